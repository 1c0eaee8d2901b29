//! Packs: load, then step.

use kinesic::Pack;
use kinesic::model::{HEADER_LEN, checksum};
use kinesic_host::pack::PackFile;
use kinesic_host::rig::Rig;

use super::engines;
use super::frames::Frames;

/// Loads the bytes as a pack, as they are and with the checksum mended (else nothing behind it would ever be reached), and
/// steps every engine that takes it for 100 frames.
pub fn pack(data: &[u8]) {
    let mut file = PackFile::from_bytes(data);
    hold(&file, data);
    if mend(file.bytes_mut()) {
        hold(&file, data);
    }
}

/// Writes the right checksum; false if there is no room for it, or it was right already.
fn mend(bytes: &mut [u8]) -> bool {
    let Some((header, body)) = bytes.split_first_chunk_mut::<HEADER_LEN>() else { return false };
    let (fields, stored) = header.split_at_mut(16);
    let sum = checksum(&std::array::from_fn(|at| fields[at]), body).to_le_bytes();
    let wrong = stored != sum;
    stored.copy_from_slice(&sum);
    wrong
}

fn hold(file: &PackFile, seed: &[u8]) {
    let Ok(pack) = file.pack() else { return };
    let _ = file.provenance();
    host(&pack);
    engines::step_all(&pack, &mut Frames::new(seed));
}

/// What the host does with a pack's skeleton: tables, and a clip on it.
fn host(pack: &Pack) {
    let Ok(rig) = Rig::from_pack(pack) else { return };
    let poses = vec![kinesic::Pose::identity(); 2];
    let locals = rig.locals(&poses);
    assert_eq!(locals.frames(), 2);
    let clip = rig.clip(&poses, 1.0 / 60.0);
    let _ = clip.summary();
    let _ = clip.to_bvh(&kinesic_host::clip::WriteOptions::default());
}
