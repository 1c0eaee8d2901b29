//! Translators from f32 to fixed point: int16 coefficients, int32 states.
//!
//! Scales are not guessed from clips: a state's scale is the largest at which no input within the kernel's range can take it out
//! of its own, the sum of the sizes of its impulse response. So nothing saturates, whatever comes in.

use kinesic::kernel::{
    Block, INPUT_BITS, JOINT_INPUT_CUT, JointBlock, LARGEST_INPUT, LARGEST_JOINT_ROW, LARGEST_ROW, OUTPUT_BITS,
    STATE_BITS, TRANSITION_BITS, is_stable,
};
use kinesic::model::{Form, LoadError, TensorType, TranslatorMeta};
use kinesic::{Pack, Rig};

use super::{QuantiseError, named};
use crate::pack::layout::row_major;
use crate::pack::{PackFile, PackWriter, Provenance};

/// Largest shift that a pack may hold.
const MOST_SHIFT: i32 = 31;

/// Share of a state's range that the bound may use; the rest is for rounding.
const HEADROOM: f64 = 0.98;

/// Products lose their 16 low bits.
const PRODUCT: f64 = 65_536.0;

/// A block in coordinates in which its entries are below 1: `x = T z`.
struct Canonical {
    transition: [i16; 4],
    /// Row-major.
    into: [f64; 4],
    back: [f64; 4],
}

/// The pack with its translator in fixed point. Everything else is copied bit for bit; nothing random.
pub fn to_int16(file: &PackFile, provenance: &Provenance) -> Result<Vec<u8>, QuantiseError> {
    let pack = file.pack()?;
    let metadata = pack.metadata();
    let Some(meta) = metadata.models.iter().find_map(|model| model.translator()) else {
        return Err(QuantiseError::NoTranslator { found: named(&pack) });
    };
    if pack.number("translate/direct")? == TensorType::I16 {
        return Err(QuantiseError::Done { number: "int16" });
    }
    if pack.number("translate/expert_bias").is_ok() {
        return Err(QuantiseError::Experts);
    }
    let rows = Rig::load(&pack)?.rows();
    let mut out = PackWriter::new(pack.kind(), metadata.name, metadata.frame_rate);
    metadata.joints.iter().for_each(|joint| out.joint(joint.name, joint.parent));
    metadata.models.iter().for_each(|model| out.model(&model));
    const KEPT: [&str; 4] =
        ["translate/mean", "translate/inverse_deviation", "translate/timing", "translate/blocks_per_joint"];
    for tensor in metadata.tensors.iter() {
        // The gate is a small part, and its distances want the range of floats.
        let kept = KEPT.contains(&tensor.name) || tensor.name.starts_with("translate/gate_");
        if kept || !tensor.name.starts_with("translate/") {
            out.copy(&tensor, pack.bytes(&tensor).ok_or(LoadError::Metadata)?);
        }
    }
    static_part(&pack, rows, &mut out)?;
    match meta.form {
        Form::PerJoint => {
            let timing = pack.slice("translate/timing_input", 3 * rows)?;
            clock(&mut out, &double(timing), None);
            per_joint(&pack, &meta, &mut out)?;
        }
        Form::WholeBody => whole_body(&pack, &meta, rows, &mut out)?,
    }
    Ok(out.finish(provenance))
}

fn double(values: &[f32]) -> Vec<f64> {
    values.iter().map(|value| f64::from(*value)).collect()
}

/// Bias and direct term.
fn static_part(pack: &Pack, rows: usize, out: &mut PackWriter) -> Result<(), QuantiseError> {
    let bias: &[[f32; 3]] = pack.slice("translate/bias", rows)?;
    let unit = f64::from(1u32 << OUTPUT_BITS);
    let mut biases = Vec::new();
    for (joint, bias) in bias.iter().enumerate() {
        for value in bias {
            let rounded = (f64::from(*value) * unit).round();
            if rounded.abs() > f64::from(1u32 << 29) {
                return Err(range("translate/bias", joint, f64::from(*value)));
            }
            biases.push(rounded as i32);
        }
    }
    out.i32s("translate/bias", 3, &biases);
    let direct: &[[f32; 9]] = pack.slice("translate/direct", rows)?;
    let scale = unit * PRODUCT / f64::from(1u32 << INPUT_BITS);
    let mut directs = Vec::new();
    for (joint, direct) in direct.iter().enumerate() {
        let scaled: Vec<f64> = direct.iter().map(|d| f64::from(*d) * scale).collect();
        let (rounded, shift) =
            shifted(&[&scaled], u32::MAX).ok_or_else(|| range("translate/direct", joint, largest(&scaled) / scale))?;
        directs.extend(rounded);
        directs.push(shift);
    }
    out.i16s("translate/direct", 10, &directs);
    Ok(())
}

/// The clock: one row over the inputs, one over the states and coordinates, and what their sums are worth.
fn clock(out: &mut PackWriter, input: &[f64], states: Option<&[f64]>) {
    let (input, gain) = row(input);
    // A unit of the sum: weight / 2^16 times a deviation / 2^24.
    let of_input = PRODUCT / f64::from(1u32 << INPUT_BITS) / gain;
    out.i16s("translate/timing_input", 1, &input);
    let (states, gain) = row(states.unwrap_or(&[]));
    out.i16s("translate/timing_states", 1, &states);
    out.f32s("translate/timing_scale", 2, &[of_input as f32, (PRODUCT / gain) as f32]);
}

fn per_joint(pack: &Pack, meta: &TranslatorMeta, out: &mut PackWriter) -> Result<(), QuantiseError> {
    let blocks: &[JointBlock] = pack.slice("translate/joint_blocks", meta.blocks as usize)?;
    let most = f64::from(LARGEST_INPUT) / f64::from(1u32 << INPUT_BITS);
    let mut all = Vec::new();
    for (index, block) in blocks.iter().enumerate() {
        let v = block.map(f64::from);
        let canonical = canonical(index, [v[0], v[1], v[2], v[3]])?;
        let b = multiply(&canonical.back, &[v[4..7].to_vec(), v[7..10].to_vec()]);
        let scale = state_scale(&canonical, &b, &[most; 3]);
        // Halves of a state's unit, from an input in int16.
        let unit = scale / 2.0 * f64::from(1u32 << JOINT_INPUT_CUT) / f64::from(1u32 << INPUT_BITS);
        let b = b.map(|row| row.iter().map(|b| b * unit).collect::<Vec<f64>>());
        let (input, input_shift) = shifted(&[&b[0], &b[1]], LARGEST_JOINT_ROW)
            .ok_or_else(|| range("translate/joint_blocks", index, largest(&b[0])))?;
        let unit = f64::from(1u32 << OUTPUT_BITS) * PRODUCT / scale;
        let [t00, t01, t10, t11] = canonical.into;
        // Columns of C T: first state's three outputs, then the second's.
        let c: Vec<f64> = (0..3)
            .map(|y| (v[10 + y] * t00 + v[13 + y] * t10) * unit)
            .chain((0..3).map(|y| (v[10 + y] * t01 + v[13 + y] * t11) * unit))
            .collect();
        let (output, output_shift) =
            shifted(&[&c], u32::MAX).ok_or_else(|| range("translate/joint_blocks", index, largest(&c) / unit))?;
        all.extend(canonical.transition);
        all.extend(input);
        all.extend(output);
        all.extend([input_shift, output_shift]);
    }
    out.i16s("translate/joint_blocks", 18, &all);
    Ok(())
}

fn whole_body(pack: &Pack, meta: &TranslatorMeta, rows: usize, out: &mut PackWriter) -> Result<(), QuantiseError> {
    let (states, drives, channels) = (2 * meta.blocks as usize, meta.drives as usize, 3 * rows);
    let project = matrix(pack, "translate/project", drives, channels)?;
    let (mut rounded, mut gains, mut bounds) = (Vec::new(), Vec::new(), Vec::new());
    let most = f64::from(LARGEST_INPUT) / f64::from(1u32 << INPUT_BITS);
    for values in &project {
        let (weights, gain) = row(values);
        rounded.extend(weights);
        gains.push(gain * f64::from(1u32 << INPUT_BITS) / PRODUCT);
        bounds.push(most * values.iter().map(|w| w.abs()).sum::<f64>());
    }
    out.i16s("translate/project", channels, &rounded);

    let blocks: &[Block] = pack.slice("translate/transition", meta.blocks as usize)?;
    let input = matrix(pack, "translate/input", states, drives)?;
    let (mut transition, mut inputs, mut shifts) = (Vec::new(), Vec::new(), Vec::new());
    let mut coordinates = Vec::new();
    for (index, (block, b)) in blocks.iter().zip(input.as_chunks::<2>().0).enumerate() {
        let canonical = canonical(index, block.map(f64::from))?;
        let b = multiply(&canonical.back, b);
        let scale = state_scale(&canonical, &b, &bounds);
        for (row, b) in b.iter().enumerate() {
            let scaled: Vec<f64> = b.iter().zip(&gains).map(|(b, gain)| scale / 2.0 * b / gain * PRODUCT).collect();
            let (weights, shift) = shifted(&[&scaled], LARGEST_ROW)
                .ok_or_else(|| range("translate/input", 2 * index + row, largest(b)))?;
            inputs.extend(weights);
            shifts.push(shift);
        }
        transition.extend(canonical.transition);
        coordinates.push((canonical.into, scale));
    }
    out.i16s("translate/transition", 4, &transition);
    out.i16s("translate/input", drives, &inputs);
    out.i16s("translate/input_shift", 1, &shifts);

    // What a state or a coordinate adds, in its integer unit.
    let in_units = |values: &[f64]| -> Vec<f64> {
        let of_states =
            values.as_chunks::<2>().0.iter().zip(&coordinates).flat_map(|([first, second], (into, scale))| {
                let [t00, t01, t10, t11] = into;
                [(first * t00 + second * t10) / scale, (first * t01 + second * t11) / scale]
            });
        let of_drives = values[states..].iter().zip(&gains).map(|(value, gain)| value / gain);
        of_states.take(states).chain(of_drives).collect()
    };
    let unit = f64::from(1u32 << OUTPUT_BITS) * PRODUCT;
    let (mut outputs, mut shifts) = (Vec::new(), Vec::new());
    for (index, values) in matrix(pack, "translate/output", channels, states + drives)?.iter().enumerate() {
        let scaled: Vec<f64> = in_units(values).iter().map(|value| value * unit).collect();
        let (weights, shift) =
            shifted(&[&scaled], LARGEST_ROW).ok_or_else(|| range("translate/output", index, largest(values)))?;
        outputs.extend(weights);
        shifts.push(shift);
    }
    out.i16s("translate/output", states + drives, &outputs);
    out.i16s("translate/output_shift", 1, &shifts);
    let of_input = double(pack.slice("translate/timing_input", channels)?);
    let of_states = in_units(&double(pack.slice("translate/timing_states", states + drives)?));
    clock(out, &of_input, Some(&of_states));
    Ok(())
}

fn matrix(pack: &Pack, name: &'static str, rows: usize, columns: usize) -> Result<Vec<Vec<f64>>, LoadError> {
    let values = row_major(pack, name, rows, columns)?;
    Ok(values.chunks_exact(columns.max(1)).map(double).collect())
}

fn range(layer: &'static str, row: usize, found: f64) -> QuantiseError {
    QuantiseError::Range { layer, row, found: found as f32 }
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, value| most.max(value.abs()))
}

/// `m v` for a 2 x 2 matrix and two rows.
fn multiply(m: &[f64; 4], rows: &[Vec<f64>; 2]) -> [Vec<f64>; 2] {
    let combine = |a: f64, b: f64| rows[0].iter().zip(&rows[1]).map(|(x, y)| a * x + b * y).collect();
    [combine(m[0], m[1]), combine(m[2], m[3])]
}

/// Rotation and scaling for a pair of complex poles; for real ones the coupling made small.
fn canonical(index: usize, [a, b, c, d]: [f64; 4]) -> Result<Canonical, QuantiseError> {
    let half = (a - d) / 2.0;
    let turn = -(half * half + b * c);
    let into = if turn > 0.0 {
        // Real and imaginary part of an eigenvector.
        [b, 0.0, -half, turn.sqrt()]
    } else if c == 0.0 {
        [1.0, 0.0, 0.0, (0.5 / b.abs()).min(1.0)]
    } else if b == 0.0 {
        [(0.5 / c.abs()).min(1.0), 0.0, 0.0, 1.0]
    } else {
        [1.0, 0.0, 0.0, (c / b).abs().sqrt()]
    };
    let det = into[0] * into[3] - into[1] * into[2];
    let back = [into[3] / det, -into[1] / det, -into[2] / det, into[0] / det];
    let product = |m: [f64; 4], n: [f64; 4]| {
        [m[0] * n[0] + m[1] * n[2], m[0] * n[1] + m[1] * n[3], m[2] * n[0] + m[3] * n[2], m[2] * n[1] + m[3] * n[3]]
    };
    let unit = f64::from(1u32 << TRANSITION_BITS);
    let rounded = product(back, product([a, b, c, d], into)).map(|entry| (entry * unit).round());
    let entries = rounded.map(|entry| (entry / unit) as f32);
    if largest(&rounded) > f64::from(i16::MAX) || !is_stable(&entries) {
        return Err(QuantiseError::Pole { block: index });
    }
    Ok(Canonical { transition: rounded.map(|entry| entry as i16), into, back })
}

/// Integer units of a state's unit: inputs up to `bounds` never take either state of the block out of its range.
fn state_scale(block: &Canonical, b: &[Vec<f64>; 2], bounds: &[f64]) -> f64 {
    let [a00, a01, a10, a11] = block.transition.map(|entry| f64::from(entry) / f64::from(1u32 << TRANSITION_BITS));
    let mut size = [0.0f64; 2];
    for ((b0, b1), bound) in b[0].iter().zip(&b[1]).zip(bounds) {
        let (mut x, mut y) = (*b0, *b1);
        let mut sum = [0.0f64; 2];
        // A pole of int16 is at least 2^-16 inside the circle: this is many of its time constants.
        for _ in 0..1_000_000 {
            sum = [sum[0] + x.abs(), sum[1] + y.abs()];
            (x, y) = (a00 * x + a01 * y, a10 * x + a11 * y);
            if x.abs().max(y.abs()) < 1e-12 * sum[0].max(sum[1]) {
                break;
            }
        }
        size = [size[0] + bound * sum[0], size[1] + bound * sum[1]];
    }
    let most = size[0].max(size[1]);
    if most > 0.0 { HEADROOM * f64::from(1u32 << STATE_BITS) / most } else { 1.0 }
}

/// A row rounded at the largest gain that keeps it within [`LARGEST_ROW`], and that gain.
fn row(values: &[f64]) -> (Vec<i16>, f64) {
    let sum: f64 = values.iter().map(|value| value.abs()).sum();
    if sum == 0.0 {
        return (vec![0; values.len()], 1.0);
    }
    let room = f64::from(LARGEST_ROW) - values.len() as f64;
    let gain = (room / sum).min(f64::from(i16::MAX) / largest(values));
    (values.iter().map(|value| (value * gain).round() as i16).collect(), gain)
}

/// Rows rounded after a shift to the left, the largest that int16 and the rows' limit allow, and that shift; `None` if not even
/// no shift fits.
fn shifted(rows: &[&[f64]], most: u32) -> Option<(Vec<i16>, i16)> {
    let fits = |shift: i32| {
        let scale = f64::from(shift).exp2();
        rows.iter().all(|row| {
            let sum: f64 = row.iter().map(|value| (value * scale).round().abs()).sum();
            largest(row) * scale <= f64::from(i16::MAX) && sum <= f64::from(most)
        })
    };
    let shift = (0..=MOST_SHIFT).rev().find(|shift| fits(*shift))?;
    let scale = f64::from(shift).exp2();
    Some((rows.iter().flat_map(|row| row.iter().map(|value| (value * scale).round() as i16)).collect(), shift as i16))
}
