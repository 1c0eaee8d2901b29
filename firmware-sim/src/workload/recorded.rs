//! The translators as a user makes them: trained on two recorded takes, fed a long take of somebody else. The clips stay
//! outside the repository, so these workloads prove sameness and are held against no budget.

use std::path::Path;

use kinesic::{Pack, Translator};
use kinesic_host::pack::Provenance;
use kinesic_host::prepare::Source;
use kinesic_host::translate::{FormChoice, TrainOptions, TrainPair, train};
use kinesic_workloads::posed::{RECORDED_JOINTS, Recorded};

use super::translator::numbers;
use super::{Prepared, WorkloadError, aligned, on_host};

const NEUTRAL: &str = "xia/neutral_01_000.bvh";
const STYLED: &str = "xia/angry_01_000.bvh";
const WALKER: &str = "cmu31/03_03.bvh";
const FPS: f64 = 60.0;
const FORMS: [(&str, &str, FormChoice); 2] =
    [("recorded", "recorded.kin", FormChoice::PerJoint), ("recorded-body", "recorded-body.kin", FormChoice::WholeBody)];

/// A translator trained on recorded clips, with recorded input.
#[derive(Clone, Debug)]
pub struct Trained {
    /// Name of the workload and of its image.
    pub name: &'static str,
    /// Pack, input, and the host's hashes.
    pub prepared: Prepared,
    /// What it was trained on and what it is fed, for people.
    pub story: String,
}

/// Trains both forms on the clips in `data` and runs up to `frames` frames of the long take on the host.
pub fn train_both(data: &Path, frames: usize) -> Result<Vec<Trained>, WorkloadError> {
    let read = |name: &str| Source::read(&data.join(name), &Default::default());
    let neutral = read(NEUTRAL)?;
    let rig = neutral.rig()?;
    let poses = [rig.poses(&neutral.on_rig(&rig, FPS)?), rig.poses(&read(STYLED)?.on_rig(&rig, FPS)?)];
    let rig = rig.centred(&[&poses[0], &poses[1]]);
    let pair = TrainPair {
        source_name: NEUTRAL.to_owned(),
        target_name: STYLED.to_owned(),
        source: rig.locals(&poses[0]),
        target: rig.locals(&poses[1]),
    };
    let mut input = numbers(&rig, &read(WALKER)?.on_rig(&rig, FPS)?, RECORDED_JOINTS);
    input.truncate(frames);
    let one = |(name, pack_name, form): (&'static str, &'static str, FormChoice)| {
        let options = TrainOptions { form, ..TrainOptions::default() };
        let model = train(&rig, std::slice::from_ref(&pair), "angry", FPS, &options, &|_| {})?.model;
        let pack = model.pack(&rig, &Provenance { tool: "kinesic-firmware-sim".to_owned(), ..Provenance::default() });
        let story = format!("{NEUTRAL} -> {STYLED}, {}; fed {} frames of {WALKER}", shape(name, &pack)?, input.len());
        Ok(Trained { name, story, prepared: on_host::<Recorded>(name, pack_name, pack, &input)? })
    };
    FORMS.into_iter().map(one).collect()
}

/// Joints, filter states and multiply-adds of a pack, in words.
fn shape(name: &str, pack: &[u8]) -> Result<String, WorkloadError> {
    let refused = |_| WorkloadError::Refused { name: name.to_owned() };
    let words = aligned(pack);
    let pack = Pack::load(&bytemuck::cast_slice(&words)[..pack.len()]).map_err(refused)?;
    let model = Translator::<{ RECORDED_JOINTS + 1 }, { (RECORDED_JOINTS + 1) * 40 }>::load(&pack).map_err(refused)?;
    let states = 2 * model.meta().blocks;
    let (rows, multiply_adds) = (model.rows(), model.multiply_adds());
    Ok(format!("{rows} rows of coordinates, {states} filter states, {multiply_adds} multiply-adds"))
}
