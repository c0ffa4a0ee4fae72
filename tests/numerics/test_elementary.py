"""Elementary functions and sums: compiled and plain, against mpmath and IEEE 754."""

import gc
import itertools
import math
import re
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from fractions import Fraction
from pathlib import Path

import mpmath as mp
import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from tests.support.compiled import Compiled

import fastlink
from fastlink.facts import tables
from fastlink.facts.bounds import WORDS
from fastlink.mechanisms import NAMES, catalogue, inputs_of
from fastlink.numerics import compensated, elementary, logarithm, multiple
from fastlink.numerics.compensated import UNIT_ROUNDING
from fastlink.numerics.compiler import parsed
from fastlink.numerics.elementary import sin
from fastlink.numerics.multiple import TripleDouble
from fastlink.precision.reference import CONTEXT

ATAN2 = Compiled(elementary, "atan2(a, b)")
DIRECTION = Compiled(elementary, "cosine(a)", "sine(a)")


def both_readings(y, x):
    compiled = ATAN2(y, x)
    with np.errstate(all="ignore"):
        plain = elementary.atan2(y, x)
    assert_array_equal(compiled.view(np.int64), plain.view(np.int64))
    return compiled


def test_atan2_is_within_two_units_in_the_last_place_in_all_quadrants():
    rng = np.random.default_rng(1)
    angle = rng.uniform(-np.pi, np.pi, 6000)
    # The first third anywhere, the second near the axes and diagonals, the third over all exponents.
    angle[2000:4000] = np.round(angle[2000:4000] / (np.pi / 4)) * (np.pi / 4) + rng.normal(0, 1e-3, 2000)
    radius = np.exp(rng.uniform(-5, 5, 6000))
    radius[4000:] = np.exp(rng.uniform(-600, 600, 2000))
    y, x = radius * np.sin(angle), radius * np.cos(angle)
    got = both_readings(y, x)
    with mp.workdps(40):
        for a, b, value in zip(y, x, got, strict=True):
            exact = mp.atan2(mp.mpf(float(a)), mp.mpf(float(b)))
            assert abs(mp.mpf(float(value)) - exact) <= 2 * np.spacing(abs(float(exact)))


def test_atan2_has_signed_zeros_and_infinities_as_ieee():
    special = [0.0, -0.0, 1.0, -1.0, np.inf, -np.inf, 5e-324, -1e-310, 1e308, -1.7e308]
    y, x = (np.array(column) for column in zip(*itertools.product(special, special), strict=True))
    got, expected = both_readings(y, x), np.arctan2(y, x)
    assert_array_equal(np.signbit(got), np.signbit(expected))
    # 2 units of ours and 1 of the library's.
    assert np.all((np.abs(got - expected) <= 3 * np.spacing(np.abs(expected))) | (got == expected))
    exact = np.isin(expected, [0.0, np.pi, -np.pi, np.pi / 2, -np.pi / 2])
    assert_array_equal(got[exact], expected[exact])


@pytest.mark.parametrize(("y", "x"), [(np.nan, 1.0), (1.0, np.nan), (np.nan, np.nan), (np.nan, -0.0)])
def test_atan2_keeps_nan(y, x):
    assert np.isnan(both_readings(np.array([y]), np.array([x]))[0])


def test_roots_logarithms_and_powers_of_two_are_read_alike():
    assert mp.isnan(elementary.sqrt(mp.mpf(-1)))
    with np.errstate(invalid="ignore"):
        assert np.isnan(elementary.sqrt(-1.0))
    for function, edge in ((logarithm.log, 0), (logarithm.log1p, -1)):
        assert function(mp.mpf(edge)) == -mp.inf
        assert mp.isnan(function(mp.mpf(edge) - 1))
    for x in [1.0, 1.5, 1.9999999999999998, 2.0, 3e-150, 7e150, 0.4]:
        assert compensated.power_of_two_below(x) == 2.0 ** np.floor(np.log2(x))
    rng = np.random.default_rng(3)
    for a, b in rng.normal(size=(300, 2)) * np.exp(rng.uniform(-100, 100, (300, 1))):
        p, e = compensated.two_product(float(a), float(b))
        with mp.workdps(60):
            assert mp.mpf(p) + mp.mpf(e) == mp.mpf(float(a)) * mp.mpf(float(b))


def test_cosine_and_sine_are_within_two_units_in_the_last_place_and_one_text():
    rng = np.random.default_rng(4)
    x = np.concatenate(
        [rng.uniform(-7, 7, 3000), np.arange(-32, 33) * (np.pi / 4), rng.uniform(-1e6, 1e6, 500)]
    )
    beyond = np.array([1.1e6, np.inf, -np.inf, np.nan])
    cosines, sines = DIRECTION(np.append(x, beyond))
    assert np.isnan([*cosines[-4:], *sines[-4:]]).all()
    assert_array_equal(cosines[:-4], elementary.cosine(x))
    assert_array_equal(sines[:-4], elementary.sine(x))
    with mp.workdps(40):
        for angle, c, s in zip(x, cosines, sines, strict=False):
            exact = mp.mpf(float(angle))
            # Near a zero the last part of pi/2, of 2^-101 pi, bounds the error: far below a rounding of 1e-16.
            assert abs(mp.mpf(float(c)) - mp.cos(exact)) <= 2 * np.spacing(abs(c) + 1e-16)
            assert abs(mp.mpf(float(s)) - mp.sin(exact)) <= 2 * np.spacing(abs(s) + 1e-16)


# == Logarithms: compiled and plain, against mpmath and IEEE 754, and as facts differentiate them ============

FUNCTIONS = {"log": mp.log, "log1p": mp.log1p, "arsinh": mp.asinh}
SPECIAL = np.array([0.0, -0.0, 1.0, np.inf, -np.inf, np.nan, -1.0, -2.0, 5e-324, 2.2e-308, 1.7e308])


COMPILED = Compiled(logarithm, *(f"{name}(a)" for name in FUNCTIONS))
QUOTIENTS = Compiled(logarithm, "log_quotient(a, b, c)", "quotient_sign(a, b)")


def both_log_readings(name, x):
    compiled = COMPILED(x)[list(FUNCTIONS).index(name)]
    with np.errstate(over="ignore"):  # of the square that is not selected
        plain = getattr(logarithm, name)(x)
    assert_array_equal(compiled, plain)  # NaN equals NaN here
    return compiled


def arguments(name, rng):
    """Everywhere, over all exponents, and where a logarithm loses digits if it is written naively."""
    every = np.exp(rng.uniform(-744, 709, 1500))
    if name == "log":
        steps = 1.0 + np.arange(-40, 41) * UNIT_ROUNDING
        return np.concatenate([rng.uniform(0.5, 2.0, 3000), 1.0 + rng.normal(0.0, 1e-5, 1000), steps, every])
    near = rng.uniform(0.0, 3.0, 3000), np.exp(rng.uniform(-50, 0, 1000))
    if name == "arsinh":
        return np.concatenate([*near, every])
    joints = rng.uniform(-0.32, -0.27, 500), rng.uniform(0.40, 0.43, 500)
    return np.concatenate([*near, *joints, -np.exp(rng.uniform(-744, -1e-6, 1500)), every])


@pytest.mark.parametrize(("name", "units"), [("log", 2), ("log1p", 2), ("arsinh", 3)])
def test_within_a_few_units_in_the_last_place(name, units):
    x = arguments(name, np.random.default_rng(5))
    got = both_log_readings(name, x)
    with mp.workdps(40):
        for argument, value in zip(x, got, strict=True):
            exact = FUNCTIONS[name](mp.mpf(float(argument)))
            # spacing(|exact|) is a unit in the last place; log of 1 is exact.
            assert abs(mp.mpf(float(value)) - exact) <= units * np.spacing(abs(float(exact)))


@pytest.mark.parametrize(("name", "library"), [("log", np.log), ("log1p", np.log1p)])
def test_special_values_are_those_of_ieee(name, library):
    with np.errstate(all="ignore"):
        expected = library(SPECIAL)
    got = both_log_readings(name, SPECIAL)
    assert_array_equal(np.isnan(got), np.isnan(expected))
    known = ~np.isnan(expected)
    assert_array_equal(np.signbit(got[known]), np.signbit(expected[known]))
    # 2 units of ours and 1 of the library's.
    assert_allclose(got[known], expected[known], rtol=6 * UNIT_ROUNDING, atol=0.0)


def both_quotients(x, y, twos):
    logs, signs = QUOTIENTS(x, y, twos)
    assert_array_equal(logs, logarithm.log_quotient(x, y, twos))
    assert_array_equal(signs, logarithm.quotient_sign(x, y))
    return logs, signs


def test_the_logarithm_of_a_quotient_is_right_within_its_range_and_none_beyond():
    """Near 1, near the change of the power of two, over all exponents, and beyond the range of doubles."""
    rng = np.random.default_rng(6)
    near = 1.0 + rng.normal(0.0, 1e-9, 1000)
    x = np.concatenate([near, rng.uniform(0.5, 2.0, 3000), 2.0 ** rng.uniform(-1020.0, 1021.0, 1000)])
    y = np.concatenate(
        [rng.permutation(near), rng.uniform(0.5, 2.0, 3000), 2.0 ** rng.uniform(-1020.0, 1021.0, 1000)]
    )
    x *= rng.choice([-1.0, 1.0], x.size)
    twos = np.where(rng.random(x.size) < 0.3, rng.integers(-(2**20), 2**20, x.size), 0) * 1.0
    logs, signs = both_quotients(x, y, twos)
    assert_array_equal(signs, np.sign(x))
    with mp.workdps(40):
        for a, b, k, value in zip(x, y, twos, logs, strict=True):
            exact = mp.log(abs(mp.mpf(float(a)) / mp.mpf(float(b)))) + int(k) * mp.ln2
            assert abs(mp.mpf(float(value)) - exact) <= 3 * np.spacing(abs(float(exact)))
            assert logarithm.log_quotient(mp.mpf(float(a)), mp.mpf(float(b)), int(k)) == exact
            assert logarithm.quotient_sign(mp.mpf(float(a)), mp.mpf(float(b))) == mp.sign(a)
    inside = [2.0**-1021, -1.0, np.nextafter(2.0**1022, 0.0)]
    outside = [0.0, -0.0, np.nextafter(2.0**-1021, 0.0), 5e-324, 2.0**1022, np.inf, -np.inf, np.nan]
    for wrong, right in itertools.product(outside, inside):
        logs, signs = both_quotients(
            np.array([wrong, right, wrong]), np.array([right, wrong, wrong]), np.zeros(3)
        )
        assert np.isnan(logs).all()
        assert (signs == 0.0).all()
    logs, signs = both_quotients(
        *map(np.array, zip(*itertools.product(inside, inside), strict=True)), np.zeros(9)
    )
    assert np.isfinite(logs).all()
    assert (abs(signs) == 1.0).all()
    one = mp.mpf(1)
    for zero in ((0 * one, one), (one, 0 * one), (mp.nan, one)):
        assert mp.isnan(logarithm.log_quotient(*zero, 0))
        assert logarithm.quotient_sign(*zero) == 0


def test_every_operation_is_of_whole_vectors_and_nothing_is_called():
    lines = [line for compiled in (COMPILED, QUOTIENTS) for line in compiled.llvm().splitlines()]
    assert sum(" fmul <" in line for line in lines) > 30
    assert not [line for line in lines if re.search(r" f(add|sub|mul|div) double", line)]
    called = {name for line in lines for name in re.findall(r"call \S+ .*?@(\S+?)\(", line)}
    assert {name for name in called if not name.startswith("llvm.")} == {"kernel.0"}


# == Sums of three doubles: their errors stay below their bounds, and tables made of them are correctly rounded

TABLES = {
    (mechanism, name, table.formula): catalogue(mechanism, input).table_low_parts.values()
    for mechanism in NAMES
    for input in inputs_of(mechanism)
    for name, table in catalogue(mechanism, input).tables.items()
}
#: Each function once: mechanisms share them.
FUNCTIONS_TRIPLE = {
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
    with mp.workprec(600 + 3 * abs(math.frexp(angle)[1])):
        value = function(mp.mpf(angle))
        return float(value), float(value - mp.mpf(float(value)))


def assert_correctly_rounded(function, has_low, angles):
    (found,) = tables.words([(function, has_low)], angles)
    expected = np.array([rounded(function, angle) for angle in angles.tolist()]).T
    assert_array_equal(found[: 1 + has_low], expected[: 1 + has_low])
    return found[: 1 + has_low]


@pytest.mark.parametrize("function", FUNCTIONS_TRIPLE, ids=[name for name, _ in FUNCTIONS_TRIPLE.values()])
def test_tables_and_their_low_parts_are_correctly_rounded(function):
    rng = np.random.default_rng(2)
    for angles in families(rng, 60).values():
        known = assert_correctly_rounded(function, FUNCTIONS_TRIPLE[function][1], angles)
        for k in range(0, angles.size, 7):  # one by one they take another way
            (one,) = tables.words([(function, FUNCTIONS_TRIPLE[function][1])], angles[k : k + 1])
            assert_array_equal(one[: len(known), 0], known[:, k])


@pytest.mark.stress
@pytest.mark.parametrize("function", FUNCTIONS_TRIPLE, ids=[name for name, _ in FUNCTIONS_TRIPLE.values()])
def test_tables_are_correctly_rounded_at_many_angles(function):
    rng = np.random.default_rng(3)
    for angles in families(rng, 50_000).values():
        assert_correctly_rounded(function, True, angles)


def test_tables_do_not_depend_on_company_or_order():
    rng = np.random.default_rng(4)
    angles = rng.permutation(np.concatenate([*families(rng, tables.MOST_KEPT // 3).values()]))
    assert angles.size > tables.MOST_KEPT > 2 * tables.BLOCK  # some are kept, and some are not
    pairs = [(function, True) for function in FUNCTIONS_TRIPLE]
    together = tables.words(pairs, angles)
    for start, stop in ((0, 1), (1, 12), (12, 200), (4000, 4500)):
        alone = tables.words(pairs[::-1], angles[start:stop][::-1].copy())[::-1]
        for one, all_ in zip(alone, together, strict=True):
            assert_array_equal(one[:, ::-1], all_[:, start:stop])


@pytest.mark.parametrize("function", FUNCTIONS_TRIPLE, ids=[name for name, _ in FUNCTIONS_TRIPLE.values()])
def test_almost_every_rounding_is_certain(function):
    """Bounds are 2^-122 of most values; low parts have a place of 2^-107 or, the lesser they are, less."""
    x = TripleDouble.of(np.random.default_rng(5).uniform(-7.0, 7.0, 20_000))
    with np.errstate(all="ignore"):
        _, _, sure, low_sure = function(x).doubles()
    assert np.mean(sure) > 0.99999
    assert np.mean(low_sure) > 0.998


def test_certainty_of_usual_angles_of_none_beyond_the_range_and_of_functions_without_a_rule():
    """Zero is exact, and whole numbers of quarters are as near to those of pi as doubles are."""
    for function, (name, has_low) in FUNCTIONS_TRIPLE.items():
        for angle in (0.0, 1.0, np.pi, -np.pi, np.pi / 2, 2.0 * np.pi):
            _, _, sure, low_sure = function(TripleDouble.of(angle)).doubles()
            cancels = name.startswith("slider_crank") and angle == np.pi / 2
            assert (low_sure if has_low else sure) or cancels, (name, angle)
    for angle in [1.1e5, -1e22, np.inf, -np.inf, np.nan, 2.0**-301, -5e-324]:
        for x in (angle, np.array([angle])):
            with np.errstate(all="ignore"):
                for core in (multiple.circular, multiple.hyperbolic):
                    assert not np.any(core(x)[1] < np.inf)
                    assert not np.any(core(x)[3] < np.inf)

    def sine_of_a_sine(theta):
        return sin(sin(theta))

    for angles in (np.array([0.5]), np.linspace(-4.0, 4.0, 41)):
        assert_correctly_rounded(sine_of_a_sine, True, angles)


def exact_parts(core, x):
    """Return the exact values of what a core of three doubles computes."""
    if core is multiple.circular:
        return mp.cos(x), mp.sin(x)
    y = mp.mpf(x) - int(core(x)[4]) * mp.ln2
    return mp.cosh(y), mp.sinh(y)


@pytest.mark.parametrize("core", [multiple.circular, multiple.hyperbolic])
def test_errors_stay_below_their_bounds(core):
    rng = np.random.default_rng(6)
    for kind, angles in families(rng, 150).items():
        if kind in ("beyond", "edges"):
            continue
        angles = angles[np.abs(angles) < 4e4]
        found = core(angles)
        for k, angle in enumerate(angles.tolist()):
            with mp.workprec(1500):
                for i, exact in enumerate(exact_parts(core, angle)):
                    parts, bound = [x[k] for x in found[2 * i]], found[2 * i + 1][k]
                    error = abs(mp.fsum(map(mp.mpf, parts)) - exact)
                    assert error <= bound, (kind, angle)
                    # 2^-100 of the square of the rest, 2^-22.7 at most, and of a table's value over 2^-11 or more
                    assert bound <= 2.0**-110 * abs(exact), (kind, angle)


def test_constants_are_rounded_to_their_last_place():
    with mp.workprec(400):
        unit = mp.mpf(2) ** multiple.PLACES
        assert int(mp.nint(mp.pi / 2 * unit)) == multiple.HALF_PI
        assert int(mp.nint(mp.ln2 * unit)) == multiple.LOG_2
        for grid, step in (
            (multiple._circle(), mp.pi / 2 ** (multiple.HALVINGS + 1)),
            (multiple._hyperbola(), mp.ln2 / 2**multiple.HALVINGS),
        ):
            assert abs(mp.fsum(map(mp.mpf, grid.pieces)) - step) < mp.mpf(2) ** -190
            assert all(math.frexp(piece)[0] * 2.0**multiple.PIECE_BITS % 1.0 == 0.0 for piece in grid.pieces)
            for k in (0, 1, 700, 1024, 1025, 2047, 2048):
                angle = k * step if grid.sign < 0.0 else (k - multiple.STEPS // 2) * step
                exact = (
                    (mp.cos(angle), mp.sin(angle)) if grid.sign < 0.0 else (mp.cosh(angle), mp.sinh(angle))
                )
                for parts, value in zip(grid.at(float(k)), exact, strict=True):
                    assert (
                        abs(mp.fsum(map(mp.mpf, parts)) - value)
                        <= mp.mpf(2) ** -106 * abs(parts[1]) + mp.mpf(2) ** -240
                    )


# == Sums and products that keep every digit: exact in rational numbers, with twice the digits of any reading

#: By function what it is of exact numbers, and how many arguments it takes.
EXACT = {
    "two_sum": (lambda a, b: a + b, 2),
    "two_product": (lambda a, b: a * b, 2),
    "sum_of_four": (lambda a, b, c, d: a + b + c + d, 4),
    "pair_product": (lambda a, a_low, b, b_low: (a + a_low) * (b + b_low), 4),
    "pair_quotient": (lambda a, a_low, b, b_low: (a + a_low) / (b + b_low), 4),
    "square_sum": (lambda a, f, f_low, b: a * a + (f + f_low) * b * b, 4),
    "gap_product_quotient": (lambda f, f_low, g, g_low, x, y: (f + f_low) * (g + g_low) / (4 * x * y), 6),
}
#: Which arguments are low parts, roundings of those before them.
LOW = {"pair_product": (1, 3), "pair_quotient": (1, 3), "square_sum": (2,), "gap_product_quotient": (1, 3)}


def drawn(name, rng, digits):
    """Return arguments, the low parts roundings of those before them in so many digits."""
    count, signs = (
        EXACT[name][1],
        [1.0] if name == "square_sum" else [-1.0, 1.0],
    )  # of whose terms none cancel
    numbers = list(rng.uniform(0.5, 2.0, count) * rng.choice(signs, count))
    for k in LOW.get(name, ()):
        numbers[k] = numbers[k - 1] * float(rng.uniform(-1.0, 1.0)) * 10.0**-digits
    return numbers


def fraction(x):
    """Return the exact value of a double or an mpmath number."""
    if isinstance(x, float):
        return Fraction(x)
    sign, mantissa, exponent, _ = x._mpf_
    return (-1) ** sign * Fraction(int(mantissa)) * Fraction(2) ** exponent


@pytest.mark.parametrize("name", EXACT)
@pytest.mark.parametrize(("reading", "bits"), [(float, 53), (CONTEXT.mpf, CONTEXT.prec)])
def test_a_pair_has_twice_the_digits(name, reading, bits):
    """As error bounds count on; some products of low parts are left out, each a rounding of a rounding."""
    rng, exact, function = np.random.default_rng(5), EXACT[name][0], getattr(compensated, name)
    roundings = Fraction(WORDS.get(function, 16 * UNIT_ROUNDING) / UNIT_ROUNDING)
    for _ in range(500):
        arguments = [reading(x) for x in drawn(name, rng, int(bits * 0.3) + 1)]
        high, low = function(*arguments)
        right = exact(*map(fraction, arguments))
        allowed = roundings * abs(right) * Fraction(2) ** (-2 * bits)
        assert abs(fraction(high) + fraction(low) - right) <= allowed
        assert abs(fraction(high) - right) <= abs(right) * Fraction(2) ** (1 - bits)


@pytest.mark.parametrize("reading", [float, CONTEXT.mpf])
def test_a_sum_that_cancels_keeps_what_is_left(reading):
    numbers = [reading(x) for x in (1.0, 2.0**-60, -1.0, 2.0**-110)]
    high, low = compensated.sum_of_four(*numbers)
    assert fraction(high) + fraction(low) == Fraction(2) ** -60 + Fraction(2) ** -110


# == Texts of functions are read by any number of threads ====================================================


@pytest.fixture
def interrupted():
    """Let threads give way to each other wherever memory is asked for, as finalisers do now and then."""

    def give_way(phase, info):
        time.sleep(1e-6)

    threshold, interval = gc.get_threshold(), sys.getswitchinterval()
    gc.set_threshold(50)
    gc.callbacks.append(give_way)
    sys.setswitchinterval(1e-5)
    yield
    gc.callbacks.remove(give_way)
    gc.set_threshold(*threshold)
    sys.setswitchinterval(interval)


def test_trees_are_made_by_many_threads(interrupted):
    """Python 3.11 takes the calls of all threads for one, and some end with a SystemError."""
    texts = [path.read_text() for path in sorted(Path(fastlink.__file__).parent.glob("mechanisms/*/*.py"))]

    def deep(text, depth):
        return deep(text, depth - 1) if depth else parsed(text)

    with ThreadPoolExecutor(8) as pool:
        trees = list(pool.map(deep, 2 * texts, [k % 17 for k in range(2 * len(texts))]))
    assert all(tree.body for tree in trees)
