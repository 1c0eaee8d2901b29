//! Reading glTF 2.0: the joints of the first skin, or all animated nodes, moved by the first animation.
//!
//! A node has a rotation of its own at rest. A clip rests with all rotations at identity, so a joint's rotation here is what turns it from
//! the file's rest pose, in axes of the world: `G(t) = W(t) W(rest)^-1`.

use std::collections::HashMap;
use std::path::Path;

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use gltf::animation::Interpolation;
use gltf::animation::util::ReadOutputs;
use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use crate::clip::bvh::orient;
use crate::clip::{Clip, Joint, JointMap, ReadError, ReadOptions, Skeleton, measure};

/// Most frames that are made of keys.
const MOST: f64 = 1e6;

/// Reads a file of text or of the binary kind.
pub(in crate::clip) fn read(bytes: &[u8], path: &Path, options: &ReadOptions) -> Result<Clip, ReadError> {
    let refuse = |fault: String| ReadError::Gltf { path: path.into(), fault };
    let map_error = |error| ReadError::Map { path: path.into(), error };
    let mut clip = parse(bytes, path.parent()).map_err(refuse)?;
    if let Some(unit) = options.units {
        let factor = unit.metres();
        clip.root.iter_mut().for_each(|p| *p *= factor);
        clip.skeleton.joints.iter_mut().for_each(|j| j.offset *= factor);
        clip.notes.push(format!("Units: {unit}, as given."));
    }
    let map = JointMap::choose(&clip.skeleton, options.map.as_ref()).map_err(map_error)?;
    measure::note_names(&mut clip, map.as_ref(), options);
    orient::turn(&mut clip, map.as_ref(), options);
    orient::note_floor(&mut clip);
    measure::note_size(&mut clip, map.as_ref());
    clip.make_signs_continuous();
    Ok(clip)
}

/// Parses the bytes; `folder` holds the buffers that a text file names.
pub fn parse(bytes: &[u8], folder: Option<&Path>) -> Result<Clip, String> {
    let file = gltf::Gltf::from_slice(bytes).map_err(|e| format!("this is no glTF 2.0: {e}. Export it again"))?;
    let mut blob = file.blob.clone();
    let buffers = file.buffers().map(|b| buffer(&b, &mut blob, folder)).collect::<Result<Vec<_>, _>>()?;
    let mut notes = Vec::new();
    let animation = file.animations().next().ok_or("the file has no animation. Export it with its animation")?;
    if file.animations().count() > 1 {
        let names: Vec<&str> = file.animations().map(|a| a.name().unwrap_or("(no name)")).collect();
        notes.push(format!("The file has {} animations ({}): the first is read.", names.len(), names.join(", ")));
    }
    let tracks = tracks(&animation, &buffers)?;
    let nodes = Nodes::new(&file, &tracks)?;
    let (times, end) = tracks.times();
    if end <= 0.0 {
        return Err("the animation has keys at one time only, expected a motion".into());
    }
    let fps = rate(&times, &mut notes);
    if end * fps > MOST {
        return Err(format!(
            "the animation lasts {end:.0} s at {fps:.0} frames per second, at most {MOST} frames are read"
        ));
    }
    let count = 1 + (end * fps + 1e-3).floor() as usize;
    let rest = nodes.worlds(None);
    let joints: Vec<Joint> = nodes.joints.iter().map(|j| nodes.joint(j, &rest)).collect();
    let mut clip = Clip {
        skeleton: Skeleton { joints },
        frame_time: 1.0 / fps,
        root: Vec::with_capacity(count),
        rotations: Vec::with_capacity(count * nodes.joints.len()),
        coordinates: None,
        notes,
    };
    for frame in 0..count {
        let worlds = nodes.worlds(Some((&tracks, frame as f64 / fps)));
        let turned: Vec<UnitQuaternion<f64>> =
            nodes.joints.iter().map(|j| worlds[j.node].rotation * rest[j.node].rotation.inverse()).collect();
        clip.root.push(worlds[nodes.joints[0].node].place);
        let local = nodes.joints.iter().zip(&turned).map(|(j, t)| j.parent.map_or(*t, |p| turned[p].inverse() * t));
        clip.rotations.extend(local);
    }
    let finite = clip.root.iter().all(|p| p.iter().all(|x| x.is_finite()))
        && clip.rotations.iter().all(|r| r.coords.iter().all(|x| x.is_finite()))
        && clip.skeleton.joints.iter().all(|j| j.offset.iter().all(|x| x.is_finite()));
    if finite {
        Ok(clip)
    } else {
        Err("the motion holds numbers that are not finite. Repair or export it again".into())
    }
}

fn buffer(buffer: &gltf::Buffer, blob: &mut Option<Vec<u8>>, folder: Option<&Path>) -> Result<Vec<u8>, String> {
    let bytes = match buffer.source() {
        gltf::buffer::Source::Bin => blob.take().ok_or("the binary chunk is missing. Export it again")?,
        gltf::buffer::Source::Uri(uri) => match uri.split_once(";base64,") {
            Some((_, text)) => BASE64_STANDARD.decode(text).map_err(|e| format!("its base64 is broken: {e}"))?,
            None => {
                let inside = Path::new(uri).components().all(|c| matches!(c, std::path::Component::Normal(_)));
                let folder = folder.filter(|_| inside).ok_or(format!("the buffer '{uri}' is not beside the file"))?;
                std::fs::read(folder.join(uri)).map_err(|e| format!("the buffer '{uri}' cannot be read: {e}"))?
            }
        },
    };
    match bytes.len() < buffer.length() {
        true => Err(format!("a buffer has {} bytes, expected {}. The file is cut off", bytes.len(), buffer.length())),
        false => Ok(bytes),
    }
}

/// Keys of one property of one node: times in s, values of 3 or 4 numbers.
struct Track {
    times: Vec<f32>,
    values: Vec<[f32; 4]>,
    kind: Interpolation,
}

impl Track {
    /// Values before and after a time, and how far it is between them.
    fn at(&self, time: f64) -> ([f32; 4], [f32; 4], f32) {
        let after = self.times.partition_point(|t| f64::from(*t) <= time).min(self.times.len() - 1);
        let before = after.saturating_sub(1);
        // A cubic key is tangent, value, tangent; between frames a straight line does.
        let value = |key: usize| match self.kind {
            Interpolation::CubicSpline => self.values.get(3 * key + 1),
            _ => self.values.get(key),
        };
        let (a, b) = (value(before).copied().unwrap_or_default(), value(after).copied().unwrap_or_default());
        let span = f64::from(self.times[after]) - f64::from(self.times[before]);
        let part = if span > 0.0 { ((time - f64::from(self.times[before])) / span).clamp(0.0, 1.0) } else { 1.0 };
        let part = if matches!(self.kind, Interpolation::Step) { part.floor() } else { part };
        (a, b, part as f32)
    }
}

#[derive(Default)]
struct Tracks {
    places: HashMap<usize, Track>,
    turns: HashMap<usize, Track>,
}

impl Tracks {
    /// All times of the longest track, and the last time of any.
    fn times(&self) -> (Vec<f32>, f64) {
        let all = || self.places.values().chain(self.turns.values());
        let longest = all().max_by_key(|t| t.times.len()).map(|t| t.times.clone()).unwrap_or_default();
        let end = all().filter_map(|t| t.times.last()).fold(0.0, |a: f64, b| a.max(f64::from(*b)));
        (longest, end)
    }
}

fn tracks(animation: &gltf::Animation, buffers: &[Vec<u8>]) -> Result<Tracks, String> {
    let mut tracks = Tracks::default();
    for channel in animation.channels() {
        let reader = channel.reader(|b| buffers.get(b.index()).map(Vec::as_slice));
        let (Some(times), Some(values)) = (reader.read_inputs(), reader.read_outputs()) else {
            return Err("a channel of the animation has no keys. Export it again".into());
        };
        let times: Vec<f32> = times.collect();
        let (values, rotation): (Vec<[f32; 4]>, bool) = match values {
            ReadOutputs::Translations(all) => (all.map(|[x, y, z]| [x, y, z, 0.0]).collect(), false),
            ReadOutputs::Rotations(all) => (all.into_f32().collect(), true),
            _ => continue,
        };
        let kind = channel.sampler().interpolation();
        let each = if matches!(kind, Interpolation::CubicSpline) { 3 } else { 1 };
        if times.is_empty()
            || values.len() != each * times.len()
            || times.windows(2).any(|w| w[0].partial_cmp(&w[1]) != Some(std::cmp::Ordering::Less))
        {
            return Err("the keys of a channel are not in order of time, or not one value each. Export it again".into());
        }
        let of = if rotation { &mut tracks.turns } else { &mut tracks.places };
        of.insert(channel.target().node().index(), Track { times, values, kind });
    }
    Ok(tracks)
}

/// The rate of the keys where they are even, else 30.
fn rate(times: &[f32], notes: &mut Vec<String>) -> f64 {
    let mut steps: Vec<f64> = times.windows(2).map(|w| f64::from(w[1]) - f64::from(w[0])).collect();
    steps.sort_by(f64::total_cmp);
    let step = steps.get(steps.len() / 2).copied().unwrap_or(1.0 / 30.0);
    let even = steps.iter().filter(|s| (*s / step - 1.0).abs() < 0.05).count() * 10 >= steps.len() * 9;
    let fps = 1.0 / step;
    let fps = if (fps - fps.round()).abs() < 2e-3 * fps { fps.round() } else { fps };
    if even && (1.0..=1000.0).contains(&fps) {
        return fps;
    }
    notes.push("The keys are not evenly spaced: sampled at 30 frames per second.".into());
    30.0
}

/// Place, rotation and scale of a node in the world.
#[derive(Clone)]
struct World {
    place: Vector3<f64>,
    rotation: UnitQuaternion<f64>,
    scale: Vector3<f64>,
}

struct Bone {
    node: usize,
    name: String,
    parent: Option<usize>,
}

/// The scene's nodes, parents first, and which of them are joints.
struct Nodes {
    order: Vec<(usize, Option<usize>)>,
    local: Vec<World>,
    joints: Vec<Bone>,
}

impl Nodes {
    fn new(file: &gltf::Gltf, tracks: &Tracks) -> Result<Self, String> {
        let mut parent: Vec<Option<usize>> = vec![None; file.nodes().count()];
        for node in file.nodes() {
            for child in node.children() {
                if parent[child.index()].replace(node.index()).is_some() {
                    return Err(format!("node {} has two parents, expected a tree", child.index()));
                }
            }
        }
        let mut open: Vec<usize> = (0..parent.len()).rev().filter(|&n| parent[n].is_none()).collect();
        let mut order = Vec::new();
        let children: Vec<Vec<usize>> = file.nodes().map(|n| n.children().map(|c| c.index()).collect()).collect();
        while let Some(node) = open.pop() {
            order.push((node, parent[node]));
            open.extend(children[node].iter().rev());
        }
        let mut chosen = vec![false; parent.len()];
        match file.skins().max_by_key(|s| s.joints().count()) {
            Some(skin) => skin.joints().for_each(|j| chosen[j.index()] = true),
            None => tracks.turns.keys().for_each(|&n| chosen[n] = true),
        }
        let names: Vec<String> =
            file.nodes().map(|n| n.name().map_or_else(|| format!("node{}", n.index()), str::to_owned)).collect();
        let mut joints: Vec<Bone> = Vec::new();
        let mut index: HashMap<usize, usize> = HashMap::new();
        for &(node, _) in order.iter().filter(|(n, _)| chosen[*n]) {
            let above = std::iter::successors(parent[node], |&p| parent[p]).find_map(|p| index.get(&p).copied());
            if above.is_none() && !joints.is_empty() {
                continue; // A second tree beside the body.
            }
            index.insert(node, joints.len());
            let twice = joints.iter().any(|j| j.name == names[node]);
            let name = if twice { format!("{}_{node}", names[node]) } else { names[node].clone() };
            joints.push(Bone { node, name, parent: above });
        }
        if joints.is_empty() {
            return Err("the file has neither a skin nor rotating nodes, expected a skeleton in motion".into());
        }
        let local = file.nodes().map(|node| {
            let (t, r, s) = node.transform().decomposed();
            World { place: Vector3::from(t).cast(), rotation: turn(r), scale: Vector3::from(s).cast() }
        });
        let local = local.collect();
        Ok(Self { order, local, joints })
    }

    /// Every node in the world: at rest, or at a time.
    fn worlds(&self, at: Option<(&Tracks, f64)>) -> Vec<World> {
        let mut worlds = self.local.clone();
        for &(node, parent) in &self.order {
            let mut own = self.local[node].clone();
            if let Some((tracks, time)) = at {
                if let Some(track) = tracks.places.get(&node) {
                    let (a, b, part) = track.at(time);
                    own.place = Vector3::from_fn(|i, _| f64::from(a[i] + (b[i] - a[i]) * part));
                }
                if let Some(track) = tracks.turns.get(&node) {
                    let (a, b, part) = track.at(time);
                    let (a, b) = (turn(a), turn(b));
                    own.rotation = a.try_slerp(&b, f64::from(part), 1e-12).unwrap_or(a);
                }
            }
            worlds[node] = match parent.map(|p| worlds[p].clone()) {
                Some(p) => World {
                    place: p.place + p.rotation * p.scale.component_mul(&own.place),
                    rotation: p.rotation * own.rotation,
                    scale: p.scale.component_mul(&own.scale),
                },
                None => own,
            };
        }
        worlds
    }

    fn joint(&self, bone: &Bone, rest: &[World]) -> Joint {
        let above = bone.parent.map(|p| rest[self.joints[p].node].place);
        let offset = above.map_or(Vector3::zeros(), |above| rest[bone.node].place - above);
        Joint { name: bone.name.clone(), parent: bone.parent, offset, end: None }
    }
}

fn turn([x, y, z, w]: [f32; 4]) -> UnitQuaternion<f64> {
    UnitQuaternion::try_new(Quaternion::new(w, x, y, z).cast(), 1e-9).unwrap_or_default()
}
