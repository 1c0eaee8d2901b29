// Curves over time with a cursor; what is under the pointer, or at the current time, is written beside the caption.

class Plot {
  constructor(canvas, values, unit) {
    Object.assign(this, { canvas, values, unit, hover: null, context: canvas.getContext("2d") });
    canvas.addEventListener("pointermove", (event) => (this.hover = this.share(event)));
    canvas.addEventListener("pointerleave", () => (this.hover = null));
    canvas.addEventListener("click", (event) => this.seek?.(this.share(event)));
  }

  share(event) {
    const box = this.canvas.getBoundingClientRect();
    return Math.max(0, Math.min(1, (event.clientX - box.left) / box.width));
  }

  cursor(now, duration, height, colours) {
    const { context, canvas } = this;
    for (const [share, colour] of [[now / duration, colours.ink], [this.hover, colours.soft]]) {
      if (share === null) continue;
      context.strokeStyle = colour;
      context.lineWidth = devicePixelRatio;
      context.beginPath();
      context.moveTo(share * canvas.width, 0);
      context.lineTo(share * canvas.width, height);
      context.stroke();
    }
  }

  // `value(figure.track, frame)` a figure.
  curves(figures, value, now, duration, colours) {
    const [width, height] = fit(this.canvas);
    const { context } = this;
    context.clearRect(0, 0, width, height);
    const curves = figures.map(({ track }) => Float32Array.from({ length: track.frames }, (_, frame) => value(track, frame)));
    const most = Math.max(1e-3, ...curves.map((curve) => curve.reduce((a, b) => Math.max(a, b), 0)));
    const least = Math.min(0, ...curves.map((curve) => curve.reduce((a, b) => Math.min(a, b), 0)));
    const y = (v) => height - 4 - ((v - least) / (most - least)) * (height - 10);
    context.fillStyle = colours.soft;
    context.font = `${11 * devicePixelRatio}px system-ui, sans-serif`;
    context.textAlign = "left";
    context.fillText(most.toPrecision(3), 4, 13 * devicePixelRatio);
    if (least < 0) context.fillText(least.toPrecision(3), 4, height - 6);
    figures.forEach(({ track, colour }, k) => {
      context.strokeStyle = colour;
      context.lineWidth = 1.6 * devicePixelRatio;
      context.beginPath();
      curves[k].forEach((v, frame) => context.lineTo((frame / track.rate / duration) * width, y(v)));
      context.stroke();
    });
    this.cursor(now, duration, height, colours);
    const at = this.hover === null ? now : this.hover * duration;
    this.values.textContent = figures.map(({ track, name }, k) => `${name} ${curves[k][track.frame(at)].toFixed(this.unit)}`).join("  ");
  }

  // Rows of contacts: two a figure.
  rows(figures, now, duration, colours) {
    const row = 11;
    this.canvas.style.height = `${figures.length * (2 * row + 6) + 6}px`;
    const [width, height] = fit(this.canvas);
    const { context } = this;
    context.clearRect(0, 0, width, height);
    figures.forEach(({ track, colour, contacts }, k) => {
      context.fillStyle = colour;
      contacts.forEach((stands, foot) => {
        const top = (6 + k * (2 * row + 6) + foot * row) * devicePixelRatio;
        for (let frame = 0; frame < stands.length; ) {
          let end = frame;
          while (end < stands.length && stands[end]) end += 1;
          if (end > frame) {
            const x = (seconds) => (seconds / track.rate / duration) * width;
            context.fillRect(x(frame), top, x(end) - x(frame), (row - 2) * devicePixelRatio);
          }
          frame = Math.max(end, frame + 1);
        }
      });
    });
    this.cursor(now, duration, height, colours);
    const at = this.hover === null ? now : this.hover * duration;
    const feet = ({ track, contacts }) => contacts.map((stands, foot) => (stands[track.frame(at)] ? "LR"[foot] : "-")).join("");
    this.values.textContent = figures.map((figure) => `${figure.name} ${feet(figure)}`).join("  ");
  }
}
