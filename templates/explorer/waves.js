// Waves: Fourier series on a circle and on a plane that closes in both directions.

/* Sums over a circle of n points, sum_j z_j exp(sign 2 pi i j k/n), by factors of n: fours, and primes. */
class Circle {
  constructor(n) {
    this.n = n;
    this.cosines = Float64Array.from({ length: n }, (_, k) => Math.cos(2 * Math.PI * k / n));
    this.sines = Float64Array.from({ length: n }, (_, k) => Math.sin(2 * Math.PI * k / n));
    this.factors = [];
    for (let rest = n, p = 4; rest > 1; ) if (rest % p) p = p === 4 ? 2 : p === 2 ? 3 : p + 2; else { this.factors.push(p); rest /= p; }
    // numbers whose sum is made first stand next to each other
    this.order = this.factors.reduce((places, p) => places.flatMap((place) => Array.from({ length: p }, (_, q) => place + q * places.length)), [0]);
    [this.re, this.im] = [new Float64Array(n), new Float64Array(n)];
    this.part = new Float64Array(2 * Math.max(1, ...this.factors));
  }
  /* In place, of n numbers from a place on, one each stride. */
  transform(re, im, from, stride, sign) {
    const { n, factors, order, re: own, im: other } = this;
    for (let k = 0; k < n; k++) { const at = from + order[k] * stride; own[k] = re[at]; other[k] = im[at]; }
    for (let level = factors.length - 1, length = 1; level >= 0; level--) {
      const p = factors[level];
      if (length > 1) this.turn(p, length, sign);
      if (p === 4) this.joinFour(length, sign);
      else this.join(p, length, sign);
      length *= p;
    }
    for (let k = 0, at = from; k < n; k++, at += stride) { re[at] = own[k]; im[at] = other[k]; }
  }
  /* Each of p sums turned to its place in a sum of p times the length. */
  turn(p, length, sign) {
    const { n, re, im, cosines, sines } = this, whole = p * length, step = n / whole;
    for (let q = 1; q < p; q++) for (let k = 1; k < length; k++) {
      const c = cosines[q * k * step], s = sign * sines[q * k * step];
      for (let j = q * length + k; j < n; j += whole) {
        const a = re[j], b = im[j];
        re[j] = a * c - b * s;
        im[j] = a * s + b * c;
      }
    }
  }
  joinFour(length, sign) {
    const { n, re, im } = this;
    for (let first = 0; first < n; first += 4 * length) for (let k = first; k < first + length; k++) {
      const k1 = k + length, k2 = k1 + length, k3 = k2 + length;
      const a = re[k] + re[k2], b = im[k] + im[k2], c = re[k] - re[k2], d = im[k] - im[k2];
      const e = re[k1] + re[k3], f = im[k1] + im[k3], g = sign * (re[k1] - re[k3]), h = sign * (im[k1] - im[k3]);
      re[k] = a + e; im[k] = b + f; re[k1] = c - h; im[k1] = d + g;
      re[k2] = a - e; im[k2] = b - f; re[k3] = c + h; im[k3] = d - g;
    }
  }
  /* Sums of p lengths, of p sums of one length each. */
  join(p, length, sign) {
    const { n, re, im, cosines, sines, part } = this;
    for (let first = 0; first < n; first += p * length) for (let at = first; at < first + length; at++) {
      for (let r = 0; r < p; r++) {
        let a = 0, b = 0;
        for (let q = 0; q < p; q++) {
          const turn = ((q * r) % p) * (n / p), c = cosines[turn], s = sign * sines[turn], j = at + q * length;
          a += re[j] * c - im[j] * s;
          b += re[j] * s + im[j] * c;
        }
        part[2 * r] = a; part[2 * r + 1] = b;
      }
      for (let r = 0; r < p; r++) { re[at + r * length] = part[2 * r]; im[at + r * length] = part[2 * r + 1]; }
    }
  }
}

/* The waves in a plane up to a part of those that its points tell apart; values along the second coordinate stand next to each other. */
class PlaneWaves {
  constructor(counts, most) {
    this.counts = counts;
    this.known = new Map();
    this.circles = counts.map((n) => new Circle(n));
    const [nx, ny] = counts, waves = (n, k) => Array.from({ length: n }, (_, j) => (j < n / 2 ? j : j - n)).map((wave, j) => [j, wave]).filter(([, wave]) => Math.abs(wave) <= k);
    this.columns = waves(ny, most[1]);
    this.kept = waves(nx, most[0]).flatMap(([i, kx]) => this.columns.map(([j, ky]) => [i * ny + j, kx, ky]));
    [this.re, this.im] = [new Float64Array(nx * ny), new Float64Array(nx * ny)];
  }
  /* The waves that are kept of values at the points: real and imaginary parts in turn, in the order of `kept`. */
  transform(values) {
    const { re, im, kept, columns } = this, [nx, ny] = this.counts;
    re.set(values);
    im.fill(0);
    for (let i = 0; i < nx; i++) this.circles[1].transform(re, im, i * ny, 1, -1);
    for (const [j] of columns) this.circles[0].transform(re, im, j, ny, -1);
    const waves = new Float64Array(2 * kept.length);
    for (let k = 0; k < kept.length; k++) { const [at] = kept[k]; waves[2 * k] = re[at]; waves[2 * k + 1] = im[at]; }
    return waves;
  }
  /* Values at the points of one real field, or of two at a time, given by their waves. */
  show(one, two, [first, second]) {
    const { re, im, kept, columns } = this, [nx, ny] = this.counts, share = 1 / (nx * ny);
    re.fill(0);
    im.fill(0);
    for (let k = 0; k < kept.length; k++) { // one + i two, so that both come back apart
      const [at] = kept[k];
      re[at] = one[2 * k] - (two ? two[2 * k + 1] : 0);
      im[at] = one[2 * k + 1] + (two ? two[2 * k] : 0);
    }
    for (const [j] of columns) this.circles[0].transform(re, im, j, ny, 1);
    for (let i = 0; i < nx; i++) this.circles[1].transform(re, im, i * ny, 1, 1);
    for (let at = 0; at < nx * ny; at++) { first[at] = share * re[at]; if (two) second[at] = share * im[at]; }
  }
  /* What a derivative of orders i and j multiplies waves by, without powers of the imaginary unit. */
  multiply([i, j], lengths) {
    const key = [i, j, ...lengths].join();
    if (this.known.size > 64) this.known.clear(); // a hand changes lengths
    if (!this.known.has(key)) {
      const [a, b] = lengths.map((length) => 2 * Math.PI / length), sign = [1, 1, -1, -1][(i + j) % 4];
      this.known.set(key, Float64Array.from(this.kept, ([, kx, ky]) => sign * (a * kx) ** i * (b * ky) ** j));
    }
    return this.known.get(key);
  }
  /* Waves of a derivative of orders i and j, of a plane of some lengths. */
  differentiate(waves, orders, lengths) {
    const factors = this.multiply(orders, lengths), odd = (orders[0] + orders[1]) % 2, found = new Float64Array(waves.length);
    for (let n = 0; n < factors.length; n++) {
      found[2 * n] = factors[n] * (odd ? -waves[2 * n + 1] : waves[2 * n]);
      found[2 * n + 1] = factors[n] * (odd ? waves[2 * n] : waves[2 * n + 1]);
    }
    return found;
  }
}

/* The same trigonometric polynomial at more points. */
class Finer {
  constructor(counts, factor) {
    const most = counts.map((n) => Math.ceil(n / 2) - 1);
    this.coarse = new PlaneWaves(counts, most);
    this.fine = new PlaneWaves(counts.map((n) => factor * n), most);
    this.share = factor * factor;
    this.values = new Float64Array(this.share * counts[0] * counts[1]);
  }
  show(values) {
    const waves = this.coarse.transform(values);
    this.fine.show(waves.map((each) => this.share * each), null, [this.values, null]);
    return this.values;
  }
}

/* A number that an expression in parameters says: nested lists, as `coadjoint.explore.surfaces` makes them. */
function evaluate(tree, p) {
  if (typeof tree === "number") return tree;
  if (!Array.isArray(tree)) return p[tree.row];
  const [operation, a, b] = [tree[0], ...tree.slice(1).map((part) => evaluate(part, p))];
  switch (operation) {
    case "+": return a + b;
    case "-": return a - b;
    case "*": return a * b;
    case "/": return a / b;
    case "^": return a ** b;
    default: return Math[operation](a);
  }
}

/* A field in a plane: kernels at the points, between transforms. Products of two kept waves have no false ones among them. */
class PlaneField {
  constructor({ counts, lengths, derivatives, operator }) {
    Object.assign(this, { counts, lengths, derivatives, operator });
    this.waves = new PlaneWaves(counts, counts.map((n) => Math.floor((n - 1) / 3)));
    this.points = counts[0] * counts[1];
    // the wave of the mean, which a stream function has only where its operator has a term without derivatives
    this.mean = operator.some(([i, j]) => !i && !j) ? -1 : this.waves.kept.findIndex(([at]) => at === 0);
    this.state = new Float64Array(this.points);
  }
  sizes(p) { return this.lengths.map((row) => p[row]); }
  /* Waves of u with sum a_ij D_x^i D_y^j u = w; its mean is 0 where constants are taken to 0. */
  solve(series, p) {
    const { waves, operator } = this, sizes = this.sizes(p), symbol = new Float64Array(waves.kept.length);
    for (const [i, j, factor] of operator) {
      if ((i + j) % 2) continue; // what is imaginary is no part of an inertia
      const value = evaluate(factor, p), own = waves.multiply([i, j], sizes);
      for (let n = 0; n < symbol.length; n++) symbol[n] += value * own[n];
    }
    return series.map((each, n) => (n >> 1 === this.mean ? 0 : each / symbol[n >> 1]));
  }
  call(name, x, p, out) {
    const { waves, points, state } = this, sizes = this.sizes(p), series = waves.transform(x), solved = this.solve(series, p);
    const wide = (this.wide ||= new Float64Array(p.length + points * this.derivatives.length));
    wide.set(p);
    const all = [[series, state], ...this.derivatives.map(([of, i, j], n) => [waves.differentiate(of ? solved : series, [i, j], sizes), wide.subarray(p.length + n * points, p.length + (n + 1) * points)])];
    for (let n = 0; n < all.length; n += 2) waves.show(all[n][0], all[n + 1]?.[0], [all[n][1], all[n + 1]?.[1]]);
    kernel[name](state, wide, points, out);
    if (name === "rhs") waves.show(waves.transform(out), null, [out, null]);
    return out;
  }
  /* A field without the waves that no step moves, and without a mean that no stream function has. */
  trim(x) {
    const series = this.waves.transform(x);
    if (this.mean >= 0) series.fill(0, 2 * this.mean, 2 * this.mean + 2);
    this.waves.show(series, null, [x, null]);
  }
}
