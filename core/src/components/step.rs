//! One frame of style components.

use nalgebra::{Quaternion, Vector3};

use super::{Components, ComponentsState};
use crate::pose::{Heading, Pose, World, forward, local_positions, nlerp, solve, unit};

impl<const JOINTS: usize, const COUNT: usize> Components<'_, JOINTS, COUNT> {
    /// Restyles a live pose: `source` in, `styled` out. Infallible; every loop has a length fixed at load time.
    ///
    /// `w = (x - mean) C_C^+`, then `x + strength (w (C_X - C_C) + shift)`: what the components do not explain of the pose
    /// stays. Strength 0 gives the source pose to rounding, a mask of 0 leaves a joint's rotation alone. Phong 2018, eq. 2.
    /// Cost: [`multiply_adds`](Self::multiply_adds) plus about 250 a joint for kinematics.
    pub fn step(&self, state: &mut ComponentsState<JOINTS>, source: &Pose<JOINTS>, styled: &mut Pose<JOINTS>) {
        let mut world = World::identity();
        forward(&self.skeleton, source, &mut world);
        state.heading = state.heading.follow(&self.skeleton, &world);
        let mut local = local_positions(&self.skeleton, &world, state.heading);
        for (local, mean) in local.iter_mut().zip(self.mean) {
            for (local, mean) in local.iter_mut().zip(mean) {
                *local -= mean;
            }
        }
        let mut weights = [0.0; COUNT];
        self.project.multiply_add(local.as_flattened(), &mut weights);
        self.restyle(state, source, &world, &weights, styled);
    }

    /// Plays the next frame of the stored stream, `M_X = W C_X`; after the last frame the first, from where the last ended.
    ///
    /// Strength 0 gives the content, 1 the learned motion. Without a stored stream `styled` is the mean pose. Cost: as
    /// [`step`](Self::step), and a second solve.
    pub fn step_stored(&self, state: &mut ComponentsState<JOINTS>, styled: &mut Pose<JOINTS>) {
        let row = state.frame.saturating_mul(self.compose.columns());
        let stored = self.weights.get(row..).unwrap_or(&[]).iter().take(self.compose.columns());
        let mut weights = [0.0; COUNT];
        for (weight, stored) in weights.iter_mut().zip(stored) {
            *weight = *stored;
        }
        let [x, z, sin, cos] = self.track.get(state.frame).copied().unwrap_or([0.0, 0.0, 0.0, 1.0]);
        state.heading = state.heading.turned(sin, cos);
        state.ground += state.heading.to_world(Vector3::new(x, 0.0, z));
        state.frame = if state.frame + 1 < self.track.len() { state.frame + 1 } else { 0 };

        let source = self.recall(state.heading, state.ground, &weights);
        let mut world = World::identity();
        forward(&self.skeleton, &source, &mut world);
        self.restyle(state, &source, &world, &weights, styled);
    }

    /// The content's pose with these weights, `mean + w C_C`, twisted as the reference pose.
    fn recall(&self, heading: Heading, ground: Vector3<f32>, weights: &[f32; COUNT]) -> Pose<JOINTS> {
        let mut local = [[0.0; 3]; JOINTS];
        for (local, mean) in local.iter_mut().zip(self.mean) {
            *local = *mean;
        }
        self.compose.multiply_add(weights, local.as_flattened_mut());
        let mut targets = [Vector3::zeros(); JOINTS];
        for (target, local) in targets.iter_mut().zip(local).take(self.skeleton.joints()) {
            *target = ground + heading.to_world(Vector3::from(local));
        }
        let mut reference = Pose::identity();
        for (to, [i, j, k, w]) in reference.rotations.iter_mut().zip(self.reference) {
            *to = unit(Quaternion::new(*w, *i, *j, *k));
        }
        if let (Some(root), Some(target)) = (reference.rotations.first_mut(), targets.first()) {
            *root = unit((heading.rotation() * *root).into_inner());
            reference.root = *target;
        }
        let mut world = World::identity();
        forward(&self.skeleton, &reference, &mut world);
        let mut pose = Pose::identity();
        solve(&self.skeleton, &reference, &world, &targets, &mut pose);
        pose
    }

    /// Moves the joints of `source` by what the style makes of the weights, and puts the bones back to their length.
    fn restyle(
        &self,
        state: &ComponentsState<JOINTS>,
        source: &Pose<JOINTS>,
        world: &World<JOINTS>,
        weights: &[f32; COUNT],
        styled: &mut Pose<JOINTS>,
    ) {
        let mut change = [[0.0; 3]; JOINTS];
        for (change, shift) in change.iter_mut().zip(self.shift) {
            *change = *shift;
        }
        self.change.multiply_add(weights, change.as_flattened_mut());
        let strength = state.controls.strength;
        let mut targets = world.positions;
        for (target, change) in targets.iter_mut().zip(change).take(self.skeleton.joints()) {
            *target += state.heading.to_world(Vector3::from(change) * strength);
        }
        if let (Some(target), Some(weight)) = (targets.first_mut(), state.controls.mask.first()) {
            *target = source.root + (*target - source.root) * *weight;
        }
        solve(&self.skeleton, source, world, &targets, styled);
        for ((styled, source), weight) in styled.rotations.iter_mut().zip(&source.rotations).zip(&state.controls.mask) {
            *styled = nlerp(source, styled, *weight);
        }
    }
}
