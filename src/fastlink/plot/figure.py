"""Figures that a notebook shows, outside matplotlib's global state."""

from __future__ import annotations

import contextlib
import io
from collections.abc import Iterator
from typing import Any

import matplotlib
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

__all__ = ["NotebookFigure", "style"]

STYLE = {
    "font.size": 10,
    "axes.titlesize": 10.5,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "hatch.color": "0.35",
    "hatch.linewidth": 0.5,
    "savefig.dpi": 160,
    "svg.hashsalt": "fastlink",  # equal pictures are equal files
}
DPI = 100  # in a notebook


class NotebookFigure(Figure):
    """A figure that a notebook shows as a picture, without pyplot; it need not be closed."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**{"layout": "constrained"} | options)
        FigureCanvasAgg(self)

    def _repr_png_(self) -> bytes:
        """Return the picture as a notebook shows it."""
        written = io.BytesIO()
        with style():
            self.savefig(written, format="png", dpi=DPI)
        return written.getvalue()


@contextlib.contextmanager
def style() -> Iterator[None]:
    """Draw with settings of our own, and restore the user's."""
    with matplotlib.rc_context():
        matplotlib.rcParams.update({**matplotlib.rcParamsDefault, **STYLE, "backend": "agg"})
        yield
