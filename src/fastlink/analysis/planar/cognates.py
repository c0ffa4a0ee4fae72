"""Roberts' cognates: the three planar 4R that trace one coupler curve."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from fastlink.analysis.designs import BY_NAME, CURVE, broadcast, read_design
from fastlink.catalogue.catalogue import Input
from fastlink.doors import door
from fastlink.mechanisms.planar_4r import planar_4r

__all__ = ["Cognate", "cognates"]


@dataclass(frozen=True)
class Cognate:
    """One of the three linkages that trace the same coupler curve; see `cognates`.

    Attributes
    ----------
    design : dict of str to ndarray
        Lengths a1 ... a4 and coupler point P_u, P_v [m], as inputs of planar_4r in the linkage's own ground frame.
    O_x, O_y, D_x, D_y : ndarray
        Ground pivots of its input and output link [m] in the ground frame of the original.
    number : int
        1 for the original, 2 and 3 for its cognates.
    """

    design: dict[str, Any]
    O_x: Any
    O_y: Any
    D_x: Any
    D_y: Any
    number: int

    def configuration(self, theta1: Any, theta2: Any, theta4: Any) -> tuple[Any, Any]:
        """Return the input angle [rad] and branch at a configuration of the original.

        Parameters
        ----------
        theta1, theta2, theta4 : float or array_like
            Directions of crank, coupler and output link of the original [rad].

        Returns
        -------
        theta1, branch : ndarray
            In the linkage's own frame. The coupler's direction drives both cognates; their branch changes where
            crank and output link of the original are parallel, which is a toggle of theirs. The branch is NaN where
            a direction is, such as where the original does not assemble.
        """
        directions = (
            Input(name, "rad", name, "direction of a link") for name in ("theta1", "theta2", "theta4")
        )
        t1, t2, t4 = broadcast("configuration", directions, theta1, theta2, theta4, gaps=True)
        own = t1 if self.number == 1 else t2
        one, other = {1: (t2, t4), 2: (t1, t4), 3: (t4, t1)}[self.number]
        with np.errstate(over="ignore"):  # of directions beyond 1e308
            turn = other - one
        known = np.isfinite(turn) & ~np.isnan(own)
        return own, np.where(known, np.where(np.sin(np.where(known, turn, 0.0)) > 0.0, 2.0, 1.0), np.nan)

    def to_ground(self, x: Any, y: Any) -> tuple[Any, Any]:
        """Return a point (x, y) [m] of the linkage's own ground frame in that of the original."""
        x, y = broadcast(
            "to_ground", (Input(name, "m", name, "coordinate") for name in "xy"), x, y, gaps=True
        )
        ground = self.design["a4"]
        cosine, sine = (self.D_x - self.O_x) / ground, (self.D_y - self.O_y) / ground
        return self.O_x + (cosine * x - sine * y), self.O_y + (sine * x + cosine * y)


@door(hint=BY_NAME)
def cognates(design: Any = None, **inputs: Any) -> tuple[Cognate, Cognate, Cognate]:
    """Return the three linkages that trace one coupler curve (Roberts, Chebyshev).

    Parameters
    ----------
    design : mapping, pandas.DataFrame or xarray.Dataset, optional
        Inputs of ``planar_4r`` by name: lengths ``a1`` ... ``a4`` and coupler point ``P_u``, ``P_v`` [m], broadcast.
        Other inputs are not read.
    **inputs : float, array_like or xarray.DataArray
        The same by name.

    Returns
    -------
    tuple of Cognate
        The original; the one on O and E; the one on D and E, where E is the third ground pivot, the triangle
        O D E being similar to A B P. If P is A, the second has lengths zero and no direction (NaN); if P is B,
        the third.

    Notes
    -----
    With complex numbers, let lambda = (P_u + i P_v)/a2 and mu = 1 - lambda, so that P = A + lambda AB =
    B + mu BA, and E = lambda OD. The second linkage has the links OA' = lambda AB, A'B' = lambda OA and
    EB' = lambda DB, and P = A' + OA; the third has DA" = mu BA, A"B" = mu DB and EB" = mu OA, and P = A" + DB.
    Both loops close because the original does (S. Roberts, Proc. London Math. Soc. 7, 1875, 14-23).

    Raises
    ------
    InputError
        The design lacks a number, or one is not valid.

    Examples
    --------
    >>> import fastlink as fl
    >>> design = {"a1": 0.5, "a2": 1.0, "a3": 0.75, "a4": 2.0, "P_u": 0.0, "P_v": 2.0}
    >>> first, second, third = fl.planar.cognates(design)
    >>> [float(second.design[name]) for name in ("a1", "a2", "a3", "a4")]
    [2.0, 1.0, 1.5, 4.0]
    >>> float(second.D_x), float(second.D_y)
    (0.0, 4.0)
    """
    a1, a2, a3, a4, u, v = read_design("cognates", planar_4r, design, inputs, CURVE).values()
    zero = np.zeros_like(a4)
    along, across = u / a2, v / a2
    E_x, E_y = along * a4, across * a4
    rest = (a2 - u) / a2
    with np.errstate(invalid="ignore"):  # zero over zero: a cognate of lengths zero
        size = np.hypot(u, v) / a2
        second = (size * a2, size * a1, size * a3, size * a4, a1 * (along / size), -a1 * (across / size))
        size = np.hypot(a2 - u, v) / a2
        third = (size * a2, size * a3, size * a1, size * a4, a3 * (rest / size), a3 * (across / size))
    pivots = ((zero, zero, a4, zero), (zero, zero, E_x, E_y), (a4, zero, E_x, E_y))
    numbers = ((a1, a2, a3, a4, u, v), second, third)
    one, two, three = (
        Cognate(dict(zip(CURVE, own, strict=True)), *pivot, number)
        for number, (own, pivot) in enumerate(zip(numbers, pivots, strict=True), 1)
    )
    return one, two, three
