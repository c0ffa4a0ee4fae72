"""Kernel text to LLVM: one walk over its syntax tree.

The grammar: functions of numbers and arrays; assignments, also to entries of arrays; ``if``, ``while``, ``break``,
``continue``, ``return``; ``for`` over ``range``, ``lanes`` or ``entries``. The body of a loop over `lanes` or `entries`
is assignments alone, each lane on its own, and the counter stands as the last index of arrays only; its values are
vectors, and nothing is left to a vectoriser. Calls are of functions marked in `fastlink.numerics.compiler`, which are
of the same grammar, and of those in `BUILT_IN`. All else is refused with its line.

Python's own meaning of the text is kept: run as it is, it gives the same bits. Division of integers (``//``, ``%``) and
negative indices mean other things in machine code, so they are refused, or never written.
"""

from __future__ import annotations

import ast
import struct
from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass
from types import ModuleType
from typing import Any, NoReturn, TypeVar

import numpy as np

from fastlink.numerics import elementary
from fastlink.numerics.compiler import COMPILED_AS, INLINED, MERGED, OUTLINED, parsed, syntax

# -- Values and instructions of LLVM, as text: what a translated function is made of

# A value knows its kind when it is made, so nothing is inferred afterwards. A vector is a value of several
# lanes; what is needed in every lane is spread there when an operation wants it.


#: Kinds: f double, i and u integers of 64 bits with and without a sign, c integer of 8 bits, b truth.
LLVM = {"f": "double", "i": "i64", "u": "i64", "c": "i8", "b": "i1"}
BYTES = {"f": 8, "i": 8, "u": 8, "c": 1}
#: Of two kinds, the later one holds the result.
ORDER = "bciuf"
MADE = {"f": float, "i": int, "u": int, "b": bool, "c": int}
CONVERSIONS = {
    ("i", "f"): "sitofp",
    ("u", "f"): "uitofp",
    ("b", "f"): "uitofp",
    ("c", "f"): "sitofp",
    ("f", "i"): "fptosi",
    ("f", "u"): "fptoui",
    ("f", "c"): "fptosi",
    ("b", "i"): "zext",
    ("b", "u"): "zext",
    ("b", "c"): "zext",
    ("c", "i"): "sext",
    ("c", "u"): "sext",
    ("i", "c"): "trunc",
    ("u", "c"): "trunc",
}


# not frozen: making one takes three times as long then, a tenth of the time of translating
@dataclass(slots=True)
class Value:
    """A number: a register or a constant, its kind, in how many lanes, and what it is where that is known."""

    at: str
    kind: str
    lanes: int = 1
    known: float | None = None


@dataclass(frozen=True, slots=True)
class Array:
    """Rows in memory, the last index fastest: pointer, kind of the entries, lengths."""

    at: str
    kind: str
    shape: tuple[Value, ...]


@dataclass(frozen=True, slots=True)
class Slot:
    """A number that changes, in memory; LLVM makes registers of such."""

    at: str
    kind: str


@dataclass(frozen=True, slots=True)
class Lane:
    """The counter of a loop over lanes: the first of the lanes at hand."""

    first: Value


def constant(value: float, kind: str | None = None) -> Value:
    """Return a known number; its kind is that of the Python number unless given."""
    if kind is None:
        kind = "b" if isinstance(value, bool) else "f" if isinstance(value, float) else "i"
    number = MADE[kind](value)
    if kind != "f":
        return Value(str(number).lower(), kind, 1, number)
    (bits,) = struct.unpack("<Q", struct.pack("<d", number))
    return Value(f"0x{bits:016X}", kind, 1, number)


def type_of(kind: str, lanes: int = 1) -> str:
    """Return LLVM's type."""
    return LLVM[kind] if lanes == 1 else f"<{lanes} x {LLVM[kind]}>"


# -- One LLVM module under construction: functions, constants, declarations


#: Of functions, of those that are merged into others, and of those whose vectors go to the stack: else LLVM leaves
#: them across cache lines there in every other process, in which reactions took up to 1.25 times as long.
ATTRIBUTES = """attributes #0 = { nounwind "denormal-fp-math"="ieee,ieee" }
attributes #1 = { nounwind alwaysinline "denormal-fp-math"="ieee,ieee" }
attributes #2 = { nounwind "stackrealign" "denormal-fp-math"="ieee,ieee" }"""


class Module:
    """The functions of one kernel under construction."""

    def __init__(self, lanes: int, scope: dict[str, Any], flags: str = "") -> None:
        self.flags = flags
        self.lanes = lanes
        #: The names of the text, its functions among them, wherever these are called.
        self.scope = scope
        self.text: list[str] = []
        self.constants: list[str] = []
        #: The functions of LLVM that are called, each once.
        self.declarations: dict[str, None] = {}
        #: Of each function that was translated, by text and kinds of arguments, its name and the kind of its result.
        self.functions: dict[Hashable, tuple[str, str | None]] = {}

    def __str__(self) -> str:
        return "\n".join([*self.constants, *self.declarations, *self.text, ATTRIBUTES])

    def constant_array(self, values: Sequence[Value]) -> Array:
        """Return a read-only array of known numbers."""
        kind = "f" if any(value.kind == "f" for value in values) else "i"
        at = f"@c{len(self.constants)}"
        numbers = [constant(value.known or 0, kind).at for value in values]
        entries = ", ".join(f"{LLVM[kind]} {number}" for number in numbers)
        self.constants.append(
            f"{at} = private unnamed_addr constant [{len(values)} x {LLVM[kind]}] [{entries}], align 64"
        )
        return Array(at, kind, (constant(len(values)),))


# -- One function of kernel text as LLVM


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
#: The value of a name: a number, several, an array, a place in memory, the counter of lanes, a function.
Name = Value | Array | Slot | Lane | tuple[Any, ...] | ast.FunctionDef | Callable[..., Any]
T = TypeVar("T")


class Refused(Exception):
    """A text that is not of the grammar: where, and what is wrong with it."""


#: Where expressions lie in one another, in those that there are most of.
WITHIN: dict[type[ast.AST], tuple[str, ...]] = {
    ast.Name: (),
    ast.Constant: (),
    ast.BinOp: ("left", "right"),
    ast.UnaryOp: ("operand",),
    ast.Subscript: ("value", "slice"),
    ast.Attribute: ("value",),
    ast.AugAssign: ("target", "value"),
}


def parts_of(node: ast.AST) -> list[ast.AST]:
    """Return a node and all expressions in it, as `ast.walk`, which takes three times as long."""
    found = [node]
    for part in found:
        names = WITHIN.get(type(part))
        if names is None:
            found += ast.iter_child_nodes(part)
        else:
            found += [getattr(part, name) for name in names]
    return found


#: Loops whose counter is many at once.
ABREAST = ("lanes", "entries")
#: AVX2 has so many for vectors; what has to wait beyond them goes to memory and back.
REGISTERS = 16


class _Function:
    """One function while it is translated: its instructions in order, and what its names stand for."""

    def __init__(
        self,
        module: Module,
        node: ast.FunctionDef,
        scope: dict[str, Any],
        args: Sequence[Name],
        symbol: str,
        noalias: bool,
    ) -> None:
        self.module, self.symbol = module, symbol
        self.lines: list[str] = []
        self.allocas: list[str] = []
        self._count = 0
        #: What is one of two numbers in each lane.
        self.selected: set[str] = set()
        #: The text at hand, the function's or that of one that is pasted, and the names of the module of that text.
        self.node, self.scope = node, scope
        #: Freedoms of arithmetic; none but in kernels that show what these would cost and gain.
        self.flags = module.flags
        #: What names stand for in the text.
        self.names: dict[str, Name] = {}
        #: Whether values are bound as they are: where no control flow meets, they need no memory.
        self.straight = False
        #: Lanes at hand: 1 outside the loops over lanes.
        self.width = 1
        #: Where the instructions before the loop over lanes end, and what names stood for there.
        self.before = 0
        self.outside: dict[str, Name] = {}
        #: Numbers from outside that stand in all lanes already.
        self.everywhere: dict[str, Value] = {}
        #: Whether values may go to the stack, whether arrays of different names do not overlap.
        self.spills = False
        self.apart = noalias
        self.result: str | None = None
        self.parameters: list[str] = []
        #: Where `continue` and `break` go.
        self.loops: list[tuple[str, str]] = []
        for parameter, arg in zip(node.args.args, args, strict=True):
            self.names[parameter.arg] = self._parameter(arg, noalias)

    def _parameter(self, arg: Name, noalias: bool) -> Name:
        def next_one(text: str) -> str:
            at = f"%p{len(self.parameters)}"
            self.parameters.append(f"{text} {at}")
            return at

        if isinstance(arg, Array):
            at = next_one("ptr noalias" if noalias else "ptr")
            shape = (d if d.known is not None else Value(next_one("i64"), "i") for d in arg.shape)
            return Array(at, arg.kind, tuple(shape))
        if isinstance(arg, Value):
            return self.slot(Value(next_one(LLVM[arg.kind]), arg.kind))
        return arg

    def finish(self, *, merged: bool) -> tuple[str, str | None]:
        """Translate the body, add the function to the module, return its name and the kind of its result."""
        self.block(self.node.body)
        if self.result is None:
            self.put("ret void")
        else:
            self.put("unreachable")
        result = LLVM[self.result] if self.result else "void"
        attributes = "#1" if merged else "#2" if self.spills else "#0"
        head = (
            f"define internal {result} @{self.symbol}({', '.join(self.parameters)}) {attributes} {{\nentry:"
        )
        self.module.text += [head, *self.allocas, *self.lines, "}"]
        return self.symbol, self.result

    # -- instructions ------------------------------------------------------------------------------

    def put(self, text: str) -> None:
        """Append an instruction without a result."""
        self.lines.append("  " + text)

    def let(self, text: str, kind: str, lanes: int = 1) -> Value:
        """Append an instruction and return its result."""
        self._count += 1
        self.lines.append(f"  %v{self._count} = {text}")
        return Value(f"%v{self._count}", kind, lanes)

    def label(self) -> str:
        """Return a new label."""
        self._count += 1
        return f"L{self._count}"

    def start(self, label: str) -> None:
        """Begin the block of a label."""
        self.lines.append(f"{label}:")

    def jump(self, label: str) -> None:
        """Go on at a label."""
        self.put(f"br label %{label}")

    def branch(self, condition: Value, yes: str, no: str) -> None:
        """Go on at one of two labels."""
        self.put(f"br i1 {self.to_kind(condition, 'b').at}, label %{yes}, label %{no}")

    def counted(
        self, start: Value, stop: Value, step: Value, body: Callable[[Value, str, str], None]
    ) -> None:
        """Append a loop; ``body(counter, next label, end label)`` appends what is in it."""
        slot = self.slot(start)
        head, inside, more, done = (self.label() for _ in range(4))
        self.jump(head)
        self.start(head)
        counter = self.read(slot)
        assert step.known
        self.branch(self.compare("lt" if step.known > 0 else "gt", counter, stop), inside, done)
        self.start(inside)
        body(counter, more, done)
        self.jump(more)
        self.start(more)
        self.write(slot, self.integer("add", counter, step))
        self.jump(head)
        self.start(done)

    # -- memory ------------------------------------------------------------------------------------

    def slot(self, value: Value) -> Slot:
        """Return a place in memory that holds a number."""
        self._count += 1
        at = f"%s{self._count}"
        self.allocas.append(f"  {at} = alloca {LLVM[value.kind]}")
        slot = Slot(at, value.kind)
        self.write(slot, value)
        return slot

    def write(self, slot: Slot, value: Value) -> None:
        """Store a number."""
        self.put(f"store {LLVM[slot.kind]} {self.to_kind(value, slot.kind).at}, ptr {slot.at}")

    def read(self, slot: Slot) -> Value:
        """Load a number."""
        return self.let(f"load {LLVM[slot.kind]}, ptr {slot.at}", slot.kind)

    def part(self, array: Array, indices: Sequence[Value]) -> Array:
        """Return the entry or the rows at some first indices, as an array of the other axes."""
        at = self.at(array, self.offset(array, indices))
        return Array(at, array.kind, array.shape[len(indices) :])

    def offset(self, array: Array, indices: Sequence[Value]) -> Value:
        """Return how many entries stand before those at some first indices."""
        offset = constant(0)
        for axis, length in enumerate(array.shape):
            offset = self.integer("mul", offset, length)
            if axis < len(indices):
                offset = self.integer("add", offset, indices[axis])
        return offset

    def at(self, array: Array, offset: Value) -> str:
        """Return where the entry stands that so many stand before."""
        return self.let(f"getelementptr inbounds {LLVM[array.kind]}, ptr {array.at}, i64 {offset.at}", "i").at

    def load(self, entry: Array, lanes: int) -> Value:
        """Load one entry, or as many as there are lanes."""
        kind = entry.kind
        return self.let(f"load {type_of(kind, lanes)}, ptr {entry.at}, align {BYTES[kind]}", kind, lanes)

    def store(self, entry: Array, value: Value, lanes: int) -> None:
        """Store one entry, or as many as there are lanes."""
        value = self.spread(self.to_kind(value, entry.kind), lanes)
        # or else LLVM stores under a mask where one of the two was loaded from the same place: up to 2.7 times as slow
        # in sampled extremes with AVX2, whose processors store so lane by lane
        kept = "volatile " if lanes > 1 and value.at in self.selected else ""
        vector = type_of(entry.kind, lanes)
        self.put(f"store {kept}{vector} {value.at}, ptr {entry.at}, align {BYTES[entry.kind]}")

    def gather(self, row: Array, index: Value) -> Value:
        """Load an entry for each lane, at the index that stands there.

        One by one: AVX-512's instruction takes as long; for AVX2, LLVM takes vectors of addresses apart again.
        """
        found = f"{type_of(row.kind, index.lanes)} poison"
        for k in range(index.lanes):
            lane = self.let(
                f"extractelement {type_of(index.kind, index.lanes)} {index.at}, i64 {k}", index.kind
            )
            one = self.load(self.part(row, [lane]), 1)
            value = self.let(
                f"insertelement {found}, {LLVM[one.kind]} {one.at}, i64 {k}", row.kind, index.lanes
            )
            found = f"{type_of(row.kind, index.lanes)} {value.at}"
        return value

    # -- kinds -------------------------------------------------------------------------------------

    def spread(self, value: Value, lanes: int) -> Value:
        """Return a number in all lanes."""
        if value.lanes == lanes:
            return value
        kind, vector = LLVM[value.kind], type_of(value.kind, lanes)
        if value.known is not None:
            return Value(f"splat ({kind} {value.at})", value.kind, lanes, value.known)
        one = self.let(f"insertelement {vector} poison, {kind} {value.at}, i64 0", value.kind, lanes)
        text = f"shufflevector {vector} {one.at}, {vector} poison, <{lanes} x i32> zeroinitializer"
        return self.let(text, value.kind, lanes)

    def to_kind(self, value: Value, kind: str) -> Value:
        """Return a number as one of another kind."""
        if value.kind == kind:
            return value
        if {value.kind, kind} == {"i", "u"}:
            return Value(value.at, kind, value.lanes, value.known)
        if value.known is not None:
            return self.spread(constant(value.known, kind), value.lanes)
        before, after = type_of(value.kind, value.lanes), type_of(kind, value.lanes)
        if kind == "b":
            zero = self.spread(constant(0, value.kind), value.lanes).at
            test = "fcmp une" if value.kind == "f" else "icmp ne"
            return self.let(f"{test} {before} {value.at}, {zero}", "b", value.lanes)
        operation = CONVERSIONS[value.kind, kind]
        return self.let(f"{operation} {before} {value.at} to {after}", kind, value.lanes)

    def meet(self, a: Value, b: Value) -> tuple[Value, Value]:
        """Return two numbers as numbers of one kind in as many lanes."""
        if a.kind == b.kind and a.lanes == b.lanes:
            return a, b
        lanes, kind = max(a.lanes, b.lanes), max(a.kind, b.kind, key=ORDER.index)
        return self.spread(self.to_kind(a, kind), lanes), self.spread(self.to_kind(b, kind), lanes)

    # -- operations --------------------------------------------------------------------------------

    def integer(self, operation: str, a: Value, b: Value) -> Value:
        """Return the sum, difference, product ... of two integers."""
        a, b = self.meet(a, b)
        if a.known is not None and b.known is not None and operation in ("add", "sub", "mul"):
            x, y = int(a.known), int(b.known)
            known = {"add": x + y, "sub": x - y, "mul": x * y}[operation]
            return self.spread(constant(known, a.kind), a.lanes)
        for one, other in ((a, b), (b, a)):  # fewer lines to parse
            if (operation, one.known) in (("add", 0), ("mul", 1)):
                return other
        return self.let(f"{operation} {type_of(a.kind, a.lanes)} {a.at}, {b.at}", a.kind, a.lanes)

    def floating(self, operation: str, a: Value, b: Value) -> Value:
        """Return the sum, difference, product or quotient of two doubles; nothing is folded here."""
        a, b = self.meet(self.to_kind(a, "f"), self.to_kind(b, "f"))
        return self.let(f"f{operation}{self.flags} {type_of('f', a.lanes)} {a.at}, {b.at}", "f", a.lanes)

    def compare(self, sign: str, a: Value, b: Value) -> Value:
        """Return the truth of a comparison: lt, le, gt, ge, eq, ne; false of NaN but for ne."""
        a, b = self.meet(a, b)
        vector = type_of(a.kind, a.lanes)
        if a.kind == "f":
            test = "fcmp une" if sign == "ne" else f"fcmp o{sign}"
        else:
            test = "icmp " + ("" if sign in ("eq", "ne") else "u" if a.kind in "ub" else "s") + sign
        return self.let(f"{test} {vector} {a.at}, {b.at}", "b", a.lanes)

    def select(self, condition: Value, a: Value, b: Value) -> Value:
        """Return one of two numbers in each lane."""
        a, b = self.meet(a, b)
        lanes = max(a.lanes, condition.lanes)
        a, b, condition = self.spread(a, lanes), self.spread(b, lanes), self.to_kind(condition, "b")
        vector = type_of(a.kind, lanes)
        text = f"select {type_of('b', condition.lanes)} {condition.at}, {vector} {a.at}, {vector} {b.at}"
        found = self.let(text, a.kind, lanes)
        self.selected.add(found.at)
        return found

    def intrinsic(self, name: str, *args: Value) -> Value:
        """Return an operation of doubles that LLVM has an instruction for."""
        lanes = max(arg.lanes for arg in args)
        given = [self.spread(self.to_kind(arg, "f"), lanes) for arg in args]
        vector = type_of("f", lanes)
        full = f"llvm.{name}.{'f64' if lanes == 1 else f'v{lanes}f64'}"
        self.module.declarations[f"declare {vector} @{full}({', '.join([vector] * len(args))})"] = None
        return self.let(f"call {vector} @{full}({', '.join(f'{vector} {x.at}' for x in given)})", "f", lanes)

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
        read = EXPRESSIONS.get(type(node))
        return read(self, node) if read else self.refuse(node, "no such expression here")

    def known(self, node: ast.Constant) -> Value:
        """Return a number that the text states."""
        if not isinstance(node.value, (bool, int, float)):
            self.refuse(node, "no such expression here")
        return constant(node.value)

    def operated(self, node: ast.BinOp) -> Value:
        """Return an operation of two numbers of the text."""
        return self.binary(node, node.op, self.number(node.left), self.number(node.right))

    def compared(self, node: ast.Compare) -> Value:
        """Return the truth of a comparison of two numbers of the text."""
        sign = COMPARISONS.get(type(node.ops[0])) if len(node.ops) == 1 else None
        if sign is None:
            self.refuse(node, "no such expression here")
        return self.compare(sign, self.number(node.left), self.number(node.comparators[0]))

    def named(self, node: ast.Name) -> Any:
        """Return what a name stands for; in lanes, a number from outside stands in all of them."""
        if node.id in self.everywhere:
            return self.everywhere[node.id]
        value = self.lookup(node.id, node)
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

    def lookup(self, name: str, node: ast.AST) -> Any:
        """Return what a name is bound to: here, in the module of the text, in Python."""
        for names in (self.names, self.scope, PYTHON_NAMES):
            if name in names:
                return names[name]
        self.refuse(node, "nothing has that name here")

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
        reads = any(isinstance(part, (ast.Subscript, ast.Call)) for arm in arms for part in parts_of(arm))
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

    # -- arrays ------------------------------------------------------------------------------------

    def subscript(self, node: ast.Subscript) -> Any:
        """Return a part of a tuple, an entry of an array, or the rows there."""
        if not isinstance(node.value, ast.Name) or not isinstance(self.names.get(node.value.id), Array):
            of = self.value(node.value)
            if (
                isinstance(of, tuple)
                and isinstance(node.slice, ast.Constant)
                and isinstance(node.slice.value, int)
            ):
                return of[node.slice.value]
        entry, lanes = self.entry(node)
        if isinstance(lanes, Value):
            return self.gather(entry, lanes)
        return entry if entry.shape else self.load(entry, lanes)

    def entry(self, node: ast.Subscript) -> tuple[Array, int | Value]:
        """Return where an entry stands, and of how many lanes it is the first, or the index in each lane."""
        of = self.value(node.value)
        parts = node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]
        if not isinstance(of, Array) or len(parts) > len(of.shape):
            self.refuse(node, "an array with as many axes is wanted")
        *first, last = parts
        last, lane = self.lane_of(last)
        parts = [*first, last]
        if lane is None:
            *others, index = indices = self.indices(node, parts)
            return (self.part(of, others), index) if index.lanes > 1 else (self.part(of, indices), 1)
        if len(parts) < len(of.shape):
            self.refuse(node, "lanes stand along the last axis")

        def begin() -> tuple[str, Value]:
            offset = self.offset(of, self.indices(node, parts))
            return (of.at, offset) if offset.known is not None else (self.at(of, offset), constant(0))

        # Once, before the loop: LLVM's passes leave it inside, and half the instructions of a loop were of addresses.
        used = [part for one in (node.value, *parts) for part in parts_of(one) if isinstance(part, ast.Name)]
        is_outside = all(self.names.get(part.id) is self.outside.get(part.id) for part in used)
        at, offset = self.before_lanes(begin) if is_outside else begin()
        row = Array(at, of.kind, (constant(self.module.lanes),))
        return self.part(row, [self.integer("add", offset, lane.first)]), self.module.lanes

    def indices(self, node: ast.Subscript, parts: Sequence[ast.expr]) -> list[Value]:
        """Return the indices of an entry; in lanes the last one may differ."""
        indices = [self.number(part) for part in parts]
        if any(part.kind not in "iu" for part in indices) or any(part.lanes > 1 for part in indices[:-1]):
            self.refuse(node, "indices are whole numbers, in lanes the last one only differs")
        if any(part.known is not None and part.known < 0 for part in indices):
            self.refuse(node, "indices count from the beginning")
        return indices

    def lane_of(self, node: ast.expr) -> tuple[ast.expr, Lane | None]:
        """Return an index without the counter of lanes, which may be added to it, and the counter."""
        if isinstance(node, ast.Name) and isinstance(lane := self.names.get(node.id), Lane):
            return ast.Constant(0), lane
        if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add):
            right, lane = self.lane_of(node.right)
            if lane is not None:
                is_alone = isinstance(right, ast.Constant)
                return node.left if is_alone else ast.BinOp(node.left, ast.Add(), right), lane
        return node, None

    # -- calls -------------------------------------------------------------------------------------

    def call(self, node: ast.Call) -> Any:
        """Translate a call: of an operation, of a text that is pasted, of a function."""
        if node.keywords:
            self.refuse(node, "arguments stand in order")
        if isinstance(node.func, ast.Attribute) and node.func.attr == "view":
            return self.words(node)
        function: Any = self.value(node.func) if isinstance(node.func, ast.Attribute) else None
        if isinstance(node.func, ast.Name):
            function = self.lookup(node.func.id, node)
        if function is np.array and len(node.args) == 1 and isinstance(node.args[0], ast.List):
            return self.module.constant_array([self.number(part) for part in node.args[0].elts])
        args = [self.value(arg) for arg in node.args]
        if isinstance(function, ast.FunctionDef) and _is_inlined(function):
            return self.paste(function, self.module.scope, args)
        if self.width > 1 and (isinstance(function, ast.FunctionDef) or function in OUTLINED):
            self.refuse(node, "lanes call no functions with loops")
        if isinstance(function, ast.FunctionDef):
            return self.call_function(function, self.module.scope, args)
        if function in BUILT_IN:
            operation: Any = BUILT_IN[function]
            if len(args) != operation.__code__.co_argcount - 1 or not all(isinstance(a, Value) for a in args):
                self.refuse(node, "it takes other arguments")
            return operation(self, *args)
        function = COMPILED_AS.get(function, function)
        if function in OUTLINED | INLINED and len(args) != function.__code__.co_argcount:
            self.refuse(node, "it takes other arguments")
        if function in OUTLINED:
            return self.call_function(syntax(function), function.__globals__, args, merged=function in MERGED)
        if function in INLINED:
            return self.paste(syntax(function), function.__globals__, args)
        self.refuse(node, "it is none of the functions that kernels call")

    def words(self, node: ast.Call) -> Array:
        """Return the bytes of a row as integers of 64 bits."""
        assert isinstance(node.func, ast.Attribute)
        of = self.value(node.func.value)
        known = of.shape[0].known if isinstance(of, Array) and of.kind == "c" and len(of.shape) == 1 else None
        if known is None or known % 8 or ast.unparse(node.args[0]) != "np.int64":
            self.refuse(node, "whole words of bytes are viewed as np.int64")
        return Array(of.at, "i", (constant(known // 8),))

    def call_function(
        self, node: ast.FunctionDef, scope: dict[str, Any], args: Sequence[Any], *, merged: bool = False
    ) -> Value | None:
        """Call a function, which is translated if it is not yet."""
        name, kind = translate_function(self.module, node, scope, args, merged=merged)
        given = []
        for arg in args:
            if isinstance(arg, Array):
                given.append(f"ptr {arg.at}")
                given += [f"i64 {length.at}" for length in arg.shape if length.known is None]
            elif isinstance(arg, Value):
                given.append(f"{LLVM[arg.kind]} {arg.at}")
        text = f"@{name}({', '.join(given)})"
        if kind is not None:
            return self.let(f"call {LLVM[kind]} {text}", kind)
        self.put(f"call void {text}")
        return None

    def paste(self, node: ast.FunctionDef, scope: dict[str, Any], args: Sequence[Any]) -> Any:
        """Translate the text of a function where it is called."""
        outer = self.node, self.names, self.scope, self.straight, self.everywhere, self.flags
        self.node, self.scope, self.straight, self.everywhere = node, scope, True, {}
        self.flags = ""
        self.names = {parameter.arg: arg for parameter, arg in zip(node.args.args, args, strict=True)}
        *body, last = node.body
        for statement in body:
            is_docstring = isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Constant)
            if not is_docstring and not isinstance(statement, ast.Assign):
                self.refuse(statement, "an inlined function has assignments only")
            if not is_docstring:
                self.statement(statement)
        if not isinstance(last, ast.Return) or last.value is None:
            self.refuse(last, "an inlined function returns at its end")
        result = self.value(last.value)
        self.node, self.names, self.scope, self.straight, self.everywhere, self.flags = outer
        return result

    # -- statements --------------------------------------------------------------------------------

    def block(self, body: Sequence[ast.stmt]) -> None:
        """Translate statements; names bound in them end with them, unless their values have a place in memory."""
        before = dict(self.names)
        for statement in body:
            self.statement(statement)
        if not self.straight:
            slots = {name: value for name, value in self.names.items() if isinstance(value, Slot)}
            self.names = slots | before

    def statement(self, node: ast.stmt) -> None:
        """Translate one statement."""
        if self.width > 1 and not isinstance(node, (ast.Assign, ast.AugAssign)):
            self.refuse(node, "lanes have assignments only")
        match node:
            case ast.Expr(value=ast.Constant()) | ast.Pass():
                pass
            case ast.Expr():
                self.value(node.value)
            case ast.Assign(targets=[target]):
                self.assign(target, self.value(node.value))
            case ast.AugAssign():
                now = self.number(node.target)
                self.assign(node.target, self.binary(node, node.op, now, self.number(node.value)))
            case ast.If():
                self.do_if(node)
            case ast.While(orelse=[]):
                self.do_while(node)
            case ast.For(target=ast.Name(), orelse=[]):
                self.do_for(node)
            case ast.Break() | ast.Continue() if self.loops:
                self.jump(self.loops[-1][isinstance(node, ast.Break)])
                self.start(self.label())
            case ast.Return():
                self.do_return(node)
            case _:
                self.refuse(node, "no such statement here")

    def assign(self, target: ast.expr, value: Name) -> None:
        """Bind a name, store an entry, or take a tuple apart."""
        if isinstance(target, ast.Tuple):
            if not isinstance(value, tuple) or len(value) != len(target.elts):
                self.refuse(target, "as many values as names are needed")
            for part, one in zip(target.elts, value, strict=True):
                self.assign(part, one)
        elif isinstance(target, ast.Subscript):
            entry, lanes = self.entry(target)
            if not isinstance(value, Value) or entry.shape or not isinstance(lanes, int):
                self.refuse(target, "one number goes to one entry")
            if value.lanes > lanes:
                self.refuse(target, "lanes go to entries side by side")
            self.store(entry, value, lanes)
        elif isinstance(target, ast.Name):
            self.bind(target, value)
        else:
            self.refuse(target, "no such target")

    def bind(self, target: ast.Name, value: Name) -> None:
        """Let a name stand for a value: as it is where the text is straight, else by a place in memory."""
        old = self.names.get(target.id)
        self.apart &= not isinstance(value, Array) or value.at.startswith("@")
        if self.straight or not isinstance(value, Value):
            if isinstance(old, Lane) or (isinstance(old, Array) and not self.straight):
                self.refuse(target, "a counter or an array keeps its name")
            if isinstance(old, Slot):
                self.refuse(target, "what lanes assign is not known outside of them")
            self.everywhere.pop(target.id, None)
            self.names[target.id] = value
        elif isinstance(old, Slot):
            if old.kind != value.kind and value.known is None and {old.kind, value.kind} != {"i", "u"}:
                self.refuse(target, f"its kind changes from {old.kind} to {value.kind}")
            self.write(old, value)
        elif old is None:
            self.names[target.id] = self.slot(value)
        else:
            self.refuse(target, "a counter or an array keeps its name")

    def do_if(self, node: ast.If) -> None:
        """Translate a branch."""
        yes, no, done = self.label(), self.label(), self.label()
        self.branch(self.number(node.test), yes, no if node.orelse else done)
        self.start(yes)
        self.block(node.body)
        self.jump(done)
        if node.orelse:
            self.start(no)
            self.block(node.orelse)
            self.jump(done)
        self.start(done)

    def do_while(self, node: ast.While) -> None:
        """Translate a loop with a condition."""
        head, body, done = self.label(), self.label(), self.label()
        self.jump(head)
        self.start(head)
        self.branch(self.number(node.test), body, done)
        self.start(body)
        self.loops.append((head, done))
        self.block(node.body)
        self.loops.pop()
        self.jump(head)
        self.start(done)

    def do_for(self, node: ast.For) -> None:
        """Translate a loop over counters, one by one or as many as a vector has lanes."""
        call, target = node.iter, node.target
        assert isinstance(target, ast.Name)
        name = call.func.id if isinstance(call, ast.Call) and isinstance(call.func, ast.Name) else ""
        if not isinstance(call, ast.Call) or name not in ("range", *ABREAST) or call.keywords:
            self.refuse(node.iter, "loops run over range, lanes or entries")
        if target.id in self.names:
            self.refuse(target, "a counter has a name of its own")
        bounds = [self.number(arg) for arg in call.args]
        if not 1 <= len(bounds) <= (1 if name in ABREAST else 3) or any(n.kind == "f" for n in bounds):
            self.refuse(node.iter, "counters run from one whole number to another")
        if name in ABREAST:
            self.abreast(node, target.id, bounds[0], overlaps=name == "entries")
            return
        start, stop, step = (
            (constant(0), bounds[0], constant(1)) if len(bounds) == 1 else (*bounds, constant(1))[:3]
        )
        if not step.known:
            self.refuse(node.iter, "the step is a number that is known")

        def body(counter: Value, more: str, done: str) -> None:
            self.loops.append((more, done))
            self.names[target.id] = counter
            self.block(node.body)
            del self.names[target.id]
            self.loops.pop()

        self.counted(start, stop, step, body)

    def abreast(self, node: ast.For, name: str, stop: Value, *, overlaps: bool) -> None:
        """Translate a loop over lanes; with `overlaps`, the last vector ends where the entries end."""
        if self.width > 1:
            self.refuse(node, "lanes have no loops")
        width = constant(self.module.lanes)
        self.before, self.outside = len(self.lines), dict(self.names)

        def body(counter: Value, more: str, done: str) -> None:
            if overlaps:
                last = self.integer("sub", stop, width)
                counter = self.select(self.compare("lt", counter, last), counter, last)
            outer = dict(self.names), self.straight, self.width, self.everywhere
            self.straight, self.width, self.everywhere = True, self.module.lanes, {}
            self.names[name] = Lane(counter)
            for statement in self.in_order(node.body):
                self.statement(statement)
            self.names, self.straight, self.width, self.everywhere = outer

        self.counted(constant(0), stop, width, body)

    def in_order(self, body: list[ast.stmt]) -> list[ast.stmt]:
        """Return the assignments of a loop over lanes in an order in which few values wait for use."""
        if len(body) <= REGISTERS:
            return body
        self.spills = True
        parts = [parts_of(node) for node in body]
        slices = [part.slice for nodes in parts for part in nodes if isinstance(part, ast.Subscript)]
        first = [part.elts[:-1] if isinstance(part, ast.Tuple) else [part] for part in slices]
        rows = all(isinstance(one, ast.Constant) for part in first for one in part)
        touched = [self.touched(*both, rows=rows) for both in zip(body, parts, strict=True)]
        return [body[k] for k in in_order_of_need(touched)]

    def touched(self, node: ast.stmt, parts: list[ast.AST], *, rows: bool) -> tuple[set[str], set[str]]:
        """Return the names that an assignment reads, and that it writes; arrays that may overlap are one name.

        With `rows`, all of whose numbers are known in the loop, rows of an array are names of their own.
        """
        reads: set[str] = set()
        writes: set[str] = set()
        target = node.targets[0] if isinstance(node, ast.Assign) else getattr(node, "target", node)
        targets = {id(part) for part in parts_of(target)}
        entries = {id(part.value): part for part in parts if isinstance(part, ast.Subscript)}
        for part in parts:
            if not isinstance(part, ast.Name):
                continue
            name, stored = part.id, isinstance(part.ctx, ast.Store)
            if isinstance(self.names.get(name), Array):
                entry = entries.get(id(part))
                row = ast.unparse(entry.slice).rpartition(",")[0] if entry and rows else ""
                name = f"{name}[{row}" if self.apart else "["
                stored = entry is None or id(part) in targets  # what a function is given, it may store to
                reads.add(name)
            (writes if stored else reads).add(name)
        return (reads | writes if isinstance(node, ast.AugAssign) else reads), writes

    def do_return(self, node: ast.Return) -> None:
        """Return from a function that is called."""
        if self.straight:
            self.refuse(node, "an inlined function returns at its end")
        if node.value is None:
            self.put("ret void")
        else:
            value = self.number(node.value)
            self.result = self.result or value.kind
            self.put(f"ret {LLVM[self.result]} {self.to_kind(value, self.result).at}")
        self.start(self.label())


def _bits(f: _Function, value: Value, before: str, after: str) -> Value:
    text = f"bitcast {type_of(before, value.lanes)} {f.to_kind(value, before).at} to "
    return f.let(text + type_of(after, value.lanes), after, value.lanes)


def _trailing_zeros(f: _Function, x: Value) -> Value:
    f.module.declarations["declare i64 @llvm.cttz.i64(i64, i1)"] = None
    return f.let(f"call i64 @llvm.cttz.i64(i64 {f.to_kind(x, 'i').at}, i1 true)", "i")


#: How expressions are translated. By their type: a chain of patterns took a tenth of the time of translating.
EXPRESSIONS: dict[type[ast.expr], Callable[[_Function, Any], Any]] = {
    ast.Constant: _Function.known,
    ast.Name: _Function.named,
    ast.Tuple: lambda f, node: tuple(f.value(part) for part in node.elts),
    ast.BinOp: _Function.operated,
    ast.UnaryOp: _Function.unary,
    ast.Compare: _Function.compared,
    ast.BoolOp: _Function.shortcut,
    ast.IfExp: _Function.choice,
    ast.Subscript: _Function.subscript,
    ast.Attribute: _Function.attribute,
    ast.Call: _Function.call,
}
#: Operations that are instructions.
BUILT_IN: dict[Any, Callable[..., Value]] = {
    elementary.sqrt: lambda f, x: f.intrinsic("sqrt", x),
    np.sqrt: lambda f, x: f.intrinsic("sqrt", x),
    abs: lambda f, x: f.intrinsic("fabs", x),
    np.copysign: lambda f, x, y: f.intrinsic("copysign", x, y),
    elementary.select: lambda f, condition, a, b: f.select(condition, a, b),
    elementary.bits_of: lambda f, x: _bits(f, x, "f", "i"),
    elementary.double_of: lambda f, x: _bits(f, x, "i", "f"),
    elementary.trailing_zeros: lambda f, x: _trailing_zeros(f, x),
    min: lambda f, a, b: f.select(f.compare("lt", b, a), b, a),
    max: lambda f, a, b: f.select(f.compare("gt", b, a), b, a),
    int: lambda f, x: f.to_kind(x, "i"),
    float: lambda f, x: f.to_kind(x, "f"),
    np.uint64: lambda f, x: f.to_kind(x, "u"),
}


def in_order_of_need(touched: Sequence[tuple[set[str], set[str]]]) -> list[int]:
    """Return the numbers of assignments, by what they read and write, in an order in which few values wait for use.

    Next is the one that leaves the fewest, of those that may be next, the first of them in the text. Reactions and
    rates take 5 to 7 % less time than in the order of the text, with AVX-512 as with AVX2.
    """
    numbers = range(len(touched))
    before: list[set[int]] = [set() for _ in numbers]
    after: list[set[int]] = [set() for _ in numbers]
    users: list[set[int]] = [set() for _ in numbers]
    writer: dict[str, int] = {}
    readers: dict[str, set[int]] = {}
    for k, (reads, writes) in enumerate(touched):
        before[k] = {writer[name] for name in reads | writes if name in writer}
        for name in reads & writer.keys():
            if "[" not in name:
                users[writer[name]].add(k)
        for name in writes:
            before[k] |= readers.pop(name, set())
            writer[name] = k
        for name in reads - writes:
            readers.setdefault(name, set()).add(k)
        for j in before[k]:
            after[j].add(k)
    taken = [[j for j in before[k] if k in users[j]] for k in numbers]
    # how many more wait after an assignment than before it
    more = [bool(users[k]) - sum(len(users[j]) == 1 for j in taken[k]) for k in numbers]
    ready, order = [k for k in numbers if not before[k]], []
    while ready:
        k = min(ready, key=lambda k: (more[k], k))
        ready.remove(k)
        order.append(k)
        for j in taken[k]:
            users[j].remove(k)
            if len(users[j]) == 1:
                more[next(iter(users[j]))] -= 1
        for j in after[k]:
            before[j].remove(k)
            if not before[j]:
                ready.append(j)
    return order


def _is_inlined(node: ast.FunctionDef) -> bool:
    return any(isinstance(mark, ast.Name) and mark.id == "inlined" for mark in node.decorator_list)


def _signature(arg: Name) -> Any:
    if isinstance(arg, Array):
        return arg.kind, tuple(length.known for length in arg.shape)
    return arg.kind if isinstance(arg, Value) else arg


def translate_function(
    module: Module,
    node: ast.FunctionDef,
    scope: dict[str, Any],
    args: Sequence[Name],
    *,
    noalias: bool = False,
    merged: bool = False,
) -> tuple[str, str | None]:
    """Translate a function for arguments of these kinds, once; return its name and the kind of its result."""
    key = (node, tuple(_signature(arg) for arg in args))
    if key not in module.functions:
        symbol = f"{node.name}.{len(module.functions)}"
        module.functions[key] = symbol, None
        module.functions[key] = _Function(module, node, scope, args, symbol, noalias).finish(merged=merged)
    return module.functions[key]


def scope_of(tree: ast.Module) -> dict[str, Any]:
    """Return the names of a text: what it imports, and its functions as syntax trees."""
    scope: dict[str, Any] = {}
    for node in tree.body:
        if isinstance(node, (ast.Import, ast.ImportFrom)):
            exec(compile(ast.Module([node], []), "<kernel>", "exec"), scope)
        elif isinstance(node, ast.FunctionDef):
            scope[node.name] = node
    return scope


def translate(
    text: str,
    arguments: Sequence[tuple[str, tuple[int | None, ...]]],
    lanes: int,
    fast_math: Sequence[str] = (),
) -> str:
    """Return the LLVM of a kernel: a function ``kernel(ptr)`` of a table."""
    tree = parsed(text)
    scope, args, types = scope_of(tree), [], []
    module = Module(lanes, scope, "".join(f" {flag}" for flag in fast_math))
    for kind, lengths in arguments:
        types += ["ptr" if lengths else "i64", *("i64" for length in lengths if length is None)]
        shape = (Value("", "i") if length is None else constant(length) for length in lengths)
        args.append(Array("", kind, tuple(shape)) if lengths else Value("", kind))
    name, _ = translate_function(module, scope["kernel"], scope, args, noalias=True)
    lines, given = [], []
    for k, llvm_type in enumerate(types):
        lines.append(f"  %a{k} = getelementptr inbounds i64, ptr %table, i64 {k}")
        lines.append(f"  %x{k} = load {llvm_type}, ptr %a{k}")
        given.append(f"{llvm_type} %x{k}")
    call = f"  call void @{name}({', '.join(given)})"
    module.text += ["define void @kernel(ptr %table) #0 {", *lines, call, "  ret void", "}"]
    return f"{module}\n"
