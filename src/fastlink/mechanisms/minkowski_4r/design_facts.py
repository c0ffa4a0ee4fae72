"""Facts of one design of the Minkowskian 4R: scaled lengths, limits, and what the loop takes from them.

Lengths are divided by a power of two near the longest. The limits of theta are told as sinh^2(theta/2), in twice the
working precision, times kappa, the power of two of a g: so that a quotient of the most unequal lengths is no overflow.
"""

from __future__ import annotations

from typing import Any

from fastlink.mechanisms import lengths
from fastlink.mechanisms.minkowski_4r.declare import LINKS, NUMERICS, minkowski_4r
from fastlink.numerics.compensated import gap, gap_product_quotient, power_of_two_below

POSITION = f"{NUMERICS}#position"
SCALING = f"{NUMERICS}#scaling"

_FOUR = {f"a{_k}": _name for _k, _name in enumerate(LINKS, 1)}
_SHARED: tuple[tuple[Any, str], ...] = ((lengths.valid, "1"), (lengths.lift, "1"), (lengths.unit, "m"))
for _law, _units in _SHARED:
    minkowski_4r.quantity(units=_units, symbol=_law.__name__, source=SCALING, internal=True, given=_FOUR)(
        _law
    )

for _name, _link in LINKS.items():
    minkowski_4r.quantity(
        units="1",
        symbol=f"s_{_name}",
        source=SCALING,
        internal=True,
        name=f"s_{_name}",
        meaning=f"scaled hyperbolic length of the {_link}",
        given={"length": _name},
    )(lengths.scaled)


def power_of_two(length: Any) -> Any:
    """The power of two at or below a scaled length."""
    return power_of_two_below(length)


def fraction(length: Any, power: Any) -> Any:
    """A scaled length over its power of two."""
    return length / power


for _name in ("a", "g"):
    for _law, _suffix, _given in (
        (power_of_two, "two", {"length": f"s_{_name}"}),
        (fraction, "one", {"length": f"s_{_name}", "power": f"{_name}_two"}),
    ):
        minkowski_4r.quantity(
            units="1",
            symbol=f"{_name}_{_suffix}",
            source=SCALING,
            internal=True,
            name=f"{_name}_{_suffix}",
            given=_given,
        )(_law)


@minkowski_4r.quantity(units="1", symbol="kappa", source=SCALING, internal=True)
def product_two(a_two: Any, g_two: Any) -> Any:
    """Power of two of the product of input crank and ground link."""
    return a_two * g_two


@minkowski_4r.quantity(units="1", symbol="c", source=SCALING, internal=True)
def product_one(a_one: Any, g_one: Any) -> Any:
    """Twice the product of input crank and ground link over its power of two."""
    return 2.0 * (a_one * g_one)


@minkowski_4r.quantity(units="1", symbol="-s_h", source=SCALING, internal=True)
def minus_s_h(s_h: Any) -> Any:
    """Minus the scaled hyperbolic length of the coupler."""
    return -s_h


def limit(s_a: Any, s_b: Any, s_g: Any, reach: Any, a_one: Any, g_one: Any, valid: Any) -> Any:
    """Return (g - a - b - h) (g - a + b + h) kappa/(4 a g)."""
    f, f_low = gap(s_g, -s_a, -s_b, -reach)
    k, k_low = gap(s_g, -s_a, s_b, reach)
    high, low = gap_product_quotient(f, f_low, k, k_low, a_one, g_one)
    return high * valid, low


for _name, _of, _reach in (("inner", "theta_min", "s_h"), ("outer", "theta_max", "minus_s_h")):
    minkowski_4r.quantity(
        units="1",
        symbol="S_0",
        source=POSITION,
        internal=True,
        name=f"{_name}_limit",
        meaning=f"kappa sinh^2({_of}/2), negative if there is no such limit",
        given={"reach": _reach},
        low=f"{_name}_limit_low",
    )(limit)


@minkowski_4r.quantity(units="1", symbol="g/a", source=POSITION, internal=True, low="ground_share_low")
def ground_share(s_g: Any, s_a: Any) -> Any:
    """Ground link over input crank."""
    return gap_product_quotient(s_g, 0.0, 4.0, 0.0, s_a, 1.0)


def arm_share(length: Any, g_one: Any) -> Any:
    """Return the length over 2 a g/kappa, times the fraction of a."""
    return length / (2.0 * g_one)


for _name, _length in (("b_share", "s_b"), ("h_share", "s_h")):
    minkowski_4r.quantity(
        units="1",
        symbol=_name,
        source=POSITION,
        internal=True,
        name=_name,
        meaning=f"length of the {LINKS[_name[0]]} in units of the roots of the quadratic",
        given={"length": _length},
    )(arm_share)


def arm_product(length: Any, other: Any, product_one: Any) -> Any:
    """Return length (length + other) kappa/(2 a g)."""
    return length * (length + other) / product_one


for _name, _given in (
    ("CB_inner", {"length": "s_b", "other": "s_h"}),
    ("CB_outer", {"length": "s_b", "other": "minus_s_h"}),
    ("AB_inner", {"length": "s_h", "other": "s_b"}),
    ("AB_outer", {"length": "minus_s_h", "other": "s_b"}),
):
    minkowski_4r.quantity(
        units="1",
        symbol="b (b + h)",
        source=POSITION,
        internal=True,
        name=_name,
        meaning=f"half the middle coefficient of the quadratic of {_name[:2]} at the {_name[3:]} limit",
        given=_given,
    )(arm_product)
