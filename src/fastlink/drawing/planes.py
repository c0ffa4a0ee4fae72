"""The planes in which mechanisms stand: their circles, and the light cones of the Minkowskian one."""

from __future__ import annotations

from typing import Any

import numpy as np

__all__ = ["PLANES", "Euclidean", "Minkowskian"]

#: Points along a circle, or an arm of one.
POINTS = 181
#: The greatest rapidity that a picture shows of a circle.
REACH = 4.0


class Euclidean:
    """The plane of the usual metric."""

    def circle(self, centre: Any, radius: float, view: Any) -> list[tuple[Any, bool]]:
        """Return the arms of a circle, as far as a view shows them, and whether each is the usual one."""
        size = float(np.hypot(view[1] - view[0], view[3] - view[2]))
        turn = np.linspace(0.0, 2.0 * np.pi, POINTS)
        if radius > size:  # of a great circle, only what is near the view
            middle = np.array([view[0] + view[1], view[2] + view[3]]) / 2.0 - centre
            turn = np.arctan2(middle[1], middle[0]) + np.linspace(-1.0, 1.0, POINTS) * 2.0 * size / radius
        return [(centre + radius * np.stack([np.cos(turn), np.sin(turn)], axis=-1), True)]

    def distance(self, vector: Any) -> Any:
        """Return the length of vectors."""
        return np.hypot(vector[..., 0], vector[..., 1])

    def curvature(self, slope: Any, bend: Any) -> Any:
        """Return the vector of curvature of a curve by its first two derivatives: along the normal."""
        across = np.stack([-slope[..., 1], slope[..., 0]], axis=-1)
        size = np.hypot(slope[..., 0], slope[..., 1])
        return ((across * bend).sum(axis=-1) / size**4)[..., None] * across

    def cone(self, apex: Any, reach: float) -> list[Any]:
        """Return the light lines through a point: none."""
        return []


class Minkowskian:
    """The plane of the metric x^2 - y^2."""

    def circle(self, centre: Any, radius: float, view: Any) -> list[tuple[Any, bool]]:
        """Return the two arms of a hyperbola, of future-pointing vectors and of past-pointing ones."""
        t = np.linspace(-REACH, REACH, POINTS)
        arm = radius * np.stack([np.cosh(t), np.sinh(t)], axis=-1)
        return [(centre + arm, True), (centre - arm, False)]

    def distance(self, vector: Any) -> Any:
        """Return the length of spacelike vectors."""
        x, y = vector[..., 0], vector[..., 1]
        return np.sqrt(np.abs(x - y)) * np.sqrt(np.abs(x + y))

    def curvature(self, slope: Any, bend: Any) -> Any:
        """Return the vector of curvature: along the line that is normal in the sense of the metric."""
        x, y = slope[..., 0], slope[..., 1]
        turn, norm = x * bend[..., 1] - y * bend[..., 0], (x - y) * (x + y)
        return (turn / (norm * np.abs(norm)))[..., None] * slope[..., ::-1]

    def cone(self, apex: Any, reach: float) -> list[Any]:
        """Return both light lines through a point."""
        return [apex + reach * np.array([[-1.0, -side], [1.0, side]]) for side in (1.0, -1.0)]


PLANES: dict[str, Euclidean | Minkowskian] = {"euclidean": Euclidean(), "minkowskian": Minkowskian()}
