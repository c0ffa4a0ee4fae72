"""Tell a page what a map holds: its dimensions and variables, and the mechanism that it is of."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink._text import in_words
from fastlink.drawing.motion import Motion
from fastlink.drawing.request import picture_of
from fastlink.errors import InputError
from fastlink.exploring.colours import colour_tables
from fastlink.exploring.translation import script_of
from fastlink.facts.names import innermost
from fastlink.maps.flags import flags_of
from fastlink.mechanisms import catalogue as find_catalogue
from fastlink.plan.query import parse_request
from fastlink.plan.validate import constants_of, selected_variants
from fastlink.plot.colours import LINES
from fastlink.space.degrees import DEGREES
from fastlink.space.design_space import BRANCH, DESIGN
from fastlink.space.links import taken_links

if TYPE_CHECKING:
    import xarray as xr

    from fastlink.catalogue.catalogue import Catalogue
    from fastlink.exploring.values import Values
    from fastlink.mechanisms._shared.picture import Picture

__all__ = ["content_of"]


def content_of(values: Values) -> dict[str, Any]:
    """Return what a page has to know of a map before it asks for values."""
    maps = values.maps
    names = values.names
    if not names:
        raise InputError("has no variables of numbers", where=("maps",), remedy="give a map with results")
    inner = [str(dim) for name in names for dim in maps[name].dims]
    dims = [dim for dim in dict.fromkeys([*map(str, maps.sizes), *inner]) if dim in inner]
    along = [
        str(name) for name, one in maps.coords.items() if one.dims == (DESIGN,) and one.dtype.kind in "iuf"
    ]
    return {
        "file": Path(str(values.path or maps.encoding.get("source", ""))).name,
        "title": str(maps.attrs.get("title", "")),
        "version": str(maps.attrs.get("fastlink_version", "")),
        "dims": [_dimension(maps, dim) for dim in dims],
        "columns": [{"name": name, **_labels(maps[name])} for name in along if name != DESIGN],
        "step": values.step,
        "constants": [
            {"name": str(name), "value": one.item(), **_labels(one)}
            for name, one in maps.coords.items()
            if one.ndim == 0 and one.dtype.kind in "iuf"
        ],
        "variables": [
            {
                "name": name,
                "dims": [str(dim) for dim in maps[name].dims],
                "requested": _is_request(maps, name),
                **_labels(maps[name]),
            }
            for name in names
        ],
        "colours": colour_tables(),
        "modes": list(LINES),
        "mechanism": _mechanism(maps),
    }


def _labels(array: xr.DataArray) -> dict[str, Any]:
    """Return meaning, symbol and units, and the meanings of codes."""
    attrs = array.attrs
    flags = {str(code): in_words(meaning) for meaning, code in flags_of(array).items()}
    return {
        "meaning": str(attrs.get("long_name", array.name)),
        "symbol": str(attrs.get("symbol", array.name)),
        "units": str(attrs.get("units", "1")),
        **({"flags": flags} if flags else {}),
    }


def _catalogue_of(maps: xr.Dataset) -> Catalogue:
    """Return the mechanism of a map, as driven by its input, or refuse it."""
    driven = maps.attrs.get("input")
    return find_catalogue(str(maps.attrs.get("mechanism")), None if driven is None else str(driven))


def _is_request(maps: xr.Dataset, name: str) -> bool:
    """Tell whether a variable is one that a study can ask for."""
    try:
        parse_request(name, _catalogue_of(maps))
    except InputError:
        return False
    return True


def _dimension(maps: xr.Dataset, dim: str) -> dict[str, Any]:
    """Return a dimension with its coordinates; without any, places; names where these are no growing numbers."""
    length = int(maps.sizes[dim])
    found: dict[str, Any] = {"name": dim, "length": length, **_labels(maps[dim])}
    if dim == DESIGN:
        return found
    along = maps[dim].values if dim in maps.coords else np.arange(length)
    numbers = along.dtype.kind in "iuf" and np.isfinite(along).all()
    steps = np.diff(along) if numbers else np.zeros(1)
    if numbers and ((steps > 0).all() or (steps < 0).all()) and "flags" not in found:
        return {**found, "values": along.tolist()}
    flags = found.get("flags", {})
    texts = [str(flags.get(str(one), one)) for one in along.tolist()]
    return {**found, "names": texts, "codes": along.tolist() if numbers else list(range(length))}


def _mechanism(maps: xr.Dataset) -> dict[str, Any] | None:
    """Return what moves beside the picture, None of a map whose mechanism cannot be drawn."""
    name = str(maps.attrs.get("mechanism"))
    try:
        catalogue = _catalogue_of(maps)
        picture = picture_of(name, catalogue)
    except InputError:
        return None
    known = catalogue.known_inputs(catalogue.variant_inputs)
    inputs = {one: float(np.ravel(maps[one].values[..., None])[0]) for one in known if one in maps.variables}
    degrees = [one for one in inputs if maps[one].attrs.get("units") in DEGREES]
    design = dict(inputs)
    links = taken_links(design)
    variants = selected_variants(catalogue, links, "eliminated", design)
    constants = {
        one: value for one, value in constants_of(catalogue, links, variants).items() if one not in inputs
    }
    motion = Motion(name, catalogue, picture, design, tuple(catalogue.branches), links)
    points = [one for one in motion.points if one.kind != "mark"]
    needed = [value for one in points for value in (one.x, one.y)]
    needed += [end for ends in picture.spans.values() for end in ends]
    needed += [bar.orientation for bar in picture.bars if bar.orientation]
    curves = [one for one in _curves(maps, catalogue) if motion.has(one)]
    facts = [one for one in [*needed, *curves] if isinstance(one, str) and one in catalogue.facts]
    script, found = script_of(catalogue, facts, [*inputs, *constants], variants)
    if not {value for one in points for value in (one.x, one.y) if value in catalogue.facts} <= set(found):
        return None
    position = catalogue.position
    return {
        "name": name,
        "title": catalogue.title,
        "script": script,
        "inputs": list(inputs),
        "degrees": degrees,
        "constants": constants,
        "branches": {str(branch): meaning for branch, meaning in catalogue.branches.items()},
        "position": {"name": position.name, "symbol": position.symbol, "units": position.units,
                     "meaning": position.meaning},
        "turns": motion.turns,
        "study": {
            "links": [] if links is None else list(links.values),
            "model": "" if links is None else links.model,
            "count": int(maps.attrs.get(f"{catalogue.position.name}_count", 0)),
            "extrema": str(maps.attrs.get("extrema", "")),
            "input": "" if catalogue is find_catalogue(name) else catalogue.position.name,
        },
        "curves": [_curve(catalogue, one) for one in curves if one in found],
        **_shape(picture, points),
    }  # fmt: skip


def _curves(maps: xr.Dataset, catalogue: Catalogue) -> list[str]:
    """Return the quantities that change over the input: first those that the map has results of."""
    own = [innermost(str(name), catalogue) for name in maps.data_vars if str(name) not in (BRANCH,)]
    return [
        one
        for one in dict.fromkeys([*own, *catalogue.public])
        if one in catalogue.public and catalogue.varies(one) and not catalogue.public[one].flags
    ]


def _curve(catalogue: Catalogue, name: str) -> dict[str, Any]:
    fact = catalogue.public_fact(name)
    return {"name": name, "meaning": fact.meaning, "symbol": fact.symbol, "units": fact.units}


def _shape(picture: Picture, points: list[Any]) -> dict[str, Any]:
    """Return the points and bars of a picture."""
    names = {one.name for one in points}
    return {
        "metric": picture.metric,
        "spans": {key: list(ends) for key, ends in picture.spans.items()},
        "points": [
            {"name": one.name, "x": one.x, "y": one.y, "kind": one.kind, "named": one.is_named, "group": one.group}
            for one in points
        ],
        "bars": [
            {"points": [one for one in bar.points.split() if one in names], "ground": bar.is_ground,
             "orientation": bar.orientation}
            for bar in picture.bars
        ],
        "guides": [{"x": one.x, "y": one.y, "slider": one.slider} for one in picture.guides if one.slider],
        "traced": [one for names in picture.traced.values() for one in names.split()],
    }  # fmt: skip
