"""Labels of the results: dimensions, units, meanings, sources, provenance."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink._text import __version__, counted, version
from fastlink.engine.resolve import ResolvedSweep
from fastlink.facts.arc import ARC
from fastlink.facts.catalogue import Catalogue
from fastlink.facts.derivative import in_a_sentence, worded
from fastlink.facts.fact import Fact, Input
from fastlink.facts.own import definition_text
from fastlink.io.layout import (
    Variable,
    assemble,
    computed_coordinates,
    coordinates,
    marked,
    of_code,
    plain_attrs,
)
from fastlink.mechanisms import sheet_of
from fastlink.plan.programs import Output, Plan
from fastlink.plan.query import STATUS_FLAGS, Request, units_of
from fastlink.space.design_space import BRANCH, EXTREMUM, Column, DesignSpace, frozen
from fastlink.space.tables import MAPS

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import NDArray


def variables(resolved: ResolvedSweep) -> list[Variable]:
    """Return the results with dimensions and attributes."""
    plan, space, lengths = resolved.plan, resolved.space, resolved.lengths
    # where the branch was given as a scalar, it is a coordinate and not a dimension
    dropped = (BRANCH,) if resolved.one_branch else ()
    swept = list(zip(space.dims, space.shape, strict=True))
    results = []
    for output in plan.outputs:
        own = [(axis, lengths[axis]) for axis in output.axes if axis not in dropped]
        leading = len(own) if resolved.layout == MAPS and swept else 0
        dims, shape = (
            zip(*(own + swept if leading else swept + own), strict=True) if swept or own else ((), ())
        )
        dtype, attrs = np.dtype(output.dtype), dict(_labels(plan, output))
        results.append(Variable(output.name, dims, shape, dtype, attrs, leading))
    return results


def request_labels(catalogue: Catalogue, request: Request) -> dict[str, Any]:
    """Return units, meaning, symbol and source of a requested name, as attributes."""
    fact = catalogue.public_fact(request.quantity)
    position = catalogue.position
    reduction = request.reduction
    attrs: dict[str, Any] = {"units": fact.units, "long_name": fact.title, "symbol": fact.symbol}
    if reduction is not None:
        attrs["units"] = reduction.units_of(fact.units)
        attrs["long_name"] = f"{fact.title}, {reduction.phrase}"
        attrs["symbol"] = f"{reduction.suffix} {fact.symbol}"
        if request.is_position:
            attrs = {
                "units": position.units,
                "long_name": f"{position.title}, where {fact.symbol} is {reduction.phrase}",
                "symbol": f"{position.symbol} at {reduction.suffix} {fact.symbol}",
            }
    if request.other and reduction is not None:
        point = request.quantity.removesuffix("_x")
        attrs["long_name"] = f"Path of {point}: {reduction.phrase}"
        attrs["symbol"] = f"{reduction.suffix} {point}"
    if request.listed:
        attrs = _of_list(request.listed, fact, position)
    attrs["references"] = fact.source
    if request.is_of_gradient:
        attrs |= _of_gradient(catalogue, request, attrs)
    if request.is_error:
        attrs["long_name"] = f"{attrs['long_name']}: error bound"
        attrs["symbol"] = f"err {attrs['symbol']}"
        attrs["references"] = catalogue.public_fact(request.bounded).source
    if fact.remark and attrs["long_name"].startswith(fact.title):
        attrs["comment"] = fact.remark
    return attrs


def _of_gradient(catalogue: Catalogue, request: Request, attrs: Mapping[str, Any]) -> dict[str, Any]:
    """Return the attributes of a derivative of a result over the cycle by an input, or of the status of all."""
    if request.is_status:
        meaning = f"Status of the derivatives by the inputs of: {attrs['long_name']}"
        return {"long_name": meaning, "symbol": f"status of grad {attrs['symbol']}"}
    if request.change:
        meaning = worded(request.change, attrs["long_name"])
        return {"long_name": meaning, "symbol": f"{request.change} change {attrs['symbol']}"}
    by, of = catalogue.variables[request.by], request.quantity if request.is_position else request.bounded
    return {
        "units": units_of(request, catalogue),
        "long_name": f"Derivative with respect to {in_a_sentence(by.title)} of: {attrs['long_name']}",
        "symbol": f"d {attrs['symbol']}/d {by.symbol}",
        "references": catalogue.public_fact(of).source,
    }


@lru_cache(maxsize=1024)
def _labels(plan: Plan, output: Output) -> dict[str, Any]:
    """Return the attributes of a result."""
    fact = plan.catalogue.public_fact(output.request.quantity)
    attrs = request_labels(plan.catalogue, output.request)
    if output.request.can_be_refined:
        attrs["extrema"] = "refined" if output.refined else "sampled"
        if not output.refined:
            of_samples = f"of {counted(plan.positions, 'position')}"
            attrs["long_name"] = attrs["long_name"].replace("over the cycle", of_samples)
    if ARC in plan.variants:
        attrs["long_name"] = attrs["long_name"].replace("over the cycle", "over the arc")
    if output.request.is_status:
        del attrs["units"]
        attrs |= flag_attrs(STATUS_FLAGS, output.dtype)
    if fact.flags and output.request.is_of_quantity:
        del attrs["units"]
        attrs |= flag_attrs(fact.flags, output.dtype)
    return attrs


def _of_list(part: str, fact: Fact, position: Input) -> dict[str, Any]:
    """Return the attributes of listed extremes, or of their places, kinds or number."""
    if part in ("value", "error"):
        return {"units": fact.units, "long_name": f"{fact.title}, extremes", "symbol": f"ext {fact.symbol}"}
    if part == "position":
        meaning = f"{position.title}, where {fact.symbol} is extreme"
        symbol = f"{position.symbol} at ext {fact.symbol}"
        return {"units": position.units, "long_name": meaning, "symbol": symbol}
    if part == "count":
        meaning = f"number of extremes of {fact.symbol}"
        return {"units": "1", "long_name": meaning, "symbol": f"n ext {fact.symbol}"}
    return {
        "long_name": f"kinds of the extremes of {fact.symbol}",
        "symbol": f"kind of ext {fact.symbol}",
        **flag_attrs({-1: "minimum", 0: "none", 1: "maximum"}, "int8"),
    }


def coordinates_of(resolved: ResolvedSweep, left_out: Collection[str] = ()) -> xr.Dataset:
    """Return a Dataset with the coordinates of a sweep."""
    # Those that are left out are written block by block, see `computed`.
    plan, space, catalogue = resolved.plan, resolved.space, resolved.catalogue
    used = {axis for output in plan.outputs for axis in output.axes}
    further: dict[str, Any] = {}
    if BRANCH in used:
        meanings = "; ".join(f"{branch}: {meaning}" for branch, meaning in catalogue.branches.items())
        labels = {"long_name": "assembly mode", "comment": meanings}
        modes = frozen(np.array(plan.branches, dtype=np.int32))
        further[BRANCH] = ((), modes[0], labels) if resolved.one_branch else ((BRANCH,), modes, labels)
    if EXTREMUM in used:
        labels = {"long_name": f"number of the extreme, by growing {catalogue.position.name}"}
        further[EXTREMUM] = ((EXTREMUM,), frozen(np.arange(1, plan.extrema_kept + 1, dtype=np.int32)), labels)
    position = catalogue.position
    if position.name in used:
        further[position.name] = ((position.name,), resolved.positions, _describe(position, space))
    return coordinates(space, _described(resolved), further, left_out)


def computed(resolved: ResolvedSweep) -> list[tuple[Variable, Column]]:
    """Return the coordinates of a sweep that are computed where they are looked at, with their labels."""
    return computed_coordinates(resolved.space, _described(resolved))


def _described(resolved: ResolvedSweep) -> dict[str, dict[str, Any]]:
    known, space = resolved.catalogue.known_inputs(resolved.plan.variants), resolved.space
    return {name: _describe(known[name], space) for name in space.names}


def labelled(
    resolved: ResolvedSweep,
    variables: Sequence[Variable],
    arrays: Sequence[NDArray[Any]],
    attrs: Mapping[str, Any],
) -> xr.Dataset:
    """Return the labelled Dataset of a sweep that stays in memory."""
    # That of one design is a copy of the last one of its kind: 0.1 ms, where xarray takes 0.8 ms to make it
    # anew, more than all the rest of such a sweep.
    plan, space = resolved.plan, resolved.space
    data = {
        variable.name: variable.arranged(array) for variable, array in zip(variables, arrays, strict=True)
    }
    if space.dims or space.labels or space.comments:
        return assemble(coordinates_of(resolved), variables, data, attrs)
    used = any(plan.catalogue.position.name in output.axes for output in plan.outputs)
    kind = tuple(space.constants), tuple(space.attrs.items()), resolved.positions.tobytes() if used else b""
    dataset = _blank(plan, *kind, resolved.one_branch).copy(deep=False, data=data)
    for name, value in space.constants.items():
        constant = dataset.variables[name]
        data, constant.attrs = of_code(value, constant.attrs)
        constant.data = np.array(data)
    for variable in variables:
        dataset.variables[variable.name].attrs = plain_attrs(variable.attrs)
    dataset.attrs |= marked(attrs)
    return dataset


@lru_cache(maxsize=64)
def _blank(
    plan: Plan, names: tuple[str, ...], attrs: tuple[tuple[str, Any], ...], positions: bytes, one_branch: bool
) -> xr.Dataset:
    """Return the Dataset of one design without its values."""
    known = plan.catalogue.known_inputs(plan.variants)
    some = {name: float(min(known[name].choices or (0,))) for name in names}
    space = DesignSpace("grid", (), (), some, attrs=dict(attrs))
    resolved = ResolvedSweep("", space, plan, np.frombuffer(positions), "", None, "", one_branch)
    results = variables(resolved)
    values = {variable.name: np.empty(variable.shape, variable.dtype) for variable in results}
    return assemble(coordinates_of(resolved), results, values, {})


def global_attrs(resolved: ResolvedSweep, threads: int) -> dict[str, Any]:
    """Return the global attributes that are known before a sweep."""
    plan, catalogue = resolved.plan, resolved.catalogue
    packages = ("llvmlite",) if resolved.backend == "llvm" else (resolved.backend, "llvmlite")
    compilers = [f"{name} {version(name)}" for name in packages]  # without an import
    versions = [f"fastlink {__version__}", *compilers, f"numpy {np.__version__}"]
    attrs: dict[str, Any] = {
        "Conventions": "CF-1.11",
        "title": f"{catalogue.title}: {', '.join(output.name for output in plan.outputs)}",
        "mechanism": str(resolved.mechanism),
        "input": catalogue.position.name,
        "source": ", ".join(versions),
        "backend": resolved.backend,
        **({"solver": resolved.solver} if resolved.solver else {}),
        "threads": threads,
    }
    if sheet := sheet_of(resolved.mechanism):
        attrs["mechanism_sheet"] = sheet
    if declared := resolved.declared:
        attrs["own_quantities"] = definition_text(resolved.mechanism, declared)
    if plan.uses_position:
        attrs[f"{catalogue.position.name}_count"] = resolved.positions.size
    if plan.extrema:
        attrs["extrema"] = plan.extrema
    if resolved.scaling_axis is not None:
        attrs["scaling_axis"] = resolved.scaling_axis.name
    return attrs


def _describe(declared: Input, space: DesignSpace) -> dict[str, Any]:
    """Return the labels of an input, with the remark of its design space."""
    labels: dict[str, Any] = {"long_name": declared.title, "symbol": declared.symbol}
    if comment := space.comments.get(declared.name, declared.remark):
        labels["comment"] = comment
    return labels | (flag_attrs(declared.choices, "int32") if declared.choices else {"units": declared.units})


def flag_attrs(meanings: Mapping[int, str], dtype: str) -> dict[str, Any]:
    """Return CF's labels of a code."""
    words = " ".join(meaning.replace(" ", "_") for meaning in meanings.values())
    return {"flag_values": frozen(np.array(list(meanings), dtype=dtype)), "flag_meanings": words}
