"""Newton's and Euler's laws of a chain of links, as the linear system of Hayes, Hninn, Irani, eq. (9)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from fastlink.precision.independent.series import Series, linear_solution

__all__ = ["Link", "bar_data", "cross", "reactions"]


def cross(one: Any, other: Any) -> Any:
    """Return the cross product of two vectors, given as complex numbers."""
    return one.real * other.imag - one.imag * other.real


@dataclass
class Link:
    """A link as point masses and a moment of inertia, with its loads and its joints.

    Attributes
    ----------
    masses : list of (mass, Series)
        Its own mass at its mass centre first, then its counterweight, as curves of time.
    spin : number
        Moment of inertia times angular acceleration.
    centre : complex number
        The mass centre of all masses.
    joints : list of (int, int, complex number)
        The number of the force in the joint, 1 or -1 as it or its reaction acts on the link, and where.
    torque : int, optional
        The number of an unknown torque on the link.
    loads : list of (complex number, complex number)
        Forces and where they act.
    load_torque : number
        A torque on the link.
    """

    masses: list[tuple[Any, Series]]
    spin: Any
    centre: Any
    joints: list[tuple[int, int, Any]]
    torque: int | None = None
    loads: list[tuple[Any, Any]] = field(default_factory=list)
    load_torque: Any = 0

    def rows(self, unknowns: int, gravity: Any) -> list[list[Any]]:
        """Return the equations of force, x and y, and of moment about the mass centre."""
        force, moment = -sum(load for load, _ in self.loads), self.spin - self.load_torque
        moment -= sum(cross(at - self.centre, load) for load, at in self.loads)
        for mass, place in self.masses:
            supplied = mass * (place.derivative(2) - gravity)
            force += supplied
            moment += cross(place.terms[0] - self.centre, supplied)
        rows: list[list[Any]] = [[0] * unknowns for _ in range(3)]
        for number, sign, at in self.joints:
            arm = at - self.centre
            rows[0][2 * number], rows[1][2 * number + 1] = sign, sign
            rows[2][2 * number], rows[2][2 * number + 1] = -sign * arm.imag, sign * arm.real
        if self.torque is not None:
            rows[2][self.torque] = 1
        for row, side in zip(rows, (force.real, force.imag, moment), strict=True):
            row.append(side)
        return rows


def reactions(links: Sequence[Link], further: Sequence[Sequence[Any]], gravity: Any) -> list[Any]:
    """Return the unknown forces, x and y of each, and the torque, by LU.

    Parameters
    ----------
    links : sequence of Link
        The links, with three equations each.
    further : sequence of rows
        Further equations.
    gravity : complex number
        Its acceleration.
    """
    unknowns = 3 * len(links) + len(further)
    rows = [row for link in links for row in link.rows(unknowns, gravity)]
    return linear_solution([*rows, *further])


def bar_data(ctx: Any, at: Mapping[str, Any], number: int, length: Any) -> tuple[Any, Any, Any]:
    """Return mass, moment of inertia and mass centre of a link in its frame, given or those of a round bar."""
    mass = inertia = None
    if "density" in at and "radius" in at:
        mass = at["density"] * ctx.pi * at["radius"] ** 2 * length
    mass = at.get(f"m{number}", mass)
    if "radius" in at and mass is not None:
        inertia = mass * (length**2 / 12 + at["radius"] ** 2 / 4)
    inertia = at.get(f"I{number}", inertia)
    centre = ctx.mpc(at.get(f"G{number}_u", length / 2), at.get(f"G{number}_v", 0))
    if mass is None or inertia is None:
        raise LookupError(f"no mass of link {number}")
    return mass, inertia, centre
