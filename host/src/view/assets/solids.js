// Triangles on a plain canvas: flat shades, drawn from the back to the front. It needs no graphics processor and no library.

// From where light falls, length one.
const LIGHT = [0.3, 0.8, 0.52];
const SHADES = 24;
const GROWN = 1.2; // pixels
const FEW = 2500;

class Solid {
  constructor({ vertices, triangles, colour, closed }) {
    this.vertices = floats(vertices);
    this.triangles = new Uint16Array(bytes(triangles).buffer);
    Object.assign(this, { colour, closed });
    const count = this.vertices.length / 3;
    [this.world, this.screen] = [new Float32Array(3 * count), new Float32Array(3 * count)];
  }
}

// What is seen of several robots in one picture.
class Painter {
  constructor(context) {
    this.context = context;
    this.shades = new Map();
    this.grow(4096);
  }

  grow(length) {
    const longer = (old, made) => (old && made.set(old), made);
    this.depths = longer(this.depths, new Float32Array(length));
    this.corners = longer(this.corners, new Float32Array(6 * length));
    this.styles = longer(this.styles, new Uint32Array(length));
  }

  begin() {
    this.count = 0;
    this.palette = [];
  }

  // A solid in a frame (place, quaternion), shifted on the ground.
  add(solid, frame, [shiftX, shiftZ], colour, { eye, project }) {
    const { vertices, triangles, world, screen } = solid;
    const [px, py, pz, x, y, z, w] = frame;
    const shades = this.range(solid.colour ?? colour);
    for (let k = 0; k < vertices.length; k += 3) {
      const [a, b, c] = [vertices[k], vertices[k + 1], vertices[k + 2]];
      const [s, t, u] = [2 * (y * c - z * b), 2 * (z * a - x * c), 2 * (x * b - y * a)];
      world[k] = px + shiftX + a + w * s + y * u - z * t;
      world[k + 1] = py + b + w * t + z * s - x * u;
      world[k + 2] = pz + shiftZ + c + w * u + x * t - y * s;
      project(world, k, screen);
    }
    for (let k = 0; k < triangles.length; k += 3) {
      const [a, b, c] = [3 * triangles[k], 3 * triangles[k + 1], 3 * triangles[k + 2]];
      // One corner behind the eye: none of it is drawn.
      if (!(screen[a + 2] > 0.05 * eye && screen[b + 2] > 0.05 * eye && screen[c + 2] > 0.05 * eye)) continue;
      const across = (screen[b] - screen[a]) * (screen[c + 1] - screen[a + 1]) - (screen[c] - screen[a]) * (screen[b + 1] - screen[a + 1]);
      if (solid.closed && across >= 0) continue;
      const [ux, uy, uz] = [world[b] - world[a], world[b + 1] - world[a + 1], world[b + 2] - world[a + 2]];
      const [vx, vy, vz] = [world[c] - world[a], world[c + 1] - world[a + 1], world[c + 2] - world[a + 2]];
      const [nx, ny, nz] = [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
      const long = Math.hypot(nx, ny, nz);
      if (!long) continue;
      // An open mesh turns its triangles either way: the side that is seen is lit.
      const light = ((across < 0 ? 1 : -1) * (nx * LIGHT[0] + ny * LIGHT[1] + nz * LIGHT[2])) / long;
      if (this.count === this.depths.length) this.grow(2 * this.count);
      const at = this.count++;
      this.depths[at] = screen[a + 2] + screen[b + 2] + screen[c + 2];
      this.styles[at] = shades + Math.round((SHADES - 1) * (0.5 + 0.5 * light));
      // A little larger than it is, so that no gap shows between neighbours.
      const [midX, midY] = [(screen[a] + screen[b] + screen[c]) / 3, (screen[a + 1] + screen[b + 1] + screen[c + 1]) / 3];
      [a, b, c].forEach((corner, k) => {
        const [dx, dy] = [screen[corner] - midX, screen[corner + 1] - midY];
        const grown = 1 + GROWN / Math.max(1, Math.hypot(dx, dy));
        this.corners[6 * at + 2 * k] = midX + grown * dx;
        this.corners[6 * at + 2 * k + 1] = midY + grown * dy;
      });
    }
  }

  // Index of the darkest shade of a colour [r, g, b], 0 to 1.
  range(colour) {
    const first = this.palette.length;
    for (let shade = 0; shade < SHADES; shade++) {
      const light = 0.38 + 0.62 * (shade / (SHADES - 1));
      this.palette.push(`rgb(${colour.map((x) => Math.round(255 * (0.1 + 0.88 * x) * light)).join(" ")})`);
    }
    return first;
  }

  // Draws what was added.
  paint() {
    const { context, count, depths, corners, styles, palette } = this;
    const order = Uint32Array.from({ length: count }, (_, at) => at).sort((a, b) => depths[b] - depths[a]);
    let open = -1;
    // A line of their own colour closes the gaps between slivers, where there are few triangles.
    const close = () => {
      if (open < 0) return;
      context.fill();
      if (count < FEW) context.stroke();
    };
    context.lineWidth = 1;
    context.lineJoin = "round";
    for (const at of order) {
      if (styles[at] !== open) {
        close();
        open = styles[at];
        context.fillStyle = context.strokeStyle = palette[open];
        context.beginPath();
      }
      const k = 6 * at;
      context.moveTo(corners[k], corners[k + 1]);
      context.lineTo(corners[k + 2], corners[k + 3]);
      context.lineTo(corners[k + 4], corners[k + 5]);
      context.closePath();
    }
    close();
  }
}
