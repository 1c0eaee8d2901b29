//! One frame of style translation.

use nalgebra::Vector3;

use super::model::Linear;
use super::{Timing, Translator, TranslatorState};
use crate::model::Numbers;
use crate::pose::{Heading, Pose, World, forward, local_positions, nlerp, solve};

impl<const JOINTS: usize, const STATES: usize, N: Numbers> Translator<'_, JOINTS, STATES, N> {
    /// Puts the filters where holding the pose of the first frame for ever would have brought them.
    ///
    /// Without it they start from zero, as if the mean pose of the training had been held; then the first half second
    /// eases in. Cost: as a step, and a division a block.
    pub fn start(&self, state: &mut TranslatorState<JOINTS, STATES>, source: &Pose<JOINTS>) {
        state.reset();
        let mut world = World::identity();
        forward(&self.skeleton, source, &mut world);
        state.heading = state.heading.follow(&self.skeleton, &world);
        let input = self.normalised(&self.local(state.heading, Vector3::zeros(), &world));
        match &self.linear {
            Linear::Float(linear) if N::FLOAT => linear.settle(&input, state.view()),
            Linear::Fixed(linear) if N::INTEGER => linear.settle(&input, state.view()),
            _ => {}
        }
        state.last_root = Some(source.root);
    }

    /// Translates one frame: `source` in, `styled` out. Infallible; every loop has a length fixed at load time.
    ///
    /// The root's height and travel are translated, its heading is the source's. Strength 0 gives the source pose to
    /// rounding, a mask of 0 leaves a joint's rotation alone. Cost: [`multiply_adds`](Self::multiply_adds) plus about 250
    /// a joint for kinematics.
    pub fn step(
        &self,
        state: &mut TranslatorState<JOINTS, STATES>,
        source: &Pose<JOINTS>,
        styled: &mut Pose<JOINTS>,
    ) -> Timing {
        let mut world = World::identity();
        forward(&self.skeleton, source, &mut world);
        let heading = state.heading.follow(&self.skeleton, &world);
        state.heading = heading;
        let travel = source.root - state.last_root.unwrap_or(source.root);
        state.last_root = Some(source.root);

        let local = self.local(heading, travel, &world);
        let input = self.normalised(&local);
        let mut output = [[0.0; 3]; JOINTS];
        let log2 = match &self.linear {
            // Guards are constant: code of number types that N leaves out is not linked.
            Linear::Float(linear) if N::FLOAT => linear.step(&input, state.view(), &mut output),
            Linear::Fixed(linear) if N::INTEGER => linear.step(&input, state.view(), &mut output),
            _ => 0.0,
        };

        let targets = self.targets(state, heading, source.root, &local, &output, &world);
        solve(&self.skeleton, source, &world, &targets, styled);
        for ((styled, source), weight) in styled.rotations.iter_mut().zip(&source.rotations).zip(&state.controls.mask) {
            if *weight != 1.0 {
                *styled = nlerp(source, styled, *weight);
            }
        }
        Timing { duration: exp2(log2) }
    }

    /// Heading-local positions, m; the root's row holds its travel since the last frame and its height.
    fn local(&self, heading: Heading, travel: Vector3<f32>, world: &World<JOINTS>) -> [[f32; 3]; JOINTS] {
        let mut local = local_positions(&self.skeleton, world, heading);
        if let Some([x, _, z]) = local.first_mut() {
            let travel = heading.to_local(travel);
            (*x, *z) = (travel.x, travel.z);
        }
        local
    }

    fn normalised(&self, local: &[[f32; 3]; JOINTS]) -> [[f32; 3]; JOINTS] {
        let mut input = [[0.0; 3]; JOINTS];
        for (((input, local), mean), scale) in input.iter_mut().zip(local).zip(self.mean).zip(self.inverse_deviation) {
            for (((input, local), mean), scale) in input.iter_mut().zip(local).zip(mean).zip(scale) {
                *input = (local - mean) * scale;
            }
        }
        input
    }

    /// World positions to reach: the source's moved by `strength` times the learned difference.
    fn targets(
        &self,
        state: &mut TranslatorState<JOINTS, STATES>,
        heading: Heading,
        root: Vector3<f32>,
        local: &[[f32; 3]; JOINTS],
        output: &[[f32; 3]; JOINTS],
        world: &World<JOINTS>,
    ) -> [Vector3<f32>; JOINTS] {
        let strength = state.controls.strength;
        let difference =
            |styled: &[f32; 3], local: &[f32; 3]| (Vector3::from(*styled) - Vector3::from(*local)) * strength;
        let mut targets = [Vector3::zeros(); JOINTS];
        let mut shift = Vector3::zeros();
        if let (Some(styled), Some(local), Some(weight)) = (output.first(), local.first(), state.controls.mask.first())
        {
            let moved = heading.to_world(difference(styled, local)) * *weight;
            state.drift += Vector3::new(moved.x, 0.0, moved.z);
            shift = state.drift;
            if let Some(target) = targets.first_mut() {
                *target = root + shift + Vector3::new(0.0, moved.y, 0.0);
            }
        }
        let rows = targets.iter_mut().zip(output).zip(local).zip(&world.positions).take(self.skeleton.joints()).skip(1);
        for (((target, styled), local), position) in rows {
            *target = position + shift + heading.to_world(difference(styled, local));
        }
        targets
    }
}

/// `2^x` for `|x| <= 4`: the Taylor polynomial of degree 6 at `x / 8`, squared three times. Relative error below 2e-6.
fn exp2(x: f32) -> f32 {
    let t = x * (core::f32::consts::LN_2 / 8.0);
    let e = 1.0 + t * (1.0 + t * (0.5 + t * (1.0 / 6.0 + t * (1.0 / 24.0 + t * (1.0 / 120.0 + t * (1.0 / 720.0))))));
    let e2 = e * e;
    let e4 = e2 * e2;
    e4 * e4
}
