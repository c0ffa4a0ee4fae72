"""What belongs to planar linkages alone: algebraic equations and constructions."""

from fastlink.planar.crunodes import crunodes
from fastlink.planar.curves import Cognate, cognates, curve_area, curve_length, sextic, straightness
from fastlink.planar.io import io_coefficients

__all__ = [
    "Cognate",
    "cognates",
    "crunodes",
    "curve_area",
    "curve_length",
    "io_coefficients",
    "sextic",
    "straightness",
]
