"""Sweep a design space: resolve, run the kernels, label and write the results."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import replace
from inspect import signature
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fastlink.catalogue.declare import ELIMINATED
from fastlink.doors import door
from fastlink.engine import labels
from fastlink.engine.evaluation import Evaluation
from fastlink.engine.executor import default_threads
from fastlink.engine.options import check_options, check_workers
from fastlink.engine.resolve import resolve
from fastlink.engine.sinks import ProgressBar
from fastlink.errors import Problems
from fastlink.io.parts import check_size
from fastlink.io.writing.target import check_target
from fastlink.maps import open as open_map
from fastlink.space.dataset import CURVES

if TYPE_CHECKING:
    import xarray as xr
    from distributed import Client
    from numpy.typing import ArrayLike

    from fastlink.engine.extending import Extension
    from fastlink.space.design_space import DesignSpace
    from fastlink.space.links import Links

__all__ = ["sweep"]


@door
def sweep(
    mechanism: str | Extension,
    space: DesignSpace | Mapping[str, Any] | str | Path | Any,
    quantities: Sequence[str],
    *,
    links: Links | None = None,
    input: str | None = None,
    angles: int | ArrayLike | None = None,
    branch: int | Sequence[int] = (1, 2),
    solver: str = ELIMINATED,
    extrema: str | None = None,
    verify: int | None = None,
    to: str | Path | None = None,
    overwrite: bool = False,
    restart: bool = False,
    part: tuple[int, int] | str | None = None,
    layout: str = CURVES,
    threads: int | None = None,
    client: Client | None = None,
    progress: bool | None = None,
    allow_invalid: bool = False,
    attrs: Mapping[str, Any] | None = None,
    block: int | None = None,
    backend: str | None = None,
    **positions: int | ArrayLike | None,
) -> xr.Dataset:
    """Evaluate quantities of a mechanism over a design space.

    Parameters
    ----------
    mechanism : str or Extension
        Name of the mechanism, such as ``"planar_4r"``; or one with quantities of one's own, from `fastlink.extend`.
    space : DesignSpace, mapping, DataFrame, Dataset or path
        From `fastlink.grid`, `fastlink.table`, `fastlink.sobol` or `fastlink.latin_hypercube`; or what `fastlink.table`
        takes, such as a DataFrame, the path of a CSV or Parquet file or the result of another sweep; or one design as a
        mapping.
    quantities : sequence of str
        Names of quantities, or of their reductions over the cycle: ``NAME_max``, ``NAME_min``, ``NAME_rms``,
        ``NAME_mean``, ``NAME_fluctuation``,
        ``INPUT_at_NAME_max``, ``INPUT_at_NAME_min``, with the input that drives, such as theta1, for INPUT; or
        ``NAME_extrema``, all extremes by growing input position along the dimension ``extremum``, with their
        ``INPUT_at_NAME_extrema``, ``NAME_extrema_kind`` and ``NAME_extrema_count``. ``NAME_error``,
        ``NAME_max_error`` and ``NAME_extrema_error`` bound the errors of values and of extremes.
        `fastlink.quantities` lists them. ``status`` comes along.
    links : Links, optional
        The model of the links that gives their mass data, such as ``fastlink.round_bar(density=7750.0, radius=0.01)``.
    input : str, optional
        The input that drives the mechanism; its first unless given, such as theta1 of the planar 4R, theta of the
        slider-crank. Others are ``"joint_angle_1"`` ... ``"joint_angle_4"`` of the planar 4R (see
        docs/conventions.md), ``"sigma"`` of the focal mechanism and ``"F_y"`` of Hart's linkage;
        ``fastlink.quantities(mechanism, input=...)`` lists the quantities. The input is a dimension of the result.
    angles : int or array_like, default 360
        The input positions: a number of equally spaced angles over one turn, or an array of positions (angles in rad,
        ``F_y`` in m). An input that does not turn takes an array; unless given, theta of ``"minkowski_4r"`` is
        ``numpy.linspace(-4, 4, 401)``.
    branch : int or sequence of int, default (1, 2)
        Assembly modes. A list is a dimension of the result, ``[2]`` too; a single number, as ``isel`` of xarray
        does it, is a scalar coordinate ``branch``.
    solver : {"eliminated", "dense"}
        Joint reactions by elimination, or by LU of the 9x9 system of Hayes et al., eq. (9), which only the planar 4R
        driven by theta1 has.
    extrema : {"refined", "sampled"}, optional
        Whether ``NAME_max``, ``NAME_min`` and their places are exact over the whole turn of the input (the default), or
        those of the given angles (the default where these are an array).
    verify : int, optional
        How many designs, chosen at random, are computed again with 50 digits after the sweep; the measured errors are
        attributes of each variable (see docs/accuracy.md). By default 64 where a file is written, which outlives its
        session, and none where the result stays in memory, as in the loop of an optimisation. 0 leaves it out.
    to : path, optional
        The HDF5 file to write; without it the result stays in memory. A file that is there already and holds the map of
        this very request, unchanged since, is opened as it is: nothing is computed.
    overwrite : bool
        Compute anew and replace an existing file, whatever it holds.
    restart : bool
        Throw away what an interrupted run has left in ``FILE.part``. Without it, the same request goes on there, and
        another one is refused (see docs/files.md).
    part : (k, n) or "k/n", optional
        Evaluate the k-th of n nearly equal ranges of consecutive designs, k from 1 to n, into a file of its own, flat
        along ``design``; `fastlink.join` makes the whole map of all n (see docs/scaling.md).
    layout : {"curves", "maps"}
        How the result is to be read. By ``"curves"``, all values of one design lie together, and the swept dimensions
        come first. By ``"maps"``, the values of all designs at one input position (or branch, or extreme) lie together,
        and these dimensions come first: a picture over two lengths is then read from a large file in one piece, a curve
        value by value. The numbers are the same bits (see docs/files.md for what each costs).
    threads : int, optional
        All processors unless given. Any number gives the same bits.
    client : distributed.Client, optional
        Evaluate the designs on the workers of a dask.distributed cluster, to the same bits: see docs/scaling.md.
    progress : bool, optional
        Show a progress bar on standard error; by default only on a terminal.
    allow_invalid : bool
        Flag designs with impossible values (``status`` says ``invalid_input``) instead of refusing them.
    attrs : mapping, optional
        Further global attributes of the result.
    block : int, optional
        Designs per block. Any number gives the same bits.
    backend : {"llvm", "numba"}, optional
        The compiler of the kernels: fastlink's own translation to LLVM, or numba, which takes seconds instead of tenths
        of a second, to the same bits. By default the value of the environment variable ``FASTLINK_BACKEND``, else
        ``"llvm"``.
    **positions : int or array_like, optional
        The same as `angles`, by the name of the input: ``theta1=72``, or ``F_y=[-0.1, 0.0, 0.1]`` where the input is
        ``"F_y"``; in degrees ``theta1_deg=[40, 80]``.

    Returns
    -------
    xarray.Dataset
        In memory, or opened lazily from the file. Dimensions: the swept ones (and the choices that the design leaves
        open, such as ``completion``), then ``branch``, then the input; the swept ones last with ``layout="maps"``.
        A configuration that does not assemble is NaN; ``status`` tells why.

    Raises
    ------
    InputError
        Bad input; the message says what, where, and what to write instead.

    Examples
    --------
    >>> import fastlink as fl
    >>> maps = fl.sweep(
    ...     "planar_4r",
    ...     fl.grid(a1=0.4, a2=[1.1, 1.2], a3=0.8, a4=1.0, omega1=25.0),
    ...     ["omega4_max", "transmission_angle_min"],
    ... )
    >>> maps.omega4_max.dims
    ('a2', 'branch')
    """
    started = time.perf_counter()
    problems, checked = Problems(), dict[str, Any]()
    with problems.at():
        given: dict[str, Any] = {"verify": verify, "to": to, "part": part, "threads": threads}
        given |= {"overwrite": overwrite, "restart": restart, "progress": progress, "layout": layout}
        given |= {"client": client}
        checked = check_options(given | {"allow_invalid": allow_invalid, "attrs": attrs, "block": block})
    with problems.at():
        asked: dict[str, Any] = {"links": links, "input": input, "angles": angles, "positions": positions}
        asked |= {"branch": branch, "solver": solver, "extrema": extrema, "backend": backend}
        asked |= {"options": _OPTIONS, "allow_invalid": checked.get("allow_invalid", False)}
        resolved = resolve(mechanism, space, quantities, **asked)
        if checked.get("part") is not None:
            check_size(("part",), checked["part"], resolved.space.size)
    check_workers(client, threads, problems)
    problems.stop()
    resolved = replace(resolved, layout=checked["layout"])
    threads, target = checked["threads"] or default_threads(), checked["to"]
    cluster = None
    if checked["client"] is not None:
        from fastlink.engine.distributed import Cluster  # 25 ms of imports, for clusters alone

        cluster = Cluster(checked["client"])
    options = 1 if cluster else threads, checked["block"], checked["verify"], target is None
    evaluation = Evaluation(resolved, *options, part=checked["part"], cluster=cluster)
    threads = cluster.threads if cluster else threads
    before = labels.global_attrs(resolved, threads) | (checked["attrs"] or {})
    is_new = target is None or overwrite
    if not is_new and (finished := evaluation.finished(target, before)) is not None:
        return finished
    path = None if target is None else check_target(target, evaluation.nbytes, overwrite)
    if cluster is not None:
        cluster.check()
    evaluation.load(started)
    with ProgressBar(evaluation.resolved.space.size, progress) as bar:
        if path is None:
            return evaluation.in_memory(bar.take, before)
        evaluation.to_file(path, bar.take, before, overwrite=overwrite, restart=restart)
    return open_map(path)


#: The keywords of a sweep besides the name of the input.
_OPTIONS = tuple(name for name in signature(sweep).parameters if name != "positions")
