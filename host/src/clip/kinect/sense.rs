//! What the numbers of a table mean: untracked joints, unit of length, axes.

use nalgebra::Vector3;

use super::table::Table;
use super::{JOINTS, KinectFault, KinectOptions, Skeleton20};
use crate::clip::bvh::spikes::{self, Leap};
use crate::clip::{Unit, UpAxis};

/// Joints at 0, 0, 0 are in the lens: what recorders write for a joint that they do not see. Refuses a joint that was never seen.
pub(super) fn untracked(table: &mut Table, notes: &mut Vec<String>) -> Result<(), KinectFault> {
    let mut rows = vec![false; table.rows.len()];
    let origin = origin(&table.rows);
    for joint in (0..JOINTS.len()).filter(|joint| origin != Some(*joint)) {
        for (row, touched) in table.rows.iter_mut().zip(&mut rows) {
            if row[joint] == Vector3::zeros() {
                row[joint] = Vector3::repeat(f64::NAN);
                *touched = true;
            }
        }
    }
    let count = rows.into_iter().filter(|t| *t).count();
    if count > 0 {
        notes.push(format!("Joints at exactly 0, 0, 0 in {count} row(s) are taken as not tracked."));
    }
    for (joint, (name, _)) in JOINTS.iter().enumerate() {
        if (0..3).any(|axis| table.rows.iter().all(|row| !row[joint][axis].is_finite())) {
            return Err(KinectFault::NeverTracked { joint: name });
        }
    }
    Ok(())
}

/// The joint that is the origin of the coordinates: always there, and within a body's reach of its neighbour, as a joint that was never
/// tracked is not.
fn origin(rows: &[Skeleton20]) -> Option<usize> {
    let is_zero = |joint: usize| rows.iter().all(|row| row[joint] == Vector3::zeros());
    let bone = |a: usize, b: usize| {
        let mut lengths: Vec<f64> = rows.iter().map(|row| (row[a] - row[b]).norm()).filter(|x| x.is_finite()).collect();
        lengths.sort_by(f64::total_cmp);
        lengths.get(lengths.len() / 2).copied().unwrap_or(0.0)
    };
    let sound = JOINTS.iter().enumerate().filter_map(|(joint, (_, parent))| Some((joint, (*parent)?)));
    let longest = sound.filter(|(a, b)| !is_zero(*a) && !is_zero(*b)).map(|(a, b)| bone(a, b)).fold(0.0, f64::max);
    let near = |joint: &usize| bone(*joint, JOINTS[*joint].1.unwrap_or(1)) <= 2.0 * longest;
    (0..JOINTS.len()).filter(|joint| is_zero(*joint)).find(near)
}

/// Names joints that leap faster than anybody moves, and back, m; with `repair`, lays straight lines over them.
pub(super) fn leaps(frames: &mut [Skeleton20], options: &KinectOptions, notes: &mut Vec<String>) {
    let second = (options.max_gap * options.fps).ceil().clamp(2.0, 1e6) as usize;
    let leap = Leap { second, ..Leap::of(1.0 / options.fps, frames.len()) };
    let mut found: Vec<(usize, Vec<usize>)> = Vec::new();
    for joint in 0..JOINTS.len() {
        let path: Vec<Vector3<f64>> = frames.iter().map(|f| f[joint]).collect();
        let lost = spikes::leaps(&path, &leap);
        let good = |f: &usize| lost.binary_search(f).is_err();
        for &frame in lost.iter().filter(|_| options.repair) {
            let (before, after) = ((0..frame).rev().find(good), (frame + 1..path.len()).find(good));
            let (Some(a), Some(b)) = (before.or(after), after.or(before)) else { continue };
            let part = if b > a { (frame - a) as f64 / (b - a) as f64 } else { 0.0 };
            frames[frame][joint] = path[a].lerp(&path[b], part);
        }
        if !lost.is_empty() {
            found.push((joint, lost));
        }
    }
    let Some((joint, lost)) = found.iter().rev().max_by_key(|(_, lost)| lost.len()) else { return };
    let done =
        if options.repair { "bridged by straight lines, as given" } else { "left as they are; --repair bridges them" };
    notes.push(format!(
        "{} '{}' leaps faster than anybody moves, and back ({} joint(s) do so): lost frames? They are {done}.",
        spikes::in_frames(lost),
        JOINTS[*joint].0,
        found.len()
    ));
}

/// Scales to metres: as given, or by the length of the legs.
pub(super) fn units(
    frames: &mut [Skeleton20],
    given: Option<Unit>,
    notes: &mut Vec<String>,
) -> Result<(), KinectFault> {
    let mut legs: Vec<f64> = frames
        .iter()
        .map(|f| {
            ((f[12] - f[13]).norm() + (f[13] - f[14]).norm()) / 2.0
                + ((f[16] - f[17]).norm() + (f[17] - f[18]).norm()) / 2.0
        })
        .collect();
    legs.sort_by(f64::total_cmp);
    let leg = legs.get(legs.len() / 2).copied().unwrap_or(0.0);
    let unit = match given {
        Some(unit) => {
            notes.push(format!("Units: {unit}, as given."));
            unit
        }
        // Small children, and legs that the sensor sees short.
        None => match leg {
            l if (0.15..2.0).contains(&l) => Unit::Metre,
            l if (2.0..4.4).contains(&l) => Unit::Foot,
            l if (4.4..15.0).contains(&l) => Unit::Decimetre,
            l if (15.0..150.0).contains(&l) => Unit::Centimetre,
            l if (150.0..2000.0).contains(&l) => Unit::Millimetre,
            // A body without legs is no body: the fit says so.
            l if l < 1e-4 => Unit::Metre,
            _ => return Err(KinectFault::UnknownUnits { leg }),
        },
    };
    if given.is_none() && unit != Unit::Metre {
        notes.push(format!("Units: {unit} assumed: a leg (hip to ankle) of {leg:.1} units."));
        notes.extend(unit.uncertain(leg));
    }
    frames.iter_mut().flatten().for_each(|p| *p *= unit.metres());
    Ok(())
}

/// Turns the frames to the sensor's axes with Y up: as given, or where the body stands on its head.
pub(super) fn axes(frames: &mut [Skeleton20], options: &KinectOptions, notes: &mut Vec<String>) {
    if let Some(up) = options.up {
        frames.iter_mut().flatten().for_each(|p| *p = up.turn(*p));
        if up != UpAxis::Y {
            notes.push(format!("Up axis {up}, as given: turned to Y up."));
        }
    } else {
        let upward = |f: &Skeleton20| (f[3] - (f[14] + f[18]) / 2.0).try_normalize(1e-9).unwrap_or_default();
        let mean = frames.iter().map(upward).sum::<Vector3<f64>>() / frames.len().max(1) as f64;
        if let Some(up) =
            UpAxis::ALL.into_iter().find(|up| mean.dot(&up.direction()) > 0.8).filter(|up| *up != UpAxis::Y)
        {
            turn_found(frames, up, 100.0 * mean.dot(&up.direction()), notes);
        } else if mean.y < 0.6 {
            notes.push(
                "Y up assumed, though the body does not stand along it: somebody lies or bends, or --up is needed."
                    .into(),
            );
        }
    }
    if options.left_handed {
        frames.iter_mut().flatten().for_each(|p| p.x = -p.x);
        notes.push("Left-handed axes, as given: X was turned round.".into());
    }
}

/// A turn where that keeps left and right, else the axis alone turned round: the file is of the other hand.
fn turn_found(frames: &mut [Skeleton20], up: UpAxis, percent: f64, notes: &mut Vec<String>) {
    let before = frames.to_vec();
    // The sensor of Azure has X and Y turned round together.
    let turn = |p: Vector3<f64>| if up == UpAxis::NegY { Vector3::new(-p.x, -p.y, p.z) } else { up.turn(p) };
    frames.iter_mut().flatten().for_each(|p| *p = turn(*p));
    let mut how = "turned to Y up";
    if against(frames) > 80 && up == UpAxis::NegY {
        frames.copy_from_slice(&before);
        frames.iter_mut().flatten().for_each(|p| p.y = -p.y);
        how = "Y was turned round, since left and right would be exchanged otherwise";
    }
    notes.push(format!(
        "{} up found (from ankles to head, the body points {percent:.0} % along {up}): {how}.",
        up.to_string().to_uppercase()
    ));
}

/// Frames in per cent in which the toes point against the direction in which left and right say the person faces.
pub(super) fn against(frames: &[Skeleton20]) -> usize {
    let facing = |f: &Skeleton20| {
        let left = (f[12] - f[16]) + (f[4] - f[8]);
        let forward = left.cross(&Vector3::y());
        let toes = (f[15] - f[14]) + (f[19] - f[18]);
        forward.dot(&toes)
    };
    100 * frames.iter().filter(|f| facing(f) < 0.0).count() / frames.len().max(1)
}
