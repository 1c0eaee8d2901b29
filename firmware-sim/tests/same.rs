//! A translator trained on recorded clips computes the same bits on every target as on the host.

use kinesic_firmware_sim::data::Data;
use kinesic_firmware_sim::same::same;

#[test]
#[ignore = "needs QEMU and a compiler for the targets: ./ci.sh firmware runs it"]
fn a_real_clip_gives_the_same_bits_on_every_target() {
    let Some(clips) = kinesic_tests::data("a_real_clip_gives_the_same_bits_on_every_target") else { return };
    let compared = same(&Data::read(None).unwrap(), &clips, &[], 1000, &|_| {}).unwrap();
    println!("{}", compared.table());
    assert_eq!(compared.failures(), Vec::<String>::new());
    assert_eq!(compared.all.len(), 2 * 6);
    for trained in &compared.trained {
        // What never changes would be the same everywhere too.
        let mut hashes = trained.prepared.hashes.clone();
        hashes.sort_unstable();
        hashes.dedup();
        assert_eq!(hashes.len(), 1000, "{}", trained.name);
        assert!(!trained.story.contains(" 0 filter states"), "{}", trained.story);
    }
    assert!(compared.all.iter().all(|one| one.frames == 1000));
}
