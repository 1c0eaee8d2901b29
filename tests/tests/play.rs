//! Moves in layers: from anywhere to anything without a jump, and behind a limiter within all limits.

#[path = "common/servos_limits.rs"]
mod limits;

use kinesic::limit::SmoothLimitState;
use kinesic::play::{Mode, Move, Player};
use kinesic::{Pipeline, PipelineState};
use limits::{ROWS, Random, SERVOS, Servos, Watch, rig};

type Frames = Vec<[f32; SERVOS]>;

/// Sums of waves: a move such as hands record, at 50 frames a second times `fine`.
fn recorded(random: &mut Random, frames: usize, fine: usize) -> Frames {
    let waves = [0; SERVOS]
        .map(|_| [0; 3].map(|_| [random.within(0.05, 0.4), random.within(0.01, 0.1), random.within(0.0, 6.3)]));
    let at = |time: f32| waves.map(|waves| waves.iter().map(|[a, w, p]| a * (w * time + p).sin()).sum());
    (0..frames * fine).map(|frame| at(frame as f32 / fine as f32)).collect()
}

/// Whatever may be called between two frames.
fn anything<'a>(random: &mut Random, player: &mut Player<'a, SERVOS, 3>, moves: &'a [Frames], fine: usize) {
    let motion = Move::new(&moves[(random.unit() * moves.len() as f32) as usize % moves.len()]).unwrap();
    let frames = random.within(20.0, 60.0) as u16 * fine as u16;
    let layer = (random.unit() * 3.0) as usize % 3;
    let target = [0; SERVOS].map(|_| random.within(-1.0, 1.0));
    let (strength, weight) = (random.within(0.0, 1.5), random.unit());
    let own = &mut player.layers[layer];
    match (random.unit() * 9.0) as u32 {
        0 => own.play(motion, frames),
        1 => own.play(motion.looped(), frames),
        2 => own.gesture(motion, frames),
        3 => own.follow(&target, frames),
        4 => own.strength(strength, frames),
        5 => own.weight(weight, frames),
        6 => own.mask(target.map(f32::abs), frames),
        7 if layer > 0 => own.leave(frames),
        _ => player.rest(frames),
    }
}

/// The largest first to third differences of what comes out in 40,000 frames of a fiftieth of a second, with 4,000 calls.
fn roughest(fine: usize) -> [f32; 3] {
    let mut random = Random(5);
    let moves: Vec<Frames> = (0..8).map(|_| recorded(&mut random, 90, fine)).collect();
    let mut player = Player::<SERVOS, 3>::new([0.0; SERVOS]);
    player.layers[2].mode = Mode::Add;
    player.start([0.5; SERVOS], 40 * fine as u16);
    let (mut past, mut most) = ([[0.5; SERVOS]; 3], [0.0f32; 3]);
    for frame in 0..40_000 * fine {
        if frame % (10 * fine) == 0 {
            anything(&mut random, &mut player, &moves, fine);
        }
        let out = *player.step();
        for (at, x) in out.iter().enumerate() {
            let [y, z, w] = past.map(|past| past[at]);
            let found = [x - y, x - 2.0 * y + z, x - 3.0 * y + 3.0 * z - w];
            most.iter_mut().zip(found).for_each(|(most, found)| *most = most.max(found.abs()));
        }
        past = [out, past[0], past[1]];
    }
    most
}

/// At four times the frame rate, where position, velocity and acceleration have no jump, the differences are a fourth, a sixteenth and a
/// 64th. A jump of the acceleration would make the last one a sixteenth, of the velocity a fourth, and one of the position leave all as they are.
#[test]
fn nothing_jumps_whatever_is_called_between_two_frames() {
    let ([v, a, j], [v4, a4, j4]) = (roughest(1), roughest(4));
    println!(
        "at most {v:.4} rad, {a:.4} rad, {j:.4} rad a frame; finer: {:.2}, {:.2}, {:.2} times less",
        v / v4,
        a / a4,
        j / j4
    );
    assert!(v / v4 > 3.5 && a / a4 > 12.0 && j / j4 > 32.0, "{v} {v4} {a} {a4} {j} {j4}");
}

/// A thousand random states, each the beginning of a random move, behind random limits: all four hold.
#[test]
fn from_a_thousand_states_to_a_thousand_moves_within_all_limits() {
    let mut random = Random(29);
    let mut most = [0.0f64; 3];
    for _ in 0..1000 {
        let servos = Servos::random(&mut random, true);
        let limits = Pipeline::new(rig(), servos.limiter(servos.table()).unwrap()).unwrap();
        let mut state = PipelineState::<SmoothLimitState<ROWS>, ROWS>::new();
        let moves = [recorded(&mut random, 60, 1), recorded(&mut random, 120, 1)];
        let mut player = Player::<SERVOS, 2>::new([0.0; SERVOS]);
        let (mut out, mut watch) = ([0.0; SERVOS], Watch::new());
        player.layers[0].play(Move::new(&moves[0]).unwrap().looped(), 30);
        let change = 10 + (random.unit() * 60.0) as usize;
        for frame in 0..change + 120 {
            if frame == change {
                player.layers[0].play(Move::new(&moves[1]).unwrap(), 30);
            }
            limits.step_coordinates(&mut state, Some(player.step()), &mut out);
            watch.check(&servos, &out);
        }
        most.iter_mut().zip(watch.most).for_each(|(most, found)| *most = most.max(found));
    }
    let [velocity, acceleration, jerk] = most;
    println!("1000 changes: at most {velocity:.6}, {acceleration:.6}, {jerk:.6} of the bounds");
    assert!(most.iter().all(|share| *share < 1.0 + 2e-5), "{most:?}");
}

#[test]
fn layers_join_as_they_say_and_a_gesture_leaves_nothing_behind() {
    let idle: Frames = (0..50).map(|at| [0.1 * (at as f32 * 0.1257).sin(); SERVOS]).collect();
    let nod: Frames = (0..60).map(|at| [0.4 * (at as f32 * 0.0532).sin(); SERVOS]).collect();
    let mut player = Player::<SERVOS, 3>::new([0.0; SERVOS]);
    player.start([0.0; SERVOS], 10);
    player.layers[0].play(Move::new(&idle).unwrap().looped(), 10);
    // The gesture moves the first coordinate alone, the gaze the second, on top.
    let only = |one: usize| core::array::from_fn(|at| f32::from(u8::from(at == one)));
    player.layers[1].mask(only(0), 0);
    player.layers[2].mask(only(1), 0);
    player.layers[2].mode = Mode::Add;
    let base = |player: &Player<SERVOS, 3>| player.shown()[2];
    for _ in 0..60 {
        player.step();
    }
    assert_eq!(*player.shown(), [base(&player); SERVOS]);
    player.layers[1].gesture(Move::new(&nod).unwrap(), 12);
    player.layers[2].follow(&[0.3; SERVOS], 12);
    for (frame, [nod, ..]) in nod.iter().enumerate() {
        let out = *player.step();
        if (12..45).contains(&frame) {
            assert!((out[0] - nod).abs() < 1e-6, "{frame}: {out:?}");
        }
        assert_eq!(out[3..], [out[2]; 3]);
    }
    assert!((player.shown()[1] - base(&player) - 0.3).abs() < 1e-3, "{:?}", player.shown());
    player.step();
    assert!(player.layers[1].is_over() && player.shown()[0] == base(&player), "{:?}", player.shown());
    // Half the idling, then rest.
    player.layers[2].leave(12);
    player.layers[0].strength(0.5, 12);
    for _ in 0..40 {
        player.step();
    }
    assert!((0..50).map(|_| player.step()[4].abs()).fold(0.0, f32::max) < 0.052);
    player.rest(20);
    for _ in 0..21 {
        player.step();
    }
    assert_eq!(*player.step(), [0.0; SERVOS]);
}

#[test]
fn numbers_that_are_none_are_ignored_and_moves_of_them_refused() {
    let still = [[0.0; SERVOS]; 2];
    assert!(Move::<SERVOS>::new(&[]).is_none());
    for wild in [f32::NAN, f32::INFINITY, -f32::INFINITY, 3e38] {
        let mut frames = still;
        frames[1][5] = wild;
        assert!(Move::new(&frames).is_none(), "{wild}");
        let mut player = Player::<SERVOS, 2>::new([0.1; SERVOS]);
        player.start([wild; SERVOS], 10);
        player.layers[1].follow(&[wild; SERVOS], 10);
        player.layers[1].weight(wild, 10);
        player.layers[1].strength(wild, 10);
        player.layers[1].mask([wild; SERVOS], 10);
        for _ in 0..30 {
            let out = *player.step();
            assert!(out.iter().all(|x| (x - 0.1).abs() < 1e-6), "{wild}: {out:?}");
        }
    }
}

/// What a review found: loops shorter than their blend grew without bound, and weights left their range.
#[test]
fn short_loops_and_changes_in_mid_change_stay_in_their_range() {
    for count in [1usize, 2, 3, 5, 10, 40, 100] {
        for frames in [0u16, 1, 10, 25, 50, 100, 1000, u16::MAX] {
            let turn = 2.0 * core::f32::consts::PI / count as f32;
            // Ends that meet, and ends that do not.
            for slope in [0.0, 0.3] {
                let wave: Frames = (0..count)
                    .map(|at| [0.3 * (at as f32 * turn).sin() + slope * at as f32 / count as f32; SERVOS])
                    .collect();
                let mut player = Player::<SERVOS, 1>::new([0.0; SERVOS]);
                player.start([1.0; SERVOS], 50);
                player.layers[0].play(Move::new(&wave).unwrap().looped(), frames);
                let most = (0..20_000).map(|_| player.step()[0].abs()).fold(0.0, f32::max);
                assert!(most < 1.4, "{count} frames, blend of {frames}, {slope}: {most}");
                if slope == 0.0 && count > 8 {
                    let worst = (0..count).map(|at| (player.step()[0] - wave[(20_000 + at) % count][0]).abs());
                    assert!(worst.fold(0.0, f32::max) < 1e-5, "{count} frames, blend of {frames}");
                }
            }
        }
    }
    let one = [[1.0; SERVOS]];
    let mut random = Random(41);
    for _ in 0..2_000 {
        let mut player = Player::<SERVOS, 2>::new([0.0; SERVOS]);
        let layer = &mut player.layers[1];
        layer.play(Move::new(&one).unwrap(), 10);
        let mut most = 0.0f32;
        for _ in 0..6 {
            let frames = random.log(1.0, 65_535.0) as u16;
            let layer = &mut player.layers[1];
            match (random.unit() * 3.0) as u32 {
                0 => layer.leave(frames),
                1 => layer.weight(random.unit(), frames),
                _ => layer.mask([random.unit(); SERVOS], frames),
            }
            for _ in 0..(random.unit() * 30.0) as usize {
                let shown = player.step()[0];
                most = most.max((shown - 0.5).abs());
            }
        }
        assert!(most < 0.502, "{most}");
    }
}

/// A target that stands is reached and held, however slowly.
#[test]
fn a_slow_search_comes_to_its_target_and_stays() {
    for frames in [10u16, 200, 1000, 5000] {
        let mut player = Player::<SERVOS, 1>::new([0.0; SERVOS]);
        player.start([0.0; SERVOS], 50);
        player.layers[0].follow(&[3.0; SERVOS], frames);
        let nine_tenths = (0..).take_while(|_| player.step()[0] < 2.7).count();
        assert!((nine_tenths as f32 / f32::from(frames) - 1.0).abs() < 0.3, "{frames}: {nine_tenths}");
        for _ in 0..8 * u32::from(frames) {
            player.step();
        }
        let worst = (0..20_000).map(|_| (player.step()[0] - 3.0).abs()).fold(0.0, f32::max);
        assert!(worst < 1e-4, "{frames}: {worst}");
    }
}
