"""Table functions of the input position, once per sweep.

They are evaluated with 40 digits and rounded, so a table is the same on every machine, and its low parts can be tabled
beside it. Sines and cosines come from fixed-point numbers of as many digits, to the same bits; mpmath is used, and
imported, where a rounding of these is not certain or they lack a function.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink.numerics.fixed_point import Fixed, fixed

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from fastlink.catalogue.catalogue import Catalogue

__all__ = ["angle_tables"]

TABLE_DIGITS = 40
#: Up to so many angles are computed one by one: an array of Python's numbers costs 60 us and then 7 us for each.
FEW = 6


def angle_tables(catalogue: Catalogue, names: Sequence[str], theta: NDArray[Any]) -> NDArray[Any]:
    """Return an array (names, positions) of tables at the given input positions."""
    theta = np.ascontiguousarray(theta, dtype=np.float64)
    table = np.empty((len(names), theta.size))
    given = theta.tobytes()
    for row, name in enumerate(names):
        if name == catalogue.position.name:
            table[row] = theta
        else:
            base = catalogue.table_low_parts.get(name, name)
            table[row] = _tabled(catalogue.tables[base].function, given)[int(base != name)]
    return table


@lru_cache(maxsize=64)
def _tabled(function: Any, theta: bytes) -> NDArray[Any]:
    """Return a function at angles: rounded values, and their low parts."""
    angles = np.frombuffer(theta)
    words, sure = np.empty((2, angles.size)), np.zeros(angles.size, dtype=bool)
    try:
        for part, x, doubt in _fixed(theta):
            words[0, part], words[1, part], sure[part] = function(x).doubles(doubt)
    except (TypeError, AttributeError):
        pass  # a function that fixed-point numbers do not have
    if not sure.all():
        words[:, ~sure] = _by_mpmath(function, angles[~sure])
    return words


@lru_cache(maxsize=8)
def _fixed(theta: bytes) -> list[tuple[Any, Fixed, Any]]:
    """Return indices, angles in fixed point with their sines cached, and doubts."""
    angles = np.frombuffer(theta)
    if angles.size <= FEW:
        return [(k, *fixed(angle)) for k, angle in enumerate(angles.tolist())]
    return [(slice(None), *fixed(angles))]


def _by_mpmath(function: Any, angles: NDArray[Any]) -> NDArray[Any]:
    import mpmath

    with mpmath.workdps(TABLE_DIGITS):
        exact = [function(mpmath.mpf(angle)) for angle in angles.tolist()]
        high = [float(value) for value in exact]
        return np.array([high, [float(value - h) for value, h in zip(exact, high, strict=True)]])
