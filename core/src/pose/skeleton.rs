//! The skeleton, as the pack holds it.

use crate::model::{LoadError, Pack};

/// Joints that give the heading: up to two left-right pairs.
pub(crate) type Across<'a> = &'a [[u16; 2]];

/// A tree of joints, parents first, borrowed from a pack.
#[derive(Clone, Copy, Debug)]
pub struct Skeleton<'a> {
    pub(super) parents: &'a [u16],
    pub(super) offsets: &'a [[f32; 3]],
    pub(super) across: Across<'a>,
}

impl<'a> Skeleton<'a> {
    /// The skeleton of a pack.
    pub fn load(pack: &Pack<'a>) -> Result<Self, LoadError> {
        let joints = pack.metadata().joints.len();
        let parents = pack.slice("skeleton/parents", joints)?;
        let offsets = pack.slice("skeleton/offsets", joints)?;
        let across = pack.slice("skeleton/across", pack.rows("skeleton/across")?)?;
        Self::new(parents, offsets, across)
    }

    /// A skeleton from its parts.
    ///
    /// - `parents`: index of each joint's parent, smaller than its own; the root's entry is its own index, 0
    /// - `offsets`: rest position relative to the parent, m; the root's is ignored
    /// - `across`: `[left, right]` pairs of joints whose connection gives the [`Heading`](super::Heading), usually the hips
    pub fn new(parents: &'a [u16], offsets: &'a [[f32; 3]], across: &'a [[u16; 2]]) -> Result<Self, LoadError> {
        let joints = parents.len();
        let value = |tensor, index: Option<usize>| match index {
            Some(index) => Err(LoadError::Value { tensor, index }),
            None => Ok(()),
        };
        if joints == 0 || joints > u16::MAX as usize {
            return Err(LoadError::Shape { tensor: "skeleton/parents", found: joints, expected: 1 });
        }
        if offsets.len() != joints {
            return Err(LoadError::Shape { tensor: "skeleton/offsets", found: offsets.len(), expected: joints });
        }
        let misplaced =
            |(joint, parent): (usize, &u16)| if joint == 0 { *parent != 0 } else { *parent as usize >= joint };
        value("skeleton/parents", parents.iter().enumerate().position(misplaced))?;
        value("skeleton/across", across.iter().position(|pair| pair.iter().any(|joint| *joint as usize >= joints)))?;
        Ok(Self { parents, offsets, across })
    }

    /// Number of joints.
    pub fn joints(&self) -> usize {
        self.parents.len()
    }
}
