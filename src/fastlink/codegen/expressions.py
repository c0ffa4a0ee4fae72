"""Expressions of kernel text as LLVM: numbers, choices, entries of arrays, calls."""

from __future__ import annotations

import ast
from abc import ABC, abstractmethod
from collections.abc import Callable
from types import ModuleType
from typing import TYPE_CHECKING, Any, NoReturn, TypeVar

import numpy as np

from fastlink.codegen.ir import Array, Builder, Lane, Slot, Value, constant, type_of

if TYPE_CHECKING:
    from fastlink.codegen.module import Module

__all__ = ["Expressions", "Name", "Refused", "Unknown", "as_load"]

FLOATING = {ast.Add: "add", ast.Sub: "sub", ast.Mult: "mul", ast.Div: "div"}
INTEGER = {
    ast.Add: "add",
    ast.Sub: "sub",
    ast.Mult: "mul",
    ast.LShift: "shl",
    ast.RShift: "ashr",
    ast.BitAnd: "and",
    ast.BitOr: "or",
    ast.BitXor: "xor",
}
COMPARISONS = {ast.Lt: "lt", ast.LtE: "le", ast.Gt: "gt", ast.GtE: "ge", ast.Eq: "eq", ast.NotEq: "ne"}
#: Functions of Python that need no import.
PYTHON_NAMES = {"abs": abs, "min": min, "max": max, "int": int, "float": float}
#: The value of a name: a number, several, an array, a place in memory, the counter of lanes.
Name = Value | Array | Slot | Lane | tuple[Any, ...]
T = TypeVar("T")


class Refused(Exception):
    """A text that is not of the grammar: where, and what is wrong with it."""


class Unknown(Exception):
    """A name that nothing binds."""


def as_load(target: ast.expr) -> ast.expr:
    """Return the expression that reads what an assignment writes."""
    if isinstance(target, ast.Name):
        return ast.Name(target.id, ast.Load())
    assert isinstance(target, ast.Subscript)
    return ast.Subscript(target.value, target.slice, ast.Load())


class Expressions(Builder, ABC):
    """The expressions of one function, and what its names stand for.

    Attributes
    ----------
    node : ast.FunctionDef
        The text at hand: the function's, or that of one that is pasted.
    scope : dict
        The names of the module of that text.
    names : dict
        What names stand for in it.
    straight : bool
        Whether values are bound as they are: where no control flow meets, they need no memory.
    width : int
        Lanes at hand: 1 outside the loops over lanes.
    """

    def __init__(self, module: Module, node: ast.FunctionDef, scope: dict[str, Any]) -> None:
        super().__init__(module)
        self.node, self.scope, self.flags = node, scope, module.flags
        self.names: dict[str, Name] = {}
        self.straight = False
        self.width = 1
        #: Where the instructions before the loop over lanes end, and what names stood for there.
        self.before = 0
        self.outside: dict[str, Name] = {}
        #: Numbers from outside that stand in all lanes already.
        self.everywhere: dict[str, Value] = {}

    @abstractmethod
    def subscript(self, node: ast.Subscript) -> Any:
        """Return a part of a tuple, an entry of an array, or the rows there."""

    @abstractmethod
    def call(self, node: ast.Call) -> Any:
        """Translate a call."""

    def refuse(self, node: ast.AST, why: str) -> NoReturn:
        """Refuse a part of the text."""
        where = f"{self.node.name}, line {getattr(node, 'lineno', '?')}"
        raise Refused(f"{where}: {ast.unparse(node)}: {why}")

    # -- expressions -------------------------------------------------------------------------------

    def number(self, node: ast.expr) -> Value:
        """Translate an expression that is a number."""
        value = self.value(node)
        if not isinstance(value, Value):
            self.refuse(node, "a number is wanted")
        return value

    def value(self, node: ast.expr) -> Any:
        """Translate an expression."""
        match node:
            case ast.Constant(value=bool() | int() | float() as known):
                return constant(known)
            case ast.Name():
                return self.named(node)
            case ast.Tuple():
                return tuple(self.value(part) for part in node.elts)
            case ast.BinOp():
                return self.binary(node, node.op, self.number(node.left), self.number(node.right))
            case ast.UnaryOp():
                return self.unary(node)
            case ast.Compare(ops=[sign], comparators=[other]) if type(sign) in COMPARISONS:
                return self.compare(COMPARISONS[type(sign)], self.number(node.left), self.number(other))
            case ast.BoolOp():
                return self.shortcut(node)
            case ast.IfExp():
                return self.choice(node)
            case ast.Subscript():
                return self.subscript(node)
            case ast.Attribute():
                return self.attribute(node)
            case ast.Call():
                return self.call(node)
        self.refuse(node, "no such expression here")

    def named(self, node: ast.Name) -> Any:
        """Return what a name stands for; in lanes, a number from outside stands in all of them."""
        if node.id in self.everywhere:
            return self.everywhere[node.id]
        try:
            value = self.lookup(node.id)
        except Unknown:
            self.refuse(node, "nothing has that name here")
        if isinstance(value, Lane):
            self.refuse(node, "the counter of lanes stands as last index only")
        if isinstance(value, Slot) and self.width > 1 and value.kind == "f":
            value = self.before_lanes(lambda slot: self.spread(self.read(slot), self.width), value)
            self.everywhere[node.id] = value
        if isinstance(value, Slot):
            value = self.read(value)
        if isinstance(value, (bool, int, float, np.number)):
            number = value.item() if isinstance(value, np.number) else value
            return constant(number, "u" if isinstance(value, np.unsignedinteger) else None)
        if self.width > 1 and isinstance(value, Value) and value.lanes == 1 and value.kind == "f":
            value = self.everywhere[node.id] = self.spread(value, self.width)
        return value

    def before_lanes(self, make: Callable[..., T], *args: Any) -> T:
        """Return what is made once, before the loop over lanes."""
        inside, self.lines = self.lines, []
        value = make(*args)
        inside[self.before : self.before] = self.lines
        self.before += len(self.lines)
        self.lines = inside
        return value

    def lookup(self, name: str) -> Any:
        """Return what a name is bound to: here, in the module of the text, in Python."""
        for names in (self.names, self.scope, PYTHON_NAMES):
            if name in names:
                return names[name]
        raise Unknown(name)

    def unary(self, node: ast.UnaryOp) -> Value:
        """Negate a number or a truth."""
        value = self.number(node.operand)
        if isinstance(node.op, ast.Not) and value.lanes == 1:
            return self.let(f"xor i1 {self.to_kind(value, 'b').at}, true", "b")
        if not isinstance(node.op, ast.USub) or value.kind in "bc":
            self.refuse(node, "numbers are negated by -, truths by not")
        if value.known is not None:
            return self.spread(constant(-value.known, value.kind), value.lanes)
        if value.kind == "f":
            return self.let(f"fneg {type_of('f', value.lanes)} {value.at}", "f", value.lanes)
        return self.integer("sub", constant(0), value)

    def binary(self, node: ast.AST, sign: ast.operator, a: Value, b: Value) -> Value:
        """Return an operation of two numbers."""
        operation = type(sign)
        if operation is ast.Div or (operation in FLOATING and "f" in (a.kind, b.kind)):
            return self.floating(FLOATING[operation], a, b)
        if operation is ast.Pow and a.known is not None and b.known is not None:
            return constant(a.known**b.known)
        if operation not in INTEGER or "f" in (a.kind, b.kind):
            self.refuse(node, "no such operation of these numbers")
        if a.kind == b.kind == "b":
            if operation in (ast.BitAnd, ast.BitOr, ast.BitXor):
                return self.integer(INTEGER[operation], a, b)
            a, b = self.to_kind(a, "i"), self.to_kind(b, "i")
        return self.integer(INTEGER[operation], a, b)

    def shortcut(self, node: ast.BoolOp) -> Value:
        """Return the truth of ``and`` or ``or``: what need not be evaluated is not."""
        if self.width > 1:
            self.refuse(node, "lanes have & and |")
        first, *rest = node.values
        result = self.slot(self.to_kind(self.number(first), "b"))
        for more in rest:
            go, done = self.label(), self.label()
            ways = (go, done) if isinstance(node.op, ast.And) else (done, go)
            self.branch(self.read(result), *ways)
            self.start(go)
            self.write(result, self.number(more))
            self.jump(done)
            self.start(done)
        return self.read(result)

    def choice(self, node: ast.IfExp) -> Any:
        """Return one of two values; outside lanes, an arm that reads memory is evaluated only if it is chosen."""
        condition = self.number(node.test)
        arms = (node.body, node.orelse)
        reads = any(isinstance(part, (ast.Subscript, ast.Call)) for arm in arms for part in ast.walk(arm))
        if self.width > 1 or not reads:
            return self.chosen(node, condition, self.value(node.body), self.value(node.orelse))
        yes, no, done = self.label(), self.label(), self.label()
        self.branch(condition, yes, no)
        self.start(yes)
        first = self.number(node.body)
        result = self.slot(first)
        self.jump(done)
        self.start(no)
        other = self.number(node.orelse)
        if other.kind != first.kind and other.known is None:
            self.refuse(node, "both values are of one kind")
        self.write(result, other)
        self.jump(done)
        self.start(done)
        return self.read(result)

    def chosen(self, node: ast.expr, condition: Value, a: Any, b: Any) -> Any:
        """Return one of two numbers, or of two tuples of such."""
        if isinstance(a, tuple) and isinstance(b, tuple):
            return tuple(self.chosen(node, condition, x, y) for x, y in zip(a, b, strict=True))
        if not isinstance(a, Value) or not isinstance(b, Value):
            self.refuse(node, "numbers are chosen")
        return self.select(condition, a, b)

    def attribute(self, node: ast.Attribute) -> Any:
        """Return what a module holds, or the shape or size of an array."""
        if isinstance(node.value, ast.Name):
            module = self.scope.get(node.value.id)
            if isinstance(module, ModuleType) and hasattr(module, node.attr):
                value = getattr(module, node.attr)
                return constant(value) if isinstance(value, float) else value
        of = self.value(node.value)
        if isinstance(of, Array) and node.attr == "shape":
            return of.shape
        if isinstance(of, Array) and node.attr == "size" and len(of.shape) == 1:
            return of.shape[0]
        self.refuse(node, "arrays have shape, those of one axis size")
