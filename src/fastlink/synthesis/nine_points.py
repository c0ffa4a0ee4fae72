"""Alt's problem: all four-bars whose coupler point passes nine points, whatever the times.

H. Alt 1923; C. W. Wampler, A. P. Morgan, A. J. Sommese, "Complete Solution of the Nine-Point Path Synthesis Problem for
Four-Bar Linkages", J. Mech. Des. 114 (1992) 153: in general 1,442 triples of cognates, of which few are real. They are
followed from a general complex instance, all of whose triples are known (`FILE`), to the points that are given. Paths
stand side by side in the lanes of a kernel.
"""

from __future__ import annotations

import ast
import re
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from fastlink.codegen.kernel import backend_of, load_kernel
from fastlink.codegen.source import Source
from fastlink.synthesis.paths import doubles, in_threads

__all__ = ["Triples", "cognates", "solutions"]

Complex = NDArray[np.complex128]
Real = NDArray[np.float64]
#: What an instance of the problem has.
TRIPLES = 1442
#: The general instance: two rows of its points and their conjugates, relative to the first, then its triples.
FILE = "nine_points.npy"

#: Paths side by side: a register of AVX-512.
WIDE = 8

# -- The system, and the text of its kernels

# One dyad at one point. All is relative to the first point, with the body as it stands there: d the point, a the fixed
# pivot, x the moving pivot, u the turn of the body since then, and a letter s where the conjugate would stand, which is
# an unknown of its own. G = 0 says, times u, that (d + x u - a) times its conjugate is (x - a) times its conjugate. The
# turns stay unknowns: with them eliminated, as usual, some tens of paths are lost by rounding.
LENGTH = """
A = d - a
B = (ds - as_) * u
C = ds - xs
S = x * B
K = d * (ds - as_) - a * C + x * as_ + S
T = xs * A
g[j, q, 5] = K * u + T
"""
# The derivatives by x, a, xs, as_, by log u, and by the place on the path.
SLOPES = """
g[j, q, 0] = (as_ + B) * u
g[j, q, 1] = -(C * u + xs)
g[j, q, 2] = a * u + A
g[j, q, 3] = (x - d - x * u) * u
g[j, q, 4] = (K + S) * u
g[j, q, 6] = dt * (B + xs) + dst * ((A + x * u) * u)
"""
#: What the formulas read.
LOADED = """
x = z[2 * q]
a = z[2 * q + 1]
xs = z[2 * q + 4]
as_ = z[2 * q + 5]
u = z[j + 8]
"""
POINTS = "\n".join(
    f"{name}t_{part} = p[{k + 4}, j]\n{name}_{part} = p[{k}, j] + t[i] * p[{k + 4}, j]"
    for k, (name, part) in enumerate((("d", "r"), ("d", "i"), ("ds", "r"), ("ds", "i")))
)

#: A value: its real and its imaginary part, or a real number alone; each one name or two, of an unevaluated sum.
Parts = tuple[tuple[str, ...], ...]


class _Expansion:
    """Formulas of complex numbers as kernel text of real ones; with `pairs`, of unevaluated sums of two.

    Entries of arrays are complex unless the index of the lane stands last. ``square`` is that of the absolute value.
    """

    def __init__(self, *, pairs: bool = False) -> None:
        self.pairs = pairs
        self.lines: list[str] = []

    def let(self, text: str) -> tuple[str, ...]:
        """Append an assignment of what a text gives, and return its names."""
        names = tuple(f"k{len(self.lines)}{low}" for low in ("", "l")[: 1 + self.pairs])
        self.lines.append(f"{', '.join(names)} = {text}")
        return names

    def add(self, a: tuple[str, ...], b: tuple[str, ...], sign: str) -> tuple[str, ...]:
        """Return the sum or difference of two real numbers."""
        if not self.pairs:
            return self.let(f"{a[0]} {sign} {b[0]}")
        high, low = self.let(f"two_sum({a[0]}, {sign.strip('+')}{b[0]})")
        return self.let(f"two_sum({high}, {low} + ({a[1]} {sign} {b[1]}))")

    def multiply(self, a: tuple[str, ...], b: tuple[str, ...]) -> tuple[str, ...]:
        """Return the product of two real numbers."""
        return self.let(f"pair_product({', '.join((*a, *b))})") if self.pairs else (f"{a[0]} * {b[0]}",)

    def value(self, node: ast.expr) -> Parts:
        """Return an expression."""
        text = ast.unparse(node)
        match node:
            case ast.Name():
                return tuple((f"{text}_{part}", f"{text}_{part}l")[: 1 + self.pairs] for part in "ri")
            case ast.Subscript():
                entry = text[:-1]
                if entry.endswith(", i"):
                    return ((text,),)
                lows = [
                    (f"{entry.replace('z', 'low')}, {part}, i]",) if self.pairs else () for part in range(2)
                ]
                return tuple((f"{entry}, {part}, i]", *low) for part, low in enumerate(lows))
            case ast.UnaryOp():
                return tuple(tuple(f"-{one}" for one in part) for part in self.value(node.operand))
            case ast.IfExp():
                arms, test = (self.value(node.body), self.value(node.orelse)), ast.unparse(node.test)
                return tuple(
                    (f"{one[0]} if {test} else {other[0]}",) for one, other in zip(*arms, strict=True)
                )
            case ast.Call(func=ast.Name("conj")):
                real, imaginary = self.value(node.args[0])
                return real, (f"-{imaginary[0]}",)
            case ast.Call(func=ast.Name("square")):
                real, imaginary = self.value(node.args[0])
                return (self.add(self.multiply(real, real), self.multiply(imaginary, imaginary), "+"),)
            case ast.BinOp(op=ast.Mult()):
                one, other = self.value(node.left), self.value(node.right)
                if len(one) == 1:
                    return tuple(self.multiply(one[0], part) for part in other)
                (a, b), (c, d) = one, other
                real = self.add(self.multiply(a, c), self.multiply(b, d), "-")
                return real, self.add(self.multiply(a, d), self.multiply(b, c), "+")
            case ast.BinOp():
                both = zip(self.value(node.left), self.value(node.right), strict=True)
                return tuple(self.add(a, b, "+" if isinstance(node.op, ast.Add) else "-") for a, b in both)
        return ((text,),)  # a real number

    def take(self, formulas: str) -> list[str]:
        """Append formulas, one in a line or parted by ;, and return all lines."""
        for line in ast.parse(formulas).body:
            assert isinstance(line, ast.Assign)
            values, targets = self.value(line.value), self.value(line.targets[0])
            for names, numbers in zip(targets, values, strict=True):
                kept = names if line.targets[0].__class__ is ast.Name else names[:1]
                self.lines += [f"{name} = {number}" for name, number in zip(kept, numbers, strict=False)]
        return self.lines


def _expanded(text: str) -> str:
    """Return kernel text with its lines of complex formulas, which begin with ~, as loops over lanes."""

    def loop(found: re.Match[str]) -> str:
        lines = _Expansion().take(found[2])
        return "\n".join([f"{found[1]}for i in lanes(8):", *(f"{found[1]}    {line}" for line in lines)])

    return re.sub(r"^( *)~ (.*)$", loop, text, flags=re.MULTILINE)


def _dyad(*, pairs: bool) -> str:
    """Return the text that evaluates a dyad at a point: its equation, with its derivatives or with twice the digits."""
    lines = POINTS.splitlines()
    if pairs:
        lines += [f"{name}_{part}l = 0.0" for name in ("d", "ds") for part in "ri"]
    expansion = _Expansion(pairs=pairs)
    lines += expansion.take(LOADED + LENGTH + ("" if pairs else SLOPES))
    return "".join(f"\n                {line}" for line in lines)


#: Functions of both kernels. z: the unknowns x a y b xs as_ ys bs u1..u8, v[5]: the place on the path, p: the points.
TEXT = """
from fastlink.numerics.compensated import pair_product, two_sum
from fastlink.numerics.compiler import lanes, outlined
from fastlink.numerics.elementary import sqrt


@outlined
def evaluate(z, t, p, g):
    for j in range(8):
        for q in range(2):
            for i in lanes(8):{slopes}


@outlined
def evaluate_again(z, low, t, p, g):
    for j in range(8):
        for q in range(2):
            for i in lanes(8):{residual}


@outlined
def combine(g, m, f, j, q, k, c):
    sign = 1.0 - 2.0 * q
    for i in lanes(8):
        f[10, i] = sign * f[c, i]
    ~ m[j, c] = m[j, c] + f[10, i] * (g[j, 1 - q, 4] * g[j, q, k])


@outlined
def eliminate(z, g, m, f):
    # of the two equations of each point, one without the turn; unknowns and equations are scaled
    for c in range(8):
        ~ f[c, i] = square(z[c])
        for i in lanes(8):
            f[c, i] = sqrt(f[c, i] + {small})
            f[8, i] = -1.0
            f[9, i] = -1.0
    for j in range(8):
        for c in range(10):
            for i in lanes(8):
                m[j, c, 0, i] = 0.0
                m[j, c, 1, i] = 0.0
        for q in range(2):
            for k in range(2):
                combine(g, m, f, j, q, k, 2 * q + k)
                combine(g, m, f, j, q, 2 + k, 4 + 2 * q + k)
                combine(g, m, f, j, q, 5 + k, 8 + k)
        for i in lanes(8):
            f[10, i] = 0.0
        for c in range(8):
            for i in lanes(8):
                f[10, i] = max(f[10, i], abs(m[j, c, 0, i]) + abs(m[j, c, 1, i]))
        for i in lanes(8):
            f[10, i] = 1.0 / f[10, i]
        for c in range(10):
            ~ m[j, c] = f[10, i] * m[j, c]


@outlined
def solve(m, f):
    # Gauss with partial pivoting, each lane on its own; two right-hand sides become the solutions
    for k in range(8):
        for r in range(k + 1, 8):
            ~ f[11, i] = square(m[r, k]) - square(m[k, k])
            for c in range(k, 10):
                ~ a = m[k, c]; m[k, c] = m[r, c] if f[11, i] > 0.0 else a; m[r, c] = a if f[11, i] > 0.0 else m[r, c]
        ~ f[11, i] = square(m[k, k])
        for i in lanes(8):
            f[11, i] = 1.0 / f[11, i]
        for c in range(k + 1, 10):
            ~ m[k, c] = f[11, i] * (conj(m[k, k]) * m[k, c])
        for r in range(k + 1, 8):
            for c in range(k + 1, 10):
                ~ m[r, c] = m[r, c] - m[r, k] * m[k, c]
    for n in range(7):
        k = 7 - n
        for r in range(k):
            for c in range(8, 10):
                ~ m[r, c] = m[r, c] - m[r, k] * m[k, c]


@outlined
def substitute(z, g, m, f, step, size):
    # steps of the unknowns by Newton (0) and by the place (1); size: the sum of their squares, relative
    for i in lanes(8):
        size[i] = 0.0
    for c in range(8):
        ~ f[10, i] = square(m[c, 8]); step[0, c] = f[c, i] * m[c, 8]; step[1, c] = f[c, i] * m[c, 9]
        for i in lanes(8):
            size[i] += f[10, i]
    for j in range(8):
        ~ f[10, i] = square(g[j, 0, 4]) + square(g[j, 1, 4])
        for i in lanes(8):
            f[10, i] = 1.0 / f[10, i]
        for k in range(2):
            for i in lanes(8):
                m[0, 1, 0, i] = 0.0
                m[0, 1, 1, i] = 0.0
            for q in range(2):
                ~ m[0, 0] = g[j, q, 5 + k]
                for c in range(4):
                    row = 2 * q + c if c < 2 else 2 + 2 * q + c
                    ~ m[0, 0] = m[0, 0] + g[j, q, c] * step[k, row]
                ~ m[0, 1] = m[0, 1] - f[10, i] * (conj(g[j, q, 4]) * m[0, 0])
            if k == 0:
                ~ f[11, i] = square(m[0, 1])
                for i in lanes(8):
                    size[i] += f[11, i]
            ~ step[k, 8 + j] = m[0, 1] * z[8 + j]


@outlined
def newton(z, p, g, m, f, step, v, size):
    evaluate(z, v[5], p, g)
    eliminate(z, g, m, f)
    solve(m, f)
    substitute(z, g, m, f, step, size)
    for k in range(16):
        ~ z[k] = z[k] + step[0, k]
"""

#: Paths from the points at place 0 to those at 1. v: 0 the place, 1 the step tried, 2 how many places are known, 3, 4
#: how far behind the earlier two are, 5 the place tried, 6 to 11 weights, 13, 14 squares of the corrections, 15 steps,
#: 16 whether it counts, 17 how it ended: 1 there, 2 not, 3 nothing to do, 18 the path.
TRACK = """

@outlined
def predict(z, past, v):
    # the polynomial of greatest degree through values and slopes at up to three places
    for i in lanes(8):
        at, first, second = v[1, i], v[3, i], v[4, i]
        two, three = v[2, i] > 1.5, v[2, i] > 2.5
        v[5, i] = v[0, i] + at
        b1, b2 = (at - first if two else 1.0), (at - second if three else 1.0)
        l0 = (b1 / -first if two else 1.0) * (b2 / -second if three else 1.0)
        l1 = at / first * (b2 / (first - second) if three else 1.0)
        l2 = at / second * (b1 / (second - first))
        s0 = (-1.0 / first if two else 0.0) - (1.0 / second if three else 0.0)
        s1 = 1.0 / first + (1.0 / (first - second) if three else 0.0)
        s2 = 1.0 / second + 1.0 / (second - first)
        v[6, i] = (1.0 - 2.0 * at * s0) * (l0 * l0)
        v[7, i] = at * (l0 * l0)
        v[8, i] = (1.0 - 2.0 * b1 * s1) * (l1 * l1) if two else 0.0
        v[9, i] = b1 * (l1 * l1) if two else 0.0
        v[10, i] = (1.0 - 2.0 * b2 * s2) * (l2 * l2) if three else 0.0
        v[11, i] = b2 * (l2 * l2) if three else 0.0
    for k in range(16):
        ~ z[k] = v[6, i] * past[0, k] + v[7, i] * past[1, k]
        ~ z[k] = z[k] + v[8, i] * past[2, k] + v[9, i] * past[3, k] + v[10, i] * past[4, k] + v[11, i] * past[5, k]


@outlined
def judge(z, past, step, v, usual):
    for i in lanes(8):
        good = (v[13, i] < {most}) & (v[14, i] < {last})
        ratio = usual / (v[13, i] + 1e-30)
        ratio = ratio if ratio == ratio else 0.0
        power = sqrt(sqrt(sqrt(ratio)))
        power = min(max(sqrt(power) if ratio > 1.0 else power, 0.25), {growth})
        power = power if good else min(power, 0.5)
        begins = v[2, i] == 0.0
        v[4, i] = v[3, i] - v[1, i] if good else v[4, i]
        v[3, i] = -v[1, i] if good else v[3, i]
        v[0, i] = v[5, i] if good else v[0, i]
        v[2, i] = min(v[2, i] + 1.0, 3.0) if good else v[2, i]
        v[15, i] += 1.0
        v[16, i] = 1.0 if good else 0.0
        at, rest = ({begin} if begins else v[1, i] * power), 1.0 - v[0, i]
        v[17, i] = 1.0 if rest == 0.0 else (2.0 if (at < {least}) | (v[15, i] > {steps}) else 0.0)
        v[1, i] = rest if at > rest else (0.5 * rest if at > 0.75 * rest else at)
    for k in range(16):
        for n in range(2):
            ~ past[4 + n, k] = past[2 + n, k] if v[16, i] > 0.0 else past[4 + n, k]
            ~ past[2 + n, k] = past[n, k] if v[16, i] > 0.0 else past[2 + n, k]
        ~ past[0, k] = z[k] if v[16, i] > 0.0 else past[0, k]
        ~ past[1, k] = step[1, k] if v[16, i] > 0.0 else past[1, k]


def kernel(starts, p, count, columns, z, past, g, m, f, step, v, ends, told):
    usual = p[8, 0]
    taken = 0
    for i in range(8):
        v[17, i] = 3.0
        v[18, i] = -1.0
    going = 1
    while going > 0:
        going = 0
        for i in range(8):
            path = int(v[18, i])
            if v[17, i] > 0.0 and path >= 0:
                told[0, path] = v[17, i]
                told[1, path] = v[15, i]
                told[2, path] = v[0, i]
                for k in range(16):
                    for part in range(2):
                        ends[2 * k + part, path] = past[0, k, part, i]
                v[18, i] = -1.0
            if v[17, i] > 0.0 and taken < count:
                for n in range(18):
                    v[n, i] = 0.0
                v[18, i] = float(taken)
                for k in range(16):
                    for part in range(2):
                        past[0, k, part, i] = starts[2 * k + part, taken]
                        for n in range(1, 6):
                            past[n, k, part, i] = 0.0
                taken += 1
            if v[18, i] >= 0.0:
                going = 1
        if going > 0:
            predict(z, past, v)
            newton(z, p, g, m, f, step, v, v[13])
            newton(z, p, g, m, f, step, v, v[14])
            judge(z, past, step, v, usual)
"""

#: Rounds of Newton at place v[5] with equations of twice the digits.
POLISH = """

def kernel(starts, p, count, columns, z, low, g, m, f, step, v, ends, told):
    for first in range(0, count, 8):
        for i in range(8):
            v[5, i] = p[8, 0]
            for k in range(16):
                for part in range(2):
                    z[k, part, i] = starts[2 * k + part, min(first + i, count - 1)]
                    low[k, part, i] = 0.0
        for n in range({rounds}):
            evaluate(z, v[5], p, g)
            evaluate_again(z, low, v[5], p, g)
            eliminate(z, g, m, f)
            solve(m, f)
            substitute(z, g, m, f, step, v[13])
            for k in range(16):
                for part in range(2):
                    for i in lanes(8):
                        a, b = two_sum(z[k, part, i], step[0, k, part, i])
                        e, h = two_sum(a, low[k, part, i] + b)
                        z[k, part, i] = e
                        low[k, part, i] = h
            for i in range(8):
                told[n, min(first + i, count - 1)] = v[13, i]
        for i in range(8):
            for k in range(16):
                for part in range(2):
                    ends[2 * k + part, min(first + i, count - 1)] = z[k, part, i]
"""

#: Of tracking: squares of the greatest relative corrections that count, the first and the second of Newton's; how
#: much steps grow; the first step, the least, and how many at most; the square of the size below which unknowns count
#: as small.
CONTROL = dict(most=1e-4, last=1e-9, growth=2.0, begin=1e-2, least=1e-13, steps=4000.0, small=1e-4)
#: The square of the first correction that the step is chosen for; smaller where two paths came to one end.
USUAL, CAREFUL = 1e-8, 1e-12
#: Up to this difference of invariants two linkages are of one triple, up to this one a triple is real: they are known
#: to some units of rounding, times what invariants multiply it by.
SAME, AS_REAL = 1e-8, 1e-9
#: Ways from the general instance to the points that are tried.
WAYS = 3
#: Rounds of Newton with residuals of twice the digits, and the square of the last correction up to which they settled.
ROUNDS, SETTLED = 6, 1e-28
#: Paths in one piece of work.
PART = 256
TOLD = {TRACK: 3, POLISH: ROUNDS}


@cache
def _source(kernel: str) -> Source:
    text = _expanded(TEXT + kernel)
    text = text.replace("{slopes}", _dyad(pairs=False)).replace("{residual}", _dyad(pairs=True))
    for name, number in (CONTROL | {"rounds": ROUNDS}).items():
        text = text.replace(f"{{{name}}}", repr(number))
    unknowns = (16, 2, WIDE)
    own: dict[str, Any] = {"past": (6, *unknowns)} if kernel == TRACK else {"low": unknowns}
    scratch = {"z": unknowns, **own, "g": (8, 2, 7, 2, WIDE), "m": (8, 10, 2, WIDE), "f": (12, WIDE),
               "step": (2, *unknowns), "v": (19, WIDE)}  # fmt: skip
    results: dict[str, Any] = {"ends": (32, None), "told": (TOLD[kernel], None)}
    return Source(text, 32, 9, doubles(scratch), doubles(results))


def _run(
    kernel: str, starts: Complex, place: Complex, change: Complex, number: float
) -> tuple[Complex, Real]:
    """Return where paths (n, 16) end, and what is told of each.

    ``place`` (2, 8) are the points and their conjugates at the start, ``change`` how they change; ``number`` is the
    square of the correction that steps are chosen for, or the place of polishing.
    """
    if not len(starts):
        return starts, np.empty((TOLD[kernel], 0))
    source = _source(kernel)
    code = load_kernel(source, backend_of(None))
    points = np.zeros((9, 8))
    points[:4], points[4:8] = (np.stack([of.real, of.imag], axis=1).reshape(4, 8) for of in (place, change))
    points[8, 0] = number
    count = len(starts)
    ends, told = np.empty((count, 16), complex), np.empty((TOLD[kernel], count))
    parts = [slice(k, None, -(-count // PART)) for k in range(-(-count // PART))]

    def work(part: slice, scratch: Any) -> None:
        given = np.ascontiguousarray(starts[part]).view(float).T.copy()
        results = np.empty_like(given), np.empty((len(told), given.shape[1]))
        code(given, points, given.shape[1], 8, *scratch, *results)
        ends[part], told[:, part] = np.ascontiguousarray(results[0].T).view(complex), results[1]

    in_threads(work, parts, source, 0)
    return ends, told


# -- Cognates, and what tells triples of them apart


@np.errstate(divide="ignore", invalid="ignore")
def cognates(unknowns: Complex, points: Complex) -> tuple[Complex, Complex]:
    """Return the two other linkages of each triple (Roberts): of points (2, 8) and their conjugates, and (n, 16)."""
    found: list[list[Complex]] = [[], []]
    for x, a, y, b in (unknowns[:, :4].T, unknowns[:, 4:8].T):
        third = (a * y - b * x) / (y - x)
        found[0] += [a - x, a, y * (a - x) / (y - x), third]
        found[1] += [b - y, b, x * (b - y) / (x - y), third]
    # the coupler of a cognate turns as a crank of the linkage
    for part, k in zip(found, (0, 2), strict=True):
        x, a = unknowns[:, k, None], unknowns[:, k + 1, None]
        part += list(((points[0] + x * unknowns[:, 8:] - a) / (x - a)).T)
    first, second = (np.stack(part, axis=1) for part in found)
    return first, second


@np.errstate(divide="ignore", invalid="ignore", over="ignore")
def _invariants(unknowns: Complex) -> Real:
    """Return numbers (n, 12) that all linkages of a triple share, by the logarithm of their size."""
    found = []
    for x, a, y, b in (unknowns[:, :4].T, unknowns[:, 4:8].T):
        third = (a * y - b * x) / (y - x)
        products = x * y + ((a - x) * y * (a - x) + (b - y) * x * (y - b)) / (y - x)
        found += [a + b + third, a * b * third, products]
    size = np.abs(found)
    turn = np.angle(found)
    return np.concatenate([np.log1p(size) * np.cos(turn), np.log1p(size) * np.sin(turn)]).T


def _first_of_triple(unknowns: Complex) -> NDArray[np.int64]:
    """Return for each linkage the first one of its triple."""
    first, known = np.arange(len(unknowns)), _invariants(unknowns)
    degenerate = ~np.isfinite(known).all(axis=1)  # a coupler without length: apart from all others
    known[degenerate] = 1e6 * (1.0 + first[degenerate, None])
    for i, j in sorted(cKDTree(known).query_pairs(SAME)):
        first[j] = min(first[j], first[i])
    return first


# -- All triples


@dataclass(frozen=True, eq=False)
class Triples:
    """Triples of cognates through nine points, complex ones too."""

    #: One linkage of each triple, (n, 16): moving and fixed pivot of either dyad relative to the first point, x a y b,
    #: the same four of the conjugate system, and how the coupler has turned at the other eight points, as e^(i theta).
    unknowns: Complex
    #: The relative correction by the last step of Newton, with equations of twice the digits.
    errors: Real
    #: Whether a triple is real.
    real: NDArray[np.bool_]
    #: Paths that did not arrive (k, 2), on the way that lost fewest, as many as triples are missing: the place where
    #: they stopped, 1 at the points, and the size of the unknowns there, by that of the points. Where the points are
    #: special, as on a line, triples go to infinity at 1, or meet.
    lost: Real


def _points(points: Complex) -> Complex:
    """Return eight points and their conjugates (2, 8) relative to the first one."""
    d = points[1:] - points[0]
    return np.array([d, d.conj()])


def _turns(unknowns: Complex, points: Complex) -> Complex:
    """Return linkages (n, 8) with their turns at points (2, 8), by elimination and then by Newton."""
    rows = []
    for k in (0, 2):
        x, a, xs, as_ = (unknowns[:, m, None] for m in (k, k + 1, k + 4, k + 5))
        d, ds = points
        rows.append(((as_ - ds) * x, (a - d) * xs, -(d * (as_ - xs) + ds * (a - x) - d * ds)))
    (p1, q1, c1), (p2, q2, c2) = rows
    turned = 1.0 + (c1 * q2 - q1 * c2) / (p1 * q2 - q1 * p2)
    return _run(POLISH, np.concatenate([unknowns, turned], axis=1), points, 0.0 * points, 0.0)[0]


@cache
def _instance() -> tuple[Complex, Complex]:
    """Return points (2, 8) of the general instance and its triples (n, 16)."""
    with files("fastlink.synthesis").joinpath(FILE).open("rb") as file:
        rows = np.load(file)
    return rows[:2], _turns(rows[2:], rows[:2])


def _follow(starts: Complex, place: Complex, goal: Complex) -> tuple[Complex, Real]:
    """Return the ends of paths (n, 16), and of each how it ended and where."""
    ends, told = _run(TRACK, starts, place, goal - place, USUAL)
    for k in range(2):
        left = told[0] != 1.0
        if left.any():
            others = cognates(starts[left], place)[k]
            ends[left], told[:, left] = _run(TRACK, others, place, goal - place, USUAL)
    arrived = np.flatnonzero(told[0] == 1.0)
    first = _first_of_triple(ends[arrived])
    twice = np.isin(first, first[first != np.arange(len(first))])
    if twice.any():
        close = arrived[twice]
        ends[close], told[:, close] = _run(TRACK, starts[close], place, goal - place, CAREFUL)
    return ends, told


def solutions(points: Complex, ways: int = WAYS) -> Triples:
    """Find all four-bars whose coupler point passes nine points, in any order and at any time.

    Parameters
    ----------
    points
        The nine points (9,) as x + iy, of any size.
    ways
        From how many starts paths are followed at most, until none is lost; one finds nearly all.

    Returns
    -------
    Triples
        1,442 of them, of points in general position.
    """
    given = _points(points)
    scale = 2.0 ** np.round(np.log2(np.abs(given).max()))
    given = given / scale
    place, starts = _instance()
    found, errors = np.empty((0, 16), complex), np.empty(0)
    lost = np.full((TRIPLES + 1, 2), np.nan)
    for way in range(ways):
        # turned and scaled, points are another instance of the same problem, with the conjugates apart from them
        factors = 2.0 * np.exp(2j * np.pi * np.random.default_rng(way).random(2))
        ends, told = _follow(starts, place, given * factors[:, None])
        arrived = told[0] == 1.0
        sizes = np.abs(ends[:, :8]).max(axis=1) / 2.0
        ends[:, :4] /= factors[0]
        ends[:, 4:8] /= factors[1]
        ends, corrections = _run(POLISH, ends[arrived], given, 0.0 * given, 0.0)
        settled = corrections[-1] < SETTLED
        before = len(found)
        found = np.concatenate([found, ends[settled]])
        errors = np.concatenate([errors, np.sqrt(corrections[-1, settled])])
        kept = _first_of_triple(found) == np.arange(len(found))
        found, errors = found[kept], errors[kept]
        arrived[np.flatnonzero(arrived)[~settled]] = False
        if len(lost) > (~arrived).sum():
            lost = np.stack([told[2], sizes], axis=1)[~arrived]
        lost = lost[: max(TRIPLES - len(found), 0)]
        if len(found) >= TRIPLES or len(found) == before:
            break
    apart = np.abs(found[:, 4:8] - found[:, :4].conj()).max(axis=1) / (1.0 + np.abs(found[:, :4]).max(axis=1))
    found[:, :8] *= scale
    return Triples(found, errors, apart < AS_REAL, lost)
