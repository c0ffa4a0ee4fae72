"""Axes that only scale results, and designs that are far from 1 and swept in units of their own."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink.engine.run import BLOCK_BYTES, Sink
from fastlink.facts.homogeneity import homogeneity_degrees
from fastlink.facts.names import ErrorBound, Trust
from fastlink.facts.sizes import PURE, DesignSizes, Sized, dimensional, is_ordinary, sized, sizes_of
from fastlink.plan.query import units_of
from fastlink.space.design_space import Column

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from fastlink.facts.catalogue import Catalogue
    from fastlink.plan.programs import Output, Plan
    from fastlink.space.design_space import DesignSpace


# -- Evaluate one value of an axis that only scales results, and multiply

# Rates grow in proportion to omega1, forces to its square or to the density of the links, places not at all
# (see `fastlink.facts.homogeneity`). A swept axis of such an input costs the output of its results and no
# more.


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
                    scaled = [
                        piece if factor is None else piece * factor[k]
                        for piece, factor in zip(pieces, self.factors, strict=True)
                    ]
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
                sink(
                    start,
                    stop,
                    [self._scaled(*pair, values) for pair in zip(pieces, self.factors, strict=True)],
                )

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
    """Return the longest axis of a grid that only scales results, if there is one.

    Its values must be positive: a rate's greatest value is minus its least one where the sense of rotation changes.
    """
    axes = [name for name in space.dims if name in space.axes and len(space.axes[name]) > 1]
    for name in sorted(axes, key=lambda name: -len(space.axes[name])):
        values = space.axes[name]
        powers = _powers(plan, space.names, name) if (values > 0.0).all() else None
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
        degree, of_tolerance = (
            _power(replace(output, request=one), degrees.get(slope), name),
            degrees.get(term.tolerance),
        )
        of_terms.add(None if degree is None or of_tolerance is None else degree + of_tolerance)
    return of_terms.pop() if len(of_terms) == 1 else None


def _power(output: Output, degree: float | None, name: str) -> float | None:
    request = output.request
    if degree is not None and request.by and request.is_position:
        return -1.0 if request.by == name else 0.0
    if degree is None or not request.has_its_units:
        return None if degree is None else 0.0
    return degree if request.reduction is None else request.reduction.degree_of(degree)


# -- Sweep designs that are far from 1 in units of their own, see `fastlink.facts.sizes`


@dataclass(frozen=True, eq=False)
class UnitsOfDesigns:
    """The designs of a sweep, as seen in units of their own."""

    #: The mechanism.
    catalogue: Catalogue
    #: The designs.
    space: DesignSpace
    #: What each result has of units.
    results: Sequence[Sized]
    #: Whether constants and axes are near 1; columns are looked at block by block.
    ordinary: bool
    #: The inputs with a dimension.
    names: tuple[str, ...]
    #: Those of them along the designs that may be far from 1.
    columns: tuple[str, ...]

    @classmethod
    def of(cls, plan: Plan, space: DesignSpace) -> UnitsOfDesigns:
        """Return those of a plan."""
        names = _dimensional(plan, space.names)
        fixed = space.constants | space.axes
        ordinary = all(is_ordinary(fixed[name]) for name in names if name in fixed)
        columns = tuple(name for name in names if name in space.columns and _may_be_far(space.columns[name]))
        return cls(plan.catalogue, space, sized_outputs(plan), ordinary, names, columns)

    def at(self, start: int, stop: int) -> BlockUnits | None:
        """Return the units of some designs, or None where they are kilogram, metre and second."""
        if self.ordinary:
            rows = np.empty((len(self.columns), stop - start))
            self.space.fill(self.columns, start, stop, rows)
            if all(map(is_ordinary, rows)):
                return None
        rows = np.empty((len(self.names), stop - start))
        self.space.fill(self.names, start, stop, rows)
        return BlockUnits.of(self.catalogue, dict(zip(self.names, rows, strict=True)), self.results)


@dataclass(frozen=True, eq=False)
class BlockUnits:
    """Units of designs, their inputs in these, and what their results have of units."""

    sizes: DesignSizes
    inputs: dict[str, NDArray[Any]]
    results: Sequence[Sized]

    @classmethod
    def of(
        cls, catalogue: Catalogue, values: Mapping[str, Any], results: Sequence[Sized]
    ) -> BlockUnits | None:
        """Return those of designs with these inputs, or None where they are kilogram, metre and second."""
        sizes = sizes_of(catalogue, values)
        return None if sizes is None else cls(sizes, sizes.inputs(catalogue, values), results)

    def enter(self, names: Sequence[str], designs: NDArray[Any]) -> None:
        """Write the inputs into the rows of a kernel's designs."""
        for name, row in zip(names, designs, strict=True):
            if name in self.inputs:
                row[: self.sizes.apart.size] = self.inputs[name]

    def leave(self, arrays: Sequence[NDArray[Any]]) -> None:
        """Write results, designs first, in kilogram, metre and second."""
        for of, array in zip(self.results, arrays, strict=True):
            if of != PURE:
                array[...] = self.sizes.result(of, array, array.ndim - 1)


def dimensional_of(catalogue: Catalogue, values: Mapping[str, Any]) -> dict[str, Any]:
    """Return the values of inputs with a dimension."""
    names = dimensional(catalogue, catalogue.version, tuple(values))
    return {name: values[name] for name in names}


def _may_be_far(values: NDArray[Any] | Column) -> bool:
    """Tell whether a value along the designs may be far from 1, by the bounds of one that is computed."""
    if not isinstance(values, Column):
        return True
    low, high = values.bounds
    return not (is_ordinary([low, high]) and 0.0 < low <= high)


@lru_cache(maxsize=256)
def sized_outputs(plan: Plan) -> tuple[Sized, ...]:
    """Return what each result of a plan has of units, found once: to parse names takes longer than one design."""
    return tuple(_sized(plan.catalogue, output) for output in plan.outputs)


@lru_cache(maxsize=256)
def _dimensional(plan: Plan, names: tuple[str, ...]) -> tuple[str, ...]:
    """Return those of these names that are inputs with a dimension, once for a plan."""
    return tuple(dimensional(plan.catalogue, plan.catalogue.version, names))


def _sized(catalogue: Catalogue, output: Output) -> Sized:
    request = output.request
    if not request.has_its_units and not (request.by or request.change):
        return PURE
    return replace(
        sized(catalogue, request.bounded, units_of(request, catalogue)), is_extreme=request.is_error
    )
