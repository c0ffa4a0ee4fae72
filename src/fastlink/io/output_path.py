"""The place of a map file: what may be written there, how it is renamed, how far its run is."""

from __future__ import annotations

import contextlib
import ctypes
import errno
import functools
import os
import re
import shutil
import sys
import tempfile
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

from fastlink._text import size
from fastlink.errors import InputError, Remedy, Setting, check_output, not_a_file

# -- The place of a map file: what may be written there, and the words in which a place is refused


#: The remedy where a file exists.
EXISTS: Remedy = ("choose another name", (", or write ", Setting("overwrite", True)))
SLACK = 2**20  # for the labels, and for the attributes that are added at the end
#: A limit on files, of the system or of the process, is reached, or the disk is full.
NO_ROOM = {errno.ENOSPC, errno.EFBIG, getattr(errno, "EDQUOT", errno.ENOSPC)}


def part_of(path: Path) -> Path:
    """Return the name of a file while it is being written."""
    return path.with_name(path.name + ".part")


def left_of(path: Path) -> Path | None:
    """Return what a run that has not finished has left of a file: its part of a map, or the state of a search."""
    return next((one for one in (part_of(path), search_of(path)) if os.path.exists(one)), None)


def search_of(path: Path) -> Path:
    """Return the name of the state of a search beside the file that it is to write."""
    return path.with_name(path.name + ".search")


def reason(error: BaseException) -> str:
    """Return the reason of a failure on one line; of HDF5, which adds times and addresses, that of the system."""
    text = getattr(error, "strerror", None) or str(error)
    if of_system := re.search(r"error message = '([^']*)'", str(text)):
        text = of_system[1]
    return " ".join(str(text).split())


def existing_file(path: str | Path) -> Path | None:
    """Return the absolute path of an output that is a file already, None where there is none."""
    target = Path(os.path.realpath(check_output(("to",), path)))
    try:
        return target if target.is_file() else None
    except OSError:
        return None


def check_writable(path: Path, where: str = "to", example: str = "maps.h5") -> None:
    """Refuse a path at which no file can be written, before anything is computed for it."""
    try:
        if other := not_a_file(path):
            remedy = (
                f"add a file name, for instance {path / example}" if path.is_dir() else "choose another name"
            )
            raise refused(f"{path} {other}", remedy, where)
        if not path.parent.is_dir():
            raise refused(f"{path}: there is no folder {path.parent}", "create it or choose another", where)
        with tempfile.TemporaryFile(dir=path.parent):
            pass
    except OSError as error:
        raise not_writable(path, error, where) from error


def not_writable(path: Path, error: Exception, where: str = "to") -> InputError:
    """Return the error of a place at which no file can be made."""
    return refused(f"{path} cannot be written ({reason(error)})", "choose another place", where)


def refused(what: str, remedy: Remedy, where: str = "to") -> InputError:
    """Return the error of an option that names a place, the output unless said otherwise."""
    return InputError(what, where=(where,), remedy=remedy)


def exists_error(path: Path, why: str = "") -> InputError:
    """Return the error of a file that may not be replaced."""
    return refused(f"{path}: the file exists{why and f', {why}'}", EXISTS)


def no_room(path: Path, nbytes: int, error: Exception | None = None) -> InputError:
    """Return the error of a disk, or of a limit on files, that is too small for a map."""
    why = f" ({reason(error)})" if error else ""
    if getattr(error, "errno", None) == errno.EFBIG:
        return refused(
            f"{path} needs {size(nbytes)}, more than a file may have here{why}",
            "raise the limit (`ulimit -f unlimited`), choose another disk, or ask for fewer quantities or designs",
        )
    if error and nbytes + SLACK <= free_bytes(
        path
    ):  # another quota, or what was taken has been given back since
        return refused(f"{path}: the disk or its quota was full{why}", "make room, or choose another disk")
    return refused(
        f"{path} needs {size(nbytes + SLACK)} but {size(free_bytes(path))} are free{why}",
        "make room, choose another disk, or ask for fewer quantities or designs",
    )


def not_written(path: Path, nbytes: int, error: Exception) -> InputError:
    """Return the error of a file of so many bytes that cannot be written any further."""
    if getattr(error, "errno", None) in NO_ROOM:
        return no_room(path, nbytes, error)
    return not_writable(path, error)


def free_bytes(path: Path) -> int:
    """Return the free bytes of the disk of a file."""
    return shutil.disk_usage(path.parent).free


# -- Rename files and folders as the system can, and Python does not offer: without replacing, and both at
#    once


def exclusive_rename() -> Callable[[Path, Path], None]:
    """Return the system's renaming that fails when the name is taken."""
    return (
        os.rename if os.name == "nt" else _rename_of_system(1, 4)
    )  # which fails there when the name is taken


def exchange() -> Callable[[Path, Path], None]:
    """Return the system's renaming that gives each of two its other's name."""
    return _rename_of_system(2, 2)


@functools.cache
def _rename_of_system(linux: int, mac: int) -> Callable[[Path, Path], None]:
    """Return a renaming that its flag says more of; it fails with ENOSYS where the system has none."""
    name, flag = ("renamex_np", mac) if sys.platform == "darwin" else ("renameat2", linux)
    function = None if os.name == "nt" else getattr(ctypes.CDLL(None, use_errno=True), name, None)

    def rename(part: Path, final: Path) -> None:
        if function is None:
            raise OSError(errno.ENOSYS, os.strerror(errno.ENOSYS))
        here = -100  # AT_FDCWD of Linux; paths are absolute
        places = (os.fsencode(part), os.fsencode(final))
        arguments = places if name == "renamex_np" else (here, places[0], here, places[1])
        if function(*arguments, flag):
            number = ctypes.get_errno()
            raise OSError(number, os.strerror(number))

    return rename


# -- Show how far a run is


#: The size of a terminal that does not say its own.
SIZE = {"ncols": 80, "nrows": 24}


def progress_bar(total: int, unit: str, visible: bool | None) -> Any:
    """Return a bar of tqdm for so many units, None where it is not to be seen."""
    notebook = _in_notebook()
    if not (sys.stderr.isatty() or notebook if visible is None else visible):
        return None
    if notebook:
        with warnings.catch_warnings():  # without ipywidgets it is the bar of a terminal, in fewer words
            warnings.simplefilter("ignore")
            from tqdm.auto import tqdm
    else:
        from tqdm import tqdm  # 15 ms, which nobody waits for who sees no bar

    file, size = (None if notebook else sys.stderr), {}
    with contextlib.suppress(OSError, ValueError, AttributeError):
        # a terminal without a size, as of `docker exec -t`, has no columns, and tqdm would print nothing there
        size = {} if os.get_terminal_size(sys.stderr.fileno()).columns else SIZE
    return tqdm(total=total, unit=unit, unit_scale=True, file=file, **size)


def _in_notebook() -> bool:
    """Tell whether a notebook runs this; IPython is not imported for it."""
    shell = sys.modules.get("IPython")
    running = shell.get_ipython() if shell is not None and hasattr(shell, "get_ipython") else None
    return type(running).__name__ == "ZMQInteractiveShell"
