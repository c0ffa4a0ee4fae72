"""Bring the values of many designs to one for each cell of a picture: their mean, the least or the greatest."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["ONE", "POOLS", "pooled"]

#: The word for a picture that shows one design of each cell.
ONE = "one"
#: Values that are read at once.
BLOCK = 1 << 21


def _mean(cells: NDArray[Any]) -> NDArray[Any]:
    """Return the mean of the finite values; where there is none, infinity if a value is infinite, else NaN."""
    finite = np.isfinite(cells)
    count = finite.sum(axis=(1, 3))
    with np.errstate(invalid="ignore"):
        mean = np.where(finite, cells, 0.0).sum(axis=(1, 3)) / count
    return np.asarray(np.where(count > 0, mean, np.fmax.reduce(cells, axis=(1, 3))))


#: What becomes of a cell, of an array whose second and fourth axis are the values of one; NaN counts in none.
POOLS: dict[str, Callable[[NDArray[Any]], NDArray[Any]]] = {
    "mean": _mean,
    "least": lambda cells: np.fmin.reduce(cells, axis=(1, 3)),
    "greatest": lambda cells: np.fmax.reduce(cells, axis=(1, 3)),
}


def pooled(
    read: Callable[[slice], NDArray[Any]], rows: range, columns: int, steps: tuple[int, int], pool: str
) -> NDArray[np.float32]:
    """Return one value for each cell of rows and columns, read a few rows at a time.

    Parameters
    ----------
    read : callable
        Returns the values of some rows.
    rows : range
        The rows.
    columns : int
        How many values a row has.
    steps : (int, int)
        How many rows and columns make a cell; the last ones may have fewer.
    pool : str
        A key of `POOLS`.
    """
    down, across = steps
    high = max(1, BLOCK // (down * columns)) * down
    found = []
    for start in range(rows.start, rows.stop, high):
        block = np.asarray(read(slice(start, min(rows.stop, start + high))), dtype=float)
        beyond = (-block.shape[0] % down, -columns % across)
        padded = np.pad(block, [(0, one) for one in beyond], constant_values=np.nan)
        cells = padded.reshape(padded.shape[0] // down, down, padded.shape[1] // across, across)
        found.append(POOLS[pool](cells).astype(np.float32))
    return np.concatenate(found)
