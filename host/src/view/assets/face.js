// Faces: landmarks by the core, the picture through the warps that the host has made of it.

class FaceCore {
  static async make(module, pack) {
    const core = new FaceCore();
    core.exports = await instance(module, pack, "load_face");
    const view = (address, length) => new Float32Array(core.exports.memory.buffer, address, length);
    core.landmarks = view(core.exports.landmarks(), 136);
    core.changed = view(core.exports.changed(), 136);
    core.reading = view(core.exports.reading(), 4);
    return core;
  }

  change(landmarks, by) {
    this.landmarks.set(landmarks);
    this.exports.change(by);
    const [cluster, strength, target, after] = this.reading;
    return { cluster, strength, target, after, landmarks: Float32Array.from(this.changed) };
  }
}

// The displacement at a change of strength: linear between the host's warps on either side.
function field({ changes, warps, parts }, by) {
  let k = 0;
  while (k + 2 < changes.length && by > changes[k + 1]) k += 1;
  const t = (by - changes[k]) / (changes[k + 1] - changes[k]);
  const [a, b] = [warps[k], warps[k + 1]];
  return Float32Array.from(a, (value, i) => (value + t * (b[i] - value)) / parts);
}

// Weights of four neighbours at a place between the second and the third: cubic convolution (Catmull-Rom).
function taps(t, weights) {
  weights[0] = t * (-0.5 + t * (1 - 0.5 * t));
  weights[1] = 1 + t * t * (-2.5 + 1.5 * t);
  weights[2] = t * (0.5 + t * (2 - 1.5 * t));
  weights[3] = t * t * (-0.5 + 0.5 * t);
}

// A picture through a displacement on a grid, bilinear between its nodes; what does not move is copied. Plain loops: this runs for
// every pixel of the face while a slider moves.
function warped(picture, { origin, cell, columns }, moves) {
  const { width, height, data } = picture;
  const out = new Uint8ClampedArray(data);
  const rows = moves.length / 2 / columns;
  const first = (axis) => Math.max(0, Math.ceil(origin[axis]));
  const end = (axis, nodes, size) => Math.min(size, Math.floor(origin[axis] + cell * (nodes - 1)) + 1);
  const [left, right, bottom] = [first(0), end(0, columns, width), end(1, rows, height)];
  const [across, down] = [new Float64Array(4), new Float64Array(4)];
  for (let y = first(1); y < bottom; y++) {
    const v = (y - origin[1]) / cell;
    const row = Math.min(rows - 2, Math.floor(v));
    for (let x = left; x < right; x++) {
      const u = (x - origin[0]) / cell;
      const column = Math.min(columns - 2, Math.floor(u));
      const s = u - column;
      const t = v - row;
      const a = 2 * (row * columns + column);
      const b = a + 2 * columns;
      const dx = (1 - t) * ((1 - s) * moves[a] + s * moves[a + 2]) + t * ((1 - s) * moves[b] + s * moves[b + 2]);
      const dy = (1 - t) * ((1 - s) * moves[a + 1] + s * moves[a + 3]) + t * ((1 - s) * moves[b + 1] + s * moves[b + 3]);
      if (dx === 0 && dy === 0) continue;
      const i0 = Math.floor(x + dx);
      const j0 = Math.floor(y + dy);
      taps(x + dx - i0, across);
      taps(y + dy - j0, down);
      let red = 0;
      let green = 0;
      let blue = 0;
      for (let j = 0; j < 4; j++) {
        const line = width * Math.max(0, Math.min(height - 1, j0 + j - 1));
        for (let i = 0; i < 4; i++) {
          const at = 4 * (line + Math.max(0, Math.min(width - 1, i0 + i - 1)));
          const weight = down[j] * across[i];
          red += weight * data[at];
          green += weight * data[at + 1];
          blue += weight * data[at + 2];
        }
      }
      const to = 4 * (y * width + x);
      out[to] = red;
      out[to + 1] = green;
      out[to + 2] = blue;
    }
  }
  return new ImageData(out, width, height);
}

class Faces {
  static async make(module, data) {
    const faces = new Faces();
    Object.assign(faces, { data, cores: [], pictures: [], pack: 0, chosen: 0, by: 0, drawn: 0, cost: 0 });
    for (const pack of data.facePacks) faces.cores.push(await FaceCore.make(module, pack));
    for (const face of data.faces) {
      const bitmap = await createImageBitmap(new Blob([bytes(face.jpeg)], { type: "image/jpeg" }), { colorSpaceConversion: "none" });
      const canvas = element("canvas", { width: bitmap.width, height: bitmap.height });
      const context = canvas.getContext("2d", { willReadFrequently: true });
      context.drawImage(bitmap, 0, 0);
      faces.pictures.push({ image: context.getImageData(0, 0, bitmap.width, bitmap.height), landmarks: floats(face.landmarks), scale: face.scale });
    }
    for (const scene of data.faceScenes.flat()) scene.warps = scene.warps.map((text) => new Int16Array(bytes(text).buffer));
    faces.listen();
    faces.choose();
    return faces;
  }

  listen() {
    const list = (id, names, change) => {
      $(id).append(...names.map((name, k) => element("option", { value: k, textContent: name })));
      $(id).addEventListener("change", () => change(Number($(id).value)));
    };
    list("picture", this.data.faces.map(({ name }) => name), (k) => { this.chosen = k; this.choose(); });
    $("pictures").hidden = this.data.faces.length < 2;
    if (this.data.facePacks.length > 1) {
      $("face-packs").append(element("label", { className: "row" }, "Pack ", element("select", { id: "face-pack" })));
      list("face-pack", this.data.facePacks.map(({ name }) => name), (k) => { this.pack = k; this.choose(); });
    }
    $("unchanged").addEventListener("click", () => this.turn(0));
    $("points").addEventListener("change", () => this.change(this.by));
  }

  scene() {
    return this.data.faceScenes[this.pack][this.chosen];
  }

  // Another picture or pack.
  choose() {
    const { changes, between } = this.scene();
    const { name, attribute, plausible, size } = this.data.facePacks[this.pack];
    $("expression").textContent = attribute;
    $("change-row").replaceChildren(slider({ id: "change", label: "Change of strength (0 = as photographed)", min: changes[0], max: changes.at(-1),
      step: "any", value: 0, change: (by) => this.change(by) }));
    $("face-note").textContent = `Strengths are in units of the labels: 0 as faces labelled 0, 1 as faces labelled 1; the slider ends where ` +
      `${name} (${size} bytes) finds them plausible, ${plausible.map((x) => x.toFixed(2)).join(" to ")}. Landmarks are computed here; the ` +
      `picture goes through ${changes.length} warps made on the host, between two of them mixed (off by ${between[0].toFixed(2)} pixels on average, ${between[1].toFixed(1)} at most).`;
    this.change(0);
  }

  turn(by) {
    $("change").value = by;
    $("change").dispatchEvent(new Event("input"));
  }

  change(by) {
    this.by = by;
    if (!this.waiting) requestAnimationFrame(() => this.draw());
    this.waiting = true;
  }

  draw() {
    this.waiting = false;
    const begin = performance.now();
    const { image, landmarks, scale } = this.pictures[this.chosen];
    this.reading = this.cores[this.pack].change(landmarks, this.by);
    this.shown = warped(image, this.scene(), field(this.scene(), this.by));
    const canvas = $("face");
    if (canvas.width !== image.width || canvas.height !== image.height) Object.assign(canvas, { width: image.width, height: image.height });
    const context = canvas.getContext("2d", { willReadFrequently: true });
    context.putImageData(this.shown, 0, 0);
    if ($("points").checked) this.points(context, landmarks, scale);
    for (const of of ["before", "target", "after"]) $(`strength-${of}`).textContent = this.reading[of === "before" ? "strength" : of].toFixed(2);
    const { attribute } = this.data.facePacks[this.pack];
    canvas.setAttribute("aria-label", `${this.data.faces[this.chosen].name}: ${attribute} ${this.reading.after.toFixed(2)}, as photographed ${this.reading.strength.toFixed(2)}`);
    this.cost = performance.now() - begin;
    $("face-cost").textContent = `A change takes ${this.cost.toFixed(1)} ms, nearly all of it for the picture.`;
    this.drawn += 1;
  }

  // Where the landmarks are, with a line from where they were.
  points(context, landmarks, scale) {
    const palette = colours();
    const size = Math.max(1.5, Math.min(context.canvas.width, context.canvas.height) / 220);
    const at = (points, k) => [0, 1].map((axis) => (points[2 * k + axis] + 0.5) * scale);
    for (let k = 0; k < 68; k++) {
      const [from, to] = [at(landmarks, k), at(this.reading.landmarks, k)];
      context.strokeStyle = context.fillStyle = palette.c2;
      context.lineWidth = size * 0.7;
      context.beginPath();
      context.moveTo(...from);
      context.lineTo(...to);
      context.stroke();
      context.beginPath();
      context.arc(...to, size, 0, 7);
      context.fill();
    }
  }

  // The host has changed the same landmarks.
  async compare(module, bits) {
    const { facePacks, faceScenes, faces } = this.data;
    for (const [index, pack] of facePacks.entries()) {
      const core = await FaceCore.make(module, pack);
      faces.forEach(({ name }, chosen) => {
        const { changes, digest: host } = faceScenes[index][chosen];
        const digest = new Digest();
        for (const by of changes) digest.add(new Uint32Array(core.change(this.pictures[chosen].landmarks, by).landmarks.buffer));
        bits.push({ pack: pack.name, face: name, changes: changes.length, here: digest.text, host });
      });
    }
  }

  state() {
    const { pack, chosen, by, drawn, waiting, cost, reading } = this;
    return { pack, picture: chosen, change: by, drawn, waiting: Boolean(waiting), cost, changes: this.scene().changes, between: this.scene().between,
      reading: reading && { ...reading, landmarks: [...reading.landmarks] } };
  }
}
