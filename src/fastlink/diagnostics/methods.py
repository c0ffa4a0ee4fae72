"""The ways to a quantity: those that the engine offers, and some outside it."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink.catalogue.declare import ELIMINATED
from fastlink.diagnostics import baselines as outside
from fastlink.engine.executor import run
from fastlink.engine.resolve import ResolvedSweep, resolve

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from fastlink.space.design_space import DesignSpace

__all__ = ["SECONDS_OF_DESIGN", "SECONDS_OF_WAY", "Bound", "Method", "Subject", "methods_for", "race"]

#: Numbers of input angles that extremes are taken over, and the one for everything else.
ANGLES = tuple(2**k for k in range(5, 13))
USUAL = 360
#: Ways outside the kernels take so long for each design that few must do.
OUTSIDE_DESIGNS = 8
#: A way is timed for so long at least (other processes leave some runs of that length whole), and with no more designs.
SECONDS, MOST_DESIGNS = 0.002, 2**16
#: Rounds end when none of the ways got faster by this part in so many of them, and after the last.
GAIN, IDLE, MOST_ROUNDS = 0.01, 6, 40
#: What a way and a design of the reference take about, to tell beforehand: compiling, a dozen rounds; 50 digits.
SECONDS_OF_WAY, SECONDS_OF_DESIGN = 0.2, 0.04


@dataclass(frozen=True)
class Subject:
    """A quantity of sampled designs, with the options of `fastlink.sweep` that are the same for all ways."""

    mechanism: str
    space: DesignSpace
    quantity: str
    options: Mapping[str, Any]

    def asked(self, **options: Any) -> ResolvedSweep:
        """Return what is asked for, resolved with further options."""
        return resolve(self.mechanism, self.space, [self.quantity], **{**self.options, **options})


@dataclass(frozen=True)
class Method:
    """One way to a quantity.

    Attributes
    ----------
    name : str
        As in the table.
    options : mapping
        Of `fastlink.sweep`.
    relaxed : bool
        Whether the kernel is compiled with relaxed arithmetic.
    outside : callable, optional
        ``outside(asked, designs)`` returns the values of the first designs without any kernel.
    """

    name: str
    options: Mapping[str, Any] = field(default_factory=dict)
    relaxed: bool = False
    outside: Callable[[ResolvedSweep, int], NDArray[Any]] | None = None

    def bind(self, subject: Subject) -> Bound:
        """Return this way to a quantity, evaluated once and ready to be timed."""
        if self.outside is not None:
            asked = subject.asked(**self.options)
            designs = min(subject.space.size, OUTSIDE_DESIGNS)
            started = time.perf_counter()
            values = self.outside(asked, designs)
            return Bound(values, designs, None, time.perf_counter() - started)
        bound = self._kernels(subject)
        while (seconds := min(bound.time() for _ in range(3))) < SECONDS and bound.designs < MOST_DESIGNS:
            times = 2 ** math.ceil(math.log2(2 * SECONDS / max(seconds, SECONDS / 64)))
            subject = replace(subject, space=_repeated(subject.space, times))
            bound = self._kernels(subject)
        return bound

    def _kernels(self, subject: Subject) -> Bound:
        asked = subject.asked(**self.options)
        job = asked.job(relaxed=self.relaxed)
        arrays = [np.empty((asked.space.size, *shape), dtype) for shape, dtype in job.shapes]
        return Bound(arrays[0], asked.space.size, partial(run, job, targets=arrays))


@dataclass
class Bound:
    """A way to a quantity of some designs: its values, and the least time that they took by one thread."""

    values: NDArray[Any]
    designs: int
    call: Callable[[], None] | None
    seconds: float = math.inf

    def time(self) -> float:
        """Evaluate again, unless it takes long, and return the least time so far."""
        if self.call is not None:
            started = time.perf_counter()
            self.call()
            self.seconds = min(self.seconds, time.perf_counter() - started)
        return self.seconds


def race(subject: Subject, ways: Iterable[Method]) -> dict[str, Bound]:
    """Return every way by name, timed in turns: what else the machine does then meets all alike."""
    bound = {way.name: way.bind(subject) for way in ways}
    idle = 0
    for _ in range(MOST_ROUNDS):
        before = [one.seconds for one in bound.values()]
        after = [one.time() for one in bound.values()]
        gained = any(now < (1.0 - GAIN) * then for then, now in zip(before, after, strict=True))
        idle = 0 if gained else idle + 1
        if idle == IDLE:
            break
    return bound


def _repeated(space: DesignSpace, times: int) -> DesignSpace:
    """Return the same designs so many times."""
    columns = {name: np.tile(column, times) for name, column in space.columns.items()}
    return replace(space, shape=(space.size * times,), columns=columns)


def methods_for(subject: Subject, with_outside: bool) -> list[Method]:
    """Return every way to a quantity that its mechanism offers."""
    asked = subject.asked()
    output = asked.plan.outputs[0]
    others = [name for name in asked.catalogue.solvers if name != ELIMINATED and asked.solver]
    if output.request.reduction is None:
        ways = [Method(solver, {"solver": solver}) for solver in (ELIMINATED, *others)]
        ways.append(Method(f"{ELIMINATED}, relaxed", relaxed=True))
        if with_outside:
            ways.append(Method("NumPy", outside=outside.by_numpy))
            ways.append(Method("NumPy, single precision", outside=outside.by_numpy_single))
        return ways
    ways = []
    if output.refined:
        ways += [Method("refined"), Method("refined, relaxed", relaxed=True)]
    if asked.catalogue.positions is not None:  # an input without bounds has no whole turn
        return ways
    sampled = {"extrema": "sampled", "angles": USUAL}
    ways += [Method(f"{count} angles", {**sampled, "angles": count}) for count in ANGLES]
    ways += [Method(f"{USUAL} angles, {solver}", {**sampled, "solver": solver}) for solver in others]
    ways.append(Method(f"{USUAL} angles", sampled))
    ways.append(Method(f"{USUAL} angles, relaxed", sampled, relaxed=True))
    if with_outside:
        ways.append(Method(f"NumPy, {USUAL} angles", sampled, outside=outside.by_numpy))
        ways.append(Method("scipy, minimize_scalar", sampled, outside=outside.by_minimize))
        if output.refined:
            ways.append(Method("scipy, brentq", sampled, outside=outside.by_brentq))
    return ways
