"""Tell whether a finished map is that of a request, and in what it differs."""

from __future__ import annotations

import contextlib
import os
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from fastlink.errors import InputError
from fastlink.io.layout import FINGERPRINT, Variable, plain_attrs
from fastlink.io.output_path import existing_file, exists_error
from fastlink.io.partial_file import forget_journal, forget_published
from fastlink.io.reader import OF_PARTS, PartOfMap, PartsError, open_map

#: Global attribute of a map: the time at which it was finished, in ns since 1970.
WRITTEN = "written_time_ns"
#: Steps of the times of files, in ns: of most file systems, Windows, microseconds, HFS+ and NFS 2, FAT.
STEPS = (1, 100, 1000, 10**9, 2 * 10**9)
#: Longer coordinates are not read to say in what two maps differ.
LONGEST_READ = 10**7
#: Differences that are named.
MOST_NAMED = 5


def marks(fingerprint: str) -> dict[str, Any]:
    """Return the attributes by which a map is known as that of a request; it is finished now."""
    return {FINGERPRINT: fingerprint, WRITTEN: time.time_ns()} if fingerprint else {}


def stamp(path: Path, attrs: Mapping[str, Any]) -> None:
    """Give a file the time that its attributes say, so that a later change of it shows."""
    if WRITTEN in attrs:
        os.utime(path, ns=(attrs[WRITTEN], attrs[WRITTEN]))


def finished_map(
    to: str | Path,
    fingerprint: str,
    *,
    verified: int,
    attrs: Mapping[str, Any],
    coords: xr.Dataset | None = None,
    variables: Sequence[Variable] = (),
) -> xr.Dataset | None:
    """Return an existing file, opened, if it is the finished map of a request, None where none is; else refuse it."""
    path = existing_file(to)
    if path is None:
        return None
    with contextlib.suppress(OSError):
        forget_published(path)
        forget_journal(path)
    try:
        found = open_map(path)
    except PartsError:
        raise
    except InputError:
        raise exists_error(path, "and is not a map") from None
    known = found.attrs
    same = known.get(FINGERPRINT) == fingerprint
    if same and known.get("verified_designs", 0) >= verified and _is_untouched(path, known):
        return found
    with found:
        if not same:
            why = _difference(found, coords, variables, plain_attrs(attrs))
        elif not _is_untouched(path, known):
            why = "changed or copied since it was written"
        else:
            why = f"with {known.get('verified_designs', 0)} verified designs, not {verified}"
    raise exists_error(path, why)


def _is_untouched(path: Path, attrs: Mapping[str, Any]) -> bool:
    """Tell whether a file has the time that its attributes say, to a step of its file system."""
    said, found = int(attrs.get(WRITTEN, -1)), path.stat().st_mtime_ns
    return any(said // step * step == found for step in STEPS)


def _difference(
    found: xr.Dataset, coords: xr.Dataset | None, variables: Sequence[Variable], attrs: Mapping[str, Any]
) -> str:
    """Return in what a map differs from a request, as far as a short look tells."""
    labels = {**({} if coords is None else coords.attrs), **attrs}
    if found.attrs.get("mechanism") != labels.get("mechanism"):
        return f"a map of {found.attrs.get('mechanism')}"
    part, wanted = (
        "a whole map" if of is None else f"part {of.part}" for of in map(PartOfMap.of, (found.attrs, labels))
    )
    if part != wanted:
        return f"{part}, not {wanted}"
    others = [
        name
        for name in labels
        if name not in OF_PARTS and not np.array_equal(np.asarray(found.attrs.get(name)), labels[name])
    ]
    if coords is None:
        return f"a map with other {', '.join(others[:MOST_NAMED])}" if others else "of another search"
    names = {variable.name for variable in variables if not variable.is_coordinate}
    computed = {variable.name for variable in variables if variable.is_coordinate}
    parts = ["quantities"] if names != set(map(str, found.data_vars)) else []
    both = [] if parts else [one for one in variables if one.name in found.variables]
    dims = [(one.dims, tuple(map(str, found[one.name].dims))) for one in both]
    parts += ["layout"] if any(a != b and sorted(a) == sorted(b) for a, b in dims) else []
    parts += [
        str(name)
        for name in dict.fromkeys([*coords.coords, *found.coords])
        if name not in computed
        and (name not in coords.coords or name not in found.coords or _differ(coords[name], found[name]))
    ]
    parts += ["versions" if name == "source" else name for name in others if name not in ("threads", "title")]
    parts = parts or [name for name in others if name == "title"]
    more = ", ..." if len(parts) > MOST_NAMED else ""
    return f"a map with other {', '.join(parts[:MOST_NAMED])}{more}" if parts else "a map by another version"


def _differ(one: xr.DataArray, other: xr.DataArray) -> bool:
    if one.shape != other.shape or one.size > LONGEST_READ:
        return one.shape != other.shape
    return not np.array_equal(one.values, other.values)
