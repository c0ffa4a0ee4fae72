"""Show how far a run is."""

from __future__ import annotations

import sys
import warnings
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
        By default it is visible on a terminal and in a notebook only; there it is a bar of the page, if ipywidgets are
        installed.
    """
    notebook = _in_notebook()
    if not (sys.stderr.isatty() or notebook if visible is None else visible):
        return None
    if notebook:
        with warnings.catch_warnings():  # without ipywidgets it is the bar of a terminal, in fewer words
            warnings.simplefilter("ignore")
            from tqdm.auto import tqdm
    else:
        from tqdm import tqdm  # 15 ms, which nobody waits for who sees no bar

    return tqdm(total=total, unit=unit, unit_scale=True, file=None if notebook else sys.stderr)


def _in_notebook() -> bool:
    """Tell whether a notebook runs this; IPython is not imported for it."""
    shell = sys.modules.get("IPython")
    running = shell.get_ipython() if shell is not None and hasattr(shell, "get_ipython") else None
    return type(running).__name__ == "ZMQInteractiveShell"
