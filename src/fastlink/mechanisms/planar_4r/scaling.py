"""Scaled lengths of the planar 4R, the effect of rounding on their sums, and their ratios."""

from __future__ import annotations

from typing import Any

from fastlink.mechanisms._shared import lengths
from fastlink.mechanisms.planar_4r.inputs import LINKS, NUMERICS, planar_4r
from fastlink.numerics.compensated import UNIT_ROUNDING

step = planar_4r.steps(units="1", source=f"{NUMERICS}#scaling")
step(lengths.valid, "valid", "valid", source=f"{NUMERICS}#status")
step(lengths.lift, "lift", "lift")
step(lengths.unit, "unit", "unit", units="m")
step(lengths.scaled, "s1", "s_1", f"scaled length of the {LINKS[1]}", length="a1")
step(lengths.scaled, "s2", "s_2", f"scaled length of the {LINKS[2]}", length="a2")
step(lengths.scaled, "s3", "s_3", f"scaled length of the {LINKS[3]}", length="a3")
step(lengths.scaled, "s4", "s_4", "scaled length of the ground link OD", length="a4")


@planar_4r.quantity(units="m-1", symbol="1/unit", source=f"{NUMERICS}#scaling", internal=True)
def per_unit(lift: Any, unit: Any) -> Any:
    """Reciprocal of the power of two at or below the longest link."""
    return lift / unit


@planar_4r.quantity(units="1", symbol="u P", source=f"{NUMERICS}#status", internal=True)
def gap_rounding(s1: Any, s2: Any, s3: Any, s4: Any) -> Any:
    """Effect of half a unit in the last place of each length on a sum of them, which counts as 0 below it."""
    return UNIT_ROUNDING * ((s1 + s2) + (s3 + s4))


# -- ratios that positions and rates are made of -----------------------------------------------------------------


@planar_4r.quantity(units="1", symbol="1/(4 a_1 a_4)", source=f"{NUMERICS}#scaling", internal=True)
def per_4_s1_s4(s1: Any, s4: Any) -> Any:
    """Reciprocal of four times crank times ground, scaled."""
    return 0.25 / (s1 * s4)


@planar_4r.quantity(units="1", symbol="gamma_0", source=f"{NUMERICS}#rates", internal=True)
def gamma0(s1: Any, s4: Any, per_4_s1_s4: Any) -> Any:
    """(a1 - a4)^2/(4 a1 a4): squared distance of A and D over 4 a1 a4, at theta1 = 0."""
    return (s1 - s4) * (s1 - s4) * per_4_s1_s4


@planar_4r.quantity(units="1", symbol="lambda", source=f"{NUMERICS}#rates", internal=True)
def crank_excess(s1: Any, s4: Any) -> Any:
    """(a1 - a4)/(2 a4)."""
    return 0.5 * (s1 - s4) / s4


def squares_ratio(x: Any, y: Any, per_4_s1_s4: Any) -> Any:
    """Return (x^2 - y^2)/(4 a1 a4)."""
    return (x - y) * (x + y) * per_4_s1_s4


def offset(x: Any, y: Any, per_4_s1_s4: Any) -> Any:
    """Return x (x - y)/(2 a1 a4)."""
    return 2.0 * x * (x - y) * per_4_s1_s4


def offset_less(x: Any, y: Any, per_4_s1_s4: Any) -> Any:
    """Return y (x - y)/(2 a1 a4)."""
    return 2.0 * y * (x - y) * per_4_s1_s4


step = planar_4r.steps(units="1", source=f"{NUMERICS}#rates")
step(squares_ratio, "epsilon", "epsilon", "(a1^2 - a4^2)/(4 a1 a4)", x="s1", y="s4")
step(squares_ratio, "kappa", "kappa", "(a2^2 - a3^2)/(4 a1 a4)", x="s2", y="s3")
step = planar_4r.steps(units="1", source=f"{NUMERICS}#position")
step(offset, "coupler_offset", "2 beta", "a2 (a2 - a3)/(2 a1 a4)", x="s2", y="s3")
step(offset_less, "output_offset", "-2 delta", "a3 (a2 - a3)/(2 a1 a4)", x="s2", y="s3")
