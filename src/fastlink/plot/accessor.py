"""Pictures of a map, from the map itself: ``maps.fastlink.plot``."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from fastlink.doors import door
from fastlink.plot.plot_designs import plot_designs, plot_front
from fastlink.plot.plot_map import plot_map

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

__all__ = ["MapPlots"]


class MapPlots:
    """The pictures of a map.

    Parameters
    ----------
    maps : xarray.Dataset
        The map.

    Examples
    --------
    >>> import fastlink as fl
    >>> space = fl.grid(a1=[0.2, 0.4, 0.6], a2=[1.1, 1.2, 1.3], a3=0.8, a4=1.0, omega1=25.0)
    >>> maps = fl.sweep("planar_4r", space, ["omega4_max", "transmission_angle_min"], branch=1)
    >>> figure = maps.fastlink.plot("omega4_max")
    >>> figure = maps.fastlink.plot.designs(["omega4_max", "transmission_angle_min"])
    >>> figure = maps.fastlink.plot.front(minimise="omega4_max", maximise="transmission_angle_min")
    """

    def __init__(self, maps: xr.Dataset) -> None:
        self._maps = maps

    @door
    def __call__(self, name: str, **options: Any) -> Figure:
        """Draw one variable over one or two inputs; options as in `fastlink.plot_map`."""
        return plot_map(self._maps, name, **options)

    @door
    def designs(self, names: str | Sequence[str], **options: Any) -> Figure:
        """Draw the rows by some quantities; options as in `fastlink.plot_designs`."""
        return plot_designs(self._maps, names, **options)

    @door
    def front(self, **options: Any) -> Figure:
        """Draw the Pareto front; options as in `fastlink.plot_front`."""
        return plot_front(self._maps, **options)
