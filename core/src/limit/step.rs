//! One frame of the limiter.

use nalgebra::Vector3;

use super::axis::Coordinate;
use super::free::{advance as step_within, exp, log, norm};
use super::model::Row;
use super::state::{Clamped, Joint};
use super::{Fault, JointKind, LimitState, Limiter};
use crate::pose::{Pose, unit};

/// Further from where it should be, rad or m, a joint counts as clamped.
const CLAMPED: f32 = 1e-5;

impl<const JOINTS: usize> Limiter<'_, JOINTS> {
    /// Puts the state where the robot is, as far as that lies within the position limits, standing still. Without it the joints
    /// start at rest, as the table says, and the root at the first sound frame. A pose that is not [sound](Pose::is_sound) is ignored.
    pub fn start(&self, state: &mut LimitState<JOINTS>, pose: &Pose<JOINTS>) {
        state.reset();
        self.at_rest(state);
        if !pose.is_sound(self.joints()) {
            return;
        }
        (state.rooted, state.pose.root) = (true, pose.root);
        let joints = state.joints.iter_mut().zip(&mut state.pose.rotations).zip(&pose.rotations);
        for (((axes, rotation), target), row) in joints.zip(self.rows()) {
            if row.kind == JointKind::Free {
                *rotation = unit(target.into_inner());
            } else {
                let from = row.neutral.inverse() * target;
                let wanted = row.frame.coordinates(row.kind, &from, *row.rest, [row.lower, row.upper]);
                place(axes, &wanted, &row);
                *rotation = row.rotation(axes);
            }
        }
    }

    fn at_rest(&self, state: &mut LimitState<JOINTS>) {
        state.started = true;
        for ((axes, rotation), row) in state.joints.iter_mut().zip(&mut state.pose.rotations).zip(self.rows()) {
            place(axes, row.rest, &row);
            *rotation = row.rotation(axes);
        }
    }

    /// Limits one frame: `frame` in, `out` out. Infallible; every loop has a length fixed at load time.
    ///
    /// A frame that is missing (`None`) or at [`Fault`](super::Fault) is quarantined: the last sound one stays the target for `hold`
    /// seconds, then the joints go to rest with the time constant `decay`; the root, position and rotation if it is free, stays where
    /// it is. The next sound frame is the target again; the way to it keeps all limits, and ends within
    /// [`recovery_frames`](Self::recovery_frames) if it stands still. Cost: about 400 multiply-adds a joint.
    pub fn step(&self, state: &mut LimitState<JOINTS>, frame: Option<&Pose<JOINTS>>, out: &mut Pose<JOINTS>) {
        let checked = self.check(state, frame);
        self.advance(state, checked, out);
    }

    /// The guard: the frame if it is sound.
    pub(crate) fn check<'f>(
        &self,
        state: &mut LimitState<JOINTS>,
        frame: Option<&'f Pose<JOINTS>>,
    ) -> Result<&'f Pose<JOINTS>, Fault> {
        state.guard.check(frame, self.joints(), self.frozen_frames)
    }

    /// One frame that is sound, or why there is none.
    pub(crate) fn advance(
        &self,
        state: &mut LimitState<JOINTS>,
        frame: Result<&Pose<JOINTS>, Fault>,
        out: &mut Pose<JOINTS>,
    ) {
        if !state.started {
            self.at_rest(state);
        }
        let (sound, fault) = (frame.ok(), frame.err());
        let report = &mut state.report;
        report.fault = fault;
        report.frames = report.frames.saturating_add(1);
        report.gap = if sound.is_some() { 0 } else { report.gap.saturating_add(1) };
        report.faulty_frames = report.faulty_frames.saturating_add(u32::from(fault.is_some()));
        let decay = if report.gap > self.hold_frames { self.decay } else { 0.0 };

        let mut clamped = Clamped::default();
        let mut joints = u32::from(self.root(state, sound.map(|pose| pose.root), &mut clamped));
        let now = state.joints.iter_mut().zip(&mut state.pose.rotations);
        for (joint, ((axes, rotation), row)) in now.zip(self.rows()).enumerate() {
            let before = clamped;
            let target = sound.and_then(|pose| pose.rotations.get(joint));
            if row.kind == JointKind::Free {
                let (went, left) = (step_of(axes), left_of(axes));
                let error = match target {
                    Some(target) => log(&unit((target * rotation.inverse()).into_inner())),
                    None if joint == 0 => left,
                    None => left + (log(&unit((row.neutral * rotation.inverse()).into_inner())) - left) * decay,
                };
                let [speed, ..] = row.speed;
                let [change, ..] = row.change;
                let went = step_within(error, went, left, speed, change);
                *rotation = unit((exp(went) * *rotation).into_inner());
                let left = error - went;
                clamped.rate += u16::from(norm(left) > CLAMPED);
                for ((axis, went), left) in axes.iter_mut().zip(&went).zip(&left) {
                    *axis = Coordinate { at: 0.0, went: *went, left: *left };
                }
            } else {
                let wanted = match target {
                    Some(target) => {
                        let from = row.neutral.inverse() * target;
                        row.frame.coordinates(row.kind, &from, axes.map(|x| x.at), [row.lower, row.upper])
                    }
                    None => towards(axes, row.rest, decay),
                };
                let (mut beyond, mut late) = (false, false);
                let used = row.kind.coordinates();
                for ((axis, wanted), bounds) in axes.iter_mut().zip(wanted).zip(row.bounds()).take(used) {
                    let inside = wanted.max(bounds.lower).min(bounds.upper);
                    *axis = axis.advance(inside, &bounds);
                    beyond |= (wanted - inside).abs() > CLAMPED;
                    late |= axis.left.abs() > CLAMPED;
                }
                clamped.position += u16::from(beyond);
                clamped.rate += u16::from(late);
                *rotation = row.rotation(axes);
            }
            joints += u32::from(before != clamped);
        }
        let report = &mut state.report;
        report.clamped = if sound.is_some() { clamped } else { Clamped::default() };
        if sound.is_some() {
            report.clamped_joints = report.clamped_joints.saturating_add(joints);
            report.clamped_frames = report.clamped_frames.saturating_add(u32::from(joints > 0));
        }
        *out = state.pose;
    }

    /// The root's position; true if it could not follow.
    fn root(&self, state: &mut LimitState<JOINTS>, target: Option<Vector3<f32>>, clamped: &mut Clamped) -> bool {
        if let (Some(target), false) = (target, state.rooted) {
            (state.rooted, state.pose.root) = (true, target);
        }
        let error = target.map_or(state.root_left, |target| target - state.pose.root);
        let went = step_within(error, state.root_went, state.root_left, self.root_speed, self.root_change);
        let at = state.pose.root + went;
        (state.root_went, state.root_left) = (went, target.map_or(error - went, |target| target - at));
        state.pose.root = at;
        let late = norm(state.root_left) > CLAMPED.max(norm(at) * 1e-6);
        clamped.rate += u16::from(late);
        late
    }
}

impl Row<'_> {
    fn rotation(&self, axes: &Joint) -> nalgebra::UnitQuaternion<f32> {
        self.neutral * self.frame.compose(self.kind, axes.map(|x| x.at))
    }
}

/// Coordinates as wanted, within the bounds, standing still.
fn place(axes: &mut Joint, wanted: &[f32; 3], row: &Row) {
    for ((axis, wanted), bounds) in axes.iter_mut().zip(wanted).zip(row.bounds()).take(row.kind.coordinates()) {
        *axis = Coordinate { at: wanted.max(bounds.lower).min(bounds.upper), went: 0.0, left: 0.0 };
    }
}

/// The last target, a share of the way to rest nearer to it.
fn towards(axes: &Joint, rest: &[f32; 3], share: f32) -> [f32; 3] {
    let mut wanted = [0.0; 3];
    for ((wanted, axis), rest) in wanted.iter_mut().zip(axes).zip(rest) {
        let last = axis.at + axis.left;
        *wanted = last + (rest - last) * share;
    }
    wanted
}

fn step_of([a, b, c]: &Joint) -> Vector3<f32> {
    Vector3::new(a.went, b.went, c.went)
}

fn left_of([a, b, c]: &Joint) -> Vector3<f32> {
    Vector3::new(a.left, b.left, c.left)
}
