"""The Pareto front of error against run time."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink._text import aligned, short_repr
from fastlink.doors import door
from fastlink.errors import InputError

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import NDArray

__all__ = ["accuracy_table", "front"]

#: Smaller errors count as this one: they are those of the last digits.
EQUAL = 2.0**-48
#: An error that is not smaller than this share of another is not smaller.
ALIKE = 0.99
#: The coordinates and variables of a result.
NEEDED = (
    "way",
    "quantity",
    "ns_per_design",
    "error_max",
    "error_99",
    "error_median",
    "missed",
    "values",
    "pareto",
)


def front(measured: xr.Dataset) -> NDArray[np.int8]:
    """Return 1 where no other method is faster with an error that is not larger."""
    errors, times = np.maximum(measured["error_max"].values, EQUAL), measured["ns_per_design"].values
    best = np.zeros(errors.shape, dtype=np.int8)
    for quantity in range(errors.shape[1]):
        least = np.inf
        for method in np.lexsort((errors[:, quantity], times[:, quantity])):
            if errors[method, quantity] < ALIKE * least:
                best[method, quantity], least = 1, errors[method, quantity]
    return best


@door
def accuracy_table(measured: xr.Dataset) -> str:
    """Return the result of `fastlink.accuracy` as lines of text, the fastest method first.

    A star marks the methods that no other one beats in both error and time.

    Examples
    --------
    >>> import xarray as xr
    >>> of_one = {"error_max": 4e-16, "error_99": 3e-16, "error_median": 1e-16, "ns_per_design": 335.0}
    >>> counts = {"missed": 0, "values": 64, "pareto": 1}
    >>> measured = xr.Dataset(
    ...     {name: (("way", "quantity"), [[value]]) for name, value in (of_one | counts).items()},
    ...     {"way": ["refined"], "quantity": ["omega4_max"]},
    ... )
    >>> print(accuracy_table(measured))
    omega4_max
       way      ns/design  largest     99 %   median   missed
    *  refined        335  4.0e-16  3.0e-16  1.0e-16  0 of 64
    """
    import xarray as xr

    if not isinstance(measured, xr.Dataset) or not set(NEEDED) <= set(measured.variables):
        what = f"is {short_repr(measured)}, not a result of fastlink.accuracy"
        raise InputError(what, where=("measured",), remedy="give what fastlink.accuracy(STUDY) returns")
    head = ("", "way", "ns/design", "largest", "99 %", "median", "missed")
    blocks = []
    for quantity in measured["quantity"].values:
        one = measured.sel(quantity=quantity)
        one = one.isel(way=np.argsort(one["ns_per_design"].values)).dropna("way", subset=["ns_per_design"])
        rows = [head, *(_row(one.isel(way=k)) for k in range(one.sizes["way"]))]
        blocks.append(f"{quantity}\n{aligned(rows, right=2)}")
    return "\n\n".join(blocks)


def _row(method: Any) -> tuple[str, ...]:
    errors = [float(method[name]) for name in ("error_max", "error_99", "error_median")]
    texts = ["-" if math.isnan(error) else f"{error:.1e}" for error in errors]
    missed = f"{int(method['missed'])} of {int(method['values'])}"
    star, name = "*" if int(method["pareto"]) else "", str(method["way"].values)
    return (star, name, f"{float(method['ns_per_design']):,.0f}", *texts, missed)
