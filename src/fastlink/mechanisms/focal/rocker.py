"""Driven by the rocker MA: the four-bar MABN is a planar 4R, which gives u, v and e; w closes the dyads of F.

P and Q divide MA and NB alike, so that PQ is -(AB + (lambda - 1) MN)/lambda, and of (1.3), (1.4) is left

    w = -sgn(lambda) (e + t)/|e + t| (|rho b u + a v|/(rho b u + a v)),    t = (lambda - 1) d/c.
"""

from __future__ import annotations

from typing import Any

from fastlink.mechanisms._shared.laws import product, quotient
from fastlink.mechanisms._shared.reuse import borrow, borrow_tables
from fastlink.mechanisms.focal.design_facts import FOUR_BAR, PREFIX
from fastlink.mechanisms.focal.inputs import WUNDERLICH, focal
from fastlink.mechanisms.focal.points import FIGURES, POSITION, declare_products
from fastlink.mechanisms.planar_4r import planar_4r
from fastlink.numerics.elementary import select, sqrt

#: The names that differ from those of the planar 4R.
NAMES = FOUR_BAR | {"cos_theta1": "u_x", "sin_theta1": "u_y", "DB_x": "NB_x", "DB_y": "NB_y"}
NAMES |= {
    "output_ratio": "dpsi_dphi",
    **{name: name for name in ("Z", "C", "Z_low", "C_low", "A_x", "A_y", "AB_x", "AB_y", "branch_sign")},
    **{name: name for name in ("from_low", "from_high", "side")},
}
borrow_tables(focal, planar_4r, NAMES)

DIRECTION_OF_NB = {
    "symbol": "psi",
    "meaning": "Direction of NB in the ground frame",
    "source": f"{WUNDERLICH}, eq. (2.2)",
}
RATIO = {
    "symbol": "d psi/d phi",
    "meaning": "Angular velocity of NB over that of MA",
    "source": f"{WUNDERLICH}, eq. (2.4), differentiated",
    "internal": False,
}
LABELS: dict[str, dict[str, Any]] = {"theta4": DIRECTION_OF_NB, "output_ratio": RATIO}
LABELS |= {name: {} for name in ("AB_x", "AB_y", "DB_x", "DB_y", "AB_v", "sigma", "per_sigma")}
borrow(focal, planar_4r, NAMES, PREFIX, LABELS)


step = focal.steps(units="1", source=FIGURES)
step.vector(quotient, "v_*", "v_*", "Direction of NB", x="NB_*", y="b")
step.vector(quotient, "e_*", "e_*", "Direction of AB", x="AB_*", y="c")


# -- w ----------------------------------------------------------------------------------------------------------


@focal.quantity(units="1", symbol="t", source=POSITION, internal=True)
def t(x: Any, s_c: Any, s_d: Any) -> Any:
    """(lambda - 1) d/c."""
    return x * s_d / s_c


step = focal.steps(units="1", source=POSITION)
step(product, "weight", "rho b", "Rho times NB, scaled", x="rho", y="s_b")


def weighted(weight: Any, u: Any, s_a: Any, v: Any) -> Any:
    """Sum of the directions of MA and NB, weighted."""
    return weight * u + s_a * v


step(weighted, "bars_x", "(rho b u + a v)_x", u="u_x", v="v_x")
step(weighted, "bars_y", "(rho b u + a v)_y", u="u_y", v="v_y")


@focal.quantity(units="1", symbol="2 a d/(b c)", source=POSITION, internal=True)
def sine_lever(s_a: Any, s_b: Any, s_c: Any, s_d: Any) -> Any:
    """Sine of the angle at B over the area of ABN over a d."""
    return 2.0 * (s_a / s_b) * (s_d / s_c)


@focal.quantity(units="1", symbol="sin(AB, NB)", source=POSITION, internal=True)
def sine_B(sine_lever: Any, bar_sigma: Any, branch_sign: Any) -> Any:
    """Sine of the angle from AB to NB, which no difference of their directions gives where both are long."""
    return branch_sign * (sine_lever * bar_sigma)


@focal.quantity(units="1", symbol="sin(MA, AB)", source=POSITION, internal=True)
def sine_A(bar_AB_v: Any, c: Any) -> Any:
    """Sine of the angle from MA to AB."""
    return bar_AB_v / c


@focal.quantity(units="1", symbol="w_x", source=f"{WUNDERLICH}, eqs. (1.3), (1.4)", internal=True)
def along_bars(QP_x: Any, e_y: Any, bars_x: Any, bars_y: Any) -> Any:
    """Minus the cosine of omega, but for a factor with the sign of lambda."""
    return QP_x * bars_x + e_y * bars_y


@focal.quantity(units="1", symbol="w_y", source=f"{WUNDERLICH}, eqs. (1.3), (1.4)", internal=True)
def across_bars(QP_x: Any, e_y: Any, bars_x: Any, bars_y: Any) -> Any:
    """Minus the sine of omega, but for the same factor."""
    return e_y * bars_x - QP_x * bars_y


@focal.quantity(units="1", symbol="1/|..|", source=POSITION, internal=True)
def per_bars(along_bars: Any, across_bars: Any, lambda_sign: Any) -> Any:
    """Reciprocal of that factor: both make a direction, however few digits are left of them."""
    return -lambda_sign / sqrt(along_bars * along_bars + across_bars * across_bars)


step = focal.steps(units="1", source=f"{WUNDERLICH}, eqs. (1.3), (1.4)")
step(product, "closing_x", "cos omega", "Cosine of omega", x="along_bars", y="per_bars")
step(
    product, "closing_y", "sin omega", "Sine of omega, right to roundings of 1", x="across_bars", y="per_bars"
)


# -- the sine of omega, small where two long bars are nearly in line ------------------------------------------------


@focal.quantity(units="1", symbol="(1 + |t|)(|rho| b + a)/4", source=POSITION, internal=True)
def bars_scale(t: Any, weight: Any, s_a: Any) -> Any:
    """A quarter of what both vectors are at most, if nothing cancels."""
    return 0.25 * ((1.0 + abs(t)) * (abs(weight) + s_a))


@focal.quantity(units="1", symbol="w_y", source=f"{WUNDERLICH}, eqs. (1.3), (1.4)", internal=True)
def across_by_sines(
    bars_scale: Any, along_bars: Any, across_bars: Any, weight: Any, s_a: Any, sine_A: Any, sine_B: Any, t: Any,
    bars_y: Any,
) -> Any:  # fmt: skip
    """The same as `across_bars`, with e across u and v known as the sines of the angles at A and B."""
    # where P and Q nearly meet both vectors cancel, and their quotient has to be that of the same two
    by_sines = (weight * sine_A - s_a * sine_B) - t * bars_y
    return select(abs(along_bars) > bars_scale, by_sines, across_bars)


step(product, "closing_sine", "sin omega", "Sine of omega", x="across_by_sines", y="per_bars")


def crank_x(crank_sign: Any, uwv_x: Any, uwv_y: Any, e_x: Any, e_y: Any) -> Any:
    """First component of the direction of SF, -k u v w/e."""
    return -crank_sign * (uwv_x * e_x + uwv_y * e_y)


def crank_y(crank_sign: Any, uwv_x: Any, uwv_y: Any, e_x: Any, e_y: Any) -> Any:
    """Second component of the direction of SF."""
    return crank_sign * (uwv_x * e_y - uwv_y * e_x)


declare_products(focal, "closing")
step = focal.steps(units="1", source=POSITION)
step.vector((crank_x, crank_y), "g_*", "g_*", "Direction of SF")


# -- rates ----------------------------------------------------------------------------------------------------------


rate = focal.quantities(units="rad s-1", source=POSITION)
rate(product, "psi_rate", "d psi/dt", "Angular velocity of NB", x="omega", y="dpsi_dphi")
rate(product, "sigma_rate", "d sigma/dt", "Angular velocity of the crank SF", x="omega", y="dsigma_dphi")
