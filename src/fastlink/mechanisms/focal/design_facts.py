"""Facts of one design of the focal mechanism: all its lengths, over a power of two near the four-bar's longest."""

from __future__ import annotations

from typing import Any

from fastlink.jit import NOT_A_NUMBER, select
from fastlink.mechanisms.borrow import borrow
from fastlink.mechanisms.focal.declare import DESIGN, GIVEN_S, LINKS, WUNDERLICH, focal
from fastlink.mechanisms.planar_4r import planar_4r

SCALING = f"{DESIGN}#numerics"

#: The four-bar MABN as a planar 4R: its lengths, and what else is called otherwise here.
LENGTHS = {"a1": "a", "a2": "c", "a3": "b", "a4": "d"}
SCALED = {f"s{length[1]}": f"s_{name}" for length, name in LENGTHS.items()}
FOUR_BAR = {**LENGTHS, **SCALED, "theta1": "phi", "theta4": "psi", "omega1": "omega"}
FOUR_BAR |= {name: name for name in ("valid", "lift", "unit", "assembles", "grashof_class", "grashof_excess")}
FOUR_BAR |= {
    "theta1_low": "phi_low",
    "theta1_high": "phi_high",
    "theta4_low": "psi_low",
    "theta4_high": "psi_high",
}
#: Before the names of all other facts that are the four-bar's.
PREFIX = "bar_"

_SAID: dict[str, dict[str, Any]] = {"valid": {}, "assembles": {}}
for _name, _here in SCALED.items():
    _meaning = f"scaled length of the {LINKS[_here[-1]]}"
    _SAID[_name] = {"symbol": _here, "meaning": _meaning, "source": SCALING}
borrow(focal, planar_4r, FOUR_BAR, PREFIX, _SAID)


def carried(length: Any, lambda_: Any) -> Any:
    """Distance of P or Q from the pivot of its rocker, scaled."""
    return select(lambda_ == 0.0, NOT_A_NUMBER, length / lambda_)


for _name, _of, _meaning in (("m", "a", "MP along MA"), ("n", "b", "NQ along NB")):
    focal.quantity(
        units="1",
        symbol=_name,
        source=f"{WUNDERLICH}, eq. (2.5)",
        internal=True,
        name=f"s_{_name}",
        meaning=f"scaled length {_meaning}",
        given={"length": f"s_{_of}"},
    )(carried)


@focal.quantity(units="1", symbol="p", source=f"{WUNDERLICH}, eqs. (1.9), (2.6)", internal=True)
def s_p(sign: Any, root_rho: Any, root_x: Any, s_n: Any) -> Any:
    """Scaled length PF, of the sign of rho."""
    return sign * (root_rho * root_x * abs(s_n))


@focal.quantity(units="1", symbol="q", source=f"{WUNDERLICH}, eqs. (1.9), (2.6)", internal=True)
def s_q(root_rho: Any, root_x: Any, s_m: Any) -> Any:
    """Scaled length QF."""
    return root_x / root_rho * abs(s_m)


@focal.quantity(units="1", symbol="r", source=f"{WUNDERLICH}, eq. (1.8)", internal=True)
def s_r(root_rho: Any, root_x: Any, rho_plus_1: Any, s_c: Any, lambda_: Any) -> Any:
    """Scaled length SF."""
    none = (rho_plus_1 == 0.0) | (lambda_ == 0.0)
    return select(none, NOT_A_NUMBER, root_rho * s_c / (abs(rho_plus_1) * root_x))


@focal.quantity(units="1", symbol="FT", source=f"{WUNDERLICH}, eq. (3.2)", internal=True)
def s_FT(root_rho: Any, root_x: Any, rho_plus_1: Any, s_d: Any, lambda_: Any) -> Any:
    """Scaled length FT."""
    none = (rho_plus_1 == 0.0) | (lambda_ == 0.0)
    return select(none, NOT_A_NUMBER, root_rho * s_d * root_x / abs(rho_plus_1))


@focal.quantity(units="1", symbol="AT/AB", source=f"{WUNDERLICH}, eq. (3.2)", internal=True)
def T_share(rho: Any, rho_plus_1: Any, valid: Any) -> Any:
    """Share rho/(1 + rho) of MS in MN, and of AT in AB."""
    return select((rho_plus_1 == 0.0) | (valid != 1.0), NOT_A_NUMBER, rho / rho_plus_1)


@focal.quantity(units="1", symbol="s", source=f"{WUNDERLICH}, eq. (1.9)", internal=True)
def s_s(s_d: Any, T_share: Any) -> Any:
    """Scaled place of the crank support S on MN."""
    return s_d * T_share


@focal.quantity(
    units="1",
    symbol="AT/AB",
    source=f"{WUNDERLICH}, eq. (3.2)",
    internal=True,
    alternative=GIVEN_S,
    name="T_share",
)
def share_of_support(s: Any, d: Any, valid: Any) -> Any:
    """Share s/d of MS in MN, and of AT in AB."""
    return select(valid == 1.0, s / d, NOT_A_NUMBER)
