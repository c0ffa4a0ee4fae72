"""Write facts as JavaScript, so that a page moves a mechanism by the same formulas.

Doubles of JavaScript are those of IEEE 754, and each operation of a fact is one operation there: only functions that
JavaScript has itself, such as the sine, may differ in their last bits.
"""

from __future__ import annotations

import ast
import json
import math
from collections.abc import Callable, Iterable
from types import ModuleType
from typing import Any

import numpy as np

from fastlink.catalogue.catalogue import Catalogue, Fact, System
from fastlink.numerics import elementary, logarithm
from fastlink.numerics.compiler import COMPILED_AS, INLINED, syntax

__all__ = ["Untranslatable", "script_of"]

#: Functions that JavaScript has.
OWN: dict[Any, str] = {
    elementary.sqrt: "Math.sqrt",
    elementary.atan2: "Math.atan2",
    elementary.cosine: "Math.cos",
    elementary.sine: "Math.sin",
    elementary.sin: "Math.sin",
    elementary.cos: "Math.cos",
    elementary.exp: "Math.exp",
    elementary.sinh: "Math.sinh",
    elementary.cosh: "Math.cosh",
    elementary.ldexp: "ldexp",
    elementary.binary_exponent: "binaryExponent",
    logarithm.log: "Math.log",
    logarithm.log1p: "Math.log1p",
    logarithm.log_quotient: "logQuotient",
    logarithm.quotient_sign: "quotientSign",
    np.sqrt: "Math.sqrt",
    np.copysign: "copysign",
    abs: "Math.abs",
}
PRELUDE = """\
const copysign = (x, y) => Math.abs(x) * (y < 0 || Object.is(y, -0) ? -1 : 1);
const ldexp = (x, times) => x * 2 ** times;
const binaryExponent = x => Math.round(x / Math.LN2);
const logQuotient = (x, y, twos) => x && y ? Math.log(Math.abs(x / y)) + twos * Math.LN2 : NaN;
const quotientSign = (x, y) => Math.sign(x) * Math.sign(y) || 0;
"""
SIGNS = {
    ast.Add: "+",
    ast.Sub: "-",
    ast.Mult: "*",
    ast.Div: "/",
    ast.Pow: "**",
    ast.BitAnd: "&",
    ast.BitOr: "|",
    ast.Lt: "<",
    ast.LtE: "<=",
    ast.Gt: ">",
    ast.GtE: ">=",
    ast.Eq: "==",
    ast.NotEq: "!=",
}


class Untranslatable(Exception):
    """A text that has no counterpart in JavaScript."""


class _Script:
    """Functions in JavaScript, each after those that it calls."""

    def __init__(self) -> None:
        self.names: dict[Any, str] = {}
        self.texts: list[str] = []

    def add(self, function: Callable[..., Any]) -> str:
        """Return the name of a function in the script, to which it is added if it is not there."""
        if function not in self.names:
            text = _Text(self, function).text()
            name = self.names[function] = f"f{len(self.names)}"
            self.texts.append(f"const {name} = {text};")
        return self.names[function]


class _Text:
    """One function as JavaScript."""

    def __init__(self, script: _Script, function: Callable[..., Any]) -> None:
        self.script, self.tree = script, syntax(function)
        self.scope = dict(function.__globals__)
        self.scope |= zip(
            function.__code__.co_freevars, [c.cell_contents for c in function.__closure__ or ()], strict=True
        )
        self.parameters = [one.arg for one in self.tree.args.args]
        self.local = {
            node.id
            for node in ast.walk(self.tree)
            if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)
        }

    def text(self) -> str:
        """Return the whole function."""
        lines = [self.statement(one) for one in self.tree.body if not _is_docstring(one)]
        own = sorted(self.local - set(self.parameters))
        declared = f"let {', '.join(map(_own, own))}; " if own else ""
        return f"({', '.join(map(_own, self.parameters))}) => {{ {declared}{' '.join(lines)} }}"

    def statement(self, node: ast.stmt) -> str:
        """Return an assignment or a return."""
        if isinstance(node, ast.Return) and node.value is not None:
            return f"return {self.value(node.value)};"
        if isinstance(node, ast.Assign) and len(node.targets) == 1:
            return f"{self.target(node.targets[0])} = {self.value(node.value)};"
        raise Untranslatable(ast.unparse(node))

    def target(self, node: ast.expr) -> str:
        """Return what is assigned to."""
        if isinstance(node, ast.Tuple):
            return f"[{', '.join(map(self.target, node.elts))}]"
        if isinstance(node, ast.Name):
            return _own(node.id)
        raise Untranslatable(ast.unparse(node))

    def value(self, node: ast.expr) -> str:
        """Return an expression."""
        match node:
            case ast.Constant(value=bool() | int() | float() as number):
                return _number(number)
            case ast.Name():
                return self.named(node)
            case ast.Tuple():
                return f"[{', '.join(map(self.value, node.elts))}]"
            case ast.BinOp() if type(node.op) in SIGNS:
                return f"({self.value(node.left)} {SIGNS[type(node.op)]} {self.value(node.right)})"
            case ast.UnaryOp(op=ast.USub()):
                return f"(-{self.value(node.operand)})"
            case ast.Compare(ops=[sign], comparators=[other]) if type(sign) in SIGNS:
                return f"({self.value(node.left)} {SIGNS[type(sign)]} {self.value(other)})"
            case ast.Subscript(slice=ast.Constant(value=int() as place)):
                return f"{self.value(node.value)}[{place}]"
            case ast.Attribute():
                return _number(self.known(node))
            case ast.Call(keywords=[]):
                return self.call(node)
        raise Untranslatable(ast.unparse(node))

    def named(self, node: ast.Name) -> str:
        """Return a local name, or the number that a name of the module stands for."""
        if node.id in self.local or node.id in self.parameters:
            return _own(node.id)
        return _number(self.known(node))

    def known(self, node: ast.expr) -> Any:
        """Return what a name of the module, or of a module in it, stands for."""
        if isinstance(node, ast.Attribute):
            of = self.known(node.value)
            if isinstance(of, ModuleType) and hasattr(of, node.attr):
                return getattr(of, node.attr)
        if isinstance(node, ast.Name):
            if node.id in self.scope:
                return self.scope[node.id]
            if node.id == "abs":
                return abs
        raise Untranslatable(ast.unparse(node))

    def call(self, node: ast.Call) -> str:
        """Return a call: of a choice, of a function of JavaScript, of one of the script."""
        function, args = self.known(node.func), [self.value(arg) for arg in node.args]
        if function is elementary.select:
            condition, yes, no = args
            return f"({condition} ? {yes} : {no})"
        if function in OWN:
            return f"{OWN[function]}({', '.join(args)})"
        function = COMPILED_AS.get(function, function)
        if function in INLINED:
            return f"{self.script.add(function)}({', '.join(args)})"
        raise Untranslatable(ast.unparse(node))


def _own(name: str) -> str:
    """Return a name that is none of JavaScript's words."""
    return f"{name}_"


def _number(value: Any) -> str:
    """Return a number as JavaScript."""
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if not isinstance(value, (int, float, np.number)):
        raise Untranslatable(repr(value))
    number = float(value)
    if math.isfinite(number):
        return repr(number).removesuffix(".0") if number >= 0 else f"({number!r})"
    return "NaN" if math.isnan(number) else "Infinity" if number > 0 else "(-Infinity)"


def _is_docstring(node: ast.stmt) -> bool:
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)


def script_of(
    catalogue: Catalogue, names: Iterable[str], given: Iterable[str], variants: Iterable[str]
) -> tuple[str, tuple[str, ...]]:
    """Return facts as an object of JavaScript, and those of the names that it has.

    The object holds for each value that is computed ``[function, needs, names]``: the function, the names of its
    arguments, and the names of its results. A fact without a counterpart in JavaScript is left out.

    Parameters
    ----------
    catalogue : Catalogue
        The mechanism, as driven by the input.
    names : iterable of str
        The facts.
    given : iterable of str
        The inputs that a design gives.
    variants : iterable of str
        The selected variants.

    Examples
    --------
    >>> from fastlink.mechanisms import catalogue
    >>> text, found = script_of(catalogue("planar_4r"), ["A_x"], ["a1"], ())
    >>> found
    ('A_x',)
    """
    script, lines, found = _Script(), dict[str, str](), list[str]()
    position, low_parts = catalogue.position.name, catalogue.table_low_parts
    tables = {*catalogue.tables, *low_parts}
    selected, known = tuple(variants), {*given, "branch", position, *tables}
    for name in dict.fromkeys(names):
        steps = [one for one in catalogue.dependencies([name], known, selected) if one.names[0] not in lines]
        mark = len(script.texts), dict(script.names)
        try:
            added = {own: _entry(script, one) for one in steps for own in one.names}
        except Untranslatable:
            del script.texts[mark[0] :]
            script.names = mark[1]
            continue
        lines |= added
        found.append(name)
    for name in sorted(tables):
        of = low_parts.get(name, name)
        function = "() => 0" if name in low_parts else script.add(catalogue.tables[of].function)
        lines[name] = (
            f"[{function}, {json.dumps([] if name in low_parts else [position])}, {json.dumps([name])}]"
        )
    functions = "\n".join(script.texts)
    entries = ",\n".join(f"{json.dumps(name)}: {line}" for name, line in lines.items())
    return f"(() => {{\n{PRELUDE}{functions}\nreturn {{\n{entries}\n}};\n}})()", tuple(found)


def _entry(script: _Script, step: Fact | System) -> str:
    """Return a step as an entry of the object."""
    if isinstance(step, System):
        raise Untranslatable(step.name)
    return f"[{script.add(step.function)}, {json.dumps(step.depends_on)}, {json.dumps(step.names)}]"
