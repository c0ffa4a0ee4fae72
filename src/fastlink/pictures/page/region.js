// A region of the picture: parallel coordinates of its designs, and the best of them.
"use strict";
let region = null;  // {fields, rows, best, count, largest}
let regionAsked = 0;

// The places along each axis of the picture that a brush covers.
function windowOf(brush) {
  const found = {};
  view.axes.forEach((axis, k) => {
    const [low, high] = [brush[2 * k], brush[2 * k + 1]].map(share => axis.places[axis.cell(clamp(share, 0, 1))]);
    found[axis.dim] = [Math.min(low, high), Math.max(low, high)];
  });
  return found;
}
const rankedBy = () => (state.by in variables && !variables[state.by].flags) ? state.by : variables[state.name].flags
  ? content.variables.find(one => !one.flags)?.name ?? state.name : state.name;

async function loadRegion() {
  const asked = ++regionAsked;
  if (!state.brush) { region = null; return; }
  const {largest} = state, found = {...await (isSample ? regionOfSample() : regionOfGrid()), largest};
  if (asked === regionAsked) region = found;
}
async function regionOfGrid() {
  const further = state.whole ? sliding() : [], axes = [...[...view.axes].reverse().map(axis => axis.dim), ...further];
  const at = {...state.at}, by = rankedBy(), window = windowOf(state.brush);
  for (const dim of further) window[dim] = [0, dims[dim].length - 1];
  for (const dim of axes) delete at[dim];
  const own = axes.filter(dim => variables[by].dims.includes(dim));
  const query = {name: own.length === axes.length ? by : state.name, axes, at, window, largest: state.largest};
  const key = JSON.stringify([query, state.name]);
  if (region?.key === key) return region;  // of all values of a slider that has moved
  const found = await source.region(query);
  const fields = [...[...view.axes.map(axis => axis.dim), ...further].map(dim => dims[dim]), ...content.variables.filter(of => of.name in found.values && !of.flags)];
  const rows = fields.map(of => of.name in found.axes ? found.axes[of.name].map(place => (of.values ?? of.codes)?.[place] ?? place) : found.values[of.name]);
  return {key, count: found.count, fields, rows, best: found.best, colours: found.values[state.name]};
}
async function regionOfSample() {
  const [x, y] = view.axes, [left, right, bottom, top] = state.brush, chosen = [];
  for (let k = 0; k < view.values.length; k++) {
    const a = x.share(view.x[k]), b = y.share(view.y[k]);
    if (a >= left && a <= right && b >= bottom && b <= top) chosen.push(k);
  }
  const at = {...state.at}, by = rankedBy();
  delete at.design;
  const fields = [...content.columns, ...content.variables.filter(of => !of.flags)].filter((of, k, all) => !of.dims || of.dims.includes("design"));
  const every = await Promise.all(fields.map(of => source.column({name: of.name, at})));
  const key = fields.findIndex(of => of.name === by), sign = state.largest ? -1 : 1;
  const ranked = chosen.filter(k => Number.isFinite(every[key].values[k])).sort((a, b) => sign * (every[key].values[a] - every[key].values[b])).slice(0, 12);
  const best = [];
  const ofPlace = async k => { const own = {...at, design: k * content.step}; return {at: own, row: await source.row({at: own})}; };
  best.push(...await Promise.all(ranked.map(ofPlace)));
  const step = Math.max(1, Math.ceil(chosen.length / 1500)), some = chosen.filter((_, k) => k % step === 0);
  return {count: chosen.length, fields, rows: every.map(one => some.map(k => one.values[k])), best, colours: some.map(k => view.values[k])};
}

async function drawRegion() {
  const place = element("region");
  await loadRegion();
  place.hidden = !region;
  if (!region) { place.replaceChildren(); return; }
  const by = rankedBy(), ranked = content.variables.filter(one => !one.flags);
  const select = make("select", {id: "choose-by"}, ...ranked.map(option));
  select.value = by;
  select.onchange = () => { state.by = select.value; remember(); drawRegion(); };
  const order = make("select", {id: "choose-order"}, make("option", {value: "", textContent: "least"}), make("option", {value: "1", textContent: "greatest"}));
  order.value = state.largest ? "1" : "";
  order.onchange = () => { state.largest = Boolean(order.value); remember(); drawRegion(); };
  const whole = make("input", {type: "checkbox", id: "tick-whole", checked: state.whole});
  whole.onchange = () => { state.whole = whole.checked; remember(); drawRegion(); };
  const sliders = isSample || !sliding().length ? [] : [make("label", {}, whole, ` over all values of ${sliding().map(dim => symbolText(dims[dim].symbol)).join(", ")}`)];
  const table = make("div", {className: "scroll"}, bestTable());
  place.replaceChildren(make("div", {className: "bar"}, make("h2", {textContent: `Region of ${region.count.toLocaleString("en")} designs${isSample && content.step > 1 ? " that are drawn" : ""}`}),
    make("label", {}, "best by the ", order, " ", select), ...sliders, button("Lock the first three", async () => { for (const one of region.best.slice(0, 3)) await lock(one.at); }),
    button("Save these", () => download("designs.csv", csvOf(region.best)), {id: "best-csv", title: "The best designs as CSV"}),
    button("Show the region alone", zoom, {id: "zoom"}), button("Forget the region", () => { state.brush = null; drawOver(); drawRegion(); remember(); })),
    make("div", {className: "scroll"}, make("canvas", {id: "parallel", role: "img", ariaLabel: "parallel coordinates of the designs in the region"})), table);
  element("parallel").style.minWidth = `${96 * region.fields.length}px`;
  drawParallel();
}
function bestTable() {
  const fields = fieldsOf(region.best).filter(of => !(of.name in dims) || of.length > 1);
  const head = make("tr", {}, make("th", {textContent: ""}), ...fields.map(of => make("th", {title: of.meaning}, ...symbolNodes(of.symbol), bracketed(of).trim())));
  return make("table", {id: "best"}, make("thead", {}, head), make("tbody", {}, ...region.best.map((one, k) => {
    const row = make("tr", {}, make("td", {}, button("Lock", () => lock(one.at), {title: `Lock the ${k + 1}. best design`})),
      ...fields.map(of => make("td", {textContent: textIn(of, one).replace(unitsText(of.units), ""), className: of.flags ? "words" : ""})));
    row.onmouseenter = () => pointTo(one.at, true);
    return row;
  })));
}
function drawParallel() {
  const canvas = element("parallel");
  if (!canvas || !region) return;
  const {pen, width, height} = prepared(canvas, 210), {fields, rows, colours} = region, paint = painter(view.scale);
  const box = {left: 70, right: width - 70, top: 34, bottom: height - 22};
  const across = k => fields.length > 1 ? box.left + k / (fields.length - 1) * (box.right - box.left) : 0.5 * (box.left + box.right);
  const ends = rows.map(values => {
    const finite = values.filter(Number.isFinite);
    return finite.length ? [finite.reduce((a, b) => Math.min(a, b)), finite.reduce((a, b) => Math.max(a, b))] : [0, 0];
  });
  const up = (k, value) => ends[k][1] > ends[k][0] ? box.bottom - (value - ends[k][0]) / (ends[k][1] - ends[k][0]) * (box.bottom - box.top) : 0.5 * (box.top + box.bottom);
  pen.globalAlpha = clamp(40 / Math.sqrt(rows[0].length + 1) / 4, 0.12, 0.9);
  for (let row = 0; row < rows[0].length; row++)
    line(pen, fields.map((_, k) => [across(k), up(k, rows[k][row])]), {strokeStyle: css(paint(colours[row])), lineWidth: 1.2});
  pen.globalAlpha = 1;
  const wanted = region.best[0];
  if (wanted) line(pen, fields.map((of, k) => [across(k), up(k, valueIn(of, wanted))]), {strokeStyle: INK, lineWidth: 2});
  fields.forEach((of, k) => {
    line(pen, [[across(k), box.top], [across(k), box.bottom]], {strokeStyle: INK, lineWidth: 1});
    const side = k === 0 ? "left" : k === fields.length - 1 ? "right" : "center", x = across(k) + (k === 0 ? -60 : k === fields.length - 1 ? 60 : 0);
    write(pen, symbolText(of.symbol), x, 9, {fillStyle: INK, textAlign: side, font: `bold 12px ${FONT}`});
    write(pen, shown(ends[k][1], of, 4), x, 23, {textAlign: side, halo: true});
    write(pen, shown(ends[k][0], of, 4), x, height - 9, {textAlign: side, halo: true});
  });
}
function zoom() {
  if (!state.brush) return;
  const brush = state.brush, wanted = isSample ? null : windowOf(brush);
  state.brush = null;
  if (isSample) {
    const limits = {...state.limits};
    view.axes.forEach((axis, k) => { limits[axis.name] = [axis.back(brush[2 * k]), axis.back(brush[2 * k + 1])]; });
    change({limits});
  } else change({window: {...state.window, ...wanted}});
  drawRegion();
}
