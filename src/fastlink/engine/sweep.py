"""Sweep a design space: resolve, run the kernels, label and write the results."""

from __future__ import annotations

import hashlib
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from inspect import signature
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink.engine import labels, sinks
from fastlink.engine.options import checked_call
from fastlink.engine.resolve import ResolvedSweep, of_request, resolve
from fastlink.engine.run import BLOCK_BYTES, Sink, default_threads, row_bytes, run
from fastlink.engine.sinks import into
from fastlink.errors import door
from fastlink.facts.catalogue import ELIMINATED
from fastlink.io.checksums import Range, joined_ranges
from fastlink.io.layout import HISTORY, Variable, history, plain_attrs
from fastlink.io.partial_file import check_target
from fastlink.io.reader import Part, PartOfMap, finished_map
from fastlink.io.writer import RemoteWriter, Writer, Written
from fastlink.maps import open as open_map
from fastlink.precision import DESIGNS, Verification, with_remark
from fastlink.space.design_space import DESIGN, Counted, DesignSpace, Links, held, part_of
from fastlink.space.tables import CURVES, MAPS

if TYPE_CHECKING:
    import xarray as xr
    from distributed import Client
    from numpy.typing import ArrayLike, NDArray

    from fastlink.engine.cluster import Cluster
    from fastlink.engine.extend import Extension


# -- The designs of a part of a sweep, and what it keeps of the whole


def whole_coordinates(resolved: ResolvedSweep, start: int, stop: int) -> xr.Dataset:
    """Return what a part of a sweep does not tell itself of the coordinates of the whole map."""
    # These are its axes; the numbers that a table gives its designs, of those with rows in the part, where
    # several rows follow from each; and as attributes the dimensions of the designs and their lengths.
    space = resolved.space
    dims, own = dict(zip(space.dims, space.shape, strict=True)), dict[str, Any]()
    shared = space.size // dims.pop(DESIGN, space.size)
    if shared > 1 and not isinstance(number := space.labels.get(DESIGN), (Counted, type(None))):
        own[DESIGN] = part_of(number, 1, start // shared, -(-stop // shared))
        dims = {DESIGN: len(own[DESIGN]), **dims}
    dims_shape: dict[str, Any] = {"dims": tuple(dims), "shape": tuple(dims.values())}
    kept = replace(space, **dims_shape, columns={}, constants={}, labels=own)
    coords = labels.coordinates_of(replace(resolved, space=kept))
    coords = coords.drop_vars([name for name in coords.coords if name not in (*space.axes, *own)])
    coords.attrs = {"dims": " ".join(space.dims), **({"shape": np.array(space.shape)} if space.dims else {})}
    return coords


# -- The evaluation of a resolved sweep, into memory or a file


#: Designs of an earlier run that are read at once.
REPLAYED = 4096


class Evaluation:
    """A sweep from its resolved request to its labelled results."""

    def __init__(
        self,
        resolved: ResolvedSweep,
        attrs: Mapping[str, Any],
        threads: int,
        block: int | None,
        verify: int | None,
        in_memory: bool,
        *,
        part: Part | None = None,
        cluster: Cluster | None = None,
    ) -> None:
        verify = (0 if in_memory else DESIGNS) if verify is None else verify
        #: The request, whose kernels run; the global attributes that are known before.
        self.whole, self.part, self.cluster, self.attrs = resolved, None, cluster, dict(attrs)
        self.range = (0, resolved.space.size)
        if part is not None:
            self.part = PartOfMap(part, self.fingerprint, resolved.space.size)
            self.range, self.attrs = self.part.range, self.attrs | self.part.attrs()
            space = resolved.space.consecutive(*self.range)
            resolved = replace(resolved, space=replace(space, attrs=resolved.space.attrs))
        plan, space, positions = resolved.plan, resolved.space, resolved.positions
        self.variables = labels.variables(resolved)
        if in_memory:  # there values stay as they are computed, and only dimensions change places
            resolved = replace(resolved, layout=CURVES)
        #: The same of the designs of the part, which label the results.
        self.resolved, self.threads, self.block = resolved, threads, block
        #: Coordinates that are computed block by block, beside the results.
        self.columns = labels.computed(resolved)
        self.nbytes = sum(variable.nbytes for variable in (self.variables if in_memory else self._written))
        sinks.check_needs(resolved, threads, block, verify, self.nbytes if in_memory else 0)
        self.counts = sinks.StatusCounts(plan)
        self.verification = Verification(plan, space, positions, verify) if verify else None

    @property
    def fingerprint(self) -> str:
        """A hash that no other sweep's file has, however many threads write it."""
        if self.part is not None:
            return self.part.fingerprint
        rest = {
            name: value.tolist() if isinstance(value, np.ndarray) else value  # whose repr leaves values out
            for name, value in plain_attrs(self.attrs).items()
            if name != "threads"
        }
        about = self.whole.fingerprint, rest, labels.variables(self.whole)
        return hashlib.sha256(repr(about).encode()).hexdigest()

    def finished(self, to: str | Path) -> xr.Dataset | None:
        """Return the map of this request if it is there already, None where no file is; refuse another file."""
        verified = 0 if self.verification is None else self.verification.designs.size
        about: Any = {"coords": self._coordinates(), "variables": self._written, "attrs": self.attrs}
        return finished_map(to, self.fingerprint, verified=verified, **about)

    @property
    def _written(self) -> list[Variable]:
        """All variables that are written block by block."""
        return [*self.variables, *(variable for variable, _ in self.columns)]

    def _coordinates(self) -> xr.Dataset:
        return labels.coordinates_of(self.resolved, [variable.name for variable, _ in self.columns])

    def load(self, started: float) -> None:
        """Compile or load the kernels, and note the time since the sweep has started."""
        self.job = self.whole.job()
        resolved = self.resolved
        if resolved.scaling_axis is not None or self.part is not None or resolved.layout == MAPS:
            self.block = sinks.designs_per_block(resolved, self.threads, self.block)
        self.loaded = time.perf_counter()
        self.set_up_time = self.loaded - started

    def in_memory(self, show: Sink) -> xr.Dataset:
        """Evaluate all designs, and return the labelled results."""
        arrays = sinks.allocated(self.job.shapes, self.resolved.space.size)
        sink, axis = self._sink(show), self.resolved.scaling_axis
        columns = {variable.name: np.empty(variable.shape, variable.dtype) for variable, _ in self.columns}

        def hold(name: str, start: int, values: NDArray[Any]) -> None:
            columns[name][start : start + len(values)] = values

        sink = sinks.tee(self._of_columns(hold), sink) if columns else sink
        if axis is None and self.part is None and self.cluster is None:
            run(self.job, targets=arrays, sink=sink, threads=self.threads, block=self.block)
        else:
            self._run(sinks.tee(into(arrays), sink))
        statistics = self._statistics()
        measured, errors = self._errors()
        variables = [replace(v, attrs=v.attrs | errors.get(v.name, {})) for v in self.variables]
        attrs, resolved = {**self.attrs, **statistics, **measured}, self.resolved
        if columns:
            resolved = replace(resolved, space=held(resolved.space, columns))
        return labels.labelled(resolved, variables, arrays, attrs)

    def to_file(self, path: Path, show: Sink, **options: Any) -> None:
        """Evaluate all designs into a file, or the rest of a killed run."""
        if self.part is None:
            options |= {"run": (self.fingerprint, self.job.size), "rows": self.resolved.scaling_axis}
        else:
            options |= {"run": (self.fingerprint, self.resolved.space.size)}
            options |= {"whole": whole_coordinates(self.whole, *self.range)}
        with Writer(path, self._coordinates(), self._written, self.attrs, **options) as writer:
            sink = self._sink(show)
            remote: list[Range] = []
            resumed = self._replay(writer, writer.written, sink)

            def merge(written: Written) -> None:
                writer.merge(written)
                remote.extend(written.ranges)
                for first, last in self._rows(written.ranges):
                    show(first, last, [])

            self._run(sink, writer, merge)
            # not before all is written: of pages that it has read, NFS may write old values of other machines
            self._replay(writer, joined_ranges(remote), self._sink())
            statistics = self._statistics(resumed)
            measured, errors = self._errors()  # an interrupt leaves a partial file that goes on from here
            made = {HISTORY: history(f"sweep {self.resolved.mechanism} to {path.name}")}
            writer.finish(statistics | measured | made, errors)

    def _into(self, file: Writer | RemoteWriter) -> Sink:
        """Return a sink that writes all variables; it travels with a remote writer, without the evaluation."""
        swept = len(self.resolved.space.shape)
        rows = [(v.name, v.shape[: v.leading] or v.shape[swept:]) for v in self.variables]

        def write(start: int, stop: int, arrays: list[NDArray[Any]]) -> None:
            for (name, row), array in zip(rows, arrays, strict=True):
                file.write(name, start, array.reshape(len(array), *row))

        return sinks.tee(write, self._of_columns(file.write))

    def _of_columns(self, write: Callable[[str, int, NDArray[Any]], None]) -> Sink:
        """Return a sink that writes the coordinates which are computed with some designs."""
        size, columns = self.resolved.space.size, self.columns

        def pass_on(start: int, stop: int, arrays: list[NDArray[Any]]) -> None:
            for variable, column in columns:
                first, last = variable.placement(size).own(start, stop)
                write(variable.name, first, column.piece(first, last))

        return pass_on

    def _run(
        self, sink: Sink, writer: Writer | None = None, merge: Callable[[Written], None] | None = None
    ) -> None:
        """Evaluate designs: into a file, where a writer is given, and into a sink besides."""
        pending = [(0, self.resolved.space.size)] if writer is None else writer.pending
        first, axis = self.range[0], self.resolved.scaling_axis
        evaluated: list[Range] | None = None if writer is None else pending
        if self.part is not None:
            pending = [(first + start, first + stop) for start, stop in pending]
            # designs that only scale with those of another part are evaluated for both
            evaluated = (
                joined_ranges([piece for of in pending for piece in axis.evaluated(*of)]) if axis else pending
            )
        into = sink if writer is None else sinks.tee(self._into(writer), sink)
        placed = self._placed(into, writer, pending)
        if self.cluster is None:
            how: dict[str, Any] = {"threads": self.threads, "block": self.block, "apart": writer is not None}
            run(self.job, sink=placed, pending=evaluated, **how)
            return
        remote: Any = None
        if writer is not None:
            file = writer.remote()
            remote = self._placed(self._into(file), file, pending), file, merge
        self.cluster.run(self.job, placed, remote=remote, block=self.block, pending=evaluated)

    def _placed(self, sink: Sink, file: Writer | RemoteWriter | None, pending: list[Range]) -> Sink:
        """Return a sink of evaluated designs, from one of those of the part or the map, which a file records."""

        def record(start: int, stop: int, arrays: list[NDArray[Any]]) -> None:
            if file is not None:
                file.record(start, stop)

        axis, at_once = self.resolved.scaling_axis, sinks.bytes_at_once(self.resolved)
        if self.part is not None:
            sink = sinks.within(pending, sinks.tee(sink, record), self.range[0])
            return axis.over(sink, at_once) if axis else sink
        return sinks.tee(axis.over(sink, at_once) if axis else sink, record)

    def _sink(self, *show: Sink) -> Sink:
        """Return the sink of the results besides the file or the arrays."""
        verified = [] if self.verification is None else [self.verification.collect]
        return sinks.tee(self.counts.take, *verified, *show)

    def _rows(self, ranges: list[Range]) -> Iterator[Range]:
        """Yield the ranges of the file's designs that follow from recorded ones."""
        axis = None if self.part else self.resolved.scaling_axis
        for start, stop in ranges:
            yield from axis.ranges(start, stop) if axis else [(start, stop)]

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

    def _replay(self, writer: Writer, written: list[Range], sink: Sink) -> int:
        """Pass on the results of designs that the file holds, and return the number of all that follow from them."""
        count, step = 0, max(1, min(REPLAYED, BLOCK_BYTES // row_bytes(self.job.shapes)))
        rows = zip(self.variables, self.job.shapes, strict=True)
        # only what the sinks look at is read
        values = [writer.values(variable.name, shape) for variable, (shape, _) in rows if written]
        for first, last in self._rows(written):
            count += last - first
            for k in range(first, last, step):
                end = min(k + step, last)
                sink(k, end, [array[k:end] for array in values])
        return count


@door
def sweep(
    mechanism: str | Extension,
    space: DesignSpace | Mapping[str, Any] | str | Path | Any,
    quantities: Sequence[str],
    *,
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
    branch : int or sequence of int, default 1
        Which of the two assembly modes, see docs/conventions.md; ``(1, 2)`` for both. A list is a dimension of the
        result, ``[2]`` too; a single number, as ``isel`` of xarray does it, is a scalar coordinate ``branch``.
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
        along ``design``; `fastlink.join` makes the whole map of all n (see docs/performance.md).
    layout : {"curves", "maps"}
        How the result is to be read. By ``"curves"``, all values of one design lie together, and the swept dimensions
        come first. By ``"maps"``, the values of all designs at one input position (or branch, or extreme) lie together,
        and these dimensions come first: a picture over two lengths is then read from a large file in one piece, a curve
        value by value. The numbers are the same bits (see docs/files.md for what each costs).
    threads : int, optional
        All processors unless given. Any number gives the same bits.
    client : distributed.Client, optional
        Evaluate the designs on the workers of a dask.distributed cluster, to the same bits: see docs/performance.md.
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
        The same as `angles`, as ``positions=72`` or by the name of the input: ``F_y=[-0.1, 0.0]`` where the input is
        ``"F_y"``; in degrees ``theta1_deg=[40, 80]``.

    Returns
    -------
    xarray.Dataset
        In memory, or opened lazily from the file. Dimensions: the swept ones (and the choices that the design leaves
        open, such as ``completion``), then ``branch``, then the input; the swept ones last with ``layout="maps"``.
        A configuration that does not assemble is NaN; ``status`` tells why.

    Examples
    --------
    >>> maps = fl.sweep(
    ...     "planar_4r",
    ...     fl.grid(a1=0.4, a2=[1.1, 1.2], a3=0.8, a4=1.0, omega1=25.0),
    ...     ["omega4_max", "transmission_angle_min"],
    ... )
    >>> maps.omega4_max.dims
    ('a2',)
    """
    call, started = dict(locals()), time.perf_counter()
    checked, resolved = checked_call(
        call, lambda given: resolve(mechanism, space, quantities, options=_OPTIONS, **of_request(given))
    )
    resolved = replace(resolved, layout=checked["layout"])
    threads, target, cluster = checked["threads"] or default_threads(), checked["to"], checked["client"]
    attrs = labels.global_attrs(resolved, cluster.threads if cluster else threads) | (checked["attrs"] or {})
    options = 1 if cluster else threads, checked["block"], checked["verify"], target is None
    evaluation = Evaluation(resolved, attrs, *options, part=checked["part"], cluster=cluster)
    is_new = target is None or overwrite
    if not is_new and (finished := evaluation.finished(target)) is not None:
        return with_remark(finished)
    path = None if target is None else check_target(target, evaluation.nbytes, overwrite)
    if cluster is not None:
        cluster.check()
    evaluation.load(started)
    with sinks.ProgressBar(evaluation.resolved.space.size, progress) as bar:
        if path is None:
            return with_remark(evaluation.in_memory(bar.take))
        evaluation.to_file(path, bar.take, overwrite=overwrite, restart=restart)
    return with_remark(open_map(path))


#: The keywords of a sweep besides the name of the input.
_OPTIONS = tuple(name for name in signature(sweep).parameters if name != "positions")
