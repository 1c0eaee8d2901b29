//! The modal recursion: a state-space model whose transition matrix is block diagonal with 2 x 2 blocks.
//!
//! A pair of complex poles is a rotation-scaling block, a pair of real poles a diagonal block, a (nearly) double pole a
//! triangular block (real Schur form of the pair): one shape holds them all, at four multiply-adds a pair instead of the
//! `n` of a dense row.

/// Transition of two states, row-major `[[a, b], [c, d]]`.
pub type Block = [f32; 4];

/// Two states of a model with 3 inputs and 3 outputs: transition `a b c d`, input row of the first and of the second state,
/// output column of the first and of the second state. 64 bytes, in the order in which a step reads them.
pub type JointBlock = [f32; 16];

/// True if both poles of the block lie inside the unit circle (Jury's conditions for 2 x 2).
pub fn is_stable(block: &Block) -> bool {
    let [a, b, c, d] = *block;
    let trace = a + d;
    let det = a * d - b * c;
    det < 1.0 && trace < 1.0 + det && -trace < 1.0 + det
}

/// `x <- A x` for all blocks. Cost: 4 multiply-adds a block.
pub fn advance(blocks: &[Block], x: &mut [[f32; 2]]) {
    for (block, x) in blocks.iter().zip(x) {
        let [a, b, c, d] = *block;
        let [x0, x1] = *x;
        *x = [a * x0 + b * x1, c * x0 + d * x1];
    }
}

/// The state at which `x = A x + drive`: where a constant input would have brought the block. Needs a stable block.
pub fn settle(block: &Block, drive: [f32; 2]) -> [f32; 2] {
    let [a, b, c, d] = *block;
    let [u0, u1] = drive;
    // Jury's conditions make this determinant positive.
    let det = (1.0 - a) * (1.0 - d) - b * c;
    [((1.0 - d) * u0 + b * u1) / det, (c * u0 + (1.0 - a) * u1) / det]
}

/// One joint's model: `y += C x`, then `x' = A x + B u`. Cost: 16 multiply-adds a block.
pub fn advance_joint(blocks: &[JointBlock], u: [f32; 3], x: &mut [[f32; 2]], y: &mut [f32; 3]) {
    let [u0, u1, u2] = u;
    let [mut y0, mut y1, mut y2] = *y;
    for (block, x) in blocks.iter().zip(x) {
        let [a, b, c, d, b00, b01, b02, b10, b11, b12, c00, c10, c20, c01, c11, c21] = *block;
        let [x0, x1] = *x;
        y0 = y0 + c00 * x0 + c01 * x1;
        y1 = y1 + c10 * x0 + c11 * x1;
        y2 = y2 + c20 * x0 + c21 * x1;
        *x = [a * x0 + b * x1 + b00 * u0 + b01 * u1 + b02 * u2, c * x0 + d * x1 + b10 * u0 + b11 * u1 + b12 * u2];
    }
    *y = [y0, y1, y2];
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stability_is_judged_by_the_poles() {
        assert!(is_stable(&[0.6, 0.7, -0.7, 0.6]), "modulus .92");
        assert!(!is_stable(&[0.8, 0.7, -0.7, 0.8]), "modulus 1.06");
        assert!(is_stable(&[0.99, 0.0, 0.0, -0.99]));
        assert!(!is_stable(&[1.0, 0.0, 0.0, 0.5]));
        assert!(is_stable(&[0.9, 5.0, 0.0, 0.9]), "a Jordan block is as stable as its pole");
        assert!(!is_stable(&[f32::NAN, 0.0, 0.0, 0.0]));
    }

    #[test]
    fn settled_state_stays() {
        let block = [0.6, 0.5, -0.5, 0.6];
        let mut x = [settle(&block, [1.0, -2.0])];
        let before = x[0];
        advance(&[block], &mut x);
        assert!((x[0][0] + 1.0 - before[0]).abs() < 1e-6 && (x[0][1] - 2.0 - before[1]).abs() < 1e-6);
    }

    #[test]
    fn joint_model_is_the_state_space_definition() {
        let block: JointBlock = core::array::from_fn(|i| 0.1 * i as f32 - 0.4);
        let u = [0.3, -0.2, 0.9];
        let mut x = [[0.5, -0.25]];
        let mut y = [1.0, 2.0, 3.0];
        advance_joint(&[block], u, &mut x, &mut y);
        let expected_y0 = 1.0 + block[10] * 0.5 + block[13] * -0.25;
        let expected_x1 = block[2] * 0.5 + block[3] * -0.25 + block[7] * u[0] + block[8] * u[1] + block[9] * u[2];
        assert!((y[0] - expected_y0).abs() < 1e-6);
        assert!((x[0][1] - expected_x1).abs() < 1e-6);
    }
}
