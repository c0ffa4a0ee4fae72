"""Search a design space without a map: sweep it block by block, keep the best, refine them."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from inspect import signature
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink.catalogue.declare import ELIMINATED
from fastlink.codegen.cache import environment
from fastlink.doors import door
from fastlink.engine.declared import check_declared, own_refused
from fastlink.engine.executor import default_threads
from fastlink.engine.options import check_options, check_workers
from fastlink.engine.resolve import resolve
from fastlink.errors import InputError, Pair, Problems
from fastlink.io.finished import finished_map
from fastlink.io.history import HISTORY, history
from fastlink.io.parts import PartOfMap, check_size
from fastlink.io.writing.target import check_left, check_target
from fastlink.maps import open as open_map
from fastlink.maps.best import listed
from fastlink.mechanisms import catalogue as find_catalogue
from fastlink.own.definition import declared_names
from fastlink.plan.query import check_names, parse_request
from fastlink.searching.best import inputs_to_refine
from fastlink.searching.result import SEARCH, Request, write
from fastlink.searching.run import found_by
from fastlink.searching.spans import Span
from fastlink.searching.stream import Kept
from fastlink.space.dataset import STATUS
from fastlink.space.degrees import angle_of
from fastlink.space.design_space import BRANCH
from fastlink.space.links import Links
from fastlink.space.samplers import table

if TYPE_CHECKING:
    import xarray as xr
    from distributed import Client
    from numpy.typing import ArrayLike

    from fastlink.catalogue.catalogue import Catalogue
    from fastlink.engine.extending import Extension
    from fastlink.io.part_files import PartFile
    from fastlink.space.design_space import DesignSpace

__all__ = ["request_of", "request_of_parts", "search", "to_file"]


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
    part: tuple[int, int] | str | None = None,
    threads: int | None = None,
    client: Client | None = None,
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
    mechanism, space, links, input, angles, solver, extrema, attrs, backend, **positions
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
    threads, client, progress, block
        As in `fastlink.sweep`.
    restart : bool
        Throw away what a killed search has left in ``FILE.search``. Without it, the same search goes on there, to the
        same bits, and another one is refused.
    part : (k, n) or "k/n", optional
        Search the k-th of n nearly equal ranges of consecutive designs alone. What it keeps is not refined; its file is
        a part, of which `fastlink.join` makes the result of the whole search (see docs/scaling.md).

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
        checked = check_options(given | {"part": part, "client": client})
    asked: dict[str, Any] = {"minimise": minimise, "maximise": maximise, "where": where, "top": top}
    asked |= {"infinite": infinite, "refine": refine, "bounds": bounds}
    of_sweep: dict[str, Any] = {"links": links, "input": input, "angles": angles, "positions": positions}
    of_sweep |= {"branch": branch, "solver": solver, "extrema": extrema, "backend": backend}
    with problems.at():
        request = request_of(mechanism, space, quantities, asked, **of_sweep, options=_OPTIONS)
        if checked.get("part") is not None:
            check_size(("part",), checked["part"], request.size)
    check_workers(client, threads, problems)
    problems.stop()
    request.options["threads"], request.attrs = checked["threads"], checked["attrs"] or {}
    of = None if part is None else PartOfMap(checked["part"], request.fingerprint, request.size)
    run: dict[str, Any] = {name: checked[name] for name in ("block", "progress", "verify")}
    run |= {"threads": checked["threads"] or default_threads(), "of": of}
    if client is not None:
        from fastlink.engine.distributed import Cluster  # 25 ms of imports, for clusters alone

        run |= {"cluster": Cluster(client), "threads": 1}
    if to is None:
        return found_by(request, **run)[0]
    run |= {"restart": restart}
    ways: dict[str, Any] = {"overwrite": overwrite, "restart": restart, "of": of}
    made = f"search {request.resolved.mechanism}"
    return to_file(
        checked["to"], request, lambda path: found_by(request, path=path, **run), made=made, **ways
    )


def to_file(
    to: Path,
    request: Request,
    found: Callable[[Path], tuple[xr.Dataset, xr.Dataset | None]],
    *,
    made: str,
    overwrite: bool,
    restart: bool,
    of: PartOfMap | None = None,
    parts: Sequence[PartFile] = (),
) -> xr.Dataset:
    """Write the result of a search, and open it; one that is there already is opened as it is.

    Parameters
    ----------
    to : Path
        The file.
    request : Request
        The search.
    found : callable
        Returns the designs that were found, for a file, and what it tells as a part to those that join it.
    made : str
        What made them, for the history of the file.
    overwrite, restart
        As in `search`.
    of : PartOfMap, optional
        Which part of the designs is searched.
    parts : sequence of PartFile
        The parts that are joined.
    """
    about, fingerprint = request.about(), request.fingerprint
    if of is not None:
        about, fingerprint = about | of.attrs(), of.fingerprint
    if not overwrite:
        finished = finished_map(to, fingerprint, verified=0, attrs=about)
        if finished is not None:
            return finished
    path = check_target(to, 0, overwrite, [one.path for one in parts])
    if not restart:
        check_left(path, fingerprint)
    result, whole = found(path)
    before = str(parts[0].attrs.get(HISTORY, "")) if parts else ""
    line = history(f"{made} to {path.name}", before)
    write(path, result, fingerprint, line, whole=whole, overwrite=overwrite, restart=restart)
    return open_map(path)


def request_of_parts(parts: Sequence[PartFile], own: Any = None) -> tuple[Request, list[Kept], Any]:
    """Return the search that parts make together, what each has kept, and how many designs are verified.

    Its designs are those that were kept, which know their numbers among all.

    Parameters
    ----------
    parts : sequence of PartFile
        All parts, in order.
    own : Extension, optional
        The mechanism with quantities of one's own by which they were searched.
    """
    for part in parts:
        part.check_labels()
    wholes, attrs = [part.whole() for part in parts], parts[0].attrs
    about = json.loads(wholes[0][SEARCH].item())
    if about["environment"] != environment().hex():
        what = f"{parts[0].path} is by another version ({attrs.get('source')})"
        raise InputError(what, where=("paths",), remedy="join with the version that has searched the parts")
    mechanism, text = str(attrs["mechanism"]), str(attrs.get("own_quantities", ""))
    if own is not None:
        mechanism = check_declared(("mechanism",), own, mechanism, text)  # type: ignore[assignment]
    elif text:
        raise own_refused(("mechanism",), declared_names(text)[0])
    kept, numbers, columns = list[Kept](), list[Any](), dict[str, list[Any]]()
    for part, whole in zip(parts, wholes, strict=True):
        kept.append(Kept.of_arrays({str(name): one.values for name, one in whole.coords.items()}))
        rows = kept[-1].rows // about["rows_of_design"]
        numbers.append(rows if len(rows) else np.array(part.of.range[:1]))
        with part.dataset() as opened:
            for name in about["columns"]:
                columns.setdefault(name, []).append(opened[name].values)
    every = np.concatenate(numbers)
    order = np.argsort(every, kind="stable")
    options = dict(about["options"])
    links = options["links"] = None if options["links"] is None else Links(**options["links"])
    space = table(
        {
            name: np.concatenate(values)[order] if np.ndim(values[0]) else values[0].item()
            for name, values in columns.items()
            if links is None or name not in links.values
        },
        keep=about["labels"],
    )
    asked = {**about["asked"], "bounds": None, "spans": None}
    if about["spans"] is not None:
        asked["spans"] = [
            Span(a, low, high, tuple(map(tuple, f)), t) for a, low, high, f, t in about["spans"]
        ]
    request = request_of(mechanism, space, about["quantities"], asked, positions={}, **options)
    request.numbers, request.known = every[order], parts[0].of.whole
    request.size, request.origin = about["size"], about["origin"]
    request.attrs = {name: attrs[name] for name in about["attrs"]}
    return request, kept, about["verify"]


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
    given: dict[str, Any] = {
        "quantities": wanted,
        "only": only,
        "bounds": bounds,
        "spans": asked.get("spans"),
    }
    request = Request.of(mechanism, resolved, of_sweep, **given)
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
