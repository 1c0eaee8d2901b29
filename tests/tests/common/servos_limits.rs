//! Limits of six servos with jerk, random ones, and a watch over what comes out.

use kinesic::limit::{LimitTable, SmoothLimiter};
use kinesic::model::LimitsMeta;
use kinesic::rig::JointKind;
use kinesic::{LoadError, Rig};

pub const ROWS: usize = 2;
pub const SERVOS: usize = 6;

pub struct Random(pub u64);

impl Random {
    pub fn unit(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / (1u64 << 24) as f32
    }

    pub fn within(&mut self, low: f32, high: f32) -> f32 {
        low + self.unit() * (high - low)
    }

    pub fn log(&mut self, low: f32, high: f32) -> f32 {
        self.within(low.ln(), high.ln()).exp()
    }
}

/// Limits of six servos.
#[derive(Clone, Debug)]
pub struct Servos {
    pub lower: [[f32; 3]; ROWS],
    pub upper: [[f32; 3]; ROWS],
    pub velocity: [[f32; 3]; ROWS],
    pub acceleration: [[f32; 3]; ROWS],
    pub jerk: [[f32; 3]; ROWS],
    pub rest: [[f32; 3]; ROWS],
    pub rate: f32,
}

impl Servos {
    /// Such as servos have: 0.5 to 12 rad/s, full speed in 30 ms to 1 s, full acceleration in 10 ms to 0.3 s. Some have no jerk limit.
    pub fn random(random: &mut Random, all: bool) -> Self {
        let zero = [[0.0; 3]; ROWS];
        let rate = [30.0, 50.0, 60.0, 100.0, 200.0][(random.unit() * 5.0) as usize % 5];
        let mut servos =
            Self { lower: zero, upper: zero, velocity: zero, acceleration: zero, jerk: zero, rest: zero, rate };
        for at in 0..SERVOS {
            let (row, own) = (at / 3, at % 3);
            let velocity = random.log(0.5, 12.0);
            let acceleration = velocity / random.log(0.03, 1.0);
            // Less a frame cannot be told apart in single precision, and is refused.
            let jerk = (acceleration / random.log(0.01, 0.3)).max(1.2e-6 * rate * rate * rate);
            let lower = -random.log(0.05, 3.0);
            (servos.lower[row][own], servos.upper[row][own]) = (lower, random.log(0.05, 3.0));
            (servos.velocity[row][own], servos.acceleration[row][own]) = (velocity, acceleration);
            servos.jerk[row][own] = if all || at != 4 { jerk } else { 0.0 };
        }
        servos
    }

    pub fn table(&self) -> LimitTable<'_> {
        LimitTable {
            lower: &self.lower,
            upper: &self.upper,
            velocity: &self.velocity,
            acceleration: &self.acceleration,
            jerk: &self.jerk,
            rest: &self.rest,
        }
    }

    pub fn limiter<'a>(&self, table: LimitTable<'a>) -> Result<SmoothLimiter<'a, ROWS>, LoadError> {
        SmoothLimiter::new(rig(), table, LimitsMeta::default(), self.rate)
    }

    /// Bounds of a coordinate per frame.
    pub fn rates(&self, at: usize) -> [f64; 3] {
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

pub fn rig() -> Rig<'static> {
    Rig::new(&KINDS, &AXES, &REFERENCE, &MIDDLE, None).unwrap()
}

/// The last coordinates, steps and changes of steps, and the largest rates as shares of their bounds, less the rounding of a coordinate.
pub struct Watch {
    pub last: [[f64; 3]; SERVOS],
    pub most: [f64; 3],
}

impl Watch {
    pub fn new() -> Self {
        Self { last: [[0.0; 3]; SERVOS], most: [0.0; 3] }
    }

    pub fn check(&mut self, servos: &Servos, out: &[f32; SERVOS]) {
        for (at, (x, last)) in out.iter().zip(&mut self.last).enumerate() {
            let (lower, upper) = (servos.lower[at / 3][at % 3], servos.upper[at / 3][at % 3]);
            assert!((lower..=upper).contains(x), "coordinate {at} at {x}, not in {lower}..={upper}");
            let x = f64::from(*x);
            let (step, change) = (x - last[0], x - last[0] - last[1]);
            // Half a unit in the last place of each coordinate that a difference is made of.
            let ulp = f64::from(upper.max(-lower)) * f64::from(f32::EPSILON);
            let found = [(step, 1.0), (change, 2.0), (change - last[2], 4.0)];
            for ((most, (rate, ulps)), bound) in self.most.iter_mut().zip(found).zip(servos.rates(at)) {
                *most = most.max((rate.abs() - ulps * ulp) / bound);
            }
            *last = [x, step, change];
        }
    }
}
