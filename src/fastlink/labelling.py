"""What a result says of itself in the file: dimensions, units, meanings, sources, provenance."""

from __future__ import annotations

from importlib.metadata import PackageNotFoundError, version
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink.catalogue import Catalogue, Input
from fastlink.closure import Closure, Output
from fastlink.label import Variable
from fastlink.label import coordinates as dataset_coordinates

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import NDArray

    from fastlink.space import DesignSpace

__all__ = ["about", "coordinates", "trailing", "variable"]


def trailing(output: Output, plan: Closure, positions: int) -> tuple[int, ...]:
    """Return what each design has of a result."""
    lengths = {"branch": len(plan.branches), plan.catalogue.position.name: positions}
    return tuple(lengths[axis] for axis in output.axes)


def variable(output: Output, plan: Closure, space: DesignSpace, positions: int) -> Variable:
    """Return a result with its dimensions and attributes."""
    fact = plan.catalogue.require(output.request.quantity)
    position = plan.catalogue.position
    reduction, place = output.request.reduction, output.request.place
    attrs: dict[str, Any] = {"units": fact.units, "long_name": fact.meaning, "symbol": fact.symbol}
    if reduction is not None:
        attrs["long_name"] = f"{fact.meaning}, {reduction.phrase}"
        attrs["symbol"] = f"{reduction.suffix} {fact.symbol}"
        if place:
            attrs = {
                "units": position.units,
                "long_name": f"{position.meaning}, where {fact.symbol} is {reduction.phrase}",
                "symbol": f"{position.symbol} at {reduction.suffix} {fact.symbol}",
            }
    attrs["references"] = fact.source
    if fact.flags:
        del attrs["units"]
        attrs["flag_values"] = np.array(list(fact.flags), dtype=output.dtype)
        attrs["flag_meanings"] = " ".join(fact.flags.values())
    return Variable(
        output.name,
        (*space.dims, *output.axes),
        (*space.shape, *trailing(output, plan, positions)),
        np.dtype(output.dtype),
        attrs,
    )


def coordinates(plan: Closure, space: DesignSpace, positions: NDArray[Any]) -> xr.Dataset:
    """Return a Dataset with the coordinates of a sweep."""
    catalogue: Catalogue = plan.catalogue
    used = {axis for output in plan.outputs for axis in output.axes}
    further: dict[str, Any] = {}
    if "branch" in used:
        meanings = "; ".join(f"{branch}: {meaning}" for branch, meaning in catalogue.branches.items())
        labels = {"long_name": "assembly mode", "comment": meanings}
        further["branch"] = (("branch",), np.array(plan.branches, dtype=np.int32), labels)
    position = catalogue.position
    if position.name in used:
        further[position.name] = ((position.name,), positions, _describe(position))
    known = catalogue.known_inputs(plan.alternatives)
    return dataset_coordinates(space, {name: _describe(known[name]) for name in space.names}, further)


def about(mechanism: str, plan: Closure, solver: str, positions: int, threads: int) -> dict[str, Any]:
    """Return the global attributes that are known before a sweep."""
    catalogue = plan.catalogue
    attrs: dict[str, Any] = {
        "Conventions": "CF-1.11",
        "title": f"{catalogue.title}: {', '.join(output.name for output in plan.outputs)}",
        "mechanism": mechanism,
        "input": catalogue.position.name,
        "source": f"fastlink {_version('fastlink-linkages')}, numba {_version('numba')}, numpy {np.__version__}",
        "solver": solver,
        "threads": threads,
    }
    if plan.uses_position:
        attrs[f"{catalogue.position.name}_count"] = positions
        attrs["extrema"] = "sampled"
    return attrs


def _describe(declared: Input) -> dict[str, Any]:
    """Return the labels of an input."""
    return {"units": declared.units, "long_name": declared.meaning, "symbol": declared.symbol}


def _version(distribution: str) -> str:
    try:
        return version(distribution)
    except PackageNotFoundError:
        return "unknown"
