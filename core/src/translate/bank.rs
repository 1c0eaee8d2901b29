//! The dynamic part of a translator in f32, in one of its two forms.

use crate::kernel::{self, Block, JointBlock, Tiled};
use crate::model::{Form, LoadError, Pack, TranslatorMeta};

#[derive(Clone, Copy, Debug)]
pub(super) enum Bank<'a> {
    PerJoint {
        /// Blocks of each joint.
        counts: &'a [u16],
        blocks: &'a [JointBlock],
    },
    WholeBody {
        /// Number of filter states; the principal coordinates follow them in the state vector.
        states: usize,
        transition: &'a [Block],
        /// Principal coordinates from the normalised input, `drives x 3 joints`.
        project: Tiled<'a>,
        /// `B`, `states x drives`.
        input: Tiled<'a>,
        /// `[C D]`, `3 rows x (states + drives)`, rad or m.
        output: Tiled<'a>,
    },
}

impl<'a> Bank<'a> {
    pub fn load(pack: &Pack<'a>, meta: &TranslatorMeta, rows: usize) -> Result<Self, LoadError> {
        match meta.form {
            Form::PerJoint => per_joint(pack, meta, rows),
            Form::WholeBody => whole_body(pack, meta, rows),
        }
    }

    pub fn multiply_adds(&self, rows: usize) -> usize {
        match self {
            Self::PerJoint { blocks, .. } => 16 * blocks.len(),
            Self::WholeBody { states, project, input, output, .. } => {
                let drives = input.columns();
                2 * states + drives * project.columns() + states * drives + 3 * rows * output.columns()
            }
        }
    }

    /// The principal coordinates, into the state vector behind the filter states. Nothing in the per-joint form.
    pub fn project(&self, u: &[[f32; 3]], filters: &mut [f32]) {
        if let Self::WholeBody { states, project, input, .. } = self {
            let drives = filters.split_at_mut_checked(*states).and_then(|(_, rest)| rest.get_mut(..input.columns()));
            if let Some(drives) = drives {
                drives.fill(0.0);
                project.multiply_add(u.as_flattened(), drives);
            }
        }
    }

    /// `y += C x (+ D p)`, then `x' = A x + B u`. The whole-body form reads the coordinates `p` from the state vector.
    pub fn advance(&self, u: &[[f32; 3]], filters: &mut [f32], y: &mut [[f32; 3]]) {
        match *self {
            Self::PerJoint { counts, mut blocks } => {
                let (mut filters, _) = filters.as_chunks_mut::<2>();
                for ((count, u), y) in counts.iter().zip(u).zip(y) {
                    let Some((own, rest)) = blocks.split_at_checked(*count as usize) else { return };
                    let Some((x, others)) = filters.split_at_mut_checked(own.len()) else { return };
                    kernel::advance_joint(own, *u, x, y);
                    (blocks, filters) = (rest, others);
                }
            }
            Self::WholeBody { states, transition, input, output, .. } => {
                output.multiply_add(filters, y.as_flattened_mut());
                if let Some((x, drives)) = filters.split_at_mut_checked(states) {
                    kernel::advance(transition, x.as_chunks_mut().0);
                    input.multiply_add(drives, x);
                }
            }
        }
    }

    /// The state that holding `u` for ever leads to.
    pub fn settle(&self, u: &[[f32; 3]], filters: &mut [f32]) {
        self.project(u, filters);
        match *self {
            Self::PerJoint { counts, blocks } => {
                let inputs = counts.iter().zip(u).flat_map(|(count, u)| core::iter::repeat_n(u, *count as usize));
                for ((block, x), [u0, u1, u2]) in blocks.iter().zip(filters.as_chunks_mut().0).zip(inputs) {
                    let [a, b, c, d, b00, b01, b02, b10, b11, b12, ..] = *block;
                    let drive = [b00 * u0 + b01 * u1 + b02 * u2, b10 * u0 + b11 * u1 + b12 * u2];
                    *x = kernel::settle(&[a, b, c, d], drive);
                }
            }
            Self::WholeBody { states, transition, input, .. } => {
                if let Some((x, drives)) = filters.split_at_mut_checked(states) {
                    x.fill(0.0);
                    input.multiply_add(drives, x);
                    for (block, x) in transition.iter().zip(x.as_chunks_mut().0) {
                        *x = kernel::settle(block, *x);
                    }
                }
            }
        }
    }
}

fn per_joint<'a>(pack: &Pack<'a>, meta: &TranslatorMeta, rows: usize) -> Result<Bank<'a>, LoadError> {
    let counts: &[u16] = pack.slice("translate/blocks_per_joint", rows)?;
    let blocks: &[JointBlock] = pack.slice("translate/joint_blocks", meta.blocks as usize)?;
    let total: usize = counts.iter().map(|count| *count as usize).sum();
    if total != blocks.len() {
        return Err(LoadError::Shape { tensor: "translate/blocks_per_joint", found: total, expected: blocks.len() });
    }
    all_stable(blocks.iter().map(|[a, b, c, d, ..]| [*a, *b, *c, *d]))?;
    Ok(Bank::PerJoint { counts, blocks })
}

fn whole_body<'a>(pack: &Pack<'a>, meta: &TranslatorMeta, rows: usize) -> Result<Bank<'a>, LoadError> {
    let states = 2 * meta.blocks as usize;
    let drives = meta.drives as usize;
    let transition: &[Block] = pack.slice("translate/transition", meta.blocks as usize)?;
    all_stable(transition.iter().copied())?;
    Ok(Bank::WholeBody {
        states,
        transition,
        project: Tiled::load(pack, "translate/project", drives, 3 * rows)?,
        input: Tiled::load(pack, "translate/input", states, drives)?,
        output: Tiled::load(pack, "translate/output", 3 * rows, states + drives)?,
    })
}

pub(super) fn all_stable(blocks: impl Iterator<Item = Block>) -> Result<(), LoadError> {
    for (block, entries) in blocks.enumerate() {
        if !kernel::is_stable(&entries) {
            return Err(LoadError::Unstable { block });
        }
    }
    Ok(())
}
