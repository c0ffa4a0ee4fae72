"""Check the values of options: whole numbers, switches, names, paths; in the same words at every door."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Sequence
from numbers import Integral
from pathlib import Path
from typing import Any

from fastlink._text import short_repr
from fastlink.errors import InputError, KeyPath, suggest

__all__ = [
    "MOST_SEED",
    "check_choice",
    "check_output",
    "check_path",
    "check_switch",
    "check_whole",
    "not_a_file",
]

#: The greatest seed: a file holds no greater whole number.
MOST_SEED = 2**63 - 1
#: Bytes of a file's name and of a whole path that file systems have room for.
LONGEST_NAME, LONGEST_PATH = 255, 4095
#: Endings of files that are no HDF5; other programs would misread a map called so.
OTHER_FILES = frozenset(
    {".csv", ".json", ".mat", ".md", ".npy", ".npz", ".parquet", ".pdf", ".pkl", ".png", ".py", ".svg"}
    | {".toml", ".tsv", ".txt", ".xls", ".xlsx", ".yaml", ".yml", ".zarr", ".zip"}
)


def check_whole(
    where: KeyPath, value: Any, least: int, most: float = math.inf, remedy: str | None = None
) -> int:
    """Return a whole number from `least` to `most`, or refuse the value.

    Examples
    --------
    >>> check_whole(("threads",), 0, 1, 4096)
    Traceback (most recent call last):
    fastlink.errors.InputError: threads is 0; write a whole number from 1 to 4096
    """
    whole = isinstance(value, Integral) and not isinstance(value, bool)
    if whole and type(value).__name__ != "timedelta64" and least <= int(value) <= most:
        return int(value)
    bounds = f"of at least {least}" if most == math.inf else f"from {least} to {most}"
    raise InputError(
        f"is {short_repr(value)}", where=where, remedy=remedy or f"write a whole number {bounds}"
    )


def check_switch(where: KeyPath, value: Any) -> bool:
    """Return True or False, or refuse what is neither: a text such as ``"no"`` would count as true.

    Examples
    --------
    >>> check_switch(("overwrite",), "no")
    Traceback (most recent call last):
    fastlink.errors.InputError: overwrite is 'no'; write True or False
    """
    if value is True or value is False:
        return value
    if type(value).__name__ in ("bool", "bool_") and type(value).__module__ == "numpy":
        return bool(value)
    raise InputError(f"is {short_repr(value)}", where=where, remedy="write True or False")


def check_choice(
    where: KeyPath, value: Any, known: Sequence[str], to: str = "", meant: Callable[[str], str] | None = None
) -> str:
    """Return a name among the known ones, or refuse it with the nearest.

    Parameters
    ----------
    where : tuple
        The option.
    value : str
        The name.
    known : sequence of str
        The names that it may be.
    to : str
        Of what they are names, such as ``" to planar_4r"``.
    meant : callable, optional
        Gives the remedy for a text that means one of them, an empty text for others.

    Examples
    --------
    >>> check_choice(("solver",), "dens", ("eliminated", "dense"))
    Traceback (most recent call last):
    fastlink.errors.InputError: solver: 'dens' is unknown; did you mean 'dense'?
    """
    if isinstance(value, str):
        for name in known:
            if name == value:
                return name
    text = value if isinstance(value, str) else short_repr(value)
    remedy = (meant(text) if meant else "") or suggest(text, known)
    raise InputError(f"{short_repr(value)} is unknown{to}", where=where, remedy=remedy)


def check_path(where: KeyPath, value: Any, example: str = "maps.h5") -> Path:
    """Return a path with ``~`` expanded, or refuse what no file can be called.

    Parameters
    ----------
    where : tuple
        The option.
    value : str or os.PathLike of str
        The path.
    example : str
        A path to write instead, for the remedy.

    Examples
    --------
    >>> check_path(("to",), b"maps.h5")
    Traceback (most recent call last):
    fastlink.errors.InputError: to is b'maps.h5', not a path; write text, such as 'maps.h5'
    """
    try:
        text = os.fspath(value)
    except Exception:  # no path, or whatever a class of somebody's does
        text = None
    if not isinstance(text, str):
        remedy = f"write text, such as {example!r}"
        raise InputError(f"is {short_repr(value)}, not a path", where=where, remedy=remedy)
    text = os.path.expanduser(text)
    if (fault := _fault(text)) is not None:
        raise InputError(f"{short_repr(text)} {fault}", where=where, remedy=f"write such as {example!r}")
    return Path(text)


def not_a_file(path: Path) -> str:
    """Return what stands at a path in place of a file, an empty text if nothing does; a pipe would be waited for.

    Examples
    --------
    >>> not_a_file(Path("/")), not_a_file(Path("no such file"))
    ('is a folder', '')
    """
    if os.path.isfile(path) or not os.path.exists(path):
        return ""
    return "is a folder" if os.path.isdir(path) else "is a device or a pipe"


def check_output(where: KeyPath, value: Any) -> Path:
    """Return the path of a map that is to be written, or refuse a name that belongs to something else.

    Examples
    --------
    >>> check_output(("to",), "maps.csv")
    Traceback (most recent call last):
    fastlink.errors.InputError: to: 'maps.csv' is not the name of an HDF5 file; write 'maps.h5'
    """
    path = check_path(where, value)
    name = os.fspath(value)
    if name.endswith(os.sep) and not path.is_dir():
        what = f"{short_repr(name)} ends as the name of a folder does"
        raise InputError(what, where=where, remedy=f"write {str(path)!r}")
    if path.suffix.lower() in OTHER_FILES:
        what = f"{short_repr(name)} is not the name of an HDF5 file"
        raise InputError(what, where=where, remedy=f"write {path.with_suffix('.h5').name!r}")
    return path


def _fault(path: str) -> str | None:
    """Return why no file can have a path, None where one can."""
    if not path.strip():
        return "is empty"
    if (control := next((letter for letter in path if letter < " "), None)) is not None:
        return f"holds the control character {control!r}"
    try:
        encoded = os.fsencode(path)
    except UnicodeEncodeError as error:
        return f"holds {path[error.start]!r}, which no name of a file can"
    longest = max(len(name) for name in encoded.split(os.fsencode(os.sep)))
    if longest > LONGEST_NAME:
        return f"holds a name of {longest} bytes, and file systems have room for {LONGEST_NAME}"
    if len(encoded) > LONGEST_PATH:
        return f"has {len(encoded)} bytes, and a path has room for {LONGEST_PATH}"
    return None
