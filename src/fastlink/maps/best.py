"""Choose the best rows of a map, by one objective or by several, block by block."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from fastlink._text import joined, short_repr
from fastlink.errors import InputError, Problems, Setting
from fastlink.maps.conditions import Condition, conditions
from fastlink.maps.flags import flags_of
from fastlink.maps.front import nondominated, undominated
from fastlink.maps.rows import Rows, numeric
from fastlink.options import check_choice, check_switch, check_whole

__all__ = [
    *(
        "ACTIVE",
        "GAIN",
        "REFINEMENT",
        "STARTS",
        "Choice",
        "Objective",
        "Selection",
        "choice_of",
        "chosen",
        "least",
        "listed",
    ),
    *("objective", "ranked"),
]

DEFAULT_TOP = 10
#: What a refinement adds to a table of designs: how it ended, what holds each design back, what was gained, from how
#: many starts it was reached.
REFINEMENT, ACTIVE, GAIN, STARTS = "refinement", "active", "gain", "starts"
NOT_A_NUMBER, INFINITE = "not a number", "infinite"


@dataclass(frozen=True)
class Objective:
    """A variable to be as small as possible, or as great where `sign` is -1."""

    array: xr.DataArray
    sign: float

    def __str__(self) -> str:
        return f"{'least' if self.sign > 0 else 'greatest'} {self.array.name}"


@dataclass(frozen=True)
class Choice:
    """Which rows of a map are the best.

    Attributes
    ----------
    objectives : list of Objective
        One, by which rows are ranked, or several, of which the front is.
    wanted : list of Condition
        What the rows must meet.
    top : int
        How many rows, of one objective.
    infinite : bool
        Whether infinite objectives count.
    """

    objectives: list[Objective]
    wanted: list[Condition]
    top: int = DEFAULT_TOP
    infinite: bool = False


def choice_of(
    maps: xr.Dataset, minimise: Any, maximise: Any, where: Any, *, top: Any = None, infinite: Any = False
) -> Choice:
    """Return the choice of rows that a caller asks for, see `fastlink.best`, or refuse it."""
    problems, wanted, sought = Problems(), list[Condition](), list[Objective]()
    with problems.at():
        check_switch(("infinite",), infinite)
    with problems.at():
        sought = _objectives(maps, minimise, maximise)
    with problems.at():
        wanted = conditions(maps, where)
    with problems.at():
        if top is not None:
            check_whole(("top",), top, 1)
            if len(sought) > 1:
                what = f"is {top}, and the front of several objectives is whole"
                raise InputError(what, where=("top",), remedy="leave it out, or name one objective")
    problems.stop()
    return Choice(sought, wanted, top or DEFAULT_TOP, bool(infinite))


@dataclass(frozen=True)
class Selection:
    """The best rows of a map, the best first, and what was left out.

    Attributes
    ----------
    rows : Rows
        All rows.
    places : array of int64
        The numbers of those that are selected.
    about : str
        How they were.
    """

    rows: Rows
    places: NDArray[np.int64]
    about: str

    def of(self, maps: xr.Dataset) -> xr.Dataset:
        """Return everything that a map says of them, along ``design``."""
        found = self.rows.taken(maps, self.places)
        found.attrs["selection"] = self.about
        return found

    def only(self, numbers: Sequence[int]) -> Selection:
        """Return some of them, by their numbers among these."""
        return replace(self, places=self.places[list(numbers)])


def chosen(maps: xr.Dataset, choice: Choice) -> Selection:
    """Return the best rows of a map, see `fastlink.best`; it is read block by block."""
    sought, wanted, infinite = choice.objectives, choice.wanted, choice.infinite
    rows = Rows.of([*(one.array for one in sought), *(one.array for one in wanted)])
    if len(sought) == 1:
        return ranked(rows, sought[0], wanted, top=choice.top, infinite=infinite)
    return _front(rows, sought, wanted, infinite=infinite)


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
        raise InputError("there is no objective", where=("best",), remedy=remedy)
    return found


def listed(given: Any) -> list[Any]:
    """Return the objectives that are given, one or several."""
    one = isinstance(given, str) or not isinstance(given, Iterable) or getattr(given, "ndim", 1) == 0
    return [given] if one else list(given)


def objective(maps: xr.Dataset, where: str, name: Any, sign: float) -> Objective:
    """Return an objective by its name, or refuse it."""
    usable = [key for key in numeric(maps) if not flags_of(maps[key])]
    own = [key for key in usable if key in maps.data_vars]
    if not isinstance(name, str):
        remedy = "write the name of a variable; a new one is maps.assign(NAME=...)"
        raise InputError(f"is {short_repr(name)}", where=(where,), remedy=remedy)
    if name in maps.variables and name not in usable:
        what = f"{short_repr(name)} is {'a code' if flags_of(maps[name]) else 'not a number for each design'}"
        remedy = f"select by where='MEANING', and rank by a number: {', '.join(own[:8])}"
        raise InputError(what, where=(where,), remedy=remedy)
    return Objective(maps[name if name in usable else check_choice((where,), name, own)], sign)


@dataclass
class Reading:
    """The rows that are considered, block by block, and what is left out."""

    rows: Rows
    objectives: list[Objective]
    conditions: list[Condition]
    infinite: bool
    considered: int = 0
    left_out: Counter[str] = field(default_factory=Counter)

    def __iter__(self) -> Any:
        """Yield the numbers of rows that count, and their objectives to be as small as possible."""
        for block in self.rows.blocks():
            inside = np.ones(block.count, dtype=bool)
            for condition in self.conditions:
                inside &= condition.holds(self.rows.read(condition.array, block))
            places = np.flatnonzero(inside)
            read = [
                one.sign * self.rows.read(one.array, block)[places].astype(float) for one in self.objectives
            ]
            points = np.stack(read, axis=1)
            absent = np.isnan(points).any(axis=1)
            boundless = np.isinf(points).any(axis=1) & ~absent & (not self.infinite)
            self.considered += len(places)
            self.left_out[NOT_A_NUMBER] += int(absent.sum())
            self.left_out[INFINITE] += int(boundless.sum())
            usable = ~absent & ~boundless
            yield block.first + places[usable], points[usable]

    def noted(self) -> str:
        """Return what was left out, to follow the number of those considered."""
        parts = [f"{count:,} {kind}" for kind, count in self.left_out.items() if count]
        return f", without {', '.join(parts)}" if parts else ""


def ranked(rows: Rows, one: Objective, wanted: list[Condition], *, top: int, infinite: bool) -> Selection:
    """Return the rows with the least or greatest values of one objective."""
    reading = Reading(rows, [one], wanted, infinite)
    chosen, kept = np.empty(0, dtype=np.int64), np.empty(0)
    for places, points in reading:
        chosen, kept = np.concatenate((chosen, places)), np.concatenate((kept, points[:, 0]))
        again = least(kept, top)
        chosen, kept = chosen[again], kept[again]
    word = "least" if one.sign > 0 else "greatest"
    about = f"{len(chosen)} {word} of {reading.considered:,} values of {one.array.name}"
    return Selection(rows, chosen[np.lexsort((chosen, kept))], about + reading.noted())


def least(values: NDArray[np.float64], n: int) -> NDArray[np.int64]:
    """Return the places of the n least values by growing place; of equal values the first."""
    if len(values) <= n:
        return np.arange(len(values))
    bound = np.partition(values, n - 1)[n - 1]
    below = np.flatnonzero(values < bound)
    equal = np.flatnonzero(values == bound)[: n - len(below)]
    return np.sort(np.concatenate((below, equal)))


def _front(rows: Rows, sought: list[Objective], wanted: list[Condition], *, infinite: bool) -> Selection:
    """Return the rows that no other row beats."""
    reading = Reading(rows, sought, wanted, infinite)
    chosen, front = np.empty(0, dtype=np.int64), np.empty((0, len(sought)))
    for places, points in reading:
        left = undominated(points, front)
        chosen, front = np.concatenate((chosen, places[left])), np.concatenate((front, points[left]))
        again = nondominated(front)
        chosen, front = chosen[again], front[again]
    about = (
        f"the front of {len(chosen):,} of {reading.considered:,} rows by the {joined(list(map(str, sought)))}"
    )
    return Selection(rows, chosen, about + reading.noted())
