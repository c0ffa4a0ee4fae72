"""What belongs to Burmester's focal mechanism alone."""

from fastlink.focal.cubics import cubic, cubic_points
from fastlink.focal.lines import StraightLine, straight_line

__all__ = ["StraightLine", "cubic", "cubic_points", "straight_line"]
