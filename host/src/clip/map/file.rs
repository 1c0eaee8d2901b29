//! Map files: the names of the canonical joints in a foreign skeleton.

use std::path::Path;
use std::str::FromStr;

use super::suggest::nearest;
use super::{CANONICAL, Canonical, JointMap, MapError};
use crate::clip::{Skeleton, Unit, UpAxis};

/// Names of the canonical joints in one kind of skeleton, and what its files leave unsaid.
#[derive(Clone, Debug, PartialEq)]
pub struct SkeletonMap {
    /// Name of the map: the file's stem.
    pub layout: String,
    /// Joint names in the order of [`Canonical::ALL`].
    pub joints: [Option<String>; CANONICAL],
    /// Unit of length of the clips.
    pub units: Option<Unit>,
    /// Up axis of the clips.
    pub up: Option<UpAxis>,
}

impl SkeletonMap {
    /// Reads a map file. See [`SkeletonMap::parse`].
    pub fn read(path: impl AsRef<Path>) -> Result<SkeletonMap, MapError> {
        let path = path.as_ref();
        let in_file = |error| MapError::InFile { path: path.into(), error: Box::new(error) };
        let text = crate::files::read_text(path).map_err(|e| in_file(MapError::Io { error: e.to_string() }))?;
        let mut map = Self::parse(&text).map_err(in_file)?;
        map.layout = path.file_stem().map_or(map.layout, |s| s.to_string_lossy().into_owned());
        Ok(map)
    }

    /// Parses the text of a map file. Only `pelvis` must be there; every further joint makes more things possible.
    ///
    /// ```
    /// let map = kinesic_host::clip::SkeletonMap::parse(r#"
    ///     units = "cm"          # optional: m, cm, mm, inch, cmu
    ///     up = "z"              # optional: y, z
    ///     [joints]
    ///     pelvis = "Root Bone"
    ///     l_knee = "shin.L"
    ///     r_knee = "shin.R"
    /// "#)?;
    /// assert_eq!(map.joints[0].as_deref(), Some("Root Bone"));
    /// # Ok::<(), kinesic_host::clip::map::MapError>(())
    /// ```
    pub fn parse(text: &str) -> Result<SkeletonMap, MapError> {
        let table: toml::Table = text.parse().map_err(|e: toml::de::Error| MapError::Toml { error: e.to_string() })?;
        if let Some(key) = table.keys().find(|k| !["joints", "units", "up"].contains(&k.as_str())) {
            let near = nearest(key, ["joints", "units", "up"]);
            return Err(MapError::UnknownKey { key: key.clone(), near });
        }
        let Some(toml::Value::Table(entries)) = table.get("joints") else {
            return Err(MapError::NoJoints);
        };
        let mut joints: [Option<String>; CANONICAL] = Default::default();
        for (name, value) in entries {
            let Some(canonical) = Canonical::from_name(name) else {
                let near = nearest(name, Canonical::ALL.map(Canonical::name));
                return Err(MapError::UnknownCanonical { name: name.clone(), near });
            };
            joints[canonical as usize] = Some(string(name, value)?.to_owned());
        }
        if joints[Canonical::Pelvis as usize].is_none() {
            return Err(MapError::NoPelvis);
        }
        let (units, up) = (setting(&table, "units")?, setting(&table, "up")?);
        Ok(SkeletonMap { layout: "map".into(), joints, units, up })
    }

    /// Finds the joints in a skeleton; each name of the map must be there.
    pub fn resolve(&self, skeleton: &Skeleton) -> Result<JointMap, MapError> {
        let mut found = [None; CANONICAL];
        for ((slot, canonical), name) in found.iter_mut().zip(Canonical::ALL).zip(&self.joints) {
            let Some(name) = name else { continue };
            *slot = skeleton.find(name);
            if slot.is_none() {
                let near = nearest(name, skeleton.joints.iter().map(|j| j.name.as_str()));
                return Err(MapError::MissingJoint { canonical: canonical.name(), name: name.clone(), near });
            }
        }
        Ok(JointMap::new(self.layout.clone(), found, skeleton))
    }
}

fn string<'a>(key: &str, value: &'a toml::Value) -> Result<&'a str, MapError> {
    let not = || MapError::NotText { key: key.into(), found: format!("of type {}", value.type_str()) };
    value.as_str().ok_or_else(not)
}

fn setting<T: FromStr<Err = String>>(table: &toml::Table, key: &'static str) -> Result<Option<T>, MapError> {
    let Some(value) = table.get(key) else {
        return Ok(None);
    };
    string(key, value)?.parse().map(Some).map_err(|error| MapError::Value { key, error })
}
