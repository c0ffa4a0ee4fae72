"""Vectors of the Minkowskian plane: how they are read, and differences of products that lose no digit."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from fastlink.catalogue.catalogue import Input
from fastlink.engine.broadcast import broadcast_inputs, like
from fastlink.errors import InputError, Problems
from fastlink.facts.fact import Rule
from fastlink.numerics.compensated import sum_of_four, two_product
from fastlink.plan.validate import value_problems
from fastlink.space.degrees import in_unit
from fastlink.space.values import MOST_DIMS, numbers_of

__all__ = [
    "angle_of",
    "grown",
    "length_of",
    "null_between",
    "number",
    "product_difference",
    "read",
    "same_arm",
]

#: The exponent of a product that is zero: below that of every other.
NO_EXPONENT = -10000
#: Greatest coordinate and length: sums of four stay in the range of doubles.
GREATEST = 1e300
#: Up to it e^angle and its reciprocal are ordinary doubles.
MOST_OF_EXP = 700.0


def number(name: str, meaning: str, units: str = "1", rule: Rule = "any") -> Input:
    """Return the declaration of a number beside vectors."""
    return Input(name, units, name, meaning, rule)


def read(function: str, vectors: Mapping[str, Any], numbers: Iterable[tuple[Input, Any]] = ()) -> list[Any]:
    """Return the coordinates of each vector, then the numbers, as arrays of one shape; NaN may stand among them.

    Raises
    ------
    InputError
        With every vector that has not two coordinates along its last axis, and every value that is not a number.
    """
    declared = [(number(name, "coordinates x, y of a vector", "m"), value) for name, value in vectors.items()]
    count, problems, first, second = len(declared), Problems(), {}, {}
    for k, (one, value) in enumerate((*declared, *numbers)):
        with problems.at():
            stated = numbers_of(function, one.name, value, MOST_DIMS)
            values = in_unit((function, one.name), value, stated, one.units)
            if k < count and values.shape[-1:] != (2,):
                what = f"has the shape {values.shape}" if values.ndim else "is one number"
                remedy = "write two coordinates, x and y, along the last axis, such as [5.0, 3.0]"
                raise InputError(what, where=(function, one.name), remedy=remedy)
            there = np.where(np.isnan(values), 1.0, values)
            problems.noted += value_problems(one, there, function)
            if one.units == "m" and np.isfinite(there).all() and (abs(there) > GREATEST).any():
                remedy = f"write at most {GREATEST:g}, in another unit of length"
                raise InputError(f"holds {abs(there).max()}", where=(function, one.name), remedy=remedy)
            labelled = like(value, values)
            first[one.name] = labelled[..., 0] if k < count else labelled
            if k < count:
                second[one.name] = labelled[..., 1]
    problems.stop()
    _, xs, shape = broadcast_inputs(function, first)
    _, ys, _ = broadcast_inputs(function, first | second)
    result = []
    for name in first:
        x = np.broadcast_to(xs[name], shape)
        result.append((x, np.broadcast_to(ys[name], shape)) if name in second else x)
    return result


def grown(x: Any, angle: Any) -> Any:
    """Return x e^angle, which may be a double where e^angle is not."""
    with np.errstate(over="ignore", under="ignore", invalid="ignore"):
        half = np.exp(0.5 * angle)
        product = np.where(abs(angle) < MOST_OF_EXP, x * np.exp(angle), (x * half) * half)
        return np.where(x == 0.0, 0.0 * angle, product)


def product_difference(a: Any, b: Any, c: Any, d: Any) -> tuple[Any, Any]:
    """Return v and n with a b - c d = v 2^n: right to 2 roundings, exact where it is zero, never out of range."""
    (a, i), (b, j), (c, k), (d, m) = (np.frexp(value) for value in (a, b, c, d))
    (p, p_low), (q, q_low) = two_product(a, b), two_product(c, d)
    exponents = np.where(p == 0.0, NO_EXPONENT, i + j), np.where(q == 0.0, NO_EXPONENT, k + m)
    common = np.maximum(*exponents)
    up, down = exponents[0] - common, exponents[1] - common
    p, p_low, q, q_low = np.ldexp(p, up), np.ldexp(p_low, up), np.ldexp(q, down), np.ldexp(q_low, down)
    return sum_of_four(p, p_low, -q, -q_low)[0], common


def length_of(x: Any, y: Any) -> tuple[Any, Any]:
    """Return v and n of the norm v 2^n of a vector: right to 3 roundings, however near the light cone."""
    exponent = np.frexp(np.maximum(abs(x), abs(y)))[1]
    x, y = np.ldexp(x, -exponent), np.ldexp(y, -exponent)
    return np.sqrt(abs(x - y) * abs(x + y)), exponent


def same_arm(x: Any, y: Any, u: Any, v: Any) -> Any:
    """Tell where two vectors are both spacelike or both timelike, and of one orientation."""
    spacelike = (abs(x) > abs(y)) & (abs(u) > abs(v)) & ((x > 0.0) == (u > 0.0))
    timelike = (abs(y) > abs(x)) & (abs(v) > abs(u)) & ((y > 0.0) == (v > 0.0))
    return spacelike | timelike


def angle_of(x: Any, y: Any, u: Any, v: Any) -> Any:
    """Return the oriented angle from (x, y) to (u, v): right to 12 roundings; NaN where they are not on one arm."""
    moment, exponent = product_difference(x, v, y, u)
    (one, i), (other, j) = length_of(x, y), length_of(u, v)
    alike = same_arm(x, y, u, v)
    sine = np.ldexp(moment / np.where(alike, one * other, 1.0), np.where(alike, exponent - i - j, 0))
    return np.where(alike, np.where(abs(x) > abs(y), 1.0, -1.0) * np.arcsinh(sine), np.nan)


def null_between(start: tuple[Any, Any], end: tuple[Any, Any]) -> tuple[Any, Any]:
    """Return the null coordinates x + y and x - y of the vector between two points, each to a rounding."""
    (x, y), (u, v) = start, end
    return sum_of_four(u, -x, v, -y)[0], sum_of_four(u, -x, -v, y)[0]
