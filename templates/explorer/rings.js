// Rings: the implicit midpoint of a field around a circle, whose sweeps are directed by the linear part about its mean.

/* The inverse of a complex matrix, rows of [real, imaginary] in turn, by elimination with the largest pivot. */
function invert(matrix, n) {
  const rows = matrix.map((row, i) => [...row, ...Array.from({ length: 2 * n }, (_, j) => (j === 2 * i ? 1 : 0))]), wide = 2 * n;
  for (let c = 0; c < n; c++) {
    let best = c;
    for (let r = c; r < n; r++) if (Math.hypot(rows[r][2 * c], rows[r][2 * c + 1]) > Math.hypot(rows[best][2 * c], rows[best][2 * c + 1])) best = r;
    [rows[c], rows[best]] = [rows[best], rows[c]];
    const own = rows[c], a = own[2 * c], b = own[2 * c + 1], size = a * a + b * b;
    for (let j = 0; j < wide; j++) { const [u, v] = [own[2 * j], own[2 * j + 1]]; own[2 * j] = (u * a + v * b) / size; own[2 * j + 1] = (v * a - u * b) / size; }
    rows.forEach((row, r) => {
      if (r === c) return;
      const [u, v] = [row[2 * c], row[2 * c + 1]];
      for (let j = 0; j < wide; j++) { row[2 * j] -= u * own[2 * j] - v * own[2 * j + 1]; row[2 * j + 1] -= u * own[2 * j + 1] + v * own[2 * j]; }
    });
  }
  return rows.map((row) => row.slice(2 * n));
}

/* Steps of blocks of points around a circle. `jacobian(x, v, out)` is the derivative of the rates along a vector. */
class RingMidpoint {
  constructor(points, blocks, rates, jacobian) {
    Object.assign(this, { points, blocks, rates, jacobian, size: points * blocks, circle: new Circle(points), h: 0 });
    [this.middle, this.slope, this.rest, this.im, this.mean, this.last] = Array.from({ length: 6 }, () => new Float64Array(this.size));
  }
  /* Parameters have changed. */
  forget() { this.h = 0; this.last.fill(0); }
  /* What a linear step divides waves by: 1 - h/2 J about the mean of each block, a matrix for each wave. */
  direct(x, h) {
    const { points, blocks, size, circle } = this, unit = new Float64Array(size), columns = [];
    for (let b = 0; b < blocks; b++) this.mean.fill(x.subarray(b * points, (b + 1) * points).reduce((sum, v) => sum + v) / points, b * points, (b + 1) * points);
    for (let b = 0; b < blocks; b++) {
      const re = new Float64Array(size), im = new Float64Array(size);
      unit.fill(0);
      unit[b * points] = 1;
      this.jacobian(this.mean, unit, re);
      for (let c = 0; c < blocks; c++) circle.transform(re, im, c * points, 1, -1);
      columns.push([re, im]);
    }
    this.inverse = Array.from({ length: points }, (_, k) => Float64Array.from(invert(Array.from({ length: blocks }, (_, r) =>
      columns.flatMap(([re, im], c) => [(r === c ? 1 : 0) - 0.5 * h * re[r * points + k], -0.5 * h * im[r * points + k]])), blocks).flat()));
    this.h = h;
  }
  /* Divide a vector of blocks by 1 - h/2 J. */
  divide(v) {
    const { points, blocks, circle, im, inverse } = this, a = new Float64Array(2 * blocks);
    im.fill(0);
    for (let b = 0; b < blocks; b++) circle.transform(v, im, b * points, 1, -1);
    for (let k = 0; k < points; k++) {
      const m = inverse[k];
      for (let b = 0; b < blocks; b++) { a[2 * b] = v[b * points + k]; a[2 * b + 1] = im[b * points + k]; }
      for (let r = 0; r < blocks; r++) {
        let [re, other] = [0, 0];
        for (let c = 0; c < blocks; c++) {
          const at = 2 * (r * blocks + c);
          re += m[at] * a[2 * c] - m[at + 1] * a[2 * c + 1];
          other += m[at] * a[2 * c + 1] + m[at + 1] * a[2 * c];
        }
        v[r * points + k] = re / points;
        im[r * points + k] = other / points;
      }
    }
    for (let b = 0; b < blocks; b++) circle.transform(v, im, b * points, 1, 1);
  }
  /* How many sweeps a step takes; the state is then that after it. 0 where they do not end. */
  step(x, h) {
    const { middle, slope, rest, size } = this;
    if (h !== this.h) this.direct(x, h);
    for (let i = 0; i < size; i++) middle[i] = x[i] + 0.5 * h * this.last[i]; // as the step before went on
    let last = Infinity;
    for (let sweep = 1; sweep <= SWEEPS; sweep++) {
      this.rates(middle, slope);
      for (let i = 0; i < size; i++) rest[i] = x[i] + 0.5 * h * slope[i] - middle[i];
      this.divide(rest);
      let change = 0, most = 0;
      for (let i = 0; i < size; i++) {
        middle[i] += rest[i];
        change = Math.max(change, Math.abs(rest[i]));
        most = Math.max(most, Math.abs(middle[i]));
      }
      if (change <= 1e-15 * most || (change <= 1e-13 * most && change >= 0.5 * last)) {
        for (let i = 0; i < size; i++) { this.last[i] = 2 * (middle[i] - x[i]) / h; x[i] = 2 * middle[i] - x[i]; }
        return sweep;
      }
      if (!(change < 10 * last)) break;
      last = change;
    }
    this.last.fill(0);
    return 0;
  }
}
