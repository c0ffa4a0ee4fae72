"""Do forces have their extremes where rates have theirs? The hypothesis of Hayes, Hninn and Irani, measured."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from fastlink._text import short_repr
from fastlink.doors import door
from fastlink.engine.evaluate import evaluate
from fastlink.engine.sweep import sweep
from fastlink.errors import InputError, Problems
from fastlink.facts.names import Quantity, Reduced
from fastlink.io.reader import as_map
from fastlink.maps.units import check_units
from fastlink.mechanisms.planar_4r import planar_4r
from fastlink.space.design_space import DesignSpace
from fastlink.space.links import Links

__all__ = ["force_hypothesis"]

WHERE = ("force_hypothesis", "maps")
GIVE_ALL = "give the whole result of the sweep"
THETA1 = planar_4r.position.name
ENDS = ("max", "min")
#: What designs are swept with.
LOADS, RATES = ("shaking_force", "shaking_moment", "F41", "F43"), ("omega4", "alpha4")
#: Configurations that are evaluated at once, each of which takes some hundred doubles.
BLOCK = 50_000


@door
def force_hypothesis(maps: Any, **options: Any) -> xr.Dataset:
    """Compare the greatest forces of a planar 4R with those where its rates are extreme.

    Hayes, Hninn and Irani propose that shaking force and moment are greatest in the configurations where the
    angular velocity and acceleration of the output are extreme, and that ground forces can be estimated there.

    Parameters
    ----------
    maps : xarray.Dataset or path
        A sweep of ``"planar_4r"``, or its file, with ``theta1_at_NAME_max`` and ``theta1_at_NAME_min`` of one or more
        rates (such as ``omega4``, ``alpha4``), and the same with ``NAME_max`` and ``NAME_min`` of one or more forces
        or moments (such as ``shaking_force``, ``shaking_moment``, ``F41``). Designs instead, as a design space or a
        mapping, are swept first, with all of these.
    **options
        Of designs, the options of `fastlink.sweep`, such as ``links``.

    Returns
    -------
    xarray.Dataset
        For each design and assembly mode, each `load` and each `extreme` of a rate (such as ``"omega4_max"``):
        ``distance``, the angle of the input between the greatest magnitude of the load and the extreme, 0 to pi [rad];
        ``ratio``, the magnitude of the load at the extreme over the greatest: how good an estimate it is. NaN where the
        design does not assemble, and where a load grows without bound at a toggle.

    Raises
    ------
    InputError
        Not a map of the planar 4R driven by theta1, or names are missing or not in SI units; options of a map.

    Examples
    --------
    The example of the paper: its shaking force is greatest 2.2 degrees from the greatest angular acceleration, but 27
    degrees from the greatest angular velocity.

    >>> import numpy as np
    >>> import fastlink as fl
    >>> paper, bars = dict(a1=0.4, a2=1.2, a3=0.8, a4=1.0, omega1=25.0), fl.round_bar(density=7750.0, radius=0.01)
    >>> found = fl.planar.force_hypothesis(paper, links=bars, branch=2).sel(load="shaking_force").squeeze()
    >>> np.degrees(found.distance).round(1).to_series().to_dict()
    {'omega4_max': 89.2, 'omega4_min': 27.4, 'alpha4_max': 2.2, 'alpha4_min': 54.3}
    >>> float(found.ratio.sel(extreme="alpha4_max").round(3))
    0.995
    """
    if isinstance(maps, (DesignSpace, Mapping)) and not isinstance(maps, xr.Dataset):
        of_all = [each for name in (*LOADS, *RATES) for each in _named(name)]
        maps, options = sweep(planar_4r.name, maps, of_all, **options), {}
    if options:
        where, remedy = (
            ("force_hypothesis", next(iter(options))),
            "leave it out, or give designs instead of a map",
        )
        raise InputError("is an option of the sweep that made the map", where=where, remedy=remedy)
    with as_map(maps) as dataset:
        loads, extremes = _loads_and_extremes(dataset)
        inputs = {str(name): dataset[name] for name in dataset.variables if name in _known_inputs()}
        inputs["branch"] = dataset["branch"]
        read = {name: dataset[name] for load in loads for name in _named(load)}
        read |= {place: dataset[place] for place in (_place(*extreme) for extreme in extremes)}
        arrays = dict(zip([*read, *inputs], xr.broadcast(*read.values(), *inputs.values()), strict=True))
        template = arrays[_place(*extremes[0])]
        flat = {name: array.values.ravel() for name, array in arrays.items()}
    shape = (len(loads), len(extremes), template.size)
    distance, ratio = np.full(shape, np.nan), np.full(shape, np.nan)
    bounded = np.all([np.isfinite(flat[name]) for name in read], axis=0)  # the others are not evaluated
    flat = {name: values[bounded] for name, values in flat.items()}
    greatest = [_greatest(load, flat) for load in loads]
    for k, extreme in enumerate(extremes):
        place = flat[_place(*extreme)]
        there = _magnitudes(loads, {name: flat[name] for name in inputs}, place)
        for i, (size, at) in enumerate(greatest):
            distance[i, k, bounded] = _turn_between(at, place)
            with np.errstate(all="ignore"):  # a load that vanishes everywhere
                ratio[i, k, bounded] = there[i] / size
    return _labelled(template, loads, [_extreme(*extreme) for extreme in extremes], distance, ratio)


def _extreme(name: str, end: str) -> str:
    """Return the name of the greatest or least value of a quantity."""
    return str(Reduced(Quantity(name), end))


def _place(name: str, end: str) -> str:
    """Return the name of the position of an extreme."""
    return str(Reduced(Quantity(name), end, THETA1))


def _named(load: str) -> list[str]:
    """Return what is read of a load: its extremes and their places."""
    return [name for end in ENDS for name in (_extreme(load, end), _place(load, end))]


def _known_inputs() -> Mapping[str, Any]:
    """Return all inputs of the planar 4R, those of loads and links among them."""
    return planar_4r.known_inputs(planar_4r.variant_inputs)


def _loads_and_extremes(dataset: xr.Dataset) -> tuple[list[str], list[tuple[str, str]]]:
    """Return the loads of a map, and the extremes of its rates as name and end, or refuse the map."""
    mechanism, position = dataset.attrs.get("mechanism"), dataset.attrs.get("input")
    if (mechanism, position) != (planar_4r.name, THETA1):
        what = f"is of {short_repr(mechanism)} by {short_repr(position)}"
        raise InputError(what, where=WHERE, remedy=f"sweep {planar_4r.name!r} by {THETA1}")
    trees = (planar_4r.parse(str(name)) for name in dataset.data_vars)
    placed = dict.fromkeys(str(tree.of) for tree in trees if isinstance(tree, Reduced) and tree.position)
    units = {name: planar_4r.public_fact(name).units for name in placed}
    loads, rates = ([name for name in units if (units[name] in ("N", "N m")) is of] for of in (True, False))
    problems = Problems()
    for kind, names, example in (("forces", loads, "shaking_force"), ("rates", rates, "omega4")):
        if not names:
            what = f"has no extremes of {kind} with their places"
            names_of = f"{_extreme(example, 'max')!r}, {_place(example, 'max')!r}"
            problems.add(what, WHERE, f"sweep {names_of} and those of its minimum")
    needed = {_place(name, end): "rad" for name in units for end in ENDS}
    needed |= {_extreme(load, end): units[load] for load in loads for end in ENDS}
    for name, unit in needed.items():
        if name not in dataset:
            problems.add(f"{name!r} is missing", WHERE, f"sweep {name!r} too, and {GIVE_ALL}")
            continue
        with problems.at():
            check_units(dataset[name], unit, (*WHERE, name))
    problems.stop()
    return loads, [(rate, end) for rate in rates for end in ENDS]


def _greatest(load: str, values: Mapping[str, Any]) -> tuple[Any, Any]:
    """Return the greatest magnitude of a load, and the position where it is."""
    high, low = (abs(values[_extreme(load, end)]) for end in ENDS)
    at_high, at_low = (values[_place(load, end)] for end in ENDS)
    return np.maximum(high, low), np.where(high >= low, at_high, at_low)


def _magnitudes(loads: Sequence[str], design: Mapping[str, Any], theta1: Any) -> Any:
    """Return the magnitudes of loads at a position of each design."""
    links = Links("round_bar", {}) if "density" in design or "radius" in design else None
    found = np.full((len(loads), theta1.size), np.nan)
    for start in range(0, theta1.size, BLOCK):
        part = slice(start, start + BLOCK)
        inputs = {name: values[part] for name, values in design.items()}
        at = evaluate(planar_4r.name, loads, links=links, allow_invalid=True, theta1=theta1[part], **inputs)
        for i, load in enumerate(loads):
            found[i, part] = abs(at[load])
    return found


def _turn_between(first: Any, second: Any) -> Any:
    """Return the angle between two directions, 0 to pi."""
    turn = abs(first - second) % (2.0 * np.pi)
    return np.minimum(turn, 2.0 * np.pi - turn)


def _labelled(template: Any, loads: list[str], extremes: list[str], distance: Any, ratio: Any) -> xr.Dataset:
    """Return the comparison with the coordinates of the map."""
    dims = (*template.dims, "load", "extreme")
    labels = {
        "distance": ("rad", "Angle of the input between the greatest magnitude of the load and the extreme"),
        "ratio": ("1", "Magnitude of the load at the extreme over the greatest"),
    }
    values = {"distance": distance, "ratio": ratio}
    variables = {
        name: (
            dims,
            np.moveaxis(values[name].reshape(*values[name].shape[:2], *template.shape), (0, 1), (-2, -1)),
            {"units": units, "long_name": meaning},
        )
        for name, (units, meaning) in labels.items()
    }
    return xr.Dataset(variables, {**template.coords, "load": loads, "extreme": extremes})
