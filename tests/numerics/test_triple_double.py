"""Sums of three doubles: their errors stay below their bounds, and tables made of them are correctly rounded."""

import math

import mpmath
import numpy as np
import pytest

from fastlink.facts import tables
from fastlink.mechanisms import NAMES, catalogue, inputs_of
from fastlink.numerics import multiple
from fastlink.numerics.elementary import sin
from fastlink.numerics.multiple import TripleDouble

TABLES = {
    (mechanism, name, table.formula): catalogue(mechanism, input).table_low_parts.values()
    for mechanism in NAMES
    for input in inputs_of(mechanism)
    for name, table in catalogue(mechanism, input).tables.items()
}
#: Each function once: mechanisms share them.
FUNCTIONS = {
    function: (f"{mechanism} {name}", name in low) for (mechanism, name, function), low in TABLES.items()
}
BEYOND = [1e5, -2e5, 3e5, 1e22, 1e300, 5e-324, 1e-310, -1e-200, 1e-90, 2.0**-300]
EDGES = np.array([0.0, -0.0, 1.0, -0.5, np.pi, 300.0, -637.0, 700.0, 710.4, 710.5, 745.0, -746.0, 760.0, 4e4])


def families(rng, n):
    """Return angles of every kind, n of the commonest."""
    signs = rng.choice([-1.0, 1.0], n)
    near = np.array([0.0, 1e-16, 1e-12, -1e-9, 3e-5])
    return {
        "anywhere": rng.uniform(-7.0, 7.0, n),
        "many turns": signs * 10.0 ** rng.uniform(0.0, 4.9, n),
        "all sizes": signs * 10.0 ** rng.uniform(-90.0, 1.0, n),
        "near eighths of a turn": np.add.outer(np.arange(-9, 9) * np.pi / 4, near).ravel(),
        "between steps": (rng.integers(-5000, 5000, n) + 0.5) * (np.pi / 4096) + 1e-15 * signs,
        "edges": EDGES,
        "beyond": np.array(BEYOND),
    }


def rounded(function, angle):
    """Return the double nearest to a function, and that nearest to the rest, from twice the digits of the fallback.

    No value is within 2^-300 of a tie but those that are exact: their rest is zero.
    """
    with mpmath.workprec(600 + 3 * abs(math.frexp(angle)[1])):
        value = function(mpmath.mpf(angle))
        return float(value), float(value - mpmath.mpf(float(value)))


def assert_correctly_rounded(function, has_low, angles):
    (found,) = tables.words([(function, has_low)], angles)
    expected = np.array([rounded(function, angle) for angle in angles.tolist()]).T
    np.testing.assert_array_equal(found[: 1 + has_low], expected[: 1 + has_low])
    return found[: 1 + has_low]


@pytest.mark.parametrize("function", FUNCTIONS, ids=[name for name, _ in FUNCTIONS.values()])
def test_tables_and_their_low_parts_are_correctly_rounded(function):
    rng = np.random.default_rng(2)
    for angles in families(rng, 60).values():
        known = assert_correctly_rounded(function, FUNCTIONS[function][1], angles)
        for k in range(0, angles.size, 7):  # one by one they take another way
            (one,) = tables.words([(function, FUNCTIONS[function][1])], angles[k : k + 1])
            np.testing.assert_array_equal(one[: len(known), 0], known[:, k])


@pytest.mark.stress
@pytest.mark.parametrize("function", FUNCTIONS, ids=[name for name, _ in FUNCTIONS.values()])
def test_tables_are_correctly_rounded_at_many_angles(function):
    rng = np.random.default_rng(3)
    for angles in families(rng, 50_000).values():
        assert_correctly_rounded(function, True, angles)


def test_tables_do_not_depend_on_company_or_order():
    rng = np.random.default_rng(4)
    angles = rng.permutation(np.concatenate([*families(rng, tables.MOST_KEPT // 3).values()]))
    assert angles.size > tables.MOST_KEPT > 2 * tables.BLOCK  # some are kept, and some are not
    pairs = [(function, True) for function in FUNCTIONS]
    together = tables.words(pairs, angles)
    for start, stop in ((0, 1), (1, 12), (12, 200), (4000, 4500)):
        alone = tables.words(pairs[::-1], angles[start:stop][::-1].copy())[::-1]
        for one, all_ in zip(alone, together, strict=True):
            np.testing.assert_array_equal(one[:, ::-1], all_[:, start:stop])


@pytest.mark.parametrize("function", FUNCTIONS, ids=[name for name, _ in FUNCTIONS.values()])
def test_almost_every_rounding_is_certain(function):
    """Bounds are 2^-122 of most values; low parts have a place of 2^-107 or, the lesser they are, less."""
    x = TripleDouble.of(np.random.default_rng(5).uniform(-7.0, 7.0, 20_000))
    with np.errstate(all="ignore"):
        _, _, sure, low_sure = function(x).doubles()
    assert np.mean(sure) > 0.99999
    assert np.mean(low_sure) > 0.998


def test_usual_angles_need_no_other_way():
    """Zero is exact, and whole numbers of quarters are as near to those of pi as doubles are."""
    for function, (name, has_low) in FUNCTIONS.items():
        for angle in (0.0, 1.0, np.pi, -np.pi, np.pi / 2, 2.0 * np.pi):
            _, _, sure, low_sure = function(TripleDouble.of(angle)).doubles()
            cancels = name.startswith("slider_crank") and angle == np.pi / 2
            assert (low_sure if has_low else sure) or cancels, (name, angle)


def exact_parts(core, x):
    """Return the exact values of what a core of three doubles computes."""
    if core is multiple.circular:
        return mpmath.cos(x), mpmath.sin(x)
    y = mpmath.mpf(x) - int(core(x)[4]) * mpmath.ln2
    return mpmath.cosh(y), mpmath.sinh(y)


@pytest.mark.parametrize("core", [multiple.circular, multiple.hyperbolic])
def test_errors_stay_below_their_bounds(core):
    rng = np.random.default_rng(6)
    for kind, angles in families(rng, 150).items():
        if kind in ("beyond", "edges"):
            continue
        angles = angles[np.abs(angles) < 4e4]
        found = core(angles)
        for k, angle in enumerate(angles.tolist()):
            with mpmath.workprec(1500):
                for i, exact in enumerate(exact_parts(core, angle)):
                    parts, bound = [x[k] for x in found[2 * i]], found[2 * i + 1][k]
                    error = abs(mpmath.fsum(map(mpmath.mpf, parts)) - exact)
                    assert error <= bound, (kind, angle)
                    # 2^-100 of the square of the rest, 2^-22.7 at most, and of a table's value over 2^-11 or more
                    assert bound <= 2.0**-110 * abs(exact), (kind, angle)


def test_nothing_is_certain_beyond_the_range():
    for angle in [1.1e5, -1e22, np.inf, -np.inf, np.nan, 2.0**-301, -5e-324]:
        for x in (angle, np.array([angle])):
            with np.errstate(all="ignore"):
                for core in (multiple.circular, multiple.hyperbolic):
                    assert not np.any(core(x)[1] < np.inf)
                    assert not np.any(core(x)[3] < np.inf)


def test_functions_without_a_rule_are_left_to_mpmath():
    def sine_of_a_sine(theta):
        return sin(sin(theta))

    for angles in (np.array([0.5]), np.linspace(-4.0, 4.0, 41)):
        assert_correctly_rounded(sine_of_a_sine, True, angles)


def test_constants_are_rounded_to_their_last_place():
    with mpmath.workprec(400):
        unit = mpmath.mpf(2) ** multiple.PLACES
        assert int(mpmath.nint(mpmath.pi / 2 * unit)) == multiple.HALF_PI
        assert int(mpmath.nint(mpmath.ln2 * unit)) == multiple.LOG_2
        for grid, step in (
            (multiple._circle(), mpmath.pi / 2 ** (multiple.HALVINGS + 1)),
            (multiple._hyperbola(), mpmath.ln2 / 2**multiple.HALVINGS),
        ):
            assert abs(mpmath.fsum(map(mpmath.mpf, grid.pieces)) - step) < mpmath.mpf(2) ** -190
            assert all(math.frexp(piece)[0] * 2.0**multiple.PIECE_BITS % 1.0 == 0.0 for piece in grid.pieces)
            for k in (0, 1, 700, 1024, 1025, 2047, 2048):
                angle = k * step if grid.sign < 0.0 else (k - multiple.STEPS // 2) * step
                exact = (
                    (mpmath.cos(angle), mpmath.sin(angle))
                    if grid.sign < 0.0
                    else (mpmath.cosh(angle), mpmath.sinh(angle))
                )
                for parts, value in zip(grid.at(float(k)), exact, strict=True):
                    assert (
                        abs(mpmath.fsum(map(mpmath.mpf, parts)) - value)
                        <= mpmath.mpf(2) ** -106 * abs(parts[1]) + mpmath.mpf(2) ** -240
                    )
