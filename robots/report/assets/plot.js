// Plots as SVG.

/** Round values on an axis, at most `most` steps, that cover the extremes. */
function ticks([low, high], most, isTight) {
  if (high - low < 1e-12 + 1e-9 * Math.abs(high)) [low, high] = [low - 1, high + 1].map((v) => v * (Math.abs(high) || 1));
  const rough = (high - low) / most;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = power * [1, 2, 5, 10].find((digit) => digit * power >= rough * (1 - 1e-9));
  const first = isTight ? Math.ceil(low / step - 1e-9) : Math.floor(low / step + 1e-9);
  const last = isTight ? Math.floor(high / step + 1e-9) : Math.ceil(high / step - 1e-9);
  const values = Array.from({ length: last - first + 1 }, (_, k) => (first + k) * step);
  const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  const range = isTight ? [low, high] : [first * step, last * step];
  return { values, digits, range };
}

/** A number on an axis. */
function axisText(value, digits) {
  return value.toFixed(Math.min(digits, 6)).replace(/^-(?=.*[1-9])|^-/, (sign) => (Number(value) === 0 ? "" : "−"));
}

/** Three significant digits and a true minus sign. */
function shortText(value) {
  if (!Number.isFinite(value)) return "–";
  const size = Math.abs(value);
  const digits = size >= 100 ? 0 : size >= 10 ? 1 : size >= 1 ? 2 : 3;
  return value.toFixed(digits).replace("-", "−");
}

/** An SVG path through the finite ones of some points. Points that lie on the line are left out. */
function linePath(xs, ys, x, y) {
  const parts = [];
  let [pen, kept] = [false, null];
  for (let i = 0; i < xs.length; i++) {
    if (!Number.isFinite(ys[i])) {
      pen = false;
      continue;
    }
    const point = [x(xs[i]), y(ys[i])];
    const [before, after] = [kept, Number.isFinite(ys[i + 1]) && [x(xs[i + 1]), y(ys[i + 1])]];
    if (pen && before && after) {
      const [dx, dy] = [after[0] - before[0], after[1] - before[1]];
      const off = Math.abs((point[0] - before[0]) * dy - (point[1] - before[1]) * dx);
      const isAhead = (point[0] - before[0]) * dx + (point[1] - before[1]) * dy >= 0;
      if (isAhead && off < 0.03 * Math.hypot(dx, dy) && Math.hypot(dx, dy) < 6) continue;
    }
    parts.push(`${pen ? "L" : "M"}${point[0].toFixed(2)} ${point[1].toFixed(2)}`);
    [pen, kept] = [true, point];
  }
  return parts.join("");
}

/** A short line as it is drawn in the plot, for a legend. */
function swatch({ stroke, color: number }) {
  return `<svg class="swatch" width="26" height="10" aria-hidden="true"><path class="${stroke} c${number % 8}" d="M1 5H25"/></svg>`;
}

/** Extremes of the shown lines; zero is in sight if it is near. */
function valueRange(series) {
  const [low, high] = extent(series.map(({ values }) => values)) ?? [0, 0];
  const span = high - low;
  return [Math.min(low, low > 0 && low < span ? 0 : low), Math.max(high, high < 0 && -high < span ? 0 : high)];
}

const BOX = { left: 54, right: 14, top: 10, bottom: 34, height: 176 };

/** A plot over time with a cursor. */
class TimePlot {
  constructor(container, run, panel, onScrub) {
    this.run = run;
    this.panel = panel;
    this.figure = document.createElement("figure");
    this.figure.className = "plot";
    const unit = panel.unit.replaceAll("*", "·");
    const legend = panel.series.map((series) => `<li>${swatch(series)}<span>${escapeText(series.label)}</span> <b></b></li>`);
    this.figure.innerHTML =
      `<figcaption><span class="name">${escapeText(panel.title)}</span> <span class="unit">[${escapeText(unit)}]</span></figcaption>` +
      `<ul class="legend">${legend.join("")}</ul><div class="drawing"></div>`;
    container.append(this.figure);
    this.readings = [...this.figure.querySelectorAll("b")];
    this.drawing = this.figure.querySelector(".drawing");
    this.render(this.drawing.clientWidth || 640);
    this.listen(onScrub);
  }

  render(width) {
    if (width === this.width) return;
    this.width = width;
    const { left, right, top, bottom, height } = BOX;
    const { start, end, times } = this.run;
    const vertical = ticks(valueRange(this.panel.series), 5, false);
    const horizontal = ticks([start, end], Math.max(4, Math.floor(width / 80)), true);
    this.x = (t) => left + ((t - start) / (end - start || 1)) * (width - left - right);
    const [low, high] = vertical.range;
    this.y = (value) => top + ((high - value) / (high - low)) * (height - top - bottom);
    const floor = height - bottom;
    const rows = vertical.values.map((value) => {
      const y = this.y(value).toFixed(1);
      return `<path class="${Math.abs(value) < 1e-12 ? "zero" : "grid"}" d="M${left} ${y}H${width - right}"/><text x="${left - 8}" y="${y}" dy=".32em" text-anchor="end">${axisText(value, vertical.digits)}</text>`;
    });
    const columns = horizontal.values.map((value) => {
      const x = this.x(value).toFixed(1);
      return `<path class="tick" d="M${x} ${floor}v4"/><text x="${x}" y="${floor + 17}" text-anchor="middle">${axisText(value, horizontal.digits)}</text>`;
    });
    // Broad lines lie below thin ones.
    const order = ["desired", "actual", "planned"];
    const sorted = [...this.panel.series].sort((a, b) => order.indexOf(a.stroke) - order.indexOf(b.stroke));
    const lines = sorted.map(({ stroke, color: number, values }) => `<path class="line ${stroke} c${number % 8}" d="${linePath(times, values, this.x, this.y)}"/>`);
    const label = `${this.panel.title} over time: ${this.panel.series.map((series) => series.label).join(", ")}`;
    this.drawing.innerHTML =
      `<svg viewBox="0 0 ${width} ${height}" width="${width}" height="${height}" role="img" aria-label="${escapeText(label)}">` +
      rows.join("") + columns.join("") +
      `<text class="axis" x="${width - right}" y="${height - 3}" text-anchor="end">time [s]</text>` +
      lines.join("") + `<path class="cursor" d="M0 ${top}V${floor}"/></svg>`;
    this.svg = this.drawing.firstElementChild;
    this.cursor = this.svg.querySelector(".cursor");
    if (this.shown !== undefined) this.show(this.shown);
  }

  /** Moves the cursor and reads the lines there. */
  show(t) {
    this.shown = t;
    this.cursor.setAttribute("transform", `translate(${this.x(t).toFixed(2)} 0)`);
    const place = locate(this.run.times, t);
    this.panel.series.forEach(({ values }, i) => {
      const text = shortText(valueAt(values, place));
      if (this.readings[i].textContent !== text) this.readings[i].textContent = text;
    });
  }

  listen(onScrub) {
    const scrub = (event) => {
      const box = this.svg.getBoundingClientRect();
      const { left, right } = BOX;
      const fraction = (((event.clientX - box.left) / box.width) * this.width - left) / (this.width - left - right);
      const { start, end } = this.run;
      onScrub(start + Math.min(1, Math.max(0, fraction)) * (end - start));
    };
    this.drawing.addEventListener("pointerdown", (event) => {
      if (event.button !== 0) return;
      this.drawing.setPointerCapture(event.pointerId);
      scrub(event);
    });
    this.drawing.addEventListener("pointermove", (event) => {
      if (this.drawing.hasPointerCapture(event.pointerId)) scrub(event);
    });
  }
}

/** SVG text of paths seen from above, in a box of this size, with the same scale along x and y. */
function pathsFromAbove(paths, width, height, margin) {
  const x = extent(paths.map((path) => path.points[0]));
  const y = extent(paths.map((path) => path.points[1]));
  const scale = Math.min((width - 2 * margin) / (x[1] - x[0]), (height - 2 * margin) / (y[1] - y[0]));
  const toX = (value) => width / 2 + (value - (x[0] + x[1]) / 2) * scale;
  const toY = (value) => height / 2 - (value - (y[0] + y[1]) / 2) * scale;
  const lines = paths.map(({ stroke, points }) => `<path class="line ${stroke} path" d="${linePath(points[0], points[1], toX, toY)}"/>`);
  return { lines: lines.join(""), toX, toY, scale };
}

/** A small picture of a run: its path from above, or its output over time. */
function thumbnail(run) {
  const [width, height] = [220, 110];
  let lines = "";
  if (run.isPlanar) {
    lines = pathsFromAbove(run.animation.paths, width, height, 14).lines;
  } else if (run.panels.length > 0) {
    const series = run.panels[0].series.filter(({ stroke }) => stroke !== "planned");
    const [low, high] = extent(series.map(({ values }) => values)) ?? [0, 1];
    const x = (t) => 10 + ((t - run.start) / (run.end - run.start || 1)) * (width - 20);
    const y = (value) => height - 14 - ((value - low) / (high - low || 1)) * (height - 28);
    const order = ["desired", "actual"];
    series.sort((a, b) => order.indexOf(a.stroke) - order.indexOf(b.stroke));
    lines = series.map(({ stroke, color: number, values }) => `<path class="line ${stroke} c${number % 8}" d="${linePath(run.times, values, x, y)}"/>`).join("");
  }
  return `<svg viewBox="0 0 ${width} ${height}" aria-hidden="true">${lines}</svg>`;
}
