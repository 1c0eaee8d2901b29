//! A trained model run in f64 on a whole clip, before it becomes a pack. Previews use the device's code instead.

use faer::Mat;

use super::dynamics::Dynamics;
use super::model::{BankModel, TranslatorModel};
use crate::rig::Locals;

/// Coordinates that the model makes of a clip, rad or m, `[frames x 3 rows]`.
pub fn simulate(model: &TranslatorModel, source: &Locals) -> Vec<f64> {
    let channels = 3 * source.rows;
    let mut styled = Vec::with_capacity(source.coordinates.len());
    let input: Vec<Vec<f64>> = source
        .coordinates
        .chunks_exact(channels)
        .map(|row| {
            let centred = row.iter().zip(&model.mean).zip(&model.inverse_deviation);
            centred.map(|((x, mean), scale)| (x - mean) * scale).collect()
        })
        .collect();
    let dynamic = dynamic_part(model, &input, channels);
    for (frame, u) in input.iter().enumerate() {
        for channel in 0..channels {
            let (joint, row) = (channel / 3, channel % 3);
            let direct: f64 = (0..3).map(|d| model.direct[9 * joint + 3 * row + d] * u[3 * joint + d]).sum();
            styled.push(model.bias[channel] + direct + dynamic[(frame, channel)]);
        }
    }
    styled
}

/// `C x (+ D p)`, `[frames x channels]`.
fn dynamic_part(model: &TranslatorModel, input: &[Vec<f64>], channels: usize) -> Mat<f64> {
    match &model.bank {
        BankModel::PerJoint(bank) => {
            let mut output = Mat::zeros(input.len(), channels);
            for (joint, blocks) in bank.iter().enumerate() {
                let u = Mat::from_fn(input.len(), 3, |t, d| input[t][3 * joint + d]);
                let dynamics = Dynamics {
                    transition: blocks.iter().map(|b| [b[0], b[1], b[2], b[3]]).collect(),
                    input: blocks.iter().flat_map(|b| &b[4..10]).copied().collect(),
                    inputs: 3,
                };
                let c = Mat::from_fn(dynamics.states(), 3, |s, row| blocks[s / 2][10 + 3 * (s % 2) + row]);
                let y = dynamics.states_before(&u) * c;
                (0..3).for_each(|d| output.col_mut(3 * joint + d).copy_from(y.col(d)));
            }
            output
        }
        BankModel::WholeBody { project, transition, input: b, output } => {
            let drives = project.len() / channels;
            let project = Mat::from_fn(channels, drives, |c, p| project[p * channels + c]);
            let u = Mat::from_fn(input.len(), channels, |t, c| input[t][c]) * project;
            let dynamics = Dynamics { transition: transition.clone(), input: b.clone(), inputs: drives };
            let states = dynamics.states();
            let x = dynamics.states_before(&u);
            let z = Mat::from_fn(
                u.nrows(),
                states + drives,
                |t, i| if i < states { x[(t, i)] } else { u[(t, i - states)] },
            );
            z * Mat::from_fn(states + drives, channels, |i, c| output[c * (states + drives) + i])
        }
    }
}
