"""Construct a focal mechanism on a position of a four-bar: from a point F of its focal cubic (Wunderlich, section 4).

With complex numbers M = 0, N = d, A, B, F, the triangles MPF ~ FQB and NQF ~ FPA say that F - A = -(p/n) E (F - N)* and
F - B = (q/m) E (F - M)*, |E| = 1 and * the conjugate. So both ratios are products of distances, and nothing cancels:

    rho = mp/(nq) = -(F - A)(F - M)*/((F - B)(F - N)*),    lambda - 1 = pq/(mn) = -(F - B)(F - A)*/((F - N)(F - M)*).

They are real for points of the cubic, by (4.5).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from fastlink.analysis.focal.nearest import nearest_point
from fastlink.analysis.focal.position import corners, point, read_position
from fastlink.doors import door
from fastlink.engine.evaluate import evaluate
from fastlink.numerics.compensated import UNIT_ROUNDING
from fastlink.options import check_choice

__all__ = ["Construction", "from_point"]

#: What may determine the completion beside its number.
RATIOS = ("rho", "s", "lambda_")
LENGTHS = ("status", "lambda_", "m", "n", "p", "q", "s", "r", "FT", "T_ratio")
ANGLES = ("psi", "sigma", "omega_angle", "alpha", "beta", "chi")
DRIVE = ("crank_type", "transmission_angle_PQ_least", "transmission_angle_F_least")
JOINTS = tuple(f"{joint}_{axis}" for joint in "ABPQTF" for axis in "xy")


@dataclass(frozen=True)
class Construction:
    """A focal mechanism constructed on a four-bar in a position; see `from_point` and `best_point`.

    Attributes
    ----------
    design : dict of str to ndarray
        The inputs of ``focal``: ``a``, ``b``, ``c``, ``d``, one of ``rho``, ``s`` and ``lambda_``, and ``completion``.
        `fastlink.sweep` takes them, and so does `fastlink.evaluate`.
    position : dict of str to ndarray
        ``phi`` and ``branch``.
    values : dict of str to ndarray
        Lengths, angles, joints and properties of the drive in that position, by their names as quantities of ``focal``.
    """

    design: dict[str, Any]
    position: dict[str, Any]
    values: dict[str, Any]


@door
def from_point(
    a: Any, b: Any, c: Any, d: Any, phi: Any, branch: Any = 1, *, x: Any, y: Any, by: str = "rho"
) -> Construction:
    """Construct the focal mechanism of a four-bar in a position, from its joint F.

    Parameters
    ----------
    a, b, c, d : float or array_like
        Lengths of MA, NB, AB and MN [m], broadcast with the position and the point.
    phi : float or array_like
        Direction of MA, seen from MN [rad].
    branch : int or array_like
        1: B to the right of the directed line from A to N; 2: to the left.
    x, y : float or array_like
        F, origin in M and x along MN [m]. Of points off the focal cubic (`cubic_points` traces it) the nearest point
        of the cubic is taken.
    by : {"rho", "s", "lambda_"}
        The input that the design has beside ``completion``.

    Returns
    -------
    Construction
        Its ``values["F_x"]``, ``values["F_y"]`` are the point that was taken. There is no mechanism, and
        ``values["status"]`` tells why, where F is M, N, A or B (bars of length 0) and where the four-bar does not
        assemble in this position (``invalid_input``: no ratio).

    Raises
    ------
    InputError
        A length is not in 1e-70 ... 1e70, a number is not valid, or the numbers do not broadcast.

    Notes
    -----
    Both ratios are products of distances of F from the corners, rho = -+FA FM/(FB FN) and lambda - 1 = -+FB FA/(FN FM),
    with signs by (4.4); lengths and joints then are those of ``focal``. Where both completions meet, a design by rho
    has half the digits of the point, one by lambda all of them, and the other way round where both roots of rho meet.

    Examples
    --------
    The mechanism of Figure 4, from the point in which circles on MA and NB as diameters meet:

    >>> import numpy as np
    >>> import fastlink as fl
    >>> made = fl.focal.from_point(5.0, 5.0, 2.0, 4.0, np.arccos(0.2), branch=2, x=2.0, y=0.449489742783178)
    >>> {name: round(float(made.values[name]), 4) for name in ("lambda_", "m", "p", "r")}
    {'lambda_': 5.9495, 'm': 0.8404, 'p': 1.8697, 'r': 0.4495}
    >>> {name: round(float(value), 9) for name, value in made.design.items()}
    {'a': 5.0, 'b': 5.0, 'c': 2.0, 'd': 4.0, 'rho': 1.0, 'completion': 1.0}
    >>> turn = fl.sweep("focal", made.design, ["T_y"], input="sigma", branch=1)
    """
    check_choice(("from_point", "by"), by, RATIOS)
    further = ((point("x"), x), (point("y"), y))
    *position, x, y = read_position("from_point", a, b, c, d, phi, branch, further=further)
    a, b, c, d, phi, branch = position
    A, B = corners(*position)
    F = nearest_point(tuple(position), x + 1j * y)
    size = np.maximum(np.maximum(a, b), np.maximum(c, d))
    to_A, to_B, to_M, to_N = (_apart(F - corner, size) for corner in (A, B, 0.0, d))
    with np.errstate(all="ignore"):
        rho = -_real_ratio(to_A * np.conj(to_M), to_B * np.conj(to_N))
        excess = -_real_ratio(to_B * np.conj(to_A), to_N * np.conj(to_M))
        completion = np.where(np.abs(excess) * d >= c, 1.0, 2.0)  # the roots have the product (c/d)^2
    design = {"a": a, "b": b, "c": c, "d": d, "rho": rho, "completion": completion}
    return construction(design, {"phi": phi, "branch": branch}, by, 1.0 + excess)


def _apart(vector: Any, size: Any) -> Any:
    """Return a vector from a corner to F over a size, 0 where F is the corner but for roundings."""
    vector = vector / size
    return np.where(np.abs(vector) <= 8.0 * UNIT_ROUNDING, 0.0, vector)


def _real_ratio(above: Any, below: Any) -> Any:
    """Return a ratio that is real but for roundings; infinite over 0."""
    size = np.abs(below)
    real = (above * np.conj(below)).real
    return np.where((size == 0.0) & (above != 0.0), np.inf, np.copysign(np.abs(above) / size, real))


def ratio_of_share(share: Any) -> Any:
    """Return rho of MS over MN."""
    with np.errstate(divide="ignore"):
        return share / (1.0 - share)


def construction(
    design: dict[str, Any], position: dict[str, Any], by: str, lambda_: Any = None
) -> Construction:
    """Return a design by rho as one by another ratio, with its lengths, angles and joints in a position."""
    if by != "rho":
        design = _by_other_ratio(design, by, lambda_)
    names = [name for name in (*LENGTHS, *ANGLES, *DRIVE, *JOINTS) if name not in design]
    values = evaluate("focal", names, **design, **position, allow_invalid=True)
    return Construction(design, position, values | {by: design[by]})


def _by_other_ratio(design: dict[str, Any], by: str, lambda_: Any) -> dict[str, Any]:
    """Return a design by s or lambda instead of rho."""
    rho, completion, a, b, d = (design[name] for name in ("rho", "completion", "a", "b", "d"))
    bars = {name: design[name] for name in "abcd"}
    with np.errstate(all="ignore"):
        if by == "s":
            share = np.where(np.abs(rho) > 1.0, 1.0 / (1.0 + 1.0 / rho), rho / (1.0 + rho))
            return bars | {"s": d * share, "completion": completion}
        if lambda_ is None:
            lambda_ = evaluate("focal", ["lambda_"], **design, phi=0.0, allow_invalid=True)["lambda_"]
        # of a given lambda the roots of rho have the product (a/b)^2
        return bars | {"lambda_": lambda_, "completion": np.where(np.abs(rho) * b >= a, 1.0, 2.0)}
