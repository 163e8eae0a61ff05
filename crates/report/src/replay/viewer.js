"use strict";
// Plays one or several recorded trials side by side. Films come as JSON in the page; lengths in
// mm, times in s, forces in N. Bodies are drawn by WebGL, curves as SVG.
(() => {
  const films = JSON.parse(document.getElementById("films").textContent);
  const at = (id) => document.getElementById(id);
  const end = Math.max(...films.map((film) => film.time[film.time.length - 1]));
  const BODY = { plug: [0.91, 0.64, 0.24], link: [0.96, 0.84, 0.64], finger: [0.3, 0.58, 0.35], beam: [0.45, 0.7, 0.48], socket: [0.55, 0.64, 0.78], spring: [0.62, 0.25, 0.66], contact: [0.85, 0.12, 0.12], grip: [0.15, 0.35, 0.85] };
  const MM_PER_N = 0.12, LONGEST = 25, LEAST = 0.05;
  const state = { time: 0, playing: false, speed: 0.25, yaw: -0.55, pitch: 0.3, distance: 105, target: [0, 0, 8], bend: 1 };

  // Inside a report the frames at the end come first, and nothing but them.
  const compact = document.body.classList.contains("compact");
  films.forEach((film, i) => {
    const part = (name, more, ...inside) => { const e = Object.assign(document.createElement(name), more); e.append(...inside); return e; };
    const canvas = part("canvas", { id: "film" + i, tabIndex: 0, ariaLabel: "the trial in 3-D: arrow keys turn, plus and minus zoom" });
    const words = part("figcaption", {}, part("span", { className: "key" + i, textContent: film.label || "" }), part("span", { id: "phase" + i }), part("b", { id: "outcome" + i }));
    at("views").append(part("figure", {}, words, canvas));
  });

  // --- vectors, quaternions (x, y, z, w), column-major matrices
  const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
  const sub = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
  const times = (a, k) => [a[0] * k, a[1] * k, a[2] * k];
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const unit = (a) => times(a, 1 / (Math.hypot(...a) || 1));
  const turned = (q, v) => {
    const t = times(cross(q, v), 2);
    return add(add(v, times(t, q[3])), cross(q, t));
  };
  const placed = (pose, v) => add(turned(pose.q, v), pose.p);
  const matrix = ({ p, q }) => {
    const [x, y, z] = [[1, 0, 0], [0, 1, 0], [0, 0, 1]].map((axis) => turned(q, axis));
    return [...x, 0, ...y, 0, ...z, 0, ...p, 1];
  };
  const product = (a, b) => {
    const c = new Array(16).fill(0);
    for (let i = 0; i < 4; i++) for (let j = 0; j < 4; j++) for (let k = 0; k < 4; k++) c[j * 4 + i] += a[k * 4 + i] * b[j * 4 + k];
    return c;
  };
  const STILL = { p: [0, 0, 0], q: [0, 0, 0, 1] };

  // --- a film at a time
  const frameAt = (film, time) => {
    let [low, high] = [0, film.time.length - 1];
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (film.time[middle] <= time) low = middle; else high = middle;
    }
    const gap = film.time[high] - film.time[low];
    return { index: low, share: gap > 0 ? Math.min(1, Math.max(0, (time - film.time[low]) / gap)) : 0 };
  };
  const poseAt = (film, name, { index, share }) => {
    const rows = film.pose[name];
    const a = rows.slice(index * 7, index * 7 + 7), next = Math.min(index + 1, film.time.length - 1);
    const b = rows.slice(next * 7, next * 7 + 7);
    const sign = a[3] * b[3] + a[4] * b[4] + a[5] * b[5] + a[6] * b[6] < 0 ? -1 : 1;
    const mix = a.map((v, i) => v + share * ((i < 3 ? b[i] : sign * b[i]) - v));
    const norm = Math.hypot(...mix.slice(3));
    return { p: mix.slice(0, 3), q: mix.slice(3).map((v) => v / norm) };
  };
  const shown = (film) => (state.time + 1e-9 >= film.decided_s ? film.outcome : "not decided yet");

  // The camera sees the socket and the fingertips at the start; in a report, which shows the end, half as high.
  const heights = films.flatMap((film) => film.bodies.flatMap(({ of, points }) => points.filter((_, i) => i % 3 === 2).map((z) => z + (of === "socket" ? 0 : film.pose.plug[2] / (compact ? 2 : 1)))));
  const [lowest, highest] = [Math.min(...heights), Math.max(...heights)];
  state.target[2] = (lowest + highest) / 2;
  state.distance = 1.9 * (highest - lowest);

  // --- WebGL
  const VERTEX = `attribute vec3 point, normal; uniform mat4 model, view; varying float light;
    void main() { gl_Position = view * model * vec4(point, 1.0);
    vec3 n = mat3(model[0].xyz, model[1].xyz, model[2].xyz) * normal;
    light = length(normal) < 0.5 ? 1.0 : 0.62 + 0.38 * dot(normalize(n), normalize(vec3(0.5, -0.4, 0.8))); }`;
  const FRAGMENT = `precision mediump float; uniform vec4 colour; varying float light;
    void main() { gl_FragColor = vec4(colour.rgb * light, colour.a); }`;
  const flat = (corners, triangles) => {
    const data = [], edges = new Map();
    for (let i = 0; i < triangles.length; i += 3) {
      const ids = [triangles[i], triangles[i + 1], triangles[i + 2]];
      const [a, b, c] = ids.map((id) => corners.slice(3 * id, 3 * id + 3));
      const normal = unit(cross(sub(b, a), sub(c, a)));
      for (const corner of [a, b, c]) data.push(...corner, ...normal);
      for (const [from, to] of [[0, 1], [1, 2], [2, 0]]) {
        const key = [ids[from], ids[to]].sort((x, y) => x - y).join();
        edges.set(key, [...(edges.get(key) || []), normal]);
      }
    }
    const lines = [];
    for (const [key, normals] of edges) {
      if (normals.length > 1 && dot(normals[0], normals[1]) > 0.95) continue;
      for (const id of key.split(",")) lines.push(...corners.slice(3 * id, 3 * id + 3), 0, 0, 0);
    }
    return { data: new Float32Array(data), lines: new Float32Array(lines) };
  };
  const ARROW = (() => {
    // A shaft and a head along +z, of length 1; x and y are scaled apart.
    const n = 10, corners = [], triangles = [];
    const ring = (radius, z) => { for (let i = 0; i < n; i++) corners.push(radius * Math.cos(6.2832 * i / n), radius * Math.sin(6.2832 * i / n), z); };
    ring(0.3, 0); ring(0.3, 0.65); ring(0.8, 0.65); corners.push(0, 0, 1, 0, 0, 0);
    for (let i = 0; i < n; i++) {
      const j = (i + 1) % n;
      triangles.push(i, j, n + j, i, n + j, n + i, n + i, n + j, 2 * n + j, n + i, 2 * n + j, 2 * n + i, 2 * n + i, 2 * n + j, 3 * n, i, 3 * n + 1, j);
    }
    return flat(corners, triangles);
  })();

  class View {
    constructor(canvas, film) {
      Object.assign(this, { canvas, film });
      const gl = (this.gl = canvas.getContext("webgl", { antialias: true, preserveDrawingBuffer: true }));
      if (!gl) { canvas.replaceWith(Object.assign(document.createElement("p"), { textContent: "This browser shows no 3-D: it has no WebGL. The curves below are whole." })); return; }
      const program = gl.createProgram();
      for (const [kind, source] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, FRAGMENT]]) {
        const shader = gl.createShader(kind);
        gl.shaderSource(shader, source); gl.compileShader(shader); gl.attachShader(program, shader);
      }
      gl.linkProgram(program); gl.useProgram(program);
      this.place = Object.fromEntries(["model", "view", "colour"].map((name) => [name, gl.getUniformLocation(program, name)]));
      this.slot = ["point", "normal"].map((name) => gl.getAttribLocation(program, name));
      this.slot.forEach((slot) => gl.enableVertexAttribArray(slot));
      gl.enable(gl.DEPTH_TEST); gl.depthFunc(gl.LEQUAL);
      // Faces a little behind, so that the edges on them are whole.
      gl.enable(gl.POLYGON_OFFSET_FILL); gl.polygonOffset(1, 2); gl.blendFuncSeparate(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA, gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
      this.buffer = gl.createBuffer();
      this.bodies = film.bodies.map((body) => {
        const mesh = flat(body.points, body.triangles);
        return { kind: body.kind, of: body.of, solid: this.keep(mesh.data), lines: this.keep(mesh.lines) };
      });
      const arrow = ARROW; this.arrow = this.keep(arrow.data);
    }
    keep(data) {
      const { gl } = this, buffer = gl.createBuffer();
      gl.bindBuffer(gl.ARRAY_BUFFER, buffer); gl.bufferData(gl.ARRAY_BUFFER, data, gl.STATIC_DRAW);
      return { buffer, count: data.length / 6 };
    }
    draw({ buffer, count }, mode, model, colour, alpha = 1) {
      const { gl, place, slot } = this;
      gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
      gl.vertexAttribPointer(slot[0], 3, gl.FLOAT, false, 24, 0);
      gl.vertexAttribPointer(slot[1], 3, gl.FLOAT, false, 24, 12);
      gl.uniformMatrix4fv(place.model, false, model); gl.uniform4f(place.colour, ...colour, alpha);
      gl.drawArrays(mode, 0, count);
    }
    camera() {
      const { yaw, pitch, distance, target } = state;
      const out = [Math.cos(pitch) * Math.cos(yaw), Math.cos(pitch) * Math.sin(yaw), Math.sin(pitch)];
      const right = unit(cross([0, 0, 1], out)), up = cross(out, right), eye = add(target, times(out, distance));
      const look = [right[0], up[0], out[0], 0, right[1], up[1], out[1], 0, right[2], up[2], out[2], 0, -dot(right, eye), -dot(up, eye), -dot(out, eye), 1];
      const f = 1 / Math.tan(0.3), aspect = this.canvas.width / this.canvas.height, [near, far] = [1, 1000];
      return product([f / aspect, 0, 0, 0, 0, f, 0, 0, 0, 0, (far + near) / (near - far), -1, 0, 0, 2 * far * near / (near - far), 0], look);
    }
    show() {
      if (!this.gl) return;
      const { gl, film, canvas } = this, ratio = window.devicePixelRatio || 1;
      const [width, height] = [canvas.clientWidth, canvas.clientHeight].map((v) => Math.max(1, Math.round(v * ratio)));
      if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
      gl.viewport(0, 0, width, height); gl.clearColor(0, 0, 0, 0); gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
      gl.uniformMatrix4fv(this.place.view, false, this.camera());
      const when = frameAt(film, state.time), pose = { socket: STILL };
      for (const name of Object.keys(film.pose)) pose[name] = poseAt(film, name, when);
      const outline = matchMedia("(prefers-color-scheme: dark)").matches ? [0.9, 0.9, 0.9] : [0.15, 0.15, 0.15];
      gl.disable(gl.BLEND); gl.depthMask(true);
      for (const body of this.bodies.filter((body) => body.of !== "socket")) {
        const model = matrix(pose[body.of]);
        this.draw(body.solid, gl.TRIANGLES, model, BODY[body.kind]);
        this.draw(body.lines, gl.LINES, model, outline);
      }
      [0, 1].forEach((side) => this.beam(pose["finger" + side], pose["jaw" + side], side, outline));
      const still = matrix(STILL);
      gl.enable(gl.BLEND); gl.depthMask(false);
      for (const body of this.bodies.filter((body) => body.of === "socket")) {
        this.draw(body.solid, gl.TRIANGLES, still, BODY[body.kind], body.kind === "socket" && at("glass").checked ? 0.22 : 1);
        this.draw(body.lines, gl.LINES, still, outline, 0.7);
      }
      gl.depthMask(true); gl.disable(gl.DEPTH_TEST); gl.disable(gl.BLEND);
      for (const kind of ["contact", "grip"]) if (at(kind).checked) this.arrows(film[kind][when.index], BODY[kind]);
      gl.enable(gl.DEPTH_TEST);
    }
    // The finger between its tip, at its simulated position, and its jaw, which is moved to
    // magnify the bend.
    beam(tip, jaw, side, outline) {
      const { half_mm: half, thick_mm: thick, low_mm: low, high_mm: high } = this.film.beam, sign = side ? 1 : -1;
      const bent = sub(placed(tip, [0, 0, low]), placed(jaw, [0, 0, low]));
      const corners = [], triangles = [], slices = 10;
      for (let i = 0; i <= slices; i++) {
        const s = i / slices, z = high + s * (low - high), share = s * s * (3 - 2 * s);
        for (const [x, y] of [[-half, 0], [half, 0], [half, sign * thick], [-half, sign * thick]]) {
          corners.push(...add(placed(jaw, [x, y, z]), times(bent, 1 - state.bend * (1 - share))));
        }
      }
      for (let i = 0; i < slices; i++) for (let k = 0; k < 4; k++) {
        const [a, b, c, d] = [4 * i + k, 4 * i + (k + 1) % 4, 4 * i + 4 + k, 4 * i + 4 + (k + 1) % 4];
        triangles.push(a, b, d, a, d, c);
      }
      const mesh = flat(corners, triangles), { gl } = this, still = matrix(STILL);
      for (const [data, mode, colour] of [[mesh.data, gl.TRIANGLES, BODY.beam], [mesh.lines, gl.LINES, outline]]) {
        gl.bindBuffer(gl.ARRAY_BUFFER, this.buffer); gl.bufferData(gl.ARRAY_BUFFER, data, gl.DYNAMIC_DRAW);
        this.draw({ buffer: this.buffer, count: data.length / 6 }, mode, still, colour);
      }
    }
    arrows(points, colour) {
      for (let i = 0; i + 5 < points.length; i += 6) {
        const force = points.slice(i + 3, i + 6), size = Math.hypot(...force);
        if (size < LEAST) continue;
        const length = Math.min(LONGEST, 1.5 + MM_PER_N * size), z = unit(force), tip = points.slice(i, i + 3);
        const x = unit(cross(Math.abs(z[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0], z)), y = cross(z, x), from = sub(tip, times(z, length));
        this.draw(this.arrow, this.gl.TRIANGLES, [...times(x, 0.7), 0, ...times(y, 0.7), 0, ...times(z, length), 0, ...from, 1], colour);
      }
    }
  }

  // --- curves
  const SVG = "http://www.w3.org/2000/svg";
  const make = (name, attributes, text) => {
    const element = document.createElementNS(SVG, name);
    for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
    if (text !== undefined) element.textContent = text;
    return element;
  };
  const W = 300, H = 110, LEFT = 40, TOP = 18, FOOT = 16;
  const cursors = [];
  const curve = (title, key, unitName) => {
    const all = films.flatMap((film) => film[key]), low = Math.min(0, ...all), high = Math.max(...all, low + 1e-3);
    const x = (t) => LEFT + (W - LEFT - 6) * t / end, y = (v) => H - FOOT - (H - FOOT - TOP) * (v - low) / (high - low);
    const svg = make("svg", { viewBox: `0 0 ${W} ${H}`, role: "img", "aria-label": `${title} over time` });
    svg.append(make("text", { x: LEFT, y: 12 }, `${title} (${unitName})`));
    for (const v of [low, high]) {
      svg.append(make("line", { x1: LEFT, x2: W - 6, y1: y(v), y2: y(v), class: "grid" }));
      svg.append(make("text", { x: LEFT - 4, y: y(v) + 4, "text-anchor": "end" }, String(+v.toPrecision(3))));
    }
    svg.append(make("text", { x: W - 6, y: H - 3, "text-anchor": "end" }, `${end.toFixed(2)} s`));
    films.forEach((film, i) => svg.append(make("polyline", { class: `film${i}`, points: film.time.map((t, n) => `${x(t).toFixed(1)},${y(film[key][n]).toFixed(1)}`).join(" ") })));
    const cursor = svg.appendChild(make("line", { class: "cursor", y1: TOP, y2: H - FOOT }));
    const value = svg.appendChild(make("text", { x: LEFT, y: H - 3 }));
    cursors.push(() => {
      cursor.setAttribute("x1", x(state.time)); cursor.setAttribute("x2", x(state.time));
      value.textContent = films.map((film) => film[key][frameAt(film, state.time).index].toFixed(2)).join(" | ");
    });
    const seek = (event) => {
      const box = svg.getBoundingClientRect();
      seekTo((((event.clientX - box.left) / box.width) * W - LEFT) / (W - LEFT - 6) * end);
    };
    svg.addEventListener("pointerdown", (event) => { svg.setPointerCapture(event.pointerId); seek(event); });
    svg.addEventListener("pointermove", (event) => event.buttons && seek(event));
    at("curves").append(svg);
  };

  // --- controls
  const views = films.map((film, i) => new View(at("film" + i), film));
  const refresh = () => {
    views.forEach((view) => view.show());
    cursors.forEach((move) => move());
    at("time").value = state.time;
    at("clock").textContent = `${state.time.toFixed(3)} s`;
    films.forEach((film, i) => {
      const phase = film.phases.find(([, until]) => state.time < until) || film.phases[film.phases.length - 1];
      at("phase" + i).textContent = phase ? phase[0] : "";
      const outcome = at("outcome" + i);
      outcome.textContent = shown(film); outcome.dataset.kind = state.time + 1e-9 >= film.decided_s ? film.kind : "open";
    });
    document.querySelectorAll("#phases button").forEach((button) => button.setAttribute("aria-current", String(state.time >= +button.dataset.from && state.time < +button.dataset.until)));
  };
  const seekTo = (time) => { state.time = Math.min(end, Math.max(0, time)); refresh(); };
  let last = 0;
  const tick = (now) => {
    if (!state.playing) return;
    const time = state.time + state.speed * Math.min(0.1, (now - last) / 1000);
    last = now;
    if (time >= end) play(false);
    seekTo(time);
    if (state.playing) requestAnimationFrame(tick);
  };
  const play = (on) => {
    if (on && state.time >= end) state.time = compact ? begin : 0;
    state.playing = on; at("play").textContent = on ? "Pause" : "Play";
    if (compact) window.parent.postMessage(on ? "playing" : "paused", "*");
    if (on) { last = performance.now(); requestAnimationFrame(tick); }
  };
  at("time").max = end;
  at("time").addEventListener("input", (event) => { play(false); seekTo(+event.target.value); });
  at("play").addEventListener("click", () => play(!state.playing));
  at("speed").addEventListener("change", (event) => { state.speed = +event.target.value; });
  at("bend").addEventListener("input", (event) => { state.bend = +event.target.value; at("times").textContent = `${state.bend} times`; refresh(); });
  for (const id of ["contact", "grip", "glass"]) at(id).addEventListener("change", refresh);
  let before = 0;
  const longest = films.reduce((a, b) => (b.phases.length > a.phases.length ? b : a));
  for (const [name, until] of longest.phases) {
    const button = Object.assign(document.createElement("button"), { type: "button", textContent: name });
    Object.assign(button.dataset, { from: before, until });
    const from = before;
    button.addEventListener("click", () => { play(false); seekTo(from); });
    at("phases").append(button);
    before = until;
  }
  const orbit = (dx, dy) => { state.yaw -= dx; state.pitch = Math.min(1.5, Math.max(-1.5, state.pitch + dy)); refresh(); };
  const zoom = (factor) => { state.distance = Math.min(400, Math.max(15, state.distance * factor)); refresh(); };
  const KEYS = { ArrowLeft: () => orbit(0.1, 0), ArrowRight: () => orbit(-0.1, 0), ArrowUp: () => orbit(0, 0.1), ArrowDown: () => orbit(0, -0.1), "+": () => zoom(0.9), "-": () => zoom(1.1) };
  for (const { canvas } of views) {
    const held = new Map();
    let moved = 0;
    canvas.addEventListener("pointerdown", () => { moved = 0; });
    canvas.addEventListener("pointermove", (event) => { moved += Math.abs(event.movementX) + Math.abs(event.movementY); });
    canvas.addEventListener("click", () => { if (compact && moved < 6) play(!state.playing); });
    canvas.addEventListener("pointerdown", (event) => { canvas.setPointerCapture(event.pointerId); held.set(event.pointerId, [event.clientX, event.clientY]); });
    for (const name of ["pointerup", "pointercancel"]) canvas.addEventListener(name, (event) => held.delete(event.pointerId));
    canvas.addEventListener("pointermove", (event) => {
      const was = held.get(event.pointerId);
      if (!was) return;
      const apart = () => { const [a, b] = [...held.values()]; return Math.hypot(a[0] - b[0], a[1] - b[1]); };
      const before = held.size === 2 ? apart() : 0;
      held.set(event.pointerId, [event.clientX, event.clientY]);
      if (held.size === 2) { zoom(before / (apart() || 1)); return; }
      if (event.shiftKey) { state.target[2] += 0.15 * (event.clientY - was[1]); refresh(); return; }
      orbit((event.clientX - was[0]) * 0.01, (event.clientY - was[1]) * 0.01);
    });
    canvas.addEventListener("wheel", (event) => { event.preventDefault(); zoom(event.deltaY > 0 ? 1.1 : 0.9); }, { passive: false });
    canvas.addEventListener("keydown", (event) => { const act = KEYS[event.key]; if (act) { event.preventDefault(); act(); } });
  }
  curve("force of the socket on the plug", "force", "N");
  curve("depth of the tip", "depth", "mm");
  curve("tilt", "tilt", "°");
  curve("slip in the grasp", "slip", "mm");
  window.addEventListener("resize", refresh);
  // In a report, playback begins with the search.
  const grasp = films[0].phases.findIndex(([name]) => name === "carry");
  const begin = grasp >= 0 ? films[0].phases[grasp][1] : 0;
  seekTo(compact ? end : 0);
  if (compact) {
    window.addEventListener("message", ({ source }) => { if (source === window.parent) play(!state.playing); });
    window.parent.postMessage(document.querySelector("canvas") ? "ready" : "picture", "*");
  }
})();
