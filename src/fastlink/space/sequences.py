"""Samples whose designs are computed from their numbers alone: Sobol's sequence and Latin hypercubes."""

from __future__ import annotations

import hashlib
import math
import threading
from abc import abstractmethod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fastlink.space.column import STEP, Column
from fastlink.space.values import Floats

__all__ = ["Permutation", "Slices", "SobolAxis", "rounds_of", "slices_axes", "sobol_axes", "sobol_bits"]

Words = NDArray[np.uint64]
#: Bits of the sequence up to 2^30 designs, those of scipy, and beyond: as many as a double holds.
FEW_BITS, ALL_BITS = 30, 53
#: Points of Sobol's sequence that are looked up; the others follow by one exclusive or.
TABLE_BITS = 12
#: Points that are compared with scipy's own.
COMPARED = 64
#: Values of a Latin hypercube that are computed at once, in the caches.
AT_ONCE = 4096
#: Rounds of the permutation of many designs; of few ones, whose orders would not come equally often.
ROUNDS, OF_FEW, FEW = 6, 16, 4096
#: Odd multipliers of the finalizers of SplitMix64 and MurmurHash3, which spread each bit over all higher ones, and a
#: shift between; by the bits of a word.
MULTIPLIERS = {64: (0xBF58476D1CE4E5B9, 0x94D049BB133111EB, 29), 32: (0x85EBCA6B, 0xC2B2AE35, 13)}


class _Last(threading.local):
    """The last block that a thread has computed."""

    def __init__(self) -> None:
        self.range, self.values = (0, 0), np.empty(0)


class _Axis(Column):
    """An input that is sampled uniformly between two ends.

    Parameters
    ----------
    length : int
        The number of designs.
    bounds : (float, float)
        The ends.
    """

    @abstractmethod
    def unit(self, start: int, stop: int, out: Floats) -> None:
        """Write points between 0 and 1."""

    def __init__(self, length: int, bounds: tuple[float, float]) -> None:
        super().__init__(length, bounds)
        self._last = _Last()

    def read(self, start: int, stop: int, out: NDArray[Any]) -> None:
        """Write some values; the last block of a thread is kept, for kernels and files take it one after the other."""
        if self._last.range == (start, stop):
            out[:] = self._last.values
            return
        low, high = self.bounds
        self.unit(start, stop, out)
        out *= high - low
        out += low
        np.minimum(out, high, out=out)  # where the sum is rounded to beyond the end
        if stop - start <= STEP:
            self._last.range, self._last.values = (start, stop), out.copy()

    def __getstate__(self) -> dict[str, Any]:
        return {name: value for name, value in vars(self).items() if name != "_last"}

    def __setstate__(self, state: dict[str, Any]) -> None:
        vars(self).update(state)
        self._last = _Last()


class SobolAxis(_Axis):
    """An axis of scipy's scrambled Sobol sequence.

    Point k is the exclusive or of the shift and of one word for each bit of k: scipy's words belong to the bits of the
    Gray code of k, which is k ^ (k >> 1), so that bit j of k stands for its words j and j - 1.

    Parameters
    ----------
    words : array
        The direction numbers.
    shift : int
        The first point.
    length : int
        The number of designs.
    bounds : (float, float)
        The ends.
    """

    def __init__(self, words: NDArray[Any], shift: int, length: int, bounds: tuple[float, float]) -> None:
        super().__init__(length, bounds)
        self.words = words ^ np.concatenate([words[:1] ^ words[:1], words[:-1]])
        self.shift = int(shift)
        table = np.zeros(1, words.dtype)
        for word in self.words[:TABLE_BITS]:
            table = np.concatenate([table, table ^ word])
        self.table, self.scale = table, 0.5 ** len(words)

    def unit(self, start: int, stop: int, out: Floats) -> None:
        """Write points between 0 and 1."""
        size = len(self.table)
        for first in range(start // size * size, stop, size):
            begin, end = max(start, first), min(stop, first + size)
            words = self.table[begin - first : end - first] ^ self.table.dtype.type(self._point(first))
            np.multiply(words, self.scale, out=out[begin - start : end - start])

    def _point(self, number: int) -> int:
        """Return the point of a number as a whole number."""
        point, bit = self.shift, 0
        while number:
            if number & 1:
                point ^= int(self.words[bit])
            number, bit = number >> 1, bit + 1
        return point

    @property
    def definition(self) -> tuple[Any, ...]:
        """The class and its parameters."""
        words = hashlib.sha256(self.words.astype("<u8").tobytes()).hexdigest()
        return "sobol", words, self.shift, len(self.words), self.length, self.bounds


def sobol_bits(n: int) -> int:
    """Return the bits of the sequence of so many designs: 30, those of scipy, as long as these tell all apart."""
    return FEW_BITS if n <= 1 << FEW_BITS else ALL_BITS


def sobol_axes(n: int, seed: int, bounds: list[tuple[float, float]]) -> list[Column]:
    """Return the axes of the first n points of scipy's scrambled Sobol sequence."""
    import scipy
    from scipy.stats import qmc

    version = tuple(int(part) for part in scipy.__version__.split(".")[:2])
    keyword = "rng" if version >= (1, 15) else "seed"
    options: dict[str, Any] = {keyword: np.random.default_rng(seed), "bits": sobol_bits(n)}
    engine: Any = qmc.Sobol(len(bounds), **options)
    words, shift = engine._sv.copy(), engine._shift.tolist()
    axes = [SobolAxis(words[k], shift[k], n, ends) for k, ends in enumerate(bounds)]
    points, compared = np.empty((COMPARED, len(axes))), engine.random(COMPARED)
    for axis, column in zip(axes, points.T, strict=True):
        axis.unit(0, COMPARED, column)
    if not np.array_equal(points, compared):
        raise RuntimeError(f"scipy {scipy.__version__} makes Sobol points in another way than is known here")
    return list(axes)


def rounds_of(n: int) -> int:
    """Return the rounds of a permutation of so many numbers."""
    return OF_FEW if n <= FEW else ROUNDS


class Permutation:
    """A permutation of 0 to n - 1 in which each number is computed without the others.

    A Feistel network on numbers l b + r, l < a, r < b, with a and b near the square root of n: by turns l and r are
    shifted, modulo a and b, by a hash of the other one and of a key. Numbers from n to a b - 1, of which there are less
    than a, are mapped again, until they fall below n. Up to 2^32 the words have 32 bits, for speed.

    Parameters
    ----------
    n : int
        How many numbers, below 2^52.
    keys : array
        Of 64 bits, one for each round.

    Examples
    --------
    >>> keys = np.arange(6, dtype=np.uint64)
    >>> sorted(Permutation(10, keys)(np.arange(10, dtype=np.uint64)).tolist())
    [0, 1, 2, 3, 4, 5, 6, 7, 8, 9]
    """

    def __init__(self, n: int, keys: Words) -> None:
        self.n, self.kind = n, np.uint32 if n <= 1 << 32 else np.uint64
        self.a = math.isqrt(n - 1) + 1
        self.b = -(-n // self.a)
        self.keys = keys.astype(self.kind)

    def __call__(self, numbers: Words) -> Words:
        """Return the images of some numbers."""
        images = self._network(numbers.astype(self.kind))
        outside = np.flatnonzero(images > self.n - 1)
        while outside.size:
            images[outside] = self._network(images[outside])
            outside = outside[images[outside] > self.n - 1]
        return images.astype(np.uint64)

    def _network(self, numbers: NDArray[Any]) -> NDArray[Any]:
        kind, b = self.kind, self.kind(self.b)
        left = numbers // b
        right = numbers - left * b
        half, sides = kind(4 * numbers.itemsize), [(left, kind(self.a)), (right, b)]
        mixed, wrapped = np.empty_like(numbers), np.empty_like(numbers)
        for key in self.keys:
            (side, size), (other, _) = sides
            np.bitwise_xor(other, key, out=mixed)
            _mix(mixed, wrapped)
            mixed *= size
            mixed >>= half
            side += mixed
            np.subtract(side, size, out=wrapped)  # below zero it wraps to beyond all
            np.minimum(side, wrapped, out=side)
            sides.reverse()
        left *= b
        left += right
        return left


def _mix(words: NDArray[Any], scratch: NDArray[Any]) -> None:
    """Replace words by hashes of half as many bits."""
    kind, bits = words.dtype.type, 8 * words.itemsize
    first, second, shift = MULTIPLIERS[bits]
    words *= kind(first)
    np.right_shift(words, kind(shift), out=scratch)
    words ^= scratch
    words *= kind(second)
    words >>= kind(bits // 2)


class Slices(_Axis):
    """An axis of a Latin hypercube: each of n equal slices of the range holds one design, somewhere inside.

    Parameters
    ----------
    length : int
        The number of designs, at most 2^50.
    bounds : (float, float)
        The ends.
    seed, axis : int
        From which the order of the slices and the places inside them follow.
    """

    def __init__(self, length: int, bounds: tuple[float, float], seed: int, axis: int) -> None:
        super().__init__(length, bounds)
        self.seed, self.axis = seed, axis
        keys: Any = np.random.SeedSequence(seed, spawn_key=(axis,)).generate_state(
            rounds_of(length) + 1, np.uint64
        )
        self.permutation, self.key = Permutation(length, keys[:-1]), keys[-1]
        # so many that slice and place together are one double: its quotient by n lies in the slice, rounded as it is,
        # for places are half a step away from either end, which is more than 2^-53 of the number of any slice
        self.bits = min(32, 52 - (length - 1).bit_length())

    def unit(self, start: int, stop: int, out: Floats) -> None:
        """Write points between 0 and 1."""
        for first in range(start, stop, AT_ONCE):
            last = min(first + AT_ONCE, stop)
            slices = self.permutation(np.arange(first, last, dtype=np.uint64))
            places = slices ^ self.key
            _mix(places, np.empty_like(places))
            places >>= np.uint64(32 - self.bits)
            target = out[first - start : last - start]
            np.add(places, 0.5, out=target)
            target *= 0.5**self.bits
            target += slices
            target /= self.length

    @property
    def definition(self) -> tuple[Any, ...]:
        """The class and its parameters."""
        return "slices", self.seed, self.axis, self.length, self.bounds


def slices_axes(n: int, seed: int, bounds: list[tuple[float, float]]) -> list[Column]:
    """Return the axes of a Latin hypercube of n designs."""
    return [Slices(n, ends, seed, axis) for axis, ends in enumerate(bounds)]
