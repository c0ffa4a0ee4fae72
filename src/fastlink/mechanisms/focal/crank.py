"""Driven by the crank SF: |MF| gives omega, both dyads turn with it, and AB closes by itself.

    u = z/(m - p w),  v = (z - d)/(n + q w),  z = s + r exp(i sigma),

where both sides of a quotient have one length.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from fastlink.mechanisms.focal.declare import WUNDERLICH
from fastlink.mechanisms.focal.drives import by_crank
from fastlink.mechanisms.focal.dyad import DYAD
from fastlink.mechanisms.focal.points import FIGURES, POSITION, angle, declare_fifth, declare_T
from fastlink.mechanisms.planar_4r import planar_4r
from fastlink.mechanisms.planar_4r.rates import product
from fastlink.mechanisms.planar_4r.slopes import opposite, opposite_product, same
from fastlink.numerics.elementary import sqrt

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


@by_crank.quantity(units="1", symbol="|sin omega|", source=f"{WUNDERLICH}, eq. (1.5)", internal=True)
def size_of_sine(half_sine_omega: Any) -> Any:
    """Sine of omega without its sign."""
    return 2.0 * half_sine_omega


@by_crank.quantity(units="1", symbol="2/|sin omega|", source=f"{WUNDERLICH}, eq. (1.5)", internal=True)
def per_half_sine(half_sine_omega: Any) -> Any:
    """Reciprocal of half the sine of omega; infinite at a dead centre."""
    return 1.0 / half_sine_omega


@by_crank.quantity(units="1", symbol="sgn omega", source=POSITION, internal=True)
def omega_sign(branch: Any) -> Any:
    """Sign of omega: 1 in branch 1, -1 in branch 2."""
    return 3.0 - 2.0 * branch


@by_crank.quantity(units="1", symbol="sin omega", source=f"{WUNDERLICH}, eq. (1.5)", internal=True)
def w_y(size_of_sine: Any, omega_sign: Any) -> Any:
    """Sine of omega."""
    return omega_sign * size_of_sine


# -- u, v, e ------------------------------------------------------------------------------------------------------


@by_crank.quantity(units="1", symbol="z_x", source=f"{WUNDERLICH}, eq. (1.7)", internal=True)
def MF_x(s_s: Any, s_r: Any, g_x: Any) -> Any:
    """Vector from M to F, scaled, x."""
    return s_s + s_r * g_x


@by_crank.quantity(units="1", symbol="(z - d)_x", source=f"{WUNDERLICH}, eq. (1.7)", internal=True)
def NF_x(s_SN: Any, s_r: Any, g_x: Any) -> Any:
    """Vector from N to F, scaled, x."""
    return s_r * g_x - s_SN


by_crank.quantity(
    units="1",
    symbol="z_y",
    source=f"{WUNDERLICH}, eq. (1.7)",
    internal=True,
    name="MF_y",
    meaning="Vector from M to F, scaled, y",
    given={"x": "s_r", "y": "g_y"},
)(product)


def swing(of_sine: Any, of_cosine: Any, squared_half_sine: Any, squared_half_cosine: Any) -> Any:
    """What omega adds to F seen from M or N along the rocker."""
    return of_sine * squared_half_sine + of_cosine * squared_half_cosine


def dyad_x(straight: Any, swing: Any) -> Any:
    """F seen from M or N, scaled, along the rocker."""
    return straight + swing


for _pivot, _rocker, _symbol in (("M", "MP", "(m - p w)_x"), ("N", "NQ", "(n + q w)_x")):
    _labels: dict[str, Any] = {
        "units": "1",
        "symbol": _symbol,
        "source": f"{WUNDERLICH}, eqs. (1.3), (1.4)",
        "internal": True,
    }
    by_crank.quantity(
        **_labels,
        name=f"swing_{_pivot}",
        given={"of_sine": f"{_pivot}_of_sine", "of_cosine": f"{_pivot}_of_cosine"},
    )(swing)
    by_crank.quantity(
        **_labels,
        name=f"dyad_{_pivot}_x",
        meaning=f"F seen from {_pivot}, scaled, along {_rocker}",
        given={"straight": f"straight_{_pivot}", "swing": f"swing_{_pivot}"},
    )(dyad_x)


@by_crank.quantity(units="1", symbol="(m - p w)_y", source=f"{WUNDERLICH}, eq. (1.3)", internal=True)
def dyad_M_y(s_p: Any, w_y: Any) -> Any:
    """F seen from M and MP, scaled, across MP."""
    return -(s_p * w_y)


@by_crank.quantity(units="1", symbol="(n + q w)_y", source=f"{WUNDERLICH}, eq. (1.4)", internal=True)
def dyad_N_y(s_q: Any, w_y: Any) -> Any:
    """F seen from N and NQ, scaled, across NQ."""
    return s_q * w_y


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


for _name, _pivot, _rocker, _bar in (("u", "M", "MA", "s_p"), ("v", "N", "NB", "s_q")):
    _vectors = {"x": f"{_pivot}F_x", "y": "MF_y", "dyad_x": f"dyad_{_pivot}_x", "dyad_y": f"dyad_{_pivot}_y"}
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
            given=_vectors | {"per": f"per_{_pivot}F", "bar": _bar},
        )(_law)

declare_fifth(by_crank, "e", "AB", "g", "w")


@by_crank.quantity(units="m", symbol="FT", source=POSITION, internal=True)
def FT_along(FT: Any, ratio_sign: Any, crank_sign: Any) -> Any:
    """Distance of T from F along u v w."""
    return -(ratio_sign * crank_sign) * FT


declare_T(by_crank, "F", "FT_along", "uwv")

# -- angles --------------------------------------------------------------------------------------------------

for _name, _rocker, _bar in (("phi", "u", "MA"), ("psi", "v", "NB")):
    by_crank.quantity(
        units="rad",
        symbol=_name,
        source=FIGURES,
        name=_name,
        meaning=f"Direction of {_bar} in the ground frame",
        given={"x": f"{_rocker}_x", "y": f"{_rocker}_y"},
    )(angle)

# -- rates --------------------------------------------------------------------------------------------------------


def rate(
    s_r: Any,
    base: Any,
    g_x: Any,
    g_y: Any,
    x: Any,
    y: Any,
    straight_lever: Any,
    swing: Any,
    bar: Any,
    per_half_sine: Any,
    omega_sign: Any,
) -> Any:
    """Return how fast a rocker turns: as the line from its pivot to F, and as omega changes."""
    lever = straight_lever + swing / bar
    turning = omega_sign * ((0.5 * base) * (g_y * lever) * per_half_sine)
    return s_r * ((s_r + base * g_x) + turning) / (x * x + y * y)


for _name, _pivot, _base, _bar, _rocker in (
    ("phi", "M", "s_s", "s_p", "MA"),
    ("psi", "N", "s_NS", "minus_s_q", "NB"),
):
    by_crank.quantity(
        units="1",
        symbol=f"d {_name}/d sigma",
        source=POSITION,
        name=f"d{_name}_dsigma",
        meaning=f"Angular velocity of {_rocker} over that of the crank SF",
        given={"base": _base, "bar": _bar, "x": f"{_pivot}F_x", "y": "MF_y"}
        | {part: f"{part}_{_pivot}" for part in ("straight_lever", "swing")},
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


@by_crank.quantity(units="1", symbol="-sr/(mp)", source=DYAD, internal=True)
def sine_change(s_s: Any, s_r: Any, s_m: Any, s_p: Any) -> Any:
    """How much sin^2(omega/2) grows over half a turn."""
    return -((s_s / s_m) * (s_r / s_p))


for _set in (None, "graded"):
    for _name, _slope, _need in (
        ("Z", same, "half_sine"),
        ("C", opposite, "half_sine"),
        ("g_x", opposite, "g_y"),
        ("g_y", same, "g_x"),
    ):
        by_crank.derivative(_name, SIGMA, given={"x": _need}, alternative=_set)(_slope)
    for _name, _change in (("squared_half_sine", product), ("squared_half_cosine", opposite_product)):
        by_crank.derivative(_name, SIGMA, given={"x": "sine_change", "y": "half_sine"}, alternative=_set)(
            _change
        )
