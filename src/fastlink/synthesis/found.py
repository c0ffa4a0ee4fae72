"""Linkages that were found for a task: their form, their defects, their cognates."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["Linkage"]


@dataclass(frozen=True, eq=False)
class Linkage:
    """A four-bar with its place, and where its crank stands at the points of a task."""

    #: Crank OA, coupler AB, output link DB, ground OD, then the coupler point along and across AB, as `planar_4r` has them.
    a1: float
    a2: float
    a3: float
    a4: float
    P_u: float
    P_v: float
    #: The fixed pivot O, and the direction of OD, in the frame of the task.
    O_x: float
    O_y: float
    ground_angle: float
    #: The assembly mode at the first point: B right (1) or left (2) of the line from A to D.
    branch: int
    #: Crank angles at the points of the task, from the ground link, each within half a turn of the one before.
    theta1: NDArray[np.float64]
