"""Functions of the path of a point in the lanes: its distance from the best straight line, and from the best circle."""

from __future__ import annotations

from typing import Any

from fastlink.numerics.compiler import lanes, outlined
from fastlink.numerics.elementary import INFINITY, sqrt

#: Rows of the scratch: of lines the least width of a strip, its direction, extremes across it with the places along it
#: where they are, and a bracket of slopes with widths and their derivatives; a NaN of any point.
LEAST, COS, SIN, LOW, HIGH, AT_LOW, AT_HIGH, MISSING = range(8)
SLOPE_A, WIDTH_A, CHANGE_A, SLOPE_B, WIDTH_B, CHANGE_B, SLOPE, STEEP = range(8, 16)
#: Directions that are tried first, half a turn in all, and how far their neighbours are; passes of the exchange, of
#: which some are left for a second frame: five are enough for most curves.
DIRECTIONS, TURN_COS, TURN_SIN, NEIGHBOUR = 16, 0.9807852804032304, 0.19509032201612825, 0.25
PASSES = 8
ROWS = 16
#: Of circles: the centre, the sums of the normal equations, the radius, the greatest distance, a NaN of any point.
X0, Y0, XX, XY, YY, BX, BY, RADIUS, FAR, ABSENT = range(10)


@outlined
def _across(x: Any, y: Any, count: int, width: int, sums: Any) -> None:
    """Find the extremes across the direction with a slope, and where along it they are."""
    for i in lanes(width):
        sums[LOW, i] = INFINITY
        sums[HIGH, i] = -INFINITY
    for j in range(count):
        for i in lanes(width):
            dx, dy = x[j, i] - x[0, i], y[j, i] - y[0, i]
            along = sums[COS, i] * dx + sums[SIN, i] * dy
            off = (sums[COS, i] * dy - sums[SIN, i] * dx) - sums[SLOPE, i] * along
            below, above = off < sums[LOW, i], off > sums[HIGH, i]
            sums[AT_LOW, i] = along if below else sums[AT_LOW, i]
            sums[AT_HIGH, i] = along if above else sums[AT_HIGH, i]
            sums[LOW, i] = off if below else sums[LOW, i]
            sums[HIGH, i] = off if above else sums[HIGH, i]


@outlined
def _exchange(x: Any, y: Any, count: int, width: int, sums: Any) -> None:
    """Find the slope of the narrowest strip by the tangents of its width, which is convex, and turn the frame to it."""
    for i in lanes(width):
        sums[SLOPE, i] = -NEIGHBOUR
    _across(x, y, count, width, sums)
    for i in lanes(width):
        sums[SLOPE_A, i] = sums[SLOPE, i]
        sums[WIDTH_A, i] = sums[HIGH, i] - sums[LOW, i]
        sums[CHANGE_A, i] = sums[AT_LOW, i] - sums[AT_HIGH, i]
        sums[SLOPE, i] = NEIGHBOUR
    _across(x, y, count, width, sums)
    for i in lanes(width):
        sums[SLOPE_B, i] = sums[SLOPE, i]
        sums[WIDTH_B, i] = sums[HIGH, i] - sums[LOW, i]
        sums[CHANGE_B, i] = sums[AT_LOW, i] - sums[AT_HIGH, i]
    for _ in range(PASSES):
        for i in lanes(width):
            # where the tangents at both ends of the bracket meet
            a, b, steep = sums[SLOPE_A, i], sums[SLOPE_B, i], sums[CHANGE_A, i] - sums[CHANGE_B, i]
            rise = (sums[WIDTH_B, i] - sums[WIDTH_A, i]) - sums[CHANGE_B, i] * (b - a)
            meets = a + rise / steep
            inside = (steep < 0.0) & (meets > a) & (meets < b)
            sums[SLOPE, i] = meets if inside else (a if sums[WIDTH_A, i] < sums[WIDTH_B, i] else b)
        _across(x, y, count, width, sums)
        for i in lanes(width):
            wide, change = sums[HIGH, i] - sums[LOW, i], sums[AT_LOW, i] - sums[AT_HIGH, i]
            falls = change < 0.0
            sums[SLOPE_A, i] = sums[SLOPE, i] if falls else sums[SLOPE_A, i]
            sums[WIDTH_A, i] = wide if falls else sums[WIDTH_A, i]
            sums[CHANGE_A, i] = change if falls else sums[CHANGE_A, i]
            sums[SLOPE_B, i] = sums[SLOPE_B, i] if falls else sums[SLOPE, i]
            sums[WIDTH_B, i] = sums[WIDTH_B, i] if falls else wide
            sums[CHANGE_B, i] = sums[CHANGE_B, i] if falls else change
    for i in lanes(width):
        first = sums[WIDTH_A, i] < sums[WIDTH_B, i]
        slope, wide = (
            (sums[SLOPE_A, i] if first else sums[SLOPE_B, i]),
            (sums[WIDTH_A, i] if first else sums[WIDTH_B, i]),
        )
        size = sqrt(1.0 + slope * slope)
        cos, sin = sums[COS, i] / size, sums[SIN, i] / size
        sums[COS, i] = cos - slope * sin
        sums[SIN, i] = sin + slope * cos
        narrow = wide / size
        sums[LEAST, i] = narrow if narrow < sums[LEAST, i] else sums[LEAST, i]


@outlined
def straightness_lanes(x: Any, y: Any, result: Any, count: int, width: int, sums: Any) -> None:
    """Store half the width of the narrowest strip that holds all points; a lane with a NaN gives NaN.

    Some directions are tried, and from the best one the strip is narrowed until it touches three points.
    """
    for i in lanes(width):
        sums[LEAST, i] = INFINITY
        sums[MISSING, i] = 0.0
        sums[SLOPE, i] = 0.0
        sums[STEEP, i] = 1.0
        sums[SLOPE_A, i] = 0.0
    for j in range(count):
        for i in lanes(width):
            sums[MISSING, i] += 0.0 * (x[j, i] + y[j, i])
    for _ in range(DIRECTIONS):
        for i in lanes(width):
            cos, sin = sums[STEEP, i], sums[SLOPE_A, i]
            sums[STEEP, i] = cos * TURN_COS - sin * TURN_SIN
            sums[SLOPE_A, i] = sin * TURN_COS + cos * TURN_SIN
            sums[LOW, i] = INFINITY
            sums[HIGH, i] = -INFINITY
        for j in range(count):
            for i in lanes(width):
                off = sums[STEEP, i] * (y[j, i] - y[0, i]) - sums[SLOPE_A, i] * (x[j, i] - x[0, i])
                sums[LOW, i] = off if off < sums[LOW, i] else sums[LOW, i]
                sums[HIGH, i] = off if off > sums[HIGH, i] else sums[HIGH, i]
        for i in lanes(width):
            wide = sums[HIGH, i] - sums[LOW, i]
            better = wide < sums[LEAST, i]
            sums[LEAST, i] = wide if better else sums[LEAST, i]
            sums[COS, i] = sums[STEEP, i] if better else sums[COS, i]
            sums[SIN, i] = sums[SLOPE_A, i] if better else sums[SIN, i]
    _exchange(x, y, count, width, sums)
    _exchange(x, y, count, width, sums)
    for i in lanes(width):
        result[i] = 0.5 * sums[LEAST, i] + sums[MISSING, i]


@outlined
def roundness_lanes(x: Any, y: Any, result: Any, count: int, width: int, sums: Any) -> None:
    """Store the greatest distance of points from a circle about the centre of the algebraic fit (Kasa 1976).

    The radius is the mean of the distances from there. A lane with a NaN gives NaN.
    """
    for r in range(ABSENT + 1):
        for i in lanes(width):
            sums[r, i] = 0.0
    for j in range(count):
        for i in lanes(width):
            sums[X0, i] += (x[j, i] - x[0, i]) / count
            sums[Y0, i] += (y[j, i] - y[0, i]) / count
            sums[ABSENT, i] += 0.0 * (x[j, i] + y[j, i])
    for j in range(count):
        for i in lanes(width):
            dx, dy = (x[j, i] - x[0, i]) - sums[X0, i], (y[j, i] - y[0, i]) - sums[Y0, i]
            half_square = 0.5 * (dx * dx + dy * dy)
            sums[XX, i] += dx * dx
            sums[XY, i] += dx * dy
            sums[YY, i] += dy * dy
            sums[BX, i] += dx * half_square
            sums[BY, i] += dy * half_square
    for i in lanes(width):
        size = sums[XX, i] * sums[YY, i] - sums[XY, i] * sums[XY, i]
        sums[X0, i] += (sums[BX, i] * sums[YY, i] - sums[BY, i] * sums[XY, i]) / size
        sums[Y0, i] += (sums[BY, i] * sums[XX, i] - sums[BX, i] * sums[XY, i]) / size
    for j in range(count):
        for i in lanes(width):
            dx, dy = (x[j, i] - x[0, i]) - sums[X0, i], (y[j, i] - y[0, i]) - sums[Y0, i]
            sums[RADIUS, i] += sqrt(dx * dx + dy * dy) / count
    for j in range(count):
        for i in lanes(width):
            dx, dy = (x[j, i] - x[0, i]) - sums[X0, i], (y[j, i] - y[0, i]) - sums[Y0, i]
            off = abs(sqrt(dx * dx + dy * dy) - sums[RADIUS, i])
            sums[FAR, i] = off if off > sums[FAR, i] else sums[FAR, i]
    for i in lanes(width):
        result[i] = sums[FAR, i] + sums[ABSENT, i]
