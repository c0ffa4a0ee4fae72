"""Extremes of the rates of any pair of joints, by the names of the paper's input-output equations."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from fastlink._text import short_repr
from fastlink.doors import door
from fastlink.engine.sweep import sweep
from fastlink.errors import InputError, listed
from fastlink.facts.names import ListOfExtrema, Quantity
from fastlink.mechanisms.planar_4r.residuals import IO_PRODUCTS
from fastlink.space.design_space import DesignSpace
from fastlink.space.table import as_space

__all__ = ["rate_extrema"]

#: Input and output: the equation of a pair holds in both directions.
PAIRS = tuple(sorted([*IO_PRODUCTS, *(pair[::-1] for pair in IO_PRODUCTS)]))


@door
def rate_extrema(space: Any, *, pair: str = "14", **options: Any) -> Any:
    """Return all extremes of rate and acceleration of one joint over a turn of another.

    These are the algorithms of section 3 of Hayes for each of the six equations, with either joint as the input: joint
    angles of the closed polygon a1, a2, a3, a4, see docs/conventions.md. In the ground frame, `omega4_extrema` and
    `alpha4_extrema` of a sweep by theta1 are those of Table 2.

    Parameters
    ----------
    space : DesignSpace, mapping, DataFrame or others
        The designs, as in `fastlink.sweep`: the lengths ``a1`` ... ``a4`` and the constant rate of the first joint of
        the pair, such as ``joint_omega_1``, which may be called ``omega1``, too.
    pair : {"12", "13", "14", "21", "23", "24", "31", "32", "34", "41", "42", "43"}
        Input and output joint: eqs. (1) to (6) are those of 14, 12, 13, 23, 24 and 34.
    **options
        Options of `fastlink.sweep`, such as ``branch`` or ``to``.

    Returns
    -------
    xarray.Dataset
        The map of that sweep: of pair "14" ``joint_omega_4_extrema``, ``joint_alpha_4_extrema``, the places
        ``joint_angle_1_at_joint_omega_4_extrema`` and so on, their numbers and kinds, along `extremum`, for both
        assembly modes.

    Raises
    ------
    InputError
        There is no such pair, or what a sweep would refuse.

    Examples
    --------
    The example of the paper in mode 2, rates of joint 3 at B over a turn of joint 1 at O:

    >>> import fastlink as fl
    >>> design = dict(a1=0.4, a2=1.2, a3=0.8, a4=1.0, joint_omega_1=25.0)
    >>> found = fl.planar.rate_extrema(design, pair="13", branch=2)
    >>> found.joint_omega_3_extrema.squeeze().dropna("extremum").values.round(3).tolist()
    [-12.506, 12.506]
    """
    if not isinstance(pair, str) or pair not in PAIRS:
        where, remedy = ("rate_extrema", "pair"), listed(PAIRS)
        raise InputError(f"{short_repr(pair)} is unknown", where=where, remedy=remedy)
    i, j = pair[0], pair[1]
    names = [str(ListOfExtrema(Quantity(f"{rate}_{j}"))) for rate in ("joint_omega", "joint_alpha")]
    if i == "1" and getattr(space := _designs(space, options), "names", ()).count("omega1"):
        space = _renamed(space, {"omega1": "joint_omega_1"})
    return sweep("planar_4r", space, names, input=f"joint_angle_{i}", **options)


def _designs(source: Any, options: dict[str, Any]) -> Any:
    """Return the design space that something stands for, itself if the sweep has to refuse it."""
    try:
        return as_space(source, allow_invalid=bool(options.get("allow_invalid", False)))
    except InputError:
        return source


def _renamed(space: DesignSpace, names: dict[str, str]) -> DesignSpace:
    """Return a design space with other names of inputs."""
    by_name = ("constants", "axes", "columns", "units", "doubtful", "comments")
    renamed: dict[str, Any] = {
        part: {names.get(name, name): of for name, of in getattr(space, part).items()} for part in by_name
    }
    return replace(space, dims=tuple(names.get(name, name) for name in space.dims), **renamed)
