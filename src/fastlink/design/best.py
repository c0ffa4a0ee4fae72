"""Find the best designs of a map, and refine them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from fastlink.errors import Problems, check_switch, door
from fastlink.io.reader import as_dataset, as_map
from fastlink.maps.best import WIDEN, choice_of, chosen, remarked
from fastlink.plan.query import check_names

if TYPE_CHECKING:
    import xarray as xr

    from fastlink.engine.extend import Extension


@door(hint=lambda name: "write fl.convert(found, to=...)" if name == "to" else "")
def best(
    maps: Any,
    *,
    minimise: str | Sequence[str] = (),
    maximise: str | Sequence[str] = (),
    where: Any = None,
    top: int | None = None,
    infinite: bool = False,
    refine: bool | Sequence[str] = False,
    mechanism: Extension | None = None,
) -> xr.Dataset:
    """Find the best designs of a map: by one objective the first few, by several the Pareto front.

    The map is read block by block and may be larger than memory. The front is exact: all rows that no other row beats,
    that is, which no other equals or betters in every objective and betters in one.

    Parameters
    ----------
    maps : xarray.Dataset or path
        From `fastlink.sweep`, `fastlink.run` or `fastlink.open`, or the file of a map.
    minimise, maximise : str or sequence of str
        The objectives: variables, or inputs that are swept. A row is a place along all dimensions that these and the
        conditions have: a design, in a branch, and at one input position where they have them.
    where : mapping, str, list of str or xarray.DataArray, optional
        For variables and inputs their least and greatest value, None for no limit, such as
        ``{"transmission_angle_min": (0.6, None)}``, or in degrees ``{"transmission_angle_min_deg": (40, None)}``; the
        meanings of a code, such as ``{"status": "rotates_fully"}``,
        or ``"rotates_fully"`` alone; or a mask, such as ``maps.a1 < 0.5``.
    top : int, default 10
        How many rows, of one objective; of refined designs how many different ones at most. The front has as many as it
        has.
    infinite : bool, default False
        Consider infinite objectives too.
    refine : bool or sequence of str, default False
        Go on from these designs, off the grid of the map, by derivatives: within the ranges of its inputs and the
        conditions, changing all inputs that are swept or those that are named. Inputs of a table that lie on a line
        stay there. See docs/design_search.md.
    mechanism : Extension, optional
        To refine by quantities of one's own: what `fastlink.extend` returned, with which the map was made. What a map
        says of them is not run.

    Returns
    -------
    xarray.Dataset
        Along ``design``, the best of the first objective first, equal ones in the order of the map: all inputs, the
        branch, all results of that row. Of rows that are equal in all objectives a front has the first one.
        The attribute ``selection`` says how many rows were considered and left out. It can be swept again.
        Refined designs have their results anew, to the bits of a sweep, and besides what was gained of each objective
        (``NAME_gain``), how it ended (``refinement``, a code), which limits hold it back (``active``, a text), and how
        many starts ended there (``starts``): designs that are the same but for what a refinement leaves undone are told
        once, and the next different ones follow. A design that cannot be refined stays as it is, and the code says why.

    Raises
    ------
    InputError
        An objective or condition is unknown, or there is no objective; or what is to be refined is known for the
        designs of the map alone.

    Examples
    --------
    >>> space = fl.grid(a1=np.linspace(0.1, 0.5, 9), a2=np.linspace(0.9, 1.3, 9), a3=0.8, a4=1.0, omega1=25.0)
    >>> maps = fl.sweep("planar_4r", space, ["omega4_max", "transmission_angle_min"], branch=1)
    >>> found = fl.best(maps, minimise="omega4_max", where={"a1": (0.2, None), "status": "rotates_fully"}, top=1)
    >>> found.a1.values, found.a2.values, found.omega4_max.values.round(2)
    (array([0.2]), array([0.9]), array([6.3]))
    >>> finer = fl.best(maps, minimise="omega4_max", where={"a1": (0.23, None)}, top=1, refine=True)
    >>> finer.a1.values, finer.omega4_max.values.round(2), finer.active.values.tolist()
    (array([0.23]), array([7.22]), ['a1 >= 0.23 m, a2 >= 0.9 m'])
    >>> front = fl.best(maps, minimise="omega4_max", maximise=["a1", "transmission_angle_min"])
    >>> front.sizes["design"] < maps.omega4_max.size
    True
    """
    with as_dataset(maps) as dataset:
        problems = Problems()
        only = problems.attempt(inputs_to_refine, refine)
        if mechanism is not None and only is None:
            problems.add(
                "counts for a refinement alone", ("mechanism",), "write refine=True, or leave it out"
            )
        choice = problems.attempt(choice_of, dataset, minimise, maximise, where, top=top, infinite=infinite)
        problems.stop()
        if only is None:
            return remarked(chosen(choice).of(dataset), f"{WIDEN}, or refine, which leaves the grid")
        from fastlink.design.refine import Model, Refinement, candidates, spans_of

        with as_map(dataset) as own:
            model = Model.of_map(own, mechanism)
        spans = spans_of(model.catalogue, own, only)
        refinement = Refinement(own, model, spans, choice.objectives, choice.wanted)
        one = len(choice.objectives) == 1
        top = choice.top if one else None
        selected = chosen(choice.refined(candidates(choice.top)))
        others = [name for name in own.data_vars if name not in refinement.looked]
        starts = selected.of(own.drop_vars(others)).load()
        searched = math.prod(selected.rows.shape)
        refined = refinement.of(
            starts, searched=searched, top=top, whole=lambda k: selected.only(k).of(own).load()
        )
        return remarked(refined)


def inputs_to_refine(refine: Any) -> tuple[str, ...] | None:
    """Return the inputs that a refinement may change, none for all, or None for no refinement."""
    if isinstance(refine, (str, list, tuple)) and refine:
        return check_names("refine", [refine] if isinstance(refine, str) else refine)
    return () if check_switch(("refine",), refine) else None
