"""What belongs to planar linkages alone: algebraic equations and constructions."""

from fastlink.planar.balance import force_balance
from fastlink.planar.cognates import Cognate, cognates
from fastlink.planar.curves import curve_area, curve_length, curve_straightness, sextic, straightness
from fastlink.planar.double_points import crunode_count, crunodes, cusp_count, cusps
from fastlink.planar.flywheel import flywheel_inertia
from fastlink.planar.inflections import inflections
from fastlink.planar.io import io_coefficients

__all__ = [
    "Cognate",
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
    "inflections",
    "io_coefficients",
    "sextic",
    "straightness",
]
