"""Functions of the Minkowskian plane and of its planar 4R: vectors, motions, triangles, the coupler curve.

A vector or point is an array with its two coordinates x, y along the last axis, the double number x + j y, j^2 = 1.
"""

from fastlink.analysis.minkowski.coupler_curve import CouplerCircles, coupler_circles, sextic
from fastlink.analysis.minkowski.motions import boost, motion, moved
from fastlink.analysis.minkowski.plane import (
    causal_type,
    conjugate,
    hyperbolic_angle,
    multiply,
    norm,
    orientation,
    polar,
    rapidity,
    scalar_product,
)
from fastlink.analysis.minkowski.tables import linkage_table
from fastlink.analysis.minkowski.triangles import (
    PureTriangle,
    cosine_rule,
    cosine_rule_angle,
    pure_triangle,
    quadrilateral_excess,
    triangle_excess,
)

__all__ = [
    "CouplerCircles",
    "PureTriangle",
    "boost",
    "causal_type",
    "conjugate",
    "cosine_rule",
    "cosine_rule_angle",
    "coupler_circles",
    "hyperbolic_angle",
    "linkage_table",
    "motion",
    "moved",
    "multiply",
    "norm",
    "orientation",
    "polar",
    "pure_triangle",
    "quadrilateral_excess",
    "rapidity",
    "scalar_product",
    "sextic",
    "triangle_excess",
]


def __dir__() -> list[str]:
    return __all__
