// A run on the page: picture, controls and plots share one time.

/** Renderer of all views, made when the first is drawn. */
const Pictures = {
  renderer: null,
  get() {
    if (!this.renderer || this.renderer.isLost) {
      const wasLost = this.renderer?.isLost;
      this.renderer = (!wasLost && WebglRenderer.create()) || new PainterRenderer();
    }
    return this.renderer;
  },
};

const prefersStill = matchMedia("(prefers-reduced-motion: reduce)");
const prefersDark = matchMedia("(prefers-color-scheme: dark)");

class Player {
  constructor(article, run) {
    this.article = article;
    this.run = run;
    this.time = run.start;
    this.isPlaying = false;
    this.speed = 1;
    this.plots = [];
    this.find = (selector) => article.querySelector(selector);
    this.canvas = this.find("canvas");
    this.isBuilt = false;
  }

  /** Unpacks and draws; once, when the run comes into sight. */
  build() {
    if (this.isBuilt) return;
    this.isBuilt = true;
    const container = this.find(".plots");
    if (container) {
      if (this.run.isPlanar) this.above = new PathPlot(container, this.run);
      for (const panel of this.run.panels) {
        this.plots.push(new TimePlot(container, this.run, panel, (t) => this.seek(t)));
      }
      new ResizeObserver(() => isPrinting || this.fit()).observe(container);
    }
    if (this.canvas) {
      this.scene = new Scene(this.run);
      this.camera = new Camera();
      this.camera.frame(this.scene.points);
      this.context = this.canvas.getContext("2d");
      this.find(".scale").textContent = `grid ${Number(this.scene.spacing.toPrecision(2))} m`;
      this.listen();
      new ViewControl(this);
      new ResizeObserver(() => this.resize()).observe(this.canvas.parentElement);
      this.resize();
    }
    this.show();
  }

  /** Draws the plots as wide as their place, or at a given width. */
  fit(width) {
    const plots = this.above ? [this.above, ...this.plots] : this.plots;
    for (const plot of plots) plot.render(width ?? (Math.round(plot.drawing.clientWidth) || plot.width));
  }

  resize() {
    const box = this.canvas.getBoundingClientRect();
    const density = Math.min(2, window.devicePixelRatio || 1);
    const [width, height] = [box.width, box.height].map((length) => Math.max(1, Math.round(length * density)));
    if (this.canvas.width !== width || this.canvas.height !== height) {
      this.canvas.width = width;
      this.canvas.height = height;
    }
    this.draw();
  }

  listen() {
    this.find(".play").addEventListener("click", () => this.toggle());
    this.find(".scrub").addEventListener("input", (event) => this.seek(Number(event.target.value)));
    this.find(".speed").addEventListener("change", (event) => (this.speed = Number(event.target.value)));
    this.find(".sight").addEventListener("change", (event) => {
      if (event.target.value) this.camera.look(event.target.value);
      this.draw();
    });
    for (const box of this.article.querySelectorAll("input[type=checkbox]")) {
      box.addEventListener("change", () => this.draw());
    }
  }

  toggle() {
    if (this.isPlaying) return this.pause();
    if (this.time >= this.run.end - 1e-6) this.time = this.run.start;
    for (const other of players) other.pause();
    this.isPlaying = true;
    this.last = null;
    this.label();
    requestAnimationFrame((now) => this.step(now));
  }

  pause() {
    if (!this.isPlaying) return;
    this.isPlaying = false;
    this.label();
  }

  label() {
    const button = this.find(".play");
    button.classList.toggle("playing", this.isPlaying);
    button.setAttribute("aria-label", this.isPlaying ? "Pause" : "Play");
  }

  step(now) {
    if (!this.isPlaying) return;
    // A tab that was hidden goes on where it was.
    const passed = this.last === null ? 0 : Math.min(0.1, (now - this.last) / 1000);
    this.last = now;
    this.time = Math.min(this.run.end, this.time + passed * this.speed);
    this.show();
    if (this.time >= this.run.end) this.pause();
    else requestAnimationFrame((next) => this.step(next));
  }

  seek(t) {
    this.time = Math.min(this.run.end, Math.max(this.run.start, t));
    this.show();
  }

  show() {
    for (const plot of this.plots) plot.show(this.time);
    this.above?.show(this.time);
    if (!this.canvas) return;
    const text = `${this.time.toFixed(2)} s`;
    const scrub = this.find(".scrub");
    scrub.value = this.time;
    scrub.setAttribute("aria-valuetext", text);
    scrub.style.setProperty("--done", `${(100 * (this.time - this.run.start)) / (this.run.end - this.run.start || 1)}%`);
    this.find(".clock").textContent = text;
    this.draw();
  }

  draw() {
    if (!this.context) return;
    const isFollowing = this.find(".follow").checked;
    this.camera.target = isFollowing ? this.scene.middle(this.time) : this.camera.home.target;
    const { width, height } = this.canvas;
    const theme = THEMES[prefersDark.matches && !isPrinting ? "dark" : "light"];
    const copies = this.find(".copies").checked;
    const picture = this.scene.picture(this.time, this.camera, width / height, theme, copies);
    Pictures.get().draw(this.context, picture);
    if (Pictures.renderer.isLost) Pictures.get().draw(this.context, picture);
    this.drawAxes(theme);
  }

  /** The directions x, y and z in a corner. */
  drawAxes(theme) {
    const context = this.context;
    const unit = Math.min(2, window.devicePixelRatio || 1) * 26;
    const origin = [1.5 * unit, this.canvas.height - 1.5 * unit];
    const direction = this.camera.direction;
    const right = Vec.unit(Vec.cross([0, 0, 1], direction));
    const up = Vec.cross(direction, right);
    const ink = theme === THEMES.dark ? "#c4ccd4" : "#4b5560";
    Object.assign(context, { strokeStyle: ink, fillStyle: ink, lineWidth: unit / 17, lineCap: "round" });
    Object.assign(context, { font: `${0.5 * unit}px system-ui, sans-serif`, textAlign: "center", textBaseline: "middle" });
    ["x", "y", "z"].forEach((name, axis) => {
      const tip = [origin[0] + unit * right[axis], origin[1] - unit * up[axis]];
      context.globalAlpha = 0.9;
      context.beginPath();
      context.moveTo(...origin);
      context.lineTo(...tip);
      context.stroke();
      if (Math.hypot(right[axis], up[axis]) < 0.15) return;
      context.fillText(name, ...[0, 1].map((i) => origin[i] + 1.3 * (tip[i] - origin[i])));
    });
    context.globalAlpha = 1;
  }
}

/** Mouse, touch and keyboard on the picture. */
class ViewControl {
  constructor(player) {
    this.player = player;
    this.pointers = new Map();
    const canvas = player.canvas;
    const on = (name, handle) => canvas.addEventListener(name, handle.bind(this), { passive: false });
    on("pointerdown", this.press);
    on("pointermove", this.move);
    for (const name of ["pointerup", "pointercancel"]) on(name, (event) => this.pointers.delete(event.pointerId));
    on("wheel", this.turnWheel);
    on("keydown", this.key);
    on("dblclick", () => this.change((camera) => camera.look("oblique")));
  }

  change(act) {
    act(this.player.camera);
    this.player.draw();
  }

  press(event) {
    this.player.canvas.setPointerCapture(event.pointerId);
    this.pointers.set(event.pointerId, [event.clientX, event.clientY]);
  }

  /** One pointer turns, two zoom. */
  move(event) {
    const before = this.pointers.get(event.pointerId);
    if (!before) return;
    const now = [event.clientX, event.clientY];
    if (this.pointers.size === 1) {
      this.player.find(".sight").value = "";
      this.change((camera) => camera.orbit((now[0] - before[0]) * 0.008, (now[1] - before[1]) * 0.008));
    } else {
      const other = [...this.pointers].find(([id]) => id !== event.pointerId)[1];
      const apart = (point) => Math.hypot(point[0] - other[0], point[1] - other[1]) || 1;
      this.change((camera) => camera.magnify(apart(now) / apart(before)));
    }
    this.pointers.set(event.pointerId, now);
  }

  /** Zooms when the picture has the focus, so that the page can be scrolled past it. */
  turnWheel(event) {
    if (document.activeElement !== this.player.canvas && !event.ctrlKey) return;
    event.preventDefault();
    this.change((camera) => camera.magnify(Math.exp(-0.0015 * event.deltaY)));
  }

  key(event) {
    const player = this.player;
    const turn = (left, up) => this.change((camera) => camera.orbit(left, up));
    const keys = {
      ArrowLeft: () => turn(0.1, 0),
      ArrowRight: () => turn(-0.1, 0),
      ArrowUp: () => turn(0, 0.1),
      ArrowDown: () => turn(0, -0.1),
      "+": () => this.change((camera) => camera.magnify(1.15)),
      "=": () => this.change((camera) => camera.magnify(1.15)),
      "-": () => this.change((camera) => camera.magnify(1 / 1.15)),
      0: () => this.change((camera) => camera.look("oblique")),
      " ": () => player.toggle(),
      ",": () => player.seek(player.time - 0.1),
      ".": () => player.seek(player.time + 0.1),
      Home: () => player.seek(player.run.start),
      End: () => player.seek(player.run.end),
    };
    if (event.ctrlKey || event.metaKey || event.altKey || !(event.key in keys)) return;
    event.preventDefault();
    keys[event.key]();
  }
}
