"""Find the text of a user's function, and refuse functions whose text says less than they do."""

from __future__ import annotations

import ast
import inspect
import textwrap
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from types import CodeType, FunctionType
from typing import Any

from fastlink._text import short_repr
from fastlink.errors import InputError
from fastlink.numerics.compiler import parsed

__all__ = ["TOO_LONG", "FunctionText", "function_text"]

#: What Python itself, which reads each expression by recursion, has no room for; and what to write.
TOO_LONG = (
    "an expression of too many terms for Python",
    "write it in several assignments: y = ..., y = y + ...",
)
#: What to write where a function cannot be read.
A_FUNCTION = "write it as `def NAME(...)` in a file or a notebook cell, below the decorator"


@dataclass(frozen=True)
class FunctionText:
    """The text of a function.

    Attributes
    ----------
    tree : ast.FunctionDef
        Its syntax.
    text : str
        Its text without decorators, as it was written.
    file : str
        The name of the file, without folders.
    line : int
        The line of the file before its first one.
    names : mapping
        The global names that it sees.
    """

    tree: ast.FunctionDef
    text: str
    file: str
    line: int
    names: dict[str, Any]

    @property
    def place(self) -> str:
        """Where it stands, for messages."""
        return f"{self.file}, line {self.line + self.tree.lineno}"


def function_text(function: Any) -> FunctionText:
    """Return the text of a function of a user.

    Raises
    ------
    InputError
        It is something else, has no text, or does more than its text says.
    """
    if not isinstance(function, FunctionType):
        what = f"{short_repr(function)} is not a function"
        raise InputError(what, where=("quantity",), remedy=A_FUNCTION)
    name = function.__name__
    if name == "<lambda>":
        raise InputError("a lambda has no name and no lines", where=("quantity",), remedy=A_FUNCTION)
    if hasattr(function, "__wrapped__"):
        what = "is wrapped by another decorator"
        raise InputError(what, where=(name,), remedy="write this decorator alone")
    if function.__closure__:
        held = ", ".join(function.__code__.co_freevars)
        what = f"holds {held} of the function around it"
        remedy = "write numbers, or declare inputs with default values: input(NAME, units=..., default=...)"
        raise InputError(what, where=(name,), remedy=remedy)
    lines, first = _lines(function)
    whole = textwrap.dedent("".join(lines))
    try:
        tree = _tree(whole, name)
        # without decorators
        text = "\n".join(whole.split("\n")[tree.lineno - 1 : tree.end_lineno]) if tree else ""
        same = _same_code(text, function.__code__)
    except (RecursionError, MemoryError):
        raise InputError(f"has {TOO_LONG[0]}", where=(name,), remedy=TOO_LONG[1]) from None
    if tree is None or not same:
        what = f"its text in {Path(function.__code__.co_filename).name} is not that of the function"
        raise InputError(what, where=(name,), remedy="load the file again: it was changed since")
    return FunctionText(tree, text, Path(function.__code__.co_filename).name, first - 1, function.__globals__)


def _lines(function: FunctionType) -> tuple[list[str], int]:
    try:
        return inspect.getsourcelines(function)
    except (OSError, TypeError, SyntaxError, IndentationError):
        what = "has no text: it was typed at a prompt, or made by exec"
        raise InputError(what, where=(function.__name__,), remedy=A_FUNCTION) from None


def _tree(text: str, name: str) -> ast.FunctionDef | None:
    """Return the syntax of a function, None of a text that is none of that name."""
    try:
        body = parsed(text).body
    except SyntaxError:
        return None
    found = body[0] if body else None
    return found if isinstance(found, ast.FunctionDef) and found.name == name else None


def _same_code(text: str, code: CodeType) -> bool:
    """Tell whether a text compiles to the code of a function."""
    whole = compile(text, "<own>", "exec")
    again = next((one for one in _codes(whole) if one.co_name == code.co_name), None)
    return again is not None and _essence(again) == _essence(code)


def _codes(code: CodeType) -> Iterator[CodeType]:
    return (one for one in code.co_consts if isinstance(one, CodeType))


def _essence(code: CodeType) -> tuple[Any, ...]:
    inner = tuple(_essence(one) for one in _codes(code))
    numbers = tuple(repr(one) for one in code.co_consts if not isinstance(one, CodeType))
    return code.co_varnames, code.co_names, numbers, inner
