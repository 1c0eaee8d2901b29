//! The factorisation and the gradients, on a made walk.

mod components_common;

use components_common::{rig, walk};
use kinesic_host::components::{
    Descent, Motion, Objective, Optimiser, Sparsity, TrainError, TrainOptions, Weights, choose, descend, gather, learn,
    noise, pca, prune, refit, sparse, train, train_kept,
};
use kinesic_host::step_cache::{StepCache, Unreadable};

fn motion() -> Motion {
    let rig = rig();
    let poses = rig.poses(&walk(&rig, 150, 1.0, 0.1));
    let rig = rig.centred(&[&poses]);
    Motion::new(&rig, &rig.locals(&poses))
}

/// A walk, and one in another manner in its deviations, on a rig that is centred on both.
fn pair() -> [Motion; 2] {
    let rig = rig();
    let [content, style] = [walk(&rig, 150, 1.0, 0.1), walk(&rig, 130, 1.6, 0.5)].map(|clip| rig.poses(&clip));
    let rig = rig.centred(&[&content, &style]);
    let content = Motion::new(&rig, &rig.locals(&content));
    let style = Motion::scaled(&rig, &rig.locals(&style), content.deviation);
    [content, style]
}

#[test]
fn coordinates_count_by_their_levers_and_travel_not_at_all() {
    let rig = rig();
    let poses = rig.poses(&walk(&rig, 150, 1.0, 0.1));
    let rig = rig.centred(&[&poses]);
    let (locals, levers) = (rig.locals(&poses), rig.levers());
    let motion = Motion::new(&rig, &locals);
    let squares = motion.values.squared_norm_l2() / (motion.frames() * motion.channels()) as f64;
    assert!((squares - 1.0).abs() < 1e-9, "{squares}");
    for (c, lever) in levers.iter().enumerate() {
        let travel = c == 0 || c == 2;
        for f in 0..motion.frames() {
            let found = motion.values[(f, c)];
            let coordinate = locals.coordinates[f * motion.channels() + c];
            assert!(travel || (found * motion.deviation / lever + motion.mean[c] - coordinate).abs() < 1e-12);
            assert!(!travel || (found == 0.0 && motion.mean[c] == 0.0));
        }
    }
    // A turn of the spine moves more than one of the head: as many metres for the same angle.
    let row = |joint: usize| rig.frames().places().nth(joint).unwrap().1;
    assert!(motion.scale[row(8)] > motion.scale[row(7)]);
}

#[test]
fn no_sweep_raises_the_objective() {
    let motion = motion();
    let m = motion.values.as_ref();
    for penalty in [0.0, 0.003, 0.03, 0.3, 3.0] {
        for start in [pca(m, 12), gather(m, 12)] {
            let descent = Descent { tolerance: 0.0, max_sweeps: 40 };
            let (factors, history) = descend(m, start, penalty, &descent);
            for (sweep, pair) in history.windows(2).enumerate() {
                assert!(pair[1] <= pair[0] * (1.0 + 1e-12) + 1e-9, "sweep {sweep} at {penalty}: {pair:?}");
            }
            let last = history.last().expect("a start");
            let direct = factors.objective(m, penalty);
            assert!((direct - last).abs() <= 1e-8 * direct.max(1e-3), "{direct} {last}");
            for k in 0..factors.count() {
                let mean_square = factors.weights.col(k).squared_norm_l2() / motion.frames() as f64;
                // The weakest principal component has a ten-millionth of the strongest one's energy: its weights are less exact.
                assert!(mean_square <= 1.0 + 1e-8, "weights {k} are out of bounds: {mean_square}");
            }
        }
    }
}

#[test]
fn a_larger_penalty_moves_fewer_joints() {
    let motion = motion();
    let m = motion.values.as_ref();
    let density = |penalty| descend(m, gather(m, 12), penalty, &Descent::default()).0.density();
    let densities = [0.003, 0.03, 0.3, 100.0].map(density);
    assert!(densities.windows(2).all(|d| d[1] <= d[0]), "{densities:?}");
    assert_eq!(densities[3], 0.0);
}

#[test]
fn the_refit_keeps_the_support_and_lowers_the_error() {
    let motion = motion();
    let m = motion.values.as_ref();
    let (factors, _) = descend(m, gather(m, 10), 0.1, &Descent::default());
    let refitted = refit(m, &factors);
    assert!(refitted.error(m) < factors.error(m), "{} {}", refitted.error(m), factors.error(m));
    assert!(refitted.density() <= factors.density());
    let pruned = prune(m, &refitted, 0.1);
    assert!((pruned.density() - 0.1).abs() < 0.01, "{}", pruned.density());
}

#[test]
fn principal_components_are_the_best_without_sparsity() {
    let motion = motion();
    let m = motion.values.as_ref();
    let (full, few) = (pca(m, m.ncols()).error(m), pca(m, 6).error(m));
    assert!(full < 1e-7, "{full}");
    let sparse = sparse(m, 6, &Sparsity::default()).factors;
    assert!(sparse.error(m) >= few, "{} {few}", sparse.error(m));
    assert!(sparse.density() <= 0.16);
    // No worse than the strongest groups of the principal components, refitted alike.
    let thinned = prune(m, &pca(m, 6), sparse.density());
    assert!(sparse.error(m) <= 1.02 * refit(m, &thinned).error(m), "{}", sparse.error(m));
}

#[test]
fn gradients_agree_with_finite_differences() {
    let [content, style] = pair();
    let [own, other] = [&content, &style].map(|m| sparse(m.values.as_ref(), 8, &Sparsity::default()).factors);
    let none = Weights { content: 0.0, style: 0.0, smooth: 0.0 };
    let terms = [
        ("content", Weights { content: 1.0, ..none }),
        ("style", Weights { style: 0.3, ..none }),
        ("smooth", Weights { smooth: 0.7, ..none }),
        ("all", Weights { content: 1.0, style: 0.01, smooth: 1.0 }),
    ];
    for (name, weights) in terms {
        let objective = Objective::new(&own, &other, weights);
        let at = noise(content.channels(), 8, 3);
        let mut gradient = at.clone();
        objective.evaluate(&at, &mut gradient);
        let largest = gradient.norm_max();
        for (row, column) in (0..content.channels()).flat_map(|r| (0..8).map(move |k| (r, k))).step_by(7) {
            let h = 1e-5;
            let value = |shift: f64| {
                let mut moved = at.clone();
                moved[(row, column)] += shift;
                objective.evaluate(&moved, &mut moved.clone()).0
            };
            let difference = (value(h) - value(-h)) / (2.0 * h);
            let found = gradient[(row, column)];
            assert!((difference - found).abs() < 1e-5 * largest, "{name} [{row}, {column}]: {difference} {found}");
        }
    }
}

#[test]
fn learning_reaches_the_threshold_and_the_same_place_from_the_same_seed() {
    let [content, style] = pair();
    let [own, other] = [&content, &style].map(|m| sparse(m.values.as_ref(), 8, &Sparsity::default()).factors);
    let objective = Objective::new(&own, &other, Weights::default());
    let run = |seed| learn(&objective, noise(content.channels(), 8, seed), &Optimiser::default());
    let (a, b, c) = (run(1), run(1), run(2));
    assert_eq!(a.components, b.components);
    assert_ne!(a.components, c.components);
    assert!(a.history.len() < Optimiser::default().max_steps, "the threshold was not reached");
    let lowest = a.history.iter().copied().fold(f64::INFINITY, f64::min);
    assert!(lowest < 0.05 * a.history[0], "{} {lowest}", a.history[0]);
    // Another start ends about as low.
    let other = c.history.iter().copied().fold(f64::INFINITY, f64::min);
    assert!((other / lowest - 1.0).abs() < 0.05, "{lowest} {other}");
}

#[test]
fn the_number_of_components_is_chosen_with_a_reason() {
    let (choice, sparse) = choose(&motion(), &Sparsity::default());
    assert_eq!(choice.count, sparse.factors.count());
    assert!((5..=30).contains(&choice.count), "{choice:?}");
    assert!(choice.reason.contains("would gain"), "{}", choice.reason);
    assert!(choice.tried.windows(2).all(|t| t[0].0 < t[1].0), "{:?}", choice.tried);
}

#[test]
fn impossible_requests_are_refused_with_what_to_do() {
    let rig = rig();
    let (content, style) = (walk(&rig, 60, 1.0, 0.1), walk(&rig, 60, 1.5, 0.3));
    let run = |options: TrainOptions, content| train(&rig, content, &style, "x", &options).map(|_| ()).unwrap_err();
    let count = |count| TrainOptions { count: Some(count), ..TrainOptions::default() };
    assert_eq!(run(count(0), &content), TrainError::Count { found: 0, most: 42 });
    assert_eq!(run(count(43), &content), TrainError::Count { found: 43, most: 42 });
    let negative = TrainOptions { weights: Weights { style: -1.0, ..Weights::default() }, ..TrainOptions::default() };
    assert_eq!(run(negative, &content).to_string(), "the style weight is -1: expected a finite number from 0 up");
    let mut still = content.clone();
    (1..60).for_each(|f| still.rotations.copy_within(0..13, 13 * f));
    let first = still.root[0];
    still.root.fill(first);
    assert_eq!(run(count(5), &still), TrainError::Still { which: "content" });
}

/// A checkpoint of anything.
struct Kept(std::collections::BTreeMap<String, Vec<f64>>);

impl kinesic_host::checkpoint::Keep for Kept {
    fn earlier(&mut self) -> Option<Vec<u8>> {
        Some(postcard::to_allocvec(&self.0).unwrap())
    }
}

#[test]
fn steps_of_a_checkpoint_that_are_none_of_this_training_are_refused() {
    let rig = rig();
    let (content, style) = (walk(&rig, 60, 1.0, 0.1), walk(&rig, 60, 1.5, 0.3));
    let options = TrainOptions { count: Some(5), ..TrainOptions::default() };
    let whole = |columns: f64| [vec![columns], vec![0.1; 5 * (60 + 39)]].concat();
    for (name, result) in [
        ("content 5", vec![]),
        ("content 5", whole(1e9)),
        ("content 5", whole(f64::NAN)),
        ("content 5", whole(6.0)),
        ("content 5", whole(0.0)),
        ("content 5", whole(4.5)),
        ("content 5", vec![5.0; 20]),
        ("style 5", [whole(5.0), vec![f64::INFINITY]].concat()),
        ("learn", vec![0.0; 3]),
        ("learn", vec![0.0; 100]),
        ("learn", vec![f64::NAN; 1000]),
    ] {
        let mut kept = Kept([(name.to_owned(), result)].into());
        let cache = StepCache::new(&mut kept).unwrap();
        let refused = train_kept(&rig, &content, &style, "x", &options, &cache).map(drop);
        assert_eq!(refused, Err(TrainError::Checkpoint(Unreadable)), "{name}");
    }
}
