//! One training job on made inputs, timed, for `benches/peers/host.py`, which does the same with what is used today:
//! `host-jobs JOB FOLDER [SCALE]`. The inputs go into `FOLDER` as raw numbers, the figures to the output as JSON.
//!
//! | job | at scale 1 |
//! |---|---|
//! | `align` | motion warping, 10 iterations, 60 channels, 1,400 frames |
//! | `identify` | a model of order 40, 3 inputs, 3 outputs, 6,000 frames; tested on 6,000 more |
//! | `identify-real` | the same on a recorded pair: `KINESIC_DATA` |
//! | `autoencoder` | an epoch of 120-300-120, 33,000 samples, batches of 128 |

mod align;
mod autoencoder;
mod identify;
mod made;
mod measure;

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
        other => return Err(format!("no job {other}: align, identify, identify-real or autoencoder").into()),
    };
    println!("{figures}");
    Ok(())
}
