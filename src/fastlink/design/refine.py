"""Refine designs that were selected from a map: off its grid, by derivatives, within what was asked for."""

from __future__ import annotations

import contextlib
import math
import re
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import IntEnum
from functools import cache, cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fastlink._text import counted, in_words, short_number, short_repr
from fastlink.engine.evaluate import evaluate
from fastlink.engine.extend import Extension, check_declared, is_own, own_refused
from fastlink.engine.function import Function, function
from fastlink.engine.labels import flag_attrs, request_labels
from fastlink.errors import InputError, Problems, listed
from fastlink.facts.arc import ARC_ENDS
from fastlink.facts.catalogue import ELIMINATED, Catalogue
from fastlink.facts.derivative import NoDependence, NoDerivative, is_tolerance
from fastlink.facts.names import derivative_name
from fastlink.maps.best import (
    ACTIVE,
    GAIN,
    MISSED,
    REFINEMENT,
    STARTS,
    Condition,
    Objective,
    labelled_missed,
    missed_text,
    nondominated,
)
from fastlink.maps.units import check_units, units_of
from fastlink.mechanisms import catalogue as find_catalogue
from fastlink.mechanisms import mechanism_of_map
from fastlink.plan.query import Request, parse_request
from fastlink.plan.request import check_positions, selected_variants
from fastlink.space.design_space import BRANCH, DESIGN, EXTREMUM, MODELS, DesignSpace, Links, bounds_of, steps
from fastlink.space.units import split

if TYPE_CHECKING:
    import xarray as xr

    from fastlink.facts.fact import Input


# -- The inputs that a refinement may change: their ranges in a map, and those that follow others


#: Rows of a table in which inputs are compared; how far from a line two of them may be, of their size.
MOST_COMPARED = 1 << 20
ON_A_LINE = 1e-12


@dataclass(frozen=True)
class Span:
    """An input that may change, from one end to the other."""

    #: The input.
    name: str
    #: Its ends, which belong to it.
    low: float
    high: float
    #: The inputs that change with it, and by how much.
    followers: tuple[tuple[str, float], ...] = ()
    #: Of an input position that goes all around: a turn; 0 of what has ends.
    period: float = 0.0

    def about(self, value: float) -> Span:
        """Return the range from a start, which belongs to it: of what goes all around, half a turn to both sides."""
        if self.period:
            return replace(self, low=value - self.period / 2.0, high=value + self.period / 2.0)
        return replace(self, low=min(self.low, value), high=max(self.high, value))


def swept_inputs(catalogue: Catalogue, maps: xr.Dataset) -> dict[str, Input]:
    """Return the inputs that are not the same for all designs of a map, and are no codes."""
    known = catalogue.known_inputs(catalogue.variant_inputs)
    swept = [name for name in known if name in maps.variables and maps[name].ndim == 1]
    return {name: known[name] for name in swept if not known[name].choices}


def spans_of(catalogue: Catalogue, maps: xr.Dataset, only: Sequence[str]) -> list[Span]:
    """Return the inputs of a map that may change, with their ranges in it.

    Of a sample the ranges are those that it was drawn from. Inputs of a table that change together with another one,
    along a straight line, follow it.
    """
    swept, problems = swept_inputs(catalogue, maps), Problems()
    only = check_only(only, list(swept), problems, "refine")
    for name, declared in swept.items():
        problems.attempt(check_units, maps[name], declared.units, ("refine", name))
    problems.stop()
    ranges = re.findall(r"(\w+)=\(([^,()]+), ([^,()]+)\)", str(maps.attrs.get("design_ranges", "")))
    drawn = {name: (float(low), float(high)) for name, low, high in ranges}
    ends = {}
    for name in only or swept:
        low, high = _ends(maps[name])
        ends[name] = min(low, drawn.get(name, (low, high))[0]), max(high, drawn.get(name, (low, high))[1])
    tabled = [] if drawn else [name for name in ends if maps[name].dims == (DESIGN,)]
    return _spans(ends, {name: maps[name].variable for name in tabled})


def spans_of_space(
    catalogue: Catalogue,
    space: DesignSpace,
    bounds: Mapping[str, tuple[float, float]],
    only: Sequence[str],
) -> list[Span]:
    """Return the inputs of a design space that may change, within given ranges or else those of the space."""
    known = catalogue.known_inputs(catalogue.variant_inputs)
    given = {**space.axes, **space.columns}
    swept = [name for name in given if not known[name].choices]
    problems = Problems()
    only = check_only(only, swept, problems, "refine")
    check_only(bounds, swept, problems, "bounds")
    problems.stop()
    ends = {name: bounds.get(name) or bounds_of(given[name]) for name in only or swept}
    return _spans(ends, {} if space.kind != "table" else {n: given[n] for n in ends if n in space.columns})


def check_only(names: Iterable[str], swept: Sequence[str], problems: Problems, where: str) -> list[str]:
    """Return names of inputs that are swept without their units, and note others."""
    for name in names:
        if split(name, swept)[0] not in swept:
            problems.add(f"{short_repr(name)} is not an input that is swept", (where,), listed(list(swept)))
    return [split(name, swept)[0] for name in names]


def _spans(ends: Mapping[str, tuple[float, float]], tabled: Mapping[str, Any]) -> list[Span]:
    """Return the inputs with these ends, some of which are columns of a table, where others may follow them."""
    spans = _with_followers(
        tabled, [Span(name, low, high) for name, (low, high) in ends.items() if low < high]
    )
    if not spans:
        remedy = "sweep the inputs that may change, such as a2=(1.0, 1.4) of fl.sobol"
        raise InputError("there is no input that may change", ("refine",), remedy)
    return spans


def within(spans: Iterable[Span], wanted: Iterable[Condition]) -> list[Span]:
    """Return inputs with the ends that conditions leave them."""
    ends = {one.name: (one.low, one.high) for one in wanted if one.array.dtype.kind == "f"}
    found = []
    for one in spans:
        low, high = ends.get(one.name, (-math.inf, math.inf))
        narrowed = replace(one, low=max(one.low, low), high=min(one.high, high), period=0.0)
        found.append(narrowed if one.name in ends else one)
    return found


def _ends(array: xr.DataArray) -> tuple[float, float]:
    """Return the least and greatest number of an input, read piece by piece."""
    low, high = np.inf, -np.inf
    for start, stop in steps(0, array.size):
        values = np.asarray(array.variable[start:stop].values, dtype=np.float64)
        finite = values[np.isfinite(values)]
        low, high = min(low, finite.min(initial=np.inf)), max(high, finite.max(initial=-np.inf))
    return float(low), float(high)


def _with_followers(tabled: Mapping[str, Any], spans: list[Span]) -> list[Span]:
    """Return the inputs without those columns of a table that follow another one, which names them."""
    leaders: dict[str, list[tuple[str, float]]] = {}
    read: dict[str, Any] = {}
    for one in (one for one in spans if one.name in tabled):
        array = tabled[one.name]
        stride = -(-array.size // MOST_COMPARED)
        read[one.name] = np.asarray(array[::stride], dtype=np.float64)
        for leader, followers in leaders.items():
            slope = _slope(read[leader], read[one.name])
            if slope is not None:
                followers.append((one.name, slope))
                break
        else:
            leaders[one.name] = []
    following = {name for followers in leaders.values() for name, _ in followers}
    kept = [one for one in spans if one.name not in following]
    return [replace(one, followers=tuple(leaders.get(one.name, ()))) for one in kept]


def _slope(leader: NDArray[np.float64], follower: NDArray[np.float64]) -> float | None:
    """Return the slope of the line on which two inputs are in all rows, None where they are not, or in two at most."""
    if len(leader) < 3:
        return None
    first, last = int(np.argmin(leader)), int(np.argmax(leader))
    span = leader[last] - leader[first]
    if not span > 0.0:
        return None
    slope = float((follower[last] - follower[first]) / span)
    off = np.abs(follower[first] + slope * (leader - leader[first]) - follower).max()
    size = np.abs(follower).max() + abs(slope) * np.abs(leader).max()
    return slope if off <= ON_A_LINE * size else None


# -- Compute the results of a map again, anywhere between its designs: values and derivatives of many points


@dataclass(frozen=True, eq=False)
class Model:
    """A mechanism with the options of the sweep of a map."""

    #: Its name, or its extension by quantities of one's own.
    mechanism: str | Extension
    #: Links, input, solver, extrema and angles, as `fastlink.sweep` takes them.
    options: dict[str, Any]
    #: Whether the input positions of the sweep are known, or there is a usual choice of them.
    knows_positions: bool = True

    @classmethod
    def of_map(cls, maps: xr.Dataset, own: Any) -> Model:
        """Return that of a map, by its labels, perhaps with the quantities of a user that it was made with."""
        attrs = maps.attrs
        name, input = mechanism_of_map(attrs), attrs.get("input")
        mechanism: str | Extension = name
        if own is not None:
            mechanism = check_declared(own, name, str(attrs.get("own_quantities", "")))
        catalogue = find_catalogue(mechanism, input)
        known = catalogue.known_inputs(catalogue.variant_inputs)
        given = [name for name in known if name in maps.variables]
        links = None
        for model, names in MODELS.items():
            if any(name in given for name in names):
                links = Links(model, {n: float(maps[n]) for n in names if n in given and not maps[n].dims})
        options = {"links": links, "input": input, "solver": attrs.get("solver", ELIMINATED)}
        positions = _positions(catalogue, maps)
        usual = catalogue.positions is None or maps.attrs.get(f"{catalogue.position.name}_count") is None
        return cls(mechanism, options | positions, usual or "angles" in positions)

    @cached_property
    def catalogue(self) -> Catalogue:
        """The mechanism, as it is driven."""
        return find_catalogue(self.mechanism, self.options.get("input"))


def _positions(catalogue: Catalogue, maps: xr.Dataset) -> dict[str, Any]:
    """Return the positions of the sweep of a map, and how its extremes were found, as far as it tells."""
    name, attrs = catalogue.position.name, maps.attrs
    count = attrs.get(f"{name}_count")
    found = {"extrema": attrs["extrema"]} if attrs.get("extrema") in ("refined", "sampled") else {}
    if name in maps.dims and name in maps.coords and count == maps.sizes[name]:
        arc = ARC_ENDS[0] in maps.variables
        own = angles_of(catalogue, np.asarray(maps[name].values, dtype=np.float64), arc)
        return {**own, **found}
    if catalogue.positions is None and count is not None:
        return found | {"angles": int(count)}
    return found if catalogue.positions is None else {}


def angles_of(catalogue: Catalogue, positions: NDArray[np.float64], arc: bool) -> dict[str, Any]:
    """Return input positions as the option of a sweep: the number of equal steps over one turn, or an arc, if so."""
    count = len(positions)
    turn = catalogue.positions is None and np.array_equal(positions, check_positions(catalogue, count))
    return {"angles": count if arc or turn else positions}


@dataclass(frozen=True, eq=False)
class Results:
    """Some results of a model, as functions of some inputs."""

    #: The mechanism.
    model: Model
    #: The results.
    names: tuple[str, ...]
    #: Which of them are of one input position.
    pointwise: tuple[bool, ...]
    #: The inputs that are given for each design; the last one is the input position where `at_position`.
    inputs: tuple[str, ...]
    #: The branch.
    branch: int
    #: Inputs that are the same for all, such as choices.
    codes: Mapping[str, float] = field(default_factory=dict)
    #: Whether designs come with an input position.
    at_position: bool = False

    def values(self, designs: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the results (points, results) of designs (inputs, points)."""
        found = np.empty((designs.shape[1], len(self.names)))
        if self._over_cycle is not None:
            found[:, self._of_cycle] = self._over_cycle(designs[: self._count]).T
        if self._of_points:
            read = self._evaluated([self.names[k] for k in self._of_points], designs)
            for k in self._of_points:
                found[:, k] = read[self.names[k]]
        return found

    def slopes(self, designs: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the derivatives (points, results, inputs); NaN of what has none."""
        found = np.zeros((designs.shape[1], len(self.names), len(self.inputs)))
        function, places = self._with_gradient
        absent = [k for k in self._of_cycle if k not in places]
        found[:, absent] = np.nan
        if function is not None:
            slopes = function.gradient(designs[: self._count])
            found[:, places, : self._count] = np.moveaxis(slopes, 2, 0)
        names = self._slopes_at_points
        read = self._evaluated([name for name in names.values() if name], designs)
        for (k, j), name in names.items():
            found[:, k, j] = read[name] if name else np.nan
        return found

    @property
    def _count(self) -> int:
        """The number of the inputs of a design, which come first."""
        return len(self.inputs) - self.at_position

    @property
    def _of_cycle(self) -> list[int]:
        return [k for k, one in enumerate(self.pointwise) if not one]

    @property
    def _of_points(self) -> list[int]:
        return [k for k, one in enumerate(self.pointwise) if one]

    def _function(self, names: Sequence[str]) -> Function:
        options: dict[str, Any] = {"branch": self.branch, **self.model.options, **self.codes}
        return function(self.model.mechanism, self.inputs[: self._count], names, **options)

    @cached_property
    def _over_cycle(self) -> Function | None:
        names = [self.names[k] for k in self._of_cycle]
        return self._function(names) if names else None

    @cached_property
    def _with_gradient(self) -> tuple[Function | None, list[int]]:
        """The function of the results over the cycle that have derivatives, and their places."""
        if self._over_cycle is None:
            return None, []
        absent = self._over_cycle.without_gradient
        places = [k for k in self._of_cycle if self.names[k] not in absent]
        if len(places) == len(self._of_cycle):
            return self._over_cycle, places
        return self._function([self.names[k] for k in places]) if places else None, places

    def _evaluated(self, names: Sequence[str], designs: NDArray[np.float64]) -> dict[str, Any]:
        """Return quantities at single input positions."""
        if not names:
            return {}
        given: dict[str, Any] = {**self.codes, **dict(zip(self.inputs, designs, strict=True))}
        given |= {name: of for name, of in self.model.options.items() if name in ("links", "input", "solver")}
        names = list(dict.fromkeys(names))
        return evaluate(self.model.mechanism, names, branch=self.branch, allow_invalid=True, **given)

    @cached_property
    def _slopes_at_points(self) -> dict[tuple[int, int], str]:
        """The name of each derivative at an input position that is not 0 everywhere, empty where there is none."""
        catalogue, names = self.model.catalogue, dict[tuple[int, int], str]()
        given = [*self.inputs, *self.codes]
        links = self.model.options.get("links")
        variants = selected_variants(catalogue, links, self.model.options.get("solver", ELIMINATED), given)
        for k in self._of_points:
            for j, by in enumerate(self.inputs):
                name = derivative_name(self.names[k], by)
                try:
                    parse_request(name, catalogue)
                    catalogue.resolve(name, variants, given)
                    names[k, j] = name
                except NoDependence:
                    continue
                except (InputError, NoDerivative):
                    names[k, j] = ""
        return names


# -- Designs about a start as points of a unit cube: their results and derivatives, and whether their codes
#    are right


#: Of its range, by which an input is moved where a derivative is taken by differences.
DIFFERENCE = 1e-6


@dataclass(frozen=True, eq=False)
class Requirement:
    """A result or an input with its aim (1 to be least, -1 greatest, 0 neither) and its limits."""

    name: str
    sign: float = 0.0
    low: float = -np.inf
    high: float = np.inf


class Points:
    """The designs that can be reached from one start, as points: each input that may change runs from 0 to 1."""

    def __init__(
        self,
        reader: Results,
        required: Sequence[Requirement],
        codes: Sequence[Condition],
        spans: Sequence[Span],
        start: NDArray[np.float64],
        limits: Mapping[str, tuple[float, float]] = {},
    ) -> None:
        inputs = reader.inputs
        self.reader, self.start = reader, start
        self.leaders = [inputs.index(span.name) for span in spans]
        self.turns = np.zeros((len(inputs), len(spans)))
        for j, span in enumerate(spans):
            for name, slope in ((span.name, 1.0), *span.followers):
                self.turns[inputs.index(name), j] = slope
        own = start[self.leaders]
        for j, span in enumerate(spans):
            own[j] = np.clip(own[j], *limits.get(span.name, (-np.inf, np.inf)))
        #: Whether the start itself is such a point, or misses a condition on an input.
        self.has_start = bool((own == start[self.leaders]).all())
        spans = [span.about(x) for span, x in zip(spans, own, strict=True)]
        self.low, self.high = np.array([(span.low, span.high) for span in spans]).T
        self.begin = self._shares(own)
        #: The least and greatest values of the results, and their aims.
        self.limits = np.array([(one.low, one.high, one.sign) for one in required]).T
        places = {name: k for k, name in enumerate(reader.names)}
        self.read = [(k, places[one.name]) for k, one in enumerate(required) if one.name in places]
        self.own = [(k, inputs.index(one.name)) for k, one in enumerate(required) if one.name not in places]
        self.codes = [(places[one.name], one) for one in codes]
        self.periods = np.array([span.period for span in spans])

    def _shares(self, leaders: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return inputs as shares of their ranges, 0 where a range is one number."""
        width = self.high - self.low
        shares: Floats = np.divide(leaders - self.low, width, out=np.zeros(len(leaders)), where=width > 0.0)
        return shares

    def place_of(self, design: NDArray[np.float64]) -> NDArray[np.float64] | None:
        """Return a design as a point, None of one that cannot be reached from this start."""
        own, turns = design[self.leaders], self.periods > 0.0
        own[turns] = self.low[turns] + (own[turns] - self.low[turns]) % self.periods[turns]
        place = self._shares(own)
        inside = (place >= 0.0).all() and (place <= 1.0).all()
        again = self.designs(place[None])[:, 0]
        again[self.leaders] = design[self.leaders]
        # inputs that follow others are a rounding or two off their line
        return place if inside and np.allclose(again, design, rtol=ON_A_LINE, atol=0.0) else None

    def designs(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the inputs (inputs, points) of points (points, changing)."""
        moved = np.clip(self.low + points * (self.high - self.low), self.low, self.high)
        found: NDArray[np.float64] = self.start[:, None] + self.turns @ (moved - self.start[self.leaders]).T
        found[self.leaders] = moved.T
        return found

    def values(self, points: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
        """Return the results of points, and whether their codes are those that are wanted."""
        designs = self.designs(points)
        read = self.reader.values(designs)
        found = np.empty((len(points), self.limits.shape[1]))
        counts = np.ones(len(points), dtype=bool)
        for k, place in self.read:
            found[:, k] = read[:, place]
        for k, row in self.own:
            found[:, k] = designs[row]
        for place, condition in self.codes:
            counts &= condition.holds(read[:, place])
        return found, counts

    def slopes(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the derivatives of the results, by differences where there are no others."""
        read = self.reader.slopes(self.designs(points))
        found = np.empty((len(points), self.limits.shape[1], len(self.start)))
        for k, place in self.read:
            found[:, k] = read[:, place]
        for k, row in self.own:
            found[:, k] = 0.0
            found[:, k, row] = 1.0
        found = np.nan_to_num(found, nan=np.nan, posinf=np.nan, neginf=np.nan)
        with np.errstate(all="ignore"):
            turned: NDArray[np.float64] = (found @ self.turns) * (self.high - self.low)
        bad = np.flatnonzero(np.isnan(turned).any(axis=(1, 2)))
        if bad.size:
            turned[bad] = np.where(np.isnan(turned[bad]), self._differences(points[bad]), turned[bad])
        return turned

    def _differences(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return quotients of differences at both sides, at an end at one."""
        count, size = points.shape
        steps = [sign * DIFFERENCE * along for along in np.eye(size) for sign in (1.0, -1.0)]
        moved = np.concatenate([np.clip(points + step, 0.0, 1.0) for step in steps])
        values = self.values(moved)[0].reshape(size, 2, count, -1)
        ends = moved.reshape(size, 2, count, size)
        over = np.stack([ends[j, 0, :, j] - ends[j, 1, :, j] for j in range(size)])
        with np.errstate(all="ignore"):
            return np.moveaxis((values[:, 0] - values[:, 1]) / over[:, :, None], 0, 2)


# -- Linear programs over the pieces of extremes about a design


Floats = NDArray[np.float64]

#: A multiplier above which a limit holds the design back; it is a share of all, which add to 1.
HOLDS = 1e-6
#: How near to its end an input is at it.
AT_END = 1e-6


@cache
def _pattern(count: int) -> Floats:
    """Return the points about a design at which it is looked at: along each input, and all about."""
    from scipy.stats import qmc

    about: Any = qmc.Sobol(count, scramble=False).random_base2(max(3, (count - 1).bit_length() + 2))
    return np.concatenate((np.zeros((1, count)), np.eye(count), -np.eye(count), 2.0 * about - 1.0))


class Program:
    """A linear program over the pieces about a point."""

    def __init__(self, walk: _Walk, reach: float, points: Floats, values: Floats, slopes: Floats) -> None:
        self.walk = walk
        count, offsets = points.shape[1], points - walk.best
        # of each result at each point: its value by that piece at the best point, so that steps start there
        here = values - np.einsum("pri,pi->pr", slopes, offsets)
        rows, ends, of = [], [], []
        for k in walk.aims:
            scale = walk.signs[k] / walk.size[k]
            rows.append(np.column_stack((scale * slopes[:, k], np.full(len(points), -1.0))))
            ends.append(-scale * (here[:, k] - walk.first[k]))
            of += [(int(k), 0)] * len(points)
        for sign, limits in ((-1, walk.low), (1, walk.high)):
            for k in np.flatnonzero(np.isfinite(limits)):
                rows.append(np.column_stack((sign * slopes[:, k], np.zeros(len(points)))) / walk.size[k])
                ends.append((sign * (limits[k] - here[:, k]) - walk.margin[k]) / walk.size[k])
                of += [(int(k), sign)] * len(points)
        self.rows, self.ends, self.of = np.concatenate(rows), np.concatenate(ends), of
        self.bounds = [*zip(np.maximum(-reach, -walk.best), np.minimum(reach, 1.0 - walk.best), strict=True)]
        self.count, self.reach = count, reach
        #: Whether a point about it does not count, or has no number or slope.
        self.left_out = False

    @classmethod
    def about(cls, walk: _Walk, reach: float) -> Program | None:
        """Return that of a reach, None where too few points have numbers."""
        points = np.clip(walk.best + reach * _pattern(len(walk.best)), 0.0, 1.0)
        values, slopes = walk.measured(points)
        good: Any = np.isfinite(values).all(axis=1) & np.isfinite(slopes).all(axis=(1, 2))
        if not good[0]:
            return None
        program = cls(walk, reach, points[good], values[good], slopes[good])
        program.left_out = not good.all()
        return program

    def solve(self, missed: Floats) -> bool:
        """Solve it with limits that are closer by what a step has missed, and tell whether there is a solution."""
        from scipy.optimize import linprog

        closer = np.array([missed[k] / self.walk.size[k] if sign else 0.0 for k, sign in self.of])
        cost = np.append(np.zeros(self.count), 1.0)
        found = linprog(
            cost, A_ub=self.rows, b_ub=self.ends - closer, bounds=[*self.bounds, (None, None)], method="highs"
        )
        if found.status != 0:
            return False
        #: Where it leads, and the height that it promises there.
        self.step, self.height, self.found = found.x[:-1], float(found.x[-1]), found
        return True

    def limits(self) -> tuple[set[tuple[int, int]], set[tuple[int, int]]]:
        """Return what holds the point back: limits of results that have a multiplier, and ends at which inputs are."""
        weights: dict[tuple[int, int], float] = {}
        for key, weight in zip(self.of, -self.found.ineqlin.marginals, strict=True):
            weights[key] = weights.get(key, 0.0) + float(weight)
        results = {key for key, weight in weights.items() if key[1] and weight > HOLDS}
        lower, upper, best = self.found.lower.marginals, self.found.upper.marginals, self.walk.best
        ends = {(j, -1) for j in range(self.count) if best[j] <= AT_END and lower[j] > HOLDS}
        ends |= {(j, 1) for j in range(self.count) if best[j] >= 1.0 - AT_END and upper[j] < -HOLDS}
        return results, ends


# -- Find a least value from a start: SLSQP, then steps by linear programs over the pieces about a point

# Extremes over the cycle have kinks, where two places tie, and a least extreme is often at one: there no
# derivative is 0, and SLSQP stops beside it. The linear program takes values and derivatives at points all
# about a design, each of which lies on one of the pieces. Where it sees nothing to gain, nothing can be
# gained to first order; its multipliers say what holds the design back.
#
# Measured on four-bars of 3 to 5 inputs and 0 to 3 conditions: SLSQP takes 1 to 80 ms, ends within 1e-9 to
# 1e-6 of the best and never far; trust-constr takes 190 to 610 ms, ends up to 3e-6 above, and raises an
# error where a value is no number. The linear programs alone end up to 5e-3 above where the way to the best
# one is bent.


#: Steps of SLSQP, and of linear programs.
MOST_STEPS, MOST_PROGRAMS = 100, 60
#: Where SLSQP ends, of the size of the objective.
PRECISION = 1e-12
#: By how much of their size constraints are kept, so that rounding does not break them.
MARGIN = 1e-9
#: A target is met if it is off by no more than this, of its size; and the steps towards it from beside.
MET, MOST_NEWTON = 1e-9, 4
#: The reach of the first linear program, of the ranges; that below which no further one is tried.
FIRST_REACH, LAST_REACH = 1e-3, 1e-10
GREATEST_REACH = 0.1
#: What a linear program has to promise, of the size of the objective, to count as something to gain.
PROMISE = 1e-10


class Outcome(IntEnum):
    """How a descent ended, by the names that maps have for it."""

    CONVERGED = 0
    NOTHING_TO_GAIN = 1
    OUT_OF_STEPS = 2
    BLOCKED_BY_A_CODE_OR_WHERE_THERE_IS_NO_VALUE = 3
    NO_DERIVATIVE_AT_THE_START = 4
    NOT_WHAT_THE_MAP_SAYS = 5
    MISSES_A_CONDITION = 6

    @property
    def meaning(self) -> str:
        """The name as a flag of a variable."""
        return self.name.lower()


@dataclass
class Descent:
    """A design that was found, and how."""

    #: The best design of all that were looked at, and its results.
    point: Floats
    values: Floats
    #: How it ended.
    outcome: Outcome
    #: The sizes of its results, in which what is left undone is measured.
    size: Floats
    #: The results whose limits hold it back, and the inputs whose ends do; each with -1 for the lower one, 1 for the
    # upper one.
    limits: set[tuple[int, int]] = field(default_factory=set)
    ends: set[tuple[int, int]] = field(default_factory=set)
    #: By how much it misses limits in all, in sizes of the results; which results do.
    miss: float = 0.0
    missed: tuple[int, ...] = ()
    #: Whether its start missed some.
    missed_first: bool = False


def descend(points: Points, start: Floats) -> Descent:
    """Return the best design that is reached from a start; the same one each time."""
    walk = _Walk(points, np.clip(start, 0.0, 1.0))
    if not walk.can_start:
        return Descent(walk.start, walk.first, Outcome.NO_DERIVATIVE_AT_THE_START, walk.size)
    with np.errstate(all="ignore"):
        walk.by_slsqp(walk.start)
        if walk.best_miss > 0.0:
            walk.by_least_squares()
            walk.by_slsqp(walk.best)
        if walk.best_miss > 0.0:
            return walk.missing()
        outcome = walk.by_programs()
    if outcome is Outcome.CONVERGED and not (walk.best_height < 0.0 or walk.first_miss > 0.0):
        outcome = Outcome.NOTHING_TO_GAIN
    return walk.result(outcome)


def constraint(kind: str, rows: Callable[[Floats], tuple[Any, Any]]) -> dict[str, Any]:
    """Return a constraint of SLSQP from a function that returns values and derivatives."""
    return {"type": kind, "fun": lambda z: rows(z)[0], "jac": lambda z: rows(z)[1]}


class _Walk:
    """The way from a start: what is known of the points that were looked at.

    Several objectives fall together: the height of a point is the greatest of their changes since the start, each in
    sizes of its own, so that a point below 0 is better in all of them. A start may miss limits: of points that miss
    some the one that misses least is the best.
    """

    def __init__(self, points: Points, start: Floats) -> None:
        self.points, self.start = points, start
        low, high, self.signs = points.limits
        self.aims = np.flatnonzero(self.signs)
        values, slopes = self.measured(start[None])
        self.first = values[0]
        self.can_start = bool(np.isfinite(values).all() and np.isfinite(slopes).all())
        self.size = self._sizes(values[0], slopes[0])
        targets = low == high
        width = np.where(targets, MET * np.maximum(np.abs(low), self.size), 0.0)
        self.low, self.high, self.targets = low - width, high + width, np.flatnonzero(targets)
        limits, span = np.stack((low, high)), high - low
        kept = np.where(np.isfinite(limits), np.maximum(np.abs(limits), self.size), 0.0).max(axis=0)
        span = np.where(targets, 2.0 * width, span)
        self.margin = np.minimum(MARGIN * kept, np.where(np.isfinite(span), span / 4.0, np.inf))
        self.first_miss = self.best_miss = self.miss(values[0])
        self.best, self.best_values = start, values[0]
        self.best_height = 0.0 if self.first_miss == 0.0 else np.inf
        self.program: Program | None = None
        self._last: tuple[bytes, Any, Any] = (b"", None, None)

    def _sizes(self, values: Floats, slopes: Floats) -> Floats:
        """Return the size of each result: its value, or what it changes by over a thousandth of the ranges."""
        steep = np.abs(slopes).max(axis=1, initial=0.0)
        size = np.maximum(np.abs(values), 1e-3 * steep)
        return np.where((size > 0.0) & np.isfinite(size), size, 1.0)

    def measured(self, points: Floats) -> tuple[Floats, Floats]:
        """Return values, NaN where a design does not count, and slopes."""
        values, counts = self.points.values(points)
        return np.where(counts[:, None], values, np.nan), self.points.slopes(points)

    def height(self, values: Floats) -> Any:
        """Return how far points lie above the start, in sizes of the objectives."""
        change = self.signs[self.aims] * (values[..., self.aims] - self.first[self.aims])
        return (change / self.size[self.aims]).max(axis=-1)

    def misses(self, values: Floats) -> Floats:
        """Return by how much results miss their limits, in their sizes: below a lower limit less than 0."""
        return (values - np.clip(values, self.low, self.high)) / self.size

    def miss(self, values: Floats) -> float:
        """Return by how much a point misses limits in all, infinite where it has no number."""
        return float(np.abs(self.misses(values)).sum()) if np.isfinite(values).all() else np.inf

    def note(self, point: Floats, values: Floats) -> bool:
        """Keep a point that is better than all before it, and tell whether it is."""
        miss = self.miss(values)
        if miss > 0.0 and not miss < self.best_miss:
            return False
        height = float(self.height(values)) if miss == 0.0 else np.inf
        if miss == self.best_miss and not height < self.best_height:
            return False
        self.best, self.best_values = point.copy(), values.copy()
        self.best_height, self.best_miss = height, miss
        return True

    # -- SLSQP ---------------------------------------------------------------------------------------------------------

    def by_slsqp(self, begin: Floats) -> None:
        """Go down by SLSQP, over the inputs and, for several objectives, their common height."""
        from scipy.optimize import minimize

        joint = len(self.aims) > 1
        start, up = np.append(begin, [0.0] * joint), np.append(0.0 * begin, 1.0)
        rows = self._rows_of_limits()
        constraints = [constraint("ineq", rows)] if len(rows(start)[0]) else []
        if len(self.targets):
            constraints.append(constraint("eq", self._rows_of_targets))

        def objective(z: Floats) -> tuple[Any, Floats]:
            return (z[-1], up) if joint else self._height_at(z)

        ends: list[Any] = [(0.0, 1.0)] * len(self.start) + [(None, None)] * joint
        how: dict[str, Any] = {"method": "SLSQP", "options": {"maxiter": MOST_STEPS, "ftol": PRECISION}}
        # where it fails the best point so far is known, and the linear programs go on from there
        with contextlib.suppress(ValueError, ArithmeticError, np.linalg.LinAlgError):
            minimize(objective, start, jac=True, bounds=ends, constraints=constraints, **how)

    def _at(self, z: Floats) -> tuple[Floats, Floats]:
        """Return values and slopes at one point of SLSQP; of a point that has none the last ones, and no change."""
        point = np.clip(z[: len(self.start)], 0.0, 1.0)
        key = point.tobytes()
        if self._last[0] != key:
            values, slopes = self.measured(point[None])
            self.note(point, values[0])
            known = np.isfinite(values[0]).all()
            # no number: higher than all, so that the search along a line turns back
            above = np.where(self.signs != 0.0, self.signs * 1e3 * self.size, 0.0)
            value = values[0] if known else self.first + above
            self._last = key, value, np.nan_to_num(slopes[0], nan=0.0, posinf=0.0, neginf=0.0)
        return self._last[1], self._last[2]

    def _height_at(self, z: Floats) -> tuple[float, Floats]:
        """Return how far a point lies above the start by the one objective, and the slopes."""
        (k,), (values, slopes) = self.aims, self._at(z)
        return float(self.height(values)), self.signs[k] * slopes[k] / self.size[k]

    def _rows_of_limits(self) -> Callable[[Floats], tuple[Floats, Floats]]:
        """Return a function that gives what must not fall below 0, and its slopes."""
        low, high = np.isfinite(self.low), np.isfinite(self.high)
        low[self.targets] = high[self.targets] = False
        low, high = np.flatnonzero(low), np.flatnonzero(high)
        aims = self.aims if len(self.aims) > 1 else self.aims[:0]

        def rows(z: Floats) -> tuple[Floats, Floats]:
            values, slopes = self._at(z)
            size, margin, count = self.size, self.margin, len(self.start)
            above = (values - self.low - margin)[low] / size[low]
            below = (self.high - margin - values)[high] / size[high]
            signs = self.signs[aims] / size[aims]
            fall = z[count:].sum() - signs * (values - self.first)[aims]
            found = np.zeros((len(low) + len(high) + len(aims), len(z)))
            found[: len(low), :count] = slopes[low] / size[low, None]
            found[len(low) : len(low) + len(high), :count] = -slopes[high] / size[high, None]
            found[len(low) + len(high) :, :count] = -signs[:, None] * slopes[aims]
            found[len(low) + len(high) :, count:] = 1.0
            return np.concatenate((above, below, fall)), found

        return rows

    def _rows_of_targets(self, z: Floats) -> tuple[Floats, Floats]:
        """Return what must be 0, and its slopes."""
        values, slopes = self._at(z)
        of, found = self.targets, np.zeros((len(self.targets), len(z)))
        found[:, : len(self.start)] = slopes[of] / self.size[of, None]
        return (values - self.points.limits[0])[of] / self.size[of], found

    # -- towards limits that are missed: least squares ----------------------------------------------------------------

    def by_least_squares(self) -> None:
        """Go from the best point to where limits are missed least, by the sum of squares."""
        from scipy.optimize import least_squares

        aimed = self.low + self.margin, self.high - self.margin

        def off(z: Floats) -> tuple[Floats, Floats]:
            values, slopes = self._at(z)
            misses = (values - np.clip(values, *aimed)) / self.size
            return misses, np.where((misses != 0.0)[:, None], slopes / self.size[:, None], 0.0)

        with contextlib.suppress(ValueError, ArithmeticError, np.linalg.LinAlgError):
            ends = {"ftol": PRECISION, "xtol": PRECISION, "max_nfev": MOST_STEPS}
            least_squares(lambda z: off(z)[0], self.best, jac=lambda z: off(z)[1], bounds=(0.0, 1.0), **ends)

    def missing(self) -> Descent:
        """Return the best point, which misses limits, with these and the ends that hold it back."""
        misses, slopes = self.misses(self.best_values), self.measured(self.best[None])[1][0]
        fall = np.nan_to_num((misses / self.size) @ slopes)  # the slope of half the sum of squares
        steep = HOLDS * np.abs(fall).max(initial=0.0)
        ends = {(j, -1) for j in range(len(fall)) if self.best[j] <= AT_END and fall[j] > steep}
        ends |= {(j, 1) for j in range(len(fall)) if self.best[j] >= 1.0 - AT_END and fall[j] < -steep}
        missed = tuple(np.flatnonzero(misses).tolist())
        limits = {(k, -1 if misses[k] < 0.0 else 1) for k in missed}
        how = Outcome.MISSES_A_CONDITION, self.size, limits, ends, self.best_miss, missed
        return Descent(self.best, self.best_values, *how, missed_first=True)

    # -- linear programs -----------------------------------------------------------------------------------------------

    def by_programs(self) -> Outcome:
        """Go down by linear programs over points about the best one, and tell how that ended."""
        reach, blocked = FIRST_REACH, False
        for _ in range(MOST_PROGRAMS):
            program = Program.about(self, reach)
            if program is None or not program.solve(np.zeros(len(self.low))):
                reach /= 10.0
                blocked = True
            else:
                self.program = program
                before = self.best_height
                promised = before - program.height
                if promised <= PROMISE:
                    return Outcome.CONVERGED
                gained = self._step(program)
                blocked = not gained and program.left_out
                share = (before - self.best_height) / promised
                reach = min(2.0 * reach, GREATEST_REACH) if share > 0.7 else reach * (0.5 if gained else 0.1)
            if reach < LAST_REACH:
                return Outcome.BLOCKED_BY_A_CODE_OR_WHERE_THERE_IS_NO_VALUE if blocked else Outcome.CONVERGED
        return Outcome.OUT_OF_STEPS

    def _step(self, program: Program) -> bool:
        """Try where a linear program leads; where a bent limit is in the way once more, as far as it was missed."""
        for again in (False, True):
            point = np.clip(self.best + program.step, 0.0, 1.0)
            point = self._onto_targets(point)
            values, counts = self.points.values(point[None])
            if not counts[0] or not np.isfinite(values).all():
                return False
            if self.note(point, values[0]):
                return True
            missed = np.maximum(self.low - values[0], values[0] - self.high)
            if again or not (missed > 0.0).any() or not program.solve(1.5 * np.maximum(missed, 0.0)):
                return False
        return False

    def _onto_targets(self, point: Floats) -> Floats:
        """Return a point moved to where targets are met, by Newton's steps of least length."""
        for _ in range(MOST_NEWTON if len(self.targets) else 0):
            off, slopes = self._rows_of_targets(point)
            if not np.isfinite(off).all() or np.abs(off).max() < MET / 4.0:
                break
            point = np.clip(point - np.linalg.lstsq(slopes, off, rcond=None)[0], 0.0, 1.0)
        return point

    def result(self, outcome: Outcome) -> Descent:
        """Return the best point with what holds it back."""
        limits = (set(), set()) if self.program is None else self.program.limits()
        missed_first = self.first_miss > 0.0
        return Descent(self.best, self.best_values, outcome, self.size, *limits, missed_first=missed_first)


# -- From which of the best rows a refinement starts, and which of its ends are one design


#: Rows among which the starts of one result are, and the least number of them.
FOR_EACH, LEAST = 64, 512
#: Starts for each different design that is wanted, at most, and further ones.
MOST_STARTS, FURTHER = 2, 4
#: The farthest of two rows of which one start is enough, of the ranges.
FARTHEST = 0.2
#: The sigma of Rinnooy Kan and Timmer: above it the number of starts stays finite however many rows there are.
WIDENED = 4.0
#: By how much of their size results may rise, or limits be missed, on the way from one end to another that is the
#: same. Ends are within the margin of their limits, and each moves the others by some times as much.
RISE = 10.0 * MARGIN
#: Points of that way.
ON_THE_WAY = np.arange(1, 9)[:, None] / 8.0


def candidates(top: int) -> int:
    """Return the number of rows among which the starts for some different designs are."""
    return max(FOR_EACH * top, LEAST) if top > 1 else 1


class Starts:
    """The order in which rows are starts: by their values, but from one neighbourhood only the best one.

    A row near which is a better one most likely leads to where that one leads (Rinnooy Kan and Timmer, Stochastic
    global optimization methods part II: multi level methods, Mathematical Programming 39, 1987): such rows come last.
    What is near any earlier start or end is left out.
    """

    def __init__(self, rows: NDArray[np.float64], groups: Sequence[Any], searched: int, top: int) -> None:
        keys = {key: k for k, key in enumerate(dict.fromkeys(groups))}
        self.rows, self.groups = rows, np.array([keys[key] for key in groups])
        self.reach, self.top = _reach(rows.shape[1], max(searched, len(rows), 2)), top
        self.near = np.zeros(len(rows), dtype=bool)

    def __iter__(self) -> Iterator[int]:
        """Yield the numbers of rows; between them tell of each end by `ended`."""
        linked = np.zeros(len(self.rows), dtype=bool)
        for row in range(len(self.rows)):
            linked[row] = bool(self._about(self.rows[row], self.groups[row])[:row].any())
        count = 0
        for row in np.argsort(linked, kind="stable").tolist():
            if self.near[row]:
                continue
            if count == MOST_STARTS * self.top + FURTHER:
                return
            count += 1
            self.near |= self._about(self.rows[row], self.groups[row])
            yield row

    def ended(self, row: int, end: NDArray[np.float64]) -> None:
        """Leave out what is near the end of a start."""
        self.near |= self._about(end, self.groups[row])

    def _about(self, point: NDArray[np.float64], group: int) -> NDArray[np.bool_]:
        apart = np.linalg.norm(self.rows - point, axis=1)
        near: NDArray[np.bool_] = (apart <= self.reach) & (self.groups == group)
        return near


def _reach(inputs: int, searched: int) -> float:
    """Return the radius within which one row of an even sample is near another one for sure, as it grows."""
    if not inputs:
        return FARTHEST
    ball = math.gamma(1.0 + inputs / 2.0) * WIDENED * math.log(searched) / searched
    return min(FARTHEST, float(ball ** (1.0 / inputs)) / math.sqrt(math.pi))


def is_one_design(points: Points, end: Descent, other: NDArray[np.float64]) -> bool:
    """Tell whether from an end another design is reached without a rise: then the two are one, the other as good.

    They are closer than a refinement looks about, and what rises between them, or is missed of limits, is within what a
    refinement leaves undone: the margin of limits, and to second order of their distance what a bent way adds.
    """
    if end.outcome is Outcome.NOT_WHAT_THE_MAP_SAYS:
        return False
    place = points.place_of(other)
    if place is None:
        return False
    step = place - end.point
    distance = float(np.abs(step).max(initial=0.0))
    if not distance <= FIRST_REACH:
        return False
    values, counts = points.values(end.point + ON_THE_WAY * step)
    low, high, signs = points.limits
    room = (RISE + distance**2) * end.size
    kept = (values >= low - room) & (values <= high + room)
    flat = signs * (values - end.values) <= np.where(signs == 0.0, np.inf, room)
    return bool(counts.all() and np.isfinite(values).all() and kept.all() and flat.all())


# -- Refine designs that were selected from a map: off its grid, by derivatives, within what was asked for


REFERENCE = "docs/design_search.md"


@dataclass(frozen=True, eq=False)
class End:
    """A design at which a refinement ended."""

    #: The number of its start.
    row: int
    #: The designs that could be reached.
    points: Points
    #: How it was reached.
    descent: Descent
    #: Its inputs.
    design: NDArray[np.float64]
    #: From how many starts.
    starts: int = 1


#: How far the value of a map may be from that which the mechanism has there: results may be in single precision.
REPRODUCED = 1e-6


class Refinement:
    """The refinement of designs of a map."""

    def __init__(
        self,
        maps: xr.Dataset,
        model: Model,
        spans: Sequence[Span],
        objectives: Sequence[Objective],
        wanted: Sequence[Condition],
    ) -> None:
        self.model, catalogue = model, model.catalogue
        self.position = catalogue.position.name
        arrays = [*(one.array for one in objectives), *(one.array for one in wanted)]
        dims = {str(dim) for array in arrays for dim in array.dims}
        self.at_position = self.position in dims
        #: The results of a row: those of one position, the others.
        self.pointwise = {str(name) for name, one in maps.variables.items() if self.position in one.dims}
        self.inputs = [*swept_inputs(catalogue, maps), *([self.position] if self.at_position else [])]
        self.spans = within([*spans, *([self._of_position(maps)] if self.at_position else [])], wanted)
        self.limits = {one.name: (one.low, one.high) for one in wanted if one.is_limit}
        self.results, self.codes = self._results(maps, objectives, wanted)
        #: The names of all that is looked at.
        self.looked = [*(one.name for one in self.results), *(one.name for one in self.codes)]
        self.units = units_of(maps)
        self._readers: dict[tuple[Any, ...], Results] = {}

    def _of_position(self, maps: xr.Dataset) -> Span:
        """Return the range of the input position: that of the map, or a whole turn where it goes all around."""
        own = np.sort(np.asarray(maps[self.position].values, dtype=np.float64).ravel())
        catalogue = self.model.catalogue
        step = np.diff(own).max(initial=0.0)
        all_around = catalogue.positions is None and own[-1] - own[0] + step >= 2.0 * np.pi * (1.0 - 1e-9)
        return Span(self.position, float(own[0]), float(own[-1]), period=2.0 * np.pi if all_around else 0.0)

    def _results(
        self, maps: xr.Dataset, objectives: Sequence[Objective], wanted: Sequence[Condition]
    ) -> tuple[list[Requirement], list[Condition]]:
        """Return results with aims and limits, and conditions on codes, or refuse what nothing computes."""
        problems, found, codes = Problems(), dict[str, dict[str, Any]](), list[Condition]()
        for aim in objectives:
            with problems.at():
                name = self._computed(maps, aim.array, "minimise" if aim.sign > 0.0 else "maximise")
                found[name] = {"sign": aim.sign}
        fixed = {BRANCH, *(n for n in maps.coords if n not in self.inputs), *(one.name for one in self.spans)}
        for one in wanted:
            if one.array.name in fixed and one.array.dtype.kind != "b":
                continue  # which holds for the start and stays, or belongs to the range
            with problems.at():
                name = self._computed(maps, one.array, "where")
                if one.codes is not None or one.array.dtype.kind != "f":
                    codes.append(one)
                else:
                    found.setdefault(name, {})
                    found[name] |= {"low": one.low, "high": one.high}
        problems.stop()
        return [Requirement(name, **given) for name, given in found.items()], codes

    def _computed(self, maps: xr.Dataset, array: xr.DataArray, where: str) -> str:
        """Return the name of a variable that is computed anywhere, or refuse it."""
        name, catalogue = str(array.name), self.model.catalogue
        remedy = "name quantities of the mechanism, or leave refine out"
        if name in self.inputs and array.dtype.kind != "b":
            return name
        if array.name is None or array.dtype.kind == "b":
            what = "is a mask, which is known for the designs of the map alone"
            raise InputError(what, (where,), "write ranges such as {'a1': (None, 0.5)}")
        request = self._request(name)
        if request is None and is_own(name, str(maps.attrs.get("own_quantities", ""))):
            raise own_refused((where,), name)
        if request is None:
            what = (
                f"{name!r} is not a quantity of {catalogue.name}, and unknown between the designs of the map"
            )
            raise InputError(what, (where,), remedy)
        if request.reduction is not None and not self.model.knows_positions:
            what = f"{name!r} is of the values of {self.position} of the sweep, which the map does not hold"
            remedy = f"ask for a quantity along {self.position} too, or search by fl.search"
            raise InputError(what, (where,), remedy)
        if EXTREMUM in array.dims or (where != "where" and (request.listed or request.is_error)):
            what = (
                f"{name!r} is {'one of a list' if request.listed else 'an error bound'}, which has no slope"
            )
            raise InputError(what, where=(where,), remedy=remedy)
        if array.dtype.kind != "f" and where != "where":
            raise InputError(f"{name!r} is a whole number", (where,), remedy)
        if array.dtype.kind == "f":
            check_units(array, str(request_labels(catalogue, request).get("units", "1")), (where, name))
        return name

    def _request(self, name: str) -> Request | None:
        """Return the request for a result by its name, None of what is none."""
        try:
            return parse_request(name, self.model.catalogue)
        except InputError:
            return None

    def of(
        self,
        found: xr.Dataset,
        *,
        searched: int,
        top: int | None = None,
        whole: Callable[[list[int]], xr.Dataset] | None = None,
        show: Callable[[int], None] = lambda count: None,
    ) -> xr.Dataset:
        """Return selected designs after their refinement, each once, the best first, with what was gained."""
        ends, missing = list[End](), list[End]()
        starts = self._starts(found, searched, top)
        for row in starts:
            one = self._ended(found.isel({DESIGN: row}), row)
            if isinstance(starts, Starts):
                starts.ended(row, self._shares(one.design))
            if one.descent.miss > 0.0:
                missing.append(one)
            elif self._noted(ends, one):
                show(1)
            if len(ends) == top and not one.descent.missed_first:
                break  # rows that miss conditions are not in the order of what they lead to
        if len(ends) > (top or len(ends)):
            ends.sort(key=lambda one: self.results[0].sign * one.descent.values[0])
            del ends[top:]
        if not ends:  # the nearest design alone
            ends = sorted(missing, key=lambda one: one.descent.miss)[:1]
        kept = [one.row for one in ends]
        own = whole(kept) if whole is not None else found.isel({DESIGN: kept})
        designs = np.array([one.design for one in ends]).reshape(-1, len(self.inputs)).T
        return self._labelled(self._recomputed(own, designs), own, ends, found.sizes[DESIGN])

    def _starts(self, found: xr.Dataset, searched: int, top: int | None) -> Starts | range:
        """Return the numbers of the rows from which to start."""
        if top is None:
            return range(found.sizes[DESIGN])
        inputs = np.array([found[name].values for name in self.inputs])
        changing = {
            name for span in self.spans for name in (span.name, *(other for other, _ in span.followers))
        }
        fixed = [values for name, values in zip(self.inputs, inputs, strict=True) if name not in changing]
        for name, coord in found.coords.items():
            if name not in (*self.inputs, DESIGN) and coord.dtype.kind in "iuf":
                fixed.append(np.broadcast_to(coord.values, inputs.shape[1]))
        groups = [*zip(*fixed, strict=True)] or [()] * inputs.shape[1]
        return Starts(self._shares(inputs).T, groups, searched, top)

    def _shares(self, designs: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the inputs that may change, as shares of their ranges."""
        widths = [max(span.high - span.low, span.period) or 1.0 for span in self.spans]
        rows = designs[[self.inputs.index(span.name) for span in self.spans]]
        shares: NDArray[np.float64] = (rows.T / np.array(widths)).T
        return shares

    def _noted(self, ends: list[End], new: End) -> bool:
        """Add an end, or count it with one that is the same design; tell whether it is a new one."""
        for k, old in enumerate(ends):
            if old.points.reader is not new.points.reader:
                continue
            heights = [self.results[0].sign * one.descent.values[0] for one in (new, old)]
            worse, better = (old, new) if heights[0] < heights[1] else (new, old)
            if is_one_design(worse.points, worse.descent, better.design):
                ends[k] = replace(better, starts=old.starts + 1)
                return False
        ends.append(new)
        return True

    def _ended(self, row: xr.Dataset, number: int) -> End:
        """Return the end of the descent from one design."""
        start = np.array([float(row[name]) for name in self.inputs])
        points = Points(self._reader(row), self.results, self.codes, self.spans, start, self.limits)
        descent = self._descent(points, row)
        stays = descent.point is points.begin and points.has_start
        design = start if stays else points.designs(descent.point[None])[:, 0]
        return End(number, points, descent, design if design is start else self._wrapped(design))

    def _descent(self, points: Points, row: xr.Dataset) -> Descent:
        aims = [one for one in self.results if one.sign]
        expected = np.array([float(row[one.name]) for one in aims])
        own = points.values(points.begin[None])[0][0]
        if points.has_start and not np.allclose(
            own[: len(aims)], expected, rtol=REPRODUCED, atol=0.0, equal_nan=True
        ):
            return Descent(points.begin, own, Outcome.NOT_WHAT_THE_MAP_SAYS, np.ones(len(own)))
        return descend(points, points.begin)

    def _wrapped(self, design: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return a design whose input position, where it goes all around, is in the turn of the map."""
        span = self.spans[-1]
        if span.period:
            design[-1] = span.low + (design[-1] - span.low) % span.period
        return design

    def _reader(self, row: xr.Dataset) -> Results:
        """Return what computes the results of a row, the same for all rows of one branch."""
        branch = int(row[BRANCH]) if BRANCH in row.variables else 1
        links, catalogue = self.model.options.get("links"), self.model.catalogue
        given = {*self.inputs, *({} if links is None else links.values)}
        inputs = catalogue.known_inputs(catalogue.variant_inputs)
        stated = [*inputs, *filter(is_tolerance, map(str, row.coords))]
        fixed = {name: float(row[name]) for name in stated if name in row.variables and name not in given}
        key = (branch, *fixed.items())
        if key not in self._readers:
            names = tuple(name for name in self.looked if name not in self.inputs)
            pointwise = tuple(name in self.pointwise for name in names)
            given_for_each = tuple(self.inputs), branch, fixed, self.at_position
            self._readers[key] = Results(self.model, names, pointwise, *given_for_each)
        return self._readers[key]

    def _recomputed(self, found: xr.Dataset, designs: NDArray[np.float64]) -> xr.Dataset:
        """Return the designs with other inputs, and all their results anew, to the bits of a sweep."""
        names = [str(name) for name in found.data_vars if self._request(str(name)) is not None]
        others = [name for name in found.data_vars if name not in names]
        result = found.drop_vars([*others, MISSED], errors="ignore").copy()
        for name, values in zip(self.inputs, designs, strict=True):
            result[name] = (DESIGN,), values, found[name].attrs
        values = {name: np.empty(designs.shape[1], found[name].dtype) for name in names}
        groups: dict[int, tuple[Results, list[int]]] = {}
        for row in range(designs.shape[1]):
            reader = self._reader(found.isel({DESIGN: row}))
            groups.setdefault(id(reader), (reader, []))[1].append(row)
        for reader, rows in groups.values():
            pointwise = tuple(name in self.pointwise for name in names)
            every = replace(reader, names=tuple(names), pointwise=pointwise)
            for name, column in zip(names, every.values(designs[:, rows]).T, strict=True):
                values[name][rows] = column
        for name in names:
            result[name] = (DESIGN,), values[name], _unmeasured(found[name].attrs)
        return result

    def _labelled(self, result: xr.Dataset, found: xr.Dataset, ends: Sequence[End], rows: int) -> xr.Dataset:
        """Return the designs with how each was refined, best first; of a front those that none beats."""

        def added(name: str, values: Any, meaning: str, **attrs: Any) -> None:
            result[name] = (DESIGN,), values, {"long_name": meaning, "references": REFERENCE, **attrs}

        aims = [one for one in self.results if one.sign]
        for one in aims:
            before, after, of = found[one.name].values, result[one.name].values, result[one.name].attrs
            with np.errstate(invalid="ignore"):
                gain = one.sign * (before - after)
            meaning = f"Gain by refinement of: {of.get('long_name', one.name)}"
            added(f"{one.name}_{GAIN}", gain, meaning, units=of.get("units", "1"))
        outcomes = [one.descent.outcome for one in ends]
        flags = flag_attrs({int(one): one.meaning for one in Outcome}, "int8")
        added(REFINEMENT, np.array(outcomes, dtype=np.int8), "How the refinement ended", **flags)
        starts = np.array([one.starts for one in ends], dtype=np.int32)
        added(STARTS, starts, "Number of starts whose refinement ended in this design")
        active = np.array([self._active(one.descent) for one in ends], dtype=str)
        added(ACTIVE, active, "What holds the design back")
        result = labelled_missed(result.set_coords(ACTIVE), [self._missed(one.descent) for one in ends])
        points = np.stack([one.sign * result[one.name].values for one in aims], axis=1)
        order = np.argsort(points[:, 0], kind="stable") if len(aims) == 1 else nondominated(points)
        beaten, count = len(points) - len(order), int(starts.sum())
        some = f" from {count:,} of these" if count < rows else ""
        ended = f" to {counted(len(ends), 'different design')}" if len(ends) < count else ""
        endings = Counter(in_words(one.meaning) for one in outcomes)
        about = ", ".join(f"{n:,} {meaning}" for meaning, n in endings.items()) or "none"
        dropped = f"; {beaten:,} that others beat then are left out" if beaten else ""
        result = result.isel({DESIGN: order})
        result.attrs["selection"] = (
            f"{found.attrs.get('selection', '')}; refined{some}{ended}: {about}{dropped}"
        )
        return result

    def _missed(self, descent: Descent) -> str:
        """Return the limits that a design misses, and by how much."""
        texts = []
        for k in descent.missed:
            one = self.results[k]
            texts.append(missed_text(one, float(descent.values[k]), self.units.get(one.name, "1")))
        return ", ".join(texts)

    def _active(self, descent: Descent) -> str:
        """Return the limits that hold a design back."""
        held: list[tuple[Requirement | Span, int]]
        held = [(self.results[k], sign) for k, sign in sorted(descent.limits)]
        held += [(self.spans[j], sign) for j, sign in sorted(descent.ends)]
        texts = []
        for one, sign in held:
            limit = f"<= {short_number(one.high)}" if sign > 0 else f">= {short_number(one.low)}"
            limit = f"= {short_number(one.low)}" if one.low == one.high else limit
            units = self.units.get(one.name, "1")
            texts.append(f"{one.name} {limit}{'' if units == '1' else f' {units}'}")
        return ", ".join(dict.fromkeys(texts))


def _unmeasured(attrs: Mapping[Any, Any]) -> dict[Any, Any]:
    """Return the attributes of a result without the errors that were measured on other designs."""
    from fastlink.io.layout import MEASURED

    return {name: value for name, value in attrs.items() if not str(name).startswith(MEASURED)}
