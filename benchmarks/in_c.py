"""A plan's kernel in C: the same text, statement by statement, for gcc to compile.

So C does the same arithmetic whatever the mechanism, and gives the same bits. Only the exact product is written as C
has it best, by a fused multiplication: the digits that it finds are the same. Not written are logarithms, which work on
the bits of a number, dense systems and refined extremes.
"""

import ast
import ctypes
import importlib
import inspect
import math
import tempfile
import textwrap
from pathlib import Path

from benchmarks import c_kernel
from fastlink.codegen.kernel import kernel_of
from fastlink.codegen.runtime.cells import LANES, MOST_LANES
from fastlink.engine.run import aligned
from fastlink.numerics.compiler import COMPILED_AS

HEADER = """#include <math.h>
#include <stdint.h>

typedef struct { double hi, lo; } pair;
#define INLINE static inline __attribute__((always_inline))

INLINE pair f_two_product(double a, double b)
{
    double p = a * b;
    return (pair){p, fma(a, b, -p)};
}
"""
#: Both make branches of choices, and gcc vectorises no branches.
FLAGS = ("-fno-tree-pre", "-fno-thread-jumps")
OPERATORS = {
    ast.Add: "+",
    ast.Sub: "-",
    ast.Mult: "*",
    ast.Div: "/",
    ast.BitAnd: "&",
    ast.BitOr: "|",
    ast.Lt: "<",
    ast.LtE: "<=",
    ast.Gt: ">",
    ast.GtE: ">=",
    ast.Eq: "==",
    ast.NotEq: "!=",
    ast.USub: "-",
}
OF_C = {"sqrt": "sqrt", "abs": "fabs", "copysign": "copysign"}
KINDS = {"float64": "double", "int64": "int64_t", "int8": "int8_t"}
#: Of whole numbers.
COUNTS = {"min": "<", "max": ">"}
LOOP = "for (long {0} = {1}; {0} < {2}; {0} += {3}) {{"


class _Function:
    """Statements of one function, in C."""

    def __init__(self, module, globals_, truths=()):
        self.module, self.globals, self.truths = module, globals_, set(truths)
        self.lines, self.scopes = [], [set()]

    def add(self, line):
        self.lines.append("    " * len(self.scopes) + line)

    # -- expressions --

    def number(self, node):
        """Return the value of an expression of numbers and constants of the module, or None."""
        try:
            value = eval(ast.unparse(node), {"__builtins__": {}}, self.globals)
        except Exception:  # whatever reads a variable
            return None
        return float(value) if isinstance(value, float) else None

    def text(self, node):
        if isinstance(node, ast.Constant):
            return repr(node.value)
        if not isinstance(node, ast.Call) and (number := self.number(node)) is not None:
            special = {"inf": "INFINITY", "-inf": "(-INFINITY)", "nan": "NAN"}
            return special.get(repr(number), f"({number!r})")
        if isinstance(node, ast.Name):
            return node.id
        if isinstance(node, ast.UnaryOp):
            return f"(-{self.text(node.operand)})"
        if isinstance(node, ast.IfExp):
            return "({} ? {} : {})".format(*map(self.text, (node.test, node.body, node.orelse)))
        if isinstance(node, ast.BinOp):
            return f"({self.text(node.left)} {OPERATORS[type(node.op)]} {self.text(node.right)})"
        if isinstance(node, ast.Compare):
            (operator,), (other,) = node.ops, node.comparators
            return f"({self.text(node.left)} {OPERATORS[type(operator)]} {self.text(other)})"
        if isinstance(node, ast.Subscript):
            return self.entry(node)
        name = node.func.attr if isinstance(node.func, ast.Attribute) else node.func.id
        values = [self.text(argument) for argument in node.args]
        if name == "select":
            # gcc vectorises no choice of truths
            choice = "(({0} & {1}) | (!{0} & {2}))" if self.is_truth(node) else "({0} ? {1} : {2})"
            return choice.format(*values)
        if name in COUNTS:
            return f"({{0}} {COUNTS[name]} {{1}} ? {{0}} : {{1}})".format(*values)
        function = OF_C.get(name) or self.module.use(self.globals[name])
        return f"{function}({', '.join(values)})"

    def entry(self, node):
        """Return an entry of an array."""
        indices = node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]
        first, *others = map(self.text, indices)
        at = first
        for length, index in zip(self.module.lengths(node.value.id), others, strict=True):
            at = f"({at}) * {length} + {index}"
        return f"{node.value.id}[{at}]"

    def is_truth(self, node):
        if isinstance(node, ast.BinOp):
            return isinstance(node.op, (ast.BitAnd, ast.BitOr))
        if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "select":
            return self.is_truth(node.args[1])
        return isinstance(node, ast.Compare) or (isinstance(node, ast.Name) and node.id in self.truths)

    # -- statements --

    def put(self, name, value, kind="double"):
        new = not any(name in scope for scope in self.scopes)
        self.scopes[-1].add(name)
        self.truths.add(name) if kind == "long" else self.truths.discard(name)
        self.add(f"{kind + ' ' if new else ''}{name} = {value};")

    def assign(self, target, value):
        if isinstance(target, ast.Tuple):
            names = [element.id for element in target.elts]
            if isinstance(value, ast.Tuple):
                for name, part in zip(names, value.elts, strict=True):
                    self.put(f"new_{name}", self.text(part))
                values = [f"new_{name}" for name in names]
            else:
                self.put(f"{names[0]}_pair", self.text(value), "pair")
                values = [f"{names[0]}_pair.hi", f"{names[0]}_pair.lo"]
            for name, part in zip(names, values, strict=True):
                self.put(name, part)
        elif isinstance(target, ast.Subscript):
            self.add(f"{self.entry(target)} = {self.text(value)};")
        else:
            is_count = isinstance(value, ast.Call) and getattr(value.func, "id", "") in COUNTS
            self.put(target.id, self.text(value), "long" if is_count or self.is_truth(value) else "double")
            if target.id == "width":
                self.add(
                    f"if (width % {MOST_LANES}) __builtin_unreachable();"
                )  # gcc writes no rest of a loop

    def branches(self, statement):
        self.add(f"if ({self.text(statement.test)}) {{")
        for body in (statement.body, statement.orelse):
            self.scopes.append(set())
            self.walk(body)
            self.scopes.pop()
            if body is statement.body:
                self.add("} else {")
        self.add("}")

    def walk(self, body):
        for statement in body:
            if isinstance(statement, ast.Assign):
                self.assign(statement.targets[0], statement.value)
            elif isinstance(statement, ast.Return):
                value = statement.value
                if isinstance(value, ast.Tuple):
                    self.add("return (pair){{{}, {}}};".format(*map(self.text, value.elts)))
                else:
                    self.add(f"return {self.text(value)};")
            elif isinstance(statement, ast.For):
                bounds = [self.text(bound) for bound in statement.iter.args]
                if len(bounds) == 1:  # lanes, entries, results of lanes
                    self.lines.append("#pragma GCC ivdep")
                    bounds = ["0", *bounds, "1"]
                self.add(LOOP.format(statement.target.id, *bounds))
                self.scopes.append({statement.target.id})
                self.walk(statement.body)
                self.scopes.pop()
                self.add("}")
            elif isinstance(statement, ast.If):
                self.branches(statement)
            elif not isinstance(statement, ast.Expr):
                raise NotImplementedError(f"in C: {ast.unparse(statement)}")


class _Module:
    """A kernel with the functions that it calls."""

    def __init__(self, program):
        self.program, self.functions = program, {}
        source = kernel_of(program).source
        self.arrays = {array.name: array for array in (*source.scratch, *source.results)}

    def lengths(self, array):
        """Return the lengths of an array but the first, as the benchmarks lay it out."""
        if array == "designs":
            return [f"((n_designs + {LANES - 1}) / {LANES} * {LANES})"]  # padded
        if array == "angles":
            return ["n_angles"]
        known = self.arrays[array].shape[1:]
        return [length if isinstance(length, int) else "n_angles" for length in known]

    def gives_pair(self, function):
        if function is None:
            return False
        last = _tree(function).body[-1].value
        again = isinstance(last, ast.Call) and isinstance(last.func, ast.Name)
        return isinstance(last, ast.Tuple) or (
            again and self.gives_pair(_globals(function).get(last.func.id))
        )

    def use(self, function):
        """Return the name of a function of the house in C; write it if this is its first use."""
        name = f"f_{function.__name__}"
        if function.__name__ != "two_product" and function not in self.functions:
            tree, globals_ = _tree(function), _globals(function)
            names = [argument.arg for argument in tree.args.args]
            tests = [
                n.args[0]
                for n in ast.walk(tree)
                if isinstance(n, ast.Call) and getattr(n.func, "id", "") == "select"
            ]
            truths = {test.id for test in tests if isinstance(test, ast.Name)}.intersection(names)
            written = _Function(self, globals_, truths)
            written.scopes[0].update(names)
            written.walk(tree.body)
            given = ", ".join(
                f"{'long' if argument in truths else 'double'} {argument}" for argument in names
            )
            kind = "pair" if self.gives_pair(function) else "double"
            self.functions[function] = "\n".join([f"INLINE {kind} {name}({given})", "{", *written.lines, "}"])
        return name

    def write(self):
        """Return the text of the C file."""
        tree = ast.parse(kernel_of(self.program).text)
        known = {"inf": math.inf, "nan": math.nan}
        for node in tree.body:
            if isinstance(node, ast.ImportFrom) and node.module != "numpy":
                found = importlib.import_module(node.module)
                known |= {alias.name: getattr(found, alias.name) for alias in node.names}
        kernel = _Function(self, known)
        kernel.walk(tree.body[-1].body)
        parameters = [
            "const double *restrict designs, const double *restrict angles",
            "long n_designs, long n_angles",
        ]
        parameters += [f"{KINDS[a.dtype]} *restrict {a.name}" for a in self.arrays.values()]
        head = f"void kernel({', '.join(parameters)})"
        return "\n\n".join([HEADER, *self.functions.values(), "\n".join([head, "{", *kernel.lines, "}"]), ""])


def _compiled(function):
    """Return the function whose text is compiled for this one."""
    return COMPILED_AS.get(function, function)


def _tree(function):
    return ast.parse(textwrap.dedent(inspect.getsource(_compiled(function)))).body[0]


def _globals(function):
    return _compiled(function).__globals__


def write(program):
    """Return a program's kernel as a C file."""
    return _Module(program).write()


def bind(bound):
    """Return a call of a bound kernel (`engine.Bound`) in C and the arrays that it fills."""
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder, "kernel.c")
        source.write_text(write(bound.program))
        kernel = c_kernel.build([source], *FLAGS).kernel
    kernel.restype = None
    inputs, arrays = bound.arguments[: -len(bound.arrays)], [aligned(a.shape, a.dtype) for a in bound.arrays]
    arguments = [
        ctypes.c_long(a) if isinstance(a, int) else a.ctypes.data_as(ctypes.c_void_p)
        for a in (*inputs, *arrays)
    ]

    def call():
        kernel(*arguments)
        return inputs, arrays  # they live as long as the call

    return call, arrays
