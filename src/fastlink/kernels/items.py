"""Items: cells of one design that hold a zero of one function, kept in lists, worked on `LANES` at a time."""

from __future__ import annotations

from typing import Any

import numpy as np

from fastlink.jit import called, inlined

__all__ = ["ITEM_ROWS", "LANES", "STATE_ROWS", "append_item", "gather"]

LANES = 64
# Rows of an item: what it is, then its bracket (place, value) and for a valley the place between.
LANE, WHICH, HALF, UPPER, XA, FA, XB, FB, XC, FC = range(10)
ITEM_ROWS = 10
# Rows of the state of `LANES` items under way: the item, then what the iteration keeps.
X, F, X1, F1, X2, F2, TOLERANCE, STEPS, OPEN, REAL = range(ITEM_ROWS, ITEM_ROWS + 10)
STATE_ROWS = ITEM_ROWS + 10


@called
def append_item(
    items: Any,
    count: int,
    lane: int,
    which: int,
    half: int,
    upper: bool,
    a: float,
    fa: float,
    b: float,
    fb: float,
) -> int:
    """Append an item and return how many there are; there is room for all that smooth functions can ask for."""
    if count < items.shape[0]:
        item = items[count]
        item[LANE], item[WHICH], item[HALF] = lane, which, half
        item[UPPER] = 1.0 if upper else 0.0
        item[XA], item[FA], item[XB], item[FB] = a, fa, b, fb
        return count + 1
    return count


@inlined
def _gather_row(source: Any, lanes: Any, target: Any, width: int) -> None:
    for i in range(width):
        target[i] = source[lanes[i]]


@called
def gather(items: Any, start: int, stop: int, w: Any, rows: Any, s: Any, lanes: Any) -> int:
    """Copy up to `LANES` items and the design values they need into the state; return the width in use.

    Lanes beyond the last item, up to a multiple of eight, repeat it.
    """
    real = min(LANES, stop - start)
    width = (real + 7) // 8 * 8
    for i in range(width):
        item = items[start + min(i, real - 1)]
        for r in range(ITEM_ROWS):
            s[r, i] = item[r]
        s[REAL, i] = 1.0 if i < real else 0.0
        lanes[i] = np.uint64(item[LANE])
    for r in range(rows.size):
        _gather_row(w[rows[r]], lanes, s[STATE_ROWS + r], width)
    return width
