"""Marks for functions that kernels call: how their text is compiled.

The functions stay plain Python, and their text can be read. The two compilers of `fastlink.codegen` read the marks;
nothing here imports one.
"""

from __future__ import annotations

import ast
import inspect
import linecache
import textwrap
import threading
from collections.abc import Callable
from functools import cache
from typing import Any, Literal, TypeVar

F = TypeVar("F", bound=Callable[..., Any])

#: Functions whose text is pasted at each call.
INLINED: set[Callable[..., Any]] = set()
#: Functions that kernels call: a text with loops of its own, compiled once for each kernel.
OUTLINED: set[Callable[..., Any]] = set()
#: Of these, the short ones that are called often: LLVM merges them into their callers.
MERGED: set[Callable[..., Any]] = set()
#: The straight-line text of a function whose other readings are more than that text.
COMPILED_AS: dict[Callable[..., Any], Callable[..., Any]] = {}

#: Loop over vector lanes, a whole number of vectors. The body is straight-line, each lane on its own.
lanes = range
#: Loop over entries side by side, at least as many as a vector has lanes; the last vector may overlap the one before.
entries = range


#: Python 3.11 counts the depth of all threads together while it makes trees: a SystemError, where one gives way.
_ONE_AT_A_TIME = threading.Lock()


def parsed(text: str, mode: Literal["exec", "eval"] = "exec") -> Any:
    """Return the syntax tree of a text, made by one thread at a time."""
    with _ONE_AT_A_TIME:
        return ast.parse(text, mode=mode)


@cache
def syntax(function: Callable[..., Any]) -> ast.FunctionDef:
    """Return the syntax tree of a function."""
    code = function.__code__
    if tree := _functions_of(code.co_filename).get((function.__name__, code.co_firstlineno)):
        return tree
    node = parsed(textwrap.dedent(inspect.getsource(function))).body[0]
    assert isinstance(node, ast.FunctionDef)
    return node


@cache
def _functions_of(file: str) -> dict[tuple[str, int], ast.FunctionDef]:
    """Return the functions of a file by name and first line; each alone takes 1 ms."""
    try:
        tree = parsed("".join(linecache.getlines(file)))
    except SyntaxError:
        return {}
    return {
        (node.name, min([node.lineno, *(part.lineno for part in node.decorator_list)])): node
        for node in tree.body
        if isinstance(node, ast.FunctionDef)
    }


def inlined(function: F) -> F:
    """Mark a straight-line function; a call of it leaves no trace in the machine code."""
    INLINED.add(function)
    return function


def outlined(function: F) -> F:
    """Mark a function with loops of its own."""
    OUTLINED.add(function)
    return function


def merged(function: F) -> F:
    """Mark a short function with branches; a call of it costs more than its body."""
    MERGED.add(function)
    return outlined(function)


def compiled_as(text: Callable[..., Any]) -> Callable[[F], F]:
    """Let kernels read a call of the decorated function as a call of `text`."""
    INLINED.add(text)

    def declare(function: F) -> F:
        COMPILED_AS[function] = text
        return function

    return declare


# -- The codes of what the derivatives of an extreme by the inputs are worth; their meanings stand in
#    `plan.gradients`


SMOOTH, AT_LIMIT, TIED, INFINITE, AT_CHANGE_POINT, NOTHING, KINK, OF_SAMPLES, CONSTANT, JUMP, MOVING = range(
    11
)
