"""Facts of one design of the Minkowskian 4R: scaled lengths, limits, and the constants of the loop.

Lengths are divided by a power of two near the longest. The limits of theta are given as sinh^2(theta/2), in twice the
working precision, times kappa, the power of two of a g: so that quotients of unequal lengths do not overflow.
"""

from __future__ import annotations

from typing import Any

from fastlink.mechanisms._shared import lengths
from fastlink.mechanisms._shared.laws import opposite
from fastlink.mechanisms.minkowski_4r.inputs import LINKS, NUMERICS, minkowski_4r
from fastlink.numerics.compensated import gap_product_quotient, power_of_two_below, sum_of_four

POSITION = f"{NUMERICS}#position"
SCALING = f"{NUMERICS}#scaling"

step = minkowski_4r.steps(units="1", source=SCALING)
step(lengths.valid, "valid", "valid", a1="a", a2="b", a3="g", a4="h")
step(lengths.lift, "lift", "lift", a1="a", a2="b", a3="g", a4="h")
step(lengths.unit, "unit", "unit", a1="a", a2="b", a3="g", a4="h", units="m")
step(lengths.scaled, "s_a", "s_a", f"scaled hyperbolic length of the {LINKS['a']}", length="a")
step(lengths.scaled, "s_b", "s_b", f"scaled hyperbolic length of the {LINKS['b']}", length="b")
step(lengths.scaled, "s_g", "s_g", f"scaled hyperbolic length of the {LINKS['g']}", length="g")
step(lengths.scaled, "s_h", "s_h", f"scaled hyperbolic length of the {LINKS['h']}", length="h")


def power_of_two(length: Any) -> Any:
    """The power of two at or below a scaled length."""
    return power_of_two_below(length)


def fraction(length: Any, power: Any) -> Any:
    """A scaled length over its power of two."""
    return length / power


step(power_of_two, "a_two", "a_two", length="s_a")
step(power_of_two, "g_two", "g_two", length="s_g")
step(fraction, "a_one", "a_one", length="s_a", power="a_two")
step(fraction, "g_one", "g_one", length="s_g", power="g_two")


@minkowski_4r.quantity(units="1", symbol="kappa", source=SCALING, internal=True)
def product_two(a_two: Any, g_two: Any) -> Any:
    """Power of two of the product of input crank and ground link."""
    return a_two * g_two


@minkowski_4r.quantity(units="1", symbol="c", source=SCALING, internal=True)
def product_one(a_one: Any, g_one: Any) -> Any:
    """Twice the product of input crank and ground link over its power of two."""
    return 2.0 * (a_one * g_one)


step(opposite, "minus_s_h", "-s_h", "Minus the scaled hyperbolic length of the coupler", x="s_h")


def limit(s_a: Any, s_b: Any, s_g: Any, reach: Any, a_one: Any, g_one: Any, valid: Any) -> Any:
    """Return (g - a - b - h) (g - a + b + h) kappa/(4 a g)."""
    f, f_low = sum_of_four(s_g, -s_a, -s_b, -reach)
    k, k_low = sum_of_four(s_g, -s_a, s_b, reach)
    high, low = gap_product_quotient(f, f_low, k, k_low, a_one, g_one)
    return high * valid, low


step = minkowski_4r.steps(units="1", source=POSITION)
_NONE = "negative if there is no such limit"
_INNER, _OUTER = f"kappa sinh^2(theta_min/2), {_NONE}", f"kappa sinh^2(theta_max/2), {_NONE}"
step(limit, "inner_limit", "S_0", _INNER, reach="s_h", low="inner_limit_low")
step(limit, "outer_limit", "S_0", _OUTER, reach="minus_s_h", low="outer_limit_low")


@minkowski_4r.quantity(units="1", symbol="g/a", source=POSITION, internal=True, low="ground_share_low")
def ground_share(s_g: Any, s_a: Any) -> Any:
    """Ground link over input crank."""
    return gap_product_quotient(s_g, 0.0, 4.0, 0.0, s_a, 1.0)


def arm_share(length: Any, g_one: Any) -> Any:
    """Return the length over 2 a g/kappa, times the fraction of a."""
    return length / (2.0 * g_one)


_UNITS = "in units of the roots of the quadratic"
step(arm_share, "b_share", "b_share", f"length of the {LINKS['b']} {_UNITS}", length="s_b")
step(arm_share, "h_share", "h_share", f"length of the {LINKS['h']} {_UNITS}", length="s_h")


def arm_product(length: Any, other: Any, product_one: Any) -> Any:
    """Return length (length + other) kappa/(2 a g)."""
    return length * (length + other) / product_one


_CB = "half the middle coefficient of the quadratic of CB"
_AB = "half the middle coefficient of the quadratic of AB"
step(arm_product, "CB_inner", "b (b + h)", f"{_CB} at the inner limit", length="s_b", other="s_h")
step(arm_product, "CB_outer", "b (b + h)", f"{_CB} at the outer limit", length="s_b", other="minus_s_h")
step(arm_product, "AB_inner", "b (b + h)", f"{_AB} at the inner limit", length="s_h", other="s_b")
step(arm_product, "AB_outer", "b (b + h)", f"{_AB} at the outer limit", length="minus_s_h", other="s_b")
