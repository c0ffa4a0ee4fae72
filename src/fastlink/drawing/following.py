"""Show what moves with a linkage besides its bars: loci of a position, circles about moving points."""

from __future__ import annotations

from importlib import import_module
from inspect import signature
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.lines import Line2D
from matplotlib.patches import Ellipse

if TYPE_CHECKING:
    from fastlink.drawing.sheet import Sheet
    from fastlink.mechanisms._shared.picture import Circle, Locus

__all__ = ["ARMS", "FAINT", "add_arms", "add_following", "legend_of_loci"]

FAINT = "0.62"
GRID, ELLIPSE, HYPERBOLA = 401, 0, 1
#: The dashes of an arm of a circle of future-pointing vectors, and of the other one.
ARMS: dict[bool, Any] = {True: (0, (1.2, 1.6)), False: (0, (5, 3))}


def add_arms(sheet: Sheet, position: float, circle: Circle) -> list[Any]:
    """Draw a circle in each assembly mode, past-pointing arms dashed, and return the lines."""
    motion, seen, drawn = sheet.motion, set(), []
    if not motion.has(circle.radius):
        return []
    centres = motion.places([position], [motion.picture.point(circle.centre)])[circle.centre][:, 0]
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
    alone = sheet.colour(0) if len(sheet.motion.branches) == 1 else FAINT
    return [
        Line2D([], [], color=alone if _is_of_mode(locus) else FAINT, linewidth=0.9, label=locus.meaning)
        for locus in _shown(sheet)
    ]


def _function(locus: Locus) -> Any:
    package, name = locus.function.split(".")
    return getattr(import_module(f"fastlink.{package}"), name)


def _is_of_mode(locus: Locus) -> bool:
    """Tell whether the curve differs by assembly mode."""
    return "branch" in signature(_function(locus)).parameters


def _shown(sheet: Sheet) -> list[Locus]:
    motion = sheet.motion
    return [one for one in motion.picture.loci if one.group in sheet.show and one.by in ("", motion.input)]


def add_following(sheet: Sheet, position: float) -> list[Any]:
    """Draw loci and circles as they are at a position, and return what was drawn."""
    drawn: list[Any] = []
    picture = sheet.motion.picture
    for circle in picture.circles:
        if circle.group in sheet.show and picture.point(circle.centre).kind != "ground":
            drawn += add_arms(sheet, position, circle)
    for locus in _shown(sheet):
        drawn += _locus(sheet, position, locus)
    return drawn


def _locus(sheet: Sheet, position: float, locus: Locus) -> list[Any]:
    """Draw the curve that a function of fastlink gives for a position, in each assembly mode if they differ."""
    motion = sheet.motion
    function = _function(locus)
    wanted = signature(function).parameters
    known = {key: value for key, value in {**motion.design, motion.input: position}.items() if key in wanted}
    further = motion.values(list(locus.given.values()), [position])
    of_mode = _is_of_mode(locus)
    drawn: list[Any] = []
    for k in np.flatnonzero(motion.assembles(position)[:, 0])[: None if of_mode else 1].tolist():
        own: dict[str, Any] = {"branch": motion.branches[k]} if of_mode else {}
        own |= {key: float(further[fact][k, 0]) for key, fact in locus.given.items()}
        curve = function(**known, **own)
        style = {
            "color": sheet.colour(k) if of_mode else FAINT,
            "linewidth": 0.9,
            "alpha": 0.75,
            "zorder": 1.2,
        }
        if locus.gives == "points":
            drawn += sheet.axis.plot(*np.asarray(curve).T, **style)
        elif locus.gives == "conic":
            drawn += _conic(sheet, curve, style)
        else:
            drawn += _level(sheet, curve, style)
    return drawn


def _conic(sheet: Sheet, conic: Any, style: dict[str, Any]) -> list[Any]:
    """Draw an ellipse or a hyperbola with its second focus."""
    centre = float(conic.centre_x), float(conic.centre_y)
    major, minor, turn = (float(one) for one in (conic.major, conic.minor, conic.direction))
    focus = {"color": style["color"], "markersize": 4.5, "zorder": 5.5}
    drawn: list[Any] = sheet.axis.plot([conic.x2], [conic.y2], "x", **focus)
    if int(conic.kind) == ELLIPSE:
        shape = Ellipse(centre, 2.0 * major, 2.0 * minor, angle=np.degrees(turn), fill=False, **style)
        drawn.append(sheet.axis.add_patch(shape))
    elif int(conic.kind) == HYPERBOLA:
        t = np.linspace(-4.0, 4.0, GRID)
        for side in (1.0, -1.0):
            along, across = side * major * np.cosh(t), minor * np.sinh(t)
            x = centre[0] + along * np.cos(turn) - across * np.sin(turn)
            y = centre[1] + along * np.sin(turn) + across * np.cos(turn)
            drawn += sheet.axis.plot(x, y, **style)
    return drawn


def _level(sheet: Sheet, coefficients: Any, style: dict[str, Any]) -> list[Any]:
    """Draw where a polynomial in x and y is zero."""
    x, y = (np.linspace(low, high, GRID) for low, high in sheet.view.reshape(2, 2))
    values = np.polynomial.polynomial.polygrid2d(x, y, coefficients)
    if not np.nanmin(values) < 0.0 < np.nanmax(values):
        return []
    lines = {"colors": [style["color"]], "linewidths": style["linewidth"], "zorder": style["zorder"]}
    drawn: list[Any] = [sheet.axis.contour(x, y, values.T, [0.0], **lines)]
    return drawn
