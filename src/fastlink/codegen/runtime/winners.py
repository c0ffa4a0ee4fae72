"""Where the greatest and the least value of a search are, for their derivatives by the inputs if these are requested.

Two places for each design, branch and search: of the greatest value, and of the least one with its sign changed.
Derivatives are evaluated there, once for each, lanes being designs: at the input position that was found; at a limit of
motion beside it, at 2^-60 of the scale, with the place kept at that distance from the limit.
"""

from __future__ import annotations

from typing import Any

from fastlink.codegen.runtime.cells import (
    BRANCHES,
    FA,
    FB,
    HALF,
    IMAGE,
    JUMPS,
    KIND,
    LANE,
    LANES,
    MIRROR,
    NUMBER,
    ONTO,
    OWN,
    PARITY,
    SIDES,
    START,
    THETA,
    TOGGLE,
    UPPER,
    VALUE,
    F,
    X,
)
from fastlink.codegen.runtime.results import FOLDED
from fastlink.numerics.compiler import lanes, outlined
from fastlink.numerics.elementary import INFINITY, NOT_A_NUMBER, PI, TWO_PI
from fastlink.numerics.gradient_status import (
    AT_CHANGE_POINT,
    AT_LIMIT,
    CONSTANT,
    INFINITE,
    JUMP,
    KINK,
    NOTHING,
    SMOOTH,
    TIED,
)
from fastlink.numerics.vectors import magnitude

__all__ = [
    *(
        "CODE",
        "HELD",
        "ALONG",
        "WINNER_ROWS",
        "forget_winners",
        "judge_winners",
        "note_kinks",
        "note_winners",
    ),
    *("settle_jumps", "store_change", "store_gradient", "store_status"),
]

# Rows of a place: the value (of a least one with its sign changed), the input position, the place in the range, whether
# it is of a mirror image, its kind; the next best value elsewhere; the code of what derivatives there are worth; and
# whether these are taken at one input position, along with a limit of motion, or not at all (0).
BEST, PLACE, AT_X, IN_HALF, IN_UPPER, MIRRORED, OF_KIND, SECOND, CODE, WHERE = range(10)
WINNER_ROWS = 10
HELD, ALONG = 1.0, 2.0
#: Entries of the table of a change by tolerances: see `store_change`.
FIRST, SQUARES, COUNT, TERMS = range(4)
#: The kinds of a jump by a full turn, and of a place where a quotient is divided by almost nothing and has its extreme
#: beside it; an end of the range has kind 0.
TURN, NEARLY_POLE = 2.0, 3.0
# A zero is found to 2^-51 of its place: there a slope without a jump is below this part of that at the bracket's ends.
KINKED = 2.0**-20
# An angle whose sine is 0 is within some roundings of 0 or pi.
FOLD = 2.0**-46
# Input positions that are nearer are one place; values that differ by less tie.
SAME, TIE = 2.0**-20, 2.0**-40


@outlined
def forget_winners(winners: Any, gradients: Any) -> None:
    """Forget the places of the designs before, and the derivatives there."""
    for least in range(2):
        row = least * WINNER_ROWS
        for i in lanes(winners.shape[1]):
            winners[row + BEST, i] = -INFINITY
            winners[row + SECOND, i] = -INFINITY
            winners[row + PLACE, i] = NOT_A_NUMBER
            winners[row + OF_KIND, i] = NOT_A_NUMBER
    for r in range(gradients.shape[0]):
        for i in lanes(gradients.shape[1]):
            gradients[r, i] = NOT_A_NUMBER


@outlined
def note_winners(s: Any, count: int, table: Any, search: Any, winners: Any, signs: Any) -> None:
    """Keep the places of the extrema at items that are the greatest or least so far, see `results.store_extrema`.

    `signs` tells whether greatest values are requested (1, else 0), and whether least ones are.
    """
    sides, branches = table[SIDES], table[BRANCHES]
    jumps, piece, beside = search[JUMPS] > 0, search[JUMPS] < 0, search[ONTO] != search[NUMBER]
    for i in range(count):
        if s[KIND, i] != s[KIND, i]:
            continue
        branch = int(s[HALF, i]) >> (sides - 1)
        for mirror in range(2):
            target = table[MIRROR + branch] if mirror == 1 else table[OWN + branch]
            if target < 0:
                continue
            column = (search[ONTO] * branches + target) * LANES + int(s[LANE, i])
            theta = s[IMAGE, i] if mirror == 1 else s[THETA, i]
            value = float(search[PARITY]) * s[VALUE, i] if mirror == 1 else s[VALUE, i]
            for least in range(1 - signs[0], 1 + signs[1]):
                high = PI if jumps else (-value if least == 1 else value)
                row = least * WINNER_ROWS
                if not high > winners[row + SECOND, column]:
                    continue
                apart = abs(theta - winners[row + PLACE, column])
                same = (apart < SAME) | (abs(apart - TWO_PI) < SAME)
                if high > winners[row + BEST, column]:
                    if not same:
                        winners[row + SECOND, column] = winners[row + BEST, column]
                    winners[row + BEST, column] = high
                    winners[row + PLACE, column] = theta
                    winners[row + AT_X, column] = s[X, i]
                    winners[row + IN_HALF, column] = s[HALF, i]
                    winners[row + IN_UPPER, column] = s[UPPER, i]
                    winners[row + MIRRORED, column] = float(mirror)
                    winners[row + OF_KIND, column] = (
                        TURN if jumps else (1.0 if piece else (NEARLY_POLE if beside else s[KIND, i]))
                    )
                elif not same:
                    winners[row + SECOND, column] = high


@outlined
def note_kinks(s: Any, count: int, table: Any, search: Any, winners: Any, signs: Any) -> None:
    """Note which of the places kept last are kinks: the slope jumps over zero there; arguments as of `note_winners`."""
    sides, branches = table[SIDES], table[BRANCHES]
    for i in range(count):
        low, high = abs(s[FA, i]), abs(s[FB, i])
        jumps = abs(s[F, i]) > KINKED * (high if high > low else low)
        if (s[KIND, i] != s[KIND, i]) | (not jumps):
            continue
        branch = int(s[HALF, i]) >> (sides - 1)
        for mirror in range(2):
            target = table[MIRROR + branch] if mirror == 1 else table[OWN + branch]
            if target < 0:
                continue
            column = (search[ONTO] * branches + target) * LANES + int(s[LANE, i])
            theta = s[IMAGE, i] if mirror == 1 else s[THETA, i]
            for least in range(1 - signs[0], 1 + signs[1]):
                row = least * WINNER_ROWS
                if winners[row + PLACE, column] == theta:
                    winners[row + OF_KIND, column] = NEARLY_POLE


@outlined
def judge_winners(winners: Any, w: Any, count: int, table: Any, search: Any, asked: Any) -> int:
    """Find what derivatives of greatest and least values are worth; return how many are at limits of motion.

    Parameters
    ----------
    winners, w : array
        The places, and the lane values.
    count : int
        The number of designs.
    table, search : array of int
        Tables of the kernel and of the search, see `cells`.
    asked : array of int
        Whether greatest values are requested (1, else 0), whether least ones are; whether it is the magnitude of a
        vector; whether it is an angle that turns back at 0 and pi, its extremes whatever the lengths.
    """
    moving = 0
    for least in range(1 - asked[0], 1 + asked[1]):
        row = least * WINNER_ROWS
        for branch in range(table[BRANCHES]):
            for i in range(count):
                column = (search[NUMBER] * table[BRANCHES] + branch) * LANES + i
                best, kind = winners[row + BEST, column], winners[row + OF_KIND, column]
                folded = (asked[3] > 0) & ((abs(best) < FOLD) | (abs(abs(best) - PI) < FOLD))
                code = NOTHING
                if (kind == TURN) | (folded & (kind == kind)):
                    code = JUMP
                elif kind == kind and abs(best) == INFINITY:
                    code = INFINITE
                elif kind == kind:
                    upper = int(winners[row + IN_UPPER, column])
                    first, toggle = abs(w[table[START] + upper, i]), w[table[TOGGLE] + upper, i] > 0.0
                    beside = (kind == 0.0) | (winners[row + AT_X, column] < FOLDED * first)
                    code = AT_LIMIT if kind == 0.0 else SMOOTH
                    code = TIED if winners[row + SECOND, column] >= best - TIE * abs(best) else code
                    code = KINK if (kind == NEARLY_POLE) | ((asked[2] > 0) & (best == 0.0)) else code
                    code = CONSTANT if (kind == 0.0) & (not toggle) else code
                    code = AT_CHANGE_POINT if (first > 0.0) & (not toggle) & beside else code
                winners[row + CODE, column] = float(code)
                where = 0.0
                if (code == SMOOTH) | (code == TIED) | (code == AT_LIMIT) | (code == CONSTANT):
                    where = HELD
                    if kind == 0.0 and code != CONSTANT:
                        where = ALONG
                        moving = moving + 1
                        upper = int(winners[row + IN_UPPER, column])
                        first = abs(w[table[START] + upper, i])
                        if winners[row + AT_X, column] < first:
                            winners[row + AT_X, column] = first
                winners[row + WHERE, column] = where
    return moving


@outlined
def settle_jumps(winners: Any, row: int, columns: Any, gradients: Any, base: int, values: int) -> None:
    """Store zeros as the derivatives of values that are pi or 0 because an angle jumps or folds.

    `row` is the first one of the places, `base` that of the derivatives, of which so many are of values.
    """
    for column in range(columns[0], columns[1]):
        if winners[row + CODE, column] == JUMP:
            for j in range(values):
                gradients[base + j, column] = 0.0


@outlined
def store_gradient(result: Any, first: int, count: int, base: int, gradients: Any, row: int) -> None:
    """Copy the derivative of a greatest or least value, or of its place."""
    for i in range(count):
        for branch in range(result.shape[1]):
            result[first + i, branch] = gradients[row, base + branch * LANES + i]


@outlined
def store_change(result: Any, first: int, count: int, gradients: Any, w: Any, terms: Any) -> None:
    """Put together the changes of a greatest or least value, or of its place, by the tolerances of inputs.

    `terms` has the first column, whether squares are added, how many inputs there are, the rows of the derivatives by
    them, and the rows of the lane values of their tolerances.
    """
    total = terms[COUNT]
    for i in range(count):
        for branch in range(result.shape[1]):
            change = 0.0
            for k in range(total):
                slope = gradients[terms[TERMS + k], terms[FIRST] + branch * LANES + i]
                one = abs(slope) * w[terms[TERMS + total + k], i]
                change = magnitude(change, one) if terms[SQUARES] > 0 else change + one
            result[first + i, branch] = change


@outlined
def store_status(result: Any, first: int, count: int, base: int, winners: Any, row: int) -> None:
    """Copy what the derivatives of a greatest or least value are worth, from the row of its code."""
    for i in range(count):
        for branch in range(result.shape[1]):
            result[first + i, branch] = int(winners[row, base + branch * LANES + i])
