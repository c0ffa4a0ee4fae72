"""Facts of one design of the focal mechanism: all its lengths, over a power of two near the four-bar's longest."""

from __future__ import annotations

from typing import Any

from fastlink.mechanisms._shared.laws import product, same
from fastlink.mechanisms._shared.reuse import borrow
from fastlink.mechanisms.focal.inputs import DESIGN, GIVEN_S, LINKS, WUNDERLICH, focal
from fastlink.mechanisms.planar_4r import planar_4r
from fastlink.numerics.compensated import sum_of_four
from fastlink.numerics.elementary import NOT_A_NUMBER, select, sqrt

SCALING = f"{DESIGN}#numerics"

#: The four-bar MABN as a planar 4R: its lengths, and the other names that differ here.
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

LABELS: dict[str, dict[str, Any]] = {"valid": {}, "assembles": {}}
for _name, _here in SCALED.items():
    _meaning = f"scaled length of the {LINKS[_here[-1]]}"
    LABELS[_name] = {"symbol": _here, "meaning": _meaning, "source": SCALING}
borrow(focal, planar_4r, FOUR_BAR, PREFIX, LABELS)


def carried(length: Any, lambda_: Any, x: Any, rho: Any) -> Any:
    """Distance of P or Q from the pivot of its rocker, scaled."""
    return select((x / rho > 0.0) & (lambda_ != 0.0), length / lambda_, NOT_A_NUMBER)


step = focal.steps(units="1", source=f"{WUNDERLICH}, eq. (2.5)")
step(carried, "s_m", "m", "scaled length MP along MA", length="s_a")
step(carried, "s_n", "n", "scaled length NQ along NB", length="s_b")


@focal.quantity(units="1", symbol="p", source=f"{WUNDERLICH}, eqs. (1.9), (2.6)", internal=True)
def s_p(ratio_sign: Any, root_rho: Any, root_x: Any, s_n: Any) -> Any:
    """Scaled length PF, of the sign of rho."""
    return ratio_sign * (root_rho * root_x * abs(s_n))


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
    share = select(abs(rho) < 2.0, rho / rho_plus_1, 1.0 - 1.0 / rho_plus_1)
    return select((rho_plus_1 == 0.0) | (valid != 1.0), NOT_A_NUMBER, share)


@focal.quantity(units="1", symbol="s", source=f"{WUNDERLICH}, eq. (1.9)", internal=True)
def s_s(s_d: Any, T_share: Any) -> Any:
    """Scaled position of the crank support S on MN."""
    return s_d * T_share


def share_of_support(s: Any, d: Any, valid: Any) -> Any:
    """Share s/d of MS in MN, and of AT in AB."""
    return select(valid == 1.0, s / d, NOT_A_NUMBER)


by_support = focal.steps(units="1", source=f"{WUNDERLICH}, eq. (3.2)", variant=GIVEN_S)
by_support(share_of_support, "T_share", "AT/AB")


# -- quantities ----------------------------------------------------------------------------------------------


@focal.quantity(units="m", symbol="unit/lift", source=SCALING, internal=True)
def scale(unit: Any, lift: Any) -> Any:
    """The length that scaled lengths are multiples of: a power of two."""
    return unit / lift


def length_of(scaled: Any, scale: Any) -> Any:
    """A length from its scaled length."""
    return scaled * scale


length = focal.quantities(units="m", source=f"{WUNDERLICH}, eq. (2.5)")
length(length_of, "m", "m", "Distance MP along MA, negative beyond M", scaled="s_m")
length(length_of, "n", "n", "Distance NQ along NB, negative beyond N", scaled="s_n")
length = focal.quantities(units="m", source=f"{WUNDERLICH}, eqs. (1.9), (2.6)")
length(length_of, "p", "p", "Length PF, of the sign of rho (see docs/focal.md)", scaled="s_p")
length(length_of, "q", "q", "Length QF", scaled="s_q")
length = focal.quantities(units="m", source=f"{WUNDERLICH}, eq. (1.8)")
length(length_of, "r", "r", "Length SF, radius of the circle of F: the crank", scaled="s_r")
length = focal.quantities(units="m", source=f"{WUNDERLICH}, section 3")
length(length_of, "FT", "FT", "Length FT", scaled="s_FT")
length = focal.quantities(units="m", source=f"{WUNDERLICH}, eqs. (1.8) corrected, (1.9)")
length(length_of, "s", "s", "Crank support S on MN, from M towards N", scaled="s_s")
length(same, "S_x", "S_x", "Crank support S, x", x="s")
by_support = focal.quantities(units="m", source=f"{WUNDERLICH}, eq. (1.9)", variant=GIVEN_S)
by_support(product, "S_x", "S_x", "Crank support S, x", x="s_s", y="scale")


@focal.quantity(units="1", symbol="AT/AB", source=f"{WUNDERLICH}, eq. (3.2)")
def T_ratio(T_share: Any) -> Any:
    """Share of AT in AB, the same as that of MS in MN."""
    return T_share


def height(s_a: Any, s_b: Any, c: Any, s_d: Any, valid: Any, scale: Any) -> Any:
    """Height of a trapezoid with the sides a = b, the base d and the other base c."""
    near, _low = sum_of_four(s_a, s_a, -s_d, c)
    far, _low = sum_of_four(s_a, s_a, s_d, -c)
    symmetric = (s_a == s_b) & (valid == 1.0)
    return select(symmetric, 0.5 * sqrt(near) * sqrt(far) * scale, NOT_A_NUMBER)


@focal.quantity(units="1", symbol="-c", source=f"{WUNDERLICH}, eq. (6.2)", internal=True)
def minus_s_c(s_c: Any) -> Any:
    """Minus the scaled length of the coupler."""
    return -s_c


_H1 = "Distance of parallel MN and AB where a = b, NaN of others"
_H2 = "Distance of parallel MN and the opposite AB where a = b, NaN of others"
trapezoid = focal.quantities(units="m", source=f"{WUNDERLICH}, eq. (6.2)")
trapezoid(height, "h1", "h_1", _H1, c="s_c")
trapezoid(height, "h2", "h_2", _H2, c="minus_s_c")


@focal.quantity(units="m", symbol="x", source=f"{WUNDERLICH}, eq. (7.5) corrected")
def line_x(s_a: Any, s_b: Any, s_d: Any, lambda_: Any, rho_plus_1: Any, scale: Any) -> Any:
    """Place of the straight line that F moves on, x; NaN unless rho is -1."""
    offset = (s_a - s_b) * (s_a + s_b) / (lambda_ * s_d)
    on_a_line = (rho_plus_1 == 0.0) & (lambda_ != 0.0)
    return select(on_a_line, 0.5 * (s_d + offset) * scale, NOT_A_NUMBER)
