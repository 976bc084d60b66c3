// Pictures by WebGL 2. One context serves all views of the page: browsers allow few.

/** Shadows of this many lamps beside each other make a soft one. */
const LAMPS = 10;

class WebglRenderer {
  /** A renderer, or null where there is no WebGL 2. */
  static create() {
    const canvas = document.createElement("canvas");
    const options = { antialias: true, alpha: false, stencil: true, powerPreference: "low-power" };
    const gl = canvas.getContext("webgl2", options);
    return gl ? new WebglRenderer(canvas, gl) : null;
  }

  constructor(canvas, gl) {
    this.canvas = canvas;
    this.gl = gl;
    this.isLost = false;
    this.shapes = new WeakMap();
    canvas.addEventListener("webglcontextlost", () => (this.isLost = true));
    this.solid = this.program(SOLID_VERTEX, SOLID_FRAGMENT);
    this.floor = this.program(FLOOR_VERTEX, FLOOR_FRAGMENT);
    this.flat = this.program(FLAT_VERTEX, FLAT_FRAGMENT);
    const corners = [-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0];
    this.plane = this.upload({ positions: corners, indices: [0, 1, 2, 0, 2, 3] });
  }

  program(vertex, fragment) {
    const gl = this.gl;
    const program = gl.createProgram();
    for (const [kind, source] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, source);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    }
    ["position", "normal", "tint"].forEach((name, i) => gl.bindAttribLocation(program, i, name));
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost()) {
      throw new Error(`shader: ${gl.getProgramInfoLog(program)}`);
    }
    const places = new Map();
    const count = gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS) ?? 0;
    for (let i = 0; i < count; i++) {
      const { name } = gl.getActiveUniform(program, i);
      places.set(name, gl.getUniformLocation(program, name));
    }
    return { program, places };
  }

  use({ program, places }, values) {
    const gl = this.gl;
    gl.useProgram(program);
    this.places = places;
    this.set(values);
  }

  set(values) {
    const gl = this.gl;
    for (const [name, value] of Object.entries(values)) {
      const place = this.places.get(name);
      if (typeof value === "number") gl.uniform1f(place, value);
      else if (value.length === 16) gl.uniformMatrix4fv(place, false, value);
      else if (value.length === 4) gl.uniform4fv(place, value);
      else gl.uniform3fv(place, value);
    }
  }

  upload({ positions, normals, tints, indices }) {
    const gl = this.gl;
    const array = gl.createVertexArray();
    gl.bindVertexArray(array);
    [[positions, 3], [normals, 3], [tints, 1]].forEach(([data, size], i) => {
      if (!data) return;
      gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
      gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(data), gl.STATIC_DRAW);
      gl.enableVertexAttribArray(i);
      gl.vertexAttribPointer(i, size, gl.FLOAT, false, 0, 0);
    });
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, new Uint32Array(indices), gl.STATIC_DRAW);
    gl.bindVertexArray(null);
    return { array, count: indices.length };
  }

  /** What was uploaded for a mesh or ribbon; uploads it the first time. */
  shape(mesh) {
    if (!this.shapes.has(mesh)) {
      const indices = [];
      for (let k = 0; k < mesh.positions.length / 3; k += 4) indices.push(k, k + 1, k + 2, k, k + 2, k + 3);
      this.shapes.set(mesh, this.upload({ ...mesh, indices }));
    }
    return this.shapes.get(mesh);
  }

  elements({ array, count }, from = 0, to = count) {
    const gl = this.gl;
    if (to <= from) return;
    gl.bindVertexArray(array);
    gl.drawElements(gl.TRIANGLES, to - from, gl.UNSIGNED_INT, 4 * from);
  }

  /** Draws a picture and copies it to a canvas with a two-dimensional context. */
  draw(context, picture) {
    const gl = this.gl;
    const { width, height } = context.canvas;
    if (this.canvas.width !== width || this.canvas.height !== height) {
      this.canvas.width = width;
      this.canvas.height = height;
    }
    gl.viewport(0, 0, width, height);
    gl.clearColor(...picture.theme.background, 1);
    gl.clearStencil(0);
    gl.depthMask(true);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT | gl.STENCIL_BUFFER_BIT);
    gl.enable(gl.CULL_FACE);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    gl.disable(gl.DEPTH_TEST);
    this.drawFloor(picture);
    this.drawShadows(picture);
    gl.disable(gl.CULL_FACE);
    if (!picture.carrier) this.drawRibbons(picture);
    gl.enable(gl.DEPTH_TEST);
    gl.enable(gl.CULL_FACE);
    // The robot stands before its copies wherever these are.
    this.drawSolids(picture, picture.copies);
    gl.clear(gl.DEPTH_BUFFER_BIT);
    this.drawSolids(picture, picture.solids);
    gl.disable(gl.CULL_FACE);
    if (picture.carrier) this.drawRibbons(picture);
    context.drawImage(this.canvas, 0, 0);
  }

  drawFloor({ viewProjection, theme, target, floor, spacing, reach }) {
    const model = [reach, 0, 0, 0, 0, reach, 0, 0, 0, 0, 1, 0, target[0], target[1], floor, 1];
    const { background, ground, lines } = theme;
    const major = majorEvery(spacing) * spacing;
    this.use(this.floor, { viewProjection, model, background, ground, lines, target, spacing, major, reach });
    this.elements(this.plane);
  }

  drawShadows({ viewProjection, theme, solids, light, floor }) {
    const gl = this.gl;
    gl.enable(gl.STENCIL_TEST);
    gl.stencilOp(gl.KEEP, gl.KEEP, gl.REPLACE);
    this.use(this.flat, { viewProjection, paint: [...theme.shadow, theme.darkness / LAMPS] });
    for (let lamp = 0; lamp < LAMPS; lamp++) {
      // Each lamp darkens a pixel once.
      gl.stencilFunc(gl.NOTEQUAL, lamp + 1, 255);
      const angle = 2.4 * lamp;
      const offset = 0.16 * Math.sqrt((lamp + 0.5) / LAMPS);
      const from = Vec.add(light, [offset * Math.cos(angle), offset * Math.sin(angle), 0]);
      const shadow = Mat.shadow(from, floor);
      for (const { mesh, matrix } of solids) {
        this.set({ model: Mat.multiply(shadow, matrix) });
        this.elements(this.shape(mesh));
      }
    }
    gl.disable(gl.STENCIL_TEST);
  }

  drawRibbons({ viewProjection, ribbons, carrier }) {
    this.use(this.flat, { viewProjection, model: carrier ?? Mat.identity() });
    for (const { mesh, paint, from, to } of ribbons) {
      this.set({ paint });
      this.elements(this.shape(mesh), 6 * from, 6 * to);
    }
  }

  drawSolids({ viewProjection, theme, light, eye, floor, size }, solids) {
    const { background } = theme;
    this.use(this.solid, { viewProjection, eye, light, background, floorHeight: floor, size });
    for (const { mesh, matrix, base, mark, fade } of solids) {
      this.set({ model: matrix, base, mark, fade });
      this.elements(this.shape(mesh));
    }
  }
}
