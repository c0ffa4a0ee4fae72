"""Ends of the range: where a quantity may be extreme though its slope is not 0, and where it grows without bound.

At a toggle a quantity has a limit or grows by its order. At a fold, where all bars of a change point are in line, it is
a sum of powers of the distance x: it may have a pole there whose factor is as small as masses and loads are, so that
nothing shows it but positions far closer. Arrays are as in `results`.
"""

from __future__ import annotations

from typing import Any

from fastlink.codegen.runtime.cells import (
    AT_LIMIT,
    BRANCHES,
    HALVES,
    KIND,
    LANE,
    LANES,
    NUMBER,
    ORDER,
    START,
    TOGGLE,
    UPPER,
    VALUE,
    XA,
    F,
    X,
    append_item,
    padded,
    set_bracket,
)
from fastlink.codegen.runtime.results import GREATEST
from fastlink.numerics.compiler import inlined, lanes, outlined
from fastlink.numerics.elementary import INFINITY

__all__ = ["collect_ends", "end_values", "keep_beside", "place_beside", "place_ends", "place_lost", "tries"]

# The first sample stands at 2^-60 of the scale. How much farther from a toggle a quantity is evaluated too, how much
# nearer to a fold, and how much greater it is there at least if it has a pole at the fold. At 2^-150 no power of an
# angle that is needed underflows; rounding errors leave no pole.
FARTHER, NEARER, GROWS = 2.0**30, 2.0**-90, 2.0**20
# How little a quantity changes from there to a toggle if it is finite.
STEADY = 2.0**-16


@inlined
def _is_fold(s: Any, i: Any, w: Any, table: Any) -> Any:
    """Tell whether an item is the first sample beside a fold."""
    upper, lane = int(s[UPPER, i]), int(s[LANE, i])
    first = abs(w[table[START] + upper, lane])
    return (w[table[TOGGLE] + upper, lane] == 0.0) & (first > 0.0) & (s[XA, i] == first)


@outlined
def tries(s: Any, count: int, w: Any, table: Any) -> int:
    """Return at how many positions beside the ends quantities are evaluated: 2 where there is a fold, else 1."""
    n = 1
    for i in range(count):
        n = 2 if _is_fold(s, i, w, table) else n
    return n


@outlined
def place_beside(s: Any, count: int, k: int) -> None:
    """Put items beside the ends of the range: farther from them at first, then nearer."""
    times = FARTHER if k == 0 else NEARER
    for i in lanes(padded(count)):
        s[X, i] = times * s[XA, i]


@outlined
def keep_beside(s: Any, count: int, w: Any, table: Any, k: int) -> None:
    """Keep the values of a quantity at positions beside the ends of the range; the nearer ones at folds alone."""
    for i in range(count):
        if k == 0 or _is_fold(s, i, w, table):
            s[F, i] = s[VALUE, i]


@outlined
def place_ends(s: Any, count: int, times: float) -> None:
    """Put items at the ends of the range at so many times their positions."""
    for i in lanes(padded(count)):
        s[X, i] = times * s[XA, i]


@outlined
def place_lost(s: Any, count: int, w: Any, table: Any, times: float) -> int:
    """Put items that have no value at a fold itself beside it; return how many they are.

    At so many times the first sample's position; the value there stands for the limit, whose error nothing bounds.
    """
    lost = 0
    for i in range(count):
        first = abs(w[table[START] + int(s[UPPER, i]), int(s[LANE, i])])
        if s[VALUE, i] != s[VALUE, i] and s[X, i] == 0.0 and first > 0.0:
            s[X, i] = times * first
            lost = lost + 1
    return lost


@outlined
def end_values(s: Any, count: int, w: Any, table: Any, search: Any) -> None:
    """Make values at ends of the range infinite where they grow towards a toggle or fold; an end is of no kind.

    At a toggle a quantity grows by its order, unless what grows has the factor 0, as the forces of links without mass:
    then it is the same at both positions. At a fold forces grow as 1/x or more where all bars are in line.

    Parameters
    ----------
    s, count, table, search
        As for `extrema_at_zeros`.
    w : array
        Lane values.
    """
    for i in range(count):
        s[KIND, i] = 0.0
        value, beside = s[VALUE, i], s[F, i]
        if search[ORDER] > 0 and value != 0.0:
            if _is_fold(s, i, w, table):
                s[VALUE, i] = beside * INFINITY if abs(beside) > GROWS * abs(value) else value
            elif w[table[TOGGLE] + int(s[UPPER, i]), int(s[LANE, i])] > 0.0:
                s[VALUE, i] = value if abs(value - beside) <= STEADY * abs(beside) else value * INFINITY


@outlined
def collect_ends(w: Any, count: int, table: Any, search: Any, best: Any, ends: Any) -> int:
    """Make items of the ends of the range where they may be extreme: at toggles, and where there is no extremum.

    An end counts where the first sample is; for a quantity with a value at the end itself, there, unless the position
    of the first sample is negative: nothing has a value at the end itself then.
    """
    total = 0
    for i in range(count):
        empty = False
        for branch in range(table[BRANCHES]):
            column = (search[NUMBER] * table[BRANCHES] + branch) * LANES + i
            empty = empty or best[GREATEST, column] == -INFINITY
        for half in range(table[HALVES]):
            for upper in range(2):
                first = w[table[START] + upper, i]
                if first != 0.0 or empty:
                    x = 0.0 if search[AT_LIMIT] > 0 and first >= 0.0 else abs(first)
                    set_bracket(ends, total, x, 0.0, x, 0.0)
                    total = append_item(ends, total, i, half, upper == 1)
    return total
