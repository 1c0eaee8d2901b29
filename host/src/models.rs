//! The packs that come with the program, as in the folder `models/`.

use crate::pack::PackFile;

/// Body mechanics of the CMU skeleton: `models/mechanics.kin`, see the card beside it.
pub fn mechanics() -> PackFile {
    PackFile::from_bytes(include_bytes!("../../models/mechanics.kin"))
}

/// A style of walking, from the program's own gait: `models/weary.kin`.
pub fn weary() -> PackFile {
    PackFile::from_bytes(include_bytes!("../../models/weary.kin"))
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_packs_load() {
        let file = super::mechanics();
        let pack = file.pack().unwrap();
        assert!(pack.metadata().models.iter().any(|model| model.mechanics().is_some()));
        let file = super::weary();
        let pack = file.pack().unwrap();
        assert!(pack.metadata().models.iter().any(|model| model.translator().is_some()));
    }
}
