"""Facts of one design of the planar 4R: link-length factors, toggles, status.

Lengths are first divided by a power of two near the longest, see `fastlink.mechanisms.lengths`.
"""

from __future__ import annotations

from typing import Any

from fastlink.mechanisms import lengths
from fastlink.mechanisms.planar_4r.declare import HAYES, LINKS, NUMERICS, planar_4r
from fastlink.numerics.compensated import UNIT_ROUNDING, gap_product_quotient
from fastlink.numerics.elementary import select
from fastlink.numerics.vectors import zero_where

IO_FACTORS = f"{HAYES}, eq. (1)"
STATUS_FLAGS = {
    0: "rotates_fully",
    1: "assembles_over_part_of_the_turn",
    2: "never_assembles",
    3: "change_point",
    4: "invalid_input",
}


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
    """What half a unit in the last place of each length may do to a sum of them: less is zero."""
    return UNIT_ROUNDING * ((s1 + s2) + (s3 + s4))


@planar_4r.quantity(units="1", symbol="Z_0", source=f"{NUMERICS}#toggles", internal=True, low="Z0_low")
def Z0(
    factor_A1: Any,
    factor_A1_low: Any,
    factor_B1: Any,
    factor_B1_low: Any,
    s1: Any,
    s4: Any,
    gap_rounding: Any,
    valid: Any,
) -> Any:
    """Squared half-angle sine at the inner toggle, -A1 B1/(4 a1 a4); negative if none."""
    high, low = gap_product_quotient(factor_A1, factor_A1_low, -factor_B1, -factor_B1_low, s1, s4)
    none = (abs(factor_A1) <= gap_rounding) | (abs(factor_B1) <= gap_rounding)
    return zero_where(none, high) * valid, zero_where(none, low)


@planar_4r.quantity(units="1", symbol="C_0", source=f"{NUMERICS}#toggles", internal=True, low="C0_low")
def C0(
    factor_C1: Any,
    factor_C1_low: Any,
    factor_D1: Any,
    factor_D1_low: Any,
    s1: Any,
    s4: Any,
    gap_rounding: Any,
    valid: Any,
) -> Any:
    """Squared half-angle cosine at the outer toggle, C1 D1/(4 a1 a4); negative if none."""
    high, low = gap_product_quotient(factor_C1, factor_C1_low, factor_D1, factor_D1_low, s1, s4)
    none = abs(factor_C1) <= gap_rounding
    return zero_where(none, high) * valid, zero_where(none, low)


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


@planar_4r.quantity(units="1", symbol="epsilon", source=f"{NUMERICS}#rates", internal=True)
def epsilon(s1: Any, s4: Any, per_4_s1_s4: Any) -> Any:
    """(a1^2 - a4^2)/(4 a1 a4)."""
    return (s1 - s4) * (s1 + s4) * per_4_s1_s4


@planar_4r.quantity(units="1", symbol="kappa", source=f"{NUMERICS}#rates", internal=True)
def kappa(s2: Any, s3: Any, per_4_s1_s4: Any) -> Any:
    """(a2^2 - a3^2)/(4 a1 a4)."""
    return (s2 - s3) * (s2 + s3) * per_4_s1_s4


@planar_4r.quantity(units="1", symbol="beta", source=f"{NUMERICS}#position", internal=True)
def coupler_offset(s2: Any, s3: Any, per_4_s1_s4: Any) -> Any:
    """a2 (a2 - a3)/(4 a1 a4)."""
    return s2 * (s2 - s3) * per_4_s1_s4


@planar_4r.quantity(units="1", symbol="delta", source=f"{NUMERICS}#position", internal=True)
def output_offset(s2: Any, s3: Any, per_4_s1_s4: Any) -> Any:
    """a3 (a3 - a2)/(4 a1 a4)."""
    return s3 * (s3 - s2) * per_4_s1_s4


@planar_4r.quantity(units="1", symbol="assembles", source=f"{IO_FACTORS}; {NUMERICS}#status", internal=True)
def assembles(factor_A2: Any, factor_B2: Any, factor_C2: Any, factor_D2: Any, valid: Any) -> Any:
    """1 where the design assembles at some angle, else 0."""
    one_too_long = (factor_A2 < 0.0) | (factor_B2 > 0.0) | (factor_C2 < 0.0) | (factor_D2 < 0.0)
    return select(one_too_long, 0.0, select(valid == 1.0, 1.0, 0.0))


@planar_4r.quantity(units="1", symbol="status", source=f"{IO_FACTORS}; {NUMERICS}#status", flags=STATUS_FLAGS)
def status(
    factor_A1: Any, factor_B1: Any, factor_C1: Any, gap_rounding: Any, assembles: Any, valid: Any
) -> Any:
    """How the design assembles over a full turn of the input."""
    change_point = (
        (abs(factor_A1) <= gap_rounding) | (abs(factor_B1) <= gap_rounding) | (abs(factor_C1) <= gap_rounding)
    )
    turns = (factor_A1 * factor_B1 >= 0.0) & (factor_C1 <= 0.0)
    code = select(change_point, 3.0, select(turns, 0.0, 1.0))
    code = select(assembles == 1.0, code, 2.0)
    return select(valid == 1.0, code, 4.0)
