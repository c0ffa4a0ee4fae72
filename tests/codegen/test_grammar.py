"""The grammar of kernel text: what is outside is refused with its line, and what is inside means what Python means."""

import llvmlite.binding as llvm
import numpy as np
import pytest

from fastlink.codegen.kernel import load_kernel
from fastlink.codegen.source import Array, Source
from fastlink.codegen.translate import Refused, translate

HEAD = '''"""A kernel."""
import math
import numpy as np
from numpy import array
from fastlink.codegen.runtime.systems import solve_lanes
from fastlink.numerics.compiler import entries, lanes
from fastlink.numerics.elementary import atan2, select, sqrt

def kernel(a, b, n, m, out):
'''
#: Two arrays of two axes and two whole numbers, and an array of one.
ARGUMENTS = [("f", (2, None)), ("f", (0, 0)), ("i", ()), ("i", ()), ("f", (None,))]


def text_of(body):
    return HEAD + "".join(f"    {line}\n" for line in body.splitlines())


def in_lanes(*lines):
    return "\n".join(("for i in lanes(n):", *(f"    {line}" for line in lines)))


REFUSED = {
    # Arithmetic that means other things in machine code, or that nothing is made of.
    "k = n // 2": "n // 2: no such operation",
    "k = n % 2": "n % 2: no such operation",
    "k = n ** 2": "n ** 2: no such operation",
    "x = a[0, 0] ** 2": "a[0, 0] ** 2: no such operation",
    "k = ~n": "~n: numbers are negated by -, truths by not",
    "x = -(n > 0)": "numbers are negated by -, truths by not",
    "x = a[0, 0] & 1": "a[0, 0] & 1: no such operation",
    "x = a + 1.0": "a: a number is wanted",
    "k = 0 < n < 5": "0 < n < 5: no such expression",
    "k = n is None": "n is None: no such expression",
    "k = n in (1, 2)": "n in (1, 2): no such expression",
    # Entries.
    "x = a[0, -1]": "a[0, -1]: indices count from the beginning",
    "out[-1] = 1.0": "out[-1]: indices count from the beginning",
    "x = a[0, 1:2]": "1:2: no such expression",
    "x = a[0, 0.5]": "a[0, 0.5]: indices are whole numbers",
    "x = a[0, 1, 2]": "a[0, 1, 2]: an array with as many axes is wanted",
    "x = n[0]": "n[0]: an array with as many axes is wanted",
    "a[0] = 1.0": "a[0]: one number goes to one entry",
    "out[0] = 1.0, 2.0": "out[0]: one number goes to one entry",
    "x = a.T": "a.T: arrays have shape, those of one axis size",
    "x = a.size": "a.size: arrays have shape, those of one axis size",
    "x = np.nothing": "np.nothing: arrays have shape, those of one axis size",
    # Expressions and statements of Python that kernels have none of.
    "x = 'text'": "'text': no such expression",
    "x = None": "None: no such expression",
    "x = 1j": "1j: no such expression",
    "x = [1.0, 2.0]": "[1.0, 2.0]: no such expression",
    "x = [v for v in (1, 2)]": "no such expression",
    "x = lambda: 1": "lambda: 1: no such expression",
    "x = (k := n)": "(k := n): no such expression",
    "x = k = 2.0": "x = k = 2.0: no such statement",
    "x: float = 1.0": "x: float = 1.0: no such statement",
    "x, k = 1.0": "(x, k): as many values as names are needed",
    "x, k = 1.0, 2.0, 3.0": "(x, k): as many values as names are needed",
    "a.flags = 1": "a.flags: no such target",
    "del n": "del n: no such statement",
    "assert n": "assert n: no such statement",
    "import os": "import os: no such statement",
    "raise ValueError": "raise ValueError: no such statement",
    "with a: pass": "no such statement",
    "try:\n    pass\nfinally:\n    pass": "no such statement",
    "def f(): pass": "no such statement",
    "break": "break: no such statement",
    "continue": "continue: no such statement",
    # Names and their kinds.
    "x = unknown": "unknown: nothing has that name here",
    "k = 1\nk = k * 0.5": "k: its kind changes from i to f",
    "x = a[0, 0]\nx = n": "x: its kind changes from f to i",
    "x = a[0, 0] > 0.0\nx = 1\nx = n": "x: its kind changes from b to i",
    "c = a\nc = b": "c: a counter or an array keeps its name",
    "c = a\nif n > 0:\n    c = b\nout[0] = c[0, 0]": "c: a counter or an array keeps its name",
    "a = b": "a: a counter or an array keeps its name",
    "c = a\nc = 1.0": "c: a counter or an array keeps its name",
    "if n > 0:\n    c = a\nout[0] = c[0, 0]": "c: nothing has that name here",
    "x = a[0, 0] if n > 0 else n": "both values are of one kind",
    # Calls.
    "x = unknown(1.0)": "unknown(1.0): nothing has that name here",
    "x = math.sin(1.0)": "math.sin(1.0): it is none of the functions that kernels call",
    "x = np.exp(1.0)": "np.exp(1.0): it is none of the functions that kernels call",
    "x = np.zeros(3)": "np.zeros(3): it is none of the functions that kernels call",
    "x = len(a)": "len(a): nothing has that name here",
    "x = lanes(n)": "lanes(n): it is none of the functions that kernels call",
    "x = array(n)": "array(n): it is none of the functions that kernels call",
    "x = sqrt(x=1.0)": "sqrt(x=1.0): arguments stand in order",
    "x = max(1.0, 2.0, 3.0)": "max(1.0, 2.0, 3.0): it takes other arguments",
    "x = sqrt()": "sqrt(): it takes other arguments",
    "x = sqrt(a)": "sqrt(a): it takes other arguments",
    "x = atan2(1.0)": "atan2(1.0): it takes other arguments",
    "solve_lanes(a, 0)": "solve_lanes(a, 0): it takes other arguments",
    "x = a.sum()": "a.sum: arrays have shape, those of one axis size",
    # Loops over numbers.
    "for i in a:\n    pass": "a: loops run over range, lanes or entries",
    "for i in (1, 2):\n    pass": "(1, 2): loops run over range, lanes or entries",
    "for i in enumerate(a):\n    pass": "enumerate(a): loops run over range, lanes or entries",
    "for i, j in range(n):\n    pass": "no such statement",
    "for i in range(n):\n    pass\nelse:\n    pass": "no such statement",
    "while n > 0:\n    n -= 1\nelse:\n    pass": "no such statement",
    "for i in range(0, n, m):\n    pass": "range(0, n, m): the step is a number that is known",
    "for i in range(0, n, 0):\n    pass": "range(0, n, 0): the step is a number that is known",
    "for i in range(2.5):\n    pass": "range(2.5): counters run from one whole number to another",
    "for i in range():\n    pass": "range(): counters run from one whole number to another",
    "for i in lanes(n, 2):\n    out[i] = 1.0": "lanes(n, 2): counters run from one whole number to another",
    "for i in range(n):\n    i = 2": "i: a counter or an array keeps its name",
    "for n in range(3):\n    pass": "n: a counter has a name of its own",
    "for i in range(n):\n    for i in range(n):\n        pass": "i: a counter has a name of its own",
    "for i in range(n):\n    pass\nx = i": "i: nothing has that name here",
    # Lanes: each on its own, assignments alone, the counter last.
    in_lanes("out[i] = i"): "i: the counter of lanes stands as last index only",
    in_lanes("k = i"): "i: the counter of lanes stands as last index only",
    in_lanes("out[i + 1] = 1.0"): "i: the counter of lanes stands as last index only",
    in_lanes("out[i * 2] = 1.0"): "i: the counter of lanes stands as last index only",
    in_lanes("out[n - i] = 1.0"): "i: the counter of lanes stands as last index only",
    in_lanes("out[i] = a[i, 0]"): "i: the counter of lanes stands as last index only",
    in_lanes("a[i] = 1.0"): "a[i]: lanes stand along the last axis",
    in_lanes("out[0] = a[0, i]"): "out[0]: lanes go to entries side by side",
    in_lanes("out[int(a[0, i])] = 1.0"): "out[int(a[0, i])]: one number goes to one entry",
    in_lanes("out[i] = a[int(a[1, i]), i]"): "in lanes the last one only differs",
    in_lanes("break"): "break: lanes have assignments only",
    in_lanes("continue"): "continue: lanes have assignments only",
    in_lanes("return"): "return: lanes have assignments only",
    in_lanes("sqrt(1.0)"): "sqrt(1.0): lanes have assignments only",
    in_lanes("solve_lanes(a, 0, 2, n)"): "lanes have assignments only",
    in_lanes("x = solve_lanes(a, 0, 2, n)"): "lanes call no functions with loops",
    in_lanes("if a[0, i] > 0: out[i] = 1.0"): "lanes have assignments only",
    in_lanes("while n > 0: out[i] = 1.0"): "lanes have assignments only",
    in_lanes("for j in range(3): out[i] = 1.0"): "lanes have assignments only",
    in_lanes("for j in lanes(8): out[j] = 1.0"): "lanes have assignments only",
    in_lanes("x = a[0, i] > 0.0 and n > 0"): "lanes have & and |",
    in_lanes("x = a[0, i] > 0.0 or n > 0"): "lanes have & and |",
    in_lanes("x = not a[0, i] > 0.0"): "numbers are negated by -, truths by not",
    in_lanes("x = a[0, i] // 2.0"): "a[0, i] // 2.0: no such operation",
    in_lanes("x = math.sin(a[0, i])"): "it is none of the functions that kernels call",
    in_lanes("i = 2"): "i: a counter or an array keeps its name",
    in_lanes("n = 2"): "n: what lanes assign is not known outside of them",
    in_lanes("x = a[0, i]") + "\nout[0] = x": "x: nothing has that name here",
}


@pytest.mark.parametrize("body", REFUSED)
def test_what_is_outside_is_refused_with_its_line_and_text(body):
    with pytest.raises(Refused) as told:
        translate(text_of(body), ARGUMENTS, 4)
    where, _, why = str(told.value).partition(": ")
    assert REFUSED[body] in why
    name, _, line = where.partition(", line ")
    assert name == "kernel"
    # What is refused begins on that line; a tuple of names is told with parentheses.
    culprit = why.split(": ")[0].splitlines()[0].replace("(x, k)", "x, k")
    assert culprit in text_of(body).splitlines()[int(line) - 1]


def test_a_function_that_is_called_is_refused_in_its_own_lines():
    text = "\n".join(["def f(x):", "    return x % 2.0", "", *text_of("out[0] = f(1.0)").splitlines()])
    with pytest.raises(Refused, match=r"f, line 2: x % 2.0: no such operation"):
        translate(text, ARGUMENTS, 4)


MEANT = {
    "arithmetic": "out[0] = n * 3 - m\nout[1] = n / m\nout[2] = -n\nout[3] = 1.0 / a[0, 0] - a[0, 1] * 2",
    "bits": "out[0] = (n << 3) >> 1\nout[1] = n & 6\nout[2] = n | 8\nout[3] = n ^ 3\nout[4] = -n >> 1",
    "comparisons": "out[0] = a[0, 0] < a[0, 1]\nout[1] = n == m\nout[2] = n != m\nout[3] = a[0, 8] != a[0, 8]",
    "sizes": "out[0] = abs(-2.5)\nout[1] = abs(a[0, 0] - 9.0)",
    "truths": "t = n > m\nout[0] = t and m > 100\nout[1] = t or m > 100\nout[2] = not t\nout[3] = t & (m > 0)",
    "short cuts": "out[0] = n > 100 and a[n, n] > 0.0\nout[1] = n < 100 or a[n, n] > 0.0",
    "choices": "out[0] = a[0, 0] if n > m else a[0, 1]\nout[1] = a[5, 5] if n < 0 else 3.0",
    "branches": "if n > m:\n    out[0] = 1.0\nelif n == m:\n    out[0] = 2.0\nelse:\n    out[0] = 3.0",
    "loops": (
        "k = 0\nfor j in range(2, n):\n    if j == 5:\n        continue\n    if j > 8:\n        break\n    k += j\n"
        "out[0] = k\nwhile k > 3:\n    k -= 3\nout[1] = k\nfor j in range(n - 1, 2, -2):\n    out[j] = j"
    ),
    "least and greatest": "x = a[0, 8]\nout[0] = min(n, m)\nout[1] = max(1.0, x)\nout[2] = max(x, 1.0)",
    "tables": "t = array([3, 5, 7])\nu = array([0.5, 1])\nout[0] = t[m - 6]\nout[1] = u[1] + int(a[0, 2] * 9.0)",
    "shapes": "out[0] = a.shape[0] * 100 + a.shape[1]\nout[1] = out.size\nrow = a[1]\nout[2] = row[3]",
    "tuples": "x, y = a[0, 0], a[0, 1]\nx, y = y, x\nout[0] = x - 2.0 * y",
    "lanes": in_lanes(
        "x = a[0, i]", "y = sqrt(abs(x))", "out[i] = x if x > 0.5 else -y / 3.0", "out[i] += n"
    ),
    "lanes from the middle": "for i in lanes(8):\n    out[8 + i] = a[1, 8 + i] * a[0, 0]",
    "gathered lanes": in_lanes("k = int(a[1, i] * 15.0)", "out[i] = a[0, k]"),
    # Assignments of longer loops are put in order: by what they read, also of one array by two names, one row by two.
    "long loops in lanes": "c, k, m1 = a, 1, 1\n"
    + in_lanes(
        *(f"x{j} = a[{j % 2}, i] + {j}.0" for j in range(9)),
        "a[0, i] = x1 * 3.0",
        "x1 = x2 - c[0, i]",
        "c[k, i] = x1 + x0",
        "x0, x1 = x1, a[m1, i]",
        "a[m1, i] = x0",
        *(f"out[i] = x{j} - 2.0 * c[k, i]\n    out[i] += out[i] * a[0, i]" for j in range(9)),
    ),
    "entries": "for i in entries(13):\n    out[i] = a[0, i] + 1.0",
    "a NaN": "out[0] = 1.0 if a[0, 8] > 0.0 else 2.0\nout[1] = 1.0 if not a[0, 8] > 0.0 else 2.0",
}


@pytest.mark.parametrize("name", MEANT)
def test_what_is_inside_means_what_python_means(name):
    text = text_of(MEANT[name])
    # As a Source: designs and angles are the arrays, their numbers the whole numbers.
    source = Source(text, 2, 0, (), (Array("out", "float64", (None,)),))
    given = np.random.default_rng(3).uniform(0.05, 0.95, (2, 16))
    given[0, 8] = np.nan
    expected, found = np.full(16, 55.0), np.full(16, 55.0)
    namespace = {}
    exec(compile(text, "<kernel>", "exec"), namespace)
    namespace["kernel"](given.copy(), np.empty((0, 0)), 16, 7, expected)
    load_kernel(source)(given, np.empty((0, 0)), 16, 7, found)
    np.testing.assert_array_equal(found, expected)
    assert (expected != 55.0).any()


def test_bad_llvm_would_be_noticed():
    """The verifier that other tests run is on: it refuses a block without an end."""
    with pytest.raises(RuntimeError, match=r"terminator|expected instruction"):
        llvm.parse_assembly("define void @kernel(ptr %x) {\n  %y = load i64, ptr %x\n}").verify()
