//! Pose -> frame, frame -> pose.

use nalgebra::{UnitQuaternion, Vector3};

use super::{Frame, Rig, carried};
use crate::pose::{Heading, Pose, unit};

/// A root that goes farther in a frame, m, was put elsewhere.
const LEAP: f32 = 0.5;

/// How far a body has been carried from where the source stands: engines change travel, and this is its sum, world, m.
///
/// It keeps within the frame's [`reach`](Frame::reach), [`REACH`](super::REACH) by default. What carries the body farther out counts in full up to half the reach,
/// then ever less, and nothing at the reach; what brings it back counts in full. So no sequence of frames takes it beyond, and where nothing
/// travels nothing moves. With limits their target keeps the reach, and the body is behind it by as much as they hold it back: a leap
/// of the source is bridged. An engine that looks at no source, an [`Emotion`](crate::Emotion), goes its own way.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Drift {
    at: [f32; 2],
}

impl Drift {
    /// Where the source stands.
    pub const fn new() -> Self {
        Self { at: [0.0; 2] }
    }
}

impl Rig<'_> {
    /// The coordinates of a sound pose. `frame` holds those of the pose before, which decide the heading where a pose leaves it open,
    /// the turn of an angle, and the travel; begin with [`Frame::new`]. Cost: about 60 multiply-adds, a root and a division per ball.
    pub fn read<const JOINTS: usize, const ROWS: usize>(&self, pose: &Pose<JOINTS>, frame: &mut Frame<ROWS>) {
        let upright = self.place(pose, frame);
        let first = core::iter::once(upright.as_ref()).chain(core::iter::repeat(None));
        for ((joint, local), upright) in self.iter().zip(&pose.rotations).zip(first) {
            let last = joint.read(frame.coordinates());
            let own = joint.coordinates(upright.unwrap_or(local), last);
            joint.write(own, frame.coordinates_mut());
        }
    }

    /// Heading, place and the root's row; the root's rotation against the heading. Nothing for a machine that stands.
    fn place<const JOINTS: usize, const ROWS: usize>(
        &self,
        pose: &Pose<JOINTS>,
        frame: &mut Frame<ROWS>,
    ) -> Option<UnitQuaternion<f32>> {
        let across = self.across?;
        let root = pose.rotations.first()?;
        frame.heading = frame.heading.square_to(root * across);
        let ground = [pose.root.x, pose.root.z];
        let [x, z] = if frame.known { frame.ground } else { ground };
        let way = Vector3::new(pose.root.x - x, 0.0, pose.root.z - z);
        let leaps = !frame.started || way.dot(&way) > LEAP * LEAP;
        let (travel, leap) = if leaps { (Vector3::zeros(), way) } else { (way, Vector3::zeros()) };
        let travel = frame.heading.to_local(travel);
        (frame.ground, frame.leap) = (ground, [leap.x, leap.z]);
        (frame.started, frame.known) = (true, true);
        if let Some(row) = frame.rows.first_mut() {
            *row = [travel.x, pose.root.y, travel.z];
        }
        Some(unit((frame.heading.rotation().inverse() * root).into_inner()))
    }

    /// The pose of `styled`, for a `source` frame that was read from the pose `from`. Joints whose coordinates are those of the
    /// source keep their rotation, bit for bit; so do joints of the pose that the rig does not have. Cost: about 60 multiply-adds, two roots and two
    /// divisions per ball that changed.
    pub fn write<const JOINTS: usize, const ROWS: usize>(
        &self,
        source: &Frame<ROWS>,
        styled: &Frame<ROWS>,
        drift: &mut Drift,
        from: &Pose<JOINTS>,
        pose: &mut Pose<JOINTS>,
    ) {
        *pose = *from;
        self.root(source, styled, drift, pose);
        self.turn(Some(source), styled, pose);
    }

    /// The pose of `styled`, every joint of the rig: one without coordinates is at its reference. Joints of the pose that the rig does not
    /// have stay. For a frame of its own making, or where no pose came. Cost: as [`write`](Self::write) where everything changed.
    pub fn show<const JOINTS: usize, const ROWS: usize>(
        &self,
        source: &Frame<ROWS>,
        styled: &Frame<ROWS>,
        drift: &mut Drift,
        pose: &mut Pose<JOINTS>,
    ) {
        self.root(source, styled, drift, pose);
        self.turn(None, styled, pose);
    }

    /// The pose at coordinates 0, at the origin.
    pub fn rest<const JOINTS: usize>(&self) -> Pose<JOINTS> {
        let mut pose = Pose::identity();
        pose.rotations.iter_mut().zip(self.iter()).for_each(|(rotation, joint)| *rotation = joint.reference());
        pose
    }

    /// Rotations of the joints whose coordinates are not those of `unchanged`. One function for both ways: half the code.
    #[inline(never)]
    fn turn<const JOINTS: usize, const ROWS: usize>(
        &self,
        unchanged: Option<&Frame<ROWS>>,
        styled: &Frame<ROWS>,
        pose: &mut Pose<JOINTS>,
    ) {
        let mut upright = self.travels();
        for (joint, rotation) in self.iter().zip(&mut pose.rotations) {
            let own = joint.read(styled.coordinates());
            let same = |frame: &Frame<ROWS>| {
                joint.read(frame.coordinates()) == own && !(upright && frame.heading != styled.heading)
            };
            if !unchanged.is_some_and(same) {
                let local = joint.rotation(own);
                *rotation = if upright { unit((styled.heading.rotation() * local).into_inner()) } else { local };
            }
            upright = false;
        }
    }

    /// Root and drift of a body that travels.
    #[inline(never)]
    fn root<const JOINTS: usize, const ROWS: usize>(
        &self,
        source: &Frame<ROWS>,
        styled: &Frame<ROWS>,
        drift: &mut Drift,
        pose: &mut Pose<JOINTS>,
    ) {
        let (Some(before), Some(after), true) = (source.rows.first(), styled.rows.first(), self.travels()) else {
            return;
        };
        let way = |heading: Heading, [x, _, z]: &[f32; 3]| heading.to_world(Vector3::new(*x, 0.0, *z));
        let change = way(styled.heading, after) - way(source.heading, before);
        let ([to_x, to_z], [from_x, from_z]) = (styled.leap, source.leap);
        drift.at = styled.carried.unwrap_or_else(|| {
            let [x, z] = carried(drift.at, [change.x, change.z], styled.reach);
            [x + (to_x - from_x), z + (to_z - from_z)]
        });
        let [x, z] = drift.at;
        let ([ground_x, ground_z], [_, height, _]) = (styled.ground, *after);
        pose.root = Vector3::new(ground_x + x, height, ground_z + z);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rig::JointKind;

    const KINDS: [u16; 3] = [JointKind::Ball as u16, JointKind::Hinge as u16, JointKind::Ball as u16];
    const AXES: [[[f32; 3]; 3]; 3] = [[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]; 3];

    fn pose(step: f32) -> Pose<3> {
        let turn = |x, y, z| UnitQuaternion::from_scaled_axis(Vector3::new(x, y, z));
        let heading = turn(0.0, 0.3 * step, 0.0);
        Pose {
            root: Vector3::new(0.1 * step, 1.0 + 0.02 * step, -0.3 * step),
            rotations: [heading * turn(0.2, 0.0, -0.1), turn(0.7 - 0.1 * step, 0.0, 0.0), turn(0.1, -0.4, 0.6)],
        }
    }

    #[test]
    fn what_is_read_is_written_again() {
        let reference = [[0.0, 0.0, 0.0, 1.0], [0.0, 0.0, 0.0, 1.0], [0.0, 0.6, 0.0, 0.8]];
        let rig = Rig::new(&KINDS, &AXES, &reference, &[[0.0; 3]; 3], Some(&[1.0, 0.0, 0.0])).unwrap();
        let (mut source, mut drift, mut out) = (Frame::<4>::new(), Drift::default(), Pose::identity());
        let mut travelled = Vector3::zeros();
        for step in 0..20 {
            let from = pose(step as f32);
            rig.read(&from, &mut source);
            let [x, height, z] = source.rows[0];
            assert_eq!(height, from.root.y);
            travelled += source.heading.to_world(Vector3::new(x, 0.0, z));
            rig.write(&source, &source, &mut drift, &from, &mut out);
            assert_eq!(out, from, "the same coordinates give the same bits");
            // With other coordinates somewhere every joint that did not change stays, and the one that did is there.
            let mut styled = source;
            styled.rows[2][0] += 0.25;
            rig.write(&source, &styled, &mut drift, &from, &mut out);
            assert_eq!([out.rotations[0], out.rotations[2]], [from.rotations[0], from.rotations[2]]);
            assert!((out.rotations[1].angle_to(&from.rotations[1]) - 0.25).abs() < 1e-5);
            // Joints that are composed anew are those that were read.
            styled = source;
            styled.rows.iter_mut().skip(1).flatten().for_each(|x| *x += 1e-7);
            rig.write(&source, &styled, &mut drift, &from, &mut out);
            let far = out.rotations.iter().zip(&from.rotations).map(|(a, b)| a.angle_to(b)).fold(0.0, f32::max);
            assert!(far < 5e-6, "{far}");
        }
        assert!((travelled - Vector3::new(1.9, 0.0, -5.7)).norm() < 1e-4, "{travelled}");
    }

    #[test]
    fn changed_travel_adds_up_and_a_gap_is_none() {
        let reference = [[0.0, 0.0, 0.0, 1.0]; 3];
        let rig = Rig::new(&KINDS, &AXES, &reference, &[[0.0; 3]; 3], Some(&[1.0, 0.0, 0.0])).unwrap();
        let (mut source, mut drift, mut out) = (Frame::<4>::new(), Drift::default(), Pose::identity());
        for _ in 0..10 {
            let from = Pose::<3>::identity();
            rig.read(&from, &mut source);
            let mut styled = source;
            styled.rows[0][2] += 0.01;
            rig.write(&source, &styled, &mut drift, &from, &mut out);
        }
        assert!((out.root.z - 0.1).abs() < 1e-6);
        source.forget_place();
        let mut far = Pose::<3>::identity();
        far.root.x = 100.0;
        rig.read(&far, &mut source);
        assert_eq!((source.rows[0][0], source.leap), (0.0, [100.0, 0.0]));
        // A leap without a gap is a leap as well.
        far.root.z = -1.0;
        rig.read(&far, &mut source);
        assert_eq!((source.rows[0], source.leap), ([0.0; 3], [0.0, -1.0]));
    }

    #[test]
    fn a_machine_that_stands_has_no_root() {
        let kinds = [JointKind::Hinge as u16; 3];
        let rig = Rig::new(&kinds, &AXES, &[[0.0, 0.0, 0.0, 1.0]; 3], &[[0.0; 3]; 3], None).unwrap();
        let (mut source, mut out) = (Frame::<1>::new(), Pose::identity());
        let mut from = Pose::<3>::identity();
        from.rotations[1] = UnitQuaternion::from_scaled_axis(Vector3::new(-0.4, 0.0, 0.0));
        rig.read(&from, &mut source);
        assert!((source.coordinates()[1] + 0.4).abs() < 1e-6);
        let styled = Frame::<1>::from_coordinates(&[0.1, 0.2, 0.3]);
        rig.write(&source, &styled, &mut Drift::default(), &from, &mut out);
        assert!((out.rotations[2].angle() - 0.3).abs() < 1e-6);
        assert_eq!(out.root, from.root);
    }

    #[test]
    fn a_leap_across_the_world_is_sound_and_bridged_by_the_drift() {
        let reference = [[0.0, 0.0, 0.0, 1.0]; 3];
        let rig = Rig::new(&KINDS, &AXES, &reference, &[[0.0; 3]; 3], Some(&[1.0, 0.0, 0.0])).unwrap();
        let (mut source, mut pose) = (Frame::<4>::new(), Pose::<3>::identity());
        for x in [-999_999.94, 999_999.94, -999_999.94] {
            pose.root.x = x;
            assert!(pose.is_sound(3));
            rig.read(&pose, &mut source);
            assert!(source.is_sound(), "{source:?}");
        }
        assert_eq!(source.leap, [-1_999_999.9, 0.0]);
        source.leap[1] = 2_000_001.0;
        assert!(!source.is_sound());
        pose.root.x = -1e6;
        assert!(!pose.is_sound(3), "nor is a pose that makes a frame that is not");
    }

    #[test]
    fn joints_without_coordinates_are_shown_at_their_reference_and_written_as_the_source_has_them() {
        let kinds = [JointKind::Hinge, JointKind::Fixed, JointKind::Slider].map(|kind| kind as u16);
        let reference = [[0.0, 0.0, 0.0, 1.0], [0.0, 0.6, 0.0, 0.8], [0.6, 0.0, 0.0, 0.8]];
        let rig = Rig::new(&kinds, &AXES, &reference, &[[0.0; 3]; 3], None).unwrap();
        let frame = Frame::<1>::from_coordinates(&[0.3, 0.1, 0.0]);
        let mut shown = Pose::<4>::identity();
        shown.rotations[3] = UnitQuaternion::from_scaled_axis(Vector3::new(0.0, 0.0, 0.4));
        let beyond = shown.rotations[3];
        rig.show(&frame, &frame, &mut Drift::new(), &mut shown);
        assert_eq!(shown.rotations[1..3], rig.rest::<4>().rotations[1..3]);
        assert!((shown.rotations[0].angle() - 0.3).abs() < 1e-6);
        assert_eq!(shown.rotations[3], beyond, "the rig does not have it");
        let from = Pose::<4> { rotations: [beyond; 4], ..Pose::identity() };
        let mut written = Pose::identity();
        rig.write(&Frame::new(), &frame, &mut Drift::new(), &from, &mut written);
        assert_eq!([written.rotations[1], written.rotations[3]], [beyond; 2]);
    }
}
