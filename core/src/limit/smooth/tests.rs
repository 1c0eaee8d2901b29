//! Random limits and hostile targets, checked in double precision.

extern crate std;
use super::*;

const BOUNDS: Bounds = Bounds { lower: -1.0, upper: 0.8, speed: 0.05, change: 0.004, jerk: 0.0005 };

fn run(bounds: &Bounds, at: f32, frames: usize, mut target: impl FnMut(usize) -> f32) -> std::vec::Vec<f32> {
    let mut smooth = Smooth::standing(at);
    (0..frames)
        .map(|frame| {
            smooth.advance(target(frame), bounds);
            smooth.at()
        })
        .collect()
}

struct Random(u64);

impl Random {
    fn unit(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / (1u64 << 24) as f32
    }

    fn log(&mut self, low: f32, high: f32) -> f32 {
        libm::expf(libm::logf(low) + self.unit() * (libm::logf(high) - libm::logf(low)))
    }

    fn bounds(&mut self) -> Bounds {
        let (lower, range, speed) = (-3.0 * self.unit(), self.log(0.05, 6.0), self.log(0.002, 0.2));
        let change = speed * self.log(0.02, 1.5);
        Bounds { lower, upper: lower + range, speed, change, jerk: change * self.log(0.05, 1.5) }
    }
}

/// Largest velocity, acceleration and jerk as a share of their bounds, less the rounding of `x`.
fn shares(way: &[f32], at: f32, bounds: &Bounds) -> [f64; 3] {
    let mut last = [f64::from(at), 0.0, 0.0];
    let mut most = [0.0f64; 3];
    let ulp = f64::from(bounds.upper.max(-bounds.lower).max(0.5)) * 1.2e-7;
    for x in way {
        assert!((bounds.lower..=bounds.upper).contains(x), "{x} {bounds:?}");
        let x = f64::from(*x);
        let step = x - last[0];
        let change = step - last[1];
        let rates = [(step, bounds.speed), (change, bounds.change), (change - last[2], bounds.jerk)];
        for ((most, (rate, bound)), ulps) in most.iter_mut().zip(rates).zip([1.0, 2.0, 4.0]) {
            *most = most.max((rate.abs() - ulps * ulp) / f64::from(bound));
        }
        last = [x, step, change];
    }
    most
}

/// A thousand random limits, each with a hostile sequence of targets.
#[test]
fn all_four_bounds_hold_whatever_comes() {
    let mut random = Random(5);
    let mut worst = [0.0f64; 3];
    for set in 0..1200 {
        let bounds = random.bounds();
        let at = bounds.lower + (bounds.upper - bounds.lower) * random.unit();
        let mut held = 0.0;
        let mut target = |frame: usize| {
            let any = random.unit();
            if frame.is_multiple_of(40) {
                held = any;
            }
            let share = match set % 6 {
                0 => any,
                1 => held,
                2 => 0.5 + 0.6 * libm::sinf(frame as f32 * 0.2),
                3 => (frame / 17 % 2) as f32,
                4 => (frame as f32 * 0.013 + if frame % 90 < 3 { any } else { 0.0 }) % 1.0,
                _ => held + 0.01 * any,
            };
            within(bounds.lower + (bounds.upper - bounds.lower) * share, bounds.lower, bounds.upper)
        };
        let way = run(&bounds, at, 600, &mut target);
        for (worst, found) in worst.iter_mut().zip(shares(&way, at, &bounds)) {
            *worst = worst.max(found);
        }
    }
    assert!(worst.iter().all(|share| *share < 1.001), "{worst:?}");
}

#[test]
fn a_jump_is_caught_up_with_in_the_shortest_time_without_overshoot() {
    let mut random = Random(9);
    for _ in 0..1000 {
        let bounds = random.bounds();
        let [at, to] = [random.unit(), random.unit()].map(|x| bounds.lower + (bounds.upper - bounds.lower) * x);
        // A jump that is no jump is followed at once, as any motion within the limits.
        if (to - at).abs() <= bounds.jerk {
            continue;
        }
        let way = run(&bounds, at, 3000, |_| to);
        let over = way.iter().fold(0.0f32, |most, x| most.max((x - to) * (to - at).signum()));
        let arrived = way.iter().rposition(|x| *x != to).map_or(0, |last| last + 1) as f32;
        let ideal = ideal((to - at).abs(), &bounds);
        assert!(over <= 1e-6 && arrived <= 1.02 * ideal + 2.0, "{over:e} {arrived} {ideal} {bounds:?} {at} {to}");
    }
}

#[test]
fn motion_within_the_limits_passes_and_a_moving_target_is_caught_up_with() {
    let wave = |frame: usize| 0.5 * libm::sinf(frame as f32 * 0.05);
    // At rest at 0, while the target moves at half the speed already.
    let way = run(&BOUNDS, 0.0, 400, wave);
    let late = way.iter().enumerate().rposition(|(frame, x)| (x - wave(frame)).abs() > 1e-6).unwrap();
    assert!(late < 40, "{late}");
    let ease = |frame: usize| 0.15 * (1.0 - libm::cosf(frame as f32 * 0.05));
    let way = run(&BOUNDS, 0.0, 400, ease);
    let late = way.iter().enumerate().rposition(|(frame, x)| (x - ease(frame)).abs() > 1e-6);
    assert_eq!(late, None);
}

/// Frames of the fastest way from rest to rest in smooth time.
fn ideal(way: f32, bounds: &Bounds) -> f32 {
    let Bounds { speed, change, jerk, .. } = *bounds;
    // Time to a speed and back, half each.
    let time = |v: f32| if v < change * change / jerk { 2.0 * sqrt(v / jerk) } else { v / change + change / jerk };
    let (mut low, mut high) = (0.0, speed);
    if time(speed) * speed <= way {
        return way / speed + time(speed);
    }
    for _ in 0..40 {
        let v = 0.5 * (low + high);
        if time(v) * v < way { low = v } else { high = v }
    }
    2.0 * time(low)
}
