"""Circuits of the planar 4R: which configurations reach each other without taking the linkage apart.

In a linkage of Grashof's kind the shortest link turns fully against its two neighbours, and the other two joints
never straighten: the sign of either distinguishes the two circuits. Where crank or ground is the shortest, B is such a
joint, and its sign is that of the branch. Where coupler or output link is the shortest, O is, and its sign is
that of sin theta1; the branches of each half meet at its toggles. Every other linkage that assembles has one
circuit: at a change point the two touch.
"""

from __future__ import annotations

from typing import Any

from fastlink.mechanisms.planar_4r.inputs import NUMERICS, planar_4r
from fastlink.numerics.elementary import NOT_A_NUMBER, select

CIRCUITS = f"{NUMERICS}#circuits"


@planar_4r.quantity(units="1", symbol="N_c", source=CIRCUITS)
def circuit_count(grashof_class: Any) -> Any:
    """Number of circuits, sets of configurations that reach each other; 0 if the design never assembles."""
    # The codes of classes.CLASS_FLAGS: Grashof's four, then the linkages with one circuit.
    count = select(grashof_class <= 3.0, 2.0, select(grashof_class <= 12.0, 1.0, 0.0))
    return select(grashof_class <= 13.0, count, NOT_A_NUMBER)


@planar_4r.quantity(units="1", symbol="c", source=CIRCUITS)
def circuit(grashof_class: Any, sin_theta1: Any, branch_sign: Any, sigma: Any) -> Any:
    """Circuit that the configuration belongs to: by branch, by the half of theta1 (1 above 0), or 1."""
    branch = 1.5 + 0.5 * branch_sign
    half = select(sin_theta1 > 0.0, 1.0, 2.0)
    number = select(grashof_class <= 1.0, branch, select(grashof_class <= 3.0, half, 1.0))
    return select(sigma >= 0.0, number, NOT_A_NUMBER)
