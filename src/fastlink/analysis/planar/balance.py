"""Balance the shaking force of the four-bar by counterweights (Berkof and Lowen).

With complex numbers in the links' frames, g_i the mass centres and e_i the links' directions, the moment of mass

    m1 g1 e1 + m2 (a1 e1 + g2 e2) + m3 (a4 + g3 e3),    a2 e2 = a4 + a3 e3 - a1 e1

is constant, and its second derivative, the shaking force, zero, if the coefficients of e1 and e3 vanish.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink.analysis.designs import BY_NAME, read_design
from fastlink.catalogue.catalogue import Input
from fastlink.catalogue.declare import ELIMINATED
from fastlink.catalogue.evaluate import read_facts
from fastlink.doors import door
from fastlink.errors import InputError, Problems
from fastlink.mechanisms.planar_4r import planar_4r
from fastlink.plan.validate import check_model, constants_of, selected_variants

if TYPE_CHECKING:
    from fastlink.space.links import Links

__all__ = ["force_balance"]

NEEDED = ("a1", "a2", "a3", "m1", "G1_u", "G1_v", "m2", "G2_u", "G2_v", "m3", "G3_u", "G3_v")


@door(hint=BY_NAME)
def force_balance(
    design: Any = None,
    *,
    links: Links | None = None,
    radius1: Any = None,
    mass1: Any = None,
    radius3: Any = None,
    mass3: Any = None,
    **inputs: Any,
) -> dict[str, Any]:
    """Return the counterweights that make the shaking force of a planar 4R zero.

    The crank's product of mass and radius is |m1 g1 + m2 a1 (1 - g2/a2)|, the output link's |m3 g3 + m2 a3 g2/a2|
    (Berkof and Lowen, 1969). Either the radius or the mass of each is free.

    Parameters
    ----------
    design : mapping, pandas.DataFrame or xarray.Dataset, optional
        The inputs of ``planar_4r`` by name: lengths, masses and mass centres, broadcast. Other inputs are not read.
    links : Links, optional
        The source of mass data that the design does not give.
    radius1, mass1 : float or array_like, optional
        Radius in m or mass in kg of the counterweight on the crank, one of them; a1 is the radius unless given.
    radius3, mass3 : float or array_like, optional
        The same of the counterweight on the output link; a3 is the radius unless given.
    **inputs : float, array_like or xarray.DataArray
        Inputs by name, as in the design.

    Returns
    -------
    dict
        The inputs ``counterweight1_mass``, ``counterweight1_radius``, ``counterweight1_direction`` and the same of
        ``counterweight3``: add them to the design.

    Raises
    ------
    InputError
        An input is missing, is not a number or has another shape; a radius and a mass are given for one link; a
        radius or mass is not positive.

    Examples
    --------
    >>> import fastlink as fl
    >>> design = dict(a1=0.4, a2=1.2, a3=0.8, a4=1.0, omega1=25.0)
    >>> bars = fl.round_bar(density=7750.0, radius=0.01)
    >>> weights = fl.planar.force_balance(design, links=bars, radius1=0.1, radius3=0.2)
    >>> round(float(weights["counterweight1_mass"]), 3)
    7.791
    >>> found = fl.evaluate("planar_4r", ["shaking_force"], **design, **weights, links=bars, theta1=1.0)
    >>> bool(found["shaking_force"] < 1e-10)
    True
    """
    check_model(planar_4r, links, ELIMINATED)
    variants = selected_variants(planar_4r, links, ELIMINATED, ())
    needed = [name for name in NEEDED if planar_4r.resolve(name, variants) is None]
    given = read_design(
        "force_balance",
        planar_4r,
        design,
        inputs,
        needed,
        optional=[*set(NEEDED).difference(needed), *planar_4r.variant_inputs["round_bar"]],
        further=[*_chosen(1, radius1, mass1), *_chosen(3, radius3, mass3)],
    )
    with np.errstate(over="ignore", invalid="ignore"):  # of masses beyond 1e200, which are refused
        facts = read_facts(planar_4r, NEEDED, constants_of(planar_4r, links, variants) | given, variants)
        g1, g2, g3 = (np.asarray(facts[f"G{i}_u"]) + 1j * np.asarray(facts[f"G{i}_v"]) for i in (1, 2, 3))
        share = g2 / facts["a2"]
        crank = -(facts["m1"] * g1 + facts["m2"] * facts["a1"] * (1.0 - share))
        output = -(facts["m3"] * g3 + facts["m2"] * facts["a3"] * share)
        weights = _counterweight(1, crank, given, facts["a1"]) | _counterweight(3, output, given, facts["a3"])
    problems = Problems()
    for name, values in weights.items():
        if not np.all(np.isfinite(values)):
            problems.add(
                f"{name} is not finite", ("force_balance",), "write masses and a radius of usual sizes"
            )
    problems.stop()
    return weights


def _chosen(link: int, radius: Any, mass: Any) -> list[tuple[Input, Any]]:
    """Return what is chosen of a counterweight: its radius, its mass or neither."""
    if radius is not None and mass is not None:
        what, where = f"mass{link} is given too", ("force_balance", f"radius{link}")
        raise InputError(what, where=where, remedy="write one of them, the other follows")
    name, units, value = ("mass", "kg", mass) if mass is not None else ("radius", "m", radius)
    meaning = f"{name} of the counterweight of link {link}"
    return [] if value is None else [(Input(f"{name}{link}", units, name, meaning, "positive"), value)]


def _counterweight(link: int, product: Any, given: Mapping[str, Any], length: Any) -> dict[str, Any]:
    """Return the inputs of a counterweight of a given complex mass times radius."""
    mass = given.get(f"mass{link}")
    chosen = given.get(f"radius{link}", length) if mass is None else mass
    other = np.abs(product) / chosen
    values = {
        "mass": other if mass is None else chosen,
        "radius": chosen if mass is None else other,
        "direction": np.angle(product),
    }
    arrays = dict(zip(values, np.broadcast_arrays(*values.values()), strict=True))
    return {f"counterweight{link}_{key}": value[()] for key, value in arrays.items()}
