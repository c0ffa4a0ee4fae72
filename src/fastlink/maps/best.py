"""Choose the best rows of a map, by one objective or by several, block by block."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from fastlink import errors
from fastlink._text import counted, joined, short_number, short_repr
from fastlink.errors import InputError, Pair, Problems, Setting, check_choice, check_switch, check_whole
from fastlink.io.checksums import pieces
from fastlink.io.where import SLACK, Range, form_of, in_units, named
from fastlink.maps.units import check_flags, flags_of
from fastlink.space.design_space import BRANCH, DESIGN
from fastlink.space.tables import STATUS
from fastlink.space.units import named_with_unit, split

# -- Conditions on the rows of a map: masks, meanings of a code, ranges of values


@dataclass(frozen=True)
class Condition:
    """A variable of which each row must have one of some codes, or a value from low to high, or one value."""

    array: xr.DataArray
    codes: tuple[int, ...] | None = None
    low: float = -math.inf
    high: float = math.inf

    def __str__(self) -> str:
        name = self.name
        if self.codes is not None:
            meanings = [meaning for meaning, code in flags_of(self.array).items() if code in self.codes]
            return f"{name} is {' or '.join(meanings)}"
        ends = [("=", self.low)] if self.is_target else [(">=", self.low), ("<=", self.high)]
        limits = [f"{sign} {short_number(end)}" for sign, end in ends if math.isfinite(end)]
        return f"{name} {' and '.join(limits)}" if limits else name

    @property
    def name(self) -> str:
        """The name of the variable."""
        return str(self.array.name)

    @property
    def is_limit(self) -> bool:
        """Whether it is of numbers, which may miss it by more or less."""
        return self.codes is None and self.array.dtype.kind != "b"

    @property
    def is_target(self) -> bool:
        """Whether it is one number that is to be met."""
        return self.is_limit and self.low == self.high

    def miss(self, values: NDArray[Any]) -> NDArray[np.float64]:
        """Return by how much numbers miss it, in sizes of its limits: 0 of what meets it, NaN of NaN."""
        size = max(map(abs, Range(self.low, self.high).ends), default=0.0) or 1.0
        off: NDArray[np.float64] = np.maximum(np.maximum(self.low - values, values - self.high), 0.0) / size
        return np.where(off <= SLACK, 0.0, off) if self.is_target else off

    def holds(self, values: NDArray[Any]) -> NDArray[np.bool_]:
        """Return where values meet it; NaN never does."""
        if self.codes is not None:
            first, *others = self.codes  # a third of the time of numpy.isin
            found: NDArray[np.bool_] = values == first
            for code in others:
                found |= values == code
            return found
        if self.array.dtype.kind == "b":
            return np.asarray(values, dtype=bool)
        return Range(self.low, self.high).holds(values, SLACK * abs(self.low) if self.is_target else 0.0)


def conditions(maps: xr.Dataset, where: Any) -> list[Condition]:
    """Return the conditions that a caller gives, or refuse them."""
    if where is None:
        return []
    if isinstance(where, str) or (isinstance(where, (list, tuple)) and where):
        if isinstance(where, str) and set("<>=") & set(where):
            remedy = "write a condition by name, such as {'a1': (None, 0.5)} or {'a1': ':0.5'}"
            raise InputError(f"{short_repr(where)} is no meaning of status", ("where",), remedy)
        if STATUS not in maps:
            what = "the map has no variable 'status'"
            raise InputError(what, ("where",), "give a mask, such as maps.a1 < 0.5")
        return [_of_code(maps[STATUS], ("where",), where)]
    if isinstance(where, Mapping) and not hasattr(where, "data_vars"):
        problems, made = Problems(), list[Condition]()
        for name, given in where.items():
            with problems.at():
                made.append(_of_name(maps, name, given))
                if sum(one.array.name == made[-1].array.name for one in made) > 1:
                    what = f"{made[-1].array.name} is given too"
                    raise InputError(what, ("where", str(name)), "write one of them")
        problems.stop()
        # of one branch alone, which is none of the axes that a search reads, it holds: others are refused
        return [one for one in made if one.array.name != BRANCH or one.array.ndim]
    if not isinstance(where, xr.DataArray) or where.dtype.kind != "b":
        remedy = (
            "write ranges such as {'a1': (None, 0.5)}, a meaning of status, or a mask such as maps.a1 < 0.5"
        )
        raise InputError(f"is {short_repr(where)}, not a mask", ("where",), remedy)
    for dim, length in where.sizes.items():
        check_along(where.name, str(dim), length, maps.sizes)
    return [Condition(where)]


def check_along(name: Any, dim: str, length: int, sizes: Mapping[Any, int]) -> None:
    """Refuse a condition that does not have the rows of a map along a dimension."""
    if sizes.get(dim) != length:
        what = f"{name or 'the mask'} has {length} along {dim!r}, the rows have {sizes.get(dim, 'no such dimension')}"
        raise InputError(what, ("where",), "give a mask made from the same map")


def _of_code(array: xr.DataArray, where: errors.KeyPath, meanings: Any) -> Condition:
    codes = check_flags(array, where, [meanings] if isinstance(meanings, str) else list(meanings))
    return Condition(array, tuple(codes))


def _of_name(maps: xr.Dataset, name: Any, given: Any) -> Condition:
    """Return the condition on one variable or input; the limits of NAME in a unit of its own as NAME_mm."""
    known = {str(one): array for one, array in maps.variables.items() if array.dtype.kind in "iuf"}
    key, factor, problems = "", None, Problems()
    with problems.at("where", str(name)):
        key, factor = named(known, name)
    problems.stop()
    array = maps[key or check_choice(("where",), name, list(known))]
    if flags_of(array) and isinstance(given, (str, list, tuple)):
        return _of_code(array, ("where", str(name)), given)
    if flags_of(array):
        what = f"{array.name} is a code, and given {short_repr(given)}"
        remedy = f"write one of its meanings, {', '.join(flags_of(array))}"
        raise InputError(what, ("where", str(name)), remedy)
    with problems.at("where", str(name)):
        of_unit = named_with_unit(str(name), given, shown=False)
        form = form_of(given, of_unit or ("write ", Pair(unlimited=True), ", or a number to be met"))
        limits = form if isinstance(form, Range) else Range(form, form)
        if limits.low == math.inf or limits.high == -math.inf:
            raise InputError("takes no finite number", remedy=("write ", Pair(unlimited=True)))
    problems.stop()
    limits = in_units(array, limits, "where", factor)
    if array.name == BRANCH and not ((array >= limits.low) & (array <= limits.high)).any():
        there = joined([str(one) for one in np.ravel(array.values)])
        raise InputError(
            f"here is branch {there} alone", ("where", BRANCH), "leave it out, or compute both branches"
        )
    return Condition(array, None, limits.low, limits.high)


# -- Rows of a map: the places along some dimensions, read block by block, so that a map may be larger than
#    memory


#: Rows that are read at once.
MOST_ROWS = 1 << 20
#: A block of which such a share of rows is wanted is read whole: to read one row costs as much as 1,000 in a row.
DENSE = 1e-3


@dataclass(frozen=True)
class Block:
    """Consecutive rows: where they are along the first dimensions, the number of the first, and how many."""

    index: tuple[int | slice, ...]
    first: int
    count: int


@dataclass(frozen=True)
class Rows:
    """The places along some dimensions of some sizes, numbered in C order."""

    sizes: dict[str, int]

    @classmethod
    def of(cls, arrays: Iterable[xr.DataArray]) -> Rows:
        """Return the places along all dimensions that some variables have, those of the greatest one first."""
        sizes: dict[str, int] = {}
        for array in sorted(arrays, key=lambda array: -array.ndim):
            sizes |= {str(dim): length for dim, length in array.sizes.items() if str(dim) not in sizes}
        return cls(sizes)

    @property
    def shape(self) -> tuple[int, ...]:
        """The length of each dimension."""
        return tuple(self.sizes.values())

    def blocks(self, most: int = 0) -> Iterator[Block]:
        """Yield all rows in consecutive pieces of about so many, MOST_ROWS unless given."""
        for index, first in pieces(self.shape, most or MOST_ROWS):
            lead = index[-1]
            assert isinstance(lead, slice)
            yield Block(index, first, (lead.stop - lead.start) * math.prod(self.shape[len(index) :]))

    def read(self, array: xr.DataArray, block: Block) -> NDArray[Any]:
        """Return the values of a variable in the rows of a block; it has some of the dimensions, or none."""
        parts = dict(zip(self.sizes, block.index, strict=False))  # the last dimensions are whole
        variable = array.variable[{dim: part for dim, part in parts.items() if dim in array.dims}].load()
        first, *others = (dim for dim in self.sizes if not isinstance(parts.get(dim), int))
        sizes = {dim: self.sizes[dim] for dim in others}
        sizes = {first: block.count // math.prod(sizes.values()), **sizes}
        whole = variable.set_dims(sizes)  # type: ignore[no-untyped-call]
        return np.asarray(whole.transpose(*sizes).values).reshape(-1)

    def taken(self, maps: xr.Dataset, flat: NDArray[np.int64]) -> xr.Dataset:
        """Return everything that a map says of some rows, along ``design``."""

        def of(array: xr.DataArray) -> Any:
            if not array.dims:
                return array.variable.copy(deep=False)
            return (DESIGN,), self._values(array, flat), dict(array.attrs)

        def of_them(arrays: Any) -> dict[Any, Any]:
            return {name: of(array) for name, array in arrays.items() if set(array.dims) <= self.sizes.keys()}

        return xr.Dataset(of_them(maps.data_vars), of_them(maps.coords), dict(maps.attrs))

    def _values(self, array: xr.DataArray, flat: NDArray[np.int64]) -> NDArray[Any]:
        """Return the values of a variable in some rows: one by one where they are few, else by blocks."""
        values = np.empty(len(flat), dtype=array.dtype)
        numbers = np.unravel_index(flat, self.shape)
        places = dict(zip(self.sizes, numbers, strict=True))
        if array.ndim == 1:
            return np.asarray(array.values)[places[str(array.dims[0])]]
        order = np.argsort(flat, kind="stable")
        ordered = flat[order]
        for block in self.blocks():
            start, stop = np.searchsorted(ordered, (block.first, block.first + block.count))
            if stop - start > DENSE * block.count:
                values[order[start:stop]] = self.read(array, block)[ordered[start:stop] - block.first]
                continue
            for row in order[start:stop]:
                values[row] = array.variable[{dim: int(places[str(dim)][row]) for dim in array.dims}].values
        return values


def numeric(maps: xr.Dataset) -> list[str]:
    """Return the variables and coordinates that have numbers along dimensions."""
    return [str(name) for name, array in maps.variables.items() if array.dtype.kind in "iuf" and array.ndim]


# -- The Pareto front: rows that no other row beats in every objective


#: Rows that are compared with each other at once.
CHUNK = 512
MOST_AT_ONCE = 1 << 14
#: A block is thinned by the rows of the front that beat most: in steps, as the first ones leave little.
STEPS = (4, 16, 64)
#: Rows of a block of which the first front is made.
SAMPLED = 4096


def nondominated(points: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return the rows that no other beats (nowhere greater, less somewhere), by growing values; of equal ones one."""
    order = np.lexsort(points.T[::-1])  # stable: equal rows by their places
    # no later row beats an earlier one, and what is before has the first objective no greater
    rest = points[order, 1:]
    if rest.shape[1] == 1:
        least = np.minimum.accumulate(rest[:, 0])
        return (
            order[np.flatnonzero(np.concatenate(([True], rest[1:, 0] < least[:-1])))] if len(order) else order
        )
    if rest.shape[1] == 2:
        return order[_above_stairs(rest)]
    kept = np.empty(0, dtype=np.int64)
    for start in range(0, len(rest), CHUNK):
        chunk = np.arange(start, min(start + CHUNK, len(rest)))
        for other in (*np.split(kept, range(MOST_AT_ONCE, len(kept), MOST_AT_ONCE)), chunk):
            before = (rest[other][:, None] <= rest[chunk][None]).all(axis=2)
            chunk = chunk[~(before & (other[:, None] < chunk[None])).any(axis=0)]
        kept = np.concatenate((kept, chunk))
    return order[kept]


def _above_stairs(rest: NDArray[np.float64]) -> list[int]:
    """Return the rows that none before them equals or betters in both columns.

    Those that none before beats are stairs, which fall in the second column where they grow in the first: one search
    among these tells of each row (Kung, Luccio and Preparata, On finding the maxima of a set of vectors, 1975).
    """
    kept, first, second = list[int](), [-math.inf], [math.inf]
    for row, (y, z) in enumerate(zip(*rest.T.tolist(), strict=True)):
        place = bisect_right(first, y)
        if second[place - 1] <= z and kept and place > 1:
            continue
        kept.append(row)
        last = place
        while last < len(second) and second[last] >= z:
            last += 1
        start = place - 1 if place > 1 and first[place - 1] == y else place
        first[start:last], second[start:last] = [y], [z]
    return kept


def undominated(points: NDArray[np.float64], front: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return rows, compared with the few that beat most, among which are all that neither others nor a front beat."""
    places = np.arange(len(points))
    if not len(points):
        return places
    some = points[:: -(-len(points) // SAMPLED)]
    known = np.concatenate((front, some))
    known = known[nondominated(known)]
    for count in STEPS:
        if not len(places):
            break
        places = places[unbeaten(points[places], strongest(known, points[places], count))]
    return places


def unbeaten(points: NDArray[np.float64], few: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return the rows that none of a few beats, which are taken one by one."""
    places = np.arange(len(points))
    for best in few:
        beaten = (points[places] >= best).all(axis=1) & (points[places] > best).any(axis=1)
        places = places[~beaten]
    return places


def strongest(front: NDArray[np.float64], points: NDArray[np.float64], count: int) -> NDArray[np.float64]:
    """Return the rows of a front that beat most, if points fill the box about them evenly."""
    with np.errstate(all="ignore"):
        high, low = points.max(axis=0), front.min(axis=0)
        shares = (high - front) / np.where(high > low, high - low, 1.0)
    beaten = np.prod(np.clip(np.nan_to_num(shares, nan=0.0), 0.0, 1.0), axis=1)
    best: NDArray[np.float64] = front[np.argsort(-beaten, kind="stable")[:count]]
    return best


DEFAULT_TOP = 10
#: What a refinement adds to a table of designs: how it ended, what holds each design back, what was gained, from how
#: many starts it was reached.
REFINEMENT, ACTIVE, GAIN, STARTS = "refinement", "active", "gain", "starts"
#: What is said of designs that do not meet all conditions: which ones, and by how much.
MISSED = "missed"
#: The remedy where no design meets all conditions.
WIDEN = "widen the conditions or the ranges, or search more designs"
#: So many rows that miss least are kept for each design that is wanted, to refine them.
NEAREST = 64


@dataclass(frozen=True)
class Objective:
    """A variable to be as small as possible, or as great where `sign` is -1."""

    array: xr.DataArray
    sign: float

    def __str__(self) -> str:
        return f"{'least' if self.sign > 0 else 'greatest'} {self.array.name}"


@dataclass(frozen=True)
class Choice:
    """Which rows are the best: by one objective the top ones, by several the front; whether infinite ones count."""

    objectives: list[Objective]
    wanted: list[Condition]
    top: int = DEFAULT_TOP
    infinite: bool = False
    #: How many of the rows that miss conditions least count where too few meet them.
    nearest: int = DEFAULT_TOP
    #: So many rows that meet all are enough.
    enough: int = 1

    def refined(self, rows: int) -> Choice:
        """Return the choice of so many rows, from which different designs are to be found."""
        if len(self.objectives) > 1:
            return self
        return replace(self, top=rows, nearest=NEAREST * self.top, enough=self.top)

    @property
    def arrays(self) -> list[xr.DataArray]:
        """The variables of objectives and conditions."""
        return [*(one.array for one in self.objectives), *(one.array for one in self.wanted)]

    @property
    def limits(self) -> list[Condition]:
        """The conditions that numbers may miss by more or less."""
        return [one for one in self.wanted if one.is_limit]


def choice_of(
    maps: xr.Dataset, minimise: Any, maximise: Any, where: Any, *, top: Any = None, infinite: Any = False
) -> Choice:
    """Return the choice of rows that a caller asks for, see `fastlink.best`, or refuse it."""
    problems = Problems()
    problems.attempt(check_switch, ("infinite",), infinite)
    sought = problems.attempt(_objectives, maps, minimise, maximise) or []
    wanted = problems.attempt(conditions, maps, where)
    with problems.at():
        if top is not None:
            check_whole(("top",), top, 1)
            if len(sought) > 1:
                what = f"is {top}, and the front of several objectives is whole"
                raise InputError(what, ("top",), "leave it out, or name one objective")
    problems.stop()
    top = top or DEFAULT_TOP
    return Choice(sought, wanted or [], top, bool(infinite), nearest=top)


@dataclass(frozen=True)
class Selection:
    """The numbers of the best rows of a map, the best first, and how they were selected."""

    rows: Rows
    places: NDArray[np.int64]
    about: str
    choice: Choice

    def of(self, maps: xr.Dataset) -> xr.Dataset:
        """Return everything that a map says of them, along ``design``."""
        found = self.rows.taken(maps, self.places)
        found.attrs["selection"] = self.about
        return with_missed(found, self.choice.limits)

    def only(self, numbers: Sequence[int]) -> Selection:
        """Return some of them, by their numbers among these."""
        return replace(self, places=self.places[list(numbers)])


def _objectives(maps: xr.Dataset, minimise: Any, maximise: Any) -> list[Objective]:
    """Return the objectives that a caller names, or refuse them."""
    problems, found = Problems(), list[Objective]()
    for where, given, sign in (("minimise", minimise, 1.0), ("maximise", maximise, -1.0)):
        names = listed(given)
        if not names and not isinstance(given, (list, tuple)):  # a list of none is one of a program's
            what = f"is {short_repr(given)}, and names nothing"
            problems.add(what, (where,), "write the name of a variable, or leave it out")
        for name in names:
            with problems.at():
                found.append(objective(maps, where, name, sign))
                if sum(known.array.name == name for known in found) > 1:
                    raise InputError(f"{name!r} is named twice", where=(where,), remedy="name it once")
    problems.stop()
    if not found:
        remedy = ("write ", Setting("minimise", "NAME"), " or ", Setting("maximise", "NAME"))
        raise InputError("there is no objective", ("minimise",), remedy)
    return found


def listed(given: Any) -> list[Any]:
    """Return the objectives that are given, one or several."""
    if isinstance(given, str):
        return [given]
    try:
        return list(given)
    except Exception:  # one value, or whatever a class of somebody's does
        return [given]


def objective(maps: xr.Dataset, where: str, name: Any, sign: float) -> Objective:
    """Return an objective by its name, or refuse it."""
    usable = [key for key in numeric(maps) if not flags_of(maps[key])]
    own = [key for key in usable if key in maps.data_vars]
    if isinstance(name, str) and (of := split(name, usable))[1]:
        raise InputError(f"{name!r} is ranked alike in any unit", (where,), f"write {of[0]!r}")
    if not own and name in maps.data_vars and not flags_of(maps[name]):
        raise InputError("ranks designs, and here is one alone", (where,), "sweep several values of an input")
    if not isinstance(name, str):
        remedy = "write the name of a variable; a new one is maps.assign(NAME=...)"
        raise InputError(f"is {short_repr(name)}", (where,), remedy)
    if name in maps.coords and not maps[name].ndim and not flags_of(maps[name]):
        remedy = f"rank by one that differs: {', '.join(own[:8])}"
        raise InputError(f"{short_repr(name)} is the same for all designs", (where,), remedy)
    if name in maps.variables and name not in usable:
        what = f"{short_repr(name)} is {'a code' if flags_of(maps[name]) else 'not a number for each design'}"
        numbers = f", and rank by a number: {', '.join(own[:8])}" if own else ""
        remedy = f"select by where={{{name!r}: 'MEANING'}}{numbers}"
        raise InputError(what, (where,), remedy)
    known = own or [str(key) for key in maps.data_vars]
    return Objective(maps[name if name in usable else check_choice((where,), name, known)], sign)


@dataclass(kw_only=True)
class Tally:
    """How many rows of a map or a sweep were considered, and why others do not count.

    Attributes
    ----------
    failed : array of int64
        For each condition, the number of rows that do not meet it.
    considered, not_numbers, infinite : int
        The rows that meet all conditions; those of them without numbers; those with infinite ones, which do not count.
    """

    failed: NDArray[np.int64]
    considered: int = 0
    not_numbers: int = 0
    infinite: int = 0

    def none_of(self, choice: Choice, size: int, noun: str = "row") -> str:
        """Return a text that none of so many rows counts, and why."""
        if not size:
            return f"there is no {noun}"
        failed = zip(choice.wanted, self.failed.tolist(), strict=True)
        reasons = [f"{count:,} fail {one.array.name or 'the mask'}" for one, count in failed if count]
        reasons += [f"{self.not_numbers:,} have no number"] if self.not_numbers else []
        reasons += [f"{self.infinite:,} are infinite"] if self.infinite else []
        return f"none of {counted(size, noun)} meets all conditions: {', '.join(reasons)}"

    def nothing_found(self, choice: Choice, size: int) -> InputError:
        """Return the error where none of so many rows counts, and none could by other numbers."""
        return InputError(self.none_of(choice, size), ("where",), WIDEN)

    @property
    def counting(self) -> int:
        """How many rows count: those that meet all conditions and have numbers."""
        return self.considered - self.not_numbers - self.infinite

    def usable(
        self, choice: Choice, shape: tuple[int, ...], values: Callable[[xr.DataArray], NDArray[Any]]
    ) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """Return the rows of a block that count and their objectives, to be as small as possible; count the others.

        `values` returns those of a variable in the rows, with the length of these or 1 along each dimension.
        """
        inside = np.ones(shape, dtype=bool)
        for k, condition in enumerate(choice.wanted):
            holds = condition.holds(values(condition.array))
            self.failed[k] += (holds.size - np.count_nonzero(holds)) * (inside.size // holds.size)
            inside &= holds
        places = np.flatnonzero(inside)
        self.considered += len(places)
        points = np.empty((len(places), len(choice.objectives)))
        if not len(places):
            return places, points
        for k, one in enumerate(choice.objectives):
            own = np.broadcast_to(values(one.array), shape).reshape(-1)
            np.multiply(own[places], one.sign, out=points[:, k])
        usable = np.isfinite(points).all(axis=1)
        if not usable.all():
            absent = np.isnan(points).any(axis=1)
            self.not_numbers += int(np.count_nonzero(absent))
            if choice.infinite:
                usable = ~absent
            else:
                self.infinite += int(np.count_nonzero(~usable & ~absent))
            places, points = places[usable], points[usable]
        return places, points

    def nearest(
        self, choice: Choice, shape: tuple[int, ...], values: Callable[[xr.DataArray], NDArray[Any]]
    ) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """Return the rows of a block that miss limits alone, those that miss least, and by how much in all."""
        missed = np.zeros(shape)
        for condition in choice.wanted:
            own = values(condition.array)
            missed = missed + (
                condition.miss(own) if condition.is_limit else np.where(condition.holds(own), 0.0, np.nan)
            )
        for one in choice.objectives:
            missed = missed + np.where(np.isfinite(values(one.array)), 0.0, np.nan)
        missed = np.broadcast_to(missed, shape).reshape(-1)
        places = np.flatnonzero(missed > 0.0)
        places = places[least(missed[places], choice.nearest)]
        return places, missed[places]


def with_missed(found: xr.Dataset, limits: Iterable[Condition]) -> xr.Dataset:
    """Return designs with a text of what each misses of limits; as they are where all meet them."""
    texts: list[list[str]] = [[] for _ in range(found.sizes.get(DESIGN, 0))]
    for one in limits:
        values = np.broadcast_to(found[one.name].values, len(texts))
        for text, value, miss in zip(texts, values, one.miss(values), strict=True):
            if miss > 0.0:
                text.append(missed_text(one, float(value), str(one.array.attrs.get("units", "1"))))
    return labelled_missed(found, list(map(", ".join, texts)))


def missed_text(one: Any, value: float, units: str) -> str:
    """Return by how much a value misses the limits `low` and `high` of what has a name."""
    low, high = one.low, one.high
    sign = "=" if low == high else ">=" if value < low else "<="
    end, off = (low, low - value) if value < low else (high, value - high)
    return (
        f"{one.name} {sign} {short_number(end)} by {short_number(off)}{'' if units == '1' else f' {units}'}"
    )


def labelled_missed(found: xr.Dataset, texts: list[str]) -> xr.Dataset:
    """Return designs with the texts of what each misses, where one misses anything."""
    attrs = {"long_name": "Conditions that are not met, and by how much"}
    return found.assign_coords({MISSED: ((DESIGN,), np.array(texts), attrs)}) if any(texts) else found


def remarked(found: xr.Dataset, remedy: str = WIDEN) -> xr.Dataset:
    """Return the designs that were found; a warning tells if none meets all conditions."""
    if MISSED in found.coords and (found[MISSED].values != "").all():
        what = f"{str(found.attrs['selection']).partition(';')[0]}; these miss least, by what 'missed' says"
        errors.remark(what, ("where",), remedy, errors.ResultWarning)
    return found


def merged_nearest(
    most: int, *kept: tuple[NDArray[np.int64], NDArray[np.float64]]
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Return the rows of several that miss least and by how much, the nearest first, of equal ones the first."""
    rows, missed = (np.concatenate(parts) for parts in zip(*kept, strict=True))
    order = np.lexsort((rows, missed))[:most]
    return rows[order], missed[order]


class Reading:
    """The rows of a map that count, block by block, and what is left out."""

    def __init__(self, rows: Rows, choice: Choice) -> None:
        self.rows, self.choice = rows, choice
        self.tally = Tally(failed=np.zeros(len(choice.wanted), dtype=np.int64))
        #: The rows that miss least, and by how much.
        self.nearest = np.empty(0, dtype=np.int64), np.empty(0)

    def __iter__(self) -> Any:
        """Yield the numbers of rows that count, and their objectives to be as small as possible."""
        for block in self.rows.blocks():
            read = partial(self.rows.read, block=block)
            places, points = self.tally.usable(self.choice, (block.count,), read)
            if self.choice.limits and self.tally.counting < self.choice.enough:
                near, missed = self.tally.nearest(self.choice, (block.count,), read)
                own = block.first + near, missed
                self.nearest = merged_nearest(self.choice.nearest, self.nearest, own)
            yield block.first + places, points

    def noted(self) -> str:
        """Return what was left out, to follow the number of those considered."""
        counts = (self.tally.not_numbers, "not a number"), (self.tally.infinite, "infinite")
        parts = [f"{count:,} {kind}" for count, kind in counts if count]
        return f", without {', '.join(parts)}" if parts else ""


def kept_of(points: NDArray[np.float64], top: int) -> NDArray[np.int64]:
    """Return the rows that stay: the front of several objectives, of one the least, by growing place."""
    return nondominated(points) if points.shape[1] > 1 else least(points[:, 0], top)


def chosen(choice: Choice) -> Selection:
    """Return the best rows of a map, see `fastlink.best`, which are read block by block."""
    sought, rows = choice.objectives, Rows.of(choice.arrays)
    reading = Reading(rows, choice)
    places, kept = np.empty(0, dtype=np.int64), np.empty((0, len(sought)))
    for further, points in reading:
        if len(sought) > 1:
            left = undominated(points, kept)
            further, points = further[left], points[left]
        places, kept = np.concatenate((places, further)), np.concatenate((kept, points))
        again = kept_of(kept, choice.top)
        places, kept = places[again], kept[again]
    considered = f"of {reading.tally.considered:,}"
    near, _ = reading.nearest
    if not len(places) and not len(near):
        raise reading.tally.nothing_found(choice, math.prod(rows.shape))
    if not len(places):
        about = f"{reading.tally.none_of(choice, math.prod(rows.shape))}; the nearest ones"
        return Selection(rows, near, about + reading.noted(), choice)
    near = near[: choice.nearest if len(places) < choice.enough else 0]
    if len(sought) > 1:
        about = f"the front of {len(places):,} {considered} rows by the {joined(list(map(str, sought)))}"
    else:
        places = places[np.lexsort((places, kept[:, 0]))]
        word = "least" if sought[0].sign > 0 else "greatest"
        about = f"{len(places)} {word} {considered} values of {sought[0].array.name}"
        about += f", {len(near)} that miss conditions least" if len(near) else ""
    return Selection(rows, np.concatenate((places, near)), about + reading.noted(), choice)


def least(values: NDArray[np.float64], n: int) -> NDArray[np.int64]:
    """Return the places of the n least values by growing place; of equal values the first."""
    if len(values) <= n:
        return np.arange(len(values))
    bound = np.partition(values, n - 1)[n - 1]
    below = np.flatnonzero(values < bound)
    equal = np.flatnonzero(values == bound)[: n - len(below)]
    return np.sort(np.concatenate((below, equal)))


# -- Rank the rows of a map by one variable


def top(maps: xr.Dataset, n: int, by: str, *, largest: bool, where: Any, infinite: bool) -> xr.Dataset:
    """Return the rows of a map with the greatest or least values of one variable; see `MapAccessor.top`."""
    n = check_whole(("n",), n, 1)
    check_switch(("largest",), largest)
    check_switch(("infinite",), infinite)
    key = objective(maps, "by", by, -1.0 if largest else 1.0)
    wanted = conditions(maps, where)
    for condition in wanted:
        for dim, length in condition.array.sizes.items():
            check_along(condition.array.name, str(dim), length, key.array.sizes)
    return remarked(chosen(Choice([key], wanted, n, infinite, nearest=n)).of(maps))
