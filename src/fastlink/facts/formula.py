"""Formulas: the straight-line text of a fact, which every program that works with facts reads.

A formula is assignments and what is returned, in Python's expressions without condition, loop or attribute. Kernels
paste its statements, the graph of derivatives and error bounds reads them, and called it computes: with doubles,
arrays, 50 digits, powers of units, growth at toggles, by the operators of these numbers.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cache, cached_property
from typing import Any

from fastlink.numerics import compensated, elementary, logarithm, vectors
from fastlink.numerics.compiler import parsed, syntax

__all__ = ["NAMESPACE", "CatalogueError", "Formula", "parameters"]


ALLOWED_NODES = (
    ast.Assign, ast.Return, ast.Name, ast.Load, ast.Store, ast.Tuple, ast.Constant, ast.Call,
    ast.BinOp, ast.Add, ast.Sub, ast.Mult, ast.Div, ast.BitAnd, ast.BitOr, ast.UnaryOp, ast.USub,
    ast.Compare, ast.Lt, ast.LtE, ast.Gt, ast.GtE, ast.Eq, ast.NotEq,
)  # fmt: skip

#: The functions and constants that a formula may name.
NAMESPACE: dict[str, Any] = {
    **{name: getattr(module, name) for module in (compensated, vectors) for name in module.__all__},
    **{
        name: getattr(elementary, name)
        for name in (
            *("sqrt", "atan2", "cosine", "sine", "select"),
            *("sin", "cos", "exp", "sinh", "cosh", "binary_exponent", "ldexp"),
            *("PI", "TWO_PI", "INFINITY", "NOT_A_NUMBER", "ANGLE_ROUNDING"),
        )
    },
    **{
        name: getattr(logarithm, name) for name in ("arsinh", "log", "log1p", "log_quotient", "quotient_sign")
    },
    "UNIT_ROUNDING": compensated.UNIT_ROUNDING,
}
WORD = re.compile(r"(?<![\w.])[A-Za-z_]\w*")


class CatalogueError(Exception):
    """A mechanism is declared wrongly: the fault is in its declaration, not in its use."""


class Formula:
    """The text of a fact: its parameters, its assignments, and what it returns.

    Attributes
    ----------
    name : str
        The name of the fact, for messages.
    parameters : tuple of str
        What it takes, in order.
    lines : tuple of str
        Assignments, then a return.
    names : mapping
        What names stand for that are neither parameters nor assigned.
    place : str
        The sheet that has it, and the line.
    """

    def __init__(
        self,
        name: str,
        parameters: Sequence[str],
        lines: Iterable[str],
        names: Mapping[str, Any] = NAMESPACE,
        place: str = "",
    ) -> None:
        self.name, self.parameters, self.names, self.place = name, tuple(parameters), names, place
        self.lines = tuple(lines)
        #: How tracebacks name its text, whose first line is the second one there.
        self.file = f"<formula {name}>"

    @classmethod
    @cache
    def of(cls, function: Callable[..., Any]) -> Formula:
        """Return the text of a straight-line function as a formula."""
        if isinstance(function, Formula):
            return function
        tree = syntax(function)
        body = tree.body[1:] if ast.get_docstring(tree) is not None else tree.body
        held = zip(function.__code__.co_freevars, function.__closure__ or (), strict=True)
        names = {**function.__globals__, **{name: cell.cell_contents for name, cell in held}}
        return cls(function.__name__, parameters(function), map(ast.unparse, body), names)

    def __call__(self, *values: Any) -> Any:
        """Compute what the formula returns for values of its parameters, numbers of any type."""
        return self.function(*values)

    @cached_property
    def function(self) -> Callable[..., Any]:
        """The formula as a function of Python."""
        return self.function_with({})

    def function_with(self, exact: Mapping[float, Any]) -> Callable[..., Any]:
        """Return the function with other values in place of some constants."""
        names = {name: self.names.get(name, abs) for name in self.uses}
        names |= {name: exact[value] for name, value in names.items() if _in(exact, value)}
        tree = parsed(self._as_function(self.lines))
        if exact:
            numbers = {value: f"_exact{k}" for k, value in enumerate(exact)}
            names |= {name: exact[value] for value, name in numbers.items()}
            tree = ast.fix_missing_locations(_Replace(numbers).visit(tree))
        exec(compile(tree, self.file, "exec"), names)
        found: Callable[..., Any] = names["formula"]
        return found

    def _as_function(self, lines: Iterable[str]) -> str:
        return "\n    ".join([f"def formula({', '.join(self.parameters)}):", *lines]) + "\n"

    @cached_property
    def body(self) -> list[ast.stmt]:
        """The assignments and the return, as they are written."""
        found: list[ast.stmt] = parsed(self._as_function(self.lines)).body[0].body
        return found

    @cached_property
    def statements(self) -> tuple[ast.stmt, ...]:
        """The assignments and the return, checked against the grammar."""
        body = self.body
        if not isinstance(body[-1], ast.Return):
            raise CatalogueError(f"fact {self.name} must end in its one return")
        for statement in body:
            for node in ast.walk(statement):
                if not isinstance(node, ALLOWED_NODES):
                    what = f"line {ast.unparse(statement)!r}: {type(node).__name__} is not allowed"
                    raise CatalogueError(f"fact {self.name}, {what}")
        if any(isinstance(statement, ast.Return) for statement in body[:-1]):
            raise CatalogueError(f"fact {self.name} must have one return")
        return tuple(body)

    @property
    def result(self) -> ast.expr:
        """The expression that is returned."""
        last = self.statements[-1]
        assert isinstance(last, ast.Return)
        assert last.value is not None
        return last.value

    @cached_property
    def uses(self) -> frozenset[str]:
        """The functions and constants that it names."""
        words = {word for line in self.lines for word in WORD.findall(line)}
        return frozenset(words.intersection({*self.names, "abs"}).difference(self.parameters))


class _Replace(ast.NodeTransformer):
    """Names in place of numbers."""

    def __init__(self, names: Mapping[float, str]) -> None:
        self.names = names

    def visit_Constant(self, node: ast.Constant) -> ast.expr:
        known = _in(self.names, node.value)
        return ast.Name(self.names[node.value], ast.Load()) if known else node  # type: ignore[index]


def _in(numbers: Mapping[float, Any], value: Any) -> bool:
    return isinstance(value, float) and value in numbers


def parameters(function: Callable[..., Any]) -> tuple[str, ...]:
    """Return the names of a function's parameters."""
    code = function.__code__  # inspect.signature takes 30 us
    return code.co_varnames[: code.co_argcount]
