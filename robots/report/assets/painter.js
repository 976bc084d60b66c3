// Pictures without WebGL: faces painted from far to near.

class PainterRenderer {
  constructor() {
    this.isLost = false;
  }

  draw(context, picture) {
    const { width, height } = context.canvas;
    this.context = context;
    this.picture = picture;
    this.scale = [width / 2, height / 2];
    context.fillStyle = this.css(picture.theme.background);
    context.fillRect(0, 0, width, height);
    this.drawFloor();
    this.drawShadows();
    if (!picture.carrier) this.drawRibbons();
    this.drawSolids(picture.copies);
    this.drawSolids(picture.solids);
    if (picture.carrier) this.drawRibbons();
  }

  css(rgb, alpha = 1) {
    return `rgb(${rgb.map((c) => Math.round(255 * Math.min(1, Math.max(0, c)))).join(" ")} / ${alpha})`;
  }

  /** Picture coordinates and distance of a point; null behind the eye. */
  project(matrix, point) {
    const [x, y, , w] = Mat.apply(matrix, point);
    if (w < 1e-6) return null;
    return [this.scale[0] * (1 + x / w), this.scale[1] * (1 - y / w), w];
  }

  line(a, b, style, width) {
    const [p, q] = [a, b].map((point) => this.project(this.picture.viewProjection, point));
    if (!p || !q) return;
    const context = this.context;
    context.strokeStyle = style;
    context.lineWidth = width;
    context.beginPath();
    context.moveTo(p[0], p[1]);
    context.lineTo(q[0], q[1]);
    context.stroke();
  }

  drawFloor() {
    const { theme, target, floor, spacing, reach } = this.picture;
    const half = Math.min(40, Math.ceil((0.5 * reach) / spacing));
    const middle = [0, 1].map((axis) => Math.round(target[axis] / spacing));
    for (let k = -half; k <= half; k++) {
      for (const axis of [0, 1]) {
        const ends = [-half, half].map((end) => {
          const point = [0, 0, floor];
          point[axis] = (middle[axis] + k) * spacing;
          point[1 - axis] = (middle[1 - axis] + end) * spacing;
          return point;
        });
        const isMajor = (middle[axis] + k) % majorEvery(spacing) === 0;
        this.line(...ends, this.css(theme.lines, isMajor ? 0.8 : 0.4), isMajor ? 1.4 : 1);
      }
    }
  }

  /** Picture coordinates of the corners of a mesh's faces; a face is null if it is not wholly ahead. */
  *faces(mesh, matrix) {
    const { positions } = mesh;
    for (let face = 0; face < mesh.faces; face++) {
      const corners = [];
      for (let k = 0; k < 4; k++) {
        const at = 3 * (4 * face + k);
        const corner = this.project(matrix, [positions[at], positions[at + 1], positions[at + 2]]);
        if (corner) corners.push(corner);
      }
      if (corners.length === 4) yield [face, corners];
    }
  }

  trace([first, ...rest]) {
    this.context.moveTo(first[0], first[1]);
    for (const corner of rest) this.context.lineTo(corner[0], corner[1]);
    this.context.closePath();
  }

  /** Twice the area of a face, positive if it is seen from outside. */
  area([a, b, c, d]) {
    return (c[1] - a[1]) * (d[0] - b[0]) - (c[0] - a[0]) * (d[1] - b[1]);
  }

  drawShadows() {
    const { viewProjection, theme, solids, light, floor } = this.picture;
    const shadow = Mat.multiply(viewProjection, Mat.shadow(light, floor));
    this.context.beginPath();
    for (const { mesh, matrix } of solids) {
      for (const [, corners] of this.faces(mesh, Mat.multiply(shadow, matrix))) {
        if (this.area(corners) > 0) this.trace(corners);
      }
    }
    this.context.fillStyle = this.css(theme.shadow, theme.darkness * 0.8);
    this.context.fill();
  }

  drawRibbons() {
    const { viewProjection, carrier, ribbons } = this.picture;
    const matrix = carrier ? Mat.multiply(viewProjection, carrier) : viewProjection;
    for (const { mesh, paint, from, to } of ribbons) {
      this.context.beginPath();
      for (const [face, corners] of this.faces(mesh, matrix)) {
        if (face < from || face >= to) continue;
        this.trace(this.area(corners) > 0 ? corners : corners.reverse());
      }
      this.context.fillStyle = this.css(paint.slice(0, 3), paint[3]);
      this.context.fill();
    }
  }

  drawSolids(solids) {
    const shown = [];
    for (const solid of solids) {
      const matrix = Mat.multiply(this.picture.viewProjection, solid.matrix);
      for (const [face, corners] of this.faces(solid.mesh, matrix)) {
        if (this.area(corners) <= 0) continue;
        const depth = corners.reduce((sum, corner) => sum + corner[2], 0);
        shown.push({ corners, depth, style: this.shade(solid, face) });
      }
    }
    shown.sort((a, b) => b.depth - a.depth);
    for (const { corners, style } of shown) {
      this.context.beginPath();
      this.trace(corners);
      this.context.fillStyle = style;
      this.context.strokeStyle = style;
      // Closes the seams between faces.
      this.context.lineWidth = 1;
      this.context.fill();
      this.context.stroke();
    }
  }

  shade({ mesh, matrix, base, mark, fade }, face) {
    const { light, theme } = this.picture;
    const at = 12 * face;
    let normal = [0, 0, 0];
    for (let k = 0; k < 12; k += 3) normal = Vec.add(normal, mesh.normals.slice(at + k, at + k + 3));
    normal = Vec.unit(Mat.turn(matrix, normal));
    const bright = 0.62 + 0.12 * normal[2] + 0.38 * Math.max(0, Vec.dot(normal, light));
    const lit = Vec.scale(Vec.mix(base, mark, mesh.tints[4 * face]), bright);
    return this.css(Vec.mix(lit, theme.background, fade));
  }
}
