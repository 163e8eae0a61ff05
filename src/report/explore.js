"use strict";
(() => {
  const data = JSON.parse(document.getElementById("study").textContent);
  const at = (id) => document.getElementById(id);
  const root = at("explore"), tip = at("tip"), NS = at("surface").namespaceURI;
  const make = (name, attributes, parent, text) => {
    const element = document.createElementNS(NS, name);
    for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
    if (text !== undefined) element.textContent = text;
    if (parent) parent.append(element);
    return element;
  };
  const number = (v, digits = 1) => (v === null || v === undefined ? "none" : v.toFixed(digits));
  const signed = (v) => (v > 0 ? "+" : "") + number(v);
  const value = (e) => `${data.measure.name} ${number(e.value, data.measure.unit ? 1 : 3)} ${e.value === null ? "" : data.measure.unit}`.trim();
  const words = (e) => [`evaluation ${e.index}`, ...data.parameters.map((p, k) => `${p.label} ${e.x[k]}${p.unit}`), e.raced ? `${data.measure.name} ${e.raced}` : value(e), e.window ? `window ${signed(e.window[0])} to ${signed(e.window[1])} mm: ${e.ends[0]} below, ${e.ends[1]} above` : `nominal start: ${e.ends[0]}`, e.force === null ? "" : `peak force ${number(e.force)} N`, e.feasible ? "" : "breaks a constraint"].filter(Boolean);
  const hover = (element, text) => {
    const show = (event) => {
      tip.textContent = typeof text === "function" ? text() : text;
      tip.hidden = false;
      const box = tip.getBoundingClientRect();
      const [x, y] = event.clientX === undefined ? [20, 20] : [event.clientX, event.clientY];
      tip.style.left = `${Math.max(4, Math.min(x + 14, innerWidth - box.width - 6))}px`;
      tip.style.top = `${y + 18 + box.height > innerHeight ? y - box.height - 10 : y + 18}px`;
    };
    element.addEventListener("pointermove", show);
    element.addEventListener("pointerleave", () => { tip.hidden = true; });
  };
  const marks = new Map();
  let chosen = data.best;
  const select = (index) => {
    for (const element of marks.get(chosen) || []) element.classList.remove("chosen");
    chosen = index;
    for (const element of marks.get(chosen) || []) element.classList.add("chosen");
    const found = data.evaluations.find((e) => e.index === chosen);
    if (found) at("selected").textContent = words(found).join("; ") + (chosen === data.best ? " (recommended)" : "");
  };
  const mark = (element, e) => {
    marks.set(e.index, [...(marks.get(e.index) || []), element]);
    element.classList.add("mark");
    if (e.index === data.best) element.classList.add("best");
    if (!e.feasible || e.value === null) element.classList.add("bad");
    element.addEventListener("click", () => select(e.index));
    hover(element, words(e).join("\n"));
    return element;
  };
  // A dot in a light ring, seen on every colour; about the recommended one a black ring in a white one.
  const spot = (svg, cx, cy, e, fill) => {
    const group = make("g", {}, svg), best = e.index === data.best;
    for (const [r, name] of best ? [[11, "halo"], [9, "ring"], [6, "halo"]] : fill ? [[5.4, "halo"]] : []) make("circle", { cx, cy, r, class: name }, group);
    make("circle", { cx, cy, r: best ? 5 : 4, class: "core", ...(fill ? { style: `fill:${fill}` } : {}) }, group);
    return mark(group, e);
  };
  const values = data.evaluations.map((e) => e.value).filter((v) => v !== null);
  const sorted = [...values].filter((v) => v !== 0).sort((a, b) => a - b);
  const low = sorted.length ? sorted[Math.floor(0.05 * (sorted.length - 1))] : 0, high = sorted.length ? sorted[sorted.length - 1] : 1;
  const STOPS = [[68, 1, 84], [59, 82, 139], [33, 145, 140], [94, 201, 98], [253, 231, 37]];
  const colour = (v) => {
    if (v === null) return "var(--lines)";
    const share = Math.min(1, Math.max(0, high > low ? (v - low) / (high - low) : 1)) * (STOPS.length - 1);
    const k = Math.min(STOPS.length - 2, Math.floor(share)), part = share - k;
    return `rgb(${STOPS[k].map((c, i) => Math.round(c + part * (STOPS[k + 1][i] - c))).join()})`;
  };
  // Drawn about as large as shown, so that text stays text on a phone.
  const narrow = innerWidth < 600, W = narrow ? 370 : 560, H = narrow ? 330 : 400, LEFT = 58, RIGHT = 14, TOP = 12, FOOT = 46;
  const scale = (from, to, a, b) => (v) => a + (b - a) * (to !== from ? (v - from) / (to - from) : 0.5);
  const nice = (a, b) => {
    const raw = (b - a) / (narrow ? 4 : 5) || 1, power = 10 ** Math.floor(Math.log10(raw)), step = [1, 2, 5, 10].map((k) => k * power).find((s) => s >= raw) || raw;
    const out = [];
    for (let v = Math.ceil(a / step) * step; v <= b + 1e-9; v += step) out.push(+v.toPrecision(6));
    return out;
  };
  const axes = (svg, [xa, xb], [ya, yb], xlabel, ylabel) => {
    svg.setAttribute("viewBox", `0 0 ${W} ${H}`);
    const x = scale(xa, xb, LEFT, W - RIGHT), y = scale(ya, yb, H - FOOT, TOP);
    for (const v of nice(xa, xb)) { make("line", { x1: x(v), x2: x(v), y1: TOP, y2: H - FOOT, class: "grid" }, svg); make("text", { x: x(v), y: H - FOOT + 18, "text-anchor": "middle" }, svg, v); }
    for (const v of nice(ya, yb)) { make("line", { x1: LEFT, x2: W - RIGHT, y1: y(v), y2: y(v), class: "grid" }, svg); make("text", { x: LEFT - 6, y: y(v) + 5, "text-anchor": "end" }, svg, v); }
    make("text", { x: (LEFT + W - RIGHT) / 2, y: H - 6, "text-anchor": "middle" }, svg, xlabel);
    make("text", { transform: `translate(14 ${(TOP + H - FOOT) / 2}) rotate(-90)`, "text-anchor": "middle" }, svg, ylabel);
    return [x, y];
  };
  const span = (list, room = 0.06) => {
    const [a, b] = [Math.min(...list), Math.max(...list)], more = (b - a || 1) * room;
    return [a - more, b + more];
  };
  const axis = (p) => `${p.label}${p.unit ? ` (${p.unit.trim()})` : ""}`;
  const draw = {
    surface() {
      const svg = at("surface"), model = data.model;
      const [p, q] = model ? model.axes.map((k) => data.parameters[k]) : [data.parameters[0], data.parameters[1]];
      if (!q) { svg.closest("figure").hidden = true; return; }
      const [i, j] = model ? model.axes : [0, 1], half = (axisOf, n) => (axisOf.high - axisOf.low) / Math.max(1, n - 1) / 2;
      const [hx, hy] = model ? [half(p, model.x.length), half(q, model.y.length)] : [0.5, 0.5];
      const [x, y] = axes(svg, [p.low - hx, p.high + hx], [q.low - hy, q.high + hy], axis(p), axis(q));
      if (model) model.mean.forEach((mean, n) => {
        const [vx, vy] = [model.x[n % model.x.length], model.y[Math.floor(n / model.x.length)]];
        const cell = make("rect", { x: x(vx - hx), y: y(vy + hy), width: x(vx + hx) - x(vx - hx) + 0.4, height: y(vy - hy) - y(vy + hy) + 0.4, fill: colour(mean) }, svg);
        hover(cell, `${p.label} ${vx}${p.unit}, ${q.label} ${vy}${q.unit}\nmodel: ${number(mean, 2)} ± ${number(model.sd[n], 2)} ${data.measure.unit}`);
      });
      for (const e of data.evaluations) spot(svg, x(e.x[i]), y(e.x[j]), e, colour(e.value));
      const bar = at("scale");
      bar.setAttribute("viewBox", `0 0 ${W} 40`);
      for (let k = 0; k < 60; k++) make("rect", { x: LEFT + k * (W - LEFT - RIGHT) / 60, y: 2, width: (W - LEFT - RIGHT) / 60 + 0.5, height: 14, fill: colour(low + (high - low) * k / 59) }, bar);
      make("text", { x: LEFT, y: 34 }, bar, `${number(low, 2)} or less`);
      make("text", { x: W - RIGHT, y: 34, "text-anchor": "end" }, bar, `${number(high, 2)} ${data.measure.unit}`);
    },
    windows() {
      const svg = at("bars"), shown = data.evaluations.filter((e) => e.window).sort((a, b) => b.window[1] - b.window[0] - a.window[1] + a.window[0]).slice(0, 40);
      if (!shown.length) { svg.closest("figure").hidden = true; return; }
      const [x, y] = axes(svg, span(shown.flatMap((e) => e.window).concat(0)), [shown.length, 0], "offset of the start (mm)", "place by range");
      shown.forEach((e, n) => {
        const at = { x: x(e.window[0]), width: Math.max(1, x(e.window[1]) - x(e.window[0])) }, [top, foot] = [y(n + 0.12), y(n + 0.88)];
        mark(make("rect", { ...at, y: top, height: foot - top, style: `fill:${colour(e.value)}` }, svg), e);
        if (e.index === data.best) make("path", { class: "pointer", d: `M${at.x - 4} ${(top + foot) / 2}l-9 -6v12z` }, svg);
      });
      make("line", { x1: x(0), x2: x(0), y1: TOP, y2: H - FOOT, class: "zero" }, svg);
    },
    course() {
      const svg = at("course"), known = data.evaluations.filter((e) => e.value !== null);
      if (!known.length) return;
      const [x, y] = axes(svg, span(known.map((e) => e.index), 0.02), span(values), "evaluation", data.measure.label);
      let best = null;
      const path = [];
      for (const e of known) {
        if (e.feasible && (best === null || data.measure.sense * e.value > data.measure.sense * best)) { if (best !== null) path.push([e.index, best]); best = e.value; path.push([e.index, best]); }
      }
      if (best !== null) path.push([known[known.length - 1].index, best]);
      make("polyline", { class: "line", points: path.map(([a, b]) => `${x(a)},${y(b)}`).join(" ") }, svg);
      for (const e of known) spot(svg, x(e.index), y(e.value), e);
    },
    force() {
      const svg = at("force"), known = data.evaluations.filter((e) => e.window && e.force !== null);
      if (!known.length) { svg.closest("figure").hidden = true; return; }
      const range = (e) => e.window[1] - e.window[0];
      const [x, y] = axes(svg, span(known.map(range)), span(known.map((e) => e.force)), "range (mm)", "peak force (N)");
      for (const e of known) spot(svg, x(range(e)), y(e.force), e);
    },
    parallel() {
      const svg = at("parallel");
      if (data.parameters.length < 3) { svg.closest("figure").hidden = true; return; }
      svg.setAttribute("viewBox", `0 0 ${W} ${H}`);
      const lines = [...data.parameters.map((p, k) => ({ name: p.label, low: p.low, high: p.high, of: (e) => e.x[k] })), { name: data.measure.label, low, high, of: (e) => e.value ?? low }];
      const x = (k) => 40 + k * (W - 80) / (lines.length - 1), y = (line, v) => H - 50 - (H - 90) * (line.high > line.low ? (Math.max(line.low, v) - line.low) / (line.high - line.low) : 0.5);
      lines.forEach((line, k) => {
        make("line", { x1: x(k), x2: x(k), y1: 40, y2: H - 50, class: "zero" }, svg);
        make("text", { x: x(k), y: k % 2 ? 14 : 28, "text-anchor": "middle", class: "small" }, svg, line.name);
        make("text", { x: x(k), y: H - 34, "text-anchor": "middle", class: "small" }, svg, +line.low.toPrecision(3));
        make("text", { x: x(k), y: 38, "text-anchor": "middle", class: "small" }, svg, +line.high.toPrecision(3));
      });
      for (const e of data.evaluations) mark(make("polyline", { points: lines.map((line, k) => `${x(k)},${y(line, line.of(e))}`).join(" "), style: `stroke:${colour(e.value)}`, class: "thread" }, svg), e);
    },
  };
  for (const one of Object.values(draw)) one();
  for (const element of marks.get(data.best) || []) element.parentNode.append(element);
  select(data.best);
  root.addEventListener("keydown", (event) => {
    const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    if (!step) return;
    const all = data.evaluations.map((e) => e.index), now = all.indexOf(chosen);
    event.preventDefault();
    select(all[(now + step + all.length) % all.length]);
  });
  for (const button of document.querySelectorAll("button[data-film]")) {
    button.addEventListener("click", () => {
      const frame = at("film");
      frame.srcdoc = JSON.parse(at(button.dataset.film).textContent);
      at("player").showModal();
    });
  }
  const player = at("player");
  if (player) {
    at("close").addEventListener("click", () => player.close());
    // The film is a document of its own, which can be heard, not looked into.
    window.addEventListener("message", ({ source, data }) => {
      if (source !== at("film").contentWindow) return;
      if (data === "ready") { player.dataset.ready = ""; at("film").focus(); }
      if (data === "close") player.close();
    });
    player.addEventListener("close", () => { at("film").srcdoc = ""; delete player.dataset.ready; });
  }
})();
