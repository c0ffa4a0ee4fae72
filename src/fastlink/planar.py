"""Functions of the planar 4R; see `fastlink.planar`."""

from fastlink.analysis.planar import (
    Cognate,
    bar_properties,
    cognates,
    crunode_count,
    crunodes,
    curve_area,
    curve_length,
    curve_straightness,
    cusp_count,
    cusps,
    flywheel_inertia,
    force_balance,
    force_equations,
    force_hypothesis,
    inflections,
    io_coefficients,
    rate_extrema,
    sextic,
    straightness,
)

__all__ = [
    "Cognate",
    "bar_properties",
    "cognates",
    "crunode_count",
    "crunodes",
    "curve_area",
    "curve_length",
    "curve_straightness",
    "cusp_count",
    "cusps",
    "flywheel_inertia",
    "force_balance",
    "force_equations",
    "force_hypothesis",
    "inflections",
    "io_coefficients",
    "rate_extrema",
    "sextic",
    "straightness",
]


def __dir__() -> list[str]:
    return __all__
