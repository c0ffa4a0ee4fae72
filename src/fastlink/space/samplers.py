"""Make design spaces: full grids and space-filling samples of inputs."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

from numpy.typing import ArrayLike

from fastlink._text import counted, short_repr
from fastlink.doors import door
from fastlink.errors import InputError, Pair, Problems
from fastlink.options import MOST_SEED, check_whole
from fastlink.space.column import Column
from fastlink.space.design_space import DesignSpace, sampled
from fastlink.space.sequences import rounds_of, slices_axes, sobol_axes, sobol_bits
from fastlink.space.table import table
from fastlink.space.values import Floats, axis_of, check_input_name, constant, numbers_of, units_of

__all__ = ["DesignSpace", "grid", "latin_hypercube", "sobol", "table"]

MOST_DESIGNS = 2**62  # flat design numbers are int64
#: A double tells no more designs of a sample apart, each in its slice of a range.
MOST_SAMPLES = 2**50
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
    constants: dict[str, float] = {}
    swept: dict[str, Floats] = {}
    units: dict[str, str] = {}
    problems = Problems()
    for name, given in _keywords("grid", axes, more).items():
        with problems.at("grid", name):
            check_input_name("grid", name)
            values = numbers_of("grid", name, given)
            units |= units_of(name, given)
            if values.ndim == 0:
                constants[name] = constant("grid", name, values)
            else:
                swept[name] = axis_of("grid", name, values)
    problems.stop()
    shape = tuple(len(values) for values in swept.values())
    if math.prod(shape) > MOST_DESIGNS:
        lengths = ", ".join(f"{name}: {length}" for name, length in zip(swept, shape, strict=True))
        what = f"{math.prod(shape):.3g} designs are too many"
        raise InputError(what, where=("grid",), remedy=f"shorten an axis ({lengths})")
    attrs: dict[str, str | int] = {"design_kind": "grid"}
    return DesignSpace("grid", tuple(swept), shape, constants, axes=swept, attrs=attrs, units=units)


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
    with problems.at():
        n = check_whole((kind, "n"), n, 1, MOST_SAMPLES, f"write an integer from 1 to {MOST_SAMPLES}")
    with problems.at():
        check_whole((kind, "seed"), seed, 0, MOST_SEED, f"write an integer from 0 to {MOST_SEED}")
    constants: dict[str, float] = {}
    bounds: dict[str, tuple[float, float]] = {}
    units: dict[str, str] = {}
    for name, given in ranges.items():
        with problems.at():
            check_input_name(kind, name)
            values = numbers_of(kind, name, given)
            units |= units_of(name, given)
            if values.ndim == 0:
                constants[name] = constant(kind, name, values)
            else:
                bounds[name] = _range(kind, name, values)
    if not (bounds or problems.noted):
        remedy = ("write ", Pair(), " for at least one, or use a grid")
        problems.add("no input has a range", (kind,), remedy)
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
