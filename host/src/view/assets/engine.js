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
    const frame = (address) => new Float32Array(buffer, address, width(pack));
    core.exports = exports;
    core.input = frame(exports.input());
    core.other = frame(exports.other());
    core.output = frame(exports.output());
    core.mask = new Float32Array(buffer, exports.mask(), pack.joints.length);
    core.positions = places(exports, pack);
    return core;
  }
}

// Numbers of a frame: coordinates of a machine, or a body's pose, which is the root and a quaternion a joint.
const width = (pack) => (pack.machine ? pack.machine.coordinates : 3 + 4 * pack.joints.length);

// Gives the places of the joints of a frame that lies in a core: 0 = its input, 1 = its output.
function places(exports, pack) {
  const { buffer } = exports.memory;
  const at = new Float32Array(buffer, exports.positions(), 3 * pack.joints.length);
  const frames = [exports.input(), exports.output()].map((address) => new Float32Array(buffer, address, width(pack)));
  return (which) => {
    if (pack.machine) return pack.machine.positions(frames[which]);
    exports.place(which);
    return at;
  };
}

// Reads once what is drawn of a pack: parent and child of every bone, or the links of a machine.
function prepared(pack) {
  pack.bones = pack.joints.flatMap(({ parent }, joint) => (parent === null ? [] : [[parent, joint]]));
  if (pack.machine) pack.machine = new Machine(pack.machine);
}

// Frames and the places of their joints.
class Track {
  constructor(pack, frames) {
    this.pack = pack;
    this.frames = frames;
    this.rate = pack.rate;
    this.width = width(pack);
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
    const track = new Track(pack, poses.length / width(pack));
    track.poses.set(poses);
    for (let frame = 0; frame < track.frames; frame++) {
      core.input.set(track.pose(frame));
      track.place(frame).set(core.positions(0));
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

  // Angle of a joint's rotation, degrees; of a machine its coordinate, degrees or mm.
  angle(frame, joint) {
    const { machine } = this.pack;
    if (machine) return machine.shown(machine.joints[joint], this.pose(frame));
    return (360 / Math.PI) * Math.acos(Math.min(1, Math.abs(this.poses[frame * this.width + 6 + 4 * joint])));
  }

  // Speed of a joint, m/s; of a machine that of its coordinate, degrees or mm per second.
  speed(frame, joint) {
    const [before, after] = [Math.max(0, frame - 1), Math.min(this.frames - 1, frame + 1)];
    if (after === before) return 0;
    if (this.pack.machine) return ((this.angle(after, joint) - this.angle(before, joint)) * this.rate) / (after - before);
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
    this.place(done).set(core.positions(1));
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
