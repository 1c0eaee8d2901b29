//! What files that know their unit go through once they are read: names, axes, floor and size are looked at as with BVH.

use std::path::Path;

use super::bvh::{orient, spikes};
use super::{Clip, JointMap, ReadError, ReadOptions, measure};

/// A clip in metres, as the file says, turned to Y up where its body says so.
pub(super) fn in_metres(mut clip: Clip, path: &Path, options: &ReadOptions) -> Result<Clip, ReadError> {
    let map_error = |error| ReadError::Map { path: path.into(), error };
    if let Some(unit) = options.units {
        let factor = unit.metres();
        clip.root.iter_mut().for_each(|p| *p *= factor);
        clip.skeleton.joints.iter_mut().for_each(|j| j.offset *= factor);
        clip.notes.push(format!("Units: {unit}, as given."));
    }
    spikes::mend(&mut clip, options.repair);
    let map = JointMap::choose(&clip.skeleton, options.map.as_ref()).map_err(map_error)?;
    measure::note_names(&mut clip, map.as_ref(), options);
    orient::turn(&mut clip, map.as_ref(), options);
    orient::note_floor(&mut clip);
    measure::note_size(&mut clip, map.as_ref());
    clip.make_signs_continuous();
    Ok(clip)
}
