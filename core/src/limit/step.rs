//! One frame of the limiter.

use nalgebra::Vector3;

use super::axis::{Axis, Bounds, Plain, within};
use super::free;
use super::model::Limit;
use super::state::Clamped;
use super::{LimitStateOf, LimiterOf};
use crate::engine::Engine;
use crate::kernel::sin_cos;
use crate::pose::Heading;
use crate::rig::{Frame, carried};

/// Further from where it should be, rad or m, a coordinate counts as clamped.
const CLAMPED: f32 = 1e-5;

/// No limit.
const FAR: f32 = 1e6;

impl<const ROWS: usize, A: Axis> LimiterOf<'_, ROWS, A> {
    /// Puts the state where the robot is, as far as that lies within the position limits, standing still. Without it the coordinates
    /// start at rest, as the table says. A frame that is not [sound](Frame::is_sound) is ignored.
    pub fn start(&self, state: &mut LimitStateOf<ROWS, A>, frame: &Frame<ROWS>) {
        state.reset();
        self.at_rest(state);
        if !frame.is_sound() {
            return;
        }
        (state.heading, state.ground) = (Some(frame.heading), Some(frame.ground));
        let axes = state.axes.as_flattened_mut().iter_mut().zip(frame.coordinates());
        for (limit, (axis, x)) in self.limits().zip(axes) {
            if let Some(Limit { bounds, .. }) = limit {
                *axis = A::standing(within(*x, bounds.lower, bounds.upper));
            }
        }
    }

    fn at_rest(&self, state: &mut LimitStateOf<ROWS, A>) {
        state.started = true;
        for (limit, axis) in self.limits().zip(state.axes.as_flattened_mut()) {
            if let Some(Limit { rest, .. }) = limit {
                *axis = A::standing(rest);
            }
        }
    }

    /// Limits one frame in place. Infallible; every loop has a length fixed at load time. A frame that is not sound counts as none:
    /// see [`idle`](Self::idle). Cost: about 30 multiply-adds, two roots and four divisions per coordinate; with a jerk limit about 100, three and ten,
    /// and twenty times as much while it catches up with its target.
    pub fn step(&self, state: &mut LimitStateOf<ROWS, A>, frame: &mut Frame<ROWS>) {
        if !frame.is_sound() {
            return self.idle(state, frame);
        }
        state.report.gap = 0;
        self.advance(state, frame, true);
    }

    /// No frame came. The last target stays for `hold` seconds, then the coordinates go to rest with the time constant `decay`, the root's
    /// height among them; over the ground the root finishes its way and stays. The next sound frame is the target again; the way to it keeps all limits, and ends within
    /// [`recovery_frames`](Self::recovery_frames) if it stands still.
    pub fn idle(&self, state: &mut LimitStateOf<ROWS, A>, frame: &mut Frame<ROWS>) {
        state.report.gap = state.report.gap.saturating_add(1);
        self.advance(state, frame, false);
    }

    fn advance(&self, state: &mut LimitStateOf<ROWS, A>, frame: &mut Frame<ROWS>, told: bool) {
        if !state.started {
            self.at_rest(state);
        }
        let decay = if state.report.gap > self.hold_frames { self.decay } else { 0.0 };
        let (mut position, mut rate) = (0u16, 0u16);
        let axes = state.axes.as_flattened_mut().iter_mut().zip(state.clamped.as_flattened_mut());
        for ((limit, (axis, clamped)), x) in self.limits().zip(axes).zip(frame.coordinates_mut()) {
            let Some(Limit { bounds, rest }) = limit else { continue };
            let last = axis.at() + axis.left();
            let wanted = if told { *x } else { last + (rest - last) * decay };
            let inside = within(wanted, bounds.lower, bounds.upper);
            axis.advance(inside, &bounds);
            *clamped = Clamped { position: (wanted - inside).abs() > CLAMPED, rate: axis.left().abs() > CLAMPED };
            position = position.saturating_add(u16::from(clamped.position));
            rate = rate.saturating_add(u16::from(clamped.rate));
            *x = axis.at();
        }
        if self.rig().travels() {
            rate += u16::from(self.turn(state, frame, told)) + u16::from(self.travel(state, frame, told));
        }
        let report = &mut state.report;
        (report.position, report.rate) = if told { (position, rate) } else { (0, 0) };
        let any = report.position > 0 || report.rate > 0;
        report.clamped_frames = report.clamped_frames.saturating_add(u32::from(any));
    }

    /// The heading; true if it could not follow. Travel of `frame` is in the source's heading until [`travel`](Self::travel).
    fn turn(&self, state: &mut LimitStateOf<ROWS, A>, frame: &mut Frame<ROWS>, told: bool) -> bool {
        let here = state.heading.unwrap_or(frame.heading);
        let error = if told { frame.heading.angle_from(here) } else { state.heading_error };
        let bounds =
            Bounds { lower: -FAR, upper: FAR, speed: self.heading.speed, change: self.heading.change, jerk: 0.0 };
        let axis = Plain { at: 0.0, went: state.heading_step, left: state.heading_error };
        let axis = axis.gone(error, &bounds);
        (state.heading_step, state.heading_error) = (axis.went, axis.left);
        let (sin, cos) = sin_cos(axis.at);
        state.heading = Some(here.turned(sin, cos));
        axis.left.abs() > CLAMPED
    }

    /// The root over the ground; true if it could not follow.
    fn travel(&self, state: &mut LimitStateOf<ROWS, A>, frame: &mut Frame<ROWS>, told: bool) -> bool {
        let heading = state.heading.unwrap_or(Heading::FORWARD);
        let flat = |[x, z]: [f32; 2]| Vector3::new(x, 0.0, z);
        let left = flat(state.root_error);
        let Some([x, _, z]) = frame.rows.first().copied() else { return false };
        let way = frame.heading.to_world(Vector3::new(x, 0.0, z)) + flat(frame.leap);
        let way = if told { way - flat(lost(state, frame, way)) } else { Vector3::zeros() };
        let error = left + way;
        let step = free::advance(error, flat(state.root_step), left, self.root.speed, self.root.change);
        let left = error - step;
        (state.root_step, state.root_error) = ([step.x, step.z], [left.x, left.z]);
        let travel = heading.to_local(step);
        if let Some([x, _, z]) = frame.rows.first_mut() {
            (*x, *z) = (travel.x, travel.z);
        }
        let [aim_x, aim_z] = state.aim;
        frame.carried = Some([aim_x - left.x, aim_z - left.z]);
        (frame.heading, frame.leap) = (heading, [0.0; 2]);
        free::norm(left) > CLAMPED
    }
}

/// What of a way would lead out of the [reach](Frame::reach), world, m. The target goes the rest.
fn lost<const ROWS: usize, A>(state: &mut LimitStateOf<ROWS, A>, frame: &Frame<ROWS>, way: Vector3<f32>) -> [f32; 2] {
    let ([x, z], [aim_x, aim_z]) = (frame.ground, state.aim);
    let by = state.ground.map_or([0.0; 2], |[from_x, from_z]| [way.x - (x - from_x), way.z - (z - from_z)]);
    (state.ground, state.aim) = (Some(frame.ground), carried(state.aim, by, frame.reach));
    let ([by_x, by_z], [to_x, to_z]) = (by, state.aim);
    [aim_x + by_x - to_x, aim_z + by_z - to_z]
}

impl<const ROWS: usize, A: Axis> Engine<ROWS> for LimiterOf<'_, ROWS, A> {
    type State = LimitStateOf<ROWS, A>;
    const STANDS: bool = true;

    fn start(&self, state: &mut Self::State, frame: &Frame<ROWS>) {
        LimiterOf::start(self, state, frame);
    }

    fn step(&self, state: &mut Self::State, frame: &mut Frame<ROWS>) {
        LimiterOf::step(self, state, frame);
    }

    fn idle(&self, state: &mut Self::State, frame: &mut Frame<ROWS>) {
        LimiterOf::idle(self, state, frame);
    }
}
