"""The 9x9 system of the joint forces as it is printed, and the bars of which its masses are."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from fastlink.analysis.designs import BY_NAME, all_entries, read_design
from fastlink.catalogue.declare import ELIMINATED
from fastlink.catalogue.evaluate import read_facts, stack_rows
from fastlink.doors import door
from fastlink.engine.evaluate import evaluate
from fastlink.errors import InputError, KeyPath, Piece, Problems, Setting, Wording
from fastlink.mechanisms._shared.round_bars import ROUND_BAR, bar_volume
from fastlink.mechanisms.planar_4r import planar_4r
from fastlink.mechanisms.planar_4r.centres import EQUATION_9
from fastlink.mechanisms.planar_4r.dense import RIGHT_SIDE, UNKNOWNS, reactions
from fastlink.mechanisms.planar_4r.inputs import LINKS
from fastlink.plan.validate import check_model, constants_of
from fastlink.space.links import Links

__all__ = ["bar_properties", "force_equations"]

#: The system, with the names on which its rows depend.
SYSTEM = planar_4r.variants["dense"][UNKNOWNS[0]]
BARS = [f"{name.format(i)}" for i in LINKS for name in ("m{}", "I{}", "G{}_u", "G{}_v")]


class _Wording(Wording):
    """The wording of what `evaluate` refuses, for callers of `force_equations`, who have no such option."""

    def path(self, where: KeyPath) -> str:
        """Return a path that begins with the function that was called."""
        return super().path(("force_equations", *where[1:]) if where[:1] == ("evaluate",) else where)

    def piece(self, piece: Piece) -> str | None:
        """Return a piece of a remedy, or None where it names an option of `evaluate` alone."""
        return None if isinstance(piece, Setting) else super().piece(piece)


@door(hint=BY_NAME)
def force_equations(
    design: Any = None, *, branch: Any = 1, links: Links | None = None, **inputs: Any
) -> xr.Dataset:
    """Return matrix A and vector b of eq. (9) of Hayes: the joint forces are A^-1 b.

    Parameters
    ----------
    design : mapping, pandas.DataFrame or xarray.Dataset, optional
        Inputs of ``planar_4r`` by name, as in `fastlink.evaluate`: lengths, speed, masses, loads.
    branch : int or array_like
        Assembly mode.
    links : Links, optional
        The source of mass data that the design does not give.
    **inputs : float, array_like or xarray.DataArray
        The same by name, and the input angle ``theta1``.

    Returns
    -------
    xarray.Dataset
        ``A``, along the dimensions of the inputs, `equation` and `unknown`, and ``b``, along those and `equation`.
        An unknown is called as the quantity that it is, an equation as the quantity on its right-hand side: the forces
        and the moment about its mass centre of link 1, 2 and 3. With loads, b is less the loads. NaN where the loop
        does not close.

    Raises
    ------
    InputError
        What `fastlink.evaluate` would refuse.

    Examples
    --------
    >>> import numpy as np
    >>> import fastlink as fl
    >>> design = dict(a1=0.4, a2=1.2, a3=0.8, a4=1.0, omega1=25.0, theta1=1.0, links=fl.round_bar(7750.0, 0.01))
    >>> equations = fl.planar.force_equations(**design)
    >>> forces = np.linalg.solve(equations.A, equations.b)
    >>> T41 = fl.evaluate("planar_4r", ["T41"], **design)["T41"]
    >>> bool(np.isclose(forces[-1], T41)), str(equations.unknown.values[-1])
    (True, 'T41')
    """
    problems = Problems()
    known = (*planar_4r.known_inputs(planar_4r.variant_inputs), planar_4r.position.name)
    given = all_entries("force_equations", design, inputs, known, problems)
    problems.stop()
    try:
        found = evaluate(planar_4r.name, SYSTEM.depends_on, branch=branch, links=links, **given)
    except InputError as error:
        raise InputError.of(error.problems, _Wording()) from None
    first = next(iter(found.values()))
    template = first if isinstance(first, xr.DataArray) else xr.DataArray(np.asarray(first))
    system = stack_rows(reactions(*(np.asarray(found[name]) for name in SYSTEM.depends_on)))
    dims = (*template.dims, "equation")
    labels = {"references": EQUATION_9}
    return xr.Dataset(
        {
            "A": (
                (*dims, "unknown"),
                system[..., :-1],
                {**labels, "long_name": "Matrix of the joint forces"},
            ),
            "b": (dims, system[..., -1], {**labels, "long_name": "Inertia forces and moments"}),
        },
        {**template.coords, "equation": list(RIGHT_SIDE), "unknown": list(UNKNOWNS)},
    )


@door(hint=BY_NAME)
def bar_properties(design: Any = None, *, links: Links, **inputs: Any) -> dict[str, Any]:
    """Return volumes, masses, moments of inertia and mass centres of links that are round bars.

    Parameters
    ----------
    design : mapping, pandas.DataFrame or xarray.Dataset, optional
        The lengths ``a1``, ``a2``, ``a3`` of ``planar_4r`` by name, broadcast. Other inputs are not read.
    links : Links
        The bars, `fastlink.round_bar`.
    **inputs : float, array_like or xarray.DataArray
        The same by name.

    Returns
    -------
    dict
        ``volume1`` [m3], and the inputs ``m1`` [kg], ``I1`` [kg m2], ``G1_u`` and ``G1_v`` [m] of the crank; the same
        of coupler (2) and output link (3). These inputs may stand in a design in place of `links`.

    Raises
    ------
    InputError
        A length, or density or radius of the bars, is missing or not positive and finite.

    Examples
    --------
    Table 1 of Hayes, where the volumes are pi/25000, 3 pi/25000 and pi/12500:

    >>> import fastlink as fl
    >>> bars = fl.planar.bar_properties(a1=0.4, a2=1.2, a3=0.8, links=fl.round_bar(7750.0, 0.01))
    >>> round(float(bars["volume1"]), 9), round(float(bars["m1"]), 6)
    (0.000125664, 0.973894)
    """
    check_model(planar_4r, links, ELIMINATED)
    needed = [f"a{i}" for i in LINKS]
    if not isinstance(links, Links):
        raise InputError(
            "is missing",
            where=("bar_properties", "links"),
            remedy="write fl.round_bar(density=..., radius=...)",
        )
    needed += [name for name in planar_4r.variant_inputs[ROUND_BAR] if name not in links.values]
    given = read_design("bar_properties", planar_4r, design, inputs, needed)
    values = constants_of(planar_4r, links, (ROUND_BAR,)) | given
    with np.errstate(all="ignore"):  # of bars beyond the range of doubles
        facts = read_facts(planar_4r, BARS, values, (ROUND_BAR,))
        volumes = {f"volume{i}": bar_volume(values[f"a{i}"], values["radius"]) for i in LINKS}
    return {
        name: of[()] for name, of in {**volumes, **{name: np.asarray(facts[name]) for name in BARS}}.items()
    }
