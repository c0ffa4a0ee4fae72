"""Designs about a start as points of a unit cube: their results and derivatives, and whether their codes are right."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from fastlink.searching.spans import ON_A_LINE

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from fastlink.maps.conditions import Condition
    from fastlink.searching.model import Results
    from fastlink.searching.spans import Span

__all__ = ["Looked", "Points"]

#: Of its range, by which an input is moved where a derivative is taken by differences.
DIFFERENCE = 1e-6


@dataclass(frozen=True, eq=False)
class Looked:
    """A result or an input that a refinement looks at, with its aim and limits, or a code with its values."""

    name: str
    sign: float = 0.0
    low: float = -np.inf
    high: float = np.inf
    condition: Condition | None = None

    @property
    def is_code(self) -> bool:
        """Whether it must have one of some values."""
        return self.condition is not None


class Points:
    """The designs that can be reached from one start, as points: each input that may change runs from 0 to 1.

    Parameters
    ----------
    reader : Results
        What computes their results.
    looked : sequence of Looked
        What is looked at, the codes last.
    spans : sequence of Span
        The inputs that may change.
    start : array
        All inputs of the start.

    Attributes
    ----------
    begin : array
        The point of the start.
    """

    def __init__(
        self,
        reader: Results,
        looked: Sequence[Looked],
        spans: Sequence[Span],
        start: NDArray[np.float64],
    ) -> None:
        inputs = reader.inputs
        self.reader, self.start = reader, start
        self.leaders = [inputs.index(span.name) for span in spans]
        self.turns = np.zeros((len(inputs), len(spans)))
        for j, span in enumerate(spans):
            for name, slope in ((span.name, 1.0), *span.followers):
                self.turns[inputs.index(name), j] = slope
        own = start[self.leaders]
        spans = [span.about(x) for span, x in zip(spans, own, strict=True)]
        self.low, self.high = np.array([(span.low, span.high) for span in spans]).T
        width = self.high - self.low
        self.begin = np.divide(own - self.low, width, out=np.zeros(len(own)), where=width > 0.0)
        self.shown = [one for one in looked if not one.is_code]
        places = {name: k for k, name in enumerate(reader.names)}
        self.read = [(k, places[one.name]) for k, one in enumerate(self.shown) if one.name in places]
        self.own = [(k, inputs.index(one.name)) for k, one in enumerate(self.shown) if one.name not in places]
        self.codes = [(places[one.name], one.condition) for one in looked if one.is_code]
        self.periods = np.array([span.period for span in spans])

    @property
    def limits(self) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """The least and greatest values of the results, and their aims: 1 to be least, -1 greatest, 0 neither."""
        low, high, signs = np.array([(one.low, one.high, one.sign) for one in self.shown]).T
        return low, high, signs

    def place_of(self, design: NDArray[np.float64]) -> NDArray[np.float64] | None:
        """Return a design as a point, None of one that cannot be reached from this start."""
        own, turns = design[self.leaders], self.periods > 0.0
        own[turns] = self.low[turns] + (own[turns] - self.low[turns]) % self.periods[turns]
        width = self.high - self.low
        place = np.divide(own - self.low, width, out=np.zeros(len(own)), where=width > 0.0)
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
        found, counts = np.empty((len(points), len(self.shown))), np.ones(len(points), dtype=bool)
        for k, place in self.read:
            found[:, k] = read[:, place]
        for k, row in self.own:
            found[:, k] = designs[row]
        for place, condition in self.codes:
            assert condition is not None
            counts &= condition.holds(read[:, place])
        return found, counts

    def slopes(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the derivatives of the results, by differences where there are no others."""
        read = self.reader.slopes(self.designs(points))
        found = np.empty((len(points), len(self.shown), len(self.start)))
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
        moved = np.concatenate(
            [
                np.clip(points + sign * DIFFERENCE * np.eye(size)[j], 0.0, 1.0)
                for j in range(size)
                for sign in (1.0, -1.0)
            ]
        )
        values = self.values(moved)[0].reshape(size, 2, count, -1)
        steps = moved.reshape(size, 2, count, size)
        over = np.stack([steps[j, 0, :, j] - steps[j, 1, :, j] for j in range(size)])
        with np.errstate(all="ignore"):
            return np.moveaxis((values[:, 0] - values[:, 1]) / over[:, :, None], 0, 2)
