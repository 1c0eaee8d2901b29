// Links of a robot, moved by its coordinates, as `robot::look` of the host places them.

class Machine {
  constructor(data) {
    Object.assign(this, data);
    this.frames = new Float64Array(7 * data.links.length);
    for (const link of data.links) link.solids = link.solids.map((solid) => new Solid(solid));
  }

  // Frames of all links, place and quaternion `x y z w`; the array is the machine's own.
  place(coordinates) {
    const { frames } = this;
    this.links.forEach(({ parent, at, way, axis, drive }, index) => {
      const value = drive ? drive[1] * coordinates[drive[0]] + drive[2] : 0;
      const place = way === "slides" ? at.slice(0, 3).map((x, k) => x + turned(at.slice(3), axis)[k] * value) : at.slice(0, 3);
      const half = way === "turns" ? value / 2 : 0;
      const turn = product(at.slice(3), [...axis.map((x) => x * Math.sin(half)), Math.cos(half)]);
      const from = parent === null ? null : frames.subarray(7 * parent, 7 * parent + 7);
      const own = frames.subarray(7 * index, 7 * index + 7);
      if (!from) own.set([...place, ...turn]);
      else {
        const carrier = from.subarray(3);
        own.set([...turned(carrier, place).map((x, k) => x + from[k]), ...product(carrier, turn)]);
      }
    });
    return frames;
  }

  // Places of the joints, three numbers each.
  positions(coordinates) {
    const frames = this.place(coordinates);
    return Float32Array.from({ length: 3 * this.joints.length }, (_, k) => frames[7 * this.joints[Math.floor(k / 3)].link + (k % 3)]);
  }

  // How high a track reaches, how far to the sides, and how far towards who looks, m. What is before and behind is seen shortened.
  extent(track) {
    const v = [0, 0, 0];
    let [height, reach, front] = [0.01, 0.01, 0];
    for (let frame = 0; frame < track.frames; frame += Math.ceil(track.frames / 16)) {
      const frames = this.place(track.pose(frame));
      this.links.forEach(({ solids }, link) => {
        const [place, turn] = [frames.subarray(7 * link, 7 * link + 3), frames.subarray(7 * link + 3, 7 * link + 7)];
        for (const { vertices } of solids) {
          for (let k = 0; k < vertices.length; k += 9) {
            [v[0], v[1], v[2]] = [vertices[k], vertices[k + 1], vertices[k + 2]];
            const [x, y, z] = turned(turn, v);
            height = Math.max(height, place[1] + y);
            reach = Math.max(reach, 1.1 * Math.abs(place[0] + x), 0.6 * Math.abs(place[2] + z));
            front = Math.max(front, place[2] + z);
          }
        }
      });
    }
    return { height, reach, front };
  }

  // What a coordinate of a joint is shown in: degrees, or mm.
  shown({ coordinate, slides }, frame) {
    return coordinate === null ? 0 : frame[coordinate] * (slides ? 1000 : 180 / Math.PI);
  }
}

// A vector turned by a quaternion.
function turned([x, y, z, w], v) {
  const t = [2 * (y * v[2] - z * v[1]), 2 * (z * v[0] - x * v[2]), 2 * (x * v[1] - y * v[0])];
  return [v[0] + w * t[0] + y * t[2] - z * t[1], v[1] + w * t[1] + z * t[0] - x * t[2], v[2] + w * t[2] + x * t[1] - y * t[0]];
}

// First `b`, then `a`.
const product = ([x, y, z, w], [i, j, k, r]) =>
  [w * i + x * r + y * k - z * j, w * j - x * k + y * r + z * i, w * k + x * j - y * i + z * r, w * r - x * i - y * j - z * k];
