// Equal members: several of one kind in one picture, each in its colour.

/* Members by what the records know of one: a place in space, a place in the plane, a direction, a frame, or a number. */
class MembersScene extends Scene {
  constructor(model, drawing) {
    super(model, drawing);
    const many = (this.count = scene.members);
    this.colours = Array.from({ length: many }, (_, i) => hue(i / many));
    this.every = Math.max(1, Math.ceil(many / 64)); // of very many, some are drawn
    this.shown = Array.from({ length: Math.ceil(many / this.every) }, (_, k) => k * this.every);
    this.movable = scene.shape !== "frames";
    this.traced = ["space", "plane", "globe"].includes(scene.shape);
    const kinds = { space: "a place in space", plane: "a place in the plane", globe: "a place on the sphere", arrows: "a vector", frames: "a body", stems: "a number along the line" };
    this.hint = `${many} members, each with ${kinds[scene.shape]}${this.every > 1 ? `; ${this.shown.length} of them are drawn` : ""}. Drag ${this.movable ? `one to ${scene.shape === "arrows" ? "turn" : "move"} it; drag elsewhere to look around` : "to look around"}`;
    const at = this.places();
    this.middle = scaled(1 / at.length, at.reduce(plus));
    if (scene.shape === "globe" || scene.shape === "arrows") this.middle = [0, 0, 0];
    this.extent = Math.max(...at.map((p) => norm(minus(p, this.middle))), 1e-6);
    if (scene.shape === "arrows") this.long = 0.7 / Math.max(...this.shown.map((i) => norm(this.vector(i))), 1e-9);
    this.camera.target = this.middle;
    this.camera.distance = { arrows: 5.2, globe: 5.6, stems: 4.2 }[scene.shape] * this.extent || 6.2 * this.extent;
    this.camera.pitch = { plane: 1.0, stems: 0.15 }[scene.shape] ?? 0.45;
    if (scene.shape === "stems") this.camera.yaw = -Math.PI / 2;
    if (scene.shape === "globe") this.camera.yaw = Math.atan2(...at.reduce(plus).slice(0, 2).reverse());
  }
  /* Row of a component of a member: blocks of all members, one for each component. */
  row(component, i) { return component * this.count + i; }
  vector(i) { return scene.place.map((component) => this.model.x[this.row(component, i)]); }
  places() {
    const { model, count } = this, x = model.x;
    if (scene.shape === "space" || scene.shape === "globe") return this.shown.map((i) => this.vector(i));
    if (scene.shape === "plane") return this.shown.map((i) => [...this.vector(i), 0]);
    if (scene.shape === "frames" && scene.place.length === 12) return this.shown.map((i) => [3, 7, 11].map((c) => x[this.row(scene.place[c], i)]));
    if (scene.shape === "stems") {
      const at = this.shown.map((i) => this.vector(i)), q = at.map((v) => v[0]);
      this.ordered ??= q.every((v, k) => !k || v > q[k - 1]); // places along the line, or else displacements of a row
      const high = (this.high ??= Math.max(...at.map((v) => Math.abs(v[this.ordered ? 1 : 0])), 1e-9)), wide = (this.wide ??= this.ordered ? Math.max(...q) - Math.min(...q) : 1);
      return at.map((v, k) => (this.ordered ? [2 * v[0] / wide, 0, 0.5 * v[1] / high] : [2 * k / at.length, 0, 0.4 * v[0] / high]));
    }
    return this.shown.map((i) => { const a = 2 * Math.PI * i / count; return [1.4 * Math.cos(a), 1.4 * Math.sin(a), 0]; });
  }
  turnOf(i) {
    const m = scene.place, wide = m.length === 12 ? 4 : 3, at = (r, c) => this.model.x[this.row(m[wide * r + c], i)];
    return quaternionOf([0, 1, 2].map((r) => [0, 1, 2].map((c) => at(r, c))));
  }
  draw(theme) {
    const { drawing, extent } = this, at = this.places(), trailed = this.shown.length <= 24;
    if (scene.shape === "globe") drawing.draw("sphere", [1, 0, 0, 0], [0, 0, 0], Array(3).fill(0.995 * extent), theme.ball);
    else if (scene.shape === "stems") {
      if (this.ordered) this.follow(this.middle = scaled(1 / at.length, at.reduce(plus)));
      drawing.line([[this.middle[0] - 4 * extent, 0, 0], [this.middle[0] + 4 * extent, 0, 0]], () => [...theme.steel, 0.9], 2);
    } else {
      const cell = 10 ** Math.round(Math.log10(extent)) / 2, low = scene.shape === "plane" ? -0.06 * extent : Math.min(...at.map((p) => p[2])) - 0.9 * extent;
      drawing.floor((this.low ??= low), 7 * extent, cell, theme.floor, theme.line, [0, 0, 1e-6], this.middle);
    }
    if (trailed && this.traced) this.sample();
    const joined = scene.shape === "frames" || (scene.shape === "stems" && !this.ordered);
    if (joined || scene.shape === "arrows") drawing.line(scene.ring || scene.shape === "arrows" ? [...at, at[0]] : at, () => [...theme.steel, 0.8], 2.5);
    const thick = Math.min(0.075, (scene.shape === "stems" ? 0.9 : 2) / this.shown.length) * extent;
    at.forEach((p, k) => {
      const i = this.shown[k], tint = this.colours[i];
      if (trailed && this.traced) drawing.line(this.trail(i).points, fade(tint), 2.5);
      if (scene.shape === "arrows") drawing.arrow(p, plus(p, scaled(this.long, this.vector(i))), tint, 0.016);
      else if (scene.shape === "frames") drawing.draw("box", this.turnOf(i), p, this.sides(at), tint, { second: theme.body2, paint: 1 });
      else drawing.draw("sphere", [1, 0, 0, 0], p, Array(3).fill(thick), tint);
      if (scene.shape === "stems") drawing.line([[p[0], 0, 0], p], () => [...tint, 1], 3);
      const behind = scene.shape === "globe" && dot(p, drawing.eye) < extent * extent;
      if (this.shown.length <= 12) this.labels.push({ text: String(i + scene.first), at: plus(p, [0, 0, 1.3 * thick]), kind: "", behind });
    });
  }
  /* A box between neighbours. */
  sides(at) {
    const step = (this.step ??= at.length > 1 ? norm(minus(at[1], at[0])) : this.extent);
    if (scene.place.length === 9) return [0.3 * step, 0.22 * step, 0.14 * step];
    if (this.along === undefined) { // long toward the next one
      const next = at.length > 1 ? rotate(conjugate(this.turnOf(0)), minus(at[1], at[0])).map(Math.abs) : E[0];
      this.along = next.indexOf(Math.max(...next));
    }
    return [0, 1, 2].map((k) => (k === this.along ? 0.44 : k === (this.along + 1) % 3 ? 0.18 : 0.12) * step);
  }
  /* The components of a member that a hand has brought to a point of the canvas. */
  valueAt(k, x, y) {
    const { drawing } = this, at = this.places(), own = at[k], held = this.vector(this.shown[k]);
    if (scene.shape === "globe") return scaled(norm(own), drawing.hit(x, y, [0, 0, 0], norm(own)).direction);
    if (scene.shape === "arrows") return scaled(norm(held), drawing.hit(x, y, own, this.long * norm(held)).direction);
    const to = this.meet(own, x, y, { plane: E[2], stems: E[1] }[scene.shape]);
    if (scene.shape !== "stems") return to.slice(0, held.length);
    if (!this.ordered) return [to[2] * this.high / 0.4];
    const room = 0.02 * this.wide, of = (j) => this.vector(this.shown[j])[0]; // an order in which they stay
    const low = k > 0 ? of(k - 1) + room : -Infinity, high = k + 1 < at.length ? of(k + 1) - room : Infinity;
    return [clamp(to[0] * this.wide / 2, low, high), ...(held.length > 1 ? [2 * to[2] * this.high] : [])];
  }
  sample() {
    if (scene.shape === "stems" && !this.ordered) this.high = Math.max(this.high, ...this.shown.map((i) => 0.9 * Math.abs(this.vector(i)[0]))); // a row that grows stays in the picture
    if (!this.traced || this.shown.length > 24) return;
    this.places().forEach((p, k) => this.trail(this.shown[k]).add(p, 0.015 * this.extent));
  }
  grab(x, y) {
    if (!this.movable) return null;
    const away = this.handles().map((p) => { const s = this.drawing.project(p); return s.front ? Math.hypot(s.x - x, s.y - y) : Infinity; });
    const found = away.indexOf(Math.min(...away));
    return away[found] < 24 ? { move: (a, b) => this.carry(found, a, b) } : null;
  }
  /* Where a hand takes each: at its place, or at the tip of its vector. */
  handles() {
    const at = this.places();
    return scene.shape === "arrows" ? at.map((p, k) => plus(p, scaled(this.long, this.vector(this.shown[k])))) : at;
  }
  carry(k, x, y) {
    const { model } = this, i = this.shown[k];
    this.valueAt(k, x, y).forEach((v, c) => { model.x[this.row(scene.place[c], i)] = v; });
    model.ended = "";
    this.clear();
    model.measure();
  }
}

/* The quaternion of a rotation by its rows: of the four forms, the one whose root is the largest. */
function quaternionOf(m) {
  const [a, b, c] = [m[0][0], m[1][1], m[2][2]], squares = [1 + a + b + c, 1 + a - b - c, 1 - a + b - c, 1 - a - b + c];
  const k = squares.indexOf(Math.max(...squares)), x = m[2][1] - m[1][2], y = m[0][2] - m[2][0], z = m[1][0] - m[0][1];
  const xy = m[0][1] + m[1][0], xz = m[0][2] + m[2][0], yz = m[1][2] + m[2][1];
  return normal([[squares[0], x, y, z], [x, squares[1], xy, xz], [y, xy, squares[2], yz], [z, xz, yz, squares[3]]][k]);
}

SCENES.members = MembersScene;
