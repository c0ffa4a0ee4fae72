"""The inputs that a refinement may change: their ranges in a map, and those that follow others."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink._text import short_repr
from fastlink.errors import InputError, Problems, listed
from fastlink.maps.units import check_units
from fastlink.space.column import bounds_of, steps
from fastlink.space.design_space import DESIGN

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import NDArray

    from fastlink.catalogue.catalogue import Catalogue, Input
    from fastlink.maps.conditions import Condition
    from fastlink.space.design_space import DesignSpace

__all__ = ["ON_A_LINE", "Span", "spans_of", "spans_of_space", "swept_inputs", "within"]

#: Rows of a table in which inputs are compared; how far from a line two of them may be, of their size.
MOST_COMPARED = 1 << 20
ON_A_LINE = 1e-12


@dataclass(frozen=True)
class Span:
    """An input that may change, from one end to the other.

    Attributes
    ----------
    name : str
        The input.
    low, high : float
        Its ends, which belong to it.
    followers : tuple of (name, slope)
        The inputs that change with it, and by how much.
    period : float
        Of an input position that goes all around: a turn; 0 of what has ends.
    """

    name: str
    low: float
    high: float
    followers: tuple[tuple[str, float], ...] = ()
    period: float = 0.0

    def about(self, value: float) -> Span:
        """Return the range from a start, which belongs to it: of what goes all around, half a turn to both sides."""
        if self.period:
            return replace(self, low=value - self.period / 2.0, high=value + self.period / 2.0)
        return replace(self, low=min(self.low, value), high=max(self.high, value))


def swept_inputs(catalogue: Catalogue, maps: xr.Dataset) -> dict[str, Input]:
    """Return the inputs that are not the same for all designs of a map, and are no codes."""
    known = catalogue.known_inputs(catalogue.variant_inputs)
    return {
        name: declared
        for name, declared in known.items()
        if name in maps.variables and maps[name].ndim == 1 and not declared.choices
    }


def spans_of(catalogue: Catalogue, maps: xr.Dataset, only: Sequence[str] = ()) -> list[Span]:
    """Return the inputs of a map that may change, with their ranges in it.

    Of a sample the ranges are those that it was drawn from. Inputs of a table that change together with another one,
    along a straight line, follow it.

    Parameters
    ----------
    catalogue : Catalogue
        The mechanism.
    maps : xarray.Dataset
        The map.
    only : sequence of str
        The inputs that may change; all that are swept unless given.
    """
    swept, problems = swept_inputs(catalogue, maps), Problems()
    check_only(only, list(swept), problems)
    for name, declared in swept.items():
        with problems.at():
            check_units(maps[name], declared.units, ("refine", name))
    problems.stop()
    drawn = dict(_drawn(str(maps.attrs.get("design_ranges", ""))))
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
    only: Sequence[str] = (),
) -> list[Span]:
    """Return the inputs of a design space that may change, within given ranges or else those of the space."""
    known = catalogue.known_inputs(catalogue.variant_inputs)
    given = {**space.axes, **space.columns}
    swept = [name for name in given if not known[name].choices]
    problems = Problems()
    check_only(only, swept, problems)
    check_only(bounds, swept, problems, "bounds")
    problems.stop()
    ends = {name: bounds.get(name) or bounds_of(given[name]) for name in only or swept}
    return _spans(ends, {} if space.kind != "table" else {n: given[n] for n in ends if n in space.columns})


def check_only(names: Iterable[str], swept: Sequence[str], problems: Problems, where: str = "refine") -> None:
    """Note names that are not inputs which are swept."""
    for name in names:
        if name not in swept:
            problems.add(f"{short_repr(name)} is not an input that is swept", (where,), listed(list(swept)))


def _spans(ends: Mapping[str, tuple[float, float]], tabled: Mapping[str, Any]) -> list[Span]:
    """Return the inputs with these ends, some of which are columns of a table, where others may follow them."""
    spans = _with_followers(
        tabled, [Span(name, low, high) for name, (low, high) in ends.items() if low < high]
    )
    if not spans:
        remedy = "sweep the inputs that may change, such as a2=(1.0, 1.4) of fl.sobol"
        raise InputError("there is no input that may change", where=("refine",), remedy=remedy)
    return spans


def within(spans: Iterable[Span], wanted: Iterable[Condition]) -> list[Span]:
    """Return inputs with the ends that conditions leave them."""
    ends = {one.array.name: (one.low, one.high) for one in wanted if one.array.dtype.kind == "f"}
    return [
        replace(one, low=max(one.low, ends[one.name][0]), high=min(one.high, ends[one.name][1]), period=0.0)
        if one.name in ends
        else one
        for one in spans
    ]


def _drawn(text: str) -> Iterable[tuple[str, tuple[float, float]]]:
    """Yield the ranges that a sample was drawn from, of the attribute ``design_ranges`` of its map."""
    for name, low, high in re.findall(r"(\w+)=\(([^,()]+), ([^,()]+)\)", text):
        yield name, (float(low), float(high))


def _pieces(array: xr.DataArray) -> Iterable[NDArray[np.float64]]:
    for start, stop in steps(0, array.size):
        yield np.asarray(array.variable[start:stop].values, dtype=np.float64)


def _ends(array: xr.DataArray) -> tuple[float, float]:
    """Return the least and greatest number of an input, read piece by piece."""
    low, high = np.inf, -np.inf
    for values in _pieces(array):
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
