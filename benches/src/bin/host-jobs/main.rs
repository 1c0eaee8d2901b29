//! One training job on made inputs, timed, for `benches/peers/host.py`, which does the same with what is used today:
//! `host-jobs JOB FOLDER [SCALE]`. The inputs go into `FOLDER` as raw numbers, the figures to the output as JSON.
//!
//! | job | at scale 1 |
//! |---|---|
//! | `align` | motion warping, 10 iterations, 60 channels, 1,400 frames |
//! | `identify` | a model of order 40, 3 inputs, 3 outputs, 6,000 frames; tested on 6,000 more |
//! | `identify-real` | the same on six recorded pairs: `KINESIC_DATA` |
//! | `autoencoder` | an epoch of 120-300-120, 33,000 samples, batches of 128 |
//! | `rank`, `rank-similar`, `rank-full` | a ranking function: 1,000 motions, 100,000 pairs, 520 or 1,560 numbers a motion |
//! | `regress` | strength -> 520 numbers by ten tanh units, 1,000 motions |
//! | `sparse`, `learn` | 25 sparse components of 200 frames x 69 channels, 500 steps of style learning |
//! | `pca`, `pca-clip` | 40 principal components of 13,000 keyframes x 120, of 1,400 frames x 198 |

mod align;
mod autoencoder;
mod components;
mod identify;
mod motions;
mod principal;
mod rank;
mod regress;

use std::error::Error;
use std::path::Path;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [job, folder, scale @ ..] = arguments.as_slice() else {
        return Err("usage: host-jobs JOB FOLDER [SCALE]".into());
    };
    let scale: f64 = scale.first().map_or(Ok(1.0), |scale| scale.parse())?;
    let folder = Path::new(folder);
    let figures = match job.as_str() {
        "align" => align::run(folder, scale)?,
        "identify" => identify::made(folder, scale)?,
        "identify-real" => identify::recorded(folder)?,
        "autoencoder" => autoencoder::run(folder, scale)?,
        "rank" => rank::run(folder, scale, rank::Kind::Reduced)?,
        "rank-similar" => rank::run(folder, scale, rank::Kind::Similar)?,
        "rank-full" => rank::run(folder, scale, rank::Kind::Full)?,
        "sparse" => components::factorise(scale)?,
        "learn" => components::learn_style(scale)?,
        "regress" => regress::run(folder, scale)?,
        "pca" => principal::keyframes(folder, scale)?,
        "pca-clip" => principal::clip(folder, scale)?,
        other => return Err(format!("no job {other}: see the table in benches/src/bin/host-jobs/main.rs").into()),
    };
    println!("{figures}");
    Ok(())
}
