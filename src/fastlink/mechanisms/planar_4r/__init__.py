"""The Euclidean planar 4R of Hayes, Hninn and Irani."""

from fastlink.mechanisms.planar_4r import by_joint, classes, dense, forces, graded, picture, position, rates  # noqa: F401 (they declare its facts)
from fastlink.mechanisms.planar_4r.inputs import planar_4r

__all__ = ["DRIVEN", "planar_4r"]

#: The same linkage by its other inputs.
DRIVEN = by_joint.driven_catalogues()
