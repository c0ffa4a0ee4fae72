"""Expressions: graphs of values that exist once; conditions, choices, and functions made of them."""

from __future__ import annotations

import ast
import math
from collections import Counter
from collections.abc import Callable, Collection, Container, Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, Generic, Self, TypeVar

from fastlink.facts.fact import Fact
from fastlink.facts.formula import NAMESPACE, Formula
from fastlink.numerics.compiler import COMPILED_AS
from fastlink.numerics.elementary import atan2, cosine, select, sine, sqrt
from fastlink.numerics.logarithm import log, log1p, log_quotient
from fastlink.numerics.vectors import absolute, magnitude

# -- Visit values after those that they are made of, in chains of any length: no recursion


T = TypeVar("T", bound=Hashable)
M = TypeVar("M")


class CircularError(Exception):
    """A value is made of itself; the arguments are the values on the way round."""


def postorder(
    roots: Iterable[T], parts: Callable[[T], Iterable[T]], done: Container[T] = frozenset()
) -> Iterator[T]:
    """Yield values that are not done, each after its parts."""
    for root in roots:
        path = {} if root in done else {root: iter(parts(root))}
        pending = [*path]
        while pending:
            value = pending[-1]
            for part in path[value]:
                if part not in done:
                    if part in path:
                        raise CircularError(*path, part)
                    path[part] = iter(parts(part))
                    pending.append(part)
                    break
            else:
                del path[pending.pop()]
                yield value


# -- Expressions: graphs of values that exist once, with folded numbers and the signs outermost

# `ExpressionGraph.read` turns a fact's text into values, `ExpressionGraph.write` values into text: a value
# that is used twice has a name.


OPERATORS: dict[str, ast.operator] = {
    "+": ast.Add(), "-": ast.Sub(), "*": ast.Mult(), "/": ast.Div(), "&": ast.BitAnd(), "|": ast.BitOr(),
}  # fmt: skip
COMPARISONS: dict[str, ast.cmpop] = {
    "<": ast.Lt(), "<=": ast.LtE(), ">": ast.Gt(), ">=": ast.GtE(), "==": ast.Eq(), "!=": ast.NotEq(),
}  # fmt: skip
SIGNS = {type(node): sign for sign, node in (*OPERATORS.items(), *COMPARISONS.items())}
#: So many operations deep an expression is written at most: Python parses and unparses by recursion.
DEEPEST = 100
#: Greater powers of two are there to keep products from underflow, smaller ones than its inverse from overflow.
FARTHEST_SCALE = 2.0**200
NOT_FINITE = {"inf": "INFINITY", "nan": "NOT_A_NUMBER"}


@dataclass(frozen=True, eq=False)
class Node:
    """A value; ``kind`` is name, number, call, tuple, item, neg or an operator."""

    kind: str
    args: tuple[Node, ...]
    value: Any = None

    @property
    def is_condition(self) -> bool:
        """Whether it is a comparison, or several."""
        return self.kind in COMPARISONS or self.kind in ("&", "|")


#: The method of `Algebra` that gives the meaning of a kind of value; `_of_other` of all others.
METHODS = {
    "name": "_of_name",
    "number": "_of_number",
    "neg": "_of_negative",
    "item": "_of_item",
    "call": "_of_call",
}
METHODS |= {"+": "_of_sum", "-": "_of_sum", "*": "_of_product", "/": "_of_quotient"}


class Algebra(Generic[M]):
    """What values mean to a reader, each from what its parts mean: readers say it by a method for each kind."""

    def __init__(self) -> None:
        self.meanings: dict[Node, M] = {}

    def of(self, root: Node) -> M:
        """Return the meaning of a value."""
        meanings, made_of = self.meanings, dict[Node, tuple[Node, ...]]()

        def parts(node: Node) -> tuple[Node, ...]:
            found = made_of[node] = self.parts(node)
            return found

        for node in postorder([root], parts, meanings):
            meanings[node] = self.rule(node, [meanings[part] for part in made_of[node]])
        return meanings[root]

    def parts(self, node: Node) -> tuple[Node, ...]:
        """Return the values by whose meanings that of a value is known."""
        return node.args

    def rule(self, node: Node, parts: Sequence[M]) -> M:
        """Return the meaning of a value from those of its parts."""
        found: M = getattr(self, METHODS.get(node.kind, "_of_other"))(node, *parts)
        return found


def beneath(
    roots: Iterable[Node], parts: Callable[[Node], Iterable[Node]] = lambda node: node.args
) -> list[Node]:
    """Return values and all that they are made of, each once and after its parts."""
    found: dict[Node, None] = {}
    for node in postorder(roots, parts, found):
        found[node] = None
    return list(found)


class ExpressionGraph:
    """Values, each of which exists once.

    `opaque` functions remain calls, as elementary ones do; the text of others is read.
    """

    def __init__(self, opaque: Iterable[Any]) -> None:
        #: By kind, value and identity of the parts.
        self.nodes: dict[tuple[Any, ...], Node] = {}
        self._opaque = {sqrt, atan2, cosine, sine, log, log1p, log_quotient, abs, *opaque}
        self.zero, self.one = self.number(0.0), self.number(1.0)

    def node(self, kind: str, *args: Node, value: Any = None) -> Node:
        """Return a value, the one that exists if there is one."""
        key = (kind, repr(value) if kind == "number" else value, *map(id, args))
        return self.nodes.setdefault(key, Node(kind, args, value))

    def name(self, name: str) -> Node:
        """Return the value of a name."""
        return self.node("name", value=name)

    def number(self, value: float) -> Node:
        """Return a number."""
        return self.node("number", value=value + 0.0)

    def part(self, node: Node, number: int) -> Node:
        """Return one value of a tuple, or of a call that returns several."""
        return node.args[number] if node.kind == "tuple" else self.node("item", node, value=number)

    def call(self, function: Any, *args: Node) -> Node:
        """Return the value of a call."""
        return self.node("call", *args, value=function)

    def neg(self, a: Node) -> Node:
        """Return -a."""
        if a.kind == "number":
            return self.number(-a.value)
        return a.args[0] if a.kind == "neg" else self.node("neg", a)

    def add(self, a: Node, b: Node) -> Node:
        """Return a + b."""
        if a.kind == b.kind == "number":
            return self.number(a.value + b.value)
        if a is self.zero or b is self.zero:
            return b if a is self.zero else a
        if a is b:
            return self.mul(self.number(2.0), a)
        if b.kind == "neg":
            return self.sub(a, b.args[0])
        return self.sub(b, a.args[0]) if a.kind == "neg" else self.node("+", a, b)

    def sub(self, a: Node, b: Node) -> Node:
        """Return a - b."""
        if a.kind == b.kind == "number":
            return self.number(a.value - b.value)
        if b is self.zero:
            return a
        if a is self.zero or a is b:
            return self.neg(b) if a is self.zero else self.zero
        if b.kind == "neg":
            return self.add(a, b.args[0])
        return self.neg(self.add(a.args[0], b)) if a.kind == "neg" else self.node("-", a, b)

    def mul(self, a: Node, b: Node) -> Node:
        """Return a b."""
        if b.kind == "number":
            a, b = b, a
        if b.kind == "number":
            return self.number(a.value * b.value)
        if a is self.zero:
            return a
        if a.kind == "number" and a.value < 0.0:
            return self.neg(self.mul(self.neg(a), b))
        if a is self.one:
            return b
        if a.kind == "neg" or b.kind == "neg":
            positive = self.mul(*(x.args[0] if x.kind == "neg" else x for x in (a, b)))
            return positive if a.kind == b.kind else self.neg(positive)
        if a.kind == "number":
            return self._multiple(a, b)
        (scale_a, a), (scale_b, b) = _scaled(a), _scaled(b)
        if scale_a * scale_b != 1.0:
            return self.mul(self.number(scale_a * scale_b), self.mul(a, b))
        return self.node("*", a, b)

    def _multiple(self, a: Node, b: Node) -> Node:
        """Return the product with a number: powers of two are exact, so they go outermost."""
        scale, rest = _scaled(b)
        if scale != 1.0:
            return self.mul(self.number(a.value * scale), rest)
        if b.kind in ("+", "-") and is_power_of_two(a.value) and all(_scaled(x)[0] != 1.0 for x in b.args):
            return self.operation(b.kind, *(self.mul(a, x) for x in b.args))
        return self.node("*", a, b)

    def div(self, a: Node, b: Node) -> Node:
        """Return a/b."""
        if a is self.zero or b is self.one:
            return a
        if a.kind == b.kind == "number" and b is not self.zero:
            return self.number(a.value / b.value)
        if a.kind == "neg" or b.kind == "neg":
            positive = self.div(*(x.args[0] if x.kind == "neg" else x for x in (a, b)))
            return positive if a.kind == b.kind else self.neg(positive)
        (scale_a, a), (scale_b, b) = _scaled(a), _scaled(b)
        if scale_a != scale_b:
            return self.mul(self.number(scale_a / scale_b), self.div(a, b))
        return self.node("/", a, b)

    def select(self, condition: Node, a: Node, b: Node) -> Node:
        """Return a where the condition holds, else b."""
        return a if a is b else self.call(select, condition, a, b)

    # -- reading ---------------------------------------------------------------------------------

    def read(self, function: Callable[..., Any], args: Sequence[Node]) -> Node:
        """Return the value of a straight-line function for these arguments, or refuse what is none."""
        formula = Formula.of(function)
        known = dict(zip(formula.parameters, args, strict=True))
        *assignments, last = formula.statements

        def value(node: ast.expr) -> Node:
            match node:
                case ast.Name(id=name) if name in known:
                    return known[name]
                case ast.Name(id=name) if isinstance(number := formula.names.get(name), int | float):
                    return self.number(number)
                case ast.Constant(value=int() | float() as number) if not isinstance(number, bool):
                    return self.number(number)
                case ast.UnaryOp(op=ast.USub()):
                    return self.neg(value(node.operand))
                case ast.BinOp(op=sign) if type(sign) in SIGNS:
                    return self.operation(SIGNS[type(sign)], value(node.left), value(node.right))
                case ast.Compare(ops=[sign]) if type(sign) in SIGNS:
                    return self.node(SIGNS[type(sign)], value(node.left), value(node.comparators[0]))
                case ast.Tuple():
                    return self.node("tuple", *map(value, node.elts))
                case ast.Call(func=ast.Name(id=name), keywords=[]) if name not in known:
                    helper = abs if name == "abs" else formula.names.get(name)
                    if callable(helper):
                        return self.apply(helper, [*map(value, node.args)])
            raise formula.refused(statement, node, known)

        def bind(target: ast.expr, bound: Node) -> None:
            match target:
                case ast.Name():
                    known[target.id] = bound
                case ast.Tuple():
                    for k, part in enumerate(target.elts):
                        bind(part, self.part(bound, k))
                case _:
                    raise formula.refused(statement, target, known)

        for statement in assignments:
            if not isinstance(statement, ast.Assign):
                raise formula.refused(statement, statement, known)
            for target in statement.targets:
                bind(target, value(statement.value))
        statement = last
        return value(formula.result)

    def operation(self, sign: str, a: Node, b: Node) -> Node:
        """Return the value of an operation with two arguments."""
        operator = {"+": self.add, "-": self.sub, "*": self.mul, "/": self.div}.get(sign)
        return operator(a, b) if operator is not None else self.node(sign, a, b)

    def apply(self, function: Any, args: Sequence[Node]) -> Node:
        """Return the value of a call; a function without a rule of its own is read."""
        if function is select:
            return self.select(*args)
        if function in self._opaque:
            return self.call(function, *args)
        return self.read(COMPILED_AS.get(function, function), args)

    def read_fact(self, fact: Fact, name: str) -> Node:
        """Return one of the values of a fact as an expression in names."""
        value = self.read(fact.formula, [self.name(part) for part in fact.depends_on])
        return value if fact.low is None else self.part(value, fact.names.index(name))

    # -- writing ---------------------------------------------------------------------------------

    def write(
        self, root: Node, given: Mapping[Node, str], assigned: Collection[Node] = ()
    ) -> tuple[tuple[str, ...], list[tuple[Node, str]]]:
        """Return the names in an expression, and the values and lines of a function that returns it.

        `given` are values that have a name of their own; those that are `assigned` have a line in any case.
        """
        nodes = beneath([*assigned, root], lambda node: () if node in given else node.args)
        order = {node: () if node in given else node.args for node in nodes}
        uses = Counter(part for parts in order.values() for part in parts)
        depends_on = {
            given.get(node, node.value): None for node in order if node in given or node.kind == "name"
        }
        pairs = {parts[0] for node, parts in order.items() if parts and node.kind == "item"}
        written: dict[Node, ast.expr] = {}
        depths: dict[Node, int] = {}
        lines: list[tuple[Node, str]] = []
        for node, parts in order.items():
            text = ast.Name(given[node]) if node in given else _expression(node, [written[a] for a in parts])
            short = node in given or node.kind in ("name", "number", "item")
            depths[node] = 0 if short else 1 + max((depths[a] for a in parts), default=0)
            repeated = uses[node] > 1 or depths[node] == DEEPEST or node in assigned
            if node in pairs or (repeated and not short):
                depths[node] = 0
                local = f"_{len(lines)}"
                target = f"{local}_0, {local}_1" if node in pairs else local
                lines.append((node, f"{target} = {ast.unparse(text)}"))
                text = ast.Name(local)
            written[node] = text
        return tuple(depends_on), [*lines, (root, f"return {ast.unparse(written[root])}")]


class GraphAsWritten(ExpressionGraph):
    """Values of operations as they are written, so that they have the same bits: nothing is folded."""

    def neg(self, a: Node) -> Node:
        """Return -a."""
        return self.node("neg", a)

    def operation(self, sign: str, a: Node, b: Node) -> Node:
        """Return the value of an operation with two arguments."""
        return self.node(sign, a, b)


def _expression(node: Node, args: Sequence[ast.expr]) -> ast.expr:
    """Return a value as text over the texts of its arguments."""
    match node.kind:
        case "name":
            return ast.Name(node.value)
        case "number":
            finite = math.isfinite(node.value)
            return ast.Constant(node.value) if finite else ast.Name(NOT_FINITE[str(node.value)])
        case "neg":
            return ast.UnaryOp(ast.USub(), args[0])
        case "call":
            return ast.Call(ast.Name(node.value.__name__), list(args), [])
        case "item":
            assert isinstance(args[0], ast.Name)
            return ast.Name(f"{args[0].id}_{node.value}")
        case sign if sign in OPERATORS:
            return ast.BinOp(args[0], OPERATORS[sign], args[1])
        case sign:
            return ast.Compare(args[0], [COMPARISONS[sign]], [args[1]])


def _scaled(x: Node) -> tuple[float, Node]:
    """Return a power of two that a value is a multiple of, and of what; a far one stays where it is."""
    if x.kind == "*" and x.args[0].kind == "number" and is_power_of_two(x.args[0].value):
        scale = abs(x.args[0].value)
        if 1.0 / FARTHEST_SCALE <= scale <= FARTHEST_SCALE:
            return x.args[0].value, x.args[1]
    return 1.0, x


def winding(nodes: Iterable[Node], known: Callable[[str], Mapping[str, float]]) -> dict[str, float]:
    """Return by how many turns the last of values changes where each angle that it is made of goes through one.

    An angle jumps there, and so does what reads it as a number. The sine of a whole number of turns does not; NaN
    stands for any other change. `nodes` are in order; `known` tells of a name what is known of it.
    """
    found: dict[Node, dict[str, float]] = {}
    for node in nodes:
        parts = [found[part] for part in node.args]
        angles = dict.fromkeys(angle for part in parts for angle in part)
        factor = math.nan
        match node.kind:
            case "name":
                turns = dict(known(node.value))
            case "neg" | "+" | "-":
                signs = {"neg": (-1.0,), "+": (1.0, 1.0), "-": (1.0, -1.0)}[node.kind]
                turns = {
                    angle: sum(sign * part.get(angle, 0.0) for sign, part in zip(signs, parts, strict=True))
                    for angle in angles
                }
            case "call" if node.value in (sine, cosine):
                turns = {angle: math.nan for angle in angles if parts[0][angle] % 1.0 != 0.0}
            case _:
                if node.kind == "*" and "number" in (kinds := [part.kind for part in node.args]):
                    factor = node.args[kinds.index("number")].value
                elif node.kind == "/" and node.args[1].kind == "number":
                    factor = 1.0 / node.args[1].value if node.args[1].value else math.nan
                turns = {angle: factor * sum(part.get(angle, 0.0) for part in parts) for angle in angles}
        found[node] = {angle: count for angle, count in turns.items() if count != 0.0}
    return found[node]


def divisors(nodes: Iterable[Node]) -> list[Node]:
    """Return the values of which one vanishes where one of some values is divided by zero."""
    return list(dict.fromkeys(zero for node in nodes if node.kind == "/" for zero in _zeros(node.args[1])))


def _zeros(node: Node) -> list[Node]:
    """Return the values of which one vanishes where a value does: factors, and what a size or a root is of."""
    match node.kind:
        case "*":
            return [zero for part in node.args for zero in _zeros(part)]
        case "neg" | "/":
            return _zeros(node.args[0])
        case "call" if node.value in (sqrt, absolute):
            return _zeros(node.args[0])
        case "call" if node.value is magnitude:
            return []  # it vanishes where two values do, at no position of most designs
    return [node]


def is_power_of_two(x: float) -> bool:
    """Tell whether a number is a power of two, so that products with it are exact."""
    return math.frexp(abs(x))[0] == 0.5


# -- Numbers without a value, of which something else is known: formulas run on them as on doubles


class Condition:
    """The result of a comparison, which counts as met; `choose` returns what is known of either value.

    Of several comparisons that of the least `rank` tells what is known of all.
    """

    def __init__(self, choose: Callable[[Any, Any], Any], rank: int = 0) -> None:
        self.choose, self.rank = choose, rank

    def __and__(self, other: Any) -> Condition:
        return other if isinstance(other, Condition) and other.rank < self.rank else self

    __rand__ = __or__ = __ror__ = __and__

    def __bool__(self) -> bool:
        """Satisfy `sqrt` of `fastlink.numerics.elementary`, which tests the sign of its argument."""
        return True


class Valueless:
    """What a subclass knows of sums (`plus`), products (`times` a power, 1 or -1) and comparisons (`compared`)."""

    #: The elementary functions of such numbers are methods of theirs.
    context = property(type)
    nan, inf = math.nan, math.inf
    plus: Callable[..., Any]
    times: Callable[..., Any]
    compared: Callable[..., Any]

    @classmethod
    def of(cls, value: Any) -> Any:
        """Return what is known of any number."""
        return value if isinstance(value, cls) else cls()

    def __add__(self, other: Any) -> Any:
        return self.plus(other)

    __radd__ = __sub__ = __rsub__ = __add__

    def __mul__(self, other: Any) -> Any:
        return 0.0 if isinstance(other, float) and other == 0.0 else self.times(other, 1)

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> Any:
        return self.times(other, -1)

    def __rtruediv__(self, other: Any) -> Any:
        return 0.0 if isinstance(other, float) and other == 0.0 else self.of(other).times(self, -1)

    def __neg__(self) -> Self:
        return self

    def __abs__(self) -> Self:
        return self

    def __lt__(self, other: Any) -> Any:
        return self.compared(other)

    __le__ = __gt__ = __ge__ = __eq__ = __ne__ = __lt__
    __hash__ = None  # type: ignore[assignment]


# -- Formulas made of expressions, and expressions of formulas


@lru_cache(maxsize=2048)
def value_of(formula: Formula) -> Node:
    """Return what a formula returns in names of its parameters, as it is written: each function remains a call."""
    graph = GraphAsWritten(filter(callable, NAMESPACE.values()))
    return graph.read(formula, [*map(graph.name, formula.parameters)])


def generate_formula(name: str, graph: ExpressionGraph, root: Node, given: Mapping[Node, str]) -> Formula:
    """Return a formula that returns a value; its parameters are the names that it depends on."""
    depends_on, lines = graph.write(root, given)
    return Formula(name, depends_on, [line for _, line in lines])
