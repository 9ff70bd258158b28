// The page: hands, sliders, keys, the address, and a frame after the other.
const id = (name) => document.getElementById(name);
const model = new Model();
const dark = matchMedia("(prefers-color-scheme: dark)"), calm = matchMedia("(prefers-reduced-motion: reduce)");
const THEMES = {
  light: { dark: 0, floor: [0.93, 0.915, 0.88], line: [0.66, 0.64, 0.60], steel: [0.45, 0.48, 0.52], body: [0.24, 0.50, 0.78], body2: [0.88, 0.90, 0.92], ball: [0.90, 0.92, 0.94], ambient: 0.5, pen: "#222", inks: ["#1a5a9e", "#9a4b00", "#0b6650", "#9c2f26", "#6a3d9a"] },
  dark: { dark: 1, floor: [0.13, 0.15, 0.18], line: [0.42, 0.47, 0.53], steel: [0.60, 0.64, 0.69], body: [0.27, 0.53, 0.82], body2: [0.80, 0.83, 0.87], ball: [0.20, 0.24, 0.29], ambient: 0.38, pen: "#ddd", inks: ["#8cc2f5", "#f0b070", "#6fd3b4", "#f0988e", "#c4a6f0"] },
};
let theme = THEMES[dark.matches ? "dark" : "light"], running = false, cutting = false, debt = 0, frames = 0, kept = [], raised = 0, room = 1;

const drawing = new Drawing(id("scene")), view = new SCENES[scene.kind](model, drawing), panel = new SpherePanel(model, id("sphere"));
const strip = new DriftStrip(model, id("drift"));
const start = { x: Float64Array.from(model.x), q: null }; // q is the attitude that a hand has given
function begin() { start.x.set(model.x); start.q = stands() ? model.pose() : null; }
/* Whether a body has an attitude that its state does not know. */
const stands = () => ["body", "rolling"].includes(scene.kind) && !scene.attitude;

let quiet = 0;
function tell(text, seen = false) {
  const status = id("status");
  status.textContent = text;
  status.classList.toggle("shown", seen);
  clearTimeout(quiet);
  if (seen) quiet = setTimeout(() => status.classList.remove("shown"), 3500);
}

function run(on) {
  if (on && model.ended) reset();
  running = on;
  id("play").textContent = on ? "Pause" : "Run";
  if (!on) save();
  tell(on ? "Running" : `Paused at ${model.clock[0].toFixed(2)}${unitText(scene.unitOfTime)}`);
}
function refresh() { view.clear(); panel.clear(); strip.clear(); model.observe(); showSliders(true); }
function reset() {
  model.x.set(start.x);
  model.settle();
  if (start.q) model.stand(start.q);
  refresh();
  tell("Back at the start");
}

// -- sliders --------------------------------------------------------------------------------------

const sliders = [];
function rangeOf(table, value, positive, big) {
  if (table === "state") { const most = 2 * big; return [-most, most]; }
  if (positive) return [0.1 * value, 3 * value];
  const most = value ? 2.5 * Math.abs(value) : Math.max(big, 1);
  return value > 0 && table === "parameters" ? [0, most] : [-most, most];
}
function addSliders(table, array, box) {
  let row = 0;
  for (const each of scene.tables[table]) {
    if (each.hidden) { row += each.components.length; continue; } // of very many members
    const group = document.createElement("div"), values = each.components.map((_, k) => array[row + k]);
    group.className = "group";
    if (each.doc) group.append(id("docs").content.querySelector(`[data-of="${CSS.escape(each.name)}"]`).cloneNode(true));
    const big = Math.max(...values.map(Math.abs)) || 1;
    each.components.forEach((name, k) => {
      const at = row++, line = document.createElement("div"), label = document.createElement("label"), input = document.createElement("input"), output = document.createElement("output");
      const [low, high] = rangeOf(table, values[k], each.positive, big);
      line.className = "row";
      input.type = "range";
      input.id = `${table}-${name}`;
      Object.assign(input, { min: low, max: high, step: (high - low) / 400 });
      label.htmlFor = output.htmlFor = input.id;
      nameOn(label, name);
      line.append(label, input, output);
      group.append(line);
      const show = (force) => {
        if (!force && document.activeElement === input) return;
        const v = array[at];
        if (v < Number(input.min)) input.min = v;
        if (v > Number(input.max)) input.max = v;
        input.value = v;
        output.textContent = `${shorten(v)}${unitText(each.units[k])}`;
        input.setAttribute("aria-valuetext", output.textContent);
      };
      input.addEventListener("input", () => {
        array[at] = Number(input.value);
        output.textContent = `${shorten(array[at])}${unitText(each.units[k])}`;
        changed(table);
      });
      show(true);
      sliders.push({ table, show });
    });
    box.append(group);
  }
}
function changed(table) {
  model.ended = "";
  if (table !== "inputs") { model.find(); model.measure(); if (table === "parameters") view.moving(); refresh(); }
  if (table === "state" && !running) begin();
  saveSoon();
}
function showSliders(all) { for (const each of sliders) if (all || each.table !== "parameters") each.show(false); }
for (const [table, box, array] of [["inputs", "drive", model.u], ["parameters", "parameters", model.p], ["state", "state", model.x]]) {
  if (!array.length || (scene.members && table === "state")) continue;
  id(box).hidden = false;
  addSliders(table, array, id(box).querySelector("div"));
}

// -- noise ----------------------------------------------------------------------------------------

const isSeed = (number) => Number.isSafeInteger(number) && number >= 0;
if (scene.noise) {
  id("noise").hidden = false;
  const choose = () => {
    const seed = Number(id("seed").value);
    if (!isSeed(seed)) { tell("A seed is a whole number from 0 to 2^53."); return; }
    model.stepper.restart(seed);
    reset();
    save();
  };
  id("seed").addEventListener("change", choose);
  id("other").addEventListener("click", () => { id("seed").value = model.stepper.seed + 1; choose(); });
}

// -- the address ----------------------------------------------------------------------------------

const MOST_SHARED = 2000; // numbers of a state in an address
let saved = 0, later = 0;
/* While a slider moves, a few times a second: browsers refuse more. */
function saveSoon() {
  clearTimeout(later);
  if (performance.now() - saved > 250) save(); else later = setTimeout(save, 250);
}
function save() {
  const digits = model.n > 200 ? 5 : 9, numbers = (array) => [...array].map((v) => Number(v.toPrecision(digits))).join(",");
  clearTimeout(later);
  saved = performance.now();
  const parts = [`p=${numbers(model.p)}`];
  if (model.n <= MOST_SHARED) parts.push(`x=${numbers(running ? start.x : model.x)}`);
  if (model.u.length) parts.push(`u=${numbers(model.u)}`);
  const attitude = running ? start.q : stands() && model.pose();
  if (attitude) parts.push(`q=${numbers(attitude)}`);
  if (scene.noise) parts.push(`s=${model.stepper.seed}`);
  try { history.replaceState(null, "", `#${parts.join("&")}`); } catch { location.hash = parts.join("&"); }
}
function load() {
  const given = new URLSearchParams(location.hash.slice(1));
  let found = false;
  for (const [key, array] of [["p", model.p], ["x", model.x], ["u", model.u]]) {
    const numbers = (given.get(key) || "").split(",").map(Number);
    if (given.get(key) && numbers.length === array.length && numbers.every(Number.isFinite)) { array.set(numbers); found = true; }
  }
  const seed = Number(given.get("s") || NaN);
  if (scene.noise && isSeed(seed)) { model.stepper.restart(seed); id("seed").value = seed; found = true; }
  if (!found) return;
  const q = (given.get("q") || "").split(",").map(Number);
  start.x.set(model.x);
  model.settle();
  start.q = stands() && q.length === 4 && Math.hypot(...q) > 0.5 ? normal(q) : null;
  if (start.q) model.stand(start.q);
  view.moving();
  refresh();
}
id("share").addEventListener("click", async () => {
  save();
  const held = model.n > MOST_SHARED ? "these parameters; the state is too long for a link" : "this motion";
  try { await navigator.clipboard.writeText(location.href); tell(`Copied: the link to ${held}.`, true); }
  catch { tell(`The address of this page is the link to ${held}.`, true); }
});

// -- hands ----------------------------------------------------------------------------------------

function orbit(camera, dx, dy) {
  camera.yaw -= 0.008 * dx;
  camera.pitch = clamp(camera.pitch + 0.008 * dy, -1.45, 1.5);
}
function drag(canvas, begin) {
  canvas.addEventListener("pointerdown", (event) => {
    const box = canvas.getBoundingClientRect(), at = (e) => [e.clientX - box.left, e.clientY - box.top];
    const hand = begin(...at(event));
    if (!hand) return;
    canvas.setPointerCapture(event.pointerId);
    let last = at(event);
    const move = (e) => { const now = at(e); hand.move(now[0], now[1], now[0] - last[0], now[1] - last[1]); last = now; };
    const up = () => { canvas.removeEventListener("pointermove", move); hand.end?.(); };
    canvas.addEventListener("pointermove", move);
    canvas.addEventListener("pointerup", up, { once: true });
    canvas.addEventListener("pointercancel", up, { once: true });
  });
}
drag(id("scene"), (x, y) => {
  if (view.grab) {
    const held = view.grab(x, y);
    if (held) { const was = running; running = false; return { move: held.move, end: () => { finish(was); } }; }
  }
  const found = view.turnable() && drawing.hit(x, y, view.centre, view.radius);
  if (!found || !found.inside) return { move: (a, b, dx, dy) => orbit(view.camera, dx, dy) };
  let before = found.direction;
  const was = running;
  running = false;
  return {
    move: (a, b) => { const now = drawing.hit(a, b, view.centre, view.radius).direction; view.turn(turnOnto(before, now)); before = now; refresh(); },
    end: () => finish(was),
  };
});
const HINT = scene.noise ? "Curves: levels of the energy, which noise crosses. Drag the point." : !scene.functions.includes("energy") || model.u.length ? "Drag the point." : panel.vector?.partner.length
  ? "Curves: levels of the least energy there; orange bounds where this motion can go. Drag the point." : "Curves: levels of the energy; orange: that of the motion. Drag the point.";
function finish(was) {
  model.settleOn();
  begin(); model.measure(); model.find(); refresh(); running = was; save();
}
if (panel.shown) {
  id("sphere-box").hidden = false;
  id("sphere-title").textContent = panel.strand ? `${plainName(panel.name)} at every point` : panel.vector.round ? `${plainName(panel.name)} on its sphere` : `${plainName(panel.name)}, the curve of the velocity`;
  id("sphere-hint").textContent = panel.strand ? "Colours are those of the ring." : panel.vector.round ? HINT : "The velocity as a point. Drag around to look.";
  id("cut").hidden = panel.strand;
  drag(id("sphere"), (x, y) => {
    if (panel.strand || !panel.vector.round) return { move: (a, b, dx, dy) => orbit(panel.camera, dx, dy) };
    const found = panel.drawing.hit(x, y, [0, 0, 0], 1), at = panel.drawing.project(scaled(panel.scale, panel.value()));
    if (cutting && found.inside) { panel.cut(found.direction); cutting = false; id("section-box").hidden = false; tell("A dot for each crossing of the green half plane."); press(); return null; }
    if (Math.hypot(at.x - x, at.y - y) > 30) return { move: (a, b, dx, dy) => orbit(panel.camera, dx, dy) };
    const was = running;
    running = false;
    return { move: (a, b) => { panel.point(panel.drawing.hit(a, b, [0, 0, 0], 1).direction); view.clear(); strip.clear(); showSliders(true); }, end: () => finish(was) };
  });
  if (panel.vector && !panel.vector.round) id("cut").hidden = true;
}
function press() {
  id("cut").setAttribute("aria-pressed", String(cutting));
  id("sphere-hint").textContent = cutting ? "Click the sphere: crossings of the half plane through that point become dots." : HINT;
}
if (panel.shown && panel.closed) id("cut").textContent = "Components";
id("cut").addEventListener("click", () => {
  if (panel.closed) {
    panel.plotted = !panel.plotted;
    id("section-box").hidden = !panel.plotted;
    id("cut").setAttribute("aria-pressed", String(panel.plotted));
    id("section").setAttribute("aria-label", `Components against ${scene.clock.name}`);
    id("section-told").textContent = panel.tellClosed();
    return;
  }
  cutting = !cutting;
  press();
});
/* What a hand can take looks so. */
const over = (canvas, found) => id(canvas).addEventListener("pointermove", (event) => {
  if (event.buttons) return;
  const box = id(canvas).getBoundingClientRect();
  id(canvas).classList.toggle("held", Boolean(found(event.clientX - box.left, event.clientY - box.top)));
});
over("scene", (x, y) => view.grab?.(x, y) || (view.turnable() && drawing.hit(x, y, view.centre, view.radius).inside));
if (panel.shown) over("sphere", (x, y) => {
  if (!panel.vector?.round) return false;
  const at = panel.drawing.project(scaled(panel.scale, panel.value()));
  return cutting || Math.hypot(at.x - x, at.y - y) <= 30;
});
for (const [canvas, own] of [["scene", view], ["sphere", panel]]) id(canvas).addEventListener("wheel", (event) => {
  event.preventDefault();
  own.camera.distance *= Math.exp(0.001 * event.deltaY);
}, { passive: false });

// -- keys -----------------------------------------------------------------------------------------

const ARROWS = { ArrowLeft: [-24, 0], ArrowRight: [24, 0], ArrowUp: [0, -24], ArrowDown: [0, 24] };
document.addEventListener("keydown", (event) => {
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  const on = document.activeElement, arrow = ARROWS[event.key];
  if (event.key === " " && !/^(BUTTON|SUMMARY|INPUT)$/.test(on.tagName)) { run(!running); event.preventDefault(); }
  else if (event.key.toLowerCase() === "r" && on.tagName !== "INPUT") reset();
  else if (arrow && on.id === "scene") { orbit(view.camera, ...arrow); event.preventDefault(); }
  else if (arrow && on.id === "sphere") {
    if (panel.vector && panel.vector.round) {
      const now = unit(panel.value()), side = unit(cross(E[2], now)), up = cross(now, side);
      panel.point(unit(plus(now, plus(scaled(arrow[0] / 300, side), scaled(-arrow[1] / 300, up)))));
      finish(running);
      tell(`${plainName(panel.name)} is ${panel.value().map(shorten).join(", ")}`);
    } else orbit(panel.camera, ...arrow);
    event.preventDefault();
  }
});
const showPace = () => { id("pace").textContent = `\u00d7\u00a0${Number((10 ** Number(id("speed").value)).toPrecision(2))}`; };
id("speed").addEventListener("input", showPace);
showPace();
id("play").addEventListener("click", () => run(!running));
id("again").addEventListener("click", reset);

// -- the stick ------------------------------------------------------------------------------------

const stick = { x: 0, y: 0, rows: [] };
if (scene.stick) {
  let row = 0;
  for (const each of scene.tables.inputs) { if (each.name === scene.stick) stick.rows = [row, row + 1, row + 2]; row += each.components.length; }
  id("pad").hidden = false;
  view.hint = "Fly with the stick: torques that lean the body as far as the stick, and hold it there";
  const knob = (x, y) => { Object.assign(stick, { x, y }); id("knob").style.transform = `translate(${40 * x}px, ${40 * y}px)`; };
  drag(id("pad"), (x, y) => {
    const half = id("pad").clientWidth / 2, to = (a, b) => { const l = Math.max(1, Math.hypot(a - half, b - half) / half); knob((a - half) / half / l, (b - half) / half / l); };
    if (!running) run(true);
    to(x, y);
    return { move: to, end: () => knob(0, 0) };
  });
  id("pad").addEventListener("keydown", (event) => { const to = ARROWS[event.key]; if (to) { knob(to[0] / 24, to[1] / 24); event.preventDefault(); } });
  id("pad").addEventListener("keyup", (event) => { if (ARROWS[event.key]) knob(0, 0); });
}
/* Torques toward the lean of the stick, as a pilot's box gives them. */
function steer() {
  const inertia = (steer.inertia ||= model.inertia()), w = model.read(scene.turning), up = scene.vertical ? unit(model.read(scene.vertical)) : [0, 0, 1];
  const lean = unit([0.45 * stick.y, 0.45 * stick.x, 1]), wanted = scaled(4, cross(lean, up));
  stick.rows.forEach((row, k) => { model.u[row] = inertia[k] * 8 * (wanted[k] - w[k]); });
}

// -- frames ---------------------------------------------------------------------------------------

/* Where a label stands by its point: the first place where it covers nothing else. */
const SIDES = [[0.5, -1], [-0.5, -1], [0.5, 1], [-0.5, 1], [0, -1.3], [0, 1.3]];
const touch = (a, b) => a[0] < b[2] && b[0] < a[2] && a[1] < b[3] && b[1] < a[3];
function showLabels(box, labels, pen, kept = []) {
  while (box.children.length < labels.length) box.append(document.createElement("span"));
  const taken = [...kept], wide = box.clientWidth, high = box.clientHeight;
  [...box.children].forEach((span, k) => {
    const own = labels[k], key = own && `${own.text} ${own.kind}`;
    span.hidden = !own || !own.text;
    if (span.hidden) return;
    if (span.dataset.key !== key) {
      span.dataset.key = key;
      span.className = own.kind;
      nameOn(span, own.text);
      span.extent = [span.offsetWidth + 2, span.offsetHeight + 2];
    }
    span.classList.toggle("behind", Boolean(own.behind));
    const [w, h] = span.extent, at = pen.project(own.at);
    const near = at.front && at.x > -30 && at.x < wide + 30 && at.y > -30 && at.y < high + 30;
    const put = (side) => { const x = clamp(at.x + side[0] * (w + 16 + 2 * (own.away || 0)) - w / 2, 2, Math.max(wide - w - 2, 2)), y = clamp(at.y + 0.5 * side[1] * (h + 8) - h / 2, 2, Math.max(high - h - 2, 2)); return [x, y, x + w, y + h]; };
    const tip = own.tip && pen.project(own.tip), ends = tip ? [[tip.x - 6, tip.y - 6, tip.x + 6, tip.y + 6]] : [];
    const free = (place) => ![...taken, ...ends].some((each) => touch(each, place));
    const sides = span.side ? [span.side, ...SIDES] : SIDES, side = near && sides.find((each) => free(put(each)));
    span.hidden = !side;
    if (!side) return;
    span.side = side;
    const place = put(side);
    taken.push(place);
    span.style.transform = `translate(${place[0].toFixed(1)}px, ${place[1].toFixed(1)}px)`;
  });
}
/* What labels of the scene leave free: the title, the hint and the buttons. */
function keepFree() {
  const stage = id("scene").getBoundingClientRect();
  return [...document.querySelectorAll("h1, #about, #hint, #controls > *, #pad")].filter((each) => !each.hidden).map((each) => { const b = each.getBoundingClientRect(); return [b.left - stage.left, b.top - stage.top, b.right - stage.left, b.bottom - stage.top]; });
}
/* The part of the height between the title and the hint, and how far the picture is raised to its middle. */
function findRoom() {
  const stage = id("scene").getBoundingClientRect(), above = id("about").querySelector("summary").getBoundingClientRect().bottom - stage.top;
  const below = stage.bottom - id("hint").getBoundingClientRect().top;
  return [clamp(1 - (above + below) / stage.height, 0.4, 1), clamp((below - above) / stage.height, 0, 0.3)];
}
function advance(seconds) {
  const until = performance.now() + 8;
  debt = Math.min(debt + seconds * 10 ** Number(id("speed").value), 0.5);
  if (scene.stick) steer();
  while (debt >= model.h) {
    if (!model.step(model.h)) { run(false); tell(`The motion ends here: ${plainName(model.ended)} no longer holds.`, true); break; }
    panel.watch();
    view.sample();
    debt -= model.h;
    if (performance.now() > until) { debt = 0; break; }
  }
  model.observe();
}
function paint() {
  theme = THEMES[dark.matches ? "dark" : "light"];
  if (frames % 30 === 0) { kept = keepFree(); [room, raised] = findRoom(); }
  do { // again, where the camera has gone to a new motion
    view.labels = [];
    view.came = false;
    drawing.begin(view.camera, theme.ambient, raised, room);
    view.draw(theme);
  } while (view.came);
  showLabels(id("scene-labels"), view.labels, drawing, kept);
  if (panel.shown) {
    const labels = [], at = panel.draw(theme, labels), spot = at && panel.drawing.project(at);
    showLabels(id("sphere-labels"), labels, panel.drawing, spot ? [[spot.x - 9, spot.y - 9, spot.x + 9, spot.y + 9]] : []);
    if (panel.plotted) drawComponents(id("section"), panel, theme);
    else if (panel.plane) {
      drawSection(id("section"), panel, theme);
      id("section-told").textContent = `${panel.dots.length} crossings of the green half plane. Drag the point: each motion has its colour.`;
    }
  }
  strip.update(theme, frames % 12 === 0);
  if (frames % 6 === 0) {
    id("clock").textContent = `${scene.clock.symbol} = ${model.clock[0].toFixed(2)}${unitText(scene.unitOfTime) || ""}`;
    if (id("hint").textContent !== view.hint) id("hint").textContent = view.hint;
    if (running) showSliders(false);
  }
  frames += 1;
}
let before = 0;
const costs = [];
function frame(now) {
  const passed = clamp((now - before) / 1000, 0, 0.05), began = performance.now();
  before = now;
  if (running) advance(passed);
  paint();
  costs.push(performance.now() - began);
  if (costs.length > 600) costs.shift();
  requestAnimationFrame(frame);
}
const METHODS = { rk4: "the method of Runge and Kutta of order 4", midpoint: "the implicit midpoint", gauss4: "the method of Gauss of order 4", isospectral_midpoint: "the isospectral midpoint", spherical_midpoint: "the spherical midpoint", splitting: "a splitting of order 2", splitting4: "a splitting of order 4", splitting6: "a splitting of order 6" };
const keeping = scene.noise ? `with the increments of Wiener processes over steps of ${shorten(model.h)}${unitText(scene.unitOfTime)}${model.method.keeps.length ? `; each path keeps ${model.method.keeps.map(plainName).join(", ")}` : ""}`
  : model.method.name === "isospectral_midpoint" ? "which keeps the eigenvalues of the matrix" : model.method.keeps.length ? `which keeps ${model.method.keeps.map(plainName).join(", ")}` : "";
id("method").textContent = `The rates are the generated code of this system. Steps are made by ${METHODS[model.method.name]}${keeping && `, ${keeping}`}.`;
id("kept").hidden = !model.integrals.length;
load();
addEventListener("hashchange", load);
globalThis.explorer = { model, view, panel, run, reset, paint, frames: () => frames, costs, isRunning: () => running };
run(!calm.matches);
requestAnimationFrame((now) => { before = now; frame(now); });
