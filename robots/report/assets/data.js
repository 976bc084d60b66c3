"use strict";
// Data of the report: packed lists of numbers, times, and values between the shown instants.

/** Numbers of a packed list of `count`; NaN where there is a gap. */
function unpack({ min, step, codes }, count) {
  const values = new Float64Array(count);
  if (!codes) return values.fill(min);
  const bytes = atob(codes);
  for (let i = 0; i < count; i++) {
    const code = bytes.charCodeAt(2 * i) | (bytes.charCodeAt(2 * i + 1) << 8);
    values[i] = code === 65535 ? NaN : min + step * code;
  }
  return values;
}

/** Shown instants, s. */
function unpackTime(time) {
  if (Array.isArray(time)) return Float64Array.from(time);
  return Float64Array.from({ length: time.count }, (_, k) => time.start + time.step * k);
}

/** Index of the shown instant at or before t, and the fraction of the way to the next. */
function locate(times, t) {
  let low = 0;
  let high = times.length - 1;
  if (t >= times[high]) return { index: high, fraction: 0 };
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (times[middle] <= t) low = middle;
    else high = middle;
  }
  const span = times[high] - times[low];
  return { index: low, fraction: span > 0 ? Math.max(0, (t - times[low]) / span) : 0 };
}

/** Value of a list at a place between two shown instants. */
function valueAt(values, { index, fraction }) {
  if (fraction === 0) return values[index];
  return values[index] + fraction * (values[index + 1] - values[index]);
}

/** Smallest and largest finite value of some lists; null if there is none. */
function extent(lists) {
  let low = Infinity;
  let high = -Infinity;
  for (const list of lists) {
    for (const value of list) {
      if (value < low) low = value;
      if (value > high) high = value;
    }
  }
  return low <= high ? [low, high] : null;
}

/** A run with its numbers unpacked. */
class Run {
  constructor(raw, robots) {
    this.title = raw.title;
    this.times = unpackTime(raw.time);
    this.start = this.times[0];
    this.end = this.times[this.times.length - 1];
    const count = this.times.length;
    const line = (series) => ({ ...series, values: unpack(series.values, count) });
    this.panels = raw.panels.map((panel) => ({ ...panel, series: panel.series.map(line) }));
    this.bodies = raw.robot === null ? [] : robots[raw.robot].bodies;
    this.animation = raw.animation && Run.unpackAnimation(raw.animation, count);
  }

  static unpackAnimation(raw, count) {
    const lists = (packed) => packed.map((list) => unpack(list, count));
    return {
      floor: raw.floor,
      carrier: raw.carrier,
      tracks: raw.bodies.map(lists),
      paths: raw.paths.map(({ stroke, points }) => ({ stroke, points: lists(points) })),
    };
  }

  /** Paths that leave their straight line enough to be shown from above. */
  get isPlanar() {
    const paths = this.animation?.paths ?? [];
    const x = extent(paths.map((path) => path.points[0]));
    const y = extent(paths.map((path) => path.points[1]));
    return Boolean(x && y) && Math.min(x[1] - x[0], y[1] - y[0]) > 0.02 * Math.max(x[1] - x[0], y[1] - y[0]);
  }
}

/** Text for HTML. */
function escapeText(text) {
  const names = { "&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;" };
  return text.replace(/[&<>"]/g, (c) => names[c]);
}
