"""The methods for a quantity, NumPy among them, and their run times."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink.catalogue.declare import ELIMINATED
from fastlink.engine.executor import Job, run
from fastlink.engine.resolve import ResolvedSweep, resolve
from fastlink.precision.sample import read_curves

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from fastlink.engine.extending import Extension
    from fastlink.space.design_space import DesignSpace

__all__ = [
    *("SECONDS_PER_DESIGN", "SECONDS_PER_METHOD", "USUAL", "Method", "Subject", "Trial"),
    *("by_numpy", "curves_by_numpy", "methods_for", "race"),
]

#: Numbers of input angles that extremes are sampled at, and the one for everything else.
ANGLES = tuple(2**k for k in range(5, 13))
USUAL = 360
#: Methods outside the kernels are so slow that only a few designs are evaluated.
BASELINE_DESIGNS = 8
#: A run that is timed lasts at least so long (other processes leave some runs of that length whole), with at most so
#: many designs.
SECONDS, MOST_DESIGNS = 0.002, 2**16
#: Rounds end when no method got faster by this share in so many of them, and after the last.
GAIN, IDLE, MOST_ROUNDS = 0.01, 6, 40
#: A method takes about so long (compiling, a dozen rounds), and so does a design of the 50-digit reference.
SECONDS_PER_METHOD, SECONDS_PER_DESIGN = 0.2, 0.04


@dataclass(frozen=True)
class Subject:
    """A quantity of sampled designs, with the options that all methods share."""

    mechanism: str | Extension
    space: DesignSpace
    quantity: str
    options: Mapping[str, Any]

    def resolve(self, **options: Any) -> ResolvedSweep:
        """Return the request, resolved with further options."""
        return resolve(self.mechanism, self.space, [self.quantity], **{**self.options, **options})


@dataclass(frozen=True)
class Method:
    """One method to compute a quantity.

    Attributes
    ----------
    name : str
        As in the table.
    options : mapping
        Of `fastlink.sweep`.
    job : callable
        ``job(resolved)`` returns the compiled kernels with their designs and input positions.
    baseline : callable, optional
        ``baseline(resolved, designs)`` returns the values of the first designs without any kernel.
    """

    name: str
    options: Mapping[str, Any] = field(default_factory=dict)
    job: Callable[[ResolvedSweep], Job] = ResolvedSweep.job
    baseline: Callable[[ResolvedSweep, int], NDArray[Any]] | None = None

    def prepare(self, subject: Subject) -> Trial:
        """Return the values of a quantity by this method, ready to be timed again."""
        if self.baseline is not None:
            resolved = subject.resolve(**self.options)
            designs = min(subject.space.size, BASELINE_DESIGNS)
            started = time.perf_counter()
            values = self.baseline(resolved, designs)
            return Trial(values, designs, None, time.perf_counter() - started)
        trial = self._run_kernels(subject)
        while (seconds := min(trial.time() for _ in range(3))) < SECONDS and trial.designs < MOST_DESIGNS:
            times = 2 ** math.ceil(math.log2(2 * SECONDS / max(seconds, SECONDS / 64)))
            subject = replace(subject, space=_repeated(subject.space, times))
            trial = self._run_kernels(subject)
        return trial

    def _run_kernels(self, subject: Subject) -> Trial:
        resolved = subject.resolve(**self.options)
        job = self.job(resolved)
        arrays = [np.empty((resolved.space.size, *shape), dtype) for shape, dtype in job.shapes]
        return Trial(arrays[0], resolved.space.size, partial(run, job, targets=arrays))


@dataclass
class Trial:
    """The values of a quantity by a method, and their least time on one thread."""

    values: NDArray[Any]
    designs: int
    run: Callable[[], None] | None
    seconds: float = math.inf

    def time(self) -> float:
        """Evaluate again, unless the method is a slow one, and return the least time so far."""
        if self.run is not None:
            started = time.perf_counter()
            self.run()
            self.seconds = min(self.seconds, time.perf_counter() - started)
        return self.seconds


def race(subject: Subject, methods: Iterable[Method]) -> dict[str, Trial]:
    """Return the trial of each method by name, timed in turns under the same load."""
    trials = {method.name: method.prepare(subject) for method in methods}
    idle = 0
    for _ in range(MOST_ROUNDS):
        before = [trial.seconds for trial in trials.values()]
        after = [trial.time() for trial in trials.values()]
        gained = any(now < (1.0 - GAIN) * then for then, now in zip(before, after, strict=True))
        idle = 0 if gained else idle + 1
        if idle == IDLE:
            break
    return trials


def _repeated(space: DesignSpace, times: int) -> DesignSpace:
    """Return the same designs so many times."""
    columns = {name: np.tile(column, times) for name, column in space.columns.items()}
    return replace(space, shape=(space.size * times,), columns=columns)


def methods_for(subject: Subject, with_numpy: bool) -> list[Method]:
    """Return every method that the mechanism of a quantity offers, and NumPy's if wanted."""
    resolved = subject.resolve()
    output = resolved.plan.outputs[0]
    others = [name for name in resolved.catalogue.solvers if name != ELIMINATED and resolved.solver]
    if output.request.reduction is None:
        methods = [Method(solver, {"solver": solver}) for solver in (ELIMINATED, *others)]
        return [*methods, *([Method("NumPy", baseline=by_numpy)] if with_numpy else [])]
    methods = [Method("refined")] if output.refined else []
    if resolved.catalogue.positions is not None:  # an input without bounds has no whole turn
        return methods
    sampled = {"extrema": "sampled", "angles": USUAL}
    methods += [Method(f"{count} angles", {**sampled, "angles": count}) for count in ANGLES]
    methods += [Method(f"{USUAL} angles, {solver}", {**sampled, "solver": solver}) for solver in others]
    methods.append(Method(f"{USUAL} angles", sampled))
    if with_numpy:
        methods.append(Method(f"NumPy, {USUAL} angles", sampled, baseline=by_numpy))
    return methods


def curves_by_numpy(resolved: ResolvedSweep, designs: int) -> NDArray[Any]:
    """Return a quantity (designs, branches, positions) from facts read by NumPy, NaN where positions do not count."""
    values: dict[str, Any] = {
        name: column[:, None, None] for name, column in resolved.space.at(np.arange(designs)).items()
    }
    values["branch"] = np.array(resolved.branches, dtype=float)[:, None]
    plan, positions = resolved.plan, resolved.positions
    output, shape = plan.outputs[0], (designs, len(resolved.branches), positions.size)
    samples, *counted = (
        read_curves(resolved.catalogue, name, values, positions, plan.variants)
        for name in (output.request.quantity, output.counted)
        if name
    )
    for numbers in counted:
        samples = np.where(np.isnan(numbers), np.nan, samples)
    return np.broadcast_to(samples, shape)


def by_numpy(resolved: ResolvedSweep, designs: int) -> NDArray[Any]:
    """Return values of a fact of the design, curves, or their extreme samples."""
    curves, request = curves_by_numpy(resolved, designs), resolved.plan.outputs[0].request
    if not resolved.catalogue.varies(request.quantity):
        return curves[:, 0, 0]
    if request.reduction is None:
        return curves
    sign = request.reduction.sign
    extremes: NDArray[Any] = sign * np.fmax.reduce(sign * curves, axis=-1)
    return extremes
