"""Show forces as arrows and torques as curved ones, all of a kind by one scale."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.lines import Line2D

from fastlink._text import short_number
from fastlink.drawing.marks import INK, add_turn
from fastlink.drawing.places import samples_of
from fastlink.plot.colours import LINES
from fastlink.plot.labels import mathematical

if TYPE_CHECKING:
    from fastlink.drawing.motion import Motion
    from fastlink.drawing.sheet import Sheet

__all__ = ["FORCES", "LONGEST", "TORQUES", "Loads", "ends_of_forces"]

FORCES, TORQUES = "forces", "torques"
#: The units of a kind; its mark in the legend.
UNITS, MARKS = {FORCES: "N", TORQUES: "N m"}, {FORCES: ">", TORQUES: r"$\circlearrowleft$"}
#: Of the picture: the length of the greatest force.
LONGEST = 0.22
#: Of a torque in points: the radius in the first assembly mode, and by how much each further one's is greater.
RADIUS, FURTHER = 17.0, 6.0
#: The distance of a name from the end of an arrow, in points.
CLOSE = 9.0


def _values(motion: Motion, kind: str, positions: Any) -> dict[str, Any]:
    """Return each load of a kind over assembly modes, positions, and its components."""
    components = {one.name: one.components for one in motion.picture.loads[kind]}
    values = motion.values([name for names in components.values() for name in names], positions)
    return {one: np.stack([values[name] for name in names], axis=-1) for one, names in components.items()}


def _shown(motion: Motion, positions: Any, moves: bool) -> Any:
    """Return the positions of which the loads have one scale."""
    return motion.spread(61, ends=False) if moves else positions


def _greatest(values: dict[str, Any]) -> float:
    sizes = np.stack([np.linalg.norm(one, axis=-1) for one in values.values()])
    return float(sizes[np.isfinite(sizes)].max(initial=0.0)) or 1.0


def ends_of_forces(motion: Motion, positions: Any, longest: float, *, moves: bool) -> Any:
    """Return where the arrows of all forces end, the longest of them of a given length."""
    shown = _shown(motion, positions, moves)
    values, places = _values(motion, FORCES, shown), motion.places(shown)
    unit = longest / _greatest(values)
    ends = [places[one.at] + unit * values[one.name] for one in motion.picture.forces]
    found = np.concatenate([one.reshape(-1, 2) for one in ends])
    return found[np.isfinite(found).all(axis=1)]


class Loads:
    """The forces and torques of one picture.

    Parameters
    ----------
    sheet : Sheet
        The picture.
    """

    def __init__(self, sheet: Sheet) -> None:
        self.sheet = sheet
        self.kinds = [kind for kind in (FORCES, TORQUES) if kind in sheet.show]
        #: The greatest one that is shown of each kind.
        self.greatest: dict[str, float] = {}

    def scale(self, position: float) -> list[Any]:
        """Find the greatest of each kind, of the whole motion where one moves, and return the legend."""
        motion, handles = self.sheet.motion, []
        for kind in self.kinds:
            greatest = _greatest(_values(motion, kind, _shown(motion, [position], self.sheet.moves)))
            self.greatest[kind] = greatest
            size = {FORCES: (5.0, 1.4), TORQUES: (10.0, 0.0)}[kind]
            style: dict[str, Any] = {"markersize": size[0], "linewidth": size[1], "markeredgewidth": 0.6}
            label = f"{kind}, the greatest {short_number(float(f'{greatest:.3g}'))} {UNITS[kind]}"
            handles.append(
                Line2D([], [], color=self._colour(0, INK), marker=MARKS[kind], label=label, **style)
            )
        return handles

    def draw(self, position: float, places: Any) -> list[Any]:
        """Draw what is shown at a position, and return what was drawn."""
        add = {FORCES: self._force, TORQUES: self._torque}
        drawn: list[Any] = []
        named = []
        for kind in self.kinds:
            values = {
                name: found[:, 0] for name, found in _values(self.sheet.motion, kind, [position]).items()
            }
            for one in self.sheet.motion.picture.loads[kind]:
                for k, value in enumerate(values[one.name] / self.greatest[kind]):
                    at = places[one.at][k]
                    if np.isfinite([*value, *at]).all():
                        arrow, beside = add[kind](k, value, at)
                        drawn += arrow
                        named.append((one.name, k, beside))
        return drawn + [self._name(*one) for one in named]

    def _colour(self, k: int, shared: str = "") -> str:
        """Return the colour in an assembly mode; in the legend, that of all."""
        if len(self.sheet.motion.branches) == 1:
            return LINES[3]
        return shared or self.sheet.colour(k)

    def _force(self, k: int, vector: Any, start: Any) -> tuple[list[Any], Any]:
        """Draw an arrow; return it, and the place beside which its name stands."""
        sheet = self.sheet
        end = start + LONGEST * min(np.ptp(sheet.view[:2]), np.ptp(sheet.view[2:])) * vector
        arrow = {"arrowstyle": "-|>", "color": self._colour(k), "linewidth": 1.4, "shrinkA": 0, "shrinkB": 0}
        sheet.names.keep_free(samples_of([start, end], sheet.scale))
        return [sheet.axis.annotate("", end, start, arrowprops=arrow, zorder=6.5)], end

    def _torque(self, k: int, value: Any, at: Any) -> tuple[list[Any], Any]:
        """Draw a curved arrow; return it, and the place beside which its name stands."""
        sheet = self.sheet
        radius = (RADIUS + FURTHER * k) * sheet.style.joint / 7.5
        drawn, arc = add_turn(sheet.axis, at, float(value[0]), radius, self._colour(k))
        sheet.names.keep_free(at + arc / sheet.scale)
        return drawn, at + arc[len(arc) // 2] / sheet.scale

    def _name(self, name: str, k: int, at: Any) -> Any:
        symbol = self.sheet.motion.catalogue.public_fact(name).symbol.strip("|")
        middle = self.sheet.names.place(f"{name} {k}", symbol.replace("_", ""), at, CLOSE)
        return self.sheet.text(mathematical(symbol), middle, self._colour(k))
