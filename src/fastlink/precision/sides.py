"""Signs of slopes at samples: by doubles, and with many digits wherever a change of sign rests on them.

Beside a fold, and of what is constant, a slope in doubles is nothing but its rounding error: its changes of sign look
like extremes. All precisions evaluate the same facts: where doubles and 50 digits agree, neither is noise, which is
2^115 times as great in doubles. Elsewhere further digits tell.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink.precision.reference import CONTEXT

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["side_of", "turning_cells"]

#: Two precisions agree to this share of a slope.
AGREE = 0.25
#: Further digits, no multiple of 50: noise may be a product of errors, as great with twice as many digits.
FURTHER = 137


def side_of(doubles: float, slope: Callable[[], Any]) -> float:
    """Return the sign of a slope, 0 where it is nothing but noise.

    Parameters
    ----------
    doubles : float
        The slope in doubles.
    slope : callable
        Returns the slope at the working precision.

    Examples
    --------
    >>> side_of(-1e-3, lambda: CONTEXT.mpf(1e-9)), side_of(-1e-3, lambda: +CONTEXT.eps)
    (1.0, 0.0)
    """
    exact = slope()
    if exact != exact or not np.isfinite(doubles):
        return float(np.sign(doubles))
    if abs(exact - doubles) < AGREE * abs(exact):
        return float(np.sign(doubles))
    with CONTEXT.workdps(FURTHER):
        finer = slope()
        sure = abs(exact - finer) < AGREE * abs(finer)
    return (float(finer > 0) - float(finer < 0)) if sure else 0.0


def turning_cells(
    sides: NDArray[Any], apart: NDArray[Any], exactly: Callable[[int, int, int], float]
) -> tuple[NDArray[Any], NDArray[Any]]:
    """Return the cells between whose ends a slope changes its sign, and the signs.

    Parameters
    ----------
    sides : array (designs, 2, samples)
        Signs of slopes in doubles, counted from the lower and from the upper end: the first samples of both are one
        position, and so are the last.
    apart : bool array (designs, 2, samples - 1)
        Cells that may hold no change.
    exactly : callable
        Returns the sign of a slope with 50 digits, by its indices in `sides`.
    """
    sides, known = sides.copy(), np.zeros(sides.shape, dtype=bool)
    last = sides.shape[-1] - 1
    while True:
        filled = _filled(sides)
        turning = ~apart & (filled[..., 1:] * filled[..., :-1] < 0.0)
        doubtful = np.zeros_like(known)
        doubtful[..., 1:] |= turning
        doubtful[..., :-1] |= turning
        doubtful &= ~known
        if not doubtful.any():
            return turning, filled
        for design, end, sample in np.argwhere(doubtful).tolist():
            ends = slice(None) if sample in (0, last) else end
            sides[design, ends, sample] = exactly(design, end, sample)
            known[design, ends, sample] = True


def _filled(sides: NDArray[Any]) -> NDArray[Any]:
    """Return signs without zeros: of the sample before on the way from the middle of the range to an end."""
    filled = sides.copy()
    # Both ends are counted from one position; a zero of the slope there belongs to one of them.
    seam = np.where(filled[:, 0, [0, -1]] == 0.0, filled[:, 0, [1, -2]], filled[:, 0, [0, -1]])
    filled[:, :, [0, -1]] = seam[:, None, :]
    half = filled.shape[-1] // 2
    for way in (filled[..., :half], filled[..., : half - 1 : -1]):
        before = np.maximum.accumulate(np.where(way != 0.0, np.arange(half), 0), axis=-1)
        way[...] = np.take_along_axis(way, before, axis=-1)
    return filled
