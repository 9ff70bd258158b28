// Panels: the sphere with its level curves, the section, and the drift of what is conserved.

/* The vector whose sphere is shown, and what its energy is the least over. */
function chooseVector() {
  if (scene.members) return null;
  const [rows, partner] = scene.spheres[0] || [null, []], names = scene.tables.state;
  const found = (places) => { let at = 0; for (const each of names) { if (at === places[0]) return each.name; at += each.components.length; } return ""; };
  if (rows) return { rows, partner, tied: true, name: found(rows), round: true };
  if (scene.vertical && scene.vertical.table === "state") {
    const partnerOf = [scene.spinning, scene.turning].find((each) => each && each.table === "state");
    return { rows: scene.vertical.rows, partner: partnerOf ? partnerOf.rows : [], tied: false, name: scene.vertical.name, round: true };
  }
  if (scene.spinning && scene.spinning.table === "state") return { rows: scene.spinning.rows, partner: [], tied: false, name: scene.spinning.name, round: true };
  const speed = scene.kind === "particles" && scene.speeds[0];
  if (speed && speed.rows.length === 3 && scene.places.length === 1) return { ...speed, partner: [], tied: false, round: false };
  return null;
}

class SpherePanel {
  constructor(model, canvas) {
    Object.assign(this, { model, canvas, vector: chooseVector(), trail: new Trail(), key: "", plane: null, dots: [], run: 0 });
    this.strand = scene.kind === "strand";
    if (!this.vector && !this.strand) return;
    this.drawing = new Drawing(canvas);
    this.camera = { yaw: -0.9, pitch: 0.35, distance: 4.1, target: [0, 0, 0] };
    this.name = this.vector ? this.vector.name : scene.tables.state[0].name;
    this.scale = 1;
    this.last = null;
    this.plotted = false;
    this.past = [];
    this.closed = Boolean(this.vector) && this.vector.round && !this.vector.partner.length && model.n === 3;
    if (this.vector) this.tint = { [scene.spinning?.name]: RED, [scene.turning?.name]: GREEN, [scene.speeds?.[0]?.name]: GREEN }[this.name] || BLUE;
    if (this.vector) this.face();
  }
  /* Look from the side on which the point is, not straight at it. */
  face() {
    const place = !this.vector.round && this.model.read(scene.places[0]);
    const [a, b, c] = unit(place ? cross(place, this.value()) : this.value()); // a curve of velocities, from above its plane
    this.camera.pitch = place ? clamp(Math.asin(c) + 0.1, -1, 1) : clamp(0.25 + 0.55 * c, -0.5, 0.75);
    this.camera.yaw = Math.hypot(a, b) > 0.1 ? Math.atan2(b, a) - 0.45 : -0.9;
  }
  get shown() { return Boolean(this.drawing); }
  value() { return this.model.read({ table: "state", ...this.vector }); }

  /* The least energy at a direction, over momenta with the product that the motion keeps. */
  potential(direction, length, kept) {
    const { model, vector } = this, x = (this.probe ||= new Float64Array(model.n));
    x.set(model.x);
    const w = scaled(length, direction);
    vector.rows.forEach((row, k) => { x[row] = w[k]; });
    if (!vector.partner.length) return model.energyAt(x);
    const at = (m) => { vector.partner.forEach((row, k) => { x[row] = m[k]; }); return model.energyAt(x); };
    const zero = at([0, 0, 0]), ahead = E.map(at), back = E.map((axis) => at(scaled(-1, axis)));
    const g = E.map((_, k) => (ahead[k] - back[k]) / 2), h = E.map((_, k) => ahead[k] + back[k] - 2 * zero);
    const off = (a, b) => at(plus(E[a], E[b])) - ahead[a] - ahead[b] + zero;
    const [u, v, t] = [off(0, 1), off(0, 2), off(1, 2)];
    const solve = (r) => solveThree([[h[0], u, v], [u, h[1], t], [v, t, h[2]]], r);
    const first = solve(g);
    let m = scaled(-1, first);
    if (vector.tied) {
      const second = solve(w), by = dot(w, second);
      m = plus(m, scaled((kept + dot(w, first)) / by, second));
    }
    return zero + dot(g, m) + 0.5 * (h[0] * m[0] * m[0] + h[1] * m[1] * m[1] + h[2] * m[2] * m[2]) + u * m[0] * m[1] + v * m[0] * m[2] + t * m[1] * m[2];
  }

  /* Level curves as segments, by triangles of a grid. They change with parameters and integrals. */
  curves(theme) {
    const { model, vector } = this, w = this.value(), length = norm(w), kept = vector.tied && vector.partner.length ? dot(w, vector.partner.map((row) => model.x[row])) : 0;
    const energy = model.energyAt(model.x), key = [...model.p, ...model.u, length.toPrecision(5), kept.toPrecision(4), scene.noise ? "" : energy.toPrecision(4), theme.dark].join();
    if (key === this.key) return;
    this.key = key;
    const rows = 36, columns = 72, points = [], values = [];
    for (let i = 0; i <= rows; i++) for (let j = 0; j <= columns; j++) {
      const p = onSphere(clamp(i / rows, 0.003, 0.997), j / columns);
      points.push(p);
      values.push(this.potential(p, length, kept));
    }
    const finite = values.filter(Number.isFinite).sort((a, b) => a - b), low = finite[0], high = finite[finite.length - 1];
    const segments = [], usable = high - low > 1e-9 * Math.max(Math.abs(high), 1);
    const levels = usable ? Array.from({ length: 11 }, (_, k) => [low + (k + 0.5) / 11 * (high - low), [...theme.line, 0.85]]) : [];
    if (usable && this.model.has("energy") && !scene.noise) levels.push([energy, [...ORANGE, 1]]);
    for (const [level, tint] of levels) for (let i = 0; i < rows; i++) for (let j = 0; j < columns; j++) {
      const a = i * (columns + 1) + j;
      for (const corner of [[a, a + 1, a + columns + 1], [a + 1, a + columns + 2, a + columns + 1]]) {
        const cut = [];
        for (let e = 0; e < 3; e++) {
          const p = corner[e], q = corner[(e + 1) % 3], s = (level - values[p]) / (values[q] - values[p]);
          if ((values[p] < level) !== (values[q] < level)) cut.push(scaled(1.001, unit(plus(points[p], scaled(s, minus(points[q], points[p]))))));
        }
        if (cut.length === 2) segments.push(...cut[0], ...cut[1], ...tint, ...tint);
      }
    }
    this.levels = new Float32Array(segments);
  }

  draw(theme, labels) {
    const { drawing, model } = this;
    drawing.begin(this.camera, theme.ambient);
    const behind = () => drawing.draw("sphere", [1, 0, 0, 0], [0, 0, 0], [0.997, 0.997, 0.997], theme.ball, {});
    if (this.strand) {
      const size = scene.members, all = Array.from({ length: size }, (_, i) => scene.curve.map((b) => model.x[b * size + i]));
      this.scale = this.scale === 1 ? 1 / Math.max(...all.map(norm), 1e-9) : this.scale;
      drawing.draw("sphere", [1, 0, 0, 0], [0, 0, 0], [1, 1, 1], [...theme.line, 0.5], { glass: 1 });
      const points = all.map((p) => scaled(this.scale, p));
      drawing.line([...points, points[0]], (s) => [...hue(s), 1], 4);
      this.axes(theme, labels);
      return;
    }
    const w = this.value(), length = norm(w) || 1;
    if (this.vector.round) {
      this.curves(theme);
      behind();
      if (this.levels.length) drawing.pairs(this.levels, this.levels.length / 14, 1.6);
      this.scale = 1.012 / length;
    } else {
      this.scale = this.scale === 1 ? 0.6 / length : this.scale;
      drawing.draw("sphere", [1, 0, 0, 0], [0, 0, 0], [0.03, 0.03, 0.03], theme.steel);
    }
    const at = scaled(this.scale, w);
    this.trail.add(at, 0.01);
    if (this.vector.round) drawing.through(() => { // what is behind the ball, faintly
      drawing.line(this.trail.points, fade(this.tint, 0.25), 2);
      drawing.draw("sphere", [1, 0, 0, 0], at, [0.05, 0.05, 0.05], [...this.tint, 0.35]);
    });
    drawing.line(this.trail.points, fade(this.tint), 3);
    this.axes(theme, labels);
    if (this.plane) {
      const ring = Array.from({ length: 49 }, (_, k) => { const a = Math.PI * (k / 48 - 0.5); return plus(scaled(1.006 * Math.cos(a), this.plane.out), [0, 0, 1.006 * Math.sin(a)]); });
      drawing.line(ring, () => [...GREEN, 1], 3);
    }
    drawing.draw("sphere", [1, 0, 0, 0], at, [0.062, 0.062, 0.062], this.tint);
    if (this.vector.round) drawing.draw("sphere", [1, 0, 0, 0], at, [0.12, 0.12, 0.12], this.tint, { glass: 1 }); // a hand may take it
    labels.unshift({ text: this.name, at, kind: this.tint === RED ? "red" : this.tint === GREEN ? "green" : "blue", behind: this.hides(at), away: 9 });
    return at;
  }
  names() { return this.vector ? scene.tables[this.vector.table || "state"].flatMap((each) => each.components).filter((_, k) => this.vector.rows.includes(k)) : scene.tables.state[0].components; }
  /* The least time so far in which the vector goes as far as its length. */
  pace() {
    const w = this.value(), rates = this.model.call("rhs", this.model.x, (this.slopes ||= new Float64Array(this.model.n)));
    return (this.stride = Math.min(this.stride ?? Infinity, (norm(w) || 1) / (norm(this.vector.rows.map((row) => rates[row])) || 1)));
  }
  axes(theme, labels) {
    const names = this.names();
    E.forEach((axis, k) => {
      this.drawing.line([scaled(this.vector && !this.vector.round ? 0 : 1, axis), scaled(1.3, axis)], () => [...theme.steel, 0.9], 2);
      labels.push({ text: names[k] || "", at: scaled(1.34, axis), kind: "axis", behind: this.hides(scaled(1.34, axis)) });
    });
  }
  /* Whether the ball stands before a point. */
  hides(at) {
    if (this.vector && !this.vector.round) return false;
    const { eye } = this.drawing, along = minus(at, eye), s = -dot(eye, along) / dot(along, along);
    return dot(at, eye) < 1 && s > 0 && s < 1 && norm(plus(eye, scaled(s, along))) < 1;
  }
  tellClosed() {
    return `Components against ${scene.clock.name}. ${model.integrals.length && !scene.noise ? "This motion is one closed level curve: a section of it would be one dot." : "The state has no more rows than these, so that a section would be dots on one curve."}`;
  }

  /* Put the point in a direction: a vertical by turning the body, anything else by itself. */
  point(direction) {
    const { model, vector } = this, length = norm(this.value()) || 1;
    if (scene.vertical && vector.rows[0] === scene.vertical.rows[0]) {
      const q = model.pose(), now = unit(this.value());
      model.turn(multiply(multiply(q, turnOnto(direction, now)), conjugate(q)));
    } else {
      model.write({ rows: vector.rows }, scaled(length, direction));
      model.ended = "";
      model.measure();
    }
    this.clear();
  }

  /* What was drawn of the motion until now is not of this one. */
  clear() { this.trail = new Trail(); this.last = null; this.run += 1; this.past = []; this.stride = undefined; }

  /* A half plane through the axis and a direction; the motion leaves a dot where it crosses it. */
  cut(direction) {
    const flat = [direction[0], direction[1], 0];
    if (norm(flat) < 1e-6) return;
    this.plane = { out: unit(flat), across: unit(cross(E[2], flat)) };
    this.dots = [];
    this.last = null;
  }
  watch() {
    if (this.closed) {
      this.past.push([this.model.clock[0], ...this.value()]);
      if (this.past.length > 4000) this.past.shift();
    }
    if (!this.plane || !this.vector) return;
    const w = this.value(), side = dot(w, this.plane.across), rates = this.model.call("rhs", this.model.x, (this.slopes ||= new Float64Array(this.model.n)));
    const now = { side, height: w[2] / (norm(w) || 1), rate: rates[this.vector.rows[2]] / (norm(w) || 1), front: dot(w, this.plane.out) };
    const before = this.last;
    if (before && before.side < 0 !== side < 0 && now.front > 0) {
      const s = before.side / (before.side - side);
      this.dots.push([before.height + s * (now.height - before.height), before.rate + s * (now.rate - before.rate), this.run]);
      if (this.dots.length > 4000) this.dots.shift();
    }
    this.last = now;
  }
}

function solveThree(rows, right) {
  const [a, b, c] = rows, d = dot(a, cross(b, c));
  return scaled(1 / d, plus(plus(scaled(right[0], cross(b, c)), scaled(right[1], cross(c, a))), scaled(right[2], cross(a, b))));
}

function fitCanvas(canvas) {
  const ratio = Math.min(devicePixelRatio || 1, 2), box = canvas.getBoundingClientRect();
  const wide = Math.round(box.width * ratio), high = Math.round(box.height * ratio);
  if (canvas.width !== wide || canvas.height !== high) Object.assign(canvas, { width: wide, height: high });
  const pen = canvas.getContext("2d");
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.clearRect(0, 0, box.width, box.height);
  return [pen, box.width, box.height];
}

/* Crossings: up, the third component; across, its rate, both by the length. The frame says from where to where. */
function drawSection(canvas, panel, theme) {
  const [pen, wide, high] = fitCanvas(canvas), [left, right, top, bottom] = [46, wide - 8, 8, high - 34], heights = panel.dots.map((d) => d[0]);
  const most = 1.1 * Math.max(...panel.dots.map((d) => Math.abs(d[1])), 1e-9), low = Math.min(...heights, 1), upper = Math.max(...heights, -1);
  const pad = Math.max(0.1 * (upper - low), 0.01), [least, greatest] = heights.length ? [Math.max(low - pad, -1), Math.min(upper + pad, 1)] : [-1, 1];
  pen.strokeStyle = pen.fillStyle = theme.pen;
  pen.globalAlpha = 0.35;
  pen.strokeRect(left, top, right - left, bottom - top);
  pen.beginPath();
  pen.moveTo((left + right) / 2, top); pen.lineTo((left + right) / 2, bottom);
  pen.stroke();
  pen.globalAlpha = 1;
  const third = `${plainName(panel.names()[2])}/|${plainName(panel.name)}|`;
  const write = (text, x, y, align, font = "12px system-ui, sans-serif") => { Object.assign(pen, { textAlign: align, font }); pen.fillText(text, x, y); };
  const symbol = 'italic 14px "STIX Two Text", "Times New Roman", serif';
  write(third, left - 6, (top + bottom) / 2 + 5, "right", symbol);
  write(`rate of ${third}`, (left + right) / 2, high - 4, "center", symbol);
  if (!heights.length) return;
  const digits = Math.max(0, Math.ceil(1 - Math.log10(greatest - least))), tell = (v) => v.toFixed(digits).replace("-", "\u2212"), unit = scene.unitOfTime && scene.unitOfTime !== "1" ? unitText(`1/${scene.unitOfTime}`) : "";
  write(tell(greatest), left - 6, top + 9, "right");
  write(tell(least), left - 6, bottom, "right");
  write(`${shorten(Number((-most).toPrecision(2)))}${unit}`, left, high - 19, "left");
  write(`${shorten(Number(most.toPrecision(2)))}${unit}`, right, high - 19, "right");
  for (const [height, rate, run] of panel.dots) {
    pen.fillStyle = theme.inks[run % theme.inks.length];
    pen.beginPath();
    pen.arc((left + right + rate / most * (right - left)) / 2, bottom - (height - least) / (greatest - least) * (bottom - top), 2.2, 0, 7);
    pen.fill();
  }
}

/* The rows of the vector over the last while, named where they end. */
function drawComponents(canvas, panel, theme) {
  const [pen, wide, high] = fitCanvas(canvas), past = panel.past, now = past.length ? past[past.length - 1][0] : 0;
  const span = 12 * panel.pace(), right = wide - 26, most = norm(panel.value()) || 1, y = (v) => high / 2 - v / most * (high / 2 - 8);
  pen.strokeStyle = pen.fillStyle = theme.pen;
  pen.globalAlpha = 0.35;
  pen.strokeRect(0.5, high / 2, right, 0);
  pen.globalAlpha = 1;
  pen.font = "italic 14px STIX Two Text, Times New Roman, serif";
  const ends = [0, 1, 2].map((k) => [k, past.length ? y(past[past.length - 1][k + 1]) : high / 2]).sort((a, b) => a[1] - b[1]);
  ends.forEach((each, k) => { each[1] = clamp(each[1], k ? ends[k - 1][1] + 14 : 8, high - 8 - 14 * (2 - k)); });
  for (const [k, place] of ends) {
    pen.strokeStyle = pen.fillStyle = theme.inks[k];
    pen.lineWidth = 1.8;
    pen.beginPath();
    for (const each of past) { const x = right * (1 - (now - each[0]) / span); if (x >= 0) pen.lineTo(x, y(each[k + 1])); }
    pen.stroke();
    pen.fillText(plainName(panel.names()[k]), right + 3, place + 4);
  }
}

/* The drift of each integral over the last while, from 1e-16 at the bottom to 1 at the top. */
class DriftStrip {
  constructor(model, list) {
    this.model = model;
    this.list = list;
    this.build();
  }
  build() {
    this.list.replaceChildren();
    this.rows = this.model.integrals.map((each) => {
      const row = document.createElement("div"), name = document.createElement("span"), value = document.createElement("span"), error = document.createElement("span"), canvas = document.createElement("canvas");
      row.className = "drift";
      nameOn(name, each.name);
      if (each.rows.length > 1) { name.prepend("|"); name.append("|"); }
      row.title = raise(each.doc);
      name.classList.add("name");
      value.className = error.className = "value";
      canvas.setAttribute("aria-hidden", "true");
      row.append(name, value, error, canvas);
      this.list.append(row);
      return { value, error, canvas, past: [] };
    });
  }
  clear() { this.rows.forEach((row) => { row.past = []; }); }
  update(theme, telling) {
    this.model.integrals.forEach((each, k) => {
      const row = this.rows[k], drift = this.model.drift(each);
      row.past.push(drift);
      if (row.past.length > 240) row.past.shift();
      if (!telling) return;
      const values = each.rows.map((r) => this.model.y[r]);
      const now = values.length === 1 ? values[0] : Math.hypot(...values), zero = Math.max(...each.first.map(Math.abs), Math.abs(now)) < 1e-12; // of sums that cancel
      row.value.textContent = `${shorten(zero ? 0 : now)}${unitText(each.unit)}`;
      row.error.textContent = tellDrift(drift);
      const [pen, wide, high] = fitCanvas(row.canvas);
      pen.strokeStyle = theme.inks[k % theme.inks.length];
      pen.lineWidth = 1.6;
      pen.beginPath();
      row.past.forEach((d, i) => pen.lineTo(i / 239 * wide, high - 1.5 - clamp((Math.log10(Math.max(d, 1e-16)) + 16) / 16, 0, 1) * (high - 3)));
      pen.stroke();
    });
  }
}
const shorten = (v) => (v === 0 ? "0" : Math.abs(v) >= 1e5 || Math.abs(v) < 1e-3 ? tellPower(v, 2) : Number(v.toPrecision(4)).toString()).replaceAll("-", "\u2212");
/* A number by its power of ten, as books write it. */
const tellPower = (v, digits) => { const [own, power] = v.toExponential(digits).split("e"); return `${own}\u00d710${[...power.replace("+", "")].map((c) => HIGH[c]).join("")}`; };
const tellDrift = (d) => (d < 1e-15 ? "\u00b10" : `\u00b1${tellPower(d, 0)}`);
const HIGH = { "-": "\u207b", 0: "\u2070", 1: "\u00b9", 2: "\u00b2", 3: "\u00b3", 4: "\u2074", 5: "\u2075", 6: "\u2076", 7: "\u2077", 8: "\u2078", 9: "\u2079" };
const raise = (text) => text.replace(/\^(-?\d+)/g, (_, digits) => [...digits].map((c) => HIGH[c]).join(""));
const unitText = (unit) => (!unit || unit === "1" ? "" : `\u00a0${raise(unit).replace(/^1\/(\w+)$/, "$1\u207b\u00b9").replace(/ /g, "\u00a0")}`);
