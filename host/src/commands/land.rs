//! Where the result of a command lands: on the clip's own skeleton or on the pack's, what its feet do there, and how good it is.

use clap::ValueEnum;
use kinesic::Pack;
use kinesic::model::LoadError;
use kinesic_host::clip::{Clip, JointMap};
use kinesic_host::feet::{self, Hold, IN_STEP, OUT_OF_STEP};
use kinesic_host::own_body::OwnBody;
use kinesic_host::prepare::Source;
use kinesic_host::quality::{Quality, measure};
use kinesic_host::rig::Rig;
use miette::miette;
use serde::Serialize;

use super::figure::figure;
use super::quality;

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum On {
    /// The clip's own skeleton and frame rate
    Clip,
    /// The pack's skeleton and frame rate
    Pack,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Feet {
    /// The root follows the feet that stand in the clip, and legs reach for where these stood
    Lock,
    /// As a device holds them, which does not look ahead; with --on pack
    Live,
    /// As the engine makes them
    Free,
}

/// Whose skeleton the result has, and what its feet do.
pub struct Place {
    on: On,
    feet: Feet,
    /// What is said of free feet.
    free: &'static str,
}

/// Quality of the clip and of the result.
#[derive(Serialize)]
pub struct Judged {
    #[serde(skip_serializing_if = "Option::is_none")]
    source: Option<Quality>,
    /// Of the second clip, where a result is made of two.
    #[serde(skip_serializing_if = "Option::is_none")]
    second: Option<Quality>,
    #[serde(skip_serializing_if = "Option::is_none")]
    styled: Option<Quality>,
    /// Correlation of each foot, left and right, with that of the clip; absent where it hardly swings.
    #[serde(skip_serializing_if = "Option::is_none")]
    step: Option<[Option<f64>; 2]>,
    /// Whether feet are held where they stand in the clip.
    #[serde(skip_serializing_if = "Option::is_none")]
    feet: Option<&'static str>,
}

impl Place {
    /// The clip's skeleton unless told otherwise; limits are of the pack's joints, and a robot's clip is of the pack's.
    pub fn choose(on: Option<On>, feet: Option<Feet>, pack: &Pack, source: Option<&Source>) -> miette::Result<Self> {
        let limited = pack.metadata().models.iter().any(|meta| meta.limits().is_some());
        let own = source.is_some_and(|source| source.machine.is_none());
        if on == Some(On::Clip) && (limited || !own) {
            let why = match limited {
                true => "the pack's limits are of its own joints",
                false if source.is_some() => "a robot's motion is on the pack's skeleton already",
                false => "a stored motion comes from no clip",
            };
            return Err(miette!(help = "leave --on out", "--on clip: {why}"));
        }
        let on = on.unwrap_or(if own && !limited { On::Clip } else { On::Pack });
        if feet == Some(Feet::Live) && (on == On::Clip || !own) {
            let why = match own {
                true => "a device holds the feet of the pack's skeleton",
                false if source.is_some() => "a robot has no feet",
                false => "a stored motion comes from no clip",
            };
            let help = if own { "add --on pack, or hold feet with --feet lock" } else { "leave --feet out" };
            return Err(miette!(help = help, "--feet live: {why}"));
        }
        Ok(Self { on, feet: feet.unwrap_or(if on == On::Clip { Feet::Lock } else { Feet::Free }), free: "free" })
    }

    /// The same with feet that are let go, since held ones would jerk.
    pub fn let_go(&self) -> Self {
        Self { on: self.on, feet: Feet::Free, free: "free: held feet would jerk" }
    }

    /// Whether the result has the clip's skeleton.
    pub fn is_own(&self) -> bool {
        self.on == On::Clip
    }

    /// What was made of `clip`, which is `source` on the rig. A robot has no feet, a stored motion no clip.
    pub fn land<'a>(
        &self,
        source: Option<&'a Source>,
        (pack, rig): (&Pack, &'a Rig),
        clip: Option<&'a Clip>,
        played: &Clip,
        hold: Hold,
    ) -> Result<Landed<'a>, LoadError> {
        let stands = source.is_some_and(|source| source.machine.is_some());
        let Some(clip) = clip.filter(|_| !stands) else {
            return Ok(Landed {
                clip: played.clone(),
                from: None,
                second: None,
                map: rig.frames().travels().then_some(&rig.map),
                step: None,
                feet: None,
            });
        };
        let (from, styled, map) = match source.filter(|_| self.on == On::Clip) {
            Some(source) => (&source.clip, OwnBody::new(source, rig).carry(clip, played), &source.map),
            None => (clip, played.clone(), &rig.map),
        };
        let mut styled = styled;
        if hold.soft > 0.0 {
            feet::keep_knees(from, &mut styled, map, 2.0 * hold.soft);
        }
        let step = feet::kept_step((from, map), (&styled, map));
        let (styled, feet) = match self.feet {
            Feet::Free => (styled, self.free),
            Feet::Lock | Feet::Live if out_of_step(&step) => (styled, "free: out of step with the clip"),
            Feet::Lock => (feet::lock(from, &styled, map, hold), "locked"),
            Feet::Live => (feet::live(pack, rig, from, &styled)?, "held as on the device"),
        };
        Ok(Landed { step: Some(step), feet: Some(feet), ..Landed::of_two(styled, from, None, map) })
    }
}

fn out_of_step(step: &[Option<f64>; 2]) -> bool {
    step.iter().flatten().any(|kept| *kept < OUT_OF_STEP)
}

/// A result where it belongs.
pub struct Landed<'a> {
    /// The motion.
    pub clip: Clip,
    from: Option<&'a Clip>,
    second: Option<&'a Clip>,
    map: Option<&'a JointMap>,
    step: Option<[Option<f64>; 2]>,
    feet: Option<&'static str>,
}

impl<'a> Landed<'a> {
    /// What was made of one or two motions on the skeleton whose joints `map` names.
    pub fn of_two(clip: Clip, from: &'a Clip, second: Option<&'a Clip>, map: &'a JointMap) -> Self {
        Self { clip, from: Some(from), second, map: Some(map), step: None, feet: None }
    }

    /// Quality of the clip and of what is written.
    pub fn judge(&self, written: &Clip) -> Judged {
        let quality = |clip: &Clip| self.map.map(|map| measure(clip, map));
        Judged {
            source: self.from.and_then(quality),
            second: self.second.and_then(quality),
            styled: quality(written),
            step: self.step,
            feet: self.feet,
        }
    }
}

impl Judged {
    /// Jerk of the result over that of the clip, or of the rougher one of two.
    pub fn jerk_ratio(&self) -> Option<f64> {
        let sources = self.source.iter().chain(&self.second).map(|quality| quality.jerk_m_s3);
        let most = sources.fold(0.0, f64::max);
        self.styled.filter(|_| most > 0.0).map(|styled| styled.jerk_m_s3 / most)
    }

    /// Feet in a few words, for a line about one of many clips.
    pub fn line(&self) -> String {
        let slides = self.source.as_ref().zip(self.styled.as_ref());
        let slides = slides
            .map(|(a, b)| format!("; feet slide {:.1} cm/s, the clip's {:.1}", b.foot_slide_cm_s, a.foot_slide_cm_s));
        slides.into_iter().chain(self.feet.map(|feet| format!(", {feet}"))).collect()
    }

    /// Prints the table, and what is wrong with the feet.
    pub fn print(&self) {
        let sources = self.source.iter().map(|q| ("source", q)).chain(self.second.iter().map(|q| ("second", q)));
        match &sources.chain(self.styled.iter().map(|q| ("styled", q))).collect::<Vec<_>>()[..] {
            [] => {}
            rows => quality::print(rows),
        }
        let side = |(name, kept): (&str, Option<f64>)| kept.map(|kept| format!("{name} {}", figure(kept, 2)));
        let sides: Vec<String> =
            ["left", "right"].into_iter().zip(self.step.unwrap_or_default()).filter_map(side).collect();
        if !sides.is_empty() {
            println!(
                "in step    {} (correlation of each foot with the clip's; {IN_STEP} and more keeps step)",
                sides.join(", ")
            );
        }
        if let Some(feet) = self.feet {
            println!("feet       {feet}");
        }
        if self.step.as_ref().is_some_and(out_of_step) {
            println!(
                "note: a foot of the result does something else than that of the clip. Either the pack was not trained in step \
                 (kinesic train translate --align in-step ...), or the clip is unlike what it was trained on"
            );
        }
    }
}
