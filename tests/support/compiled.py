"""Functions of `fastlink.numerics` as kernels compile them, by both compilers."""

import ast

import numpy as np
from numpy.testing import assert_array_equal

from fastlink.codegen.kernel import BACKENDS, llvm_text, load_kernel
from fastlink.codegen.runtime.cells import MOST_LANES
from fastlink.codegen.source import Array, Source

ARGUMENTS = "abcdef"
TEXT = """
from {module} import {names}
from fastlink.numerics.compiler import lanes

def kernel(designs, angles, n_designs, n_angles, {results}):
    for i in lanes(n_designs):
{body}
"""


class Compiled:
    """Expressions of columns a, b, c ... in which functions of a module are called, compiled twice."""

    def __init__(self, module, *expressions):
        trees = [ast.walk(ast.parse(expression)) for expression in expressions]
        used = {node.id for tree in trees for node in tree if isinstance(node, ast.Name)}
        self.arguments = sorted(used & set(ARGUMENTS))
        results = tuple(Array(f"out_{k}", "float64", (None,)) for k in range(len(expressions)))
        lines = [f"{name} = designs[{k}, i]" for k, name in enumerate(self.arguments)]
        lines += [f"out_{k}[i] = {expression}" for k, expression in enumerate(expressions)]
        text = TEXT.format(
            module=module.__name__,
            names=", ".join(sorted(used - set(ARGUMENTS))),
            results=", ".join(result.name for result in results),
            body="\n".join(f"        {line}" for line in lines),
        )
        self.source = Source(text, len(self.arguments), 0, (), results)

    def llvm(self):
        return llvm_text(self.source)

    def __call__(self, *columns):
        """Return the values in order, after a look whether both compilers give the same bits."""
        size = columns[0].size
        width = -(-size // MOST_LANES) * MOST_LANES
        designs = np.ones((len(columns), width))
        designs[:, :size] = columns
        first, *others = (self._by(backend, designs, width) for backend in BACKENDS)
        for other in others:
            assert_same_bits(first, other)
        return tuple(values[:size] for values in first) if len(first) > 1 else first[0][:size]

    def _by(self, backend, designs, width):
        found = [np.full(width, 0.5) for _ in self.source.results]
        load_kernel(self.source, backend)(designs, np.empty((0, 0)), width, 0, *found)
        return found


def assert_same_bits(found, expected):
    """Compare arrays bit by bit; the sign and the payload of a NaN are not part of a result."""
    for one, other in zip(found, expected, strict=True):
        assert_array_equal(one, other)  # NaN equals NaN here, and 0 equals -0
        if one.dtype == np.float64:
            known = ~np.isnan(one)
            assert_array_equal(np.signbit(one[known]), np.signbit(other[known]))
