// Numerics: vectors, quaternions, and steps of a motion. A quaternion is [real, x, y, z].
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const scaled = (s, a) => [s * a[0], s * a[1], s * a[2]];
const plus = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
const minus = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const norm = (a) => Math.hypot(a[0], a[1], a[2]);
const unit = (a) => (norm(a) > 0 ? scaled(1 / norm(a), a) : [0, 0, 1]);
const clamp = (v, low, high) => Math.min(Math.max(v, low), high);
const E = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];

const multiply = (p, q) => [
  p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3],
  p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2],
  p[0] * q[2] - p[1] * q[3] + p[2] * q[0] + p[3] * q[1],
  p[0] * q[3] + p[1] * q[2] - p[2] * q[1] + p[3] * q[0],
];
const conjugate = (q) => [q[0], -q[1], -q[2], -q[3]];
const normal = (q) => { const s = 1 / Math.hypot(...q); return q.map((v) => s * v); };
const rotate = (q, v) => multiply(multiply(q, [0, ...v]), conjugate(q)).slice(1);
/* The rotation by the angle |v| about v. */
const turnBy = (v) => {
  const angle = norm(v), s = angle > 1e-12 ? Math.sin(angle / 2) / angle : 0.5;
  return [Math.cos(angle / 2), ...scaled(s, v)];
};
/* The shortest rotation of one direction to another. */
const turnOnto = (a, b) => {
  const u = unit(a), v = unit(b), c = dot(u, v);
  if (c < -1 + 1e-12) return [0, ...unit(Math.abs(u[0]) < 0.9 ? cross(u, E[0]) : cross(u, E[1]))];
  return normal([1 + c, ...cross(u, v)]);
};

const GAUSS4 = Math.sqrt(3) / 6;
const IMPLICIT = {
  midpoint: { a: [[0.5]], b: [1] },
  gauss4: { a: [[0.25, 0.25 - GAUSS4], [0.25 + GAUSS4, 0.25]], b: [0.5, 0.5] },
};
const SWEEPS = 60;

/* Steps of one motion. `rates(x, out)` are its rates; a step changes the state in place. */
class Stepper {
  constructor(size, rates, method, spheres, flow) {
    Object.assign(this, { size, rates, method, spheres, flow });
    this.work = Array.from({ length: 8 }, () => new Float64Array(size));
    this.wide = new Float64Array(2 * size);
  }

  step(x, h) {
    if (this.method.schedule.length) this.compose(x, h);
    else if (this.method.name === "spherical_midpoint") this.roundMidpoint(x, h);
    else if (this.method.name === "isospectral_midpoint") this.turnMatrix(x, h);
    else if (IMPLICIT[this.method.name]) this.collocate(x, h, IMPLICIT[this.method.name]);
    else this.explicit(x, h);
  }

  /* A product of flows of parts of the energy, each the generated function of its name. */
  compose(x, h) {
    const rise = this.work[0];
    for (const [flow, part] of this.method.schedule) {
      this.wide.set(x);
      this.wide[this.size] = part * h;
      this.flow(flow, this.wide, rise);
      for (let i = 0; i < this.size; i++) x[i] += rise[i];
    }
  }

  /* W = w + h [X, V], X = w + h/2 [X, V] + h^2/4 V X V, V that of X; the last product is a function of the kernel. */
  turnMatrix(x, h) {
    const [middle, rates, xi, both] = this.work, n = this.size;
    middle.set(x);
    for (let sweep = 0, change = 1; sweep < SWEEPS && change > 0; sweep++) {
      this.rates(middle, rates);
      this.flow("energy_gradient", middle, xi);
      this.wide.set(middle);
      for (let i = 0; i < n; i++) this.wide[n + i] = 0.5 * h * xi[i];
      this.flow("sandwich", this.wide, both);
      change = 0;
      for (let i = 0; i < n; i++) {
        const next = x[i] + (0.5 * h * rates[i] + both[i]);
        if (Math.abs(next - middle[i]) > 4e-16 * (Math.abs(next) + 1)) change = 1;
        middle[i] = next;
      }
    }
    for (let i = 0; i < n; i++) x[i] += h * rates[i];
  }

  /* The classical method of Runge and Kutta. */
  explicit(x, h) {
    const [k1, k2, k3, k4, y] = this.work, n = this.size;
    this.rates(x, k1);
    for (let i = 0; i < n; i++) y[i] = x[i] + 0.5 * h * k1[i];
    this.rates(y, k2);
    for (let i = 0; i < n; i++) y[i] = x[i] + 0.5 * h * k2[i];
    this.rates(y, k3);
    for (let i = 0; i < n; i++) y[i] = x[i] + h * k3[i];
    this.rates(y, k4);
    for (let i = 0; i < n; i++) x[i] += (h / 6) * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i]);
  }

  /* A method of Gauss: sweeps until no stage changes by more than rounding, from the slopes of the step before. */
  collocate(x, h, { a, b }) {
    const n = this.size, s = b.length, stages = this.work.slice(0, s), slopes = this.work.slice(s, 2 * s), next = this.work[2 * s];
    for (let k = 0; k < s; k++) this.add(stages[k], x, h, a[k], slopes);
    for (let sweep = 0, change = 1; sweep < SWEEPS && change > 0; sweep++) {
      for (let k = 0; k < s; k++) this.rates(stages[k], slopes[k]);
      change = 0;
      for (let k = 0; k < s; k++) {
        const stage = stages[k];
        this.add(next, x, h, a[k], slopes);
        for (let i = 0; i < n && !change; i++) if (!(Math.abs(next[i] - stage[i]) <= 4e-16 * (Math.abs(next[i]) + 1))) change = 1;
        stage.set(next);
      }
    }
    this.add(x, x, h, b, slopes);
    if (!x.every(Number.isFinite)) for (const slope of slopes) slope.fill(0); // nothing to begin another step from
  }
  /* x + h times a sum of slopes. */
  add(out, x, h, weights, slopes) {
    out.set(x);
    for (let j = 0; j < weights.length; j++) {
      const slope = slopes[j], w = h * weights[j];
      for (let i = 0; i < out.length; i++) out[i] += w * slope[i];
    }
  }

  /* W = w + h X(r (w + W)/|w + W|) on each sphere, of dual numbers w where it has a tangent. */
  roundMidpoint(x, h) {
    const [end, middle, rates] = this.work, n = this.size;
    end.set(x);
    for (let sweep = 0, change = 1; sweep < SWEEPS && change > 0; sweep++) {
      for (let i = 0; i < n; i++) middle[i] = 0.5 * (x[i] + end[i]);
      for (const [rows, tangent] of this.spheres) this.stretch(x, middle, rows, tangent);
      this.rates(middle, rates);
      change = 0;
      for (let i = 0; i < n; i++) {
        const next = x[i] + h * rates[i];
        if (Math.abs(next - end[i]) > 4e-16 * (Math.abs(next) + 1)) change = 1;
        end[i] = next;
      }
    }
    x.set(end);
  }

  stretch(x, middle, rows, tangent) {
    const pick = (array, places) => places.map((place) => array[place]);
    const w = pick(x, rows), c = pick(middle, rows), a = dot(w, w), A = dot(c, c);
    if (!(a > 0 && A > 0)) return;
    const scale = Math.sqrt(a / A);
    if (tangent.length) {
      const slope = scale * (dot(w, pick(x, tangent)) / a - dot(c, pick(middle, tangent)) / A);
      tangent.forEach((place, k) => { middle[place] = scale * middle[place] + slope * c[k]; });
    }
    rows.forEach((place, k) => { middle[place] = scale * c[k]; });
  }
}
