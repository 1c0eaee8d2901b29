//! One engine, or a composition of them, between pose and pose.

use super::{Engine, Fault, FromPack, Guard};
use crate::model::{LoadError, Pack};
use crate::pose::Pose;
use crate::rig::{Drift, Frame, REACH, Rig};

/// An engine, or a composition of engines, with the rig before and behind it: a pose or servo positions in, the same out.
///
/// Frames that are missing or garbled never reach an engine. `ROWS` is the capacity in rows of coordinates, the engines' own.
#[derive(Clone, Copy, Debug)]
pub struct Pipeline<'a, E, const ROWS: usize> {
    rig: Rig<'a>,
    /// The engine; its settings are its own.
    pub engine: E,
    /// How far the body may be carried from where the source stands, m: see [`Drift`]. [`f32::INFINITY`] for as far as it gets.
    pub reach: f32,
}

/// What a running pipeline remembers.
#[derive(Clone, Copy, Debug)]
pub struct PipelineState<S, const ROWS: usize> {
    /// The engine's state; its controls may change at any frame.
    pub engine: S,
    /// Which frames are kept out.
    pub guard: Guard,
    /// The last sound frame that came in.
    source: Frame<ROWS>,
    /// The last frame that went out.
    shown: Frame<ROWS>,
    drift: Drift,
    report: Report,
}

/// What happened to the last frame, and to all of them. Counts stop at their largest value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Report {
    /// What was wrong with the last frame.
    pub fault: Option<Fault>,
    /// Frames since the last sound one.
    pub gap: u32,
    /// Frames so far.
    pub frames: u32,
    /// Frames that were kept out.
    pub faulty: u32,
}

impl<S: Default, const ROWS: usize> PipelineState<S, ROWS> {
    /// Nothing seen yet, the engine at rest.
    pub fn new() -> Self {
        Self::with(S::default())
    }
}

impl<S, const ROWS: usize> PipelineState<S, ROWS> {
    /// Nothing seen yet, with an engine's state. It can stand in a `static`.
    pub const fn with(engine: S) -> Self {
        Self {
            engine,
            guard: Guard::new(),
            source: Frame::new(),
            shown: Frame::new(),
            drift: Drift::new(),
            report: Report { fault: None, gap: 0, frames: 0, faulty: 0 },
        }
    }

    /// What happened to the last frame, and to all of them.
    pub fn report(&self) -> &Report {
        &self.report
    }

    /// The last sound frame that came in.
    pub fn source(&self) -> &Frame<ROWS> {
        &self.source
    }

    /// The last frame that went out.
    pub fn shown(&self) -> &Frame<ROWS> {
        &self.shown
    }

    fn count(&mut self, fault: Option<Fault>) {
        let Report { gap, frames, faulty, .. } = self.report;
        self.report = Report {
            fault,
            gap: if fault.is_some() { gap.saturating_add(1) } else { 0 },
            frames: frames.saturating_add(1),
            faulty: faulty.saturating_add(u32::from(fault.is_some())),
        };
    }

    /// Nobody has moved since the last frame.
    fn stand(&mut self, travels: bool) {
        for frame in [&mut self.source, &mut self.shown] {
            frame.forget_place();
            if let (Some([x, _, z]), true) = (frame.rows.first_mut(), travels) {
                (*x, *z) = (0.0, 0.0);
            }
        }
    }
}

impl<S: Default, const ROWS: usize> Default for PipelineState<S, ROWS> {
    fn default() -> Self {
        Self::new()
    }
}

impl<'a, E: Engine<ROWS> + FromPack<'a>, const ROWS: usize> Pipeline<'a, E, ROWS> {
    /// The engines that `E` names, from a pack, after every check that makes the steps infallible.
    pub fn load(pack: &Pack<'a>) -> Result<Self, LoadError> {
        Self::new(Rig::load(pack)?, E::from_pack(pack)?)
    }
}

impl<'a, E: Engine<ROWS>, const ROWS: usize> Pipeline<'a, E, ROWS> {
    /// An engine on a rig.
    pub fn new(rig: Rig<'a>, engine: E) -> Result<Self, LoadError> {
        if rig.rows() > ROWS {
            return Err(LoadError::Capacity { parameter: "ROWS", found: rig.rows(), capacity: ROWS });
        }
        Ok(Self { rig, engine, reach: REACH })
    }

    /// The rig that poses must have.
    pub fn rig(&self) -> &Rig<'a> {
        &self.rig
    }

    /// Puts everything where it would be had `pose` always been held. A pose that is not sound is ignored.
    pub fn start<const JOINTS: usize>(&self, state: &mut PipelineState<E::State, ROWS>, pose: &Pose<JOINTS>) {
        if pose.is_sound(self.rig.joints()) {
            (state.source, state.drift) = (Frame::new(), Drift::new());
            self.rig.read(pose, &mut state.source);
            state.shown = state.source;
            self.engine.start(&mut state.engine, &state.source);
        }
    }

    /// The same for coordinates: where a machine stands when it is switched on. What is not sound is ignored.
    pub fn start_coordinates(&self, state: &mut PipelineState<E::State, ROWS>, coordinates: &[f32]) {
        let frame = Frame::from_coordinates(coordinates);
        if frame.is_sound() {
            (state.source, state.shown) = (frame, frame);
            self.engine.start(&mut state.engine, &frame);
        }
    }

    /// One frame: `pose` in, or `None` where none came; `out` is what goes out. Infallible. Cost: the engine's, and about 250
    /// multiply-adds per joint for the rig.
    ///
    /// Where the pose is missing or garbled, engines hold what they last showed, or do what they do without a frame; `out` must then
    /// still hold the pose that went out before.
    pub fn step<const JOINTS: usize>(
        &self,
        state: &mut PipelineState<E::State, ROWS>,
        pose: Option<&Pose<JOINTS>>,
        out: &mut Pose<JOINTS>,
    ) {
        match state.guard.check(pose, self.rig.joints()) {
            Ok(pose) => {
                state.count(None);
                self.rig.read(pose, &mut state.source);
                state.source.reach = self.reach;
                state.shown = state.source;
                self.engine.step(&mut state.engine, &mut state.shown);
                self.rig.write(&state.source, &state.shown, &mut state.drift, pose, out);
            }
            Err(fault) => {
                state.count(Some(fault));
                state.stand(self.rig.travels());
                self.engine.idle(&mut state.engine, &mut state.shown);
                self.rig.show(&state.source, &state.shown, &mut state.drift, out);
            }
        }
    }

    /// One frame of coordinates in order, of servos for example, without any rotation between. `coordinates` and `out` have the rig's
    /// number of coordinates; what is missing is 0, what is too much is left alone.
    pub fn step_coordinates(
        &self,
        state: &mut PipelineState<E::State, ROWS>,
        coordinates: Option<&[f32]>,
        out: &mut [f32],
    ) {
        match state.guard.check_coordinates(coordinates) {
            Ok(coordinates) => {
                state.count(None);
                state.source = Frame::from_coordinates(coordinates);
                state.shown = state.source;
                self.engine.step(&mut state.engine, &mut state.shown);
            }
            Err(fault) => {
                state.count(Some(fault));
                self.engine.idle(&mut state.engine, &mut state.shown);
            }
        }
        out.iter_mut().zip(state.shown.coordinates()).for_each(|(out, shown)| *out = *shown);
    }
}
