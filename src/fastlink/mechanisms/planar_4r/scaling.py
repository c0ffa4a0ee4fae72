"""Scaled lengths of the planar 4R: over a power of two near the longest, and the effect of rounding on their sums."""

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
