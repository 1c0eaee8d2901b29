//! Size and names of a skeleton that was just read: which unit, which layout, and what is odd about them.

use super::map::JointMap;
use super::units::{Unit, measure_leg};
use super::{Clip, ReadOptions, Skeleton, bvh};

/// A person outside of this is worth a warning, m.
const PERSON: std::ops::RangeInclusive<f64> = 0.4..=2.5;

/// The unit of length: as given, from the map, or by the length of the leg.
pub(super) fn unit(
    skeleton: &Skeleton,
    map: Option<&JointMap>,
    options: &ReadOptions,
    notes: &mut Vec<String>,
) -> Result<Unit, bvh::ParseError> {
    if let Some(unit) = options.units {
        notes.push(format!("Units: {unit}, as given."));
        return Ok(unit);
    }
    // A map that does not fit says nothing about this clip.
    let fits = options.map.as_ref().filter(|m| map.is_some_and(|found| found.layout() == m.layout));
    if let Some(unit) = fits.and_then(|m| m.units) {
        notes.push(format!("Units: {unit}, from the skeleton map."));
        return Ok(unit);
    }
    let (leg, measured) = measure_leg(skeleton, map);
    let unit = Unit::detect(leg).ok_or_else(|| bvh::ParseError::UnknownUnits(measured.clone()))?;
    let metres = unit.metres();
    notes
        .push(format!("Units: {unit} assumed (1 unit = {metres} m): {measured} makes a leg of {:.2} m.", leg * metres));
    notes.extend(unit.uncertain(leg));
    Ok(unit)
}

/// Says by which names the joints were found, unless they are known to the letter.
pub(super) fn note_names(clip: &mut Clip, map: Option<&JointMap>, options: &ReadOptions) {
    match (map, &options.map) {
        (Some(map), Some(given)) if map.layout() != given.layout => clip.notes.push(format!(
            "The skeleton map '{}' fits none of these joints: the layout {} was found by their names.",
            given.layout,
            map.layout()
        )),
        (Some(map), None) if map.is_fitted() => {
            clip.notes.push(format!("Joints: names of no exact layout, read as {} by their parts.", map.layout()));
        }
        (None, _) => clip.notes.push(
            "Joints: names of no known layout, so that neither the up axis nor left and right could be checked; --map names \
             them, and `kinesic inspect --suggest-map` makes a map to look at."
                .into(),
        ),
        _ => {}
    }
}

/// Warns of a person who is no size for a person.
pub(super) fn note_size(clip: &mut Clip, map: Option<&JointMap>) {
    let height = clip.skeleton.height(map);
    if map.is_some() && !PERSON.contains(&height) {
        clip.notes.push(format!(
            "Size: the person is about {height:.2} m tall, expected 0.4 to 2.5 m: the unit of length may be another (--units)."
        ));
    }
}
