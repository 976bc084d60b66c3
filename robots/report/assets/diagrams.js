// Diagrams that are not over time.

/** The paths of a run from above, with the robot's place. */
class PathPlot {
  constructor(container, run) {
    this.run = run;
    const figure = document.createElement("figure");
    figure.className = "plot";
    const legend = run.animation.paths.map(({ stroke }) => `<li><svg class="swatch" width="26" height="10" aria-hidden="true"><path class="${stroke} path" d="M1 5H25"/></svg><span>${stroke}</span></li>`);
    figure.innerHTML =
      `<figcaption><span class="name">Path from above</span> <span class="unit">[m]</span></figcaption>` +
      `<ul class="legend">${legend.join("")}</ul><div class="drawing"></div>`;
    container.append(figure);
    this.drawing = figure.querySelector(".drawing");
    this.render(this.drawing.clientWidth || 640);
  }

  render(width) {
    if (width === this.width) return;
    this.width = width;
    const height = Math.round(Math.min(320, 0.62 * width));
    const { lines, toX, toY, scale } = pathsFromAbove(this.run.animation.paths, width, height, 44);
    [this.toX, this.toY] = [toX, toY];
    const [left, right, top, floor] = [54, width - 14, 22, height - 34];
    const across = ticks([left, right].map((x) => (x - toX(0)) / scale), Math.max(3, width / 60), true);
    const up = ticks([floor, top].map((y) => (toY(0) - y) / scale), 6, true);
    const columns = across.values.map((value) => {
      const x = toX(value).toFixed(1);
      return `<path class="grid" d="M${x} ${top}V${floor}"/><text x="${x}" y="${floor + 17}" text-anchor="middle">${axisText(value, across.digits)}</text>`;
    });
    const rows = up.values.map((value) => {
      const y = toY(value).toFixed(1);
      return `<path class="grid" d="M${left} ${y}H${right}"/><text x="${left - 8}" y="${y}" dy=".32em" text-anchor="end">${axisText(value, up.digits)}</text>`;
    });
    this.drawing.innerHTML =
      `<svg viewBox="0 0 ${width} ${height}" role="img" aria-label="Paths from above: desired, planned, actual">` +
      columns.join("") + rows.join("") + lines +
      `<text class="axis" x="${right}" y="${height - 3}" text-anchor="end">x [m]</text><text class="axis" x="${left}" y="12" text-anchor="middle">y [m]</text>` +
      `<circle class="place" r="5"/></svg>`;
    this.dot = this.drawing.querySelector(".place");
    if (this.shown !== undefined) this.show(this.shown);
  }

  show(t) {
    this.shown = t;
    const place = locate(this.run.times, t);
    const paths = this.run.animation.paths;
    const actual = paths.find(({ stroke }) => stroke === "actual") ?? paths[0];
    const [x, y] = actual.points.map((list) => valueAt(list, place));
    this.dot.setAttribute("cx", this.toX(x).toFixed(2));
    this.dot.setAttribute("cy", this.toY(y).toFixed(2));
  }
}

/** Poles without and with control in the complex plane; both axes are stretched near zero. */
function polePlot(open, closed) {
  const [width, height, margin] = [420, 260, 34];
  const far = Math.max(2, ...[...open, ...closed].flat().map(Math.abs)) * 1.15;
  const bend = (value) => Math.asinh(value) / Math.asinh(far);
  const x = (re) => margin + ((1 + bend(re)) / 2) * (width - 2 * margin);
  const y = (im) => height / 2 - (bend(im) / 2) * (height - 2 * margin);
  const marks = [];
  for (let power = 1; power <= far; power *= 10) {
    for (const value of [power, 3 * power]) if (value <= far) marks.push(value, -value);
  }
  const grid = [...marks, 0].map((value) => {
    const name = String(value).replace("-", "−");
    const column = x(value).toFixed(1);
    const row = y(value).toFixed(1);
    const kind = value === 0 ? "zero" : "grid";
    return (
      `<path class="${kind}" d="M${column} ${margin}V${height - margin}M${margin} ${row}H${width - margin}"/>` +
      `<text x="${column}" y="${height - margin + 16}" text-anchor="middle">${name}</text>` +
      (value === 0 ? "" : `<text x="${margin - 6}" y="${row}" dy=".32em" text-anchor="end">${name}</text>`)
    );
  });
  const cross = ([re, im], kind) => `<path class="${kind}" transform="translate(${x(re).toFixed(1)} ${y(im).toFixed(1)})" d="M-5-5 5 5M-5 5 5-5"/>`;
  const ring = ([re, im], kind) => `<circle class="${kind}" cx="${x(re).toFixed(1)}" cy="${y(im).toFixed(1)}" r="5"/>`;
  const stable = `<rect class="stable" x="${margin}" y="${margin}" width="${(x(0) - margin).toFixed(1)}" height="${height - 2 * margin}"/>`;
  return (
    `<svg viewBox="0 0 ${width} ${height}" role="img" aria-label="Poles in the complex plane: ${open.length} without control, ${closed.length} of the closed loop">` +
    stable + grid.join("") + open.map((pole) => ring(pole, "open")).join("") +
    closed.map((pole) => cross(pole, "closed")).join("") +
    `<text class="axis" x="${width - margin}" y="${height - 3}" text-anchor="end">real part [1/s]</text>` +
    `<text class="axis" x="${margin}" y="14">imaginary part [1/s]</text></svg>` +
    `<ul class="legend"><li><svg width="14" height="14" aria-hidden="true"><circle class="open" cx="7" cy="7" r="5"/></svg>without control</li>` +
    `<li><svg width="14" height="14" aria-hidden="true"><path class="closed" transform="translate(7 7)" d="M-5-5 5 5M-5 5 5-5"/></svg>closed loop</li></ul>`
  );
}
