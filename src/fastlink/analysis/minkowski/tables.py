"""Tables 1 to 3 of the paper, filled from a map of linkages."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink._text import in_words
from fastlink.doors import door
from fastlink.errors import InputError
from fastlink.io.reader import as_dataset
from fastlink.mechanisms.minkowski_4r.types import LINKAGE_FLAGS

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["linkage_table"]

SUMS = ("T1", "T2", "T3", "T4", "T5")
#: Where the paper has each kind, and how its condition is written.
KINDS = {
    "strange": ("Table 1", ">"),
    "rigid": ("Table 2", "="),
    "reducible": ("Theorems 3.20, 3.21", ""),
    "irreducible": ("Table 3", ""),
}
#: The link that the sign of a sum tells of, with that sign; b is left.
LONG_LINKS = {"T3": (1, "g > a + b + h"), "T4": (-1, "a > b + g + h"), "T5": (-1, "h > a + b + g")}
REMAINING = "b > a + g + h"


@door
def linkage_table(maps: Any) -> pd.DataFrame:
    """Return the linkages of a map by type and signs of T1 to T5, as Tables 1 to 3.

    Hegedues and Moore, section 3.6: the space of linkages. Each combination that occurs has a row, in the order of the
    tables: strange linkages (one link longer than the others together), rigid ones (as long), reducible ones (T1 = 0 or
    T2 = 0), and what is left, irreducible ones. Invalid designs are not counted.

    Parameters
    ----------
    maps : xarray.Dataset or path
        A sweep of ``"minkowski_4r"`` with ``linkage_type`` and ``T1`` to ``T5``, or its file.

    Returns
    -------
    pandas.DataFrame
        Columns: ``paper`` (the table or theorem), ``kind``, ``input``, ``output`` (how the cranks move), ``T1`` to
        ``T5`` (+, 0 or -, as they are, whatever the ``tolerance``), ``condition`` (on the lengths) and ``linkages``.

    Raises
    ------
    InputError
        Not a map or a path, or a name is missing.

    Examples
    --------
    >>> import fastlink as fl
    >>> names = ["linkage_type", "T1", "T2", "T3", "T4", "T5"]
    >>> part = fl.sweep("minkowski_4r", fl.grid(a=1.0, b=[1.0, 7.0], g=[4.0, 3.0], h=1.0), names)
    >>> print(fl.minkowski.linkage_table(part).drop(columns="paper").to_string(index=False))
       kind       input output T1 T2 T3 T4 T5     condition  linkages
    strange       crank  crank  +  +  -  +  + b > a + g + h         2
    strange superrocker  crank  +  -  +  +  + g > a + b + h         1
      rigid      rocker  crank  +  -  0  +  + g = a + b + h         1
    """
    import pandas as pd

    with as_dataset(maps) as dataset:
        for name in ("linkage_type", *SUMS):
            if name not in dataset.data_vars:
                remedy = "sweep 'linkage_type' and 'T1' to 'T5', and give the whole result"
                raise InputError(f"{name!r} is missing", where=("linkage_table", "maps"), remedy=remedy)
        types = dataset["linkage_type"]
        signs = [np.sign(dataset[name].broadcast_like(types).transpose(*types.dims).values) for name in SUMS]
        codes = types.values
    valid = (codes >= 0) & (codes < max(LINKAGE_FLAGS))
    key = codes[valid].astype(int)  # one number for a type and five signs, in base 3
    for sign in signs:
        key = 3 * key + 1 + sign[valid].astype(int)
    rows = [
        _row(int(one), int(count)) for one, count in zip(*np.unique(key, return_counts=True), strict=True)
    ]
    return pd.DataFrame(rows, columns=["paper", "kind", "input", "output", *SUMS, "condition", "linkages"])


def _row(key: int, count: int) -> list[Any]:
    """Return a row of the table from a type and the signs of the sums as one number."""
    code, rest = divmod(key, 3 ** len(SUMS))
    kind, *motions = in_words(LINKAGE_FLAGS[code]).split()
    signs = {name: rest // 3**k % 3 - 1 for name, k in zip(SUMS, (4, 3, 2, 1, 0), strict=True)}
    paper, relation = KINDS[kind]
    if relation:
        links = (
            text
            for name, (sign, text) in LONG_LINKS.items()
            if signs[name] == (sign if relation == ">" else 0)
        )
        condition = next(links, REMAINING).replace(">", relation)
    else:
        equal = {"T1": "b + g = a + h", "T2": "a + b = g + h"}
        condition = ", ".join(text for name, text in equal.items() if signs[name] == 0)
    return [paper, kind, *motions, *("-0+"[sign + 1] for sign in signs.values()), condition, count]
