// The pointer and the keys on the picture; the motion's controls; the link.
"use strict";
function pointTo(at, hold = state.held) {
  if (!at) return;
  state.cursor = at;
  state.held = hold;
  drawOver();
  load0();
}
// The design alone, without a new picture.
let designing = false, wanted = false;
async function load0() {
  if (designing) { wanted = true; return; }
  designing = true;
  try {
    do { wanted = false; await loadDesign(); } while (wanted);
    if (state.cursor?.free) drawOver();
  } finally { designing = false; remember(); }
}
function placeIn(event) {
  const box = element("over").getBoundingClientRect();
  return [event.clientX - box.left, event.clientY - box.top];
}
function shareIn(event) {
  const [left, top] = placeIn(event), {box} = view;
  return [clamp((left - box.left) / box.width, 0, 1), clamp(1 - (top - box.top) / box.height, 0, 1)];
}
// -- joints of the mechanism that are dragged --

let dragging = null;  // {point, branch, position, view, back: from the canvas to the plane}
function jointAt(x, y) {
  if (!design?.scene) return null;
  const canvas = element("linkage"), {motion, scene: {view}} = design, position = positionNow();
  const [on, back] = framing(view, canvas.clientWidth, canvas.clientHeight);
  const found = motion.branches.filter(branch => motion.assembles(position, [branch])).flatMap(branch => mechanism.points.map(point => {
    const [a, b] = on(motion.place(motion.at(position, branch), point));
    return {point, branch, position, view, back, away: Math.hypot(a - x, b - y)};
  })).sort((one, other) => one.away - other.away).find(one => one.away < 18 && moversOf(one.point).length);
  return found ?? null;
}
function dragJoint(x, y) {
  const {point, branch, position, back} = dragging, {inputs, position: at} = design.motion.moved(point, branch, position, back([x, y]));
  dragging.position = at;
  depart(Object.fromEntries(Object.entries(inputs).map(([name, value]) => [name, mechanism.degrees.includes(name) ? value * 180 / Math.PI : value])));
}
function listenToJoints() {
  const canvas = element("linkage");
  canvas.onpointerdown = event => {
    dragging = jointAt(event.offsetX, event.offsetY);
    if (!dragging) return;
    play(false);
    canvas.setPointerCapture(event.pointerId);
  };
  canvas.addEventListener("touchstart", event => { if (dragging) event.preventDefault(); }, {passive: false});
  canvas.onpointermove = ({offsetX, offsetY}) => {
    if (dragging) dragJoint(offsetX, offsetY);
    else canvas.style.cursor = jointAt(offsetX, offsetY) ? "grab" : "";
  };
  canvas.onpointerup = canvas.onpointercancel = () => {
    if (!dragging) return;
    dragging = null;
    if (design.scene) design.scene = scene(design.motion);
    drawMotion();
  };
}
function listen() {
  listenToJoints();
  element("back").onclick = () => { const {free, ...at} = state.cursor; pointTo(at, true); };
  element("keep").onclick = () => lock(state.cursor);
  const over = element("over");
  let from = null, dragged = false;
  over.onpointerdown = event => { from = shareIn(event); dragged = false; over.setPointerCapture(event.pointerId); over.focus(); };
  over.onpointermove = event => {
    if (from) {
      const to = shareIn(event);
      dragged ||= Math.hypot((to[0] - from[0]) * view.box.width, (to[1] - from[1]) * view.box.height) > 6;
      if (dragged) { state.brush = brushed(from, to); drawOver(); }
    } else if (!state.held) pointTo(pickAt(...placeIn(event)));
  };
  over.onpointerup = event => {
    if (dragged) { remember(); drawRegion(); }
    else if (from) pointTo(pickAt(...placeIn(event)), !state.held);
    from = null;
  };
  over.ondblclick = event => { pointTo(pickAt(...placeIn(event)), true); lock(state.cursor); };
  over.onkeydown = keyed;
  element("play").onclick = () => play(!state.playing);
  element("position").oninput = event => { play(false); state.share = +event.target.value; if (design?.scene) drawFrame(); };
  element("curve").onchange = event => { state.curve = event.target.value; remember(); drawMotion(); };
  element("help").onclick = () => {
    element("keys").hidden = !element("keys").hidden;
    element("help").setAttribute("aria-expanded", String(!element("keys").hidden));
  };
  element("copy").onclick = async () => {
    remember();
    try { await navigator.clipboard.writeText(location.href); } catch { window.prompt("The view as a link", location.href); return; }
    element("copy").textContent = "Copied";
    setTimeout(() => { element("copy").textContent = "Copy link to this view"; }, 1500);
  };
  let resizing = null;
  window.onresize = () => { clearTimeout(resizing); resizing = setTimeout(() => { drawMap(); drawMotion(); drawParallel(); }, 80); };
}
function brushed(from, to) {
  const y = state.y || isSample;
  return [Math.min(from[0], to[0]), Math.max(from[0], to[0]), y ? Math.min(from[1], to[1]) : 0, y ? Math.max(from[1], to[1]) : 1];
}
let corner = null;
function keyed(event) {
  const moves = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1]};
  const at = placeNow();
  const shares = () => {
    const [left, top] = placeOf(at) ?? [view.box.left, view.box.top];
    return [(left - view.box.left) / view.box.width, 1 - (top - view.box.top) / view.box.height];
  };
  if (event.key in moves) moveBy(at, ...moves[event.key].map(one => one * (event.shiftKey ? 10 : 1)));
  else if (event.key === "Enter") lock(at);
  else if (event.key === "b" && corner) { state.brush = brushed(corner, shares()); corner = null; drawOver(); drawRegion(); remember(); }
  else if (event.key === "b") { corner = shares(); said("region begun; move to its other corner and press b"); }
  else if (event.key === "z") zoom();
  else if (event.key === "0") change({window: {}, limits: {}});
  else if (event.key === "Escape") { Object.assign(state, {brush: null, held: false}); corner = null; drawOver(); drawRegion(); remember(); }
  else if (event.key === " ") play(!state.playing);
  else return;
  event.preventDefault();
}
function moveBy({free, ...at}, across, up) {
  const [x, y] = view.axes;
  let to;
  if (isSample) {
    const k = Math.round(at.design / content.step) + across + up;
    to = {...at, design: clamp(k, 0, view.values.length - 1) * content.step};
  } else {
    to = {...at, [x.dim]: x.places[clamp(nearestOf(x.places, at[x.dim]) + across, 0, x.places.length - 1)]};
    if (y) to[y.dim] = y.places[clamp(nearestOf(y.places, at[y.dim]) + up, 0, y.places.length - 1)];
  }
  state.held = true;
  pointTo(to, true);
  const told = placeTexts(to).map(([of, text]) => `${of.symbol} ${text}`).join(", ");
  setTimeout(() => said(`${told}; ${state.name} ${shown(design.row[state.name], variables[state.name])}`), 120);
}
