"""What a sweep did, in a few lines: designs and their status, configurations, run time, the file."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["contents", "summary"]

SIZES = (" B", " kB", " MB", " GB")
MULTIPLES = ("", " thousand", " million", " billion")


def summary(dataset: xr.Dataset) -> str:
    """Tell what a sweep did, from the attributes of its result.

    Parameters
    ----------
    dataset : xarray.Dataset
        From `fastlink.sweep`, `fastlink.run_study` or `fastlink.open`.

    Returns
    -------
    str
        Lines of text: designs and how many have each status, configurations where there were given input
        positions, run time and speed; and the file with its size, for a dataset that is opened from one.

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
    rows: list[tuple[str, str]] = []
    if "designs" in attrs:
        designs = int(attrs["designs"])
        rows.append(("designs", f"{designs:,}"))
        meanings = str(dataset["status"].attrs.get("flag_meanings", "")) if "status" in dataset else ""
        known = [name for name in meanings.split() if f"designs_{name}" in attrs]
        width = max((len(name) for name in known), default=0)
        for name in known:
            count = int(attrs[f"designs_{name}"])
            label = name.replace("_", " ").ljust(width)
            rows.append(("", f"{f'{count:,}':>{len(f'{designs:,}')}}  {label}  {_percent(count, designs)}"))
    if "configurations" in attrs:
        rows.append(("configurations", f"{int(attrs['configurations']):,}"))
    if "designs_of_earlier_runs" in attrs:
        rows.append(
            ("resumed", f"{int(attrs['designs_of_earlier_runs']):,} designs of an earlier run were there")
        )
    if "run_time_s" in attrs:
        text = duration(float(attrs["run_time_s"]))
        if "set_up_time_s" in attrs:
            text += f", after {duration(float(attrs['set_up_time_s']))} of setting up and compiling"
        if "threads" in attrs:
            text += f", {_counted(int(attrs['threads']), 'thread')}"
        rows.append(("run time", text))
    for what in ("configurations", "designs"):
        if f"{what}_per_second" in attrs:
            units = [f"{multiple} {what}/s" for multiple in MULTIPLES]
            rows.append(("speed", _scaled(float(attrs[f"{what}_per_second"]), units)))
            break
    rows += _errors(dataset)
    source = dataset.encoding.get("source")
    if source and Path(source).is_file():
        rows.append(("file", f"{source} ({_scaled(Path(source).stat().st_size, SIZES)})"))
    return aligned(rows)


def _errors(dataset: xr.Dataset) -> list[tuple[str, str]]:
    """Return what the verification of a sweep found: the largest error of each variable."""
    if "verify_failed" in dataset.attrs:
        return [("errors", f"not measured: {dataset.attrs['verify_failed']}")]
    lines = []
    for name, array in dataset.data_vars.items():
        if "verified_values" not in array.attrs:
            continue
        texts = []
        if "error_max_relative" in array.attrs:
            texts.append(f"{array.attrs['error_max_relative']:.1e} relative")
        if "error_max_roundings" in array.attrs:
            texts.append(f"{array.attrs['error_max_roundings']:.2g} roundings")
        if array.attrs["verify_mismatches"]:
            texts.append(f"{_counted(int(array.attrs['verify_mismatches']), 'value')} NOT AS WITH 50 DIGITS")
        if texts:
            lines.append((str(name), f"{', '.join(texts)}, of {int(array.attrs['verified_values']):,}"))
    width = max((len(name) for name, _ in lines), default=0)
    return [
        ("" if k else "largest error", f"{name:<{width}}  {text}") for k, (name, text) in enumerate(lines)
    ]


def aligned(rows: list[tuple[str, str]]) -> str:
    """Return rows of a name and a text, with the texts below each other."""
    width = max((len(name) for name, _ in rows), default=0)
    return "\n".join(f"{name:<{width}}  {text}".rstrip() for name, text in rows)


def duration(seconds: float) -> str:
    """Return a time as it is read.

    Examples
    --------
    >>> duration(0.0123), duration(4.56), duration(125.0), duration(7300.0)
    ('0.012 s', '4.6 s', '2 min 5 s', '2 h 1 min')
    """
    if seconds < 60:
        return f"{seconds:.2g} s"
    minutes, rest = divmod(round(seconds), 60)
    if minutes < 60:
        return f"{minutes} min {rest} s"
    return f"{minutes // 60} h {minutes % 60} min"


def _percent(count: int, of: int) -> str:
    share = 100 * count / of if of else 0.0
    return " <0.1 %" if 0 < share < 0.05 else f"{share:5.1f} %"


def _scaled(value: float, units: Sequence[str]) -> str:
    """Return a number with three digits and its unit, of those for 1, 10^3, 10^6 and 10^9."""
    power = 3 if value >= 1e9 else 2 if value >= 1e6 else 1 if value >= 1e3 else 0
    return f"{value / 1e3**power:.3g}{units[power]}"


def _counted(number: int, what: str) -> str:
    return f"{number} {what}{'' if number == 1 else 's'}"


def contents(dataset: xr.Dataset) -> str:
    """Tell what a result holds: mechanism, axes, constants, variables, and what its sweep did.

    Parameters
    ----------
    dataset : xarray.Dataset
        From `fastlink.sweep`, `fastlink.run_study` or `fastlink.open`.
    """
    attrs = dataset.attrs
    keys = ("title", "mechanism", "input", "study_file", "solver", "source")
    head = [(key.replace("_", " "), str(attrs[key])) for key in keys if key in attrs]
    dims = [(str(dim), _axis(dataset, str(dim), size)) for dim, size in dataset.sizes.items()]
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
    parts = [
        ("", head),
        ("dimensions", dims),
        ("inputs along them", sampled),
        ("constants", constants),
        ("variables", variables),
    ]
    blocks = [f"{title}\n{_indented(rows)}" if title else aligned(rows) for title, rows in parts if rows]
    return "\n\n".join([*blocks, summary(dataset)])


def _axis(dataset: xr.Dataset, dim: str, size: int) -> str:
    if dim not in dataset.coords:
        return f"{size:,}"
    text = f"{size:,}: {_span(dataset[dim])}"
    return f"{text}; {dataset[dim].attrs['comment']}" if "comment" in dataset[dim].attrs else text


def _span(coord: xr.DataArray) -> str:
    values = coord.values
    ends = f"{values[0]:g}" if len(values) == 1 else f"{values.min():g} to {values.max():g}"
    units = coord.attrs.get("units", "")
    return f"{ends} {'' if units == '1' else units}".rstrip() + _meaning(coord)


def _meaning(array: xr.DataArray) -> str:
    return f"  {array.attrs['long_name']}" if "long_name" in array.attrs else ""


def _indented(rows: list[tuple[str, str]]) -> str:
    return "\n".join(f"  {line}" for line in aligned(rows).splitlines())
