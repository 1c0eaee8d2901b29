//! The clips of bandai2, all on the first one's skeleton.

use std::path::PathBuf;

use kinesic::Pose;
use kinesic_host::clip::{Clip, ReadOptions};
use kinesic_host::prepare::Source;
use kinesic_host::rig::{MAX_JOINTS, Rig};

use super::Fallible;

/// What is done.
pub const ACTIONS: [&str; 7] = [
    "raise-up-both-hands",
    "raise-up-right-hand",
    "run",
    "walk",
    "walk-turn-left",
    "wave-both-hands",
    "wave-left-hand",
];
/// How it is done; the first one is the source.
pub const STYLES: [&str; 7] = ["normal", "active", "elderly", "exhausted", "feminine", "masculine", "youthful"];
/// How often.
pub const TAKES: usize = 4;
/// Frames per second of every clip.
pub const FRAME_RATE: f64 = 30.0;

pub type Poses = Vec<Pose<MAX_JOINTS>>;

/// A clip, as file and as the device reads it.
pub struct Take {
    pub name: String,
    pub clip: Clip,
    pub poses: Poses,
}

pub struct Clips {
    /// Centred on all clips: for features.
    pub rig: Rig,
    takes: Vec<Take>,
}

impl Clips {
    pub fn read() -> Fallible<Self> {
        let data = std::env::var_os("KINESIC_DATA").map_or_else(|| PathBuf::from("../shared/data"), PathBuf::from);
        let (mut rig, mut takes) = (None, Vec::new());
        for action in ACTIONS {
            for style in STYLES {
                for take in 1..=TAKES {
                    let name = format!("{action}_{style}_{take:03}.bvh");
                    let source = Source::read(&data.join("bandai2").join(&name), &ReadOptions::default())?;
                    let rig = match &mut rig {
                        Some(rig) => rig,
                        none => none.insert(source.rig()?),
                    };
                    let clip = source.on_rig(rig, FRAME_RATE)?;
                    takes.push(Take { name, poses: rig.poses(&clip), clip });
                }
            }
        }
        let all: Vec<&[Pose<MAX_JOINTS>]> = takes.iter().map(|take| take.poses.as_slice()).collect();
        let rig = rig.ok_or("no clips")?.centred(&all);
        Ok(Self { rig, takes })
    }

    /// Takes are counted from 1.
    pub fn take(&self, action: usize, style: usize, take: usize) -> &Take {
        &self.takes[(action * STYLES.len() + style) * TAKES + take - 1]
    }
}
