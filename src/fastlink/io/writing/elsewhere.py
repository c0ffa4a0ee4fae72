"""Write into the file of a run from another process or machine that sees it, and report what was written."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from numpy.typing import NDArray

from fastlink.errors import InputError
from fastlink.io.checksums import add, read_all
from fastlink.io.dataset import Variable
from fastlink.io.ranges import Range
from fastlink.io.writing import partial_file
from fastlink.io.writing.blocks import OfThread
from fastlink.io.writing.journal import synchronise
from fastlink.io.writing.values_file import ValuesFile

__all__ = ["NotHereError", "WriterElsewhere", "Written"]


class NotHereError(Exception):
    """The file of a run is not seen from here."""


@dataclass
class Written:
    """An account of what was written and is on the disk.

    Attributes
    ----------
    ranges : list of (start, stop)
        The designs whose every result is written.
    addends : dict
        What their values add to the checksums, by block.
    values : dict
        The number of values of each variable.
    nbytes : int
        The bytes of all of them.
    """

    ranges: list[Range] = field(default_factory=list)
    addends: dict[int, int] = field(default_factory=dict)
    values: dict[str, int] = field(default_factory=dict)
    nbytes: int = 0


class WriterElsewhere:
    """A stand-in for a `Writer` in another process, for the designs of one task; a context manager.

    It opens the file anew for each task: the system reports an error of writing once for each time that a file is open,
    and the synchronisation of one thread would take that of another.

    Parameters
    ----------
    part : Path
        The partial file.
    token : mapping of int to bytes
        Bytes that no other file has, by where they stand.
    offsets : mapping of str to int
        Where the values of each variable begin.
    variables : sequence of Variable
        The variables.
    """

    def __init__(
        self,
        part: Path,
        token: Mapping[int, bytes],
        offsets: Mapping[str, int],
        variables: Sequence[Variable],
    ) -> None:
        self._part, self._token, self._offsets = part, dict(token), dict(offsets)
        self._variables = [replace(variable, attrs={}) for variable in variables]
        self._written = Written()

    def __enter__(self) -> WriterElsewhere:
        self._fd = self._opened()
        self._file = ValuesFile(self._fd, self._offsets, self._variables)
        self._of_thread = OfThread()
        return self

    def __exit__(self, *error: object) -> None:
        os.close(self._fd)

    def write(self, name: str, start: int, block: NDArray[Any]) -> None:
        """Write values, as `Writer.write`."""
        pieces = self._file.pieces(name, start, block, self._of_thread)
        add(self._written.addends, self._file.put(name, pieces))
        self._written.values[name] = self._written.values.get(name, 0) + block.size
        self._written.nbytes += block.nbytes

    def record(self, start: int, stop: int) -> None:
        """Note that all variables of some designs are written."""
        self._written.ranges.append((start, stop))

    def report(self) -> Written:
        """Return what was written, after it is on the disk: who gets this cannot synchronise another machine."""
        synchronise(self._fd)
        return self._written

    def _opened(self) -> int:
        """Return a number by which the file of the run, and no other with its name, is written.

        It is not read by that number: where it could be, NFS may write whole pages, with old values of other machines.
        """
        try:
            known = partial_file.opened(self._part)
        except (OSError, InputError) as error:
            raise NotHereError from error
        try:
            for position, expected in self._token.items():
                if read_all(known, len(expected), position) != expected:
                    raise NotHereError(self._part)
            fd = os.open(self._part, os.O_WRONLY | getattr(os, "O_BINARY", 0) | getattr(os, "O_NOFOLLOW", 0))
            if not os.path.samestat(os.fstat(fd), os.fstat(known)):
                os.close(fd)
                raise NotHereError(self._part)
        except (OSError, EOFError) as error:
            raise NotHereError from error
        finally:
            os.close(known)
        return fd
