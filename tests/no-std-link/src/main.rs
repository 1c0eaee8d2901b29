//! A program of `core` and kinesic alone: loads a pack and plays a hundred frames.
#![no_std]
#![no_main]

use kinesic::{Emotion, EmotionState, Pack, Pose, Translator, TranslatorState};

#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! {
    loop {}
}

/// 0 if the pack plays, else the number of the step that failed.
// SAFETY: the C runtime calls `main` once; the signature is the one it expects (arguments are ignored).
#[unsafe(no_mangle)]
pub extern "C" fn main() -> i32 {
    let Ok(pack) = Pack::load(kinesic::include_pack!("../../packs/v1/translator-whole-body.kin")) else { return 1 };
    let Ok(translator) = Translator::<19, 64>::load(&pack) else { return 2 };
    let mut state = TranslatorState::new();
    let mut styled = Pose::identity();
    for _ in 0..100 {
        translator.step(&mut state, &Pose::identity(), &mut styled);
    }
    let Ok(pack) = Pack::load(kinesic::include_pack!("../../packs/v1/emotion.kin")) else { return 4 };
    let Ok(emotion) = Emotion::<19, 4, 8>::load(&pack) else { return 5 };
    let (mut playing, mut played) = (EmotionState::new(), Pose::<19>::identity());
    for _ in 0..100 {
        emotion.step(&mut playing, 1.0 / 60.0, &mut played);
    }
    if played.rotations.iter().any(|q| q.coords.norm_squared() < 0.99) {
        return 6;
    }
    if styled.rotations.iter().all(|q| q.coords.norm_squared() > 0.99) { 0 } else { 3 }
}
