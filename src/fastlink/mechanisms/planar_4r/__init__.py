"""The Euclidean planar 4R of Hayes, Hninn and Irani."""

from fastlink.mechanisms.planar_4r import (
    classes,
    coupler,
    dense,
    design_facts,
    factors,
    forces,
    joints,
    links,
    position,
    rates,
)
from fastlink.mechanisms.planar_4r.declare import planar_4r

__all__ = [
    "classes",
    "coupler",
    "dense",
    "design_facts",
    "factors",
    "forces",
    "joints",
    "links",
    "planar_4r",
    "position",
    "rates",
]

planar_4r.check()
