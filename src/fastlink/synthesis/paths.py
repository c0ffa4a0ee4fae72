"""Path generation: a linkage whose coupler point passes points, or follows a curve, timed or not."""

from __future__ import annotations

import threading
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from importlib.resources import files
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.fft import fft, ifft, irfft, rfft

from fastlink.codegen.kernel import backend_of, load_kernel
from fastlink.codegen.source import N_ANGLES, Array, Source
from fastlink.engine.run import aligned, default_threads
from fastlink.machine import work_in_threads
from fastlink.synthesis.kernels import assembled, rates

__all__ = ["NUMBERS", "Candidates", "PathTask", "pins", "refinement", "solve_path"]

Floats = NDArray[np.float64]
Complex = NDArray[np.complex128]

# -- The kernel of `kernels.py`


#: Linkages side by side in the kernel, and those of one piece of work.
WIDE, PART = 8, 64


@dataclass(frozen=True)
class _Refinement(Source):
    """The kernel that refines linkages; its arguments before the scratch are its own."""

    @property
    def arguments(self) -> list[tuple[str, tuple[int | None, ...]]]:
        """The dtype of each argument, and its axes."""
        given = ["float64"] * 7 + ["int64", *["float64"] * 4]
        linkages, points = ((None, 10), (None, 2), (None, None), (None,)), ((None, 2), (None,), (None,))
        shapes = [*linkages, *points, (4,), *[(10,)] * 3, (1,)]
        return [*zip(given, shapes, strict=True), ("int64", ()), *super().arguments[4:]]


@cache
def refinement() -> Source:
    """Return the kernel."""
    text = files("fastlink.synthesis").joinpath("kernels.py").read_text(encoding="utf-8")
    rows = dict(p=10, side=2, theta=N_ANGLES, q=10, moved=N_ANGLES, d=10, scales=10, f=14, v=8)
    shapes: dict[str, tuple[Any, ...]] = {name: (count, WIDE) for name, count in rows.items()} | {
        "m": (N_ANGLES, 11, WIDE), "along": (N_ANGLES, WIDE), "slope": (N_ANGLES, WIDE),
        "across": (N_ANGLES, 11, WIDE), "g": (23, 11), "w": (13, 12), "h": (10, 10)}  # fmt: skip
    return _Refinement(text, 0, 0, doubles(shapes), ())


def doubles(shapes: Mapping[str, tuple[Any, ...]]) -> tuple[Array, ...]:
    """Return arrays of doubles for a kernel."""
    return tuple(Array(name, "float64", shape) for name, shape in shapes.items())


#: Numbers of a linkage in kernels.
NUMBERS = ("a1", "a2", "a3", "a4", "P_u", "P_v", "O_x", "O_y", "ground_angle", "phase")
#: Those of a slider-crank: D is infinitely far across its line; the offset takes the place of a3, and a4 is none.
SLIDER = ("r", "l", "e", "", *NUMBERS[4:])
#: Places of a swept curve.
PLACES = 64
#: Closed paths of so many points are followed as whole curves.
WHOLE = 24
#: Up to so many points a path has all its starts.
MANY = 40
#: Parts of a curve that an open path may be.
SPANS = (0.05, 0.1, 0.17, 0.25, 0.35, 0.45, 0.57, 0.7, 0.85, 1.0)


@dataclass(frozen=True)
class PathTask:
    """A path or a motion that was checked."""

    #: The points, of a motion those of the body.
    target: NDArray[np.complex128]
    #: Crank angles from the first point on, where the timing is given.
    times: NDArray[np.float64] | None = None
    #: Whether the path closes.
    closed: bool = False
    #: Whether the crank is to turn fully, and angles are to follow each other.
    crank: bool = True
    #: How often each point counts.
    weights: NDArray[np.float64] = field(default_factory=lambda: np.empty(0))
    #: Whether a slider-crank is to pass it.
    slider: bool = False
    #: Limits of the numbers of a linkage.
    lower: NDArray[np.float64] = field(default_factory=lambda: np.full(10, -np.inf))
    upper: NDArray[np.float64] = field(default_factory=lambda: np.full(10, np.inf))
    #: Of poses the directions, and the length that weighs them.
    angles: Any = None
    length: float = 1.0
    #: The numbers of a linkage that are given, of two to four poses; NaN where one is free.
    fixed: NDArray[np.float64] = field(default_factory=lambda: np.full(10, np.nan))

    def __post_init__(self) -> None:
        if not self.weights.size:
            object.__setattr__(self, "weights", np.ones(len(self.target)))

    @property
    def size(self) -> float:
        """The sum of the squared distances from the mean."""
        return float(np.sum(np.abs(self.target - self.target.mean()) ** 2))

    @property
    def extent(self) -> float:
        """The greatest distance from the mean, or the length that weighs angles where all points are one."""
        return float(np.abs(self.target - self.target.mean()).max()) or self.length

    @property
    def is_whole(self) -> bool:
        """Whether the path counts as a curve that is followed as a whole."""
        return self.closed and self.times is None and len(self.target) >= WHOLE and not self.slider

    @property
    def share(self) -> NDArray[np.float64]:
        """How much of the length each point has behind it: of the whole curve where the path closes."""
        steps = np.abs(np.diff(self.target))
        behind = np.append(0.0, np.cumsum(steps))
        whole = behind[-1] + (abs(self.target[0] - self.target[-1]) if self.closed else 0.0)
        return np.asarray(behind / whole)


@dataclass
class Candidates:
    """Linkages in kernels: rows of ten numbers, of signs s and senses, of angles; sums of squares."""

    numbers: NDArray[np.float64]
    signs: NDArray[np.float64]
    theta: NDArray[np.float64]
    cost: NDArray[np.float64]
    #: From how many starts each was reached.
    starts: NDArray[np.int64]

    def parts(self) -> tuple[Any, ...]:
        """Return the arrays."""
        return self.numbers, self.signs, self.theta, self.cost, self.starts

    def at(self, rows: Any) -> Candidates:
        """Return a copy of some rows."""
        return Candidates(*(np.array(part[rows], order="C") for part in self.parts()))


def shapes_of(count: int, seed: int, skip: int, slider: bool) -> Floats:
    """Return shapes (a2, a3, a4, P_u, P_v by a1) of cranks that turn fully, from a Sobol sequence.

    a1 and the three sums of Grashof's condition are free positive numbers: each of them times a1 as a power of ten; of
    slider-cranks the offset, and what the rod is longer than it and the crank.
    """
    from scipy.stats import qmc  # 0.3 s, for paths alone

    engine = qmc.Sobol(6, scramble=True, seed=seed)
    if skip:
        engine.fast_forward(skip)
    x = engine.random(count)
    p, q, r = 10.0 ** (2.6 * x[:, :3] - 1.3).T
    # crank-rockers, and one in six a double crank: a4 less than a1
    double = x[:, 5] < 1.0 / 6.0
    a1 = np.ones(count)
    big = a1 + (q + r) / 2.0
    a4 = np.where(double, a1, big)
    a1 = np.where(double, big, a1)
    short = np.minimum(a1, a4)
    a2, a3 = short + (p + r) / 2.0, short + (p + q) / 2.0
    if slider:
        a1, a2, a3, a4 = np.ones(count), 1.0 + p + q, p, np.zeros(count)
    radius, turn = 2.5 * np.sqrt(x[:, 3]), 2.0 * np.pi * x[:, 4]
    u, v = a2 * (0.5 + radius * np.cos(turn)), a2 * radius * np.sin(turn)
    return np.ascontiguousarray(np.stack([a2, a3, a4, u, v], axis=1) / a1[:, None])


def pins(numbers: Floats, theta: Any, side: Any, slider: bool = False) -> tuple[Complex, ...]:
    """Return O and D of linkages, then A, B and P (linkages, angles), in the frame of the task.

    NaN where the bars do not meet. Of slider-cranks D is the direction across the line of the slider.
    """
    n = numbers[:, :, None]
    a1, a2, a3, a4, u, v = (n[:, k] for k in range(6))
    turn, o = np.exp(1j * n[:, 8]), n[:, 6] + 1j * n[:, 7]
    with np.errstate(all="ignore"):
        c, s = np.cos(theta), np.sin(theta)
        ax, ay, bx, by, *_, x, y = assembled(a1, a2, a3, a4, u, v, side, c, s, int(slider))
        a = ax + 1j * ay
        moving = (o + turn * of for of in (a, a + a2 * (bx + 1j * by), x + 1j * y))
        return o[:, 0], (1j * turn if slider else o + turn * a4)[:, 0], *moving


def from_pins(
    o: Any, d: Any, a: Any, b: Any, point: Any, slider: bool = False
) -> tuple[Floats, Floats, Floats]:
    """Return numbers, crank angles and sides of linkages of O, D (linkages) and A, B, P (linkages, points).

    The inverse of `pins`.
    """
    o, d = o[:, None], d[:, None]
    ground, bar = d if slider else d - o, b - a
    with np.errstate(all="ignore"):
        place = ((point - a) / (bar / np.abs(bar))).mean(axis=1)
        turn = ground[:, 0] * (-1j if slider else 1.0)
        theta = np.angle((a - o) / turn[:, None])
        side = np.sign((np.conj(ground if slider else d - a) * bar).imag)
    last = (np.conj(d) * (b - o)).real if slider else np.abs(b - d)
    numbers = [np.abs(a - o).mean(axis=1), np.abs(bar).mean(axis=1), last.mean(axis=1),
               np.abs(ground[:, 0]) * (not slider), place.real, place.imag, o[:, 0].real, o[:, 0].imag,
               np.angle(turn), np.zeros(len(o))]  # fmt: skip
    return np.stack(numbers, axis=1), theta, side


def at_shares(values: Any, points: Complex, share: Floats) -> Any:
    """Return values (curves, places) where so many shares of the length of curves (curves, places) are behind."""
    behind = np.concatenate([np.zeros((len(points), 1)), np.cumsum(np.abs(np.diff(points)), axis=1)], axis=1)
    # all curves in one table, one after the other
    rows = np.arange(len(points))[:, None]
    table = (behind / behind[:, -1:] + rows).ravel()
    return np.interp((share + rows).ravel(), table, values.ravel()).reshape(len(points), -1)


def starts_of(task: PathTask, count: int, keep: int, seed: int, skip: int = 0) -> Candidates:
    """Return the linkages whose curves are most like a path, of so many shapes.

    Each curve has equal places, by its length or with times by the crank angle. What the best turn, size and place of
    it leave of the squares, for all first places at once, is made of circular correlations with the path.
    """
    shapes = np.repeat(shapes_of(count, seed, skip, task.slider), 2, axis=0)
    side = np.tile([[-1.0], [1.0]], (count, 1))
    numbers = np.concatenate([np.ones((2 * count, 1)), shapes, np.zeros((2 * count, 4))], axis=1)
    turns = np.arange(PLACES + 1) / PLACES
    z = pins(numbers, 2.0 * np.pi * turns, side, task.slider)[-1]
    at = np.broadcast_to(turns, z.shape)
    timed = task.times is not None
    if not timed:
        at, z = (at_shares(of, z, turns[:-1]) for of in (at, z))
    at, z = at[:, :PLACES], z[:, :PLACES]
    share = task.share if task.times is None else task.times / (2.0 * np.pi)
    centre, n, whole = task.target.mean(), len(task.target), task.size
    # sizes at which a shape is within the limits of its numbers
    with np.errstate(divide="ignore", invalid="ignore"):
        ends = np.sort(np.stack([task.lower[:6] / numbers[:, :6], task.upper[:6] / numbers[:, :6]]), axis=0)
        least, most = ends[0].max(axis=1, keepdims=True), ends[1].min(axis=1, keepdims=True)
    curves, squares, products = fft(z), rfft(np.abs(z) ** 2), rfft((np.conj(z) * np.roll(z, -1, 1)).real)
    best, how = np.full(2 * count, np.inf), np.zeros((2 * count, 3))
    for span in (1.0,) if task.closed or timed else SPANS:
        offset = share * span * PLACES
        low, part = np.floor(offset).astype(int), offset % 1.0

        def comb(
            to_first: Any, to_next: Any, sense: float, of: Any = fft, low: Any = low
        ) -> Complex:  # of points between two places, backwards for the other sense
            made = np.zeros(PLACES, dtype=np.result_type(to_first, to_next))
            np.add.at(made, low % PLACES, to_first)
            np.add.at(made, (low + 1) % PLACES, to_next)
            return np.asarray(of(made) if sense < 0.0 else np.conj(of(np.conj(made))))

        path = np.conj(task.target - centre)
        for sense in (1.0,) if timed else (1.0, -1.0):
            mean = ifft(curves * comb(1.0 - part, part, sense)) / n
            both = ifft(curves * comb(path * (1.0 - part), path * part, sense))
            twice = 2.0 * part * (1.0 - part)
            own = squares * comb((1.0 - part) ** 2, part**2, sense, rfft)
            ahead, back = (twice, 0.0 * part) if sense > 0.0 else (0.0 * part, twice)
            own += products * comb(ahead, back, sense, rfft)
            own = irfft(own, PLACES) - n * np.abs(mean) ** 2
            with np.errstate(divide="ignore", invalid="ignore"):
                size = np.abs(both) / own
                left = whole - np.abs(both) * size
                place = centre - np.conj(both) / own * mean
            within = (size >= least) & (size <= most)
            for k, of in ((6, place.real), (7, place.imag)):
                if np.isfinite(task.lower[k]) or np.isfinite(task.upper[k]):
                    within &= (of >= task.lower[k]) & (of <= task.upper[k])
            left = np.where(own > 1e-12 * n, np.where(within, left, 1e4 * left), np.inf)
            k = np.argmin(left, axis=1)
            left = left[np.arange(2 * count), k]
            better = left < best
            best[better] = left[better]
            how[better, 0], how[better, 1], how[better, 2] = k[better], sense, span
    # half of them are the best of all, half the best of small groups: what fits best may lie in one long valley
    groups = np.array_split(np.arange(2 * count), keep // 2)
    rows = np.argsort(best, kind="stable")[: keep - len(groups)]
    rows = np.unique(np.concatenate([rows, [group[np.argmin(best[group])] for group in groups]]))
    rows = rows[np.isfinite(best[rows])]
    numbers, at, (first, sense, span) = numbers[rows], at[rows], (of[:, None] for of in how[rows].T)
    # the angles there, and how the points at these are turned, sized and placed
    where = first + sense * span * share * PLACES
    below = np.floor(where)
    one, other = (
        np.take_along_axis(at, (below + k).astype(int) % PLACES, 1) + (below + k) // PLACES for k in (0, 1)
    )
    theta = 2.0 * np.pi * (one + (where - below) * (other - one))
    points = pins(numbers, theta, side[rows], task.slider)[-1]
    middle = points.mean(axis=1, keepdims=True)
    factor = (np.conj(points - middle) @ (task.target - centre)) / (np.abs(points - middle) ** 2).sum(axis=1)
    numbers[:, :6] *= np.abs(factor)[:, None]
    place = centre - factor * middle[:, 0]
    numbers[:, 6], numbers[:, 7], numbers[:, 8] = place.real, place.imag, np.angle(factor)
    numbers[:, 9] = 2.0 * np.pi * first[:, 0] / PLACES if timed else 0.0
    signs = np.concatenate([side[rows], sense], axis=1)
    return fit_limits(task, Candidates(numbers, signs, theta, best[rows], np.ones(len(rows), dtype=np.int64)))


def refined(task: PathTask, found: Candidates, most: int, *, angles_only: bool = False) -> Candidates:
    """Return linkages after so many steps at most, the best first."""
    source = refinement()
    code = load_kernel(source, backend_of(None))
    n = len(task.target)
    target = np.stack([task.target.real, task.target.imag], axis=1)
    times = np.zeros(n) if task.times is None else task.times
    options = np.array([task.times is not None, task.crank, task.closed, task.slider], dtype=np.int64)
    free = (task.lower < task.upper).astype(float) * (not angles_only)
    free[[3, 9]] *= not task.slider, task.times is not None
    enough = np.array([1e-31 * float(np.sum(np.abs(task.target - task.target[0]) ** 2))])
    fixed = (target, np.sqrt(task.weights), times, options, free, task.lower, task.upper, enough, most)
    count = max(-(-len(found.cost) // PART), 1)
    made = [found.at(slice(k, None, count)) for k in range(count)]

    def work(part: Candidates, scratch: Any) -> None:
        code(part.numbers, part.signs, part.theta, part.cost, *fixed, *scratch)

    in_threads(work, made, source, 2 * n + 10)
    whole = joined(*made)
    return whole.at(np.isfinite(whole.cost))


def in_threads(work: Any, parts: Sequence[Any], source: Source, rows: int) -> None:
    """Work on parts by a kernel, each thread with its scratch."""
    left = iter(parts)

    def each() -> None:
        scratch = [aligned(array.lengths(rows), array.dtype) for array in source.scratch]
        for part in left:
            work(part, scratch)

    work_in_threads(each, min(default_threads(), len(parts)), "synthesis", threading.Event())


#: Shapes that are compared in each round, of closed or timed paths and of open ones; starts that are refined.
SHAPES, SHAPES_OPEN, KEPT = 4096, 1024, 1000
#: Stages of the refinement: how many linkages go on, for how many steps each.
STAGES = ((KEPT, 30), (300, 150), (40, 1500))
#: Rounds at most; an error so small beside the size of the path counts as none.
ROUNDS, EXACT = 4, 1e-11
#: Linkages that are the same to so much of their size are told once; and how many are told at most.
SAME, MOST = 1e-6, 400


def solve_path(task: PathTask, seed: int, rounds: int, steps: Any, *, all_rounds: bool) -> Candidates:
    """Return the linkages that come nearest to a path, all different ones that were found, the best first.

    Rounds of starts go on until a linkage passes all points, or the best one was found a second time; or all are made,
    for a choice by other measures.
    """
    open_path = not task.closed and task.times is None
    shapes = SHAPES_OPEN if open_path else SHAPES
    few = min(1.0, MANY / len(task.target))
    shapes, kept = (shapes, KEPT) if few == 1.0 else (shapes // 2, max(100, int(KEPT * few)))
    found: Candidates | None = None

    def refined_starts(number: int) -> tuple[Any, ...]:
        starts = starts_of(task, shapes, min(kept, shapes), seed, number * shapes)
        for most, count in STAGES:  # fewer of longer ones
            most, count = max(8, int(most * few)), max(30, int(count * few))
            # what passes all points already stays: by other measures it may be the best
            met = int(np.searchsorted(starts.cost, EXACT**2 * task.size)) if count > STAGES[0][1] else 0
            starts = refined(task, starts.at(slice(0, max(most, min(met, 5 * STAGES[-1][0])))), count)
        return starts.parts()

    for number in range(rounds):
        starts = Candidates(*steps(refined_starts, number))
        found = merged(starts if found is None else joined(found, starts))
        if not len(found.cost):
            continue
        again = 20 if task.slider else 1  # of fewer shapes many have the same end
        if not all_rounds and (found.cost[0] <= EXACT**2 * task.size or found.starts[0] > again):
            break
    assert found is not None
    return found


#: Of whole curves: starts that are refined by length, for so many steps; places of the path and of the curve then.
BY_LENGTH, LENGTH_STEPS, UNIFORM, FINE = 60, 40, 100, 256


def solve_curve(task: PathTask, seed: int) -> Candidates:
    """Return linkages whose whole curves follow a closed path, and what they become if points alone count."""
    found = by_length(task, starts_of(task, SHAPES, BY_LENGTH, seed))
    polished = refined(task, found.at(slice(0, BY_LENGTH // 3)), 300)
    return merged(joined(refined(task, found, 10, angles_only=True), polished))


def by_length(task: PathTask, found: Candidates) -> Candidates:
    """Return linkages refined so that equal shares of the length of curves and path meet.

    By Levenberg-Marquardt with differences. Unknowns are the logarithms of the shortest link and of Grashof's sums, so
    that cranks turn, then the other numbers and the first crank angle.
    """
    target = task.target - task.target.mean()
    around = np.append(target, target[0])[None]
    wanted = at_shares(around, around, np.arange(UNIFORM) / UNIFORM)[0]
    size, middle = float(np.sqrt(np.mean(np.abs(wanted) ** 2))), task.target.mean()
    shift = np.array([*[0.0] * 6, middle.real, middle.imag, 0.0, 0.0])
    n = found.numbers - shift
    double = (n[:, 0] > n[:, 3])[:, None]

    def unknowns(n: Floats) -> Floats:
        short, long = (np.where(double[:, 0], n[:, i], n[:, k]) for i, k in ((3, 0), (0, 3)))
        big, one, other = long - short, n[:, 1] - short, n[:, 2] - short
        sums = np.stack([one + other - big, big + other - one, big + one - other, short], axis=1)
        return np.asarray(np.log(np.maximum(sums, 1e-9 * short[:, None])))

    def numbers(x: Floats, double: Any) -> Floats:
        p, q, r, short = np.exp(x[:, :4]).T[:, :, None]
        long = short + (q + r) / 2.0
        lengths = [np.where(double, long, short), short + (p + r) / 2.0, short + (p + q) / 2.0,
                   np.where(double, short, long)]  # fmt: skip
        return np.concatenate([*lengths, x[:, 4:9], 0.0 * x[:, :1]], axis=1)

    def off(x: Floats, double: Any, signs: Floats) -> Floats:
        n, turns = numbers(x, double), 2.0 * np.pi * np.arange(FINE + 1) / FINE
        theta = x[:, 9:] + signs[:, 1:] * turns
        theta = at_shares(theta, pins(n, theta, signs[:, :1])[-1], np.arange(UNIFORM) / UNIFORM)
        away = pins(n, theta, signs[:, :1])[-1] - wanted
        return np.concatenate([away.real, away.imag], axis=1)

    x = np.concatenate([unknowns(n), n[:, 4:9], found.theta[:, :1]], axis=1)
    steps = 1e-6 * np.array([1.0] * 4 + [size] * 4 + [1.0] * 2)
    count, damping = len(x), np.full(len(x), 1e-3)
    now = off(x, double, found.signs)
    cost = np.sum(now**2, axis=1)
    for _ in range(LENGTH_STEPS):
        beside = (x[:, None] + np.diag(steps)).reshape(-1, 10)
        there = off(beside, np.repeat(double, 10, axis=0), np.repeat(found.signs, 10, axis=0))
        j = np.nan_to_num((there.reshape(count, 10, -1) - now[:, None]) / steps[:, None])
        h = j @ j.swapaxes(1, 2)
        diagonal = np.einsum("mii->mi", h)
        least = 1e-12 * diagonal.max(axis=1, keepdims=True) + 1e-300
        h = h + np.einsum("mi,ij->mij", damping[:, None] * diagonal + least, np.eye(10))
        step = -solved(h, (j @ now[:, :, None])[:, :, 0])
        moved = x + np.concatenate([np.clip(step[:, :4], -1.0, 1.0), step[:, 4:]], axis=1)
        n = np.clip(numbers(moved, double), task.lower - shift, task.upper - shift)
        n[:, 9] = 0.0
        moved[:, :9] = np.concatenate([unknowns(n), n[:, 4:9]], axis=1)
        other = off(moved, double, found.signs)
        better = np.sum(other**2, axis=1) < cost
        x[better], now[better] = moved[better], other[better]
        cost = np.sum(now**2, axis=1)
        damping = np.where(better, 0.2 * damping, np.minimum(4.0 * damping, 1e8))
    order = np.argsort(cost, kind="stable")
    made, x = found.at(order), x[order]
    made.numbers, made.cost = numbers(x, double[order]), cost[order]
    turns = x[:, 9:] + made.signs[:, 1:] * 2.0 * np.pi * np.arange(FINE + 1) / FINE
    made.theta = at_shares(turns, pins(made.numbers, turns, made.signs[:, :1])[-1], task.share)
    made.numbers += shift
    return made


def varied(
    task: PathTask, numbers: Floats, theta: Floats, side: Floats, change: float, rng: Any
) -> Candidates:
    """Return linkages that pass a path to its rounding, near others: these are changed at random and refined."""
    n, by = numbers.copy(), change * rng.normal(size=numbers.shape)
    lengths = [0, 1] if task.slider else [0, 1, 2, 3]
    n[:, lengths] *= np.exp(by[:, lengths])
    size = np.sqrt(task.size / len(task.target)) + np.abs(n)
    rest = [k for k in range(8) if k not in lengths]
    n[:, rest] += by[:, rest] * size[:, rest]
    n[:, 8:] += by[:, 8:] * [1.0, task.times is not None]
    sense = np.ones(len(n)) if task.times is not None else np.sign(theta[:, -1] - theta[:, 0])
    signs, ones = np.stack([side, sense], axis=1), np.ones(len(n), dtype=np.int64)
    made = refined(task, fit_limits(task, Candidates(n, signs, theta, 0.0 * side, ones)), 100)
    return made.at(made.cost <= EXACT**2 * task.size)


def fit_limits(task: PathTask, found: Candidates) -> Candidates:
    """Return starts moved, in place, into the limits of numbers: given lengths size all, angles turn by whole turns."""
    numbers = found.numbers
    for k in range(2 if task.slider else 4):
        if task.lower[k] == task.upper[k]:
            numbers[:, :6] *= (task.lower[k] / numbers[:, k])[:, None]
            break
    for k in (8, 9):
        low = task.lower[k] if np.isfinite(task.lower[k]) else -np.pi
        numbers[:, k] = low + np.remainder(numbers[:, k] - low, 2.0 * np.pi)
    np.clip(numbers, task.lower, task.upper, out=numbers)
    return found


def joined(*several: Candidates) -> Candidates:
    """Return the linkages of several, the best first."""
    both = Candidates(*map(np.concatenate, zip(*(one.parts() for one in several), strict=True)))
    return both.at(np.argsort(both.cost, kind="stable"))


def wrapped(angles: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return angles within half a turn."""
    return np.asarray(np.remainder(angles + np.pi, 2.0 * np.pi) - np.pi)


def turned(angles: Any, start: float) -> Any:
    """Return angles within a turn from a start, by whole turns: one that is there but for rounding keeps its bits."""
    return angles - 2.0 * np.pi * np.floor((angles - start + 1e-9) / (2.0 * np.pi))


def cosines(theta: Floats, whole: Any) -> tuple[Floats, Floats]:
    """Return the least and the greatest cosine between the ends of angles (linkages, angles), exactly; or of a turn."""
    low, high, turn = theta.min(axis=1), theta.max(axis=1), 2.0 * np.pi
    on, back = (
        np.floor((high - of) / turn) > np.floor((low - of) / turn) - (np.remainder(low - of, turn) == 0.0)
        for of in (0.0, np.pi)
    )
    ends = np.cos(low), np.cos(high)
    least = np.where(back | whole, -1.0, np.minimum(*ends))
    return least, np.where(on | whole, 1.0, np.maximum(*ends))


def transmission(
    a1: Floats, a2: Any, a3: Floats, a4: Any, theta: Floats, whole: Any, slider: bool
) -> tuple[Floats, Any]:
    """Return the least acute transmission angle between the ends of crank angles, and whether a dead point is there."""
    least, most = cosines(theta - (0.5 * np.pi if slider else 0.0), whole)
    with np.errstate(invalid="ignore", divide="ignore"):
        if slider:  # cosines of the transmission angle, the least and the greatest of what is used
            of = (a1 * least - a3) / a2, (a1 * most - a3) / a2
            dead = (of[0] <= -1.0) | (of[1] >= 1.0)
        else:
            near, far = (np.sqrt(np.maximum(a1**2 + a4**2 - 2.0 * a1 * a4 * c, 0.0)) for c in (most, least))
            dead = (far >= a2 + a3) | (near <= np.abs(a2 - a3))
            of = tuple((a2**2 + a3**2 - one**2) / (2.0 * a2 * a3) for one in (near, far))
        return np.arccos(np.minimum(np.maximum(*np.abs(of)), 1.0)), dead


def solved(matrices: Floats, right: Floats) -> Floats:
    """Return the solutions of many small systems, NaN where one is singular."""
    det = np.linalg.det(matrices)
    singular = ~(np.abs(det) > 0.0)
    matrices = np.where(singular[:, None, None], np.eye(matrices.shape[-1]), matrices)
    found = np.linalg.solve(matrices, right[..., None])[..., 0]
    return np.where(singular[:, None], np.nan, found)


def merged(found: Candidates) -> Candidates:
    """Return different linkages, the best of each, with the number of starts that ended there."""
    kept, starts = different(found.numbers, found.signs[:, 0], found.starts, MOST)
    result = found.at(kept)
    result.starts = np.array(starts, dtype=np.int64)
    return result


def different(
    numbers: Floats, signs: Floats, starts: NDArray[np.int64], most: int, least: float = SAME
) -> tuple[list[int], list[int]]:
    """Return the rows of the first of linkages that are the same, and from how many starts each was reached."""
    kept, counts = list[int](), list[int]()
    for k, one in enumerate(numbers):
        off = np.abs(numbers[kept, :8] - one[:8]).max(axis=1, initial=0.0) / one[:4].max()
        turn = np.abs(wrapped(numbers[kept, 8] - one[8]))
        same = (off < least) & (turn < least) & (signs[kept] == signs[k])
        if same.any():
            counts[int(np.argmax(same))] += int(starts[k])
        elif len(kept) < most:
            kept.append(k)
            counts.append(int(starts[k]))
    return kept, counts


@np.errstate(all="ignore")
def curve_of(n: Floats, theta: Floats, side: float, slider: bool) -> tuple[Any, ...]:
    """Return coupler points of one linkage, and their derivatives by its numbers and (last) the crank angle.

    Then the direction of AB as a complex number, the derivatives of its angle, and whether the bars meet.
    """
    (a1, a2, a3, a4, u, v), c, s = n[:6], np.cos(theta), np.sin(theta)
    ax, ay, bx, by, fx, fy, x, y = assembled(a1, a2, a3, a4, u, v, side, c, s, int(slider))
    turns = rates(a2, ax, ay, bx, by, fx, fy, c, s, int(slider))
    turn, b = np.exp(1j * n[8]), bx + 1j * by
    rate, along = np.zeros((len(theta), 10)), np.zeros((len(theta), 10), dtype=complex)
    for k, one in zip((0, 1, 2, 3, 9), turns, strict=True):
        rate[:, k] = one
    along[:, 0], along[:, 4], along[:, 5], along[:, 9] = c + 1j * s, b, 1j * b, 1j * (ax + 1j * ay)
    along += (1j * (x - ax) - (y - ay))[:, None] * rate
    along[:, 8] = 1j * (x + 1j * y)
    along *= turn
    along[:, 6], along[:, 7] = 1.0, 1j
    rate[:, 8] = 1.0
    point = complex(n[6], n[7]) + turn * (x + 1j * y)
    return point, np.nan_to_num(along), turn * b, np.nan_to_num(rate), bool(np.isfinite(x).all())


class Fit:
    """How far a linkage is from a task, as a function of its numbers; crank angles without times follow these.

    From points; or from poses, in places and in directions times a length: the last number is the body's angle from AB.
    """

    def __init__(self, task: PathTask, theta: Floats, side: float) -> None:
        self.task, self.theta, self.side = task, theta.copy(), side

    @np.errstate(all="ignore")  # at a dead point rates are infinite
    def __call__(self, n: Floats, whole: bool = False) -> tuple[Floats, Floats]:
        """Return the errors and their derivatives; or of each point the root of the sum of its squares."""
        task, roots = self.task, np.sqrt(self.task.weights)
        for _ in range(6):
            if task.times is not None:
                self.theta = n[9] + task.times
            point, by, along, rate, meets = curve_of(n, self.theta, self.side, task.slider)
            away, slopes = point - task.target, np.stack([by.real, by.imag, task.length * rate])
            off = np.stack([away.real, away.imag, 0.0 * away.real])
            if task.angles is None:
                slopes[2] = 0.0
            else:
                off[2] = task.length * wrapped(np.angle(along) + n[9] - task.angles)
            off, slopes = off * roots, slopes * roots[:, None]
            crank = slopes[:, :, 9:].copy()
            square = (crank**2).sum(axis=0) + 1e-300
            turn = -(crank[..., 0] * off).sum(axis=0) / square[:, 0]
            if not meets or task.times is not None or np.abs(turn).max() < 1e-13:
                break
            self.theta = self.theta + np.clip(turn, -0.3, 0.3)
        if not meets:
            off = np.full_like(off, 1e3 * (np.sqrt(task.size) + task.length))
            slopes = 0.0 * np.nan_to_num(slopes)
        elif task.times is None:
            slopes[:, :, 9] = 0.0
            slopes[2, :, 9] = task.length * (task.angles is not None)
            slopes -= crank * (crank * slopes).sum(axis=0) / square
        if whole:
            size = np.sqrt((off**2).sum(axis=0)) + 1e-300
            return size, (off[..., None] * slopes).sum(axis=0) / size[:, None]
        return off.ravel(), slopes.reshape(-1, 10)
