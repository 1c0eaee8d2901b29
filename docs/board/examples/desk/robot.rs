//! What the robot does in a frame. Nothing here knows of a board.

use kinesic::model::Floats;
use kinesic::{LimitState, Limiter, LoadError, Pack, Pipeline, PipelineState, Servos, Translator, TranslatorState};

/// Servos, and coordinates of the pack.
pub const SERVOS: usize = 4;

// Capacities: `kinesic inspect lively.kin` prints the least that they must be.
const ROWS: usize = 2;
const STATES: usize = 24;

/// The style, in f32 alone, then the servos' limits.
type Style = Pipeline<'static, (Translator<'static, ROWS, STATES, Floats>, Limiter<'static, ROWS>), ROWS>;

/// What they remember.
type State = PipelineState<(TranslatorState<ROWS, STATES>, LimitState<ROWS>), ROWS>;

/// Where the robot is parked, rad. Hobby servos do not report; one that does is asked, and `Servos::coordinate` gives its angle.
const PARKED: [f32; SERVOS] = [0.0; SERVOS];

/// The pack's tables, and what they remember.
pub struct Robot {
    style: Style,
    servos: Servos<'static>,
    state: State,
}

impl Robot {
    /// A robot that stands where it is parked.
    #[inline(never)]
    pub fn load(pack: &'static [u8]) -> Result<Self, LoadError> {
        let pack = Pack::load(pack)?;
        let (style, servos, mut state) = (Style::load(&pack)?, Servos::load(&pack)?, State::new());
        // Plain: the limits start where the style puts the robot, and that must be where it stands.
        state.engine.0.controls.strength = 0.0;
        style.start_coordinates(&mut state, &PARKED);
        Ok(Self { style, servos, state })
    }

    /// The pulse widths at which it stands, microseconds.
    pub fn standing(&self) -> [u16; SERVOS] {
        self.pulses(&PARKED)
    }

    /// One frame: angles, rad, or none where none came, and how lively it is, 0 to 1. Pulse widths, microseconds, come out.
    pub fn frame(&mut self, angles: Option<&[f32; SERVOS]>, mood: f32) -> [u16; SERVOS] {
        let mut out = [0.0; SERVOS];
        self.state.engine.0.controls.strength = mood;
        self.style.step_coordinates(&mut self.state, angles.map(|angles| &angles[..]), &mut out);
        self.pulses(&out)
    }

    fn pulses(&self, angles: &[f32; SERVOS]) -> [u16; SERVOS] {
        let mut pulses = [0; SERVOS];
        for command in self.servos.commands(angles) {
            // A servo's id is its channel.
            if let Some(pulse) = pulses.get_mut(usize::from(command.id)) {
                *pulse = command.whole() as u16;
            }
        }
        pulses
    }
}

/// How lively the robot is: up in 8 s, down in 8 s. On a product: a sensor, a clock, a dialogue.
pub fn mood(frame: u32) -> f32 {
    let at = frame % 800;
    (if at < 400 { at } else { 800 - at }) as f32 / 400.0
}

/// Whether a frame is lost on the way: two now and then, and once a whole second, in which the robot goes to rest.
pub fn lost(frame: u32) -> bool {
    frame % 97 >= 95 || (550..600).contains(&frame)
}
