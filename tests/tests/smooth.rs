//! Jerk limits: position, velocity, acceleration and jerk within their bounds after any input, checked in double precision.

#[path = "common/servos_limits.rs"]
mod limits;

use kinesic::limit::{LimitState, LimitTable, Limiter, SmoothLimitState};
use kinesic::model::LimitsMeta;
use kinesic::{LoadError, Pipeline, PipelineState};
use limits::{ROWS, Random, SERVOS, Servos, Watch, rig};

type State = PipelineState<SmoothLimitState<ROWS>, ROWS>;

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

/// Where nothing has a jerk limit, the limiter without them gives the same bits; where something has one, it refuses.
#[test]
fn the_plain_limiter_gives_the_same_bits_and_refuses_jerk_limits() {
    let mut random = Random(19);
    let servos = Servos::random(&mut random, true);
    let table = LimitTable { jerk: &[], ..servos.table() };
    let plain = |table| Limiter::<ROWS>::new(rig(), table, LimitsMeta::default(), servos.rate);
    assert_eq!(plain(servos.table()).unwrap_err(), LoadError::Jerk);
    let plain = Pipeline::new(rig(), plain(table).unwrap()).unwrap();
    let smooth = Pipeline::new(rig(), servos.limiter(table).unwrap()).unwrap();
    let (mut state, mut other) = (PipelineState::<LimitState<ROWS>, ROWS>::new(), State::new());
    let mut outs = [[0.0; SERVOS]; 2];
    for _ in 0..500 {
        let target = [0; SERVOS].map(|_| random.within(-3.0, 3.0));
        plain.step_coordinates(&mut state, Some(&target), &mut outs[0]);
        smooth.step_coordinates(&mut other, Some(&target), &mut outs[1]);
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

/// What a review found: plans longer than can be counted, a root of a difference that is nothing, places far from 0.
#[test]
fn odd_limits_that_are_taken_are_kept_and_targets_reached() {
    let all = |x: f32| [[x; 3]; ROWS];
    let servos = |rate, [lower, upper]: [f32; 2], [velocity, acceleration, jerk]: [f32; 3]| Servos {
        lower: all(lower),
        upper: all(upper),
        velocity: all(velocity),
        acceleration: all(acceleration),
        jerk: all(jerk),
        rest: all(upper),
        rate,
    };
    let cases = [
        (
            servos(100.0, [-3.0, 3.0], [23.025_936, 37_390.395, 2.650_313_4]),
            vec![-0.016_266_666, 0.007_276_304, 0.070_628_91],
        ),
        (servos(50.0, [-3.0, 3.0], [0.2, 60.0, 1e11]), vec![1.5]),
        (
            servos(1.0, [-100.0, -99.719_574], [0.011_889_854, 3.947_124_6e-4, 5.432_376_6e-4]),
            vec![-100.0, -99.8, -99.72],
        ),
        (servos(50.0, [-0.118_085, -0.118_084], [1.0, 20.0, 400.0]), vec![-0.118_085, -0.118_084]),
    ];
    for (servos, targets) in cases {
        let limits = Pipeline::new(rig(), servos.limiter(servos.table()).unwrap()).unwrap();
        let (mut state, mut out, mut watch) = (State::new(), [0.0; SERVOS], Watch::new());
        let here = [servos.upper[0][0].min(0.0); SERVOS];
        limits.start_coordinates(&mut state, &here);
        watch.last = here.map(|x| [f64::from(x), 0.0, 0.0]);
        for frame in 0..600 {
            let target = targets[frame % targets.len()];
            limits.step_coordinates(&mut state, Some(&[target; SERVOS]), &mut out);
            watch.check(&servos, &out);
        }
        let target = *targets.last().unwrap();
        for _ in 0..limits.engine.recovery_frames() {
            limits.step_coordinates(&mut state, Some(&[target; SERVOS]), &mut out);
            watch.check(&servos, &out);
        }
        assert!(watch.most.iter().all(|share| *share < 1.001), "{:?} {servos:?}", watch.most);
        assert_eq!(out, [target; SERVOS], "{servos:?}");
    }
    // A jerk that is lost in the product with the frame time is no missing one.
    let lost = servos(100.0, [-1.0, 1.0], [1.0, 10.0, 1e-41]);
    assert_eq!(lost.limiter(lost.table()).unwrap_err(), LoadError::Value { tensor: "limit/jerk", index: 0 });
}
