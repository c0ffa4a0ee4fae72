"""Values that users have given for numbers by mistake, and some that nobody would."""

from __future__ import annotations

import datetime
from decimal import Decimal
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr


class Raising:
    """An object that cannot be converted, compared or shown."""

    def __array__(self, *_: Any, **__: Any) -> Any:
        raise RuntimeError("no array")

    def __repr__(self) -> str:
        raise RuntimeError("no text")


# fmt: off
def scalars() -> list[Any]:
    """Return single values, most of which no input can have."""
    nan, inf = float("nan"), float("inf")
    return [
        0.4, 1, 0, -0.0, -0.4, 1e-300, 1e300, 5e-324, nan, inf, -inf, 2, 3, 7, 1.5,
        True, False, None, "90", "", "0.4", b"0.4", 0.4 + 0j, {0.4}, frozenset(), {}, {"a1": 0.4}, object(),
        Decimal("0.4"), Decimal("NaN"), Decimal("sNaN"), Decimal("Infinity"), Fraction(2, 5), 10**400, -(10**5000),
        np.float32(0.5), np.int8(3), np.bool_(True), np.array(0.4), np.array("0.4"), np.array(None, dtype=object),
        np.datetime64("2020-01-01"), np.timedelta64(3, "s"), datetime.date(2020, 1, 1), Path("a"), int, abs,
        np.ma.masked, np.ma.array(0.4, mask=True), np.ma.array(0.4), pd.NA, pd.Timestamp("2020"), Raising(),
        (x for x in [0.4]), range(10**9), range(10**30), slice(3), Ellipsis, NotImplemented, nan * 1j,
        xr.DataArray(0.4), xr.DataArray("0.4"), xr.Dataset({"a": 0.4}),
    ]


def arrays() -> list[Any]:
    """Return one-dimensional values of distinct numbers, some with a hostile one among them."""
    return [
        [0.4, 0.5], (0.4, 0.5), np.array([0.4, 0.5]), range(1, 3), pd.Series([0.4, 0.5], index=["x", "y"]),
        [0.4, None], [0.4, "0.5"], [0.4, 0.5j], [0.4, -0.5], [0.4, float("nan")], [0.4, float("inf")],
        np.ma.array([0.4, 0.5], mask=[0, 1]), np.ma.array([1, 2], mask=[0, 1]), np.ma.array([0.4, 0.5]),
        [[0.4], [0.4, 0.5]], [0.4, [0.5]], np.array([0.4, None], dtype=object), np.array(["a", "b"]),
        np.array([True, False]), np.array([1, 2], dtype="M8[s]"), [Fraction(1, 2), Decimal("0.4")],
        pd.Series([1, None], dtype="Int64"), pd.Categorical(["a", "b"]), [0.4, Raising()], [1.0, 2.0], [1, 7],
        [0.4, 10**400], [0.4, np.timedelta64(3, "s")],
    ]
# fmt: on
