//! glTF 2.0, read (`read`: `numbers`, `tracks`) and written. Writing: skeleton, animation, and a body of bones so that a viewer shows something.
//!
//! | what | how |
//! |---|---|
//! | unit, axes | metres, right-handed, +Y up, the person faces +Z: glTF's own, nothing is converted |
//! | joints | node `i` is joint `i` of the clip, with its name; translation = the bone, rotation = rest (identity) |
//! | animation | one key a frame at `frame / rate` s, from 0 to [`Clip::duration`], linear; a rotation for every joint |
//! | root motion | the translation of node 0, in the world; nothing else moves |
//! | quaternions | `x y z w`, of the two signs the one nearer to the frame before |
//! | names | scene and animation: the file's; nodes: the joints' |
//! | body | one octahedron a bone, all of one mesh, skinned to the joints (`bones`) |
//! | `asset.extras` | `frame_rate`, `frames`, `duration_s`, `unit`, `root_motion` |
//!
//! `.glb` holds the numbers as a binary chunk, `.gltf` as base64 in the JSON: one file in both cases.

mod bones;
mod numbers;
mod read;
mod tracks;

pub use read::{parse, read};

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use nalgebra::{UnitQuaternion, Vector4};
use serde_json::{Value, json};

use super::Clip;
use super::bvh::write::{WriteError, check};

/// Name of a motion that is not written to a file.
const UNNAMED: &str = "motion";

const FLOAT: u32 = 5126;
const U16: u32 = 5123;
const VERTICES: u32 = 34_962;
const INDICES: u32 = 34_963;

impl Clip {
    /// A binary glTF file whose motion has no name of its own. Refuses what the BVH writer refuses.
    pub fn to_glb(&self) -> Result<Vec<u8>, WriteError> {
        self.to_glb_named(UNNAMED)
    }

    /// As [`Clip::to_glb`]; scene and animation have the name.
    pub fn to_glb_named(&self, name: &str) -> Result<Vec<u8>, WriteError> {
        let (document, buffer) = document(self, name, None)?;
        let mut text = document.to_string().into_bytes();
        text.resize(text.len().next_multiple_of(4), b' ');
        let length = 12 + 8 + text.len() + 8 + buffer.len();
        let mut out = Vec::with_capacity(length);
        let word = |out: &mut Vec<u8>, value: usize| out.extend((value as u32).to_le_bytes());
        out.extend(b"glTF");
        word(&mut out, 2);
        word(&mut out, length);
        for (kind, chunk) in [(b"JSON", &text), (b"BIN\0", &buffer)] {
            word(&mut out, chunk.len());
            out.extend(kind);
            out.extend(chunk);
        }
        Ok(out)
    }

    /// A glTF file as text, with its numbers in it.
    pub fn to_gltf(&self) -> Result<String, WriteError> {
        self.to_gltf_named(UNNAMED)
    }

    /// As [`Clip::to_gltf`]; scene and animation have the name.
    pub fn to_gltf_named(&self, name: &str) -> Result<String, WriteError> {
        let (_, buffer) = document(self, name, None)?;
        let uri = format!("data:application/octet-stream;base64,{}", BASE64_STANDARD.encode(&buffer));
        Ok(document(self, name, Some(uri))?.0.to_string())
    }
}

/// The binary part and what the JSON says about it.
#[derive(Default)]
struct Buffer {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl Buffer {
    /// Numbers in rows of `kind`; returns the accessor's index. `bounds`: the least and greatest value of each column, where glTF wants them.
    fn push(
        &mut self,
        bytes: &[u8],
        kind: (&str, u32, usize),
        target: Option<u32>,
        bounds: Option<[Vec<f32>; 2]>,
    ) -> usize {
        let (shape, component, row) = kind;
        let mut view = json!({"buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len()});
        if let Some(target) = target {
            view["target"] = json!(target);
        }
        let mut accessor = json!({"bufferView": self.views.len(), "componentType": component, "type": shape, "count": bytes.len() / row});
        if let Some([least, greatest]) = bounds {
            accessor["min"] = json!(least);
            accessor["max"] = json!(greatest);
        }
        self.bytes.extend(bytes);
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.views.push(view);
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    fn floats(&mut self, shape: (&str, usize), values: &[f32], target: Option<u32>, bounded: bool) -> usize {
        let (shape, columns) = shape;
        let bounds = bounded.then(|| {
            let column = |k: usize| values.iter().skip(k).step_by(columns).copied();
            let over = |f: fn(f32, f32) -> f32, from: f32| (0..columns).map(|k| column(k).fold(from, f)).collect();
            [over(f32::min, f32::INFINITY), over(f32::max, f32::NEG_INFINITY)]
        });
        self.push(bytemuck::cast_slice(values), (shape, FLOAT, 4 * columns), target, bounds)
    }
}

/// A quaternion of length 1, as glTF asks for: what the device computes in singles is a millionth off.
fn unit(turn: &UnitQuaternion<f64>) -> Vector4<f64> {
    turn.coords.try_normalize(1e-9).unwrap_or(turn.coords)
}

fn document(clip: &Clip, name: &str, uri: Option<String>) -> Result<(Value, Vec<u8>), WriteError> {
    check(clip)?;
    let joints = clip.skeleton.len();
    let mut smooth = clip.clone();
    smooth.make_signs_continuous();
    let mut buffer = Buffer::default();
    let times: Vec<f32> = (0..clip.frames()).map(|frame| (frame as f64 * clip.frame_time) as f32).collect();
    let times = buffer.floats(("SCALAR", 1), &times, None, true);
    let root: Vec<f32> = clip.root.iter().flat_map(|p| p.iter().map(|v| *v as f32)).collect();
    let root = buffer.floats(("VEC3", 3), &root, None, false);
    let mut samplers = vec![json!({"input": times, "output": root, "interpolation": "LINEAR"})];
    let mut channels = vec![json!({"sampler": 0, "target": {"node": 0, "path": "translation"}})];
    for joint in 0..joints {
        let rotations: Vec<f32> =
            (0..clip.frames()).flat_map(|frame| unit(&smooth.pose(frame)[joint]).map(|v| v as f32).data.0[0]).collect();
        let output = buffer.floats(("VEC4", 4), &rotations, None, false);
        channels.push(json!({"sampler": samplers.len(), "target": {"node": joint, "path": "rotation"}}));
        samplers.push(json!({"input": times, "output": output, "interpolation": "LINEAR"}));
    }
    let (mesh, skin) = body(clip, &mut buffer);
    let mut nodes: Vec<Value> = (0..joints).map(|joint| node(clip, joint)).collect();
    nodes.push(json!({"name": "body", "mesh": 0, "skin": 0}));
    let mut stored = json!({"byteLength": buffer.bytes.len()});
    if let Some(uri) = uri {
        stored["uri"] = json!(uri);
    }
    let document = json!({
        "asset": {"version": "2.0", "generator": concat!("kinesic ", env!("CARGO_PKG_VERSION")), "extras": {
            "frame_rate": clip.fps(),
            "frames": clip.frames(),
            "duration_s": clip.duration(),
            "unit": "m",
            "root_motion": "translation of node 0",
        }},
        "scene": 0,
        "scenes": [{"name": name, "nodes": [0, joints]}],
        "nodes": nodes,
        "animations": [{"name": name, "channels": channels, "samplers": samplers}],
        "meshes": [mesh],
        "skins": [skin],
        "materials": [{"name": "bone", "pbrMetallicRoughness": {"baseColorFactor": [0.25, 0.45, 0.75, 1.0], "metallicFactor": 0.0, "roughnessFactor": 0.8}}],
        "accessors": buffer.accessors,
        "bufferViews": buffer.views,
        "buffers": [stored],
    });
    Ok((document, buffer.bytes))
}

fn node(clip: &Clip, joint: usize) -> Value {
    let it = &clip.skeleton.joints[joint];
    // At rest the root stands where the motion begins.
    let place = if joint == 0 { clip.root[0] } else { it.offset };
    let mut node =
        json!({"name": it.name, "translation": [place.x, place.y, place.z], "rotation": [0.0, 0.0, 0.0, 1.0]});
    let children: Vec<usize> = clip.skeleton.children(joint).collect();
    if !children.is_empty() {
        node["children"] = json!(children);
    }
    node
}

/// Mesh and skin.
fn body(clip: &Clip, buffer: &mut Buffer) -> (Value, Value) {
    let bones = bones::mesh(&clip.skeleton);
    let position = buffer.floats(("VEC3", 3), bones.positions.as_flattened(), Some(VERTICES), true);
    let four = |joint: &u16| [*joint, 0, 0, 0];
    let joints: Vec<[u16; 4]> = bones.joints.iter().map(four).collect();
    let joints = buffer.push(bytemuck::cast_slice(&joints), ("VEC4", U16, 8), Some(VERTICES), None);
    let weights = vec![[1.0f32, 0.0, 0.0, 0.0]; bones.positions.len()];
    let weights = buffer.floats(("VEC4", 4), weights.as_flattened(), Some(VERTICES), false);
    let indices = buffer.push(bytemuck::cast_slice(&bones.triangles), ("SCALAR", U16, 2), Some(INDICES), None);
    let unbind = |rest: &nalgebra::Vector3<f64>| {
        let [x, y, z] = rest.map(|v| -v as f32).data.0[0];
        [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, x, y, z, 1.0f32]
    };
    let matrices: Vec<[f32; 16]> = clip.skeleton.rest_positions().iter().map(unbind).collect();
    let matrices = buffer.floats(("MAT4", 16), matrices.as_flattened(), None, false);
    let mesh = json!({"name": "bones", "primitives": [{
        "attributes": {"POSITION": position, "JOINTS_0": joints, "WEIGHTS_0": weights},
        "indices": indices,
        "material": 0,
    }]});
    let skin =
        json!({"joints": (0..clip.skeleton.len()).collect::<Vec<_>>(), "skeleton": 0, "inverseBindMatrices": matrices});
    (mesh, skin)
}
