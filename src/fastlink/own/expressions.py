"""Rewrite the numbers and conditions of a user's function in the grammar of facts."""

from __future__ import annotations

import ast
import builtins
import math
import re
from collections.abc import Callable, Sequence
from types import ModuleType

from fastlink.errors import Problems, suggest
from fastlink.own.functions import (
    CONSTANTS,
    MODULES,
    OwnFunction,
    constant_of,
    function_named,
    names_of_functions,
)
from fastlink.own.source import FunctionText
from fastlink.symbolic.expression import DEEPEST

__all__ = ["CONDITION", "NUMBER", "Expressions", "Refused", "local_name", "quoted"]

#: The greatest power that is written as products.
MOST_POWER = 16
#: The most conditions that are joined in one line.
MOST_JOINED = 32
NUMBER, CONDITION = "number", "condition"
SIGNS = (ast.Add, ast.Sub, ast.Mult, ast.Div)
COMPARISONS = (ast.Lt, ast.LtE, ast.Gt, ast.GtE, ast.Eq, ast.NotEq)
A_LOOP = "is a loop", "write each term"
#: What is no number.
EXPRESSIONS: dict[type[ast.AST], tuple[str, str]] = {
    ast.Lambda: ("is a lambda", "write its formula here"),
    ast.ListComp: A_LOOP,
    ast.GeneratorExp: A_LOOP,
    ast.SetComp: A_LOOP,
    ast.DictComp: A_LOOP,
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


class Refused(Exception):
    """Something that no fact has; it is noted."""


class Expressions:
    """The numbers and conditions of a function while they are rewritten.

    Attributes
    ----------
    kinds : dict
        What each parameter and local name is: a number, or a condition.
    written : list of (str, int)
        The lines so far, and the lines of the function that they are of.
    """

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
