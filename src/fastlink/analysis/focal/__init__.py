"""Functions of Burmester's focal mechanism: its cubic, and straight lines."""

from fastlink.analysis.focal.cubic import cubic, cubic_points
from fastlink.analysis.focal.straight_line import StraightLine, T_deviation, straight_line

__all__ = ["StraightLine", "T_deviation", "cubic", "cubic_points", "straight_line"]


def __dir__() -> list[str]:
    return __all__
