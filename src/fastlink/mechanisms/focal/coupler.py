"""Direction of the coupler AB where the crank SF drives: from that of SF, or from MA and NB.

e = -k u v w/g is right to the errors of the other four, and all of these may turn fast while AB hardly does
(a or b short). c e = (d + b v) - a u is then right to its own: with the shorter rocker taken last, d + b v is
as long as that and AB together, and where NB points towards M it is (d - b) + b (1 + v), which does not
cancel. Where AB is shorter than both rockers, it is e that turns fast, and comes from the other four.
"""

from __future__ import annotations

from typing import Any

from fastlink.mechanisms.focal.by_crank import by_crank
from fastlink.mechanisms.focal.inputs import focal
from fastlink.mechanisms.focal.points import POSITION, declare_products
from fastlink.numerics.elementary import select


@focal.quantity(units="1", symbol="c < a, b", source=POSITION, internal=True)
def coupler_is_short(s_a: Any, s_b: Any, s_c: Any) -> Any:
    """1 where AB is shorter than MA and NB, else 0."""
    return select((s_c < s_a) & (s_c < s_b), 1.0, 0.0)


@focal.quantity(units="1", symbol="k", source=POSITION, internal=True)
def fifth_sign(coupler_is_short: Any, crank_sign: Any) -> Any:
    """Minus the sign of (1 + rho) lambda where AB is the shortest, else 0."""
    return -(coupler_is_short * crank_sign)


@focal.quantity(units="1", symbol="1/c", source=POSITION, internal=True)
def per_coupler(coupler_is_short: Any, s_c: Any) -> Any:
    """Reciprocal of c where AB is not the shortest, else 0."""
    return select(coupler_is_short == 1.0, 0.0, 1.0 / s_c)


@focal.quantity(units="1", symbol="b >= a", source=POSITION, internal=True)
def long_v(s_a: Any, s_b: Any) -> Any:
    """1 where NB is the longer rocker, else 0."""
    return select(s_a <= s_b, 1.0, 0.0)


@focal.quantity(units="1", symbol="b < a", source=POSITION, internal=True)
def long_u(long_v: Any) -> Any:
    """1 where MA is the longer rocker, else 0."""
    return 1.0 - long_v


def greater(x: Any, y: Any) -> Any:
    """Return the greater of two lengths."""
    return select(x > y, x, y)


def lesser(x: Any, y: Any) -> Any:
    """Return the lesser of two lengths."""
    return select(x > y, y, x)


def excess(s_d: Any, longer: Any) -> Any:
    """Length MN less the longer rocker."""
    return s_d - longer


step = focal.steps(units="1", source=POSITION)
step(greater, "longer", "max(a, b)", "Longer rocker, scaled", x="s_a", y="s_b")
step(lesser, "shorter", "min(a, b)", "Shorter rocker, scaled", x="s_a", y="s_b")
step(excess, "excess_of_d", "d - max(a, b)")


def from_other_pivot(s_d: Any, longer: Any, excess_of_d: Any, along: Any, across: Any) -> Any:
    """Return d + l t, along MN, for the longer rocker l as seen from the pivot of the other one."""
    towards = excess_of_d + longer * (across * across) / (1.0 + abs(along))
    return select(along < 0.0, towards, s_d + longer * along)


def of_longer(long_v: Any, v: Any, long_u: Any, u: Any) -> Any:
    """Return a component of the longer rocker: v, or -u as seen from A."""
    return long_v * v - long_u * u


def of_shorter(long_v: Any, v: Any, long_u: Any, u: Any) -> Any:
    """Return a component of the shorter rocker: -u, or v."""
    return long_u * v - long_v * u


step = by_crank.steps(units="1", source=POSITION)
step.vector(of_longer, "long_*", "t_*", "Direction of the longer rocker", v="v_*", u="u_*")
step(of_shorter, "short_x", "t_x", "Direction of the shorter rocker", v="v_x", u="u_x")
step(from_other_pivot, "far_x", "d + l t", along="long_x", across="long_y")
declare_products(by_crank, "w")


@by_crank.quantity(units="1", symbol="e_x", source=POSITION, internal=True)
def e_x(
    fifth_sign: Any, uwv_x: Any, uwv_y: Any, g_x: Any, g_y: Any, per_coupler: Any, far_x: Any, shorter: Any,
    short_x: Any,
) -> Any:  # fmt: skip
    """Direction of AB, x."""
    return fifth_sign * (uwv_x * g_x + uwv_y * g_y) + per_coupler * (far_x + shorter * short_x)


@by_crank.quantity(units="1", symbol="e_y", source=POSITION, internal=True)
def e_y(
    fifth_sign: Any, uwv_x: Any, uwv_y: Any, g_x: Any, g_y: Any, per_coupler: Any, s_a: Any, u_y: Any,
    s_b: Any, v_y: Any,
) -> Any:  # fmt: skip
    """Direction of AB, y."""
    return per_coupler * (s_b * v_y - s_a * u_y) - fifth_sign * (uwv_x * g_y - uwv_y * g_x)
