"""Facts of position of Hart's linkage, driven by MA.

With u = e^(i phi) and p = Z - Z0, q = C - C0, sigma^2 = p q of the four-bar MABN (docs/numerics.md) the bars from M to
F are, for lambda > 0 (else they are turned round),

    MP = m u,    PF = m (p - q + 2 i s sigma),    so that F = m (C0 - Z0) + i m (sin phi + 2 s sigma):

the line, without any angle of the four-bar, whatever kappa is. P and Q are A and B as seen from M and N, over lambda,
and e^(i omega) is minus PF over u and p.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from fastlink.mechanisms._shared.laws import along, product, quotient, same, total
from fastlink.mechanisms.hart.design_facts import NUMERICS
from fastlink.mechanisms.hart.four_bar import POSITION
from fastlink.mechanisms.hart.inputs import PAGE, WUNDERLICH, hart
from fastlink.numerics.compensated import UNIT_ROUNDING
from fastlink.numerics.elementary import NOT_A_NUMBER, atan2, select, sqrt
from fastlink.numerics.vectors import largest

# -- the bars from M to F -------------------------------------------------------------------------------------


@hart.quantity(units="m", symbol="m", source=POSITION, internal=True)
def m_along(m: Any, lambda_sign: Any, valid: Any) -> Any:
    """Length of MP along MA, with a sign."""
    return select(valid == 1.0, lambda_sign * m, NOT_A_NUMBER)


@hart.quantity(units="1", symbol="p - q", source=POSITION, internal=True)
def PF_along(past_Z0: Any, past_C0: Any, sigma: Any) -> Any:
    """PF over m, x; NaN where the loop does not close."""
    return select(sigma >= 0.0, past_Z0 - past_C0, NOT_A_NUMBER)


@hart.quantity(units="1", symbol="2 s sigma", source=POSITION, internal=True)
def PF_across(sigma: Any, branch_sign: Any) -> Any:
    """PF over m, y."""
    return branch_sign * (2.0 * sigma)


def middle(start: Any, length: Any, direction: Any) -> Any:
    """Return where the middle of a bar is."""
    return start + 0.5 * (length * direction)


def from_start(start: Any, x: Any, lambda_: Any) -> Any:
    """Return start + x/lambda."""
    return start + x / lambda_


joint = hart.quantities(units="m", source=POSITION)
joint(product, "P_x", "P_x", "Joint P, x", x="m_along", y="cos_phi")
joint(product, "P_y", "P_y", "Joint P, y", x="m_along", y="sin_phi")
joint(middle, "PF_mid_x", "PF_mid_x", "Middle of PF, x", start="P_x", length="m_along", direction="PF_along")
joint(middle, "PF_mid_y", "PF_mid_y", "Middle of PF, y", start="P_y", length="m_along", direction="PF_across")
joint(total, "B_x", "B_x", "Joint B, x", x="d", y="NB_x")
joint(along, "F_y", "F_y", "Joint F, y", start="P_y", length="m_along", direction="PF_across")
joint(from_start, "Q_x", "Q_x", "Joint Q, x", start="d", x="NB_x")
joint(quotient, "Q_y", "Q_y", "Joint Q, y", x="B_y", y="lambda_")


@hart.quantity(units="m", symbol="F_x", source=f"{POSITION}, eq. (7.5)")
def F_x(line_x: Any, sigma: Any) -> Any:
    """Point F, x: that of its line, where the linkage assembles."""
    return select(sigma >= 0.0, line_x, NOT_A_NUMBER)


@hart.quantity(units="1", symbol="kappa n/m sin omega", source=POSITION, internal=True)
def sine_part(PF_along: Any, PF_across: Any, cos_phi: Any, sin_phi: Any) -> Any:
    """Sine of omega times K n/m."""
    return PF_along * sin_phi - PF_across * cos_phi


@hart.quantity(units="1", symbol="kappa n/m cos omega", source=POSITION, internal=True)
def cosine_part(PF_along: Any, PF_across: Any, cos_phi: Any, sin_phi: Any) -> Any:
    """Cosine of omega times K n/m."""
    return -(PF_along * cos_phi + PF_across * sin_phi)


@hart.quantity(units="rad", symbol="omega", source=f"{WUNDERLICH}, eqs. (1.1) to (1.3)")
def omega_angle(sine_part: Any, cosine_part: Any, kappa: Any) -> Any:
    """Angle omega of eq. (1.3), the angle MPF; half a turn more where kappa is negative."""
    sign = select(kappa < 0.0, -1.0, 1.0)
    return atan2(sign * sine_part + 0.0, sign * cosine_part)


@hart.quantity(units="m rad-1", symbol="dF_y/dphi", source=f"{PAGE}#rates-and-extremes")
def dF_y_dphi(m_along: Any, sine_part: Any, per_sigma: Any, branch_sign: Any) -> Any:
    """Rate of F along its line by the direction of MA."""
    return -(branch_sign * (0.5 * m_along * (sine_part * per_sigma)))


# -- rounding errors -----------------------------------------------------------------------------------------


@hart.quantity(units="1", symbol="u", source=NUMERICS)
def F_deviation(P_x: Any, m_along: Any, PF_along: Any, line_x: Any, m: Any, n: Any, K: Any) -> Any:
    """Distance of the end of MP and PF as computed from the line, in units of 2^-53 (MP + PF)."""
    return abs((P_x + m_along * PF_along) - line_x) / (UNIT_ROUNDING * (m + K * n))


@hart.quantity(units="m", symbol="l", source=NUMERICS, internal=True)
def longest(m: Any, n: Any, d: Any, K: Any, size_a: Any, size_b: Any, size_c: Any) -> Any:
    """Longest of the bars."""
    return largest(largest(m, n, d, size_c), largest(size_a, size_b, K * m, K * n), 0.0, 0.0)


def bar_error(x: Any, y: Any, x0: Any, y0: Any, length: Any, longest: Any) -> Any:
    """Return by how much the distance of two joints misses the length of their bar, over the longest bar."""
    u = (x - x0) / longest
    v = (y - y0) / longest
    return sqrt(u * u + v * v) - length / longest


def fixed_bar_error(x: Any, y: Any, x0: Any, length: Any, longest: Any) -> Any:
    """Return the same of a bar from a ground pivot."""
    u = (x - x0) / longest
    v = y / longest
    return sqrt(u * u + v * v) - length / longest


step = hart.steps(units="m", source=NUMERICS)
step(product, "size_p", "|p|", "Length PF", x="K", y="n")
step(product, "size_q", "|q|", "Length QF", x="K", y="m")


def declare_bar(name: str, law: Callable[..., Any], ends: str, **given: str) -> None:
    """Declare by how much the distance of two joints misses the length of their bar."""
    meaning = f"by how much the distance {ends} misses the length of its bar, over the longest bar"
    to = {"x": f"{ends[1]}_x", "y": f"{ends[1]}_y"}
    hart.steps(units="1", source=NUMERICS)(law, name, ends, meaning, **to, **given)


BAR_ERRORS = ("AB_error", "PF_error", "QF_error", "NB_error", "NQ_error")
declare_bar("AB_error", bar_error, "AB", x0="A_x", y0="A_y", length="size_c")
declare_bar("PF_error", bar_error, "PF", x0="P_x", y0="P_y", length="size_p")
declare_bar("QF_error", bar_error, "QF", x0="Q_x", y0="Q_y", length="size_q")
declare_bar("NB_error", fixed_bar_error, "NB", x0="d", length="size_b")
declare_bar("NQ_error", fixed_bar_error, "NQ", x0="d", length="n")


@hart.quantity(units="1", symbol="r", source=NUMERICS)
def closure_residual(AB_error: Any, PF_error: Any, QF_error: Any, NB_error: Any, NQ_error: Any) -> Any:
    """Closure error of the bars AB, PF, QF, NB and NQ by the joints as computed, relative to the longest bar."""
    moving = AB_error * AB_error + (PF_error * PF_error + QF_error * QF_error)
    return sqrt(moving + (NB_error * NB_error + NQ_error * NQ_error))


hart.derivatives("phi")(same, "F_y", x="dF_y_dphi")
