//! Principal components.

use std::error::Error;
use std::path::Path;

use faer::{Mat, MatRef};
use kinesic_host::components::pca;
use serde_json::{Value, json};

use crate::motions::{self, COMPONENTS, KEYFRAMES};
use kinesic_benches::measure::{peak_mib, timed, write};
use kinesic_benches::synthetic::{self, centred};

/// The keyframes of 1,000 motions, 120 numbers each, on 40 components: the first step of emotion strength.
pub fn keyframes(folder: &Path, scale: f64) -> Result<Value, Box<dyn Error>> {
    let count = (1000.0 * scale).round() as usize;
    run(folder, &motions::made(count).values, motions::CHANNELS, count * KEYFRAMES)
}

/// A clip of 198 channels on 40 components.
pub fn clip(folder: &Path, scale: f64) -> Result<Value, Box<dyn Error>> {
    let frames = (1400.0 * scale).round() as usize;
    run(folder, &synthetic::rows(&synthetic::channels(198, 1), frames, |t| t, 2), 198, frames)
}

fn run(folder: &Path, values: &[f64], columns: usize, rows: usize) -> Result<Value, Box<dyn Error>> {
    write(folder, "rows.f64", values)?;
    let given = MatRef::from_row_major_slice(values, rows, columns).to_owned();
    let (seconds, (centred, factors)) = timed(|| {
        let centred = centred(given.as_ref());
        let factors = pca(centred.as_ref(), COMPONENTS);
        (centred, factors)
    });
    let peak = peak_mib();
    let left: Mat<f64> = &centred - factors.product();
    let explained = 1.0 - left.squared_norm_l2() / centred.squared_norm_l2();
    Ok(json!({
        "seconds": seconds, "peak_mib": peak, "explained": explained,
        "rows": rows, "columns": columns, "components": COMPONENTS,
    }))
}
