"""Formulas: the straight-line text of a fact, which every program that works with facts reads.

A formula is assignments and what is returned, in Python's expressions without condition, loop or attribute. Kernels
paste its statements, the graph of derivatives and error bounds reads them, and called it computes: with doubles,
arrays, 50 digits, powers of units, growth at toggles, by the operators of these numbers.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Callable, Container, Iterable, Iterator, Mapping, Sequence
from functools import cache, cached_property
from typing import Any

from fastlink.errors import suggest
from fastlink.numerics import compensated, elementary, logarithm, vectors
from fastlink.numerics.compiler import parsed, syntax

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


class SheetError(CatalogueError):
    """A sheet cannot be read: where, what, and what to write instead."""

    def __init__(self, place: str, what: str, remedy: str) -> None:
        super().__init__(f"{place}: {what}; {remedy}")
        self.place, self.what, self.remedy = place, what, remedy


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
        head = f"def formula({', '.join(self.parameters)}):"
        tree = parsed("\n    ".join([head, *self.lines]) + "\n")
        if exact:
            numbers = {value: f"_exact{k}" for k, value in enumerate(exact)}
            names |= {name: exact[value] for value, name in numbers.items()}
            tree = ast.fix_missing_locations(_Replace(numbers).visit(tree))
        exec(compile(tree, self.file, "exec"), names)
        found: Callable[..., Any] = names["formula"]
        return found

    @cached_property
    def body(self) -> list[ast.stmt]:
        """The assignments and the return, as they are written."""
        try:
            found: list[ast.stmt] = parsed("\n".join(self.lines)).body
        except SyntaxError as error:
            line = self.lines[min(error.lineno or 1, len(self.lines)) - 1]
            raise self._refused(line, f"is no expression of Python, {error.msg}", "mend it") from None
        return found

    @cached_property
    def statements(self) -> tuple[ast.stmt, ...]:
        """The assignments and the return."""
        returns = [isinstance(statement, ast.Return) for statement in self.body]
        if not returns or sum(returns) != 1 or not returns[-1]:
            raise self._refused("", "must end in its one return", "write all that it returns there")
        return tuple(self.body)

    def refused(self, statement: ast.stmt, node: ast.AST, local: Container[str]) -> SheetError:
        """Return the error of a part of a statement that no program which reads formulas would understand."""
        known = [name for name, value in {**self.names, "abs": abs}.items() if callable(value)]
        functions = [name for name in known if name not in local]
        remedy = "write operators, comparisons and calls: select(condition, a, b) for a choice"
        what, kind = "", type(node).__name__
        match node:
            case ast.Call(func=ast.Name(id=name), keywords=[]):
                what, remedy = f"calls {name}, which is no function of formulas", suggest(name, functions)
            case ast.Call():
                kind = "keyword" if node.keywords else type(node.func).__name__
            case ast.Name(id=name) if name in functions:
                what, remedy = f"has the function {name} without arguments", f"write {name}(...)"
            case ast.Compare(ops=[_, _, *_]):
                what, remedy = "compares more than two numbers", "join comparisons of two by &"
            case ast.Constant():
                what, remedy = f"has {node.value!r}, which is no number", "write numbers and names"
            case ast.BinOp(op=ast.Pow()):
                kind, remedy = "Pow", "write powers as products, x * x"
            case ast.BinOp(op=sign) | ast.UnaryOp(op=sign) | ast.Compare(ops=[sign]):
                kind = type(sign).__name__
        what = what or f"has {kind}, which is not in the grammar of formulas"
        return self._refused(statement, what, remedy)

    def _refused(self, line: ast.stmt | str, what: str, remedy: str) -> SheetError:
        text = line if isinstance(line, str) else ast.unparse(line)
        text = f"= {text.removeprefix('return ')}" if text.startswith("return ") else text
        where = f"formula of {self.name}" + (f", line {text!r}," if text else "")
        return SheetError(self.place or self.file, f"{where} {what}", remedy)

    @property
    def nodes(self) -> Iterator[ast.AST]:
        """The nodes of all statements."""
        return (node for statement in self.statements for node in ast.walk(statement))

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
        targets = (line.partition(" = ")[0] for line in self.lines[:-1])
        local = {word for target in targets for word in WORD.findall(target)}
        return frozenset(words.intersection({*self.names, "abs"}) - {*self.parameters} - local)


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
