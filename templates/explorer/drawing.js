// Drawing: lit meshes, thick lines and a floor on a WebGL canvas, without a library.
// A camera looks at `target` from `distance`, turned by `yaw` and `pitch`; up is the third axis.
const perspective = (fov, aspect, near, far) => {
  const f = 1 / Math.tan(fov / 2);
  return [f / aspect, 0, 0, 0, 0, f, 0, 0, 0, 0, (far + near) / (near - far), -1, 0, 0, 2 * far * near / (near - far), 0];
};
const lookAt = (eye, target) => {
  const z = unit(minus(eye, target)), x = unit(cross(E[2], z)), y = cross(z, x);
  return [x[0], y[0], z[0], 0, x[1], y[1], z[1], 0, x[2], y[2], z[2], 0, -dot(x, eye), -dot(y, eye), -dot(z, eye), 1];
};
const product = (a, b) => {
  const out = new Array(16).fill(0);
  for (let c = 0; c < 4; c++) for (let r = 0; r < 4; r++)
    for (let k = 0; k < 4; k++) out[4 * c + r] += a[4 * k + r] * b[4 * c + k];
  return out;
};
/* Columns of a rotation, each scaled, and a place. */
const place = (q, at, sizes) => {
  const columns = E.map((axis, k) => scaled(sizes[k], rotate(q, axis)));
  return [...columns[0], 0, ...columns[1], 0, ...columns[2], 0, ...at, 1];
};

const MESH_VERTEX = `#version 300 es
uniform mat4 view, model; uniform mat3 turn;
in vec3 point, direction; out vec3 world, facing, local;
void main() { vec4 p = model * vec4(point, 1.0); world = p.xyz; local = point; facing = turn * direction;
  gl_Position = view * p; }`;
const MESH_FRAGMENT = `#version 300 es
precision highp float;
uniform vec4 colour; uniform vec3 eye, second; uniform float paint, glass, ambient;
in vec3 world, facing, local; out vec4 result;
void main() {
  vec3 n = normalize(facing), toward = normalize(eye - world);
  if (dot(n, toward) < 0.0) n = -n;
  vec3 base = colour.rgb;
  if (paint > 0.5) {
    vec3 s = smoothstep(-0.012, 0.012, local);
    float odd = mod(floor(s.x + 0.5) + floor(s.y + 0.5) + (paint > 1.5 ? 0.0 : floor(s.z + 0.5)), 2.0);
    base = mix(base, second, odd);
  }
  if (glass > 0.5) {
    float rim = 1.0 - abs(dot(n, toward));
    result = vec4(base, colour.a * (0.25 + 0.75 * rim * rim * rim));
    return;
  }
  vec3 light = normalize(vec3(0.45, -0.35, 0.85));
  float sun = max(dot(n, light), 0.0), sky = 0.5 + 0.5 * n.z;
  float shine = pow(max(dot(n, normalize(light + toward)), 0.0), 48.0);
  result = vec4(base * (ambient * (0.6 + 0.4 * sky) + 0.5 * sun) + 0.18 * shine, colour.a);
}`;
const LINE_VERTEX = `#version 300 es
uniform mat4 view; uniform vec2 screen; uniform float width;
in vec2 corner; in vec3 first, last; in vec4 tint, tint2; out vec4 colour;
void main() {
  vec4 a = view * vec4(first, 1.0), b = view * vec4(last, 1.0);
  if (a.w < 0.02 || b.w < 0.02) { gl_Position = vec4(2.0, 2.0, 2.0, 1.0); return; }
  vec2 along = (b.xy / b.w - a.xy / a.w) * screen;
  vec2 across = length(along) > 1e-6 ? normalize(vec2(-along.y, along.x)) : vec2(0.0, 1.0);
  vec4 p = mix(a, b, corner.x);
  p.xy += across * corner.y * width / screen * p.w;
  p.z -= 0.0004 * p.w;
  gl_Position = p; colour = mix(tint, tint2, corner.x);
}`;
const LINE_FRAGMENT = `#version 300 es
precision mediump float;
in vec4 colour; out vec4 result;
void main() { result = colour; }`;
const FLOOR_FRAGMENT = `#version 300 es
precision highp float;
uniform vec4 colour; uniform vec3 eye, second, shadow; uniform float paint, glass, ambient;
in vec3 world, facing, local; out vec4 result;
void main() {
  vec2 cell = world.xy / paint, near = abs(fract(cell - 0.5) - 0.5) / fwidth(cell);
  float line = (1.0 - min(min(near.x, near.y), 1.0)) * 0.55;
  float far = length(local.xy) * 1.02, fade = 1.0 - smoothstep(0.25, 1.0, far);
  float dark = 0.34 * exp(-2.2 * dot(world.xy - shadow.xy, world.xy - shadow.xy) / (shadow.z * shadow.z));
  result = vec4(mix(colour.rgb, second, line) * (1.0 - dark), fade * colour.a);
}`;
/* Colours of a grid, along both coordinates of a plane or by longitude and latitude. */
const MAP_FRAGMENT = `#version 300 es
precision highp float;
uniform sampler2D colours; uniform float round_; uniform vec2 counts;
in vec3 world, facing, local; out vec4 result;
void main() {
  vec3 p = normalize(local);
  vec2 at = round_ > 0.5 ? vec2(atan(p.y, p.x) / 6.2831853 + 0.5, asin(clamp(p.z, -1.0, 1.0)) / 3.1415927 + 0.5)
    : 0.5 * local.xy + 0.5 + 0.5 / counts;
  result = vec4(textureLod(colours, at.yx, 0.0).rgb, 1.0); // the second coordinate is along rows
}`;

class Drawing {
  constructor(canvas) {
    this.canvas = canvas;
    const gl = (this.gl = canvas.getContext("webgl2", { antialias: true, alpha: true }));
    if (!gl) {
      document.getElementById("hint").textContent = "This page draws with WebGL 2, which this browser lacks or has switched off. Open it in another one.";
      throw new Error("no WebGL 2");
    }
    this.solid = this.program(MESH_VERTEX, MESH_FRAGMENT);
    this.floorProgram = this.program(MESH_VERTEX, FLOOR_FRAGMENT);
    this.mapped = this.program(MESH_VERTEX, MAP_FRAGMENT);
    this.ribbon = this.program(LINE_VERTEX, LINE_FRAGMENT);
    this.meshes = { sphere: this.mesh(ballMesh()), box: this.mesh(boxMesh()), tube: this.mesh(tubeMesh(1)), cone: this.mesh(tubeMesh(0)), floor: this.mesh(floorMesh()) };
    this.lines = gl.createVertexArray();
    gl.bindVertexArray(this.lines);
    this.corners = this.fill(gl.createBuffer(), new Float32Array([0, -1, 1, -1, 0, 1, 1, 1]));
    this.attribute(this.ribbon, "corner", 2, 0, 0, 0);
    this.segments = gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, this.segments);
    [["first", 3, 0], ["last", 3, 12], ["tint", 4, 24], ["tint2", 4, 40]].forEach(([name, count, offset]) =>
      this.attribute(this.ribbon, name, count, 56, offset, 1));
    gl.bindVertexArray(null);
  }

  program(vertex, fragment) {
    const gl = this.gl, made = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      gl.attachShader(made, shader);
    }
    gl.linkProgram(made);
    if (!gl.getProgramParameter(made, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(made) || "shader");
    return made;
  }

  fill(buffer, data, kind = this.gl.ARRAY_BUFFER) {
    this.gl.bindBuffer(kind, buffer);
    this.gl.bufferData(kind, data, this.gl.DYNAMIC_DRAW);
    return buffer;
  }

  attribute(program, name, count, stride, offset, divisor) {
    const gl = this.gl, at = gl.getAttribLocation(program, name);
    if (at < 0) return;
    gl.enableVertexAttribArray(at);
    gl.vertexAttribPointer(at, count, gl.FLOAT, false, stride, offset);
    gl.vertexAttribDivisor(at, divisor);
  }

  /* Points, their normals, and triangles. */
  mesh({ points, normals, triangles }) {
    const gl = this.gl, array = gl.createVertexArray();
    gl.bindVertexArray(array);
    for (const [name, data] of [["point", points], ["direction", normals]]) {
      this.fill(gl.createBuffer(), new Float32Array(data));
      for (const program of [this.solid, this.floorProgram, this.mapped]) this.attribute(program, name, 3, 0, 0, 0);
    }
    this.fill(gl.createBuffer(), new Uint32Array(triangles), gl.ELEMENT_ARRAY_BUFFER);
    gl.bindVertexArray(null);
    return { array, count: triangles.length };
  }

  /* A camera's picture, raised by a part of half the height where more is covered below than above. */
  begin(camera, ambient, raised = 0, room = 1) {
    const gl = this.gl, box = this.canvas.getBoundingClientRect(), ratio = Math.min(devicePixelRatio || 1, 2);
    const wide = Math.max(1, Math.round(box.width * ratio)), high = Math.max(1, Math.round(box.height * ratio));
    if (this.canvas.width !== wide || this.canvas.height !== high) Object.assign(this.canvas, { width: wide, height: high });
    this.ratio = ratio;
    this.ambient = ambient;
    const c = Math.cos(camera.pitch), reach = camera.distance * Math.max(1, 1.02 * high / wide, 0.8 / room);
    this.eye = plus(camera.target, scaled(reach, [c * Math.cos(camera.yaw), c * Math.sin(camera.yaw), Math.sin(camera.pitch)]));
    this.look = lookAt(this.eye, camera.target);
    const lens = perspective(0.6, wide / high, reach / 50, reach * 30);
    lens[9] = -(this.raised = raised);
    this.view = product(lens, this.look);
    gl.viewport(0, 0, wide, high);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.enable(gl.BLEND);
    gl.blendFuncSeparate(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA, gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
  }

  uniform(program, name, value) {
    const gl = this.gl, places = (program.places ||= {}); // asked for once: an answer waits for what is being drawn
    const at = name in places ? places[name] : (places[name] = gl.getUniformLocation(program, name));
    if (at === null) return;
    if (typeof value === "number") gl.uniform1f(at, value);
    else if (value.length === 16) gl.uniformMatrix4fv(at, false, value);
    else if (value.length === 9) gl.uniformMatrix3fv(at, false, value);
    else gl[`uniform${value.length}fv`](at, value);
  }

  /* A mesh by name or of one's own, at a rotation, a place and sizes along its axes. */
  draw(mesh, q, at, sizes, colour, { second = colour, paint = 0, glass = 0, program = this.solid, shadow = [0, 0, 1] } = {}) {
    const gl = this.gl, { array, count } = this.meshes[mesh] || mesh;
    gl.useProgram(program);
    const turn = E.flatMap((axis, k) => scaled(1 / (sizes[k] || 1), rotate(q, axis)));
    const values = { view: this.view, model: place(q, at, sizes), turn, colour: colour.length === 4 ? colour : [...colour, 1],
      eye: this.eye, second: second.slice(0, 3), paint, glass, ambient: this.ambient, shadow };
    for (const [name, value] of Object.entries(values)) this.uniform(program, name, value);
    gl.depthMask(!glass && program !== this.floorProgram);
    gl.bindVertexArray(array);
    gl.drawElements(gl.TRIANGLES, count, gl.UNSIGNED_INT, 0);
    gl.depthMask(true);
  }

  /* A sphere, or a plane, with the colours of a grid of some counts: bytes, along the second coordinate next to each other. */
  map(mesh, sizes, pixels, counts, round) {
    const gl = this.gl, program = this.mapped;
    if (!this.colours) {
      gl.bindTexture(gl.TEXTURE_2D, (this.colours = gl.createTexture()));
      for (const side of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, side, gl.REPEAT);
      for (const side of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, side, gl.LINEAR);
    }
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, counts[1], counts[0], 0, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
    gl.useProgram(program);
    this.uniform(program, "round_", round ? 1 : 0);
    this.uniform(program, "counts", counts);
    this.draw(mesh, [1, 0, 0, 0], [0, 0, 0], sizes, [1, 1, 1], { program });
  }

  floor(height, radius, cell, colour, line, shadow, middle) {
    const at = [Math.round(middle[0] / cell) * cell, Math.round(middle[1] / cell) * cell, height];
    this.draw("floor", [1, 0, 0, 0], at, [radius, radius, 1], colour, { second: line, paint: cell, program: this.floorProgram, shadow });
  }

  /* Small crosses that rest in space, around a place. */
  lattice(middle, cell, reach, colour) {
    const data = [], steps = Math.ceil(reach / cell), base = middle.map((v) => Math.round(v / cell));
    for (let i = -steps; i <= steps; i++) for (let j = -steps; j <= steps; j++) for (let k = -steps; k <= steps; k++) {
      const at = [base[0] + i, base[1] + j, base[2] + k].map((v) => cell * v), tint = [...colour, 0.9 * clamp(1.2 - norm(minus(at, middle)) / reach, 0, 1)];
      if (tint[3] > 0) for (const axis of E) data.push(...minus(at, scaled(0.045, axis)), ...plus(at, scaled(0.045, axis)), ...tint, ...tint);
    }
    this.pairs(new Float32Array(data), data.length / 14, 1.5);
  }

  arrow(from, to, colour, thick) {
    const along = minus(to, from), length = norm(along);
    if (!(length > 4 * thick)) return;
    const q = turnOnto(E[2], along), head = Math.min(5 * thick, 0.4 * length), neck = plus(from, scaled(1 - head / length, along));
    this.draw("tube", q, from, [thick, thick, length - head], colour);
    this.draw("cone", q, neck, [2.6 * thick, 2.6 * thick, head], colour);
  }

  /* A polyline; `tint(k)` is the colour of a point with its alpha. */
  line(points, tint, width) {
    const count = points.length - 1;
    if (count < 1) return;
    const data = new Float32Array(14 * count);
    let before = tint(0);
    for (let k = 0; k < count; k++) { // no list is made for a piece: thousands in each frame would be collected at some time
      const at = 14 * k, after = tint((k + 1) / count);
      data.set(points[k], at); data.set(points[k + 1], at + 3); data.set(before, at + 6); data.set(after, at + 10);
      before = after;
    }
    this.pairs(data, count, width);
  }

  pairs(data, count, width) {
    const gl = this.gl;
    gl.useProgram(this.ribbon);
    this.uniform(this.ribbon, "view", this.view);
    this.uniform(this.ribbon, "screen", [this.canvas.width / 2, this.canvas.height / 2]);
    this.uniform(this.ribbon, "width", (width * this.ratio) / 2);
    this.fill(this.segments, data);
    gl.bindVertexArray(this.lines);
    gl.depthMask(false);
    gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, count);
    gl.depthMask(true);
  }

  /* Draw without regard to what stands before. */
  through(drawn) {
    this.gl.disable(this.gl.DEPTH_TEST);
    drawn();
    this.gl.enable(this.gl.DEPTH_TEST);
  }

  /* Where a point is on the canvas, in CSS pixels, and whether it is in front of the eye. */
  project(p) {
    const m = this.view, at = [0, 1, 3].map((r) => m[r] * p[0] + m[4 + r] * p[1] + m[8 + r] * p[2] + m[12 + r]);
    return { x: (1 + at[0] / at[2]) * this.canvas.clientWidth / 2, y: (1 - at[1] / at[2]) * this.canvas.clientHeight / 2, front: at[2] > 0 };
  }

  /* The direction from the eye through a point of the canvas. */
  ray(x, y) {
    const wide = this.canvas.clientWidth, high = this.canvas.clientHeight, f = Math.tan(0.3), m = this.look;
    const a = (2 * x / wide - 1) * f * wide / high, b = (1 - 2 * y / high - this.raised) * f;
    return unit(E.map((_, k) => a * m[4 * k] + b * m[4 * k + 1] - m[4 * k + 2]));
  }

  /* The direction from a centre to where a ray meets a ball, or to its rim where it passes by. */
  hit(x, y, centre, radius) {
    const d = this.ray(x, y), o = minus(this.eye, centre), b = dot(o, d), c = dot(o, o) - radius * radius, under = b * b - c;
    return { inside: under >= 0, direction: unit(plus(o, scaled(under >= 0 ? -b - Math.sqrt(under) : -b, d))) };
  }
}

function grid(rows, columns, at) {
  const points = [], normals = [], triangles = [];
  for (let i = 0; i <= rows; i++) for (let j = 0; j <= columns; j++) {
    const [p, n] = at(i / rows, j / columns);
    points.push(...p);
    normals.push(...n);
    const a = i * (columns + 1) + j;
    if (i < rows && j < columns) triangles.push(a, a + 1, a + columns + 1, a + 1, a + columns + 2, a + columns + 1);
  }
  return { points, normals, triangles };
}
const onSphere = (u, v) => [Math.sin(Math.PI * u) * Math.cos(2 * Math.PI * v), Math.sin(Math.PI * u) * Math.sin(2 * Math.PI * v), Math.cos(Math.PI * u)];
function ballMesh() { return grid(32, 64, (u, v) => { const p = onSphere(u, v); return [p, p]; }); }
function floorMesh() { return { points: [-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0], normals: [0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1], triangles: [0, 1, 2, 0, 2, 3] }; }
/* A tube of radius 1 from 0 to 1 along the third axis, closed; with another radius at its end. */
function tubeMesh(end) {
  return grid(5, 48, (u, v) => {
    const k = Math.round(5 * u), radius = [0, 1, 1, end, end, 0][k], c = Math.cos(2 * Math.PI * v), s = Math.sin(2 * Math.PI * v);
    return [[radius * c, radius * s, k > 2 ? 1 : 0], k < 2 ? [0, 0, -1] : k > 3 ? [0, 0, 1] : unit([c, s, 1 - end])];
  });
}
function boxMesh() {
  const points = [], normals = [], triangles = [];
  for (let axis = 0; axis < 3; axis++) for (const sign of [-1, 1]) {
    const first = points.length / 3;
    for (const [a, b] of [[-1, -1], [1, -1], [1, 1], [-1, 1]]) {
      const p = [0, 0, 0], n = [0, 0, 0];
      p[axis] = n[axis] = sign; p[(axis + 1) % 3] = a; p[(axis + 2) % 3] = b;
      points.push(...p);
      normals.push(...n);
    }
    triangles.push(first, first + 1, first + 2, first, first + 2, first + 3);
  }
  return { points, normals, triangles };
}
/* A surface with the normals of its faces, shared where points are. */
function smooth(points, triangles) {
  const sums = points.map(() => [0, 0, 0]);
  for (let k = 0; k < triangles.length; k += 3) {
    const [a, b, c] = triangles.slice(k, k + 3), n = cross(minus(points[b], points[a]), minus(points[c], points[a]));
    for (const each of [a, b, c]) sums[each] = plus(sums[each], n);
  }
  return { points: points.flat(), normals: sums.flatMap(unit), triangles };
}
