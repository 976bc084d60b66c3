// What a run looks like: bodies, paths and floor at a time.

const LIGHT = Vec.unit([0.45, -0.55, 1]);

/** Colours of the picture; the first three are those of the page. */
const THEMES = {
  light: {
    background: color("#ffffff"), ground: color("#f3f4f2"), lines: color("#9aa3ab"),
    shadow: color("#20262c"), darkness: 0.34, fade: 0.8,
    desired: color("#b9c4cd"), planned: color("#0072b2"), actual: color("#d55e00"),
    ball: color("#e2542a"), ballMark: color("#fff4e6"), trunk: color("#c9d3dc"), band: color("#0072b2"),
    limb: color("#2f7f8f"), block: color("#7b8c9b"), wheel: color("#2f353c"), spoke: color("#aeb8c1"),
  },
  dark: {
    background: color("#1a1e23"), ground: color("#22272d"), lines: color("#59636e"),
    shadow: color("#000000"), darkness: 0.5, fade: 0.72,
    desired: color("#56616b"), planned: color("#56b4e9"), actual: color("#f58549"),
    ball: color("#e2542a"), ballMark: color("#fff4e6"), trunk: color("#b4c0cb"), band: color("#2b8cc9"),
    limb: color("#3d9aac"), block: color("#74869a"), wheel: color("#4a525b"), spoke: color("#c3ccd4"),
  },
};

/** Instants at which pale copies of the robot are shown, as fractions of the run. */
const COPIES = [0, 0.3, 0.4, 0.5, 0.6, 0.7, 1];

/** Colours of a body: which of the theme's, and which for its pattern. */
function look({ kind, radius, length }, spins) {
  if (kind === "sphere") return spins ? ["ball", "ballMark"] : ["limb", "limb"];
  if (kind === "capsule") return ["limb", "limb"];
  if (kind === "box") return ["block", "block"];
  return length < 2 * radius ? ["wheel", "spoke"] : ["trunk", "band"];
}

/** Largest of 1, 2, 5 times a power of ten that is not above a length. */
function roundLength(length) {
  const power = 10 ** Math.floor(Math.log10(length));
  return power * [5, 2, 1].find((digit) => digit * power <= length * (1 + 1e-9));
}

/** A ribbon along points, one face per step between shown instants; `dash` in metres, 0 for none. */
function ribbonMesh([x, y, z], width, lift, dash) {
  const mesh = new Mesh();
  const count = x.length;
  const side = (k) => {
    // The nearest neighbours that are elsewhere give the direction.
    let [a, b] = [k, k];
    const apart = () => Math.hypot(x[b] - x[a], y[b] - y[a]) > width * 0.05;
    while (!apart() && (a > 0 || b < count - 1)) {
      a = Math.max(0, a - 1);
      b = Math.min(count - 1, b + 1);
    }
    const along = Vec.unit([x[b] - x[a], y[b] - y[a], 0]);
    return [(-along[1] * width) / 2, (along[0] * width) / 2, 0];
  };
  const sides = Array.from({ length: count }, (_, k) => side(k));
  let travelled = 0;
  for (let k = 0; k + 1 < count; k++) {
    const ends = [k, k + 1].map((i) => [x[i], y[i], z[i] + lift]);
    travelled += Vec.length(Vec.sub(ends[1], ends[0]));
    const isGap = dash > 0 && travelled % (2 * dash) > dash;
    const shown = isGap ? [ends[0], ends[0], ends[0], ends[0]] : [
      Vec.sub(ends[0], sides[k]), Vec.sub(ends[1], sides[k + 1]),
      Vec.add(ends[1], sides[k + 1]), Vec.add(ends[0], sides[k]),
    ];
    for (const corner of shown) mesh.corner([corner, [0, 0, 1]], 0);
  }
  return mesh;
}

class Scene {
  constructor(run) {
    this.run = run;
    const { tracks, floor, carrier } = run.animation;
    this.floor = floor;
    this.carrier = carrier;
    // Turning shows on a body that turns more than it leans.
    const turns = (track) => track.slice(3).some((list) => {
      const [low, high] = extent([list]);
      return high - low > 0.4;
    });
    this.bodies = run.bodies.map((body, i) => {
      const spins = turns(tracks[i]);
      const girth = bodyGirth(body);
      const bounds = tracks[i].slice(0, 3).map((list) => extent([list]));
      const moves = bounds.some(([low, high]) => high - low > girth);
      return { mesh: bodyMesh(body, spins), look: look(body, spins), track: tracks[i], girth, moves };
    });
    this.points = this.outline();
    const bounds = [0, 1, 2].map((axis) => extent([this.points.map((p) => p[axis])]));
    this.size = Math.hypot(...bounds.map(([low, high]) => high - low)) / 2;
    this.spacing = roundLength(this.size / 6);
    this.ribbons = run.animation.paths.map((path) => this.ribbon(path));
  }

  /** Points that must be seen: around every body at some instants, and the floor below. */
  outline() {
    const points = [];
    const step = Math.max(1, Math.floor(this.run.times.length / 40));
    for (let k = 0; k < this.run.times.length; k += step) {
      this.run.bodies.forEach((body, i) => {
        const place = { index: k, fraction: 0 };
        const matrix = poseAt(this.bodies[i].track, place);
        const radius = Math.min(bodyRadius(body), body.radius ?? Infinity);
        const half = body.kind === "sphere" || body.kind === "box" ? 0 : body.length / 2;
        const ends = body.kind === "box" ? this.corners(body) : [[0, 0, half], [0, 0, -half]];
        const reach = body.kind === "box" ? 0 : radius;
        for (const end of ends) {
          const [x, y, z] = Mat.apply(matrix, end);
          for (const axis of [0, 1, 2]) {
            for (const side of [1, -1]) {
              const point = [x, y, z];
              point[axis] += side * reach;
              points.push(point);
            }
          }
        }
      });
    }
    return points;
  }

  corners({ edges }) {
    return [0, 1, 2, 3, 4, 5, 6, 7].map((k) => edges.map((edge, i) => (k & (1 << i) ? edge : -edge) / 2));
  }

  ribbon({ stroke, points }) {
    const unit = this.size;
    const width = { desired: 0.03, planned: 0.008, actual: 0.013 }[stroke] * unit;
    const lift = { desired: 0.002, planned: 0.003, actual: 0.004 }[stroke] * unit;
    const dash = stroke === "planned" ? 0.04 * unit : 0;
    return { stroke, mesh: ribbonMesh(points, width, lift, dash), count: points[0].length - 1 };
  }

  solids(theme, t, fade) {
    const place = locate(this.run.times, t);
    return this.bodies.map(({ mesh, look: [base, mark], track }) => ({
      mesh, matrix: poseAt(track, place), base: theme[base], mark: theme[mark], fade,
    }));
  }

  /** Pale copies at some instants, where they stand clear of the robot. */
  copies(theme, t) {
    const { start, end } = this.run;
    const now = locate(this.run.times, t);
    const copies = [];
    for (const fraction of COPIES) {
      const then = locate(this.run.times, start + fraction * (end - start));
      const moving = this.bodies.filter(({ moves }) => moves);
      const clear = moving.every(({ track, girth }) => {
        const way = track.slice(0, 3).map((list) => valueAt(list, then) - valueAt(list, now));
        return Vec.length(way) > 1.2 * girth;
      });
      if (!clear) continue;
      const solids = this.solids(theme, start + fraction * (end - start), theme.fade);
      copies.push(...solids.filter((_, i) => this.bodies[i].moves));
    }
    return copies;
  }

  /** Ribbons with their paint; what the robot has not done yet is pale. */
  paints(theme, t) {
    const done = locate(this.run.times, t).index;
    const parts = [];
    for (const { stroke, mesh, count } of this.ribbons) {
      const paint = [...theme[stroke], 1];
      if (stroke === "actual") {
        parts.push({ mesh, paint: [...theme.actual, 0.25], from: done, to: count });
        parts.push({ mesh, paint, from: 0, to: done });
      } else {
        parts.push({ mesh, paint, from: 0, to: count });
      }
    }
    return parts;
  }

  /** Everything a renderer needs for the picture at time t. */
  picture(t, camera, aspect, theme, withCopies) {
    const { eye, viewProjection } = camera.matrices(aspect);
    const solids = this.solids(theme, t, 0);
    const copies = withCopies ? this.copies(theme, t) : [];
    const carrier = this.carrier === null ? null : solids[this.carrier].matrix;
    return {
      eye, viewProjection, theme, solids, copies, carrier,
      ribbons: this.paints(theme, t), light: LIGHT, floor: this.floor, target: camera.target,
      spacing: this.spacing, reach: 4.5 * this.size, size: this.size,
    };
  }

  /** Where the robot is: middle of its bodies. */
  middle(t) {
    const place = locate(this.run.times, t);
    const sum = this.bodies.reduce((sum, { track }) => Vec.add(sum, track.slice(0, 3).map((list) => valueAt(list, place))), [0, 0, 0]);
    return Vec.scale(sum, 1 / this.bodies.length);
  }
}
