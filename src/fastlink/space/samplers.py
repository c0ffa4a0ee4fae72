"""Make design spaces: full grids and space-filling samples of inputs."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from fastlink._text import counted, short_repr
from fastlink.doors import door
from fastlink.errors import InputError, Pair, Problems
from fastlink.memory import check_memory
from fastlink.options import MOST_SEED, check_whole
from fastlink.space.design_space import DesignSpace, sampled
from fastlink.space.table import table
from fastlink.space.values import Floats, axis_of, check_input_name, constant, numbers_of, units_of

__all__ = ["DesignSpace", "grid", "latin_hypercube", "sobol", "table"]

MOST_DESIGNS = 2**62  # flat design numbers are int64
MOST_SAMPLES = 2**30  # scipy's Sobol points have 30 bits
SOBOL_CHUNK = 2**16
#: How often a sample is held in memory at most while it is made, by scipy and here (measured 1.2 and 4.0).
COPIES = {"sobol": 2, "latin_hypercube": 5}
FEWER = "ask for fewer designs"
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

    Parameters
    ----------
    n : int
        Number of designs, at most 2^30. Only powers of two keep the full balance of the sequence; any other
        number is its first `n` points.
    ranges : mapping, optional
        The inputs as a mapping, beside or instead of keywords: for Hart's input ``n``, ``{"n": (1.0, 2.0)}``.
    seed : int, default 0
        Seed of the scrambling; the same seed gives the same designs.
    **more : float or (lo, hi)
        A number is a constant; a pair is sampled uniformly between its ends.

    Returns
    -------
    DesignSpace
        Of kind ``"sobol"``; seed, number, ranges and scipy's version are in its `attrs`.

    Examples
    --------
    >>> space = sobol(8, seed=1, a1=(0.2, 0.4), a2=(1.0, 1.4), a4=1.0)
    >>> space.shape, space.constants
    ((8,), {'a4': 1.0})
    >>> bool(space.columns["a1"].min() >= 0.2)
    True
    """
    return _sample("sobol", n, seed, _keywords("sobol", ranges, more), _sobol_chunks)


@door(hint=OF_THAT_NAME)
def latin_hypercube(
    n: int, ranges: Mapping[str, ArrayLike] | None = None, *, seed: int = 0, **more: ArrayLike
) -> DesignSpace:
    """Sample the inputs by a Latin hypercube, along the dimension ``design``.

    Each of `n` equal slices of every range holds exactly one design.

    Parameters
    ----------
    n : int
        Number of designs, at most 2^30.
    ranges : mapping, optional
        The inputs as a mapping, beside or instead of keywords: for Hart's input ``n``, ``{"n": (1.0, 2.0)}``.
    seed : int, default 0
        The same seed gives the same designs.
    **more : float or (lo, hi)
        A number is a constant; a pair is sampled between its ends.

    Returns
    -------
    DesignSpace
        Of kind ``"latin_hypercube"``; seed, number, ranges and scipy's version are in its `attrs`.

    Examples
    --------
    >>> space = latin_hypercube(4, a1=(0.0, 4.0), a4=1.0)
    >>> sorted(int(value) for value in space.columns["a1"])
    [0, 1, 2, 3]
    """
    return _sample(
        "latin_hypercube", n, seed, _keywords("latin_hypercube", ranges, more), _latin_hypercube_chunks
    )


def _sample(
    kind: str,
    n: int,
    seed: int,
    ranges: Mapping[str, ArrayLike],
    chunks: Callable[[int, int, int], Iterable[Floats]],
) -> DesignSpace:
    """Scale the points that ``chunks(n, dimensions, seed)`` yields to the ranges."""
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
    n = int(n)
    copies = COPIES[kind]
    check_memory(8 * n * len(bounds) * copies, "a sample of that size", where=(kind, "n"), remedy=FEWER)
    columns = {name: np.empty(n) for name in bounds}
    start = 0
    for points in chunks(n, len(bounds), seed):
        stop = start + len(points)
        for (name, (low, high)), unit in zip(bounds.items(), points.T, strict=True):
            # a Latin hypercube may reach 1.0, where the sum can round to beyond the end
            columns[name][start:stop] = np.minimum(low + unit * (high - low), high)
        start = stop
    return sampled(kind, constants, columns, _sample_attrs(kind, n, seed, bounds), units=units)


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
    import scipy  # scipy takes longer to import than all the rest of this module, and grids do without

    return {
        "design_kind": kind,
        "design_n": int(n),
        "design_seed": int(seed),
        "design_ranges": ", ".join(f"{name}=({low!r}, {high!r})" for name, (low, high) in bounds.items()),
        "design_scipy": scipy.__version__,
    }


def _engine(name: str, dimensions: int, seed: int) -> Any:
    import scipy
    from scipy.stats import qmc

    version = tuple(int(part) for part in scipy.__version__.split(".")[:2])
    keyword = "rng" if version >= (1, 15) else "seed"
    return getattr(qmc, name)(dimensions, **{keyword: np.random.default_rng(seed)})


def _sobol_chunks(n: int, dimensions: int, seed: int) -> Iterator[Floats]:
    """Yield the first n points piece by piece, so that scipy does not hold them all."""
    engine = _engine("Sobol", dimensions, seed)
    # scipy warns of any first piece that is not a power of two; the points do not depend on how they are cut
    chunk = min(SOBOL_CHUNK, 1 << (n - 1).bit_length())
    for start in range(0, n, chunk):
        yield engine.random(chunk)[: n - start]


def _latin_hypercube_chunks(n: int, dimensions: int, seed: int) -> Iterator[Floats]:
    yield _engine("LatinHypercube", dimensions, seed).random(n)
