"""Search a design space without a map: sweep it block by block, keep the best, refine them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from inspect import signature
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fastlink.catalogue.declare import ELIMINATED
from fastlink.doors import door
from fastlink.engine.executor import default_threads
from fastlink.engine.options import check_options
from fastlink.engine.resolve import resolve
from fastlink.errors import InputError, Pair, Problems
from fastlink.io.finished import finished_map
from fastlink.io.writing.target import check_left, check_target
from fastlink.maps import open as open_map
from fastlink.maps.best import listed
from fastlink.mechanisms import catalogue as find_catalogue
from fastlink.plan.query import check_names, parse_request
from fastlink.searching.best import inputs_to_refine
from fastlink.searching.result import Request, write
from fastlink.searching.run import found_by
from fastlink.space.dataset import STATUS
from fastlink.space.degrees import angle_of
from fastlink.space.design_space import BRANCH

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import ArrayLike

    from fastlink.catalogue.catalogue import Catalogue
    from fastlink.engine.extending import Extension
    from fastlink.space.design_space import DesignSpace
    from fastlink.space.links import Links

__all__ = ["request_of", "search"]


@door
def search(
    mechanism: str | Extension,
    space: DesignSpace | Mapping[str, Any] | str | Path | Any,
    quantities: Sequence[str] = (),
    *,
    minimise: str | Sequence[str] = (),
    maximise: str | Sequence[str] = (),
    where: Any = None,
    top: int | None = None,
    infinite: bool = False,
    refine: bool | Sequence[str] = True,
    bounds: Mapping[str, tuple[float, float]] | None = None,
    links: Links | None = None,
    input: str | None = None,
    angles: int | ArrayLike | None = None,
    branch: int | Sequence[int] = 1,
    solver: str = ELIMINATED,
    extrema: str | None = None,
    verify: int | None = None,
    to: str | Path | None = None,
    overwrite: bool = False,
    restart: bool = False,
    threads: int | None = None,
    progress: bool | None = None,
    attrs: Mapping[str, Any] | None = None,
    block: int | None = None,
    backend: str | None = None,
    **positions: int | ArrayLike | None,
) -> xr.Dataset:
    """Search a design space for its best designs, without a map of all, and refine them.

    The designs are swept block by block; the best few, or those of the Pareto front, are kept, and nothing else: memory
    does not grow with their number, a sample of 10^9 designs needs no file. Those that were found are refined as by
    `fastlink.best`.

    Parameters
    ----------
    mechanism, space, links, input, angles, solver, extrema, threads, progress, attrs, block, backend, **positions
        As in `fastlink.sweep`; for a search, `space` is mostly a sample, such as ``fastlink.sobol(10**7, ...)``.
    quantities : sequence of str
        What else to compute of the designs that are found; objectives and conditions come along.
    minimise, maximise, where, top, infinite
        As in `fastlink.best`, by names of quantities and inputs; conditions by name, not as a mask.
    refine : bool or sequence of str, default True
        As in `fastlink.best`.
    bounds : mapping, optional
        For inputs that are swept the least and greatest value of refined designs; by default those of the space.
    branch : int or sequence of int, default 1
        The assembly mode, or several, in each of which a design is a row of its own.
    verify : int, optional
        How many of the designs that are found are computed again with 50 digits, as in `fastlink.sweep`.
    to : path, optional
        The HDF5 file to write. A file that is there already and holds the result of this search is opened as it is.
    overwrite : bool
        Search anew and replace an existing file.
    restart : bool
        Throw away what a killed search has left in ``FILE.search``. Without it, the same search goes on there, to the
        same bits, and another one is refused.

    Returns
    -------
    xarray.Dataset
        The designs that were found as a map of their own, along ``design``, the best of the first objective first; the
        label ``design`` is the number of the start in the space. Their attributes say what was searched, how many
        designs, how many rows each condition excludes and how many there were of each status.

    Raises
    ------
    InputError
        Bad input; or no design meets the conditions, with the numbers that each excludes.

    Examples
    --------
    >>> import fastlink as fl
    >>> space = fl.sobol(4096, a1=(0.1, 0.5), a2=(0.8, 1.3), a3=(0.5, 1.2), a4=1.0, omega1=1.0)
    >>> where = {"status": "rotates_fully", "transmission_angle_min_deg": (40, None), "swing_deg": (60, None)}
    >>> found = fl.search("planar_4r", space, minimise="omega4_max", where=where, top=2)
    >>> found.omega4_max.values.round(4), found.active.values[0].item()
    (array([0.473]), 'transmission_angle_min >= 0.698132 rad, swing >= 1.0472 rad')
    >>> found.attrs["searched_designs"], found.attrs["excluded_by_swing"] > 1000
    (4096, True)
    """
    problems, checked = Problems(), dict[str, Any]()
    with problems.at():
        given: dict[str, Any] = {"verify": verify, "to": to, "threads": threads, "overwrite": overwrite}
        given |= {"restart": restart, "progress": progress, "attrs": attrs, "block": block}
        checked = check_options(given)
    asked: dict[str, Any] = {"minimise": minimise, "maximise": maximise, "where": where, "top": top}
    asked |= {"infinite": infinite, "refine": refine, "bounds": bounds}
    of_sweep: dict[str, Any] = {"links": links, "input": input, "angles": angles, "positions": positions}
    of_sweep |= {"branch": branch, "solver": solver, "extrema": extrema, "backend": backend}
    with problems.at():
        request = request_of(mechanism, space, quantities, asked, **of_sweep, options=_OPTIONS)
    problems.stop()
    request.options["threads"], request.attrs = checked["threads"], checked["attrs"] or {}
    target, run = checked["to"], dict[str, Any](threads=checked["threads"] or default_threads())
    run |= {name: checked[name] for name in ("block", "progress", "verify")}
    if target is None:
        return found_by(request, **run)
    if not overwrite:
        finished = finished_map(target, request.fingerprint, verified=0, attrs=request.about())
        if finished is not None:
            return finished
    path = check_target(target, 0, overwrite)
    if not restart:
        check_left(path, request.fingerprint)
    found = found_by(request, path=path, restart=restart, **run)
    write(path, request, found, overwrite=overwrite, restart=restart)
    return open_map(path)


#: The keywords of a search besides the name of the input.
_OPTIONS = tuple(name for name in signature(search).parameters if name != "positions")


def request_of(
    mechanism: Any, space: Any, quantities: Any, asked: Mapping[str, Any], **of_sweep: Any
) -> Request:
    """Return the request of a search, or refuse it with all its problems; nothing is compiled.

    Parameters
    ----------
    mechanism, space, quantities
        As in `search`.
    asked : mapping
        Objectives, conditions, and how designs are refined, as `search` takes them.
    **of_sweep
        Options of `fastlink.engine.resolve.resolve`.
    """
    problems, only = Problems(), None
    with problems.at():
        only = inputs_to_refine(asked["refine"])
    names = _searched(find_catalogue(mechanism, of_sweep["input"]), asked, problems)
    bounds = _ranges(asked["bounds"], problems)
    resolved, others = None, list[str]()
    with problems.at():
        others = [] if _is_nothing(quantities) else list(check_names("quantities", quantities))
        resolve(mechanism, space, [*others, *(n for n in names if n not in others)] or [STATUS], **of_sweep)
        resolved = resolve(mechanism, space, names or [STATUS], **of_sweep)
    problems.stop()
    assert resolved is not None
    wanted = tuple(dict.fromkeys([*others, *names]))
    request = Request.of(mechanism, resolved, of_sweep, quantities=wanted, only=only, bounds=bounds)
    choice = {name: asked[name] for name in ("minimise", "maximise", "where", "top", "infinite")}
    request.choose(**choice)
    return request


def _is_nothing(names: Any) -> bool:
    return isinstance(names, (list, tuple)) and not names


def _searched(catalogue: Catalogue, asked: Mapping[str, Any], problems: Problems) -> list[str]:
    """Return the quantities that objectives and conditions name; what is unknown is noted, other values are not."""
    aims = [(key, name) for key in ("minimise", "maximise") for name in listed(asked[key])]
    where = asked["where"]
    wanted = where if isinstance(where, Mapping) and not hasattr(where, "data_vars") else {}
    inputs = {*catalogue.known_inputs(catalogue.variant_inputs), catalogue.position.name, BRANCH, STATUS}
    found: dict[str, None] = {}
    for key, name in [*aims, *(("where", name) for name in wanted)]:
        if not isinstance(name, str) or name in inputs:
            continue
        with problems.at(key):
            try:
                parse_request(name, catalogue)
            except InputError:
                angle = angle_of(name) if key == "where" else ""
                if angle in inputs:
                    continue
                parse_request(angle or name, catalogue)
                name = angle
            found[name] = None
    return list(found)


def _ranges(bounds: Any, problems: Problems) -> dict[str, tuple[float, float]]:
    """Return the ranges of refined designs; what is none is noted."""
    found: dict[str, tuple[float, float]] = {}
    if bounds is None:
        return found
    remedy = "write such as {'a1': (0.2, 0.5)}"
    if not isinstance(bounds, Mapping):
        problems.add("is not a mapping", ("bounds",), remedy)
        return found
    for name, ends in bounds.items():
        try:
            low, high = map(float, ends)
            right = -float("inf") < low < high < float("inf")
        except (TypeError, ValueError, OverflowError):
            right = False
        if right:
            found[str(name)] = low, high
        else:
            problems.add("is not a range", ("bounds", str(name)), ("write ", Pair(), " with finite lo < hi"))
    return found
