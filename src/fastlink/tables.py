"""The functions of the input position, tabled once per sweep.

They are evaluated with 40 digits and rounded, so a table is the same on every machine, and what rounding
lost can be tabled beside it.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import mpmath
import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from fastlink.catalogue import Catalogue

__all__ = ["angle_tables"]

DIGITS = 40


def angle_tables(catalogue: Catalogue, names: Sequence[str], theta: NDArray[Any]) -> NDArray[Any]:
    """Return an array (names, positions) of the named tables at the given input positions."""
    theta = np.ascontiguousarray(theta, dtype=np.float64)
    table = np.empty((len(names), theta.size))
    for row, name in enumerate(names):
        if name == catalogue.position.name:
            table[row] = theta
        else:
            base = catalogue.table_low_parts.get(name, name)
            table[row] = _tabled(catalogue.tables[base].function, theta.tobytes())[int(base != name)]
    return table


@lru_cache(maxsize=64)
def _tabled(function: Any, theta: bytes) -> NDArray[Any]:
    with mpmath.workdps(DIGITS):
        exact = [function(mpmath.mpf(float(t))) for t in np.frombuffer(theta)]
        high = [float(value) for value in exact]
        return np.array([high, [float(value - h) for value, h in zip(exact, high, strict=True)]])
