//! Jerk limits: position, velocity, acceleration and jerk within their bounds after any input, checked in double precision.

use kinesic::limit::{LimitState, LimitTable, Limiter};
use kinesic::model::LimitsMeta;
use kinesic::rig::JointKind;
use kinesic::{LoadError, Pipeline, PipelineState, Rig};

const ROWS: usize = 2;
const SERVOS: usize = 6;

struct Random(u64);

impl Random {
    fn unit(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / (1u64 << 24) as f32
    }

    fn within(&mut self, low: f32, high: f32) -> f32 {
        low + self.unit() * (high - low)
    }

    fn log(&mut self, low: f32, high: f32) -> f32 {
        self.within(low.ln(), high.ln()).exp()
    }
}

/// Limits of six servos.
#[derive(Clone, Debug)]
struct Servos {
    lower: [[f32; 3]; ROWS],
    upper: [[f32; 3]; ROWS],
    velocity: [[f32; 3]; ROWS],
    acceleration: [[f32; 3]; ROWS],
    jerk: [[f32; 3]; ROWS],
    rest: [[f32; 3]; ROWS],
    rate: f32,
}

impl Servos {
    /// Such as servos have: 0.5 to 12 rad/s, full speed in 30 ms to 1 s, full acceleration in 10 ms to 0.3 s. Some have no jerk limit.
    fn random(random: &mut Random, all: bool) -> Self {
        let zero = [[0.0; 3]; ROWS];
        let rate = [30.0, 50.0, 60.0, 100.0, 200.0][(random.unit() * 5.0) as usize % 5];
        let mut servos =
            Self { lower: zero, upper: zero, velocity: zero, acceleration: zero, jerk: zero, rest: zero, rate };
        for at in 0..SERVOS {
            let (row, own) = (at / 3, at % 3);
            let velocity = random.log(0.5, 12.0);
            let acceleration = velocity / random.log(0.03, 1.0);
            let jerk = acceleration / random.log(0.01, 0.3);
            let lower = -random.log(0.05, 3.0);
            (servos.lower[row][own], servos.upper[row][own]) = (lower, random.log(0.05, 3.0));
            (servos.velocity[row][own], servos.acceleration[row][own]) = (velocity, acceleration);
            servos.jerk[row][own] = if all || at != 4 { jerk } else { 0.0 };
        }
        servos
    }

    fn table(&self) -> LimitTable<'_> {
        LimitTable {
            lower: &self.lower,
            upper: &self.upper,
            velocity: &self.velocity,
            acceleration: &self.acceleration,
            jerk: &self.jerk,
            rest: &self.rest,
        }
    }

    fn limiter<'a>(&self, table: LimitTable<'a>) -> Result<Limiter<'a, ROWS>, LoadError> {
        Limiter::new(rig(), table, LimitsMeta::default(), self.rate)
    }

    /// Bounds of a coordinate per frame.
    fn rates(&self, at: usize) -> [f64; 3] {
        let (row, own, time) = (at / 3, at % 3, 1.0 / f64::from(self.rate));
        let of = |table: &[[f32; 3]; ROWS], time: f64| f64::from(table[row][own]) * time;
        let jerk = of(&self.jerk, time * time * time);
        [of(&self.velocity, time), of(&self.acceleration, time * time), if jerk > 0.0 { jerk } else { f64::INFINITY }]
    }
}

static KINDS: [u16; SERVOS] = [JointKind::Hinge as u16; SERVOS];
static AXES: [[[f32; 3]; 3]; SERVOS] = [[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]; SERVOS];
static REFERENCE: [[f32; 4]; SERVOS] = [[0.0, 0.0, 0.0, 1.0]; SERVOS];
static MIDDLE: [[f32; 3]; SERVOS] = [[0.0; 3]; SERVOS];

fn rig() -> Rig<'static> {
    Rig::new(&KINDS, &AXES, &REFERENCE, &MIDDLE, None).unwrap()
}

type State = PipelineState<LimitState<ROWS>, ROWS>;

/// The last coordinates, steps and changes of steps, and the largest rates as shares of their bounds, less the rounding of a coordinate.
struct Watch {
    last: [[f64; 3]; SERVOS],
    most: [f64; 3],
}

impl Watch {
    fn new() -> Self {
        Self { last: [[0.0; 3]; SERVOS], most: [0.0; 3] }
    }

    fn check(&mut self, servos: &Servos, out: &[f32; SERVOS]) {
        for (at, (x, last)) in out.iter().zip(&mut self.last).enumerate() {
            let (lower, upper) = (servos.lower[at / 3][at % 3], servos.upper[at / 3][at % 3]);
            assert!((lower..=upper).contains(x), "coordinate {at} at {x}, not in {lower}..={upper}");
            let x = f64::from(*x);
            let (step, change) = (x - last[0], x - last[0] - last[1]);
            // Half a unit in the last place of each coordinate that a difference is made of.
            let ulp = f64::from(upper.max(-lower).max(0.5)) * f64::from(f32::EPSILON);
            let found = [(step, 1.0), (change, 2.0), (change - last[2], 4.0)];
            for ((most, (rate, ulps)), bound) in self.most.iter_mut().zip(found).zip(servos.rates(at)) {
                *most = most.max((rate.abs() - ulps * ulp) / bound);
            }
            *last = [x, step, change];
        }
    }
}

fn wild(random: &mut Random) -> f32 {
    match (random.unit() * 6.0) as u32 {
        0 => f32::NAN,
        1 => f32::INFINITY,
        2 => f32::from_bits((random.unit() * 4e9) as u32),
        _ => random.within(-4.0, 4.0),
    }
}

/// Two thousand tables, each with three hundred frames of noise, jumps, waves, gaps and broken numbers.
#[test]
fn four_bounds_hold_after_any_sequence() {
    let mut random = Random(3);
    let (mut most, mut frames) = ([0.0f64; 3], 0);
    for _ in 0..2000 {
        let servos = Servos::random(&mut random, false);
        let limits = Pipeline::new(rig(), servos.limiter(servos.table()).unwrap()).unwrap();
        let (mut state, mut out, mut watch) = (State::new(), [0.0; SERVOS], Watch::new());
        let (mut kind, mut held) = (0, [0.0; SERVOS]);
        for at in 0..300 {
            if at % 23 == 0 {
                kind = (random.unit() * 7.0) as u32;
                held = held.map(|_| random.within(-3.0, 3.0));
            }
            let speed = random.within(2.0, 2.2);
            let target = held.map(|held| match kind {
                0 => wild(&mut random),
                1 => random.within(-3.0, 3.0),
                2 => held * (at as f32 * 0.1 * speed).sin(),
                3 => held * (at as f32 * 0.03).sin(),
                4 => held + random.within(-0.01, 0.01),
                _ => held,
            });
            limits.step_coordinates(&mut state, (kind != 6).then_some(&target), &mut out);
            watch.check(&servos, &out);
            frames += 1;
        }
        most.iter_mut().zip(watch.most).for_each(|(most, found)| *most = most.max(found));
    }
    let [velocity, acceleration, jerk] = most;
    println!("{frames} frames of six coordinates: at most {velocity:.6}, {acceleration:.6}, {jerk:.6} of the bounds");
    assert!(most.iter().all(|share| *share < 1.001), "{most:?}");
}

/// A thousand states on the way to somewhere, and from each the beginning of another motion.
#[test]
fn from_any_state_to_any_motion() {
    let mut random = Random(11);
    let (mut most, mut late) = ([0.0f64; 3], 0.0f32);
    for _ in 0..1000 {
        let servos = Servos::random(&mut random, true);
        let limits = Pipeline::new(rig(), servos.limiter(servos.table()).unwrap()).unwrap();
        let (mut state, mut out, mut watch) = (State::new(), [0.0; SERVOS], Watch::new());
        let place = |random: &mut Random| [0; SERVOS].map(|_| random.within(-3.0, 3.0));
        let (from, to) = (place(&mut random), place(&mut random));
        for _ in 0..(random.unit() * 60.0) as usize {
            limits.step_coordinates(&mut state, Some(&from), &mut out);
            watch.check(&servos, &out);
        }
        let wave = random.within(0.2, 2.0);
        for at in 0..120 {
            let target = to.map(|x| x * (1.0 + (at as f32 / servos.rate * wave).sin()) * 0.5);
            limits.step_coordinates(&mut state, Some(&target), &mut out);
            watch.check(&servos, &out);
        }
        // And it comes to rest where it is told, in time.
        let told = limits.engine.recovery_frames();
        let mut arrived = 0;
        for at in 1..=told {
            limits.step_coordinates(&mut state, Some(&to), &mut out);
            watch.check(&servos, &out);
            let there = (0..SERVOS)
                .all(|at| out[at] == to[at].clamp(servos.lower[at / 3][at % 3], servos.upper[at / 3][at % 3]));
            arrived = if there { arrived } else { at };
        }
        late = late.max(arrived as f32 / told as f32);
        most.iter_mut().zip(watch.most).for_each(|(most, found)| *most = most.max(found));
    }
    let [velocity, acceleration, jerk] = most;
    println!(
        "1000 random states to 1000 random motions: at most {velocity:.6}, {acceleration:.6}, {jerk:.6} of the bounds"
    );
    println!("at rest within {late:.3} of recovery_frames");
    assert!(most.iter().all(|share| *share < 1.001) && late < 1.0, "{most:?} {late}");
}

/// No table, a table of zeros: the same bits.
#[test]
fn without_a_jerk_limit_nothing_changes() {
    let mut random = Random(17);
    let mut servos = Servos::random(&mut random, true);
    servos.jerk = [[0.0; 3]; ROWS];
    let tables = [servos.table(), LimitTable { jerk: &[], ..servos.table() }];
    let [zero, none] = tables.map(|table| Pipeline::new(rig(), servos.limiter(table).unwrap()).unwrap());
    let (mut states, mut outs) = ([State::new(), State::new()], [[0.0; SERVOS]; 2]);
    for _ in 0..500 {
        let target = [0; SERVOS].map(|_| random.within(-3.0, 3.0));
        zero.step_coordinates(&mut states[0], Some(&target), &mut outs[0]);
        none.step_coordinates(&mut states[1], Some(&target), &mut outs[1]);
        assert_eq!(outs[0].map(f32::to_bits), outs[1].map(f32::to_bits));
    }
}

#[test]
fn jerks_that_cannot_be_kept_are_refused_by_name() {
    let servos = Servos::random(&mut Random(23), true);
    let refused = |jerk: &[[f32; 3]]| servos.limiter(LimitTable { jerk, ..servos.table() }).unwrap_err();
    for wild in [f32::NAN, f32::INFINITY, -1.0, 1e-9, 1e30] {
        let mut jerk = servos.jerk;
        jerk[1][2] = wild;
        assert_eq!(refused(&jerk), LoadError::Value { tensor: "limit/jerk", index: 1 }, "{wild}");
    }
    assert_eq!(refused(&servos.jerk[..1]), LoadError::Shape { tensor: "limit/jerk", found: 1, expected: 2 });
}
