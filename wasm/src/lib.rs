//! The core as WebAssembly, without bindings: numbers and addresses cross the boundary, everything else lies in static memory.
//!
//! One instance plays one pack. The page grows the memory by the pack, writes the bytes there and calls [`load`]; then it writes a
//! pose to [`input`], calls [`step`], and reads [`output`]. A pose is `3 + 4 JOINTS` floats: the root's position, m, and each joint's
//! unit quaternion `x y z w`. The capacities are those of `kinesic-host`, so that everything it plays plays here, with the same bits.
#![no_std]

mod emotion;
mod engine;
mod face;
mod memory;

use core::fmt::Write;

use emotion::Player;
use engine::Engine;
use kinesic::face::FaceSynth;
use kinesic::pose::{World, forward};
use kinesic::{LoadError, Pack};
use memory::{Floats as _, Memory, Write as _, memory};

/// Joints that a pose holds.
pub const JOINTS: usize = 128;

/// Rows of coordinates: that of the root, and one per joint.
pub const ROWS: usize = JOINTS + 1;

/// Takes the pack at an address. 0 if it loaded, else the length of the [`message`] that says why not.
///
/// # Safety
/// The address is divisible by 16 and valid for `len` bytes, which are never changed again.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn load(pack: *const u8, len: usize) -> usize {
    // SAFETY: by the caller's promise.
    let bytes: &'static [u8] = unsafe { core::slice::from_raw_parts(pack, len) };
    let memory = memory();
    memory.mask = [1.0; JOINTS];
    let loaded = Pack::load(bytes).and_then(|pack| Engine::load(&pack)).map(|engine| memory.engine.put(engine));
    answer(memory, loaded)
}

/// Takes the face pack at an address, as [`load`] does the others.
///
/// # Safety
/// As for [`load`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn load_face(pack: *const u8, len: usize) -> usize {
    // SAFETY: by the caller's promise.
    let bytes: &'static [u8] = unsafe { core::slice::from_raw_parts(pack, len) };
    let memory = memory();
    let loaded = Pack::load(bytes).and_then(|pack| FaceSynth::load(&pack)).map(|model| memory.face.put(model));
    answer(memory, loaded)
}

/// Takes the emotion pack at an address, as [`load`] does the others.
///
/// # Safety
/// As for [`load`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn load_emotion(pack: *const u8, len: usize) -> usize {
    // SAFETY: by the caller's promise.
    let bytes: &'static [u8] = unsafe { core::slice::from_raw_parts(pack, len) };
    let memory = memory();
    let loaded = Pack::load(bytes).and_then(|pack| Player::load(&pack)).map(|player| memory.emotion.put(player));
    answer(memory, loaded)
}

/// Length of the message that says why there was no load, 0 if there was one.
fn answer(memory: &mut Memory, loaded: Result<(), LoadError>) -> usize {
    memory.message.clear();
    if let Err(error) = loaded {
        // Writing to a message cannot fail: what is too long is cut.
        let _ = write!(memory.message, "{error}");
    }
    memory.message.text().len()
}

/// Address of the text of the last refusal, UTF-8.
#[unsafe(no_mangle)]
pub extern "C" fn message() -> *const u8 {
    memory().message.text().as_ptr()
}

/// Address of the pose, or the coordinates of a machine, that [`step`] reads.
#[unsafe(no_mangle)]
pub extern "C" fn input() -> *mut f32 {
    memory().input.as_mut_ptr()
}

/// Address of the pose whose expression [`mix`] takes.
#[unsafe(no_mangle)]
pub extern "C" fn other() -> *mut f32 {
    memory().other.as_mut_ptr()
}

/// Address of the pose, or the coordinates of a machine, that [`step`], [`mix`] and [`step_emotion`] write.
#[unsafe(no_mangle)]
pub extern "C" fn output() -> *mut f32 {
    memory().output.as_mut_ptr()
}

/// Address of the joints' weights, `[JOINTS]`, 1 after [`load`].
#[unsafe(no_mangle)]
pub extern "C" fn mask() -> *mut f32 {
    memory().mask.as_mut_ptr()
}

/// Address of the world positions that [`place`] writes, `[JOINTS]` of x, y, z in m.
#[unsafe(no_mangle)]
pub extern "C" fn positions() -> *const f32 {
    memory().positions.as_ptr().cast()
}

/// Forgets the past: the next [`step`] or [`step_emotion`] is the first of a stream.
#[unsafe(no_mangle)]
pub extern "C" fn reset() {
    let memory = memory();
    if let Some(engine) = memory.engine.get() {
        engine.reset();
    }
    if let Some(player) = memory.emotion.get() {
        player.reset();
    }
}

/// One frame: [`input`] to [`output`], with a strength (translator, components) or an amount of expression (body mechanics). Both are
/// poses of a body; of a machine that stands they are coordinates, rad and m.
#[unsafe(no_mangle)]
pub extern "C" fn step(strength: f32) {
    let memory = memory();
    let Some(engine) = memory.engine.get() else { return };
    if engine.stands() {
        engine.step_coordinates(&memory.input, strength, &memory.mask, &mut memory.output);
    } else {
        engine.step(&memory.input.pose(), strength, &memory.mask).write(&mut memory.output);
    }
}

/// One frame of body mechanics: the mechanics of [`input`] with the expression of [`other`] times `amount`. With another engine as
/// [`step`].
#[unsafe(no_mangle)]
pub extern "C" fn mix(amount: f32) {
    let memory = memory();
    if let Some(engine) = memory.engine.get() {
        engine.mix(&memory.input.pose(), &memory.other.pose(), amount, &memory.mask).write(&mut memory.output);
    }
}

/// World positions of the joints of a body's pose: 0 = [`input`], 1 = [`output`]. Core's forward kinematics.
#[unsafe(no_mangle)]
pub extern "C" fn place(which: u32) {
    let memory = memory();
    let engine = memory.engine.get().map(|engine| *engine.skeleton());
    if let Some(skeleton) = engine.or_else(|| memory.emotion.get().map(|player| *player.skeleton())) {
        let pose = if which == 0 { memory.input.pose() } else { memory.output.pose() };
        let mut world = World::identity();
        forward(&skeleton, &pose, &mut world);
        memory.positions = world.positions.map(Into::into);
    }
}

/// Address of the strengths that [`step_emotion`] reads, `[4]`, in the order of the pack's attributes.
#[unsafe(no_mangle)]
pub extern "C" fn strengths() -> *mut f32 {
    memory().strengths.as_mut_ptr()
}

/// Address of the strengths that the last [`step_emotion`] played, `[4]`: those asked for, held inside the pack's ranges.
#[unsafe(no_mangle)]
pub extern "C" fn playing() -> *const f32 {
    memory().playing.as_ptr()
}

/// One frame of an emotion pack at [`strengths`] to [`output`]; then `dt` seconds pass. Strengths may change from frame to frame.
#[unsafe(no_mangle)]
pub extern "C" fn step_emotion(dt: f32) {
    let memory = memory();
    if let Some(player) = memory.emotion.get() {
        memory.playing = player.step(&memory.strengths, dt, &mut memory.output);
    }
}

/// Remembers where an emotion pack's motion is.
#[unsafe(no_mangle)]
pub extern "C" fn keep() {
    if let Some(player) = memory().emotion.get() {
        player.keep();
    }
}

/// Goes back to where the motion was at [`keep`].
#[unsafe(no_mangle)]
pub extern "C" fn back() {
    if let Some(player) = memory().emotion.get() {
        player.back();
    }
}

/// Address of the landmarks that [`change`] reads, `[68]` of x, y.
#[unsafe(no_mangle)]
pub extern "C" fn landmarks() -> *mut f32 {
    memory().landmarks.as_mut_ptr().cast()
}

/// Address of the landmarks that [`change`] writes, `[68]` of x, y.
#[unsafe(no_mangle)]
pub extern "C" fn changed() -> *const f32 {
    memory().changed.as_ptr().cast()
}

/// Address of what [`change`] read: cluster of head pose, strength, the strength aimed at, the strength of the changed landmarks.
#[unsafe(no_mangle)]
pub extern "C" fn reading() -> *const f32 {
    memory().reading.as_ptr()
}

/// Changes a single face's strength by so much: [`landmarks`] to [`changed`] and [`reading`]. What is no face stays as it is, with a
/// reading of zeros.
#[unsafe(no_mangle)]
pub extern "C" fn change(by: f32) {
    let memory = memory();
    if let Some(model) = memory.face.get() {
        (memory.changed, memory.reading) = face::change(model, &memory.landmarks, by);
    }
}

#[cfg(target_arch = "wasm32")]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    core::arch::wasm32::unreachable()
}
