//! What a desk robot's firmware does in a frame when it has a player: layers, style, limits of jerk too, and what every servo is told.

use kinesic::model::{Floats, Ungated};
use kinesic::play::Move;
use kinesic::{Pack, Pipeline, PipelineState, Player, Servos, SmoothLimitState, SmoothLimiter};
use kinesic::{Translator, TranslatorState};

use crate::{Digest, Refused, Workload};

const SERVOS: usize = 4;
const ROWS: usize = 2;
const STATES: usize = 28;

/// A nod of half a second: the second servo, rad.
static NOD: [[f32; SERVOS]; 25] = nod();

const fn nod() -> [[f32; SERVOS]; 25] {
    let mut frames = [[0.0; SERVOS]; 25];
    let mut at = 0;
    while at < 25 {
        let from_middle = at as f32 / 12.0 - 1.0;
        frames[at][1] = 0.3 * (1.0 - from_middle * from_middle);
        at += 1;
    }
    frames
}

/// A head with two antennas. What comes in is followed; every two seconds it nods once, in the other second at half the strength.
#[derive(Clone, Copy, Debug)]
pub struct Layers;

/// RAM of the player, of the pipeline and of their caller.
#[derive(Clone, Debug)]
pub struct Running {
    player: Player<'static, SERVOS, 2>,
    nod: Option<Move<'static, SERVOS>>,
    state: PipelineState<(TranslatorState<ROWS, STATES>, SmoothLimitState<ROWS>), ROWS>,
    at: u32,
    angles: [f32; SERVOS],
    told: [i32; SERVOS],
}

/// An input frame is an angle per servo, rad.
impl Workload for Layers {
    type Model<'p> =
        (Pipeline<'p, (Translator<'p, ROWS, STATES, Ungated<Floats>>, SmoothLimiter<'p, ROWS>), ROWS>, Servos<'p>);
    type State = Running;

    fn open(pack: &[u8]) -> Result<Self::Model<'_>, Refused> {
        let pack = Pack::load(pack).map_err(|_| Refused)?;
        Ok((Pipeline::load(&pack).map_err(|_| Refused)?, Servos::load(&pack).map_err(|_| Refused)?))
    }

    fn power_on(_: &Self::Model<'_>) -> Self::State {
        let mut player = Player::new([0.0; SERVOS]);
        player.start([0.0; SERVOS], 50);
        let [_, gesture] = &mut player.layers;
        gesture.mask([0.0, 1.0, 0.0, 0.0], 0);
        let nod = Move::new(&NOD);
        Running { player, nod, state: PipelineState::new(), at: 0, angles: [0.0; SERVOS], told: [0; SERVOS] }
    }

    fn load(_: &Self::Model<'_>, running: &mut Self::State, input: &[u8]) {
        let numbers = input.as_chunks::<4>().0.iter().map(|bytes| f32::from_le_bytes(*bytes));
        running.angles.iter_mut().zip(numbers).for_each(|(angle, number)| *angle = number);
    }

    fn step((pipeline, servos): &Self::Model<'_>, running: &mut Self::State) {
        let [base, gesture] = &mut running.player.layers;
        base.follow(&running.angles, 10);
        match (running.at % 100, running.nod) {
            (0, Some(nod)) => gesture.gesture(nod, 8),
            (50, _) => base.strength(if running.at % 200 < 100 { 0.5 } else { 1.0 }, 25),
            _ => {}
        }
        running.at = running.at.wrapping_add(1);
        let mut out = [0.0; SERVOS];
        pipeline.step_coordinates(&mut running.state, Some(running.player.step()), &mut out);
        running.told.iter_mut().zip(servos.commands(&out)).for_each(|(told, command)| *told = command.whole());
    }

    fn output(_: &Self::Model<'_>, running: &Self::State, digest: &mut Digest) {
        running.told.iter().for_each(|told| digest.float(*told as f32));
    }
}
