// The picture of a variable over one or two dimensions, or of designs that were sampled.
"use strict";
const MARGIN = {left: 66, right: 96, top: 34, bottom: 46};
const dims = Object.fromEntries(content.dims.map(one => [one.name, one]));
const variables = Object.fromEntries(content.variables.map(one => [one.name, one]));
const columns = Object.fromEntries([...content.columns, ...content.variables].map(one => [one.name, one]));
const isSample = "design" in dims;

// An axis along a dimension: from coordinates to shares of its length and back; even in the logarithm if these are so.
function axisOf(dim, [low, high], step) {
  const own = dims[dim], places = [];
  for (let k = low; k <= high; k += step) places.push(k);
  const numbers = own.values ? places.map(k => own.values[k]) : places.map((_, k) => k);
  const ratio = numbers.length > 3 && numbers.every(one => one > 0) && !isEven(numbers) && isEven(numbers.map(Math.log));
  const to = ratio ? Math.log : one => one, back = ratio ? Math.exp : one => one;
  const at = numbers.map(to), descends = at.length > 1 && at[1] < at[0];
  if (descends) { at.reverse(); places.reverse(); }
  const edges = at.length > 1 ? [1.5 * at[0] - 0.5 * at[1], ...at.slice(1).map((one, k) => 0.5 * (one + at[k])),
    1.5 * at.at(-1) - 0.5 * at.at(-2)] : [at[0] - 0.5, at[0] + 0.5];
  const first = edges[0], last = edges.at(-1), count = places.length;
  const cell = share => {
    const wanted = first + share * (last - first);
    let [a, b] = [0, count - 1];
    while (a < b) { const m = (a + b) >> 1; if (wanted < edges[m + 1]) b = m; else a = m + 1; }
    return a;
  };
  const scale = own.values ? factor(own.units) : 1;
  const shareOf = place => (at[nearestOf(places, place)] - first) / (last - first);
  const marks = own.names ? places.filter((_, k) => k % Math.ceil(count / 12) === 0).map(place => [shareOf(place), own.names[place]])
    : (ratio ? logTicks(back(first) * scale, back(last) * scale) : ticks(first * scale, last * scale, 6, scale !== 1))
      .map(tick => [(to(tick / scale) - first) / (last - first), short(tick)]);
  return {dim, places, cell, index: k => descends ? count - 1 - k : k, share: shareOf, shareOfValue: one => (to(one) - first) / (last - first), marks, of: own, back: one => back(first + one * (last - first))};
}
const isEven = numbers => {
  const step = (numbers.at(-1) - numbers[0]) / (numbers.length - 1);
  return numbers.every((one, k) => Math.abs(one - numbers[0] - k * step) < 0.02 * Math.abs(step));
};
function nearestOf(places, place) {
  let best = 0;
  places.forEach((one, k) => { if (Math.abs(one - place) < Math.abs(places[best] - place)) best = k; });
  return best;
}
// An axis of a sample: along the values of a column.
function axisOfColumn(name, numbers) {
  const finite = Array.from(numbers).filter(Number.isFinite).sort((a, b) => a - b);
  let low = finite[Math.floor(0.002 * finite.length)] ?? 0, high = finite[Math.ceil(0.998 * (finite.length - 1))] ?? 1;
  if (state.limits[name]) [low, high] = state.limits[name];
  else { const pad = 0.02 * (high - low) || Math.abs(low) || 1; [low, high] = [low - pad, high + pad]; }
  const of = columns[name], scale = factor(of.units);
  return {name, of, low, high, share: value => (value - low) / (high - low), back: one => low + one * (high - low),
    marks: ticks(low * scale, high * scale, 6, scale !== 1).map(tick => [(tick / scale - low) / (high - low), short(tick)])};
}

const view = {};  // the picture as it stands: axes, values, box
function boxOf(width, height) {
  return {left: MARGIN.left, top: MARGIN.top, width: width - MARGIN.left - MARGIN.right, height: height - MARGIN.top - MARGIN.bottom};
}
// As high as leaves the sliders below it in the window.
const heightOf = canvas => clamp(window.innerHeight - 150 - element("sliders").offsetHeight, 300, Math.max(300, 0.95 * canvas.clientWidth));

function drawMap() {
  const canvas = element("map"), {pen, width, height, ratio} = prepared(canvas, heightOf(canvas));
  const of = variables[state.name], box = view.box = boxOf(width, height);
  view.scale = state.fit ? fitted(of, view.values) : view.full;
  const paint = painter(view.scale);
  pen.fillStyle = "#f3f4f6";
  pen.fillRect(box.left, box.top, box.width, box.height);
  if (isSample) drawPoints(pen, box, paint);
  else if (view.axes.length === 2) drawCells(pen, box, paint, ratio);
  else drawLine(pen, box, of);
  drawAxes(pen, box, of, width, height);
  drawOver();
}

function drawCells(pen, box, paint, ratio) {
  const [x, y] = view.axes, wide = Math.max(1, Math.round(box.width * ratio)), high = Math.max(1, Math.round(box.height * ratio));
  const across = Array.from({length: wide}, (_, k) => x.index(x.cell((k + 0.5) / wide)));
  const image = new ImageData(wide, high), pixels = new Uint32Array(image.data.buffer), cells = view.values;
  const colours = new Uint32Array(cells.length), known = new Uint8Array(cells.length);
  let before = -1;
  for (let j = 0; j < high; j++) {
    const row = y.index(y.cell(1 - (j + 0.5) / high)) * view.across, start = j * wide;
    if (row === before) { pixels.copyWithin(start, start - wide, start); continue; }
    before = row;
    for (let k = 0; k < wide; k++) {
      const cell = row + across[k];
      if (!known[cell]) {
        const [red, green, blue] = paint(cells[cell]);
        colours[cell] = 0xff000000 | blue << 16 | green << 8 | red;
        known[cell] = 1;
      }
      pixels[start + k] = colours[cell];
    }
  }
  const place = document.createElement("canvas");
  place.width = wide;
  place.height = high;
  place.getContext("2d").putImageData(image, 0, 0);
  pen.drawImage(place, box.left, box.top, box.width, box.height);
}

function drawPoints(pen, box, paint) {
  const [x, y] = view.axes, count = view.values.length, size = count > 20000 ? 2 : count > 2000 ? 3 : 5;
  for (let k = 0; k < count; k++) {
    const across = x.share(view.x[k]), up = y.share(view.y[k]);
    if (!(across >= 0 && across <= 1 && up >= 0 && up <= 1)) continue;
    pen.fillStyle = css(paint(view.values[k]));
    pen.fillRect(box.left + across * box.width - size / 2, box.top + (1 - up) * box.height - size / 2, size, size);
  }
}

function drawLine(pen, box, of) {
  const [x] = view.axes, {low, high} = of.flags ? {low: -1, high: Object.keys(of.flags).length} : lineEnds();
  view.up = value => box.top + (1 - (value - low) / (high - low)) * box.height;
  const points = x.places.map((place, k) => [box.left + x.share(place) * box.width, view.up(view.values[x.index(k)])]);
  const scale = factor(of.units);
  for (const tick of of.flags ? [] : ticks(low * scale, high * scale, 6)) {
    line(pen, [[box.left, view.up(tick / scale)], [box.left + box.width, view.up(tick / scale)]], {strokeStyle: "#dfe3e8", lineWidth: 1});
    write(pen, short(tick), box.left - 6, view.up(tick / scale), {textAlign: "right"});
  }
  pen.save();
  pen.beginPath();
  pen.rect(box.left, box.top, box.width, box.height);
  pen.clip();
  line(pen, points, {strokeStyle: MODES[0], lineWidth: 1.8});
  for (const [a, b] of points.length < 80 ? points : []) { pen.beginPath(); pen.arc(a, b, 2.4, 0, 7); pen.fillStyle = MODES[0]; pen.fill(); }
  pen.restore();
}
function lineEnds() {
  const finite = Array.from(view.values).filter(Number.isFinite), low = Math.min(...finite), high = Math.max(...finite);
  const pad = 0.06 * (high - low) || Math.abs(low) || 1;
  return finite.length ? {low: low - pad, high: high + pad} : {low: 0, high: 1};
}

// The colours of the values that are shown alone.
function fitted(of, values) {
  const scale = view.full;
  if (scale.kind === "codes" || scale.kind === "counts") return scale;
  const finite = Array.from(values).filter(one => Number.isFinite(one) && (scale.kind !== "log" || one > 0)).sort((a, b) => a - b);
  if (finite.length < 2) return scale;
  let low = finite[Math.floor(0.01 * finite.length)], high = finite[Math.floor(0.99 * (finite.length - 1))];
  if (scale.map === "RdBu_r") [low, high] = [-Math.max(-low, high), Math.max(-low, high)];
  return high > low ? {...scale, low, high} : scale;
}

function drawAxes(pen, box, of, width, height) {
  line(pen, [[box.left, box.top], [box.left, box.top + box.height], [box.left + box.width, box.top + box.height]], {strokeStyle: INK, lineWidth: 1});
  const [x, y] = view.axes;
  for (const [share, text] of x.marks) {
    const at = box.left + share * box.width;
    if (share < -1e-6 || share > 1 + 1e-6) continue;
    line(pen, [[at, box.top + box.height], [at, box.top + box.height + 4]], {strokeStyle: INK, lineWidth: 1});
    write(pen, String(text).slice(0, 12), at, box.top + box.height + 13, {drops: true});
  }
  const named = {fillStyle: INK, font: `13px ${FONT}`};
  write(pen, labelled(pen, x.of, 0.9 * width), Math.min(box.left + box.width / 2, width / 2), height - 12, named);
  for (const [share, text] of y?.marks ?? []) {
    const at = box.top + (1 - share) * box.height;
    if (share < -1e-6 || share > 1 + 1e-6) continue;
    line(pen, [[box.left - 4, at], [box.left, at]], {strokeStyle: INK, lineWidth: 1});
    write(pen, String(text).slice(0, 8), box.left - 7, at, {textAlign: "right", drops: true});
  }
  pen.save();
  pen.translate(13, box.top + box.height / 2);
  pen.rotate(-Math.PI / 2);
  write(pen, labelled(pen, y ? y.of : of, 2 * box.top + box.height - 8), 0, 0, named);
  pen.restore();
  if (y && view.scale.kind !== "codes") drawColourBar(pen, box, of, width);
  drawLegend(of);
}

function drawColourBar(pen, box, of, width) {
  const scale = view.scale, left = box.left + box.width + 16, wide = 14, paint = painter(scale);
  const at = share => scale.kind === "log" ? scale.low * (scale.high / scale.low) ** share : scale.low + share * (scale.high - scale.low);
  for (let k = 0; k < box.height; k++) {
    pen.fillStyle = css(paint(at(1 - (k + 0.5) / box.height)));
    pen.fillRect(left, box.top + k, wide, 1.5);
  }
  for (const [end, y, side] of [[scale.high, box.top, -1], [scale.low, box.top + box.height, 1]])
    if (["both", side < 0 ? "max" : "min"].includes(scale.extend))  // values lie beyond this end
      line(pen, [[left, y], [left + wide / 2, y + 8 * side], [left + wide, y]], {strokeStyle: css(paint(end)), fillStyle: css(paint(end)), lineWidth: 1});
  const by = factor(of.units);
  const marks = scale.kind === "log" ? logTicks(scale.low * by, scale.high * by) : scale.kind === "counts"
    ? Array.from({length: scale.high - scale.low}, (_, k) => scale.low + 0.5 + k) : ticks(scale.low * by, scale.high * by, 7);
  for (const tick of marks) {
    const share = scale.kind === "log" ? Math.log(tick / by / scale.low) / Math.log(scale.high / scale.low) : (tick / by - scale.low) / (scale.high - scale.low);
    const y = box.top + (1 - share) * box.height;
    line(pen, [[left + wide, y], [left + wide + 4, y]], {strokeStyle: INK, lineWidth: 1});
    write(pen, short(tick, 4), left + wide + 7, y, {textAlign: "left", drops: true});
  }
  write(pen, symbolText(of.symbol) + bracketed(of), width - 4, 11, {fillStyle: INK, textAlign: "right"});
}

function drawLegend(of) {
  const place = element("legend"), present = new Set();
  const absent = view.values.some(Number.isNaN), infinite = view.values.some(one => Math.abs(one) === Infinity);
  if (of.flags) view.values.forEach(one => present.add(String(one)));
  const entries = Object.entries(of.flags ?? {}).filter(([code]) => present.has(code)).map(([code, meaning]) =>
    [view.scale.colours[code], meaning]);
  if (absent && view.axes.length > 1) entries.push([css(ABSENT), "no value: does not assemble, or has none"]);
  if (isSample && content.step > 1) entries.push(["transparent", `one of ${content.step} designs is drawn`]);
  if (infinite) entries.push([css(INFINITE), "grows without bound"]);
  const focused = document.activeElement?.id;
  place.replaceChildren(...entries.map(([colour, text]) => {
    const swatch = make("span", {className: "swatch"});
    swatch.style.background = colour;
    return make("span", {}, swatch, text);
  }), ...poolChooser());
  if (focused === "choose-pool") element(focused)?.focus();
}
// Which of the designs of a cell is shown, where a cell holds several.
function poolChooser() {
  if (isSample || !view.several?.some(one => one > 1)) return [];
  const count = view.several.join(" × "), words = {mean: "mean", least: "least", greatest: "greatest", one: "first"};
  if (!view.full.pools) return [make("span", {textContent: `each cell shows one of ${count} designs`})];
  const select = make("select", {id: "choose-pool"}, ...Object.entries(words).map(([value, textContent]) => make("option", {value, textContent})));
  select.value = state.pool;
  select.onchange = () => change({pool: select.value});
  return [make("label", {}, "each cell shows the ", select, ` of ${count} designs`)];
}

// -- places: from the pointer to a design and back --

function pickAt(left, top) {
  const {box} = view, across = (left - box.left) / box.width, up = 1 - (top - box.top) / box.height;
  if (across < 0 || across > 1 || up < 0 || up > 1) return null;
  if (isSample) return pickPoint(across, up);
  const [x, y] = view.axes, at = {...state.at, [x.dim]: x.places[x.cell(across)]};
  return y ? {...at, [y.dim]: y.places[y.cell(up)]} : at;
}
function pickPoint(across, up) {
  const [x, y] = view.axes, wide = view.box.width, high = view.box.height;
  let best = -1, least = 30 ** 2;
  for (let k = 0; k < view.values.length; k++) {
    const a = (x.share(view.x[k]) - across) * wide, b = (y.share(view.y[k]) - up) * high, distance = a * a + b * b;
    if (distance < least) { least = distance; best = k; }
  }
  return best < 0 ? null : {...state.at, design: best * content.step};
}
function placeOf(at, row = design?.row) {
  const {box, axes: [x, y]} = view;
  if (at.free) {  // off the grid; beyond the picture, at its edge
    const share = axis => clamp(axis.dim ? axis.dim in at.free ? axis.shareOfValue(at.free[axis.dim]) : axis.share(at[axis.dim])
      : axis.share(valueIn(axis.of, {at, row})), 0, 1);
    return [box.left + share(x) * box.width, y ? box.top + (1 - share(y)) * box.height : clamp(view.up(row[state.name]), box.top, box.top + box.height)];
  }
  if (isSample) {
    const k = Math.round(at.design / content.step);
    return [box.left + x.share(view.x[k]) * box.width, box.top + (1 - y.share(view.y[k])) * box.height];
  }
  if (Object.keys(dims).some(dim => dim !== x.dim && dim !== y?.dim && variables[state.name].dims.includes(dim) && at[dim] !== state.at[dim])) return null;
  const up = y ? 1 - y.share(at[y.dim]) : (view.up(view.values[x.index(nearestOf(x.places, at[x.dim]))]) - box.top) / box.height;
  return [box.left + x.share(at[x.dim]) * box.width, box.top + up * box.height];
}

function drawOver() {
  const canvas = element("over"), {pen} = prepared(canvas, heightOf(element("map"))), {box} = view;
  if (state.brush) {
    const [left, right, top, bottom] = state.brush.map((one, k) => k < 2 ? box.left + one * box.width : box.top + (1 - one) * box.height);
    pen.fillStyle = "#ffffff40";
    pen.fillRect(left, bottom, right - left, top - bottom);
    line(pen, [[left, top], [right, top], [right, bottom], [left, bottom], [left, top]], {strokeStyle: "#fff", lineWidth: 3});
    line(pen, [[left, top], [right, top], [right, bottom], [left, bottom], [left, top]], {strokeStyle: INK, lineWidth: 1.4, dash: [5, 3]});
  }
  state.locks.forEach(({at, row}, k) => {
    const place = placeOf(at, row);
    if (!place) return;
    pen.beginPath();
    pen.arc(...place, 9, 0, 7);
    Object.assign(pen, {fillStyle: INK, strokeStyle: "#fff", lineWidth: 2});
    pen.fill();
    pen.stroke();
    write(pen, String(k + 1), place[0], place[1] + 0.5, {fillStyle: "#fff", font: `bold 11px ${FONT}`});
  });
  const place = state.cursor && placeOf(state.cursor);
  if (state.cursor?.free) {  // a hollow diamond
    const [x, y] = place, corners = [[x, y - 9], [x + 9, y], [x, y + 9], [x - 9, y], [x, y - 9]];
    for (const [strokeStyle, lineWidth] of [["#fff", 5], ["#d1495b", 2]]) line(pen, corners, {strokeStyle, lineWidth});
  } else if (place) {
    for (const [colour, width] of [["#fff", 3.5], [state.held ? "#d1495b" : INK, 1.5]]) {
      const style = {strokeStyle: colour, lineWidth: width}, [x, y] = place;
      for (const [a, b] of [[1, 0], [-1, 0], [0, 1], [0, -1]]) line(pen, [[x + 5 * a, y + 5 * b], [x + 15 * a, y + 15 * b]], style);
      pen.beginPath();
      pen.arc(x, y, 5, 0, 7);
      Object.assign(pen, style);
      pen.stroke();
    }
  }
}
