"""The picture of a linkage: sheets of links, marks, forces and overlays; curves, legend and numbers; films.

A `Sheet` draws one design at a position, a `Board` is the whole figure. What moves is what is added to the axes after
the background: it is taken away and drawn anew for each picture of a film.
"""

from __future__ import annotations

import base64
import html
import io
import json
import pathlib
import re
import subprocess
import tempfile
import textwrap
from collections.abc import Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from matplotlib.lines import Line2D
from matplotlib.patches import Ellipse
from matplotlib.path import Path
from matplotlib.patheffects import withStroke, withTickedStroke
from matplotlib.transforms import ScaledTranslation
from PIL import Image

from fastlink._text import filled, short_number
from fastlink.errors import InputError
from fastlink.facts.names import derivative_name
from fastlink.io.output import write_whole
from fastlink.maps.units import DEGREE
from fastlink.pictures.charts import cut
from fastlink.pictures.labels import mathematical, units_text
from fastlink.pictures.motion import (
    PLANES,
    Names,
    finite_of,
    function_of,
    parameters_of,
    samples_of,
)
from fastlink.pictures.style import LINES, NotebookFigure, drawable, limits_of
from fastlink.space.units import RADIANS

if TYPE_CHECKING:
    from fastlink.mechanisms._shared.picture import Bar, Circle, Locus, Point, Value
    from fastlink.pictures.draw import Request
    from fastlink.pictures.motion import Motion


# -- Marks of one size whatever the scale: ground pivots with their hatching, sliders, lines with hatching


INK, FAINT, GHOST = "0.15", "0.62", "0.72"
POINT = 1.0 / 72.0
#: Of a slider in points: half its length and half its height; its corners in these.
SLIDER = np.array([10.0, 6.0])
CORNERS = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])
#: Round the letters of names, over lines.
HALO = withStroke(linewidth=2.0, foreground="white")
HATCH: dict[str, Any] = {"spacing": 4.0, "length": 0.6}
#: Of a curved arrow: the turn of the greatest and of the least, where it begins, its head in points.
TURN, LEAST_TURN, TURN_START, HEAD = 1.5 * np.pi, 0.35 * np.pi, 0.25 * np.pi, 7.0


def _about(axis: Any, at: Any) -> Any:
    """Return the transform of inches of the page about a place."""
    return axis.figure.dpi_scale_trans + ScaledTranslation(float(at[0]), float(at[1]), axis.transData)


def _line(axis: Any, x: Any, y: Any, at: Any, **style: Any) -> None:
    """Draw a line in points of the page about a place."""
    (drawn,) = axis.plot(np.multiply(x, POINT), np.multiply(y, POINT), transform=_about(axis, at), **style)
    drawn.set_in_layout(False)


def _shape(axis: Any, corners: Any, at: Any, **style: Any) -> None:
    """Fill a shape in points of the page about a place."""
    axis.fill(*np.multiply(corners, POINT).T, transform=_about(axis, at), **style)


def add_ground(axis: Any, at: Any, size: float) -> None:
    """Draw the support of a ground pivot: a triangle on hatched ground."""
    base, half = -11.0 * size, 7.0 * size
    look: dict[str, Any] = {"linewidth": 1.0, "zorder": 4.5}
    _shape(axis, [(0.0, 0.0), (-half, base), (half, base)], at, facecolor="white", edgecolor=INK, **look)
    width = 1.6 * half
    _line(axis, [-width, width], [base, base], at, color=INK, solid_joinstyle="round", **look)
    starts, gap = np.linspace(-0.8 * width, width, 6), np.full(6, np.nan)
    x = np.stack([starts, starts - 4.0 * size, gap], axis=-1).ravel()
    y = np.tile([base, base - 4.5 * size, np.nan], 6)
    _line(axis, x, y, at, zorder=4.5, color=INK, linewidth=0.7)


def add_mark(axis: Any, at: Any, size: float, marker: Any = "o", **style: Any) -> None:
    """Draw a mark at a place."""
    style = {"linestyle": "none", "zorder": 6, **style}
    axis.plot(*np.reshape(at, (2, 1)), marker=marker, markersize=size, **style)


def add_joint(axis: Any, at: Any, colour: Any, size: float) -> None:
    """Draw a revolute joint."""
    add_mark(axis, at, size, markerfacecolor="white", markeredgecolor=colour, markeredgewidth=1.3)


def _quartered() -> Path:
    """Return the mark of a mass centre: a circle of which two quarters are filled."""
    turn = np.linspace(0.0, 2.0 * np.pi, 41)
    circle = np.stack([np.cos(turn), np.sin(turn)], axis=-1)
    quarters = [np.concatenate([[(0.0, 0.0)], circle[k : k + 11]]) for k in (0, 20)]
    return Path.make_compound_path(*map(Path, (circle, 0.84 * circle[::-1], *quarters)))


def add_guide(axis: Any, low: float, high: float, y: float, size: float) -> None:
    """Draw the hatched line on which a slider runs along x."""
    below = ScaledTranslation(0.0, -SLIDER[1] * size * POINT, axis.figure.dpi_scale_trans)
    style = {"color": INK, "linewidth": 0.8, "zorder": 2.5}
    effects = [withTickedStroke(angle=-135, **HATCH)]
    axis.plot([low, high], [y, y], transform=axis.transData + below, path_effects=effects, **style)


def add_turn(axis: Any, at: Any, share: float, radius: float, colour: Any) -> Any:
    """Draw a curved arrow about a place, the longer the greater the share; return its line in points."""
    sweep = np.sign(share) * max(abs(share) * TURN, LEAST_TURN)
    turn = TURN_START + np.linspace(0.0, sweep, 41)
    line = radius * np.stack([np.cos(turn), np.sin(turn)], axis=-1)
    cut = -1 - int(np.ceil(0.9 * HEAD / np.hypot(*(line[1] - line[0]))))
    _line(axis, line[: cut + 1, 0], line[: cut + 1, 1], at, color=colour, linewidth=1.4, zorder=6.5)
    end, back = line[-1], line[-1] - line[cut]
    back = HEAD * back / np.hypot(*back)
    side = 0.38 * np.array([-back[1], back[0]])
    style = {"facecolor": colour, "edgecolor": colour, "linewidth": 0.5, "zorder": 6.5}
    _shape(axis, np.array([end, end - back + side, end - back - side]), at, **style)
    return line


def add_scale(axis: Any, view: Any, width: float) -> None:
    """Draw the length of a round number of metres in the lower left corner."""
    step = 10.0 ** np.floor(np.log10(0.3 * width))
    length = step * max(one for one in (1.0, 2.0, 5.0) if one * step <= 0.3 * width)
    left, low = view[0], view[2]
    axis.plot([left, left + length], [low, low], color=INK, linewidth=1.0, clip_on=False)
    for x in (left, left + length):
        _line(axis, [0.0, 0.0], [-3.0, 3.0], (x, low), color=INK, linewidth=1.0, clip_on=False)
    text = {"xytext": (0, 3), "textcoords": "offset points", "ha": "center", "va": "bottom"}
    clear = {"facecolor": "white", "edgecolor": "none", "pad": 0.6, "alpha": 0.85}
    axis.annotate(f"{length:g} m", (left + 0.5 * length, low), fontsize=8, color=INK, bbox=clear, **text)


CENTRE = _quartered()

# -- Show what moves with a linkage besides its bars: loci of a position, circles about moving points


GRID, ELLIPSE, HYPERBOLA = 401, 0, 1
#: The dashes of an arm of a circle of future-pointing vectors, and of the other one.
ARMS: dict[bool, Any] = {True: (0, (1.2, 1.6)), False: (0, (5, 3))}


def add_arms(sheet: Sheet, position: float, circle: Circle) -> list[Any]:
    """Draw a circle in each branch, past-pointing arms dashed, and return the lines."""
    motion, seen, drawn = sheet.motion, set(), list[Any]()
    if not motion.has(circle.radius):
        return []
    centres = motion.place(circle.centre, position)[:, 0]
    radii = motion.values([circle.radius], [position])[circle.radius][:, 0]
    for centre, radius in zip(centres, radii, strict=True):
        key = (*np.round(centre * sheet.scale, 3), round(float(radius) * sheet.scale, 3))
        if not np.isfinite(key).all() or key in seen:
            continue
        seen.add(key)
        for arm, is_usual in sheet.plane.circle(centre, radius, sheet.view):
            style = {"color": FAINT, "linewidth": 0.9, "linestyle": ARMS[is_usual], "zorder": 1.0}
            drawn += sheet.axis.plot(*arm.T, **style)
    return drawn


def legend_of_loci(sheet: Sheet) -> list[Any]:
    """Return the legend of the loci that are shown."""
    handles = []
    for locus in sheet.loci:
        own = "branch" in parameters_of(locus) and len(sheet.motion.branches) == 1
        colour = sheet.colour(0) if own else FAINT
        handles.append(Line2D([], [], color=colour, linewidth=0.9, label=locus.meaning))
    return handles


def add_locus(sheet: Sheet, position: float, locus: Locus) -> None:
    """Draw the curve that a function of fastlink gives for a position, in each branch if they differ."""
    motion, taken = sheet.motion, parameters_of(locus)
    of_branch = "branch" in taken
    further = motion.values(list(locus.given.values()), [position])
    for k in np.flatnonzero(motion.assembles(position)[:, 0])[: None if of_branch else 1].tolist():
        inputs = {**motion.design, motion.input: position, "branch": motion.branches[k]}
        own = {key: float(further[fact][k, 0]) for key, fact in locus.given.items()}
        given = {name: value for name, value in inputs.items() if name in taken}
        curve = function_of(locus)(**given, **own)
        colour = sheet.colour(k) if of_branch else FAINT
        style = {"color": colour, "linewidth": 0.9, "alpha": 0.75, "zorder": 1.2}
        if locus.gives == "points":
            sheet.axis.plot(*np.asarray(curve).T, **style)
        elif locus.gives == "conic":
            _add_conic(sheet.axis, curve, style)
        else:
            _add_level(sheet, curve, style)


def _add_conic(axis: Any, conic: Any, style: dict[str, Any]) -> None:
    """Draw an ellipse or a hyperbola with its second focus."""
    centre = float(conic.centre_x), float(conic.centre_y)
    major, minor, turn = (float(one) for one in (conic.major, conic.minor, conic.direction))
    axis.plot([conic.x2], [conic.y2], "x", color=style["color"], markersize=4.5, zorder=5.5)
    if int(conic.kind) == ELLIPSE:
        angle = np.degrees(turn)
        axis.add_patch(Ellipse(centre, 2.0 * major, 2.0 * minor, angle=angle, fill=False, **style))
    elif int(conic.kind) == HYPERBOLA:
        t = np.linspace(-4.0, 4.0, GRID)
        for side in (1.0, -1.0):
            along, across = side * major * np.cosh(t), minor * np.sinh(t)
            x = centre[0] + along * np.cos(turn) - across * np.sin(turn)
            y = centre[1] + along * np.sin(turn) + across * np.cos(turn)
            axis.plot(x, y, **style)


def _add_level(sheet: Sheet, coefficients: Any, style: dict[str, Any]) -> None:
    """Draw where a polynomial in x and y is zero."""
    x, y = (np.linspace(low, high, GRID) for low, high in sheet.view.reshape(2, 2))
    values = np.polynomial.polynomial.polygrid2d(x, y, coefficients)
    if np.nanmin(values) < 0.0 < np.nanmax(values):
        lines = {"colors": [style["color"]], "linewidths": style["linewidth"], "zorder": style["zorder"]}
        sheet.axis.contour(x, y, values.T, [0.0], **lines)


# -- Show forces as arrows and torques as curved ones, all of a kind by one scale


FORCES, TORQUES, CENTRES = "forces", "torques", "centres"
#: The units of a kind; its mark in the legend, with size and width of line.
UNITS = {FORCES: "N", TORQUES: "N m"}
MARKS = {FORCES: (">", 5.0, 1.4), TORQUES: (r"$\circlearrowleft$", 10.0, 0.0)}
#: Of the picture: the length of the greatest force.
LONGEST = 0.22
#: Of a torque in points: the radius in the first branch, and by how much each further one's is greater.
RADIUS, FURTHER_RADIUS = 17.0, 6.0
#: The distance of a name from the end of an arrow, in points.
CLOSE = 9.0


def _loads(motion: Motion, kind: str, positions: Any) -> tuple[dict[str, Any], float]:
    """Return each load of a kind over branches, positions, and its components; and how great the greatest is."""
    values = motion.vectors({one.name: one.components for one in motion.picture.loads[kind]}, positions)
    sizes = np.stack([np.linalg.norm(one, axis=-1) for one in values.values()])
    return values, float(sizes[np.isfinite(sizes)].max(initial=0.0)) or 1.0


def ends_of_forces(motion: Motion, positions: Any, longest: float) -> Any:
    """Return where the arrows of all forces end, the longest of them of a given length."""
    values, greatest = _loads(motion, FORCES, positions)
    places, unit = motion.places(positions), longest / greatest
    return finite_of(places[one.at] + unit * values[one.name] for one in motion.picture.forces)


def legend_of_loads(sheet: Sheet, position: float) -> list[Any]:
    """Settle the scale of the forces and torques that are shown, and return their legend."""
    handles = []
    for kind in (kind for kind in (FORCES, TORQUES) if kind in sheet.show):
        positions = sheet.motion.spread(61, ends=False) if sheet.moves else [position]
        _, greatest = _loads(sheet.motion, kind, positions)
        sheet.greatest[kind] = greatest
        marker, size, width = MARKS[kind]
        style: dict[str, Any] = {"markersize": size, "linewidth": width, "markeredgewidth": 0.6}
        label = f"{kind}, the greatest {short_number(float(f'{greatest:.3g}'))} {UNITS[kind]}"
        colour = LINES[3] if len(sheet.motion.branches) == 1 else INK
        handles.append(Line2D([], [], color=colour, marker=marker, label=label, **style))
    return handles


def add_loads(sheet: Sheet, position: float) -> None:
    """Draw the forces and torques that are shown at a position, then their names."""
    motion, named = sheet.motion, []
    for kind, greatest in sheet.greatest.items():
        values, _ = _loads(motion, kind, [position])
        for one in motion.picture.loads[kind]:
            for k, value in enumerate(values[one.name][:, 0] / greatest):
                at = sheet.places[one.at][k]
                colour = LINES[3] if len(motion.branches) == 1 else sheet.colour(k)
                if np.isfinite([*value, *at]).all():
                    add = _add_force if kind == FORCES else _add_torque
                    named.append((one.name, k, colour, add(sheet, k, value, at, colour)))
    for name, k, colour, at in named:
        symbol = motion.catalogue.public_fact(name).symbol.strip("|")
        middle = sheet.names.place(f"{name} {k}", symbol.replace("_", ""), at, CLOSE)
        sheet.write(mathematical(symbol), middle, colour)


def _add_force(sheet: Sheet, k: int, vector: Any, start: Any, colour: str) -> Any:
    """Draw an arrow; return the place beside which its name stands."""
    end = start + LONGEST * sheet.side * vector
    arrow = {"arrowstyle": "-|>", "color": colour, "linewidth": 1.4, "shrinkA": 0, "shrinkB": 0}
    sheet.names.keep_free(samples_of([start, end], sheet.scale))
    sheet.axis.annotate("", end, start, arrowprops=arrow, zorder=6.5)
    return end


def _add_torque(sheet: Sheet, k: int, value: Any, at: Any, colour: str) -> Any:
    """Draw a curved arrow; return the place beside which its name stands."""
    radius = (RADIUS + FURTHER_RADIUS * k) * sheet.size
    arc = add_turn(sheet.axis, at, float(value[0]), radius, colour)
    sheet.names.keep_free(at + arc / sheet.scale)
    return at + arc[len(arc) // 2] / sheet.scale


# -- Show more than the linkage, each thing by a word: paths, limits, circles, light cones, curvature combs


TEETH = 90
#: Points from tooth to tooth, twice; how often they are spaced anew, evenly along feet and tips.
FINE, SPACED = 8, 3
#: Of the picture: the length of a usual tooth, and of the longest.
TOOTH, LONGEST_TOOTH = 0.06, 3.0
#: Of the whole span: how far the positions are from each other of which the change of the slope is taken.
ASIDE = 1e-6
#: The usual curvature times the size of the picture below which a path is a straight line, and rounding its curvature.
STRAIGHT = 1e-6


def colour_of(branch: int) -> str:
    """Return the colour of a branch."""
    return LINES[(branch - 1) % len(LINES)]


def branch_line(branch: int, **changes: Any) -> dict[str, Any]:
    """Return how curves of a branch are drawn: in its colour, those of the second dashed."""
    dashes = "solid" if branch == 1 else (0, (5, 1.6))
    return {"color": colour_of(branch), "linestyle": dashes, "linewidth": 1.3, **changes}


def _traced(sheet: Sheet, unless: str = "") -> list[Point]:
    """Return the points whose paths are shown; where none are, those of a word."""
    return sheet.motion.traced(sheet.show) or sheet.motion.traced([unless])


def _add_paths(sheet: Sheet, position: float) -> list[Any]:
    """Draw the paths of traced points."""
    motion, traced = sheet.motion, _traced(sheet)
    if not traced:
        return []
    every_range = "circuits" in sheet.show or motion.picture.metric != "euclidean"
    for positions in motion.along(361, None if every_range else position):
        places = motion.places(positions, traced)
        for one in traced:
            for branch, look, line in zip(motion.branches, motion.looks, places[one.name], strict=True):
                if np.isfinite(line).all(axis=-1).any():
                    style = branch_line(look, zorder=2.0, gid=f"path {one.name} {branch}")
                    sheet.axis.plot(*line.T, **style)
                    sheet.names.keep_free(samples_of(line, sheet.scale)[::2], 0.5)
    letters = " and ".join(_lettered(one.name) if one.is_named else "the middle of a bar" for one in traced)
    style = branch_line(1) if len(motion.branches) == 1 else {"color": FAINT, "linewidth": 1.3}
    return [Line2D([], [], label=f"path of {letters}", **style)]


def _add_circles(sheet: Sheet, position: float, group: str) -> list[Any]:
    """Draw the circles about ground pivots and the lines of a group, and return their legend."""
    motion, arms = sheet.motion, list[Any]()
    for circle in motion.picture.circles:
        if circle.group == group and motion.picture.point(circle.centre).kind == "ground":
            arms += add_arms(sheet, position, circle)
    for one in arms:
        sheet.names.keep_free(samples_of(one.get_xydata(), sheet.scale)[::2], 0.4)
    for guide in motion.picture.guides:
        if guide.group == group and not guide.slider and guide.x is not None and motion.has(guide.x):
            x = motion.number(guide.x)
            if np.isfinite(x):
                sheet.axis.axvline(x, color=FAINT, linewidth=0.9, linestyle=(0, (8, 3, 1, 3)), zorder=1.0)
    labels = {True: "future-pointing arms", False: "past-pointing arms"} if arms else {}
    if motion.picture.metric == "euclidean":
        labels = {True: "circles of joints"} if group == "circles" else {}
    style: dict[str, Any] = {"color": FAINT, "linewidth": 0.9}
    return [Line2D([], [], linestyle=ARMS[one], label=label, **style) for one, label in labels.items()]


def _add_limits(sheet: Sheet, position: float) -> list[Any]:
    """Draw the linkage faintly where its motion ends."""
    motion = sheet.motion
    ends = [end for one in motion.around(position) for end in one if end not in motion.span]
    if motion.turns_fully or not ends:
        return []
    places = motion.places(ends)
    for bar in (bar for bar in motion.picture.bars if not bar.is_ground):
        names = [name for name in bar.points.split() if name in places]
        for at in np.stack([places[name] for name in names], axis=-2).reshape(-1, len(names), 2):
            if np.isfinite(at).all():
                sheet.axis.plot(*at[[0, 1]].T, color=GHOST, linewidth=1.0, zorder=1.5)
    return [Line2D([], [], color=GHOST, linewidth=1.0, label="limits of motion")]


def _add_cones(sheet: Sheet, position: float) -> list[Any]:
    """Draw the light lines through the ground pivots."""
    reach, style = 2.0 * float(np.ptp(sheet.view)), dict[str, Any](color="0.85", linewidth=0.8)
    for at in sheet.ground.values():
        for side in (1.0, -1.0):
            line = at + reach * np.array([[-1.0, -side], [1.0, side]])
            sheet.axis.plot(*line.T, zorder=0.5, **style)
    return [Line2D([], [], label="light lines", **style)]


def _add_comb(sheet: Sheet, position: float) -> list[Any]:
    """Draw the curvature of each path that is shown as teeth across it, on the outer side."""
    motion, handles, size = sheet.motion, list[Any](), sheet.side
    centre = 0.5 * (sheet.view[::2] + sheet.view[1::2])
    for point in _traced(sheet, unless="path"):
        ranges = motion.along(2 * TEETH, position)
        bends = finite_of(_curved(sheet, point, one)[1] for one in ranges)
        usual = float(np.median(np.hypot(*bends.T))) if bends.size else 0.0
        if usual * size < STRAIGHT:
            continue
        for positions in ranges:
            for _ in range(SPACED):
                feet, tips = _teeth(sheet, point, positions, TOOTH * size, usual)
                steps = sum(np.linalg.norm(np.diff(one, axis=1), axis=-1) for one in (feet, tips))
                near = np.linalg.norm(feet[:, 1:] - centre, axis=-1) < np.ptp(sheet.view)
                steps = np.where(near & np.isfinite(steps), steps, 0.0).max(axis=0)
                way = np.concatenate([[0.0], np.cumsum(steps)])
                positions = np.interp(np.linspace(0.0, way[-1], FINE * TEETH + 1), way, positions)
            feet, tips = _teeth(sheet, point, positions, TOOTH * size, usual)
            for look, foot, tip in zip(motion.looks, feet, tips, strict=True):
                teeth = np.stack([foot, tip, np.full_like(foot, np.nan)], axis=1)[:: FINE // 2].reshape(-1, 2)
                for line, width in ((teeth, 0.5), (tip, 0.8)):
                    style = {"linestyle": "solid", "linewidth": width, "alpha": 0.7, "zorder": 1.8}
                    sheet.axis.plot(*line.T, **branch_line(look, **style))
        handles = [Line2D([], [], color=FAINT, linewidth=0.8, label="comb: the curvature of the path")]
    return handles


def _teeth(sheet: Sheet, point: Point, positions: Any, length: float, usual: float) -> tuple[Any, Any]:
    """Return feet and tips of teeth, of a length where the curvature is the usual one."""
    feet, bends = _curved(sheet, point, positions)
    with np.errstate(all="ignore"):
        teeth = -length / usual * bends
        teeth *= np.minimum(1.0, LONGEST_TOOTH * length / np.linalg.norm(teeth, axis=-1))[..., None]
    return feet, feet + teeth


def _slope(motion: Motion, coordinate: Value) -> Value:
    """Return the derivative of a coordinate by the input: a fact, or 0 where it is the same everywhere."""
    name = derivative_name(str(coordinate), motion.input)
    try:
        motion.values([name], [motion.usual])
    except InputError:
        return 0.0
    return name


def _curved(sheet: Sheet, point: Point, positions: Any) -> tuple[Any, Any]:
    """Return the places of a point and the vectors of curvature of its path, over branches."""
    motion = sheet.motion
    slopes = {point.name: [_slope(motion, xy) for xy in (point.x, point.y)]}
    aside = ASIDE * (motion.span[1] - motion.span[0])

    def slope(shift: float) -> Any:
        return motion.vectors(slopes, positions + shift)[point.name]

    with np.errstate(all="ignore"):  # the first derivatives are facts
        bend = (slope(aside) - slope(-aside)) / (2.0 * aside)
        return motion.place(point.name, positions), sheet.plane.curvature(slope(0.0), bend)


def add_overlays(sheet: Sheet, position: float) -> list[Any]:
    """Draw all that is shown besides the linkage, as for a position, and return its legend."""
    handles = [line for group in sorted(sheet.show) for line in _add_circles(sheet, position, group)]
    handles += [*legend_of_loci(sheet), *_add_paths(sheet, position)]
    for word, add in (("cone", _add_cones), ("limits", _add_limits), ("comb", _add_comb)):
        if word in sheet.show:
            handles += add(sheet, position)
    for word, marker, label, edge in (
        (CENTRES, CENTRE, "mass centres", 0.0),
        ("foci", "x", "second focus of the conic", 1.0),
    ):
        if word in sheet.show:
            style: dict[str, Any] = {"linestyle": "none", "color": INK, "markeredgewidth": edge}
            handles.append(Line2D([], [], marker=marker, label=label, **style))
    return handles


# -- One picture of a linkage: what stands still, and the linkage itself at a position


#: Of the size of the picture: points of two branches that are nearer to each other are one.
SAME = 1e-9
PLATE = 0.14
#: The size of a joint for which marks have their sizes.
USUAL_JOINT = 7.5


class Style(NamedTuple):
    """The width of a sheet in inches; that of a bar, and the sizes of joints and letters, in points."""

    width: float
    bar: float
    joint: float
    font: float


#: By how many linkages stand in a row.
STYLES = {
    1: Style(5.6, 3.6, USUAL_JOINT, 10.0),
    2: Style(4.2, 3.2, 6.5, 9.5),
    3: Style(3.2, 2.8, 5.6, 8.5),
    4: Style(2.7, 2.4, 5.6, 8.5),
}


class Sheet:
    """The picture of a design in one pair of axes of a board."""

    def __init__(self, axis: Any, motion: Motion, board: Board, style: Style) -> None:
        self.axis, self.motion, self.view, self.scale = axis, motion, board.view, board.scale
        self.show, self.style, self.size = board.request.show, style, style.joint / USUAL_JOINT
        in_film = board.request.moves
        #: Whether lengths have their symbols; whether one scale of forces is for the whole motion.
        self.lengths = len(board.request.sheets) == 1 and not in_film
        self.moves = in_film or len(board.request.positions) > 1
        self.plane = PLANES[motion.picture.metric]
        self.names = Names(self.scale, self.view, in_film)
        self.loci = [
            one for one in motion.picture.loci if one.group in self.show and one.by in ("", motion.input)
        ]
        #: The shorter side of the view.
        self.side = min(np.ptp(self.view[:2]), np.ptp(self.view[2:]))
        #: The greatest force and torque, of those that are shown.
        self.greatest: dict[str, float] = {}
        #: The places of the ground pivots.
        self.ground: dict[str, Any] = {}
        #: The places of the points in the picture, over branches; those that are the same in all.
        self.places: dict[str, Any] = {}
        self.common: set[str] = set()

    # -- what stands still -----------------------------------------------------------------------------------------

    def background(self, position: float) -> list[Any]:
        """Draw what does not move, as for a position; return the legend of it."""
        axis, view, motion = self.axis, self.view, self.motion
        axis.set(xlim=view[:2], ylim=view[2:], aspect="equal", autoscale_on=False)
        axis.set_axis_off()
        pivots = [one for one in motion.points if one.kind == "ground"]
        self.ground = {name: at[0] for name, at in motion.places_at(position, pivots).items()}
        handles = [*add_overlays(self, position), *legend_of_loads(self, position)]
        for bar in motion.picture.bars:
            if bar.is_ground:
                at = np.array([self.ground[name] for name in bar.points.split()])
                axis.plot(*at.T, color="0.75", linewidth=1.0, linestyle=(0, (8, 3, 1, 3)), zorder=2.2)
                self.names.keep_free(samples_of(at, self.scale), 0.3)
        edge = 16.0 / self.scale
        corner = np.stack(np.meshgrid([-12.0, -6.0, 0.0, 6.0, 12.0], [-7.0, -11.0, -15.0]), axis=-1)
        for at in self.ground.values():
            if np.isfinite(at).all():
                add_ground(axis, at, self.size)
                self.names.keep_free(at + corner * self.size / self.scale, 2.0)
        for guide in motion.picture.guides:
            if guide.slider and guide.y is not None:
                x = motion.place(guide.slider, np.concatenate(motion.along(61)))[..., 0]
                low, high, y = np.nanmin(x) - edge, np.nanmax(x) + edge, motion.number(guide.y)
                add_guide(axis, low, high, y, self.size)
                hatched = np.array([[low, y], [high, y]]) - [0.0, 1.3 * SLIDER[1] * self.size / self.scale]
                self.names.keep_free(samples_of(hatched, self.scale), 0.7)
        self.names.rest()
        return handles

    # -- the linkage -----------------------------------------------------------------------------------------------

    def linkage(self, position: float) -> None:
        """Draw the linkage at a position in all its branches."""
        motion, names = self.motion, self.names
        points = [one for one in motion.points if not one.group or one.group in self.show]
        assembled = motion.assembles(position)
        self.places = {
            one.name: at if one.kind == "ground" else np.where(assembled, at, np.nan)
            for one, at in zip(points, motion.places_at(position, points).values(), strict=True)
        }
        self.common = {name for name, at in self.places.items() if self._is_common(at)}
        names.clear()
        for circle in motion.picture.circles:
            if circle.group in self.show and motion.picture.point(circle.centre).kind != "ground":
                add_arms(self, position, circle)
        for locus in self.loci:
            add_locus(self, position, locus)
        for bar in motion.picture.bars:
            if not bar.is_ground:
                self._bar(bar, position)
        for one in points:
            for k, colour in self._in_branches(one.name):
                self._point(one, self.places[one.name][k], colour)
        if not assembled.any():
            self.write("does not assemble", 0.5 * (self.view[::2] + self.view[1::2]), "0.4")
        add_loads(self, position)
        self._letters([one.name for one in points if one.is_named])
        if self.lengths:
            self._symbols()

    def _is_common(self, at: Any) -> bool:
        """Tell whether a point is the same in all branches in which it exists."""
        finite = at[np.isfinite(at).all(axis=-1)]
        if len(finite) < 2:
            return len(self.motion.branches) < 2
        return float(np.ptp(finite, axis=0).max()) <= SAME * float(np.ptp(self.view[:2]))

    def _in_branches(self, *names: str) -> list[tuple[int, str]]:
        """Return the branches, by index, in which some points are, and their colours: one where all of them agree."""
        places = np.stack([self.places[name] for name in names])
        finite = np.flatnonzero(np.isfinite(places).all(axis=(0, 2))).tolist()
        if self.common.issuperset(names):
            return [(k, INK) for k in finite[:1]]
        return [(k, self.colour(k)) for k in finite]

    def colour(self, k: int) -> str:
        """Return the colour of the branch with an index."""
        return colour_of(self.motion.looks[k])

    def _point(self, point: Point, at: Any, colour: Any) -> None:
        joint, kind = self.style.joint, point.kind
        if kind == "slider":
            box = {"facecolor": "white", "edgecolor": colour, "linewidth": 1.4, "zorder": 3.5}
            _shape(self.axis, CORNERS * SLIDER * self.size, at, **box)
            corners = at + SLIDER * self.size / self.scale * np.concatenate([CORNERS, CORNERS[:1]])
            self.names.keep_free(samples_of(corners, self.scale))
            add_joint(self.axis, at, colour, 0.8 * joint)
        elif point.group == CENTRES:
            for marker, face in (("o", "white"), (CENTRE, colour)):
                add_mark(self.axis, at, 1.1 * joint, marker, color=face, markeredgewidth=0.0)
        elif kind in ("traced", "mark"):
            add_mark(self.axis, at, (0.5 if kind == "traced" else 0.4) * joint, color=colour)
        else:
            add_joint(self.axis, at, colour, joint)

    def _bar(self, bar: Bar, position: float) -> None:
        """Draw a bar, or a plate, in each branch that has it."""
        names = [name for name in bar.points.split() if name in self.places]
        for k, colour in self._in_branches(*names):
            places = {name: self.places[name][k] for name in names}
            at = np.stack([*places.values()])
            self._outline(bar, places, self.motion.branches[k], colour)
            if len(at) > 2:
                self.axis.fill(*at.T, facecolor=colour, alpha=PLATE, linewidth=0, zorder=3.0)
            if bar.orientation:
                side = self.motion.values([bar.orientation], [position])[bar.orientation][k, 0]
                head = {"facecolor": "white" if side < 0.0 else colour, "edgecolor": colour, "linewidth": 1.2}
                head |= {"arrowstyle": "-|>,head_length=0.55,head_width=0.3", "shrinkA": 0, "shrinkB": 0}
                start, along = at[0], at[1] - at[0]
                self.axis.annotate("", start + 0.6 * along, start + 0.5 * along, arrowprops=head, zorder=5)
            self.names.keep_free(samples_of(np.concatenate([at, at[:1]]), self.scale))

    def _outline(self, bar: Bar, places: dict[str, Any], branch: int, colour: str) -> None:
        """Draw a bar: thick along lengths, hollow in the second branch; thin round the rest of a plate."""
        edges = list(pairwise([*places, next(iter(places))]))
        thick: list[Any] = [tuple(pair.split()) for pair in bar.lengths]
        if len(places) == 2:
            thick = thick or edges[:1]  # whose length is a number, or changes
        thin = [pair for pair in edges if pair not in thick and pair[::-1] not in thick]
        width, style = self.style.bar, {"solid_capstyle": "round", "zorder": 4.0}
        for kind, pairs, wide in (("bar", thick, width), ("edge", thin, 0.3 * width)):
            for a, b in pairs:
                look = {"color": colour, "linewidth": wide, "gid": f"{kind} {a} {b} {branch}", **style}
                self.axis.plot(*np.transpose([places[a], places[b]]), **look)
        for a, b in thick if branch > 1 and colour != INK else ():
            line = np.transpose([places[a], places[b]])
            self.axis.plot(*line, color="white", linewidth=0.45 * width, **style)

    def _letters(self, named: list[str]) -> None:
        """Write the names of points; those that stand in one place share it."""
        groups: list[tuple[Any, Any, list[str]]] = []
        near = 0.6 * self.style.joint / self.scale
        for name in named:
            for k, colour in self._in_branches(name):
                at = self.places[name][k]
                self.names.keep_free(at + np.array([[0.0, 0.0], [3.0, 0.0], [-3.0, 0.0]]) / self.scale, 1.5)
                letters = next((names for place, _, names in groups if np.hypot(*(place - at)) < near), None)
                if letters is None:
                    groups.append((at, colour, [name]))
                elif name not in letters:
                    letters.append(name)
        for number, (at, colour, letters) in enumerate(groups):
            if self._is_in_view(at):
                text = ", ".join(letters)
                middle = self.names.place(f"{text} {number}", text, at)
                self.write(", ".join(map(_lettered, letters)), middle, colour)

    def _is_in_view(self, at: Any) -> bool:
        view = self.view
        return bool(view[0] <= at[0] <= view[1] and view[2] <= at[1] <= view[3])

    def _symbols(self) -> None:
        """Write the symbols of lengths along bars, those of the first branch."""
        known, facts = self.motion.known_inputs, self.motion.catalogue.facts
        for bar in self.motion.picture.bars:
            for pair, length in bar.lengths.items():
                for k, colour in self._in_branches(*pair.split())[:1]:
                    start, end = (self.places[name][k] for name in pair.split())
                    if self._is_in_view(0.5 * (start + end)):
                        symbol = (known.get(length) or facts[length]).symbol
                        middle = self.names.beside(pair, symbol.replace("_", ""), start, end)
                        self.write(mathematical(symbol), middle, "0.5" if bar.is_ground else colour)

    def write(self, text: str, at: Any, colour: Any) -> None:
        """Write the name of something."""
        style = {"ha": "center", "va": "center", "fontsize": self.style.font, "zorder": 8, "gid": "name"}
        self.axis.text(*at, text, color=colour, path_effects=[HALO], **style)


# -- Curves of quantities over the input, beside a linkage, with the input marked


CURVE_POINTS = 361
MOST_RANGE = 50.0


def _lettered(name: str) -> str:
    """Return the name of a point as it is written: the number of a mass centre is an index."""
    return mathematical(re.sub(r"(?<=[A-Z])(\d+)$", r"_\1", name))


class Curves:
    """The curves of some quantities, one below the other."""

    def __init__(self, axes: Sequence[Any], motion: Motion, names: Sequence[str], degrees: bool) -> None:
        self.axes, self.motion, self.names, self.degrees = axes, motion, names, degrees
        known = motion.catalogue
        #: What stands along an axis, by its name: a quantity, or the input.
        self.labels: dict[str, Any] = {name: known.public_fact(name) for name in names}
        self.labels[motion.input] = known.position
        for axis, name in zip(axes, names, strict=True):
            self._draw(axis, name)
            axis.set_ylabel(self._label(name), fontsize=9)
            axis.tick_params(labelsize=8, labelbottom=axis is axes[-1])
            axis.grid(color="0.92", linewidth=0.8)
            axis.set_axisbelow(True)
        axes[-1].set_xlabel(self._label(motion.input), fontsize=9)

    def _units(self, name: str) -> str:
        units: str = self.labels[name].units
        return DEGREE if self.degrees and units == RADIANS else units

    def _label(self, name: str) -> str:
        units = self._units(name)
        return mathematical(self.labels[name].symbol) + ("" if units == "1" else f" [{units_text(units)}]")

    def _values(self, name: str, positions: Any) -> Any:
        """Return a quantity, or the input, over branches and positions, as it is shown."""
        values = self.motion.values([name], positions)[name]
        return np.degrees(values) if self._units(name) == DEGREE else values

    def _draw(self, axis: Any, name: str) -> None:
        motion, every = self.motion, []
        for positions in motion.along(CURVE_POINTS):
            curves = zip(self._values(motion.input, positions), self._values(name, positions), strict=True)
            for branch, (along, values) in zip(motion.looks, curves, strict=True):
                axis.plot(*cut(along, drawable(values), self._units(name)), **branch_line(branch))
                every.append(values)
        low, high, extend = limits_of(drawable(np.concatenate(every)), np.concatenate(every), MOST_RANGE)
        if extend != "neither":
            axis.set_ylim(low - 0.05 * (high - low), high + 0.05 * (high - low))
        ends = self._values(motion.input, [motion.ranges[0][0], motion.ranges[-1][1]])[0]
        axis.set_xlim(*ends)
        if self._units(motion.input) == DEGREE:
            step = next(step for step in (5, 10, 15, 30, 45, 60, 90) if (ends[1] - ends[0]) / step <= 8.5)
            axis.set_xticks(np.arange(np.ceil(ends[0] / step), np.floor(ends[1] / step) + 1) * step)

    def mark(self, positions: Sequence[float]) -> None:
        """Mark the input, moved by whole turns into what the axes show, and the values there."""
        low, shown = self.motion.ranges[0][0], np.asarray(positions)
        shown = low + (shown - low) % (2.0 * np.pi) if self.motion.turns else shown
        for axis, name in zip(self.axes, self.names, strict=True):
            for position, x in zip(positions, self._values(self.motion.input, shown)[0], strict=True):
                axis.axvline(x, color="0.35", linewidth=0.9, zorder=1.5)
                values = self._values(name, [position])[:, 0]
                for branch, value in zip(self.motion.looks, values, strict=True):
                    if np.isfinite(value):
                        style = {"markersize": 5, "markeredgecolor": "white", "zorder": 5}
                        axis.plot([x], [value], "o", color=colour_of(branch), **style)


# -- The whole picture: one or several sheets, curves beside them, the legend and the numbers of the design


MOST_IN_A_ROW = len(STYLES)
#: In inches: the margin, a line of text, the title, the curves beside, and each of these.
MARGIN, LINE, TITLE, BESIDE, CURVE = 0.25, 0.19, 0.3, 3.6, 1.25
#: The height of a sheet over its width.
FLATTEST, TALLEST = 0.42, 1.1
#: Of the size of what is drawn: the margin in a view, and in one of a plane without bounds.
AROUND, WIDE_AROUND = 0.09, 0.3
#: The same where the teeth of a comb stand on the path.
COMB_AROUND = 0.32
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
        wide = STYLES[columns].width
        high = wide * float(np.ptp(self.view[2:]) / np.ptp(self.view[:2]))
        self.scale = POINTS * wide / float(np.ptp(self.view[:2]))
        self.figure = NotebookFigure(layout=None)
        #: The axes with their places in inches, from the upper left corner.
        self.placed: list[tuple[Any, tuple[float, float, float, float]]] = []
        self.sheets: list[Sheet] = []
        handles: list[Any] = []
        titles = [textwrap.fill(title, int(wide * TITLE_LETTERS)) for *_, title in request.sheets]
        above = LINE * 1.2 * max(title.count("\n") + bool(title) for title in titles)
        top, each = MARGIN + TITLE, high + above + MARGIN
        for number, (title, (motion, position, _)) in enumerate(zip(titles, request.sheets, strict=True)):
            row, column = divmod(number, columns)
            axis = self._axes((MARGIN + column * (wide + MARGIN), top + row * each + above, wide, high))
            sheet = Sheet(axis, motion, self, STYLES[columns])
            found = sheet.background(position)
            handles = handles or found
            if title:
                axis.set_title(title, fontsize=sheet.style.font, pad=3.0)
            self.sheets.append(sheet)
        add_scale(self.sheets[0].axis, self.view, float(np.ptp(self.view[:2])))
        page, low = MARGIN + columns * (wide + MARGIN), top + rows * each - MARGIN
        self.curves: Curves | None = None
        if request.curves:
            low = max(low, top + CURVE * len(request.curves) + 0.5)
            self.curves = self._add_curves(page, top + 0.1, low - 0.4)
            page += BESIDE
        # one alone is named by the numbers below
        branches = self.motion.branches if len(self.motion.branches) > 1 else ()
        named = [Line2D([], [], label=self._branch(k), **branch_line(b)) for k, b in enumerate(branches)]
        self._finish(page, low, [*named, *handles])
        self.moving: list[Any] = []

    def _add_curves(self, left: float, top: float, low: float) -> Curves:
        """Add the axes of curves on the right."""
        names, gap = self.request.curves, 0.12
        each = (low - top + gap) / len(names)
        tops = [top + k * each for k in range(len(names))]
        axes = [self._axes((left + 0.6, one, BESIDE - 0.6 - MARGIN, each - gap)) for one in tops]
        return Curves(axes, self.motion, names, self.request.degrees)

    def _axes(self, box: tuple[float, float, float, float]) -> Any:
        """Return new axes with their place in inches, from the upper left corner: left, top, width, height."""
        axis = self.figure.add_axes((0.0, 0.0, 1.0, 1.0), label=str(len(self.placed)))
        self.placed.append((axis, box))
        return axis

    def _finish(self, width: float, low: float, handles: list[Any]) -> None:
        """Write title, legend and numbers, and give the page the size that all of it takes."""
        caption = self._caption(width)
        longest = max((len(handle.get_label()) for handle in handles), default=0)
        columns = 2 if len(handles) > 3 and 2 * (longest * LETTER + 0.9) < width else 1
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
        title = textwrap.fill(self.motion.title, int(width * TITLE_LETTERS))
        figure.text(0.5, 1.0 - 1.2 * MARGIN / height, title, fontsize=10.5, **centre)
        style = {"frameon": False, "fontsize": 8.5, "borderaxespad": 0.0, "handlelength": 2.4}
        place = (0.5, 1.0 - (low + 0.7 * MARGIN) / height)
        figure.legend(handles=handles, loc="upper center", bbox_to_anchor=place, ncols=columns, **style)
        for number, line in enumerate(reversed(caption)):
            at = (0.6 * MARGIN + LINE * (number + 0.5)) / height
            figure.text(0.5, at, line, fontsize=8, color="0.35", **centre)

    def _branch(self, k: int) -> str:
        """Return a branch in words; of a single picture also which bars point to the future and to the past."""
        motion, branch = self.motion, self.motion.branches[k]
        is_single = len(self.request.sheets) == 1 and not self.request.moves
        text = f"branch {branch}: {motion.catalogue.branches[branch]}"
        for bar in motion.picture.bars:
            if bar.orientation and is_single:
                code = motion.values([bar.orientation], self.request.positions)[bar.orientation][k, 0]
                words = motion.catalogue.facts[bar.orientation].flags.get(int(np.nan_to_num(code)), "")
                text += f"; {next(iter(bar.lengths)).replace(' ', '')} {words.replace('_', '-')}"
        return text

    def _caption(self, width: float) -> list[str]:
        """Return the numbers of the design and its words, a few lines."""
        motion, degrees = self.motion, self.request.degrees
        inputs, several = motion.known_inputs, len(self.request.motions) > 1
        given = {**motion.design, **({} if motion.links is None else motion.links.values)}
        own = [
            _valued(inputs[name], value)
            for name, value in given.items()
            if name in inputs and not (several and inputs[name].choices)  # which the titles say
        ]
        if len(self.request.positions) == 1 and not self.request.moves:
            own.append(motion.stated(self.request.positions[0], degrees))
        words = [motion.meaning("status")] if "status" in motion.catalogue.facts else []
        words += [self._branch(0)] if len(motion.branches) < 2 else []
        if motion.ranges and motion.ranges != (motion.span,):
            words.append(f"{motion.symbol} {', '.join(motion.range_texts(degrees))}")
        return [*_filled(own, ", ", width), *_filled(words, "; ", width)]

    def show(self, positions: Sequence[float] | None = None) -> None:
        """Draw the linkages at positions, one for each sheet, in place of those that are there."""
        self.clear()
        still = set(self._artists())
        given = [position for _, position, _ in self.request.sheets] if positions is None else positions
        for sheet, position in zip(self.sheets, given, strict=True):
            sheet.linkage(position)
        if self.request.moves:
            text, axis = self.motion.stated(given[0], self.request.degrees, brief=True), self.sheets[0].axis
            axis.text(0.0, 1.0, text, transform=axis.transAxes, va="top", fontsize=9, color=INK)
        if self.curves is not None:
            self.curves.mark(given)
        self.moving = [one for one in self._artists() if one not in still]

    def clear(self) -> None:
        """Take away what moves."""
        for one in self.moving:
            one.remove()
        self.moving = []

    def _artists(self) -> list[Any]:
        return [one for axis, _ in self.placed for one in axis.get_children()]


def _view(request: Request) -> Any:
    """Return what every sheet shows: linkage and overlays, of all the motion where it moves and a plane has bounds."""
    corners: list[Any] = []
    bounded = all(one.picture.metric == "euclidean" for one in request.motions)
    for motion in request.motions:
        points = [point for point in motion.points if point.kind != "mark"]
        corners += motion.places(request.positions, points).values()
        moving = [one for one in points if request.moves or one.kind == "slider"]
        along = motion.along(61, None if request.moves else request.positions) if bounded else []
        along += [motion.spread(61)] if request.moves and not bounded else []
        if "limits" in request.show and bounded and not motion.turns_fully:
            corners += motion.places(np.ravel(motion.around(request.positions)), points).values()
        for one in along:
            corners += motion.places(one, [*moving, *motion.traced(request.show)]).values()
        for circle in motion.picture.circles if bounded and "circles" in request.show else ():
            if motion.picture.point(circle.centre).kind == "ground" and circle.group == "circles":
                centre = motion.place(circle.centre, 0.0)[:1, 0]
                radius = motion.number(circle.radius)
                corners += [centre + radius * np.array([[1.0, 1.0], [-1.0, -1.0]])]
    every = finite_of(corners)
    low, high = every.min(axis=0), every.max(axis=0)
    if not bounded and request.moves:
        low, high = np.percentile(every, 4, axis=0), np.percentile(every, 96, axis=0)
    if FORCES in request.show:
        longest = LONGEST * GROWN * max((high - low).min(), FLATTEST * (high - low).max())
        moves = request.moves or len(request.positions) > 1
        ends = [
            ends_of_forces(one, one.spread(61, ends=False) if moves else request.positions, longest)
            for one in request.motions
        ]
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


# -- Write a linkage that moves: as GIF, as film, or as a page with a slider


DPI, COLOURS = 90, 48
SECONDS = 6.0  # of a cycle
#: Away from the ends of the motion, so that no two pictures in a row are the same.
PHASE = 0.25


def write_film(board: Board, path: pathlib.Path, frames: int) -> None:
    """Write the motion of a picture of one position: a turn, or there and back through the range."""
    motion = board.motion
    low, high = motion.around(board.request.positions)[0]
    share = (np.arange(frames) + PHASE) / frames
    if motion.turns_fully:
        positions = low + (high - low) * share
    else:
        positions = 0.5 * (low + high) - 0.5 * (high - low) * np.cos(2.0 * np.pi * share)
    pictures = _pictures(board, positions)
    written = {".gif": _gif, ".mp4": _film, ".html": _page}[path.suffix.lower()]
    labels = [motion.shown(one, board.request.degrees, brief=True) for one in positions]
    write_whole(path, written(pictures, f"{motion.mechanism}: {motion.input}", labels), "animate")


def _pictures(board: Board, positions: Any) -> list[Any]:
    """Return a picture for each position: what stands still is drawn once."""
    figure = board.figure
    figure.set_dpi(DPI)
    board.clear()
    canvas: Any = figure.canvas
    canvas.draw()
    still = canvas.copy_from_bbox(figure.bbox)
    found = []
    for position in positions:
        board.show([position] * len(board.sheets))
        canvas.restore_region(still)
        for one in sorted(board.moving, key=lambda artist: artist.get_zorder()):
            figure.draw_artist(one)
        found.append(Image.fromarray(np.array(canvas.buffer_rgba())[..., :3]))
    return found


def _small(pictures: list[Any]) -> list[Any]:
    """Return pictures of the same few colours, each the nearest: Pillow's own are near ones, and white turns grey."""
    few = pictures[0].quantize(COLOURS)
    palette = np.reshape(few.getpalette(), (-1, 3))
    palette[few.getpixel((0, 0))] = 255
    found = []
    for picture in pictures:
        pixels = np.asarray(picture, dtype=np.int64)
        packed: Any = pixels @ np.array([1 << 16, 1 << 8, 1])
        colours, places = np.unique(packed, return_inverse=True)
        parts = np.stack([colours >> 16, (colours >> 8) & 255, colours & 255], axis=-1)
        nearest = ((parts[:, None] - palette[None]) ** 2).sum(axis=-1).argmin(axis=1)
        small = Image.fromarray(nearest[places].reshape(pixels.shape[:2]).astype(np.uint8))
        small.putpalette(palette.ravel().tolist())
        found.append(small)
    return found


def _gif(pictures: list[Any], title: str, labels: Sequence[str]) -> bytes:
    first, *others = _small(pictures)
    step = max(20, round(1000.0 * SECONDS / len(pictures)))
    film = io.BytesIO()
    first.save(film, format="GIF", save_all=True, append_images=others, duration=step, loop=0, disposal=1)
    return film.getvalue()


def _film(pictures: list[Any], title: str, labels: Sequence[str]) -> bytes:
    width, height = pictures[0].size
    rate = f"{len(pictures) / SECONDS:.6f}"
    # coding takes sides of an even number of pixels
    given = ["-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{width}x{height}", "-r", rate, "-i", "-"]
    wanted = ["-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2:color=white", "-pix_fmt", "yuv420p", "-f", "mp4"]
    pixels = b"".join(picture.tobytes() for picture in pictures)
    # into a file: ffmpeg goes back in it to note where the pictures are
    with tempfile.TemporaryDirectory() as folder:
        film = pathlib.Path(folder, "film.mp4")
        command = ["ffmpeg", "-y", "-loglevel", "error", *given, *wanted, str(film)]
        done = subprocess.run(command, input=pixels, capture_output=True, check=False)
        if done.returncode:
            lines = done.stderr.decode(errors="replace").strip().splitlines()
            what = f"ffmpeg failed ({lines[-1] if lines else f'exit status {done.returncode}'})"
            raise InputError(what, where=("animate",), remedy="write a .gif or an .html")
        return film.read_bytes()


PAGE = """<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>TITLE</title>
<style>
body {font: 15px sans-serif; margin: 1em auto; max-width: WIDTHpx; text-align: center}
img {max-width: 100%} input {width: 60%; vertical-align: middle} output {display: inline-block; min-width: 8em}
</style></head><body>
<img id="picture" alt="TITLE"><br>
<button id="play" aria-label="play or pause">&#10074;&#10074;</button>
<input id="place" type="range" min="0" max="LAST" value="0" aria-label="TITLE"> <output id="label"></output>
<script>
const frames = FRAMES, labels = LABELS, step = STEP;
const [picture, play, place, label] = ["picture", "play", "place", "label"].map(id => document.getElementById(id));
let timer = null;
function show(k) { place.value = k; picture.src = "data:image/png;base64," + frames[k]; label.value = labels[k]; }
function run(on) {
  clearInterval(timer);
  timer = on ? setInterval(() => show((+place.value + 1) % frames.length), step) : null;
  play.innerHTML = on ? "&#10074;&#10074;" : "&#9654;";
}
play.onclick = () => run(timer === null);
place.oninput = () => { run(false); show(+place.value); };
show(0); run(!window.matchMedia("(prefers-reduced-motion: reduce)").matches);
</script></body></html>
"""


def _page(pictures: list[Any], title: str, labels: Sequence[str]) -> bytes:
    texts = []
    for picture in _small(pictures):
        page = io.BytesIO()
        picture.save(page, format="PNG", optimize=True)
        texts.append(base64.b64encode(page.getvalue()).decode())
    values = {
        "TITLE": html.escape(title),
        "WIDTH": str(pictures[0].width),
        "LAST": str(len(pictures) - 1),
        "LABELS": json.dumps(list(labels)),
        "STEP": f"{1000.0 * SECONDS / len(pictures):.0f}",
        "FRAMES": json.dumps(texts),
    }
    return filled(PAGE, values).encode()
