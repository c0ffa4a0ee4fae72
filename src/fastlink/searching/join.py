"""Join the parts of a map, or of a search."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fastlink.doors import door
from fastlink.engine.executor import default_threads
from fastlink.engine.options import check_options
from fastlink.engine.sinks import ProgressBar
from fastlink.errors import InputError, Problems
from fastlink.io.finished import finished_map
from fastlink.io.joining import JoinedMap
from fastlink.io.merged import CORE_TIME, JOINED, merged
from fastlink.io.part_files import RUN_AGAIN, PartFile, part_files
from fastlink.io.parts import shown_parts
from fastlink.io.place import exists_error, reason
from fastlink.io.writing.target import check_target
from fastlink.io.writing.writer import Writer
from fastlink.maps import open as open_map
from fastlink.options import check_output, check_switch
from fastlink.precision import DESIGNS
from fastlink.searching.result import SEARCH
from fastlink.searching.run import finished
from fastlink.searching.search import request_of_parts, to_file
from fastlink.searching.stream import Stream

if TYPE_CHECKING:
    import xarray as xr

    from fastlink.engine.extending import Extension

__all__ = ["join"]

#: More threads than these do not copy faster.
MOST_THREADS = 4
#: What is told of the run of a joined search, from its parts.
OF_RUN = ("run_time_s", "threads", JOINED, CORE_TIME)


@door
def join(
    paths: str | Path | Sequence[str | Path],
    *,
    to: str | Path,
    copy: bool = False,
    overwrite: bool = False,
    restart: bool = False,
    progress: bool | None = None,
    mechanism: Extension | None = None,
) -> xr.Dataset:
    """Join the parts of a map to the map that one sweep of all designs writes; those of a search to its result.

    Its values stay in the files of the parts, which the map shows as one, as virtual datasets of HDF5. Nothing is
    copied; the parts must stay, and are moved together with the map. `fastlink.open` refuses the map where a part is
    missing or has changed since, and `fastlink.check` reads them all. With ``copy=True`` the values are copied to one
    file, each checked against the checksums of its part as it is read; a copy that was killed goes on when it is called
    again.

    The labels and the bits are those of the whole sweep, and `fastlink.sweep` of the same request finds its map in the
    file. Counts of designs and run times are sums, measured errors the greatest of all parts; docs/scaling.md tells
    each attribute. Of a search the best rows of all parts are refined here, to the bits of one search of all designs;
    its file needs no part any more.

    Parameters
    ----------
    paths : path, or sequence of paths
        The files of all parts, made with ``part=(k, n)``; the folder that holds them; or a pattern such as
        ``"maps.part-*.h5"``.
    to : path
        The HDF5 file to write; without a copy in the folder of the parts, or in one above it.
    copy : bool, default False
        Copy the values, to a file that does not need the parts any more.
    overwrite : bool, default False
        Replace an existing file. Without it, an existing map of the same request, unchanged since, is opened as it is.
    restart : bool, default False
        Throw away what an interrupted join has left in ``FILE.part``.
    progress : bool, optional
        Show a progress bar on standard error; by default only on a terminal.
    mechanism : Extension, optional
        Of a search by quantities of one's own: what `fastlink.extend` returned, with which the parts were made.

    Returns
    -------
    xarray.Dataset
        Opened lazily from the file.

    Raises
    ------
    InputError
        A part is missing, damaged, doubled with other values or of another map; the message names it.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> import fastlink as fl
    >>> request = "planar_4r", fl.grid(a1=0.4, a2=[1.1, 1.2, 1.3], a3=0.8, a4=[1.0, 1.1]), ["transmission_angle_min"]
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     for k in (1, 2, 3):
    ...         fl.sweep(*request, part=(k, 3), to=f"{folder}/maps.part-{k}-of-3.h5", verify=0).close()
    ...     with fl.join(folder, to=pathlib.Path(folder, "maps.h5")) as maps:
    ...         dict(maps.transmission_angle_min.sizes)
    {'a2': 3, 'a4': 2, 'branch': 2}
    """
    problems, checked, parts = Problems(), dict[str, Any](), list[PartFile]()
    ways: dict[str, Any] = {"overwrite": overwrite, "restart": restart}
    with problems.at():
        check_output(("to",), to)
        checked = check_options({"overwrite": overwrite, "restart": restart, "progress": progress})
    with problems.at():
        check_switch(("copy",), copy)
    with problems.at():
        parts = part_files(paths)
    problems.stop()
    if SEARCH in parts[0].whole():
        return _joined_search(parts, mechanism, checked["progress"], Path(to), **ways)
    if mechanism is not None:
        remedy = "leave it out: maps are joined as they are"
        raise InputError("counts for the parts of a search alone", where=("mechanism",), remedy=remedy)
    joined = JoinedMap(parts)
    about: dict[str, Any] = {"coords": joined.coords, "variables": joined.variables, "attrs": {}}
    if not overwrite:
        found = finished_map(to, joined.fingerprint, verified=0, **about)
        if found is not None:
            if copy and shown_parts(Path(found.encoding["source"])):
                found.close()
                raise exists_error(Path(to), "and shows the values of its parts")
            return found
    path = check_target(to, 0, overwrite, [part.path for part in parts])
    shown = None if copy else joined.shown_in(path.parent)
    ways |= {"run": joined.run(shown), "shown": shown}
    with Writer(path, joined.coords, joined.variables, {}, **ways) as writer:
        with ProgressBar(joined.designs, checked["progress"]) as bar:
            for start, stop in writer.written:
                bar.take(start, stop, [])
            threads = min(default_threads(), MOST_THREADS)
            joined.copy(writer, threads, lambda start, stop: bar.take(start, stop, []), shown)
        writer.finish(joined.last_attrs(path.name), joined.errors)
    return open_map(path)


def _joined_search(
    parts: Sequence[PartFile], own: Extension | None, progress: bool | None, to: Path, **ways: Any
) -> xr.Dataset:
    """Return the result of the search of all parts."""
    try:
        request, found, verify = request_of_parts(parts, own)
    except (KeyError, ValueError, TypeError, AttributeError) as error:
        if isinstance(error, InputError):
            raise
        what = f"{parts[0].path}: what it says of its search cannot be read ({reason(error)})"
        raise InputError(what, where=("paths",), remedy=RUN_AGAIN) from error
    stream = Stream(request.resolved, request.kept, request.along)
    kept = stream.nothing()
    for one in found:
        stream.merge(kept, one)
    stream.settle(kept)
    about = {name: value for name, value in merged([part.attrs for part in parts]).items() if name in OF_RUN}
    about["designs_per_second"] = request.size / about["run_time_s"]
    how: dict[str, Any] = {"verify": DESIGNS if verify is None else verify, "progress": progress}
    made = f"join {len(parts)} parts of a search"
    return to_file(
        to,
        request,
        lambda path: (finished(request, stream, kept, about, **how), None),
        made=made,
        parts=parts,
        **ways,
    )
