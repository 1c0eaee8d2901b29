//! `kinesic decouple`.

use std::path::PathBuf;

use miette::IntoDiagnostic;
use serde::Serialize;

use super::clips::Reading;
use super::expression::{Body, outputs};
use super::output::{print_json, spinner};

/// Split a motion into what the body must do and what it expresses
///
/// The mechanics clip holds B', the pose without expression; the expressive clip holds E* over the rest pose, with the hips
/// of the first frame. E* B' is the motion again.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  kinesic decouple models/mechanics.kin box.bvh --mechanics box-plain.bvh --expressive box-expression.bvh
  kinesic decouple models/mechanics.kin box.bvh --mechanics box-plain.bvh --json")]
pub struct Args {
    /// Body-mechanics pack
    #[arg(value_name = "PACK.kin")]
    pack: PathBuf,
    /// Clip to split
    #[arg(value_name = "CLIP")]
    clip: PathBuf,
    /// Motion to write (.bvh, .glb, .gltf or .csv): the pose without expression
    #[arg(long, value_name = "FILE", required_unless_present = "expressive")]
    mechanics: Option<PathBuf>,
    /// Motion to write: what expression adds, on the rest pose
    #[arg(long, value_name = "FILE")]
    expressive: Option<PathBuf>,
    /// Random seed; decoupling makes no random choice
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Print one JSON object: frames, expressive_deg, product_error
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    reading: Reading,
}

#[derive(Serialize)]
struct Summary {
    clip: String,
    frames: usize,
    /// Mean angle of E*, degrees.
    expressive_deg: f64,
    /// Largest difference of a quaternion component between E* B' and the clip.
    product_error: f32,
}

/// Runs the command.
pub fn run(args: &Args) -> miette::Result<()> {
    outputs(&args.mechanics.iter().chain(&args.expressive).collect::<Vec<_>>())?;
    let bar = spinner();
    bar.set_message("decoupling");
    let body = Body::read(&args.pack)?;
    let motion = body.decouple(&args.clip, &args.reading)?;
    if let Some(path) = &args.mechanics {
        let plain = body.clip(&motion.parts.iter().map(|p| p.mechanics).collect::<Vec<_>>());
        plain.write(path).into_diagnostic()?;
    }
    if let Some(path) = &args.expressive {
        let mut poses = Vec::with_capacity(motion.parts.len());
        for parts in &motion.parts {
            let mut pose = kinesic::Pose { root: motion.poses[0].root, rotations: parts.expressive };
            pose.rotations[0] = motion.poses[0].rotations[0];
            poses.push(pose);
        }
        body.clip(&poses).write(path).into_diagnostic()?;
    }
    let joints = body.rig.joints();
    let error = |(parts, pose): (&kinesic::mechanics::Decoupled<_>, &kinesic::Pose<_>)| {
        let product = parts.observed();
        let pairs = product.rotations.iter().zip(&pose.rotations).take(joints);
        pairs.map(|(a, b)| (a.coords - b.coords).amax()).fold(0.0f32, f32::max)
    };
    let summary = Summary {
        clip: motion.name(),
        frames: motion.poses.len(),
        expressive_deg: motion.expression_deg(),
        product_error: motion.parts.iter().zip(&motion.poses).map(error).fold(0.0, f32::max),
    };
    bar.finish_and_clear();
    if args.json {
        return print_json(&summary);
    }
    println!(
        "{}: {} frames, expression {:.2} degrees a joint, E* B' differs by at most {:.1e}",
        summary.clip, summary.frames, summary.expressive_deg, summary.product_error
    );
    Ok(())
}
