"""From a task to linkages: the door, what is read of a task, defects, cognates, and the labelled result."""

from __future__ import annotations

import contextlib
import hashlib
import os
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.optimize import minimize

from fastlink._text import counted, joined, short_number, short_repr
from fastlink.codegen.cache import environment
from fastlink.design.refine import constraint
from fastlink.design.search import Unfinished, names_searched, to_file
from fastlink.engine.evaluate import evaluate
from fastlink.engine.function import function
from fastlink.engine.sweep import sweep
from fastlink.errors import InputError, Problems, Setting, check_switch, check_whole, door, remark
from fastlink.facts.catalogue import Catalogue
from fastlink.maps.best import Choice, Condition, choice_of, chosen, with_missed
from fastlink.mechanisms import catalogue as find_catalogue
from fastlink.plan.query import check_names
from fastlink.space.design_space import DESIGN
from fastlink.space.tables import table
from fastlink.space.units import PI, in_si, looks_like_degrees, scaled, split
from fastlink.synthesis import functions, nine_points, paths, poses
from fastlink.synthesis.paths import NUMBERS, wrapped

__all__ = ["DEFECTS", "Linkages", "synthesise"]

Floats = NDArray[np.float64]

#: What may be wrong with a linkage that fits a task, by the code in the result; the first that applies is told.
DEFECTS = dict(enumerate(
    ("no_defect", "circuit_defect", "branch_defect", "order_defect", "dead_point", "crank_does_not_turn")
))  # fmt: skip
#: A tenth of a microradian: angles so near count as equal, where a path comes back to its first point.
TOUCH = 1e-7
#: Poses and points that a task takes, and linkages of which a result is chosen.
MOST_POINTS, MOST_FOUND = 2000, 400
#: Links of a path are so many times as long as its points are from their mean at most, unless a limit is given: of a
#: closed one, and of an open one, which may be a small part of a curve.
LONGEST, LONGEST_OPEN = 20.0, 50.0
#: Sets of nine points of a path that are met exactly, as starts; the relative error up to which a second set is tried.
THROUGH_NINE, NEARLY = 4, 1e-4


# -- Linkages, and what is wrong with them


#: A result that is limited often.
USED = "least_transmission_angle_used"
#: The arrays of linkages.
ARRAYS = ("numbers", "theta", "side", "starts")


@dataclass(eq=False)
class Linkages:
    """Linkages that were found, as arrays along the first axis: what `paths`, `poses` and `functions` have in common.

    The numbers are those of `paths.NUMBERS`: lengths a1 to a4, the coupler point, O, the direction of OD, the phase;
    or of `paths.SLIDER`, with the direction of the slider's line. D is infinitely far across that, and told by its
    direction.
    """

    #: Their numbers; crank angles from OD at the points of the task; +1 where B is left of the line from A to D.
    numbers: Floats
    theta: Floats
    side: Floats
    #: From how many starts each was reached, one unless it is told.
    starts: Any = None
    #: Further results by name, along the first axis.
    more: dict[str, Any] = field(default_factory=dict)
    #: Whether they are slider-cranks.
    slider: bool = False

    def __post_init__(self) -> None:
        if self.starts is None:
            self.starts = np.ones(len(self.numbers), dtype=np.int64)

    def __len__(self) -> int:
        return len(self.numbers)

    def at(self, rows: Any) -> Linkages:
        """Return some of them."""
        more = {name: of[rows] for name, of in self.more.items()}
        return replace(self, **{name: getattr(self, name)[rows] for name in ARRAYS}, more=more)

    def pins(self) -> tuple[Any, ...]:
        """Return O and D, and A, B and P at the points of the task, in its frame."""
        return paths.pins(self.numbers, self.theta, self.side, self.slider)


def in_order(theta: Floats, closed: bool) -> tuple[NDArray[np.int64], Floats]:
    """Return the sense (+1, -1, or 0 out of order) in which crank angles follow each other within a turn, and them so.

    Where both senses do, as for two points, the shorter way counts.
    """
    if theta.shape[1] < 2:
        return np.ones(len(theta), dtype=np.int64), theta
    turns = []
    for side in (1.0, -1.0):
        steps = np.remainder(side * np.diff(theta, axis=1), 2.0 * np.pi)
        turns.append(np.where(steps > 2.0 * np.pi - TOUCH, steps - 2.0 * np.pi, steps))
    whole = np.stack([steps.sum(axis=1) for steps in turns])
    best = np.argmin(whole, axis=0)
    sense = np.where(whole.min(axis=0) <= 2.0 * np.pi + TOUCH, np.where(best == 0, 1, -1), 0)
    steps = np.where(best[:, None] == 0, turns[0], -turns[1])
    ordered = np.concatenate([theta[:, :1], theta[:, :1] + np.cumsum(steps, axis=1)], axis=1)
    return sense, np.asarray(np.where(sense[:, None] == 0, np.unwrap(theta, axis=1), ordered))


def judged(found: Linkages, closed: bool, timed: bool) -> Linkages:
    """Return linkages with their order, circuit and defect, and the least transmission angle of what is used."""
    n, slider = found.numbers, found.slider
    a1, a2, a3, a4 = n[:, :4].T
    if slider:
        grashof, turns, by_side = np.abs(a2 - a1) > np.abs(a3), a2 > a1 + np.abs(a3), a1 <= a2
    else:
        grashof = n[:, :4].max(axis=1) + n[:, :4].min(axis=1) < n[:, :4].sum(axis=1) / 2.0
        by_side = np.minimum(a1, a4) <= np.minimum(a2, a3)
        turns = grashof & by_side
    # the triangle without the shortest link never folds: its side tells the circuit
    with np.errstate(invalid="ignore"):
        beside = -np.cos(found.theta) if slider else np.sin(found.theta)
        circuits = np.where(by_side[:, None], found.side, np.sign(beside))
    first = circuits[:, :1]
    circuit_defect = grashof & (circuits != first).any(axis=1)
    branch_defect = (found.side != found.side[:, :1]).any(axis=1)
    order, theta = in_order(found.theta, closed)
    if timed:
        order, theta = np.ones(len(n), dtype=np.int64), found.theta
    transmission, dead = paths.transmission(a1, a2, a3, a4, theta, closed, slider)
    wrong = [circuit_defect, branch_defect, order == 0, dead, closed & ~turns]
    own = {
        "defect": np.select(wrong, [1, 2, 3, 4, 5]).astype(np.int8),
        "order": order.astype(np.int8),
        "circuit": np.where(grashof & (first[:, 0] > 0), 2, 1).astype(np.int8),
        USED: np.where(dead, 0.0, transmission),
    }
    return replace(found, theta=theta, more={**found.more, **own})


def cognates_of(found: Linkages) -> Linkages:
    """Return each linkage with all others that draw the same curve: three cognates, each driven at either pivot.

    Roberts 1875; see `fastlink.planar.cognates`. They stand linkage by linkage, the given one first. A slider-crank has
    one cognate, and one crank.
    """
    o, d, a, b, point = found.pins()
    with np.errstate(invalid="ignore"):  # at a dead point bars may miss each other by rounding
        ratio = (point - a) / (b - a)
    one, slider = o[:, None] + (point - a), found.slider
    if slider:
        third, two = d * ratio[:, 0] / np.abs(ratio[:, 0]), o[:, None] + ratio * (b - o[:, None])
        forms = [(o, d, a, b, 1), (o, third, one, two, 2)]
    else:
        third = o + (d - o) * ratio[:, 0]
        two = third[:, None] + ratio * (b - d[:, None])
        three, four = d[:, None] + (point - b), third[:, None] + (1.0 - ratio) * (a - o[:, None])
        forms = [(o, d, a, b, 1), (d, o, b, a, 1), (o, third, one, two, 2), (third, o, two, one, 2),
                 (d, third, three, four, 3), (third, d, four, three, 3)]  # fmt: skip
    made = [paths.from_pins(*form[:4], point, slider) for form in forms]
    count, each = len(found), len(forms)
    stacked = (np.stack(parts, axis=1) for parts in zip(*made, strict=True))
    numbers, theta, side = (of.reshape(each * count, -1) for of in stacked)
    first = each * np.arange(count)
    numbers[first], theta[first], side[first] = found.numbers, found.theta, found.side
    more = {name: np.repeat(values, each, axis=0) for name, values in found.more.items()}
    more["cognate"] = np.tile(np.array([form[4] for form in forms], dtype=np.int8), count)
    more["curve"] = np.repeat(np.arange(count), each)
    return Linkages(numbers, theta, side, np.repeat(found.starts, each), more, slider)


# -- What a caller asks for


#: Units of the names of a result, and what they mean.
LABELS: dict[str, tuple[str, str]] = {
    **{f"{pin}_{k}": ("m", f"Fixed pivot {pin} in the frame of the task") for pin in "OD" for k in "xy"},
    "ground_angle": ("rad", "Direction of OD in the frame of the task"),
    "phase": ("rad", "Crank angle from OD where the timing counts from"),
    "body_angle": ("rad", "Direction of the body from AB"),
    "theta1": ("rad", "Crank angle from OD at each point of the task"),
    "point_error": ("m", "Distance from each point of the task"),
    "angle_error": ("rad", "Error of the direction of the body at each pose"),
    "path_error": ("m", "Root mean square of the distances from the points"),
    "path_error_max": ("m", "Greatest distance from a point"),
    "path_error_sum": ("m2", "Sum of the squared distances from the points"),
    "pose_error": ("m", "Root mean square of distances and rotation_length times errors of direction"),
    "pose_error_max": ("m", "Greatest of these over the poses"),
    "structural_error": ("rad", "Greatest error of the output over the range"),
    "structural_error_rms": ("rad", "Root mean square error of the output at the points"),
    "output_error": ("rad", "Error of the output at each point of the task"),
    "theta4": ("rad", "Output angle that is wanted at each point of the task, from OD"),
    "peak_error": ("rad", "Greatest errors of either sign, in turn"),
    "peak_theta1": ("rad", "Where these are"),
    USED: ("rad", "Least acute transmission angle from the first to the last point"),
    "chamfer": ("1", "Mean distances of nearest places, of a target with unit root mean square"),
    "ordered_distance": ("1", "Least mean squared distance of places in order, of such a target, times 2 pi"),
    "order": ("1", "Sense in which the crank passes the points; 0 out of order"),
    "circuit": ("1", "Circuit at the first point"),
    "starts": ("1", "Starts that ended there"),
    "cognate": ("1", "Which of the three linkages of one curve, the one that was found being the first"),
    "cognate_of": ("1", "The first design of the same curve"),
    "sense": ("1", "Sense of the output against that of the input"),
    "function_error": ("1", "Greatest error as a share of the output's range"),
    "input_turn": ("rad", "By how much the crank turns over the range"),
    "output_turn": ("rad", "By how much the output link turns over the range"),
}
#: Names of a slider-crank's results that are others, and those of lengths in place of angles.
OF_SLIDER = {"theta1": "theta", "peak_theta1": "peak_theta", "theta4": "slider_position"}
LABELS |= {OF_SLIDER[name]: LABELS[name] for name in ("theta1", "peak_theta1")}
LABELS["slider_position"] = "m", "Place of the slider that is wanted at each point of the task"
POINT = {"P_u": ("m", "Point of the rod, along AB from A"), "P_v": ("m", "Point of the rod, left of AB")}
#: Root mean square errors, and what the greatest of the same are called.
GREATEST = {"path_error": "path_error_max", "pose_error": "pose_error_max"}
OUTPUTS = ("structural_error", "structural_error_rms", "output_error", "peak_error")
TARGETS = {"target_x": "m", "target_y": "m", "target_angle": "rad", "time": "rad"}


@dataclass
class Asked:
    """What a caller wants besides the task: limits of numbers, conditions, the objective."""

    catalogue: Catalogue
    quantities: tuple[str, ...]
    where: Any
    minimise: Any
    maximise: Any
    top: int
    lower: Floats
    upper: Floats
    seed: int
    exact: bool

    @property
    def slider(self) -> bool:
        """Whether slider-cranks are asked for."""
        return self.catalogue.name == "slider_crank"

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the numbers of a linkage."""
        return paths.SLIDER if self.slider else NUMBERS

    def with_limits_as_conditions(self) -> Asked:
        """Return the same with limits as conditions, within which a family is searched; a sample of it meets few.

        A range of directions is none: it chooses between a slider-crank and the same turned by half a turn.
        """
        least = np.where(np.arange(len(self.names)) < (2 if self.slider else 4), 0.0, -np.inf)
        lower, upper, where = self.lower.copy(), self.upper.copy(), dict(self.where or {})
        for k, name in enumerate(self.names):
            low, high = float(lower[k]), float(upper[k])
            is_range = low < high
            if name and (low > least[k] or high < np.inf) and not (is_range and name == "ground_angle"):
                angle = float(paths.turned(low, -np.pi)) if name == "ground_angle" else low
                where.setdefault(name, (low, high) if is_range else angle)
                lower[k], upper[k] = least[k], np.inf
        return self if where == (self.where or {}) else replace(self, where=where, lower=lower, upper=upper)

    @property
    def labels(self) -> dict[str, tuple[str, str]]:
        """Units of the names of a result, and what they mean."""
        return LABELS | {name: ("m", LABELS[name][1]) for name in OUTPUTS} | POINT if self.slider else LABELS

    @property
    def crank(self) -> bool:
        """Whether the conditions say that the crank is to turn fully."""
        wanted = self.where.get("status") if isinstance(self.where, Mapping) else self.where
        return wanted == "rotates_fully"

    def others(self) -> list[str]:
        """Return the quantities of the mechanism that objectives and conditions name, or refuse unknown ones."""
        own, problems = {*self.labels, "defect", "branch"}, Problems()
        where = self.where if isinstance(self.where, Mapping) else {}
        asked: dict[str, Any] = {}
        asked["where"] = {k: v for k, v in where.items() if split(str(k), own)[0] not in own}
        for name, given in (("minimise", self.minimise), ("maximise", self.maximise)):
            asked[name] = [one for one in _listed(given) if one not in own]
        found = names_searched(self.catalogue, asked, problems)
        problems.stop()
        return found

    def within(self, found: Linkages) -> Linkages:
        """Return the linkages within the limits of their numbers."""
        fits = self._fit(found)
        if found.slider and self.lower[9] != self.upper[9] and "theta4" not in found.more:
            # turned by half a turn it is the same, in the other branch: in the first one if that fits
            other = replace(found, numbers=found.numbers * np.where(np.arange(10) == 2, -1.0, 1.0),
                            theta=found.theta + np.pi, side=-found.side)  # fmt: skip
            other.numbers[:, 8:] = wrapped(other.numbers[:, 8:] + np.pi)
            swap = self._fit(other)
            swap &= ~fits | (found.side[:, 0] > 0.0)
            fits |= swap
            for name in ("numbers", "theta", "side"):
                getattr(found, name)[swap] = getattr(other, name)[swap]
        return found.at(fits)

    def _fit(self, found: Linkages) -> NDArray[np.bool_]:
        """Tell which linkages have a size and are within the limits, with their direction turned into these."""
        low, high = self.lower.copy(), self.upper.copy()
        slack = 1e-9 * (1.0 + np.abs(found.numbers))
        turned = found.numbers.copy()
        start = low[8] if np.isfinite(low[8]) else -np.pi
        turned[:, 8] = paths.turned(turned[:, 8], start)
        fits = ((turned >= low - slack) & (turned <= high + slack))[:, :9].all(axis=1)
        lengths = np.abs(turned[:, : 2 if found.slider else 4])
        fits &= np.isfinite(turned).all(axis=1) & (lengths.min(axis=1) > 1e-9 * lengths.max(axis=1))
        found.numbers[:, 8] = np.where(fits, turned[:, 8], found.numbers[:, 8])
        return np.asarray(fits)


def _limits(bounds: Any, fixed: Any, slider: bool, problems: Problems) -> tuple[Floats, Floats]:
    """Return the limits of the numbers of a linkage, in SI."""
    low, high = np.full(10, -np.inf), np.full(10, np.inf)
    low[: 2 if slider else 4] = 0.0
    known = [name for name in paths.SLIDER if name] if slider else [*NUMBERS, "D_x", "D_y"]
    units = {name: "rad" if name in ("ground_angle", "phase") else "m" for name in known}
    given: dict[str, tuple[float, float]] = {}
    for where, values in (("bounds", bounds), ("fixed", fixed)):
        if values is None:
            continue
        if not isinstance(values, Mapping):
            example = f"{{'{known[0]}': (0.1, 1.0)}}" if where == "bounds" else "{'O_x': 0.0}"
            problems.add("is not a mapping", (where,), f"write such as {example}")
            continue
        for name, value in (problems.attempt(in_si, where, dict(values), units) or {}).items():
            if name not in units:
                what = f"{short_repr(name)} is no number of a linkage"
                problems.add(what, (where,), f"write one of {', '.join(units)}")
                continue
            try:
                first, last = (value, value) if where == "fixed" else value
                ends = float(-np.inf if first is None else first), float(np.inf if last is None else last)
            except (TypeError, ValueError, IndexError):
                ends = (np.nan, np.nan)
            if not ends[0] <= ends[1]:
                remedy = "write a number" if where == "fixed" else "write (lo, hi), None for no limit"
                problems.add(f"is {short_repr(value)}", (where, name), remedy)
            elif name in known[: 2 if slider else 4] and ends[1] <= 0.0:
                what = f"is {short_repr(value)}, and a length is positive"
                problems.add(what, (where, name), "write positive numbers")
            else:
                given[name] = ends
    pivots = {"O_x", "O_y", "D_x", "D_y"}
    if {"D_x", "D_y"} & given.keys():
        if pivots <= given.keys() and all(given[name][0] == given[name][1] for name in pivots):
            o, d = complex(given["O_x"][0], given["O_y"][0]), complex(given["D_x"][0], given["D_y"][0])
            given["a4"], given["ground_angle"] = (abs(d - o),) * 2, (float(np.angle(d - o)),) * 2
        else:
            remedy = "fix O_x, O_y, D_x and D_y together, or write where={'D_x': (lo, hi)}"
            problems.add("D has its place by O, a4 and ground_angle", ("fixed",), remedy)
    for k, name in enumerate(paths.SLIDER if slider else NUMBERS):
        if name in given:
            low[k], high[k] = max(given[name][0], 1e-12 if low[k] == 0.0 else -np.inf), given[name][1]
    return low, high


def _check(holds: Any, where: str, what: str, remedy: Any) -> None:
    """Refuse what does not hold."""
    if not holds:
        raise InputError(what, (where,), remedy)


def _columns(where: str, given: Any, names: Sequence[str], units: Mapping[str, str]) -> Floats:
    """Return the rows of an array, a table, or the file of one, as numbers."""
    remedy = f"write rows of {', '.join(names)}, or a table with these columns"
    if isinstance(given, (str, os.PathLike)):
        given = _read(where, given, names)
    tabled = isinstance(given, Mapping) or hasattr(given, "columns") or hasattr(given, "data_vars")
    keys, bare = list(given) if tabled else [], "angle" in names
    if keys:
        columns: dict[str, Any] = {}
        for key in keys:
            of, unit = split(str(key), units)
            if of in names:
                values, bare = np.asarray(given[key], dtype=float), bare and not (of == "angle" and unit)
                columns[of] = in_si(where, {str(key): values}, units)[of] if unit else values
        missing = [name for name in names if name not in columns]
        _check(not missing, where, f"has no column {''.join(missing[:1])}", remedy)
        rows = np.stack([np.asarray(columns[name], dtype=float) for name in names], axis=1)
    else:
        try:
            raw = np.asarray(given)
            is_complex = np.iscomplexobj(raw) and raw.ndim == 1
            rows = np.stack([raw.real, raw.imag], axis=1) if is_complex else raw.astype(float)
        except (TypeError, ValueError):
            raise InputError(f"is {short_repr(given)}", (where,), remedy) from None
    _check(rows.ndim == 2 and rows.shape[1] == len(names), where, f"has the shape {rows.shape}", remedy)
    less = f"give at most {MOST_POINTS:,}, such as every tenth"
    _check(len(rows) <= MOST_POINTS, where, f"has {len(rows):,} rows", less)
    bad = np.flatnonzero(~np.isfinite(rows).all(axis=1))
    _check(not len(bad), where, f"is not finite in row {bad.min(initial=len(rows))}", "leave that row out")
    if bare and (most := np.abs(rows[:, 2]).max(initial=0.0)) > 2.0 * np.pi:
        remedy = "if these are degrees, give a table with a column angle_deg"
        remark(f"has angles up to {most:g}, which are taken as radians", (where,), remedy)
    return np.ascontiguousarray(rows)


def _read(where: str, path: Any, names: Sequence[str]) -> Any:
    """Return the columns of a table in a file, as `fastlink.table` reads it, or the numbers of a CSV without names."""
    remedy = f"give a CSV file whose first line is {','.join(names)}"
    try:
        _check(os.path.getsize(path), where, "is an empty file", remedy)
        with contextlib.suppress(ValueError):
            return np.loadtxt(path, delimiter=",", ndmin=2, encoding="utf-8")
        space = table(Path(path))
    except (OSError, InputError) as error:
        what = error.problems[0].what if isinstance(error, InputError) else error
        raise InputError(f"cannot be read ({what})", (where,), remedy) from None
    named = {name: f"{name}_{space.units[name]}" if name in space.units else name for name in space.columns}
    return {named[name]: np.asarray(values) for name, values in space.columns.items()}


# -- The three tasks: from what was given to linkages


@dataclass
class Solved:
    """What was found for a task, before it is chosen from."""

    task: str
    #: What was asked, with the limits that the task adds.
    asked: Asked
    found: Linkages
    #: Coordinates along ``point``; attributes.
    target: dict[str, Floats]
    attrs: dict[str, Any]
    #: What is minimised or maximised unless a caller says so.
    minimise: str = ""
    maximise: str = ""
    #: Whether linkages with defects are told too, after the others.
    with_defects: bool = False
    #: The path or the motion, where linkages are to be refined within conditions; of functions, what finds them again.
    path: Any = None
    again: Any = None

    @property
    def size(self) -> float:
        """The size of a path or a motion."""
        task = self.path
        return float(np.sqrt(task.size / len(task.target))) if task.angles is None else task.extent

    def changed(self, numbers: Floats, theta: Floats, side: Floats, body: Any = None) -> Linkages:
        """Return linkages for a path or a motion, from others that were changed: those within their limits."""
        task, count = self.path, len(numbers)
        more: dict[str, Any] = {}
        if task.angles is not None:
            more["body_angle"] = numbers[:, 9].copy() if body is None else body
            numbers[:, 9] = 0.0
        elif task.times is not None:
            theta = numbers[:, 9:] + task.times
        else:
            more = {"cognate": np.ones(count, dtype=np.int8), "curve": np.arange(count)}
        made = self.asked.within(Linkages(numbers, theta, side, None, more, self.asked.slider))
        return _come_back(made) if self.found.theta.shape[1] > len(task.target) else made

    def varied(self, some: Linkages, change: float, rng: Any) -> Linkages:
        """Return linkages that do a task exactly, near others: these are changed at random and made exact again."""
        task, count = self.path, len(self.path.target)
        if task.angles is not None:
            return self.changed(*poses.varied(task, some.pins(), change, rng))
        made = paths.varied(task, some.numbers, some.theta[:, :count], some.side[:, 0], change, rng)
        return self.changed(made.numbers, made.theta, np.repeat(made.signs[:, :1], count, axis=1))


def _solve_path(asked: Asked, steps: Steps, path: Any, timing: Any, closed: Any) -> Solved:
    rows = _columns("path", path, ("x", "y"), {"x": "m", "y": "m"})
    points = rows[:, 0] + 1j * rows[:, 1]
    count = len(points)
    _check(count >= 2, "path", f"has {counted(count, 'point')}", "give at least 2 points, or 3 for a shape")
    size = float(np.abs(points - points.mean()).max())
    _check(size > 0.0, "path", "has one place alone", "give points that differ")
    apart = np.abs(np.diff(points)) > 1e-12 * size
    k, one_less = int(np.argmin(apart)), "leave one of them out"
    _check(apart.all() or timing is not None, "path", f"has the same point in rows {k} and {k + 1}", one_less)
    if closed is not None:
        check_switch(("closed",), closed)
    comes_back = abs(points[0] - points[-1]) <= 1e-9 * size
    is_closed = bool(comes_back if closed is None else closed)
    times = None
    if isinstance(timing, str):
        angles = "write the crank angle at each point, in rad"
        _check(timing == "even", "timing", f"is {short_repr(timing)}", f"write 'even', or {angles[6:]}")
        _check(is_closed, "timing", "is 'even', and the path is open", angles)
        times = 2.0 * np.pi * np.arange(count) / (count - comes_back)
    elif timing is not None:
        try:
            times = np.asarray(timing, dtype=float)
        except (TypeError, ValueError):
            times = np.empty(0)
        what = f"has the shape {times.shape}, and there are {counted(count, 'point')}"
        fits = times.shape == (count,) and np.isfinite(times).all()
        _check(fits, "timing", what, "write a crank angle for each point, in rad")
        differ = (np.diff(times) != 0.0).all()
        _check(differ, "timing", "has the same angle twice", "write angles that differ")
        if looks_like_degrees(times):
            what = f"is {short_repr(times.tolist())}, which is taken as radians"
            remark(what, ("timing",), "if these are degrees, convert them")
    crank = is_closed or asked.crank
    target, weights = points, np.ones(count)
    if is_closed and comes_back and times is None:
        target, weights = points[:-1], np.ones(count - 1)
        weights[0] = 2.0
    if not asked.exact:
        # lengths without a limit of their own: nearly straight or round paths are met ever better by ever longer links
        longest = np.where(np.arange(10) < 6, (LONGEST if is_closed else LONGEST_OPEN) * size, np.inf)
        upper = np.where(np.isfinite(asked.upper), asked.upper, longest)
        asked = replace(asked, upper=upper, lower=np.where(np.isfinite(asked.lower), asked.lower, -longest))
    slider = asked.slider
    task = paths.PathTask(target, times, is_closed, crank, weights, slider, asked.lower, asked.upper)
    attrs: dict[str, Any] = {"closed": int(is_closed)}
    if asked.exact:
        found, attrs["complete"] = _all_exact(asked, task, steps)
    else:
        many = times is None and not task.is_whole and not slider and 9 <= len(target) <= paths.MANY
        if task.is_whole:
            solved = paths.Candidates(*steps(lambda: paths.solve_curve(task, asked.seed).parts()))
        else:
            rounds = 1 if many else paths.ROUNDS if len(target) <= paths.MANY else 2
            every = bool(asked.minimise or asked.maximise)
            solved = paths.solve_path(task, asked.seed, rounds, steps, all_rounds=every)
        for attempt in range(THROUGH_NINE if many else 0):
            error = np.sqrt(solved.cost[0] / task.size) if len(solved.cost) else np.inf
            if error < paths.EXACT or (attempt and error > NEARLY):
                break
            more = steps(lambda k: _through_nine(task, k).parts(), attempt)
            solved = paths.merged(paths.joined(solved, paths.Candidates(*more)))
        side = np.repeat(solved.signs[:, :1], len(target), axis=1)
        found = Linkages(solved.numbers, solved.theta, side, solved.starts, slider=slider)
    if times is None:
        # both drivers of all three linkages draw the curve; those that cannot are left out later
        found = cognates_of(found.at(slice(0, MOST_FOUND // 2)))
        if not asked.exact:
            keep = judged(found, is_closed, False).more["defect"] == 0
            found = found.at(keep | (np.arange(len(found)) % (2 if slider else 6) == 0))
    found = _different(asked.within(found))
    if is_closed and comes_back and times is None:
        found = _come_back(found)
    coords = {"target_x": rows[:, 0], "target_y": rows[:, 1]} | ({} if times is None else {"time": times})
    if times is not None:
        attrs["timing"] = "crank angles, but for a phase"
    least = "ordered_distance" if task.is_whole else "path_error"
    path = None if asked.exact else task
    return Solved("path", asked, found, coords, attrs, least, with_defects=asked.exact, path=path)


def _come_back(found: Linkages) -> Linkages:
    """Return linkages with the last point of a path that ends where it begins: a turn after the first one."""
    sense, theta = in_order(found.theta, True)
    last = theta[:, :1] + np.where(sense == 0, 1, sense)[:, None] * 2.0 * np.pi
    side = np.append(found.side, found.side[:, :1], axis=1)
    return replace(found, theta=np.append(theta, last, axis=1), side=side)


def joined_linkages(one: Linkages, other: Linkages) -> Linkages:
    """Return the linkages of both; those of the first are curves of their own."""
    more = {}
    for name, values in other.more.items():
        parts = [one.more.get(name, values[:1].repeat(len(one), axis=0)), values]
        if name.startswith("peak_"):  # there may be more of them
            most = max(part.shape[1] for part in parts)
            wide = [((0, 0), (0, most - part.shape[1])) for part in parts]
            parts = [np.pad(*of, constant_values=np.nan) for of in zip(parts, wide, strict=True)]
        more[name] = np.concatenate(parts)
    if "curve" in more:
        more["curve"][: len(one)] = more["curve"].max(initial=0) + 1 + np.arange(len(one))
        more["cognate"][: len(one)] = 1
    arrays: dict[str, Any] = {
        name: np.concatenate([getattr(one, name), getattr(other, name)]) for name in ARRAYS
    }
    return replace(one, **arrays, more=more)


def _all_exact(asked: Asked, task: paths.PathTask, steps: Steps) -> tuple[Linkages, str]:
    """Return all linkages that pass points exactly, where algebra gives them, and how many that are."""
    count = len(task.target)
    best = "leave it out: least squares find the best"
    _check(not task.slider, "exact", "is for planar_4r", best)
    if task.times is not None:
        _check(count == 5, "exact", f"is for five points with timing, and there are {count}", best)
        # the crank of a linkage turns as the coupler of a cognate does: points with times are poses of that
        timed = replace(task, angles=task.times)
        numbers, theta, side, _ = poses.pairs_of(timed, poses.dyads_of(timed))
        found = cognates_of(Linkages(numbers, theta, side)).at(slice(2, None, 6))
        found.numbers[:, 9] = wrapped(found.theta[:, 0] - task.times[0])
        found.theta, found.more = found.numbers[:, 9:] + task.times, {}
        return asked.within(found), f"all {counted(len(found), 'linkage')} of five timed points"
    _check(count == 9, "exact", f"is for nine points, or five with timing, and there are {count}", best)

    def every() -> list[Any]:
        found, complete = _of_nine(task.target)
        return [found.numbers, found.theta, found.side, found.starts, complete]

    *parts, complete = steps(every)
    return Linkages(*parts), str(complete)


def _of_nine(points: NDArray[np.complex128], ways: int = nine_points.WAYS) -> tuple[Linkages, str]:
    """Return a linkage of each triple of cognates through nine points, and how many triples there are."""
    triples = nine_points.solutions(points, ways)
    real = triples.unknowns[triples.real]
    turns = np.concatenate([np.ones((len(real), 1)), real[:, 8:]], axis=1)
    x, a, y, b = (real[:, k, None] for k in range(4))
    place, start = np.broadcast_to(points, turns.shape), points[0]
    pins = (start + a)[:, 0], (start + b)[:, 0], points + x * turns, points + y * turns, place
    found = Linkages(*paths.from_pins(*pins))
    complete = f"all {len(real)} real of {len(triples.unknowns):,} triples of cognates"
    return found, complete + (f"; {len(triples.lost)} paths did not arrive" if len(triples.lost) else "")


def _through_nine(task: paths.PathTask, attempt: int) -> paths.Candidates:
    """Return linkages that pass nine of the points in order, refined on all: where curves of many shapes are alike.

    The best of a sample of shapes lies in a long valley then, and what passes all points is not near its start. Each
    attempt takes other points.
    """
    last = len(task.target) - 1
    some = np.unique(np.linspace(0, last, 9).round().astype(int))
    if attempt:
        between = np.random.default_rng(attempt).choice(last - 1, 7, replace=False) + 1
        some = np.sort(np.append(between, [0, last]))
    found, _ = _of_nine(task.target[some], ways=1)
    found = judged(cognates_of(found), task.closed, False)
    found = found.at(found.more["defect"] == 0)
    share, order = task.share, found.more["order"].astype(float)
    theta = np.array([np.interp(share, share[some], one) for one in found.theta]).reshape(-1, last + 1)
    signs = np.stack([found.side[:, 0], order], axis=1)
    starts = paths.Candidates(found.numbers.copy(), signs, theta, np.zeros(len(found)), found.starts)
    return paths.refined(task, paths.fit_limits(task, starts), 300)


def _different(found: Linkages) -> Linkages:
    """Return linkages without those that are the same as one before."""
    return found.at(paths.different(found.numbers, found.side[:, 0], found.starts, len(found))[0])


def _solve_motion(asked: Asked, steps: Steps, motion: Any, rotation_length: Any) -> Solved:
    rows = _columns("motion", motion, ("x", "y", "angle"), {"x": "m", "y": "m", "angle": "rad"})
    points, angles = rows[:, 0] + 1j * rows[:, 1], np.unwrap(rows[:, 2])
    count = len(points)
    _check(count >= 2, "motion", f"has {counted(count, 'pose')}", "give at least 2 poses")
    size = float(np.abs(points - points.mean()).max())
    for k in range(count):
        same = np.abs(points[:k] - points[k]) <= 1e-12 * size
        same &= np.abs(wrapped(angles[:k] - angles[k])) <= 1e-12
        what = f"has the same pose in rows {int(np.argmax(same)) if k else 0} and {k}"
        _check(not same.any(), "motion", what, "leave one of them out")
    most = 4 if asked.slider else 5
    own = Setting("rotation_length", float(f"{size or 1.0:.2g}"))
    what = f"is missing: over {'four' if most == 4 else 'five'} poses are met nearly, in places and in directions"
    remedy = ("write ", own, ", the length at which an angle counts")
    _check(rotation_length is not None or count <= most, "rotation_length", what, remedy)
    length = float(rotation_length or size or 1.0)
    what = f"is {short_repr(rotation_length)}"
    _check(0.0 < length < np.inf, "rotation_length", what, "write a positive length in m")
    phase = np.isfinite([asked.lower[9], asked.upper[9]]).any()
    _check(not phase, "phase", "is of a path with timing", "leave it out")
    fixed = np.where((asked.lower == asked.upper) & (count < 5), asked.lower, np.nan)
    if asked.where is None or isinstance(asked.where, Mapping):
        asked = asked.with_limits_as_conditions()
    task = paths.PathTask(points, crank=False, slider=asked.slider, angles=angles, length=length, fixed=fixed)
    if count == 4:
        _check_curves(task)
    numbers, theta, side, body, dyads = steps(poses.solve_motion, task, asked.seed)
    found = Linkages(numbers, theta, side, None, {"body_angle": body}, asked.slider)
    attrs: dict[str, Any] = {"dyads": int(dyads), "rotation_length": length}
    found = asked.within(found)
    if count < 5:
        # a family: those without defects, the best angles first, go on
        more = judged(found, False, False).more
        attrs["found_linkages"] = len(found)
        rows_of = np.flatnonzero(more["defect"] == np.min(more["defect"], initial=9))
        found = found.at(rows_of[np.argsort(-more[USED][rows_of], kind="stable")[:MOST_FOUND]])
    elif count == most:
        made = counted(attrs["dyads"], "dyad"), counted(len(found), "linkage")
        attrs["complete"] = f"all {made[0]} of five poses, {made[1]}"
    coords = {"target_x": rows[:, 0], "target_y": rows[:, 1], "target_angle": angles}
    objectives = ("pose_error", "") if count >= 5 else ("", USED)
    return Solved("motion", asked, found, coords, attrs, *objectives, with_defects=count >= 5, path=task)


def _check_curves(task: paths.PathTask) -> None:
    """Refuse pivots that no link has in four poses: fixed ones off the centre-point curve, moving ones off a circle."""
    o = complex(*task.fixed[6:8])
    d = np.nan if task.slider else o + task.fixed[3] * np.exp(1j * task.fixed[8])
    for name, pivot in (("O", o), ("D", d)):
        if np.isfinite(pivot) and not poses.on_circle(task, pivot):
            place = f"({short_number(pivot.real)}, {short_number(pivot.imag)})"
            what = f"{name} at {place} is off the centre-point curve of the four poses"
            remedy = "leave D out, or write where={'D_x': (lo, hi), 'D_y': (lo, hi)}"
            if name == "O":
                own = short_number(poses.nearest_centre(task))
                remedy = f"fix O_x alone, for which O_y is {own}, or give ranges by bounds"
            raise InputError(what, ("fixed",), remedy)
    on_circle = (task.fixed[4:6] != 0.0).any() or poses.on_circle(task)
    what = "P is to be the pin A, and the four points of the poses are on no circle"
    _check(on_circle, "fixed", what, "leave P_u or P_v out, or give ranges by bounds")


def _solve_function(
    asked: Asked, steps: Steps, function: Any, over: Any, turn: Any, turn_deg: Any, travel: Any, points: Any
) -> Solved:
    slider, given = asked.slider, None
    if points is not None:
        check_whole(("precision_points",), points, 3, 5)
    turns, unit = _turns(turn, turn_deg, slider), 1.0
    both = "write both turns, such as turn_deg=(60, 90)"
    _check(slider or travel is None, "travel", "is for slider_crank", both)
    far = np.nan
    with contextlib.suppress(TypeError, ValueError):
        far = 1.0 if travel is None else float(travel)
    what = f"is {short_repr(travel)}"
    _check(0.0 < abs(far) < np.inf, "travel", what, "write how far the slider moves in m, such as 0.1")
    if callable(function):
        try:
            low, high = (float(end) for end in over)
        except (TypeError, ValueError):
            low = high = np.nan
        what = f"is {short_repr(over)}"
        _check(low < high < np.inf, "over", what, "write the range of x, such as over=(1, 2)")
        own = ("", 60) if slider else ("s of both shafts", (60, 90))
        _check(turns, "turn_deg", "is missing", f"write the turn{own[0]}, such as turn_deg={own[1]}")
        x_all = np.array([low, high])
        x = np.linspace(low, high, functions.FINE)
        x = x if points is None else functions.chebyshev(low, high, points)
        exact, y_all, y = points is not None, _values(function, x_all), _values(function, x)
    else:
        rows = _columns("function", function, ("x", "y"), {"x": "1", "y": "1"})
        few = f"has {counted(len(rows), 'pair')}"
        _check(len(rows) >= 3, "function", few, "give at least 3 pairs (x, y)")
        x, y = x_all, y_all = rows.T
        grow = (np.diff(x) > 0.0).all()
        _check(grow, "function", "has inputs that do not grow", "sort the pairs by x, each once")
        exact = len(rows) <= 5 or points is not None
        if points is not None:  # the pairs next to these places, each once
            what = f"is {points}, and there are {counted(len(rows), 'pair')}"
            _check(points <= len(rows), "precision_points", what, "leave it out")
            near = functions.chebyshev(x[0], x[-1], points)
            k = np.abs(x[:, None] - near).argmin(axis=0) - np.arange(points)
            x, y = rows[np.minimum(np.maximum.accumulate(k), len(rows) - points) + np.arange(points)].T
    (low, high), (first, last) = x_all[[0, -1]], y_all[[0, -1]]
    fine = np.isfinite([first, last, *y]).all()
    _check(fine, "function", "is not finite over its range", "choose the range by over=(lo, hi)")
    # the middle of the range of a turn, of which the others are multiples
    ends = [sum(one) / 2.0 for one in turns or ()]
    rate = ends[0] / (high - low) if ends else 1.0
    if travel is not None or len(ends) > 1:
        what = f"has the values {first:g} and {last:g} at the ends"
        remedy = "give a range whose ends differ in value, or y as angles in rad"
        _check(first != last, "function", what, remedy)
        unit = abs(far) if slider else 1.0
        factor = (np.sign(far) if slider else ends[1]) / (last - first)
    else:
        unit = float(np.abs(y - first).max()) if slider else 1.0
        _check(unit > 0.0, "function", "has one value alone", "give one that changes")
        factor = 1.0 / unit
    if callable(function):

        def given(angle: Floats) -> Floats:
            return np.asarray((_values(function, low + angle / rate) - first) * factor)

    turn_in, turn_out = (x - low) * rate, (y - first) * factor
    pairs = zip(turns or (), ends, strict=True)
    scales = [(min(one / of, other / of), max(one / of, other / of)) for (one, other), of in pairs]
    scales += [(1.0, 1.0)] * (2 - len(scales))
    senses = (1,) if len(ends) < 2 or ends[1] < 0.0 else (1, -1)
    task = functions.FunctionTask(turn_in, turn_out, given, exact, senses, slider, (scales[0], scales[1]))
    length = unit if slider else 1.0
    if not slider and asked.lower[3] == asked.upper[3]:
        unit = float(asked.lower[3])
    free = len(task.free) > 5  # the turns differ by linkage then

    def generated(task: functions.FunctionTask, few: int = functions.FEW) -> Linkages:
        made = functions.solve_function(task, steps, few)
        peaks, places = np.full((2, len(made), max((len(one.peaks) for one in made), default=0)), np.nan)
        n = np.array([one.numbers for one in made]).reshape(-1, 7)
        senses = np.array([one.sense for one in made], dtype=np.int8)
        lengths, theta, wanted, side = task.built(n, senses, np.stack([turn_in, turn_out]))
        errors = np.array([one.error for one in made])
        for k, one in enumerate(made):
            peaks[k, : len(one.errors)] = one.errors
            places[k, : len(one.peaks)] = theta[k, 0] + n[k, 5] * (one.peaks - turn_in[0])
            if exact:
                turns_all = {"turn_in": (x_all - low) * rate, "turn_out": (y_all - first) * factor}
                whole = replace(task, **turns_all, exact=False)
                errors[k] = n[k, 6] * np.abs(functions.peaks_of(whole, n[k], one.sign, one.sense)[1]).max()
        span = n[:, 6] * float(np.ptp(turn_out))
        more = {"theta4": length * wanted, "sense": senses, "structural_error": length * errors,
                "peak_error": length * peaks, "function_error": errors / span, "peak_theta1": places}  # fmt: skip
        if free:
            more |= {"input_turn": n[:, 5] * rate * (high - low)} | ({} if slider else {"output_turn": span})
        numbers = np.hstack([unit * lengths, np.zeros((len(made), 6))])
        return asked.within(Linkages(numbers, theta, side, None, more, slider))

    def again(limits: list[Any]) -> Linkages:
        names = [one.name for one in limits if one.name not in (*asked.names, USED)]

        def slack(n: Floats, sense: int) -> Floats:
            turn = np.stack([turn_in, turn_out])[:, :1]
            lengths, _, _, side = task.built(n, sense, turn)
            at: dict[str, Any] = dict(zip(asked.names[: 4 - slider], unit * lengths.T, strict=False))
            branch = np.where(side[:, 0] > 0.0, 2, 1)
            if names:
                at |= evaluate(asked.catalogue.name, names, branch=branch, allow_invalid=True, **at)
            at[USED] = task.transmissions(n)
            ends = [sign * (at[name] - end) / max(abs(end), 1e-6) for name, sign, end in _ends(limits)]
            return np.stack(ends, axis=1) - 1e-9

        return generated(replace(task, limits=slack) if limits else task)

    coords = {"x": x} | ({} if free else {"turn_in": turn_in, "turn_out": length * turn_out})
    attrs = {"points_are_precision_points": int(exact)}
    by = "function_error" if free else "structural_error"
    # with conditions one linkage tells their names and limits
    found = generated(task, 1 if isinstance(asked.where, Mapping) and not exact else functions.FEW)
    return Solved("function", asked, found, coords, attrs, by, again=again)


def _values(function: Any, x: Floats) -> Floats:
    """Return a function at places, of arrays or of single numbers."""
    try:
        values = np.asarray(function(x), dtype=float)
    except Exception:  # whatever a function of somebody's does with an array
        values = np.empty(0)
    if values.shape == x.shape:
        return values
    try:
        return np.array([float(function(one)) for one in x])
    except Exception as error:
        remedy = "give a function of one number, such as numpy.log10"
        raise InputError(f"cannot be called ({error})", ("function",), remedy) from None


#: The range of a turn that is free.
FREE = (np.radians(30.0), np.radians(150.0))


def _turns(turn: Any, turn_deg: Any, slider: bool) -> list[tuple[float, float]] | None:
    """Return the range of the crank's turn and, of four bars, of that of the output link."""
    _check(turn is None or turn_deg is None, "turn", "is given, and so is turn_deg", "write one of them")
    name, given, unit = ("turn", turn, Fraction(1)) if turn_deg is None else ("turn_deg", turn_deg, PI / 180)
    if given is None:
        return None
    own = ("a turn", 60) if slider else ("two turns", (60, 90))
    what, remedy = f"is {short_repr(given)}", f"write {own[0]} up to 360 degrees, such as turn_deg={own[1]}"
    remedy, made = f"{remedy}; (lo, hi) for a range of one, None if it is free", list[tuple[float, float]]()
    try:
        for part in [given] if slider else given:
            ends = [float(scaled(float(one), unit)) for one in np.ravel(part)] if part is not None else FREE
            made.append((min(ends), max(ends)))
            grows = len(ends) == 1 or (len(ends) == 2 and ends[0] < ends[1])
            _check(grows and not isinstance(part, str), name, what, remedy)
    except (TypeError, ValueError):
        made = []
    fine = [low * high > 0.0 and max(-low, high) <= 2.0 * np.pi for low, high in made]
    _check(len(fine) == 2 - slider and all(fine) and made[0][0] > 0.0, name, what, remedy)
    return made


#: The tasks: what solves each, and the options that are its own.
TASKS: dict[str, tuple[Callable[..., Solved], tuple[str, ...]]] = {
    "path": (_solve_path, ("timing", "closed")),
    "motion": (_solve_motion, ("rotation_length",)),
    "function": (_solve_function, ("over", "turn", "turn_deg", "travel", "precision_points")),
}


# -- Conditions on what fastlink computes, and other objectives, of paths and motions


#: Linkages that are refined within conditions, and steps of each.
CONSTRAINED, MOST_STEPS = 12, 150
#: Of a family so many linkages stay, each with so many that are changed at random, by ever less.
FAMILY, CHANGED, CHANGES = 12, 24, 0.4 * 0.75 ** np.arange(28)


def within_conditions(solved: Solved, steps: Steps) -> Linkages | None:
    """Return linkages that are refined once more, within the conditions and towards the objective; None without any."""
    asked, error = solved.asked, "pose_error" if solved.task == "motion" else "path_error"
    if not (solved.path or solved.again) or not (asked.where or asked.minimise or asked.maximise):
        return None
    every, least, most = labelled(solved), asked.minimise, asked.maximise
    if not least and not most:
        least = (solved.minimise if solved.task == "function" else error) if solved.minimise else ()
        most = solved.maximise or ()
    choice = choice_of(every, least, most, asked.where, top=None)
    limits = [one for one in choice.limits if one.name not in asked.labels]
    if solved.task == "function":
        again: Linkages = solved.again([*limits, *(one for one in choice.limits if one.name == USED)])
        return again
    if len(choice.objectives) != 1:
        return None
    aim_name = str(choice.objectives[0].array.name)

    def worth(found: xr.Dataset) -> Floats:
        missed, of = np.zeros(found.sizes[DESIGN]), choice_of(found, least, most, asked.where, top=None)
        for one in of.wanted:
            values = one.array.values
            missed += one.miss(values) if one.is_limit else ~one.holds(values)
        aim = of.objectives[0]
        score = np.where(missed > 0.0, 1e9 * (1.0 + missed), aim.sign * aim.array.values)
        return np.asarray(np.where((found["defect"] == 0) & ~np.isnan(score), score, np.inf))

    score = worth(every)
    exact = (every[error].values <= paths.EXACT * solved.size) & np.isfinite(score)
    is_best = aim_name == error and score.min() < 1e-9 * solved.size
    can_vary = solved.task == "path" or len(solved.path.target) < 5
    if exact.any() and can_vary and not is_best:
        found, score = solved.found.at(exact), score[exact]
        *parts, missed = steps(_in_family, solved, found, score, worth)
        if missed < 1e9 or aim_name != error:
            own: dict[str, Any] = dict(zip(ARRAYS, parts[:4], strict=True))
            return replace(found, **own, more=dict(zip(found.more, parts[4:], strict=True)))
    # numbers of linkages have limits of their own there, where the nearest linkage does not meet them
    lower, upper, first = asked.lower.copy(), asked.upper.copy(), int(np.argmin(every[error].values))
    for one in choice.limits:
        if one.name in asked.names and one.miss(one.array.values)[first] > 0.0:
            k = asked.names.index(one.name)
            lower[k], upper[k] = max(lower[k], one.low), min(upper[k], one.high)
    tighter = bool((lower > asked.lower).any() or (upper < asked.upper).any())
    closer = replace(solved, asked=replace(asked, lower=lower, upper=upper))
    limits = [one for one in limits if one.name in every.data_vars]
    by_error = aim_name.startswith(error)
    asks = limits or tighter or aim_name == GREATEST[error] or not by_error
    if not asks or (lower > upper).any() or (not by_error and aim_name in asked.labels):
        return None
    both = error, GREATEST[error]
    near = min((one.high for one in choice.wanted if one.name in both), default=np.inf)
    names = [*dict.fromkeys([*(one.name for one in limits), *([] if by_error else [aim_name])])]
    key = every[error].values
    if not by_error:
        key = np.where(key <= near, score, np.inf)
    most = CONSTRAINED if by_error else CONSTRAINED // 3
    orders = [[k for k in np.argsort(of, kind="stable") if np.isfinite(score[k])] for of in (key, score)]
    # half of them those of the least errors, half those that miss conditions least
    rows = [*dict.fromkeys([*orders[0][: most // 2], *orders[1][: most // 2], *orders[0]])][:most]
    parts = [steps(_refined_within, closer, row, choice, limits, names, near) for row in rows]
    made = [part for part in parts if part]
    if not made:
        return None
    numbers, theta, side = (np.array(part) for part in zip(*made, strict=True))
    sides = np.repeat(side[:, None], theta.shape[1], axis=1)
    return solved.changed(numbers, theta, sides)


def _in_family(solved: Solved, found: Linkages, score: Floats, worth: Any) -> list[Any]:
    """Return the best of a family of linkages that do a task exactly, as arrays, and the least score.

    What is best is changed at random and made exact again, by ever less; those that stay differ by such a change.
    """
    rng = np.random.default_rng(solved.asked.seed)
    for change in CHANGES:
        order = np.argsort(score, kind="stable")[: int(np.isfinite(score).sum())]
        some = found.at(order)
        apart = paths.different(some.numbers, some.side[:, 0], some.starts, FAMILY, 0.1 * change)[0]
        found, score = some.at(apart), score[order][apart]
        made = solved.varied(found.at(np.repeat(np.arange(len(found)), CHANGED)), change, rng)
        if len(made):
            score = np.append(score, worth(labelled(replace(solved, found=made))))
            found = joined_linkages(found, made)
    found = found.at(np.argsort(score, kind="stable")[:FAMILY])
    return [*(getattr(found, name) for name in ARRAYS), *found.more.values(), score.min()]


def _refined_within(
    solved: Solved, row: int, choice: Choice, limits: list[Condition], names: list[str], near: float
) -> tuple[Any, ...]:
    """Return numbers, crank angles and side of a linkage refined within conditions towards the objective.

    By a sequential quadratic program (SciPy's SLSQP) with the exact derivatives of `fastlink.function` and of errors.
    """
    asked, size, aim = solved.asked, solved.size, choice.objectives[0]
    by_error = not names or str(aim.array.name) not in names
    task, found, side = solved.path, solved.found, float(solved.found.side[row, 0])
    fit = paths.Fit(task, found.theta[row, : len(task.target)], side)
    start: Floats = found.numbers[row].copy()
    if task.angles is not None:
        start[9] = found.more["body_angle"][row]
    if task.crank and names:  # off a change point, where rates are infinite
        start[3 if start[3] < start[0] and not asked.slider else 0] *= 0.97
    unknowns = 9 + (task.times is not None or task.angles is not None)
    free = np.flatnonzero((asked.lower < asked.upper) & (np.arange(10) < unknowns))
    free = free[free != 3] if asked.slider else free
    scale = np.where(np.isin(free, (8, 9)), 1.0, size)
    inputs = 3 if asked.slider else 6
    branch = 2 if side > 0 else 1
    call: Any = function(asked.catalogue.name, asked.names[:inputs], names, branch=branch) if names else None
    # the last unknown is the greatest distance, where that is minimised or limited
    greatest = aim.array.name in GREATEST.values() or near < np.inf
    x = np.append(start[free] / scale, [np.abs(fit(start, True)[0]).max() / size] * greatest)

    def numbers(x: Floats) -> Floats:
        n = start.copy()
        n[free] = x[: len(free)] * scale
        return n

    def values(x: Floats, name: str) -> tuple[float, Floats]:
        n, k, slopes = numbers(x)[:inputs], names.index(name), np.zeros(10)
        slopes[:inputs] = call.gradient(n)[k]
        return float(call(n)[k]), np.nan_to_num(np.append(slopes[free] * scale, [0.0] * greatest))

    def distances(x: Floats) -> tuple[Floats, Floats]:
        off, slopes = fit(numbers(x), True)
        by = np.hstack([-slopes[:, free] * scale / size, np.ones((len(off), 1))])
        return np.asarray(x[-1] - off / size), by

    def objective(x: Floats) -> tuple[float, Floats]:
        if not by_error:
            value, slopes = values(x, str(aim.array.name))
            return aim.sign * value, aim.sign * slopes
        if aim.array.name in GREATEST.values():
            return float(x[-1]), np.eye(len(x))[-1]
        off, slopes = fit(numbers(x))
        by = 2.0 * (off @ slopes)[free] * scale / size**2
        return float(off @ off) / size**2, np.append(by, [0.0] * greatest)

    def limit(name: str, sign: float, end: float, x: Floats) -> tuple[float, Floats]:
        (value, slopes), unit = values(x, name), max(abs(end), 1e-6)
        return sign * (value - end) / unit - 1e-9, sign * slopes / unit

    rules = [constraint("ineq", partial(limit, *end)) for end in _ends(limits)]
    rules += [constraint("ineq", distances)] * greatest
    if task.crank:
        longer = 1.0 if start[3] >= start[0] else -1.0
        of_bars = [[-longer, -1, 1, longer], [-longer, 1, -1, longer], [-1, 1, 1, -1]]
        folds = np.array([[-1, 1, -1, 0], [-1, 1, 1, 0]] if asked.slider else of_bars, dtype=float)
        wide = np.zeros((len(folds), len(x)))
        wide[:, : len(free)] = np.pad(folds, ((0, 0), (0, 6)))[:, free] * scale / size
        rules.append(constraint("ineq", lambda x: (folds @ numbers(x)[:4] / size - 1e-6, wide)))
    low = np.append(asked.lower[free] / scale, [0.0] * greatest)
    high = np.append(asked.upper[free] / scale, [near / size] * greatest)
    # far from a least-squares objective the first step knows no curvature: it is kept short, and others follow
    for _ in range(1 if by_error else 10):
        reach = np.inf if by_error else 0.2 * (1.0 + np.abs(x))
        box = [*zip(np.maximum(low, x - reach), np.minimum(high, x + reach), strict=True)]
        with np.errstate(all="ignore"):  # where limits cannot be met it may step to no number
            best = minimize(objective, np.clip(x, low, high), jac=True, bounds=box, constraints=rules, method="SLSQP",
                            options={"maxiter": MOST_STEPS if by_error else 30, "ftol": 1e-14})  # fmt: skip
        stuck = not np.isfinite(best.x).all() or best.status not in (0, 8, 9)
        stuck = stuck or np.abs(best.x - x).max() < 1e-9
        x = best.x if by_error or not stuck else x
        if stuck:
            break
    if not np.isfinite(x).all() or (n := numbers(x))[: 2 if asked.slider else 4].min() <= 0.0:
        return ()
    fit(n)
    return n, fit.theta, side


def _ends(limits: Sequence[Condition]) -> list[tuple[str, float, float]]:
    """Return the name, the sense and the number of each finite end of conditions."""
    both = ((one.name, ((1.0, one.low), (-1.0, one.high))) for one in limits)
    return [(name, sign, end) for name, ends in both for sign, end in ends if np.isfinite(end)]


# -- The result


def labelled(solved: Solved) -> xr.Dataset:
    """Return all linkages of a task with their results, errors computed by the facts of the mechanism."""
    found = judged(solved.found, bool(solved.attrs.get("closed")), "time" in solved.target)
    asked, n, slider = solved.asked, found.numbers, found.slider
    inputs = dict(zip(asked.names[:6], n[:, :6].T, strict=True))
    inputs.pop("", None)
    beside = {name: inputs.pop(name) for name in ("P_u", "P_v") if slider or solved.task == "function"}
    branch = np.where(found.side[:, 0] > 0, 2, 1)
    wanted = [*dict.fromkeys([*asked.quantities, *asked.others(), "status"])]
    swept = sweep(asked.catalogue.name, table(inputs), wanted, branch=(1, 2), verify=0, progress=False)
    index: dict[str, Any] = {DESIGN: xr.DataArray(np.arange(len(n)), dims=DESIGN)}
    if "branch" in swept.dims:
        index["branch"] = xr.DataArray(branch - 1, dims=DESIGN)
    result = swept.isel(index).drop_vars("branch", errors="ignore").load()
    data: dict[str, Any] = {}
    if solved.task != "function":
        data = dict(zip(NUMBERS[6:9], n[:, 6:9].T, strict=True))
        ends = {"D_x": n[:, 6] + n[:, 3] * np.cos(n[:, 8]), "D_y": n[:, 7] + n[:, 3] * np.sin(n[:, 8])}
        data |= beside if slider else ends
    data |= {name: found.more[name] for name in ("order", "circuit", USED)}
    data |= {"starts": found.starts, "theta1": found.theta} | _errors(solved, found, branch)
    data |= {name: values for name, values in found.more.items() if name in LABELS}
    if "time" in solved.target:
        data["phase"] = n[:, 9]
    if "curve" in found.more:
        data["cognate_of"] = found.more["curve"]
    made: dict[str, Any] = {}
    for name, values in data.items():
        name = OF_SLIDER.get(name, name) if slider else name
        dims = (DESIGN, "peak" if name.startswith("peak_") else "point")[: np.ndim(values)]
        made[name] = (dims, values, dict(zip(("units", "long_name"), asked.labels[name], strict=True)))
    flags = {"flag_values": np.array(list(DEFECTS), dtype=np.int8), "flag_meanings": " ".join(DEFECTS.values()),
             "long_name": "What keeps the linkage from the task", "units": "1"}  # fmt: skip
    made["defect"] = ((DESIGN,), found.more["defect"], flags)
    text = f"Assembly mode: B right (1) or left (2) of {'A' if slider else 'the line from A to D'}"
    coords: dict[str, Any] = {"branch": ((DESIGN,), branch, {"long_name": text})}
    if "peak_error" in data:
        coords["peak"] = ("peak", np.arange(data["peak_error"].shape[1]), {"long_name": "Number of a peak"})
    texts = active_limits(n, asked)
    if any(texts):
        coords["active"] = ((DESIGN,), np.array(texts), {"long_name": "Limits that hold the linkage back"})
    for name, values in solved.target.items():
        units = "m" if slider and name == "turn_out" else TARGETS.get(name, "1")
        about = {"units": units, "long_name": f"{name} of the task"}
        coords[name] = (("point",), values, about)
    return result.assign(made).assign_coords(coords)


def active_limits(numbers: Floats, asked: Asked) -> list[str]:
    """Return which limits of their numbers linkages have reached, as texts."""
    found: list[list[str]] = [[] for _ in numbers]
    for k, (name, low, high) in enumerate(zip(asked.names, asked.lower, asked.upper, strict=True)):
        units = "rad" if name in ("ground_angle", "phase") else "m"
        for sign, end in ((">=", low), ("<=", high)):
            if name and low < high and np.isfinite(end):
                for row in np.flatnonzero(np.abs(numbers[:, k] - end) <= 1e-9 * max(abs(end), 1e-6)):
                    found[row].append(f"{name} {sign} {short_number(end)} {units}")
    return [", ".join(one) for one in found]


def _errors(solved: Solved, found: Linkages, branch: NDArray[np.int64]) -> dict[str, Any]:
    """Return the errors at the points of a task, from the facts of the mechanism at the crank angles."""
    n, target, slider = found.numbers, solved.target, found.slider
    names = solved.asked.names[: 3 if slider else 4 if solved.task == "function" else 6]
    given = dict(zip(names, n.T[:, :, None], strict=False)) | {"theta" if slider else "theta1": found.theta}

    def at(names: list[str], branch: Any) -> Any:
        return evaluate(solved.asked.catalogue.name, names, branch=branch, allow_invalid=True, **given)

    if solved.task == "function":
        name = "slider_position" if slider else "theta4"
        off = at([name], branch[:, None])[name] - found.more["theta4"]
        off = off if slider else wrapped(off)
        return {"output_error": off, "structural_error_rms": np.sqrt(np.mean(off**2, axis=1))}
    x, y = ("A_x", "A_y") if slider else ("P_x", "P_y")
    facts = at(["theta2", x, y], np.where(found.side > 0, 2, 1))
    place, turn = facts[x] + 1j * facts[y], facts["theta2"]
    if slider:
        place = place + (n[:, 4:5] + 1j * n[:, 5:6]) * np.exp(1j * turn)
    wanted = target["target_x"] + 1j * target["target_y"]
    off = np.abs(n[:, 6:7] + 1j * n[:, 7:8] + np.exp(1j * n[:, 8:9]) * place - wanted)
    if solved.task == "path":
        square, whole = off**2, {}
        if solved.minimise == "ordered_distance":
            whole = curve_distances(found, wanted)
        return {"point_error": off, "path_error": np.sqrt(square.mean(axis=1)), "path_error_max": off.max(axis=1),
                "path_error_sum": square.sum(axis=1)} | whole  # fmt: skip
    turn = wrapped(turn + n[:, 8:9] + found.more["body_angle"][:, None] - target["target_angle"])
    both = off**2 + (solved.attrs["rotation_length"] * turn) ** 2
    return {"point_error": off, "angle_error": turn, "pose_error": np.sqrt(both.mean(axis=1)),
            "pose_error_max": np.sqrt(both.max(axis=1))}  # fmt: skip


#: Places of whole curves that are compared, and parts of the distance between two where the first may be.
UNIFORM, FINER = 200, 8


def curve_distances(found: Linkages, target: NDArray[np.complex128]) -> dict[str, Floats]:
    """Return how far whole curves are from a closed one, both with the unit root mean square of the target.

    As in A. Nobari et al., LInK, 2024: at 200 places by length, the mean distance of the nearest place, both ways,
    summed; and the least mean squared distance over all first places and both senses, times 2 pi.
    """

    def uniform(z: NDArray[np.complex128]) -> Any:
        around = np.append(z, z[0])[None]
        return paths.at_shares(around, around, np.arange(UNIFORM) / UNIFORM)[0]

    wanted = uniform(target)
    centre = wanted.mean()
    size = np.sqrt(np.mean(np.abs(wanted - centre) ** 2))
    wanted, result = (wanted - centre) / size, np.full((2, len(found)), np.nan)
    rows = np.flatnonzero(found.more["defect"] == 0)
    # cognates have one curve, which the first of them draws
    first, same = np.unique(found.more["curve"][rows], return_index=True, return_inverse=True)[1:]
    some = found.at(rows[first])
    theta = 2.0 * np.pi * np.arange(2 * UNIFORM) / (2 * UNIFORM)
    for k, curve in enumerate(paths.pins(some.numbers, theta, some.side[:, :1])[-1]):
        own = (uniform(curve) - centre) / size
        apart = np.abs(own[:, None] - wanted[None])
        # first places between the 200 count too, or else near curves would not tell themselves apart
        products = np.fft.fftshift(np.fft.fft([own, own[::-1]]) * np.conj(np.fft.fft(wanted)), axes=1)
        wide = np.pad(products, ((0, 0), ((FINER - 1) * UNIFORM // 2,) * 2))
        both = FINER * np.fft.ifft(np.fft.ifftshift(wide, axes=1)).real
        squares = np.sum(np.abs(own) ** 2) + np.sum(np.abs(wanted) ** 2) - 2.0 * both.max()
        made = apart.min(axis=0).mean() + apart.min(axis=1).mean(), 2.0 * np.pi * max(squares, 0.0) / UNIFORM
        result[:, rows[same == k]] = np.array(made)[:, None]
    return {"chamfer": result[0], "ordered_distance": result[1]}


def selected(every: xr.Dataset, solved: Solved) -> xr.Dataset:
    """Return the best linkages that meet all conditions, those without defects first; or none, and the reason."""
    asked, where = solved.asked, solved.asked.where
    about = {"task": solved.task, "found": every.sizes[DESIGN], "seed": asked.seed}
    attrs = {**every.attrs, **solved.attrs, **about}
    codes = every["defect"].values if every.sizes[DESIGN] else np.empty(0, dtype=int)
    for code, name in DEFECTS.items():
        attrs[f"found_{name}"] = int(np.count_nonzero(codes == code))
    asks_defect = isinstance(where, Mapping) and any(split(str(k), ("defect",))[0] == "defect" for k in where)
    left = every
    if not asks_defect and not solved.with_defects:
        left = every.isel({DESIGN: codes == 0})
    minimise, maximise = asked.minimise, asked.maximise
    if not minimise and not maximise:
        minimise, maximise = solved.minimise or (), solved.maximise or ()
    if not left.sizes[DESIGN]:
        counts = {name: attrs[f"found_{name}"] for code, name in DEFECTS.items() if code}
        why = [f"{counted(count, 'linkage')} with {name}" for name, count in counts.items() if count]
        reason = f"no linkage does it: {joined(why)}" if why else "no linkage was found"
        return _ended(left, attrs, reason)
    several = len(_listed(minimise)) + len(_listed(maximise)) > 1
    choice = choice_of(left, minimise, maximise, where, top=None if several else left.sizes[DESIGN])
    for one in choice.wanted:
        attrs[f"excluded_by_{one.name}"] = int(np.count_nonzero(~one.holds(one.array.values)))
    try:
        selection = chosen(choice)
        best = with_missed(left.isel({DESIGN: selection.places}), choice.limits)
    except InputError as error:
        return _ended(left.isel({DESIGN: slice(0, 0)}), attrs, error.what)
    attrs["selection"] = selection.about
    order = np.argsort(best["defect"].values != 0, kind="stable")
    best = best.isel({DESIGN: order[: asked.top]})
    return _ended(best, attrs, "")


def _listed(given: Any) -> list[Any]:
    return [given] if isinstance(given, str) else list(given)


def _ended(found: xr.Dataset, attrs: dict[str, Any], reason: str) -> xr.Dataset:
    """Return a result with its designs numbered, cognates named by these, and the reason where there is none."""
    count = found.sizes[DESIGN]
    if "cognate_of" in found:
        _, first, same = np.unique(found["cognate_of"], return_index=True, return_inverse=True)
        found = found.assign(cognate_of=found["cognate_of"].copy(data=first[same]))
    found = found.assign_coords({DESIGN: np.arange(count)})
    for name in ("configurations", "configurations_per_second", "set_up_time_s", "design_kind"):
        attrs.pop(name, None)
    attrs = {k: v for k, v in attrs.items() if not k.startswith("designs_")}
    found.attrs = {**attrs, "designs": count, **({"reason": reason} if reason else {})}
    return found


@door
def synthesise(
    mechanism: str,
    quantities: Sequence[str] = (),
    *,
    path: Any = None,
    motion: Any = None,
    function: Any = None,
    timing: Any = None,
    closed: bool | None = None,
    exact: bool = False,
    rotation_length: float | None = None,
    over: tuple[float, float] | None = None,
    turn: Any = None,
    turn_deg: Any = None,
    travel: float | None = None,
    precision_points: int | None = None,
    where: Any = None,
    bounds: Mapping[str, Any] | None = None,
    fixed: Mapping[str, float] | None = None,
    minimise: str | Sequence[str] = (),
    maximise: str | Sequence[str] = (),
    top: int = 10,
    seed: int = 0,
    to: str | Path | None = None,
    overwrite: bool = False,
    restart: bool = False,
    attrs: Mapping[str, Any] | None = None,
) -> xr.Dataset:
    """Find linkages for a task: a path, a motion or a function.

    What algebra gives exactly is all there; beyond, the best are found from thousands of starts and refined by exact
    derivatives. A linkage that cannot do the task in motion is no solution: each is looked at for defects.

    Parameters
    ----------
    mechanism : {"planar_4r", "slider_crank"}
        The mechanism. Of a slider-crank ``r``, ``l``, ``e`` take the place of ``a1`` to ``a4``, ``theta`` that of
        ``theta1``, the direction of the slider's line that of OD; ``P_u``, ``P_v`` is a point of the rod.
    quantities : sequence of str
        What else is computed of each linkage, as `fastlink.sweep` takes it.
    path : array_like, table or path of a CSV file
        Points (x, y) [m] that the coupler point passes in this order, or a whole curve as up to 2,000 of them.
    motion : array_like, table or path of a CSV file
        Poses (x, y, angle) [m, m, rad] of a body on the coupler; ``angle_deg`` in a table. Two to five are met exactly,
        by slider-cranks two to four.
    function : callable, array_like or table
        The output as a function of x, or pairs (x, y); up to five pairs are met exactly.
    timing : array_like or "even", optional
        The crank angle at each point of a path [rad], counted from anywhere (``fixed={"phase": 0}``: from OD); or equal
        steps over a turn.
    closed : bool, optional
        Whether the path closes; by default if it ends where it begins. The crank then turns fully.
    exact : bool, default False
        Find all linkages through five points with timing, or through nine without, and tell those with defects too.
    rotation_length : float, optional
        The length [m] at which an error of direction counts as one of place; needed for more poses than are exact.
    over : (float, float)
        The range of x of a function.
    turn, turn_deg : (turn, turn); of a slider-crank turn
        By how much crank and output link turn over the range: numbers, ranges (lo, hi), or None for 30 to 150 degrees;
        of turns that are free the error is the least as a share of the output's. A positive output turn may have either
        sense, see ``sense`` in the result; a negative one is against the crank. Without it pairs are angles in rad.
    travel : float, optional
        By how much the slider of a slider-crank moves from the first to the last value [m]. Without it the values of
        the function are places in m.
    precision_points : int, optional
        Meet a function exactly at 3 to 5 points in Chebyshev's spacing, instead of with the least greatest error; of a
        table those pairs that are next to these.
    where : mapping, optional
        Conditions on all that is computed, as of `fastlink.best`, such as
        ``{"least_transmission_angle_deg": (40, None)}`` or ``{"D_x": (0, 1)}``.
    bounds, fixed : mapping, optional
        Ranges of, or numbers for ``a1`` to ``a4``, ``P_u``, ``P_v``, ``O_x``, ``O_y``, ``ground_angle`` and ``phase``;
        D by ``D_x``, ``D_y`` where O is fixed too. Of motions they are conditions, as of `where`; families of two to
        four poses meet numbers that are given to the last bit. Where no linkage can, ``missed`` tells by how much.
    minimise, maximise : str or sequence of str
        What is best; by default the least error, and of two to four poses the greatest of the least transmission angles
        between them.
    top : int, default 10
        How many linkages at most.
    seed : int, default 0
        Of the starts; the same seed gives the same result.
    to : path, optional
        An HDF5 file to write the result to.
    overwrite : bool, default False
        Replace an existing file.
    restart : bool, default False
        Throw away what a stopped run has left in ``FILE.search``. Without it, the same run goes on there, to the same
        bits, and another one is refused.
    attrs : mapping, optional
        Further attributes.

    Returns
    -------
    xarray.Dataset
        Linkages along ``design``, the best first, as a map: ``a1`` to ``a4``, ``P_u``, ``P_v``, ``branch``; O, D and
        ``ground_angle`` in the frame of the task; the crank angles ``theta1(design, point)``; the errors; ``defect``,
        ``order``, ``circuit``, ``status``, ``starts``; linkages of one curve have one ``cognate_of``. Where there is
        none, it is empty and the attribute ``reason`` says why.

    Raises
    ------
    InputError
        The task is none: too few points, equal ones, NaN; or a name is unknown.

    Notes
    -----
    F. Freudenstein 1955 for functions; L. Burmester 1888 for motions, whose dyads come from a null space and two
    conics; paths with timing are motions of a cognate; H. Alt 1923 for nine points.

    Examples
    --------
    >>> arc = [(3, 3), (2.759, 3.363), (2.372, 3.663), (1.89, 3.862), (1.355, 3.943)]
    >>> found = fl.synthesise("planar_4r", path=arc, timing=np.radians([30, 45, 60, 75, 90]), exact=True)
    >>> found.attrs["complete"], bool((found.path_error < 1e-12).all())
    ('all 2 linkages of five timed points', True)
    """
    call, began, problems = dict(locals()), time.perf_counter(), Problems()
    tasks = [name for name in TASKS if call[name] is not None]
    if len(tasks) != 1:
        what = f"has {joined(tasks)}" if tasks else "has no task"
        problems.add(what, ("synthesise",), "write one of path=..., motion=..., function=...")
    slider = mechanism == "slider_crank"
    if not slider and mechanism != "planar_4r":
        remedy = "write 'planar_4r' or 'slider_crank'"
        problems.add(f"{short_repr(mechanism)} is not synthesised", ("mechanism",), remedy)
    problems.attempt(check_whole, ("top",), top, 1)
    problems.attempt(check_whole, ("seed",), seed, 0)
    problems.attempt(check_switch, ("exact",), exact)
    names = problems.attempt(check_names, "quantities", quantities) if quantities else ()
    limits = _limits(bounds, fixed, slider, problems)
    for task, (_, options) in TASKS.items():
        for name in options:
            if call[name] is not None and tasks != [task]:
                problems.add(f"is for {task}=...", (name,), "leave it out")
    problems.stop()
    solve_task, options = TASKS[tasks[0]]
    known = find_catalogue("slider_crank" if slider else "planar_4r", None)
    asked = Asked(known, tuple(names or ()), where, minimise, maximise, top, *limits, seed, exact)
    asked.others()  # unknown names are refused before anything is computed
    about = {"mechanism": mechanism, "synthesis": tasks[0], **dict(attrs or {})}

    def solve(steps: Steps) -> xr.Dataset:
        solved = solve_task(asked, steps, *(call[name] for name in (*tasks, *options)))
        none = not len(solved.found)
        if none:
            solved.found = _one(solved)
        elif (more := within_conditions(solved, steps)) is not None and len(more):
            solved.found = joined_linkages(more, solved.found)
            if tasks[0] == "motion":  # pivots that are given may leave one linkage
                solved.found = _different(solved.found)
        result = selected(labelled(solved).isel({DESIGN: slice(0, 0 if none else None)}), solved)
        result.attrs |= {**about, "run_time_s": time.perf_counter() - began}
        return result

    if to is None:
        return solve(Steps(Unfinished(None, "", False, dict)))
    words: list[Any] = [environment(), mechanism, names, top, seed, exact]
    words += [_as_text(call[name], over) for name in (*TASKS, *(n for _, own in TASKS.values() for n in own))]
    words += [*map(repr, (where, bounds, fixed, minimise, maximise))]
    fingerprint = hashlib.sha256(repr(words).encode()).hexdigest()

    def found(target: Path) -> tuple[xr.Dataset, None]:
        with Steps(Unfinished(target, fingerprint, restart, dict)) as steps:
            result = solve(steps)
        if not result.sizes[DESIGN]:
            raise InputError(f"{result.attrs['reason']}; nothing is written", ("where",), "widen the limits")
        return result, None

    ways: dict[str, Any] = {"made": f"synthesise {mechanism}", "overwrite": overwrite, "restart": restart}
    return to_file(Path(to), about, fingerprint, found, **ways)


class Steps(AbstractContextManager["Steps"]):
    """Steps of a run in turn: those of an earlier one, which was stopped, have their arrays beside its file."""

    def __init__(self, unfinished: Unfinished) -> None:
        self.unfinished, self.number = unfinished, 0
        self.made: dict[str, Any]
        self.made, ((_, self.done),) = unfinished.read() or ({}, [(0, 0)])
        self.made.pop("about", None)

    def __call__(self, step: Callable[..., Sequence[Any]], *of: Any) -> list[Any]:
        """Return the arrays that a step makes, or has made."""
        name, self.number = f"{self.number}.", self.number + 1
        if self.number > self.done:
            self.made |= {f"{name}{k}": np.asarray(one) for k, one in enumerate(step(*of))}
            self.done = self.number
            if time.monotonic() >= self.unfinished.due:
                self.unfinished.write(self, [(0, self.done)])
        count = sum(key.startswith(name) for key in self.made)
        return [self.made[f"{name}{k}"].copy() for k in range(count)]

    def arrays(self) -> dict[str, Any]:
        """Return all arrays by name, as a file keeps them."""
        return self.made

    def __exit__(self, kind: Any, error: BaseException | None, traceback: Any) -> None:
        """Keep what a run that was stopped has done; else nothing."""
        if error is None:
            self.unfinished.remove()
        elif self.done and self.unfinished.path is not None:
            with contextlib.suppress(InputError):
                self.unfinished.write(self, [(0, self.done)])
                one = self.done == 1
                kept = f"{counted(self.done, 'step')} of it {'is' if one else 'are'} kept in {self.unfinished.path}"
                error.add_note(f"{kept}; run the same again to go on")


def _as_text(value: Any, over: Any) -> str:
    """Return what tells a task from others: its numbers, also those of a file, or of a function over its range."""
    with contextlib.suppress(TypeError, ValueError, OSError), np.printoptions(threshold=10**9):
        if callable(value):
            value = _values(value, np.linspace(over[0], over[1], 1001))
        elif isinstance(value, (str, os.PathLike)) and value != "even":
            return Path(value).read_bytes().hex()
        return repr(value) if value is None else np.asarray(value, dtype=float).tobytes().hex()
    return repr(value)


def _one(solved: Solved) -> Linkages:
    """Return one linkage in place of none, for the labels of an empty result."""
    count = len(next(iter(solved.target.values())))
    more = {name: np.zeros((1, *of.shape[1:]), dtype=of.dtype) for name, of in solved.found.more.items()}
    numbers = np.array([[1.0, 4.0, 2.0, 3.5, 0, 0, 0, 0, 0, 0]])
    ones = np.ones((1, count))
    return Linkages(numbers, 0.0 * ones, ones, None, more, solved.asked.slider)
