"""The whole picture of a linkage: sheets, curves beside them, the legend, the numbers of the design."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.lines import Line2D

from fastlink._text import short_number
from fastlink.maps.units import half_turn
from fastlink.pictures.draw import Request
from fastlink.pictures.labels import mathematical, units_text
from fastlink.pictures.map_axes import cut
from fastlink.pictures.scene import FORCES, LONGEST, MODES, Sheet, Style, add_scale, ends_of_forces, mode_line
from fastlink.pictures.style import NotebookFigure, drawable, limits_of
from fastlink.space.design_space import RADIANS

if TYPE_CHECKING:
    from fastlink.pictures.motion import Motion

__all__ = ["Board", "Curves"]


# -- Curves of quantities over the input, beside a linkage, with the input marked


CURVE_POINTS = 361
MOST_RANGE = 50.0


class Curves:
    """The curves of some quantities, one below the other."""

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
        for positions in motion.along(CURVE_POINTS):
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


# -- The whole picture: one or several sheets, curves beside them, the legend and the numbers of the design


#: In inches: the width of one sheet by how many stand in a row, the margin, a line of text, the curves beside.
WIDTHS = {1: 5.6, 2: 4.2, 3: 3.2, 4: 2.7}
MOST_IN_A_ROW = 4
MARGIN, LINE, TITLE, BESIDE, CURVE = 0.25, 0.19, 0.3, 3.6, 1.25
#: The height of a sheet over its width.
FLATTEST, TALLEST = 0.42, 1.1
#: Of the size of what is drawn: the margin in a view, and in one of a plane without bounds.
AROUND, WIDE_AROUND = 0.09, 0.3
#: The same where the teeth of a comb stand on the path.
COMB_AROUND = 0.22
#: How much the margin and the arrows themselves add to a view in which forces are shown.
GROWN = 1.4
LETTER = 0.072  # of the legend, in inches
CAPTION_LETTERS, TITLE_LETTERS = 15, 12  # in an inch
POINTS = 72.0


class Board:
    """The figure of a request, and its moving parts."""

    def __init__(self, request: Request) -> None:
        self.request = request
        self.motion = request.motions[0]
        self.view = _view(request)
        rows = -(-len(request.sheets) // MOST_IN_A_ROW)
        columns = -(-len(request.sheets) // rows)
        self.width = WIDTHS[columns]
        self.height = self.width * float(np.ptp(self.view[2:]) / np.ptp(self.view[:2]))
        self.scale = POINTS * self.width / float(np.ptp(self.view[:2]))
        self.figure = NotebookFigure(layout=None)
        #: The axes with their places in inches, from the upper left corner.
        self.placed: list[tuple[Any, tuple[float, float, float, float]]] = []
        self.sheets: list[Sheet] = []
        handles = self._add_sheets(columns)
        page, low = self._block(columns)
        self.curves = self._add_curves(page, low)
        page += BESIDE if request.curves else 0.0
        self._finish(page, low, [*self._legend_of_modes(), *handles])
        self.moving: list[Any] = []

    def _title_height(self) -> float:
        return LINE * 1.2 if any(title for *_, title in self.request.sheets) else 0.0

    def _add_sheets(self, columns: int) -> list[Any]:
        """Add the axes of each linkage with what stands still, and return its legend."""
        handles: list[Any] = []
        style, each = self._style(columns), self.height + self._title_height() + MARGIN
        for number, (motion, position, title) in enumerate(self.request.sheets):
            row, column = divmod(number, columns)
            left = MARGIN + column * (self.width + MARGIN)
            top = MARGIN + TITLE + row * each + self._title_height()
            axis = self._axes((left, top, self.width, self.height))
            sheet = Sheet(axis, motion, self.view, self.scale, self.request.show, style=style)
            sheet.moves = self.request.moves or len(self.request.positions) > 1
            found = sheet.background(position)
            handles = handles or found
            if title:
                axis.set_title(title, fontsize=style.font, pad=3.0)
            self.sheets.append(sheet)
        add_scale(self.sheets[0].axis, self.view, float(np.ptp(self.view[:2])))
        return handles

    def _block(self, columns: int) -> tuple[float, float]:
        """Return how wide the linkages are with their margins, and how far down they or the curves reach."""
        rows = -(-len(self.sheets) // columns)
        low = MARGIN + TITLE + rows * (self.height + self._title_height() + MARGIN) - MARGIN
        least = MARGIN + TITLE + CURVE * len(self.request.curves) + 0.5
        return MARGIN + columns * (self.width + MARGIN), max(low, least) if self.request.curves else low

    def _add_curves(self, left: float, low: float) -> Curves | None:
        """Add the axes of curves on the right."""
        names, top = self.request.curves, MARGIN + TITLE + 0.1
        if not names:
            return None
        gap = 0.12
        each = (low - 0.4 - top + gap) / len(names)
        axes = [
            self._axes((left + 0.6, top + k * each, BESIDE - 0.6 - MARGIN, each - gap))
            for k in range(len(names))
        ]
        return Curves(axes, self.motion, names, self.request.degrees)

    def _style(self, columns: int) -> Style:
        if columns == 1:
            return Style(lengths=not self.request.moves)
        bars = {2: 3.2, 3: 2.8, 4: 2.4}[columns]
        return Style(bars, 5.6 if columns > 2 else 6.5, 8.5 if columns > 2 else 9.5, lengths=False)

    def _axes(self, box: tuple[float, float, float, float]) -> Any:
        """Return new axes with their place in inches, from the upper left corner: left, top, width, height."""
        axis = self.figure.add_axes((0.0, 0.0, 1.0, 1.0), label=str(len(self.placed)))
        self.placed.append((axis, box))
        return axis

    def _finish(self, width: float, low: float, handles: list[Any]) -> None:
        """Write title, legend and numbers, and give the page the size that all of it takes."""
        caption = self._caption(width)
        longest = max(len(handle.get_label()) for handle in handles)
        columns = 2 if len(handles) > 3 and 2 * (longest * LETTER + 0.6) < width else 1
        room = int((width / columns - 0.9) / LETTER)
        for handle in handles:
            handle.set_label(textwrap.fill(handle.get_label(), room))
        rows = -(-sum(handle.get_label().count("\n") + 1 for handle in handles) // columns)
        height = low + LINE * (0.93 * rows + len(caption)) + 2.0 * MARGIN
        figure = self.figure
        figure.set_size_inches(width, height)
        for axis, (left, top, wide, high) in self.placed:
            axis.set_position((left / width, 1.0 - (top + high) / height, wide / width, high / height))
        centre: dict[str, Any] = {"ha": "center", "va": "center"}
        title = textwrap.fill(self.motion.catalogue.title, int(width * TITLE_LETTERS))
        figure.text(0.5, 1.0 - 1.2 * MARGIN / height, title, fontsize=10.5, **centre)
        style = {"frameon": False, "fontsize": 8.5, "borderaxespad": 0.0, "handlelength": 2.4}
        place = (0.5, 1.0 - (low + 0.7 * MARGIN) / height)
        figure.legend(handles=handles, loc="upper center", bbox_to_anchor=place, ncols=columns, **style)
        for number, line in enumerate(reversed(caption)):
            at = (0.6 * MARGIN + LINE * (number + 0.5)) / height
            figure.text(0.5, at, line, fontsize=8, color="0.35", **centre)

    def _legend_of_modes(self) -> list[Any]:
        """Return a line for each assembly mode."""
        branches = self.motion.catalogue.branches
        return [
            Line2D([], [], **mode_line(b), label=f"assembly mode {b}: {branches[b]}{self._orientations(k)}")
            for k, b in enumerate(self.motion.branches)
        ]

    def _orientations(self, k: int) -> str:
        """Return which bars of an assembly mode point to the future and to the past, of a single picture."""
        if len(self.request.sheets) > 1 or self.request.moves:
            return ""
        motion, text = self.motion, ""
        for bar in motion.picture.bars:
            if bar.orientation:
                code = motion.values([bar.orientation], self.request.positions)[bar.orientation][k, 0]
                words = motion.catalogue.facts[bar.orientation].flags.get(
                    int(code) if code == code else 0, ""
                )
                text += f"; {next(iter(bar.lengths)).replace(' ', '')} {words.replace('_', '-')}"
        return text

    def _caption(self, width: float) -> list[str]:
        """Return the numbers of the design and its words, a few lines."""
        motion, degrees = self.motion, self.request.degrees
        inputs = motion.catalogue.known_inputs(motion.catalogue.variant_inputs)
        told = {name for name in inputs if inputs[name].choices and len(self.request.motions) > 1}
        own = [
            _valued(inputs[name], value)
            for name, value in motion.design.items()
            if name in inputs and name not in told
        ]
        if motion.links is not None:
            own += [_valued(inputs[name], value) for name, value in motion.links.values.items()]
        symbol = mathematical(motion.catalogue.position.symbol)
        if len(self.request.positions) == 1 and not self.request.moves:
            own.append(f"{symbol} = {motion.shown(self.request.positions[0], degrees)}")
        words = [
            motion.meaning(name) for name in ("grashof_class", "status") if name in motion.catalogue.facts
        ]
        if not motion.turns_fully:
            ends = [] if motion.ranges == (motion.span,) else motion.range_texts(degrees)
            words += [f"{symbol} {', '.join(ends)}"] if ends else []
        return [*_filled(own, ", ", width), *_filled(words, "; ", width)]

    def show(self, positions: Sequence[float] | None = None) -> None:
        """Draw the linkages at positions, one for each sheet, in place of those that are there."""
        for one in self.moving:
            one.remove()
        given = [position for _, position, _ in self.request.sheets] if positions is None else positions
        self.moving = [
            artist for sheet, at in zip(self.sheets, given, strict=True) for artist in sheet.linkage(at)
        ]
        if self.curves is not None:
            self.moving += self.curves.mark(given)


def _view(request: Request) -> Any:
    """Return what every sheet shows: all of the motion, or where a plane has no bounds, the positions."""
    corners: list[Any] = []
    bounded = all(one.picture.metric == "euclidean" for one in request.motions)
    for motion in request.motions:
        positions = [request.positions]
        if bounded:
            positions += motion.along(61, None if request.moves else request.positions)
        elif request.moves:
            positions += [motion.spread(61)]
        for one in positions:
            points = [point for point in motion.points if point.kind != "mark"]
            corners += [at.reshape(-1, 2) for at in motion.places(one, points).values()]
    every = np.concatenate(corners)
    every = every[np.isfinite(every).all(axis=1)]
    low, high = every.min(axis=0), every.max(axis=0)
    if not bounded and request.moves:
        low, high = np.percentile(every, 4, axis=0), np.percentile(every, 96, axis=0)
    if FORCES in request.show:
        longest = LONGEST * GROWN * max((high - low).min(), FLATTEST * (high - low).max())
        moves = request.moves or len(request.positions) > 1
        ends = [ends_of_forces(one, request.positions, longest, moves=moves) for one in request.motions]
        every = np.concatenate([*ends, [low, high]])
        low, high = np.nanmin(every, axis=0), np.nanmax(every, axis=0)
    middle, size = 0.5 * (low + high), high - low
    around = WIDE_AROUND if not bounded else COMB_AROUND if "comb" in request.show else AROUND
    size = size + 2.0 * around * size.max()
    width = max(size[0], size[1] / TALLEST)
    height = max(size[1], width * FLATTEST)
    half = 0.5 * np.array([width, height])
    return np.stack([middle - half, middle + half], axis=-1).ravel()


def _valued(declared: Any, value: float) -> str:
    units = "" if declared.units == "1" else f" {units_text(declared.units)}"
    return f"{mathematical(declared.symbol)} = {short_number(float(value))}{units}"


def _filled(parts: Sequence[str], between: str, width: float) -> list[str]:
    """Return parts in lines of a width in inches; letters of formulas count as what they show."""
    lines: list[list[str]] = [[]]
    for part in parts:
        shown = textwrap.shorten(between.join([*lines[-1], part]), 10**6)
        plain = len(shown.translate(str.maketrans("", "", "${}_\\")))
        if lines[-1] and plain > width * CAPTION_LETTERS:
            lines.append([])
        lines[-1].append(part)
    return [between.join(line) for line in lines if line]
