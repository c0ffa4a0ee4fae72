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
from collections.abc import Sequence
from typing import Any

from fastlink.codegen.calls import Calls
from fastlink.codegen.expressions import Name, Refused, as_load
from fastlink.codegen.ir import LLVM, Array, Lane, Slot, Value, constant
from fastlink.codegen.module import Module
from fastlink.numerics.compiler import parsed

__all__ = ["Refused", "translate"]

#: Loops whose counter is many at once.
ABREAST = ("lanes", "entries")
#: AVX2 has so many for vectors; what has to wait beyond them goes to memory and back.
REGISTERS = 16


def _signature(arg: Name) -> Any:
    if isinstance(arg, Array):
        return arg.kind, tuple(length.known for length in arg.shape)
    assert isinstance(arg, Value)
    return arg.kind


class _Function(Calls):
    """One function while it is translated."""

    def __init__(
        self,
        module: Module,
        node: ast.FunctionDef,
        scope: dict[str, Any],
        args: Sequence[Name],
        symbol: str,
        noalias: bool,
    ) -> None:
        super().__init__(module, node, scope)
        self.symbol = symbol
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
        assert isinstance(arg, Value)
        return self.slot(Value(next_one(LLVM[arg.kind]), arg.kind))

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

    def translated(
        self, node: ast.FunctionDef, scope: dict[str, Any], args: Sequence[Any], *, merged: bool
    ) -> tuple[str, str | None]:
        """Return the name of a function for arguments of these kinds, and the kind of its result."""
        return translate_function(self.module, node, scope, args, merged=merged)

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
                now = self.number(as_load(node.target))
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
        parts = [list(ast.walk(node)) for node in body]
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
        targets = {id(part) for part in ast.walk(target)}
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
    """Return the LLVM of a kernel: a function ``kernel(ptr)`` of a table.

    Parameters
    ----------
    text : str
        A module with a function ``kernel``.
    arguments : sequence of (kind, lengths)
        Of each argument of the kernel its kind, and the lengths of its axes, None where the text does not know them.
        The table holds the arguments in order: a pointer and the unknown lengths of an array, or an integer.
    lanes : int
        How many doubles a vector has.
    fast_math : sequence of str
        Flags of LLVM that let roundings change, outside functions of `fastlink.numerics`; no sweep has any.

    Raises
    ------
    Refused
        The text is not of the grammar.
    """
    tree = parsed(text)
    module, args, types = Module(lanes, "".join(f" {flag}" for flag in fast_math)), [], []
    for kind, lengths in arguments:
        types += ["ptr" if lengths else "i64", *("i64" for length in lengths if length is None)]
        shape = (Value("", "i") if length is None else constant(length) for length in lengths)
        args.append(Array("", kind, tuple(shape)) if lengths else Value("", kind))
    scope = scope_of(tree)
    name, _ = translate_function(module, scope["kernel"], scope, args, noalias=True)
    lines, given = [], []
    for k, llvm_type in enumerate(types):
        lines.append(f"  %a{k} = getelementptr inbounds i64, ptr %table, i64 {k}")
        lines.append(f"  %x{k} = load {llvm_type}, ptr %a{k}")
        given.append(f"{llvm_type} %x{k}")
    call = f"  call void @{name}({', '.join(given)})"
    module.text += ["define void @kernel(ptr %table) #0 {", *lines, call, "  ret void", "}"]
    return f"{module}\n"
