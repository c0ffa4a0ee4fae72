"""Points and circles through the joints of Wunderlich's figures, and joints in the frame of AB, from joints alone."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from fastlink.precision.independent.series import of_rounding

__all__ = ["CIRCLES", "MEETING", "SEEN", "circles", "meeting", "seen_from_AB"]

#: Quantities by the order of the derivatives that they need.
MEETING = dict.fromkeys(("X_x", "X_y", "Y_x"), 0)
CIRCLES = {f"{name}_{part}": 0 for name in ("PFQX", "SFTY", "PSQT") for part in ("x", "y", "radius")}
SEEN = {f"{joint}_{way}_AB": 0 for joint in "MNSF" for way in ("along", "across")}


def _cross(one: Any, other: Any) -> Any:
    """Return the third component of the product of two vectors."""
    return one.real * other.imag - one.imag * other.real


def meeting(ctx: Any, A: Any, B: Any, d: Any) -> dict[str, Any]:
    """Return where MA and NB meet, and MN and AB, as far as they do."""
    found: dict[str, Any] = {}
    to_B = B - d
    sine = _cross(A, to_B)
    if not of_rounding(ctx, sine, abs(A) * abs(to_B)):
        X = A * (d * to_B.imag / sine)
        found |= {"X_x": X.real, "X_y": X.imag}
    if not of_rounding(ctx, B.imag - A.imag, abs(A.imag) + abs(B.imag)):
        found["Y_x"] = A.real - A.imag * (B.real - A.real) / (B.imag - A.imag)
    return found


def circles(ctx: Any, joints: Mapping[str, Any]) -> dict[str, Any]:
    """Return centre and radius of the circles whose first three points are known and not in line."""
    found: dict[str, Any] = {}
    for name in ("PFQX", "SFTY", "PSQT"):
        if any(joint not in joints for joint in name[:3]):
            continue
        one, two, three = (joints[joint] for joint in name[:3])
        to_two, to_three = two - one, three - one
        area = _cross(to_two, to_three)
        if of_rounding(ctx, area, abs(to_two) * abs(to_three)):
            continue
        # as far from the second and third point as from the first
        squares = (abs(to_two) ** 2, abs(to_three) ** 2)
        x = (squares[0] * to_three.imag - squares[1] * to_two.imag) / (2 * area)
        y = (squares[1] * to_two.real - squares[0] * to_three.real) / (2 * area)
        found |= {
            f"{name}_x": one.real + x,
            f"{name}_y": one.imag + y,
            f"{name}_radius": (x * x + y * y) ** 0.5,
        }
    return found


def seen_from_AB(joints: Mapping[str, Any], A: Any, B: Any) -> dict[str, Any]:
    """Return joints in the frame of AB."""
    found: dict[str, Any] = {}
    for name, joint in joints.items():
        seen = (joint - A) * (B - A).conjugate() / abs(B - A)
        found |= {f"{name}_along_AB": seen.real, f"{name}_across_AB": seen.imag}
    return found
