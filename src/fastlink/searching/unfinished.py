"""Keep what a search has found so far beside its file, so that a killed one goes on."""

from __future__ import annotations

import io
import json
import os
import time
import zipfile
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from fastlink.errors import InputError, Setting
from fastlink.io.place import not_writable, refused, search_of
from fastlink.io.ranges import Range
from fastlink.searching.stream import Kept

__all__ = ["Unfinished"]

#: Seconds between two states that are kept.
STEP_SECONDS = 10.0


class Unfinished:
    """The state of a search that is under way: what it keeps, and of which designs.

    It is written whole, under another name, and then given its own: what stands there is never half.

    Parameters
    ----------
    path : Path
        The file of the search.
    fingerprint : str
        The hash of its request.
    """

    def __init__(self, path: Path, fingerprint: str) -> None:
        self.path, self.fingerprint = search_of(path), fingerprint
        self._next = time.monotonic() + STEP_SECONDS

    def read(self) -> tuple[Kept, list[Range]] | None:
        """Return what an earlier run of the same request has left, None where nothing is; refuse that of another."""
        remedy = (
            "finish that search, choose another name",
            (", or write ", Setting("restart", True), " to throw it away"),
        )
        try:
            with np.load(self.path) as arrays:
                about = json.loads(str(arrays["about"]))
                if about.get("fingerprint") == self.fingerprint:
                    ranges = [(int(start), int(stop)) for start, stop in about["done"]]
                    return Kept.of_arrays(arrays), ranges
        except FileNotFoundError:
            return None
        except (OSError, ValueError, KeyError, zipfile.BadZipFile) as error:
            raise refused(f"{self.path} cannot be read ({error})", remedy) from error
        raise refused(f"{self.path} is of another search, or by another version", remedy)

    def is_due(self) -> bool:
        """Tell whether it is time to keep the state."""
        return time.monotonic() >= self._next

    def write(self, kept: Kept, done: Sequence[Range]) -> None:
        """Keep a state."""
        about = json.dumps({"fingerprint": self.fingerprint, "done": [list(one) for one in done]})
        content = io.BytesIO()
        np.savez(content, about=np.array(about), **kept.arrays())
        fresh = self.path.with_name(f"{self.path.name}.{os.getpid()}")
        try:
            with open(fresh, "wb") as file:
                file.write(content.getbuffer())
                file.flush()
                os.fsync(file.fileno())
            os.replace(fresh, self.path)
        except OSError as error:
            fresh.unlink(missing_ok=True)
            raise not_writable(self.path, error) from error
        self._next = time.monotonic() + STEP_SECONDS

    def remove(self) -> None:
        """Remove it: the search has its file, or is to begin anew."""
        try:
            self.path.unlink(missing_ok=True)
        except OSError as error:
            raise InputError(f"{self.path} cannot be removed ({error})", remedy="remove it") from error
