// Skeletons in space on a plain canvas: a camera that turns about a point, lines and discs.

const SLOT = 1.3; // metres between figures
const UPRIGHT = { yaw: 0.35, pitch: 0.2 };

class Scene {
  constructor(canvas) {
    this.canvas = canvas;
    this.context = canvas.getContext("2d");
    this.target = [0, 0.9, 0];
    this.count = 1;
    this.reset();
    this.listen();
  }

  // As many figures stand there: all of them are to be seen, unless the person has chosen a view.
  stand(count) {
    this.count = count;
    if (!this.moved) this.reset();
  }

  // So far away that people with their arms up, and a row of them, fill the picture.
  reset() {
    const [width, height] = fit(this.canvas);
    const row = SLOT * (this.count - 1);
    const across = (focal(width, height) / width) * (row + 1.1) + 0.5 * row * Math.sin(UPRIGHT.yaw);
    this.camera = { ...UPRIGHT, distance: Math.max(across, (focal(width, height) / height) * 3.25) };
    this.moved = false;
  }

  turn(yaw, pitch) {
    this.moved = true;
    this.camera.yaw += yaw;
    this.camera.pitch = Math.max(-0.2, Math.min(1.5, this.camera.pitch + pitch));
  }

  zoom(factor) {
    this.moved = true;
    this.camera.distance = Math.max(1.5, Math.min(30, this.camera.distance * factor));
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

  // Sizes the canvas to its box and returns the projection of a point to [x, y, pixels a metre], or null behind the camera.
  projection() {
    const [width, height] = fit(this.canvas);
    const { yaw, pitch, distance } = this.camera;
    const [sy, cy, sp, cp] = [Math.sin(yaw), Math.cos(yaw), Math.sin(pitch), Math.cos(pitch)];
    const scaled = focal(width, height);
    return (x, y, z) => {
      const [dx, dy, dz] = [x - this.target[0], y - this.target[1], z - this.target[2]];
      const right = cy * dx - sy * dz;
      const away = -(sy * dx + cy * dz);
      const depth = distance + cp * away - sp * dy;
      if (depth < 0.2) return null;
      const scale = scaled / depth;
      return [width / 2 + scale * right, height / 2 - scale * (cp * dy + sp * away), scale];
    };
  }

  // Figures: { track, frame, shift: [x, z], colour, name, stands: [joint] }.
  draw(figures, colours) {
    const project = this.projection();
    const { context } = this;
    context.clearRect(0, 0, this.canvas.width, this.canvas.height);
    this.ground(project, colours);
    for (const figure of figures) this.figure(project, figure, colours);
  }

  ground(project, colours) {
    const { context } = this;
    const [cx, cz] = [Math.round(this.target[0]), Math.round(this.target[2])];
    context.strokeStyle = colours.line;
    context.lineWidth = devicePixelRatio;
    const reach = 5;
    for (let k = -reach; k <= reach; k++) {
      for (const [from, to] of [[[cx + k, cz - reach], [cx + k, cz + reach]], [[cx - reach, cz + k], [cx + reach, cz + k]]]) {
        const [a, b] = [project(from[0], 0, from[1]), project(to[0], 0, to[1])];
        if (!a || !b) continue;
        context.beginPath();
        context.moveTo(a[0], a[1]);
        context.lineTo(b[0], b[1]);
        context.stroke();
      }
    }
  }

  figure(project, { track, frame, shift, colour, name, stands }, colours) {
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
    if (!top) return;
    context.fillStyle = colours.ink;
    context.font = `${13 * devicePixelRatio}px system-ui, sans-serif`;
    context.textAlign = "center";
    context.fillText(name, top[0], top[1] - 0.2 * top[2]);
  }
}

// End of a leaf's bone: the joint's place and its world rotation, from the local ones above it.
function tip(track, frame, joint, { tip: offset }, place) {
  const pose = track.pose(frame);
  let v = offset;
  for (let at = joint; at !== null; at = track.pack.joints[at].parent) {
    const [x, y, z, w] = pose.subarray(3 + 4 * at, 7 + 4 * at);
    const t = [2 * (y * v[2] - z * v[1]), 2 * (z * v[0] - x * v[2]), 2 * (x * v[1] - y * v[0])];
    v = [
      v[0] + w * t[0] + y * t[2] - z * t[1],
      v[1] + w * t[1] + z * t[0] - x * t[2],
      v[2] + w * t[2] + x * t[1] - y * t[0],
    ];
  }
  return [place[0] + v[0], place[1] + v[1], place[2] + v[2]];
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
