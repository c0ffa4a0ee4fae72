"""The Euclidean planar 4R of Hayes, Hninn and Irani."""

from fastlink.mechanisms.planar_4r import (  # noqa: F401 (they declare its facts)
    acceleration,
    angle_derivatives,
    by_joint,
    centres,
    circuits,
    classes,
    counterweights,
    coupler,
    dense,
    factors,
    forces,
    graded,
    joints,
    keywords,
    known,
    links,
    loads,
    position,
    rates,
    residuals,
    scaling,
    shaking,
    toggles,
)
from fastlink.mechanisms.planar_4r.inputs import planar_4r

__all__ = ["DRIVEN", "planar_4r"]

#: The same linkage by its other inputs.
DRIVEN = by_joint.driven_catalogues()
