//! Reading glTF 2.0: the joints of the first skin, or all animated nodes, moved by the first animation.
//!
//! A node has a rotation of its own at rest. A clip rests with all rotations at identity, so a joint's rotation here is what turns it from
//! the file's rest pose, in axes of the world: `G(t) = W(t) W(rest)^-1`.

use std::collections::HashSet;
use std::path::Path;

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use super::tracks::{Tracks, rate, tracks};
use crate::clip::bvh::MAX_JOINTS;
use crate::clip::{Clip, Joint, ReadError, ReadOptions, Skeleton, settle};
use crate::files;
use crate::quietly::quietly;

/// Most frames that are made of keys.
const MOST: f64 = 1e6;
/// Bytes that a moving node takes a frame while it is read.
const NODE: f64 = 32.0;

/// Reads a file of text or of the binary kind; the path is for messages, and its folder holds the buffers that a text file names.
pub fn read(bytes: &[u8], path: &Path, options: &ReadOptions) -> Result<Clip, ReadError> {
    let refuse = |fault: String| ReadError::Gltf { path: path.into(), fault };
    let clip = parse(bytes, path.parent()).map_err(refuse)?;
    settle::in_metres(clip, path, options)
}

/// Parses the bytes; `folder` holds the buffers that a text file names.
pub fn parse(bytes: &[u8], folder: Option<&Path>) -> Result<Clip, String> {
    // The crate takes the header's length for at least its own.
    if bytes.starts_with(b"glTF") && !bytes.get(8..12).is_some_and(|l| l.iter().rev().ge(&[0, 0, 0, 12])) {
        return Err("its header is broken. Export it again".into());
    }
    let file = quietly(|| gltf::Gltf::from_slice(bytes)).ok_or("its indices lead nowhere. Export it again")?;
    let file = file.map_err(|e| format!("this is no glTF 2.0: {e}. Export it again"))?;
    let mut blob = file.blob.clone();
    let buffers = file.buffers().map(|b| buffer(&b, &mut blob, folder)).collect::<Result<Vec<_>, _>>()?;
    let mut notes = Vec::new();
    let animation = file.animations().next().ok_or("the file has no animation. Export it with its animation")?;
    if file.animations().count() > 1 {
        let names: Vec<&str> = file.animations().map(|a| a.name().unwrap_or("(no name)")).collect();
        notes.push(format!("The file has {} animations ({}): the first is read.", names.len(), names.join(", ")));
    }
    let size = bytes.len() + buffers.iter().map(Vec::len).sum::<usize>();
    // What is read is at most 20 times the file, and 200 MB: keys are rows of four numbers, frames have every node.
    let allowed = 20.0 * size as f64 + 2e8;
    let tracks = tracks(&file, &animation, &buffers, (allowed / 16.0) as usize)?;
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
    let needed = count as f64 * nodes.order.len() as f64 * NODE;
    if needed > allowed {
        return Err(format!(
            "{count} frames of {} nodes take {:.0} MB of memory, at most {:.0} MB are taken (20 times the file, and 200 MB)",
            nodes.order.len(),
            needed / 1e6,
            allowed / 1e6
        ));
    }
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
                files::read(&folder.join(uri)).map_err(|e| format!("the buffer '{uri}' cannot be read: {e}"))?
            }
        },
    };
    match bytes.len() < buffer.length() {
        true => Err(format!("a buffer has {} bytes, expected {}. The file is cut off", bytes.len(), buffer.length())),
        false => Ok(bytes),
    }
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
        let mut taken: HashSet<&str> = HashSet::new();
        // The nearest joint at or above each node.
        let mut nearest: Vec<Option<usize>> = vec![None; parent.len()];
        for &(node, _) in &order {
            let above = parent[node].and_then(|p| nearest[p]);
            nearest[node] = above;
            // A second tree beside the body is left out.
            if !chosen[node] || (above.is_none() && !joints.is_empty()) {
                continue;
            }
            if joints.len() >= MAX_JOINTS {
                return Err(format!("it has more than {MAX_JOINTS} joints, at most that many are read"));
            }
            nearest[node] = Some(joints.len());
            let name = &names[node];
            let name = if taken.insert(name) { name.clone() } else { format!("{name}_{node}") };
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
