"""Draw a variable over one or two dimensions, without matplotlib's global state."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fastlink.plot.cells import draw_maps
from fastlink.plot.figure import NotebookFigure
from fastlink.plot.labels import constants_of, title_of
from fastlink.plot.lines import draw_lines
from fastlink.plot.panels import modes_of
from fastlink.plot.selection import Selection

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["draw"]


def draw(dataset: xr.Dataset, shown: Selection) -> NotebookFigure:
    """Return the figure of a variable, with a panel or line for each assembly mode."""
    figure = NotebookFigure()
    if len(shown.free) == 1:
        figure.set_size_inches(7.2, 4.2)
        draw_lines(figure, shown)
    else:
        draw_maps(figure, shown)
    titles = [title_of(dataset, shown.variable, shown.fixed), modes_of(shown)]
    figure.suptitle("\n".join(filter(None, titles)), fontsize=12)
    figure.supxlabel(constants_of(dataset), fontsize=7.5, color="0.45")
    return figure
