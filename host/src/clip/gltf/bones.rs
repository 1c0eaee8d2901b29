//! A body of octahedra, one a bone, in the rest pose with the root at the origin.

use nalgebra::Vector3;

use crate::clip::Skeleton;

/// Vertices with the joint that each follows, and triangles over them.
#[derive(Default)]
pub(super) struct Bones {
    pub positions: Vec<[f32; 3]>,
    pub joints: Vec<u16>,
    pub triangles: Vec<[u16; 3]>,
}

/// Shorter bones are not drawn, m.
const SHORTEST: f64 = 1e-3;

/// Corners of an octahedron: near end, four around, far end.
const FACES: [[u16; 3]; 8] = [[0, 2, 1], [0, 3, 2], [0, 4, 3], [0, 1, 4], [5, 1, 2], [5, 2, 3], [5, 3, 4], [5, 4, 1]];

/// The bones from each joint to its children and to its tip. A skeleton with neither gets one of 5 cm, so that the mesh is not empty.
pub(super) fn mesh(skeleton: &Skeleton) -> Bones {
    let mut bones = Bones::default();
    let rest = skeleton.rest_positions();
    for (joint, it) in skeleton.joints.iter().enumerate() {
        let offsets = skeleton.children(joint).map(|child| skeleton.joints[child].offset).chain(it.end);
        for bone in offsets.filter(|bone| bone.norm() > SHORTEST) {
            bones.push(joint, rest[joint], bone);
        }
    }
    if bones.positions.is_empty() {
        bones.push(0, Vector3::zeros(), Vector3::y() * 0.05);
    }
    bones
}

impl Bones {
    fn push(&mut self, joint: usize, from: Vector3<f64>, bone: Vector3<f64>) {
        // Indices are 16 bits: a skeleton with more bones than that shows its first ones.
        let Ok(first) = u16::try_from(self.positions.len() + FACES.len()).map(|end| end - FACES.len() as u16) else {
            return;
        };
        let thick = (0.1 * bone.norm()).min(0.03);
        let least = if bone.x.abs() < 0.9 * bone.norm() { Vector3::x() } else { Vector3::z() };
        let u = bone.cross(&least).normalize() * thick;
        let v = u.cross(&bone.normalize());
        let waist = from + bone * 0.15;
        for corner in [from, waist + u, waist + v, waist - u, waist - v, from + bone] {
            self.positions.push(corner.map(|x| x as f32).into());
            self.joints.push(joint as u16);
        }
        self.triangles.extend(FACES.map(|face| face.map(|corner| first + corner)));
    }
}
