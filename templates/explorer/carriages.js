// Carriages: vehicles in the plane whose constraints are solved, so that some velocities follow from others.

/* The frame has a wheel where no motion moves it sideways; a carriage trails at an angle that turns as a trailer does. */
class CarriageScene extends PlanarScene {
  constructor(model, drawing) {
    super(model, drawing);
    this.links = this.findLinks();
    this.size = 0.8 * Math.max(0.1, ...this.wheels().map((w) => Math.abs(w.at)), ...this.links.map((each) => Math.max(Math.abs(each.joint), each.length)));
    this.camera.distance = 8 * this.size;
    this.hint = this.links.length ? "Drag the golden carriage to turn it; drag the floor to look around" : "Drag to look around; wheels stand where the constraints put them";
  }
  /* What a variable of the state or of the observables is, for each free velocity of one. */
  slopes(variable, change = () => {}) {
    const { model } = this, x = Float64Array.from(model.x);
    change(x);
    const at = (own) => { scene.free.forEach((row, k) => { x[row] = own === k ? 1 : 0; }); return model.read(variable, x)[0]; };
    const zero = at(-1);
    return scene.free.map((_, k) => at(k) - zero);
  }
  wheels() {
    if (scene.free.length !== 2) return [];
    const rows = scene.frame.map((each) => this.slopes(each)), [a, b, turn] = cross(rows.map((r) => r[0]), rows.map((r) => r[1]));
    return Math.abs(b) > 1e-9 ? [{ at: turn / b, angle: -Math.atan(a / b) }] : [];
  }
  /* Which reconstructed rows are the place and the direction: those with the rates of the frame where the direction is 0. */
  order() {
    const { model } = this, x = Float64Array.from(model.x);
    scene.free.forEach((row, k) => { x[row] = 0.37 + 0.61 * k; });
    const rates = [...model.call("reconstruction", Float64Array.from([...x, 0, 0, 0]), new Float64Array(3))];
    const [along, , turning] = scene.frame.map((each) => model.read(each, x)[0]), is = (v) => rates.findIndex((rate) => Math.abs(rate - v) < 1e-9);
    const turn = is(turning), first = is(along);
    this.rows = { turn, x: first, y: [0, 1, 2].find((k) => k !== turn && k !== first) };
  }
  /* The rate of a trailer's angle is -(sin(angle) v + omega (length - joint cos(angle)))/length. */
  findLinks() {
    this.order();
    if (!this.wheels().some((w) => Math.abs(w.at) < 1e-9)) return [];
    return scene.turns.flatMap(({ angle, rate }) => {
      const [along, , turning] = scene.frame, found = [0, 0.7, 1.6, 3, 4.4].map((value) => {
        const set = (x) => { x[angle.rows[0]] = value; };
        const [a, b] = this.slopes(along, set), [c, d] = this.slopes(turning, set), [p, q] = this.slopes(rate, set), by = a * d - b * c;
        return [value, (p * d - q * c) / by, (q * a - p * b) / by]; // per velocity along, and per turning
      });
      const length = -Math.sin(0.7) / found[1][1], joint = (found[0][2] + 1) * length;
      const fits = found.every(([v, a, t]) => Math.abs(a * length + Math.sin(v)) < 1e-9 && Math.abs(t + 1 - joint / length * Math.cos(v)) < 1e-9);
      return fits && length > 0 ? [{ angle, length, joint }] : [];
    });
  }
  moving() { this.links = this.findLinks(); }
  draw(theme) {
    const { model, drawing, size, rows } = this, r = model.rest, q = turnBy([0, 0, r[rows.turn]]), at = [r[rows.x], r[rows.y], 0.16 * size];
    this.follow(at);
    drawing.floor(0, 24 * size, size, theme.floor, theme.line, [at[0], at[1], size], at);
    this.sample();
    drawing.line(this.trail("path").points, fade(ORANGE), 3);
    const ends = [0, ...this.wheels().map((w) => w.at), ...this.links.map((each) => each.joint)];
    this.beam(q, at, Math.min(...ends), Math.max(...ends), theme.body);
    for (const wheel of this.wheels()) this.axle(multiply(q, turnBy([0, 0, wheel.angle])), plus(at, rotate(q, [wheel.at, 0, 0])), theme);
    this.knobs = [];
    for (const { angle, length, joint } of this.links) {
      const own = multiply(q, turnBy([0, 0, model.read(angle)[0]])), hinge = plus(at, rotate(q, [joint, 0, 0]));
      this.beam(own, hinge, -length, 0, GOLD);
      const end = plus(hinge, rotate(own, [-length, 0, 0]));
      this.axle(own, end, theme);
      this.knob(angle, hinge, plus(end, [0, 0, 0.06 * size]));
      drawing.draw("tube", q, minus(hinge, [0, 0, 0.05 * size]), [0.05 * size, 0.05 * size, 0.2 * size], theme.steel);
      this.label(angle.name, plus(hinge, [0, 0, 0.25 * size]), "orange");
    }
  }
  beam(q, at, from, to, tint) {
    const half = (to - from) / 2;
    this.drawing.draw("box", q, plus(at, rotate(q, [(from + to) / 2, 0, 0])), [half + 0.08 * this.size, 0.09 * this.size, 0.03 * this.size], tint);
  }
  axle(q, at, theme) {
    const { drawing, size } = this;
    for (const side of [-1, 1])
      drawing.draw("tube", multiply(q, turnOnto(E[2], E[1])), plus(at, rotate(q, [0, side * 0.2 * size - 0.02 * size, -0.06 * size])), [0.1 * size, 0.1 * size, 0.04 * size], theme.steel);
  }
}

SCENES.carriage = CarriageScene;
