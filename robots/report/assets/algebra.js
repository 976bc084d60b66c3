// Vectors [x, y, z], unit quaternions [w, x, y, z], 4x4 matrices by columns.

const Vec = {
  add: (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]],
  sub: (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]],
  scale: (a, s) => [a[0] * s, a[1] * s, a[2] * s],
  dot: (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2],
  cross: (a, b) => [
    a[1] * b[2] - a[2] * b[1],
    a[2] * b[0] - a[0] * b[2],
    a[0] * b[1] - a[1] * b[0],
  ],
  length: (a) => Math.hypot(a[0], a[1], a[2]),
  unit: (a) => Vec.scale(a, 1 / (Vec.length(a) || 1)),
  mix: (a, b, f) => a.map((value, i) => value + f * (b[i] - value)),
};

const Mat = {
  identity: () => [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1],

  multiply(a, b) {
    const out = new Array(16);
    for (let column = 0; column < 4; column++) {
      for (let row = 0; row < 4; row++) {
        let sum = 0;
        for (let k = 0; k < 4; k++) sum += a[4 * k + row] * b[4 * column + k];
        out[4 * column + row] = sum;
      }
    }
    return out;
  },

  /** Image of a point, with the homogeneous coordinate last. */
  apply(m, p) {
    const row = (i) => m[i] * p[0] + m[4 + i] * p[1] + m[8 + i] * p[2] + m[12 + i];
    return [row(0), row(1), row(2), row(3)];
  },

  /** Image of a direction. */
  turn(m, d) {
    const row = (i) => m[i] * d[0] + m[4 + i] * d[1] + m[8 + i] * d[2];
    return [row(0), row(1), row(2)];
  },

  perspective(height, aspect, near, far) {
    const f = 1 / Math.tan(height / 2);
    const depth = near - far;
    return [f / aspect, 0, 0, 0, 0, f, 0, 0, 0, 0, (far + near) / depth, -1, 0, 0, (2 * far * near) / depth, 0];
  },

  lookAt(eye, target, up) {
    const z = Vec.unit(Vec.sub(eye, target));
    const x = Vec.unit(Vec.cross(up, z));
    const y = Vec.cross(z, x);
    const shift = (axis) => -Vec.dot(axis, eye);
    return [x[0], y[0], z[0], 0, x[1], y[1], z[1], 0, x[2], y[2], z[2], 0, shift(x), shift(y), shift(z), 1];
  },

  /** Rotation by a quaternion, then a shift. */
  pose([w, x, y, z], p) {
    return [
      1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y), 0,
      2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x), 0,
      2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y), 0,
      p[0], p[1], p[2], 1,
    ];
  },

  /** Shadow on the plane z = height under light that comes from a direction. */
  shadow(light, height) {
    const [x, y] = [light[0] / light[2], light[1] / light[2]];
    return [1, 0, 0, 0, 0, 1, 0, 0, -x, -y, 0, 0, x * height, y * height, height, 1];
  },
};

/** Pose of a body between two shown instants, as a matrix. */
function poseAt(tracks, place) {
  const [x, y, z, ...rotation] = tracks.map((track) => valueAt(track, place));
  const length = Math.hypot(...rotation) || 1;
  return Mat.pose(rotation.map((value) => value / length), [x, y, z]);
}

/** `#rrggbb` as numbers from 0 to 1. */
function color(text) {
  return [1, 3, 5].map((at) => parseInt(text.slice(at, at + 2), 16) / 255);
}

/** How many steps of the grid make a stronger line, so that these are 1, 5 or 10 times a power of ten. */
function majorEvery(spacing) {
  return String(spacing.toExponential(0)).startsWith("5") ? 2 : 5;
}
