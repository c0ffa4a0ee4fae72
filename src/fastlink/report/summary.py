"""Say in a few lines what a sweep did, and what its map holds."""

from __future__ import annotations

import math
import numbers
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from fastlink._text import aligned, counted, duration, in_words, scaled, short_number, size
from fastlink.doors import door
from fastlink.io.history import SOURCE
from fastlink.io.merged import JOINED
from fastlink.io.parts import PartOfMap
from fastlink.io.reader import as_map, files_of
from fastlink.maps.flags import flag_counts, flags_of
from fastlink.own.definition import declared_names

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["contents", "summary"]

MULTIPLES = ("", " thousand", " million", " billion")


@door
def summary(maps: Any) -> str:
    """Return what a sweep did as lines of text, from the attributes of its result.

    Parameters
    ----------
    maps : xarray.Dataset or path
        From `fastlink.sweep`, `fastlink.run_study` or `fastlink.open`, or the file of a map.

    Returns
    -------
    str
        Designs and how many have each status, configurations where there were given input positions, run time and
        speed, the largest errors that were measured; and the file with its size, for a map that is opened from one. Of
        a part of a map, the designs of that part.

    Raises
    ------
    InputError
        Neither a map nor its path.

    Examples
    --------
    >>> import fastlink as fl
    >>> space = fl.grid(a1=[0.4, 0.6], a2=1.2, a3=0.8, a4=1.0)
    >>> print(summary(fl.sweep("planar_4r", space, ["transmission_angle"])).partition("run time")[0])
    designs         2
                    1  rotates fully                     50.0 %
                    0  assembles over part of the turn    0.0 %
                    0  never assembles                    0.0 %
                    1  change point                      50.0 %
                    0  invalid input                      0.0 %
                    0  assembles in one position          0.0 %
    configurations  1,440
    <BLANKLINE>
    """
    with as_map(maps) as dataset:
        return _summary(dataset)


def _summary(dataset: xr.Dataset) -> str:
    told = _Numbers(dataset.attrs)
    rows = _designs(dataset, told)
    if (part := PartOfMap.of(dataset.attrs)) is not None:
        start, stop = part.range
        rows.append(("part", f"{part.part}: designs {start:,} to {stop - 1:,} of {part.designs:,}"))
    rows += _searched(dataset, told)
    if "selection" in dataset.attrs:
        rows.append(("selection", str(dataset.attrs["selection"])))
    if told.has("configurations"):
        rows.append(("configurations", f"{told['configurations']:,.0f}"))
    if told.has("designs_of_earlier_runs"):
        earlier = counted(int(told["designs_of_earlier_runs"]), "design")
        rows.append(("resumed", f"{earlier} from an earlier run"))
    if told.has("run_time_s"):
        text = duration(told["run_time_s"])
        if told.has("set_up_time_s"):
            text += f", after {duration(told['set_up_time_s'])} of setting up and compiling"
        if told.has("threads"):
            text += f", {counted(int(told['threads']), 'thread')}"
        if told.has(JOINED):
            text += f"; of {counted(int(told[JOINED]), 'part')} together"
        rows.append(("run time", text))
    for unit in ("configurations", "designs"):
        if told.has(f"{unit}_per_second"):
            units = [f"{multiple} {unit}/s" for multiple in MULTIPLES]
            rows.append(("speed", scaled(told[f"{unit}_per_second"], units)))
            break
    rows += _errors(dataset)
    notes = {
        str(array.attrs["rounding"]) for array in dataset.data_vars.values() if "rounding" in array.attrs
    }
    rows += [("rounding", note) for note in sorted(notes)]
    files = [path for path in files_of(dataset) if path.is_file()]
    if files:
        text = f"{files[0]} ({size(files[0].stat().st_size)})"
        if parts := files[1:]:
            nbytes = sum(part.stat().st_size for part in parts)
            text += f", which shows values of {counted(len(parts), 'part')} ({size(nbytes)})"
        rows.append(("file", text))
    return aligned(rows)


def _searched(dataset: xr.Dataset, told: _Numbers) -> list[tuple[str, str]]:
    """Return what was searched to find these designs, and how many rows were left out, why."""
    if "search" not in dataset.attrs or not told.has("searched_designs"):
        return []
    rows = [("searched", f"{told['searched_designs']:,.0f} designs for {dataset.attrs['search']}")]
    left_out = [
        (
            in_words(name.removeprefix("excluded_")) if name.startswith("excluded_as") else name[9:],
            count,
        )
        for name, count in told.items()
        if name.startswith("excluded_") and count
    ]
    texts = [f"{count:,.0f} {name.replace('by_', 'by ', 1)}" for name, count in left_out]
    return [
        *rows,
        *(
            [("excluded", f"{', '.join(texts)}, of {told.get('searched_rows', 0.0):,.0f} rows")]
            if texts
            else []
        ),
    ]


class _Numbers(dict[str, float]):
    """The attributes that are finite numbers; users may have changed the others.

    Parameters
    ----------
    attrs : mapping
        Attributes.
    """

    def __init__(self, attrs: Mapping[Any, Any]) -> None:
        for name, value in attrs.items():
            if isinstance(value, numbers.Real) and math.isfinite(value):
                self[str(name)] = float(value)

    def has(self, name: str) -> bool:
        """Tell whether there is such a number, and it is not negative."""
        return self.get(name, -1.0) >= 0.0


def _designs(dataset: xr.Dataset, told: _Numbers) -> list[tuple[str, str]]:
    """Return how many designs there are, and how many of them have each status.

    Those of a whole sweep stand in its attributes. A part of it is counted; after a mean over designs the statuses are
    no codes, and not counted.
    """
    if not told.has("designs"):
        return []
    swept = int(told["designs"])
    status = dataset["status"] if "status" in dataset.variables else None
    designs = swept if status is None else status.size
    text, counts = f"{designs:,}", None
    if designs != swept:
        text += f" of the {swept:,} of the sweep"
        counts = None if status is None else flag_counts(status)
    elif status is not None and status.dtype.kind in "iu":
        names = flags_of(status)
        counts = {name: int(told[f"designs_{name}"]) for name in names if told.has(f"designs_{name}")}
    rows = [("designs", text)]
    label_width, count_width = max(map(len, counts or ()), default=0), len(f"{designs:,}")
    for name, count in (counts or {}).items():
        label = f"{in_words(name):<{label_width}}"
        rows.append(("", f"{count:>{count_width},}  {label}  {_percent(count, designs)}"))
    return rows


def _errors(dataset: xr.Dataset) -> list[tuple[str, str]]:
    """Return the largest error of each variable, by the verification of a sweep."""
    if "verify_failed" in dataset.attrs:
        return [("errors", f"not measured: {dataset.attrs['verify_failed']}")]
    errors, title = [], "largest error"
    for name, array in dataset.data_vars.items():
        told = _Numbers(array.attrs)
        if not told.has("verified_values") and told.has(f"{SOURCE}verified_values"):
            title = "of the whole map"  # of which this is a part
            told = _Numbers({str(key).removeprefix(SOURCE): value for key, value in array.attrs.items()})
        if not told.has("verified_values"):
            continue
        texts = []
        if told.has("error_max_relative"):
            texts.append(f"{told['error_max_relative']:.1e} relative")
        if told.has("error_max_roundings"):
            texts.append(f"{told['error_max_roundings']:.2g} roundings")
        if told.has("error_max_of_bound"):
            texts.append(f"{told['error_max_of_bound']:.2g} of the bound")
        if told.get("verify_mismatches"):
            texts.append(f"{counted(int(told['verify_mismatches']), 'value')} NOT AS WITH 50 DIGITS")
        if texts:
            errors.append((str(name), f"{', '.join(texts)}, of {told['verified_values']:,.0f}"))
    return [("" if k else title, line) for k, line in enumerate(aligned(errors).splitlines())]


def _percent(count: int, total: int) -> str:
    share = 100 * count / total if total else 0.0
    return " <0.1 %" if 0 < share < 0.05 else f"{share:5.1f} %"


def contents(maps: Any) -> str:
    """Return what a result holds: mechanism, axes, constants, variables, its summary.

    Parameters
    ----------
    maps : xarray.Dataset or path
        From `fastlink.sweep`, `fastlink.run_study` or `fastlink.open`, or the file of a map.
    """
    with as_map(maps) as dataset:
        return _contents(dataset)


def _contents(dataset: xr.Dataset) -> str:
    attrs, coords = dataset.attrs, {str(name): coord for name, coord in dataset.coords.items()}
    keys = ("title", "mechanism", "input", "study_file", "solver", "source")
    declared = declared_names(str(attrs.get("own_quantities", "")))
    head = [(in_words(key), str(attrs[key])) for key in keys if key in attrs]
    head += [("own quantities", ", ".join(declared))] if declared else []
    dims = [(str(dim), _axis(dataset, str(dim), length)) for dim, length in dataset.sizes.items()]
    sampled = [(n, _span(coord)) for n, coord in coords.items() if coord.ndim == 1 and n not in dataset.dims]
    constants = [(n, _of_all(coord)) for n, coord in coords.items() if coord.ndim == 0]
    variables = [
        (str(n), f"({', '.join(map(str, array.dims))})  [{array.attrs.get('units', '1')}]{_meaning(array)}")
        for n, array in dataset.data_vars.items()
    ]
    titled = {
        "dimensions": dims,
        "inputs along them": sampled,
        "constants": constants,
        "variables": variables,
    }
    blocks = [
        aligned(head),
        *(f"{title}\n{aligned(rows, indent='  ')}" for title, rows in titled.items() if rows),
    ]
    return "\n\n".join(filter(None, [*blocks, _summary(dataset)]))


def _axis(dataset: xr.Dataset, dim: str, length: int) -> str:
    if dim not in dataset.coords:
        return f"{length:,}"
    text = f"{length:,}: {_span(dataset[dim])}"
    return f"{text}; {dataset[dim].attrs['comment']}" if "comment" in dataset[dim].attrs else text


def _of_all(coord: xr.DataArray) -> str:
    """Return the value that a scalar coordinate has for all designs, with what its number stands for."""
    text = f"{short_number(coord.values[()])} {coord.attrs.get('units', '')}{_meaning(coord)}"
    return f"{text}; {coord.attrs['comment']}" if "comment" in coord.attrs else text


def _span(coord: xr.DataArray) -> str:
    values = coord.values
    if not values.size:
        return "no values"
    if values.dtype.kind in "iuf":
        ends = (values[0],) if len(values) == 1 else (values.min(), values.max())
    else:
        ends = (values[0],) if len(values) == 1 else (values[0], values[-1])
    units = coord.attrs.get("units", "")
    return f"{' to '.join(map(short_number, ends))} {'' if units == '1' else units}".rstrip() + _meaning(
        coord
    )


def _meaning(array: xr.DataArray) -> str:
    return f"  {array.attrs['long_name']}" if "long_name" in array.attrs else ""
