// The model: one system at one state, moved by its generated functions.
const scene = JSON.parse(document.getElementById("scene-data").textContent);
const size = (table) => scene.tables[table].reduce((sum, each) => sum + each.components.length, 0) *
  (scene.members && table === "state" ? scene.members : 1);

/* A name as books write it; of those that the page gives itself, as it stands. */
const WRITTEN = new Map(Object.values(scene.tables).flat().flatMap((each) => [[each.name, each.written], ...each.components.map((name, k) => [name, each.letters[k]])]));
function nameOn(element, name) {
  const [letters, below] = WRITTEN.get(name) || [name, ""];
  element.replaceChildren(letters);
  element.classList.toggle("word", letters.match(/\p{L}/gu)?.length > 1);
  element.classList.toggle("upright", letters.codePointAt(0) > 0xffff); // which is a calligraphic letter
  if (below) { const sub = document.createElement("sub"); sub.textContent = below; element.append(sub); }
}
const LOW = ["\u2080", "\u2081", "\u2082", "\u2083", "\u2084", "\u2085", "\u2086", "\u2087", "\u2088", "\u2089"];
function plainName(name) {
  const [letters, below] = WRITTEN.get(name) || [name, ""];
  return letters + below.replace(/\d/g, (c) => LOW[c]);
}

const AGAIN = 4; // steps after which one is chosen again, as of a disk that falls or of bodies that meet
const MOST_SWEEPS = 16; // of a step of a field
const FIELDS = ["strand", "profile", "surface"];

class Model {
  constructor() {
    this.n = size("state");
    this.x = new Float64Array(this.n);
    this.p = new Float64Array(size("parameters"));
    this.u = new Float64Array(size("inputs"));
    this.y = new Float64Array(size("observables"));
    this.rest = new Float64Array(size("reconstructed"));
    this.clock = new Float64Array(1);
    this.old = new Float64Array(this.n);
    this.half = new Float64Array(this.n);
    this.given = { state: this.x, parameters: this.p, inputs: this.u, time: this.clock };
    this.plane = scene.plane ? new PlaneField(scene.plane) : null;
    const method = scene.methods[0] || { name: scene.noise ? "midpoint" : "rk4", schedule: [], keeps: [] }, rates = (x, out) => this.call("rhs", x, out);
    const spheres = method.name === "spherical_midpoint" ? scene.spheres : [];
    this.stepper = scene.noise ? new NoisyMidpoint(this.n, rates, (x, out) => this.call("noise", x, out), scene.noise, spheres)
      : this.isRing(method) ? new RingMidpoint(scene.members, this.n / scene.members, rates, (x, v, out) => this.call("jacobian_vector", Float64Array.from([...x, ...v]), out))
      : new Stepper(this.n, rates, method, scene.spheres, (flow, x, out) => this.call(flow, x, out));
    this.method = method;
    this.coarse = scene.noise ? 0 : method.name === "rk4" ? 1 : ["particles", "members"].includes(scene.kind) ? 4 : 0; // the factor within which a step stays
    for (const table of ["parameters", "inputs"]) this.fill(table, table === "inputs" ? this.u : this.p);
    this.position = [0, 0, 0];
    this.attitude = [1, 0, 0, 0];
    this.begin();
    scene.slipping = this.findSlip();
    if (scene.slips && !scene.slipping) scene.kind = "body";
  }

  /* Whether it is a field around a circle, of which the linear part may direct a step. */
  isRing(method) { return ["strand", "profile"].includes(scene.kind) && scene.ring && method.name === "midpoint" && this.has("jacobian_vector"); }

  fill(table, array) {
    let row = 0;
    for (const each of scene.tables[table]) each.components.forEach((_, k) => {
      array[row++] = each.default ? each.default[k] : each.positive ? 1 : 0;
    });
  }

  call(name, x, out) {
    if (this.plane) return this.plane.call(name, x, this.p, out);
    if (scene.members) return kernel[name](x, this.p, scene.members, out);
    const names = scene.takes[name] || scene.takes.rhs;
    return kernel[name](...names.map((each) => (each === "state" ? x : this.given[each])), out);
  }

  has(name) { return scene.functions.includes(name); }
  energyAt(x) { return this.call("energy", x, this.one ||= new Float64Array(1))[0]; }
  observe() { if (this.has("observables")) this.call("observables", this.x, this.y); }

  /* A variable's components: of a state, or what the kernel says of them. */
  read(variable, x = this.x) {
    if (variable.table === "state") return variable.rows.map((row) => x[row]);
    if (variable.table === "reconstructed") return variable.rows.map((row) => this.rest[row]);
    const y = x === this.x ? this.y : this.call("observables", x, this.spare ||= new Float64Array(this.y.length));
    return variable.rows.map((row) => y[row]);
  }
  write(variable, values, x = this.x) { variable.rows.forEach((row, k) => { x[row] = values[k]; }); }

  /* The first state: defaults of the spec, and a plain motion where it has none. */
  begin() {
    let row = 0;
    const missing = [];
    for (const each of scene.tables.state) {
      const members = scene.members || 1;
      for (let k = 0; k < each.components.length * members; k++, row++) {
        this.x[row] = each.default ? each.default[k] : 0;
        if (!each.default) missing.push(row);
      }
    }
    if (missing.length && scene.kind === "particles") this.beginParticles(new Set(missing));
    else if (missing.length && scene.turning) this.beginBody(new Set(missing));
    else if (scene.shape === "frames") missing.forEach((place) => { // frames that stand alike
      const at = scene.place.indexOf(Math.floor(place / scene.members)), wide = scene.place.length / 3;
      this.x[place] = at >= 0 && Math.floor(at / wide) === at % wide ? 1 : 0;
    });
    else if (missing.length && this.plane) { // eddies that turn against each other
      const [a, b] = scene.plane.counts;
      missing.forEach((place) => { const u = 2 * Math.PI * Math.floor(place / b) / a, v = 2 * Math.PI * (place % b) / b; this.x[place] = Math.cos(2 * v) + 0.5 * Math.cos(u) + 0.3 * Math.sin(u + v); });
    } else if (scene.members) missing.forEach((place) => { // one smooth wave for each component
      const block = Math.floor(place / scene.members), s = 2 * Math.PI * (place % scene.members) / scene.members;
      this.x[place] = 0.5 + 0.4 * Math.cos(s + 2 * block);
    });
    else missing.forEach((place, k) => { this.x[place] = [1, 0.4, 0.7, 0.2][k % 4]; });
    this.settle();
  }

  beginParticles(missing) {
    scene.places.forEach((place, k) => {
      const speed = scene.speeds[k], apart = 1 + k;
      if (!place || !missing.has(place.rows[0])) return;
      this.write(place, [apart, 0.1 * k, 0]);
      if (!speed || !missing.has(speed.rows[0])) return;
      this.write(speed, [0, 0, 0]);
      this.call("rhs", this.x, this.half);
      const pull = Math.hypot(...speed.rows.map((row) => this.half[row]));
      const fast = Math.sqrt((pull || 1) * apart);
      this.write(speed, [0, 0.8 * fast, 0.35 * fast]);
    });
  }

  beginBody(missing) {
    const driven = this.u.length > 0, { spinning, pushing, vertical } = scene;
    const free = (variable) => variable && variable.table === "state" && missing.has(variable.rows[0]);
    if (scene.attitude && free(scene.attitude)) this.write(scene.attitude, [1, 0, 0, 0]);
    let weight = [0, 0, 0];
    if (free(vertical)) {
      this.write(vertical, [0, 0, 1]);
      weight = this.weight();
      const lean = norm(weight) > 0 ? rotate(turnBy([0.5, 0, 0]), [0, 0, 1]) : [0, 0, 1];
      this.write(vertical, rotate(turnOnto([0, 0, 1], unit(norm(weight) > 0 ? weight : E[2])), lean));
    }
    if (free(spinning) && !driven) {
      const inertia = this.inertia(), heavy = norm(weight);
      if (heavy > 0) {
        const axis = unit(weight), about = dot(axis.map((a, k) => a * inertia[k]), axis);
        this.write(spinning, plus(scaled(Math.sqrt(10 * about * heavy), axis), scaled(0.02 * about, [1, 1, 1])));
      } else {
        const sorted = [0, 1, 2].sort((a, b) => inertia[a] - inertia[b]);
        this.write(spinning, [0, 1, 2].map((k) => inertia[k] * (k === sorted[1] ? 2 : 0.15)));
      }
    }
    if (free(pushing) && !driven) {
      const mass = this.inertia(pushing, scene.moving);
      this.write(pushing, [0.25, 0.15, 0.6].map((v, k) => v * mass[k]));
    }
  }

  /* The slope of the energy by the vertical, all else at rest: the direction of the weight's arm. */
  weight() {
    const { vertical } = scene;
    if (!vertical || vertical.table !== "state") return [0, 0, 0];
    const at = (v) => {
      this.half.set(this.x);
      for (const each of [scene.spinning, scene.pushing, scene.turning])
        if (each && each.table === "state") this.write(each, [0, 0, 0], this.half);
      this.write(vertical, v, this.half);
      return this.energyAt(this.half);
    };
    if (!this.has("energy")) return [0, 0, 0];
    const found = E.map((axis) => (at(axis) - at(scaled(-1, axis))) / 2);
    return found.every(Number.isFinite) ? found : [0, 0, 0];
  }

  /* Momenta of unit velocities, by the linear part of the velocity of each momentum. */
  inertia(momentum = scene.spinning, velocity = scene.turning) {
    if (!momentum || momentum.table !== "state" || velocity.table !== "observables") return [1, 1, 1];
    return E.map((axis, k) => {
      this.half.set(this.x);
      this.write(momentum, axis, this.half);
      const one = this.read(velocity, this.half)[k];
      this.write(momentum, [0, 0, 0], this.half);
      const slope = one - this.read(velocity, this.half)[k];
      return slope > 0 ? 1 / slope : 1;
    });
  }

  /* The velocity of the body's point at a contact that slides, among vectors that may be it. */
  findSlip() {
    const x = Float64Array.from(this.x), { turning, moving, vertical } = scene, up = [0.48, 0.6, 0.64];
    const at = (each, w, v) => { this.write(vertical, up, x); this.write(turning, w, x); this.write(moving, v, x); return this.read(each, x); };
    const near = (a, b) => norm(minus(a, b)) < 1e-9;
    return (scene.slips || []).find((each) => {
      const [a, b, c] = E.map((axis) => at(each, axis, [0, 0, 0])), arm = [b[2], c[0], a[1]].map((v) => -v);
      const w = [0.3, -0.7, 0.5], v = [0.2, 0.9, -0.4], found = at(each, w, v), bound = this.call("constraint_residual", x, new Float64Array(1))[0];
      return near(found, minus(v, cross(w, scaled(-1, arm)))) && Math.abs(bound - dot(up, found)) < 1e-9;
    });
  }

  /* The arm from the point of contact to the centre: Y = Omega x s is linear in Omega. */
  arm(up) {
    this.half.set(this.x);
    this.write(scene.vertical, up, this.half);
    this.write(scene.turning, E[0], this.half);
    if (scene.slipping) this.write(scene.moving, [0, 0, 0], this.half); // the slip is Y - Omega x s
    const of = scene.slipping || scene.moving, sign = scene.slipping ? -1 : 1, first = this.read(of, this.half);
    this.write(scene.turning, E[1], this.half);
    const second = this.read(of, this.half);
    return scaled(sign, [-second[2], first[2], second[0]]);
  }

  /* Put a state that a hand has moved back on its constraints. */
  settleOn() { if (this.has("projection")) this.call("projection", this.x.slice(), this.x); }

  /* What goes with a state: the attitude, step, and integrals that its drift is measured from. */
  settle() {
    this.clock[0] = 0;
    if (scene.noise) this.stepper.restart();
    this.ended = "";
    this.settleOn();
    let row = 0;
    for (const each of scene.tables.reconstructed) {
      const up = each.upright && scene.vertical ? this.read(scene.vertical) : null;
      const start = each.default || (each.quaternion ? (up ? turnOnto(up, E[2]) : [1, 0, 0, 0]) : each.components.map(() => 0));
      for (const value of start) this.rest[row++] = value;
    }
    this.position = [0, 0, 0];
    this.attitude = scene.vertical ? turnOnto(this.read(scene.vertical), E[2]) : [1, 0, 0, 0];
    this.observe();
    this.find();
    this.measure();
  }

  measure() {
    this.observe();
    let row = 0;
    this.integrals = [];
    for (const each of scene.tables.observables) {
      const rows = each.components.map(() => row++);
      if (each.conserved) this.integrals.push({ name: each.name, doc: each.doc, unit: each.units[0], rows, first: rows.map((r) => this.y[r]) });
    }
  }

  drift({ rows, first }) {
    const most = Math.max(...first.map(Math.abs)), big = most > 1e-9 ? most : 1; // of what is zero, the drift itself
    return Math.max(...rows.map((row, k) => Math.abs(this.y[row] - first[k]))) / big;
  }

  /* A step from how fast nearby motions part; with noise a power of two, so that it is easily said. */
  find() {
    const rate = this.findRate((x, out) => this.call("rhs", x, out));
    const [part, most] = FIELDS.includes(scene.kind) ? [0.12, 0.05] : [0.04, 0.02]; // of many rows; their fastest waves are those of two points' length
    this.h = clamp(part / (rate || 1), 1e-6, most);
    this.steps = 0;
    if (this.stepper instanceof RingMidpoint) { this.stepper.forget(); this.findStep(); }
    if (!scene.noise) return;
    const { slopes } = this.stepper, count = scene.noise.processes.length;
    const noisy = this.findRate((x, out) => { // increments grow with the root of a step
      this.call("noise", x, slopes);
      for (let i = 0; i < this.n; i++) out[i] = slopes.subarray(i * count, (i + 1) * count).reduce((sum, each) => sum + each);
    });
    this.h = 2 ** Math.floor(Math.log2(Math.min(this.h, 0.04 / (noisy * noisy || 1))));
  }

  findAgain() {
    const h = this.h;
    this.find();
    if (h / this.coarse < this.h && this.h < h * this.coarse) this.h = h; // what a method keeps, it keeps with equal steps
  }

  /* The longest step at which a field moves by a small part, and few sweeps are needed. */
  findStep() {
    const rates = this.call("rhs", this.x, new Float64Array(this.n)), least = this.h;
    this.h = clamp(0.04 * (Math.hypot(...this.x) || 1) / (Math.hypot(...rates) || 1), least, 0.02);
    for (let found = 0; this.h > least; this.h = Math.max(0.5 * this.h, least)) {
      found = this.stepper.step(this.x.slice(), this.h);
      if (found && found <= MOST_SWEEPS) return;
    }
  }

  /* The rate of what a function says of a state, by repeated differences. */
  findRate(rates) {
    const base = new Float64Array(this.n), other = new Float64Array(this.n);
    rates(this.x, base);
    let v = Float64Array.from(base, (each, k) => each + 1e-3 * Math.sin(k + 1)), rate = 0;
    const scale = Math.max(...this.x.map(Math.abs), 1e-3);
    for (let round = 0; round < 12; round++) {
      const length = Math.hypot(...v) || 1, little = (1e-6 * scale) / length;
      rates(this.x.map((each, k) => each + little * v[k]), other);
      const next = other.map((each, k) => (each - base[k]) / little);
      rate = Math.max(rate * 0.7, Math.hypot(...next) / length);
      v = next;
    }
    const own = Math.hypot(...base) / (Math.hypot(...this.x) || 1);
    return Math.max(rate, own);
  }

  step(h) {
    this.old.set(this.x);
    let solved = this.stepper.step(this.x, h);
    if (solved === 0) { this.find(); h = this.h; solved = this.stepper.step(this.x, h); } // shorter, as the motion has become
    if (solved === false || solved === 0) return this.end("the equation of a step");
    if (this.coarse && ++this.steps >= AGAIN) this.findAgain();
    this.settleOn();
    if (!this.x.every(Number.isFinite)) return this.end("rates without value");
    if (scene.domain.length) {
      const rows = this.call("domain", this.x, this.bounds ||= new Float64Array(scene.domain.length));
      const left = scene.domain.findIndex((each, k) => !(each.strict ? rows[k] > 0 : rows[k] >= 0));
      if (left >= 0) return this.end(scene.domain[left].name);
    }
    if (scene.noise) this.half.set(this.stepper.middle);
    else for (let i = 0; i < this.n; i++) this.half[i] = 0.5 * (this.old[i] + this.x[i]);
    if (this.rest.length) this.follow(h);
    else if (scene.turning && !scene.attitude) {
      const q = this.attitude, w = this.readSpeed(scene.turning, scene.spinning);
      const half = () => 0.5 * h * (scene.spinning ? this.stepper.stretchOf(scene.spinning.rows) : 1);
      this.attitude = normal(multiply(q, scene.noise ? [1, ...scaled(half(), w)] : turnBy(scaled(h, w)))); // midpoints turn by Cayley's transform
    }
    if (scene.moving && (scene.kind === "body" || scene.slipping))
      this.position = plus(this.position, scaled(h, rotate(this.pose(), this.readSpeed(scene.moving, scene.pushing))));
    this.clock[0] += h;
    return true;
  }

  /* A velocity in the middle of a step, with its noise: the derivatives of the Hamiltonians of noise by its momentum. */
  readSpeed(velocity, momentum) {
    const drift = this.read(velocity, this.half);
    if (!scene.noise || !momentum || !this.has("noise_gradient")) return drift;
    const { numbers } = this.stepper, slopes = this.call("noise_gradient", this.half, new Float64Array(this.n * numbers.length));
    return drift.map((v, i) => numbers.reduce((sum, each, k) => sum + slopes[momentum.rows[i] * numbers.length + k] * each, v));
  }

  end(why) { this.x.set(this.old); this.ended = why; return false; }

  /* What is reconstructed, by the middle of the step. */
  follow(h) {
    const joined = (x, rest) => Float64Array.from([...x, ...rest]);
    const k = this.call("reconstruction", joined(this.old, this.rest), new Float64Array(this.rest.length));
    const middle = this.rest.map((each, i) => each + 0.5 * h * k[i]);
    this.call("reconstruction", joined(this.half, middle), k);
    for (let i = 0; i < k.length; i++) this.rest[i] += h * k[i];
    const place = this.quaternionRows();
    if (place) {
      const q = normal(place.map((row) => this.rest[row]));
      place.forEach((row, i) => { this.rest[row] = q[i]; });
    }
  }

  quaternionRows() {
    let row = 0;
    for (const each of scene.tables.reconstructed) {
      if (each.quaternion) return each.components.map((_, k) => row + k);
      row += each.components.length;
    }
    return null;
  }

  /* The attitude, from body to space. Where a vertical is part of the state, it stands upright. */
  pose() {
    const rows = this.quaternionRows();
    const q = scene.attitude ? normal(this.read(scene.attitude)) : rows ? rows.map((row) => this.rest[row]) : this.attitude;
    if (!scene.vertical) return q;
    const turned = normal(multiply(turnOnto(rotate(q, this.read(scene.vertical)), E[2]), q));
    if (!rows && !scene.attitude) this.attitude = turned;
    return turned;
  }

  /* Take an attitude. */
  stand(q) {
    if (scene.attitude) this.write(scene.attitude, q);
    else this.quaternionRows()?.forEach((row, k) => { this.rest[row] = q[k]; });
    this.attitude = q;
  }

  /* Turn the body by a rotation of space, as a hand does: its momentum in the body stays. */
  turn(rotation) {
    const q = normal(multiply(rotation, this.pose()));
    this.stand(q);
    if (scene.vertical && scene.vertical.table === "state") {
      const length = norm(this.read(scene.vertical)) || 1;
      this.write(scene.vertical, scaled(length, rotate(conjugate(q), E[2])));
    }
    this.ended = "";
    this.measure();
  }
}
