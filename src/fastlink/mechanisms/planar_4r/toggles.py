"""Toggles of the planar 4R: where the coupler and the output link are in line, in twice the working precision."""

from __future__ import annotations

from typing import Any

from fastlink.mechanisms.planar_4r import factors, scaling  # noqa: F401 (on which it builds)
from fastlink.mechanisms.planar_4r.inputs import NUMERICS, planar_4r
from fastlink.numerics.compensated import gap_product_quotient
from fastlink.numerics.vectors import zero_where


@planar_4r.quantity(units="1", symbol="Z_0", source=f"{NUMERICS}#toggles", internal=True, low="Z0_low")
def Z0(
    factor_A1: Any, factor_A1_low: Any, factor_B1: Any, factor_B1_low: Any, s1: Any, s4: Any,
    gap_rounding: Any, valid: Any,
) -> Any:  # fmt: skip
    """Squared half-angle sine at the inner toggle, -A1 B1/(4 a1 a4); negative if none."""
    high, low = gap_product_quotient(factor_A1, factor_A1_low, -factor_B1, -factor_B1_low, s1, s4)
    none = (abs(factor_A1) <= gap_rounding) | (abs(factor_B1) <= gap_rounding)
    return zero_where(none, high) * valid, zero_where(none, low)


@planar_4r.quantity(units="1", symbol="C_0", source=f"{NUMERICS}#toggles", internal=True, low="C0_low")
def C0(
    factor_C1: Any, factor_C1_low: Any, factor_D1: Any, factor_D1_low: Any, s1: Any, s4: Any,
    gap_rounding: Any, valid: Any,
) -> Any:  # fmt: skip
    """Squared half-angle cosine at the outer toggle, C1 D1/(4 a1 a4); negative if none."""
    high, low = gap_product_quotient(factor_C1, factor_C1_low, factor_D1, factor_D1_low, s1, s4)
    none = abs(factor_C1) <= gap_rounding
    return zero_where(none, high) * valid, zero_where(none, low)
