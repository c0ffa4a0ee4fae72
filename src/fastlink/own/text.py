"""Rewrite the text of a user's function in the grammar of facts, or refuse it with line, reason and remedy."""

from __future__ import annotations

import ast
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from fastlink.own.expressions import CONDITION, NUMBER, Expressions, Refused, local_name
from fastlink.own.functions import CONSTANTS, HELPERS
from fastlink.own.source import TOO_LONG, FunctionText

__all__ = ["FactText", "fact_text"]

CHOOSE = "write `a if condition else b`, or max and min"
A_LOOP = "is a loop", "write each term: only straight-line code is compiled for any number of designs"
#: What is not straight-line code, and what to write instead.
STATEMENTS: dict[type[ast.AST], tuple[str, str]] = {
    ast.If: ("branches", CHOOSE),
    ast.For: A_LOOP,
    ast.While: A_LOOP,
    ast.Match: ("branches", CHOOSE),
    ast.FunctionDef: (
        "defines a function",
        "declare it as a quantity of its own, and take that as a parameter",
    ),
    ast.ClassDef: ("defines a class", "write assignments and one return"),
    ast.Global: ("is about global names", "take a parameter, or declare an input with a default value"),
    ast.Nonlocal: ("is about outer names", "take a parameter, or declare an input with a default value"),
    ast.Import: ("imports", "import above the function"),
    ast.ImportFrom: ("imports", "import above the function"),
    ast.Assert: ("tests", "write the value where it holds, and another one else: `a if condition else b`"),
    ast.Raise: ("raises an error", CHOOSE),
    ast.Expr: ("has no effect", "leave it out"),
    ast.Pass: ("has no effect", "leave it out"),
}


@dataclass(frozen=True)
class FactText:
    """A function in the grammar of facts.

    Attributes
    ----------
    text : str
        Its text, a function of `parameters`.
    parameters : tuple of str
        The names that it depends on.
    lines : tuple of int
        The line of the user's text that each of its lines is of, from its second one.
    imports : tuple of str
        The imports by which the user's text can be run.
    jumps : bool
        Whether a condition chooses a value, which may jump there.
    """

    text: str
    parameters: tuple[str, ...]
    lines: tuple[int, ...]
    imports: tuple[str, ...]
    jumps: bool


def fact_text(of: FunctionText) -> FactText:
    """Return a function in the grammar of facts.

    Raises
    ------
    InputError
        With every line that is something else.
    """
    return _Rewriter(of).rewritten()


class _Rewriter(Expressions):
    """The statements of one function while they are rewritten."""

    def rewritten(self) -> FactText:
        """Return the function, or raise InputError with all problems."""
        body = list(self.of.tree.body)
        if body and isinstance(body[0], ast.Expr) and isinstance(getattr(body[0].value, "value", None), str):
            body = body[1:]
        *assignments, last = body or [ast.Pass(lineno=self.of.tree.lineno)]
        for statement in assignments:
            self._guard(self._statement, statement)
        if isinstance(last, ast.Return) and last.value is not None:
            self._guard(self._return, last)
        elif not self.problems.noted or isinstance(last, ast.Return):
            self.line = last.lineno
            self.note("ends without a value", "end in `return` and one number")
        self.problems.stop()
        head = f"def {self.name}({', '.join(self.parameters)}):"
        text = "\n    ".join([head, *(line for line, _ in self.written)]) + "\n"
        lines = tuple(self.of.line + line for _, line in self.written)
        return FactText(text, self.parameters, lines, tuple(sorted(self.imports)), self.jumps)

    def _guard(self, read: Callable[[Any], None], statement: ast.stmt) -> None:
        """Read a statement; what is refused is noted, and the others are read all the same."""
        self.line = statement.lineno
        try:
            read(statement)
        except Refused:
            for target in getattr(statement, "targets", [getattr(statement, "target", None)]):
                if isinstance(target, ast.Name):
                    self.kinds.setdefault(target.id, NUMBER)
        except RecursionError:
            self.note(f"has {TOO_LONG[0]}", TOO_LONG[1])

    # -- statements ----------------------------------------------------------------------------------------------

    def _statement(self, node: ast.stmt) -> None:
        if isinstance(node, ast.Assign) and all(isinstance(target, ast.Name) for target in node.targets):
            self._assign([target.id for target in node.targets if isinstance(target, ast.Name)], node.value)
        elif isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name) and node.value is not None:
            self._assign([node.target.id], node.value)
        elif isinstance(node, ast.AugAssign) and isinstance(node.target, ast.Name):
            of = ast.copy_location(ast.Name(node.target.id, ast.Load()), node)
            self._assign([node.target.id], ast.copy_location(ast.BinOp(of, node.op, node.value), node))
        elif isinstance(node, (ast.Assign, ast.AnnAssign, ast.AugAssign)):
            raise self.refuse(
                node, "assigns to more than a name", "assign one number to one name on each line"
            )
        elif isinstance(node, ast.Return):
            raise self.refuse(node, "is not the last line", f"end in one return: {CHOOSE}")
        else:
            what, remedy = STATEMENTS.get(
                type(node), ("is not straight-line code", "write assignments and one return")
            )
            raise self.refuse(node, what, remedy)

    def _assign(self, names: Sequence[str], value: ast.expr) -> None:
        for name in names:
            if name in HELPERS or name in CONSTANTS:
                raise self.refuse(
                    value, f"is called {name}, as a function or constant is", "call it otherwise"
                )
        kind = self.kind(value)
        text = self.condition(value) if kind == CONDITION else self.number(value)
        for name in names:
            self.write(f"{local_name(name, self.parameters)} = {text}")
            self.kinds[name] = kind

    def _return(self, node: ast.Return) -> None:
        assert node.value is not None
        self.write(f"return {self.number(node.value)}")
