"""Quantities of one's own beside a study: the Python file that declares them, run only by who trusts it."""

from __future__ import annotations

import linecache
import traceback
from dataclasses import replace
from pathlib import Path
from typing import Any

from fastlink.engine.extending import Extension
from fastlink.errors import InputError, Problem, Setting, path_text
from fastlink.options import check_path, not_a_file
from fastlink.own.source import TOO_LONG

__all__ = ["KEY", "TRUST", "load_extension"]

#: The key of a study that names the file, and the option by which it is run.
KEY, TRUST = "quantities_file", "trust_code"


def load_extension(study: Path, name: Any, mechanism: str, trusted: bool) -> Extension:
    """Return the extension of a mechanism that a file beside a study declares.

    Parameters
    ----------
    study : Path
        The study.
    name : str
        What it names: a path from its own folder.
    mechanism : str
        Its mechanism.
    trusted : bool
        Whether the file may be run.

    Raises
    ------
    InputError
        It may not, or cannot, or does not declare one extension of the mechanism.
    """
    path = study.parent / check_path((KEY,), name, "mine.py")
    if not trusted:
        what = f"names {str(name)!r}, Python code that is run to declare quantities, by who has read it alone"
        remedy = (f"read {path}, and if you trust it write ", Setting(TRUST, True))
        raise InputError(what, where=(KEY,), remedy=remedy)
    scope = _run(path)
    found = {id(one): (key, one) for key, one in scope.items() if isinstance(one, Extension)}
    fitting = [(key, one) for key, one in found.values() if one.mechanism == mechanism]
    if len(fitting) != 1:
        others = ", ".join(f"{key} of {one.mechanism}" for key, one in found.values())
        what = f"{str(name)!r} declares {others or 'no extension of a mechanism'}"
        raise InputError(what, where=(KEY,), remedy=f'write one: mine = fl.extend("{mechanism}")')
    return fitting[0][1]


def _run(path: Path) -> dict[str, Any]:
    """Return the names that a file defines."""
    try:
        if other := not_a_file(path):
            raise InputError(f"{str(path)!r} {other}", where=(KEY,), remedy="name a file of Python code")
        text = path.read_text(encoding="utf-8-sig")
        code = compile(text, str(path), "exec")
    except (OSError, SyntaxError, ValueError) as error:
        why = f"line {error.lineno}: {error.msg}" if isinstance(error, SyntaxError) else str(error)
        what = f"{str(path)!r} cannot be read ({why})"
        raise InputError(what, where=(KEY,), remedy="name a file of Python code beside the study") from None
    except (RecursionError, MemoryError):
        raise InputError(f"{str(path)!r} has {TOO_LONG[0]}", where=(KEY,), remedy=TOO_LONG[1]) from None
    linecache.checkcache(str(path))
    scope: dict[str, Any] = {"__name__": path.stem, "__file__": str(path)}
    try:
        exec(code, scope)
    except InputError as error:
        raise InputError.of(_within(error)) from None
    except Exception as error:
        lines = [one.lineno for one in traceback.extract_tb(error.__traceback__) if one.filename == str(path)]
        line = f"line {lines[-1]}: " if lines else ""
        what = f"{path.name} fails with {type(error).__name__} ({line}{error})"
        raise InputError(what, where=(KEY,), remedy="mend it, and run it by itself: `python FILE`") from None
    return scope


def _within(error: InputError) -> list[Problem]:
    """Return the problems of a declaration, at the key of the study."""
    return [
        replace(one, where=(KEY,), what=f"{path_text(one.where)}: {one.what}".removeprefix(": "))
        for one in error.problems
    ]
