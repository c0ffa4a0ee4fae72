// Numbers, symbols, axes, colours and canvases, which all parts of the page share.
"use strict";
const element = id => document.getElementById(id);
const make = (tag, of = {}, ...inside) => {
  const made = Object.assign(document.createElement(tag), of);
  made.append(...inside);
  return made;
};
const clamp = (x, low, high) => Math.min(high, Math.max(low, x));
const INK = "#1d2430", SOFT = "#5a6472", FAINT = "#c3c9d1", ABSENT = [199, 199, 199], INFINITE = [115, 115, 115];
const FONT = "system-ui, 'Segoe UI', 'DejaVu Sans', sans-serif";

// -- numbers and symbols --

const short = (x, digits = 5) => {
  if (typeof x !== "number") return String(x);
  if (!Number.isFinite(x)) return Number.isNaN(x) ? "none" : x > 0 ? "∞" : "−∞";
  const size = Math.abs(x);
  const text = size && (size < 1e-4 || size >= 1e7) ? x.toExponential(digits - 1) : String(+x.toPrecision(digits));
  return text.replace(/\.?0+e/, "e").replace("-", "−");
};
const GREEK = Object.fromEntries(("alpha α beta β gamma γ delta δ epsilon ε zeta ζ eta η theta θ kappa κ lambda λ mu μ nu ν "
  + "xi ξ rho ρ sigma σ tau τ phi φ chi χ psi ψ omega ω Delta Δ").split(" ").reduce((pairs, word, k, all) =>
  k % 2 ? pairs : [...pairs, [word, all[k + 1]]], []));
const symbolParts = symbol => symbol.split(" ").map(word => {
  const found = /^(\|?)([A-Za-z]+)(?:_\{?([A-Za-z0-9]+)\}?)?(\|?)$/.exec(word);
  const plain = !found || ["max", "min", "rms", "at", "status", "mean"].includes(word);
  if (plain) return {base: word, index: "", leaning: false};
  return {base: found[1] + (GREEK[found[2]] ?? found[2]), index: found[3] ?? "", leaning: found[2].length === 1 || found[2] in GREEK,
    after: found[4]};
});
const symbolNodes = symbol => symbolParts(symbol).flatMap(({base, index, leaning, after = ""}) =>
  [make(leaning ? "i" : "span", {textContent: base}), index ? make("sub", {textContent: index}) : "", after, " "]);
const worded = of => [...symbolNodes(of.symbol), of.symbol === of.meaning ? "" : of.meaning];
const LOWERED = Object.fromEntries([..."0123456789aehijklmnoprstuvx"].map((letter, k) => [letter, [..."₀₁₂₃₄₅₆₇₈₉ₐₑₕᵢⱼₖₗₘₙₒₚᵣₛₜᵤᵥₓ"][k]]));
const lowered = index => [...index].every(one => one in LOWERED) ? [...index].map(one => LOWERED[one]).join("") : index && `_${index}`;
const symbolText = symbol => symbolParts(symbol).map(({base, index, after = ""}) => base + lowered(index) + after).join(" ");
const RAISED = {"-": "⁻", 1: "¹", 2: "²", 3: "³", 4: "⁴"};
const isAngle = units => units === "rad";
const factor = units => state.degrees && isAngle(units) ? 180 / Math.PI : 1;
const unitsText = units => units === "1" ? "" : state.degrees && isAngle(units) ? "°"
  : units === "degree" ? "°" : " " + units.replace(/(-?)(\d)\b/g, (_, sign, digit) => (RAISED[sign] ?? "") + (RAISED[digit] ?? digit));
const shown = (x, of, digits) => of.flags ? of.flags[String(x)] ?? "none"
  : short(x * factor(of.units), digits) + (Number.isFinite(x) ? unitsText(of.units) : "");
const bracketed = of => of.units === "1" || of.flags ? "" : ` [${unitsText(of.units).trim()}]`;
// Symbol, words and units of an axis; where there is no room for the words, without them.
const labelled = (pen, of, room) => {
  const text = symbolText(of.symbol) + bracketed(of), whole = `${symbolText(of.symbol)}, ${of.meaning}${bracketed(of)}`;
  return of.symbol !== of.meaning && pen.measureText(whole).width < room ? whole : text;
};

// -- axes --

function ticks(low, high, count, inTurns = false) {
  const rough = (high - low) / Math.max(1, count);
  if (!(rough > 0)) return [low];
  const size = 10 ** Math.floor(Math.log10(rough));
  const step = inTurns ? [5, 10, 15, 30, 45, 60, 90, 180].find(one => one >= rough) ?? 180
    : [1, 2, 2.5, 5, 10].map(one => one * size).find(one => one >= rough * 0.999);
  const found = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k++) found.push(+(k * step).toPrecision(12));
  return found;
}
function logTicks(low, high) {
  const found = [];
  const few = Math.log10(high / low) > 2.5;
  for (let power = Math.floor(Math.log10(low)); power <= Math.log10(high); power++)
    for (const one of few ? [1] : [1, 2, 5]) {
      const tick = one * 10 ** power;
      if (tick >= low * (1 - 1e-9) && tick <= high * (1 + 1e-9)) found.push(tick);
    }
  return found.length > 1 ? found : ticks(low, high, 4);
}

// -- colours --

const tables = {};
for (const [name, colours] of Object.entries(content.colours))
  tables[name] = colours.map(hex => [1, 3, 5].map(k => parseInt(hex.slice(k, k + 2), 16)));
const ofHex = hex => [1, 3, 5].map(k => parseInt(hex.slice(k, k + 2), 16));
function painter(scale) {
  if (scale.kind === "codes") {
    const colours = Object.fromEntries(Object.entries(scale.colours).map(([code, hex]) => [code, ofHex(hex)]));
    return value => colours[value] ?? ABSENT;
  }
  const table = tables[scale.map], {low, high} = scale;
  const share = scale.kind === "log" ? value => Math.log(value / low) / Math.log(high / low) : value => (value - low) / (high - low);
  const steps = scale.kind === "counts" ? high - low : 0;
  return value => {
    if (!Number.isFinite(value)) return Number.isNaN(value) ? ABSENT : INFINITE;
    let at = share(value);
    if (Number.isNaN(at)) at = 0;  // the logarithm of what is not positive
    if (steps) at = (Math.floor(at * steps) + 0.5) / steps;
    return table[clamp(Math.floor(at * table.length), 0, table.length - 1)];
  };
}
const css = ([red, green, blue], alpha = 1) => `rgba(${red},${green},${blue},${alpha})`;

// -- canvases --

function prepared(canvas, height) {
  const ratio = window.devicePixelRatio || 1, width = Math.max(120, canvas.clientWidth);
  if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
    canvas.style.height = `${height}px`;
  }
  const pen = canvas.getContext("2d");
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.clearRect(0, 0, width, height);
  Object.assign(pen, {font: `12px ${FONT}`, taken: []});
  return {pen, width, height, ratio};
}
function line(pen, points, style) {
  pen.save();
  Object.assign(pen, {lineJoin: "round", lineCap: "round"}, style);
  pen.setLineDash(style.dash ?? []);
  pen.beginPath();
  let down = false;
  for (const [x, y] of points) {
    if (!Number.isFinite(x) || !Number.isFinite(y)) down = false;
    else if (down) pen.lineTo(x, y);
    else { pen.moveTo(x, y); down = true; }
  }
  if (style.fillStyle) pen.fill();
  pen.stroke();
  pen.restore();
}
// A text that gives way is moved up or down from those before it, or left out if it is dropped there.
function write(pen, text, x, y, style = {}) {
  pen.save();
  Object.assign(pen, {fillStyle: SOFT, textAlign: "center", textBaseline: "middle"}, style);
  const {width} = pen.measureText(text), left = x - width * {left: 0, center: 0.5, right: 1}[pen.textAlign];
  const free = at => pen.taken.every(([from, to, there]) => left > to + 3 || left + width < from - 3 || Math.abs(at - there) > 14);
  if (style.gives) y = [0, 15, -15, 30, -30, 45, -45].map(by => y + by).find(free) ?? NaN;
  if (style.drops && !free(y) || Number.isNaN(y)) { pen.restore(); return; }
  if (!pen.getTransform().b) pen.taken.push([left, left + width, y]);
  if (style.halo) { Object.assign(pen, {strokeStyle: "#fffd", lineWidth: 3.5, lineJoin: "round"}); pen.strokeText(text, x, y); }
  pen.fillText(text, x, y);
  pen.restore();
}
const said = text => { element("said").textContent = text; };
