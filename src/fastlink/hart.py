"""Hart's linkages held at AB, and in whole numbers by exact arithmetic (Wunderlich, section 7).

With kappa = i/j in lowest terms the eight sizes m, n, p = kappa n, q = -kappa m, a = (1 - kappa^2) m,
b = (1 - kappa^2) n, c = kappa d and d are whole if and only if

    m = j^2 M,   n = j^2 N,   d = j D,   and then   p = i j N,  q = -i j M,  a = (j^2 - i^2) M,  b = (j^2 - i^2) N,
    c = i D

for whole M, N, D: i and j have no common divisor, nor have j^2 and j^2 - i^2. The greatest common divisor of the
eight sizes is that of M, N and D.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import gcd, isqrt
from typing import Any

import numpy as np
import xarray as xr

from fastlink.errors import check_switch, check_whole, door
from fastlink.mechanisms.hart import hart
from fastlink.papers import read_design

__all__ = ["held_at_AB", "integer_designs"]


def __dir__() -> list[str]:
    return __all__


#: The list grows with the cube; at this size it has 4.7 million designs (0.4 GB).
GREATEST_SIZE = 500
LENGTHS = {
    "m": "length of MP",
    "n": "length of NQ",
    "d": "length of the ground link MN",
    "p": "kappa n: length of PF",
    "q": "-kappa m: length of QF, with the sign of eq. (7.2)",
    "a": "(1 - kappa^2) m: MA along MP; negative: on the extension beyond M",
    "b": "(1 - kappa^2) n: NB along NQ; negative: on the extension beyond N",
    "c": "kappa d: length of AB",
}


@door
def integer_designs(max_size: int, *, movable: bool = False) -> xr.Dataset:
    """Return every Hart linkage whose sizes m, n, p, q, a, b, c, d are whole and limited.

    Each is listed once: with no common divisor of its sizes (the others are multiples), with kappa > 0 (the sign
    of kappa changes nothing but that of p, q and c) and with m <= n (exchanging M and N mirrors the linkage).
    Those with kappa > 1 are the ones with 1/kappa with AB held in place of MN: other mechanisms of the same
    bars, and listed. The arithmetic is of whole numbers: only kappa is rounded, where it is not a double.

    Parameters
    ----------
    max_size : int
        Greatest magnitude of the eight sizes, 1 to 500.
    movable : bool, default False
        Leave out those that assemble in isolated positions only, where d = (1 + kappa)(m + n) or
        d = |1 - kappa| |m - n|. Linkages that assemble nowhere are never listed.

    Returns
    -------
    xarray.Dataset
        Along the dimension ``design``, small linkages first: the inputs ``m``, ``n``, ``d`` and ``kappa``, which
        `fastlink.table` takes as they are, and as whole coordinates the other sizes ``p``, ``q``, ``a``, ``b``, ``c``
        with the signs of eqs. (7.2) and (7.4), ``kappa_numerator`` and ``kappa_denominator``.

    Examples
    --------
    >>> designs = fl.hart.integer_designs(8)
    >>> wunderlich = (designs.n == 8) & (designs.m == 4) & (designs.d == 6)
    >>> {name: int(value) for name, value in designs.isel(design=wunderlich).squeeze().coords.items()}
    {'p': 4, 'q': -2, 'a': 3, 'b': 6, 'c': 3, 'kappa_numerator': 1, 'kappa_denominator': 2}
    >>> maps = fl.sweep("hart", fl.table(designs), ["stroke", "is_kite"])
    >>> int((maps.is_kite > 0).sum())
    2
    """
    size = check_whole(("integer_designs", "max_size"), max_size, 1, GREATEST_SIZE)
    movable = check_switch(("integer_designs", "movable"), movable)
    none = (np.zeros((5, 0), dtype=np.int64),)
    columns = np.concatenate((*none, *(_with_kappa(i, j, size, movable) for i, j in _kappas(size))), axis=1)
    i, j, M, N, D = columns
    sizes = {"m": j * j * M, "n": j * j * N, "d": j * D, "p": i * j * N, "q": -i * j * M}
    sizes |= {"a": (j - i) * (j + i) * M, "b": (j - i) * (j + i) * N, "c": i * D}
    order = np.lexsort((sizes["d"], sizes["m"], sizes["n"], i / j, np.max(np.abs([*sizes.values()]), axis=0)))
    coords: dict[str, Any] = {
        name: ("design", sizes[name][order], {"long_name": meaning}) for name, meaning in LENGTHS.items()
    }
    inputs = {name: coords.pop(name) for name in ("m", "n", "d")}
    inputs["kappa"] = ("design", (i / j)[order], {"long_name": "ratio of eq. (7.2)"})
    coords["kappa_numerator"] = ("design", i[order], {"long_name": "numerator of kappa"})
    coords["kappa_denominator"] = ("design", j[order], {"long_name": "denominator of kappa"})
    return xr.Dataset(inputs, coords)


def _kappas(size: int) -> Iterator[tuple[int, int]]:
    """Yield numerator and denominator of each kappa for which there may be a linkage."""
    for j in range(1, isqrt(size) + 1):
        # i^2 - j^2 is the greatest square that enters a size
        for i in range(1, isqrt(size + j * j) + 1):
            if i != j and gcd(i, j) == 1:
                yield i, j


def _with_kappa(i: int, j: int, size: int, movable: bool) -> Any:
    """Return i, j, M, N, D of every linkage with kappa = i/j, in columns."""
    greatest = size // max(j * j, i * j, abs(j * j - i * i))
    m, n = np.triu_indices(greatest)
    m, n = m + 1, n + 1
    # It assembles where |1 - kappa| |m - n| <= d <= (1 + kappa)(m + n), and moves between the two.
    first = np.maximum(abs(j - i) * (n - m) + movable, 1)
    last = np.minimum((i + j) * (m + n) - movable, size // max(i, j))
    counts = np.maximum(last - first + 1, 0)
    m, n = np.repeat(m, counts), np.repeat(n, counts)
    starts = np.cumsum(counts) - counts
    d = np.arange(counts.sum()) - np.repeat(starts - first, counts)
    once = np.gcd(np.gcd(m, n), d) == 1
    return np.stack([np.full(m.size, i), np.full(m.size, j), m, n, d])[:, once]


@door(hint="inputs are given by name, such as m=4.0, or as one mapping")
def held_at_AB(design: Any = None, **inputs: Any) -> dict[str, Any]:
    """Return the Hart linkage that a Hart linkage is with AB held fixed.

    Its M, N, A, B are A, B, M, N of the other one; P, Q and F stay, and F runs along a straight line again.

    Parameters
    ----------
    design, **inputs
        Inputs of ``hart`` in a mapping, pandas.DataFrame or xarray.Dataset, or by name: ``m``, ``n``, ``d`` and
        ``kappa``. Others are not read.

    Returns
    -------
    dict of str to ndarray
        The same inputs of the linkage that stands on AB, as `fastlink.sweep` takes them: kappa^2 m, kappa^2 n,
        |kappa| d and 1/kappa; what is beyond the range of doubles is infinite, as of kappa = 0, where AB is a point.

    Examples
    --------
    >>> held = fl.hart.held_at_AB(m=4.0, n=8.0, d=6.0, kappa=0.5)
    >>> {name: float(value) for name, value in held.items()}
    {'m': 1.0, 'n': 2.0, 'd': 3.0, 'kappa': 2.0}
    >>> line = fl.evaluate("hart", ["line_along_AB"], m=4.0, n=8.0, d=6.0, kappa=0.5, phi=1.0)
    >>> float(line["line_along_AB"]), float(fl.evaluate("hart", ["line_x"], **held, phi=1.0)["line_x"])
    (3.0, 3.0)
    """
    given = read_design("held_at_AB", hart, design, inputs, ("m", "n", "d", "kappa"))
    m, n, d, kappa = given.values()
    size = np.abs(kappa)
    with np.errstate(divide="ignore", over="ignore", under="ignore"):
        return {"m": size * (size * m), "n": size * (size * n), "d": size * d, "kappa": 1.0 / kappa}
