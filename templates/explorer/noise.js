// Noise: normal numbers by seed, step and Wiener process, and midpoints with their increments.
// Words, numbers and steps are those of the library, operation by operation, so that a seed gives the same path.

/* The high and the low 32 bits of a product of two words. */
function multiplyWords(a, b) {
  const low = (a & 0xffff) * b, high = (a >>> 16) * b;
  return [Math.floor((high + Math.floor(low / 65536)) / 65536) >>> 0, Math.imul(a, b) >>> 0];
}
/* Philox4x32: four words from a counter of four words and a key of two. */
function philox([a, b, c, d], [keyA, keyB], { rounds, multipliers, weyl }) {
  for (let n = 0; n < rounds; n++) {
    const [high1, low1] = multiplyWords(a, multipliers[0]), [high2, low2] = multiplyWords(c, multipliers[1]);
    [a, b, c, d] = [(high2 ^ b ^ keyA) >>> 0, low2, (high1 ^ d ^ keyB) >>> 0, low1];
    [keyA, keyB] = [(keyA + weyl[0]) >>> 0, (keyB + weyl[1]) >>> 0];
  }
  return [a, b, c, d];
}
const horner = (coefficients, r) => coefficients.reduceRight((total, each) => total * r + each);
/* Minus the natural logarithm, by operations that round alike everywhere. */
function minusLog(number, { series, log2 }) {
  const real = new Float64Array([number]), words = new Uint32Array(real.buffer); // the low word first, as every browser has it
  let exponent = (words[1] >>> 20) - 1023;
  words[1] = (words[1] & 0xfffff) | 0x3ff00000;
  let [m] = real;
  if (m > 1.4142135623730951) { m *= 0.5; exponent += 1; }
  const s = (m - 1) / (m + 1), log = 2 * s * horner(series, s * s);
  return -(exponent * log2[0]) - (exponent * log2[1] + log);
}
/* The normal number below which others are with a probability. */
function normalOf(probability, tables) {
  const middle = probability - 0.5, r = 0.180625 - middle * middle;
  if (Math.abs(middle) <= 0.425) return middle * horner(tables.middle[0], r) / horner(tables.middle[1], r);
  const root = Math.sqrt(minusLog(probability < 1 - probability ? probability : 1 - probability, tables));
  const [pair, at] = root <= 5 ? [tables.tail, root - 1.6] : [tables.far, root - 5];
  const tail = horner(pair[0], at) / horner(pair[1], at);
  return middle < 0 ? -tail : tail;
}
/* The normal number of a step and a Wiener process: 52 bits of two words and a half are its probability. */
function drawNormal(seed, step, process, tables) {
  const counter = [step >>> 0, Math.floor(step / 2 ** 32), 0, process];
  const [low, high] = philox(counter, [seed >>> 0, Math.floor(seed / 2 ** 32)], tables);
  return normalOf((high * 2 ** 20 + (low >>> 12) + 0.5) * 2 ** -52, tables);
}

/* The quotient of the lengths of a vector and of the half of a sum, by one step of Newton's method for each sweep; of dual
   numbers where there is a tangent. A state is multiplied by it as a start with a rise, so that a middle is rounded once. */
class Scale {
  constructor(x, [rows, tangent], { near, roundings }) {
    Object.assign(this, { rows, tangent, near, roundings, scale: 1, slope: 0, rest: 1 });
    const [square, mixed] = this.measure(x);
    this.half = 0.5 / (square > 0 ? square : 1);
    this.slant = -4 * this.half * this.half * mixed;
    this.empty = square === 0;
  }
  measure(x) {
    const [a, b, c] = this.rows.map((row) => x[row]), square = a * a + b * b + c * c;
    if (!this.tangent.length) return [square, 0];
    const [d, e, f] = this.tangent.map((row) => x[row]);
    return [square, a * d + b * e + c * f];
  }
  isRoot() { return this.empty || (Math.abs(this.rest - 1) < this.near && this.scale > 0); }
  apply(start, rise, x) {
    const { rows, tangent, half, scale, slope, roundings } = this, [square, mixed] = this.measure(x);
    const both = scale * scale, part = half * square, rest = 1.5 - part * both, stays = Math.abs(rest - 1) <= roundings;
    if (tangent.length) {
      const tilt = 2 * half * mixed, lean = (this.slant * square + tilt) * both + 2 * part * scale * slope;
      if (!(stays && Math.abs(lean) <= roundings * Math.abs(tilt))) this.slope = slope * rest - scale * lean;
    }
    this.rest = rest;
    if (!stays) this.scale = scale * rest;
    const beyond = this.scale - 1;
    tangent.forEach((row, k) => { x[row] = start[row] + (rise[row] + (beyond * x[row] + this.slope * x[rows[k]])); });
    for (const row of rows) x[row] = start[row] + (rise[row] + beyond * x[row]);
  }
}

/* The implicit midpoint of `rates + fields (dW/h)`, and on spheres the spherical one; `rates(x, out)` is the drift,
   `fields(x, out)` has a row for each component. */
class NoisyMidpoint {
  constructor(size, rates, fields, tables, spheres = []) {
    Object.assign(this, { size, rates, fields, tables, spheres, seed: 1, made: 0, kept: [] });
    this.numbers = new Float64Array(tables.processes.length);
    this.slopes = new Float64Array(size * this.numbers.length);
    [this.middle, this.next, this.slope, this.chord] = Array.from({ length: 4 }, () => new Float64Array(size));
  }
  /* The same path again, or that of another seed. */
  restart(seed = this.seed) { Object.assign(this, { seed, made: 0 }); }
  /* The rates with the noise of the step. */
  move(x, out) {
    const { size, numbers, slopes } = this, count = numbers.length;
    this.rates(x, out);
    this.fields(x, slopes);
    for (let i = 0; i < size; i++) for (let k = 0; k < count; k++) out[i] += slopes[i * count + k] * numbers[k];
  }
  /* Whether its equation was solved; the state is then that after the step. */
  step(x, h) {
    const { size, tables, middle, slope, next, chord, numbers } = this, half = 0.5 * h;
    const bound = Math.sqrt(4 * Math.max(1, -Math.log(h))); // Milstein, Repin and Tretyakov 2002
    for (let k = 0; k < numbers.length; k++) numbers[k] = clamp(drawNormal(this.seed, this.made, k, tables), -bound, bound) * Math.sqrt(h) / h;
    middle.set(x);
    const kept = this.kept = this.spheres.map((each) => new Scale(x, each, tables));
    let last = Infinity, solved = false;
    for (let sweep = 0; sweep < tables.sweeps; sweep++) {
      this.move(middle, slope);
      for (let i = 0; i < size; i++) next[i] = x[i] + (chord[i] = half * slope[i]);
      for (const each of kept) each.apply(x, chord, next);
      let change = 0, most = 0;
      for (let i = 0; i < size; i++) {
        change = Math.max(change, Math.abs(next[i] - middle[i]));
        most = Math.max(most, Math.abs(next[i]));
      }
      middle.set(next);
      solved = change <= tables.solved * most;
      if (change === 0 || (solved && change >= last)) break;
      last = change;
    }
    if (!solved || !kept.every((each) => each.isRoot())) return false;
    for (let i = 0; i < size; i++) x[i] = kept.length ? x[i] + h * slope[i] : 2 * middle[i] - x[i];
    this.made += 1;
    return true;
  }
  /* By how much the middle of the step is longer than that of its chord, for the vector with these rows. */
  stretchOf(rows) { return this.kept.find((each) => each.rows[0] === rows[0])?.scale ?? 1; }
}
