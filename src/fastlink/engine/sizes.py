"""Sweep designs that are far from 1 in units of their own, see `fastlink.catalogue.sizes`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink.catalogue.sizes import (
    PURE,
    DesignSizes,
    Sized,
    dimensional,
    is_ordinary,
    sized,
    sizes_of,
)
from fastlink.plan.gradients import units_of
from fastlink.space.column import Column

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from fastlink.catalogue.catalogue import Catalogue
    from fastlink.plan.plan import Plan
    from fastlink.plan.program import Output
    from fastlink.space.design_space import DesignSpace

__all__ = ["BlockUnits", "UnitsOfDesigns", "dimensional_of", "sized_outputs"]


@dataclass(frozen=True, eq=False)
class UnitsOfDesigns:
    """The designs of a sweep, as seen in units of their own.

    Attributes
    ----------
    catalogue : Catalogue
        The mechanism.
    space : DesignSpace
        The designs.
    results : sequence of Sized
        What each result has of units.
    ordinary : bool
        Whether constants and axes are near 1; columns are looked at block by block.
    names : tuple of str
        The inputs with a dimension.
    columns : tuple of str
        Those of them along the designs that may be far from 1.
    """

    catalogue: Catalogue
    space: DesignSpace
    results: Sequence[Sized]
    ordinary: bool
    names: tuple[str, ...]
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
