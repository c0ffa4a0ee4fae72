"""Pieces that the functions of the papers share: designs as they are read, integrals, the coupler sextic."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from fastlink._text import short_repr
from fastlink.engine.evaluate import broadcast_inputs, like
from fastlink.errors import InputError, Problems, check_whole
from fastlink.facts.catalogue import Catalogue
from fastlink.facts.fact import Input, Rule
from fastlink.numerics.compensated import UNIT_ROUNDING
from fastlink.plan.request import keywords_in_si, name_problems, value_problems
from fastlink.space.design_space import MOST_DIMS, has, in_unit, numbers_of, read_or_none
from fastlink.space.units import split

#: The inputs of planar_4r that determine a coupler curve.
CURVE = ("a1", "a2", "a3", "a4", "P_u", "P_v")
#: How the functions of planar_4r are called, for who calls them otherwise.
BY_NAME = "inputs are given by name, such as a1=0.5, or as one mapping"
#: Lengths of whole designs are at most this, links at least the other, as those of sweeps (2^80, 2^-80): no product
#: of six over a squared one overflows.
GREATEST_LENGTH, LEAST_LENGTH = 1e24, 1e-24
#: Most samples of one curve.
MOST_SAMPLES = 10**6


def read_design(
    function: str,
    catalogue: Catalogue,
    design: Any,
    inputs: Mapping[str, Any],
    needed: Iterable[str],
    *,
    optional: Iterable[str] = (),
    further: Iterable[tuple[Input, Any]] = (),
) -> dict[str, Any]:
    """Return the inputs of designs that a function needs, as arrays of one shape."""
    known, problems = catalogue.known_inputs(catalogue.variant_inputs), Problems()
    position = catalogue.position.name
    given = all_entries(function, design, inputs, known, problems, (position,))
    given = keywords_in_si(catalogue, function, given, problems, position=False)
    problems.noted += name_problems(catalogue, list(given), known, function)
    for name in needed:
        if name not in given:
            what = f"is missing ({known[name].meaning} [{known[name].units}])"
            problems.add(what, (function, name), "add it to the design")
    values = {name: given[name] for name in (*needed, *optional) if name in given}
    declared = {name: known[name] for name in values} | {one.name: one for one, _ in further}
    values |= {one.name: value for one, value in further}
    numbers = _broadcast(function, declared, values, problems)
    check_lengths(function, declared.values(), numbers.values())
    return numbers


def all_entries(
    function: str,
    design: Any,
    inputs: Mapping[str, Any],
    known: Collection[str],
    problems: Problems,
    unread: Collection[str] = (),
) -> dict[str, Any]:
    """Return what a design gives of the known names but some, and what is given by name; note what is in both."""
    entries = {} if design is None else read_or_none(_entries_of, design, known)
    if entries is None:
        remedy = "give the inputs by name, such as a1=0.5, or a mapping of them"
        raise InputError(f"is {short_repr(design)}", (function, "design"), remedy)
    given = {name: of for name, of in entries.items() if split(name, unread)[0] not in unread}
    for name in inputs:
        if name in given:
            problems.add("is in the design and given by name", (function, name), "leave one out")
    return given | dict(inputs)


def _entries_of(design: Any, known: Collection[str]) -> dict[str, Any] | None:
    """Return name and values of each input of a DataFrame, a Dataset or a mapping; None of what is none of these."""
    if has(design, "data_vars") and has(design, "variables"):
        return {name: design[name] for name in design.variables if split(name, known)[0] in known}
    if has(design, "columns") and has(design, "to_numpy"):
        return {name: design[name].to_numpy() for name in design.columns if split(name, known)[0] in known}
    if isinstance(design, Mapping) and all(isinstance(name, str) for name in design):
        return dict(design)
    return None


def number(name: str, meaning: str, units: str = "1", rule: Rule = "any") -> Input:
    """Return the declaration of a number that is no input of a mechanism."""
    return Input(name, units, name, meaning, rule)


def broadcast(function: str, declared: Iterable[Input], *numbers: Any, gaps: bool = False) -> list[Any]:
    """Return numbers as arrays of one shape."""
    named = {one.name: one for one in declared}
    values = dict(zip(named, numbers, strict=True))
    return list(_broadcast(function, named, values, Problems(), gaps=gaps).values())


def broadcast_points(function: str, x: Any, y: Any) -> list[Any]:
    """Return the coordinates of points in the last axis, among which NaN may stand, as arrays of one shape."""
    declared = (number(name, "coordinate of the points", "m") for name in "xy")
    points = broadcast(function, declared, x, y, gaps=True)
    if not points[0].ndim:
        raise InputError("is one point", (function, "x"), "write arrays of points")
    return points


def _broadcast(
    function: str,
    declared: Mapping[str, Input],
    values: Mapping[str, Any],
    problems: Problems,
    *,
    gaps: bool = False,
) -> dict[str, Any]:
    read, _ = read_numbers(function, declared, values, problems, gaps=gaps)
    _, plain, shape = broadcast_inputs(function, read)
    return {name: np.broadcast_to(value, shape) for name, value in plain.items()}


def read_numbers(
    function: str,
    declared: Mapping[str, Input],
    values: Mapping[str, Any],
    problems: Problems,
    *,
    gaps: bool = False,
    vectors: Collection[str] = (),
    greatest: float = np.inf,
) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return numbers in their declared units, of vectors x and y apart, or refuse them; gaps are NaN among them."""
    first, second = {}, {}
    for name, value in values.items():
        with problems.at():
            one, stated = declared[name], numbers_of(function, name, value, MOST_DIMS)
            numbers = in_unit((function, name), value, stated, one.units)
            if name in vectors and numbers.shape[-1:] != (2,):
                what = f"has the shape {numbers.shape}" if numbers.ndim else "is one number"
                remedy = "write two coordinates, x and y, along the last axis, such as [5.0, 3.0]"
                raise InputError(what, (function, name), remedy)
            checked = np.where(np.isnan(numbers), 1.0, numbers) if gaps else numbers
            problems.noted += value_problems(one, checked, function)
            if one.units == "m" and np.isfinite(checked).all() and (abs(checked) > greatest).any():
                remedy = f"write at most {greatest:g}, in another unit of length"
                raise InputError(f"holds {abs(checked).max()}", (function, name), remedy)
            first[name] = like(value, numbers)
            if name in vectors:
                first[name], second[name] = first[name][..., 0], first[name][..., 1]
    problems.stop()
    return first, second


def check_lengths(
    function: str,
    declared: Iterable[Input],
    values: Iterable[Any],
    products: str = "six lengths over a squared one",
) -> None:
    """Refuse lengths whose products would overflow or vanish: those beyond a greatest, links below its inverse."""
    problems, greatest = Problems(), GREATEST_LENGTH
    for one, numbers in zip(declared, values, strict=True):
        least = LEAST_LENGTH if one.rule == "positive" else -greatest
        outside = numbers[~((numbers >= least) & (numbers <= greatest))]
        if one.units == "m" and outside.size:
            unit = "in another unit of length"
            remedy = f"write {least:g} to {greatest:g}, {unit}: products of {products} are computed"
            problems.add(f"is {outside.flat[0]} ({one.meaning})", (function, one.name), remedy)
    problems.stop()


def check_samples(function: str, samples: Any, least: int = 1) -> int:
    """Return a number of samples of a curve, or refuse it."""
    return check_whole((function, "samples"), samples, least, MOST_SAMPLES)


def blocks(count: int, size: int) -> Iterator[slice]:
    """Yield the parts of a number of designs that are computed at once."""
    return (slice(start, start + size) for start in range(0, count, size))


# -- Integrate functions of many designs at once, each to its own accuracy and with its own error


# scipy.integrate has quad_vec and cubature, which refine all functions where one of them needs it, and quad, which
# takes one function of one design; kinks lie elsewhere in each design, so that the first evaluate a thousand designs
# a thousand times too often.

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(16)
#: Gauss's weights on (0, 1), and its nodes between two next to the ends: a pole or a zero may lie at the first end.
WEIGHTS, NODES = 0.5 * _WEIGHTS, np.concatenate([[1e-6], 0.5 * (_NODES + 1.0), [1.0]])
#: Takes values at Gauss's nodes to those of their polynomial at the ends.
_AT_ALL = np.polynomial.legendre.legvander(2.0 * NODES - 1.0, _NODES.size - 1)
TO_ENDS = (_AT_ALL[[0, -1]] @ np.linalg.inv(_AT_ALL[1:-1])).T
#: A panel is halved until its two halves change it by less than this part of the whole integral of magnitudes.
PANEL_TOLERANCE = 8.0 * UNIT_ROUNDING
#: Most halvings: a kink needs some 25, a layer at the end of a range as many as it is narrow.
MOST_HALVINGS = 64


def integrate(
    integrand: Callable[[Any, Any], tuple[Any, Any]], owner: Any, width: Any, layer: Any, count: int
) -> tuple[Any, Any]:
    """Return the sums of integrals from 0 over pieces of many designs, and bounds of their errors.

    Notes
    -----
    Gauss's rule of 16 nodes on a panel against the sum of its halves: they differ by the error of the former, many
    times that of the latter, which is kept. A kink between the last node and the end of a panel is seen by neither: at
    a distance d it moves the value at the end by the change s of the slope times d, the integral by s d^2/2; s is about
    the size of the values per panel. The error is the sum of these differences, of the tolerance of each panel (two
    rules may agree by chance), and of the integrated bounds of roundings.
    """
    piece = np.arange(owner.size)
    low, high = np.zeros(owner.size), width
    whole = _rule(integrand, piece, low, high)
    scale = np.bincount(owner, whole[2], count)
    value, error = np.zeros(count), np.zeros(count)
    whole_value = whole[0]
    for halving in range(MOST_HALVINGS):
        middle = 0.5 * (low + high)
        both = np.concatenate([piece, piece])
        ends = np.concatenate([low, middle]), np.concatenate([middle, high])
        halves, noise, _, kinks = _rule(integrand, both, *ends)
        total, rounding, unseen = (part.reshape(2, -1).sum(axis=0) for part in (halves, noise, kinks))
        change, of = np.abs(whole_value - total) + unseen, owner[piece]
        # A panel next to 0 that is wider than the layer there may not have seen it.
        seen = (low > 0.0) | (high <= layer[piece])
        done = (change <= np.maximum(PANEL_TOLERANCE * scale[of], rounding)) & seen
        done |= ~np.isfinite(change) | (halving == MOST_HALVINGS - 1)
        value += np.bincount(of[done], total[done], count)
        error += np.bincount(of[done], (change + rounding)[done] + PANEL_TOLERANCE * scale[of[done]], count)
        if done.all():
            break
        left = np.tile(~done, 2)
        piece, low, high, whole_value = both[left], ends[0][left], ends[1][left], halves[left]
    return value, np.where(np.isnan(value), np.nan, error)


def _rule(integrand: Any, piece: Any, low: Any, high: Any) -> tuple[Any, Any, Any, Any]:
    """Return Gauss's rule of the integrand, of its roundings and magnitudes on each panel, and what a kink may hide."""
    size = high - low
    values, noise = integrand(piece[:, None], low[:, None] + size[:, None] * NODES)
    inner, magnitude = values[:, 1:-1], np.abs(values[:, 1:-1]) @ WEIGHTS
    apart = np.abs(inner @ TO_ENDS - values[:, [0, -1]]).max(axis=1)
    kink = np.where(apart > 0.0, apart * (apart / magnitude), 0.0)
    return size * (inner @ WEIGHTS), size * (noise[:, 1:-1] @ WEIGHTS), size * magnitude, size * kink


# -- The coupler sextic over complex and double numbers, for both planes


#: Designs at once. Their coefficients stay in the cache; the powers are the first two axes, so that operations on one
#: coefficient run over all designs (ten times as fast as with powers last and all designs at once).
BLOCK = 512


def _polynomial(size: int, **terms: Any) -> Any:
    """Return coefficients (size, size, designs) of terms such as x1y2 for X Y^2."""
    result = np.zeros((size, size, next(iter(terms.values())).size))
    for powers, coefficient in terms.items():
        result[int(powers[1]), int(powers[3])] = coefficient
    return result


def _product(f: Any, g: Any) -> Any:
    """Multiply polynomials in X and Y of degree n - 1, coefficients (n, n, designs)."""
    n = f.shape[0]
    powers = [(i, j) for i in range(n) for j in range(n - i)]
    result = np.zeros((2 * n - 1, 2 * n - 1, *f.shape[2:]))
    for i, j in powers:
        for k, m in powers:
            result[i + k, j + m] += f[i, j] * g[k, m]
    return result


def coupler_sextic(jj: int, lengths: Sequence[Any], point: Sequence[Any]) -> Any:
    """Return the coefficients (..., 7, 7) of the sextic of all coupler points.

    With N(z) = z conj(z) and the W and V of `fastlink.planar.sextic` the equation is N(W) + 4 jj V^2 = 0: its
    elimination depends neither on the sign of j^2 nor on that of N(p).
    """
    shape = np.shape(lengths[0])
    columns = np.array([np.ravel(number) for number in (*lengths, *point)])
    result = np.empty((columns.shape[1], 7, 7))
    for part in blocks(len(result), BLOCK):
        result[part] = np.moveaxis(_sextics(jj, columns[:, part]), -1, 0)
    return result.reshape(*shape, 7, 7)


def _sextics(jj: int, columns: Any) -> Any:
    """Return the coefficients (7, 7, designs) of designs, one a column."""
    crank, coupler, output, ground, u, v = columns
    square = (u - v) * (u + v) if jj > 0 else u * u + v * v
    k = square - crank * crank
    middle = 2.0 * coupler * u - (crank - output) * (crank + output) - coupler * coupler - ground * ground
    along, across = u / coupler, v / coupler
    # g = ground z^2 + middle z - k ground, then W = (N(z) + k)(z - ground) - (along - j across) g.
    real = _polynomial(4, x2y0=ground, x0y2=jj * ground, x1y0=middle, x0y0=-k * ground)
    unit = _polynomial(4, x1y1=2.0 * ground, x0y1=middle)
    one = np.ones_like(ground)
    W_real = _polynomial(
        4, x3y0=one, x1y2=-jj * one, x2y0=-ground, x0y2=jj * ground, x1y0=k, x0y0=-k * ground
    )
    W_real -= along * real - jj * across * unit
    W_unit = _polynomial(4, x2y1=one, x0y3=-jj * one, x0y1=k) - (along * unit - across * real)
    V = _polynomial(4, x0y1=ground * (square / coupler - u), x2y0=-v, x0y2=jj * v, x1y0=v * ground)
    return _product(W_real, W_real) - jj * _product(W_unit, W_unit) + 4.0 * jj * _product(V, V)
