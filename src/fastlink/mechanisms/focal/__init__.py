"""The focal mechanism of Burmester, after Wunderlich."""

from fastlink.mechanisms.focal import (
    apex,
    completion,
    crank,
    crank_graded,
    design_facts,
    drives,
    dyad,
    graded,
    points,
    ranges,
    reach,
    residuals,
    rocker,
    status,
)
from fastlink.mechanisms.focal.declare import focal

__all__ = [
    "DRIVEN",
    "apex",
    "completion",
    "crank",
    "crank_graded",
    "design_facts",
    "drives",
    "dyad",
    "focal",
    "graded",
    "points",
    "ranges",
    "reach",
    "residuals",
    "rocker",
    "status",
]

#: The same mechanism by its other inputs.
DRIVEN = {"sigma": drives.with_design_facts}
