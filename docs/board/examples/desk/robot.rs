//! What the robot does in a frame. Nothing here knows of a board.

use kinesic::model::{Floats, Ungated};
use kinesic::play::Move;
use kinesic::{
    LimitState, Limiter, LoadError, Pack, Pipeline, PipelineState, Player, Servos, Translator, TranslatorState,
};

/// Servos, and coordinates of the pack.
pub const SERVOS: usize = 4;

// Capacities: `kinesic inspect lively.kin` prints the least that they must be.
const ROWS: usize = 2;
const STATES: usize = 24;

/// The style, in f32 alone and without a gate, which machines never have; then the servos' limits.
type Style = Pipeline<'static, (Translator<'static, ROWS, STATES, Ungated<Floats>>, Limiter<'static, ROWS>), ROWS>;

/// What they remember.
type State = PipelineState<(TranslatorState<ROWS, STATES>, LimitState<ROWS>), ROWS>;

/// Where the robot is parked, rad. Hobby servos do not report; one that does is asked, and `Servos::coordinate` gives its angle.
const PARKED: [f32; SERVOS] = [0.0; SERVOS];

/// Frames a second: the pack's, the move's, and the timer's.
pub const RATE: u32 = 50;

/// Frames in which the robot comes from where it is parked into its move.
const SECOND: u16 = RATE as u16;

/// The pack's tables, what they remember, and the player.
pub struct Robot {
    style: Style,
    servos: Servos<'static>,
    state: State,
    player: Player<'static, SERVOS, 1>,
}

impl Robot {
    /// A robot that stands where it is parked, and goes from there to a move that comes again and again.
    #[inline(never)]
    pub fn load(pack: &'static [u8], calm: &'static [[f32; SERVOS]]) -> Result<Self, LoadError> {
        let pack = Pack::load(pack)?;
        let (style, servos, mut state) = (Style::load(&pack)?, Servos::load(&pack)?, State::new());
        style.start_coordinates(&mut state, &PARKED);
        let mut player = Player::new(PARKED);
        player.start(PARKED, SECOND);
        if let ([base], Some(calm)) = (&mut player.layers, Move::new(calm)) {
            base.play(calm.looped(), SECOND);
        }
        Ok(Self { style, servos, state, player })
    }

    /// The pulse widths at which it stands, microseconds.
    pub fn standing(&self) -> [u16; SERVOS] {
        self.pulses(&PARKED)
    }

    /// One frame: how lively the robot is, 0 to 1, and whether the frame of the move is lost. Pulse widths, microseconds, come out.
    pub fn frame(&mut self, mood: f32, lost: bool) -> [u16; SERVOS] {
        let mut out = [0.0; SERVOS];
        self.state.engine.0.controls.strength = mood;
        let angles = self.player.step();
        self.style.step_coordinates(&mut self.state, (!lost).then_some(&angles[..]), &mut out);
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
