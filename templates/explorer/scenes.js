// Scenes: the thing itself, drawn from what the records of a system say of it.
const BLUE = [0.16, 0.45, 0.78], ORANGE = [0.90, 0.52, 0.12], GOLD = [0.93, 0.72, 0.20], GREEN = [0.10, 0.58, 0.46], RED = [0.80, 0.30, 0.25], VIOLET = [0.50, 0.32, 0.68];
const fade = (colour, most = 0.95) => (part) => [...colour, most * part * part];
const TRAIL = 700;

class Trail {
  constructor(most = TRAIL) { this.points = []; this.most = most; }
  add(p, least) {
    const last = this.points[this.points.length - 1];
    if (last && norm(minus(p, last)) < least) return;
    this.points.push(p);
    if (this.points.length > this.most) this.points.shift();
  }
}

/* What all scenes share: a camera, trails, arrows with their names, and a hand. */
class Scene {
  constructor(model, drawing) {
    Object.assign(this, { model, drawing, trails: {}, labels: [], radius: 1, centre: [0, 0, 0] });
    this.camera = { yaw: -0.9, pitch: 0.32, distance: 6, target: [0, 0, 0] };
    this.hint = "Drag to look around";
  }
  trail(name, most) { return (this.trails[name] ||= new Trail(most)); }
  clear() { this.trails = {}; this.since = undefined; }
  /* Come nearer to what moves, as fast at any number of frames; of a new motion, at once. */
  follow(at) {
    const now = performance.now() / 1000, part = 1 - Math.exp(-8 * (now - (this.since ?? -Infinity)));
    this.came = this.since === undefined;
    this.since = now;
    this.camera.target = this.camera.target.map((v, k) => v + part * (at[k] - v));
  }
  label(text, at, kind = "", tip = null) { this.labels.push({ text, at, kind, tip }); }
  /* The name of an arrow, past its tip. */
  nameArrow(text, from, tip, kind) { this.label(text, plus(tip, scaled(0.06, minus(tip, from))), kind, tip); }
  /* Where a ray meets the plane through a point with a normal; by default that plane faces the eye. */
  meet(at, x, y, normal) {
    const { drawing } = this, facing = normal || unit(minus(drawing.eye, this.camera.target)), d = drawing.ray(x, y);
    return plus(drawing.eye, scaled(dot(minus(at, drawing.eye), facing) / dot(d, facing), d));
  }
  turnable() { return false; }
  moving() {}
  sample() {}
}

/* A body: about a fixed point, free, or moving; with a box of its moments of inertia. */
class BodyScene extends Scene {
  constructor(model, drawing) {
    super(model, drawing);
    this.hint = "Drag the body to turn it; drag elsewhere to look around";
    this.flip = [1, 0, 0, 0];
    const down = scene.vertical && scene.vertical.depth && scene.vertical.depth.length === 1;
    if (down && model.has("energy")) {
      const x = Float64Array.from(model.x), row = scene.vertical.depth[0], before = model.energyAt(x);
      x[row] += 1;
      if (model.energyAt(x) < before) this.flip = [0, 1, 0, 0]; // the normal of the plane points down
    }
    this.rolls = this.isFree();
    if (this.rolls) this.hint = "The ellipsoid of inertia rolls on the plane normal to the momentum; drag the body to turn it";
    this.shape();
  }
  /* Whether it turns by its inertia alone: the momentum rests in space, and the energy is half its product with the angular velocity. */
  isFree() {
    const { model } = this, { spinning, turning } = scene;
    if (scene.noise || !spinning || spinning.table !== "state" || scene.vertical || scene.moving || model.u.length || !model.has("energy")) return false;
    const m = model.read(spinning), w = model.read(turning), rates = model.call("rhs", model.x, new Float64Array(model.n));
    const own = spinning.rows.map((row) => rates[row]), size = norm(m) * norm(w);
    return norm(minus(own, cross(m, w))) < 1e-9 * size && Math.abs(2 * model.energyAt(model.x) - dot(m, w)) < 1e-9 * size;
  }
  /* The ellipsoid of inertia: angular velocities of one energy, by their momenta, to which it is normal. */
  ellipsoid() {
    const { model } = this, x = Float64Array.from(model.x);
    const columns = E.map((axis) => { model.write(scene.spinning, axis, x); return model.read(scene.turning, x); });
    const of = (m) => { const w = columns.reduce((sum, c, k) => plus(sum, scaled(m[k], c)), [0, 0, 0]); return scaled(1 / Math.sqrt(dot(w, m)), w); };
    const made = grid(40, 80, (u, v) => { const m = onSphere(u, v); return [of(m), m]; });
    this.unit = 1 / Math.max(...made.points.map((_, k) => (k % 3 ? 0 : norm(made.points.slice(k, k + 3)))));
    made.points = made.points.map((v) => this.unit * v);
    this.own = this.drawing.mesh(made);
  }
  shape() {
    const model = this.model, inertia = model.inertia(), total = Math.max(...inertia);
    const sides = [0, 1, 2].map((k) => Math.sqrt(Math.max(inertia[(k + 1) % 3] + inertia[(k + 2) % 3] - inertia[k], 0.03 * total)));
    const big = Math.max(...sides);
    this.sizes = sides.map((s) => 0.85 * s / big);
    const equal = (a, b) => Math.abs(inertia[a] - inertia[b]) < 1e-9 * total;
    this.axis = equal(0, 1) ? 2 : equal(1, 2) ? 0 : equal(0, 2) ? 1 : -1;
    const weight = model.weight();
    this.arm = norm(weight) > 1e-12 && !scene.moving ? scaled(1.15, unit(weight)) : [0, 0, 0];
    this.weighs = norm(this.arm) > 0;
    if (this.weighs) this.sizes = scaled(0.62, this.sizes);
    if (this.rolls) {
      this.ellipsoid();
      const out = Math.hypot(...this.sizes.map((s, k) => s * this.unit * Math.sqrt(inertia[k]) / this.unit ** 2));
      this.sizes = scaled(0.94 / out, this.sizes); // corners within the ellipsoid
    }
    this.below = this.weighs ? -Math.max(1.5, norm(this.arm) + 1.05 * Math.hypot(...this.sizes)) : -1.5;
    this.camera.distance = this.weighs ? 7.6 : scene.moving ? (scene.pushing && !this.model.u.length ? 8.8 : 7.5) : 5;
    this.camera.target = [0, 0, this.weighs ? -0.1 : 0]; // tips of arrows stand above what weighs
  }
  moving() { if (this.model.u.length) return; this.shape(); }
  place() { return rotate(this.flip, scene.moving ? this.model.position : [0, 0, 0]); }
  draw(theme) {
    const { model, drawing } = this;
    if (this.rolls) this.flip = turnOnto(rotate(model.pose(), model.read(scene.spinning)), [0, 0, -1]); // the plane that the momentum is normal to is the floor
    const q = multiply(this.flip, model.pose()), at = this.place(), middle = plus(at, rotate(q, this.arm));
    this.centre = this.weighs ? at : middle;
    this.radius = this.weighs ? 1.5 : 1;
    if (this.weighs) {
      drawing.floor(this.below, 5, 0.5, theme.floor, theme.line, [middle[0], middle[1], 0.8], [0, 0]);
      drawing.draw("tube", [1, 0, 0, 0], [0, 0, this.below], [0.3, 0.3, 0.04], theme.steel);
      drawing.draw("tube", [1, 0, 0, 0], [0, 0, this.below], [0.03, 0.03, -0.06 - this.below], theme.steel);
      drawing.draw("cone", [1, 0, 0, 0], [0, 0, -0.12], [0.03, 0.03, 0.11], theme.steel);
      drawing.draw("tube", multiply(q, turnOnto(E[2], this.arm)), at, [0.035, 0.035, norm(this.arm)], theme.steel);
      drawing.draw("sphere", q, middle, [0.1, 0.1, 0.1], GOLD);
    } else if (scene.moving) {
      this.follow(at);
      const cell = 0.5;
      if (model.u.length) drawing.floor(Math.min(0, Math.floor(at[2])) - 1.6, 14, cell, theme.floor, theme.line, [at[0], at[1], 0.9], at);
      else drawing.lattice(at, 1.5, 4.5, theme.line); // what does not move
    }
    const rotors = scene.stick && scene.moving;
    if (rotors) this.frame(q, at, theme);
    else this.solid(q, middle, theme);
    if (this.rolls) { this.roll(q, theme); this.arrows(q, at); return; }
    const tip = this.sample();
    drawing.line(this.trail("tip").points, fade(ORANGE), 2.5);
    if (!scene.moving && !this.weighs) drawing.arrow(plus(at, rotate(q, scaled(this.sizes[2] * 0.9, E[2]))), tip, ORANGE, 0.022);
    this.arrows(q, at);
  }
  /* The ellipsoid on its plane, with the curves of the contact on both. */
  roll(q, theme) {
    const { model, drawing } = this, at = this.contact(), deep = rotate(q, at)[2];
    drawing.floor(deep, 5, 0.5, theme.floor, theme.line, [0, 0, 0.9], [0, 0]);
    this.sample();
    const lifted = this.trail("herpolhode", 3000).points.map((p) => [p[0], p[1], deep + 0.004]);
    drawing.line(lifted, fade(ORANGE), 2.5);
    drawing.line(this.trail("polhode", 900).points.map((p) => rotate(q, scaled(1.003, p))), fade(GREEN), 2.5);
    drawing.draw(this.own, q, [0, 0, 0], [1, 1, 1], [...(theme.dark ? theme.steel : theme.body), 0.55], { glass: 1 });
    drawing.draw("sphere", [1, 0, 0, 0], rotate(q, at), Array(3).fill(0.035), ORANGE);
  }
  contact() { const w = this.model.read(scene.turning); return scaled(this.unit / Math.sqrt(dot(w, this.model.read(scene.spinning))), w); }
  sample() {
    const q = multiply(this.flip, this.model.pose());
    if (!this.rolls) {
      const tip = scene.moving ? this.place() : rotate(q, this.weighs ? scaled(1.06, this.arm) : scaled(this.sizes[2] + 0.25, E[2]));
      this.trail("tip").add(tip, 0.02);
      return tip;
    }
    const at = this.contact();
    this.trail("herpolhode", 3000).add(rotate(q, at), 0.012);
    this.trail("polhode", 900).add(at, 0.012);
    return at;
  }
  solid(q, middle, theme) {
    const { drawing } = this;
    if (this.axis >= 0) {
      const own = multiply(q, turnOnto(E[2], E[this.axis])), r = this.sizes[(this.axis + 1) % 3], h = this.sizes[this.axis];
      drawing.draw("tube", own, minus(middle, rotate(own, [0, 0, h])), [r, r, 2 * h], theme.body, { second: theme.body2, paint: 2 });
    } else drawing.draw("box", q, middle, this.sizes, theme.body, { second: theme.body2, paint: 1 });
  }
  /* Something that is driven by a thrust: rotors on a cross. */
  frame(q, at, theme) {
    const { drawing } = this;
    drawing.draw("sphere", q, at, [0.24, 0.24, 0.13], theme.body);
    for (let k = 0; k < 4; k++) {
      const out = [[1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0]][k], end = plus(at, rotate(q, scaled(0.8, out)));
      drawing.draw("tube", turnOnto(E[2], rotate(q, out)), at, [0.035, 0.035, 0.8], theme.steel);
      drawing.draw("tube", q, plus(end, rotate(q, [0, 0, -0.05])), [0.34, 0.34, 0.012], k === 0 ? ORANGE : theme.body2);
      const turned = multiply(q, turnBy([0, 0, (k % 2 ? 7 : -7) * this.model.clock[0]])); // in turn, so that they do not turn the frame
      drawing.draw("box", turned, plus(end, rotate(q, [0, 0, -0.07])), [0.32, 0.03, 0.012], theme.steel);
    }
  }
  arrows(q, at) {
    const { model, drawing } = this, w = model.read(scene.turning), size = norm(w);
    const far = this.rolls ? norm(this.contact()) : this.weighs ? 1.5 : 1.35; // to the contact, where it has one
    if (size > 1e-9) {
      const tip = plus(at, rotate(q, scaled(far / size, w)));
      drawing.arrow(at, tip, GREEN, 0.022);
      this.nameArrow(scene.turning.name, at, tip, "green");
    }
    if (scene.vertical && !model.u.length) { // the point on the sphere is this direction, seen from the body
      const along = rotate(q, unit(model.read(scene.vertical))), tip = plus(at, scaled(far, along));
      drawing.arrow(at, tip, BLUE, 0.014);
      this.nameArrow(scene.vertical.name, at, tip, "blue");
    }
    const momentum = scene.spinning && scene.spinning.table === "state" ? model.read(scene.spinning) : [0, 0, 0];
    if (norm(momentum) > 1e-9) {
      const m = unit(momentum), long = this.rolls ? dot(m, this.contact()) : 1.15 * far, tip = plus(at, rotate(q, scaled(long, m)));
      drawing.arrow(at, tip, RED, 0.022);
      this.nameArrow(scene.spinning.name, at, tip, "red");
    }
    if (scene.moving && !model.u.length && norm(model.read(scene.moving)) > 1e-9) {
      const tip = plus(at, rotate(q, scaled(1.5, unit(model.read(scene.moving)))));
      drawing.arrow(at, tip, VIOLET, 0.022);
      this.nameArrow(scene.moving.name, at, tip, "violet");
    }
    if (scene.pushing && scene.pushing.table === "state" && !scene.vertical && !model.u.length && norm(model.read(scene.pushing)) > 1e-9) {
      const tip = plus(at, rotate(q, scaled(1.7, unit(model.read(scene.pushing)))));
      drawing.arrow(at, tip, BLUE, 0.022);
      this.nameArrow(scene.pushing.name, at, tip, "blue");
    }
  }
  turnable() { return true; }
  /* Without a vertical a body is turned below its momenta, which rest in space. */
  turn(rotation) {
    const { model } = this, held = [scene.spinning, scene.pushing].filter((each) => !scene.vertical && each?.table === "state");
    const momenta = held.map((each) => rotate(model.pose(), model.read(each)));
    model.turn(multiply(multiply(conjugate(this.flip), rotation), this.flip));
    held.forEach((each, k) => { model.write(each, rotate(conjugate(model.pose()), momenta[k])); });
    model.measure();
  }
}

/* A body that rolls: its surface is where the arms to its centre of mass begin. */
class RollingScene extends Scene {
  constructor(model, drawing) {
    super(model, drawing);
    this.hint = scene.slipping ? "It slides on the plane: orange is the path of the contact. Drag the body to turn it" : "Drag the body to turn it; drag the floor to look around";
    this.surface();
  }
  surface() {
    const rows = 40, columns = 64, points = [], triangles = [];
    for (let i = 0; i <= rows; i++) for (let j = 0; j <= columns; j++) {
      const u = clamp(i / rows, 0.004, 0.996);
      points.push(scaled(-1, this.model.arm(onSphere(u, j / columns))));
      const a = i * (columns + 1) + j;
      if (i < rows && j < columns) triangles.push(a, a + columns + 1, a + 1, a + 1, a + columns + 1, a + columns + 2);
    }
    for (const row of [0, rows]) { // flat ends, as of a disk, are closed at their middle
      const ring = points.slice(row * (columns + 1), row * (columns + 1) + columns);
      const middle = scaled(1 / columns, ring.reduce(plus));
      const first = points.length;
      points.push(middle, ...ring);
      for (let j = 0; j < columns; j++) triangles.push(first, first + 1 + j, first + 1 + ((j + 1) % columns));
    }
    const finite = points.filter((p) => p.every(Number.isFinite));
    this.size = Math.max(...finite.map(norm), 1e-9);
    for (const p of points) if (!p.every(Number.isFinite)) p.fill(0);
    this.own = this.drawing.mesh(smooth(points.map((p) => scaled(1 / this.size, p)), triangles));
    this.spread = Math.max(...finite.map((p) => Math.abs(p[2]))) / this.size;
    this.camera.distance = 6.4 * this.size;
    this.camera.pitch = 0.42;
  }
  moving() { const { distance, pitch } = this.camera; this.surface(); Object.assign(this.camera, { distance, pitch }); }
  draw(theme) {
    const { model, drawing, size } = this, q = model.pose(), up = model.read(scene.vertical);
    const contact = this.contact(), arm = rotate(q, model.arm(unit(up))), at = plus(contact, arm);
    this.centre = at;
    this.radius = size;
    this.follow(plus(at, [0, 0, 0.25 * size])); // arrows stand above the body
    const cell = 10 ** Math.round(Math.log10(size)) / 2;
    drawing.floor(0, 22 * size, cell, theme.floor, theme.line, [at[0], at[1], 0.9 * size], at);
    this.sample();
    drawing.line(this.trail("contact").points, fade(ORANGE), 3);
    drawing.draw(this.own, q, at, [size, size, size], theme.body, { second: theme.body2, paint: this.spread < 0.05 ? 2 : 1 });
    if (this.spread < 0.05) this.rim(q, at, theme);
    drawing.draw("sphere", q, plus(contact, [0, 0, 0.01 * size]), Array(3).fill(0.035 * size), ORANGE);
    if (this.spread < 0.05) this.label("contact", contact, "orange");
    if (scene.vertical) {
      const tip = plus(at, [0, 0, 1.35 * size]);
      drawing.arrow(at, tip, BLUE, 0.012 * size);
      this.nameArrow(scene.vertical.name, at, tip, "blue");
    }
    const w = model.read(scene.turning);
    if (norm(w) > 1e-9) {
      const along = rotate(q, scaled(1.5 * size / norm(w), w)), under = at[2] + along[2] < 0; // else it would end below the floor
      const from = under ? minus(at, scaled(0.85, along)) : at, tip = under ? minus(at, scaled(0.25, along)) : plus(at, along);
      drawing.arrow(from, tip, GREEN, 0.018 * size);
      this.nameArrow(scene.turning.name, under ? tip : from, under ? from : tip, "green");
    }
  }
  /* The trace of the contact, at every step. */
  sample() {
    this.trail("contact").add(plus(this.contact(), [0, 0, 0.004 * this.size]), 0.02 * this.size);
  }
  /* Where it touches the plane: reconstructed, or below a centre that slides along. */
  contact() {
    const { model } = this;
    if (scene.slipping) { const arm = rotate(model.pose(), model.arm(unit(model.read(scene.vertical)))); return [model.position[0] - arm[0], model.position[1] - arm[1], 0]; }
    const rows = (this.free ||= [...model.rest.keys()].filter((row) => !model.quaternionRows().includes(row)));
    return [model.rest[rows[0]], model.rest[rows[1]], 0];
  }
  rim(q, at, theme) {
    const ring = Array.from({ length: 65 }, (_, k) => plus(at, rotate(q, scaled(this.size, [Math.cos(k * Math.PI / 32), Math.sin(k * Math.PI / 32), 0]))));
    this.drawing.line(ring, () => [...theme.steel, 1], 4);
  }
  turnable() { return true; }
  turn(rotation) { this.model.turn(rotation); }
}

/* A vehicle in the plane: each constraint is a wheel, on the line where it lets the frame turn. */
class PlanarScene extends Scene {
  constructor(model, drawing) {
    super(model, drawing);
    this.camera.pitch = 0.75;
    if (scene.kind !== "planar") return;
    const wheels = this.wheels();
    this.hint = `Drag ${scene.angles.map((each) => (this.steers(each) ? "the wheels to steer" : "the golden bar to turn it")).concat("the floor to look around").join(", ")}`;
    this.size = Math.max(...wheels.map((w) => Math.abs(w.at)), 0.1) * 1.25;
    this.camera.distance = 9 * this.size;
  }
  /* Rows of constraints are linear in the velocities of the frame: n . (v + omega x p). */
  wheels() {
    const { model } = this, count = scene.sizes.constraint_residual || 0;
    const x = model.half, found = [], all = scene.frame.flatMap((each) => each.rows), out = () => new Float64Array(count);
    x.set(model.x);
    const at = (velocity) => { all.forEach((row, k) => { x[row] = velocity[k]; }); return model.call("constraint_residual", x, out()); };
    const zero = at([0, 0, 0]), order = this.order();
    const slopes = order.map((k) => at([0, 1, 2].map((j) => (j === k ? 1 : 0))).map((v, i) => v - zero[i]));
    for (let i = 0; i < count; i++) {
      const [a, b, turn] = slopes.map((s) => s[i]);
      if (Math.abs(b) > 1e-9) found.push({ at: turn / b, angle: Math.atan2(-a, b) });
    }
    return found;
  }
  /* Which velocities are along, across and of turning: by what each does to the place. */
  order() {
    if (this.known) return this.known;
    const { model } = this, rows = scene.frame.flatMap((each) => each.rows), x = new Float64Array(model.n + 3);
    const rates = rows.map((row) => { x.fill(0); x[row] = 1; return [...model.call("reconstruction", x, new Float64Array(3))]; });
    const largest = rates.map((r) => r.findIndex((v) => Math.abs(v) > 0.5)), turn = rates.findIndex((r, k) => {
      x.fill(0); x[rows[k]] = 1; x[model.n + largest[k]] = 0.3; // a direction turns no other rate
      const again = [...model.call("reconstruction", x, new Float64Array(3))];
      return r.filter((v) => Math.abs(v) > 0.5).length === 1 && again.every((v, j) => v === r[j]) && this.turns(rates, r, largest[k], rows, x);
    });
    const others = [0, 1, 2].filter((k) => k !== turn).sort((a, b) => largest[a] - largest[b]);
    this.rows = { turn: largest[turn], x: largest[others[0]], y: largest[others[1]] };
    return (this.known = [...others, turn]);
  }
  /* Whether a reconstructed row is the direction: others depend on it. */
  turns(rates, own, row, rows, x) {
    return rows.some((each) => {
      x.fill(0); x[each] = 1;
      const before = [...this.model.call("reconstruction", x, new Float64Array(3))];
      x[this.model.n + row] = 0.3;
      return [...this.model.call("reconstruction", x, new Float64Array(3))].some((v, j) => v !== before[j]);
    });
  }
  draw(theme) {
    const { model, drawing, size } = this, wheels = this.wheels(), rows = this.rows, r = model.rest;
    const at = [r[rows.x], r[rows.y], 0.16 * size], q = turnBy([0, 0, r[rows.turn]]), lift = 0.1 * size;
    this.follow(at);
    drawing.floor(0, 24 * size, size, theme.floor, theme.line, [at[0], at[1], size], at);
    this.sample();
    drawing.line(this.trail("path").points, fade(ORANGE), 3);
    const long = Math.max(...wheels.map((w) => Math.abs(w.at)), 0.5 * size);
    this.knobs = [];
    drawing.draw("box", q, at, [long, 0.11 * size, 0.025 * size], theme.body);
    for (const wheel of wheels) {
      const turn = multiply(q, turnBy([0, 0, wheel.angle])), middle = plus(at, rotate(q, [wheel.at, 0, 0.06 * size]));
      drawing.draw("box", turn, middle, [0.2 * size, 0.14 * size, 0.022 * size], theme.body2);
      for (const side of [-1, 1]) {
        const hub = plus(middle, rotate(turn, [0, side * 0.15 * size - 0.02 * size, -0.12 * size]));
        drawing.draw("tube", multiply(turn, turnOnto(E[2], E[1])), hub, [lift, lift, 0.04 * size], theme.steel);
      }
    }
    scene.angles.filter((each) => !this.steers(each)).forEach((each, k) => {
      const own = multiply(q, turnBy([0, 0, model.read(each)[0]])), high = plus(at, [0, 0, (0.2 + 0.1 * k) * size]);
      drawing.draw("tube", q, at, [0.04 * size, 0.04 * size, (0.2 + 0.1 * k) * size], theme.steel);
      drawing.draw("box", own, high, [0.55 * size, 0.06 * size, 0.04 * size], GOLD);
      const end = plus(high, rotate(own, [0.55 * size, 0, 0]));
      this.label(each.name, end, "orange");
      this.knob(each, high, end);
    });
    scene.angles.filter((each) => this.steers(each)).forEach((each) => {
      if (!wheels[0]) return;
      const middle = plus(at, rotate(q, [wheels[0].at, 0, 0.08 * size]));
      this.label(each.name, plus(middle, [0, 0, 0.08 * size]));
      this.knobs.push({ angle: each, at: middle });
    });
  }
  sample() { this.trail("path").add([this.model.rest[this.rows.x], this.model.rest[this.rows.y], 0.01 * this.size], 0.01 * this.size); }
  /* A knob at the end of something that turns with an angle about a pivot. */
  knob(angle, pivot, end) {
    this.knobs.push({ angle, pivot, at: end, frame: Math.atan2(end[1] - pivot[1], end[0] - pivot[0]) - this.model.read(angle)[0] });
    this.drawing.draw("sphere", [1, 0, 0, 0], end, Array(3).fill(0.08 * this.size), ORANGE);
  }
  grab(x, y) {
    const near = ({ at }) => { const s = this.drawing.project(at); return s.front && Math.hypot(s.x - x, s.y - y) < 26; };
    const held = this.knobs?.find(near);
    if (!held) return null;
    const { angle, pivot, at, frame } = held;
    let before = this.model.read(angle)[0], last = x;
    return { move: (a, b) => {
      if (pivot) { // the turn nearest to the one before
        const to = minus(this.meet(at, a, b, E[2]), pivot), wanted = Math.atan2(to[1], to[0]) - frame;
        before += Math.atan2(Math.sin(wanted - before), Math.cos(wanted - before));
      } else { before += 0.012 * (a - last); last = a; }
      this.model.write(angle, [before]);
      this.model.ended = "";
      this.model.measure();
    } };
  }
  /* Whether the wheels turn with an angle. */
  steers(angle) {
    if (this.steering?.has(angle.name)) return this.steering.get(angle.name);
    const before = JSON.stringify(this.wheels()), kept = this.model.x[angle.rows[0]];
    this.model.x[angle.rows[0]] = kept + 0.1;
    const found = JSON.stringify(this.wheels()) !== before;
    this.model.x[angle.rows[0]] = kept;
    (this.steering ||= new Map()).set(angle.name, found);
    return found;
  }
}

/* A field: a vector at each point of a ring, whose tips are a moving curve; or a height. */
class FieldScene extends Scene {
  constructor(model, drawing) {
    super(model, drawing);
    this.hint = "Drag the coloured curve, which is the field, to pull it; drag elsewhere to look around";
    this.camera.pitch = 0.5;
    this.camera.distance = 8.2;
    const values = this.curve();
    const lengths = values.map((v) => Math.hypot(...v)), most = Math.max(...lengths, 1e-9);
    this.scale = 1 / most;
    this.length = values[0].length === 3 && Math.min(...lengths) > (1 - 1e-9) * most ? most : 0; // as of spins
  }
  grab(x, y) {
    const away = (this.tips || []).map((p) => { const s = this.drawing.project(p); return s.front ? Math.hypot(s.x - x, s.y - y) : Infinity; });
    const i = away.indexOf(Math.min(...away));
    if (!(away[i] < 18)) return null;
    let at = this.tips[i];
    return { move: (a, b) => { const to = this.meet(at, a, b); this.pull(i, scaled(1 / (0.9 * this.scale), minus(to, at))); at = to; } };
  }
  /* Add a smooth bump about a point; vectors of one length keep it. */
  pull(i, by) {
    const { model } = this, size = scene.members, wide = size / 16;
    this.curve().forEach((v, j) => {
      const far = Math.min(Math.abs(i - j), size - Math.abs(i - j)) / wide, part = Math.exp(-far * far);
      let now = v.length === 3 ? plus(v, scaled(part, by)) : [v[0] + part * by[2]];
      if (this.length) now = scaled(this.length, unit(now));
      scene.curve.forEach((block, k) => { model.x[block * size + j] = now[k]; });
    });
    model.ended = "";
    model.measure();
  }
  curve() {
    const size = scene.members;
    return Array.from({ length: size }, (_, i) => scene.curve.map((block) => this.model.x[block * size + i]));
  }
  draw(theme) {
    const { drawing } = this, values = this.curve(), count = values.length, tips = [], ring = [];
    values.forEach((v, i) => {
      const a = 2 * Math.PI * i / count, out = [Math.cos(a), Math.sin(a), 0], base = scaled(1.6, out);
      ring.push(base);
      const along = v.length === 3 ? v : [0, 0, v[0]];
      tips.push(plus(base, scaled(0.9 * this.scale, along)));
    });
    this.tips = tips;
    drawing.floor(-1.3, 6, 0.5, theme.floor, theme.line, [0, 0, 1.6], [0, 0]);
    drawing.line([...ring, ring[0]], () => [...theme.steel, 1], 4);
    const every = Math.max(1, Math.floor(count / 64));
    for (let i = 0; i < count; i += every) drawing.line([ring[i], tips[i]], (s) => [...hue(i / count), 0.25 + 0.6 * s], 2);
    drawing.line([...tips, tips[0]], (s) => [...hue(s), 1], 4.5);
    this.label(scene.tables.state[0].name, plus(tips[0], [0.15, 0, 0.1]));
  }
}
/* Colours around a ring that readers without one kind of cone tell apart by their lightness. */
function hue(s) {
  const a = 2 * Math.PI * s;
  return [0.52 + 0.38 * Math.cos(a), 0.50 + 0.16 * Math.cos(a - 1.4), 0.50 - 0.32 * Math.cos(a + 0.3)];
}

const SCENES = { body: BodyScene, rolling: RollingScene, planar: PlanarScene, strand: FieldScene, profile: FieldScene };
