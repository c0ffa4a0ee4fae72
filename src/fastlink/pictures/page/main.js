// The state of the page, its controls, and what follows from a change.
"use strict";
const START = {name: "", x: "", y: "", at: {}, cursor: null, held: false, degrees: false, fit: false, curve: "", window: {},
  limits: {}, locks: [], brush: null, by: "", largest: false, whole: false, pool: "mean", playing: true, share: 0.17, forces: false};
const LINKED = ["name", "x", "y", "at", "cursor", "held", "degrees", "fit", "curve", "window", "limits", "brush", "by", "largest",
  "whole", "pool", "forces"];
const state = {...START};
const source = content.served ? served : embedded;

function defaults() {
  const first = content.variables.find(one => !one.flags) ?? content.variables[0];
  state.name = variables[first.name] ? first.name : content.variables[0].name;
  for (const one of content.dims) state.at[one.name] = one.name === "branch" || one.name === "extremum" ? 0 : Math.floor(((one.length ?? 1) - 1) / 2);
  state.degrees = [mechanism?.position, ...content.variables].some(one => one && isAngle(one.units));
  settleAxes();
}
const ofDims = name => variables[name].dims.filter(dim => dim !== "design");
function settleAxes() {
  if (isSample) {
    const known = content.columns.length > 1 ? content.columns : content.variables;
    if (!(state.x in columns)) state.x = known[0].name;
    if (!(state.y in columns)) state.y = (known[1] ?? known[0]).name;
    return;
  }
  const own = ofDims(state.name), long = [...own].sort((a, b) => dims[b].length - dims[a].length);
  const choice = long.filter(dim => dim !== "branch");
  if (!own.includes(state.x)) state.x = choice[0] ?? own[0];
  if (!own.includes(state.y) || state.y === state.x) state.y = choice.find(dim => dim !== state.x && dims[dim].length > 1) ?? "";
}

// -- controls --

function option(one) { return make("option", {value: one.name, textContent: `${one.name} · ${one.meaning}`}); }
function chooser(label, list, key, empty = "") {
  const select = make("select", {id: `choose-${key}`});
  if (empty) select.append(make("option", {value: "", textContent: empty}));
  select.append(...list.map(option));
  select.value = state[key];
  select.onchange = () => change({[key]: select.value});
  return make("label", {}, `${label} `, select);
}
function ticker(label, key) {
  const box = make("input", {type: "checkbox", checked: state[key], id: `tick-${key}`});
  box.onchange = () => change({[key]: box.checked});
  return make("label", {}, box, ` ${label}`);
}
function button(text, act, of = {}) {
  const made = make("button", {type: "button", textContent: text, ...of});
  made.onclick = act;
  return made;
}
function drawControls() {
  const axes = isSample ? Object.values(columns) : ofDims(state.name).map(dim => dims[dim]);
  const parts = [chooser("Quantity", content.variables, "name"), chooser("across", axes, "x")];
  if (axes.length > 1) parts.push(chooser("up", axes, "y", isSample ? "" : "nothing: a line"));
  parts.push(ticker("degrees", "degrees"), ticker("colours of this picture alone", "fit"));
  if (mechanism?.loads.length) parts.push(ticker("forces", "forces"));
  if (Object.keys(state.window).length || Object.keys(state.limits).length) parts.push(button("Whole picture", () => change({window: {}, limits: {}})));
  const focused = document.activeElement?.id;
  element("controls").replaceChildren(...parts);
  element("sliders").replaceChildren(...sliding().flatMap(slider));
  if (focused) element(focused)?.focus();
}
const sliding = () => variables[state.name].dims.filter(dim =>
  dim !== "design" && (isSample || (dim !== state.x && dim !== state.y)) && dims[dim].length > 1);
function slider(name) {
  const of = dims[name], output = make("output", {});
  const range = make("input", {type: "range", id: `slide-${name}`, min: 0, max: of.length - 1, step: 1, value: state.at[name]});
  const label = make("label", {htmlFor: range.id}, ...worded(of));
  const tell = () => {
    output.textContent = coordinate(of, +range.value);
    range.setAttribute("aria-valuetext", output.textContent);
  };
  range.oninput = () => {
    tell();
    state.at = {...state.at, [name]: +range.value};
    if (state.cursor) state.cursor = settled({...state.cursor, [name]: +range.value}, {[name]: undefined});
    load();
  };
  tell();
  return [label, output, range];
}
const coordinate = (of, place) => of.names ? of.names[place] : of.values ? shown(of.values[place], of) : String(place);

// -- change, load, draw --

let loading = null, again = false;
function change(parts) {
  Object.assign(state, parts);
  if ("name" in parts && state.name !== view.name) state.brush = null;
  settleAxes();
  drawControls();
  fillCurves();
  load();
}
// One request at a time, and the newest after it: a slider that runs leaves no queue behind.
async function load() {
  if (loading) { again = true; return; }
  loading = true;
  const begun = performance.now();
  try {
    do {
      again = false;
      await Promise.all([isSample ? loadSample() : loadGrid(), findDesign()]);
      drawMap();
      drawDesign();
      if (state.brush) await drawRegion();
    } while (again);
    element("file").classList.remove("problem");
    element("file").textContent = mechanism?.title ?? content.title;
  } catch (error) {
    element("file").textContent = content.served ? `The map does not answer (${error.message}): is fastlink still running?` : String(error);
    element("file").classList.add("problem");
    if (!(error instanceof TypeError)) console.error(error);
  } finally {
    loading = null;
    view.took = performance.now() - begun;
    remember();
  }
}
async function loadGrid() {
  const {name} = state, axes = state.y ? [state.y, state.x] : [state.x], window = {};
  for (const dim of axes) window[dim] = state.window[dim] ?? [0, dims[dim].length - 1];
  const at = Object.fromEntries(variables[name].dims.filter(dim => !axes.includes(dim)).map(dim => [dim, state.at[dim]]));
  const query = {name, axes, at, window}, {values, scale, steps} = await source.picture(query);
  const made = axes.map(dim => axisOf(dim, window[dim], steps[dim])).reverse();
  Object.assign(view, {name, values, full: scale, axes: made, across: made[0].places.length, query, pooled: "one",
    several: axes.map(dim => steps[dim]).reverse()});
  refineSoon();
}
// Where a cell holds several designs, one of them is shown while a slider runs; what is asked of all, when it rests.
let refining = null;
function refineSoon() {
  clearTimeout(refining);
  if (state.pool !== "one" && view.full.pools && view.several.some(one => one > 1)) refining = setTimeout(refine, 100);
}
async function refine() {
  const {query} = view, {pool} = state;
  if (loading) { refineSoon(); return; }
  try {
    const {values, pooled} = await source.picture({...query, pool});
    if (view.query !== query || state.pool !== pool) return;
    Object.assign(view, {values, pooled});
    drawMap();
  } catch (error) { console.error(error); }  // the picture of one of them stays
}
async function loadSample() {
  const at = {...state.at};
  delete at.design;
  const ask = async name => (await source.column({name, at}));
  const [x, y, value] = await Promise.all([state.x, state.y, state.name].map(ask));
  Object.assign(view, {name: state.name, x: x.values, y: y.values, values: value.values, full: value.scale,
    axes: [axisOfColumn(state.x, x.values), axisOfColumn(state.y, y.values)]});
}

// -- the design under the cursor --

const inputsOf = (at, row) => {
  const found = {};
  for (const name of mechanism?.inputs ?? []) {
    const of = dims[name];
    let value = content.constants.find(one => one.name === name)?.value;
    if (of) value = of.values ? of.values[at[name]] : of.codes[at[name]];
    if (row && name in row) value = row[name];
    value = at.free?.[name] ?? value;
    found[name] = mechanism.degrees.includes(name) ? value * Math.PI / 180 : value;
  }
  return found;
};
function branchesOf(at) {
  const constant = content.constants.find(one => one.name === "branch")?.value;
  if (dims.branch) return [(dims.branch.values ?? dims.branch.codes)[at.branch]];
  return constant ? [constant] : Object.keys(mechanism.branches).map(Number);
}
// A place {a2: 7, ...} is of the map; one with {free: {a2: 1.234}} is off its grid, with these inputs in the map's units.
let design = null;  // {at, row, motion, scene}
async function designAt(at) {
  const {free, ...places} = at, asked = source.row({at: places});
  const early = mechanism && !isSample ? motionOf(at, null) : null;  // while the row is on its way
  const row = await asked, found = {at, row, ...(early ?? (mechanism ? motionOf(at, row) : {}))};
  return free ? {...found, row: computedRow(found)} : found;
}
// What this page can tell of a design that the map does not hold.
function computedRow({at, row, motion}) {
  const found = {}, [branch] = motion.branches;
  for (const {name} of content.columns) found[name] = at.free[name] ?? row[name];
  for (const {name, of: [quantity, how]} of content.variables) {
    const value = quantity in FACTS ? how ? motion.reduced(quantity, how, branch) : valueOf(motion.at(givenAt(at), branch), quantity) : undefined;
    if (value !== undefined) found[name] = value;
  }
  return found;
}
// A design with some inputs changed; on the grid where these are all on it.
function settled({free, ...at}, changed) {
  const every = Object.entries({...free, ...changed}).filter(([, value]) => value !== undefined), places = {...at};
  const off = every.filter(([name, value]) => {
    const near = one => Math.abs(one - value) <= 1e-9 * Math.abs(one), k = dims[name]?.values?.findIndex(near) ?? -1;
    if (k >= 0) places[name] = k;
    return k < 0 && !(fieldOf(name).value !== undefined && near(fieldOf(name).value));
  });
  return off.length ? {...at, free: Object.fromEntries(every)} : places;
}
function depart(changed) {
  const at = settled(placeNow(), changed);  // not the design that is shown: an input typed just before may still be on its way
  if (at.free) pointTo(at, true);
  else change({at: {...at}, cursor: at, held: true});
}
const fieldOf = name => dims[name] ?? columns[name] ?? content.constants.find(one => one.name === name);
function givenAt(at) {
  const of = fieldOf(mechanism.position.name), value = (of?.values ?? of?.codes)?.[at[of.name]] ?? of?.value;
  return of?.units === "degree" ? value * Math.PI / 180 : value;
}
function motionOf(at, row) {
  const motion = new Motion(inputsOf(at, row), branchesOf(at));
  return {motion, scene: motion.ranges.length ? scene(motion) : null};
}
async function loadDesign() {
  await findDesign();
  drawDesign();
}
function drawDesign() {
  drawValues();
  drawMotion();
}
const placeNow = () => state.cursor ?? {...state.at};
let designAsked = 0, designAnswered = 0;
async function findDesign() {
  const at = placeNow(), key = JSON.stringify(at), turn = ++designAsked;
  if (design?.key !== key) {
    const found = await designAt(at);
    if (turn < designAnswered) return;  // a newer one came first
    designAnswered = turn;
    design = {...found, key};
    if (mechanism && dims[mechanism.position.name]?.values && variables[state.name].dims.includes(mechanism.position.name)) design.given = givenAt(at);
    if (dragging && design.scene) {
      design.scene.view = dragging.view;
      state.share = design.motion.shareOf(dragging.position);
    }
  }
}
function placeTexts(at) {
  return content.dims.filter(of => of.name in at && of.length > 1 && of.name !== "design").map(of => [of, coordinate(of, at[of.name])]);
}
function drawValues() {
  const {at, row} = design, inputs = mechanism?.inputs ?? [], entries = [], place = element("values");
  if (isSample) entries.push([{symbol: "design", meaning: "number of the design"}, String(at.design)]);
  for (const of of inputs.map(fieldOf)) entries.push([of, shown(valueIn(of, design), of)]);
  for (const [of, text] of placeTexts(at)) entries.push([of, text]);
  for (const of of content.columns) if (of.name in row) entries.push([of, shown(row[of.name], of)]);
  for (const of of content.constants.filter(one => one.units !== "1")) entries.push([of, shown(of.value, of)]);
  for (const of of content.variables) if (of.name in row) entries.push([of, shown(row[of.name], of, 6) + (at.free && of.of[1] ? " sampled" : "")]);
    else if (at.free) entries.push([of, "not computed"]);
  const rows = entries.filter(([of], k) => k < inputs.length + isSample || !inputs.includes(of.name)), key = JSON.stringify([rows.map(([of]) => of.name), state.degrees]);
  if (place.dataset.key !== key) {
    place.dataset.key = key;
    place.replaceChildren(...rows.map(([of, text]) => {
      const typed = of.name in (mechanism?.rules ?? {}) && make("input", {type: "number", step: "any", id: `type-${of.name}`, oninput: typedIn});
      const made = make("div", {title: `${of.meaning}${of.name ? ` (${of.name})` : ""}`}, make(typed ? "label" : "span", {htmlFor: `type-${of.name}`}, ...worded(of)),
        make("span", {className: "value"}, ...(typed ? [typed, unitsText(of.units)] : [])));
      made.dataset.name = of.name ?? "design";
      return made;
    }));
  }
  rows.forEach(([of, text], k) => {
    const made = place.children[k], typed = made.querySelector("input");
    made.className = of.name === state.name ? "shown" : "";
    if (!typed) made.lastChild.textContent = text;
    else if (typed !== document.activeElement) typed.value = +(valueIn(of, design) * factor(of.units)).toPrecision(6);
  });
  element("off").hidden = !mechanism;
  element("off").className = at.free ? "free" : "";
  element("told").textContent = at.free ? "Off the grid: computed by this page." : "Of the map. Type an input, or drag a joint.";
}
function typedIn({target}) {
  const name = target.id.slice(5), value = target.value === "" ? NaN : target.value / factor(fieldOf(name).units);
  target.setAttribute("aria-invalid", String(!allowed(name, value)));
  if (allowed(name, value)) depart({[name]: value});
}
function fillCurves() {
  if (!mechanism?.curves.length) { element("curved").hidden = true; return; }
  const select = element("curve"), own = mechanism.curves.find(one => state.name.startsWith(one.name) && (state.name.length === one.name.length
    || state.name[one.name.length] === "_"))?.name;
  if (!select.options.length) select.append(...mechanism.curves.map(option));
  select.value = state.curve || own || mechanism.curves[0].name;
}
const positionNow = () => design.given !== undefined && !state.playing && state.share === null ? design.given : design.motion.played(state.share ?? 0);
function drawMotion() {
  const linkage = element("linkage"), width = linkage.clientWidth, height = clamp(0.45 * width, 220, 340);
  if (!mechanism) { element("mechanism").hidden = true; return; }
  if (!design.scene) {
    const {pen} = prepared(linkage, height);
    write(pen, "this design does not assemble at any input position", width / 2, height / 2);
    prepared(element("curves"), 210);
    element("positioned").textContent = "";
    return;
  }
  drawFrame();
}
function drawFrame() {
  const linkage = element("linkage"), height = clamp(0.45 * linkage.clientWidth, 220, 340), position = positionNow();
  drawLinkage(linkage, height, design.scene, position);
  const of = mechanism.curves.find(one => one.name === element("curve").value);
  if (of) drawCurves(element("curves"), 210, of, [{motion: design.motion}, ...state.locks.flatMap(({motion, scene}, k) =>
    scene ? [{motion, number: k + 1}] : [])], position);
  if (state.share !== null) element("position").value = state.share;
  element("positioned").textContent = `${symbolText(mechanism.position.symbol)} = ${shown(position, mechanism.position, 4)}`;
  drawCards();
}
let last = null;
function tick(now) {
  if (state.playing && design?.scene && document.visibilityState === "visible") {
    if (last !== null) state.share = ((state.share ?? 0) + (now - last) / 6000) % 1;
    drawFrame();
  }
  last = state.playing ? now : null;
  requestAnimationFrame(tick);
}
function play(on) {
  state.playing = on;
  element("play").textContent = on ? "❚❚" : "▶";
}

// -- the view as a link --

function remember() {
  const kept = Object.fromEntries(LINKED.filter(key => JSON.stringify(state[key]) !== JSON.stringify(START[key])).map(key => [key, state[key]]));
  if (state.locks.length) kept.locks = state.locks.map(one => one.at);
  history.replaceState(null, "", `#${encodeURIComponent(JSON.stringify(kept))}`);
}
async function recall() {
  let kept = {};
  try { kept = JSON.parse(decodeURIComponent(location.hash.slice(1)) || "{}"); } catch { /* not a view */ }
  const isFree = free => mechanism && free && Object.entries(free).every(([name, value]) => name in mechanism.rules && allowed(name, value));
  const fits = at => at && Object.entries(at).every(([dim, place]) => dim === "free" ? isFree(place) : dim in dims && Number.isInteger(place) && place >= 0 && place < (dims[dim].length ?? Infinity));
  for (const key of LINKED) if (key in kept) state[key] = kept[key];
  if (!(state.name in variables)) state.name = content.variables[0].name;
  state.at = {...Object.fromEntries(content.dims.map(one => [one.name, 0])), ...(fits(kept.at) ? kept.at : state.at)};
  if (!fits(state.cursor)) state.cursor = null;
  settleAxes();
  state.locks = [];
  for (const at of (kept.locks ?? []).filter(fits)) state.locks.push(await designAt(at));
}

async function begin() {
  document.title = `${content.file || content.title} · fastlink`;
  element("title").textContent = content.file || content.title;
  defaults();
  await recall();
  drawControls();
  fillCurves();
  play(!window.matchMedia("(prefers-reduced-motion: reduce)").matches);
  listen();
  await load();
  drawLocked();
  await drawRegion();
  requestAnimationFrame(tick);
  document.body.dataset.ready = "yes";
}
