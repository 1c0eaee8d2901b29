//! A program of `core` and kinesic alone: loads a pack and plays a hundred frames.
#![no_std]
#![no_main]

use kinesic::{Emotion, EmotionState, Frame, Pack, Pipeline, PipelineState, Pose, Translator};

#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! {
    loop {}
}

/// 0 if the pack plays, else the number of the step that failed.
// SAFETY: the C runtime calls `main` once; the signature is the one it expects (arguments are ignored).
#[unsafe(no_mangle)]
pub extern "C" fn main() -> i32 {
    let Ok(pack) = Pack::load(kinesic::include_pack!("../../packs/v2/translator-whole-body.kin")) else { return 1 };
    let Ok(pipeline) = Pipeline::<Translator<20, 64>, 20>::load(&pack) else { return 2 };
    let mut state = PipelineState::new();
    let mut styled = Pose::<19>::identity();
    for _ in 0..100 {
        pipeline.step(&mut state, Some(&Pose::identity()), &mut styled);
    }
    let Ok(pack) = Pack::load(kinesic::include_pack!("../../packs/v2/emotion.kin")) else { return 4 };
    let Ok(emotion) = Emotion::<20, 4, 8>::load(&pack) else { return 5 };
    let (mut playing, mut played) = (EmotionState::new(), Frame::new());
    for _ in 0..100 {
        emotion.step(&mut playing, 1.0 / 60.0, &mut played);
    }
    if !played.is_sound() {
        return 6;
    }
    if styled.rotations.iter().all(|q| q.coords.norm_squared() > 0.99) { 0 } else { 3 }
}
