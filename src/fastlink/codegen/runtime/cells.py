"""Items: cells of one design that hold a zero of one function, kept in lists, worked on `LANES` at a time."""

from __future__ import annotations

from typing import Any

from fastlink.numerics.compiler import inlined, lanes, merged, outlined

__all__ = ["ITEM_ROWS", "LANES", "MOST_LANES", "STATE_ROWS", "append_item", "gather", "padded"]

LANES = 64
#: Doubles in the widest vectors: loops over lanes run over whole numbers of these.
MOST_LANES = 8
# Rows of an item: what it is, then its bracket (place, value) and for a valley the place between.
LANE, HALF, UPPER, XA, FA, XB, FB, XC, FC = range(9)
ITEM_ROWS = 9
# Rows of the state of `LANES` items under way: the item, then what the iteration keeps.
X, F, X1, F1, X2, F2, TOLERANCE, STEPS, OPEN = range(ITEM_ROWS, ITEM_ROWS + 9)
STATE_ROWS = ITEM_ROWS + 9


@inlined
def padded(count: int) -> int:
    """Return the number of lanes of the whole vectors that hold so many."""
    return (count + (MOST_LANES - 1)) & -MOST_LANES


@merged
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
    if count + MOST_LANES <= items.shape[1]:
        items[LANE, count] = lane
        items[HALF, count] = half
        items[UPPER, count] = 1.0 if upper else 0.0
        items[XA, count] = a
        items[FA, count] = fa
        items[XB, count] = b
        items[FB, count] = fb
        return count + 1
    return count


@outlined
def gather(items: Any, start: int, stop: int, w: Any, rows: Any, s: Any) -> int:
    """Copy up to `LANES` items and the design values they need into the state; return how many they are.

    Lanes beyond the last item, up to a whole number of vectors, repeat it.
    """
    count = min(LANES, stop - start)
    width = padded(count)
    if start + count == stop:
        for k in range(stop, start + width):
            for r in range(ITEM_ROWS):
                items[r, k] = items[r, stop - 1]
    for r in range(ITEM_ROWS):
        for i in lanes(width):
            s[r, i] = items[r, start + i]
    for r in range(rows.size):
        row = rows[r]
        for i in lanes(width):
            s[STATE_ROWS + r, i] = w[row, int(s[LANE, i])]
    return count
