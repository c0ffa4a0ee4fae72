"""Show more than the linkage, each thing by a word: paths, limits, circles, light cones, curvature combs, loci."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.lines import Line2D

from fastlink.drawing.following import ARMS, FAINT, add_arms, legend_of_loci
from fastlink.drawing.places import samples_of
from fastlink.facts.names import derivative_name
from fastlink.plot.colours import LINES
from fastlink.plot.labels import mathematical

if TYPE_CHECKING:
    from fastlink.drawing.sheet import Sheet

__all__ = ["MODES", "add_overlays", "mode_line"]

#: The colours of assembly modes, and of what belongs to none.
MODES = LINES
GHOST = "0.72"
TEETH = 90
#: Of the picture: the length of a usual tooth, and of the longest.
TOOTH, LONGEST = 0.06, 4.0


def mode_line(branch: int, **changes: Any) -> dict[str, Any]:
    """Return how curves of an assembly mode are drawn: in its colour, those of the second dashed."""
    dashes = "solid" if branch == 1 else (0, (5, 1.6))
    return {"color": MODES[(branch - 1) % len(MODES)], "linestyle": dashes, "linewidth": 1.3, **changes}


def _add_paths(sheet: Sheet, position: float) -> list[Any]:
    """Draw the paths of traced points."""
    motion = sheet.motion
    names = [
        name for word, names in motion.picture.traced.items() if word in sheet.show for name in names.split()
    ]
    traced = [one for one in motion.points if one.name in names]
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
    return [Line2D([], [], color=FAINT, linewidth=1.3, label=f"path of {letters}")]


def _add_circles(sheet: Sheet, position: float, group: str) -> list[Any]:
    """Draw the circles about ground pivots and the lines of a group, and return their legend."""
    motion, arms = sheet.motion, 0
    for circle in motion.picture.circles:
        if circle.group == group and motion.picture.point(circle.centre).kind == "ground":
            arms += len(add_arms(sheet, position, circle))
    for guide in motion.picture.guides:
        if guide.group == group and not guide.slider and guide.x is not None and motion.has(guide.x):
            x = motion.number(guide.x)
            if np.isfinite(x):
                sheet.axis.axvline(x, color=FAINT, linewidth=0.9, linestyle=(0, (8, 3, 1, 3)), zorder=1.0)
    both = arms and motion.picture.metric != "euclidean"
    lines = [Line2D([], [], color=FAINT, linewidth=0.9, linestyle=ARMS[one]) for one in (True, False) if both]
    for line, label in zip(lines, ("future-pointing arms", "past-pointing arms"), strict=False):
        line.set_label(label)
    return lines


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
    """Draw the curvature of each path as teeth across it, on the outer side."""
    motion = sheet.motion
    size = min(np.ptp(sheet.view[:2]), np.ptp(sheet.view[2:]))
    for name, curvature in motion.picture.curvature.items():
        point = motion.picture.point(name)
        slopes = [derivative_name(str(xy), motion.input) for xy in (point.x, point.y)]
        pieces = [
            motion.values([point.x, point.y, *slopes, curvature], one)
            for one in motion.along(2 * TEETH, position)
        ]
        every = np.concatenate([np.abs(piece[curvature]).ravel() for piece in pieces])
        every = every[np.isfinite(every)]
        unit = TOOTH * size / (float(np.median(every)) or 1.0) if every.size else 0.0
        for piece in pieces:
            for k in range(len(motion.branches)):
                x, y, dx, dy, bend = (piece[key][k] for key in (point.x, point.y, *slopes, curvature))
                length = np.clip(unit * bend, -LONGEST * TOOTH * size, LONGEST * TOOTH * size)
                with np.errstate(all="ignore"):
                    speed = np.hypot(dx, dy)
                    tips = np.stack([x + length * dy / speed, y - length * dx / speed], axis=-1)
                at = np.stack([x, y], axis=-1)
                fine = {"linewidth": 0.5, "alpha": 0.7, "zorder": 1.8}
                gaps = np.full_like(at, np.nan)
                teeth = np.stack([at, tips, gaps], axis=1)[::2].reshape(-1, 2)
                sheet.axis.plot(*teeth.T, **sheet.line_of(k, linestyle="solid", **fine))
                sheet.axis.plot(*tips.T, **sheet.line_of(k, linestyle="solid", **fine | {"linewidth": 0.8}))
    return []


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
