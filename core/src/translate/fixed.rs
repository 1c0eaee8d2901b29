//! The linear part of a translator in fixed point: see [`crate::kernel`]'s `fixed` for units and limits.

use super::bank::all_stable;
use super::float::timing;
use crate::kernel::{
    self, FixedBlock, FixedTransition, INPUT_BITS, JOINT_INPUT_CUT, LARGEST_INPUT, OUTPUT_BITS, Rows, STATE_BITS,
};
use crate::model::{Form, LoadError, Pack, TranslatorMeta};

/// Largest bias: 2048 m. With it, the direct term and the states' part no output leaves 32 bits.
const LARGEST_BIAS: u32 = 1 << 29;

/// A direct term in fixed point: 3 x 3, row-major, and the shift of its sums.
type FixedDirect = [i16; 10];

/// From the normalised input to styled coordinates and the clock.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fixed<'a> {
    bias: &'a [[i32; 3]],
    direct: &'a [FixedDirect],
    timing: TimingHead<'a>,
    bank: Bank<'a>,
}

#[derive(Clone, Copy, Debug)]
struct TimingHead<'a> {
    bias: f32,
    range: [f32; 2],
    /// log2 of a unit of the two sums.
    scale: [f32; 2],
    input: Rows<'a>,
    states: Option<Rows<'a>>,
}

#[derive(Clone, Copy, Debug)]
enum Bank<'a> {
    PerJoint {
        counts: &'a [u16],
        blocks: &'a [FixedBlock],
    },
    /// As in [`super::bank::Bank`]; the coordinates follow the states.
    WholeBody {
        states: usize,
        transition: &'a [FixedTransition],
        project: Rows<'a>,
        input: Rows<'a>,
        input_shift: &'a [i16],
        output: Rows<'a>,
        output_shift: &'a [i16],
    },
}

impl<'a> Fixed<'a> {
    pub fn load(pack: &Pack<'a>, meta: &TranslatorMeta, rows: usize) -> Result<Self, LoadError> {
        // Experts have no fixed-point form.
        let tensor = "translate/expert_bias";
        match pack.number(tensor) {
            Err(LoadError::NoTensor { .. }) => {}
            found => return Err(LoadError::NumberType { tensor, found: found? }),
        }
        let bias: &[[i32; 3]] = pack.slice("translate/bias", rows)?;
        let large = |value: &i32| value.unsigned_abs() > LARGEST_BIAS;
        refuse("translate/bias", bias.as_flattened().iter().position(large))?;
        let direct: &[FixedDirect] = pack.slice("translate/direct", rows)?;
        refuse("translate/direct", direct.iter().position(|[.., shift]| !kernel::is_shift(*shift)))?;
        let bank = match meta.form {
            Form::PerJoint => Bank::per_joint(pack, meta, rows)?,
            Form::WholeBody => Bank::whole_body(pack, meta, rows)?,
        };
        let states = match meta.form {
            Form::WholeBody => {
                let count = 2 * meta.blocks as usize + meta.drives as usize;
                Some(Rows::load(pack, "translate/timing_states", 1, count)?)
            }
            Form::PerJoint => None,
        };
        let [bias_of_time, low, high] = timing(pack)?;
        let scale = match pack.slice::<[f32; 2]>("translate/timing_scale", 1)? {
            [scale] => *scale,
            _ => [0.0; 2],
        };
        let input = Rows::load(pack, "translate/timing_input", 1, 3 * rows)?;
        let timing = TimingHead { bias: bias_of_time, range: [low, high], scale, input, states };
        Ok(Self { bias, direct, timing, bank })
    }

    pub fn multiply_adds(&self, rows: usize) -> usize {
        match &self.bank {
            Bank::PerJoint { blocks, .. } => 16 * blocks.len(),
            Bank::WholeBody { states, project, input, output, .. } => {
                let drives = input.columns();
                2 * states + drives * project.columns() + states * drives + 3 * rows * output.columns()
            }
        }
    }

    /// The state that holding `input` for ever leads to, by f32: once, when a stream starts.
    pub fn settle<const ROWS: usize>(&self, input: &[[f32; 3]; ROWS], filters: &mut [i32]) {
        let input = to_fixed(input);
        self.bank.project(&input, filters);
        match self.bank {
            Bank::PerJoint { counts, blocks } => {
                let inputs = counts.iter().zip(&input).flat_map(|(n, u)| core::iter::repeat_n(u, usize::from(*n)));
                for ((block, x), u) in blocks.iter().zip(filters.as_chunks_mut::<2>().0).zip(inputs) {
                    let [a, b, c, d, ..] = *block;
                    let mut drive = [[0; 2]];
                    // From the zero state a step gives what the inputs add.
                    kernel::advance_joint_fixed(core::slice::from_ref(block), cut(*u), &mut drive, &mut [0; 3]);
                    *x = settle([a, b, c, d], drive[0]);
                }
            }
            Bank::WholeBody { states, transition, input, input_shift, .. } => {
                if let Some((x, drives)) = filters.split_at_mut_checked(states) {
                    x.fill(0);
                    let x = x.as_chunks_mut().0;
                    kernel::advance_fixed(transition, shifted(&input, input_shift, drives), x);
                    for (block, x) in transition.iter().zip(x) {
                        *x = settle(*block, *x);
                    }
                }
            }
        }
    }

    /// One frame: `output` in m; log2 of the duration.
    pub fn step<const ROWS: usize>(
        &self,
        input: &[[f32; 3]; ROWS],
        filters: &mut [i32],
        output: &mut [[f32; 3]; ROWS],
    ) -> f32 {
        let input = to_fixed(input);
        let mut y = [[0; 3]; ROWS];
        self.apply_direct(&input, &mut y);
        self.bank.project(&input, filters);
        let log2 = self.timing.evaluate(input.as_flattened(), filters);
        self.bank.advance(&input, filters, &mut y);
        for (output, y) in output.as_flattened_mut().iter_mut().zip(y.as_flattened()) {
            *output = kernel::from_output(*y);
        }
        log2
    }

    /// `y = bias + D_joint u`.
    #[inline(never)]
    fn apply_direct(&self, input: &[[i32; 3]], y: &mut [[i32; 3]]) {
        for (((y, bias), direct), [u0, u1, u2]) in y.iter_mut().zip(self.bias).zip(self.direct).zip(input) {
            let [a, b, c, d, e, f, g, h, i, shift] = *direct;
            let row = |bias: i32, d0, d1, d2| {
                let sum = kernel::scale16(d0, *u0).wrapping_add(kernel::scale16(d1, *u1));
                bias.wrapping_add(sum.wrapping_add(kernel::scale16(d2, *u2)).wrapping_shr(shift as u32))
            };
            let [first, second, third] = *bias;
            *y = [row(first, a, b, c), row(second, d, e, f), row(third, g, h, i)];
        }
    }
}

/// Normalised inputs as integers.
#[inline(never)]
fn to_fixed<const ROWS: usize>(input: &[[f32; 3]; ROWS]) -> [[i32; 3]; ROWS] {
    input.map(|u| u.map(|u| kernel::to_fixed(u, INPUT_BITS, LARGEST_INPUT)))
}

/// An input of one joint's recursion, rounded to nearest; at most 2^15 in size.
fn cut(u: [i32; 3]) -> [i32; 3] {
    u.map(|u| (u + (1 << (JOINT_INPUT_CUT - 1))) >> JOINT_INPUT_CUT)
}

/// What the coordinates add to the states, in halves of a state's unit.
fn shifted<'x>(input: &'x Rows, shifts: &'x [i16], drives: &'x [i32]) -> impl Iterator<Item = i32> + use<'x> {
    input.sums(drives).zip(shifts).map(|(sum, shift)| sum.wrapping_shr(*shift as u32))
}

fn settle(block: FixedTransition, drive: [i32; 2]) -> [i32; 2] {
    const LIMIT: f32 = (1u32 << STATE_BITS) as f32;
    let settled = kernel::settle(&kernel::transition(block), drive.map(|drive| drive as f32));
    settled.map(|x| x.clamp(-LIMIT, LIMIT) as i32)
}

impl TimingHead<'_> {
    fn evaluate(&self, input: &[i32], filters: &[i32]) -> f32 {
        let [of_input, of_states] = self.scale;
        let sum = |rows: &Rows, x| rows.sums(x).fold(0, |_, sum| sum) as f32;
        let states = self.states.as_ref().map_or(0.0, |rows| of_states * sum(rows, filters));
        let [low, high] = self.range;
        (self.bias + of_input * sum(&self.input, input) + states).max(low).min(high)
    }
}

impl<'a> Bank<'a> {
    fn per_joint(pack: &Pack<'a>, meta: &TranslatorMeta, rows: usize) -> Result<Self, LoadError> {
        let counts: &[u16] = pack.slice("translate/blocks_per_joint", rows)?;
        let blocks: &[FixedBlock] = pack.slice("translate/joint_blocks", meta.blocks as usize)?;
        let total: usize = counts.iter().map(|count| *count as usize).sum();
        if total != blocks.len() {
            return Err(LoadError::Shape {
                tensor: "translate/blocks_per_joint",
                found: total,
                expected: blocks.len(),
            });
        }
        all_stable(blocks.iter().map(|[a, b, c, d, ..]| kernel::transition([*a, *b, *c, *d])))?;
        refuse("translate/joint_blocks", blocks.iter().position(|block| !kernel::is_bounded(block)))?;
        // A joint's states add at most 2^30 to an output: see `LARGEST_BIAS`.
        let mut first = 0;
        let mut rest = blocks;
        for count in counts {
            let Some((own, others)) = rest.split_at_checked(*count as usize) else { break };
            let most = own
                .iter()
                .fold(0u32, |sum, [.., shift]| sum.saturating_add((1u32 << STATE_BITS).wrapping_shr(*shift as u32)));
            refuse("translate/joint_blocks", (most > 1 << 30).then_some(first))?;
            first += own.len();
            rest = others;
        }
        Ok(Self::PerJoint { counts, blocks })
    }

    fn whole_body(pack: &Pack<'a>, meta: &TranslatorMeta, rows: usize) -> Result<Self, LoadError> {
        let states = 2 * meta.blocks as usize;
        let drives = meta.drives as usize;
        let transition: &[FixedTransition] = pack.slice("translate/transition", meta.blocks as usize)?;
        all_stable(transition.iter().map(|block| kernel::transition(*block)))?;
        let shifts = |name, rows| {
            let shifts: &'a [i16] = pack.slice(name, rows)?;
            refuse(name, shifts.iter().position(|shift| !kernel::is_shift(*shift)))?;
            Ok::<_, LoadError>(shifts)
        };
        Ok(Self::WholeBody {
            states,
            transition,
            project: Rows::load(pack, "translate/project", drives, 3 * rows)?,
            input: Rows::load(pack, "translate/input", states, drives)?,
            input_shift: shifts("translate/input_shift", states)?,
            output: Rows::load(pack, "translate/output", 3 * rows, states.saturating_add(drives))?,
            output_shift: shifts("translate/output_shift", 3 * rows)?,
        })
    }

    fn project(&self, u: &[[i32; 3]], filters: &mut [i32]) {
        if let Self::WholeBody { states, project, .. } = self
            && let Some((_, drives)) = filters.split_at_mut_checked(*states)
        {
            for (drive, sum) in drives.iter_mut().zip(project.sums(u.as_flattened())) {
                *drive = sum;
            }
        }
    }

    /// `y += C x (+ D p)`, then `x' = A x + B u`.
    #[inline(never)]
    fn advance(&self, u: &[[i32; 3]], filters: &mut [i32], y: &mut [[i32; 3]]) {
        match *self {
            Self::PerJoint { counts, mut blocks } => {
                let (mut filters, _) = filters.as_chunks_mut::<2>();
                for ((count, u), y) in counts.iter().zip(u).zip(y) {
                    let Some((own, rest)) = blocks.split_at_checked(*count as usize) else { return };
                    let Some((x, others)) = filters.split_at_mut_checked(own.len()) else { return };
                    kernel::advance_joint_fixed(own, cut(*u), x, y);
                    (blocks, filters) = (rest, others);
                }
            }
            Self::WholeBody { states, transition, input, input_shift, output, output_shift, .. } => {
                let sums = output.sums(filters).zip(output_shift);
                for (y, (sum, shift)) in y.as_flattened_mut().iter_mut().zip(sums) {
                    *y = y.wrapping_add(sum.wrapping_shr(*shift as u32));
                }
                if let Some((x, drives)) = filters.split_at_mut_checked(states) {
                    kernel::advance_fixed(transition, shifted(&input, input_shift, drives), x.as_chunks_mut().0);
                }
            }
        }
    }
}

fn refuse(tensor: &'static str, index: Option<usize>) -> Result<(), LoadError> {
    index.map_or(Ok(()), |index| Err(LoadError::Value { tensor, index }))
}

// The unit of an output is the kernel's; the bias's limit is in it.
const _: () = assert!(LARGEST_BIAS >> OUTPUT_BITS == 2048);
