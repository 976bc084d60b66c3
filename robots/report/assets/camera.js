// A camera that goes around a target.

const FIELD = (28 * Math.PI) / 180;

/** Directions of sight by name: azimuth and elevation of the eye, radians. */
const SIGHTS = {
  oblique: [-1.05, 0.3],
  side: [-Math.PI / 2, 0.06],
  front: [0, 0.06],
  top: [-Math.PI / 2, 1.54],
};

class Camera {
  constructor() {
    this.target = [0, 0, 0];
    this.home = { target: [0, 0, 0], points: [] };
    this.zoom = 1;
    this.distance = 1;
    [this.azimuth, this.elevation] = SIGHTS.oblique;
  }

  /** Takes what is to be seen: the points must fit into the picture. */
  frame(points) {
    const bounds = [0, 1, 2].map((axis) => extent([points.map((p) => p[axis])]));
    const target = bounds.map(([low, high]) => (low + high) / 2);
    this.home = { target, points };
    this.target = target;
  }

  look(sight) {
    [this.azimuth, this.elevation] = SIGHTS[sight];
    this.zoom = 1;
  }

  orbit(left, up) {
    this.azimuth -= left;
    this.elevation = Math.min(1.54, Math.max(0.03, this.elevation + up));
  }

  magnify(factor) {
    this.zoom = Math.min(8, Math.max(0.25, this.zoom * factor));
  }

  get direction() {
    const flat = Math.cos(this.elevation);
    return [flat * Math.cos(this.azimuth), flat * Math.sin(this.azimuth), Math.sin(this.elevation)];
  }

  /** Distance at which all points of the home view are in a picture of this aspect. */
  fitted(aspect) {
    const tangent = Math.tan(FIELD / 2) * 0.9;
    const direction = this.direction;
    const right = Vec.unit(Vec.cross([0, 0, 1], direction));
    const up = Vec.cross(direction, right);
    let distance = 0;
    for (const point of this.home.points) {
      const p = Vec.sub(point, this.home.target);
      const needed = Math.max(Math.abs(Vec.dot(p, up)), Math.abs(Vec.dot(p, right)) / aspect);
      distance = Math.max(distance, needed / tangent + Vec.dot(p, direction));
    }
    return distance || 1;
  }

  /** Matrices and eye for a picture of this aspect. */
  matrices(aspect) {
    this.distance = this.fitted(aspect) / this.zoom;
    const eye = Vec.add(this.target, Vec.scale(this.direction, this.distance));
    const projection = Mat.perspective(FIELD, aspect, this.distance / 50, this.distance * 20);
    const view = Mat.lookAt(eye, this.target, [0, 0, 1]);
    return { eye, viewProjection: Mat.multiply(projection, view) };
  }
}
