"""Items: cells of one design that hold a zero of one function, kept in lists, worked on `LANES` at a time."""

from __future__ import annotations

from typing import Any

from fastlink.numerics.compiler import lanes, outlined

__all__ = ["ITEM_ROWS", "LANES", "MOST_LANES", "STATE_ROWS", "append_item", "gather"]

LANES = 64
#: Doubles in the widest vectors: loops over lanes run over whole numbers of these.
MOST_LANES = 8
# Rows of an item: what it is, then its bracket (place, value) and for a valley the place between.
LANE, HALF, UPPER, XA, FA, XB, FB, XC, FC = range(9)
ITEM_ROWS = 9
# Rows of the state of `LANES` items under way: the item, then what the iteration keeps.
X, F, X1, F1, X2, F2, TOLERANCE, STEPS, OPEN, REAL = range(ITEM_ROWS, ITEM_ROWS + 10)
STATE_ROWS = ITEM_ROWS + 10


@outlined
def append_item(
    items: Any,
    count: int,
    lane: int,
    half: int,
    upper: bool,
    a: float,
    fa: float,
    b: float,
    fb: float,
) -> int:
    """Append an item and return how many there are; there is room for all that smooth functions can ask for."""
    if count < items.shape[0]:
        items[count, LANE] = lane
        items[count, HALF] = half
        items[count, UPPER] = 1.0 if upper else 0.0
        items[count, XA] = a
        items[count, FA] = fa
        items[count, XB] = b
        items[count, FB] = fb
        return count + 1
    return count


@outlined
def gather(items: Any, start: int, stop: int, w: Any, rows: Any, s: Any, lane: Any) -> int:
    """Copy up to `LANES` items and the design values they need into the state; return the width in use.

    Lanes beyond the last item, up to a whole number of vectors, repeat it.
    """
    real = min(LANES, stop - start)
    width = (real + (MOST_LANES - 1)) & -MOST_LANES
    for i in range(width):
        item = start + min(i, real - 1)
        for r in range(ITEM_ROWS):
            s[r, i] = items[item, r]
        s[REAL, i] = 1.0 if i < real else 0.0
        lane[i] = int(items[item, LANE])
    for r in range(rows.size):
        row = rows[r]
        for i in lanes(width):
            s[STATE_ROWS + r, i] = w[row, lane[i]]
    return width
