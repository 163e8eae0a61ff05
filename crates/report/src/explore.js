"use strict";
(() => {
  const data = JSON.parse(document.getElementById("study").textContent);
  const at = (id) => document.getElementById(id);
  const root = at("explore"), tip = at("tip"), surface = at("surface"), NS = surface.namespaceURI;
  const fill = (element, attributes, parent, text) => {
    for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
    if (text !== undefined) element.textContent = text;
    if (parent) parent.append(element);
    return element;
  };
  const make = (name, attributes, parent, text) => fill(document.createElementNS(NS, name), attributes, parent, text);
  const part = (name, attributes, parent, text) => fill(document.createElement(name), attributes, parent, text);
  const unit = data.measure.unit, digits = unit ? 1 : 3;
  const number = (v, places = 1) => (v === null || v === undefined ? "none" : v.toFixed(places));
  const signed = (v) => (v > 0 ? "+" : "") + number(v);
  const designs = data.evaluations.map(([index, x, value, feasible, window, ends, force, stiffness]) => ({ index, x, value, feasible, window, ends: (ends || []).map((k) => data.outcomes[k]), force, stiffness }));
  const byIndex = new Map(designs.map((e) => [e.index, e]));
  const valued = (e) => data.raced[e.index] || (e.value === null ? "none" : `${number(e.value, digits)} ${unit}`.trim());
  const named = (e) => data.parameters.map((p, k) => `${p.label} ${e.x[k]}${p.unit}`).join(", ");
  const fails = (e) => !e.window;
  const windowed = (e) => (e.window ? `${signed(e.window[0])} to ${signed(e.window[1])} mm` : `none: ${e.ends[0] || "not simulated"} at the nominal start`);
  const command = (e) => `${data.command} ${data.parameters.map((p, k) => p.option + e.x[k]).join(" ")} --offset-mm ${e.window ? +(e.window[1] + 0.1).toFixed(1) : 0} --record trial.html`;

  // --- choosing
  const marks = new Map();
  let chosen = data.best ?? designs[0].index, kept = null;
  const select = (index) => {
    for (const of of [chosen, index]) marks.get(of)?.classList.toggle("chosen", of === index);
    chosen = index;
    for (const row of body.rows) row.classList.toggle("chosen", +row.dataset.index === chosen);
    details();
  };
  const all = designs.filter((e) => e.window).flatMap((e) => e.window).concat(0);
  const [lowest, highest] = [all.reduce((a, b) => Math.min(a, b)), all.reduce((a, b) => Math.max(a, b))];
  const place = (mm) => `${(100 * (mm - lowest) / (highest - lowest || 1)).toFixed(1)}%`;
  const details = () => {
    const box = at("selected");
    box.replaceChildren();
    for (const e of [...new Set([kept, chosen])].map((index) => byIndex.get(index)).filter(Boolean)) {
      const card = part("div", { class: "card" }, box), list = (name, text) => { if (text) { part("dt", {}, list.of, name); part("dd", {}, list.of, text); } };
      part("h3", {}, card, named(e) + (e.index === data.best ? " (recommended)" : ""));
      const track = part("div", { class: "track" }, card);
      if (e.window) part("i", { class: "light", style: `left:${place(e.window[0])};width:${(100 * (e.window[1] - e.window[0]) / (highest - lowest || 1)).toFixed(1)}%` }, track);
      part("b", { style: `left:${place(0)}` }, track);
      list.of = part("dl", {}, card);
      list("evaluation", String(e.index));
      list(`searched ${data.measure.name}`, valued(e) + (e.feasible ? "" : e.value === null ? "" : ", violates a constraint"));
      list(`window${data.on}`, windowed(e));
      list("ends", e.window && `${e.ends[0]} below, ${e.ends[1]} above`);
      list("confirmed, firm", data.confirmed[e.index] !== undefined && `${number(data.confirmed[e.index])} mm`);
      list("on a robot", data.robot[e.index] !== undefined && `${number(data.robot[e.index])} mm`);
      list("peak force", e.force !== null && `${number(e.force)} N`);
      list("stiffness across", `${number(e.stiffness, 2)} N/mm`);
      const buttons = part("p", { class: "files" }, card);
      if (e.index === data.best && at("film0")) part("button", { type: "button" }, buttons, "Play its replay").addEventListener("click", () => { at("film").scrollIntoView({ block: "center" }); play(0); });
      else { part("p", { class: "muted" }, card, "Its replay, just outside its window:"); part("code", {}, part("pre", {}, card), command(e)); }
      const label = kept === e.index ? "Let go" : "Keep to compare";
      part("button", { type: "button" }, buttons, label).addEventListener("click", () => { kept = kept === e.index ? null : e.index; details(); });
    }
  };

  // --- the surface
  const narrow = innerWidth < 600, W = narrow ? 350 : 560, H = narrow ? 330 : 400, LEFT = 58, RIGHT = 14, TOP = 12, FOOT = 46;
  const scale = (from, to, a, b) => (v) => a + (b - a) * (to !== from ? (v - from) / (to - from) : 0.5);
  const nice = (a, b, count = narrow ? 4 : 5) => {
    const raw = (b - a) / count || 1, power = 10 ** Math.floor(Math.log10(raw)), step = [1, 2, 5, 10].map((k) => k * power).find((s) => s >= raw) || raw, out = [];
    for (let v = Math.ceil(a / step - 1e-9) * step; v <= b + 1e-9 * step; v += step) out.push(+v.toPrecision(6));
    return out;
  };
  const STOPS = [[68, 1, 84], [59, 82, 139], [33, 145, 140], [94, 201, 98], [253, 231, 37]];
  const ramp = (low, high) => (v) => {
    const share = Math.min(1, Math.max(0, high > low ? (v - low) / (high - low) : 1)) * (STOPS.length - 1);
    const k = Math.min(STOPS.length - 2, Math.floor(share)), rest = share - k;
    return `rgb(${STOPS[k].map((c, i) => Math.round(c + rest * (STOPS[k + 1][i] - c))).join()})`;
  };
  const values = designs.map((e) => e.value).filter((v) => v !== null && v !== 0).sort((a, b) => a - b);
  // From the lowest twentieth on, so that failures do not flatten it.
  const least = values.length ? values[Math.floor(0.05 * (values.length - 1))] : 0, most = values.length ? values[values.length - 1] : 1;
  const model = data.model, [i, j] = model ? model.axes : [0, 1], [p, q] = [data.parameters[i], data.parameters[j]];
  const axis = (of) => `${of.label}${of.unit ? ` (${of.unit.trim()})` : ""}`;
  const cells = [];
  const colours = (shown) => {
    const of = model ? model[shown] : [], [low, high] = shown === "sd" ? [0, of.reduce((a, b) => Math.max(a, b), 1e-9)] : [least, most], colour = ramp(low, high);
    cells.forEach((cell, k) => cell.setAttribute("fill", colour(of[k])));
    const bar = at("scale");
    if (!values.length) return colour;
    bar.replaceChildren();
    bar.setAttribute("viewBox", `0 0 ${W} 56`);
    const x = scale(low, high, LEFT, W - RIGHT);
    for (let k = 0; k < 60; k++) make("rect", { x: LEFT + k * (W - LEFT - RIGHT) / 60, y: 2, width: (W - LEFT - RIGHT) / 60 + 0.5, height: 14, fill: colour(low + (high - low) * k / 59) }, bar);
    for (const v of nice(low, high)) { make("line", { x1: x(v), x2: x(v), y1: 16, y2: 21, class: "zero" }, bar); make("text", { x: x(v), y: 35, "text-anchor": "middle" }, bar, v); }
    make("text", { x: (LEFT + W - RIGHT) / 2, y: 52, "text-anchor": "middle" }, bar, shown === "sd" ? `deviation of the model${unit && ` (${unit})`}` : `${data.measure.label}, darkest: ${number(low, 2)} or less`);
    return colour;
  };
  if (!q) at("map").hidden = true;
  else {
    surface.setAttribute("viewBox", `0 0 ${W} ${H}`);
    const half = (of, n) => (of.high - of.low) / Math.max(1, n - 1) / 2, [hx, hy] = model ? [half(p, model.x.length), half(q, model.y.length)] : [0.5, 0.5];
    const x = scale(p.low - hx, p.high + hx, LEFT, W - RIGHT), y = scale(q.low - hy, q.high + hy, H - FOOT, TOP);
    for (const v of nice(p.low, p.high)) make("text", { x: x(v), y: H - FOOT + 18, "text-anchor": "middle" }, surface, v);
    for (const v of nice(q.low, q.high)) make("text", { x: LEFT - 6, y: y(v) + 5, "text-anchor": "end" }, surface, v);
    make("text", { x: (LEFT + W - RIGHT) / 2, y: H - 6, "text-anchor": "middle" }, surface, axis(p));
    make("text", { transform: `translate(14 ${(TOP + H - FOOT) / 2}) rotate(-90)`, "text-anchor": "middle" }, surface, axis(q));
    if (model) model.mean.forEach((_, n) => {
      const [vx, vy] = [model.x[n % model.x.length], model.y[Math.floor(n / model.x.length)]];
      cells.push(make("rect", { x: x(vx - hx), y: y(vy + hy), width: x(vx + hx) - x(vx - hx) + 0.4, height: y(vy - hy) - y(vy + hy) + 0.4, "data-cell": n }, surface));
    });
    else make("rect", { x: LEFT, y: TOP, width: W - LEFT - RIGHT, height: H - FOOT - TOP, fill: "none", class: "zero" }, surface);
    const colour = colours("mean");
    // A dot in a light ring; about the recommended one a black ring in a white one; bars where it fails.
    for (const e of [...designs.filter((e) => e.index !== data.best), ...designs.filter((e) => e.index === data.best)]) {
      const best = e.index === data.best, bad = fails(e) || !e.feasible, [cx, cy] = [x(e.x[i]), y(e.x[j])];
      const group = make("g", { class: `mark${best ? " best" : ""}${bad ? " bad" : ""}`, "data-index": e.index, transform: `translate(${cx.toFixed(1)} ${cy.toFixed(1)})` }, surface);
      for (const [r, name] of best ? [[11, "halo"], [9, "ring"], [6, "halo"]] : []) make("circle", { r, class: name }, group);
      make("circle", { r: best ? 5 : 4.5, class: "core", ...(bad || e.value === null ? {} : { style: `fill:${colour(e.value)}` }) }, group);
      if (fails(e)) make("path", { d: "M-4 0L0 -4M-3.2 3.2L3.2 -3.2M0 4L4 0", class: "bars" }, group);
      marks.set(e.index, group);
    }
    at("shown").hidden = !model;
    at("shown").addEventListener("change", (event) => colours(event.target.value));
    const words = (target) => {
      const mark = target.closest?.(".mark"), cell = target.dataset?.cell;
      if (mark) { const e = byIndex.get(+mark.dataset.index); return [`evaluation ${e.index}`, named(e), `${data.measure.name} ${valued(e)}`, `window ${windowed(e)}`].join("\n"); }
      if (cell !== undefined) return `${p.label} ${model.x[cell % model.x.length]}${p.unit}, ${q.label} ${model.y[Math.floor(cell / model.x.length)]}${q.unit}\nmodel: ${number(model.mean[cell], 2)} ± ${number(model.sd[cell], 2)} ${unit}`;
      return "";
    };
    surface.addEventListener("pointermove", (event) => {
      tip.textContent = words(event.target);
      tip.hidden = !tip.textContent;
      const box = tip.getBoundingClientRect();
      tip.style.left = `${Math.max(4, Math.min(event.clientX + 14, innerWidth - box.width - 6))}px`;
      tip.style.top = `${event.clientY + 18 + box.height > innerHeight ? event.clientY - box.height - 10 : event.clientY + 18}px`;
    });
    surface.addEventListener("pointerleave", () => { tip.hidden = true; });
    surface.addEventListener("click", (event) => { const mark = event.target.closest(".mark"); if (mark) select(+mark.dataset.index); });
  }

  // --- the table, as long as one wants it
  const PAGE = 100, robot = Object.keys(data.robot).length > 0;
  const width = (e) => (e.window ? e.window[1] - e.window[0] : null);
  const own = data.parameters.map((of, k) => [axis(of), (e) => e.x[k]]), found = [[`searched ${data.measure.name}${unit && ` (${unit})`}`, (e) => e.value, (e) => data.raced[e.index] || number(e.value, digits)],
    [`window${data.on} (mm)`, width, (e) => (e.window ? `${signed(e.window[0])} to ${signed(e.window[1])}` : e.ends[0] || "none")], ["force (N)", (e) => e.force, (e) => number(e.force)], ...(robot ? [["on a robot (mm)", (e) => data.robot[e.index] ?? null, (e) => (data.robot[e.index] === undefined ? "" : number(data.robot[e.index]))]] : [])];
  // Of many parameters the results stand first, where they are seen.
  const columns = [["no.", (e) => e.index], ...(own.length > 3 ? [...found, ...own] : [...own, ...found])];
  const table = part("table", {}), body = table.createTBody(), head = part("tr", {}, table.createTHead());
  let order = [columns.findIndex(([name]) => name.startsWith("searched")), -data.measure.sense], length = PAGE;
  const more = part("button", { type: "button" }, null, "More");
  const list = () => {
    const [column, sense] = order, key = columns[column][1];
    const rank = (e) => (e.index === data.best ? 0 : key(e) === null ? 2 : 1);
    const sorted = [...designs].sort((a, b) => rank(a) - rank(b) || sense * (key(a) - key(b)) || a.index - b.index);
    body.replaceChildren(...sorted.slice(0, length).map((e) => {
      const row = part("tr", { "data-index": e.index, class: e.index === chosen ? "chosen" : "" });
      columns.forEach(([, value, text], k) => { const cell = part("td", {}, row, k ? (text || value)(e) : undefined); if (!k) part("button", { type: "button", "aria-label": `design ${e.index}` }, cell, e.index); });
      return row;
    }));
    more.hidden = length >= designs.length;
    [...head.cells].forEach((cell, k) => cell.setAttribute("aria-sort", k !== column ? "none" : sense > 0 ? "ascending" : "descending"));
  };
  columns.forEach(([name], k) => part("button", { type: "button" }, part("th", {}, head), name).addEventListener("click", () => { order = [k, order[0] === k ? -order[1] : 1]; list(); }));
  body.addEventListener("click", (event) => { const row = event.target.closest("tr"); if (row) select(+row.dataset.index); });
  more.addEventListener("click", () => { length += 5 * PAGE; list(); });
  at("designs").replaceChildren(table, more);
  list();
  select(chosen);
  root.addEventListener("keydown", (event) => {
    const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    if (!step || event.target.type === "radio") return;
    const now = designs.findIndex((e) => e.index === chosen);
    event.preventDefault();
    select(designs[(now + step + designs.length) % designs.length].index);
  });
})();
