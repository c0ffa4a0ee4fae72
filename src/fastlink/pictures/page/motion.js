// The motion of a design by the facts of its mechanism: where it assembles, where its points are, its curves.
"use strict";
const mechanism = content.mechanism;
const FACTS = /*FACTS*/;
const SAMPLES = 360, HALVINGS = 44;

function valueOf(known, name) {
  if (typeof name === "number") return name;
  const own = known[name];
  if (own !== undefined) return own;
  const step = FACTS[name];
  if (step === undefined) return NaN;
  const [law, needs, names] = step;
  const result = law(...needs.map(one => valueOf(known, one)));
  if (names.length === 1) known[name] = result;
  else names.forEach((one, k) => { known[one] = result[k]; });
  return known[name];
}

// The inputs, and the position, that a value follows from.
const needed = {};
const needsOf = name => needed[name] ??= new Set(FACTS[name] ? FACTS[name][1].flatMap(one => [...needsOf(one)])
  : [...Object.keys(mechanism.rules), mechanism.position.name].filter(one => one === name));
const allowed = (name, x) => Number.isFinite(x) && (x > 0 || !["positive", "non-negative"].includes(mechanism.rules[name]) || x === 0 && mechanism.rules[name] !== "positive");
// What dragging a point changes: what it needs, of inputs and position, and no point needs that needs fewer.
function moversOf(point) {
  const needs = one => new Set([...needsOf(one.x), ...needsOf(one.y)]), own = needs(point);
  const fewer = mechanism.points.map(needs).filter(some => some.size < own.size && [...some].every(one => own.has(one)));
  const left = [...own].filter(name => !fewer.some(some => some.has(name)));
  return left.length ? left : [...own];
}

class Motion {
  // inputs: those of the design in SI units and radians; branches: the branches
  constructor(inputs, branches) {
    this.inputs = {...mechanism.constants, ...inputs};
    this.branches = branches;
    this.turns = mechanism.turns;
    const ends = mechanism.spans[mechanism.position.name] ?? [1, 1];
    const [low, high] = this.turns ? [Math.PI, Math.PI] : ends.map(end => valueOf({...this.inputs, branch: branches[0],
      [mechanism.position.name]: 0}, end));
    this.span = [-low, high];
    this.joints = mechanism.points.filter(one => one.kind === "joint" || one.kind === "slider");
    this.ranges = this.findRanges();
  }
  at(position, branch) { return {...this.inputs, branch, [mechanism.position.name]: position}; }
  place(known, point) { return [valueOf(known, point.x), valueOf(known, point.y)]; }
  places(position, branch, points = mechanism.points) {
    const known = this.at(position, branch);
    return Object.fromEntries(points.map(one => [one.name, this.place(known, one)]));
  }
  assembles(position, branches = this.branches) {
    return branches.some(branch => {
      const known = this.at(position, branch);
      return this.joints.every(one => this.place(known, one).every(Number.isFinite));
    });
  }
  findRanges(branches = this.branches) {
    const [low, high] = this.span, step = (high - low) / SAMPLES;
    if (!(high > low)) return [];
    const samples = [low, ...Array.from({length: SAMPLES}, (_, k) => low + step * (k + 0.5)), high];
    const inside = samples.map(one => this.assembles(one, branches));
    if (inside.every(Boolean)) return [[low, high]];
    const bounds = inside[0] ? [low] : [];
    for (let k = 1; k < samples.length; k++)
      if (inside[k] !== inside[k - 1]) {
        let [good, bad] = inside[k - 1] ? [samples[k - 1], samples[k]] : [samples[k], samples[k - 1]];
        for (let n = 0; n < HALVINGS; n++) {
          const middle = 0.5 * (good + bad);
          if (this.assembles(middle, branches)) good = middle; else bad = middle;
        }
        bounds.push(good);
      }
    if (inside.at(-1)) bounds.push(high);
    let found = [];
    for (let k = 0; k + 1 < bounds.length; k += 2) found.push([bounds[k], bounds[k + 1]]);
    if (this.turns && inside[0] && inside.at(-1) && found.length > 1)  // one range about half a turn
      found = [[found.at(-1)[0], found[0][1] + 2 * Math.PI], ...found.slice(1, -1)];
    return found;
  }
  get turnsFully() { return this.turns && this.ranges.length === 1 && this.ranges[0][0] === this.span[0]
    && this.ranges[0][1] === this.span[1]; }
  get widest() { return this.ranges.reduce((a, b) => b[1] - b[0] > a[1] - a[0] ? b : a, this.ranges[0]); }
  along(count, range = this.widest) {
    const [low, high] = range, even = this.turnsFully;
    return Array.from({length: count}, (_, k) => {
      const share = k / (count - 1);
      return low + (high - low) * (even ? share : 0.5 - 0.5 * Math.cos(Math.PI * share));
    });
  }
  // share of a cycle from 0 to 1: a turn, or there and back
  played(share) {
    const [low, high] = this.widest;
    return this.turnsFully ? low + (high - low) * share : 0.5 * (low + high) - 0.5 * (high - low) * Math.cos(2 * Math.PI * share);
  }
  shareOf(position) {
    const [low, high] = this.widest, share = Math.min(1, Math.max(0, (this.within(position) - low) / (high - low)));
    return this.turnsFully ? share : Math.acos(1 - 2 * share) / (2 * Math.PI);
  }
  // What brings a point nearest to a place: Gauss-Newton by differences, as far as the linkage holds together.
  moved(point, branch, position, [x, y]) {
    const names = moversOf(point), inputs = names.filter(name => name in mechanism.rules);
    let known = this.at(position, branch), miss = this.missed(known, point, x, y);
    for (let n = 0; n < 30; n++) {
      const slopes = names.map(name => {
        const by = 1e-6 * Math.max(1e-3, Math.abs(known[name]));
        const [up, down] = [by, -by].map(one => this.missed({...known, [name]: known[name] + one}, point, x, y));
        return [0, 1].map(k => (down[k] - up[k]) / (2 * by));
      });
      const sum = (i, j) => slopes.reduce((total, one) => total + one[i] * one[j], 0), damping = 1e-9 * (sum(0, 0) + sum(1, 1));
      const [a, b, d] = [sum(0, 0) + damping, sum(0, 1), sum(1, 1) + damping], det = a * d - b * b;
      const [p, q] = [(d * miss[0] - b * miss[1]) / det, (a * miss[1] - b * miss[0]) / det];
      let part = 1, better = null;
      for (; part > 1e-3 && !better; part /= 2) {
        const next = {...known};
        names.forEach((name, k) => { next[name] += part * (slopes[k][0] * p + slopes[k][1] * q); });
        const rest = this.missed(next, point, x, y);
        if (Math.hypot(...rest) < (1 - 1e-9) * Math.hypot(...miss) && this.holds(next, inputs)) better = [next, rest];
      }
      if (!better) break;
      [known, miss] = better;
    }
    return {position: known[mechanism.position.name], inputs: Object.fromEntries(inputs.map(name => [name, known[name]]))};
  }
  missed(known, point, x, y) {
    const [a, b] = this.place({...known}, point);
    return [x - a, y - b];
  }
  holds(known, inputs) {
    const copy = {...known};
    return inputs.every(name => allowed(name, known[name])) && this.joints.every(one => this.place(copy, one).every(Number.isFinite));
  }
  // A reduction over the cycle by samples, precise where it is an extreme; undefined where samples do not tell it.
  reduced(name, how, branch) {
    const curves = this.curve(name, branch);
    if (how === "mean" || how === "rms") {
      if (!this.turnsFully) return undefined;
      const values = curves[0].slice(1).map(([, y]) => how === "rms" ? y * y : y), mean = values.reduce((a, b) => a + b, 0) / values.length;
      return how === "rms" ? Math.sqrt(mean) : mean;
    }
    if (!["max", "min", "peak"].includes(how)) return undefined;
    const size = how === "peak" ? Math.abs : one => one, values = this.extremes(name, branch, curves).map(one => one.value);
    for (const points of this.turnsFully ? [] : curves) for (const k of [0, -1])  // at a toggle it grows without bound
      if (Math.abs(points.at(k)[1]) > 100 * Math.abs(points.at(3 * k + 1)[1])) values.push(Math.sign(points.at(k)[1]) * Infinity);
    return values.length ? Math[how === "min" ? "min" : "max"](...values.map(size)) : NaN;
  }
  // the greatest of the forces and of the torques over the motion, by their units
  get greatest() {
    if (this.most) return this.most;
    const positions = this.ranges.flatMap(range => this.along(61, range)), most = this.most = {};
    for (const known of this.branches.flatMap(branch => positions.map(one => this.at(one, branch))))
      for (const load of mechanism.loads) {
        const size = Math.hypot(...load.of.map(name => valueOf(known, name)));
        if (Number.isFinite(size)) most[load.units] = Math.max(most[load.units] ?? 0, size);
      }
    return most;
  }
  within(position) {
    if (!this.turns) return position;
    const low = this.widest[0];
    return low + ((((position - low) % (2 * Math.PI)) + 2 * Math.PI) % (2 * Math.PI));
  }
  curve(name, branch, count = 241) {
    return this.ranges.map(range => this.along(count, range).map(position => [position, valueOf(this.at(position, branch), name)]));
  }
  // where a value is greatest (sign 1) or least between two positions, by golden section
  refined(of, sign, low, high) {
    const ratio = (Math.sqrt(5) - 1) / 2;
    for (let n = 0; n < 60; n++) {
      const a = high - ratio * (high - low), b = low + ratio * (high - low);
      if (sign * of(a) > sign * of(b)) high = b; else low = a;
    }
    const position = 0.5 * (low + high);
    return {position, value: of(position), sign};
  }
  // all maxima and minima of a curve that are seen at its samples, which an angle's jump by a turn is not
  bends(name, branch, curves, leap = Infinity) {
    const of = position => valueOf(this.at(position, branch), name), found = [];
    for (const points of curves) {
      const finite = points.map(point => point[1]).filter(Number.isFinite), last = points.length - 1;
      const low = finite.reduce((a, b) => Math.min(a, b), Infinity), high = finite.reduce((a, b) => Math.max(a, b), -Infinity);
      const least = 1e-9 * Math.max(high - low, 1e-3 * Math.abs(high), 1e-3 * Math.abs(low)), loop = this.turnsFully;
      for (let k = loop ? 0 : 1; k < last; k++) {
        const [before, here, after] = [k ? k - 1 : last - 1, k, k + 1].map(one => points[one][1]);
        const [up, on] = [here - before, here - after];
        if (!(Math.max(Math.abs(up), Math.abs(on)) > least && Math.max(Math.abs(up), Math.abs(on)) < leap)) continue;
        const sign = up >= 0 && on > 0 ? 1 : up <= 0 && on < 0 ? -1 : 0;
        const start = k ? points[k - 1][0] : points[0][0] - (points[last][0] - points[last - 1][0]);
        if (sign) found.push(this.refined(of, sign, start, points[k + 1][0]));
      }
    }
    return found;
  }
  // the greatest and the least value of a curve, made precise between its samples
  extremes(name, branch, curves) {
    const of = position => valueOf(this.at(position, branch), name);
    return [1, -1].map(sign => {
      let best = null;
      for (const points of curves) points.forEach(([, y], k) => {
        if (Number.isFinite(y) && (best === null || sign * y > sign * best.points[best.k][1])) best = {points, k};
      });
      if (best === null) return null;
      const {points, k} = best;
      const found = this.refined(of, sign, points[Math.max(0, k - 1)][0], points[Math.min(points.length - 1, k + 1)][0]);
      return sign * found.value > sign * points[k][1] ? found : {position: points[k][0], value: points[k][1], sign};
    }).filter(Boolean);
  }
}
