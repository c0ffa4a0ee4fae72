"""The one door: design space to plan to run to labels to file."""

from __future__ import annotations

import hashlib
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from inspect import signature
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink.engine import labels
from fastlink.engine.executor import Job, Sink, block_length, default_threads, run
from fastlink.engine.resolve import ResolvedSweep, resolve
from fastlink.engine.sinks import StatusCounts, progress_bar, tee
from fastlink.errors import InputError
from fastlink.io.dataset import Variable
from fastlink.io.partial_file import check_target
from fastlink.io.reader import open_map
from fastlink.io.writer import Writer
from fastlink.precision import Verification, check_verify

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import ArrayLike, NDArray

    from fastlink.engine.scaling import ScalingAxis
    from fastlink.space.design_space import DesignSpace
    from fastlink.space.links import Links

__all__ = ["sweep"]

#: Designs of an earlier run that are read at once.
REPLAYED = 4096


def sweep(
    mechanism: str,
    space: DesignSpace,
    quantities: Sequence[str],
    *,
    links: Links | None = None,
    input: str | None = None,
    angles: int | ArrayLike | None = None,
    branch: int | Sequence[int] = (1, 2),
    solver: str = "eliminated",
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
    space : DesignSpace
        From `fastlink.grid`, `fastlink.table`, `fastlink.sobol` or `fastlink.latin_hypercube`.
    quantities : sequence of str
        Names of quantities, or of what is taken over the cycle: ``NAME_max``, ``NAME_min``, ``NAME_rms``,
        ``NAME_mean``, ``NAME_fluctuation``,
        ``theta1_at_NAME_max``, ``theta1_at_NAME_min``; or ``NAME_extrema``, all extremes by growing theta1 along the
        dimension ``extremum``, with their ``theta1_at_NAME_extrema``, ``NAME_extrema_kind`` and
        ``NAME_extrema_count``. `fastlink.quantities` lists them. ``status`` comes along.
    links : Links, optional
        Where mass data come from, such as ``fastlink.round_bar(density=7750.0, radius=0.01)``.
    input : str, optional
        What drives: ``"theta1"`` unless given, or one of ``"joint_angle_1"`` ... ``"joint_angle_4"`` of the
        planar 4R (see docs/conventions.md); ``fastlink.quantities(mechanism, input=...)`` lists what there is then.
        The input takes the place of theta1: as dimension, in ``INPUT_at_NAME_max``, in the design its rate.
    angles : int or array_like, default 360
        Number of equally spaced input angles over one turn, or the angles themselves in rad. An input without bounds
        takes an array; unless given, theta of ``"minkowski_4r"`` is ``numpy.linspace(-4, 4, 401)``.
    branch : int or sequence of int, default (1, 2)
        Assembly modes.
    solver : {"eliminated", "dense"}
        Joint reactions by elimination, or by LU of the 9x9 system of Hayes et al., eq. (9), which only the planar 4R
        driven by theta1 has.
    extrema : {"refined", "sampled"}, optional
        Whether ``NAME_max``, ``NAME_min`` and their places are exact over the whole turn of the input (the default), or
        taken over the given angles (the default where these are an array).
    verify : int, optional
        How many designs, chosen at random, are computed again with 50 digits after the sweep; the errors found are
        attributes of each variable (see docs/accuracy.md). By default 64 where a file is written, which outlives what
        made it, and none where the result stays in memory, as in the loop of an optimisation. 0 leaves it out.
    to : path, optional
        The HDF5 file to write; without it the result stays in memory.
    overwrite : bool
        Replace an existing file.
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
        What compiles the kernels: fastlink's own translation to LLVM, or numba, which takes seconds where that takes
        tenths of one, to the same bits. By default what the environment variable ``FASTLINK_BACKEND`` says, else
        ``"llvm"``.
    **positions : int or array_like, optional
        The same as `angles`, by the name of the input: ``theta1=72``, or ``F_y=[-0.1, 0.0, 0.1]`` where the input is
        ``"F_y"``.

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
    asked = resolve(
        mechanism,
        space,
        quantities,
        links=links,
        input=input,
        angles=angles,
        positions=positions,
        options=_OPTIONS,
        branch=branch,
        solver=solver,
        extrema=extrema,
        allow_invalid=allow_invalid,
        backend=backend,
    )
    space, count = asked.space, _check_threads(threads)
    sweeping = _Sweep(asked, count, block, verify=check_verify(verify, to is not None))
    about = labels.about(mechanism, asked.plan, asked.solver, asked.positions.size, count, asked.backend)
    about |= attrs or {}
    if asked.scaling_axis is not None:
        about["scaling_axis"] = asked.scaling_axis.name
    target = None if to is None else check_target(to, sweeping.nbytes, overwrite)
    sweeping.load()
    bar = progress_bar(space.size, progress)
    before = time.perf_counter()

    def report(resumed: int = 0) -> dict[str, Any]:
        run_time = time.perf_counter() - before
        found = {"designs": space.size, "set_up_time_s": before - started, "run_time_s": run_time}
        if resumed:
            found["designs_of_earlier_runs"] = resumed
        return found | sweeping.rates(run_time, resumed) | sweeping.counts.attrs()

    with bar:
        if target is None:
            return sweeping.in_memory(bar.take, about, report)
        sweeping.to_file(target, overwrite, bar.take, about, report)
    return open_map(target)


#: The keywords of a sweep besides the name of the input.
_OPTIONS = tuple(name for name in signature(sweep).parameters if name != "positions")


class _Sweep:
    """One sweep: its kernels and labels, and what takes its results.

    Parameters
    ----------
    asked : Asked
        What is computed.
    threads, block : int
        How many threads, and how many designs they take at once.
    verify : int
        How many designs are computed again.
    """

    def __init__(self, asked: ResolvedSweep, threads: int, block: int | None, verify: int) -> None:
        plan, space, positions = asked.plan, asked.space, asked.positions
        self.asked, self.plan, self.space, self.spread = asked, plan, space, asked.scaling_axis
        self.threads, self.block = threads, block
        self.variables = [labels.variable(o, plan, space, positions.size) for o in plan.outputs]
        self.nbytes = sum(variable.nbytes for variable in self.variables)
        self.shapes = [(labels.trailing(o, plan, positions.size), o.dtype) for o in plan.outputs]
        self.counts = StatusCounts(plan)
        self.verification = Verification(plan, space, positions, verify) if verify else None

    def load(self) -> None:
        """Compile the kernels, or load them."""
        self.job = Job(self.asked.parts(), self.shapes, self.asked.evaluated.size)
        if self.spread is not None and self.block is None:
            self.block = max(1, block_length(self.job, self.threads) // self.spread.length)

    def rates(self, run_time: float, resumed: int) -> dict[str, Any]:
        """Return how fast it was."""
        found: dict[str, Any] = {}
        rate = found["designs_per_second"] = (self.space.size - resumed) / run_time
        if self.plan.uses_position:
            of_each = len(self.asked.branches) * self.asked.positions.size
            found["configurations"] = self.space.size * of_each
            found["configurations_per_second"] = rate * of_each
        return found

    def takers(self, show: Sink) -> Sink:
        """Return what takes the results besides the file or the arrays."""
        verified = [] if self.verification is None else [self.verification.take]
        return tee(self.counts.take, *verified, show)

    def measure(self) -> tuple[dict[str, Any], dict[str, dict[str, Any]]]:
        """Return the errors that were found, as attributes of the whole and of the variables."""
        return ({}, {}) if self.verification is None else self.verification.measure()

    def in_memory(
        self, show: Sink, about: dict[str, Any], report: Callable[[], dict[str, Any]]
    ) -> xr.Dataset:
        """Evaluate all designs, and return the labelled results."""
        arrays = [np.empty((self.space.size, *shape), dtype) for shape, dtype in self.shapes]
        take, spread = self.takers(show), self.spread
        if spread is None:
            run(self.job, targets=arrays, deliver=take, threads=self.threads, block=self.block)
        else:
            deliver = spread.over(tee(_into(arrays), take))
            run(self.job, deliver=deliver, threads=self.threads, block=self.block)
        about |= report()
        measured, errors = self.measure()
        variables = [replace(v, attrs=v.attrs | errors.get(v.name, {})) for v in self.variables]
        named = {variable.name: array for variable, array in zip(variables, arrays, strict=True)}
        return labels.assembled(
            self.plan, self.space, self.asked.positions, variables, named, about | measured
        )

    def to_file(
        self,
        target: Path,
        overwrite: bool,
        show: Sink,
        about: dict[str, Any],
        report: Callable[[int], dict[str, Any]],
    ) -> None:
        """Evaluate all designs into a file, or those that a killed run of the same has left."""
        variables, spread = self.variables, self.spread
        coords = labels.coordinates(self.plan, self.space, self.asked.positions)
        key = _fingerprint(self.asked, about, variables), self.job.size
        with Writer(target, coords, variables, about, overwrite=overwrite, run=key) as writer:

            def write(start: int, stop: int, arrays: list[NDArray[Any]]) -> None:
                for variable, array in zip(variables, arrays, strict=True):
                    writer.write(variable.name, start, array)

            take = self.takers(show)
            resumed = _replay(writer, variables, self.shapes, spread, take)
            todo, take = writer.todo, tee(write, take)
            deliver = tee(spread.over(take) if spread else take, lambda a, b, _: writer.record(a, b))
            run(self.job, deliver=deliver, threads=self.threads, block=self.block, todo=todo)
            found = report(resumed)
            errors: dict[str, dict[str, Any]] = {}
            try:
                measured, errors = self.measure()
                found |= measured
            finally:  # what was computed is kept, whatever becomes of its verification
                writer.finish(found, errors)


def _fingerprint(asked: ResolvedSweep, about: Mapping[str, Any], variables: Sequence[Variable]) -> str:
    """Return what tells the file of a sweep from all others, however many threads write it."""
    kept = {name: value for name, value in about.items() if name != "threads"}
    return hashlib.sha256(repr((asked.fingerprint, kept, variables)).encode()).hexdigest()


def _replay(
    writer: Writer,
    variables: Sequence[Variable],
    shapes: Sequence[tuple[tuple[int, ...], str]],
    spread: ScalingAxis | None,
    take: Sink,
) -> int:
    """Hand on what a killed run has written; return how many designs these are."""
    count = 0
    for start, stop in writer.done:
        for first, last in spread.ranges(start, stop) if spread else [(start, stop)]:
            count += last - first
            for k in range(first, last, REPLAYED):
                end = min(k + REPLAYED, last)
                rows = zip(variables, shapes, strict=True)
                take(k, end, [writer.read(variable.name, k, end, shape) for variable, (shape, _) in rows])
    return count


def _check_threads(threads: int | None) -> int:
    if threads is None:
        return default_threads()
    if isinstance(threads, bool) or not isinstance(threads, int) or threads < 1:
        remedy = "write a whole number of at least 1"
        raise InputError(f"is {threads!r}", where=("threads",), remedy=remedy)
    return threads


def _into(whole: list[NDArray[Any]]) -> Sink:
    def deliver(start: int, stop: int, arrays: list[NDArray[Any]]) -> None:
        for kept, array in zip(whole, arrays, strict=True):
            kept[start:stop] = array

    return deliver
