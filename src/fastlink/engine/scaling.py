"""Axes that only scale results, and designs with numbers beyond the range of doubles."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink.engine.run import BLOCK_BYTES, Sink
from fastlink.facts.arc import ARC_ENDS
from fastlink.facts.fact import Fact, Input, System
from fastlink.facts.names import ErrorBound, Trust
from fastlink.facts.powers import Powers, UnlikePowers, any_beyond_range, beyond_range, limits
from fastlink.plan.request import flag_beyond_range
from fastlink.space.design_space import Column, DesignSpace

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from fastlink.plan.programs import Output, Plan


# -- Evaluate one value of an axis that only scales results, and multiply

# Rates grow in proportion to omega1, forces to its square or to the density of the links, places not at all
# (the facts say so by themselves, on numbers of `fastlink.facts.powers`). A swept axis of such an input costs
# the output of its results and no more.


@dataclass(frozen=True)
class ScalingAxis:
    """An input that only scales results, and the designs without its axis."""

    #: The input.
    name: str
    #: The designs that are evaluated, at 1 for that input.
    space: DesignSpace
    #: How many of them follow each other before the axis moves on.
    inner: int
    #: For each result its factor at each value of the axis; None where it stays the same.
    factors: tuple[NDArray[Any] | None, ...]
    #: Number of values of the axis.
    length: int

    def over(self, sink: Sink, most: int = BLOCK_BYTES) -> Sink:
        """Return a sink of evaluated designs that passes on the results of all, at most so many bytes of slabs."""

        def scale(start: int, stop: int, arrays: list[NDArray[Any]]) -> None:
            for first, last, in_slabs in self._pieces(start, stop):
                pieces = [array[first - start : last - start] for array in arrays]
                if in_slabs:
                    self._pass_slabs(sink, first, last, pieces, most)
                    continue
                for k, begin in enumerate(self._starts(first)):
                    pairs = zip(pieces, self.factors, strict=True)
                    scaled = [piece if factor is None else piece * factor[k] for piece, factor in pairs]
                    sink(begin, begin + last - first, scaled)

        return scale

    def _pass_slabs(self, sink: Sink, first: int, last: int, arrays: list[NDArray[Any]], most: int) -> None:
        """Pass on the results that follow from whole slabs, as many at once as have so many bytes."""
        nbytes = sum(array.nbytes for array in arrays)
        slabs = (last - first) // self.inner
        slabs_at_once = max(1, most * slabs // (nbytes * self.length))
        step = self.length if nbytes * self.length <= most * slabs else max(1, most * slabs // nbytes)
        for begin in range(first, last, slabs_at_once * self.inner):
            end = min(begin + slabs_at_once * self.inner, last)
            slabs_at_once = (end - begin) // self.inner
            pieces = [array[begin - first : end - first] for array in arrays]
            for k in range(0, self.length, step):
                values = slice(k, min(k + step, self.length))
                start = begin * self.length + k * self.inner
                stop = start + slabs_at_once * self.inner * (values.stop - k)
                # without a name: those before would stay until these are computed
                pairs = zip(pieces, self.factors, strict=True)
                sink(start, stop, [self._scaled(*pair, values) for pair in pairs])

    def ranges(self, start: int, stop: int) -> Iterator[tuple[int, int]]:
        """Yield the ranges of all designs that follow from a range of evaluated ones."""
        for first, last, in_slabs in self._pieces(start, stop):
            if in_slabs:
                yield first * self.length, last * self.length
            else:
                yield from ((begin, begin + last - first) for begin in self._starts(first))

    def evaluated(self, start: int, stop: int) -> Iterator[tuple[int, int]]:
        """Yield the ranges of evaluated designs that a range of all designs follows from, or a little more."""
        of_slab = self.length * self.inner
        if stop - start > of_slab:
            yield start // of_slab * self.inner, -(-stop // of_slab) * self.inner
            return
        while start < stop:
            slab, offset = start // of_slab, start % self.inner
            count = min(self.inner - offset, stop - start)
            yield slab * self.inner + offset, slab * self.inner + offset + count
            start += count

    def _starts(self, first: int) -> list[int]:
        """Return the number among all designs of an evaluated one, at each axis value."""
        slab, offset = divmod(first, self.inner)
        return [(slab * self.length + k) * self.inner + offset for k in range(self.length)]

    def _pieces(self, start: int, stop: int) -> list[tuple[int, int, bool]]:
        """Cut a range where the axis moves on: whole slabs are contiguous in the result."""
        first, last = -(-start // self.inner) * self.inner, stop // self.inner * self.inner
        if first >= last:
            cuts = sorted({start, *([first] if start < first < stop else []), stop})
            return [(a, b, False) for a, b in itertools.pairwise(cuts)]
        pieces = [(start, first, False), (first, last, True), (last, stop, False)]
        return [piece for piece in pieces if piece[0] < piece[1]]

    def _scaled(self, piece: NDArray[Any], factor: NDArray[Any] | None, values: slice) -> NDArray[Any]:
        """Return whole slabs at some values of the axis, in the order of all designs."""
        slabs = piece.reshape(-1, 1, self.inner, *piece.shape[1:])
        if factor is None:
            scaled = np.repeat(slabs, values.stop - values.start, axis=1)
        else:
            scaled = slabs * factor[values].reshape(-1, *[1] * (slabs.ndim - 2))
        return scaled.reshape(-1, *piece.shape[1:])


def find_scaling_axis(plan: Plan, space: DesignSpace) -> ScalingAxis | None:
    """Return the longest axis of a grid that only scales results, if there is one."""
    # Its values must be positive: a rate's greatest value is minus its least one where the sense of rotation
    # changes.
    known = plan.catalogue.known_inputs(plan.variants)
    # extremes over an arc are none of the quantity alone: its ends scale nothing
    axes = [name for name in space.dims if name in space.axes and len(space.axes[name]) > 1]
    axes = [name for name in axes if name not in ARC_ENDS]
    for name in sorted(axes, key=lambda name: -len(space.axes[name])):
        values = space.axes[name]
        scales = (values > 0.0).all() and not np.any(beyond_range(known[name], values))
        powers = _powers(plan, space.names, name) if scales else None
        if powers is None:
            continue
        k = space.dims.index(name)
        rest = replace(
            space,
            dims=space.dims[:k] + space.dims[k + 1 :],
            shape=space.shape[:k] + space.shape[k + 1 :],
            axes={key: axis for key, axis in space.axes.items() if key != name},
            constants={**space.constants, name: 1.0},
        )
        factors = tuple(None if power == 0.0 else values**power for power in powers)
        return ScalingAxis(name, rest, math.prod(space.shape[k + 1 :]), factors, len(values))
    return None


@lru_cache(maxsize=256)
def _powers(plan: Plan, given: tuple[str, ...], name: str) -> list[float] | None:
    """Return the power of an input by which each result grows, or None."""
    catalogue = plan.catalogue
    if catalogue.known_inputs(plan.variants)[name].choices:
        return None
    tables = (catalogue.position.name, *catalogue.tables, *catalogue.table_low_parts)
    quantities = [output.request.bounded for output in plan.outputs]
    bounds = any(output.request.is_error for output in plan.outputs)
    if bounds or any(isinstance(catalogue.parse(quantity), (ErrorBound, Trust)) for quantity in quantities):
        return None  # an error bound knows nothing of the rounding of one more product
    quantities += [name for o in plan.outputs for name in (*o.slopes, *(term.tolerance for term in o.terms))]
    steps = catalogue.dependencies(quantities, (*given, *tables, "branch"), plan.variants)
    degrees = homogeneity_degrees(steps, name)
    powers = [_power_of(output, degrees, name) for output in plan.outputs]
    return None if None in powers else [power for power in powers if power is not None]


def _power_of(output: Output, degrees: Mapping[str, float | None], name: str) -> float | None:
    """Return the power of an input by which a result grows, or None."""
    if not output.terms:
        return _power(output, degrees.get(output.request.bounded), name)
    of_terms = set[float | None]()
    for slope, term in zip(output.slopes, output.terms, strict=True):
        one = replace(output.request, by=term.by, change="")
        degree = _power(replace(output, request=one), degrees.get(slope), name)
        of_tolerance = degrees.get(term.tolerance)
        of_terms.add(None if degree is None or of_tolerance is None else degree + of_tolerance)
    return of_terms.pop() if len(of_terms) == 1 else None


def _power(output: Output, degree: float | None, name: str) -> float | None:
    request = output.request
    if degree is not None and request.by and request.is_position:
        return -1.0 if request.by == name else 0.0
    if degree is None or not request.has_its_units:
        return None if degree is None else 0.0
    return degree if request.reduction is None else request.reduction.degree_of(degree)


def homogeneity_degrees(steps: Iterable[Fact | System], name: str) -> dict[str, float | None]:
    """Return the power of an input by which each value grows, or None."""
    degrees: dict[str, Powers | None] = {name: Powers((1.0,))}
    for step in steps:
        known = [degrees.get(part, Powers((0.0,))) for part in step.depends_on]
        degrees |= zip(step.names, _degrees(step, known), strict=True)
    return {of: None if value is None else value.powers[0] for of, value in degrees.items()}


def _degrees(step: Fact | System, known: Sequence[Powers | None]) -> Sequence[Powers | None]:
    """Return the powers of the values of a step, None where they follow from none."""
    unknown, pure = [None] * len(step.names), Powers((0.0,))
    given = [value for value in known if value is not None]
    if len(given) < len(known):
        return unknown
    if not any(value.powers[0] for value in given):
        return [pure] * len(step.names)
    if isinstance(step, System):
        return unknown
    try:
        value = step.formula(*given)
    except (UnlikePowers, TypeError, AttributeError):
        return unknown
    values = [value] if step.low is None else value
    return [one if isinstance(one, Powers) else pure for one in values]


# -- Flag designs with a number beyond the range in which all steps stay normal numbers


@dataclass(frozen=True, eq=False)
class FarDesigns:
    """The designs of a sweep with an input beyond its limits, see `fastlink.facts.powers.limits`."""

    #: All designs.
    space: DesignSpace
    #: The inputs that may be beyond their limits.
    inputs: Mapping[str, Input]
    #: Which result is the status, and its code for such designs.
    status: tuple[int, int] | None

    @classmethod
    def of(cls, plan: Plan, space: DesignSpace) -> FarDesigns:
        """Return those of a plan."""
        known, fixed = plan.catalogue.known_inputs(plan.variants), space.constants | space.axes
        far = [name for name in fixed if np.any(beyond_range(known[name], fixed[name]))]
        far += [name for name, values in space.columns.items() if _may_be_beyond(known[name], values)]
        inputs = {name: known[name] for name in space.names if name in far}
        names = [output.name for output in plan.outputs]
        return cls(space, inputs, flag_beyond_range(plan.catalogue, names))

    def at(self, start: int, stop: int) -> NDArray[np.bool_] | None:
        """Tell which of some designs they are; None if none of them is."""
        if not self.inputs:
            return None
        rows = np.empty((len(self.inputs), stop - start))
        self.space.fill(tuple(self.inputs), start, stop, rows)
        far = any_beyond_range(self.inputs, dict(zip(self.inputs, rows, strict=True)))
        return far if far.any() else None

    def flag(self, arrays: Sequence[NDArray[Any]], far: NDArray[np.bool_]) -> None:
        """Write the status of such designs into the results."""
        if self.status is not None:
            arrays[self.status[0]][far] = self.status[1]


def _may_be_beyond(declared: Input, values: NDArray[Any] | Column) -> bool:
    """Tell whether a value along the designs may be beyond its limits, by the bounds of one that is computed."""
    least, most = limits(declared.units, declared.rule)
    if not isinstance(values, Column):
        return most < math.inf
    low, high = values.bounds
    return not ((low > least or least == 0.0) and -most < low and high < most)
