"""Split a user's text at its kinks: the values that vanish there, and the smooth texts between which it chooses."""

from __future__ import annotations

import ast
import copy
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import product

from fastlink.numerics.compiler import parsed

__all__ = ["MOST_KINKS", "Split", "only_name", "split"]

#: The most smooth texts that are searched one by one; a text with more of them is searched as it is.
MOST_PIECES = 8
#: The most kinks and magnitudes that are searched: with twice as many, a kernel takes four times as long to compile.
MOST_KINKS = 64


@dataclass(frozen=True)
class Split:
    """The texts of functions of one name, each with its parameters.

    Attributes
    ----------
    switches : tuple of str
        What vanishes at the kinks.
    pieces : tuple of str
        The smooth texts, none where they are too many; and magnitudes within, which are sharp where they almost vanish.
    too_many : bool
        Whether it has more kinks than are searched, so that none is.
    """

    switches: tuple[str, ...]
    pieces: tuple[str, ...]
    too_many: bool = False


def split(text: str, parameters: tuple[str, ...], kinked: Mapping[str, tuple[str, ...]]) -> Split | None:
    r"""Return what a text chooses between, None of a text without kinks.

    Parameters
    ----------
    text : str
        A function in the grammar of facts.
    parameters : tuple of str
        Its parameters.
    kinked : mapping
        Of parameters that have kinks themselves the names of their smooth pieces.

    Examples
    --------
    >>> found = split("def lower(x, y):\n    return choice(x != x, x, choice(x < y, x, y))", ("x", "y"), {})
    >>> found.switches
    ('def lower(x, y):\n    return x - y',)
    >>> found.pieces
    ('def lower(x, y):\n    return x', 'def lower(x, y):\n    return y')
    """
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
    r"""Return the parameter that a function returns as it is, empty where it returns something else.

    Examples
    --------
    >>> only_name("def piece(x, y):\n    a = y\n    return a"), only_name("def piece(x):\n    return x + 1.0")
    ('y', '')
    """
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
