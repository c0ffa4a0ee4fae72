// The values of a map that this page carries itself, compressed, for those without a server.
"use strict";
const unpacked = {};
// Bytes of one kind together compress better: the first of all numbers, the second of all numbers, ...
async function arrayOf(name) {
  if (!(name in unpacked)) unpacked[name] = (async () => {
    const {data, type} = content.arrays[name], width = type === "f8" ? 8 : 4;
    const packed = Uint8Array.from(atob(data), letter => letter.charCodeAt(0));
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
    const apart = new Uint8Array(await new Response(stream).arrayBuffer()), count = apart.length / width;
    const bytes = new Uint8Array(apart.length);
    for (let b = 0; b < width; b++) for (let k = 0; k < count; k++) bytes[k * width + b] = apart[b * count + k];
    return width === 8 ? new Float64Array(bytes.buffer) : new Float32Array(bytes.buffer);
  })();
  return unpacked[name];
}
// A part of an array: along each dimension a place, or [first, last, step]; in the order of axes.
async function partOf(name, axes, at, window) {
  const own = content.arrays[name].dims, values = await arrayOf(name), strides = {};
  let stride = 1;
  for (const dim of [...own].reverse()) { strides[dim] = stride; stride *= dims[dim].length; }
  let start = 0;
  for (const dim of own) if (!axes.includes(dim)) start += at[dim] * strides[dim];
  const ranges = axes.map(dim => {
    const [low, high, step] = window[dim];
    return Array.from({length: Math.floor((high - low) / step) + 1}, (_, k) => (low + k * step) * (strides[dim] ?? 0));
  });
  const found = new Float64Array(ranges.reduce((count, one) => count * one.length, 1));
  let next = 0;
  const fill = (n, base) => {
    if (n === ranges.length - 1) for (const one of ranges[n]) found[next++] = values[base + one];
    else for (const one of ranges[n]) fill(n + 1, base + one);
  };
  fill(0, start);
  return found;
}
const MOST_CELLS = 720, MOST_ROWS = 1500, MOST_BEST = 12;
const inWindow = (dim, window, most) => {
  const [low, high] = window[dim] ?? [0, dims[dim].length - 1];
  return [low, high, Math.max(1, Math.ceil((high - low + 1) / most))];
};
// One value for each cell of several, as `_pooled` in content.py has it.
function pooledOf(values, sizes, steps, pool) {
  const [high, wide] = sizes.length > 1 ? sizes : [1, sizes[0]], [down, across] = steps.length > 1 ? steps : [1, steps[0]];
  const found = new Float64Array(Math.ceil(high / down) * Math.ceil(wide / across));
  let next = 0;
  for (let j = 0; j < high; j += down) for (let k = 0; k < wide; k += across) {
    let total = 0, count = 0, low = NaN, top = NaN;
    for (let a = j; a < Math.min(high, j + down); a++) for (let b = k; b < Math.min(wide, k + across); b++) {
      const one = values[a * wide + b];
      if (Number.isNaN(one)) continue;
      if (Number.isFinite(one)) { total += one; count++; }
      if (!(low <= one)) low = one;
      if (!(top >= one)) top = one;
    }
    found[next++] = pool === "least" ? low : pool === "greatest" || !count ? top : total / count;
  }
  return found;
}
// Ranges with steps that leave about so many designs as are drawn; the shortest keep most.
function someOf(axes, window) {
  const found = {}, lengthOf = dim => window[dim][1] - window[dim][0] + 1;
  let left = MOST_ROWS;
  [...axes].sort((a, b) => lengthOf(a) - lengthOf(b)).forEach((dim, number) => {
    const step = Math.ceil(lengthOf(dim) / Math.floor(left ** (1 / (axes.length - number)) + 1e-9));
    found[dim] = [...window[dim], step];
    left = Math.floor(left / Math.ceil(lengthOf(dim) / step));
  });
  return found;
}
const embedded = {
  async picture({name, axes, at, window, pool = "one"}) {
    const most = axes.length > 1 ? MOST_CELLS : MOST_CELLS ** 2, scale = content.scales[name];
    const whole = Object.fromEntries(axes.map(dim => [dim, inWindow(dim, window, most)]));
    const steps = Object.fromEntries(axes.map(dim => [dim, whole[dim][2]]));
    if (pool === "one" || !scale.pools || Object.values(steps).every(one => one === 1))
      return {values: await partOf(name, axes, at, whole), steps, scale, pooled: "one"};
    const every = Object.fromEntries(axes.map(dim => [dim, [...whole[dim].slice(0, 2), 1]]));
    const sizes = axes.map(dim => whole[dim][1] - whole[dim][0] + 1);
    return {values: pooledOf(await partOf(name, axes, at, every), sizes, axes.map(dim => steps[dim]), pool), steps, scale, pooled: pool};
  },
  async column({name, at}) {
    return {values: await partOf(name, ["design"], at, {design: [0, dims.design.length - 1, content.step]}), scale: content.scales[name]};
  },
  async row({at}) {
    const found = {};
    for (const [name, {dims: own}] of Object.entries(content.arrays)) {
      if (!own.every(dim => dim in at)) continue;
      const axes = own.slice(-1), window = Object.fromEntries(axes.map(dim => [dim, [at[dim], at[dim], 1]]));
      found[name] = (await partOf(name, axes, at, window))[0];
    }
    return found;
  },
  async region({name, axes, at, window, largest}) {
    const sizes = axes.map(dim => window[dim][1] - window[dim][0] + 1), count = sizes.reduce((a, b) => a * b, 1);
    const some = someOf(axes, window);
    const full = Object.fromEntries(axes.map(dim => [dim, [...window[dim], 1]]));
    const values = {};
    for (const of of content.variables) if (of.dims.every(dim => dim in at || axes.includes(dim))) values[of.name] = Array.from(await partOf(of.name, axes, at, some));
    const ranked = Array.from(await partOf(name, axes, at, full), (value, k) => [value, k]).filter(one => Number.isFinite(one[0]))
      .sort((a, b) => (largest ? b[0] - a[0] : a[0] - b[0]) || a[1] - b[1]).slice(0, MOST_BEST);
    const placed = (k, ranges, sizes) => {
      const own = {...at};
      for (let n = axes.length - 1; n >= 0; n--) { own[axes[n]] = ranges[axes[n]][0] + (k % sizes[n]) * ranges[axes[n]][2]; k = Math.floor(k / sizes[n]); }
      return own;
    };
    const lengths = axes.map(dim => Math.floor((some[dim][1] - some[dim][0]) / some[dim][2]) + 1);
    const places = Array.from({length: lengths.reduce((a, b) => a * b, 1)}, (_, k) => placed(k, some, lengths));
    const best = [];
    for (const [, k] of ranked) { const own = placed(k, full, sizes); best.push({at: own, row: await embedded.row({at: own})}); }
    return {count, values, axes: Object.fromEntries(axes.map(dim => [dim, places.map(one => one[dim])])), best};
  },
};
