//! Real clips (`KINESIC_DATA`): what the documentation claims, on a part of the clips.

mod real;

use kinesic_host::clip::ReadOptions;
use kinesic_host::components::{FRAME_RATE, Motion, Sparsity, TrainOptions, choose, pca, prune, refit, sparse, train};
use kinesic_host::prepare::Source;

const PAIRS: [[&str; 2]; 3] = [
    ["bandai1/guide_normal_001.bvh", "bandai1/guide_angry_001.bvh"],
    ["bandai1/bow_normal_001.bvh", "bandai1/bow_active_001.bvh"],
    ["xia/neutral_01_000.bvh", "xia/old_01_000.bvh"],
];

#[test]
fn sparse_components_at_equal_density() {
    let Some(folder) = real::data("components_real") else { return };
    for [name, _] in PAIRS {
        let source = Source::read(&folder.join(name), &ReadOptions::default()).expect("reads");
        let rig = source.rig().expect("a rig");
        let poses = rig.poses(&source.on_rig(&rig, FRAME_RATE).expect("fits"));
        let rig = rig.centred(&[&poses]);
        let motion = Motion::new(&rig, &rig.locals(&poses));
        let m = motion.values.as_ref();
        for density in [0.08, 0.15, 0.3] {
            let found = sparse(m, 30, &Sparsity { density: Some(density), ..Sparsity::default() });
            assert!(found.history.windows(2).all(|h| h[1] <= h[0] * (1.0 + 1e-12)), "{name}: the objective rose");
            let baseline = refit(m, &prune(m, &pca(m, 30), density));
            let (ours, theirs) = (found.factors.error(m), baseline.error(m));
            println!("{name} at density {density}: sparse {ours:.4}, pruned PCA {theirs:.4}");
            assert!(ours <= theirs, "{name} at {density}: {ours} against {theirs}");
        }
        let (choice, _) = choose(&motion, &Sparsity::default());
        assert!((10..=45).contains(&choice.count), "{name}: {choice:?}");
    }
}

#[test]
fn real_pairs_come_nearer_to_the_style_heads_and_hands_too() {
    let Some(folder) = real::data("components_real") else { return };
    for names in PAIRS {
        let [content, style] =
            names.map(|name| Source::read(&folder.join(name), &ReadOptions::default()).expect("reads"));
        let rig = content.rig().expect("a rig");
        let [a, b] = [&content, &style].map(|clip| clip.on_rig(&rig, FRAME_RATE).expect("fits"));
        let rig = rig.centred(&[&rig.poses(&a), &rig.poses(&b)]);
        let options = TrainOptions { count: Some(30), ..TrainOptions::default() };
        let trained = train(&rig, &a, &b, "style", &options).expect("trains");
        let (before, after) = (&trained.degrees_before, &trained.degrees_after);
        println!("{names:?}: {before:?} before, {after:?} after");
        assert!(after.all < before.all && after.leaves < before.leaves, "{names:?}: {before:?}, {after:?}");
    }
}
