"""Find the point of a focal cubic from which a crank drives the four-bar best."""

from __future__ import annotations

from typing import Any

import numpy as np

from fastlink.analysis.focal.construction import RATIOS, Construction, construction, ratio_of_share
from fastlink.analysis.focal.position import read_position
from fastlink.doors import door
from fastlink.engine.evaluate import evaluate
from fastlink.errors import Pair
from fastlink.options import check_choice
from fastlink.space.degrees import ends_of

__all__ = ["best_point"]

LEAST_ANGLE = "transmission_angle_PQ_least"
#: Supports that are compared between the limits, next to the best one, and how often: 8 times as closely each time.
SAMPLES, FEW, ROUNDS = 129, 17, 14
#: Designs that are searched at once.
BLOCK = 1000


@door
def best_point(
    a: Any, b: Any, c: Any, d: Any, phi: Any, branch: Any = 1, *, between: Any = (0.1, 0.9), by: str = "rho"
) -> Construction:
    """Find the joint F from which a crank drives a four-bar with the best transmission angle.

    It is the point of the focal cubic of the position whose crank SF turns fully, and whose least transmission angle
    at P and Q over the whole turn, ``transmission_angle_PQ_least``, is the greatest. The transmission angle at F is
    that of the rockers MA and NB alone, whatever F is.

    Parameters
    ----------
    a, b, c, d : float or array_like
        Lengths of MA, NB, AB and MN [m], broadcast with the position.
    phi : float or array_like
        Direction of MA, seen from MN [rad]. It decides where F is, but not which crank is best.
    branch : int or array_like
        1: B to the right of the directed line from A to N; 2: to the left.
    between : (float, float)
        The least and greatest MS over MN: where the support S may stand, M being at 0 and N at 1.
    by : {"rho", "s", "lambda_"}
        The input that the design has beside ``completion``.

    Returns
    -------
    Construction
        NaN, and ``values["status"]`` is ``invalid_input``, where no crank between the limits turns fully: only
        four-bars of Grashof's kind have one, every double rocker and double crank among them.

    Raises
    ------
    InputError
        A length is not in 1e-70 ... 1e70, a number is not valid, or the numbers do not broadcast.

    Notes
    -----
    Both completions of 129 supports are compared, then supports ever closer to the best one: to 1e-14 of the range
    where the angles of both ends of the stroke are equal, to 1e-8 where one of them is stationary.

    Examples
    --------
    >>> import numpy as np
    >>> import fastlink as fl
    >>> best = fl.focal.best_point(4.0, 5.0, 2.0, 4.0, 1.2, branch=2)
    >>> {name: round(float(best.values[name]), 3) for name in ("s", "r", "m", "n", "p", "q")}
    {'s': 3.135, 'r': 0.307, 'm': 0.487, 'n': 0.609, 'p': 3.112, 'q': 0.687}
    >>> round(float(np.degrees(best.values["transmission_angle_PQ_least"])), 1)
    50.6
    """
    check_choice(("best_point", "by"), by, RATIOS)
    limits = ends_of("best_point", "between", between, "1", ("write ", Pair(), " with lo < hi"))
    position = read_position("best_point", a, b, c, d, phi, branch)
    a, b, c, d, phi, branch = position
    bars = np.stack([np.ravel(length) for length in (a, b, c, d)])
    blocks = [bars[:, start : start + BLOCK] for start in range(0, max(bars.shape[1], 1), BLOCK)]
    found = np.concatenate([_best(block, limits) for block in blocks], axis=1)
    share, completion = found.reshape(2, *np.shape(a))
    design = {"a": a, "b": b, "c": c, "d": d, "rho": ratio_of_share(share), "completion": completion}
    return construction(design, {"phi": phi, "branch": branch}, by)


def _best(bars: Any, limits: tuple[float, float]) -> Any:
    """Return the shares of the best supports and their completions, NaN without a crank that turns fully."""
    first, last = (np.full(bars.shape[1], limit) for limit in limits)
    shares = np.linspace(first, last, SAMPLES)
    angles = np.stack([_least_angles(bars, shares, completion) for completion in (1.0, 2.0)])
    completion = np.where(angles[0].max(axis=0) >= angles[1].max(axis=0), 1.0, 2.0)
    angles = np.where(completion == 1.0, *angles)
    for _ in range(ROUNDS):
        step = (last - first) / (len(shares) - 1)
        share = np.take_along_axis(shares, angles.argmax(axis=0)[None], axis=0)[0]
        first, last = np.maximum(share - step, limits[0]), np.minimum(share + step, limits[1])
        shares = np.linspace(first, last, FEW)
        angles = _least_angles(bars, shares, completion)
    share = np.take_along_axis(shares, angles.argmax(axis=0)[None], axis=0)[0]
    return np.stack([np.where(angles.max(axis=0) > 0.0, share, np.nan), completion])


def _least_angles(bars: Any, shares: Any, completion: Any) -> Any:
    """Return the least transmission angle of each support, -1 where there is no crank."""
    a, b, c, d = bars
    rho = ratio_of_share(shares)
    given = {"a": a, "b": b, "c": c, "d": d, "rho": rho, "completion": completion, "phi": 0.0}
    angles = evaluate("focal", [LEAST_ANGLE], **given, allow_invalid=True)[LEAST_ANGLE]
    return np.where(np.isnan(angles), -1.0, angles)
