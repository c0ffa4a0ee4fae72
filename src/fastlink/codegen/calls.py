"""Entries of arrays and calls in kernel text, as LLVM."""

from __future__ import annotations

import ast
from abc import abstractmethod
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from fastlink.codegen.expressions import Expressions, Unknown
from fastlink.codegen.ir import LLVM, Array, Lane, Value, constant, type_of
from fastlink.numerics import elementary
from fastlink.numerics.compiler import COMPILED_AS, INLINED, MERGED, OUTLINED, syntax

__all__ = ["Calls"]


class Calls(Expressions):
    """Entries of arrays and calls of one function."""

    @abstractmethod
    def statement(self, node: ast.stmt) -> None:
        """Translate a statement of a text that is pasted."""

    @abstractmethod
    def translated(
        self, node: ast.FunctionDef, scope: dict[str, Any], args: Sequence[Any], *, merged: bool
    ) -> tuple[str, str | None]:
        """Return the name of a function for arguments of these kinds, and the kind of its result."""

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
        names = {
            name.id for part in (node.value, *parts) for name in ast.walk(part) if isinstance(name, ast.Name)
        }
        is_outside = all(self.names.get(name) is self.outside.get(name) for name in names)
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
            try:
                function = self.lookup(node.func.id)
            except Unknown:
                self.refuse(node, "nothing has that name here")
        if function is np.array and len(node.args) == 1 and isinstance(node.args[0], ast.List):
            return self.module.constant_array([self.number(part) for part in node.args[0].elts])
        args = [self.value(arg) for arg in node.args]
        if self.width > 1 and (isinstance(function, ast.FunctionDef) or function in OUTLINED):
            self.refuse(node, "lanes call no functions with loops")
        if isinstance(function, ast.FunctionDef):
            return self.call_function(function, self.scope, args)
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
            return self.paste(function, args)
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
        name, kind = self.translated(node, scope, args, merged=merged)
        given = []
        for arg in args:
            if isinstance(arg, Array):
                given.append(f"ptr {arg.at}")
                given += [f"i64 {length.at}" for length in arg.shape if length.known is None]
            else:
                given.append(f"{LLVM[arg.kind]} {arg.at}")
        text = f"@{name}({', '.join(given)})"
        if kind is not None:
            return self.let(f"call {LLVM[kind]} {text}", kind)
        self.put(f"call void {text}")
        return None

    def paste(self, function: Callable[..., Any], args: Sequence[Any]) -> Any:
        """Translate the text of a function where it is called."""
        node = syntax(function)
        outer = self.node, self.names, self.scope, self.straight, self.everywhere, self.flags
        self.node, self.scope, self.straight, self.everywhere = node, function.__globals__, True, {}
        self.flags = ""
        self.names = {parameter.arg: arg for parameter, arg in zip(node.args.args, args, strict=True)}
        *body, last = node.body
        for statement in body:
            self.statement_of_pasted(statement)
        if not isinstance(last, ast.Return) or last.value is None:
            self.refuse(last, "an inlined function returns at its end")
        result = self.value(last.value)
        self.node, self.names, self.scope, self.straight, self.everywhere, self.flags = outer
        return result

    def statement_of_pasted(self, node: ast.stmt) -> None:
        """Translate a statement of a text that is pasted: an assignment, or a docstring."""
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
            return
        if not isinstance(node, ast.Assign):
            self.refuse(node, "an inlined function has assignments only")
        self.statement(node)


def _bits(f: Calls, value: Value, before: str, after: str) -> Value:
    text = f"bitcast {type_of(before, value.lanes)} {f.to_kind(value, before).at} to "
    return f.let(text + type_of(after, value.lanes), after, value.lanes)


def _trailing_zeros(f: Calls, x: Value) -> Value:
    f.module.declare("declare i64 @llvm.cttz.i64(i64, i1)")
    return f.let(f"call i64 @llvm.cttz.i64(i64 {f.to_kind(x, 'i').at}, i1 true)", "i")


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
