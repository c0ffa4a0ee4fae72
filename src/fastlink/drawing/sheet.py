"""One picture of a linkage: what stands still, and the linkage itself at a position."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink.drawing.following import add_following
from fastlink.drawing.loads import Loads
from fastlink.drawing.marks import INK, SLIDER, add_ground, add_guide, add_joint, add_slider
from fastlink.drawing.overlays import MODES, add_overlays, mode_line
from fastlink.drawing.places import Names, samples_of
from fastlink.drawing.planes import PLANES
from fastlink.plot.labels import mathematical

if TYPE_CHECKING:
    from fastlink.drawing.motion import Motion
    from fastlink.mechanisms._shared.picture import Bar

__all__ = ["Sheet", "Style"]

#: Of the size of the picture: points of two assembly modes that are nearer to each other are one.
SAME = 1e-9
PLATE = 0.14


@dataclass(frozen=True)
class Style:
    """Sizes in points.

    Attributes
    ----------
    bar, joint, font : float
        The width of a bar, the size of a joint, the size of letters.
    lengths : bool
        Whether bars carry the symbols of their lengths.
    """

    bar: float = 3.6
    joint: float = 7.5
    font: float = 10.0
    lengths: bool = True


class Sheet:
    """The picture of a design in one pair of axes.

    Parameters
    ----------
    axis : matplotlib axes
        Where it is drawn.
    motion : Motion
        The design.
    view : array of 4
        The least and greatest x, the least and greatest y that are shown.
    scale : float
        Points of the page per unit of length.
    show : frozenset of str
        The words of what is shown besides the linkage.
    style : Style
        Sizes.
    """

    def __init__(
        self, axis: Any, motion: Motion, view: Any, scale: float, show: frozenset[str], *, style: Style
    ) -> None:
        self.axis, self.motion, self.view, self.scale = axis, motion, view, scale
        self.show, self.style = show, style
        self.plane = PLANES[motion.picture.metric]
        self.names = Names(scale, view)
        #: Whether one scale of forces is for the whole motion.
        self.moves = False
        self.loads = Loads(self)
        self.free: list[tuple[Any, float]] = []

    # -- what stands still -----------------------------------------------------------------------------------------

    def background(self, position: float) -> list[Any]:
        """Draw what does not move, as for a position; return the legend of it."""
        axis, view = self.axis, self.view
        axis.set(xlim=view[:2], ylim=view[2:], aspect="equal", autoscale_on=False)
        axis.set_axis_off()
        handles = add_overlays(self, position)
        handles += self.loads.scale(position)
        places = self.motion.places([position])
        ground = [one for one in self.motion.points if one.kind == "ground"]
        for bar in self.motion.picture.bars:
            if bar.is_ground:
                at = np.array([places[name][0, 0] for name in bar.points.split()])
                axis.plot(*at.T, color="0.75", linewidth=1.0, linestyle=(0, (8, 3, 1, 3)), zorder=2.2)
                self.keep_free(samples_of(at, self.scale), 0.3)
        for one in ground:
            at = places[one.name][0, 0]
            if np.isfinite(at).all():
                add_ground(axis, at, self.style.joint / 7.5)
                corner = np.stack(np.meshgrid([-12.0, -6.0, 0.0, 6.0, 12.0], [-7.0, -11.0, -15.0]), axis=-1)
                self.keep_free(at + corner * self.style.joint / 7.5 / self.scale, 2.0)
        for guide in self.motion.picture.guides:
            if guide.slider and guide.y is not None:
                (low, high), y, size = (
                    self._run(guide.slider),
                    self.motion.number(guide.y),
                    self.style.joint / 7.5,
                )
                add_guide(axis, low, high, y, size)
                hatched = np.array([[low, y], [high, y]]) - [0.0, 1.3 * SLIDER[1] * size / self.scale]
                self.keep_free(samples_of(hatched, self.scale), 0.7)
        return handles

    def _run(self, slider: str) -> tuple[float, float]:
        """Return how far the ground of a slider reaches."""
        along = np.concatenate(self.motion.along(61))
        x = self.motion.places(along, [self.motion.picture.point(slider)])[slider][..., 0]
        edge = 16.0 / self.scale
        return float(np.nanmin(x)) - edge, float(np.nanmax(x)) + edge

    def keep_free(self, points: Any, weight: float) -> None:
        """Note points that names should not cover."""
        self.free.append((points, weight))

    # -- the linkage -----------------------------------------------------------------------------------------------

    def linkage(self, position: float) -> list[Any]:
        """Draw the linkage at a position in all its assembly modes, and return what was drawn."""
        motion, names = self.motion, self.names
        points = [one for one in motion.points if not one.group or one.group in self.show]
        there = motion.assembles(position)
        places = {
            name: np.where(there, at[:, 0], np.nan) for name, at in motion.places([position], points).items()
        }
        places |= {
            one.name: motion.places([position], [one])[one.name][:, 0]
            for one in points
            if one.kind == "ground"
        }
        size = float(np.ptp(self.view[:2]))
        common = {name: self._is_common(at, size) for name, at in places.items()}
        names.clear()
        for cloud, weight in self.free:
            names.keep_free(cloud, weight)
        drawn = add_following(self, position)
        for bar in motion.picture.bars:
            if not bar.is_ground:
                drawn += self._bar(bar, position, places, common)
        for one in points:
            for at, colour in self._modes(places[one.name], common[one.name]):
                drawn += self._point(one.kind, at, colour)
        if not there.any():
            middle = 0.5 * (self.view[::2] + self.view[1::2])
            drawn.append(self.text("does not assemble", middle, "0.4"))
        drawn += self.loads.draw(position, places)
        drawn += self._letters(points, places, common)
        if self.style.lengths:
            drawn += self._symbols(places, common)
        return drawn

    def _is_common(self, at: Any, size: float) -> bool:
        """Tell whether a point is the same in all assembly modes in which it exists."""
        finite = at[np.isfinite(at).all(axis=-1)]
        return (len(finite) < 2 and len(self.motion.branches) < 2) or (
            len(finite) > 1 and float(np.ptp(finite, axis=0).max()) <= SAME * size
        )

    def _modes(self, at: Any, common: bool) -> list[tuple[Any, Any]]:
        """Return the places of a point with their colours: one if they agree."""
        finite = np.isfinite(at).all(axis=-1)
        if common:
            return [(at[k], INK) for k in np.flatnonzero(finite)[:1]]
        return [(at[k], self.colour(int(k))) for k in np.flatnonzero(finite)]

    def colour(self, k: int) -> str:
        """Return the colour of the assembly mode with an index."""
        return MODES[(self.motion.branches[k] - 1) % len(MODES)]

    def _point(self, kind: str, at: Any, colour: Any) -> list[Any]:
        if kind == "slider":
            slider = add_slider(self.axis, at, colour, self.style.joint / 7.5)
            half = np.multiply(SLIDER, self.style.joint / 7.5) / self.scale
            corners = at + half * np.array([(-1, -1), (1, -1), (1, 1), (-1, 1), (-1, -1)])
            self.names.keep_free(samples_of(corners, self.scale))
            drawn = [slider, add_joint(self.axis, at, colour, 0.8 * self.style.joint)]
        elif kind in ("traced", "mark"):
            size = (0.5 if kind == "traced" else 0.4) * self.style.joint
            drawn = self.axis.plot(*np.reshape(at, (2, 1)), "o", color=colour, markersize=size, zorder=6)
        else:
            drawn = [add_joint(self.axis, at, colour, self.style.joint)]
        return drawn

    def _bar(self, bar: Bar, position: float, places: Any, common: Any) -> list[Any]:
        """Draw a bar, or a plate, in each assembly mode that has it."""
        names = [name for name in bar.points.split() if name in places]
        corners = np.stack([places[name] for name in names], axis=1)
        complete = np.isfinite(corners).all(axis=(1, 2))
        modes = np.flatnonzero(complete)
        is_common = all(common[name] for name in names)
        drawn: list[Any] = []
        for k in modes[:1] if is_common else modes:
            at = corners[k]
            colour = INK if is_common else self.colour(k)
            hollow = not is_common and self.motion.branches[k] > 1
            drawn += self._stroke(self._outline(at, bar, names), self.motion.branches[k], colour, hollow)
            if len(at) > 2:
                plate = {"facecolor": colour, "alpha": PLATE, "linewidth": 0, "zorder": 3.0}
                drawn += self.axis.fill(*at.T, **plate)
            if bar.orientation:
                side = self.motion.values([bar.orientation], [position])[bar.orientation][k, 0]
                drawn += self._direction(at[0], at[1], "white" if side < 0.0 else colour, colour)
            self.names.keep_free(samples_of(np.concatenate([at, at[:1]]), self.scale))
        return drawn

    def _direction(self, start: Any, end: Any, face: Any, colour: Any) -> list[Any]:
        """Draw the head of an arrow on a bar."""
        head = {"arrowstyle": "-|>,head_length=0.55,head_width=0.3", "edgecolor": colour, "facecolor": face}
        along = end - start
        arrow = {**head, "shrinkA": 0, "shrinkB": 0, "linewidth": 1.2}
        return [self.axis.annotate("", start + 0.6 * along, start + 0.5 * along, arrowprops=arrow, zorder=5)]

    def _outline(self, at: Any, bar: Bar, names: list[str]) -> list[tuple[Any, float, str]]:
        """Return the lines of a bar, each with width and name: thick along lengths, thin round the rest of a plate."""
        thick = [tuple(pair.split()) for pair in bar.lengths]
        edges = list(zip(names, [*names[1:], names[0]], strict=True)) if len(names) > 2 else []
        thin = [pair for pair in edges if pair not in thick and pair[::-1] not in thick]
        width = self.style.bar
        return [
            (at[[names.index(a), names.index(b)]], width * (1.0 if kind == "bar" else 0.3), f"{kind} {a} {b}")
            for kind, pairs in (("bar", thick), ("edge", thin))
            for a, b in pairs
        ]

    def _stroke(
        self, lines: list[tuple[Any, float, str]], branch: int, colour: Any, hollow: bool
    ) -> list[Any]:
        """Draw lines, with a white core in the second assembly mode."""
        drawn: list[Any] = []
        ends = {"solid_capstyle": "round", "zorder": 4.0}
        for line, width, name in lines:
            drawn += self.axis.plot(*line.T, color=colour, linewidth=width, gid=f"{name} {branch}", **ends)
        for line, width, name in lines if hollow else ():
            if name.startswith("bar"):
                drawn += self.axis.plot(*line.T, color="white", linewidth=0.45 * width, **ends)
        return drawn

    def _letters(self, points: Any, places: Any, common: Any) -> list[Any]:
        """Write the names of points; those that stand in one place share it."""
        groups: list[tuple[Any, Any, list[str]]] = []
        near = 0.6 * self.style.joint / self.scale
        for one in filter(lambda one: one.is_named, points):
            for at, colour in self._modes(places[one.name], common[one.name]):
                self.names.keep_free(at + np.array([[0.0, 0.0], [3.0, 0.0], [-3.0, 0.0]]) / self.scale, 1.5)
                letters = next((names for place, _, names in groups if np.hypot(*(place - at)) < near), None)
                if letters is None:
                    groups.append((at, colour, [one.name]))
                elif one.name not in letters:
                    letters.append(one.name)
        drawn = []
        for number, (at, colour, letters) in enumerate(groups):
            if not self._is_in_view(at):
                continue
            text = ", ".join(letters)
            middle = self.names.place(f"{text} {number}", text, at)
            shown = ", ".join(mathematical(one) for one in letters)
            drawn.append(self.text(shown, middle, colour))
        return drawn

    def _is_in_view(self, at: Any) -> bool:
        view = self.view
        return bool(view[0] <= at[0] <= view[1] and view[2] <= at[1] <= view[3])

    def _symbols(self, places: Any, common: Any) -> list[Any]:
        """Write the symbols of lengths along bars, those of the first assembly mode."""
        drawn = []
        for bar in self.motion.picture.bars:
            for pair, length in bar.lengths.items():
                a, b = (places[name] for name in pair.split())
                there = np.flatnonzero(np.isfinite(a + b).all(axis=-1))
                if not there.size or not self._is_in_view(0.5 * (a[there[0]] + b[there[0]])):
                    continue
                k = there[0]
                is_common = all(common[name] for name in pair.split())
                colour = "0.5" if bar.is_ground else INK if is_common else self.colour(k)
                symbol = self.symbol(length)
                middle = self.names.beside(pair, symbol.replace("_", ""), a[k], b[k])
                drawn.append(self.text(mathematical(symbol), middle, colour))
        return drawn

    def symbol(self, name: str) -> str:
        """Return the symbol of a fact or an input."""
        known = self.motion.catalogue
        inputs = known.known_inputs(known.variant_inputs)
        return inputs[name].symbol if name in inputs else known.facts[name].symbol

    def text(self, text: str, at: Any, colour: Any) -> Any:
        """Write the name of something."""
        style = {"ha": "center", "va": "center", "fontsize": self.style.font, "zorder": 8, "gid": "name"}
        return self.axis.text(*at, text, color=colour, **style)

    def line_of(self, k: int, **changes: Any) -> dict[str, Any]:
        """Return how curves of an assembly mode are drawn."""
        return mode_line(self.motion.branches[k], **changes)
