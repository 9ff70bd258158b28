// Surfaces: a field in a plane, or the function that entries of a matrix stand for, as colours about zero.

/* Colours about zero, those of the pictures: the zero is that of the paper. */
const ABOUT = {
  light: [[127, 59, 8], [224, 130, 20], [254, 224, 182], [247, 247, 247], [216, 218, 235], [128, 115, 172], [45, 0, 75]],
  dark: [[255, 214, 150], [240, 150, 50], [120, 72, 24], [30, 34, 40], [70, 60, 120], [150, 130, 225], [222, 214, 255]],
};
function colour(values, most, scale, out) {
  const last = scale.length - 1;
  for (let k = 0; k < values.length; k++) {
    const at = clamp((values[k] / most + 1) / 2, 0, 1) * last, low = Math.min(Math.floor(at), last - 1), part = at - low;
    for (let c = 0; c < 3; c++) out[4 * k + c] = scale[low][c] + part * (scale[low + 1][c] - scale[low][c]);
    out[4 * k + 3] = 255;
  }
}

class SurfaceScene extends Scene {
  constructor(model, drawing) {
    super(model, drawing);
    this.round = scene.surface === "sphere";
    const source = scene.surface === "plane" ? null : this.round ? new MatrixOnSphere(scene.matrix, scene.towers) : new MatrixOnTorus(scene.matrix);
    const counts = source ? source.counts : scene.plane.counts;
    const finer = this.round ? null : new Finer(counts, Math.max(1, Math.ceil(128 / Math.max(...counts))));
    this.field = () => { const values = source ? source.show(model.x) : model.x; return finer ? finer.show(values) : values; };
    this.counts = finer ? finer.fine.counts : counts;
    this.pixels = new Uint8Array(4 * this.counts[0] * this.counts[1]);
    this.most = this.field().reduce((most, v) => Math.max(most, Math.abs(v)), 1e-12);
    const name = plainName(scene.tables.state[0].name);
    const told = `${name}: purple where it is positive, orange where it is negative, up to ${shorten(this.most)}${unitText(scene.tables.state[0].units[0])}`;
    this.hint = `${told}. ${scene.surface === "plane" ? "Drag across the plane to stir it; drag elsewhere to look around" : "Drag to look around"}`;
    if (this.round) Object.assign(this.camera, { distance: 4.6, pitch: 0.35 });
    else Object.assign(this.camera, { distance: 6, pitch: 1.15, yaw: -Math.PI / 2 });
  }
  /* Half its extents in the picture. */
  sides() {
    const [a, b] = scene.surface === "plane" ? this.model.plane.sizes(this.model.p) : [1, 1], most = Math.max(a, b);
    return [1.25 * a / most, 1.25 * b / most, 1];
  }
  draw(theme) {
    const { drawing, pixels, counts } = this;
    colour(this.field(), this.most, ABOUT[theme.dark ? "dark" : "light"], pixels);
    if (this.round) {
      drawing.map("sphere", [1, 1, 1], pixels, counts, true);
      const line = (at) => drawing.line(Array.from({ length: 97 }, (_, k) => scaled(1.003, at(2 * Math.PI * k / 96))), () => [...theme.steel, 0.55], 1);
      for (let k = 0; k < 3; k++) line((s) => { const a = Math.PI * k / 3; return [Math.cos(s) * Math.cos(a), Math.cos(s) * Math.sin(a), Math.sin(s)]; });
      for (let k = -2; k <= 2; k++) line((s) => { const a = Math.PI * k / 6; return [Math.cos(a) * Math.cos(s), Math.cos(a) * Math.sin(s), Math.sin(a)]; });
      return;
    }
    const [a, b] = this.sides(), names = scene.plane?.coordinates || ["x", "y"];
    drawing.map("floor", [a, b, 1], pixels, counts, false);
    drawing.line([[-a, -b, 0], [a, -b, 0], [a, b, 0], [-a, b, 0], [-a, -b, 0]], () => [...theme.steel, 1], 2);
    this.label(names[0], [0, -1.04 * b - 0.05, 0], "axis");
    this.label(names[1], [-1.07 * a - 0.08, 0, 0], "axis");
  }
  /* Where a ray meets the plane, as parts of its lengths; null outside. */
  spot(x, y) {
    const [a, b] = this.sides(), at = this.meet([0, 0, 0], x, y, E[2]), part = [(at[0] / a + 1) / 2, (at[1] / b + 1) / 2];
    return part.every((v) => v >= 0 && v < 1) ? part : null;
  }
  grab(x, y) {
    if (scene.surface !== "plane") return null;
    let before = this.spot(x, y);
    if (!before) return null;
    return { move: (a, b) => { const now = this.spot(a, b); if (now && before) this.stir(before, now); before = now; } };
  }
  /* Two eddies to the sides of a path, which push the fluid along it. */
  stir(from, to) {
    const { model } = this, [nx, ny] = scene.plane.counts, sizes = this.model.plane.sizes(model.p), by = [0, 1].map((c) => (to[c] - from[c]) * sizes[c]);
    const long = Math.hypot(...by), wide = 0.06 * Math.min(...sizes);
    if (!long) return;
    const strength = this.most * Math.min(1, long / wide);
    for (let i = 0; i < nx; i++) for (let j = 0; j < ny; j++) {
      const away = [i / nx - to[0], j / ny - to[1]].map((v, c) => (v - Math.round(v)) * sizes[c] / wide);
      const across = (away[1] * by[0] - away[0] * by[1]) / long; // left of the path is positive
      model.x[i * ny + j] -= strength * across * Math.exp(-0.5 * (away[0] ** 2 + away[1] ** 2));
    }
    model.plane.trim(model.x);
    model.ended = "";
    model.measure();
  }
}

SCENES.surface = SurfaceScene;
