"""The attributes of a converted map: what it holds of which map, and what is no longer true of it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from fastlink.io.converting.selection import Selection
from fastlink.io.converting.source import Source
from fastlink.io.dataset import Variable, plain_attrs
from fastlink.io.finished import FINGERPRINT, WRITTEN
from fastlink.io.history import HISTORY, SOURCE, history
from fastlink.io.parts import OF_PARTS
from fastlink.io.reader import COMPRESSION
from fastlink.space.dataset import FORMAT, STATUS
from fastlink.space.design_space import BRANCH, DESIGN

__all__ = ["as_json", "labelled"]

#: Global attributes that are true of a whole run alone.
OF_RUN = ("designs_of_earlier_runs", "run_time_s", "set_up_time_s", "verified_designs")
OF_RUN_BEGIN = ("designs_per_", "configurations_per_", "verify_")
#: Attributes of variables, and their beginnings, that are measured on the designs of a whole run.
MEASURED = ("verified_values", "verify_mismatches", "independent_", "error_")
#: Measured on values as they were computed: of rounded values they say nothing.
OF_DOUBLES = ("error_median_relative", "error_max_roundings", "error_max_of_bound")


def labelled(maps: xr.Dataset, source: Source, selection: Selection, command: str) -> dict[str, Any]:
    """Return the global attributes of the result, and give those of its variables to the source.

    Parameters
    ----------
    maps : xarray.Dataset
        The map that is converted.
    source : Source
        What is taken of it.
    selection : Selection
        How it was selected.
    command : str
        What made the result, for its history.
    """
    given = {str(name): value for name, value in maps.attrs.items() if name not in (FORMAT, COMPRESSION)}
    of_file = (FINGERPRINT, WRITTEN, *OF_PARTS)  # nor can a converted part be joined
    attrs = {f"{SOURCE}{name}" if name in of_file else name: one for name, one in given.items()}
    if len(source.variables) < len(maps.data_vars):
        attrs = _titled(attrs, [str(name) for name in maps.data_vars], [v.name for v in source.variables])
    if selection.texts:
        attrs = _selected(maps, attrs, source, selection)
    for variable in source.variables:
        if selection.texts:
            renamed = {_of_source(name, MEASURED): value for name, value in variable.attrs.items()}
            variable.attrs.clear()
            variable.attrs.update(renamed)
        rounded = maps[variable.name].dtype.itemsize > variable.dtype.itemsize
        if rounded and variable.dtype.kind == "f":
            _round(variable)
    attrs[HISTORY] = history(command, str(given.get(HISTORY, "")))
    return plain_attrs(attrs)


def as_json(attrs: Mapping[str, Any]) -> dict[str, Any]:
    """Return attributes as JSON holds them."""
    return {
        str(name): value.tolist() if isinstance(value, (np.ndarray, np.generic)) else value
        for name, value in attrs.items()
    }


def _titled(attrs: Mapping[str, Any], names: list[str], kept: list[str]) -> dict[str, Any]:
    """Return attributes whose title, if it lists the variables, lists those that are kept."""
    title = str(attrs.get("title", ""))
    listed = ", ".join(names)
    new = title.removesuffix(listed) + ", ".join(kept) if title.endswith(listed) else title
    return dict(attrs) | ({"title": new} if title else {})


def _selected(
    maps: xr.Dataset, attrs: Mapping[str, Any], source: Source, selection: Selection
) -> dict[str, Any]:
    """Return attributes that are true of a part of a map: its designs are counted, those of the run renamed."""
    designs = _design_dims(maps)
    fewer = [dim for dim in designs if dim in selection.indexers]
    is_table = DESIGN in fewer and not isinstance(selection.indexers[DESIGN], int)
    result: dict[str, Any] = {}
    for name, value in attrs.items():
        of_designs = name.startswith("design_") and DESIGN in fewer
        counted = name == "designs" or name.startswith("designs_")
        renamed = of_designs or name == "designs" or _of_source(name, (*OF_RUN, *OF_RUN_BEGIN)) != name
        if renamed:
            result[f"{SOURCE}{name}"] = value
        elif not counted and name != "configurations":
            result[name] = value
    if DESIGN in fewer:
        result["design_kind"] = "table" if is_table else "grid"
    before = selection.texts if "selection" not in attrs else [str(attrs["selection"]), *selection.texts]
    result["selection"] = "; ".join(before)
    return result | _counts(maps, attrs, source, designs, selection)


def _counts(
    maps: xr.Dataset, attrs: Mapping[str, Any], source: Source, designs: list[str], selection: Selection
) -> dict[str, Any]:
    """Return the numbers of designs, of those with each status, and of configurations."""
    sizes = source.coords.sizes
    count = math.prod(_size(maps, sizes, selection, dim) for dim in designs)
    result: dict[str, Any] = {"designs": count}
    status = next((v for v in source.variables if v.name == STATUS), None)
    if status is not None and status.dtype.kind in "iu":
        codes = np.atleast_1d(status.attrs.get("flag_values", ())).tolist()
        numbers = dict.fromkeys(codes, 0)
        for _, _, values in source.blocks(status):
            for code, number in zip(*np.unique(values, return_counts=True), strict=True):
                numbers[int(code)] = numbers.get(int(code), 0) + int(number)
        meanings = str(status.attrs.get("flag_meanings", "")).split()
        result |= {f"designs_{m}": numbers[code] for m, code in zip(meanings, codes, strict=False)}
    position = str(attrs.get("input", ""))
    if "configurations" in attrs:
        inner = [dim for dim in (BRANCH, position) if dim in maps.sizes]
        result["configurations"] = count * math.prod(_size(maps, sizes, selection, dim) for dim in inner)
    if f"{position}_count" in attrs and position in maps.sizes:
        result[f"{position}_count"] = _size(maps, sizes, selection, position)
    return result


def _size(maps: xr.Dataset, sizes: Mapping[Any, int], selection: Selection, dim: str) -> int:
    """Return how many values of a dimension are taken."""
    if isinstance(selection.indexers.get(dim), int):
        return 1
    return int(sizes.get(dim, maps.sizes[dim]))


def _design_dims(maps: xr.Dataset) -> list[str]:
    """Return the dimensions of the design space of a map."""
    if STATUS in maps.variables:
        return list(map(str, maps[STATUS].dims))
    dims = [set(map(str, one.dims)) for one in maps.data_vars.values()]
    return sorted(set.intersection(*dims) if dims else set())


def _of_source(name: str, beginnings: tuple[str, ...]) -> str:
    """Return the name of an attribute in the result, where it is true of the converted map alone."""
    return f"{SOURCE}{name}" if name.startswith(beginnings) else name


def _round(variable: Variable) -> None:
    """Let the attributes of a variable say what its rounding adds to the errors."""
    info = np.finfo(variable.dtype)
    unit, least = float(info.eps) / 2, float(info.smallest_subnormal) / 2
    for name in OF_DOUBLES:
        variable.attrs.pop(name, None)
    if "error_max_relative" in variable.attrs:
        # (1 + e)(1 + u) - 1, and a bit more than its own rounding
        e = float(variable.attrs["error_max_relative"])
        variable.attrs["error_max_relative"] = float(np.nextafter(e + unit * (1 + e), np.inf))
    variable.attrs["rounding"] = (
        f"float64 rounded to {variable.dtype}: off by at most {unit:.3g} of the value more than before; "
        f"by {least:.1g} below {float(info.smallest_normal):.3g}; infinite beyond {float(info.max):.3g}"
    )
