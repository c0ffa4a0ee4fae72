"""Show how far a run is."""

from __future__ import annotations

import sys
from typing import Any

__all__ = ["progress_bar"]


def progress_bar(total: int, unit: str, visible: bool | None) -> Any:
    """Return a bar of tqdm for so many units, None where it is not to be seen.

    Parameters
    ----------
    total : int
        How many there are.
    unit : str
        Their name.
    visible : bool, optional
        By default it is visible on a terminal only.
    """
    if not (sys.stderr.isatty() if visible is None else visible):
        return None
    from tqdm import tqdm  # 15 ms, which nobody waits for who sees no bar

    return tqdm(total=total, unit=unit, unit_scale=True, file=sys.stderr)
