// Matrices: the functions on a torus or a sphere that real matrices stand for.
const SPHERE = 64; // latitudes at which values are computed

/* Functions on the torus: i times a sum of matrices of waves, of N rows. */
class MatrixOnTorus {
  constructor(n) {
    Object.assign(this, { n, circle: new Circle(n), counts: [n, n] });
    [this.re, this.im] = [new Float64Array(n * n), new Float64Array(n * n)];
  }
  show(x) {
    const { n, re, im } = this;
    for (let i = 0; i < n; i++) for (let k2 = 0; k2 < n; k2++) { // by x and by k2
      const j = (i + k2) % n, at = ((2 * i + k2) % n) * n + k2, a = x[i * n + j], b = x[j * n + i];
      re[at] = 0.5 * (a + b);
      im[at] = -0.5 * (a - b);
    }
    for (let i = 0; i < n; i++) this.circle.transform(re, im, i * n, 1, 1);
    return re;
  }
}

/* Functions on the sphere: sums of harmonics by the weights that entries of a diagonal have. */
class MatrixOnSphere {
  constructor(n, towers) {
    Object.assign(this, { n, towers, counts: [2 * SPHERE, SPHERE] }); // longitudes, then latitudes
    const z = Float64Array.from({ length: SPHERE }, (_, k) => Math.sin(Math.PI * ((k + 0.5) / SPHERE - 0.5)));
    this.legendre = towers.map((_, order) => this.listLegendre(z, order, n - order));
    this.values = new Float64Array(2 * SPHERE * SPHERE);
  }
  /* Harmonics of an order at the longitude 0, degree by degree, by the recurrence over degrees. */
  listLegendre(z, order, count) {
    let first = z.map(() => Math.sqrt(1 / (4 * Math.PI)));
    for (let m = 1; m <= order; m++) first = first.map((v, k) => v * Math.sqrt((2 * m + 1) / (2 * m) * (1 - z[k] * z[k])));
    const found = [first, first.map((v, k) => Math.sqrt(2 * order + 3) * z[k] * v)];
    for (let degree = order + 2; degree < order + count; degree++) {
      const [a, b] = [degree, degree - 1].map((k) => Math.sqrt((4 * k * k - 1) / (k * k - order * order)));
      const [before, last] = found.slice(-2);
      found.push(last.map((v, k) => a * (z[k] * v - before[k] / b)));
    }
    return found.slice(0, count);
  }
  show(x) {
    const { n, towers, values, legendre } = this, share = 4 * Math.PI / n;
    values.fill(0);
    towers.forEach((tower, order) => {
      const half = order ? 1 : 0.5, cosine = new Float64Array(SPHERE), sine = new Float64Array(SPHERE);
      tower.forEach((weights, degree) => {
        let [a, b] = [0, 0];
        weights.forEach((weight, i) => {
          const above = x[i * n + i + order], below = x[(i + order) * n + i];
          a += weight * (above + below);
          b += weight * (above - below);
        });
        const own = legendre[order][degree];
        for (let k = 0; k < SPHERE; k++) { cosine[k] += half * share * a * own[k]; sine[k] += half * share * b * own[k]; }
      });
      for (let i = 0; i < 2 * SPHERE; i++) {
        const angle = order * Math.PI * ((i + 0.5) / SPHERE - 1), c = Math.cos(angle), s = Math.sin(angle);
        for (let k = 0; k < SPHERE; k++) values[i * SPHERE + k] += c * cosine[k] + s * sine[k];
      }
    });
    return values;
  }
}
