"""Say in a few lines what a sweep did, and what its map holds."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from fastlink._text import aligned, counted, duration, scaled, size
from fastlink.doors import door

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["contents", "summary"]

MULTIPLES = ("", " thousand", " million", " billion")


@door
def summary(dataset: xr.Dataset) -> str:
    """Return what a sweep did as lines of text, from the attributes of its result.

    Parameters
    ----------
    dataset : xarray.Dataset
        From `fastlink.sweep`, `fastlink.run_study` or `fastlink.open`.

    Returns
    -------
    str
        Designs and how many have each status, configurations where there were given input positions, run time and
        speed, the largest errors that were measured; and the file with its size, for a dataset that is opened from
        one.

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
    configurations  1,440
    <BLANKLINE>
    """
    attrs = dataset.attrs
    rows = _designs(dataset)
    if "configurations" in attrs:
        rows.append(("configurations", f"{int(attrs['configurations']):,}"))
    if "designs_of_earlier_runs" in attrs:
        earlier = counted(int(attrs["designs_of_earlier_runs"]), "design")
        rows.append(("resumed", f"{earlier} from an earlier run"))
    if "run_time_s" in attrs:
        text = duration(float(attrs["run_time_s"]))
        if "set_up_time_s" in attrs:
            text += f", after {duration(float(attrs['set_up_time_s']))} of setting up and compiling"
        if "threads" in attrs:
            text += f", {counted(int(attrs['threads']), 'thread')}"
        rows.append(("run time", text))
    for unit in ("configurations", "designs"):
        if f"{unit}_per_second" in attrs:
            units = [f"{multiple} {unit}/s" for multiple in MULTIPLES]
            rows.append(("speed", scaled(float(attrs[f"{unit}_per_second"]), units)))
            break
    rows += _errors(dataset)
    source = dataset.encoding.get("source")
    if source and Path(source).is_file():
        rows.append(("file", f"{source} ({size(Path(source).stat().st_size)})"))
    return aligned(rows)


def _designs(dataset: xr.Dataset) -> list[tuple[str, str]]:
    """Return how many designs there are, and how many of them have each status."""
    attrs = dataset.attrs
    if "designs" not in attrs:
        return []
    designs = int(attrs["designs"])
    meanings = str(dataset["status"].attrs.get("flag_meanings", "")) if "status" in dataset else ""
    statuses = [name for name in meanings.split() if f"designs_{name}" in attrs]
    label_width, count_width = max(map(len, statuses), default=0), len(f"{designs:,}")
    rows = [("designs", f"{designs:,}")]
    for name in statuses:
        count = int(attrs[f"designs_{name}"])
        label = f"{name.replace('_', ' '):<{label_width}}"
        rows.append(("", f"{count:>{count_width},}  {label}  {_percent(count, designs)}"))
    return rows


def _errors(dataset: xr.Dataset) -> list[tuple[str, str]]:
    """Return the largest error of each variable, by the verification of a sweep."""
    if "verify_failed" in dataset.attrs:
        return [("errors", f"not measured: {dataset.attrs['verify_failed']}")]
    errors = []
    for name, array in dataset.data_vars.items():
        attrs = array.attrs
        if "verified_values" not in attrs:
            continue
        texts = []
        if "error_max_relative" in attrs:
            texts.append(f"{attrs['error_max_relative']:.1e} relative")
        if "error_max_roundings" in attrs:
            texts.append(f"{attrs['error_max_roundings']:.2g} roundings")
        if attrs["verify_mismatches"]:
            texts.append(f"{counted(int(attrs['verify_mismatches']), 'value')} NOT AS WITH 50 DIGITS")
        if texts:
            errors.append((str(name), f"{', '.join(texts)}, of {int(attrs['verified_values']):,}"))
    return [("" if k else "largest error", line) for k, line in enumerate(aligned(errors).splitlines())]


def _percent(count: int, total: int) -> str:
    share = 100 * count / total if total else 0.0
    return " <0.1 %" if 0 < share < 0.05 else f"{share:5.1f} %"


def contents(dataset: xr.Dataset) -> str:
    """Return what a result holds: mechanism, axes, constants, variables, its summary.

    Parameters
    ----------
    dataset : xarray.Dataset
        From `fastlink.sweep`, `fastlink.run_study` or `fastlink.open`.
    """
    attrs = dataset.attrs
    keys = ("title", "mechanism", "input", "study_file", "solver", "source")
    head = [(key.replace("_", " "), str(attrs[key])) for key in keys if key in attrs]
    dims = [(str(dim), _axis(dataset, str(dim), length)) for dim, length in dataset.sizes.items()]
    sampled = [
        (str(name), _span(coord))
        for name, coord in dataset.coords.items()
        if coord.ndim == 1 and name not in dataset.dims
    ]
    constants = [
        (str(name), f"{coord.item():g} {coord.attrs.get('units', '')}{_meaning(coord)}")
        for name, coord in dataset.coords.items()
        if coord.ndim == 0
    ]
    variables = [
        (
            str(name),
            f"({', '.join(map(str, array.dims))})  [{array.attrs.get('units', '1')}]{_meaning(array)}",
        )
        for name, array in dataset.data_vars.items()
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
    return "\n\n".join(filter(None, [*blocks, summary(dataset)]))


def _axis(dataset: xr.Dataset, dim: str, length: int) -> str:
    if dim not in dataset.coords:
        return f"{length:,}"
    text = f"{length:,}: {_span(dataset[dim])}"
    return f"{text}; {dataset[dim].attrs['comment']}" if "comment" in dataset[dim].attrs else text


def _span(coord: xr.DataArray) -> str:
    values = coord.values
    ends = f"{values[0]:g}" if len(values) == 1 else f"{values.min():g} to {values.max():g}"
    units = coord.attrs.get("units", "")
    return f"{ends} {'' if units == '1' else units}".rstrip() + _meaning(coord)


def _meaning(array: xr.DataArray) -> str:
    return f"  {array.attrs['long_name']}" if "long_name" in array.attrs else ""
