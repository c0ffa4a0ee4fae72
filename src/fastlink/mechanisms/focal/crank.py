"""Driven by the crank SF: |MF| gives omega, both dyads turn with it, and AB closes by itself.

    u = z/(m - p w),  v = (z - d)/(n + q w),  z = s + r exp(i sigma),

where both sides of a quotient have one length.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

from fastlink.jit import sqrt
from fastlink.mechanisms.focal.declare import WUNDERLICH
from fastlink.mechanisms.focal.drives import by_crank
from fastlink.mechanisms.focal.dyad import DYAD
from fastlink.mechanisms.focal.points import FIGURES, POSITION, along, angle, declare_fifth, product
from fastlink.mechanisms.planar_4r import planar_4r
from fastlink.mechanisms.planar_4r.slopes import opposite, same

SIGMA = by_crank.position.name
#: What the tables of the planar 4R are called here.
TABLES = {"cos_theta1": "g_x", "sin_theta1": "g_y", "Z": "Z", "C": "C"}

for _name, _here in TABLES.items():
    _table = planar_4r.tables[_name]
    by_crank.tables[_here] = replace(
        _table, name=_here, needs=(SIGMA,), symbol=_table.symbol.replace("theta_1", SIGMA)
    )

# -- w ----------------------------------------------------------------------------------------------------------


def mixed(at_0: Any, at_pi: Any, C: Any, Z: Any) -> Any:
    """What changes with the cosine of sigma, from its values at 0 and pi."""
    return at_0 * C + at_pi * Z


for _name in ("sine", "cosine"):
    by_crank.quantity(
        units="1",
        symbol=f"{_name}^2(omega/2)",
        source=f"{WUNDERLICH}, eq. (1.5); {DYAD}",
        internal=True,
        name=f"squared_half_{_name}",
        meaning=f"Squared {_name} of omega/2",
        given={"at_0": f"{_name}_at_0", "at_pi": f"{_name}_at_pi"},
    )(mixed)


@by_crank.quantity(units="1", symbol="cos omega", source=f"{WUNDERLICH}, eq. (1.5)", internal=True)
def w_x(squared_half_sine: Any, squared_half_cosine: Any) -> Any:
    """Cosine of omega."""
    return squared_half_cosine - squared_half_sine


@by_crank.quantity(units="1", symbol="|sin omega|/2", source=f"{WUNDERLICH}, eq. (1.5)", internal=True)
def half_sine_omega(squared_half_sine: Any, squared_half_cosine: Any) -> Any:
    """Half the sine of omega without its sign; NaN where the dyads do not close."""
    return sqrt(squared_half_sine * squared_half_cosine)


@by_crank.quantity(units="1", symbol="sgn omega", source=POSITION, internal=True)
def omega_sign(branch: Any) -> Any:
    """Sign of omega: 1 in branch 1, -1 in branch 2."""
    return 3.0 - 2.0 * branch


@by_crank.quantity(units="1", symbol="sin omega", source=f"{WUNDERLICH}, eq. (1.5)", internal=True)
def w_y(half_sine_omega: Any, omega_sign: Any) -> Any:
    """Sine of omega."""
    return omega_sign * (2.0 * half_sine_omega)


# -- u, v, e ------------------------------------------------------------------------------------------------------


@by_crank.quantity(units="1", symbol="z_x", source=f"{WUNDERLICH}, eq. (1.7)", internal=True)
def MF_x(s_s: Any, s_r: Any, g_x: Any) -> Any:
    """Vector from M to F, scaled, x."""
    return s_s + s_r * g_x


@by_crank.quantity(units="1", symbol="d - s", source=f"{WUNDERLICH}, eq. (1.9)", internal=True)
def SN(s_d: Any, rho_plus_1: Any) -> Any:
    """Distance from S to N, scaled."""
    return s_d / rho_plus_1


@by_crank.quantity(units="1", symbol="(z - d)_x", source=f"{WUNDERLICH}, eq. (1.7)", internal=True)
def NF_x(SN: Any, s_r: Any, g_x: Any) -> Any:
    """Vector from N to F, scaled, x."""
    return s_r * g_x - SN


by_crank.quantity(
    units="1",
    symbol="y",
    source=f"{WUNDERLICH}, eq. (1.7)",
    internal=True,
    name="SF_y",
    meaning="Height of F over MN, scaled",
    given={"x": "s_r", "y": "g_y"},
)(product)


@by_crank.quantity(units="1", symbol="(m - p w)_x", source=f"{WUNDERLICH}, eq. (1.3)", internal=True)
def dyad_M_x(s_m: Any, s_p: Any, w_x: Any) -> Any:
    """F seen from M and MP, scaled, along MP."""
    return s_m - s_p * w_x


@by_crank.quantity(units="1", symbol="(m - p w)_y", source=f"{WUNDERLICH}, eq. (1.3)", internal=True)
def dyad_M_y(s_p: Any, w_y: Any) -> Any:
    """F seen from M and MP, scaled, across MP."""
    return -(s_p * w_y)


@by_crank.quantity(units="1", symbol="(n + q w)_x", source=f"{WUNDERLICH}, eq. (1.4)", internal=True)
def dyad_N_x(s_n: Any, s_q: Any, w_x: Any) -> Any:
    """F seen from N and NQ, scaled, along NQ."""
    return s_n + s_q * w_x


@by_crank.quantity(units="1", symbol="(n + q w)_y", source=f"{WUNDERLICH}, eq. (1.4)", internal=True)
def dyad_N_y(s_q: Any, w_y: Any) -> Any:
    """F seen from N and NQ, scaled, across NQ."""
    return s_q * w_y


def per_lengths(x: Any, y: Any, dyad_x: Any, dyad_y: Any) -> Any:
    """Reciprocal of the product of two equal lengths."""
    return 1.0 / sqrt((x * x + y * y) * (dyad_x * dyad_x + dyad_y * dyad_y))


def turned_x(x: Any, y: Any, dyad_x: Any, dyad_y: Any, per: Any) -> Any:
    """First component of a quotient of two vectors of one length."""
    return (x * dyad_x + y * dyad_y) * per


def turned_y(x: Any, y: Any, dyad_x: Any, dyad_y: Any, per: Any) -> Any:
    """Second component of a quotient of two vectors of one length."""
    return (y * dyad_x - x * dyad_y) * per


for _name, _pivot, _rocker in (("u", "M", "MA"), ("v", "N", "NB")):
    _vectors = {"x": f"{_pivot}F_x", "y": "SF_y", "dyad_x": f"dyad_{_pivot}_x", "dyad_y": f"dyad_{_pivot}_y"}
    for _fact, _law, _symbol in (
        (f"per_{_pivot}F", per_lengths, f"1/{_pivot}F^2"),
        (f"{_name}_x", turned_x, f"{_name}_x"),
        (f"{_name}_y", turned_y, f"{_name}_y"),
    ):
        by_crank.quantity(
            units="1",
            symbol=_symbol,
            source=f"{WUNDERLICH}, eqs. (1.3), (1.4)",
            internal=True,
            name=_fact,
            meaning=f"Direction of {_rocker}" if _law is not per_lengths else f"1/{_pivot}F^2, scaled",
            given=_vectors | {"per": f"per_{_pivot}F"},
        )(_law)

declare_fifth(by_crank, "e", "AB", "g")

# -- angles, F --------------------------------------------------------------------------------------------------

for _name, _rocker, _bar in (("phi", "u", "MA"), ("psi", "v", "NB")):
    by_crank.quantity(
        units="rad",
        symbol=_name,
        source=FIGURES,
        name=_name,
        meaning=f"Direction of {_bar} in the ground frame",
        given={"x": f"{_rocker}_x", "y": f"{_rocker}_y"},
    )(angle)

_joint: Callable[..., Any]
for _axis, _joint, _given in (
    ("x", along, {"start": "S_x", "length": "r", "direction": "g_x"}),
    ("y", product, {"x": "r", "y": "g_y"}),
):
    by_crank.quantity(
        units="m",
        symbol=f"F_{_axis}",
        source=f"{WUNDERLICH}, eq. (1.7)",
        name=f"F_{_axis}",
        meaning=f"Joint F, {_axis}",
        given=_given,
    )(_joint)

# -- rates --------------------------------------------------------------------------------------------------------


def rate(s_r: Any, length: Any, bar_x: Any, bar_y: Any, g_x: Any, g_y: Any, w_y: Any) -> Any:
    """Return how fast a rocker turns: what PF or QF takes of the speed of F, over the lever of its joint."""
    return s_r * (bar_y * g_x - bar_x * g_y) / (length * w_y)


for _name, _length, _bar, _rocker in (("phi", "s_m", "f", "MA"), ("psi", "s_n", "h", "NB")):
    by_crank.quantity(
        units="1",
        symbol=f"d {_name}/d sigma",
        source=POSITION,
        name=f"d{_name}_dsigma",
        meaning=f"Angular velocity of {_rocker} over that of the crank SF",
        given={"length": _length, "bar_x": f"{_bar}_x", "bar_y": f"{_bar}_y"},
    )(rate)
    by_crank.quantity(
        units="rad s-1",
        symbol=f"d {_name}/dt",
        source=POSITION,
        name=f"{_name}_rate",
        meaning=f"Angular velocity of {_rocker}",
        given={"x": "omega", "y": f"d{_name}_dsigma"},
    )(product)
    by_crank.derivative(_name, SIGMA, given={"x": f"d{_name}_dsigma"})(same)


@by_crank.quantity(units="1", symbol="sin(sigma)/2", source=POSITION, internal=True)
def half_sine(g_y: Any) -> Any:
    """Half the sine of sigma."""
    return 0.5 * g_y


for _name, _slope, _need in (
    ("Z", same, "half_sine"),
    ("C", opposite, "half_sine"),
    ("g_x", opposite, "g_y"),
    ("g_y", same, "g_x"),
):
    by_crank.derivative(_name, SIGMA, given={"x": _need})(_slope)
