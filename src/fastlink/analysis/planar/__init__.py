"""Functions of the planar 4R alone: algebraic equations, coupler curves, balancing.

Lengths are 1e-25 to 1e25 m, coordinates at most 1e25 m: others are refused, as their products may leave the range of
doubles.
"""

from fastlink.analysis.planar.balance import force_balance
from fastlink.analysis.planar.cognates import Cognate, cognates
from fastlink.analysis.planar.curves import curve_straightness, sextic, straightness
from fastlink.analysis.planar.double_points import crunode_count, crunodes, cusp_count, cusps
from fastlink.analysis.planar.flywheel import flywheel_inertia
from fastlink.analysis.planar.force_equations import bar_properties, force_equations
from fastlink.analysis.planar.force_hypothesis import force_hypothesis
from fastlink.analysis.planar.inflections import inflections
from fastlink.analysis.planar.input_output import io_coefficients
from fastlink.analysis.planar.path_integrals import curve_area, curve_length
from fastlink.analysis.planar.rate_extrema import rate_extrema

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
