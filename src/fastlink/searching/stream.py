"""Keep the best rows of a sweep that goes by block by block: memory does not grow with the number of designs."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fastlink.maps.best import least
from fastlink.maps.front import nondominated, strongest, unbeaten, undominated
from fastlink.space.design_space import BRANCH, DESIGN

if TYPE_CHECKING:
    from fastlink.engine.resolve import ResolvedSweep
    from fastlink.maps.best import Choice

__all__ = ["Kept", "Rows", "Stream"]

#: Rows that are compared with a front at once: to compare few takes as long as its own length.
MOST_WAITING = 1 << 17
#: Rows of a front with which each block is compared: each leaves less, and takes 20 us of a block of 4,096.
MOST_STRONG = 16


@dataclass
class Kept:
    """The best rows of some designs, and how many rows there were; that of several blocks in any order is the same.

    Attributes
    ----------
    rows : array of int64
        Their numbers.
    points : array (rows, objectives)
        Their objectives, to be as small as possible.
    designs : array of int64
        The number of designs by status.
    failed : array of int64
        For each condition, the number of rows that do not meet it.
    considered, not_numbers, infinite : int
        The rows that meet all conditions; those of them without numbers; those with infinite ones, which do not count.
    """

    rows: NDArray[np.int64]
    points: NDArray[np.float64]
    designs: NDArray[np.int64]
    failed: NDArray[np.int64]
    considered: int = 0
    not_numbers: int = 0
    infinite: int = 0

    def arrays(self) -> dict[str, Any]:
        """Return everything as arrays by name, as a file keeps them."""
        return {name: np.asarray(value) for name, value in vars(self).items()}

    @classmethod
    def of_arrays(cls, arrays: Mapping[str, Any]) -> Kept:
        """Return what `arrays` has given, perhaps flat."""
        numbers = ("considered", "not_numbers", "infinite")
        given: dict[str, Any] = {name: np.array(arrays[name]) for name in cls.__dataclass_fields__}
        given |= {name: int(given[name].item()) for name in numbers}
        if len(given["rows"]):
            given["points"] = given["points"].reshape(len(given["rows"]), -1)
        return cls(**given)


@dataclass(frozen=True)
class Rows:
    """The rows of a search: places along the designs and further dimensions, numbered in C order.

    Attributes
    ----------
    sizes : dict
        The further dimensions of objectives and conditions, and their lengths.
    """

    sizes: dict[str, int] = field(default_factory=dict)

    @property
    def of_design(self) -> int:
        """The rows of one design."""
        return math.prod(self.sizes.values())

    def places(self, rows: NDArray[np.int64]) -> tuple[NDArray[np.int64], dict[str, NDArray[np.int64]]]:
        """Return the designs of rows, and their places along each further dimension."""
        designs, inside = np.divmod(rows, self.of_design)
        along = np.unravel_index(inside, tuple(self.sizes.values())) if self.sizes else ()
        return designs, dict(zip(self.sizes, along, strict=True))


class Stream:
    """The reading of the blocks of a sweep.

    Parameters
    ----------
    resolved : ResolvedSweep
        The sweep.
    choice : Choice
        Which rows are the best, and what they must meet.
    along : dict
        The values of the coordinates of further dimensions.
    """

    def __init__(self, resolved: ResolvedSweep, choice: Choice, along: Mapping[str, NDArray[Any]]) -> None:
        self.resolved, self.choice, self.along = resolved, choice, along
        arrays = [*(one.array for one in choice.objectives), *(one.array for one in choice.wanted)]
        dims = dict.fromkeys(str(dim) for array in arrays for dim in array.dims if dim != DESIGN)
        self.lengths = resolved.lengths
        order = [dim for dim in (BRANCH, *along) if dim in dims]
        self.rows = Rows({dim: self.lengths[dim] for dim in order})
        self.names = list(dict.fromkeys(str(array.name) for array in arrays))
        outputs = {output.name: k for k, output in enumerate(resolved.plan.outputs)}
        self.outputs = {name: outputs[name] for name in self.names if name in outputs}
        self.inputs = [name for name in self.names if name in resolved.space.names]
        self.status = outputs["status"]
        self.several = len(choice.objectives) > 1
        #: Rows that are not compared with each other yet, and how many; rows of the front that beat most others.
        self.waiting: list[tuple[NDArray[np.int64], NDArray[np.float64]]] = []
        self.count, self.strongest = 0, np.empty((0, len(choice.objectives)))
        self.codes = max(resolved.catalogue.facts["status"].flags) + 1

    @property
    def searched(self) -> list[str]:
        """The names of the results that are looked at, as a sweep takes them."""
        return [name for name in self.outputs if name != "status"] or ["status"]

    def nothing(self) -> Kept:
        """Return what is kept of no rows."""
        empty = np.empty((0, len(self.choice.objectives)))
        counts = np.zeros(self.codes, dtype=np.int64), np.zeros(len(self.choice.wanted), dtype=np.int64)
        return Kept(np.empty(0, dtype=np.int64), empty, *counts)

    def read(self, start: int, stop: int, arrays: list[NDArray[Any]], into: Kept, known: Kept) -> None:
        """Add the results of consecutive designs to what is kept of a block; `known` is kept of others already."""
        count = stop - start
        whole = (count, *self.rows.sizes.values())
        values = self._values(start, stop, arrays)
        into.designs += np.bincount(arrays[self.status].reshape(-1), minlength=self.codes)
        inside = np.ones(whole, dtype=bool)
        for k, condition in enumerate(self.choice.wanted):
            holds = condition.holds(values[str(condition.array.name)])
            into.failed[k] += (holds.size - np.count_nonzero(holds)) * (inside.size // holds.size)
            inside &= holds
        places = np.flatnonzero(inside)
        into.considered += len(places)
        if not len(places):
            return
        points = np.empty((len(places), len(self.choice.objectives)))
        for k, one in enumerate(self.choice.objectives):
            own = np.broadcast_to(values[str(one.array.name)], whole).reshape(-1)
            np.multiply(own[places], one.sign, out=points[:, k])
        usable = np.isfinite(points).all(axis=1)
        if not usable.all():
            absent = np.isnan(points).any(axis=1)
            into.not_numbers += int(np.count_nonzero(absent))
            if self.choice.infinite:
                usable = ~absent
            else:
                into.infinite += int(np.count_nonzero(~usable & ~absent))
            places, points = places[usable], points[usable]
        self._add(into, start * self.rows.of_design + places, points, known)

    def _values(self, start: int, stop: int, arrays: list[NDArray[Any]]) -> dict[str, NDArray[Any]]:
        """Return what is looked at, with a length or 1 along each dimension of the rows."""
        lengths, found = self.lengths, dict[str, NDArray[Any]]()
        for name, k in self.outputs.items():
            axes = self.resolved.plan.outputs[k].axes
            shape = [lengths[dim] if dim in axes else 1 for dim in self.rows.sizes]
            found[name] = arrays[k].reshape(stop - start, *shape)
        if self.inputs:
            read = np.empty((len(self.inputs), stop - start))
            self.resolved.space.fill(self.inputs, start, stop, read)
            for name, row in zip(self.inputs, read, strict=True):
                found[name] = row.reshape(-1, *(1 for _ in self.rows.sizes))
        for name in self.names:
            if name not in found:
                shape = [lengths[dim] if dim == name else 1 for dim in self.rows.sizes]
                found[name] = self.along[name].reshape(1, *shape)
        return found

    def merge(self, one: Kept, other: Kept) -> None:
        """Add what is kept of other designs; rows of a front wait until they are many, see `settle`."""
        for name in ("designs", "failed", "considered", "not_numbers", "infinite"):
            setattr(one, name, getattr(one, name) + getattr(other, name))
        if len(other.rows):
            self.waiting.append((other.rows, other.points))
            self.count += len(other.rows)
        if self.count > (MOST_WAITING if self.several else 0):
            self.settle(one)

    def settle(self, kept: Kept) -> None:
        """Compare the rows that wait: of equal ones those with the least numbers stay."""
        if not self.waiting:
            return
        rows, points = (np.concatenate(parts) for parts in zip(*self.waiting, strict=True))
        self.waiting, self.count = [], 0
        if self.several:
            left = undominated(points, kept.points)
            rows, points = rows[left], points[left]
        rows, points = np.concatenate((kept.rows, rows)), np.concatenate((kept.points, points))
        order = np.argsort(rows, kind="stable")
        rows, points = rows[order], points[order]
        chosen = nondominated(points) if self.several else least(points[:, 0], self.choice.top)
        kept.rows, kept.points = rows[chosen], points[chosen]
        if self.several:
            self.strongest = strongest(kept.points, points, MOST_STRONG)

    def _add(self, into: Kept, rows: NDArray[np.int64], points: NDArray[np.float64], known: Kept) -> None:
        """Add rows that count, but for those that others beat for sure."""
        if self.several:
            first = unbeaten(points, self.strongest)
        else:
            best, top = known.points, self.choice.top
            near = np.flatnonzero(points[:, 0] <= best.max()) if len(best) >= top else np.arange(len(points))
            first = near[least(points[near, 0], top)]
        into.rows = np.concatenate((into.rows, rows[first]))
        into.points = np.concatenate((into.points, points[first]))

    def ordered(self, kept: Kept) -> Kept:
        """Return what was kept, the best row of the first objective first."""
        order = np.lexsort((kept.rows, *kept.points.T[::-1]))
        return replace(kept, rows=kept.rows[order], points=kept.points[order])
