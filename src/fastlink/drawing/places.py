"""Find places for names where they cover nothing: among a few round each point, the freest."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np

__all__ = ["Names", "samples_of"]

#: In points: the size of a letter, the distance of a name from its point, the step along what must not be covered.
LETTER, HEIGHT, AWAY, STEP = 5.6, 12.0, 12.0, 3.0
ROUND = np.pi / 8.0 * np.arange(16)
#: Where a name stands best if all places are free: above to the right.
BEST, PREFERENCE, STAY = np.pi / 4.0, 0.15, 0.6
#: How much farther away a name may stand where that is free, and what it costs.
FURTHER, FARTHER = 6.0, 3.0
NEAR, OUTSIDE = 1.7, 6.0


def samples_of(line: Any, scale: float) -> Any:
    """Return points along a broken line, close to each other in the picture; `scale` is points per unit."""
    line = np.asarray(line, dtype=float)
    line = line[np.isfinite(line).all(axis=-1)]
    pieces = [line]
    for start, end in itertools.pairwise(line):
        count = min(400, int(np.hypot(*(end - start)) * scale / STEP))
        if count > 1:
            share = np.linspace(0.0, 1.0, count)[:, None]
            pieces.append(start + share * (end - start))
    return np.concatenate(pieces) if line.size else np.empty((0, 2))


class Names:
    """The names of one picture, placed one after the other.

    Parameters
    ----------
    scale : float
        Points of the page per unit of length.
    view : sequence of float
        The least and greatest x, the least and greatest y that are shown.
    """

    def __init__(self, scale: float, view: Any) -> None:
        self.scale, self.view = scale, np.asarray(view, dtype=float)
        self.last: dict[str, int] = {}
        self.clear()

    def clear(self) -> None:
        """Forget what must not be covered, but not where names stood, so that they move little."""
        self.cloud = np.empty((0, 2))
        self.weights = np.empty(0)

    def keep_free(self, points: Any, weight: float = 1.0) -> None:
        """Add points that names should not cover."""
        points = np.asarray(points, dtype=float).reshape(-1, 2)
        points = points[np.isfinite(points).all(axis=1)]
        self.cloud = np.concatenate([self.cloud, points])
        self.weights = np.concatenate([self.weights, np.full(len(points), weight)])

    def place(self, key: str, text: str, anchor: Any, away: float = AWAY) -> Any:
        """Return where the middle of a name stands that belongs to a point."""
        wide = 0.5 * LETTER * len(text)
        rounds = [
            np.stack([(one + wide - LETTER) * np.cos(ROUND), one * np.sin(ROUND)], axis=-1)
            for one in (away, away + FURTHER)
        ]
        farther = np.repeat([0.0, FARTHER], len(ROUND))
        middles = np.asarray(anchor) + np.concatenate(rounds) / self.scale
        return self._best(key, wide, middles, np.tile(ROUND, 2), farther)

    def beside(self, key: str, text: str, start: Any, end: Any, away: float = AWAY) -> Any:
        """Return where the middle of a name stands that belongs to a bar."""
        start, end = np.asarray(start), np.asarray(end)
        along = end - start
        length = float(np.hypot(*along)) or 1.0
        normal = np.array([-along[1], along[0]]) / length
        wide = 0.5 * LETTER * len(text)
        off = away + max(0.0, wide - LETTER) * abs(normal[0])
        shares = np.array([0.5, 0.5, 0.38, 0.38, 0.62, 0.62])
        sides = np.array([1.0, -1.0] * 3)
        middles = start + shares[:, None] * along + (sides * off / self.scale)[:, None] * normal
        return self._best(key, wide, middles, BEST + 0.3 * np.arange(6))

    def _best(self, key: str, wide: float, middles: Any, angles: Any, farther: Any = 0.0) -> Any:
        """Return the freest of some places, and keep it free from now on."""
        half = np.array([wide + 2.0, 0.5 * HEIGHT + 1.0]) / self.scale
        cost = PREFERENCE * (1.0 - np.cos(angles - BEST)) + farther
        if key in self.last:
            cost += STAY * (np.arange(len(middles)) != self.last[key])
        if len(self.cloud):
            gaps = np.abs(self.cloud[None] - middles[:, None]) / half
            cost = cost + np.maximum(0.0, NEAR - gaps.max(axis=-1)) ** 2 @ self.weights
        low, high = self.view[::2], self.view[1::2]
        beyond = (middles - half < low) | (middles + half > high)
        cost = cost + OUTSIDE * beyond.any(axis=1)
        chosen = int(np.argmin(cost))
        self.last[key] = chosen
        box = np.stack(np.meshgrid(np.linspace(-1, 1, 7), np.linspace(-1, 1, 3)), axis=-1).reshape(-1, 2)
        self.keep_free(middles[chosen] + box * half, 2.0)
        return middles[chosen]
