"""Values and instructions of LLVM, as text: what a translated function is made of.

A value knows its kind when it is made, so nothing is inferred afterwards. A vector is a value of several lanes; what is
needed in every lane is spread there when an operation wants it.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from fastlink.codegen.module import Module

__all__ = ["Array", "Builder", "Lane", "Slot", "Value", "constant", "type_of"]

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


@dataclass(frozen=True, slots=True)
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
    kind = kind or ("b" if isinstance(value, bool) else "f" if isinstance(value, float) else "i")
    number = MADE[kind](value)
    if kind != "f":
        return Value(str(number).lower(), kind, 1, number)
    (bits,) = struct.unpack("<Q", struct.pack("<d", number))
    return Value(f"0x{bits:016X}", kind, 1, number)


def type_of(kind: str, lanes: int = 1) -> str:
    """Return LLVM's type."""
    return LLVM[kind] if lanes == 1 else f"<{lanes} x {LLVM[kind]}>"


class Builder:
    """Instructions of one function, in order."""

    def __init__(self, module: Module) -> None:
        self.module = module
        self.lines: list[str] = []
        self.allocas: list[str] = []
        #: What is one of two numbers in each lane.
        self.selected: set[str] = set()
        self._count = 0
        #: Freedoms of arithmetic; none but in kernels that show what these would cost and gain.
        self.flags = ""

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
        self.module.declare(f"declare {vector} @{full}({', '.join([vector] * len(args))})")
        return self.let(f"call {vector} @{full}({', '.join(f'{vector} {x.at}' for x in given)})", "f", lanes)
