"""Quantities that users declare: functions of Python are read into formulas, or refused with line and remedy."""

from __future__ import annotations

import ast
import builtins
import dis
import inspect
import math
import re
import sys
import textwrap
import traceback
from collections.abc import Callable, Generator, Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import lru_cache, reduce
from itertools import product
from pathlib import Path
from types import CodeType, FunctionType, ModuleType
from typing import Any

import numpy as np

from fastlink._text import short_repr
from fastlink.errors import InputError, KeyPath, Problems, suggest
from fastlink.facts.catalogue import Catalogue
from fastlink.facts.derivative import NoDerivative
from fastlink.facts.expression import (
    SIGNS,
    GraphAsWritten,
    Node,
    beneath,
    divisors,
    generate_formula,
    postorder,
    winding,
)
from fastlink.facts.fact import Fact, Input, System
from fastlink.facts.formula import NAMESPACE, Formula, SheetError
from fastlink.facts.names import (
    ErrorBound,
    ListOfExtrema,
    Quantity,
    Reduced,
    Trust,
    bounded_of,
    plain_part,
    root_of,
)
from fastlink.facts.powers import UNITS, Powers, UnlikePowers, units_text
from fastlink.numerics.compiler import parsed
from fastlink.numerics.elementary import NOT_A_NUMBER, select, sqrt
from fastlink.numerics.vectors import absolute, choice, magnitude

# -- What a user's function may call


#: Modules whose functions may be called by an attribute.
MODULES = (math, np)
CONSTANTS = {"pi": math.pi, "tau": math.tau, "e": math.e}
#: NaN where either number is.
_OUTER = "choice(a != a, a, choice(a {} b, a, b))"
_FUNCTIONS = {
    "abs(a)": "absolute(a)",
    "sqrt(a)": "sqrt(a)",
    "hypot(a, b)": "magnitude(a, b)",
    "atan2(a, b)": "atan2(a, b)",
    "sin(a)": "sine(a)",
    "cos(a)": "cosine(a)",
    "tan(a)": "sine(a) / cosine(a)",
    "atan(a)": "atan2(a, 1.0)",
    "asin(a)": "atan2(a, sqrt((1.0 - a) * (1.0 + a)))",
    "acos(a)": "atan2(sqrt((1.0 - a) * (1.0 + a)), a)",
    "log(a)": "log(a)",
    "degrees(a)": f"{180.0 / math.pi!r} * a",
    "radians(a)": f"{math.pi / 180.0!r} * a",
    "max(a, b)": _OUTER.format(">"),
    "min(a, b)": _OUTER.format("<"),
    "where(condition, a, b)": "select(condition, a, b)",
}
#: The functions by their names.
FUNCTIONS = {
    head.partition("(")[0]: Formula(head, re.findall(r"\w+", head)[1:], [f"return {text}"])
    for head, text in _FUNCTIONS.items()
}
#: Those that take two numbers or more.
OF_MANY = ("max", "min")
#: Their names in Python's modules and NumPy.
ALIASES = {"fabs": "abs", "absolute": "abs", "arctan2": "atan2", "arctan": "atan", "arcsin": "asin"}
ALIASES |= {"arccos": "acos", "maximum": "max", "minimum": "min", "rad2deg": "degrees", "deg2rad": "radians"}
#: Their names by the objects of Python and NumPy that they are.
OBJECTS = {
    id(getattr(module, name)): ALIASES.get(name, name)
    for module in (builtins, math, np)
    for name in (*FUNCTIONS, *ALIASES)
    if hasattr(module, name) and not (module is np and name in OF_MANY)
}


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

#: Instructions of Python that tell a text from another one of the same names and numbers.
STEPS = ("LOAD_FAST", "LOAD_SMALL", "STORE", "BINARY", "COMPARE", "UNARY")


def _source_of(function: Any) -> tuple[ast.FunctionDef, str, int]:
    """Return the syntax of a user's function, its text without decorators, and the line of the file before it."""
    if not isinstance(function, FunctionType):
        raise InputError(f"{short_repr(function)} is not a function", ("quantity",), A_FUNCTION)
    name, code = function.__name__, function.__code__
    if name == "<lambda>":
        raise InputError("a lambda has no name and no lines", ("quantity",), A_FUNCTION)
    if hasattr(function, "__wrapped__"):
        raise InputError("is wrapped by another decorator", (name,), "write this decorator alone")
    if function.__closure__:
        what = f"holds {', '.join(code.co_freevars)} of the function around it"
        remedy = "write numbers, or declare inputs with default values: input(NAME, units=..., default=...)"
        raise InputError(what, (name,), remedy)
    try:
        lines, first = inspect.getsourcelines(function)
    except (OSError, TypeError, SyntaxError):
        what = "has no text: it was typed at a prompt, or made by exec"
        raise InputError(what, (name,), A_FUNCTION) from None
    text = textwrap.dedent("".join(lines))
    try:
        tree = next(iter(parsed(text).body), None)
        if isinstance(tree, ast.FunctionDef) and tree.name == name:
            text = "\n".join(text.split("\n")[tree.lineno - 1 : tree.end_lineno])
            module = compile(text, "<text>", "exec")
            if any(_does(one) == _does(code) for one in module.co_consts if isinstance(one, CodeType)):
                return tree, text, first - 1
    except SyntaxError:
        pass
    except (RecursionError, MemoryError):
        raise InputError(f"has {TOO_LONG[0]}", (name,), TOO_LONG[1]) from None
    what = f"its text in {Path(code.co_filename).name} is not that of the function"
    raise InputError(what, (name,), "load the file again: it was changed since")


def _does(code: CodeType) -> tuple[Any, ...]:
    """Return what a function does, wherever its text stands; but for calls, which depend on the file's imports."""
    steps = [
        (step.opname, step.argval) for step in dis.get_instructions(code) if step.opname.startswith(STEPS)
    ]
    constants = [one.co_name if isinstance(one, CodeType) else repr(one) for one in code.co_consts]
    return code.co_name, code.co_varnames, code.co_names, constants, steps


# -- Read the text of a user's function into values, or refuse it with line, reason and remedy


#: The greatest power that is written as products.
MOST_POWER = 16
A_NUMBER = "write `1.0 if condition else 0.0`"
CHOOSE = "write `a if condition else b`, or max and min"
A_GLOBAL = "take a parameter, or declare an input with a default value"
#: What is no number or no straight-line code, by kinds of syntax, and what to write instead.
REFUSED = {
    "Lambda": ("is a lambda", "write its formula here"),
    "ListComp GeneratorExp SetComp DictComp": ("is a loop", "write each term"),
    "List": ("is a list", "write numbers"),
    "Tuple": ("is several values", "return one number; declare a quantity for each"),
    "Dict": ("is a dict", "write numbers"),
    "Subscript": ("is a part of something", "take a parameter for it"),
    "JoinedStr": ("is a text", "write numbers"),
    "NamedExpr": ("assigns within an expression", "assign on a line of its own"),
    "Starred": ("has an unknown number of values", "write each"),
    "BinOp": ("is an operation that facts do not have", "write + - * / or **"),
    "Return": ("is not the last line", f"end in one return: {CHOOSE}"),
    "If Match": ("branches", CHOOSE),
    "For While": (
        "is a loop",
        "write each term: only straight-line code is compiled for any number of designs",
    ),
    "FunctionDef": (
        "defines a function",
        "declare it as a quantity of its own, and take that as a parameter",
    ),
    "ClassDef": ("defines a class", "write assignments and one return"),
    "Global": ("is about global names", A_GLOBAL),
    "Nonlocal": ("is about outer names", A_GLOBAL),
    "Import ImportFrom": ("imports", "import above the function"),
    "Assert": ("tests", "write the value where it holds, and another one else: `a if condition else b`"),
    "Raise": ("raises an error", CHOOSE),
    "Expr Pass": ("has no effect", "leave it out"),
}
REFUSALS = {kind: said for kinds, said in REFUSED.items() for kind in kinds.split()}
#: Returns a value, and yields such of the parts that it needs: texts of any depth are read without recursion.
Reading = Generator[Any, Node, Node]


class Refused(Exception):
    """Something that no fact has; it is noted."""


class _Reader:
    """The values of a function's names, statement by statement."""

    def __init__(self, tree: ast.FunctionDef, file: str, before: int, names: Mapping[str, Any]) -> None:
        self.tree, self.file, self.before, self.names = tree, file, before, names
        self.problems, self.line = Problems(), tree.lineno
        with self.problems.at(tree.name):
            check_name(tree.name)
        self.graph = GraphAsWritten((absolute, choice, magnitude))
        self.parameters = self._parameters(tree.args)
        self.values = {name: self.graph.name(name) for name in self.parameters}
        #: The values that are assigned, and by all values the line that has them first.
        self.assigned: dict[Node, None] = {}
        self.lines: dict[Node, int] = {}
        #: Whether all is a number that is compared: else nothing that is chosen is one.
        self.exists: Node | None = None
        self.compared: set[Node] = set()
        self.jumps = False

    def formula(self) -> list[tuple[str, int]]:
        """Return the lines of a formula, each with the line of the file that says so; raise all problems."""
        body = self.tree.body[ast.get_docstring(self.tree) is not None :]
        *assignments, last = body or [ast.Pass(lineno=self.tree.lineno)]
        for statement in assignments:
            self._read(statement)
        if isinstance(last, ast.Return) and last.value is not None:
            self._read(last, last.value)
        elif not self.problems.noted or isinstance(last, ast.Return):
            self.line = last.lineno
            self.note("ends without a value", "end in `return` and one number")
        self.problems.stop()
        _, written = self.graph.write(self.values["return"], {}, self.assigned)
        return [(line, self.before + self.lines.get(node, last.lineno)) for node, line in written]

    def _read(self, statement: ast.stmt, returned: ast.expr | None = None) -> None:
        """Read a statement; what is refused is noted, and the others are read all the same."""
        self.line = statement.lineno
        try:
            names, value = (["return"], returned) if returned else self._assignment(statement)
            condition = not returned and self.is_condition(value)
            found = _result(self.condition(value) if condition else self.number(value))
            self.values |= dict.fromkeys(names, found)
            self.assigned |= {} if returned else {found: None}
        except Refused:
            for target in getattr(statement, "targets", [getattr(statement, "target", None)]):
                if isinstance(target, ast.Name):
                    self.values.setdefault(target.id, self.graph.name(target.id))
        new = list(self.graph.nodes.values())[len(self.lines) :]
        self.lines |= dict.fromkeys(new, statement.lineno)

    def _assignment(self, node: ast.stmt) -> tuple[list[str], ast.expr]:
        """Return the names that a statement assigns to, and the value."""
        if not isinstance(node, (ast.Assign, ast.AnnAssign, ast.AugAssign)):
            wrong = "is not straight-line code", "write assignments and one return"
            raise self.refuse(node, *REFUSALS.get(type(node).__name__, wrong))
        targets = node.targets if isinstance(node, ast.Assign) else [node.target]
        names = [target.id for target in targets if isinstance(target, ast.Name)]
        if len(names) < len(targets) or node.value is None:
            raise self.refuse(
                node, "assigns to more than a name", "assign one number to one name on each line"
            )
        if isinstance(node, ast.AugAssign):
            before = ast.copy_location(ast.Name(names[0], ast.Load()), node)
            return names, ast.copy_location(ast.BinOp(before, node.op, node.value), node)
        return names, node.value

    @property
    def imports(self) -> tuple[str, ...]:
        """The imports of modules, and of functions and constants of math, by which the text has the same meaning."""
        found = set()
        names = (node.id for one in self.tree.body for node in ast.walk(one) if isinstance(node, ast.Name))
        for name in {*names} - self.values.keys():
            before, meant = "", self.names.get(name)
            if isinstance(meant, ModuleType):
                of = meant.__name__
            elif (constant := constant_of(meant)) is not None:
                of, before = next(key for key, one in CONSTANTS.items() if one == constant), "from math "
            elif callable(meant) and getattr(meant, "__module__", None) == "math":
                of, before = meant.__name__, "from math "
            else:
                continue
            found.add(f"{before}import {of}" + ("" if of == name else f" as {name}"))
        return tuple(sorted(found))

    def note(self, what: str, remedy: str, node: ast.AST | None = None) -> None:
        """Note a problem at the line at hand."""
        text = "" if node is None else f"{quoted(node)} "
        place = f"line {self.before + self.line} of {self.file}: "
        self.problems.add(f"{place}{text}{what}", (self.tree.name,), remedy)

    def refuse(self, node: ast.AST, what: str, remedy: str) -> Refused:
        """Note a problem of a node, and return what to raise."""
        self.line = getattr(node, "lineno", self.line)
        self.note(what, remedy, node)
        return Refused()

    def _parameters(self, args: ast.arguments) -> tuple[str, ...]:
        if args.vararg or args.kwarg:
            self.note("takes any number of arguments", "name each quantity and input that it depends on")
        named = [*args.posonlyargs, *args.args]
        defaults = (*zip(named[len(named) - len(args.defaults) :], args.defaults, strict=True),)
        by_name = zip(args.kwonlyargs, args.kw_defaults, strict=True)
        for parameter, value in (*defaults, *((one, value) for one, value in by_name if value)):
            remedy = f'declare it: input("{parameter.arg}", units=..., default={quoted(value)[1:-1]})'
            self.note(f"the parameter {parameter.arg} has a default value", remedy)
        names = tuple(one.arg for one in (*named, *args.kwonlyargs))
        if not names:
            self.note("takes no parameter", "name the quantities and inputs that it depends on")
        return names

    # -- expressions ---------------------------------------------------------------------------------------------

    def is_condition(self, node: ast.expr) -> bool:
        """Tell whether an expression is a condition, not a number."""
        match node:
            case ast.Name():
                return node.id in self.values and self.values[node.id].is_condition
            case ast.Compare() | ast.BoolOp() | ast.BinOp(op=ast.BitAnd() | ast.BitOr()):
                return True
        return isinstance(getattr(node, "op", None), (ast.Not, ast.Invert))

    def number(self, node: ast.expr) -> Reading:
        """Read a number."""
        if self.is_condition(node):
            raise self.refuse(node, "is a condition, not a number", A_NUMBER)
        match node:
            case ast.Constant():
                return self._constant(node)
            case ast.Name():
                return self._name(node)
            case ast.Attribute():
                constant = constant_of(getattr(self._module(node.value), node.attr, None))
                if constant is None:
                    raise self.refuse(node, "is not a number", "write the number")
                return self.graph.number(constant)
            case ast.UnaryOp():
                value = yield self.number(node.operand)
                return self.graph.neg(value) if isinstance(node.op, ast.USub) else value
            case ast.BinOp(op=ast.Pow()):
                halves = self._halves(node)
                return self._power((yield self.number(node.left)), halves)
            case ast.BinOp() if type(node.op) in SIGNS:
                left = yield self.number(node.left)
                return self.graph.node(SIGNS[type(node.op)], left, (yield self.number(node.right)))
            case ast.IfExp():
                return (yield self.choice(node.test, node.body, node.orelse))
            case ast.Call():
                name = self._called(node)
                if name == "where":
                    return (yield self.choice(*node.args))
                numbers = yield from self._each(self.number, node.args)
                if name in OF_MANY:
                    return reduce(lambda a, b: self.graph.read(FUNCTIONS[name], [a, b]), numbers)
                return self.graph.read(FUNCTIONS[name], numbers)
        wrong = "is not a number", "write numbers, + - * / and functions"
        raise self.refuse(node, *REFUSALS.get(type(node).__name__, wrong))

    def _each(
        self, read: Callable[[ast.expr], Reading], nodes: Iterable[ast.expr]
    ) -> Generator[Any, Node, list[Node]]:
        """Read several parts."""
        values = []
        for node in nodes:
            values.append((yield read(node)))
        return values

    def _constant(self, node: ast.Constant) -> Node:
        if isinstance(node.value, bool) or not isinstance(node.value, (int, float)):
            raise self.refuse(node, "is not a real number", "write numbers")
        if abs(node.value) > sys.float_info.max:
            raise self.refuse(node, "is not finite", "write finite numbers")
        return self.graph.number(float(node.value))

    def _name(self, node: ast.Name) -> Node:
        if node.id in self.values:
            return self.values[node.id]
        meant = self.names.get(node.id)
        if (constant := constant_of(meant)) is not None:
            return self.graph.number(constant)
        if meant is not None or hasattr(builtins, node.id):
            number = f", default={meant!r}" if isinstance(meant, (int, float)) else ""
            remedy = (
                f'write the number, or declare input("{node.id}", units=...{number}) and make it a parameter'
            )
            raise self.refuse(node, "is a name outside of the function", remedy)
        remedy = suggest(node.id, self.values) if self.values else ""
        remedy = remedy if remedy.startswith("did you mean") else "make it a parameter"
        raise self.refuse(node, "is neither a parameter nor assigned above", remedy)

    def _module(self, node: ast.expr) -> ModuleType | None:
        """Return the module that a name stands for, None if that is none of which functions may be called."""
        if not isinstance(node, ast.Name) or node.id in self.values:
            return None
        found = self.names.get(node.id)
        return found if isinstance(found, ModuleType) and found in MODULES else None

    def _halves(self, node: ast.BinOp) -> int:
        """Return twice the exponent of a power."""
        try:
            exponent = ast.literal_eval(node.right)
        except ValueError:
            exponent = None
        halves = 2 * exponent if type(exponent) in (int, float) else 0
        if not 0 < abs(halves) <= 2 * MOST_POWER or halves % 1:
            remedy = f"write a whole or half number up to {MOST_POWER}, such as x**2, x**-1 or x**0.5"
            raise self.refuse(node, "is a power that facts do not have", remedy)
        return int(halves)

    def _power(self, base: Node, halves: int) -> Node:
        """Return a power as products of squares."""
        graph, whole = self.graph, abs(halves) // 2
        factors = [graph.call(sqrt, base)] if halves % 2 else []
        while whole:
            factors += [base] if whole % 2 else []
            base, whole = graph.node("*", base, base), whole // 2
        found = reduce(lambda a, b: graph.node("*", a, b), factors)
        return graph.node("/", graph.one, found) if halves < 0 else found

    def choice(self, test: ast.expr, body: ast.expr, orelse: ast.expr) -> Reading:
        """Read a choice by a condition."""
        self.jumps, graph = True, self.graph
        condition = yield self.condition(test)
        numbers = yield from self._each(self.number, (body, orelse))
        chosen = graph.call(choice, condition, *numbers)
        none = graph.number(NOT_A_NUMBER)
        return chosen if self.exists is None else graph.call(select, self.exists, chosen, none)

    def _called(self, node: ast.Call) -> str:
        """Return the name of a function that is called, or refuse the call."""
        called, meant, name = "", None, ""
        if isinstance(node.func, ast.Attribute):
            called = node.func.attr
            name = OBJECTS.get(id(getattr(self._module(node.func.value), called, None)), "")
        elif isinstance(node.func, ast.Name) and node.func.id not in self.values:
            called = node.func.id
            meant = self.names.get(called, getattr(builtins, called, None))
            # a name that stands for nothing is known by its letters
            name = OBJECTS.get(id(meant), "") if meant is not None else ALIASES.get(called, called)
        if node.keywords or any(isinstance(one, ast.Starred) for one in node.args):
            raise self.refuse(node, "has arguments by name or in a list", "write one number for each")
        if called == self.tree.name:
            raise self.refuse(node, "calls itself", "write a formula")
        if name not in FUNCTIONS:
            known = ", ".join(sorted(FUNCTIONS))
            remedy = f"write its formula here, or make it a quantity and a parameter; known: {known}"
            raise self.refuse(node, "calls a function that no fact has", remedy)
        count, many = len(FUNCTIONS[name].parameters), name in OF_MANY
        if len(node.args) < count or (len(node.args) > count and not many):
            remedy = f"{called} takes {count}{' or more' if many else ''}"
            raise self.refuse(node, "has another number of arguments", remedy)
        return name

    def condition(self, node: ast.expr) -> Reading:
        """Read a condition."""
        graph = self.graph
        match node:
            case ast.Name() if self.is_condition(node):
                return self.values[node.id]
            case ast.Compare() if all(type(sign) in SIGNS for sign in node.ops):
                numbers = yield from self._each(self.number, (node.left, *node.comparators))
                for one in numbers:
                    self._must_exist(one)
                pairs = zip(node.ops, numbers, numbers[1:], strict=False)
                parts, sign = [graph.node(SIGNS[type(sign)], a, b) for sign, a, b in pairs], "&"
            case ast.BoolOp():
                sign = "&" if isinstance(node.op, ast.And) else "|"
                parts = yield from self._each(self.condition, node.values)
            case ast.BinOp(op=ast.BitAnd() | ast.BitOr()):
                sign = SIGNS[type(node.op)]
                parts = yield from self._each(self.condition, (node.left, node.right))
            case ast.UnaryOp():
                raise self.refuse(
                    node, "negates a condition", "turn its comparison round: `a <= b` for `not a > b`"
                )
            case _:
                raise self.refuse(node, "is not a condition", "compare two numbers: < <= > >= == !=")
        return reduce(lambda a, b: graph.node(sign, a, b), parts)

    def _must_exist(self, number: Node) -> None:
        """Let nothing that is chosen be a number where this is none."""
        exists = self.graph.node("==", number, number)
        if number.kind != "number" and exists not in self.compared:
            self.compared.add(exists)
            self.exists = exists if self.exists is None else self.graph.node("&", self.exists, exists)


def _result(reading: Reading) -> Node:
    """Return the value that is read."""
    pending, value = [reading], None
    while pending:
        try:
            pending.append(pending[-1].send(value))  # type: ignore[arg-type]
            value = None
        except StopIteration as end:
            pending.pop()
            value = end.value
    assert isinstance(value, Node)
    return value


def quoted(node: ast.AST) -> str:
    """Return a short text of a node, in quotes."""
    try:
        text = ast.unparse(node).splitlines()[0]
    except RecursionError:
        return "`...`"
    return f"`{text if len(text) <= 40 else text[:37] + '...'}`"


# -- Names that no quantity or input of a user can have


#: Names of options and coordinates.
OPTIONS = """
    active allow_invalid angles angles_deg attrs backend block branch client design extrema extremum
    input inputs keep layout links mechanism n outputs overwrite part positions progress quantities
    refinement restart seed solver space starts status threads to verify
"""
#: Names of variables and functions in the texts of kernels.
OF_KERNELS = """
    abs all_best all_gradients all_lists all_winners append_item append_of_lane array at
    begin_pieces best bound_aside bound_at_zero bound_ends bound_hidden bound_zeros clear
    clear_ranges close_pieces collect collect_beside collect_ends collect_jumps collect_leasts
    collect_rest collect_unresolved copy_row counts cut_pieces designs divide_cells divided doubt
    drop_folds end_values ends entries evaluate_items every_vector extrema_at_zeros filled
    find_certain find_hidden find_roots fine_marks flag_undecided flags flattened fluctuation_lanes
    forget_slopes forget_splits forget_winners forget_zeros found from_high from_low from_upper
    further gather gradients has_no_bound i i0 inf insert j j0 j1 j2 join_pieces join_winners
    judge_winners k keep_leasts keep_slopes keep_splits keep_zeros kernel known lanes leasts lists
    mark mark_ends mark_hiding mark_splits mark_unresolved marks max min mirror_image n_angles
    n_designs n_ends n_further n_here n_leasts n_open n_pieces n_vectors nan next_split note_kinks
    note_pieces note_uncertain note_winners nothing_yet numbers octaves of_better off_at_end
    outlined p0 padded piece pieces place_aside place_samples pole_values position range ranges rest
    roots roundness_lanes samples search_octaves settle_jumps settle_toggles side signs silence_rest
    silenced solve_lanes split split_valleys splits square start state step store_assembly
    store_best store_change store_counts store_extrema store_list store_row straightness_lanes sums
    table tile trial turn unlist_jumps unresolved upper v valleys values_at_pole values_beside
    values_lost vectors w w2 width winners zeros
"""
TAKEN = frozenset({*OPTIONS.split(), *OF_KERNELS.split(), *NAMESPACE})
#: The beginnings of names that kernels make.
MADE = r"out_|whole_|(asked|certain|columns|f|gradient|limit|part|rows|search|slope|split_by|value)_\d"
#: Letters of the longest name: results have endings, and files room for 255.
LONGEST = 60


def is_reserved(name: str) -> bool:
    """Tell whether a name has another meaning at the doors, in files or in kernels."""
    return name in TAKEN or re.match(MADE, name) is not None


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
    if is_reserved(name):
        raise InputError(
            f"{name!r} is a word of fastlink's own", remedy=f"call it otherwise, such as 'my_{name}'"
        )


# -- Split a user's text at its kinks: the values that vanish there, and the smooth texts between which it
#    chooses


#: The most smooth texts that are searched one by one; a text with more of them is searched as it is.
MOST_PIECES = 8
#: The most kinks and magnitudes that are searched: with twice as many, a kernel takes four times as long to compile.
MOST_KINKS = 64


def split(
    graph: GraphAsWritten, root: Node, kinked: Mapping[str, tuple[str, ...]]
) -> tuple[list[Node], list[Node]] | None:
    """Return what vanishes at the kinks of a value, and the smooth values between which it chooses.

    Of these there is none where they are too many. With them are magnitudes within, sharp where they almost vanish.
    `kinked` are names that choose between others. None of more kinks and magnitudes than are searched.
    """
    nodes = beneath([root])
    kinks = {node: kink for node in nodes if (kink := _kink(graph, node)) is not None}
    norms = [node for node in nodes if node.value is magnitude]
    if len(kinks) + len(norms) > MOST_KINKS:
        return None
    inner = [node for node in nodes if node.kind == "name" and node.value in kinked]
    sides = [sides for _, *sides in kinks.values()]
    sides += [[graph.name(name) for name in kinked[node.value]] for node in inner]
    pieces: dict[Node, None] = {}
    if (sides or norms) and math.prod(len(one) or MOST_PIECES for one in sides) <= MOST_PIECES:
        chosen = (dict(zip((*kinks, *inner), of_each, strict=True)) for of_each in product(*sides))
        pieces = dict.fromkeys(_piece(graph, root, one) for one in chosen)
    return list(dict.fromkeys(kink[0] for kink in kinks.values())), list(pieces | dict.fromkeys(norms))


def _kink(graph: GraphAsWritten, node: Node) -> tuple[Node, Node, Node] | None:
    """Return what vanishes where both values of a choice of the greater or a size meet, and these; None for others."""
    if node.kind != "call":
        return None
    x = node.args[0]
    if node.value is choice and x.kind in ("<", ">") and x.args == node.args[1:]:
        return graph.node("-", *x.args), x.args[0], x.args[1]
    if node.value is sqrt and x.kind == "*" and x.args[0] is x.args[1]:
        x = x.args[0]
    elif node.value is not absolute:
        return None
    return x, x, graph.neg(x)


def _piece(graph: GraphAsWritten, root: Node, chosen: Mapping[Node, Node]) -> Node:
    """Return a value with one of those between which it chooses in place of each choice."""
    made: dict[Node, Node] = {}

    def same(node: Node) -> Node:
        """Return the value that stands for a value, itself if none does."""
        # the same value before a choice between it and another one, where it is no number
        if node.value is choice and node.args[0].kind == "!=" and {*node.args[0].args} == {node.args[1]}:
            return node.args[2]
        return chosen.get(node, node)

    def parts(node: Node) -> tuple[Node, ...]:
        return node.args if same(node) is node else (same(node),)

    for node in postorder([root], parts, made):
        new = [made[part] for part in parts(node)]
        made[node] = graph.node(node.kind, *new, value=node.value) if same(node) is node else new[0]
    return made[root]


# -- Check the units of a user's quantity: its text runs on numbers that have no value, only a dimension

# A text means the same in any units: constants are pure numbers, what has a unit is an input.


#: What other programs call units, by their texts here.
OTHERS = {
    "rad": ("deg", "degree", "degrees", "°"),
    "1": ("", "-", "dimensionless", "%"),
    "N m": ("Nm", "N*m"),
    "m s-2": ("m/s2", "m/s^2"),
    "m s-1": ("m/s",),
    "rad s-1": ("rad/s",),
    "s-1": ("Hz",),
    "N m-2": ("Pa",),
    "kg m2": ("kg*m2",),
    "m": ("mm",),
    "N": ("kN",),
    "s": ("ms",),
    "kg": ("g",),
}


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
    meant = next(
        (ours for ours, others in OTHERS.items() if isinstance(units, str) and units.strip() in others), ""
    )
    known = f"of {', '.join(UNITS)} with whole powers, such as 'kg m2 s-2' or 'rad s-1'"
    remedy = f"write {meant!r}" if meant else f"write a product {known}"
    raise InputError(f"is {short_repr(units)}", where=where, remedy=remedy)


# -- Declarations of users as data: inputs, and quantities by their texts, from which catalogues are made
#    anywhere


def input_text(declared: Input) -> str:
    """Return the declaration of an input, to be read and run."""
    given = {"units": declared.units, "default": declared.default, "rule": declared.rule}
    given |= {"description": declared.meaning, "symbol": declared.symbol}
    usual = {"rule": "any", "default": None, "description": declared.name, "symbol": declared.name}
    shown = (f"{key}={value!r}" for key, value in given.items() if value != usual.get(key, ""))
    return f"mine.input({declared.name!r}, {', '.join(shown)})"


@dataclass(frozen=True)
class OwnQuantity:
    """A quantity that a user declares."""

    name: str
    units: str
    symbol: str
    meaning: str
    parameters: tuple[str, ...]
    #: The lines of its formula, and its text as the user wrote it.
    formula_lines: tuple[str, ...]
    written: str
    imports: tuple[str, ...]
    jumps: bool
    file: str = field(compare=False, repr=False)
    line: int = field(compare=False, repr=False)
    #: The line of the file that says each line of the formula.
    lines: tuple[int, ...] = field(compare=False, repr=False)

    @property
    def text(self) -> str:
        """Its declaration, to be read and run."""
        symbol = "" if self.symbol == self.name else f", symbol={self.symbol!r}"
        return f"@mine.quantity(units={self.units!r}, description={self.meaning!r}{symbol})\n{self.written}"

    @property
    def formula(self) -> Formula:
        """Its formula."""
        return Formula(self.name, self.parameters, self.formula_lines)


def read_quantity(function: Any, units: str, meaning: str, symbol: str) -> OwnQuantity:
    """Return the quantity that a user's function is, or refuse it with lines, reasons and remedies."""
    tree, text, before = _source_of(function)
    file, name = Path(function.__code__.co_filename).name, tree.name
    reader = _Reader(tree, file, before, function.__globals__)
    formula, lines = zip(*reader.formula(), strict=True)
    first = (ast.get_docstring(tree) or "").strip().split("\n", 1)[0].rstrip(".")
    labels = name, units, symbol or name, meaning or first or name
    place = file, before + tree.lineno, lines
    return OwnQuantity(*labels, reader.parameters, formula, text, reader.imports, reader.jumps, *place)


#: What a user declares, each after what it depends on.
Definition = tuple[Input | OwnQuantity, ...]


def _check_units(quantity: OwnQuantity, formula: Formula, units: Iterable[str]) -> None:
    """Refuse a formula that does not give the units of its quantity, for parameters of some units."""
    try:
        value = formula(*map(Powers.of_units, units))
    except (UnlikePowers, ArithmeticError) as error:
        steps = traceback.extract_tb(error.__traceback__)
        number = [step.lineno or 2 for step in steps if step.filename == formula.file][-1]
        what, remedy = f"cannot be computed ({error})", "mend the text"
        if isinstance(error, UnlikePowers):
            what = str(error)
            remedy = (
                "constants have no units: declare mine.input(NAME, units=..., default=...), and write NAME"
            )
        place = f"line {quantity.lines[number - 2]} of {quantity.file}"
        raise InputError(f"{place} {what}", (quantity.name,), remedy) from None
    expected = Powers.of_units(quantity.units).powers
    found = value.powers if isinstance(value, Powers) else (0.0, 0.0, 0.0)
    if found != expected:
        gives = "a number without units" if not any(found) else units_text(found)
        remedy = f"declare units={'1' if not any(found) else units_text(found)!r}, or mend the text"
        if any(found) and not any(expected):
            remedy = f'divide by an input of that unit: mine.input(NAME, units="{gives}", default=...)'
        what = f"is declared in {quantity.units!r}, and its text gives {gives}"
        raise InputError(what, (quantity.name,), remedy)


def declared_names(text: str) -> list[str]:
    """Return the names that a text of `definition_text` declares."""
    return ["".join(found) for found in re.findall(r"^def (\w+)|^mine\.input\('(\w+)'", text, re.M)]


def definition_text(mechanism: str, definition: Definition) -> str:
    """Return declarations as a text of Python that makes them again."""
    imports = {line for one in definition if isinstance(one, OwnQuantity) for line in one.imports}
    head = "\n".join([*sorted(imports), "import fastlink as fl", "", f"mine = fl.extend({mechanism!r})"])
    parts = [f"\n{one.text}" if isinstance(one, OwnQuantity) else input_text(one) for one in definition]
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
            if isinstance(one, Input):
                _check_free(own, one.name, "input")
                own.declare_input(one)
            elif first is None or all(own.declares(plain_part(own.parse(name))) for name in one.parameters):
                _declare(own, one)
        except SheetError as error:
            raise InputError(error.what, (one.name,), "call it otherwise") from None
    return own


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
    formula = one.formula
    _check_units(one, formula, units)
    labels: dict[str, Any] = {"units": one.units, "symbol": one.symbol, "meaning": one.meaning}
    labels |= {"source": f"declared in {one.file}", "own": True}
    catalogue.declare(Fact(one.name, formula, one.parameters, **labels))
    graded = catalogue.graded
    if graded is None:
        return
    graph = GraphAsWritten((absolute, choice, magnitude))
    root = graph.read(formula, [*map(graph.name, one.parameters)])
    turns = winding(beneath([root]), catalogue.winding_of)
    if (
        one.jumps
        or not graded.wraps_at.keys() >= turns.keys()
        or not _declare_kinks(catalogue, one, root, graph, labels)
    ):
        names = (*graded.not_differentiable, one.name)
        catalogue.graded = replace(graded, not_differentiable=names)
    elif turns:
        assert catalogue.graded is not None
        windings = {**catalogue.graded.windings, one.name: turns}
        catalogue.graded = replace(catalogue.graded, windings=windings)
    _declare_poles(catalogue, one, root, labels)


def _declare_kinks(
    catalogue: Catalogue, one: OwnQuantity, root: Node, graph: GraphAsWritten, labels: dict[str, Any]
) -> bool:
    """Declare what vanishes at kinks and the smooth quantities between them; return False of too many kinks."""
    graded = catalogue.graded
    assert graded is not None
    known = {name: pieces for name, (_, pieces) in graded.kinks.items()}
    found = split(graph, root, known)
    inner = [switch for name in one.parameters for switch in graded.kinks.get(name, ((), ()))[0]]
    if found is None or len(inner) + len(found[0]) + len(found[1]) > MOST_KINKS:
        return False

    kinks = (
        *inner,
        *(declared_step(catalogue, f"{one.name}_kink{k}", node, labels) for k, node in enumerate(found[0])),
    )
    pieces = tuple(
        declared_step(catalogue, f"{one.name}_piece{k}", node, labels) for k, node in enumerate(found[1])
    )
    if kinks or pieces or any(name in known for name in one.parameters):
        catalogue.graded = replace(graded, kinks={**graded.kinks, one.name: (kinks, pieces)})
    return True


def _declare_poles(catalogue: Catalogue, one: OwnQuantity, root: Node, labels: dict[str, Any]) -> None:
    """Declare what a quantity is divided by, of itself or of the quantities that it is made of."""
    graded, nodes = catalogue.graded, beneath([root])
    assert graded is not None
    moving = [zero for zero in divisors(nodes) if any(_moves(catalogue, part) for part in beneath([zero]))]
    poles = [declared_step(catalogue, f"{one.name}_pole{k}", node, labels) for k, node in enumerate(moving)]
    poles += [pole for name in one.parameters for pole in graded.poles.get(name, ())]
    if poles and one.name not in graded.not_differentiable:
        catalogue.graded = replace(graded, poles={**graded.poles, one.name: tuple(dict.fromkeys(poles))})


def _moves(catalogue: Catalogue, node: Node) -> bool:
    """Tell whether a value is the input position, or a quantity, which may change with it."""
    return node.kind == "name" and (
        node.value == catalogue.position.name or catalogue.is_quantity(node.value)
    )


def declared_step(catalogue: Catalogue, name: str, node: Node, labels: Mapping[str, Any]) -> str:
    """Declare a value as a step within the facts, and return its name; a quantity is that."""
    if node.kind == "name" and catalogue.is_quantity(node.value):
        return str(node.value)
    formula = generate_formula(name, GraphAsWritten(()), node, {})
    catalogue.declare(Fact(name, formula, formula.parameters, **labels, internal=True))
    return name


def _units_of(catalogue: Catalogue, one: OwnQuantity, name: str) -> str:
    """Return the units of a parameter, or refuse what a quantity cannot depend on."""
    if name in catalogue.variables:
        return catalogue.variables[name].units
    if name == "branch":
        return "1"
    tree = catalogue.parse(name)
    of, own, what = bounded_of(tree), Quantity(one.name), f"the parameter {name} is"
    if isinstance(of, (Reduced, ListOfExtrema)) and catalogue.is_quantity(str(of.of)):
        what += " of the whole cycle, and a quantity is of one input position"
        remedy = (
            f"take {of.of}, and ask for the extremes of {own}: {Reduced(own, 'max')}, {Reduced(own, 'mean')}"
        )
    elif isinstance(tree, (ErrorBound, Trust)) and catalogue.is_quantity(str(tree.of)):
        what += " an error bound"
        remedy = f"take {tree.of}; {ErrorBound(own)} follows by itself"
    elif name == one.name:
        what, remedy = "depends on itself", "take parameters that are declared before"
    elif not catalogue.is_quantity(name):
        what += " a step within the facts" if catalogue.declares(name) else " unknown"
        remedy = suggest(name, [*catalogue.public, *catalogue.variables])
    else:
        fact = catalogue.public_fact(name)
        try:
            catalogue.resolve(name)
        except NoDerivative as error:
            what, remedy = f"the parameter {error.what}", "take another one"
        else:
            return fact.units
    raise InputError(what, (one.name,), remedy)
