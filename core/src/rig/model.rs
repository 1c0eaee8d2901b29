//! The rig: a checked, immutable view of a pack's tables.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use super::joint::{Axes, JointKind, ball, hinge, hinged};
use super::rotation::{exp, log, renormalised};
use crate::model::{LoadError, Pack};

/// Which coordinates every joint has. All slices have one entry per joint, parents first.
#[derive(Clone, Copy, Debug)]
pub struct Rig<'a> {
    kinds: &'a [u16],
    axes: &'a [[[f32; 3]; 3]],
    reference: &'a [[f32; 4]],
    middle: &'a [[f32; 3]],
    /// Direction from the right hip to the left one in the root's frame; `None` for a machine that stands.
    pub(super) across: Option<Vector3<f32>>,
    rows: usize,
}

/// One joint, and where its coordinates are. It borrows: a copy of its tables would cost more than reading them.
pub(crate) struct Joint<'a> {
    /// Which coordinates it has.
    kind: JointKind,
    /// Index of the first one.
    first: usize,
    axes: &'a [[f32; 3]; 3],
    reference: &'a [f32; 4],
    middle: &'a [f32; 3],
}

impl<'a> Rig<'a> {
    /// The rig of a pack.
    pub fn load(pack: &Pack<'a>) -> Result<Self, LoadError> {
        let joints = pack.metadata().joints.len();
        let across = pack.slice::<[f32; 3]>("rig/across", pack.rows("rig/across")?)?;
        Self::new(
            pack.slice("rig/kinds", joints)?,
            pack.slice("rig/axes", joints)?,
            pack.slice("rig/reference", joints)?,
            pack.slice("rig/middle", joints)?,
            across.first(),
        )
    }

    /// A rig from its parts.
    ///
    /// - `kinds`: [`JointKind`] of each joint
    /// - `axes`: three axes in the frame that `reference` turns, of length one and at right angles; a hinge uses the first alone, a
    ///   ball none
    /// - `reference`: local rotation `[i, j, k, w]` of each joint at coordinates 0
    /// - `middle`: middle of the range of each angle, rad: an angle is that of all equal ones which is nearest to it
    /// - `across`: direction from the right hip to the left one in the root's frame, for a body that travels. Joint 0 is then a ball
    pub fn new(
        kinds: &'a [u16],
        axes: &'a [[[f32; 3]; 3]],
        reference: &'a [[f32; 4]],
        middle: &'a [[f32; 3]],
        across: Option<&[f32; 3]>,
    ) -> Result<Self, LoadError> {
        let joints = kinds.len();
        let count = |tensor, found| match found == joints {
            true => Ok(()),
            false => Err(LoadError::Shape { tensor, found, expected: joints }),
        };
        let value =
            |tensor, index: Option<usize>| index.map_or(Ok(()), |index| Err(LoadError::Value { tensor, index }));
        if joints == 0 || joints > u16::MAX as usize {
            return Err(LoadError::Shape { tensor: "rig/kinds", found: joints, expected: 1 });
        }
        count("rig/axes", axes.len())?;
        count("rig/reference", reference.len())?;
        count("rig/middle", middle.len())?;
        value("rig/kinds", kinds.iter().position(|code| JointKind::from_code(*code).is_none()))?;
        value("rig/reference", reference.iter().position(|q| !is_one(q.iter().map(|x| x * x).sum())))?;
        value("rig/axes", axes.iter().zip(kinds).position(|(axes, kind)| !are_axes(axes, *kind)))?;
        value("rig/middle", middle.iter().position(|x| !x.iter().all(|x| x.abs() < 100.0)))?;
        let across = across.map(|across| Vector3::from(*across));
        if let Some(across) = across {
            value("rig/across", (!is_one(across.dot(&across))).then_some(0))?;
            value("rig/kinds", (kinds.first() != Some(&(JointKind::Ball as u16))).then_some(0))?;
        }
        let mut rig = Self { kinds, axes, reference, middle, across, rows: 0 };
        rig.rows = rig.coordinates().div_ceil(3);
        Ok(rig)
    }

    /// Number of joints.
    pub fn joints(&self) -> usize {
        self.kinds.len()
    }

    /// Number of rows of a frame.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Number of coordinates, what is left free between them included.
    pub fn coordinates(&self) -> usize {
        self.places().last().map_or(0, |(kind, first)| first + kind.coordinates())
    }

    /// True for a body that travels: its first row is the root's.
    pub fn travels(&self) -> bool {
        self.across.is_some()
    }

    /// Kind of every joint, and index of its first coordinate. Cost: a few operations per joint.
    pub fn places(&self) -> impl Iterator<Item = (JointKind, usize)> + use<'a> {
        let mut end = if self.across.is_some() { 3 } else { 0 };
        self.kinds.iter().map(move |code| {
            // Checked when the rig was made.
            let kind = JointKind::from_code(*code).unwrap_or(JointKind::Fixed);
            let first = kind.first(end);
            end = first + kind.coordinates();
            (kind, first)
        })
    }

    /// Gives every coordinate of a joint this weight in a mask, such as [`Controls::mask`](crate::engine::Controls::mask). The root's
    /// row goes with joint 0. A joint that the rig does not have is ignored.
    pub fn weigh<const ROWS: usize>(&self, joint: usize, weight: f32, mask: &mut [[f32; 3]; ROWS]) {
        if let (Some(root), 0, true) = (mask.first_mut(), joint, self.travels()) {
            *root = [weight; 3];
        }
        if let Some((kind, first)) = self.places().nth(joint) {
            let own = mask.as_flattened_mut().iter_mut().skip(first).take(kind.coordinates());
            own.for_each(|to| *to = weight);
        }
    }

    pub(crate) fn iter(&self) -> impl Iterator<Item = Joint<'a>> + use<'a> {
        let tables = self.axes.iter().zip(self.reference).zip(self.middle);
        self.places().zip(tables).map(|((kind, first), ((axes, reference), middle))| Joint {
            kind,
            first,
            axes,
            reference,
            middle,
        })
    }
}

impl Joint<'_> {
    /// Its local rotation at coordinates 0.
    pub fn reference(&self) -> UnitQuaternion<f32> {
        let [i, j, k, w] = *self.reference;
        UnitQuaternion::new_unchecked(Quaternion::new(w, i, j, k))
    }

    /// The local rotation with these coordinates.
    pub fn rotation(&self, coordinates: [f32; 3]) -> UnitQuaternion<f32> {
        let turn = match self.kind {
            JointKind::Fixed | JointKind::Slider => return self.reference(),
            JointKind::Ball => exp(Vector3::from(coordinates)),
            JointKind::Hinge => {
                let ([axis, ..], [angle, ..]) = (self.axes, coordinates);
                hinged(axis, angle)
            }
            JointKind::Chain => Axes::new(self.axes).rotation(coordinates),
        };
        renormalised((self.reference() * turn).into_inner())
    }

    /// The coordinates of a local rotation. What the joint cannot do is left out. Of all the values that mean the same rotation the one
    /// nearest to the middle of its range counts, but the turn of `last` is kept for a while.
    pub fn coordinates(&self, local: &UnitQuaternion<f32>, last: [f32; 3]) -> [f32; 3] {
        let from = || renormalised((self.reference().inverse() * local).into_inner());
        match self.kind {
            JointKind::Fixed | JointKind::Slider => last,
            JointKind::Ball => ball(log(&from()), last),
            JointKind::Hinge => {
                let ([axis, ..], [last, ..], [middle, ..]) = (self.axes, last, self.middle);
                [hinge(axis, &from(), last, *middle), 0.0, 0.0]
            }
            JointKind::Chain => Axes::new(self.axes).angles(&from(), last, *self.middle),
        }
    }

    /// Its coordinates in a frame; 0 past the ones that it has.
    pub fn read(&self, coordinates: &[f32]) -> [f32; 3] {
        // By number: a copy of a length that is not known is a call.
        match (self.kind.coordinates(), coordinates.get(self.first..).unwrap_or(&[])) {
            (3, [a, b, c, ..]) => [*a, *b, *c],
            (1, [a, ..]) => [*a, 0.0, 0.0],
            _ => [0.0; 3],
        }
    }

    /// Puts its coordinates into a frame.
    pub fn write(&self, own: [f32; 3], coordinates: &mut [f32]) {
        match (self.kind.coordinates(), coordinates.get_mut(self.first..).unwrap_or(&mut [])) {
            (3, [a, b, c, ..]) => [*a, *b, *c] = own,
            (1, [a, ..]) => [*a, ..] = own,
            _ => {}
        }
    }
}

fn is_one(square: f32) -> bool {
    (square - 1.0).abs() < 1e-3
}

/// The axes that a kind uses have length one and stand at right angles.
fn are_axes([a, b, c]: &[[f32; 3]; 3], kind: u16) -> bool {
    let dot = |a: &[f32; 3], b: &[f32; 3]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f32>();
    let square = |a: &[f32; 3], b: &[f32; 3]| dot(a, b).abs() < 1e-3;
    match JointKind::from_code(kind) {
        Some(JointKind::Hinge | JointKind::Slider) => is_one(dot(a, a)),
        Some(JointKind::Chain) => {
            [a, b, c].into_iter().all(|a| is_one(dot(a, a))) && square(a, b) && square(b, c) && square(c, a)
        }
        _ => true,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const AXES: [[f32; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    const REST: [f32; 4] = [0.0, 0.0, 0.0, 1.0];

    #[test]
    fn hinges_share_rows_and_balls_begin_one() {
        use JointKind::{Ball, Fixed, Hinge, Slider};
        let kinds = [Hinge, Hinge, Ball, Fixed, Hinge, Slider, Hinge, Hinge].map(|kind| kind as u16);
        let rig = Rig::new(&kinds, &[AXES; 8], &[REST; 8], &[[0.0; 3]; 8], None).unwrap();
        let first: [usize; 8] = core::array::from_fn(|joint| rig.places().nth(joint).unwrap().1);
        assert_eq!(first, [0, 1, 3, 6, 6, 7, 8, 9]);
        assert_eq!((rig.coordinates(), rig.rows()), (10, 4));
        let body = [Ball, Ball, Hinge].map(|kind| kind as u16);
        let rig = Rig::new(&body, &[AXES; 3], &[REST; 3], &[[0.0; 3]; 3], Some(&[1.0, 0.0, 0.0])).unwrap();
        assert_eq!((rig.places().nth(2).unwrap().1, rig.rows()), (9, 4));
    }

    #[test]
    fn a_joints_weight_is_that_of_its_coordinates() {
        use JointKind::{Ball, Hinge};
        let kinds = [Ball, Hinge, Hinge].map(|kind| kind as u16);
        let (axes, reference, middle) = ([AXES; 3], [REST; 3], [[0.0; 3]; 3]);
        let body = Rig::new(&kinds, &axes, &reference, &middle, Some(&[1.0, 0.0, 0.0])).unwrap();
        let machine = Rig::new(&kinds, &axes, &reference, &middle, None).unwrap();
        let weighed = |rig: &Rig, joint| {
            let mut mask = [[1.0; 3]; 3];
            rig.weigh(joint, 0.5, &mut mask);
            mask
        };
        assert_eq!(weighed(&body, 0), [[0.5; 3], [0.5; 3], [1.0; 3]]);
        assert_eq!(weighed(&machine, 0), [[0.5; 3], [1.0; 3], [1.0; 3]]);
        assert_eq!(weighed(&body, 2), [[1.0; 3], [1.0; 3], [1.0, 0.5, 1.0]]);
        assert_eq!(weighed(&body, 3), [[1.0; 3]; 3]);
    }

    #[test]
    fn tables_that_make_no_rig_are_refused_by_name() {
        let hinge = [JointKind::Hinge as u16; 2];
        let refused = |kinds: &[u16], axes: &[[[f32; 3]; 3]], reference: &[[f32; 4]], across: Option<&[f32; 3]>| {
            Rig::new(kinds, axes, reference, &[[0.0; 3]; 2][..kinds.len()], across).unwrap_err()
        };
        let value = |tensor, index| LoadError::Value { tensor, index };
        assert_eq!(refused(&[1, 9], &[AXES; 2], &[REST; 2], None), value("rig/kinds", 1));
        assert_eq!(refused(&hinge, &[AXES, [[0.0; 3]; 3]], &[REST; 2], None), value("rig/axes", 1));
        assert_eq!(refused(&hinge, &[AXES; 2], &[REST, [0.0; 4]], None), value("rig/reference", 1));
        assert_eq!(refused(&hinge, &[AXES; 2], &[REST; 2], Some(&[0.0; 3])), value("rig/across", 0));
        assert_eq!(refused(&hinge, &[AXES; 2], &[REST; 2], Some(&[1.0, 0.0, 0.0])), value("rig/kinds", 0));
        assert!(matches!(refused(&[], &[], &[], None), LoadError::Shape { .. }));
        assert!(matches!(refused(&hinge, &[AXES], &[REST; 2], None), LoadError::Shape { tensor: "rig/axes", .. }));
    }
}
