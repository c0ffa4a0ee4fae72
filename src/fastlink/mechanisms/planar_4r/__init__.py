"""The Euclidean planar 4R of Hayes, Hninn and Irani."""

from fastlink.mechanisms.planar_4r import (
    circuits,
    classes,
    coupler,
    dense,
    design_facts,
    driven,
    factors,
    forces,
    graded,
    joints,
    links,
    position,
    rates,
)
from fastlink.mechanisms.planar_4r.declare import planar_4r

__all__ = [
    "DRIVEN",
    "circuits",
    "classes",
    "coupler",
    "dense",
    "design_facts",
    "driven",
    "factors",
    "forces",
    "graded",
    "joints",
    "links",
    "planar_4r",
    "position",
    "rates",
]

planar_4r.check()
#: The same linkage by its other inputs.
DRIVEN = driven.driven_catalogues()
