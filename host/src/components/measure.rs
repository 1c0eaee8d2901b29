//! Figures of a motion: speed, jerk, distances.

use faer::Mat;

use super::objective::gram;

/// Mean size of the third derivative of the joints' positions, m/s^3.
pub fn jerk(positions: &[f64], channels: usize, fps: f64) -> f64 {
    let rows: Vec<&[f64]> = positions.chunks_exact(channels.max(1)).collect();
    let (mut sum, mut count) = (0.0, 0usize);
    for window in rows.windows(4) {
        let [a, b, c, d] = [window[0], window[1], window[2], window[3]];
        for joint in 0..channels / 3 {
            let third = |x: usize| d[x] - 3.0 * c[x] + 3.0 * b[x] - a[x];
            sum += (3 * joint..3 * joint + 3).map(|x| third(x).powi(2)).sum::<f64>().sqrt() * fps.powi(3);
            count += 1;
        }
    }
    sum / count.max(1) as f64
}

/// `|C_C - C_X| / |C_C|`.
pub fn content_distance(content: &Mat<f64>, learned: &Mat<f64>) -> f64 {
    (content - learned).norm_l2() / content.norm_l2().max(1e-300)
}

/// `|Gram(C_S) - Gram(C_X)| / |Gram(C_S)|`.
pub fn style_distance(style: &Mat<f64>, learned: &Mat<f64>) -> f64 {
    let wanted = gram(style.as_ref());
    (&wanted - gram(learned.as_ref())).norm_l2() / wanted.norm_l2().max(1e-300)
}
