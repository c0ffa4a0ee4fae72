"""Error bounds of extrema, where they are requested.

Every position x of the graded range is one of the reachable range. So the exact quantity at an x that was found, which
is within its error bound E of the computed value, is never beyond the extreme; it may fall short of it, as x is
not the exact place.

- At a zero of the slope s, the exact slope is at most S = |s| + E_s, with the error bound E_s of the slope: x is off by
  at most S/|b|, b being the second derivative, and the value by half of S S/|b|. Twice that is added, as b changes on
  the way and has an error of its own. Where two extremes are about to meet, or one is flat, b differs on the way, and
  the value is off by a power of S beyond the first (4/3 for an extreme like x^4): a thousandth of E.
- Where b vanishes, s is within E_s: the value is off by at most 2 E_s times half a turn. At a kink s is far from zero
  on both sides; its place is known to 2^-51 of x, less than 2^-48 in the input position, or to where rounding hides
  which side it is on, by E.
- The magnitude of a vector that almost vanishes has a kink, too. A least magnitude f is off by at most the greater of E
  and f, as the exact one is between 0 and f + E.
- An end of the range counts at x = 0, which is exact; or at a first sample x = 2^-60 r beside a toggle or a fold, for
  quantities that have no value at the toggle itself. In x they are smooth there, and the input position changes by
  less than 4 x. The value is off by at most 8 x |s|; beside a toggle, where it may change as c x and s grows as 1/x, by
  c x = s s/|b|. What is infinite at a toggle has no bound, nor has what grows as 1/x or more towards a fold: |b| x^2 is
  at least half of it, then.
- Beside a toggle at which the slope vanishes an extreme may stand that is not looked for (`toggles`): the value at the
  toggle is off by at most what the quantity changes within four times the distance of that.
- Where a quantity has a limit at a fold but no value there in doubles, that at 2^-30 of the scale stands for it, and
  has no bound.
- Where no slope changes its sign, a place in the middle of the turn stands for the extreme. If its slope is within its
  error bound the quantity is constant but for rounding: off by at most S times half a turn on each side.
- A jump by a whole turn is at pi, which is off by its own rounding.
- Where a gap counts as zero within the rounding of the lengths, others may stand next to the fold for the lengths as
  given: nothing bounds them.
"""

from __future__ import annotations

from typing import Any

from fastlink.codegen.runtime.cells import (
    BEND,
    BOUND,
    JUMPS,
    KIND,
    LANE,
    SLOPE,
    SLOPE_BOUND,
    START,
    TOGGLE,
    UPPER,
    VALUE,
    X,
    padded,
)
from fastlink.numerics.compiler import inlined, lanes, outlined
from fastlink.numerics.elementary import INFINITY, PI, TWO_PI

__all__ = [
    *("MARGIN", "OF_PI", "bound_at_zero", "bound_ends", "bound_zeros", "has_no_bound", "is_certain", "known"),
    *("of_better", "off_at_end"),
]

# For what the powers of E_s beyond the first come to, and for the roundings of the bound itself.
MARGIN = 1.0 + 2.0**-10
# Of pi in doubles, 1.2e-16: half of its last place is 2^-52.
OF_PI = 2.0**-52
# The place of a kink.
OF_PLACE = 2.0**-48
# At a kink rounding may hide the sign of a slope that is far beyond that of rounding, and no step leads to its zero.
UNRESOLVED, FAR = 2.0**20, 2.0**-7
# A slope is certain where it is so many times as great as its error bound.
TIMES = 2.0


@inlined
def known(bound: Any) -> Any:
    """Return a bound, infinite where it is not a number."""
    return bound if bound >= 0.0 else INFINITY


@inlined
def is_certain(slope: Any, slope_bound: Any) -> Any:
    """Tell whether the sign of a slope of some size is more than rounding."""
    return slope > TIMES * slope_bound


@inlined
def bound_at_zero(bound: Any, slope: Any, slope_bound: Any, bend: Any) -> Any:
    """Return the bound of a value, and what its place is off, at a zero of the slope."""
    own, steep = MARGIN * bound, slope + slope_bound
    kink = (steep > UNRESOLVED * own) & (steep > FAR * bend)
    off = steep * (steep / bend)
    most = own + (OF_PLACE * slope + (0.0 if kink else TWO_PI * slope_bound))
    total = own + (off if off < most else most)
    return own, total


@inlined
def off_at_end(x: Any, slope: Any, slope_bound: Any, bend: Any, first: Any) -> Any:
    """Return what the place of a value at an end of the range is off, where the first sample is."""
    off, beside = 8.0 * x * slope, 4.0 * slope * (slope / bend)
    off = 0.0 if x == 0.0 else (beside if beside < off else off)
    return PI * (slope + slope_bound) if (first == 0.0) & (slope <= slope_bound) else off


@inlined
def has_no_bound(x: Any, size: Any, bend: Any, first: Any, toggle: Any) -> Any:
    """Tell whether a value at an end of the range is infinite, grows towards a fold, or stands for a limit."""
    pole = (toggle == 0.0) & (x > 0.0) & (size > 0.0) & (4.0 * (bend * (x * x)) >= size)
    return (size == INFINITY) | pole | (x > 2.0 * abs(first))


@outlined
def bound_zeros(s: Any, count: int, search: Any, magnitude: int) -> None:
    """Add to the bounds of values at zeros of the slope what the places are off.

    Parameters
    ----------
    s, count : array, int
        State of the items, and how many they are.
    search : array of int
        Table of the search, see `cells`.
    magnitude : int
        1 for the magnitude of a vector, else 0.
    """
    if search[JUMPS] > 0:
        for i in lanes(padded(count)):
            s[BOUND, i] = OF_PI
    else:
        for i in lanes(padded(count)):
            value = s[VALUE, i]
            own, bound = bound_at_zero(s[BOUND, i], s[SLOPE, i], s[SLOPE_BOUND, i], s[BEND, i])
            # not a number where the value is exactly 0
            least = (magnitude > 0) & (s[KIND, i] < 0.0) & ((bound > value) | (bound != bound))
            s[BOUND, i] = known((value if value > own else own) if least else bound)


@outlined
def bound_ends(s: Any, count: int, w: Any, table: Any) -> None:
    """Add to the bounds of values at ends of the range what the places are off.

    Parameters
    ----------
    s, count : array, int
        State of the items, and how many they are.
    w, table : array
        Lane values, and the table of the kernel, see `cells`.
    """
    for i in range(count):
        first = w[table[START] + int(s[UPPER, i]), int(s[LANE, i])]
        toggle = w[table[TOGGLE] + int(s[UPPER, i]), int(s[LANE, i])]
        x, size, bend = s[X, i], abs(s[VALUE, i]), s[BEND, i]
        total = known(MARGIN * s[BOUND, i] + off_at_end(x, s[SLOPE, i], s[SLOPE_BOUND, i], bend, first))
        s[BOUND, i] = INFINITY if has_no_bound(x, size, bend, first, toggle) else total


@inlined
def of_better(best: Any, best_bound: Any, value: Any, bound: Any) -> Any:
    """Return the error bound of the better of two candidates for an extreme, of which the other may be it.

    Each extreme lies within the bound of its own candidate, so that the outermost of all lies within that of the best
    candidate, or beyond it by at most what the bound of another exceeds the distance of both values.
    """
    ahead = value - best
    own = bound if ahead > 0.0 else best_bound
    other = best_bound if ahead > 0.0 else bound
    reach = other - abs(ahead)
    return reach if reach > own else own
