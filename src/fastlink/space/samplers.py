"""Make design spaces: full grids and space-filling samples of inputs."""

from __future__ import annotations

import hashlib
import math
import threading
from abc import abstractmethod
from collections.abc import Callable, Mapping
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fastlink._text import counted, short_repr
from fastlink.errors import MOST_SEED, InputError, Pair, Problems, Samples, check_whole, door, remark
from fastlink.space.design_space import (
    STEP,
    Column,
    DesignSpace,
    Floats,
    axis_of,
    check_input_name,
    constant,
    numbers_of,
    sampled,
    units_of,
)

# -- Samples whose designs are computed from their numbers alone: Sobol's sequence and Latin hypercubes


T = TypeVar("T")
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

    def __reduce__(self) -> tuple[type[_Last], tuple[()]]:
        return _Last, ()  # another process has computed none


class _Axis(Column):
    """An input that is sampled uniformly between two ends."""

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


class SobolAxis(_Axis):
    """An axis of scipy's scrambled Sobol sequence.

    Point k is the exclusive or of the shift and of one word for each bit of k: scipy's words belong to the bits of the
    Gray code of k, which is k ^ (k >> 1), so that bit j of k stands for its words j and j - 1.
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
    """An axis of a Latin hypercube: each of n equal slices of the range holds one design, somewhere inside."""

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


MOST_DESIGNS = 2**62  # flat design numbers are int64
#: A double tells no more designs of a sample apart, each in its slice of a range.
MOST_SAMPLES = 2**50
#: A third value is rather a number of values if it is at least so much, and so many times the first two.
FEWEST, FAR = 2, 4
#: How an input is given that is called like a parameter.
OF_THAT_NAME = "an input called n is given in a mapping, such as {'n': (1.0, 2.0)}"


@door
def grid(axes: Mapping[str, ArrayLike] | None = None, /, **more: ArrayLike) -> DesignSpace:
    """Sweep every combination of the values given.

    Parameters
    ----------
    axes : mapping, optional
        The inputs as a mapping, beside or instead of keywords.
    **more : float or array_like
        A number is a constant; a 1-D array of distinct values is a swept axis and a dimension of that name,
        in the order given (the last one varies fastest).

    Returns
    -------
    DesignSpace
        Of kind ``"grid"``; one design without dimensions when everything is constant.

    Examples
    --------
    >>> import numpy as np
    >>> space = grid(a1=0.4, a2=np.linspace(1.0, 1.4, 5), a3=[0.6, 0.8], a4=1.0)
    >>> space.dims, space.shape, space.size
    (('a2', 'a3'), (5, 2), 10)
    """
    problems, given = Problems(), _keywords("grid", axes, more)
    constants, swept, units = _read("grid", given, axis_of, problems)
    problems.stop()
    if name := next((name for name in swept if _is_linspace(given[name])), ""):
        what = f"{given[name]} is an axis of these three values"
        remark(what, ("grid", name), ("if it is a range, write ", Samples(*given[name])))
    shape = tuple(len(values) for values in swept.values())
    if math.prod(shape) > MOST_DESIGNS:
        lengths = ", ".join(f"{name}: {length}" for name, length in zip(swept, shape, strict=True))
        what = f"{math.prod(shape):.3g} designs are too many"
        raise InputError(what, where=("grid",), remedy=f"shorten an axis ({lengths})")
    attrs: dict[str, str | int] = {"design_kind": "grid"}
    return DesignSpace("grid", tuple(swept), shape, constants, axes=swept, attrs=attrs, units=units)


def _is_linspace(given: Any) -> bool:
    """Tell whether an axis is rather the ends and the number of its values: a whole number far beyond both."""
    count = given[2] if isinstance(given, tuple) and len(given) == 3 else None
    return type(count) is int and count >= FEWEST and count > FAR * max(abs(given[0]), abs(given[1]))


def _keywords(kind: str, axes: Any, more: Mapping[str, ArrayLike]) -> dict[str, Any]:
    """Return the inputs of a grid or a sample that are given as a mapping, by keywords, or both."""
    if axes is None:
        return dict(more)
    if not isinstance(axes, Mapping) or not all(isinstance(name, str) for name in axes):
        remedy = "write inputs by name, such as a2=" + ("[1.1, 1.2]" if kind == "grid" else "(1.1, 1.2)")
        where = (kind,) if kind == "grid" else (kind, "ranges")
        raise InputError(f"is {short_repr(axes)}", where=where, remedy=remedy)
    for name in axes.keys() & more.keys():
        raise InputError("is given twice", where=(kind, name), remedy="write it once")
    return {**axes, **more}


def _read(
    kind: str, given: Mapping[str, Any], several: Callable[[str, str, Floats], T], problems: Problems
) -> tuple[dict[str, float], dict[str, T], dict[str, str]]:
    """Return the constants, what `several` makes of inputs with several values, and the units that these state."""
    constants, swept, units = dict[str, float](), dict[str, T](), dict[str, str]()
    for name, one in given.items():
        with problems.at(kind, name):
            check_input_name(kind, name)
            values = numbers_of(kind, name, one)
            units |= units_of(name, one)
            if values.ndim == 0:
                constants[name] = constant(kind, name, values)
            else:
                swept[name] = several(kind, name, values)
    return constants, swept, units


@door(hint=OF_THAT_NAME)
def sobol(
    n: int, ranges: Mapping[str, ArrayLike] | None = None, *, seed: int = 0, **more: ArrayLike
) -> DesignSpace:
    """Sample inputs by a scrambled Sobol sequence, along the dimension ``design``.

    Each design is computed from its number where it is looked at: 10^10 designs need no memory.

    Parameters
    ----------
    n : int
        Number of designs, at most 2^50. Only powers of two keep the full balance of the sequence; any other
        number is its first `n` points. Up to 2^30 designs these have 30 bits, as those of scipy; more have 53.
    ranges : mapping, optional
        The inputs as a mapping, beside or instead of keywords: for Hart's input ``n``, ``{"n": (1.0, 2.0)}``.
    seed : int, default 0
        Seed of the scrambling; the same seed gives the same designs.
    **more : float or (lo, hi)
        A number is a constant; a pair is sampled uniformly between its ends.

    Returns
    -------
    DesignSpace
        Of kind ``"sobol"``; seed, number, ranges, bits and scipy's version are in its `attrs`.

    Examples
    --------
    >>> space = sobol(8, seed=1, a1=(0.2, 0.4), a2=(1.0, 1.4), a4=1.0)
    >>> space.shape, space.constants
    ((8,), {'a4': 1.0})
    >>> bool(space.columns["a1"].min() >= 0.2)
    True
    """
    return _sample("sobol", n, seed, _keywords("sobol", ranges, more), sobol_axes)


@door(hint=OF_THAT_NAME)
def latin_hypercube(
    n: int, ranges: Mapping[str, ArrayLike] | None = None, *, seed: int = 0, **more: ArrayLike
) -> DesignSpace:
    """Sample the inputs by a Latin hypercube, along the dimension ``design``.

    Each of `n` equal slices of every range holds exactly one design. Each design is computed from its number where it
    is looked at, by a permutation of the slices that the seed determines: 10^10 designs need no memory.

    Parameters
    ----------
    n : int
        Number of designs, at most 2^50.
    ranges : mapping, optional
        The inputs as a mapping, beside or instead of keywords: for Hart's input ``n``, ``{"n": (1.0, 2.0)}``.
    seed : int, default 0
        The same seed gives the same designs.
    **more : float or (lo, hi)
        A number is a constant; a pair is sampled between its ends.

    Returns
    -------
    DesignSpace
        Of kind ``"latin_hypercube"``; seed, number, ranges and the method are in its `attrs`.

    Examples
    --------
    >>> space = latin_hypercube(4, a1=(0.0, 4.0), a4=1.0)
    >>> sorted(int(value) for value in space.columns["a1"])
    [0, 1, 2, 3]
    """
    return _sample("latin_hypercube", n, seed, _keywords("latin_hypercube", ranges, more), slices_axes)


def _sample(
    kind: str,
    n: int,
    seed: int,
    ranges: Mapping[str, ArrayLike],
    axes: Callable[[int, int, list[tuple[float, float]]], list[Column]],
) -> DesignSpace:
    """Return the sample whose columns ``axes(n, seed, ranges)`` gives."""
    problems = Problems()
    remedy = f"write an integer from 1 to {MOST_SAMPLES}"
    problems.attempt(check_whole, (kind, "n"), n, 1, MOST_SAMPLES, remedy)
    remedy = f"write an integer from 0 to {MOST_SEED}"
    problems.attempt(check_whole, (kind, "seed"), seed, 0, MOST_SEED, remedy)
    constants, bounds, units = _read(kind, ranges, _range, problems)
    if not (bounds or problems.noted):
        problems.add("no input has a range", (kind,), ("write ", Pair(), " for at least one, or use a grid"))
    problems.stop()
    columns = dict(zip(bounds, axes(int(n), int(seed), list(bounds.values())), strict=True))
    return sampled(kind, constants, columns, _sample_attrs(kind, int(n), int(seed), bounds), units=units)


def _range(kind: str, name: str, values: Floats) -> tuple[float, float]:
    if len(values) != 2:
        remedy = ("write ", Pair(), ", or a number for a constant")
        raise InputError(f"holds {counted(len(values), 'value')}", where=(kind, name), remedy=remedy)
    low, high = float(values[0]), float(values[1])
    if not math.isfinite(high - low):
        raise InputError(f"runs from {low} to {high}", where=(kind, name), remedy="write finite ends")
    if low >= high:
        remedy = ("write ", Pair(), " with lo < hi")
        raise InputError(f"runs from {low} to {high}", where=(kind, name), remedy=remedy)
    return low, high


def _sample_attrs(
    kind: str, n: int, seed: int, bounds: Mapping[str, tuple[float, float]]
) -> dict[str, str | int]:
    attrs: dict[str, str | int] = {
        "design_kind": kind,
        "design_n": n,
        "design_seed": seed,
        "design_ranges": ", ".join(f"{name}=({low!r}, {high!r})" for name, (low, high) in bounds.items()),
    }
    if kind == "sobol":
        import scipy  # scipy takes longer to import than all the rest of this module, and others do without

        return attrs | {"design_bits": sobol_bits(n), "design_scipy": scipy.__version__}
    return attrs | {"design_method": f"keyed permutation, {rounds_of(n)} rounds"}
