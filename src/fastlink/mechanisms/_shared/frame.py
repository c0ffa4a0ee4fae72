"""Laws of joints in the frame of a coupler AB: the x-axis from A towards B, the y-axis to its left."""

from __future__ import annotations

from typing import Any

__all__ = ["ACROSS", "ALONG", "M_across", "M_along", "across", "along"]

#: The meaning of a coordinate, of a joint.
ALONG, ACROSS = (
    "Joint {} in the frame of AB, from A towards B",
    "Joint {} in the frame of AB, to the left of AB",
)


def M_along(a: Any, u_x: Any, u_y: Any, e_x: Any, e_y: Any) -> Any:
    """Return how far the pivot of a bar MA is along AB from A."""
    return -(a * (u_x * e_x + u_y * e_y))


def M_across(a: Any, u_x: Any, u_y: Any, e_x: Any, e_y: Any) -> Any:
    """Return how far the pivot of a bar MA is to the left of AB."""
    return a * (u_x * e_y - u_y * e_x)


def along(place: Any, a: Any, u_x: Any, u_y: Any, e_x: Any, e_y: Any) -> Any:
    """Return how far a point of the ground line is along AB from A."""
    return (place - a * u_x) * e_x - a * u_y * e_y


def across(place: Any, a: Any, u_x: Any, u_y: Any, e_x: Any, e_y: Any) -> Any:
    """Return how far a point of the ground line is to the left of AB."""
    return -((place - a * u_x) * e_y + a * u_y * e_x)
