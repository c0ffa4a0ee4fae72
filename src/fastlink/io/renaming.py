"""Rename files and folders as the system can, and Python does not offer: without replacing, and both at once."""

from __future__ import annotations

import ctypes
import errno
import functools
import os
import sys
from collections.abc import Callable
from pathlib import Path

__all__ = ["exchange", "exclusive_rename"]


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
