"""Evaluate facts without a kernel: on floats, arrays and mpmath numbers.

The same text that the kernels are made of runs here as plain Python, so the rounding error of every quantity can be
measured without a second formula.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import lru_cache
from typing import Any

import numpy as np

from fastlink.facts.catalogue import Catalogue
from fastlink.facts.fact import Fact, System
from fastlink.numerics.elementary import context_of


def read_facts(
    catalogue: Catalogue, names: Iterable[str], values: Mapping[str, Any], variants: Iterable[str] = ()
) -> dict[str, Any]:
    """Evaluate facts on numbers of any type."""
    known = dict(values)
    position = catalogue.position.name
    if position in known:
        tables = (*catalogue.tables, *catalogue.table_low_parts)
        known |= tables_at(catalogue, known[position], [name for name in tables if name not in known])
    with np.errstate(all="ignore"):  # of a case that is not selected, or a value that says so itself
        for step in steps_of(catalogue, names, known, variants):
            evaluate_step(step, known)
    return known


def steps_of(
    catalogue: Catalogue, names: Iterable[str], given: Iterable[str], variants: Iterable[str] = ()
) -> tuple[Fact | System, ...]:
    """Return the steps of `Catalogue.dependencies`, cached."""
    return _steps(catalogue, catalogue.version, tuple(names), frozenset(given), tuple(variants))


@lru_cache(maxsize=256)
def _steps(
    catalogue: Catalogue,
    version: int,
    names: tuple[str, ...],
    given: frozenset[str],
    variants: tuple[str, ...],
) -> tuple[Fact | System, ...]:
    return tuple(catalogue.dependencies(names, given, variants))


def tables_at(catalogue: Catalogue, theta: Any, names: Iterable[str]) -> dict[str, Any]:
    """Return the tables at an input position of any type; low parts are zero.

    In mpmath they are right to all digits of its context, whatever the size of the position.
    """
    functions = {name: catalogue.tables[name].formula for name in names if name in catalogue.tables}
    context = context_of(theta)
    if hasattr(context, "workprec") and theta != 0 and context.isfinite(theta):
        # squares of small angles stand beside 1, whole turns and powers of two beside great ones
        with context.workprec(context.prec + 2 * abs(context.mag(theta))):
            tabled = {name: function(theta) for name, function in functions.items()}
        tabled = {name: +value if hasattr(value, "context") else value for name, value in tabled.items()}
    else:
        tabled = {name: function(theta) for name, function in functions.items()}
    return {name: tabled[name] if name in tabled else 0 * theta for name in names}


def evaluate_step(step: Fact | System, known: dict[str, Any]) -> None:
    """Add the values of a step to the known values."""
    if isinstance(step, System):
        rows = step.formula(*(known[name] for name in step.depends_on))
        known.update(zip(step.unknowns, _solve(rows), strict=True))
    else:
        known.update(step.values(known))


def evaluate_on_doubles(steps: Iterable[Fact | System], known: dict[str, Any]) -> None:
    """Add the values of steps to known doubles and arrays of NumPy.

    A number of Python, such as the constant of a case, becomes one of NumPy: of these a quotient by zero is infinite or
    NaN, as in arrays and in kernels, and no exception.
    """
    with np.errstate(all="ignore"):
        for step in steps:
            evaluate_step(step, known)
            for name in step.names:
                if isinstance(known[name], (float, int)):
                    known[name] = np.float64(known[name])


def stack_rows(rows: Any) -> Any:
    """Return the rows of a system, doubles or arrays of one shape, as one array with rows and columns last."""
    shape = np.broadcast_shapes(*(np.shape(entry) for row in rows for entry in row))
    stacked = np.empty((*shape, len(rows), len(rows[0])))
    for r, row in enumerate(rows):
        for c, entry in enumerate(row):
            stacked[..., r, c] = entry
    return stacked


class Singular(ZeroDivisionError):
    """The equations do not determine the unknowns, at a toggle or where joints coincide."""


def linear_solution(rows: Sequence[Sequence[Any]], least: Any = 0) -> list[Any]:
    """Solve a linear system by LU with partial pivoting.

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


def _solve(rows: Any) -> list[Any]:
    """Solve a system given as rows with the right-hand side last."""
    size = len(rows)
    context = next((c for row in rows for c in (getattr(entry, "context", None) for entry in row) if c), None)
    if context is not None:
        if any(context.isnan(entry) for row in rows for entry in row):
            return [context.nan] * size
        return linear_solution(rows)
    stacked = stack_rows(rows)
    closes = np.isfinite(stacked).all(axis=(-2, -1))
    result = np.full((*closes.shape, size), np.nan)
    result[closes] = np.linalg.solve(stacked[closes][..., :size], stacked[closes][..., size:])[..., 0]
    return [result[..., r] for r in range(size)]
