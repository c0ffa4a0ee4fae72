"""The attribute ``history`` of CF: a line for each program that has made or changed a file."""

from __future__ import annotations

from datetime import UTC, datetime

from fastlink._text import writable
from fastlink._version import __version__

__all__ = ["HISTORY", "SOURCE", "history"]

HISTORY = "history"
#: What the attributes begin with that are true of the map from which a file was converted, and not of the file.
SOURCE = "source_"


def history(command: str, before: str = "") -> str:
    """Return the history of a file after a command: its lines before, then time, version and the command.

    Examples
    --------
    >>> history("sweep planar_4r").partition("Z ")[2].startswith("fastlink ")
    True
    """
    line = f"{datetime.now(UTC):%Y-%m-%dT%H:%M:%SZ} fastlink {__version__}: {writable(' '.join(command.split()))}"
    return f"{before}\n{line}" if before else line
