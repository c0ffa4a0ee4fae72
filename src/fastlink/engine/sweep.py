"""Sweep a design space: resolve, run the kernels, label and write the results."""

from __future__ import annotations

import hashlib
import time
from collections.abc import Mapping, Sequence
from dataclasses import replace
from inspect import signature
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink.catalogue.declare import ELIMINATED
from fastlink.doors import door
from fastlink.engine import labels
from fastlink.engine.executor import BLOCK_BYTES, Sink, default_threads, row_bytes, run
from fastlink.engine.needs import allocated, check_needs, designs_per_block
from fastlink.engine.options import check_options
from fastlink.engine.resolve import ResolvedSweep, resolve
from fastlink.engine.sinks import ProgressBar, StatusCounts, into, tee
from fastlink.errors import Problems
from fastlink.io.dataset import plain_attrs
from fastlink.io.finished import finished_map
from fastlink.io.partial_file import check_target, existing_file
from fastlink.io.writer import Writer
from fastlink.maps import open as open_map
from fastlink.precision import DESIGNS, Verification

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import ArrayLike, NDArray

    from fastlink.space.design_space import DesignSpace
    from fastlink.space.links import Links

__all__ = ["sweep"]

#: Designs of an earlier run that are read at once.
REPLAYED = 4096


@door
def sweep(
    mechanism: str,
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
    threads: int | None = None,
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
    mechanism : str
        Name of the mechanism, such as ``"planar_4r"``.
    space : DesignSpace, mapping, DataFrame, Dataset or path
        From `fastlink.grid`, `fastlink.table`, `fastlink.sobol` or `fastlink.latin_hypercube`; or what `fastlink.table`
        takes, such as a DataFrame, the path of a CSV file or the result of another sweep; or one design as a mapping.
    quantities : sequence of str
        Names of quantities, or of their reductions over the cycle: ``NAME_max``, ``NAME_min``, ``NAME_rms``,
        ``NAME_mean``, ``NAME_fluctuation``,
        ``INPUT_at_NAME_max``, ``INPUT_at_NAME_min``, with the input that drives, such as theta1, for INPUT; or
        ``NAME_extrema``, all extremes by growing input position along the dimension ``extremum``, with their
        ``INPUT_at_NAME_extrema``, ``NAME_extrema_kind`` and ``NAME_extrema_count``.
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
    threads : int, optional
        All processors unless given. Any number gives the same bits.
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
        open, such as ``completion``), then ``branch``, then the input.
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
        given = {"verify": verify, "to": to, "overwrite": overwrite, "threads": threads, "progress": progress}
        checked = check_options(given | {"allow_invalid": allow_invalid, "attrs": attrs, "block": block})
    with problems.at():
        asked: dict[str, Any] = {"links": links, "input": input, "angles": angles, "positions": positions}
        asked |= {"branch": branch, "solver": solver, "extrema": extrema, "backend": backend}
        asked |= {"options": _OPTIONS, "allow_invalid": checked.get("allow_invalid", False)}
        resolved = resolve(mechanism, space, quantities, **asked)
    problems.stop()
    threads, target = checked["threads"] or default_threads(), checked["to"]
    evaluation = _Evaluation(resolved, threads, checked["block"], checked["verify"], target is None)
    before = labels.global_attrs(resolved, threads) | (checked["attrs"] or {})
    is_new = target is None or overwrite
    if not is_new and (finished := evaluation.finished(target, before)) is not None:
        return finished
    path = None if target is None else check_target(target, evaluation.nbytes, overwrite)
    evaluation.load(started)
    with ProgressBar(resolved.space.size, progress) as bar:
        if path is None:
            return evaluation.in_memory(bar.take, before)
        evaluation.to_file(path, overwrite, bar.take, before)
    return open_map(path)


#: The keywords of a sweep besides the name of the input.
_OPTIONS = tuple(name for name in signature(sweep).parameters if name != "positions")


class _Evaluation:
    """A sweep from its resolved request to its labelled results.

    Parameters
    ----------
    resolved : ResolvedSweep
        The request.
    threads : int
        Number of threads.
    block : int, optional
        Designs per block.
    verify : int, optional
        How many designs are computed again; those that a file is verified by unless given.
    in_memory : bool
        Whether the results stay in memory.
    """

    def __init__(
        self, resolved: ResolvedSweep, threads: int, block: int | None, verify: int | None, in_memory: bool
    ) -> None:
        verify = (0 if in_memory else DESIGNS) if verify is None else verify
        self.resolved, self.threads, self.block = resolved, threads, block
        plan, space, positions = resolved.plan, resolved.space, resolved.positions
        self.variables = labels.variables(plan, space, positions.size, one_branch=resolved.one_branch)
        self.nbytes = sum(variable.nbytes for variable in self.variables)
        check_needs(resolved, threads, block, verify, self.nbytes if in_memory else 0)
        self.counts = StatusCounts(plan)
        self.verification = Verification(plan, space, positions, verify) if verify else None

    def finished(self, to: str | Path, attrs: Mapping[str, Any]) -> xr.Dataset | None:
        """Return the map of this request if it is there already, None where no file is; refuse another file."""
        path = existing_file(to)
        if path is None:
            return None
        verified = 0 if self.verification is None else self.verification.designs.size
        return finished_map(
            path,
            self._fingerprint(attrs),
            verified=verified,
            coords=self._coordinates(),
            variables=self.variables,
            attrs=attrs,
        )

    def _coordinates(self) -> xr.Dataset:
        resolved = self.resolved
        return labels.sweep_coordinates(
            resolved.plan, resolved.space, resolved.positions, one_branch=resolved.one_branch
        )

    def load(self, started: float) -> None:
        """Compile or load the kernels, and note the time since the sweep has started."""
        self.job = self.resolved.job()
        if self.resolved.scaling_axis is not None:
            self.block = designs_per_block(self.resolved, self.threads, self.block)
        self.loaded = time.perf_counter()
        self.set_up_time = self.loaded - started

    def in_memory(self, show: Sink, attrs: Mapping[str, Any]) -> xr.Dataset:
        """Evaluate all designs, and return the labelled results."""
        arrays = allocated(self.job.shapes, self.resolved.space.size)
        sink, axis = self._sink(show), self.resolved.scaling_axis
        if axis is None:
            run(self.job, targets=arrays, sink=sink, threads=self.threads, block=self.block)
        else:
            run(self.job, sink=axis.over(tee(into(arrays), sink)), threads=self.threads, block=self.block)
        statistics = self._statistics()
        measured, errors = self._errors()
        variables = [replace(v, attrs=v.attrs | errors.get(v.name, {})) for v in self.variables]
        return labels.labelled(self.resolved, variables, arrays, {**attrs, **statistics, **measured})

    def to_file(self, path: Path, overwrite: bool, show: Sink, attrs: Mapping[str, Any]) -> None:
        """Evaluate all designs into a file, or the rest of a killed run."""
        axis, coords = self.resolved.scaling_axis, self._coordinates()
        key = self._fingerprint(attrs), self.job.size
        with Writer(path, coords, self.variables, attrs, overwrite=overwrite, run=key) as writer:

            def write(start: int, stop: int, arrays: list[NDArray[Any]]) -> None:
                for variable, array in zip(self.variables, arrays, strict=True):
                    row = variable.shape[len(self.resolved.space.shape) :]
                    writer.write(variable.name, start, array.reshape(len(array), *row))

            sink = self._sink(show)
            resumed = self._replay(writer, sink)
            sink = tee(write, sink)
            run(
                self.job,
                sink=tee(
                    axis.over(sink) if axis else sink, lambda start, stop, _: writer.record(start, stop)
                ),
                threads=self.threads,
                block=self.block,
                pending=writer.pending,
            )
            statistics = self._statistics(resumed)
            errors: dict[str, dict[str, Any]] = {}
            try:
                measured, errors = self._errors()
                statistics |= measured
            finally:  # what was computed is kept, whatever becomes of its verification
                writer.finish(statistics, errors)

    def _sink(self, show: Sink) -> Sink:
        """Return the sink of the results besides the file or the arrays."""
        verified = [] if self.verification is None else [self.verification.collect]
        return tee(self.counts.take, *verified, show)

    def _statistics(self, resumed: int = 0) -> dict[str, Any]:
        """Return numbers of designs and their speed, as global attributes."""
        run_time = time.perf_counter() - self.loaded
        resolved, size = self.resolved, self.resolved.space.size
        rate = (size - resumed) / run_time
        attrs = {"designs": size, "set_up_time_s": self.set_up_time, "run_time_s": run_time}
        if resumed:
            attrs["designs_of_earlier_runs"] = resumed
        attrs["designs_per_second"] = rate
        if resolved.plan.uses_position:
            of_each = len(resolved.branches) * resolved.positions.size
            attrs |= {"configurations": size * of_each, "configurations_per_second": rate * of_each}
        return attrs | self.counts.attrs()

    def _errors(self) -> tuple[dict[str, Any], dict[str, dict[str, Any]]]:
        """Return the measured errors as global attributes, and as those of each variable."""
        return ({}, {}) if self.verification is None else self.verification.measure()

    def _fingerprint(self, attrs: Mapping[str, Any]) -> str:
        """Return a hash that no other sweep's file has, however many threads write it."""
        rest = {
            name: value.tolist() if isinstance(value, np.ndarray) else value  # whose repr leaves values out
            for name, value in plain_attrs(attrs).items()
            if name != "threads"
        }
        return hashlib.sha256(repr((self.resolved.fingerprint, rest, self.variables)).encode()).hexdigest()

    def _replay(self, writer: Writer, sink: Sink) -> int:
        """Pass on the results of a killed run, and return the number of its designs."""
        axis, count = self.resolved.scaling_axis, 0
        step = max(1, min(REPLAYED, BLOCK_BYTES // row_bytes(self.job.shapes)))
        for start, stop in writer.written:
            for first, last in axis.ranges(start, stop) if axis else [(start, stop)]:
                count += last - first
                for k in range(first, last, step):
                    end = min(k + step, last)
                    rows = zip(self.variables, self.job.shapes, strict=True)
                    sink(k, end, [writer.read(variable.name, k, end, shape) for variable, (shape, _) in rows])
        return count
