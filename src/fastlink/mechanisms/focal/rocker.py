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
from fastlink.mechanisms.focal.points import FIGURES, POSITION, declare_fifth, declare_T
from fastlink.mechanisms.planar_4r import planar_4r
from fastlink.numerics.elementary import sqrt

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
LABELS |= {name: {} for name in ("AB_x", "AB_y", "DB_x", "DB_y", "per_sigma")}
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


@focal.quantity(units="1", symbol="1/|..|", source=POSITION, internal=True)
def per_bars(QP_x: Any, e_y: Any, bars_x: Any, bars_y: Any, lambda_sign: Any) -> Any:
    """Reciprocal of the lengths of both vectors, with the sign of -lambda."""
    lengths = sqrt((QP_x * QP_x + e_y * e_y) * (bars_x * bars_x + bars_y * bars_y))
    return -lambda_sign / lengths


@focal.quantity(units="1", symbol="cos omega", source=f"{WUNDERLICH}, eqs. (1.3), (1.4)", internal=True)
def closing_x(QP_x: Any, e_y: Any, bars_x: Any, bars_y: Any, per_bars: Any) -> Any:
    """Cosine of omega."""
    return (QP_x * bars_x + e_y * bars_y) * per_bars


@focal.quantity(units="1", symbol="sin omega", source=f"{WUNDERLICH}, eqs. (1.3), (1.4)", internal=True)
def closing_y(QP_x: Any, e_y: Any, bars_x: Any, bars_y: Any, per_bars: Any) -> Any:
    """Sine of omega."""
    return (e_y * bars_x - QP_x * bars_y) * per_bars


declare_fifth(focal, "g", "SF", "e", "closing")


step = focal.steps(units="m", source=f"{WUNDERLICH}, eq. (3.2)")
step(product, "AT", "AT", "Distance of T from A along AB", x="T_share", y="c")


declare_T(focal, "A", "AT", "e")

# -- rates ----------------------------------------------------------------------------------------------------------


rate = focal.quantities(units="rad s-1", source=POSITION)
rate(product, "psi_rate", "d psi/dt", "Angular velocity of NB", x="omega", y="dpsi_dphi")
rate(product, "sigma_rate", "d sigma/dt", "Angular velocity of the crank SF", x="omega", y="dsigma_dphi")
