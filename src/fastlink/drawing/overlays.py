"""Show more than the linkage, each thing by a word: paths, limits, circles, light cones, curvature combs, loci."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.lines import Line2D

from fastlink.drawing.following import ARMS, FAINT, add_arms, legend_of_loci
from fastlink.drawing.places import samples_of
from fastlink.errors import InputError
from fastlink.facts.names import derivative_name
from fastlink.plot.colours import LINES
from fastlink.plot.labels import mathematical

if TYPE_CHECKING:
    from fastlink.drawing.motion import Motion
    from fastlink.drawing.sheet import Sheet
    from fastlink.mechanisms._shared.picture import Point, Value

__all__ = ["MODES", "add_overlays", "mode_line"]

#: The colours of assembly modes, and of what belongs to none.
MODES = LINES
GHOST = "0.72"
TEETH = 90
#: Of the picture: the length of a usual tooth, and of the longest.
TOOTH, LONGEST = 0.06, 4.0
#: Of the whole span: how far the positions are from each other of which the change of the slope is taken.
BESIDE = 1e-6
#: The usual curvature times the size of the picture below which a path is a straight line, and rounding its curvature.
STRAIGHT = 1e-6


def mode_line(branch: int, **changes: Any) -> dict[str, Any]:
    """Return how curves of an assembly mode are drawn: in its colour, those of the second dashed."""
    dashes = "solid" if branch == 1 else (0, (5, 1.6))
    return {"color": MODES[(branch - 1) % len(MODES)], "linestyle": dashes, "linewidth": 1.3, **changes}


def _traced(sheet: Sheet, unless: str = "") -> list[Point]:
    """Return the points whose paths are shown; where none are, those of a word."""
    traced = sheet.motion.picture.traced
    words = [word for word in traced if word in sheet.show] or [unless]
    names = [name for word in words for name in traced.get(word, "").split()]
    return [one for one in sheet.motion.points if one.name in names]


def _add_paths(sheet: Sheet, position: float) -> list[Any]:
    """Draw the paths of traced points."""
    motion, traced = sheet.motion, _traced(sheet)
    if not traced:
        return []
    whole = "circuits" in sheet.show or motion.picture.metric != "euclidean"
    for positions in motion.along(361, None if whole else position):
        places = motion.places(positions, traced)
        for one in traced:
            for k, branch in enumerate(motion.branches):
                line = places[one.name][k]
                if np.isfinite(line).all(axis=-1).any():
                    sheet.axis.plot(*line.T, zorder=2.0, gid=f"path {one.name} {branch}", **sheet.line_of(k))
                    sheet.keep_free(samples_of(line, sheet.scale)[::2], 0.5)
    letters = " and ".join(
        mathematical(one.name) if one.is_named else "the middle of a bar" for one in traced
    )
    style = mode_line(motion.branches[0]) if len(motion.branches) == 1 else {"color": FAINT, "linewidth": 1.3}
    return [Line2D([], [], label=f"path of {letters}", **style)]


def _add_circles(sheet: Sheet, position: float, group: str) -> list[Any]:
    """Draw the circles about ground pivots and the lines of a group, and return their legend."""
    motion, arms = sheet.motion, 0
    for circle in motion.picture.circles:
        if circle.group == group and motion.picture.point(circle.centre).kind == "ground":
            lines = add_arms(sheet, position, circle)
            arms += len(lines)
            for one in lines:
                sheet.keep_free(samples_of(one.get_xydata(), sheet.scale)[::2], 0.4)
    for guide in motion.picture.guides:
        if guide.group == group and not guide.slider and guide.x is not None and motion.has(guide.x):
            x = motion.number(guide.x)
            if np.isfinite(x):
                sheet.axis.axvline(x, color=FAINT, linewidth=0.9, linestyle=(0, (8, 3, 1, 3)), zorder=1.0)
    both = arms and motion.picture.metric != "euclidean"
    legend = [
        Line2D([], [], color=FAINT, linewidth=0.9, linestyle=ARMS[one]) for one in (True, False) if both
    ]
    for line, label in zip(legend, ("future-pointing arms", "past-pointing arms"), strict=False):
        line.set_label(label)
    return legend


def _limits(sheet: Sheet, position: float) -> list[Any]:
    """Draw the linkage faintly where its motion ends."""
    motion = sheet.motion
    if motion.turns_fully:
        return []
    ends = [end for one in motion.around(position) for end in one if end not in motion.span]
    if not ends:
        return []
    places = motion.places(ends)
    for bar in motion.picture.bars:
        names = [name for name in bar.points.split() if name in places]
        if bar.is_ground:
            continue
        for at in np.stack([places[name] for name in names], axis=-2).reshape(-1, len(names), 2):
            if np.isfinite(at).all():
                sheet.axis.plot(*at[[0, 1]].T, color=GHOST, linewidth=1.0, zorder=1.5)
    return [Line2D([], [], color=GHOST, linewidth=1.0, label="limits of motion")]


def _cones(sheet: Sheet, position: float) -> list[Any]:
    """Draw the light lines through the ground pivots."""
    reach = 2.0 * float(np.ptp(sheet.view))
    for one in sheet.motion.points:
        if one.kind == "ground":
            at = sheet.motion.places([position], [one])[one.name][0, 0]
            for line in sheet.plane.cone(at, reach):
                sheet.axis.plot(*line.T, color="0.85", linewidth=0.8, zorder=0.5)
    return [Line2D([], [], color="0.85", linewidth=0.8, label="light lines")]


def _comb(sheet: Sheet, position: float) -> list[Any]:
    """Draw the curvature of each path that is shown as teeth across it, on the outer side."""
    motion = sheet.motion
    size = min(np.ptp(sheet.view[:2]), np.ptp(sheet.view[2:]))
    for point in _traced(sheet, unless="path"):
        pieces = [_curved(sheet, point, one) for one in motion.along(2 * TEETH, position)]
        every = np.concatenate([np.hypot(*np.moveaxis(bend, -1, 0)).ravel() for _, bend in pieces])
        every = every[np.isfinite(every)]
        usual = float(np.median(every)) if every.size else 0.0
        if usual * size < STRAIGHT:
            continue
        for places, bends in pieces:
            for k, (at, bend) in enumerate(zip(places, bends, strict=True)):
                tooth = -TOOTH * size / usual * bend
                with np.errstate(all="ignore"):
                    tooth *= np.minimum(1.0, LONGEST * TOOTH * size / np.hypot(*tooth.T))[:, None]
                tips = at + tooth
                fine = {"linewidth": 0.5, "alpha": 0.7, "zorder": 1.8}
                gaps = np.full_like(at, np.nan)
                teeth = np.stack([at, tips, gaps], axis=1)[::2].reshape(-1, 2)
                sheet.axis.plot(*teeth.T, **sheet.line_of(k, linestyle="solid", **fine))
                sheet.axis.plot(*tips.T, **sheet.line_of(k, linestyle="solid", **fine | {"linewidth": 0.8}))
    return []


def _slope(motion: Motion, coordinate: Value) -> Value:
    """Return the derivative of a coordinate by the input: a fact, or 0 where it is the same everywhere."""
    name = derivative_name(str(coordinate), motion.input)
    try:
        motion.values([name], [motion.usual])
    except InputError:
        return 0.0
    return name


def _curved(sheet: Sheet, point: Point, positions: Any) -> tuple[Any, Any]:
    """Return the places of a point and the vectors of curvature of its path, over assembly modes.

    The second derivative is the difference of first ones, which are facts, on both sides.
    """
    motion = sheet.motion
    slopes = [_slope(motion, xy) for xy in (point.x, point.y)]
    beside = BESIDE * (motion.span[1] - motion.span[0])

    def slope(shift: float) -> Any:
        values = motion.values(slopes, positions + shift)
        return np.stack([values[name] for name in slopes], axis=-1)

    with np.errstate(all="ignore"):
        bend = (slope(beside) - slope(-beside)) / (2.0 * beside)
        return motion.places(positions, [point])[point.name], sheet.plane.curvature(slope(0.0), bend)


#: What is drawn by a word of its own.
OF_WORDS: dict[str, Callable[[Sheet, float], list[Any]]] = {
    "cone": _cones,
    "limits": _limits,
    "comb": _comb,
}


def add_overlays(sheet: Sheet, position: float) -> list[Any]:
    """Draw all that is shown besides the linkage, as for a position, and return its legend."""
    handles = [line for group in sorted(sheet.show) for line in _add_circles(sheet, position, group)]
    handles += [*legend_of_loci(sheet), *_add_paths(sheet, position)]
    for word, add in OF_WORDS.items():
        if word in sheet.show:
            handles += add(sheet, position)
    return handles
