"""Read a position of the four-bar MABN, as functions of its focal cubic are given it."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from fastlink.analysis.designs import broadcast, check_lengths
from fastlink.catalogue.catalogue import Input
from fastlink.engine.broadcast import like
from fastlink.engine.evaluate import evaluate
from fastlink.mechanisms.focal import focal
from fastlink.mechanisms.planar_4r import planar_4r
from fastlink.plan.validate import branch_codes

__all__ = ["POSITION", "corners", "point", "read_position"]

#: Lengths are at most this, and at least its inverse: products of four neither overflow nor vanish.
GREATEST_LENGTH = 1e70
#: The names of the numbers of a position, but for its branch.
POSITION = ("a", "b", "c", "d", "phi")


def point(name: str) -> Input:
    """Return the declaration of a coordinate of a point in the plane."""
    return Input(name, "m", name, f"coordinate {name} of the point")


def read_position(function: str, *numbers: Any, further: Iterable[tuple[Input, Any]] = ()) -> list[Any]:
    """Return a, b, c, d, phi, branch and further numbers as arrays of one shape.

    Raises
    ------
    InputError
        With every number that is not possible; or the shapes do not broadcast.
    """
    *position, branch = numbers
    declared = [*(focal.inputs[name] for name in "abcd"), focal.position]
    mode = Input("branch", "1", "branch", "assembly mode")
    more = [one for one, _ in further]
    given = (*position, like(branch, branch_codes(planar_4r, branch)), *(value for _, value in further))
    arrays = broadcast(function, [*declared, mode, *more], *given)
    named = [*declared, *more]
    lengths = [*arrays[: len(declared)], *arrays[len(declared) + 1 :]]
    check_lengths(function, named, lengths, GREATEST_LENGTH, "four lengths")
    return arrays


def corners(a: Any, b: Any, c: Any, d: Any, phi: Any, branch: Any) -> tuple[Any, Any]:
    """Return the joints A and B as complex numbers, NaN where the four-bar does not assemble."""
    joints = ["A_x", "A_y", "B_x", "B_y"]
    found = evaluate("planar_4r", joints, a1=a, a2=c, a3=b, a4=d, theta1=phi, branch=branch)
    A_x, A_y, B_x, B_y = (np.asarray(found[name]) for name in joints)
    closes = np.isfinite(B_x)
    return np.where(closes, A_x + 1j * A_y, np.nan), B_x + 1j * B_y
