// A mechanism on a canvas, at a position: ground, bars, joints, names, the paths of traced points; and curves.
"use strict";
const MODES = content.modes, MODE_DASH = [7, 3];
const modeColour = branch => MODES[(branch - 1) % MODES.length];
const modeDash = branch => branch === 1 ? [] : MODE_DASH;

// What stands still for a design: its paths, and the view that holds all of its motion.
function scene(motion) {
  const traced = mechanism.points.filter(one => mechanism.traced.includes(one.name));
  const paths = [], corners = [];
  for (const branch of motion.branches) {
    for (const range of motion.ranges) {
      const own = traced.map(() => []);
      for (const position of motion.along(121, range)) {
        const known = motion.at(position, branch);
        for (const one of mechanism.points) {
          const place = motion.place(known, one);
          if (place.every(Number.isFinite)) corners.push(place);
          const k = traced.indexOf(one);
          if (k >= 0) own[k].push(place);
        }
      }
      own.forEach(points => paths.push({branch, points}));
    }
  }
  const sorted = k => corners.map(one => one[k]).sort((a, b) => a - b);
  const share = mechanism.metric === "minkowskian" ? 0.04 : 0;
  const [x, y] = [0, 1].map(k => {
    const all = sorted(k), at = one => all[Math.round(one * (all.length - 1))] ?? 0;
    return [at(share), at(1 - share)];
  });
  return {motion, paths, view: [x[0], x[1], y[0], y[1]]};
}

// From the plane of the mechanism to a canvas, and back.
function framing(view, width, height, small = false) {
  const margin = small ? 14 : state.forces ? 60 : 34;
  const wide = Math.max(view[1] - view[0], 1e-9), high = Math.max(view[3] - view[2], 1e-9);
  const scale = Math.min((width - 2 * margin) / wide, (height - 2 * margin) / high);
  const middle = [0.5 * (view[0] + view[1]), 0.5 * (view[2] + view[3])];
  return [([x, y]) => [width / 2 + (x - middle[0]) * scale, height / 2 - (y - middle[1]) * scale],
    ([x, y]) => [middle[0] + (x - width / 2) / scale, middle[1] - (y - height / 2) / scale]];
}
function drawLinkage(canvas, height, {motion, paths, view}, position, {small = false} = {}) {
  const {pen, width} = prepared(canvas, height), [on] = framing(view, width, height, small);
  if (mechanism.metric === "minkowskian" && !small)
    for (const one of mechanism.points.filter(point => point.kind === "ground")) {
      const [x, y] = on(motion.place(motion.at(position, motion.branches[0]), one)), far = width + height;
      for (const side of [1, -1])
        line(pen, [[x - far, y + side * far], [x + far, y - side * far]], {strokeStyle: "#dfc89a", lineWidth: 1, dash: [2, 4]});
    }
  for (const {branch, points} of paths)
    line(pen, points.map(on), {strokeStyle: modeColour(branch), lineWidth: 1.2, dash: modeDash(branch), globalAlpha: 0.55});
  let ground = false, drawn = 0;
  for (const branch of motion.branches) {
    const known = motion.at(position, branch);
    const places = Object.fromEntries(mechanism.points.map(one => [one.name, on(motion.place(known, one))]));
    if (!ground) { drawGround(pen, places, width, small, motion, known, on); ground = true; }
    if (motion.assembles(position, [branch])) { drawBars(pen, places, branch, small, drawn === 0); drawn += 1; }
  }
  if (!drawn) write(pen, "does not assemble here", width / 2, height - 12);
  else if (state.forces && !small) drawLoads(pen, motion, position, on, height);
  return drawn;
}

// Forces as arrows, torques as turned ones; all of a kind by one scale, the greatest of the motion.
const ARROW = 0.22, RADIUS = 17;  // of the height; pixels
function drawLoads(pen, motion, position, on, height) {
  let top = 14;
  for (const [units, most] of Object.entries(motion.greatest)) {
    write(pen, `${units === "N" ? "forces" : "torques"}, the greatest ${short(+most.toPrecision(3))} ${units}`, 8, top, {textAlign: "left"});
    top += 15;
  }
  for (const branch of motion.branches.filter(one => motion.assembles(position, [one]))) {
    const known = motion.at(position, branch), style = {strokeStyle: INK, fillStyle: INK, lineWidth: 1.4};
    for (const load of mechanism.loads) {
      const [x, y] = on(motion.place(known, mechanism.points.find(one => one.name === load.at)));
      const parts = load.of.map(name => valueOf(known, name) / motion.greatest[load.units]);
      if (![x, y, ...parts].every(Number.isFinite) || Math.hypot(...parts) < 1e-3) continue;
      let end, turn, head = 8;
      if (parts.length === 2) {
        end = [x + ARROW * height * parts[0], y - ARROW * height * parts[1]];
        turn = Math.atan2(y - end[1], end[0] - x);
        head = Math.min(head, 0.6 * Math.hypot(end[0] - x, end[1] - y));
        line(pen, [[x, y], end], style);
      } else {
        const from = 0.7, to = from + Math.sign(parts[0]) * (0.6 + 3.6 * Math.abs(parts[0]));
        const path = Array.from({length: 33}, (_, k) => from + (to - from) * k / 32).map(angle => [x + RADIUS * Math.cos(angle), y - RADIUS * Math.sin(angle)]);
        end = path.at(-1);
        turn = to + Math.sign(parts[0]) * Math.PI / 2;
        line(pen, path, {...style, fillStyle: undefined});
      }
      const tip = [0, 2.7, -2.7].map(by => [end[0] + (by ? head : 0) * Math.cos(turn + by), end[1] - (by ? head : 0) * Math.sin(turn + by)]);
      line(pen, [...tip, tip[0]], style);
      write(pen, symbolText(load.symbol), end[0] + 12 * Math.cos(turn), end[1] - 12 * Math.sin(turn), {fillStyle: INK, halo: true, gives: true});
    }
  }
}

function drawGround(pen, places, width, small, motion, known, on) {
  const size = small ? 0.6 : 1;
  for (const guide of mechanism.guides) {
    const value = name => valueOf(known, name);
    const [a, b] = guide.y !== null ? [on([0, value(guide.y)])[1]] : [on([value(guide.x), 0])[0]];
    const [from, to] = guide.y !== null ? [[0, a + 7 * size], [width, a + 7 * size]] : [[a, 0], [a, width]];
    line(pen, [from, to], {strokeStyle: INK, lineWidth: 1});
    for (let x = 6; x < width && guide.y !== null; x += 9)
      line(pen, [[x, a + 7 * size], [x - 5, a + 12 * size]], {strokeStyle: INK, lineWidth: 0.7});
  }
  for (const one of mechanism.points.filter(point => point.kind === "ground")) {
    const [x, y] = places[one.name];
    line(pen, [[x, y], [x - 8 * size, y + 13 * size], [x + 8 * size, y + 13 * size], [x, y]],
      {strokeStyle: INK, lineWidth: 1, fillStyle: "#fff"});
    line(pen, [[x - 13 * size, y + 13 * size], [x + 13 * size, y + 13 * size]], {strokeStyle: INK, lineWidth: 1.2});
    for (let k = -2; k <= 3; k++)
      line(pen, [[x + 4.5 * k * size, y + 13 * size], [x + (4.5 * k - 5) * size, y + 18 * size]], {strokeStyle: INK, lineWidth: 0.8});
  }
}

function drawBars(pen, places, branch, small, named) {
  const colour = modeColour(branch), hollow = branch !== 1, size = small ? 0.6 : 1;
  for (const bar of mechanism.bars) {
    if (bar.ground) continue;
    const points = bar.points.map(name => places[name]).filter(place => place.every(Number.isFinite));
    if (points.length > 2) line(pen, [...points, points[0]], {strokeStyle: colour, lineWidth: 1, fillStyle: colour + "22"});
    const ends = points.slice(0, 2);
    line(pen, ends, {strokeStyle: colour, lineWidth: 5 * size});
    if (hollow) line(pen, ends, {strokeStyle: "#fff", lineWidth: 2.4 * size});
  }
  const xs = Object.values(places), middle = [0, 1].map(k => xs.reduce((sum, one) => sum + one[k], 0) / xs.length);
  for (const one of mechanism.points) {
    const [x, y] = places[one.name];
    if (!Number.isFinite(x) || !Number.isFinite(y)) continue;
    pen.save();
    Object.assign(pen, {strokeStyle: one.kind === "ground" ? INK : colour, fillStyle: one.kind === "traced" ? colour : "#fff", lineWidth: 1.6});
    pen.beginPath();
    if (one.kind === "slider") pen.rect(x - 11 * size, y - 7 * size, 22 * size, 14 * size);
    else pen.arc(x, y, (one.kind === "traced" ? 3.2 : 4.6) * size, 0, 7);
    pen.fill();
    pen.stroke();
    pen.restore();
    if (named && !small && one.named) {
      const away = Math.hypot(x - middle[0], y - middle[1]) || 1;
      const side = one.kind === "ground" ? [x < middle[0] ? -15 : 15, -3] : [15 * (x - middle[0]) / away, 15 * (y - middle[1]) / away];
      write(pen, one.name, x + side[0], y + side[1], {fillStyle: INK, font: `italic 14px ${FONT}`, halo: true, gives: true});
    }
  }
}

// Curves of one quantity over the input: those of the designs given, each with its motion, number and colour.
function drawCurves(canvas, height, of, entries, position) {
  const {pen, width} = prepared(canvas, height);
  const box = {left: 62, right: width - 26, top: 8, bottom: height - 36};
  const every = entries.flatMap(({motion}) => motion.branches.map(branch => ({motion, branch, curves: motion.curve(of.name, branch)})));
  const values = every.flatMap(({curves}) => curves.flat().map(point => point[1])).filter(Number.isFinite).sort((a, b) => a - b);
  if (!values.length) { write(pen, "no finite values", width / 2, height / 2); return; }
  let low = values[0], high = values.at(-1);
  const inner = [0.03, 0.97].map(share => values[Math.round(share * (values.length - 1))]);
  if (high - low > 12 * (inner[1] - inner[0]) && inner[1] > inner[0]) {  // poles must not use up the axis
    const span = inner[1] - inner[0];
    [low, high] = [Math.max(low, inner[0] - 0.6 * span), Math.min(high, inner[1] + 0.6 * span)];
  }
  if (high - low < 1e-12 * Math.max(Math.abs(low), Math.abs(high)) || high === low) { low -= Math.abs(low) || 1; high += Math.abs(high) || 1; }
  const pad = 0.2 * (high - low), main = entries[0].motion;
  [low, high] = [low - pad, high + pad];
  const from = Math.min(...entries.map(one => one.motion.ranges[0]?.[0] ?? Infinity));
  const to = Math.max(...entries.map(one => one.motion.ranges.at(-1)?.[1] ?? -Infinity));
  const x = at => box.left + (at - from) / (to - from) * (box.right - box.left);
  const y = value => box.bottom - (value - low) / (high - low) * (box.bottom - box.top);
  const turn = factor(mechanism.position.units), scale = factor(of.units);
  for (const tick of ticks(from * turn, to * turn, 7, turn !== 1)) {
    line(pen, [[x(tick / turn), box.top], [x(tick / turn), box.bottom]], {strokeStyle: "#eceff3", lineWidth: 1});
    write(pen, short(tick), x(tick / turn), box.bottom + 11, {drops: true});
  }
  for (const tick of ticks(low * scale, high * scale, 5)) {
    line(pen, [[box.left, y(tick / scale)], [box.right, y(tick / scale)]], {strokeStyle: "#eceff3", lineWidth: 1});
    write(pen, short(tick), box.left - 6, y(tick / scale), {textAlign: "right", drops: true});
  }
  write(pen, labelled(pen, mechanism.position, box.right - box.left), 0.5 * (box.left + box.right), height - 9);
  pen.save();
  pen.beginPath();
  pen.rect(box.left, box.top - 4, box.right - box.left, box.bottom - box.top + 8);
  pen.clip();
  every.forEach(({motion, branch, curves}) => {
    const own = motion === main;
    for (const points of curves)
      line(pen, cutAngles(points, of.units).map(([at, value]) => [x(at), y(value)]), {strokeStyle: own ? modeColour(branch) : "#8b94a1",
        lineWidth: own ? 1.8 : 1, dash: modeDash(branch)});
  });
  const here = main.within(position);
  line(pen, [[x(here), box.top], [x(here), box.bottom]], {strokeStyle: SOFT, lineWidth: 1});
  pen.restore();
  for (const {motion, branch, curves} of every) {
    if (motion !== main) continue;
    const ends = motion.extremes(of.name, branch, curves), near = 1e-4 * (to - from);
    for (const {position: at, value, sign} of motion.bends(of.name, branch, curves, isAngle(of.units) ? Math.PI : Infinity)) {
      if (value < low || value > high || ends.some(one => one.sign === sign && Math.abs(at - one.position) % (2 * Math.PI) < near)) continue;
      const top = y(value), there = x(at < from ? at + 2 * Math.PI : at);
      line(pen, [[there - 3.5, top - sign * 7], [there + 3.5, top - sign * 7], [there, top - sign * 2], [there - 3.5, top - sign * 7]],
        {strokeStyle: modeColour(branch), fillStyle: "#fff", lineWidth: 1});
    }
    for (const {position: at, value, sign} of ends) {
      const top = clamp(y(value), box.top, box.bottom);
      line(pen, [[x(at) - 5, top - sign * 9], [x(at) + 5, top - sign * 9], [x(at), top - sign * 2], [x(at) - 5, top - sign * 9]],
        {strokeStyle: modeColour(branch), fillStyle: modeColour(branch), lineWidth: 1});
      write(pen, shown(value, of, 4), clamp(x(at), box.left + 30, box.right - 34), clamp(top - sign * 17, 9, box.bottom - 8), {fillStyle: INK, halo: true, gives: true});
    }
    const now = valueOf(motion.at(position, branch), of.name);
    if (Number.isFinite(now) && now >= low && now <= high) {
      pen.beginPath();
      pen.arc(x(here), y(now), 3.6, 0, 7);
      pen.fillStyle = modeColour(branch);
      pen.fill();
    }
  }
  for (const {motion, number} of entries.slice(1)) {
    const [at, value] = motion.curve(of.name, motion.branches[0], 9).flat().findLast(point => Number.isFinite(point[1])) ?? [NaN, NaN];
    if (Number.isFinite(at)) write(pen, String(number), x(at) + 10, clamp(y(value), box.top + 6, box.bottom - 6), {halo: true, fillStyle: INK, gives: true});
  }
}
// An angle that passes half a turn goes on at the other side: no line joins the two.
function cutAngles(points, units) {
  if (!isAngle(units)) return points;
  return points.flatMap((point, k) => k && Math.abs(point[1] - points[k - 1][1]) > Math.PI ? [[point[0], NaN], point] : [point]);
}
