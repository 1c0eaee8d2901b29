// Emotion strength: motions that the core makes of strengths alone, which may change while they play.

class EmotionCore {
  static async make(module, pack) {
    const core = new EmotionCore();
    core.exports = await instance(module, pack, "load_emotion");
    const view = (address, length) => new Float32Array(core.exports.memory.buffer, address, length);
    core.output = view(core.exports.output(), width(pack));
    core.positions = places(core.exports, pack);
    core.strengths = view(core.exports.strengths(), pack.attributes.length);
    core.playing = view(core.exports.playing(), pack.attributes.length);
    return core;
  }
}

// A motion at the strengths of `controls`, frame by frame; from any frame on they may be others.
class EmotionTrack extends Track {
  constructor(core, pack, frames, controls) {
    super(pack, frames);
    // As the host divides: in single precision.
    const dt = Math.fround(1 / Math.fround(pack.rate));
    Object.assign(this, { core, controls, dt, passes: 0, played: new Float32Array(frames * pack.attributes.length) });
    this.begin();
  }

  // Everything at the strengths of now.
  begin() {
    this.core.exports.reset();
    this.take(0);
    this.done = 0;
  }

  // Other strengths from a frame on, as they would change on the device: the core goes back to where they changed last, steps from there
  // to here, and remembers this frame.
  change(frame) {
    this.core.exports.back();
    this.core.strengths.set(this.strength);
    for (this.done = this.from; this.done < frame; ) this.step();
    this.take(frame);
  }

  // The next frame to be made, `frame`, is the first with the strengths of now.
  take(frame) {
    this.core.exports.keep();
    this.from = frame;
    this.strength = [...this.controls.strength];
    this.core.strengths.set(this.strength);
  }

  step() {
    const { core, done } = this;
    core.exports.step_emotion(this.dt);
    this.pose(done).set(core.output);
    this.place(done).set(core.positions(1));
    this.played.set(core.playing, done * core.playing.length);
    this.done += 1;
  }

  // Steps until a time; returns how many frames it made.
  advance(deadline) {
    let made = 0;
    while (this.done < this.frames && (made % 8 || performance.now() < deadline)) {
      this.step();
      made += 1;
      if (this.done === this.frames) this.passes += 1;
    }
    return made;
  }

  digest(frames) {
    const digest = new Digest();
    digest.add(new Uint32Array(this.poses.buffer, 0, Math.min(frames, this.frames) * this.width));
    return digest.text;
  }
}

// An emotion pack on the page: the motion as its sliders are, beside the one at the strengths of the start.
class Emotion {
  static async make(module, pack, index) {
    prepared(pack);
    const emotion = new Emotion();
    Object.assign(emotion, { pack, index, core: await EmotionCore.make(module, pack), controls: { strength: starts(pack), shown: true } });
    return emotion;
  }

  // Makes both motions as long as the page plays; the core is left to the one that may change.
  prepare(seconds) {
    const frames = Math.floor(seconds * this.pack.rate + 1e-3) + 1;
    if (this.track?.frames === frames) return;
    this.start = new EmotionTrack(this.core, this.pack, frames, { strength: starts(this.pack) });
    this.start.advance(Infinity);
    this.track = new EmotionTrack(this.core, this.pack, frames, this.controls);
    this.track.source = this.start;
  }

  figures() {
    const { name } = this.pack;
    const start = kinesic.emotions.length > 1 ? `${name}: start` : "start";
    const at = this.pack.attributes.map((attribute) => `${attribute.name} ${attribute.start.toFixed(2)}`).join(", ");
    return [{ track: this.start, name: start, role: "start", says: `${start} (${at})`, carried: true }, { track: this.track, name, role: "emotion", carried: true }];
  }

  // A slider has moved. While it plays the motion goes on from here, as on the device; otherwise it is made again.
  changed() {
    const { track } = this;
    if (!track) return;
    if (kinesic.playing) track.change(track.frame(kinesic.time));
    else track.begin();
    kinesic.stale = true;
  }

  // The person has gone to a time. What was played before the last change was at other strengths than the sliders are.
  sought(seconds) {
    if (this.track && this.track.frame(seconds) < this.track.from) this.track.begin();
  }

  state() {
    const { track, controls } = this;
    const frame = track?.frame(kinesic.time);
    return { strength: [...controls.strength], shown: controls.shown, frames: track?.frames, done: track?.done, from: track?.from,
      playing: track && [...track.played.subarray(frame * controls.strength.length, (frame + 1) * controls.strength.length)] };
  }

  panel() {
    const { pack, index, controls } = this;
    const set = element("fieldset", {}, element("legend", { textContent: pack.name }));
    set.append(element("p", { className: "soft small", textContent: `emotion strength, motion ${pack.motion}${pack.seconds === null ? ", a cycle" : ""}; ` +
      `${moving(pack).length} joints, ${pack.rate} frames a second, ${pack.size} bytes` }));
    // The only figures of a page stay.
    if (kinesic.data.packs.length + kinesic.data.emotions.length > 1) {
      const shown = element("input", { type: "checkbox", id: `emotion-shown-${index}`, checked: true });
      shown.addEventListener("change", () => { controls.shown = shown.checked; show(); });
      set.append(element("label", {}, shown, " shown"));
    }
    const sliders = pack.attributes.map(({ name, range: [min, max], start }, k) =>
      slider({ id: `emotion-${index}-${k}`, label: `${name} (${min.toFixed(2)} to ${max.toFixed(2)})`, min, max, step: "any", value: start,
        change: (value) => { controls.strength[k] = value; this.changed(); } }));
    const back = element("button", { id: `emotion-start-${index}`, type: "button", textContent: "as at the start" });
    back.addEventListener("click", () => sliders.forEach((made, k) => {
      const input = made.querySelector("input");
      input.value = pack.attributes[k].start;
      input.dispatchEvent(new Event("input"));
    }));
    set.append(...sliders, element("div", { className: "buttons" }, back), element("p", { className: "soft small", textContent:
      "Strengths are in units of the ranking that the pack was trained with. While it plays, a change goes on from where the motion is, " +
      "as on the device. Paused, the motion is made again from its first frame, and so it is where you go back to before the last change. " +
      (pack.machine ? "Limits of servos are not kept here: synth keeps them." : "While the picture follows, figures are carried along side by side, however fast they walk.") }));
    return set;
  }
}

const starts = (pack) => pack.attributes.map(({ start }) => start);

// How long a page plays motions that have no clip: cycles as long as anything else, and 10 s alone.
const LONG = 10;

// The host has made the same motions: at the strengths of the start, and with a change on the way.
async function compareEmotions(module, { emotions, checked }, bits) {
  for (const pack of emotions) {
    const controls = { strength: starts(pack) };
    const track = new EmotionTrack(await EmotionCore.make(module, pack), pack, checked, controls);
    const made = (what, host) => {
      track.advance(Infinity);
      bits.push({ pack: pack.name, emotion: what, steps: checked, here: track.digest(checked), host });
    };
    made("start", pack.digests[0]);
    controls.strength = pack.change.strength;
    track.change(pack.change.frame);
    made("changed", pack.digests[1]);
    await new Promise((done) => setTimeout(done));
  }
}
