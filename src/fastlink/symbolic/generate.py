"""Make functions of expressions: Python functions whose text kernels read like that of any fact."""

from __future__ import annotations

import linecache
from collections.abc import Callable, Mapping
from itertools import count
from typing import Any

from fastlink.numerics import compensated, vectors
from fastlink.numerics.elementary import INFINITY, NOT_A_NUMBER, atan2, cosine, select, sine, sqrt
from fastlink.numerics.logarithm import arsinh, log, log1p, log_quotient
from fastlink.symbolic.expression import ExpressionGraph, Node

__all__ = ["generate_function"]

#: The names that a generated text may use.
NAMESPACE: dict[str, Any] = {
    **{name: getattr(module, name) for module in (compensated, vectors) for name in module.__all__},
    **{
        function.__name__: function
        for function in (sqrt, atan2, cosine, sine, arsinh, log, log1p, log_quotient, select)
    },
    "INFINITY": INFINITY,
    "NOT_A_NUMBER": NOT_A_NUMBER,
}
_serial = count()


def generate_function(
    name: str, graph: ExpressionGraph, root: Node, given: Mapping[Node, str]
) -> tuple[Callable[..., Any], tuple[str, ...]]:
    """Return a function that returns a value, and the names that it depends on.

    Parameters
    ----------
    name : str
        The function's name.
    graph, root
        The value, in its graph.
    given : mapping of Node to str
        Values that have a name of their own.
    """
    depends_on, lines = graph.write(root, given)
    source = "\n    ".join([f"def {name}({', '.join(depends_on)}):", *lines]) + "\n"
    file = f"<generated {name} {next(_serial)}>"
    # inspect reads the text there, and kernels read it by inspect
    linecache.cache[file] = (len(source), None, source.splitlines(keepends=True), file)
    namespace = dict(NAMESPACE)
    exec(compile(source, file, "exec"), namespace)
    return namespace[name], depends_on
