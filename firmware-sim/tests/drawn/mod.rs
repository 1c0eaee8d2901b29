//! Faces that nobody has.

use kinesic_host::face::{TrainOptions, synthetic, train};
use kinesic_host::pack::{PackFile, Provenance};
use kinesic_host::view::ViewFace;
use rand::SeedableRng;
use rand::rngs::ChaCha8Rng;

/// A pack trained on made faces, and two drawn ones: of 500 pixels, and of 1000, which the page makes smaller.
pub fn faces() -> (PackFile, [ViewFace; 2]) {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let trained =
        train(&synthetic::faces(600, &mut random), "smile", &TrainOptions { clusters: 3, ..TrainOptions::default() });
    let file = PackFile::from_bytes(&trained.unwrap().model.pack(&Provenance::default()));
    let faces = [("a face", 2, 0.3), ("another", 4, 0.8)].map(|(name, size, strength)| {
        let landmarks = synthetic::landmarks(strength, 0.2, &mut random).map(|point| point.map(|x| size as f32 * x));
        ViewFace { name: name.to_owned(), picture: synthetic::draw(&landmarks, 250 * size).into(), landmarks }
    });
    (file, faces)
}
