"""The rows of a map as points in a plane: read block by block, one by one where they are few, else counted in cells."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink.maps.best import Objective, Reading
from fastlink.maps.conditions import Condition
from fastlink.maps.flags import flags_of
from fastlink.maps.rows import Rows
from fastlink.maps.units import DEGREE, RADIAN
from fastlink.plot.colours import drawable, limits_of
from fastlink.plot.labels import label_of

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["MOST_POINTS", "Cloud", "Column", "column_of"]

#: More rows than this are counted in cells.
MOST_POINTS = 100_000
CELLS = 140
#: A range that is so many times longer than that of its inner 96 % is cut; so many times greater, it is logarithmic.
FAR, WIDE = 5.0, 30.0


@dataclass
class Column:
    """A variable or input as an axis of a picture.

    Attributes
    ----------
    array : xarray.DataArray
        Its values.
    factor : float
        Into what is shown: of degrees, where angles are in degrees.
    low, high : float
        The range that is shown, of logarithms where `logarithmic`.
    logarithmic : bool
        Whether the scale is.
    """

    array: xr.DataArray
    factor: float = 1.0
    low: float = 0.0
    high: float = 1.0
    logarithmic: bool = False

    @property
    def flags(self) -> dict[str, int]:
        """The codes by their meanings."""
        return flags_of(self.array)

    def label(self, name: bool = True) -> str:
        """Return name, symbol and units."""
        in_degrees = self.array[:0] if self.array.ndim else self.array
        if self.factor != 1.0:
            in_degrees = in_degrees.copy(deep=False).assign_attrs(units=DEGREE)
        return label_of(in_degrees, name)

    def settle(self, values: Any) -> None:
        """Settle scale and range from some of the values."""
        if self.flags:
            self.low, self.high = min(self.flags.values()) - 0.5, max(self.flags.values()) + 0.5
            return
        if values.size and values.min() > 0.0:
            inner = np.percentile(values, (2, 98))
            self.logarithmic = bool(inner[1] > WIDE * inner[0])
        scaled = self.scaled(values)
        low, high, _ = limits_of(scaled, scaled, FAR)
        margin = 0.02 * (high - low)
        self.low, self.high = low - margin, high + margin

    def scaled(self, values: Any) -> Any:
        """Return values as they stand along the axis."""
        return np.log10(values) if self.logarithmic else values

    def edges(self, count: int = CELLS) -> Any:
        """Return the ends of cells along the axis, as values."""
        ends = np.linspace(self.low, self.high, count + 1)
        return 10.0**ends if self.logarithmic else ends

    def places(self, values: Any, count: int = CELLS) -> tuple[Any, Any]:
        """Return the cell of each value, and whether it has one."""
        with np.errstate(all="ignore"):
            share = (self.scaled(values) - self.low) / (self.high - self.low)
        inside = (share >= 0.0) & (share <= 1.0)
        return np.minimum((np.where(inside, share, 0.0) * count).astype(np.int64), count - 1), inside


@dataclass
class Cloud:
    """The rows of a map that meet some conditions and have a number in every column.

    Attributes
    ----------
    columns : list of Column
        What is read.
    wanted : list of Condition
        The conditions.
    points : array or None
        Rows and columns, if they are at most `MOST_POINTS`.
    count, considered : int
        How many are shown, and how many meet the conditions.
    left_out : Counter
        How many are not shown, by why.
    """

    columns: list[Column]
    wanted: Sequence[Condition]
    points: Any = None
    count: int = 0
    considered: int = 0
    left_out: Counter[str] = field(default_factory=Counter)
    names: Mapping[str, int] = field(init=False)

    def __post_init__(self) -> None:
        """Read all rows once: their number, scales and ranges."""
        self.names = {str(column.array.name): k for k, column in enumerate(self.columns)}
        held, kept, step = list[Any](), 0, 1
        reading = self._reading()
        for values in self._blocks(reading):
            self.count += len(values)
            held.append(values[::step])
            kept += len(held[-1])
            if kept > 2 * MOST_POINTS:
                held, step = [np.concatenate(held)[::2]], 2 * step
                kept = len(held[0])
        some = np.concatenate(held) if held else np.empty((0, len(self.columns)))
        for column, values in zip(self.columns, some.T, strict=True):
            column.settle(values)
        self.points = some if step == 1 and self.count <= MOST_POINTS else None
        self.considered, self.left_out = reading.considered, reading.left_out

    def _reading(self) -> Reading:
        arrays = [column.array for column in self.columns]
        rows = Rows.of([*arrays, *(one.array for one in self.wanted)])
        return Reading(rows, [Objective(array, 1.0) for array in arrays], list(self.wanted), False)

    def _blocks(self, reading: Reading) -> Iterator[Any]:
        factors = np.array([column.factor for column in self.columns])
        for _, values in reading:
            yield drawable(values) * factors

    def cells(self, wanted: Sequence[Sequence[str]]) -> list[tuple[Any, Any]]:
        """Return the rows in each cell of one column, or of the second and the first; sums of a third; all in one pass.

        Parameters
        ----------
        wanted : sequence of sequences of str
            One to three columns for each of the results.
        """
        columns = [[self.names[name] for name in names] for names in wanted]
        shapes = [(CELLS,) * len(over[:2]) for over in columns]
        found = [(np.zeros(CELLS ** len(shape)), np.zeros(CELLS ** len(shape))) for shape in shapes]
        used = sorted({k for over in columns for k in over[:2]})
        for values in [self.points] if self.points is not None else self._blocks(self._reading()):
            places = {k: self.columns[k].places(values[:, k]) for k in used}
            for over, shape, (counts, sums) in zip(columns, shapes, found, strict=True):
                own = [places[k] for k in over[:2]]
                inside = np.logical_and.reduce([one for _, one in own])
                flat = np.ravel_multi_index([cell[inside] for cell, _ in reversed(own)], shape)
                counts += np.bincount(flat, minlength=counts.size)
                for k in over[2:]:
                    sums += np.bincount(flat, values[inside, k], minlength=counts.size)
        return [
            (counts.reshape(shape), sums.reshape(shape))
            for shape, (counts, sums) in zip(shapes, found, strict=True)
        ]

    def below(self, name: str) -> tuple[Any, Any]:
        """Return values of a column, growing, and how many rows have at most that."""
        k = self.names[name]
        if self.points is not None:
            return np.sort(self.points[:, k]), np.arange(1, self.count + 1)
        edges = self.columns[k].edges()
        counts = np.zeros(len(edges))
        for values in self._blocks(self._reading()):
            counts += np.searchsorted(np.sort(values[:, k]), edges, side="right")
        return edges, counts

    def note(self) -> str:
        """Return how many rows are shown, and why others are not."""
        if self.count == self.considered:
            return f"{self.count:,} rows"
        others = ", ".join(f"{count:,} {why}" for why, count in self.left_out.items() if count)
        return f"{self.count:,} of {self.considered:,} rows, without {others}"


def column_of(maps: xr.Dataset, name: str, degrees: bool) -> Column:
    """Return a variable or an input as an axis."""
    array = maps[name]
    in_degrees = degrees and array.attrs.get("units") == RADIAN
    return Column(array, float(np.rad2deg(1.0)) if in_degrees else 1.0)
