// Particles: places on their orbits, and rods that hang on each other.

/* Particles on their orbits; a centre of force at the origin. */
class ParticleScene extends Scene {
  constructor(model, drawing) {
    super(model, drawing);
    this.hint = "Drag a particle or the tip of its velocity; drag elsewhere to look around";
    this.camera.pitch = 0.5;
    this.extent = Math.max(...this.positions().map(norm), 0.5);
    const known = new Map(scene.tables.state.map((each) => [each.name, each])); // lengths one without a unit are directions
    this.directions = scene.places.every((each, k) => known.get(each.name)?.units[0] === "1" && Math.abs(norm(this.positions()[k]) - 1) < 1e-9);
    this.rods = this.directions ? findRods(model) : null;
    if (this.rods) Object.assign(this, { hint: "Drag a mass or the tip of the rate of its rod; drag elsewhere to look around", extent: 1 });
    else if (this.directions) this.hint = "Directions are points of a sphere. Drag one or the tip of its rate; drag elsewhere to look around";
    this.camera.distance = (this.rods ? 4.4 : 6.5) * this.extent;
    if (this.rods) this.camera.target = [0, 0, -0.5]; // half as deep as they reach
    this.central = this.isCentral();
  }
  /* Whether one particle at rest is pulled to the origin. */
  isCentral() {
    const { model } = this, [at] = this.positions(), [speed] = scene.speeds;
    if (scene.places.length !== 1 || speed.table !== "state") return false;
    const x = Float64Array.from(model.x);
    model.write(speed, speed.rows.map(() => 0), x);
    const rates = model.call("rhs", x, new Float64Array(model.n)), pull = speed.rows.map((row) => rates[row]);
    if (pull.length === 2) pull.push(0);
    return dot(pull, at) < -0.999999 * norm(pull) * norm(at);
  }
  /* Where particles are: of rods, each at the end of the one before. */
  positions() {
    const vectors = scene.places.map((each) => { const r = this.model.read(each); return r.length === 2 ? [...r, 0] : r; });
    if (!this.rods) return vectors;
    let at = [0, 0, 0];
    return vectors.map((v, k) => (at = plus(at, scaled(this.rods.lengths[k], v))));
  }
  /* What a direction begins at. */
  pivot(k) { return this.rods && k ? this.positions()[k - 1] : [0, 0, 0]; }
  sample() { this.positions().forEach((at, k) => this.trail(k).add(at, 0.01 * this.extent)); }
  draw(theme) {
    const { drawing, extent } = this, points = this.positions();
    const far = Math.max(...points.map(norm)) + 0.4 * extent; // an arrow's length
    if (!this.rods) this.camera.distance += 0.02 * (clamp(5.2 * far, 4.6 * extent, 40 * extent) - this.camera.distance) * (far > this.camera.distance / 3.6 ? 1 : 0);
    drawing.floor(this.rods ? -1.15 : 0, 6 * extent, extent / 2, [...theme.floor.slice(0, 3), 0.35], theme.line, [1e9, 0, 1], [0, 0]);
    drawing.draw("sphere", [1, 0, 0, 0], [0, 0, 0], Array(3).fill((this.central ? 0.11 : 0.025) * extent), this.central ? GOLD : theme.steel);
    if (this.directions && !this.rods) drawing.draw("sphere", [1, 0, 0, 0], [0, 0, 0], [1, 1, 1], [...(theme.dark ? theme.steel : theme.body), 0.4], { glass: 1 });
    this.sample();
    points.forEach((at, k) => {
      const from = this.pivot(k), along = minus(at, from);
      if (this.directions) drawing.draw("tube", turnOnto(E[2], along), from, [0.015, 0.015, norm(along)], theme.steel);
      const tint = [BLUE, RED, GREEN][k % 3], trail = this.trail(k);
      drawing.line(trail.points, fade(tint), 2.5);
      drawing.draw("sphere", [1, 0, 0, 0], at, Array(3).fill((this.rods ? this.rods.sizes[k] : 0.075) * extent), tint);
      if (!this.rods) drawing.line([at, [at[0], at[1], 0]], () => [...theme.line, 0.5], 1);
      this.label(scene.places[k].name, this.rods ? plus(from, scaled(0.55, along)) : plus(at, [0, 0, 0.12 * extent]));
      const speed = scene.speeds[k];
      if (speed) {
        const v = this.model.read(speed), tip = plus(at, scaled(0.5 * extent / (this.fast ||= norm([...v, 0])), v.length === 2 ? [...v, 0] : v));
        drawing.arrow(at, tip, GREEN, 0.014 * extent);
        this.nameArrow(speed.name, at, tip, "green");
      }
    });
  }
  /* The tip of the arrow of a velocity. */
  tip(k) {
    const v = this.model.read(scene.speeds[k]);
    return plus(this.positions()[k], scaled(0.5 * this.extent / this.fast, v.length === 2 ? [...v, 0] : v));
  }
  grab(x, y) {
    const near = (p) => { const s = this.drawing.project(p); return Math.hypot(s.x - x, s.y - y) < 22; };
    const tip = this.fast ? scene.speeds.findIndex((each, k) => each && each.table === "state" && near(this.tip(k)) && !near(this.positions()[k])) : -1;
    if (tip >= 0) return { move: (a, b) => this.aim(tip, a, b) };
    const found = this.positions().findIndex((p) => { const s = this.drawing.project(p); return Math.hypot(s.x - x, s.y - y) < 26; });
    return found < 0 ? null : { move: (a, b) => this.carry(found, a, b) };
  }
  /* Of particles in a plane, its normal. */
  flatOf(k) { return scene.places[k].rows.length === 2 ? E[2] : null; }
  carry(k, x, y) {
    if (this.directions) this.put(scene.places[k], this.drawing.hit(x, y, this.pivot(k), this.rods ? this.rods.lengths[k] : 1).direction);
    else this.put(scene.places[k], this.meet(this.positions()[k], x, y, this.flatOf(k)));
  }
  aim(k, x, y) {
    const from = this.positions()[k], to = this.meet(this.tip(k), x, y, this.flatOf(k));
    this.put(scene.speeds[k], scaled(this.fast / (0.5 * this.extent), minus(to, from)));
  }
  moving() { if (this.rods) this.rods = findRods(this.model); }
  put(variable, value) {
    this.model.write(variable, value);
    this.model.ended = "";
    this.clear();
    this.model.measure();
  }
}

/* Rods that hang on each other, by the energy of the rates of their directions. Mass a is at the sum of l_i gamma_i over the rods
   up to its own, so that the coefficients of v_i . v_j are l_i l_j times the mass from max(i, j) on: each pair gives l_i/l_j.
   Null where they are not so. Lengths are parts of that of the whole. */
function findRods(model) {
  const count = scene.places.length, x = Float64Array.from(model.x), rows = scene.speeds.map((each) => each?.table === "state" && each.rows);
  if (count < 2 || !model.has("energy") || !rows.every((own) => own && own.length === 3)) return null;
  const at = (...moved) => { rows.flat().forEach((row) => { x[row] = 0; }); moved.forEach((row) => { x[row] += 1; }); return model.energyAt(x); };
  const rest = at(), product = (a, b) => at(a, b) - at(a) - at(b) + rest;
  const scale = Math.abs(product(rows[0][0], rows[0][0])), near = (a, b) => Math.abs(a - b) < 1e-9 * scale;
  const inertia = rows.map((own) => rows.map((other) => product(own[0], other[0])));
  const alike = rows.every((own, i) => rows.every((other, j) => [0, 1, 2].every((a) => [0, 1, 2].every((b) => near(product(own[a], other[b]), a === b ? inertia[i][j] : 0)))));
  const last = count - 1, ratios = inertia.map((row) => row[last] / inertia[last][last]), mass = inertia.map((row, j) => row[j] / ratios[j] ** 2); // from each on
  const chain = ratios.every((l) => l > 0) && inertia.every((row, i) => row.every((v, j) => near(v, ratios[i] * ratios[j] * mass[Math.max(i, j)])));
  const masses = mass.map((m, j) => m - (mass[j + 1] || 0)), whole = ratios.reduce((sum, l) => sum + l), most = Math.max(...masses);
  if (!alike || !chain || !masses.every((m) => m > 0)) return null;
  return { lengths: ratios.map((l) => l / whole), sizes: masses.map((m) => 0.075 * Math.cbrt(m / most)) };
}

SCENES.particles = ParticleScene;
