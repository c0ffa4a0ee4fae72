"""Functions of the planar 4R of the Minkowski plane; see `fastlink.minkowski`."""

from fastlink.analysis.minkowski import (
    CouplerCircles,
    PureTriangle,
    boost,
    causal_type,
    conjugate,
    cosine_rule,
    cosine_rule_angle,
    coupler_circles,
    hyperbolic_angle,
    linkage_table,
    motion,
    moved,
    multiply,
    norm,
    orientation,
    polar,
    pure_triangle,
    quadrilateral_excess,
    rapidity,
    scalar_product,
    sextic,
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
