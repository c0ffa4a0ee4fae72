"""Faults of system calls: the n-th call of a run fails, is interrupted or is its last."""

from __future__ import annotations

import errno
import itertools
import os
import signal
from collections.abc import Callable
from typing import Any

from fastlink.io.writing import partial_file

#: The system calls of a run that writes a file; HDF5's own are not among them.
CALLS = (
    "open",
    "pwrite",
    "write",
    "fsync",
    "fdatasync",
    "posix_fallocate",
    "ftruncate",
    "replace",
    "link",
    "unlink",
    "utime",
)


def _fail(number: int) -> Callable[[], None]:
    def fail() -> None:
        raise OSError(number, os.strerror(number))

    return fail


def _signal(number: int) -> Callable[[], None]:
    return lambda: os.kill(os.getpid(), number)


#: What happens instead of a call; after a signal that does not end the process, the call goes on.
FAULTS: dict[str, Callable[[], None]] = {
    "kill": _signal(signal.SIGKILL),
    "interrupt": _signal(signal.SIGINT),
    "EIO": _fail(errno.EIO),
    "ENOSPC": _fail(errno.ENOSPC),
}


class Injector:
    """Counts the calls of a run, and lets a fault happen at one of them.

    Parameters
    ----------
    at : int
        The call, from 0; -1 for none.
    fault : str
        One of `FAULTS`.
    """

    def __init__(self, at: int = -1, fault: str = "kill") -> None:
        self.at, self.fault = at, fault
        self.calls: list[str] = []
        self._count = itertools.count()

    def install(self) -> None:
        """Put the injector in the place of all calls, for the rest of the process."""
        for name in CALLS:
            setattr(os, name, self._guarded(name, getattr(os, name)))
        exclusive = self._guarded("rename", partial_file.exclusive_rename())
        partial_file.exclusive_rename = lambda: exclusive

    def _guarded(self, name: str, call: Callable[..., Any]) -> Callable[..., Any]:
        def guarded(*arguments: Any, **options: Any) -> Any:
            number = next(self._count)
            self.calls.append(name)
            if number == self.at:
                FAULTS[self.fault]()
            return call(*arguments, **options)

        return guarded
