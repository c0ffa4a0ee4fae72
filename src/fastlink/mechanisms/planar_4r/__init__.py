"""The Euclidean planar 4R of Hayes, Hninn and Irani."""

from fastlink.mechanisms.planar_4r import (
    acceleration,
    circuits,
    classes,
    counterweights,
    coupler,
    dense,
    design_facts,
    driven,
    factors,
    forces,
    graded,
    joints,
    links,
    loads,
    position,
    rates,
    shaking,
    slopes,
)
from fastlink.mechanisms.planar_4r.declare import planar_4r

__all__ = [
    "DRIVEN",
    "acceleration",
    "circuits",
    "classes",
    "counterweights",
    "coupler",
    "dense",
    "design_facts",
    "driven",
    "factors",
    "forces",
    "graded",
    "joints",
    "links",
    "loads",
    "planar_4r",
    "position",
    "rates",
    "shaking",
    "slopes",
]

#: The same linkage by its other inputs.
DRIVEN = driven.driven_catalogues()
