"""Marks of one size whatever the scale: ground pivots with their hatching, sliders, lines with hatching."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.patheffects import withTickedStroke
from matplotlib.transforms import ScaledTranslation

__all__ = ["INK", "SLIDER", "add_ground", "add_guide", "add_joint", "add_scale", "add_slider", "add_turn"]

INK = "0.15"
POINT = 1.0 / 72.0
#: Of a slider in points: half its length and half its height.
SLIDER = (10.0, 6.0)
HATCH: dict[str, Any] = {"spacing": 4.0, "length": 0.6}

#: Of a curved arrow: the turn of the greatest and of the least, where it begins, its head in points.
TURN, LEAST_TURN, TURN_START, HEAD = 1.5 * np.pi, 0.35 * np.pi, 0.25 * np.pi, 7.0


def _line(axis: Any, x: Any, y: Any, at: Any, **style: Any) -> Any:
    """Draw a line in points of the page about a place."""
    there = ScaledTranslation(float(at[0]), float(at[1]), axis.transData)
    page = axis.figure.dpi_scale_trans
    (drawn,) = axis.plot(np.multiply(x, POINT), np.multiply(y, POINT), transform=page + there, **style)
    drawn.set_in_layout(False)
    return drawn


def add_ground(axis: Any, at: Any, size: float = 1.0) -> None:
    """Draw the support of a ground pivot: a triangle on hatched ground."""
    base, half = -11.0 * size, 7.0 * size
    style: dict[str, Any] = {"color": INK, "linewidth": 1.0, "solid_joinstyle": "round"}
    there = ScaledTranslation(float(at[0]), float(at[1]), axis.transData)
    page = axis.figure.dpi_scale_trans
    triangle = np.multiply([(0.0, 0.0), (-half, base), (half, base)], POINT)
    axis.fill(
        *triangle.T, transform=page + there, facecolor="white", edgecolor=INK, linewidth=1.0, zorder=4.5
    )
    width = 1.6 * half
    _line(axis, [-width, width], [base, base], at, zorder=4.5, **style)
    starts, gap = np.linspace(-0.8 * width, width, 6), np.full(6, np.nan)
    x = np.stack([starts, starts - 4.0 * size, gap], axis=-1).ravel()
    y = np.tile([base, base - 4.5 * size, np.nan], 6)
    _line(axis, x, y, at, zorder=4.5, color=INK, linewidth=0.7)


def add_joint(axis: Any, at: Any, colour: Any, size: float) -> Any:
    """Draw a revolute joint."""
    style = {"marker": "o", "markersize": size, "markerfacecolor": "white", "markeredgecolor": colour}
    (drawn,) = axis.plot(*np.reshape(at, (2, 1)), linestyle="none", markeredgewidth=1.3, zorder=6, **style)
    return drawn


def add_slider(axis: Any, at: Any, colour: Any, size: float = 1.0) -> Any:
    """Draw a slider that runs along x."""
    x, y = np.multiply(SLIDER, size)
    corners = np.multiply([(-x, -y), (x, -y), (x, y), (-x, y)], POINT)
    there = ScaledTranslation(float(at[0]), float(at[1]), axis.transData)
    style = {"facecolor": "white", "edgecolor": colour, "linewidth": 1.4}
    (drawn,) = axis.fill(*corners.T, transform=axis.figure.dpi_scale_trans + there, zorder=3.5, **style)
    return drawn


def add_guide(axis: Any, low: float, high: float, y: float, size: float = 1.0) -> None:
    """Draw the hatched line on which a slider runs along x."""
    below = ScaledTranslation(0.0, -SLIDER[1] * size * POINT, axis.figure.dpi_scale_trans)
    effects = [withTickedStroke(angle=-135, **HATCH)]
    axis.plot(
        *([low, high], [y, y]),
        transform=axis.transData + below,
        color=INK,
        linewidth=0.8,
        path_effects=effects,
        zorder=2.5,
    )


def add_turn(axis: Any, at: Any, share: float, radius: float, colour: Any) -> tuple[list[Any], Any]:
    """Draw a curved arrow about a place, the longer the greater the share; return it, and its line in points."""
    sweep = np.sign(share) * max(abs(share) * TURN, LEAST_TURN)
    turn = TURN_START + np.linspace(0.0, sweep, 41)
    line = radius * np.stack([np.cos(turn), np.sin(turn)], axis=-1)
    cut = -1 - int(np.ceil(0.9 * HEAD / np.hypot(*(line[1] - line[0]))))
    shaft = _line(axis, line[: cut + 1, 0], line[: cut + 1, 1], at, color=colour, linewidth=1.4, zorder=6.5)
    end, back = line[-1], line[-1] - line[cut]
    back = HEAD * back / np.hypot(*back)
    side = 0.38 * np.array([-back[1], back[0]])
    there = ScaledTranslation(float(at[0]), float(at[1]), axis.transData)
    corners = POINT * np.array([end, end - back + side, end - back - side])
    style = {"facecolor": colour, "edgecolor": colour, "linewidth": 0.5, "zorder": 6.5}
    (head,) = axis.fill(*corners.T, transform=axis.figure.dpi_scale_trans + there, **style)
    return [shaft, head], line


def add_scale(axis: Any, view: Any, width: float) -> None:
    """Draw the length of a round number of metres in the lower left corner."""
    step = 10.0 ** np.floor(np.log10(0.3 * width))
    length = step * max(one for one in (1.0, 2.0, 5.0) if one * step <= 0.3 * width)
    left, low = view[0], view[2]
    start = (left, low)
    axis.plot([left, left + length], [low, low], color=INK, linewidth=1.0, clip_on=False)
    for x in (left, left + length):
        _line(axis, [0.0, 0.0], [-3.0, 3.0], (x, start[1]), color=INK, linewidth=1.0, clip_on=False)
    text = {"xytext": (0, 3), "textcoords": "offset points", "ha": "center", "va": "bottom"}
    clear = {"facecolor": "white", "edgecolor": "none", "pad": 0.6, "alpha": 0.85}
    axis.annotate(f"{length:g} m", (left + 0.5 * length, low), fontsize=8, color=INK, bbox=clear, **text)
