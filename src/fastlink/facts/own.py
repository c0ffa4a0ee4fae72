"""Quantities that users declare: their texts are read, and rewritten in the grammar of facts or refused."""

from __future__ import annotations

import ast
import builtins
import copy
import inspect
import math
import re
import textwrap
import traceback
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache
from itertools import product
from pathlib import Path
from types import CodeType, FunctionType, ModuleType
from typing import Any

import numpy as np

from fastlink._text import short_repr
from fastlink.errors import InputError, KeyPath, Problems, suggest
from fastlink.facts.catalogue import Catalogue
from fastlink.facts.derivative import NoDerivative
from fastlink.facts.expression import DEEPEST
from fastlink.facts.fact import Fact, Input, Rule, System
from fastlink.facts.formula import NAMESPACE, CatalogueError, Formula
from fastlink.facts.names import (
    Derivative,
    ErrorBound,
    ListOfExtrema,
    Quantity,
    Reduced,
    Trust,
    bounded_of,
    error_name,
    root_of,
)
from fastlink.facts.powers import UNITS, Powers, UnlikePowers, dimensions, units_text
from fastlink.numerics import elementary, logarithm, vectors
from fastlink.numerics.compiler import parsed

__all__ = [
    "TAKEN",
    "TOO_LONG",
    "Definition",
    "OwnInput",
    "OwnQuantity",
    "check_name",
    "check_units",
    "declared_names",
    "definition_text",
    "extended",
    "fact_text",
    "function_text",
    "split",
    "used",
]


#: What the text of a fact calls.
HELPERS: dict[str, Any] = {
    function.__name__: function
    for function in (
        *(
            elementary.sqrt,
            elementary.atan2,
            elementary.cosine,
            elementary.sine,
            elementary.select,
            logarithm.log,
        ),
        *(vectors.absolute, vectors.choice, vectors.magnitude),
    )
}
HELPERS["NOT_A_NUMBER"] = elementary.NOT_A_NUMBER
#: Modules whose functions may be called by an attribute.
MODULES = (math, np)
CONSTANTS = {"pi": math.pi, "tau": math.tau, "e": math.e}
#: NaN where either number is.
_OUTER = "choice({{a}} != {{a}}, {{a}}, choice({{a}} {sign} {{b}}, {{a}}, {{b}}))"


@dataclass(frozen=True)
class OwnFunction:
    """A function that may be called: how many numbers it takes, and its text, with a, b for them.

    Where it takes any number, the text is that of two, and others follow one by one; a choice by a condition has none.
    """

    count: int | None
    text: str = ""

    @property
    def is_choice(self) -> bool:
        """Whether its first argument is a condition."""
        return not self.text


_FUNCTIONS = {
    "abs": OwnFunction(1, "absolute({a})"),
    "sqrt": OwnFunction(1, "sqrt({a})"),
    "hypot": OwnFunction(2, "magnitude({a}, {b})"),
    "atan2": OwnFunction(2, "atan2({a}, {b})"),
    "sin": OwnFunction(1, "sine({a})"),
    "cos": OwnFunction(1, "cosine({a})"),
    "tan": OwnFunction(1, "sine({a}) / cosine({a})"),
    "atan": OwnFunction(1, "atan2({a}, 1.0)"),
    "asin": OwnFunction(1, "atan2({a}, sqrt((1.0 - {a}) * (1.0 + {a})))"),
    "acos": OwnFunction(1, "atan2(sqrt((1.0 - {a}) * (1.0 + {a})), {a})"),
    "log": OwnFunction(1, "log({a})"),
    "degrees": OwnFunction(1, f"{180.0 / math.pi!r} * {{a}}"),
    "radians": OwnFunction(1, f"{math.pi / 180.0!r} * {{a}}"),
    "max": OwnFunction(None, _OUTER.format(sign=">")),
    "min": OwnFunction(None, _OUTER.format(sign="<")),
    "where": OwnFunction(3),
}
#: Their names in Python's modules and NumPy.
_ALSO = {
    "fabs": "abs",
    "absolute": "abs",
    "arctan2": "atan2",
    "arctan": "atan",
    "arcsin": "asin",
    "arccos": "acos",
}
_ALSO |= {"maximum": "max", "minimum": "min", "rad2deg": "degrees", "deg2rad": "radians"}


def _known() -> dict[Any, str]:
    """Return the names of functions by the objects of Python and NumPy that they are."""
    found: dict[Any, str] = {}
    for name in (*_FUNCTIONS, *_ALSO):
        for module in (builtins, math, np):
            function = getattr(module, name, None)
            if function is not None and not (module is np and name in ("max", "min")):
                found[function] = _ALSO.get(name, name)
    return found


_OBJECTS = _known()


def function_named(name: str, meant: Any) -> OwnFunction | None:
    """Return a function by its name, or by the object that the name stands for, None of any other.

    A name that stands for nothing is taken by its letters.
    """
    try:
        known = _OBJECTS.get(meant) if meant is not None else _ALSO.get(name, name)
    except TypeError:  # what has no hash
        return None
    return None if known is None else _FUNCTIONS.get(known)


def names_of_functions() -> tuple[str, ...]:
    """Return the names of all functions, for messages."""
    return tuple(sorted(_FUNCTIONS))


def constant_of(value: Any) -> float | None:
    """Return a mathematical constant, None of any other value."""
    return value if isinstance(value, float) and value in CONSTANTS.values() else None


# -- Find the text of a user's function, and refuse functions whose text says less than they do


#: What Python itself, which reads each expression by recursion, has no room for; and what to write.
TOO_LONG = (
    "an expression of too many terms for Python",
    "write it in several assignments: y = ..., y = y + ...",
)
#: What to write where a function cannot be read.
A_FUNCTION = "write it as `def NAME(...)` in a file or a notebook cell, below the decorator"


@dataclass(frozen=True)
class FunctionText:
    """The text of a function."""

    tree: ast.FunctionDef
    text: str
    file: str
    #: The line of the file before its first one.
    line: int
    names: dict[str, Any]

    @property
    def place(self) -> str:
        """Where it stands, for messages."""
        return f"{self.file}, line {self.line + self.tree.lineno}"


def function_text(function: Any) -> FunctionText:
    """Return the text of a function of a user."""
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


# -- Rewrite the text of a user's function in the grammar of facts, or refuse it with line, reason and remedy


#: The greatest power that is written as products.
MOST_POWER = 16
#: The most conditions that are joined in one line.
MOST_JOINED = 32
NUMBER, CONDITION = "number", "condition"
SIGNS = (ast.Add, ast.Sub, ast.Mult, ast.Div)
COMPARISONS = (ast.Lt, ast.LtE, ast.Gt, ast.GtE, ast.Eq, ast.NotEq)
A_LOOP_IN_IT = "is a loop", "write each term"
#: What is no number.
EXPRESSIONS: dict[type[ast.AST], tuple[str, str]] = {
    ast.Lambda: ("is a lambda", "write its formula here"),
    ast.ListComp: A_LOOP_IN_IT,
    ast.GeneratorExp: A_LOOP_IN_IT,
    ast.SetComp: A_LOOP_IN_IT,
    ast.DictComp: A_LOOP_IN_IT,
    ast.List: ("is a list", "write numbers"),
    ast.Tuple: ("is several values", "return one number; declare a quantity for each"),
    ast.Dict: ("is a dict", "write numbers"),
    ast.Subscript: ("is a part of something", "take a parameter for it"),
    ast.JoinedStr: ("is a text", "write numbers"),
    ast.NamedExpr: ("assigns within an expression", "assign on a line of its own"),
    ast.Starred: ("has an unknown number of values", "write each"),
}
#: The functions that may be called, for messages.
KNOWN = ", ".join(names_of_functions())
A_NUMBER = "write `1.0 if condition else 0.0`"
CHOOSE = "write `a if condition else b`, or max and min"
A_LOOP = "is a loop", "write each term: only straight-line code is compiled for any number of designs"
#: What is not straight-line code, and what to write instead.
STATEMENTS: dict[type[ast.AST], tuple[str, str]] = {
    ast.If: ("branches", CHOOSE),
    ast.For: A_LOOP,
    ast.While: A_LOOP,
    ast.Match: ("branches", CHOOSE),
    ast.FunctionDef: (
        "defines a function",
        "declare it as a quantity of its own, and take that as a parameter",
    ),
    ast.ClassDef: ("defines a class", "write assignments and one return"),
    ast.Global: ("is about global names", "take a parameter, or declare an input with a default value"),
    ast.Nonlocal: ("is about outer names", "take a parameter, or declare an input with a default value"),
    ast.Import: ("imports", "import above the function"),
    ast.ImportFrom: ("imports", "import above the function"),
    ast.Assert: ("tests", "write the value where it holds, and another one else: `a if condition else b`"),
    ast.Raise: ("raises an error", CHOOSE),
    ast.Expr: ("has no effect", "leave it out"),
    ast.Pass: ("has no effect", "leave it out"),
}


@dataclass(frozen=True)
class FactText:
    """A function in the grammar of facts."""

    text: str
    parameters: tuple[str, ...]
    #: The line of the user's text that each line is of, from the second one.
    lines: tuple[int, ...]
    imports: tuple[str, ...]
    #: Whether a condition chooses a value, which may jump there.
    jumps: bool


class Refused(Exception):
    """Something that no fact has; it is noted."""


class _Rewriter:
    """The statements, numbers and conditions of a function while they are rewritten."""

    def __init__(self, of: FunctionText) -> None:
        self.of, self.problems, self.name = of, Problems(), of.tree.name
        self.parameters = self._parameters(of.tree.args)
        self.kinds: dict[str, str] = dict.fromkeys(self.parameters, NUMBER)
        self.written: list[tuple[str, int]] = []
        self.imports: set[str] = set()
        #: The values that are compared: where one is no number, nothing that is chosen is one.
        self.compared: dict[str, None] = {}
        #: The name of the condition that earlier ones of them are numbers, if there were many.
        self.exist: list[str] = []
        #: How deep the texts of numbers and conditions are nested; names are not.
        self.depths: dict[str, int] = {}
        self.line, self.temporaries, self.jumps = 0, 0, False

    def rewritten(self) -> FactText:
        """Return the function, or raise InputError with all problems."""
        body = list(self.of.tree.body)
        if body and isinstance(body[0], ast.Expr) and isinstance(getattr(body[0].value, "value", None), str):
            body = body[1:]
        *assignments, last = body or [ast.Pass(lineno=self.of.tree.lineno)]
        for statement in assignments:
            self._guard(self._statement, statement)
        if isinstance(last, ast.Return) and last.value is not None:
            self._guard(self._return, last)
        elif not self.problems.noted or isinstance(last, ast.Return):
            self.line = last.lineno
            self.note("ends without a value", "end in `return` and one number")
        self.problems.stop()
        head = f"def {self.name}({', '.join(self.parameters)}):"
        text = "\n    ".join([head, *(line for line, _ in self.written)]) + "\n"
        lines = tuple(self.of.line + line for _, line in self.written)
        return FactText(text, self.parameters, lines, tuple(sorted(self.imports)), self.jumps)

    def _guard(self, read: Callable[[Any], None], statement: ast.stmt) -> None:
        """Read a statement; what is refused is noted, and the others are read all the same."""
        self.line = statement.lineno
        try:
            read(statement)
        except Refused:
            for target in getattr(statement, "targets", [getattr(statement, "target", None)]):
                if isinstance(target, ast.Name):
                    self.kinds.setdefault(target.id, NUMBER)
        except RecursionError:
            self.note(f"has {TOO_LONG[0]}", TOO_LONG[1])

    # -- statements ----------------------------------------------------------------------------------------------

    def _statement(self, node: ast.stmt) -> None:
        if isinstance(node, ast.Assign) and all(isinstance(target, ast.Name) for target in node.targets):
            self._assign([target.id for target in node.targets if isinstance(target, ast.Name)], node.value)
        elif isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name) and node.value is not None:
            self._assign([node.target.id], node.value)
        elif isinstance(node, ast.AugAssign) and isinstance(node.target, ast.Name):
            of = ast.copy_location(ast.Name(node.target.id, ast.Load()), node)
            self._assign([node.target.id], ast.copy_location(ast.BinOp(of, node.op, node.value), node))
        elif isinstance(node, (ast.Assign, ast.AnnAssign, ast.AugAssign)):
            raise self.refuse(
                node, "assigns to more than a name", "assign one number to one name on each line"
            )
        elif isinstance(node, ast.Return):
            raise self.refuse(node, "is not the last line", f"end in one return: {CHOOSE}")
        else:
            what, remedy = STATEMENTS.get(
                type(node), ("is not straight-line code", "write assignments and one return")
            )
            raise self.refuse(node, what, remedy)

    def _assign(self, names: Sequence[str], value: ast.expr) -> None:
        for name in names:
            if name in HELPERS or name in CONSTANTS:
                raise self.refuse(
                    value, f"is called {name}, as a function or constant is", "call it otherwise"
                )
        kind = self.kind(value)
        text = self.condition(value) if kind == CONDITION else self.number(value)
        for name in names:
            self.write(f"{local_name(name, self.parameters)} = {text}")
            self.kinds[name] = kind

    def _return(self, node: ast.Return) -> None:
        assert node.value is not None
        self.write(f"return {self.number(node.value)}")

    def note(self, what: str, remedy: str, node: ast.AST | None = None) -> None:
        """Note a problem at the line at hand."""
        text = "" if node is None else f"{quoted(node)} "
        place = f"line {self.of.line + self.line} of {self.of.file}: "
        self.problems.add(f"{place}{text}{what}", (self.name,), remedy)

    def refuse(self, node: ast.AST, what: str, remedy: str) -> Refused:
        """Note a problem of a node, and return what to raise."""
        self.line = getattr(node, "lineno", self.line)
        self.note(what, remedy, node)
        return Refused()

    def _parameters(self, args: ast.arguments) -> tuple[str, ...]:
        self.line = self.of.tree.lineno
        if args.vararg or args.kwarg:
            self.note("takes any number of arguments", "name each quantity and input that it depends on")
        named = [*args.posonlyargs, *args.args]
        defaults = dict(
            zip([one.arg for one in named][len(named) - len(args.defaults) :], args.defaults, strict=True)
        )
        own = {one.arg: value for one, value in zip(args.kwonlyargs, args.kw_defaults, strict=True) if value}
        for name, value in (defaults | own).items():
            remedy = f'declare it: input("{name}", units=..., default={quoted(value)[1:-1]})'
            self.note(f"the parameter {name} has a default value", remedy)
        names = tuple(one.arg for one in (*named, *args.kwonlyargs))
        if not names:
            self.note("takes no parameter", "name the quantities and inputs that it depends on")
        return names

    def write(self, line: str) -> None:
        """Append a line."""
        self.written.append((line, self.line))

    def _bound(self, text: str) -> str:
        """Return a name or number that stands for a text, which is computed once."""
        if re.fullmatch(r"\w+|\d[\w.]*", text):
            return text
        self.temporaries += 1
        name = f"_{self.temporaries}"
        self.write(f"{name} = {text}")
        return name

    def _nested(self, text: str, *parts: str) -> str:
        """Return a text made of others, by a name where it is nested as deep as any reader of it goes."""
        depth = 1 + max(self.depths.get(part, 0) for part in parts)
        if depth >= DEEPEST:
            return self._bound(text)
        self.depths[text] = depth
        return text

    def _joined(self, sign: str, parts: Sequence[str]) -> str:
        """Return conditions joined by a sign, many of them group by group."""
        parts = list(parts)
        if len(parts) + max(self.depths.get(part, 0) for part in parts) >= DEEPEST:
            parts = [self._bound(part) for part in parts]
        while len(parts) > MOST_JOINED:
            groups = [parts[k : k + MOST_JOINED] for k in range(0, len(parts), MOST_JOINED)]
            parts = [self._bound(sign.join(group)) for group in groups]
        if len(parts) == 1:
            return parts[0]
        text = f"({sign.join(parts)})"
        self.depths[text] = len(parts) + max(self.depths.get(part, 0) for part in parts)
        return text

    # -- expressions ---------------------------------------------------------------------------------------------

    def kind(self, node: ast.expr) -> str:
        """Tell whether an expression is a number or a condition."""
        if isinstance(node, ast.Name):
            return self.kinds.get(node.id, NUMBER)
        if isinstance(node, ast.BinOp) and isinstance(node.op, (ast.BitAnd, ast.BitOr)):
            return CONDITION
        is_not = isinstance(node, ast.UnaryOp) and isinstance(node.op, (ast.Not, ast.Invert))
        return CONDITION if isinstance(node, (ast.Compare, ast.BoolOp)) or is_not else NUMBER

    def number(self, node: ast.expr) -> str:
        """Return the text of a number."""
        if self.kind(node) == CONDITION:
            raise self.refuse(node, "is a condition, not a number", A_NUMBER)
        match node:
            case ast.Constant():
                return self._constant(node)
            case ast.Name():
                return self._name(node)
            case ast.Attribute():
                return self._attribute(node)
            case ast.UnaryOp(op=ast.UAdd() | ast.USub()):
                return self._signed(node)
            case ast.BinOp(op=ast.Pow()):
                return self._power(node)
            case ast.BinOp() if isinstance(node.op, SIGNS):
                return self._chain(node, SIGNS, "+-*/", self.number)
            case ast.BinOp():
                raise self.refuse(node, "is an operation that facts do not have", "write + - * / or **")
            case ast.IfExp():
                return self._choices(node)
            case ast.Call():
                return self._call(node)
        what, remedy = EXPRESSIONS.get(
            type(node), ("is not a number", "write numbers, + - * / and functions")
        )
        raise self.refuse(node, what, remedy)

    def _signed(self, node: ast.expr) -> str:
        """Return a number after any number of signs."""
        minus = 0
        while isinstance(node, ast.UnaryOp) and isinstance(node.op, (ast.UAdd, ast.USub)):
            minus += isinstance(node.op, ast.USub)
            node = node.operand
        text = self.number(node)
        for _ in range(minus):
            text = self._nested(f"(-{text})", text)
        return text

    def _chain(
        self,
        node: ast.expr,
        operators: tuple[type[ast.operator], ...],
        signs: str,
        read: Callable[[ast.expr], str],
    ) -> str:
        """Return operations on what stands left of them, in chains of any length: no recursion."""
        chain = []
        while isinstance(node, ast.BinOp) and isinstance(node.op, operators):
            chain.append(node)
            node = node.left
        text = read(node)
        for one in reversed(chain):
            right = read(one.right)
            text = self._nested(f"({text} {signs[operators.index(type(one.op))]} {right})", text, right)
        return text

    def _constant(self, node: ast.Constant) -> str:
        if isinstance(node.value, bool) or not isinstance(node.value, (int, float)):
            raise self.refuse(node, "is not a real number", "write numbers")
        try:
            value = float(node.value)
        except OverflowError:
            value = math.inf
        if not math.isfinite(value):
            raise self.refuse(node, "is not finite", "write finite numbers")
        return repr(value)

    def _name(self, node: ast.Name) -> str:
        if node.id in self.kinds:
            return local_name(node.id, self.parameters)
        meant = self.of.names.get(node.id)
        if (constant := constant_of(meant)) is not None:
            self.imports.add(_import(_name_of(constant), node.id))
            return repr(constant)
        if meant is not None or hasattr(builtins, node.id):
            number = f", default={meant!r}" if isinstance(meant, (int, float)) else ""
            remedy = (
                f'write the number, or declare input("{node.id}", units=...{number}) and make it a parameter'
            )
            raise self.refuse(node, "is a name outside of the function", remedy)
        remedy = suggest(node.id, [*self.kinds]) if self.kinds else ""
        remedy = remedy if remedy.startswith("did you mean") else "make it a parameter"
        raise self.refuse(node, "is neither a parameter nor assigned above", remedy)

    def _module(self, node: ast.expr) -> ModuleType | None:
        found = (
            self.of.names.get(node.id) if isinstance(node, ast.Name) and node.id not in self.kinds else None
        )
        if not isinstance(found, ModuleType) or found not in MODULES:
            return None
        assert isinstance(node, ast.Name)
        called = "" if found.__name__ == node.id else f" as {node.id}"
        self.imports.add(f"import {found.__name__}{called}")
        return found

    def _attribute(self, node: ast.Attribute) -> str:
        module = self._module(node.value)
        constant = None if module is None else constant_of(getattr(module, node.attr, None))
        if constant is None:
            raise self.refuse(node, "is not a number", "write the number")
        return repr(constant)

    def _power(self, node: ast.BinOp) -> str:
        exponent = node.right
        negative = isinstance(exponent, ast.UnaryOp) and isinstance(exponent.op, ast.USub)
        number = getattr(exponent.operand if isinstance(exponent, ast.UnaryOp) else exponent, "value", None)
        halves = 2 * number if isinstance(number, (int, float)) and not isinstance(number, bool) else 0.5
        if halves != int(halves) or not 0 < halves <= 2 * MOST_POWER:
            remedy = f"write a whole or half number up to {MOST_POWER}, such as x**2, x**-1 or x**0.5"
            raise self.refuse(node, "is a power that facts do not have", remedy)
        base = self._bound(self.number(node.left))
        factors = [self._bound(f"sqrt({base})")] if int(halves) % 2 else []
        square, whole = base, int(halves) // 2
        while whole:
            factors += [square] if whole % 2 else []
            whole //= 2
            square = self._bound(f"{square} * {square}") if whole else square
        product = f"({' * '.join(factors)})" if factors[1:] else factors[0]
        return f"(1.0 / {product})" if negative else product

    def _choices(self, node: ast.expr) -> str:
        """Return choices that follow one another, in chains of any length: no recursion."""
        self.jumps = True
        chain = []
        while isinstance(node, ast.IfExp):
            chain.append((self.condition(node.test), self.number(node.body)))
            node = node.orelse
        return self._chosen(chain, self.number(node))

    def _chosen(self, chain: Sequence[tuple[str, str]], text: str) -> str:
        """Return the number of the first condition of a chain that holds, else a text."""
        if len(self.compared) > MOST_JOINED:
            parts = [*self.exist, *(f"({one} == {one})" for one in self.compared)]
            self.exist, self.compared = [self._bound(self._joined(" & ", parts))], {}
        parts = [*self.exist, *(f"({one} == {one})" for one in self.compared)]
        exist = " & ".join(parts)
        self.depths[exist] = len(parts)
        for condition, number in reversed(chain):
            text = self._nested(f"choice({condition}, {number}, {text})", condition, number, text)
            text = self._nested(f"select({exist}, {text}, NOT_A_NUMBER)", exist, text) if exist else text
        return text

    def _called(self, node: ast.Call) -> tuple[str, OwnFunction | None]:
        if isinstance(node.func, ast.Attribute):
            module = self._module(node.func.value)
            meant = None if module is None else getattr(module, node.func.attr, None)
            return node.func.attr, None if meant is None else function_named(node.func.attr, meant)
        if not isinstance(node.func, ast.Name) or node.func.id in self.kinds:
            return "", None
        name = node.func.id
        meant = self.of.names.get(name, getattr(builtins, name, None))
        found = function_named(name, meant)
        if found is not None and meant is not None and getattr(meant, "__module__", None) == "math":
            self.imports.add(_import(meant.__name__, name))
        return name, found

    def _call(self, node: ast.Call) -> str:
        name, function = self._called(node)
        if node.keywords or any(isinstance(one, ast.Starred) for one in node.args):
            raise self.refuse(node, "has arguments by name or in a list", "write one number for each")
        if name == self.name:
            raise self.refuse(node, "calls itself", "write a formula")
        if function is None:
            remedy = f"write its formula here, or make it a quantity and a parameter; known: {KNOWN}"
            raise self.refuse(node, "calls a function that no fact has", remedy)
        least = 2 if function.count is None else function.count
        if len(node.args) < least or (function.count is not None and len(node.args) > function.count):
            more = " or more" if function.count is None else ""
            remedy = f"{name} takes {least}{more}"
            raise self.refuse(node, "has another number of arguments", remedy)
        if function.is_choice:
            return self._choices(ast.IfExp(*node.args))
        numbers = [self._bound(self.number(one)) for one in node.args]
        if function.count is not None:
            return f"({function.text.format(**dict(zip('ab', numbers, strict=False)))})"
        result = numbers[0]
        for other in numbers[1:]:
            result = self._bound(function.text.format(a=result, b=other))
        return result

    def condition(self, node: ast.expr) -> str:
        """Return the text of a condition."""
        match node:
            case ast.Name() if self.kinds.get(node.id) == CONDITION:
                return local_name(node.id, self.parameters)
            case ast.Compare() if all(isinstance(sign, COMPARISONS) for sign in node.ops):
                numbers = [self._bound(self.number(one)) for one in (node.left, *node.comparators)]
                self.compared.update(dict.fromkeys(one for one in numbers if not one[0].isdigit()))
                signs = [
                    ("<", "<=", ">", ">=", "==", "!=")[COMPARISONS.index(type(sign))] for sign in node.ops
                ]
                parts = [f"({a} {s} {b})" for a, s, b in zip(numbers, signs, numbers[1:], strict=False)]
                return self._joined(" & ", parts)
            case ast.BoolOp():
                sign = " & " if isinstance(node.op, ast.And) else " | "
                return self._joined(sign, [self.condition(one) for one in node.values])
            case ast.BinOp(op=ast.BitAnd() | ast.BitOr()):
                return self._chain(node, (ast.BitAnd, ast.BitOr), "&|", self.condition)
            case ast.UnaryOp():
                raise self.refuse(
                    node, "negates a condition", "turn its comparison round: `a <= b` for `not a > b`"
                )
        raise self.refuse(node, "is not a condition", "compare two numbers: < <= > >= == !=")


def fact_text(of: FunctionText) -> FactText:
    """Return a function in the grammar of facts."""
    return _Rewriter(of).rewritten()


def local_name(name: str, parameters: Sequence[str]) -> str:
    """Return the name of a parameter, or a local name that no function of a fact has."""
    return name if name in parameters else f"_{name}"


def _import(name: str, called: str) -> str:
    """Return the import of a name of the module math, perhaps by another name."""
    return f"from math import {name}" + (f" as {called}" if called != name else "")


def _name_of(constant: float) -> str:
    return next(name for name, value in CONSTANTS.items() if value == constant)


def quoted(node: ast.AST) -> str:
    """Return a short text of a node, in quotes."""
    try:
        text = ast.unparse(node).splitlines()[0]
    except RecursionError:
        return "`...`"
    return f"`{text if len(text) <= 40 else text[:37] + '...'}`"


# -- Names that no quantity or input of a user can have


#: Names of options and coordinates.
OPTIONS = (
    *("active", "refinement", "starts"),
    *(
        "allow_invalid",
        "angles",
        "angles_deg",
        "attrs",
        "backend",
        "block",
        "branch",
        "client",
        "design",
        "extrema",
    ),
    *(
        "extremum",
        "input",
        "inputs",
        "keep",
        "layout",
        "links",
        "mechanism",
        "n",
        "outputs",
        "overwrite",
        "part",
    ),
    *(
        "positions",
        "progress",
        "quantities",
        "restart",
        "seed",
        "solver",
        "space",
        "status",
        "threads",
        "to",
        "verify",
    ),
)
#: Names of variables and functions in the texts of kernels.
OF_KERNELS = (
    *("begin_certain", "collect_toggles", "flag_undecided", "keep_certain"),
    *("note_hidden", "note_uncertain", "settle_toggles"),
    *("collect_jumps", "forget_slopes", "forget_splits", "keep_slopes", "keep_splits", "mark_splits"),
    *("next_split", "place_split", "replace_cells", "splits"),
    *(
        "bound_hidden",
        "count_near",
        "count_turned",
        "keep_away",
        "keep_near",
        "keep_turned",
        "n_turned",
        "place_near",
    ),
    *("abs", "advance_roots", "advance_valleys", "append_item", "append_of_lane", "append_unresolved"),
    *("array", "at", "begin_roots", "begin_valleys", "best", "bound_at_zero", "bound_ends"),
    *("bound_zeros", "clear", "collect", "collect_ends", "collect_fine", "collect_folds"),
    *("collect_octaves", "collect_rest", "collect_unresolved", "count_folded"),
    *("counts", "designs", "divide", "divided", "doubt", "drop_folds", "end_values", "ends", "entries"),
    *("every_vector", "extrema_at_zeros", "filled", "fine_marks", "flags", "flattened"),
    *("fluctuation_lanes", "forget_winners", "from_high", "from_low", "from_upper", "gather"),
    *("gradients", "has_no_bound", "i", "i0", "inf", "j", "j0", "j1", "j2", "judge_winners", "k"),
    *("keep_beside", "keep_beside_fold", "keep_fine", "keep_octave", "keep_slope", "kernel", "known"),
    *("lanes", "lists", "mark", "mark_ends", "mark_fine", "mark_unresolved", "marks", "max", "min"),
    *(
        "mirror_image",
        "n_angles",
        "n_designs",
        "n_ends",
        "n_here",
        "n_lost",
        "n_moving",
        "n_near",
        "n_octaves",
    ),
    *("n_open", "n_tries", "n_vectors", "nan", "note_kinks", "note_winners", "nothing_yet", "octaves"),
    *("of_better", "off_at_end", "outlined", "padded", "piece", "place_beside", "place_beside_fold"),
    *("place_ends", "place_fine", "place_lost", "place_octave", "place_samples", "place_slope"),
    *("begin_octaves", "weigh_octave"),
    *("position", "range", "rest", "roots", "samples", "set_bracket", "settle_jumps", "settle_noise"),
    *("settle_slopes", "side", "signs", "silence_rest", "silenced", "solve_lanes", "split", "square"),
    *("start", "state", "step", "store_best", "store_bound", "store_change", "store_counts"),
    *("store_extrema", "store_gradient", "store_list", "store_status", "sums", "table"),
    *("thin", "tile", "to_sample", "trial", "tries", "turn", "unresolved", "upper", "v", "valleys"),
    *("vectors", "w", "w2", "width", "winners"),
)
TAKEN = frozenset({*OPTIONS, *OF_KERNELS, *HELPERS, *NAMESPACE})
#: The beginnings of names that kernels make.
MADE = r"out_|whole_|(asked|columns|f|gradient|limit|part|rows|search|slope|split_by|value)_\d"
#: Letters of the longest name: results have endings, and files room for 255.
LONGEST = 60


def check_name(name: Any) -> None:
    """Refuse a name that no file or kernel could have.

    Examples
    --------
    >>> check_name("width")
    Traceback (most recent call last):
    fastlink.errors.InputError: 'width' is a word of fastlink's own; call it otherwise, such as 'my_width'
    """
    is_text = isinstance(name, str) and len(name) <= LONGEST
    if not (is_text and re.fullmatch("[A-Za-z](_?[A-Za-z0-9])*", name)):
        remedy = f"write up to {LONGEST} letters of a to z, digits and single underscores between them"
        raise InputError(f"{short_repr(name)} cannot be a name", remedy=remedy)
    if name in TAKEN or re.match(MADE, name):
        raise InputError(
            f"{name!r} is a word of fastlink's own", remedy=f"call it otherwise, such as 'my_{name}'"
        )


# -- Split a user's text at its kinks: the values that vanish there, and the smooth texts between which it
#    chooses


#: The most smooth texts that are searched one by one; a text with more of them is searched as it is.
MOST_PIECES = 8
#: The most kinks and magnitudes that are searched: with twice as many, a kernel takes four times as long to compile.
MOST_KINKS = 64


@dataclass(frozen=True)
class Split:
    """The texts of functions of one name, each with its parameters."""

    #: What vanishes at the kinks.
    switches: tuple[str, ...]
    #: The smooth texts, none where they are too many; and magnitudes within, sharp where they almost vanish.
    pieces: tuple[str, ...]
    too_many: bool = False


def split(text: str, parameters: tuple[str, ...], kinked: Mapping[str, tuple[str, ...]]) -> Split | None:
    """Return what a text chooses between, None of a text without kinks."""
    tree = parsed(text).body[0]
    assert isinstance(tree, ast.FunctionDef)
    kinks: dict[str, tuple[int, ast.expr]] = {}
    magnitudes: dict[str, tuple[int, ast.expr]] = {}
    for number, statement in enumerate(tree.body):
        for node in ast.walk(statement):
            if isinstance(node, ast.Call) and (sides := _sides(node)):
                kinks.setdefault(ast.dump(node), (number, _difference(*sides)))
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "magnitude":
                magnitudes.setdefault(ast.dump(node), (number, node))
    if len(kinks) + len(magnitudes) > MOST_KINKS:
        return Split((), (), too_many=True)
    norms = dict.fromkeys(_with(tree, tree.body[:number], node) for number, node in magnitudes.values())
    inner = [name for name in parameters if name in kinked]
    if not kinks and not inner and not norms:
        return None
    switches = tuple(_with(tree, tree.body[:number], difference) for number, difference in kinks.values())
    count = 2 ** len(kinks)
    for name in inner:
        count *= max(len(kinked[name]), MOST_PIECES if not kinked[name] else 1)
    if count > MOST_PIECES:
        return Split(switches, tuple(norms))
    pieces: dict[str, None] = {}
    for chosen in product(range(2), repeat=len(kinks)):
        for names in product(*(kinked[name] for name in inner)):
            piece = _Choose(dict(zip(kinks, chosen, strict=True)), dict(zip(inner, names, strict=True)))
            pieces[ast.unparse(ast.fix_missing_locations(piece.visit(copy.deepcopy(tree))))] = None
    return Split(switches, tuple(pieces | norms))


def only_name(text: str) -> str:
    """Return the parameter that a function returns as it is, empty where it returns something else."""
    names: dict[str, str] = {}
    tree = parsed(text).body[0]
    assert isinstance(tree, ast.FunctionDef)
    for statement in tree.body:
        value = getattr(statement, "value", None)
        name = names.get(value.id, value.id) if isinstance(value, ast.Name) else ""
        if isinstance(statement, ast.Assign) and isinstance(target := statement.targets[0], ast.Name):
            names[target.id] = name
    return name


def _sides(node: ast.Call) -> tuple[ast.expr, ast.expr] | None:
    """Return the two values of a choice of the greater or the lesser, or of a size and its negative."""
    name = node.func.id if isinstance(node.func, ast.Name) else ""
    if name == "absolute":
        return node.args[0], ast.UnaryOp(ast.USub(), node.args[0])
    square = node.args[0]
    if (
        name == "sqrt"
        and isinstance(square, ast.BinOp)
        and isinstance(square.op, ast.Mult)
        and _same(square.left, square.right)
    ):
        return square.left, ast.UnaryOp(ast.USub(), square.left)
    if name != "choice" or len(node.args) != 3 or not isinstance(node.args[0], ast.Compare):
        return None
    condition, first, second = node.args
    if not (isinstance(condition, ast.Compare) and isinstance(condition.ops[0], (ast.Lt, ast.Gt))):
        return None
    own = _same(condition.left, first) and _same(condition.comparators[0], second)
    return (first, second) if own else None


def _same(first: ast.expr, *others: ast.expr) -> bool:
    """Tell whether texts are the same."""
    return all(ast.dump(first) == ast.dump(other) for other in others)


def _difference(first: ast.expr, second: ast.expr) -> ast.expr:
    """Return what vanishes where both values are equal."""
    return first if isinstance(second, ast.UnaryOp) else ast.BinOp(first, ast.Sub(), second)


def _with(tree: ast.FunctionDef, before: list[ast.stmt], value: ast.expr) -> str:
    """Return a function that returns another value, after the statements before."""
    found = copy.deepcopy(tree)
    found.body = [*before, ast.Return(value)]
    return ast.unparse(ast.fix_missing_locations(found))


class _Choose(ast.NodeTransformer):
    """Put one side in place of each kink, and other names in place of parameters."""

    def __init__(self, sides: Mapping[str, int], names: Mapping[str, str]) -> None:
        self.sides, self.names = sides, names

    def visit_Call(self, node: ast.Call) -> ast.AST:
        side, values = self.sides.get(ast.dump(node)), _sides(node)
        if side is not None and values is not None:
            return self._of(values[side])
        # the same value before a choice between it and another one, where it is no number
        if isinstance(node.func, ast.Name) and node.func.id == "choice" and len(node.args) == 3:
            test = node.args[0]
            of_itself = isinstance(test, ast.Compare) and isinstance(test.ops[0], ast.NotEq)
            if of_itself and _same(test.left, test.comparators[0], node.args[1]):  # type: ignore[attr-defined]
                return self._of(node.args[2])
        return self.generic_visit(node)

    def _of(self, node: ast.expr) -> ast.AST:
        found: ast.AST = self.visit(copy.deepcopy(node))
        return found

    def visit_Name(self, node: ast.Name) -> ast.AST:
        return ast.Name(self.names.get(node.id, node.id), node.ctx)

    def visit_arg(self, node: ast.arg) -> ast.AST:
        return ast.arg(self.names.get(node.arg, node.arg))


# -- Check the units of a user's quantity: its text runs on numbers that have no value, only a dimension

# A text means the same in any units: constants are pure numbers, what has a unit is an input.


#: What other programs call units, and their texts here.
OTHERS = {
    "deg": "rad",
    "degree": "rad",
    "degrees": "rad",
    "°": "rad",
    "": "1",
    "-": "1",
    "dimensionless": "1",
}
OTHERS |= {
    "Nm": "N m",
    "N*m": "N m",
    "m/s": "m s-1",
    "rad/s": "rad s-1",
    "Hz": "s-1",
    "Pa": "N m-2",
    "mm": "m",
}
OTHERS |= {"m/s2": "m s-2", "m/s^2": "m s-2", "kg*m2": "kg m2", "kN": "N", "ms": "s", "g": "kg", "%": "1"}


def check_units(where: KeyPath, units: Any) -> str:
    """Return the units of a quantity or an input, or refuse what files cannot state.

    Examples
    --------
    >>> check_units(("units",), "N m")
    'N m'
    >>> check_units(("units",), "m/s")
    Traceback (most recent call last):
    fastlink.errors.InputError: units is 'm/s'; write 'm s-1'
    """
    text = " ".join(units.split()) if isinstance(units, str) else ""
    found = [re.fullmatch(r"([A-Za-z]+|1)(-?\d*)", one) for one in text.split()]
    if found and all(one is not None and one[1] in UNITS for one in found):
        return text
    meant = OTHERS.get(units.strip()) if isinstance(units, str) else None
    known = f"of {', '.join(UNITS)} with whole powers, such as 'kg m2 s-2' or 'rad s-1'"
    remedy = f"write {meant!r}" if meant else f"write a product {known}"
    raise InputError(f"is {short_repr(units)}", where=where, remedy=remedy)


# -- Declarations of users as data: inputs, and quantities by their texts, from which catalogues are made
#    anywhere


@dataclass(frozen=True)
class OwnInput:
    """An input that a user declares."""

    name: str
    units: str
    symbol: str
    meaning: str
    rule: Rule
    default: float | None

    @property
    def text(self) -> str:
        """Its declaration, to be read and run."""
        given = {"units": self.units, "default": self.default, "rule": self.rule, "description": self.meaning}
        given |= {} if self.symbol == self.name else {"symbol": self.symbol}
        usual = {"rule": "any", "default": None, "description": self.name}
        shown = (f"{key}={value!r}" for key, value in given.items() if value != usual.get(key, ""))
        return f"mine.input({self.name!r}, {', '.join(shown)})"


@dataclass(frozen=True)
class OwnQuantity:
    """A quantity that a user declares."""

    name: str
    units: str
    symbol: str
    meaning: str
    parameters: tuple[str, ...]
    #: Its text as that of a fact; `written` as the user wrote it.
    fact: str
    written: str
    imports: tuple[str, ...]
    jumps: bool
    file: str = field(compare=False, repr=False)
    line: int = field(compare=False, repr=False)
    #: The lines of the file of each line of `fact`, from its second one.
    lines: tuple[int, ...] = field(compare=False, repr=False)

    @property
    def text(self) -> str:
        """Its declaration, to be read and run."""
        symbol = "" if self.symbol == self.name else f", symbol={self.symbol!r}"
        return f"@mine.quantity(units={self.units!r}, description={self.meaning!r}{symbol})\n{self.written}"

    @property
    def formula(self) -> Formula:
        """Its text as a formula."""
        return formula_of(self.name, self.fact)


#: What a user declares, each after what it depends on.
Definition = tuple[OwnInput | OwnQuantity, ...]


@lru_cache(maxsize=1024)
def formula_of(name: str, text: str) -> Formula:
    """Return the formula of a text, once."""
    head, *lines = text.removesuffix("\n").split("\n")
    parameters = head.partition("(")[2].removesuffix("):").split(", ")
    return Formula(name, parameters, [line.strip() for line in lines], HELPERS)


def check_dimension(quantity: OwnQuantity, units: Iterable[str]) -> None:
    """Refuse a text that does not give the units of its quantity, for parameters of some units."""
    declare = "constants have no units: declare mine.input(NAME, units=..., default=...), and write NAME"
    try:
        value = quantity.formula(*(Powers(tuple(map(float, dimensions(unit)))) for unit in units))
        found = value.powers if isinstance(value, Powers) else (0.0, 0.0, 0.0)
    except UnlikePowers as error:
        own = quantity.formula.file
        numbers = [
            frame.lineno for frame in traceback.extract_tb(error.__traceback__) if frame.filename == own
        ]
        line = quantity.lines[(numbers[-1] or 2) - 2] if numbers else quantity.line
        what = f"line {line} of {quantity.file} {error}"
        raise InputError(what, where=(quantity.name,), remedy=declare) from None
    expected = tuple(map(float, dimensions(quantity.units)))
    if found != expected:
        gives = "a number without units" if not any(found) else units_text(found)
        what = f"is declared in {quantity.units!r}, and its text gives {gives}"
        if any(found) and not any(expected):
            remedy = (
                f'divide by an input of that unit: mine.input(NAME, units="{units_text(found)}", default=...)'
            )
        else:
            remedy = f"declare units={'1' if not any(found) else units_text(found)!r}, or mend the text"
        raise InputError(what, where=(quantity.name,), remedy=remedy)


def declared_names(text: str) -> list[str]:
    """Return the names that a text of `definition_text` declares."""
    return ["".join(found) for found in re.findall(r"^def (\w+)|^mine\.input\('(\w+)'", text, re.M)]


def definition_text(mechanism: str, definition: Definition) -> str:
    """Return declarations as a text of Python that makes them again."""
    imports = {line for one in definition if isinstance(one, OwnQuantity) for line in one.imports}
    head = "\n".join([*sorted(imports), "import fastlink as fl", "", f"mine = fl.extend({mechanism!r})"])
    parts = [f"\n{one.text}" if isinstance(one, OwnQuantity) else one.text for one in definition]
    return "\n".join([head, *parts]) + "\n"


# -- The catalogue of a mechanism with a user's declarations beside its own, which stay as they are


@lru_cache(maxsize=64)
def extended(
    base: Catalogue, version: int, definition: Definition, first: Catalogue | None = None
) -> Catalogue:
    """Return a catalogue with these declarations, the same one for the same declarations."""
    own = base.copied()
    own.definition = definition
    if first is not None:
        own.first = first  # type: ignore[attr-defined]
    for one in definition:
        try:
            if isinstance(one, OwnInput):
                _check_free(own, one.name, "input")
                own.declare_input(Input(one.name, one.units, one.symbol, one.meaning, one.rule, one.default))
            elif first is None or all(map(own.declares, map(_plain(own), one.parameters))):
                _declare(own, one)
        except CatalogueError as error:
            what, _, _remedy = str(error).removeprefix(f"{own.name}: ").partition("; ")
            raise InputError(what, where=(one.name,), remedy="call it otherwise") from None
    return own


def _plain(catalogue: Catalogue) -> Any:
    """Return a function that returns the quantity whose derivative a name is, else the name."""

    def plain(name: str) -> str:
        tree = catalogue.parse(name)
        return plain(str(tree.of)) if isinstance(tree, Derivative) else name

    return plain


def own_names(catalogue: Catalogue, names: Iterable[str]) -> set[str]:
    """Return those of these names that a user has declared as quantities."""
    return {name for name in names if name in catalogue.facts and catalogue.facts[name].own}


def used(catalogue: Catalogue, steps: Iterable[Fact | System], inputs: Iterable[str] = ()) -> Definition:
    """Return what a user has declared of that which some steps and inputs depend on."""
    if not catalogue.definition:
        return ()
    names = {root_of(catalogue.parse(step.name)) for step in steps if isinstance(step, Fact) and step.own}
    names.update(inputs)
    for one in reversed(catalogue.definition):
        if isinstance(one, OwnQuantity) and one.name in names:
            names.update(root_of(catalogue.parse(parameter)) for parameter in one.parameters)
            names.update(one.parameters)
    return tuple(one for one in catalogue.definition if one.name in names)


def _check_free(catalogue: Catalogue, name: str, noun: str) -> None:
    """Refuse a name that stands for something else."""
    if catalogue.is_public(name):
        kind = "is a quantity"
    elif name in catalogue.variables:
        kind = "is an input"
    elif catalogue.declares(name):
        kind = "is a step within the facts"
    else:
        return
    of = "" if catalogue.is_public(name) and catalogue.facts[name].own else f" of {catalogue.name}"
    raise InputError(f"{kind}{of} already", where=(name,), remedy=f"call the {noun} otherwise")


def _declare(catalogue: Catalogue, one: OwnQuantity) -> None:
    _check_free(catalogue, one.name, "quantity")
    units = [_units_of(catalogue, one, parameter) for parameter in one.parameters]
    check_dimension(one, units)
    labels: dict[str, Any] = {"units": one.units, "symbol": one.symbol, "meaning": one.meaning}
    labels |= {"source": f"declared in {one.file}", "own": True}
    catalogue.declare(Fact(one.name, one.formula, one.parameters, **labels))
    graded = catalogue.graded
    if graded is None:
        return
    jumps = one.jumps or own_names(catalogue, one.parameters) & set(graded.not_differentiable)
    if jumps or not _declare_kinks(catalogue, one, labels):
        names = (*graded.not_differentiable, one.name)
        catalogue.graded = replace(graded, not_differentiable=names)


def _declare_kinks(catalogue: Catalogue, one: OwnQuantity, labels: dict[str, Any]) -> bool:
    """Declare what vanishes at kinks and the smooth quantities between them; return False of too many kinks."""
    graded = catalogue.graded
    assert graded is not None
    known = {name: pieces for name, (_, pieces) in graded.kinks.items()}
    found = split(one.fact, one.parameters, known)
    if found is None:
        return True
    inner = tuple(switch for name in one.parameters if name in known for switch in graded.kinks[name][0])
    if found.too_many or len(inner) + len(found.switches) + len(found.pieces) > MOST_KINKS:
        return False
    kinks = *inner, *_steps_of(catalogue, one.name, "kink", found.switches, labels)
    pieces = _steps_of(catalogue, one.name, "piece", found.pieces, labels)
    catalogue.graded = replace(graded, kinks={**graded.kinks, one.name: (kinks, pieces)})
    return True


def _steps_of(
    catalogue: Catalogue, name: str, noun: str, texts: Iterable[str], labels: dict[str, Any]
) -> tuple[str, ...]:
    """Declare texts as steps within the facts, and return their names; one that is a parameter is that."""
    names = []
    for k, text in enumerate(texts):
        if (own := only_name(text)) and catalogue.is_quantity(own):
            names.append(own)
            continue
        names.append(step := f"{name}_{noun}{k}")
        formula = formula_of(step, text)
        catalogue.declare(Fact(step, formula, formula.parameters, **labels, internal=True))
    return tuple(names)


def _units_of(catalogue: Catalogue, one: OwnQuantity, name: str) -> str:
    """Return the units of a parameter, or refuse what a quantity cannot depend on."""
    if name in catalogue.variables:
        return catalogue.variables[name].units
    if name == "branch":
        return "1"
    tree = catalogue.parse(name)
    of = bounded_of(tree)
    if isinstance(of, (Reduced, ListOfExtrema)) and catalogue.is_quantity(str(of.of)):
        what = f"the parameter {name} is of the whole cycle, and a quantity is of one input position"
        asked = ", ".join(str(Reduced(Quantity(one.name), how)) for how in ("max", "mean"))
        remedy = f"take {of.of}, and ask for the extremes of {one.name}: {asked}"
        raise InputError(what, where=(one.name,), remedy=remedy)
    if isinstance(tree, (ErrorBound, Trust)) and catalogue.is_quantity(str(tree.of)):
        what = f"the parameter {name} is an error bound"
        raise InputError(
            what, where=(one.name,), remedy=f"take {tree.of}; {error_name(one.name)} follows by itself"
        )
    if name == one.name:
        what = "depends on itself"
        raise InputError(what, where=(one.name,), remedy="take parameters that are declared before")
    if not catalogue.is_quantity(name):
        internal = catalogue.declares(name)
        what = f"the parameter {name} is {'a step within the facts' if internal else 'unknown'}"
        known = [*catalogue.public, *catalogue.variables]
        raise InputError(what, where=(one.name,), remedy=suggest(name, known))
    fact = catalogue.public_fact(name)
    _check_derivative(catalogue, one, name)
    return fact.units


def _check_derivative(catalogue: Catalogue, one: OwnQuantity, name: str) -> None:
    try:
        catalogue.resolve(name)
    except NoDerivative as error:
        raise InputError(
            f"the parameter {error.what}", where=(one.name,), remedy="take another one"
        ) from None
