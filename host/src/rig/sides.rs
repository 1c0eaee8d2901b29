//! The mirror image of a body, whatever axes its bones were drawn along.
//!
//! A mirror that turns X round takes a world rotation `W` of a joint to `S W S` at its partner. Bones of the left and of the right may be drawn
//! along different axes: the partner's own axes are then `S W S F`, with a fixed turn `F` by quarters about the axes. World-aligned
//! skeletons have none.

use kinesic::rig::JointKind;
use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

use super::Rig;
use crate::clip::{Clip, reflect, reflect_rotation};

/// Largest angle between a bone and the image of its partner.
const ASKEW: f64 = 20.0;
/// Shortest bone whose direction counts, m.
const SHORT: f64 = 0.01;

/// Which joint is the image of which, and how the axes of its image are turned.
#[derive(Clone, Debug)]
pub struct Sides {
    parents: Vec<Option<usize>>,
    partners: Vec<usize>,
    turns: Vec<UnitQuaternion<f64>>,
}

impl Sides {
    /// The sides of a body, by local rotations in which it stands about straight, joint 0 against the heading. `None` where some bone is
    /// more than 20 degrees from the image of its partner: left and right are not mirror images.
    pub fn find(rig: &Rig, straight: &[UnitQuaternion<f64>]) -> Option<Self> {
        let joints = rig.joints();
        let mut sides = Self {
            parents: rig.skeleton.joints.iter().map(|joint| joint.parent).collect(),
            partners: (0..joints).map(|joint| rig.map.mirror_partner(joint).unwrap_or(joint)).collect(),
            turns: vec![UnitQuaternion::identity(); joints],
        };
        if sides.fit(rig) {
            return Some(sides);
        }
        let world = rig.skeleton.world_rotations(straight);
        for (joint, partner) in sides.partners.iter().copied().enumerate() {
            let turn = quarters(&(reflect_rotation(&world[partner]).inverse() * world[joint]));
            // There and back again is no turn.
            sides.turns[partner] = reflect_rotation(&turn).inverse();
            sides.turns[joint] = turn;
        }
        sides.fit(rig).then_some(sides)
    }

    /// Whether every bone is where the image of its partner is.
    fn fit(&self, rig: &Rig) -> bool {
        let joints = &rig.skeleton.joints;
        joints.iter().zip(&self.partners).all(|(joint, &partner)| {
            let image = self.turn(joint.parent).inverse() * reflect(joints[partner].offset);
            joint.offset.norm() < SHORT || joint.offset.angle(&image) < ASKEW.to_radians()
        })
    }

    fn turn(&self, joint: Option<usize>) -> UnitQuaternion<f64> {
        joint.map_or_else(UnitQuaternion::identity, |joint| self.turns[joint])
    }

    /// The joint whose image a joint is.
    pub fn partner(&self, joint: usize) -> usize {
        self.partners[joint]
    }

    /// Local rotation of a joint in the mirror of these.
    pub fn image(&self, joint: usize, locals: &[UnitQuaternion<f64>]) -> UnitQuaternion<f64> {
        let of_parent = self.turn(self.parents[joint]);
        of_parent.inverse() * reflect_rotation(&locals[self.partners[joint]]) * self.turns[joint]
    }

    /// A clip of this skeleton in the mirror, on the same skeleton.
    pub fn mirrored(&self, clip: &Clip) -> Clip {
        let joints = clip.skeleton.len();
        let frames = clip.rotations.chunks_exact(joints.max(1));
        Clip {
            root: clip.root.iter().copied().map(reflect).collect(),
            rotations: frames.flat_map(|locals| (0..joints).map(|joint| self.image(joint, locals))).collect(),
            coordinates: None,
            ..clip.clone()
        }
    }

    /// Which axis of the partner's rotation vector becomes an axis of the joint's, and with which sign.
    pub fn axis(&self, joint: usize, axis: usize) -> (usize, f64) {
        // A rotation vector is no arrow: what lies along the mirror's normal stays, the rest turns round.
        let weights = Matrix3::from_diagonal(&Vector3::new(1.0, -1.0, -1.0)) * (self.turns[joint] * unit(axis));
        let from = weights.iamax();
        (from, weights[from].signum())
    }
}

/// Where every coordinate goes in a mirror that turns X round, and whether its sign changes.
#[derive(Clone, Debug)]
pub struct Mirror {
    from: Vec<(usize, f64)>,
}

impl Mirror {
    /// The mirror of a body; `None` where left and right are not mirror images, or joints have other coordinates than balls have.
    pub fn new(rig: &Rig) -> Option<Self> {
        let device = rig.frames();
        let places: Vec<_> = device.places().collect();
        let balls = places.iter().all(|(kind, _)| matches!(kind, JointKind::Ball | JointKind::Fixed));
        let sides = rig.sides().filter(|_| balls && device.travels())?;
        let mut from: Vec<(usize, f64)> = (0..3 * device.rows()).map(|channel| (channel, 1.0)).collect();
        from[0].1 = -1.0;
        for (joint, (kind, first)) in places.iter().enumerate() {
            let (other, start) = places[sides.partner(joint)];
            if other != *kind {
                return None;
            }
            for axis in 0..kind.coordinates() {
                let (of_other, sign) = sides.axis(joint, axis);
                from[first + axis] = (start + of_other, sign);
            }
        }
        Some(Self { from })
    }

    /// Rows in the mirror.
    pub fn rows(&self, rows: &[f64]) -> Vec<f64> {
        rows.chunks_exact(self.from.len()).flat_map(|row| self.from.iter().map(|(at, sign)| sign * row[*at])).collect()
    }
}

fn unit(axis: usize) -> Vector3<f64> {
    let mut unit = Vector3::zeros();
    unit[axis] = 1.0;
    unit
}

/// The nearest of the 24 turns by quarters about the axes.
fn quarters(turn: &UnitQuaternion<f64>) -> UnitQuaternion<f64> {
    let of = |first: usize, second: usize, signs: usize| {
        let [a, b] =
            [(first, signs & 1), (second, signs >> 1)].map(|(axis, minus)| unit(axis) * (1.0 - 2.0 * minus as f64));
        let axes = Matrix3::from_columns(&[a, b, a.cross(&b)]);
        UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(axes))
    };
    let pairs = (0..9).map(|pair| (pair / 3, pair % 3)).filter(|(first, second)| first != second);
    let all = pairs.flat_map(|(first, second)| (0..4).map(move |signs| of(first, second, signs)));
    all.min_by(|a, b| a.angle_to(turn).total_cmp(&b.angle_to(turn))).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clip::JointMap;
    use crate::gait::{Manner, walk};

    /// The same motion with bones that are drawn along other axes: quarters that differ from joint to joint.
    fn redrawn(clip: &Clip) -> Clip {
        let turns: Vec<UnitQuaternion<f64>> = (0..clip.skeleton.len())
            .map(|joint| {
                let [a, b] = [joint % 4, joint * 7 % 3].map(|quarters| quarters as f64 * std::f64::consts::FRAC_PI_2);
                UnitQuaternion::from_euler_angles(a, b, 0.0)
            })
            .collect();
        let mut out = clip.clone();
        let joints = clip.skeleton.len();
        for (index, joint) in out.skeleton.joints.iter_mut().enumerate() {
            let of_parent = joint.parent.map_or_else(UnitQuaternion::identity, |parent| turns[parent]);
            joint.offset = of_parent.inverse() * joint.offset;
            joint.end = joint.end.map(|end| turns[index].inverse() * end);
            out.rotations.iter_mut().skip(index).step_by(joints).for_each(|local| {
                *local = of_parent.inverse() * *local * turns[index];
            });
        }
        out
    }

    /// Largest distance between the motion of mirrored coordinates and the mirror image of the motion, m.
    fn wrong(clip: &Clip) -> f64 {
        let map = JointMap::choose(&clip.skeleton, None).unwrap().unwrap();
        let rig = Rig::new(&clip.skeleton, &map).unwrap();
        let poses = rig.poses(clip);
        let rig = rig.centred(&[&poses]);
        let mirror = Mirror::new(&rig).unwrap();
        let places = |rows: &[f64]| {
            let device = rig.frames();
            let mut pose = rig.zero_pose();
            let mut frame = crate::rig::HostFrame::new();
            frame.rows.as_flattened_mut().iter_mut().zip(rows).for_each(|(to, from)| *to = *from as f32);
            device.show(&frame, &frame, &mut kinesic::rig::Drift::new(), &mut pose);
            let locals: Vec<_> = pose.rotations[..rig.joints()]
                .iter()
                .map(|q| UnitQuaternion::new_normalize(q.into_inner().cast()))
                .collect();
            rig.skeleton.pose_positions(&Vector3::zeros(), &locals)
        };
        let sides = rig.sides().unwrap();
        let mut worst = 0.0f64;
        for frame in rig.read(&poses) {
            let rows: Vec<f64> = frame.rows[..rig.rows()].as_flattened().iter().map(|x| f64::from(*x)).collect();
            let (own, image) = (places(&rows), places(&mirror.rows(&rows)));
            for joint in 0..rig.joints() {
                let from = own[sides.partner(joint)] - own[0];
                worst = worst.max((image[joint] - image[0] - reflect(from)).norm());
            }
        }
        worst
    }

    #[test]
    fn coordinates_are_mirrored_whatever_axes_the_bones_have() {
        let clip = walk(&Manner::WEARY, 2.0, 60.0, 0.2, 4);
        for clip in [redrawn(&clip), clip] {
            assert!(wrong(&clip) < 1e-3, "{}", wrong(&clip));
        }
    }

    #[test]
    fn a_clip_in_the_mirror_of_its_mirror_is_the_clip() {
        let clip = redrawn(&walk(&Manner::WEARY, 1.0, 60.0, 0.2, 4));
        let map = JointMap::choose(&clip.skeleton, None).unwrap().unwrap();
        let rig = Rig::new(&clip.skeleton, &map).unwrap();
        let sides = rig.centred(&[&rig.poses(&clip)]).sides().unwrap();
        let image = sides.mirrored(&clip);
        for (frame, from) in [(0, clip.positions(0)), (30, clip.positions(30))] {
            for (joint, at) in image.positions(frame).into_iter().enumerate() {
                let from = from[sides.partner(joint)];
                assert!((at - reflect(from)).norm() < 1e-9);
            }
        }
        let back = sides.mirrored(&image);
        assert!(
            back.rotations.iter().zip(&clip.rotations).all(|(a, b)| a.angle_to(b) < 1e-7) && back.root == clip.root
        );
    }

    #[test]
    fn a_body_with_one_arm_bent_back_has_no_sides() {
        let mut clip = walk(&Manner::WEARY, 2.0, 60.0, 0.2, 4);
        let map = JointMap::choose(&clip.skeleton, None).unwrap().unwrap();
        let hand = map.joint(crate::clip::Canonical::LWrist).unwrap();
        clip.skeleton.joints[hand].offset = Vector3::new(0.0, 0.0, -0.3);
        let rig = Rig::new(&clip.skeleton, &map).unwrap();
        let rig = rig.centred(&[&rig.poses(&clip)]);
        assert!(rig.sides().is_none());
    }
}
