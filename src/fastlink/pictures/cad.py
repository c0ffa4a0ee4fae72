"""Write a linkage at true scale, with its paths, for CAD: DXF by ezdxf, and plain SVG, both in millimetres."""

from __future__ import annotations

import html
import io
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from pathlib import Path

    from fastlink.pictures.draw import Request
    from fastlink.pictures.motion import Motion

#: The endings; an .svg of another name is a picture.
DXF, SVG = ".dxf", ".mm.svg"
MM = 1000.0
#: The layers, and their colours: of AutoCAD's table, and of the web.
LAYERS = {"ground": (8, "#808080"), "bars": (7, "#000000"), "joints": (5, "#0b5fa5"), "paths": (1, "#d1495b")}
#: Of the size of the drawing: the radius of a joint.
JOINT = 0.008
#: A layer, what it is, its points in millimetres, and its text: ``"line"``, ``"closed"``, ``"circle"`` or ``"text"``.
Shape = tuple[str, str, tuple[tuple[float, float], ...], str]


def is_cad(path: Path) -> bool:
    """Tell whether a file is one for CAD by its name."""
    return path.name.lower().endswith((DXF, SVG))


def written(request: Request, path: Path) -> bytes:
    """Return the drawing of a request as the file of a name holds it."""
    shapes = list(
        dict.fromkeys(one for motion, at, _ in request.sheets for one in _shapes(motion, at, request.show))
    )
    every = np.array([point for *_, points, _ in shapes for point in points])
    radius = JOINT * float(np.ptp(every, axis=0).max())
    return _dxf(shapes, radius) if path.suffix.lower() == DXF else _svg(shapes, radius, every, request)


def _shapes(motion: Motion, position: float, show: frozenset[str]) -> Iterator[Shape]:
    """Yield what is drawn of a design at a position; of several branches each has layers of its own."""
    points = [one for one in motion.points if not one.group or one.group in show]
    places, there = motion.places_at(position, points), motion.assembles(position)[:, 0]
    traced = motion.traced(show)
    for k, branch in enumerate(motion.branches):
        own = f" {branch}" if len(motion.branches) > 1 else ""
        for bar in motion.picture.bars:
            ends = [places[name][k] for name in bar.points.split() if name in places]
            if bar.is_ground or there[k]:
                layer = "ground" if bar.is_ground else f"bars{own}"
                yield layer, "closed" if len(ends) > 2 else "line", _in_mm(ends), ""
        for one in (one for one in points if one.kind == "ground" or there[k]):
            layer = "ground" if one.kind == "ground" else f"joints{own}"
            yield layer, "circle", _in_mm([places[one.name][k]]), ""
            yield layer, "text", _in_mm([places[one.name][k]]), one.name
        along = motion.along(361, position)
        for guide in (one for one in motion.picture.guides if one.slider):
            x = motion.place(guide.slider, np.concatenate(along))[k, :, 0]
            run = np.stack([[np.nanmin(x), np.nanmax(x)], [motion.number(guide.y or 0.0)] * 2], axis=-1)
            yield "ground", "line", _in_mm(run), ""
        for positions in along:
            for one in traced:
                path = motion.place(one.name, positions)[k]
                gaps = np.flatnonzero(~np.isfinite(path).all(axis=-1))
                for piece in np.split(path, gaps):
                    piece = piece[np.isfinite(piece).all(axis=-1)]
                    if len(piece) > 1:
                        yield f"paths{own}", "line", _in_mm(piece), ""


def _in_mm(points: Any) -> tuple[tuple[float, float], ...]:
    return tuple((float(MM * x), float(MM * y)) for x, y in points)


def _dxf(shapes: list[Shape], radius: float) -> bytes:
    """Return a DXF file, whose head says that one unit is a millimetre."""
    import ezdxf
    from ezdxf import units

    drawing = ezdxf.new("R2010", units=units.MM)
    for layer in dict.fromkeys(layer for layer, *_ in shapes):
        drawing.layers.add(layer, color=LAYERS[layer.split()[0]][0])
    space = drawing.modelspace()
    for layer, kind, points, text in shapes:
        on: dict[str, Any] = {"dxfattribs": {"layer": layer}}
        if kind == "circle":
            space.add_circle(points[0], radius, **on)
        elif kind == "text":
            x, y = points[0]
            space.add_text(text, height=2.0 * radius, **on).set_placement((x + radius, y + radius))
        else:
            space.add_lwpolyline(points, close=kind == "closed", **on)
    file = io.StringIO()
    drawing.write(file)
    return bytes(drawing.encode(file.getvalue()))


def _svg(shapes: list[Shape], radius: float, every: Any, request: Request) -> bytes:
    """Return an SVG file of which a unit is a millimetre; y grows downwards there."""
    low, high = every.min(axis=0) - 6.0 * radius, every.max(axis=0) + 6.0 * radius
    wide, tall = (high - low).tolist()
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{wide}mm" height="{tall}mm"'
        f' viewBox="{low[0]} {-high[1]} {wide} {tall}">',
        f"<title>{html.escape(request.motions[0].title)}</title>",
    ]
    for layer in dict.fromkeys(layer for layer, *_ in shapes):
        look = f'fill="none" stroke="{LAYERS[layer.split()[0]][1]}" stroke-width="{0.25 * radius}"'
        lines.append(f'<g id="{layer.replace(" ", "_")}" {look} font-size="{3.0 * radius}">')
        for of, kind, points, text in shapes:
            x, y = points[0][0], -points[0][1]
            if of != layer:
                continue
            if kind == "circle":
                lines.append(f'<circle cx="{x}" cy="{y}" r="{radius}"/>')
            elif kind == "text":
                lines.append(f'<text x="{x + radius}" y="{y - radius}">{html.escape(text)}</text>')
            else:
                tag = "polygon" if kind == "closed" else "polyline"
                lines.append(f'<{tag} points="{" ".join(f"{x},{-y}" for x, y in points)}"/>')
        lines.append("</g>")
    return "\n".join([*lines, "</svg>\n"]).encode()
