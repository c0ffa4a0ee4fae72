"""Table functions of the input position, once per sweep.

A table holds the doubles nearest to the exact values, its low parts those nearest to what is left, so that both are
the same on every machine. They come from sums of three doubles, and where a rounding of these is not certain, or
they lack a function, from mpmath, which is imported then.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink.numerics.multiple import TripleDouble

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from fastlink.facts.catalogue import Catalogue


Function = Callable[[Any], Any]

#: Up to so many angles are computed one by one, 40 us each: an array takes 0.6 ms.
FEW = 16
#: So many angles at a time: their intermediate values stay in the cache of a processor.
BLOCK = 4096
#: Tables of so many angles are kept for the next call.
MOST_KEPT = 1 << 14
#: Places of mpmath: a rounding is in doubt once in 2^85 angles, where terms cancel to 2^-64 too.
EXACT_PLACES = 256


def angle_tables(catalogue: Catalogue, names: Sequence[str], theta: NDArray[Any]) -> NDArray[Any]:
    """Return an array (names, positions) of tables at the given input positions."""
    theta = np.ascontiguousarray(theta, dtype=np.float64)
    low_parts = catalogue.table_low_parts
    bases = {name: low_parts.get(name, name) for name in names if name != catalogue.position.name}
    read = {base: (catalogue.tables[base].formula, base in low_parts.values()) for base in bases.values()}
    found = dict(zip(read, words(list(read.values()), theta), strict=True))
    table = np.empty((len(names), theta.size))
    for row, name in enumerate(names):
        table[row] = found[bases[name]][int(bases[name] != name)] if name in bases else theta
    return table


def words(functions: Sequence[tuple[Function, bool]], theta: NDArray[Any]) -> list[NDArray[Any]]:
    """Return functions at angles, each as an array (2, angles): rounded values, and low parts.

    Low parts count only if the function comes with True: without, they may be wrong in their last bits.
    """
    if theta.size <= MOST_KEPT:
        given = theta.tobytes()
        return [_kept(*function, given) for function in functions]
    found = [np.empty((2, theta.size)) for _ in functions]
    for part in _parts(theta):
        x = TripleDouble.of(theta[part])
        for function, both in zip(functions, found, strict=True):
            both[:, part] = _certain(*function, x)
    return found


@lru_cache(maxsize=64)
def _kept(function: Function, has_low: bool, theta: bytes) -> NDArray[Any]:
    """Return the words of a function at not too many angles."""
    size = len(theta) // 8
    if size <= FEW:
        return np.array([_one(function, has_low, x) for x in _numbers(theta)]).reshape(-1, 2).T
    both = np.empty((2, size))
    for part, x in zip(_parts(both[0]), _numbers(theta), strict=True):
        both[:, part] = _certain(function, has_low, x)
    return both


@lru_cache(maxsize=8)
def _numbers(theta: bytes) -> list[TripleDouble]:
    """Return angles, one by one or in parts, as numbers that keep their sines."""
    angles = np.frombuffer(theta)
    each = angles.tolist() if angles.size <= FEW else [angles[part] for part in _parts(angles)]
    return [TripleDouble.of(angle) for angle in each]


def _parts(theta: NDArray[Any]) -> list[slice]:
    return [slice(start, start + BLOCK) for start in range(0, theta.size, BLOCK)]


def _one(function: Function, has_low: bool, x: TripleDouble) -> tuple[float, float]:
    """Return the words of a function at one angle."""
    try:
        high, low, sure, low_sure = function(x).doubles()
    except (TypeError, AttributeError):
        sure = low_sure = False  # a function that these numbers do not have
    return (high, low) if (low_sure if has_low else sure) else exact_words(function, x.parts[0])


def _certain(function: Function, has_low: bool, x: TripleDouble) -> NDArray[Any]:
    """Return the words of a function at angles."""
    theta = x.parts[0]
    both, doubt = np.empty((2, theta.size)), np.ones(theta.size, dtype=bool)
    try:
        with np.errstate(all="ignore"):
            both[0], both[1], sure, low_sure = function(x).doubles()
            doubt[:] = ~(low_sure if has_low else sure)
    except (TypeError, AttributeError):
        pass
    for k in np.flatnonzero(doubt):
        both[:, k] = exact_words(function, float(theta[k]))
    return both


def exact_words(function: Function, angle: float) -> tuple[float, float]:
    """Return a function at an angle by mpmath: its rounded value, and the low part."""
    import mpmath

    # squares of small angles stand beside 1, whole turns beside great ones
    with mpmath.workprec(EXACT_PLACES + 2 * abs(math.frexp(angle)[1])):
        value = function(mpmath.mpf(angle))
        high = float(value)
        return high, float(value - high)
