"""The focal mechanism of Burmester, after Wunderlich."""

from fastlink.mechanisms.focal import (  # noqa: F401 (they declare its facts)
    angles,
    by_crank,
    circles,
    completion,
    coupler,
    crank,
    crank_graded,
    crossings,
    design_facts,
    dyad,
    four_bar,
    frame_AB,
    joint_F,
    keywords,
    points,
    reach,
    residuals,
    rocker,
    status,
)
from fastlink.mechanisms.focal.inputs import focal

__all__ = ["DRIVEN", "focal"]

#: The same mechanism by its other inputs.
DRIVEN = {"sigma": by_crank.with_design_facts}
