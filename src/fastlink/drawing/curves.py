"""Curves of quantities over the input, beside a linkage, with the input marked."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink.drawing.overlays import MODES, mode_line
from fastlink.maps.units import half_turn
from fastlink.plot.colours import drawable, limits_of
from fastlink.plot.labels import mathematical, units_text
from fastlink.plot.lines import cut
from fastlink.space.degrees import RADIANS

if TYPE_CHECKING:
    from fastlink.drawing.motion import Motion

__all__ = ["Curves"]

POINTS = 361
MOST_RANGE = 50.0


class Curves:
    """The curves of some quantities, one below the other.

    Parameters
    ----------
    axes : sequence of matplotlib axes
        One for each.
    motion : Motion
        The design.
    names : sequence of str
        The quantities.
    degrees : bool
        Whether angles are in degrees.
    """

    def __init__(self, axes: Sequence[Any], motion: Motion, names: Sequence[str], degrees: bool) -> None:
        self.axes, self.motion, self.names, self.degrees = axes, motion, names, degrees
        known = motion.catalogue
        self.units = {name: known.public_fact(name).units for name in names}
        for axis, name in zip(axes, names, strict=True):
            self._draw(axis, name)
            fact = known.public_fact(name)
            units = "" if fact.flags else units_text(self._units(fact.units))
            axis.set_ylabel(f"{mathematical(fact.symbol)}{units and f' [{units}]'}", fontsize=9)
            axis.tick_params(labelsize=8, labelbottom=axis is axes[-1])
            axis.grid(color="0.92", linewidth=0.8)
            axis.set_axisbelow(True)
        position = known.position
        units = units_text(self._units(position.units))
        axes[-1].set_xlabel(f"{mathematical(position.symbol)}{units and f' [{units}]'}", fontsize=9)

    def _units(self, units: str) -> str:
        return "°" if self.degrees and units == RADIANS else "" if units == "1" else units

    def _scaled(self, values: Any, units: str) -> Any:
        return np.degrees(values) if self.degrees and units == RADIANS else values

    def _at(self, positions: Any) -> Any:
        return self._scaled(np.asarray(positions, dtype=float), self.motion.catalogue.position.units)

    def _draw(self, axis: Any, name: str) -> None:
        motion, every = self.motion, []
        units = self.units[name]
        for positions in motion.along(POINTS):
            values = self._scaled(motion.values([name], positions)[name], units)
            for k, branch in enumerate(motion.branches):
                x, y = cut(
                    self._at(positions), drawable(values[k]), self._units(units).replace("°", "degree")
                )
                axis.plot(x, y, **mode_line(branch))
                every.append(values[k])
        low, high, extend = limits_of(drawable(np.concatenate(every)), np.concatenate(every), MOST_RANGE)
        if extend != "neither":
            axis.set_ylim(low - 0.05 * (high - low), high + 0.05 * (high - low))
        ends = self._at([motion.ranges[0][0], motion.ranges[-1][1]])
        axis.set_xlim(*ends)
        half = half_turn(motion.catalogue.position.units)
        if half is not None and self.degrees:
            step = next(step for step in (5, 10, 15, 30, 45, 60, 90) if (ends[1] - ends[0]) / step <= 8.5)
            axis.set_xticks(np.arange(np.ceil(ends[0] / step), np.floor(ends[1] / step) + 1) * step)

    def mark(self, positions: Sequence[float]) -> list[Any]:
        """Mark the input and the values there, and return what was drawn."""
        drawn: list[Any] = []
        shown = [self._within(position) for position in positions]
        for axis, name in zip(self.axes, self.names, strict=True):
            for position, x in zip(positions, self._at(shown), strict=True):
                drawn.append(axis.axvline(x, color="0.35", linewidth=0.9, zorder=1.5))
                values = self._scaled(self.motion.values([name], [position])[name][:, 0], self.units[name])
                for branch, value in zip(self.motion.branches, values, strict=True):
                    if np.isfinite(value):
                        colour = MODES[(branch - 1) % len(MODES)]
                        style = {"color": colour, "markersize": 5, "markeredgecolor": "white", "zorder": 5}
                        drawn += axis.plot([x], [value], "o", **style)
        return drawn

    def _within(self, position: float) -> float:
        """Return a position moved by whole turns into what the axis shows."""
        low = self.motion.ranges[0][0]
        return low + (position - low) % (2.0 * np.pi) if self.motion.turns else position
