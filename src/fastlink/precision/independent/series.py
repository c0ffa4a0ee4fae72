"""Truncated power series of the drive, and Newton's iteration on equations between them.

Numbers are those of a context, `MPContext` of mpmath or one with the same functions: real and complex numbers, `mpf`,
`mpc`, `sqrt`, `cos_sin`, `exp`, `atan2`. Derivatives follow from the equations themselves: no formula of a rate
stands anywhere.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import lru_cache
from math import factorial
from typing import Any

from mpmath import MPContext

__all__ = [
    "Open",
    "Series",
    "Singular",
    "closed",
    "context",
    "exponential",
    "linear_solution",
    "of_rounding",
    "rotation",
    "solved",
    "unit_vector",
]

MOST_STEPS = 12
#: Of so many roundings of its terms a value may come that vanishes, where two links are in line.
ROUNDINGS = 64
#: So many square roots of a rounding an angle may be off there.
IN_LINE = 1024


@lru_cache(maxsize=8)
def context(digits: int) -> Any:
    """Return numbers of so many digits, whatever precision others set for theirs."""
    ctx = MPContext()
    ctx.dps = digits
    return ctx


class Open(ArithmeticError):
    """The loop does not close: there is no such configuration."""


class Singular(ArithmeticError):
    """The equations do not determine the unknowns, at a toggle or where joints coincide."""


def closed(ctx: Any, value: Any, size: Any, otherwise: str) -> Any:
    """Return a value that is not negative where a loop closes: 0 where it is so but for the rounding of its terms.

    Parameters
    ----------
    ctx : context
        Of the numbers; its `eps` is 0 where numbers know their rounding themselves.
    value : number
        What is not negative.
    size : number
        The sum of the sizes of its terms.
    otherwise : str
        What is so where it is negative.

    Raises
    ------
    Open
        It is negative.
    """
    if not value < 0:
        return value
    if value < -ROUNDINGS * ctx.eps * size:
        raise Open(otherwise)
    return 0 * value


def of_rounding(ctx: Any, value: Any, size: Any) -> bool:
    """Tell whether a value may differ from 0 by rounding alone, where its terms are of a size and links in line."""
    return bool(abs(value) <= _rounding_in_line(ctx) * size)


def _rounding_in_line(ctx: Any) -> Any:
    """Return the rounding of an angle where links are in line: it is known to the root of that of its cosine."""
    return IN_LINE * ctx.sqrt(ctx.mpf(ctx.eps))


class Series:
    """A truncated power series, by its terms.

    Examples
    --------
    >>> square = Series((3.0, 1.0, 0.0)) * Series((3.0, 1.0, 0.0))
    >>> square.terms, square.derivative(2)
    ((9.0, 6.0, 1.0), 2.0)
    """

    __slots__ = ("terms",)

    def __init__(self, terms: Iterable[Any]) -> None:
        self.terms = tuple(terms)

    def derivative(self, order: int) -> Any:
        """Return a derivative where the drive is 0."""
        return self.terms[order] * factorial(order)

    def differentiated(self) -> Series:
        """Return the series of the derivative, which has one term less."""
        return Series(k * term for k, term in enumerate(self.terms[1:], 1))

    def __add__(self, other: Any) -> Series:
        if isinstance(other, Series):
            return Series([a + b for a, b in zip(self.terms, other.terms, strict=False)])
        return Series((self.terms[0] + other, *self.terms[1:]))

    __radd__ = __add__

    def __neg__(self) -> Series:
        return Series([-term for term in self.terms])

    def __sub__(self, other: Any) -> Series:
        return self.__add__(-other)

    def __rsub__(self, other: Any) -> Series:
        return self.__neg__().__add__(other)

    def __mul__(self, other: Any) -> Series:
        if not isinstance(other, Series):
            return Series([term * other for term in self.terms])
        count = min(len(self.terms), len(other.terms))
        return Series([_convolved(self.terms, other.terms, k) for k in range(count)])

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> Series:
        if not isinstance(other, Series):
            return Series(term / other for term in self.terms)
        quotient: list[Any] = []
        for k in range(min(len(self.terms), len(other.terms))):
            known = sum(quotient[i] * other.terms[k - i] for i in range(k))
            quotient.append((self.terms[k] - known) / other.terms[0])
        return Series(quotient)

    def __rtruediv__(self, other: Any) -> Series:
        one = Series((other, *(0 * term for term in self.terms[1:])))
        return one.__truediv__(self)

    def at_speed(self, rate: Any, acceleration: Any = 0) -> Series:
        """Return the series in time where the drive is rate t + acceleration t^2/2."""
        drive = Series((0 * rate, rate, acceleration / 2, 0 * rate)[: len(self.terms)])
        total = Series((self.terms[-1], *(0 * rate for _ in self.terms[1:])))
        for term in self.terms[-2::-1]:
            total = total * drive + term
        return total

    @property
    def real(self) -> Series:
        """The real part."""
        return Series(term.real for term in self.terms)

    @property
    def imag(self) -> Series:
        """The imaginary part."""
        return Series(term.imag for term in self.terms)


def _convolved(a: Sequence[Any], b: Sequence[Any], k: int) -> Any:
    total = a[0] * b[k]
    for i in range(1, k + 1):
        total += a[i] * b[k - i]
    return total


def _exponential(first: Any, exponent: Series) -> Series:
    """Return the exponential of a series from its first term, by its differential equation."""
    terms = [first]
    for k in range(1, len(exponent.terms)):
        terms.append(sum(i * exponent.terms[i] * terms[k - i] for i in range(1, k + 1)) / k)
    return Series(terms)


def exponential(ctx: Any, exponent: Series) -> Series:
    """Return e^x of a series x."""
    return _exponential(ctx.exp(exponent.terms[0]), exponent)


def rotation(ctx: Any, angle: Series) -> Series:
    """Return the direction e^(i x) of a series x, a complex number of size 1."""
    return _exponential(unit_vector(ctx, angle.terms[0]), angle * ctx.mpc(0, 1))


def unit_vector(ctx: Any, angle: Any) -> Any:
    """Return the complex number of size 1 of an angle."""
    return ctx.mpc(*ctx.cos_sin(angle))


def linear_solution(rows: Sequence[Sequence[Any]], least: Any = 0) -> list[Any]:
    """Solve a linear system by LU with partial pivoting.

    Parameters
    ----------
    rows : sequence of sequence
        The equations, each with its right-hand side last.
    least : number
        The greatest pivot that may come from rounding alone.

    Raises
    ------
    Singular
        The matrix is singular to working precision.

    Examples
    --------
    >>> linear_solution([[0.0, 2.0, 4.0], [1.0, 1.0, 5.0]])
    [3.0, 2.0]
    """
    table = [list(row) for row in rows]
    size = len(table)
    for k in range(size):
        pivot = max(range(k, size), key=lambda r: abs(table[r][k]))
        table[k], table[pivot] = table[pivot], table[k]
        if abs(table[k][k]) <= least:
            raise Singular("the matrix of the equations is singular")
        for row in table[k + 1 :]:
            if row[k] != 0:
                factor = row[k] / table[k][k]
                for c in range(k + 1, size + 1):
                    if table[k][c] != 0:
                        row[c] -= factor * table[k][c]
    unknowns: list[Any] = [None] * size
    for k in reversed(range(size)):
        known = sum(table[k][c] * unknowns[c] for c in range(k + 1, size) if table[k][c] != 0)
        unknowns[k] = (table[k][size] - known) / table[k][k]
    return unknowns


Equations = Callable[[list[Series], Series], list[Series]]


def solved(ctx: Any, equations: Equations, start: Sequence[Any], drive: Series) -> list[Series]:
    """Solve equations by Newton's iteration, and for the series of their unknowns, term by term.

    Parameters
    ----------
    ctx : context
        Of the numbers.
    equations : callable
        Returns what has to be 0, real series, of the unknowns and the drive.
    start : sequence
        The unknowns, nearly.
    drive : Series
        The input; its length is that of the results.

    Raises
    ------
    Singular
        The equations do not determine the unknowns, or the iteration does not converge.
    """
    values = list(start)
    enough = ctx.mpf(10) ** -(6 * ctx.dps // 10)
    for _ in range(MOST_STEPS):
        matrix, residuals = _linearized(equations, values, drive)
        steps = linear_solution([[*row, -r] for row, r in zip(matrix, residuals, strict=True)])
        values = [value + step for value, step in zip(values, steps, strict=True)]
        if all(abs(step) <= enough * (1 + abs(value)) for step, value in zip(steps, values, strict=True)):
            break
    else:
        raise Singular("Newton's iteration does not converge")
    unknowns = [Series((value,)) for value in values]
    least = _rounding_in_line(ctx) * max(abs(entry) for row in matrix for entry in row)
    for k in range(1, len(drive.terms)):
        guess = [Series((*x.terms, 0 * x.terms[0])) for x in unknowns]
        found = equations(guess, Series(drive.terms[: k + 1]))
        rows = [[*row, -one.terms[k]] for row, one in zip(matrix, found, strict=True)]
        further = linear_solution(rows, least)
        unknowns = [Series((*x.terms, term)) for x, term in zip(unknowns, further, strict=True)]
    return unknowns


def _linearized(
    equations: Equations, values: Sequence[Any], drive: Series
) -> tuple[list[list[Any]], list[Any]]:
    """Return the matrix of derivatives by the unknowns, and the residuals."""
    zero = 0 * drive.terms[0]
    held = Series((drive.terms[0], zero))
    columns = []
    for i in range(len(values)):
        moved = [Series((value, zero + (k == i))) for k, value in enumerate(values)]
        columns.append(equations(moved, held))
    matrix = [[column[row].terms[1] for column in columns] for row in range(len(values))]
    return matrix, [one.terms[0] for one in columns[0]]
