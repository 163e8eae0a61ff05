"use strict";
// The films on the first screen: a document of its own in a frame, which can be heard, not looked into.
var play = (() => {
  const at = (id) => document.getElementById(id), frame = at("film");
  if (!frame) return () => {};
  const viewer = JSON.parse(at("viewer").textContent), buttons = [...document.querySelectorAll("button[data-film]")];
  let shown = -1, wanted = false;
  const show = (k) => {
    shown = k;
    delete frame.dataset.state;
    // It shows the first end alone.
    const poster = document.querySelector(".stage img");
    if (poster && k > 0) poster.remove();
    if (!poster || k > 0) at("caption").textContent = buttons[k].dataset.caption;
    frame.srcdoc = viewer.replace("<body>", '<body class="compact">').replace('id="films">', () => `id="films">${at(`film${k}`).textContent}`);
  };
  const play = (k) => {
    if (frame.dataset.state === "picture") return;
    if (k !== shown) { wanted = true; show(k); return; }
    if (frame.dataset.state) frame.contentWindow.postMessage("play", "*"); else wanted = true;
  };
  window.addEventListener("message", ({ source, data }) => {
    if (source !== frame.contentWindow) return;
    frame.dataset.state = String(data);
    // Without WebGL the picture of the failed trial stays.
    if (data === "picture") { at("caption").append(" The films need WebGL, which this browser lacks."); return; }
    at("caption").textContent = buttons[shown].dataset.caption;
    buttons.forEach((button, k) => button.setAttribute("aria-pressed", String(k === shown && data === "playing")));
    if (data !== "playing" && data !== "paused" && wanted) { wanted = false; frame.contentWindow.postMessage("play", "*"); }
  });
  buttons.forEach((button, k) => button.addEventListener("click", () => play(k)));
  // After the page itself has been drawn.
  if (buttons.length) requestAnimationFrame(() => setTimeout(() => shown < 0 && show(0)));
  return play;
})();
