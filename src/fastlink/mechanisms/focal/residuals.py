"""How well a computed position of the focal mechanism closes: measures of rounding errors."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from fastlink.mechanisms.focal.by_crank import either, steps
from fastlink.mechanisms.focal.inputs import WUNDERLICH
from fastlink.mechanisms.focal.points import POSITION
from fastlink.numerics.compensated import square_sum
from fastlink.numerics.elementary import select, sqrt
from fastlink.numerics.vectors import largest

# -- the bars ---------------------------------------------------------------------------------------------------


def bar_error(
    from_x: Any, from_y: Any, to_x: Any, to_y: Any, length: Any, size: Any, lift: Any, unit: Any
) -> Any:
    """Return the difference of a bar from its length over the longest bar."""
    x = (to_x - from_x) * lift / unit
    y = (to_y - from_y) * lift / unit
    return abs(sqrt(x * x + y * y) - abs(length)) / size


def rocker_error(x: Any, y: Any, length: Any, size: Any, lift: Any, unit: Any) -> Any:
    """Return the difference of a bar with an end in M from its length over the longest bar."""
    x_scaled = x * lift / unit
    y_scaled = y * lift / unit
    return abs(sqrt(x_scaled * x_scaled + y_scaled * y_scaled) - length) / size


def pivot_error(x: Any, y: Any, place: Any, length: Any, size: Any, lift: Any, unit: Any) -> Any:
    """Return the difference of a bar with an end on MN from its length over the longest bar."""
    x_scaled = (x - place) * lift / unit
    y_scaled = y * lift / unit
    return abs(sqrt(x_scaled * x_scaled + y_scaled * y_scaled) - length) / size


@either(units="1", symbol="max", source=POSITION, internal=True)
def longest_bar(
    s_a: Any, s_b: Any, s_c: Any, s_d: Any, s_m: Any, s_n: Any, s_p: Any, s_q: Any, s_r: Any, s_FT: Any
) -> Any:
    """Longest of all bars, scaled."""
    four_bar = largest(s_a, s_b, s_c, s_d)
    dyads = largest(abs(s_m), abs(s_n), abs(s_p), abs(s_q))
    crank = select(s_r > s_FT, s_r, select(s_FT == s_FT, s_FT, 0.0))
    return largest(four_bar, dyads, crank, 0.0)


def declare_bar(bar: str, law: Callable[..., Any], **given: str) -> None:
    """Declare how far the ends of a bar are from its length."""
    step(law, f"error_{bar}", "e", size="longest_bar", **given)


def declare_moving(bar: str, length: str) -> None:
    """Declare the same of a bar without an end on MN."""
    start, end = bar[0], bar[1]
    ends = {"from_x": f"{start}_x", "from_y": f"{start}_y", "to_x": f"{end}_x", "to_y": f"{end}_y"}
    declare_bar(bar, bar_error, length=length, **ends)


step = steps(units="1", source=POSITION)
declare_moving("AB", "s_c")
declare_moving("PF", "s_p")
declare_moving("QF", "s_q")
declare_moving("TF", "s_FT")
declare_bar("MA", rocker_error, x="A_x", y="A_y", length="s_a")
declare_bar("NB", pivot_error, x="B_x", y="B_y", place="d", length="s_b")
declare_bar("SF", pivot_error, x="F_x", y="F_y", place="S_x", length="s_r")

# -- the ratios -------------------------------------------------------------------------------------------------


@either(units="1", symbol="e", source=f"{WUNDERLICH}, eq. (2.5)", internal=True)
def error_PQ(
    A_x: Any, A_y: Any, B_x: Any, B_y: Any, P_x: Any, P_y: Any, Q_x: Any, Q_y: Any, d: Any, lambda_: Any,
    longest_bar: Any, lift: Any, unit: Any,
) -> Any:  # fmt: skip
    """Error of MP : MA = NQ : NB = 1 : lambda."""
    x = abs(A_x - lambda_ * P_x) + abs((B_x - d) - lambda_ * (Q_x - d))
    y = abs(A_y - lambda_ * P_y) + abs(B_y - lambda_ * Q_y)
    return (x + y) * lift / unit / ((1.0 + abs(lambda_)) * longest_bar)


@either(units="1", symbol="e", source=f"{WUNDERLICH}, eq. (3.2)", internal=True)
def error_ST(
    A_x: Any, A_y: Any, B_x: Any, B_y: Any, T_x: Any, T_y: Any, S_x: Any, d: Any, rho: Any,
    longest_bar: Any, lift: Any, unit: Any,
) -> Any:  # fmt: skip
    """Error of AT : TB = MS : SN = rho."""
    x = abs((T_x - A_x) - rho * (B_x - T_x)) + abs(S_x - rho * (d - S_x))
    y = abs((T_y - A_y) - rho * (B_y - T_y))
    return (x + y) * lift / unit / ((1.0 + abs(rho)) * longest_bar)


def greater(x: Any, y: Any) -> Any:
    """Return the greater of two errors; NaN if one is."""
    return select((x > y) | (x != x), x, y)


_UP_TO = "Greatest error up to this one"
step(greater, "greatest_to_NB", "e", _UP_TO, x="error_MA", y="error_NB")
step(greater, "greatest_to_AB", "e", _UP_TO, x="greatest_to_NB", y="error_AB")
step(greater, "greatest_to_PF", "e", _UP_TO, x="greatest_to_AB", y="error_PF")
step(greater, "greatest_to_QF", "e", _UP_TO, x="greatest_to_PF", y="error_QF")
step(greater, "greatest_to_PQ", "e", _UP_TO, x="greatest_to_QF", y="error_PQ")


@either(units="1", symbol="e", source=POSITION)
def closure_residual(
    greatest_to_PQ: Any, error_SF: Any, error_TF: Any, error_ST: Any, rho_plus_1: Any
) -> Any:
    """Greatest closure error of the eight bars and of both ratios (2.5), (3.2), relative to the longest bar."""
    crank = select((error_SF > error_TF) | (error_SF != error_SF), error_SF, error_TF)
    support = select((crank > error_ST) | (crank != crank), crank, error_ST)
    rest = select(rho_plus_1 == 0.0, 0.0, support)
    return select((greatest_to_PQ > rest) | (greatest_to_PQ != greatest_to_PQ), greatest_to_PQ, rest)


@either(units="m", symbol="e_F", source=f"{WUNDERLICH}, eq. (1.6) over nq")
def F_path_residual(
    F_x: Any, F_y: Any, s_a: Any, s_b: Any, s_c: Any, s_d: Any, rho: Any, rho_plus_1: Any, root_rho: Any,
    root_x: Any, lambda_: Any, lift: Any, unit: Any,
) -> Any:  # fmt: skip
    """Distance of the computed F from its circle, or with rho = -1 from its straight line."""
    # (1 + rho) z zbar - rho d (z + zbar - d) = (a^2 + rho b^2)/lambda, over the gradient between F and the circle
    x = F_x * lift / unit
    y = F_y * lift / unit
    power = rho_plus_1 * (x * x + y * y) - rho * (s_d * (2.0 * x - s_d))
    sides, _low = square_sum(s_a, rho, 0.0, s_b)
    excess = power - sides / lambda_
    across = rho_plus_1 * x - rho * s_d
    radius = sqrt(across * across + (rho_plus_1 * y) * (rho_plus_1 * y))
    return abs(excess) / (radius + s_c * (root_rho / root_x)) * unit / lift
