"""What belongs to Burmester's focal mechanism alone."""

from fastlink.focal.cubic import cubic, cubic_points

__all__ = ["cubic", "cubic_points"]
