// Diagrams that are not over time.

/** The paths of a run from above, with the robot's place. */
class PathPlot {
  constructor(container, run) {
    this.run = run;
    const figure = document.createElement("figure");
    figure.className = "plot";
    const paths = run.animation.paths;
    const legend = paths.map(({ stroke }) => `<li><svg class="swatch" width="26" height="10" aria-hidden="true"><path class="${stroke} path" d="M1 5H25"/></svg><span>${stroke}</span></li>`);
    figure.innerHTML =
      `<figcaption><span class="name">Path from above</span> <span class="unit">[m]</span></figcaption>` +
      `<ul class="legend">${legend.join("")}</ul><div class="drawing">${this.svg(paths)}</div>`;
    container.append(figure);
    this.dot = figure.querySelector(".place");
  }

  svg(paths) {
    const [width, height, margin] = [640, 300, 40];
    const { lines, toX, toY, scale } = pathsFromAbove(paths, width, height, margin);
    [this.toX, this.toY] = [toX, toY];
    const step = roundLength(70 / scale);
    const marks = (low, high) => ticks([low, high], Math.max(1, (high - low) / step), true);
    const across = marks((54 - toX(0)) / scale, (width - 14 - toX(0)) / scale);
    const up = marks((toY(0) - height + 34) / scale, (toY(0) - 10) / scale);
    const columns = across.values.map((value) => {
      const x = toX(value).toFixed(1);
      return `<path class="grid" d="M${x} 10V${height - 34}"/><text x="${x}" y="${height - 18}" text-anchor="middle">${axisText(value, across.digits)}</text>`;
    });
    const rows = up.values.map((value) => {
      const y = toY(value).toFixed(1);
      return `<path class="grid" d="M54 ${y}H${width - 14}"/><text x="46" y="${y}" dy=".32em" text-anchor="end">${axisText(value, up.digits)}</text>`;
    });
    return (
      `<svg viewBox="0 0 ${width} ${height}" role="img" aria-label="Paths from above: desired, planned, actual">` +
      columns.join("") + rows.join("") + lines +
      `<text class="axis" x="${width - 14}" y="${height - 3}" text-anchor="end">x [m]</text><text class="axis" x="4" y="18">y [m]</text>` +
      `<circle class="place" r="5"/></svg>`
    );
  }

  show(t) {
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
