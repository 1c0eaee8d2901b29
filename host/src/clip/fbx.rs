//! Reading FBX: its bones, moved by its first animation. The crate `fbx-rs` knows the format and evaluates the animation's curves; it is
//! pure Rust without unsafe code, and bounds what it allocates.
//!
//! A bone rests as the bind pose has it, or else as the file has it without the animation. A clip rests with all rotations at identity, so
//! a joint's rotation here is what turns it from there, in axes of the world: `G(t) = W(t) W(rest)^-1`, as with glTF.

use std::collections::HashSet;
use std::path::Path;

use fbx_rs::{Limits, LoadOptions, Matrix, Scene};
use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};
use rayon::prelude::*;

use super::bvh::MAX_JOINTS;
use super::{Clip, Joint, ReadError, ReadOptions, Skeleton, settle};

/// Most frames that are made of curves.
const MOST: f64 = 1e6;
/// Bytes that are allowed beside 20 times the file.
const SPARE: usize = 200_000_000;
/// Bytes that a node takes in an evaluated frame, and a joint in a clip.
const NODE: f64 = 64.0;

/// Reads a file, binary or text; the path is for messages.
pub fn read(bytes: &[u8], path: &Path, options: &ReadOptions) -> Result<Clip, ReadError> {
    let clip = parse(bytes).map_err(|fault| ReadError::Fbx { path: path.into(), fault })?;
    settle::in_metres(clip, path, options)
}

/// Parses the bytes.
pub fn parse(bytes: &[u8]) -> Result<Clip, String> {
    let allowed = bytes.len().saturating_mul(20).saturating_add(SPARE);
    let limits = Limits {
        max_allocation: allowed,
        max_decompressed_bytes: allowed,
        max_animation_work: allowed,
        ..Limits::default()
    };
    let refuse = |error| format!("it is no FBX that can be read: {error}. Export it again as FBX 2014 or later");
    let scene = fbx_rs::load_with_limits(bytes, &LoadOptions::default(), &limits).map_err(refuse)?;
    let stacks = scene.animation_stacks();
    let at = scene.default_animation_stack().unwrap_or(0);
    let stack = stacks.get(at).ok_or("the file has no animation. Export it with its animation")?;
    let mut notes = Vec::new();
    if stacks.len() > 1 {
        notes.push(format!("The file has {} animations: '{}' is read.", stacks.len(), stack.name));
    }
    let mut fps = scene.settings().frames_per_second();
    if !(1.0..=1000.0).contains(&fps) {
        fps = 30.0;
        notes.push("The file has no plausible frame rate: sampled at 30 frames per second.".into());
    }
    let (mut begin, mut length) = (stack.time_begin, stack.time_end - stack.time_begin);
    if length == 0.0 {
        // Exporters leave out a start or an end that is 0.
        let keys = || scene.animation_curves().iter().flat_map(|curve| &curve.keys).map(|key| key.time);
        begin = keys().fold(f64::INFINITY, f64::min);
        length = keys().fold(f64::NEG_INFINITY, f64::max) - begin;
        notes.push("The animation says no start or no end: it is read from its first key to its last.".into());
    }
    if !(length.is_finite() && length > 0.0) {
        return Err("the animation has no length, expected a motion".into());
    }
    let count = 1.0 + (length * fps + 1e-3).floor();
    let nodes = scene.nodes().len();
    if count > MOST || count * nodes as f64 * NODE > allowed as f64 {
        return Err(format!(
            "{count} frames of {nodes} nodes are more than are read of a file of {} bytes: at most {MOST} frames, and 20 times the file \
             and 200 MB of memory",
            bytes.len()
        ));
    }
    let bones = bones(&scene)?;
    // World transforms are in metres, whatever the file's unit is.
    let rest: Vec<World> = bones.iter().map(|bone| World::new(&rest(&scene, bone.node))).collect();
    let frames = (0..count as usize).into_par_iter().map(|frame| {
        let pose = scene.evaluate(Some(at), begin + frame as f64 / fps).map_err(|error| error.to_string())?;
        let world = |bone: &Bone| pose.nodes.get(bone.node).map(|node| World::new(&node.node_to_world));
        let worlds = bones.iter().map(world).collect::<Option<Vec<World>>>().ok_or("a bone is lost")?;
        let turned: Vec<_> = worlds.iter().zip(&rest).map(|(w, rest)| w.rotation * rest.rotation.inverse()).collect();
        let local = bones.iter().zip(&turned).map(|(b, turn)| b.parent.map_or(*turn, |p| turned[p].inverse() * turn));
        Ok((worlds.first().map_or(Vector3::zeros(), |w| w.place), local.collect::<Vec<_>>()))
    });
    let frames = frames.collect::<Result<Vec<_>, String>>()?;
    let joints = bones.iter().zip(&rest).map(|(bone, own)| {
        let offset = bone.parent.map_or(Vector3::zeros(), |p| own.place - rest[p].place);
        Joint { name: bone.name.clone(), parent: bone.parent, offset, end: None }
    });
    let skeleton = Skeleton { joints: joints.collect() };
    let root: Vec<Vector3<f64>> = frames.iter().map(|frame| frame.0).collect();
    let rotations: Vec<UnitQuaternion<f64>> = frames.into_iter().flat_map(|frame| frame.1).collect();
    let finite = root.iter().all(|p| p.iter().all(|x| x.is_finite()))
        && rotations.iter().all(|r| r.coords.iter().all(|x| x.is_finite()))
        && skeleton.joints.iter().all(|j| j.offset.iter().all(|x| x.is_finite()));
    if !finite {
        return Err("the motion holds numbers that are not finite. Repair or export it again".into());
    }
    Ok(Clip { skeleton, frame_time: 1.0 / fps, root, rotations, coordinates: None, notes })
}

struct Bone {
    node: usize,
    name: String,
    parent: Option<usize>,
}

/// The bones of the first skeleton, parents first, each below the nearest bone above it.
fn bones(scene: &Scene) -> Result<Vec<Bone>, String> {
    let nodes = scene.nodes();
    let mut bones: Vec<Bone> = Vec::new();
    let mut taken: HashSet<&str> = HashSet::new();
    let mut seen = vec![false; nodes.len()];
    let mut open: Vec<(usize, Option<usize>)> = vec![(0, None)];
    while let Some((at, above)) = open.pop() {
        let Some(node) = nodes.get(at).filter(|_| !std::mem::replace(&mut seen[at], true)) else { continue };
        let mut nearest = above;
        // A second tree beside the body is left out.
        if node.bone().is_some() && (above.is_some() || bones.is_empty()) {
            if bones.len() >= MAX_JOINTS {
                return Err(format!("it has more than {MAX_JOINTS} bones, at most that many are read"));
            }
            nearest = Some(bones.len());
            let name = node.name();
            let name = if taken.insert(name) { name.to_owned() } else { format!("{name}_{at}") };
            bones.push(Bone { node: at, name, parent: above });
        }
        open.extend(node.children().iter().rev().map(|&child| (child, nearest)));
    }
    match bones.is_empty() {
        true => Err("the file has no bones, expected a skeleton in motion".into()),
        false => Ok(bones),
    }
}

/// Where a bone rests, in the world: as its bind pose says, or as it stands in the file.
fn rest(scene: &Scene, node: usize) -> Matrix {
    let own = scene.nodes().get(node);
    let pose = own.and_then(|n| n.bind_pose()).and_then(|pose| scene.poses().get(pose));
    let bound = pose.and_then(|pose| pose.bone_poses.iter().find(|bone| bone.bone_node == node));
    let stands = || own.map_or(Matrix::IDENTITY, |n| *n.node_to_world());
    bound.map_or_else(stands, |bone| bone.bone_to_world)
}

/// Place, m, and rotation in the world; what is scaled loses its scale.
struct World {
    place: Vector3<f64>,
    rotation: UnitQuaternion<f64>,
}

impl World {
    fn new(matrix: &Matrix) -> World {
        let column = |i: usize| Vector3::from(matrix.column(i));
        let x = column(0).try_normalize(1e-12).unwrap_or(Vector3::x());
        let y = column(1) - x * x.dot(&column(1));
        let y = y
            .try_normalize(1e-12)
            .unwrap_or_else(|| x.cross(&Vector3::z()).try_normalize(1e-12).unwrap_or(Vector3::y()));
        let turn = Matrix3::from_columns(&[x, y, x.cross(&y)]);
        let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(turn));
        World { place: column(3), rotation }
    }
}
