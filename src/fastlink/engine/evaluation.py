"""The evaluation of a resolved sweep, into memory or a file."""

from __future__ import annotations

import hashlib
import time
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink.engine import labels
from fastlink.engine.executor import BLOCK_BYTES, Sink, row_bytes, run
from fastlink.engine.needs import allocated, bytes_at_once, check_needs, designs_per_block
from fastlink.engine.parts import consecutive, whole_coordinates
from fastlink.engine.sinks import StatusCounts, into, tee, within
from fastlink.io.dataset import plain_attrs
from fastlink.io.finished import finished_map
from fastlink.io.history import HISTORY, history
from fastlink.io.parts import Part, PartOfMap
from fastlink.io.ranges import joined
from fastlink.io.writing.writer import Writer
from fastlink.precision import DESIGNS, Verification
from fastlink.space.dataset import CURVES, MAPS
from fastlink.space.design_space import held

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import NDArray

    from fastlink.engine.distributed import Cluster
    from fastlink.engine.resolve import ResolvedSweep
    from fastlink.io.dataset import Variable
    from fastlink.io.ranges import Range

__all__ = ["Evaluation"]

#: Designs of an earlier run that are read at once.
REPLAYED = 4096


class Evaluation:
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
    part : Part, optional
        The part of the designs to evaluate; all unless given.
    cluster : Cluster, optional
        Whose workers evaluate them, instead of threads of this process.

    Attributes
    ----------
    whole : ResolvedSweep
        The request, whose kernels run.
    resolved : ResolvedSweep
        The same of the designs of the part, which label the results.
    """

    def __init__(
        self,
        resolved: ResolvedSweep,
        threads: int,
        block: int | None,
        verify: int | None,
        in_memory: bool,
        *,
        part: Part | None = None,
        cluster: Cluster | None = None,
    ) -> None:
        verify = (0 if in_memory else DESIGNS) if verify is None else verify
        self.whole, self.part, self.cluster = resolved, part, cluster
        self.range = (0, resolved.space.size) if part is None else part.range(resolved.space.size)
        if part is not None:
            resolved = replace(resolved, space=consecutive(resolved.space, *self.range))
        plan, space, positions = resolved.plan, resolved.space, resolved.positions
        self.variables = labels.variables_of(resolved)
        if in_memory:  # there values stay as they are computed, and only dimensions change places
            resolved = replace(resolved, layout=CURVES)
        self.resolved, self.threads, self.block = resolved, threads, block
        #: Coordinates that are computed block by block, beside the results.
        self.columns = labels.computed(plan, space)
        self.nbytes = sum(variable.nbytes for variable in (self.variables if in_memory else self._written))
        check_needs(resolved, threads, block, verify, self.nbytes if in_memory else 0)
        self.counts = StatusCounts(plan)
        self.verification = Verification(plan, space, positions, verify) if verify else None

    def finished(self, to: str | Path, attrs: Mapping[str, Any]) -> xr.Dataset | None:
        """Return the map of this request if it is there already, None where no file is; refuse another file."""
        verified = 0 if self.verification is None else self.verification.designs.size
        return finished_map(
            to,
            self._fingerprint(attrs),
            verified=verified,
            coords=self._coordinates(),
            variables=self._written,
            attrs=self._labelled(attrs),
        )

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
            self.block = designs_per_block(resolved, self.threads, self.block)
        self.loaded = time.perf_counter()
        self.set_up_time = self.loaded - started

    def in_memory(self, show: Sink, attrs: Mapping[str, Any]) -> xr.Dataset:
        """Evaluate all designs, and return the labelled results."""
        arrays = allocated(self.job.shapes, self.resolved.space.size)
        sink, axis = self._sink(show), self.resolved.scaling_axis
        columns = {variable.name: np.empty(variable.shape, variable.dtype) for variable, _ in self.columns}

        def hold(name: str, start: int, values: NDArray[Any]) -> None:
            columns[name][start : start + len(values)] = values

        sink = tee(self._of_columns(hold), sink) if columns else sink
        if axis is None and self.part is None and self.cluster is None:
            run(self.job, targets=arrays, sink=sink, threads=self.threads, block=self.block)
        else:
            self._run(tee(into(arrays), sink))
        statistics = self._statistics()
        measured, errors = self._errors()
        variables = [replace(v, attrs=v.attrs | errors.get(v.name, {})) for v in self.variables]
        attrs = {**self._labelled(attrs), **statistics, **measured}
        resolved = self.resolved
        if columns:
            resolved = replace(resolved, space=held(resolved.space, columns))
        return labels.labelled(resolved, variables, arrays, attrs)

    def to_file(
        self, path: Path, show: Sink, attrs: Mapping[str, Any], *, overwrite: bool, restart: bool
    ) -> None:
        """Evaluate all designs into a file, or the rest of a killed run."""
        options: dict[str, Any] = {"overwrite": overwrite, "restart": restart}
        if self.part is None:
            options |= {"run": (self._fingerprint(attrs), self.job.size), "rows": self.resolved.scaling_axis}
        else:
            options |= {"run": (self._fingerprint(attrs), self.resolved.space.size)}
            options |= {"whole": whole_coordinates(self.whole, *self.range)}
        swept = len(self.resolved.space.shape)
        rows = [(v.name, v.shape[: v.leading] or v.shape[swept:]) for v in self.variables]
        with Writer(path, self._coordinates(), self._written, self._labelled(attrs), **options) as writer:
            # both travel to the workers of a cluster, and the evaluation does not
            def write(start: int, stop: int, arrays: list[NDArray[Any]]) -> None:
                for (name, row), array in zip(rows, arrays, strict=True):
                    writer.write(name, start, array.reshape(len(array), *row))

            def record(start: int, stop: int, arrays: list[NDArray[Any]]) -> None:
                writer.record(start, stop)

            sink = self._sink(show)
            resumed = self._replay(writer, sink)
            self._run(tee(write, self._of_columns(writer.write), sink), record, writer.pending)
            statistics = self._statistics(resumed)
            measured, errors = self._errors()  # an interrupt leaves a partial file that goes on from here
            made = {HISTORY: history(f"sweep {self.resolved.mechanism} to {path.name}")}
            writer.finish(statistics | measured | made, errors)

    def _of_columns(self, write: Callable[[str, int, NDArray[Any]], None]) -> Sink:
        """Return a sink that writes the coordinates which are computed with some designs."""
        size, columns = self.resolved.space.size, self.columns

        def pass_on(start: int, stop: int, arrays: list[NDArray[Any]]) -> None:
            for variable, column in columns:
                first, last = variable.placement(size).own(start, stop)
                write(variable.name, first, column.piece(first, last))

        return pass_on

    def _run(self, sink: Sink, record: Sink | None = None, pending: list[Range] | None = None) -> None:
        """Evaluate designs.

        Parameters
        ----------
        sink : callable
            Takes the results of all designs: of the part, numbered from its first.
        record : callable, optional
            Takes the designs whose results `sink` has: those that are evaluated; of a part, all.
        pending : list of (start, stop), optional
            The designs to evaluate, as `record` numbers them; all unless given.
        """
        axis, at_once = self.resolved.scaling_axis, bytes_at_once(self.resolved)
        if self.part is None:
            sink = axis.over(sink, at_once) if axis else sink
            sink = tee(sink, record) if record else sink
        else:
            first, (start, stop) = self.range[0], self.range
            every = [(0, stop - start)] if pending is None else pending
            rows = [(first + a, first + b) for a, b in every]
            sink = within(rows, tee(sink, record) if record else sink, first)
            # designs that only scale with those of another part are evaluated for both
            pending = joined([piece for row in rows for piece in axis.evaluated(*row)]) if axis else rows
            sink = axis.over(sink, at_once) if axis else sink
        if self.cluster is None:
            how: dict[str, Any] = {"threads": self.threads, "block": self.block, "apart": record is not None}
            run(self.job, sink=sink, pending=pending, **how)
        else:
            travels = record is not None
            self.cluster.run(self.job, sink, travels=travels, block=self.block, pending=pending)

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

    def _labelled(self, attrs: Mapping[str, Any]) -> dict[str, Any]:
        """Return global attributes, of a part with those that tell which."""
        return {**attrs, **({} if self.part is None else self._of_map(attrs).attrs())}

    def _of_map(self, attrs: Mapping[str, Any]) -> PartOfMap:
        assert self.part is not None
        return PartOfMap(self.part, self._whole_fingerprint(attrs), self.whole.space.size)

    def _fingerprint(self, attrs: Mapping[str, Any]) -> str:
        """Return a hash that no other sweep's file has, however many threads write it."""
        return self._whole_fingerprint(attrs) if self.part is None else self._of_map(attrs).fingerprint

    def _whole_fingerprint(self, attrs: Mapping[str, Any]) -> str:
        """Return the hash of the request of all designs, the same in each part."""
        whole = self.whole
        variables = labels.variables_of(whole)
        rest = {
            name: value.tolist() if isinstance(value, np.ndarray) else value  # whose repr leaves values out
            for name, value in plain_attrs(attrs).items()
            if name != "threads"
        }
        return hashlib.sha256(repr((whole.fingerprint, rest, variables)).encode()).hexdigest()

    def _replay(self, writer: Writer, sink: Sink) -> int:
        """Pass on the results of a killed run, and return the number of its designs."""
        axis, count = None if self.part else self.resolved.scaling_axis, 0
        step = max(1, min(REPLAYED, BLOCK_BYTES // row_bytes(self.job.shapes)))
        rows = zip(self.variables, self.job.shapes, strict=True)
        # only what the sinks look at is read
        values = [writer.values(variable.name, shape) for variable, (shape, _) in rows]
        for start, stop in writer.written:
            for first, last in axis.ranges(start, stop) if axis else [(start, stop)]:
                count += last - first
                for k in range(first, last, step):
                    end = min(k + step, last)
                    sink(k, end, [array[k:end] for array in values])
        return count
