// Designs that are locked, side by side; and what is written of them.
"use strict";
async function lock(at) {
  if (!at || state.locks.some(one => JSON.stringify(one.at) === JSON.stringify(at))) return;
  state.locks.push(await designAt(at));
  said(`design ${state.locks.length} is locked`);
  locksChanged();
}
function locksChanged() {
  remember();
  drawOver();
  drawLocked();
  if (design) drawMotion();
}
function drawLocked() {
  const place = element("locked");
  place.hidden = !state.locks.length;
  if (place.hidden) { place.replaceChildren(); return; }
  const number = k => make("span", {className: "number", textContent: k + 1});
  const cards = make("div", {id: "cards"}, ...state.locks.map((one, k) => {
    const show = button("Show", () => { const {free, ...at} = one.at; change({at, cursor: one.at, held: true}); });
    const drop = button("Remove", () => { state.locks.splice(k, 1); locksChanged(); }, {title: `Remove design ${k + 1}`});
    return make("figure", {}, ...(mechanism ? [make("canvas", {})] : []), make("figcaption", {}, number(k), show, drop));
  }));
  place.replaceChildren(make("div", {className: "bar"}, make("h2", {textContent: "Locked designs"}),
    button("CSV", () => download("designs.csv", csvOf(state.locks)), {id: "to-csv"}),
    button("Study", () => saveStudy(state.locks), {id: "to-study", title: "A study of these designs, to be run by fastlink"}),
    button("Remove all", () => { state.locks = []; locksChanged(); })), cards, make("div", {className: "scroll"}, comparison(number)));
  drawCards();
}
function fieldsOf(entries) {
  const along = content.dims.filter(of => of.length > 1 || of.values).filter(of => of.name !== "design");
  return [...along, ...content.columns, ...content.constants, ...content.variables].filter(of =>
    entries.some(one => of.name in dims && of.name in one.at || of.name in one.row || of.name in (one.at.free ?? {})));
}
const valueIn = (of, {at, row}) => at.free?.[of.name] ?? of.value ?? (of.name in dims ? (of.values ? of.values[at[of.name]] : of.codes[at[of.name]]) : row[of.name]);
const textIn = (of, one) => of.name in dims && !(of.name in (one.at.free ?? {})) ? coordinate(of, one.at[of.name])
  : valueIn(of, one) === undefined ? "" : shown(valueIn(of, one), of, 6);
function comparison(number) {
  const fields = fieldsOf(state.locks);
  const head = make("tr", {}, make("th", {textContent: isSample ? "design" : ""}), ...state.locks.map((one, k) => make("th", {}, number(k), isSample ? ` ${one.at.design}` : "")));
  const rows = fields.map(of => {
    const values = state.locks.map(one => valueIn(of, one)), numbers = values.filter(Number.isFinite), differ = new Set(numbers).size > 1 && of.name in variables && !of.flags;
    return make("tr", {}, make("td", {title: of.name}, ...symbolNodes(of.symbol), of.meaning), ...state.locks.map((one, k) => make("td", {
      textContent: textIn(of, one), className: !differ ? "" : values[k] === Math.min(...numbers) ? "least" : values[k] === Math.max(...numbers) ? "most" : ""})));
  });
  return make("table", {id: "comparison"}, make("thead", {}, head), make("tbody", {}, ...rows));
}
function drawCards() {
  if (!mechanism) return;
  document.querySelectorAll("#cards canvas").forEach((canvas, k) => {
    const one = state.locks[k];
    if (one?.scene) drawLinkage(canvas, 130, one.scene, one.motion.played(state.share ?? 0.17), {small: true});
    else if (one) { const {pen, width} = prepared(canvas, 130); write(pen, "does not assemble", width / 2, 65); }
  });
}

// -- files --

const plain = x => typeof x === "number" ? (Number.isNaN(x) ? "" : Number.isFinite(x) ? String(x) : x > 0 ? "inf" : "-inf") : JSON.stringify(x);
function csvOf(entries) {
  const inputs = mechanism ? Object.keys(inputsOf(entries[0].at, entries[0].row)) : [], branch = dims.branch || content.constants.some(one => one.name === "branch");
  const others = fieldsOf(entries).filter(of => !inputs.includes(of.name) && of.name !== "branch");
  const head = [...inputs, ...(branch && mechanism ? ["branch"] : []), ...others.map(of => of.name)];
  const lines = entries.map(one => {
    const own = inputsOf(one.at, one.row);
    return [...inputs.map(name => own[name]), ...(branch && mechanism ? [branchesOf(one.at)[0]] : []), ...others.map(of => valueIn(of, one) ?? NaN)].map(plain).join(",");
  });
  return [head.join(","), ...lines, ""].join("\n");
}
function download(name, text) {
  const address = URL.createObjectURL(new Blob([text], {type: "text/plain"}));
  make("a", {href: address, download: name}).click();
  setTimeout(() => URL.revokeObjectURL(address), 10000);
}

// A study of some designs: one with its numbers, several with a table beside it.
function saveStudy(entries) {
  const files = studyOf(entries);
  Object.entries(files).forEach(([name, text], k) => setTimeout(() => download(name, text), 400 * k));
}
function studyOf(entries) {
  const {study, position} = mechanism, every = entries.map(one => inputsOf(one.at, one.row)), names = Object.keys(every[0]);
  const same = name => every.every(one => one[name] === every[0][name]), several = names.some(name => !same(name));
  const ofLinks = names.filter(name => study.links.includes(name) && same(name)), lines = [];
  const quantities = content.variables.filter(of => of.requested).map(of => JSON.stringify(of.name));
  lines.push(`# Chosen in ${content.file || "a map"}`, `mechanism = "${mechanism.name}"`, `quantities = [${quantities.join(", ")}]`, "", "[design]");
  if (several) lines.push('table = "study.csv"');
  else for (const name of names) if (!ofLinks.includes(name)) lines.push(`${name} = ${tomlOf(every[0][name])}`);
  if (ofLinks.length) lines.push("", "[links]", `model = "${study.model}"`, ...ofLinks.map(name => `${name} = ${tomlOf(every[0][name])}`));
  lines.push("", "[cycle]", `branch = [${[...new Set(entries.flatMap(one => branchesOf(one.at)))].sort().join(", ")}]`);
  if (study.input) lines.push(`input = "${study.input}"`);
  if (dims[position.name]?.values) lines.push(`${position.name} = {values = [${positionsOf(dims[position.name]).map(tomlOf).join(", ")}]}`);
  else if (study.count) lines.push(`angles = ${study.count}`);
  if (study.extrema === "sampled") lines.push('extrema = "sampled"');
  const files = {"study.toml": [...lines, ""].join("\n")};
  const along = names.filter(name => !ofLinks.includes(name));
  if (several) files["study.csv"] = [along.join(","), ...every.map(one => along.map(name => tomlOf(one[name])).join(",")), ""].join("\n");
  return files;
}
const positionsOf = of => of.units === "degree" ? of.values.map(one => one * Math.PI / 180) : of.values;
const tomlOf = x => Number.isInteger(x) && Math.abs(x) < 1e15 ? `${x}.0` : String(x);
