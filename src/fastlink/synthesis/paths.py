"""Path generation: a linkage whose coupler point passes points, or follows a curve, timed or not."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cache
from importlib.resources import files
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.stats import qmc

from fastlink.codegen.kernel import load_kernel
from fastlink.codegen.source import Source

__all__ = ["NUMBERS", "Candidates", "PathTask", "compiled", "solve_path"]

#: The arguments of each kernel: kinds and numbers of axes, see `kernels.py`.
ARGUMENTS = {
    "refine": "f2 f2 f2 c1 f1 f1 i1 f1 f1 f1 i1 i0",
    "compare": "f2 c1 f1 f1 f1 i0 i0 i0 i0 f1 f1 f1 f2",
    "dyads": "f3 f3 f3 i1",
    "freudenstein": "f2 f2 f2 f2 f2 f3",
    "begin": "f2 f2 f2 c1 f1 f1 i0 i0 f2 f2",
}
KINDS = {"f": "float64", "c": "complex128", "i": "int64"}


@dataclass(frozen=True)
class _Text(Source):
    """A kernel whose arguments are its own."""

    given: tuple[tuple[str, int], ...] = ()

    @property
    def arguments(self) -> list[tuple[str, tuple[int | None, ...]]]:
        """The dtype of each argument, and its axes."""
        return [(dtype, (None,) * axes) for dtype, axes in self.given]


@cache
def compiled(name: str) -> Callable[..., None]:
    """Return a kernel of `kernels.py`, compiled by numba, or from the cache."""
    text = files("fastlink.synthesis").joinpath("kernels.py").read_text(encoding="utf-8")
    given = tuple((KINDS[one[0]], int(one[1])) for one in ARGUMENTS[name].split())
    return load_kernel(_Text(f"{text}\n\nkernel = {name}\n", 0, 0, (), (), given=given), "numba")


#: Numbers of a linkage in kernels.
NUMBERS = ("a1", "a2", "a3", "a4", "P_u", "P_v", "O_x", "O_y", "ground_angle", "phase")
#: Places of a swept curve, and starts on it that are tried.
PLACES, PHASES = 64, 32
#: Points of a path that shapes are compared with, at most.
COMPARED = 20
#: Parts of a curve that an open path may be.
SPANS = (0.05, 0.1, 0.17, 0.25, 0.35, 0.45, 0.57, 0.7, 0.85, 1.0)


@dataclass(frozen=True)
class PathTask:
    """A path that was checked."""

    #: The points.
    target: NDArray[np.complex128]
    #: Crank angles from the first point on, where the timing is given.
    times: NDArray[np.float64] | None = None
    #: Whether the path closes.
    closed: bool = False
    #: Whether the crank is to turn fully, and angles are to follow each other.
    crank: bool = True
    #: How often each point counts.
    weights: NDArray[np.float64] = field(default_factory=lambda: np.empty(0))
    #: Limits of the numbers of a linkage.
    lower: NDArray[np.float64] = field(default_factory=lambda: np.full(10, -np.inf))
    upper: NDArray[np.float64] = field(default_factory=lambda: np.full(10, np.inf))

    def __post_init__(self) -> None:
        if not self.weights.size:
            object.__setattr__(self, "weights", np.ones(len(self.target)))

    @property
    def size(self) -> float:
        """The sum of the squared distances from the mean."""
        return float(np.sum(np.abs(self.target - self.target.mean()) ** 2))

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

    def at(self, rows: Any) -> Candidates:
        """Return some rows."""
        return Candidates(*(np.ascontiguousarray(part[rows]) for part in
                            (self.numbers, self.signs, self.theta, self.cost, self.starts)))  # fmt: skip


def shapes_of(count: int, seed: int, skip: int = 0) -> NDArray[np.float64]:
    """Return shapes (a2, a3, a4, P_u, P_v by a1) of cranks that turn fully, from a Sobol sequence.

    a1 and the three sums of Grashof's condition are free positive numbers: each of them times a1 as a power of ten.
    """
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
    radius, turn = 2.5 * np.sqrt(x[:, 3]), 2.0 * np.pi * x[:, 4]
    u, v = a2 * (0.5 + radius * np.cos(turn)), a2 * radius * np.sin(turn)
    return np.ascontiguousarray(np.stack([a2, a3, a4, u, v], axis=1) / a1[:, None])


def starts_of(task: PathTask, count: int, keep: int, seed: int, skip: int = 0) -> Candidates:
    """Return the linkages whose curves are most like a path, of so many shapes."""
    shapes = shapes_of(count, seed, skip)
    best, how = np.empty(2 * count), np.zeros((2 * count, 3))
    timed = task.times is not None
    times = task.times if task.times is not None else np.zeros(len(task.target))
    spans = np.array([1.0]) if task.closed or timed else np.array(SPANS)
    some = np.unique(
        np.linspace(0, len(task.target) - 1, min(len(task.target), COMPARED)).round().astype(int)
    )
    compiled("compare")(shapes, task.target[some], task.share[some], times[some], spans, int(timed), PLACES, PHASES, 2,
                        task.lower, task.upper, best, how)  # fmt: skip
    # half of them are the best of all, half the best of small groups: what fits best may lie in one long valley
    groups = np.array_split(np.arange(2 * count), keep // 2)
    rows = np.argsort(best, kind="stable")[: keep - len(groups)]
    rows = np.unique(np.concatenate([rows, [group[np.argmin(best[group])] for group in groups]]))
    rows = rows[np.isfinite(best[rows])]
    signs = np.stack([2.0 * (rows % 2) - 1.0, how[rows, 1]], axis=1)
    numbers, theta = np.zeros((len(rows), 10)), np.zeros((len(rows), len(task.target)))
    chosen = np.ascontiguousarray(shapes[rows // 2])
    compiled("begin")(chosen, signs, np.ascontiguousarray(how[rows]), task.target, task.share, times, int(timed),
                      PLACES, numbers, theta)  # fmt: skip
    return Candidates(numbers, signs, theta, best[rows], np.ones(len(rows), dtype=np.int64))


def refined(task: PathTask, found: Candidates, most: int) -> Candidates:
    """Return linkages after so many steps at most, the best first."""
    times = task.times if task.times is not None else np.zeros(len(task.target))
    options = np.array([int(task.times is not None), int(task.crank), 1, int(task.closed)])
    cost, steps = np.empty(len(found.cost)), np.zeros(len(found.cost), dtype=np.int64)
    compiled("refine")(found.numbers, found.signs, found.theta, task.target, task.weights, times, options, task.lower,
                       task.upper, cost, steps, most)  # fmt: skip
    found.cost = cost
    order = np.argsort(cost, kind="stable")
    return found.at(order[np.isfinite(cost[order])])


#: Shapes that are compared in each round, of closed or timed paths and of open ones; starts that are refined.
SHAPES, SHAPES_OPEN, KEPT = 4096, 1024, 1000
#: Stages of the refinement: how many linkages go on, for how many steps each.
STAGES = ((KEPT, 30), (300, 150), (40, 1500))
#: Rounds at most; an error so small beside the size of the path counts as none.
ROUNDS, EXACT = 4, 1e-11
#: Linkages that are the same to so much of their size are told once.
SAME = 1e-6


def solve_path(task: PathTask, seed: int, rounds: int = ROUNDS, enough: float = EXACT) -> Candidates:
    """Return the linkages that come nearest to a path, all different ones that were found, the best first.

    Rounds of starts go on until a linkage passes all points, or the best one was found a second time.
    """
    open_path = not task.closed and task.times is None
    shapes = SHAPES_OPEN if open_path else SHAPES
    few = min(1.0, 2.0 * COMPARED / len(task.target))
    shapes, kept = (shapes, KEPT) if few == 1.0 else (shapes // 2, max(100, int(KEPT * few)))
    found: Candidates | None = None
    for number in range(rounds):
        starts = starts_of(task, shapes, min(kept, shapes), seed, number * shapes)
        fit_limits(task, starts)
        for most, steps in STAGES:  # fewer of longer ones
            most, steps = max(8, int(most * few)), max(30, int(steps * few))
            starts = refined(task, starts.at(slice(0, most)), steps)
        found = merged(starts if found is None else joined(found, starts))
        if not len(found.cost):
            continue
        if found.cost[0] <= enough**2 * task.size or found.starts[0] > 1:
            break
    assert found is not None
    return found


def fit_limits(task: PathTask, found: Candidates) -> None:
    """Move starts into the limits of their numbers: given lengths size all, angles turn by whole turns."""
    numbers = found.numbers
    for k in range(4):
        if task.lower[k] == task.upper[k]:
            numbers[:, :6] *= (task.lower[k] / numbers[:, k])[:, None]
            break
    for k in (8, 9):
        low = task.lower[k] if np.isfinite(task.lower[k]) else -np.pi
        numbers[:, k] = low + np.remainder(numbers[:, k] - low, 2.0 * np.pi)
    np.clip(numbers, task.lower, task.upper, out=numbers)


def joined(one: Candidates, other: Candidates) -> Candidates:
    """Return the linkages of two, the best first."""
    parts = ("numbers", "signs", "theta", "cost", "starts")
    both = Candidates(*(np.concatenate([getattr(one, name), getattr(other, name)]) for name in parts))
    return both.at(np.argsort(both.cost, kind="stable"))


def wrapped(angles: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return angles within half a turn."""
    return np.asarray(np.remainder(angles + np.pi, 2.0 * np.pi) - np.pi)


def merged(found: Candidates, most: int = 400) -> Candidates:
    """Return different linkages, the best of each, with the number of starts that ended there."""
    kept, starts = different(found.numbers, found.signs[:, 0], found.starts, most)
    result = found.at(kept)
    result.starts = np.array(starts, dtype=np.int64)
    return result


def different(
    numbers: NDArray[np.float64], signs: NDArray[np.float64], starts: NDArray[np.int64], most: int
) -> tuple[list[int], list[int]]:
    """Return the rows of the first of linkages that are the same, and from how many starts each was reached."""
    kept, counts = list[int](), list[int]()
    for k, one in enumerate(numbers):
        off = np.abs(numbers[kept, :8] - one[:8]).max(axis=1, initial=0.0) / one[:4].max()
        turn = np.abs(wrapped(numbers[kept, 8] - one[8]))
        same = (off < SAME) & (turn < SAME) & (signs[kept] == signs[k])
        if same.any():
            counts[int(np.argmax(same))] += int(starts[k])
        elif len(kept) < most:
            kept.append(k)
            counts.append(int(starts[k]))
    return kept, counts


def curve_of(n: NDArray[np.float64], theta: NDArray[np.float64], side: float) -> tuple[Any, ...]:
    """Return coupler points of one linkage, and their derivatives by its numbers and (last) the crank angle.

    Then the direction of AB as a complex number, the derivatives of its angle, and whether the bars meet. The kernels
    have the same formulas, for thousands of linkages.
    """
    crank, turn, w = n[0] * np.exp(1j * theta), np.exp(1j * n[8]), complex(n[4], n[5])
    far = n[3] - crank
    size = np.abs(far)
    with np.errstate(all="ignore"):
        cosine = (size**2 + n[1] ** 2 - n[2] ** 2) / (2.0 * size * n[1])
        b = far / size * (cosine + 1j * side * np.sqrt(np.maximum(1.0 - cosine**2, 0.0)))
        f = (n[1] * b - far) / n[2]
        rate = np.zeros((len(theta), 10))
        for k, along in ((0, np.exp(1j * theta)), (1, b), (3, -1.0), (9, 1j * crank)):
            rate[:, k] = (np.conj(f) * along).real
        rate[:, 2] = -1.0
        rate /= (np.conj(f) * b).imag[:, None] * n[1]
    point = complex(n[6], n[7]) + turn * (crank + w * b)
    by = (turn * w * 1j * b)[:, None] * rate
    by[:, 0] += turn * np.exp(1j * theta)
    by[:, 9] += turn * 1j * crank
    by[:, 4], by[:, 5], by[:, 6], by[:, 7] = turn * b, 1j * turn * b, 1.0, 1j
    by[:, 8] = 1j * (point - complex(n[6], n[7]))
    rate[:, 8] = 1.0
    return point, np.nan_to_num(by), turn * b, np.nan_to_num(rate), bool((np.abs(cosine) < 1.0).all())


class Fit:
    """How far the curve of a linkage is from a path, as a function of its numbers: the angles follow these."""

    def __init__(self, task: PathTask, theta: NDArray[np.float64], side: float) -> None:
        self.task, self.theta, self.side = task, theta.copy(), side
        self.root = np.sqrt(task.weights)

    def __call__(
        self, n: NDArray[np.float64], whole: bool = False
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the distances across the curve (with times: both coordinates) and their derivatives; or whole."""
        task = self.task
        if task.times is not None:
            point, by, *_, meets = curve_of(n, n[9] + task.times, self.side)
            off = (
                (point - task.target) * self.root if meets else np.full(len(point), 1e3 * np.sqrt(task.size))
            )
            by = by * self.root[:, None]
            if whole:
                size = np.abs(off) + 1e-300
                return size, (np.conj(off / size)[:, None] * by).real
            return np.concatenate([off.real, off.imag]), np.concatenate([by.real, by.imag])
        for _ in range(4):
            point, by, *_, meets = curve_of(n, self.theta, self.side)
            off, along = point - task.target, by[:, 9]
            turn = -(np.conj(along) * off).real / (np.abs(along) ** 2 + 1e-300)
            if not meets or np.abs(turn).max() < 1e-12:
                break
            self.theta = self.theta + np.clip(turn, -0.3, 0.3)
        if not meets:
            return np.full(len(off), 1e3 * np.sqrt(task.size)), np.zeros((len(off), 10))
        across = np.conj(1j * along / (np.abs(along) + 1e-300)) * self.root
        slopes = (across[:, None] * by).real
        slopes[:, 9] = 0.0
        return (across * off).real, slopes
