// The page: what is shown, time, and what a test reads back (`kinesic.state()`).

const kinesic = {
  data: JSON.parse($("data").textContent),
  cores: [], controls: [], emotions: [], figures: [], results: [],
  clip: 0, time: 0, duration: 1, playing: false, joint: 0,
  frames: 0, drawn: 0, cost: { picture: 0, step: 0 }, bits: [], errors: [],
};

function refuse(error) {
  kinesic.errors.push(String(error?.message ?? error));
  $("alert").hidden = false;
  $("alert").textContent = kinesic.errors.join("; ");
}
addEventListener("error", (event) => refuse(event.error ?? event.message));
addEventListener("unhandledrejection", (event) => refuse(event.reason));

// Recorded tracks of a pack and a clip, read once.
const tracks = new Map();
function recorded(index, clip) {
  const key = `${index}/${clip}`;
  if (!tracks.has(key)) {
    const scene = kinesic.data.scenes[index][clip];
    const track = (text) => text && Track.recorded(kinesic.cores[index], kinesic.data.packs[index], floats(text));
    tracks.set(key, { source: track(scene.source), target: track(scene.target) });
  }
  return tracks.get(key);
}

// Which figures there are: the source, one result a pack, the target; two an emotion pack.
function show() {
  const { data, controls, clip } = kinesic;
  const shown = data.packs.map((_, index) => index).filter((index) => controls[index].shown);
  const clips = data.packs.length ? recorded(shown[0] ?? 0, clip) : null;
  const figures = [];
  if (clips) figures.push({ track: clips.source, name: "source", role: "source" });
  kinesic.results = data.packs.map((pack, index) => {
    if (!controls[index].shown) return null;
    const { source } = recorded(index, clip);
    return new Result(kinesic.cores[index], pack, source, controls[index]);
  });
  for (const index of shown) {
    mixed(index);
    if (kinesic.results[index].other) kinesic.results[index].begin();
    figures.push({ track: kinesic.results[index], name: data.packs[index].name, role: "result" });
  }
  if (clips?.target) figures.push({ track: clips.target, name: "target", role: "target" });
  // Emotions make their own motion, as long as the clip; without one the first of them stays.
  const emotions = kinesic.emotions.filter((emotion) => emotion.controls.shown);
  if (!clips && !emotions.length) emotions.push(kinesic.emotions[0]);
  const length = clips ? (clips.source.frames - 1) / clips.source.rate : 0;
  const duration = Math.max(length, ...emotions.map(({ pack }) => pack.seconds ?? (clips ? 0 : LONG)));
  for (const emotion of emotions) {
    emotion.prepare(duration);
    kinesic.results.push(emotion.track);
    figures.push(...emotion.figures());
  }
  const rooms = figures.map(({ track }) => room(track.source ?? track));
  const most = (of) => Math.max(...rooms.map((each) => each[of]));
  kinesic.scene.stand(figures.length, { height: most("height"), reach: most("reach"), front: most("front") });
  const placed = figures.map((figure, k) => {
    const [x, , z] = (figure.track.source ?? figure.track).place(0);
    return { ...figure, index: k, shift: [(k - (figures.length - 1) / 2) * kinesic.scene.slot - x, -z] };
  });
  kinesic.figures = placed;
  const { rate } = figures[0].track;
  kinesic.frames = Math.round(duration * rate) + 1;
  kinesic.duration = Math.max(1e-3, (kinesic.frames - 1) / rate);
  $("time").max = kinesic.frames - 1;
  seek(Math.min(kinesic.time, kinesic.duration));
  $("legend").replaceChildren(...placed.map((figure) =>
    element("li", {}, element("i", { style: `background: var(--c${figure.index % 6})` }), figure.says ?? figure.name + (figure.role === "result" ? " (result)" : ""))));
  const names = moving(figures[0].track.pack);
  const chosen = $("joint").selectedOptions[0]?.textContent ?? data.joint;
  $("joint").replaceChildren(...names.map(([name, joint]) => element("option", { value: joint, textContent: name })));
  choose((names.find(([name]) => name === chosen) ?? names[0])[1]);
  $("scene").setAttribute("aria-label", `Figures side by side: ${placed.map(({ name }) => name).join(", ")}`);
  kinesic.stale = true;
}

// Name and index of the joints that can be plotted.
const moving = ({ joints, machine }) =>
  joints.map(({ name }, joint) => [name, joint]).filter(([, joint]) => !machine || machine.joints[joint].coordinate !== null);

// Plots another joint, in its unit.
function choose(joint) {
  const { machine } = kinesic.figures[0].track.pack;
  $("joint").value = kinesic.joint = joint;
  const unit = machine?.joints[joint].slides ? "mm" : "degrees";
  $("angle-caption").textContent = machine ? `Coordinate, ${unit}` : "Rotation from rest, degrees";
  $("speed-caption").textContent = machine ? `Speed, ${unit} per second` : "Speed, m/s";
  $("feet-plot").hidden = Boolean(machine);
  kinesic.stale = true;
}

// Where a person goes, and where a round begins again.
function seek(seconds) {
  for (const emotion of kinesic.emotions) emotion.sought(seconds);
  pass(seconds);
}

function pass(seconds) {
  kinesic.time = Math.max(0, Math.min(kinesic.duration, seconds));
  const rate = (kinesic.frames - 1) / kinesic.duration;
  $("time").value = Math.round(kinesic.time * rate);
  $("clock").textContent = `${kinesic.time.toFixed(2)} / ${kinesic.duration.toFixed(2)} s`;
  $("time").setAttribute("aria-valuetext", `${kinesic.time.toFixed(2)} seconds`);
}

function play(on) {
  if (on && kinesic.time >= kinesic.duration) seek(0);
  kinesic.playing = on;
  $("play").setAttribute("aria-pressed", on);
  $("play").setAttribute("aria-label", on ? "Pause" : "Play");
  $("play").textContent = on ? "Pause" : "Play";
}

// The joint of a figure's skeleton that is called as the chosen one, or plays its part.
function joint(figure) {
  const [from, to] = [kinesic.figures[0].track.pack, figure.track.pack];
  if (from === to) return kinesic.joint;
  const part = from.joints[kinesic.joint].part;
  const same = to.joints.findIndex((other) => (part ? other.part === part : other.name === from.joints[kinesic.joint].name));
  return Math.max(0, same);
}

function plots() {
  const palette = colours();
  const figures = kinesic.figures.map((figure) => {
    const { track } = figure;
    // A result's curve changes while it is made again; feet are found once a pass.
    if (!figure.contacts || figure.pass !== track.passes) {
      figure.contacts = track.pack.feet.map((foot) => track.contacts(foot));
      figure.pass = track.passes;
    }
    return { ...figure, colour: palette[`c${figure.index % 6}`], joint: joint(figure) };
  });
  const { time, duration, plot } = kinesic;
  const of = new Map(figures.map((figure) => [figure.track, figure.joint]));
  plot.angle.curves(figures, (track, frame) => track.angle(frame, of.get(track)), time, duration, palette);
  plot.speed.curves(figures, (track, frame) => track.speed(frame, of.get(track)), time, duration, palette);
  plot.feet.rows(figures, time, duration, palette);
}

// The shift of a figure that is carried along beside the first one: by how much farther that one has gone.
function carried({ track, shift }, frame) {
  const first = kinesic.figures[0].track;
  const [own, its] = [track.way(frame), first.way(first.frame(kinesic.time))];
  return shift.map((at, axis) => at + its[axis] - own[axis]);
}

function picture() {
  const palette = colours();
  const centre = [0, 0];
  const follow = $("follow").checked;
  const drawn = kinesic.figures.map((figure) => {
    const { track } = figure;
    const frame = track.frame(kinesic.time);
    const [x, , z] = track.place(frame);
    const shift = follow && figure.carried ? carried(figure, frame) : figure.shift;
    centre[0] += (x + shift[0]) / kinesic.figures.length;
    centre[1] += (z + shift[1]) / kinesic.figures.length;
    const stands = track.pack.feet.filter((_, foot) => figure.contacts?.[foot][frame]);
    return { ...figure, shift, frame, stands, colour: palette[`c${figure.index % 6}`] };
  });
  if (follow) [kinesic.scene.target[0], kinesic.scene.target[2]] = centre;
  kinesic.scene.draw(drawn, palette);
}

// One picture of the screen: step what is to be stepped, draw.
let last = null;
function tick(now) {
  const elapsed = last === null ? 0 : Math.min(0.1, (now - last) / 1000);
  last = now;
  if (kinesic.playing) {
    const at = kinesic.time + elapsed * Number($("speed").value);
    if (at > kinesic.duration) seek(0);
    else pass(at);
  }
  const begin = performance.now();
  let made = 0;
  for (const result of kinesic.results) made += result ? result.advance(begin + 6) : 0;
  const stepped = performance.now();
  if (made) kinesic.cost.step += 0.1 * ((stepped - begin) / made - kinesic.cost.step);
  picture();
  // Plots every other picture: they cost more than the skeletons.
  if (kinesic.drawn % 2 === 0 || kinesic.stale) plots();
  kinesic.stale = false;
  kinesic.cost.picture += 0.05 * (performance.now() - stepped - kinesic.cost.picture);
  kinesic.drawn += 1;
  if (kinesic.drawn % 30 === 0) $("cost").textContent = `A picture takes ${kinesic.cost.picture.toFixed(1)} ms, a step of the core ${(1000 * kinesic.cost.step).toFixed(0)} us.`;
  requestAnimationFrame(tick);
}

// The host has stepped the same frames; a core of its own, so that the running ones keep their state.
async function compare(module) {
  const { data } = kinesic;
  for (const [index, pack] of data.packs.entries()) {
    const core = await Core.make(module, pack);
    for (const scene of data.scenes[index]) {
      const poses = floats(scene.source);
      const source = new Track(pack, poses.length / width(pack));
      source.poses.set(poses);
      kinesic.bits.push({ pack: pack.name, frames: Math.min(data.checked, source.frames), here: digest(core, source, data.strength, data.checked), host: scene.digest });
      await new Promise((done) => setTimeout(done));
    }
  }
  await compareEmotions(module, data, kinesic.bits);
  await kinesic.face?.compare(module, kinesic.bits);
  const same = kinesic.bits.every(({ here, host }) => here === host);
  const most = (of) => Math.max(0, ...kinesic.bits.map((each) => each[of] ?? 0));
  const over = [[most("frames"), "frames of every clip and pack"], [most("steps"), "frames of every emotion pack, strengths changing"],
    [most("changes"), "strengths of every face and pack"]].filter(([count]) => count);
  $("bits").textContent = same ? `Same output bits as the host over ${over.map((each) => each.join(" ")).join("; ")}.` : "OUTPUT DIFFERS from the host's: see kinesic.bits in the console.";
  kinesic.compared = true;
}

kinesic.state = () => ({
  ready: Boolean(kinesic.ready), errors: kinesic.errors, playing: kinesic.playing, time: kinesic.time, duration: kinesic.duration,
  frame: kinesic.figures[0]?.track.frame(kinesic.time), drawn: kinesic.drawn, clip: kinesic.clip, joint: kinesic.joint,
  camera: { ...kinesic.scene?.camera }, target: [...(kinesic.scene?.target ?? [])], cost: { ...kinesic.cost }, bits: kinesic.bits, compared: Boolean(kinesic.compared),
  figures: kinesic.figures.map(({ name, role, track, contacts }) => ({ name, role, frames: track.frames, pose: [...track.pose(track.frame(kinesic.time))],
    contacts: contacts?.map((stands) => [...stands].join("")) })),
  results: kinesic.results.map((result) => result && { strength: result.strength, passes: result.passes, done: result.done, frames: result.frames, changed: result.changed, mixed: Boolean(result.mixed) }),
  controls: kinesic.controls.map((each) => ({ ...each, mask: [...each.mask] })),
  emotions: kinesic.emotions.map((emotion) => emotion.state()),
  face: kinesic.face?.state(),
});

// Skeletons: everything about packs that play clips, and about emotions.
async function motions(module) {
  const { data } = kinesic;
  for (const pack of data.packs) {
    prepared(pack);
    kinesic.cores.push(await Core.make(module, pack));
    kinesic.controls.push({ strength: 1, mask: pack.joints.map(() => 1), shown: true, other: null });
  }
  for (const [index, pack] of data.emotions.entries()) kinesic.emotions.push(await Emotion.make(module, pack, index));
  kinesic.scene = new Scene($("scene"));
  kinesic.plot = { angle: new Plot($("angle"), $("angles"), 1), speed: new Plot($("velocity"), $("speeds"), 2), feet: new Plot($("contacts"), $("feet"), 0) };
  for (const plot of Object.values(kinesic.plot)) plot.seek = (share) => seek(share * kinesic.duration);
  $("clip").append(...data.clips.map(({ name }, k) => element("option", { value: k, textContent: name })));
  $("clip").addEventListener("change", () => { kinesic.clip = Number($("clip").value); kinesic.time = 0; show(); });
  $("clip").closest("label").hidden = !data.clips.length;
  $("packs").append(...data.packs.map(panel), ...kinesic.emotions.map((emotion) => emotion.panel()));
  $("joint").addEventListener("change", () => choose(Number($("joint").value)));
  const rate = () => (kinesic.frames - 1) / kinesic.duration;
  const step = (frames) => { play(false); seek(Math.round(kinesic.time * rate() + frames) / rate()); };
  $("time").addEventListener("input", () => seek(Number($("time").value) / rate()));
  $("play").addEventListener("click", () => play(!kinesic.playing));
  $("start").addEventListener("click", () => seek(0));
  $("back").addEventListener("click", () => step(-1));
  $("next").addEventListener("click", () => step(1));
  $("view").addEventListener("click", () => kinesic.scene.reset());
  addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const typing = event.target.closest?.("input[type=range], select");
    if (event.key === " " && !event.target.closest?.("button, summary, select, input[type=checkbox]")) play(!kinesic.playing);
    else if (event.key === "ArrowLeft" && !typing) step(-1);
    else if (event.key === "ArrowRight" && !typing) step(1);
    else if (event.key === "Home" && !typing) seek(0);
    else return;
    event.preventDefault();
  });
  show();
  requestAnimationFrame(tick);
  if (!matchMedia("(prefers-reduced-motion: reduce)").matches) play(true);
}

async function begin() {
  const { data } = kinesic;
  const module = await WebAssembly.compile(bytes(data.wasm));
  const moving = data.packs.length + data.emotions.length;
  $("motions").hidden = !moving;
  $("faces").hidden = !data.faces.length;
  if (moving) await motions(module);
  if (data.faces.length) kinesic.face = await Faces.make(module, data);
  kinesic.ready = true;
  await compare(module);
}

begin().catch(refuse);
