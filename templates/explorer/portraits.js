// Portraits: links of a pendulum in the plane, vectors of the state, or rows of it that move.

/* Links that hang on each other in a plane: observables x and y are the sums of their sines and of minus their cosines. */
class LinkScene extends Scene {
  constructor(model, drawing, links) {
    super(model, drawing);
    Object.assign(this, links, { whole: links.lengths.reduce((sum, l) => sum + l), hint: "Drag a mass to turn its link; drag elsewhere to look around" });
    Object.assign(this.camera, { yaw: -Math.PI / 2, pitch: 0.12, distance: 4.2 * this.whole, target: [0, 0, -0.35 * this.whole] });
  }
  moving() { Object.assign(this, findLinks(this.model) || {}); this.whole = this.lengths.reduce((sum, l) => sum + l); }
  masses() {
    let at = [0, 0, 0];
    return this.angles.map(({ row }, k) => (at = plus(at, scaled(this.lengths[k], [Math.sin(this.model.x[row]), 0, -Math.cos(this.model.x[row])]))));
  }
  sample() { this.trail("last").add(this.masses().at(-1), 0.005 * this.whole); }
  draw(theme) {
    const { drawing, whole } = this, at = this.masses();
    this.sample();
    drawing.line(this.trail("last").points, fade(ORANGE), 2.5);
    drawing.draw("box", [1, 0, 0, 0], [0, 0, 0.02 * whole], [0.12 * whole, 0.05 * whole, 0.02 * whole], theme.steel);
    at.forEach((p, k) => {
      const from = k ? at[k - 1] : [0, 0, 0], along = minus(p, from);
      drawing.draw("tube", turnOnto(E[2], along), from, [0.01 * whole, 0.01 * whole, norm(along)], theme.steel);
      drawing.draw("sphere", [1, 0, 0, 0], p, Array(3).fill(0.035 * whole), BLUE);
      this.label(this.angles[k].name, plus(from, scaled(0.5, along)));
    });
  }
  grab(x, y) {
    const k = this.masses().findIndex((p) => { const s = this.drawing.project(p); return s.front && Math.hypot(s.x - x, s.y - y) < 26; });
    return k < 0 ? null : { move: (a, b) => this.carry(k, a, b) };
  }
  carry(k, x, y) {
    const { model } = this, at = this.masses(), to = minus(this.meet(at[k], x, y, E[1]), k ? at[k - 1] : [0, 0, 0]), { row } = this.angles[k];
    const wanted = Math.atan2(to[0], -to[2]) - model.x[row];
    model.x[row] += Math.atan2(Math.sin(wanted), Math.cos(wanted)); // the turn nearest to the one before
    model.ended = "";
    this.clear();
    model.measure();
  }
}

/* Scalars of a table with their rows. */
function listScalars(table) {
  let row = 0;
  return scene.tables[table].flatMap((each) => {
    const first = row;
    row += each.components.length;
    return each.components.length === 1 && each.components[0] === each.name ? [{ name: each.name, row: first, unit: each.units[0] }] : [];
  });
}
/* Angles and lengths of links, or null. */
function findLinks(model) {
  const angles = listScalars("state").filter((each) => each.unit === "rad"), told = listScalars("observables");
  if (!angles.length || !model.has("observables")) return null;
  const state = Float64Array.from(model.x), out = new Float64Array(model.y.length);
  const at = (turns, row) => { angles.forEach((each, k) => { state[each.row] = turns[k]; }); return model.call("observables", state, out)[row]; };
  const probe = angles.map((_, k) => 0.3 + 1.1 * k);
  for (const across of told) for (const up of told) {
    if (across === up || across.unit !== up.unit) continue;
    const lengths = angles.map((_, k) => at(angles.map((_, j) => (j === k ? Math.PI / 2 : 0)), across.row));
    const sum = (of) => lengths.reduce((all, l, k) => all + l * of(probe[k]), 0), size = lengths.reduce((all, l) => all + Math.abs(l), 0);
    const off = Math.abs(at(probe, across.row) - sum(Math.sin)) + Math.abs(at(probe, up.row) + sum(Math.cos));
    if (lengths.every((l) => l > 0) && off < 1e-9 * size) return { angles, lengths };
  }
  return null;
}

/* All vectors of a state of vectors of one unit, from one point; of other states the three rows that move the most, as a point. */
class PortraitScene extends Scene {
  constructor(model, drawing) {
    super(model, drawing);
    this.choose();
    this.camera.distance = 6 * this.extent;
  }
  choose() {
    const { state } = scene.tables, units = new Set(state.flatMap((each) => each.units));
    this.whole = units.size === 1 && state.every((each) => each.components.length === 3);
    const rows = this.findMoving(), components = state.flatMap((each) => each.components);
    let first = 0;
    const own = state.map((each) => each.components.map(() => first++));
    const best = own.find((each) => each.length === 3 && each.every((row) => rows.includes(row))) || rows.slice(0, 3).sort((a, b) => a - b);
    this.parts = this.whole ? own : [best];
    this.tips = this.whole ? state.map((each) => each.name) : [""];
    this.axes = this.whole ? ["1", "2", "3"] : best.map((row) => components[row]);
    this.hint = this.whole ? `${this.tips.map(plainName).join(" and ")}, with ${state.length > 1 ? "their" : "its"} components along the axes; drag to look around`
      : `${this.axes.map(plainName).join(", ")} as a point in space; drag to look around`;
    this.extent = Math.max(...this.points().map(norm), 1e-3);
  }
  /* Rows that change over some steps of Runge and Kutta, the one that changes the most first; all where nothing moves. */
  findMoving() {
    const { model } = this, h = 2 * model.h, rates = (x) => model.call("rhs", x, new Float64Array(model.n)), along = (x, k, part) => x.map((v, i) => v + part * k[i]);
    let x = Float64Array.from(model.x);
    const low = x.slice(), high = x.slice();
    for (let n = 0; n < 60 && x.every(Number.isFinite); n++) {
      x.forEach((v, i) => { low[i] = Math.min(low[i], v); high[i] = Math.max(high[i], v); });
      const a = rates(x), b = rates(along(x, a, h / 2)), c = rates(along(x, b, h / 2)), d = rates(along(x, c, h));
      x = x.map((v, i) => v + h / 6 * (a[i] + 2 * b[i] + 2 * c[i] + d[i]));
    }
    const sizes = [...high].map((v, k) => v - low[k]), most = Math.max(...sizes), all = sizes.map((_, k) => k);
    return most > 0 ? all.filter((k) => sizes[k] > 1e-9 * most).sort((a, b) => sizes[b] - sizes[a]) : all;
  }
  clear() { super.clear(); if (this.parts) this.choose(); }
  points() { return this.parts.map((rows) => [0, 1, 2].map((k) => (k < rows.length ? this.model.x[rows[k]] : 0))); }
  draw(theme) {
    const { drawing } = this, points = this.points();
    this.extent = Math.max(this.extent, ...points.map((at) => norm(at) * 0.9));
    this.camera.distance = Math.max(this.camera.distance, 4.5 * this.extent);
    this.axes.forEach((name, k) => { drawing.line([[0, 0, 0], scaled(this.extent, E[k])], () => [...theme.steel, 0.8], 2); this.label(name, scaled(1.06 * this.extent, E[k])); });
    points.forEach((at, k) => {
      const tint = this.whole ? [BLUE, RED, GREEN, VIOLET][k % 4] : BLUE, kind = ["blue", "red", "green", "violet"][k % 4];
      this.trail(k).add(at, 0.005 * this.extent);
      drawing.line(this.trail(k).points, fade(tint), 2.5);
      if (!this.whole) { drawing.draw("sphere", [1, 0, 0, 0], at, Array(3).fill(0.04 * this.extent), ORANGE); return; }
      drawing.arrow([0, 0, 0], at, tint, 0.014 * this.extent);
      this.nameArrow(this.tips[k], [0, 0, 0], at, kind);
    });
  }
}

/* What a constructor returns is what it makes. */
SCENES.portrait = function portray(model, drawing) {
  const links = findLinks(model);
  return links ? new LinkScene(model, drawing, links) : new PortraitScene(model, drawing);
};
