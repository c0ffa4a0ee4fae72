"""Driven by the rocker MA: the four-bar MABN is a planar 4R, which gives u, v and e; w closes the dyads of F.

P and Q divide MA and NB alike, so that PQ is -(AB + (lambda - 1) MN)/lambda, and of (1.3), (1.4) is left

    w = -sgn(lambda) (e + t)/|e + t| (|rho b u + a v|/(rho b u + a v)),    t = (lambda - 1) d/c.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from fastlink.jit import select, sqrt
from fastlink.mechanisms.borrow import borrow, renaming
from fastlink.mechanisms.focal.declare import WUNDERLICH, focal
from fastlink.mechanisms.focal.design_facts import FOUR_BAR, PREFIX
from fastlink.mechanisms.focal.points import FIGURES, POSITION, angle, declare_fifth, product
from fastlink.mechanisms.planar_4r import planar_4r
from fastlink.mechanisms.planar_4r.slopes import same

PHI = focal.position.name
#: What the planar 4R calls otherwise.
NAMES = FOUR_BAR | {"cos_theta1": "u_x", "sin_theta1": "u_y", "DB_x": "NB_x", "DB_y": "NB_y"}
NAMES |= {
    "output_ratio": "dpsi_dphi",
    **{name: name for name in ("Z", "C", "Z_low", "C_low", "A_x", "A_y", "AB_x", "AB_y", "branch_sign")},
    **{name: name for name in ("from_low", "from_high", "side")},
}
RENAME = renaming(planar_4r, NAMES, PREFIX)

for _table in planar_4r.tables.values():
    focal.tables[RENAME(_table.name)] = replace(
        _table, name=RENAME(_table.name), needs=(PHI,), symbol=_table.symbol.replace("theta_1", "phi")
    )
focal.table_low_parts = {RENAME(low): RENAME(name) for low, name in planar_4r.table_low_parts.items()}

DIRECTION_OF_NB = {
    "symbol": "psi",
    "meaning": "direction of NB in the ground frame",
    "source": f"{WUNDERLICH}, eq. (2.2)",
}
RATIO = {
    "symbol": "d psi/d phi",
    "meaning": "angular velocity of NB over that of MA",
    "source": f"{WUNDERLICH}, eq. (2.4), differentiated",
    "internal": False,
}
borrow(
    focal,
    planar_4r,
    NAMES,
    PREFIX,
    {
        "AB_x": {},
        "AB_y": {},
        "DB_x": {},
        "DB_y": {},
        "per_sigma": {},
        "theta4": DIRECTION_OF_NB,
        "output_ratio": RATIO,
    },
)


def share(x: Any, length: Any) -> Any:
    """Component of a direction."""
    return x / length


for _bar, _of, _length in (("v", "NB", "b"), ("e", "AB", "c")):
    for _axis in "xy":
        focal.quantity(
            units="1",
            symbol=f"{_bar}_{_axis}",
            source=FIGURES,
            internal=True,
            name=f"{_bar}_{_axis}",
            meaning=f"Direction of {_of}, {_axis}",
            given={"x": f"{_of}_{_axis}", "length": _length},
        )(share)


# -- w ----------------------------------------------------------------------------------------------------------


@focal.quantity(units="1", symbol="t", source=POSITION, internal=True)
def t(x: Any, s_c: Any, s_d: Any) -> Any:
    """(lambda - 1) d/c."""
    return x * s_d / s_c


@focal.quantity(units="1", symbol="rho b", source=POSITION, internal=True)
def weight(rho: Any, s_b: Any) -> Any:
    """Rho times NB, scaled."""
    return rho * s_b


@focal.quantity(units="1", symbol="x", source=POSITION, internal=True)
def QP_x(e_x: Any, t: Any) -> Any:
    """Vector from P to Q over c, times lambda, x."""
    return e_x + t


def weighted(weight: Any, u: Any, s_a: Any, v: Any) -> Any:
    """Sum of the directions of MA and NB, weighted."""
    return weight * u + s_a * v


for _axis in "xy":
    focal.quantity(
        units="1",
        symbol=f"(rho b u + a v)_{_axis}",
        source=POSITION,
        internal=True,
        name=f"bars_{_axis}",
        given={"u": f"u_{_axis}", "v": f"v_{_axis}"},
    )(weighted)


@focal.quantity(units="1", symbol="1/|..|", source=POSITION, internal=True)
def per_bars(QP_x: Any, e_y: Any, bars_x: Any, bars_y: Any, lambda_sign: Any) -> Any:
    """Reciprocal of the lengths of both vectors, with the sign of -lambda."""
    lengths = sqrt((QP_x * QP_x + e_y * e_y) * (bars_x * bars_x + bars_y * bars_y))
    return -lambda_sign / lengths


@focal.quantity(units="1", symbol="cos omega", source=f"{WUNDERLICH}, eqs. (1.3), (1.4)", internal=True)
def w_x(QP_x: Any, e_y: Any, bars_x: Any, bars_y: Any, per_bars: Any) -> Any:
    """Cosine of omega."""
    return (QP_x * bars_x + e_y * bars_y) * per_bars


@focal.quantity(units="1", symbol="sin omega", source=f"{WUNDERLICH}, eqs. (1.3), (1.4)", internal=True)
def w_y(QP_x: Any, e_y: Any, bars_x: Any, bars_y: Any, per_bars: Any) -> Any:
    """Sine of omega."""
    return (e_y * bars_x - QP_x * bars_y) * per_bars


# -- the crank ----------------------------------------------------------------------------------------------------

declare_fifth(focal, "g", "SF", "e")

focal.quantity(
    units="rad",
    symbol="sigma",
    source=FIGURES,
    name="sigma",
    meaning="Direction of the crank SF in the ground frame",
    given={"x": "g_x", "y": "g_y"},
)(angle)


# -- F: from S, or from M where that is nearer than S may be ----------------------------------------------------------


@focal.quantity(units="1", symbol="|s| + r", source=POSITION, internal=True)
def near_crank(s_s: Any, s_r: Any, s_m: Any, s_p: Any) -> Any:
    """1 where S is nearer to F than P may be, 0 otherwise."""
    return select(abs(s_s) + s_r < abs(s_m) + abs(s_p), 1.0, 0.0)


def of_crank(near_crank: Any, length: Any) -> Any:
    """A length where F is taken from S, else 0."""
    return select(near_crank == 1.0, length, 0.0)


def of_dyad(near_crank: Any, length: Any) -> Any:
    """A length where F is taken from M, else 0."""
    return select(near_crank == 1.0, 0.0, length)


for _name, _law in (("S_x", of_crank), ("r", of_crank), ("m", of_dyad), ("p", of_dyad)):
    focal.quantity(
        units="m", symbol=_name, source=POSITION, internal=True, name=f"used_{_name}", given={"length": _name}
    )(_law)


@focal.quantity(units="m", symbol="F_x", source=f"{WUNDERLICH}, eqs. (1.3), (1.7)")
def F_x(used_S_x: Any, used_r: Any, g_x: Any, used_m: Any, u_x: Any, used_p: Any, f_x: Any) -> Any:
    """Joint F, x."""
    return (used_S_x + used_r * g_x) + (used_m * u_x - used_p * f_x)


@focal.quantity(units="m", symbol="F_y", source=f"{WUNDERLICH}, eqs. (1.3), (1.7)")
def F_y(used_r: Any, g_y: Any, used_m: Any, u_y: Any, used_p: Any, f_y: Any) -> Any:
    """Joint F, y."""
    return used_r * g_y + (used_m * u_y - used_p * f_y)


# -- rates ----------------------------------------------------------------------------------------------------------


@focal.quantity(
    units="1", symbol="(1 + rho) sqrt((lambda - 1)/rho) b/(2 d lambda)", source=POSITION, internal=True
)
def crank_share(rho_plus_1: Any, root_x: Any, root_rho: Any, s_b: Any, s_d: Any, lambda_: Any) -> Any:
    """Ratio of the crank's rate to sin omega over twice the area of MABN's dyad."""
    return 0.5 * rho_plus_1 * (root_x / root_rho) * (s_b / s_d) / abs(lambda_)


@focal.quantity(units="1", symbol="d sigma/d phi", source=POSITION)
def dsigma_dphi(crank_share: Any, w_y: Any, bar_per_sigma: Any, branch_sign: Any) -> Any:
    """Angular velocity of the crank SF over that of MA."""
    return branch_sign * (crank_share * w_y * bar_per_sigma)


for _name, _ratio, _symbol, _link in (
    ("psi_rate", "dpsi_dphi", "d psi/dt", "NB"),
    ("sigma_rate", "dsigma_dphi", "d sigma/dt", "the crank SF"),
):
    focal.quantity(
        units="rad s-1",
        symbol=_symbol,
        source=POSITION,
        name=_name,
        meaning=f"Angular velocity of {_link}",
        given={"x": "omega", "y": _ratio},
    )(product)


focal.derivative("sigma", PHI, given={"x": "dsigma_dphi"})(same)
