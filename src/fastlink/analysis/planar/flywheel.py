"""The flywheel that keeps the speed of a crank within bounds."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from fastlink.catalogue.catalogue import Input
from fastlink.doors import door
from fastlink.engine.broadcast import like
from fastlink.errors import InputError
from fastlink.io.reader import as_dataset
from fastlink.maps.units import check_units
from fastlink.plan.validate import value_problems
from fastlink.space.degrees import in_unit
from fastlink.space.values import MOST_DIMS, numbers_of

__all__ = ["flywheel_inertia"]


@door
def flywheel_inertia(maps: Any, C_s: Any) -> Any:
    """Return the moment of inertia for a given coefficient of speed fluctuation.

    The greatest swing of the energy, ``T41_fluctuation``, is to change the speed by C_s omega1 in all:
    I = T41_fluctuation/(C_s omega1^2), on the crank; omega of a slider-crank stands for omega1. The linkage's own
    inertia, which varies, is counted on neither side; the torque is that at constant speed.

    Parameters
    ----------
    maps : xarray.Dataset or path
        A sweep with ``T41_fluctuation`` and the speed of the crank, ``omega1`` or ``omega``, or its file; or any
        mapping with both names.
    C_s : float or array_like
        Coefficient of fluctuation: greatest less least speed over the mean speed, positive.

    Returns
    -------
    array or xarray.DataArray
        In kg m2, like ``T41_fluctuation``; NaN for an input that does not turn fully.

    Raises
    ------
    InputError
        Not a map or a path; a name is missing or not in SI units; or C_s is not positive and finite.

    Examples
    --------
    >>> import fastlink as fl
    >>> maps = fl.sweep(
    ...     "planar_4r",
    ...     fl.grid(a1=0.4, a2=1.2, a3=0.8, a4=1.0, omega1=25.0),
    ...     ["T41_fluctuation"],
    ...     links=fl.round_bar(density=7750.0, radius=0.01),
    ...     branch=1,
    ... )
    >>> round(float(fl.planar.flywheel_inertia(maps, C_s=0.02)), 2)
    26.34
    """
    bound = Input("C_s", "1", "C_s", "coefficient of speed fluctuation", "positive")
    path = ("flywheel_inertia", "C_s")
    numbers = in_unit(path, C_s, numbers_of(*path, C_s, MOST_DIMS), bound.units)
    if problems := value_problems(bound, numbers, "flywheel_inertia"):
        raise InputError.of(problems)
    if isinstance(maps, Mapping) and not hasattr(maps, "data_vars"):
        return _inertia(maps, like(C_s, numbers))
    with as_dataset(maps) as dataset:
        inertia = _inertia(dataset, like(C_s, numbers))
        inertia.attrs = {"units": "kg m2", "long_name": "Moment of inertia of the flywheel", "symbol": "I_S"}
        return inertia.rename("flywheel_inertia").load()


def _inertia(maps: Mapping[Any, Any], C_s: Any) -> Any:
    """Return the moment of inertia from the swing of the energy and the speed of the crank."""
    where = ("flywheel_inertia", "maps")
    crank_speed = "omega" if "omega" in maps else "omega1"
    units_of = {"T41_fluctuation": "N m", crank_speed: "rad s-1"}
    for name, units in units_of.items():
        if name not in maps:
            raise InputError(
                f"{name!r} is missing", where=where, remedy=f"sweep {name!r} and give the whole result"
            )
        check_units(maps[name], units, (*where, name))
    swing, speed = (
        like(maps[name], numbers_of(*where[:1], name, maps[name], MOST_DIMS)) for name in units_of
    )
    try:
        with np.errstate(
            all="ignore"
        ):  # a square of the speed may leave the range of doubles where the inertia does not
            return swing / speed / speed / C_s
    except ValueError as error:  # arrays of other shapes, or DataArrays of other coordinates
        remedy = "write one number, or one for each value of the maps"
        what = f"does not go with the maps ({error})"
        raise InputError(what, where=("flywheel_inertia", "C_s"), remedy=remedy) from None
