"""Driven by the crank SF: |MF| gives omega, both dyads turn with it, and AB closes by itself.

    u = z/(m - p w),  v = (z - d)/(n + q w),  z = s + r exp(i sigma),

where both sides of a quotient have one length.
"""

from __future__ import annotations

from typing import Any

from fastlink.mechanisms._shared.laws import (
    angle,
    difference,
    half,
    opposite,
    opposite_product,
    product,
    same,
    total,
    twice,
)
from fastlink.mechanisms._shared.reuse import borrow_tables
from fastlink.mechanisms.focal.by_crank import by_crank
from fastlink.mechanisms.focal.dyad import DYAD
from fastlink.mechanisms.focal.inputs import WUNDERLICH
from fastlink.mechanisms.focal.points import FIGURES, POSITION
from fastlink.mechanisms.planar_4r import planar_4r
from fastlink.numerics.elementary import sqrt

SIGMA = by_crank.position.name
#: The tables of the planar 4R, by their names here.
TABLES = {"cos_theta1": "g_x", "sin_theta1": "g_y", "Z": "Z", "C": "C"}

borrow_tables(by_crank, planar_4r, TABLES)

# -- w ----------------------------------------------------------------------------------------------------------


def mixed(at_0: Any, at_pi: Any, C: Any, Z: Any) -> Any:
    """Value that is linear in the cosine of sigma, from its values at 0 and pi."""
    return at_0 * C + at_pi * Z


step = by_crank.steps(units="1", source=f"{WUNDERLICH}, eq. (1.5); {DYAD}")
_SINE = {"at_0": "sine_at_0", "at_pi": "sine_at_pi"}
_COSINE = {"at_0": "cosine_at_0", "at_pi": "cosine_at_pi"}
step(mixed, "squared_half_sine", "sine^2(omega/2)", "Squared sine of omega/2", **_SINE)
step(mixed, "squared_half_cosine", "cosine^2(omega/2)", "Squared cosine of omega/2", **_COSINE)
step = by_crank.steps(units="1", source=f"{WUNDERLICH}, eq. (1.5)")
step(difference, "w_x", "cos omega", "Cosine of omega", x="squared_half_cosine", y="squared_half_sine")
step(twice, "size_of_sine", "|sin omega|", "Sine of omega without its sign", x="half_sine_omega")
step(product, "w_y", "sin omega", "Sine of omega", x="omega_sign", y="size_of_sine")


@by_crank.quantity(units="1", symbol="|sin omega|/2", source=f"{WUNDERLICH}, eq. (1.5)", internal=True)
def half_sine_omega(squared_half_sine: Any, squared_half_cosine: Any) -> Any:
    """Half the sine of omega without its sign; NaN where the dyads do not close."""
    return sqrt(squared_half_sine * squared_half_cosine)


@by_crank.quantity(units="1", symbol="2/|sin omega|", source=f"{WUNDERLICH}, eq. (1.5)", internal=True)
def per_half_sine(half_sine_omega: Any) -> Any:
    """Reciprocal of half the sine of omega; infinite at a dead centre."""
    return 1.0 / half_sine_omega


@by_crank.quantity(units="1", symbol="sgn omega", source=POSITION, internal=True)
def omega_sign(branch: Any) -> Any:
    """Sign of omega: 1 in branch 1, -1 in branch 2."""
    return 3.0 - 2.0 * branch


# -- u, v, e ------------------------------------------------------------------------------------------------------


step = by_crank.steps(units="1", source=f"{WUNDERLICH}, eq. (1.7)")
step(mixed, "MF_x", "z_x", "Vector from M to F, scaled, x", at_0="MF_at_0", at_pi="MF_at_pi")
step(mixed, "NF_x", "(z - d)_x", "Vector from N to F, scaled, x", at_0="NF_at_0", at_pi="NF_at_pi")
step(product, "MF_y", "z_y", "Vector from M to F, scaled, y", x="s_r", y="g_y")


def swing(of_sine: Any, of_cosine: Any, squared_half_sine: Any, squared_half_cosine: Any) -> Any:
    """Part of F seen from M or N along the rocker that changes with omega."""
    return of_sine * squared_half_sine + of_cosine * squared_half_cosine


step = by_crank.steps(units="1", source=f"{WUNDERLICH}, eqs. (1.3), (1.4)")
step(swing, "swing_M", "(m - p w)_x", of_sine="M_of_sine", of_cosine="M_of_cosine")
step(swing, "swing_N", "(n + q w)_x", of_sine="N_of_sine", of_cosine="N_of_cosine")
step(total, "dyad_M_x", "(m - p w)_x", "F seen from M, scaled, along MP", x="straight_M", y="swing_M")
step(total, "dyad_N_x", "(n + q w)_x", "F seen from N, scaled, along NQ", x="straight_N", y="swing_N")
across = by_crank.steps(units="1", source=f"{WUNDERLICH}, eq. (1.3)")
across(opposite, "dyad_M_y", "(m - p w)_y", "F seen from M and MP, scaled, across MP", x="MF_across")
across = by_crank.steps(units="1", source=f"{WUNDERLICH}, eq. (1.4)")
across(product, "dyad_N_y", "(n + q w)_y", "F seen from N and NQ, scaled, across NQ", x="s_q", y="w_y")


def per_lengths(x: Any, y: Any, dyad_x: Any, bar: Any, size_of_sine: Any) -> Any:
    """Reciprocal of the product of two equal lengths, of both signs of omega."""
    dyad_y = bar * size_of_sine
    return 1.0 / sqrt((x * x + y * y) * (dyad_x * dyad_x + dyad_y * dyad_y))


def turned_x(x: Any, y: Any, dyad_x: Any, dyad_y: Any, per: Any) -> Any:
    """First component of a quotient of two vectors of one length."""
    return (x * dyad_x + y * dyad_y) * per


def turned_y(x: Any, y: Any, dyad_x: Any, dyad_y: Any, per: Any) -> Any:
    """Second component of a quotient of two vectors of one length."""
    return (y * dyad_x - x * dyad_y) * per


def declare_rocker(name: str, pivot: str, rocker: str, bar: str) -> None:
    """Declare the direction of a rocker: that of F from its pivot over that of the dyad."""
    per = f"per_{pivot}F"
    vectors = {"x": f"{pivot}F_x", "y": "MF_y", "dyad_x": f"dyad_{pivot}_x", "dyad_y": f"dyad_{pivot}_y"}
    step(per_lengths, per, f"1/{pivot}F^2", f"1/{pivot}F^2, scaled", bar=bar, **vectors)
    step(turned_x, f"{name}_x", f"{name}_x", f"Direction of {rocker}", per=per, **vectors)
    step(turned_y, f"{name}_y", f"{name}_y", f"Direction of {rocker}", per=per, **vectors)


declare_rocker("u", "M", "MA", "s_p")
declare_rocker("v", "N", "NB", "s_q")

# -- angles --------------------------------------------------------------------------------------------------

direction = by_crank.quantities(units="rad", source=FIGURES)
direction(angle, "phi", "phi", "Direction of MA in the ground frame", x="u_x", y="u_y")
direction(angle, "psi", "psi", "Direction of NB in the ground frame", x="v_x", y="v_y")

# -- rates --------------------------------------------------------------------------------------------------------


def rate(
    s_r: Any, base: Any, g_y: Any, x: Any, y: Any, at_0: Any, C: Any, at_pi: Any, Z: Any,
    straight_lever: Any, swing: Any, bar: Any, per_half_sine: Any, omega_sign: Any,
) -> Any:  # fmt: skip
    """Return how fast a rocker turns: as the line from its pivot to F, and as omega changes."""
    lever = straight_lever + swing / bar
    turning = omega_sign * ((0.5 * base) * (g_y * lever) * per_half_sine)
    along_crank = at_0 * C - at_pi * Z
    return s_r * (along_crank + turning) / (x * x + y * y)


def declare_rate(name: str, pivot: str, rocker: str, base: str, bar: str) -> None:
    """Declare how fast a rocker turns."""
    ratio = f"d{name}_dsigma"
    labels = ratio, f"d {name}/d sigma", f"Angular velocity of {rocker} over that of the crank SF"
    given = {"at_0": f"{pivot}F_at_0", "at_pi": f"{pivot}F_at_pi"}
    given |= {"base": base, "bar": bar, "x": f"{pivot}F_x", "y": "MF_y", "swing": f"swing_{pivot}"}
    quantity = by_crank.quantities(units="1", source=POSITION)
    quantity(rate, *labels, straight_lever=f"straight_lever_{pivot}", **given)
    velocity = by_crank.quantities(units="rad s-1", source=POSITION)
    velocity(product, f"{name}_rate", f"d {name}/dt", f"Angular velocity of {rocker}", x="omega", y=ratio)
    by_crank.derivatives(SIGMA)(same, name, x=ratio)


declare_rate("phi", "M", "MA", "s_s", "s_p")
declare_rate("psi", "N", "NB", "s_NS", "minus_s_q")


step = by_crank.steps(units="1", source=POSITION)
step(half, "half_sine", "sin(sigma)/2", "Half the sine of sigma", x="g_y")


@by_crank.quantity(units="1", symbol="-sr/(mp)", source=DYAD, internal=True)
def sine_change(s_s: Any, s_r: Any, s_m: Any, s_p: Any) -> Any:
    """How much sin^2(omega/2) grows over half a turn."""
    return -((s_s / s_m) * (s_r / s_p))


# of tables, and of the facts that replace them in the graded range
for _set in (None, "graded"):
    derivative = by_crank.derivatives(SIGMA, variant=_set)
    derivative(same, "Z", x="half_sine")
    derivative(opposite, "C", x="half_sine")
    derivative(opposite, "g_x", x="g_y")
    derivative(same, "g_y", x="g_x")
    derivative(product, "squared_half_sine", x="sine_change", y="half_sine")
    derivative(opposite_product, "squared_half_cosine", x="sine_change", y="half_sine")
