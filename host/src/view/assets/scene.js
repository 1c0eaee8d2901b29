// Figures in space on a plain canvas: a camera that turns about a point; people as lines and discs, robots as solids.

const UPRIGHT = { yaw: 0.35, pitch: 0.2 };

// Room that a track needs, m: a person's, or what a robot reaches in it.
const room = (track) => track.pack.machine?.extent(track) ?? { height: 1.75, reach: 0.65, front: 0 };

class Scene {
  constructor(canvas) {
    this.canvas = canvas;
    this.context = canvas.getContext("2d");
    this.painter = new Painter(this.context);
    this.target = [0, 0.9, 0];
    Object.assign(this, { count: 1, front: 0, slot: 1.3, size: 1 });
    this.reset();
    this.listen();
  }

  // As many figures stand there, each with so much room: all of them are to be seen, unless the person has chosen a view.
  stand(count, { height, reach, front }) {
    // `slot`: metres between figures; `size`: against a person.
    Object.assign(this, { count, front, slot: 2 * reach * (front ? 1.15 : 1), size: Math.max((height + 0.4 * front) / 1.75, 0.85 * reach) });
    this.target[1] = 0.5 * height + 0.025 * this.size;
    if (!this.moved) this.reset();
  }

  // So far away that people with their arms up, and a row of them, fill the picture.
  reset() {
    const [width, height] = fit(this.canvas);
    const row = this.slot * (this.count - 1);
    const across = (focal(width, height) / width) * (row + 0.85 * this.slot) + 0.5 * row * Math.sin(UPRIGHT.yaw);
    this.camera = { ...UPRIGHT, distance: this.front + Math.max(across, (focal(width, height) / height) * 3.25 * this.size) };
    this.moved = false;
  }

  turn(yaw, pitch) {
    this.moved = true;
    this.camera.yaw += yaw;
    this.camera.pitch = Math.max(-0.2, Math.min(1.5, this.camera.pitch + pitch));
  }

  zoom(factor) {
    this.moved = true;
    this.camera.distance = Math.max(1.5 * this.size, Math.min(30 * this.size, this.camera.distance * factor));
  }

  listen() {
    const fingers = new Map();
    const spread = () => {
      const [a, b] = [...fingers.values()];
      return Math.hypot(a.x - b.x, a.y - b.y);
    };
    this.canvas.addEventListener("pointerdown", (event) => {
      this.canvas.setPointerCapture(event.pointerId);
      fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    });
    this.canvas.addEventListener("pointermove", (event) => {
      const finger = fingers.get(event.pointerId);
      if (!finger) return;
      const before = fingers.size === 2 ? spread() : 0;
      const [dx, dy] = [event.clientX - finger.x, event.clientY - finger.y];
      [finger.x, finger.y] = [event.clientX, event.clientY];
      if (fingers.size === 2) this.zoom(before / Math.max(1, spread()));
      else this.turn(-0.008 * dx, 0.006 * dy);
    });
    for (const end of ["pointerup", "pointercancel"]) this.canvas.addEventListener(end, (event) => fingers.delete(event.pointerId));
    this.canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      this.zoom(Math.exp(0.001 * event.deltaY));
    }, { passive: false });
    this.canvas.addEventListener("keydown", (event) => {
      const keys = {
        ArrowLeft: () => this.turn(-0.1, 0), ArrowRight: () => this.turn(0.1, 0), ArrowUp: () => this.turn(0, 0.08),
        ArrowDown: () => this.turn(0, -0.08), "+": () => this.zoom(0.9), "=": () => this.zoom(0.9), "-": () => this.zoom(1.1),
        0: () => this.reset(),
      };
      if (!keys[event.key] || event.ctrlKey || event.metaKey || event.altKey) return;
      keys[event.key]();
      event.preventDefault();
      event.stopPropagation();
    });
  }

  // Sizes the canvas to its box. `point` projects x, y, z to [x, y, pixels a metre], or null behind the camera; `project` the three
  // numbers at an index of one array to x, y and depth in another.
  projection() {
    const [width, height] = fit(this.canvas);
    const { yaw, pitch, distance } = this.camera;
    const [sy, cy, sp, cp] = [Math.sin(yaw), Math.cos(yaw), Math.sin(pitch), Math.cos(pitch)];
    const scaled = focal(width, height);
    const [tx, ty, tz] = this.target;
    const project = (from, k, to) => {
      const [dx, dy, dz] = [from[k] - tx, from[k + 1] - ty, from[k + 2] - tz];
      const away = -(sy * dx + cy * dz);
      const depth = distance + cp * away - sp * dy;
      const scale = scaled / depth;
      to[k] = width / 2 + scale * (cy * dx - sy * dz);
      to[k + 1] = height / 2 - scale * (cp * dy + sp * away);
      to[k + 2] = depth;
    };
    const made = [0, 0, 0];
    const point = (...at) => {
      project(at, 0, made);
      return made[2] < 0.2 * this.size ? null : [made[0], made[1], scaled / made[2]];
    };
    return { point, project, eye: this.size };
  }

  // Figures: { track, frame, shift: [x, z], colour, name, stands: [joint] }.
  draw(figures, colours) {
    const view = this.projection();
    const { context, painter } = this;
    context.clearRect(0, 0, this.canvas.width, this.canvas.height);
    this.ground(view.point, colours);
    painter.begin();
    for (const figure of figures) {
      if (figure.track.pack.machine) this.robot(view, figure);
      else this.person(view.point, figure, colours);
    }
    painter.paint();
    for (const figure of figures.filter(({ track }) => track.pack.machine)) this.named(view.point, figure, colours);
  }

  // A robot's solids, and a disc in the figure's colour under it: its parts have their own.
  robot(view, { track, frame, shift, colour }) {
    const { machine } = track.pack;
    const { context } = this;
    const spot = view.point(shift[0], 0, shift[1]);
    if (spot) {
      context.globalAlpha = 0.3;
      context.fillStyle = colour;
      context.beginPath();
      const radius = 0.42 * this.slot * spot[2];
      context.ellipse(spot[0], spot[1], radius, radius * Math.max(0.1, Math.sin(Math.abs(this.camera.pitch))), 0, 0, 7);
      context.fill();
      context.globalAlpha = 1;
    }
    const plain = rgb(context, colour);
    const frames = machine.place(track.pose(frame));
    machine.links.forEach(({ solids }, link) => {
      for (const solid of solids) this.painter.add(solid, frames.subarray(7 * link, 7 * link + 7), shift, plain, view);
    });
  }

  // A robot's name, over it.
  named(point, { track, shift, name }, colours) {
    const top = point(shift[0], 2 * this.target[1], shift[1]);
    if (top) this.label(name, top[0], top[1], colours);
  }

  label(name, x, y, colours) {
    const { context } = this;
    context.fillStyle = colours.ink;
    context.font = `${13 * devicePixelRatio}px system-ui, sans-serif`;
    context.textAlign = "center";
    context.fillText(name, x, y);
  }

  ground(project, colours) {
    const { context } = this;
    // Squares of a metre under people, of ten centimetres under a desk robot.
    const step = this.size < 0.4 ? 0.1 : 1;
    const [cx, cz] = [Math.round(this.target[0] / step), Math.round(this.target[2] / step)];
    context.strokeStyle = colours.line;
    context.lineWidth = devicePixelRatio;
    const reach = 5;
    for (let k = -reach; k <= reach; k++) {
      for (const [from, to] of [[[cx + k, cz - reach], [cx + k, cz + reach]], [[cx - reach, cz + k], [cx + reach, cz + k]]]) {
        const [a, b] = [project(step * from[0], 0, step * from[1]), project(step * to[0], 0, step * to[1])];
        if (!a || !b) continue;
        context.beginPath();
        context.moveTo(a[0], a[1]);
        context.lineTo(b[0], b[1]);
        context.stroke();
      }
    }
  }

  person(project, { track, frame, shift, colour, name, stands }, colours) {
    const { context } = this;
    const places = track.place(frame);
    const at = (joint) => [places[3 * joint] + shift[0], places[3 * joint + 1], places[3 * joint + 2] + shift[1]];
    context.globalAlpha = 0.35;
    context.fillStyle = colour;
    for (const joint of stands) {
      const [x, , z] = at(joint);
      const spot = project(x, 0, z);
      if (!spot) continue;
      context.beginPath();
      context.ellipse(spot[0], spot[1], 0.12 * spot[2], 0.12 * spot[2] * Math.max(0.1, Math.sin(Math.abs(this.camera.pitch))), 0, 0, 7);
      context.fill();
    }
    context.globalAlpha = 1;
    context.strokeStyle = colour;
    context.lineCap = "round";
    const bones = track.pack.bones.map(([parent, child]) => [at(parent), at(child)]);
    const tips = track.pack.joints.flatMap((joint, index) => (joint.tip ? [[at(index), tip(track, frame, index, joint, at(index))]] : []));
    for (const [from, to] of bones.concat(tips)) {
      const [a, b] = [project(...from), project(...to)];
      if (!a || !b) continue;
      context.lineWidth = Math.max(1.5 * devicePixelRatio, 0.028 * (a[2] + b[2]) / 2);
      context.beginPath();
      context.moveTo(a[0], a[1]);
      context.lineTo(b[0], b[1]);
      context.stroke();
    }
    let top = null;
    for (let joint = 0; joint < track.pack.joints.length; joint++) {
      const spot = project(...at(joint));
      if (!spot) continue;
      if (!top || spot[1] < top[1]) top = spot;
      const size = joint === track.pack.head ? 0.09 : 0.022;
      context.beginPath();
      context.arc(spot[0], spot[1] - (joint === track.pack.head ? 0.06 * spot[2] : 0), Math.max(1.5, size * spot[2]), 0, 7);
      context.fill();
    }
    if (top) this.label(name, top[0], top[1] - 0.2 * top[2], colours);
  }
}

// End of a leaf's bone: the joint's place and its world rotation, from the local ones above it.
function tip(track, frame, joint, { tip: offset }, place) {
  const pose = track.pose(frame);
  let v = offset;
  for (let at = joint; at !== null; at = track.pack.joints[at].parent) v = turned(pose.subarray(3 + 4 * at, 7 + 4 * at), v);
  return [place[0] + v[0], place[1] + v[1], place[2] + v[2]];
}

// A colour of the page as red, green, blue, 0 to 1.
function rgb(context, colour) {
  context.fillStyle = colour;
  return [1, 3, 5].map((at) => parseInt(context.fillStyle.slice(at, at + 2), 16) / 255);
}

// Pixels that something a metre wide has in a metre's distance.
const focal = (width, height) => Math.min(1.6 * height, width);

// A canvas as many pixels wide as its box is; returns its size in pixels.
function fit(canvas) {
  const box = canvas.getBoundingClientRect();
  const [width, height] = [Math.max(1, Math.round(box.width * devicePixelRatio)), Math.max(1, Math.round(box.height * devicePixelRatio))];
  if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
  return [width, height];
}
