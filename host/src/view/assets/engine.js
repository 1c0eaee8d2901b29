// The core in WebAssembly: one instance a pack, and the motions that it makes.

// What can be turned: a strength, unless the engine is here. Emotions and faces have files of their own.
const STRENGTH = { label: "Strength", help: "0 = the source, 1 = as learned" };
const CONTROLS = {
  mechanics: { label: "Expressiveness", help: "0 = what the body must do, 1 = the source, 2 = twice the expression" },
};

const bytes = (text) => Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
const floats = (text) => new Float32Array(bytes(text).buffer);

// An instance of the core with a pack in it, taken by `load`, `load_emotion` or `load_face`.
async function instance(module, pack, load) {
  const { exports } = await WebAssembly.instantiate(module, {});
  const data = bytes(pack.bytes);
  const at = exports.memory.buffer.byteLength;
  exports.memory.grow(Math.ceil(data.length / 65536));
  new Uint8Array(exports.memory.buffer, at, data.length).set(data);
  const refused = exports[load](at, data.length);
  const text = (length) => new TextDecoder().decode(new Uint8Array(exports.memory.buffer, exports.message(), length));
  if (refused) throw new Error(`${pack.name}: ${text(refused)}`);
  return exports;
}

class Core {
  static async make(module, pack) {
    const core = new Core();
    const exports = await instance(module, pack, "load");
    const { buffer } = exports.memory;
    const joints = pack.joints.length;
    const pose = (address) => new Float32Array(buffer, address, 3 + 4 * joints);
    core.exports = exports;
    core.input = pose(exports.input());
    core.other = pose(exports.other());
    core.output = pose(exports.output());
    core.mask = new Float32Array(buffer, exports.mask(), joints);
    core.positions = new Float32Array(buffer, exports.positions(), 3 * joints);
    return core;
  }
}

// Parent and child of every bone.
const bones = (pack) => pack.joints.flatMap(({ parent }, joint) => (parent === null ? [] : [[parent, joint]]));

// Poses and the places of their joints, frame by frame.
class Track {
  constructor(pack, frames) {
    this.pack = pack;
    this.frames = frames;
    this.rate = pack.rate;
    this.width = 3 + 4 * pack.joints.length;
    this.poses = new Float32Array(frames * this.width);
    this.places = new Float32Array(frames * 3 * pack.joints.length);
  }

  pose(frame) {
    return this.poses.subarray(frame * this.width, (frame + 1) * this.width);
  }

  place(frame) {
    const size = 3 * this.pack.joints.length;
    return this.places.subarray(frame * size, (frame + 1) * size);
  }

  frame(seconds) {
    return Math.max(0, Math.min(this.frames - 1, Math.round(seconds * this.rate)));
  }

  // Recorded poses.
  static recorded(core, pack, poses) {
    const track = new Track(pack, poses.length / (3 + 4 * pack.joints.length));
    track.poses.set(poses);
    for (let frame = 0; frame < track.frames; frame++) {
      core.input.set(track.pose(frame));
      core.exports.place(0);
      track.place(frame).set(core.positions);
    }
    return track;
  }

  // Where the way of the root has led at a frame, without its sway: how far its mean over a second (less near the ends) is from the
  // first frame, x and z in m.
  way(frame) {
    const around = Math.min(Math.round(this.rate / 2), frame, this.frames - 1 - frame);
    const [x0, , z0] = this.place(0);
    const sum = [0, 0];
    for (let at = frame - around; at <= frame + around; at++) {
      const [x, , z] = this.place(at);
      sum[0] += x - x0;
      sum[1] += z - z0;
    }
    return sum.map((of) => of / (2 * around + 1));
  }

  // Angle of a joint's rotation, degrees.
  angle(frame, joint) {
    return (360 / Math.PI) * Math.acos(Math.min(1, Math.abs(this.poses[frame * this.width + 6 + 4 * joint])));
  }

  // Speed of a joint, m/s.
  speed(frame, joint) {
    const [before, after] = [Math.max(0, frame - 1), Math.min(this.frames - 1, frame + 1)];
    if (after === before) return 0;
    const [a, b] = [this.place(before), this.place(after)];
    const k = 3 * joint;
    return (Math.hypot(b[k] - a[k], b[k + 1] - a[k + 1], b[k + 2] - a[k + 2]) * this.rate) / (after - before);
  }

  // Whether the foot (a joint) is on the ground, a frame.
  contacts(foot) {
    const height = (frame) => this.place(frame)[3 * foot + 1];
    const heights = Float32Array.from({ length: this.frames }, (_, frame) => height(frame)).sort();
    const ground = heights[Math.floor(this.frames / 20)];
    return Uint8Array.from({ length: this.frames }, (_, frame) => {
      const [now, then] = [height(frame), height(Math.min(this.frames - 1, frame + 1))];
      return now < ground + 0.03 && Math.abs(then - now) * this.rate < 0.2 ? 1 : 0;
    });
  }
}

// A pack's answer to a source, made again frame by frame from the first whenever a control has changed.
class Result extends Track {
  constructor(core, pack, source, controls) {
    super(pack, source.frames);
    Object.assign(this, { core, source, controls, other: null, done: 0, changed: false, passes: 0 });
    // Until it has been made, a frame is the source's.
    this.poses.set(source.poses);
    this.places.set(source.places);
    this.begin();
  }

  begin() {
    this.core.exports.reset();
    this.core.mask.set(this.controls.mask);
    this.strength = this.controls.strength;
    this.mixed = this.other;
    this.done = 0;
    this.changed = false;
  }

  // Controls have changed: the pass that runs is finished first, so that a moving slider shows something.
  change() {
    if (this.done === this.frames) this.begin();
    else this.changed = true;
  }

  step() {
    const { core, done } = this;
    core.input.set(this.source.pose(done));
    if (this.mixed) {
      core.other.set(this.mixed.pose(Math.min(done, this.mixed.frames - 1)));
      core.exports.mix(this.strength);
    } else {
      core.exports.step(this.strength);
    }
    this.pose(done).set(core.output);
    core.exports.place(1);
    this.place(done).set(core.positions);
    this.done += 1;
  }

  // Steps until a time; returns how many frames it made.
  advance(deadline) {
    let made = 0;
    while (this.done < this.frames && (made % 8 || performance.now() < deadline)) {
      this.step();
      made += 1;
      if (this.done === this.frames) {
        this.passes += 1;
        if (this.changed) this.begin();
      }
    }
    return made;
  }
}

// Two hashes over words; the host has its own.
class Digest {
  constructor() {
    [this.a, this.b] = [0x811c9dc5, 0x9e3779b9];
  }

  add(words) {
    for (const word of words) {
      this.a = Math.imul(this.a ^ word, 0x01000193);
      this.b = Math.imul(this.b ^ word, 0x85ebca6b) + this.a;
    }
  }

  get text() {
    return [this.a, this.b].map((half) => (half >>> 0).toString(16).padStart(8, "0")).join("");
  }
}

// Of a result's first frames.
function digest(core, source, strength, frames) {
  const words = new Uint32Array(core.output.buffer, core.output.byteOffset, core.output.length);
  const digest = new Digest();
  core.exports.reset();
  core.mask.fill(1);
  for (let frame = 0; frame < Math.min(frames, source.frames); frame++) {
    core.input.set(source.pose(frame));
    core.exports.step(strength);
    digest.add(words);
  }
  return digest.text;
}
