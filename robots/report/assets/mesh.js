// Solids as four-cornered faces. A tint from 0 to 1 mixes the colours of a body's pattern.

/** Faces over a grid of (u, v) in [0, 1]²; `point` gives position and normal, `tint` the pattern. */
class Mesh {
  constructor() {
    this.positions = [];
    this.normals = [];
    this.tints = [];
  }

  get faces() {
    return this.tints.length / 4;
  }

  corner([position, normal], tint) {
    this.positions.push(...position);
    this.normals.push(...normal);
    this.tints.push(tint);
  }

  grid(columns, rows, point, tint = () => 0) {
    for (let i = 0; i < columns; i++) {
      for (let j = 0; j < rows; j++) {
        const shade = tint((i + 0.5) / columns, (j + 0.5) / rows);
        for (const [di, dj] of [[0, 0], [1, 0], [1, 1], [0, 1]]) {
          this.corner(point((i + di) / columns, (j + dj) / rows), shade);
        }
      }
    }
    return this;
  }
}

const TURN = 2 * Math.PI;

/** Part of a ball around a centre on the z axis, from polar angle `from` to `to`. */
function addBall(mesh, radius, height, from, to, rows, tint) {
  const point = (u, v) => {
    const polar = to + v * (from - to);
    const normal = [
      Math.sin(polar) * Math.cos(TURN * u),
      Math.sin(polar) * Math.sin(TURN * u),
      Math.cos(polar),
    ];
    return [Vec.add(Vec.scale(normal, radius), [0, 0, height]), normal];
  };
  return mesh.grid(48, rows, point, tint);
}

function addTube(mesh, radius, length, rows, tint) {
  const point = (u, v) => {
    const normal = [Math.cos(TURN * u), Math.sin(TURN * u), 0];
    return [[radius * normal[0], radius * normal[1], (v - 0.5) * length], normal];
  };
  return mesh.grid(48, rows, point, tint);
}

function addDisc(mesh, radius, height, up, tint) {
  const point = (u, v) => {
    const angle = up * TURN * u;
    return [[radius * v * Math.cos(angle), radius * v * Math.sin(angle), height], [0, 0, up]];
  };
  // From the rim inwards, so that faces turn outwards.
  const inwards = (u, v) => point(u, 1 - v);
  return mesh.grid(48, 6, inwards, tint && ((u, v) => tint(u, 1 - v)));
}

function sphereMesh({ radius }, spins) {
  const pattern = (u, v) => (Math.floor(6 * u) + Math.floor(2 * v)) % 2;
  return addBall(new Mesh(), radius, 0, 0, Math.PI, 24, spins ? pattern : undefined);
}

function capsuleMesh({ radius, length }) {
  const mesh = addTube(new Mesh(), radius, length, 12);
  addBall(mesh, radius, length / 2, 0, Math.PI / 2, 8);
  return addBall(mesh, radius, -length / 2, Math.PI / 2, Math.PI, 8);
}

function cylinderMesh({ radius, length }) {
  const isWheel = length < 2 * radius;
  const spokes = (u, v) => (v > 0.3 && v < 0.8 && Math.floor(10 * u) % 2 ? 1 : 0);
  const band = (u, v) => (v > 0.88 && v < 0.96 ? 1 : 0);
  const mesh = addTube(new Mesh(), radius, length, isWheel ? 4 : 25, isWheel ? undefined : band);
  for (const up of [1, -1]) addDisc(mesh, radius, (up * length) / 2, up, isWheel ? spokes : undefined);
  return mesh;
}

function boxMesh({ edges }) {
  const mesh = new Mesh();
  for (let axis = 0; axis < 3; axis++) {
    const [a, b] = [(axis + 1) % 3, (axis + 2) % 3];
    for (const side of [1, -1]) {
      const normal = [0, 0, 0];
      normal[axis] = side;
      const point = (u, v) => {
        const position = [0, 0, 0];
        position[axis] = (side * edges[axis]) / 2;
        position[a] = (u - 0.5) * edges[a] * side;
        position[b] = (v - 0.5) * edges[b];
        return [position, normal];
      };
      mesh.grid(6, 6, point);
    }
  }
  return mesh;
}

/** Mesh of a body; `spins` says whether it turns in the run, so that turning should be seen. */
function bodyMesh(body, spins) {
  const build = { sphere: sphereMesh, capsule: capsuleMesh, cylinder: cylinderMesh, box: boxMesh };
  return build[body.kind](body, spins);
}

/** Distance from the centre within which a body lies. */
function bodyRadius({ kind, radius, length, edges }) {
  if (kind === "sphere") return radius;
  if (kind === "box") return Vec.length(edges) / 2;
  return kind === "capsule" ? radius + length / 2 : Math.hypot(radius, length / 2);
}

/** Half of the width that a body has across its length. */
function bodyGirth({ radius, edges }) {
  return radius ?? [...edges].sort((a, b) => a - b)[1] / 2;
}
