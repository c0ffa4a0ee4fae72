"""Section 5: conics that touch the four lines of a position, their foci, and the involution of their tangents."""

import mpmath as mp
import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from tests.support.focal_configurations import positions
from tests.support.refusals import refused

import fastlink as fl
from fastlink.numerics.compensated import UNIT_ROUNDING

POSITION = ("a", "b", "c", "d", "phi", "branch")


@pytest.fixture(scope="module")
def figure():
    """Positions that close, with F and the corners as complex numbers."""
    values = positions(21, 3000, "F_x", "F_y", "A_x", "A_y", "B_x", "B_y")
    values |= {joint: values[f"{joint}_x"] + 1j * values[f"{joint}_y"] for joint in "ABF"}
    return values | {"M": 0.0 * values["A"], "N": values["d"] + 0j}


def position(figure):
    return [figure[name] for name in POSITION]


def sides(figure):
    """Return a point and the direction of each line that the conics touch."""
    ends = (("M", "A"), ("A", "B"), ("B", "N"), ("N", "M"))
    return [
        (figure[one], (figure[two] - figure[one]) / np.abs(figure[two] - figure[one])) for one, two in ends
    ]


def distances(conic, start, direction):
    """Return the signed distances of both foci from a line."""
    foci = (conic.x1 + 1j * conic.y1, conic.x2 + 1j * conic.y2)
    return [((focus - start) * np.conj(direction)).imag for focus in foci]


def assert_touches(figure, conic, roundings=200):
    """Assert that all four lines touch: the distances of the foci from a tangent have the product +-minor^2."""
    squared = np.where(conic.kind == 1, -1.0, 1.0) * conic.minor**2
    size = np.max([np.abs(figure[joint]) for joint in "ABN"], axis=0) + np.hypot(conic.x1, conic.y1)
    size = size + np.hypot(conic.x2, conic.y2)
    # a focus is the root of a quadratic equation: both are as far off as they are near each other
    apart = np.hypot(conic.x1 - conic.x2, conic.y1 - conic.y2)
    steep = 1.0 + size / np.maximum(apart, 1e-300)
    for start, direction in sides(figure):
        one, two = distances(conic, start, direction)
        assert (np.abs(one * two - squared) <= roundings * UNIT_ROUNDING * size**2 * steep).all()


@pytest.mark.parametrize("t", [-3.0, -0.4, 0.2, 0.5, 0.9, 1.7, 40.0])
def test_every_conic_touches_all_four_lines(figure, t):
    conic = fl.focal.inscribed_conics(*position(figure), t=t)
    assert np.isin(conic.kind, (0, 1)).all()
    assert_touches(figure, conic)
    middle = 0.5 * ((1 - t) * (figure["M"] + figure["B"]) + t * (figure["A"] + figure["N"]))
    assert_allclose(conic.centre_x + 1j * conic.centre_y, middle, rtol=0, atol=1e-13 * (1 + abs(t)))
    half = np.hypot(conic.x1 - conic.x2, conic.y1 - conic.y2) / 2
    signed = np.where(conic.kind == 0, 1.0, -1.0) * conic.minor**2
    assert_allclose(conic.major**2, half**2 + signed, rtol=0, atol=1e-12 * (1 + abs(t)) ** 2)


@pytest.mark.parametrize("t", [-0.4, 0.2, 0.5, 1.7])
def test_the_foci_lie_on_the_focal_cubic(figure, t):
    conic = fl.focal.inscribed_conics(*position(figure), t=t)
    k = fl.focal.cubic(*position(figure))
    for x, y in ((conic.x1, conic.y1), (conic.x2, conic.y2)):
        terms = [k[..., i, j] * x**i * y**j for i in range(4) for j in range(4 - i)]
        size = np.sum(np.abs(terms), axis=0) + np.abs(k).max(axis=(1, 2))
        apart = np.hypot(conic.x1 - conic.x2, conic.y1 - conic.y2)
        assert (np.abs(np.sum(terms, axis=0)) <= 1e3 * UNIT_ROUNDING * size * (1.0 + 1.0 / apart)).all()


def test_F_is_a_focus_and_its_conic_is_found(figure):
    """Section 5: F is a focus of one of the conics."""
    F = figure["F"]
    conic = fl.focal.inscribed_conics(*position(figure), x=F.real, y=F.imag)
    nearer = np.minimum(
        np.hypot(conic.x1 - F.real, conic.y1 - F.imag), np.hypot(conic.x2 - F.real, conic.y2 - F.imag)
    )
    size = np.max([np.abs(figure[joint]) for joint in "ABNF"], axis=0) + np.hypot(conic.x1, conic.y1)
    assert np.median(nearer / size) <= 10 * UNIT_ROUNDING
    # where both foci are near each other or t is great the root loses digits
    assert (nearer <= 1e-7 * size).all()
    assert_touches(figure, conic, 1e5)


def rays_to(figure, joint, x, y):
    return np.angle(figure[joint] - (x + 1j * y))


def same_line(one, other):
    """Return what vanishes where two directions are those of one line."""
    return np.abs(np.sin(one - other))


def test_rays_to_opposite_corners_are_pairs(figure):
    """Desargues: GM, GB and GN, GA, and at F all pairs have common bisectors."""
    rng = np.random.default_rng(4)
    x, y = rng.uniform(-2.0, 2.0, (2, figure["a"].size))
    found = fl.focal.involution(*position(figure), x=x, y=y)
    for one, other in (("M", "B"), ("N", "A"), ("B", "M"), ("A", "N")):
        off = same_line(found.partner(rays_to(figure, one, x, y)), rays_to(figure, other, x, y))
        assert np.quantile(off, 0.9) <= 1e-13
        assert np.quantile(off, 0.999) <= 1e-9


@pytest.mark.parametrize("t", [-0.8, 0.3, 2.5])
def test_tangents_from_a_point_are_a_pair_and_touch(figure, t):
    rng = np.random.default_rng(6)
    x, y = rng.uniform(-3.0, 3.0, (2, figure["a"].size))
    found = fl.focal.involution(*position(figure), x=x, y=y)
    one, other = found.tangents(t)
    real = np.isfinite(one) & np.isfinite(other)
    assert real.sum() > 200
    assert np.quantile(same_line(found.partner(one), other)[real], 0.99) <= 1e-10
    conic = fl.focal.inscribed_conics(*position(figure), t=t)
    squared = np.where(conic.kind == 1, -1.0, 1.0) * conic.minor**2
    for direction in (one, other):
        near, far = distances(conic, x + 1j * y, np.exp(1j * np.where(real, direction, 0.0)))
        off = np.abs(near * far - squared)[real]
        assert np.quantile(off, 0.95) <= 1e-10


def test_at_points_of_the_cubic_alone_the_involution_is_symmetric(figure):
    """Section 5: it then comprises the isotropic lines."""
    F = figure["F"]
    found = fl.focal.involution(*position(figure), x=F.real, y=F.imag)
    sure = np.isfinite(found.asymmetry)
    assert np.median(np.abs(found.asymmetry[sure])) <= 20 * UNIT_ROUNDING
    assert np.quantile(np.abs(found.asymmetry[sure]), 0.99) <= 1e-10
    bisects = np.abs(np.cos(found.first - found.second))
    assert np.quantile(bisects[sure], 0.99) <= 1e-10
    # angles of a pair with the double ray are equal and opposite
    turned = rays_to(figure, "M", F.real, F.imag) + rays_to(figure, "B", F.real, F.imag) - 2.0 * found.first
    assert np.quantile(np.abs(np.sin(turned)[sure]), 0.99) <= 1e-10
    beside = fl.focal.involution(*position(figure), x=F.real + 0.1, y=F.imag - 0.1)
    assert np.median(np.abs(beside.asymmetry)) > 1e-3


def test_where_the_four_bar_does_not_assemble_there_is_none():
    never = (1.0, 1.0, 0.1, 5.0, 0.0)
    assert all(np.isnan(value) for value in fl.focal.inscribed_conics(*never, t=0.5))
    assert np.isnan(fl.focal.involution(*never, x=1.0, y=1.0).first)


@pytest.mark.parametrize("t", [1e160, -1e200, 1.7e308])
def test_towards_infinity_the_conics_become_the_parabola(figure, t):
    """The focus at a finite place is then A N/(A + N - B), and tangents do not depend on t any more."""
    conic, even_further = (
        fl.focal.inscribed_conics(*position(figure), t=one) for one in (t, 2.0 * (t / 4.0))
    )
    A, B, N = figure["A"], figure["B"], figure["d"]
    focus = A * N / (A + N - B)
    # the roundings of products of B, A and N in the square of their sum
    size = np.abs(focus) * ((np.abs(A) + N + np.abs(B)) / np.abs(A + N - B)) ** 2
    assert (np.abs(conic.x2 + 1j * conic.y2 - focus) <= 10 * UNIT_ROUNDING * size).all()
    assert_array_equal(conic.kind, even_further.kind)
    assert_array_equal(conic.direction, even_further.direction)
    finite = np.isfinite(conic.major)
    assert finite.all() or t == 1.7e308
    assert_array_equal(conic.major[finite], 2.0 * even_further.major[finite])
    rays = fl.focal.involution(*position(figure), x=1.7, y=-2.9)
    assert_array_equal(rays.tangents(t), rays.tangents(np.ldexp(np.frexp(t)[0], 100)))


@pytest.mark.parametrize(
    ("given", "key"),
    [
        ({}, "x and y and t are missing"),
        ({"t": 0.5, "x": 1.0}, "given together"),
        ({"x": 1.0}, "y is missing"),
    ],
)
def test_a_conic_is_given_by_its_number_or_a_focus(given, key):
    with refused(key, "give t=..., or a focus"):
        fl.focal.inscribed_conics(1.0, 1.2, 0.8, 1.1, 0.5, **given)


# == Inscribed conics of four-bars next to parallelograms, kites and rhombi, and next to parabolas, against 60 digits

#: Which lengths are equal but for a gap, of a, b, c, d: the length of each by its number.
EQUAL = {
    "parallelogram": (0, 0, 2, 2),
    "kite of M": (0, 2, 2, 0),
    "kite of A": (0, 2, 0, 2),
    "rhombus": (0, 0, 0, 0),
}
EQUAL |= {"random": (0, 1, 2, 3)}


def drawn(kind, rng, n):
    """Return lengths with gaps from 1e-16 to 0.01, angles and numbers of conics up to 1e12 of either sign."""
    lengths = rng.uniform(0.3, 2.0, (4, n))[list(EQUAL[kind])]
    gaps = 10.0 ** rng.uniform(-16.0, -2.0, (4, n)) * rng.choice([-1.0, 0.0, 1.0], (4, n))
    t = rng.uniform(-1.5, 2.5, n) * 10.0 ** rng.choice([0.0, 0.0, 4.0, 8.0, 12.0], n)
    return [*(lengths * (1.0 + gaps)), rng.uniform(-3.0, 3.0, n), t]


def foci(branch, a, b, c, d, phi, t):
    """Return the foci and the squared semi-axis across them, with its sign; None where the four-bar does not close."""
    A = a * mp.expj(phi)
    along = (d - A) / abs(d - A)
    foot = (abs(d - A) ** 2 + c * c - b * b) / (2 * abs(d - A))
    if abs(foot) >= c:
        return None
    B = A + along * mp.mpc(foot, (1 if branch == 2 else -1) * mp.sqrt(c * c - foot * foot))
    half = ((1 - t) * B + t * (A + d)) / 2
    root = mp.sqrt(half * half - t * A * d)
    return [half + root, half - root], mp.im(half + root) * mp.im(half - root)


def matched(found, others):
    """Return others in the order in which they are nearest."""
    straight = sum(abs(x - y) for x, y in zip(found, others, strict=True))
    crossed = sum(abs(x - y) for x, y in zip(found, others[::-1], strict=True))
    return others if straight <= crossed else others[::-1]


@pytest.mark.parametrize("kind", EQUAL)
def test_the_foci_are_right_to_the_roundings_of_the_inputs(kind):
    rng, n = np.random.default_rng(6), 40
    inputs, branch, compared = drawn(kind, rng, n), rng.integers(1, 3, n), 0
    conic = fl.focal.inscribed_conics(*inputs[:5], branch=branch, t=inputs[5])
    with mp.workdps(60):
        step = mp.mpf(10) ** -25
        for i in range(n):
            at = [mp.mpf(float(values[i])) for values in inputs]
            exact = foci(branch[i], *at)
            assert (exact is not None) == np.isfinite(conic.x1[i])
            if exact is None:
                continue
            # the change of each focus with relative changes of all inputs: what their last digits determine
            moved = [
                foci(branch[i], *(x * (1 + step * (j == k)) for k, x in enumerate(at))) for j in range(6)
            ]
            moved = [matched(exact[0], one[0]) for one in moved]
            got = matched(exact[0], [mp.mpc(conic.x1[i], conic.y1[i]), mp.mpc(conic.x2[i], conic.y2[i])])
            units = [
                abs(exact[0][k]) + sum(abs(one[k] - exact[0][k]) for one in moved) / step for k in (0, 1)
            ]
            for k in (0, 1):
                # corners and the root have some three roundings each; the greatest of 1,200 is 1.2
                assert abs(got[k] - exact[0][k]) <= 4 * UNIT_ROUNDING * units[k], (kind, i)
            squared = mp.mpf(float(conic.minor[i])) ** 2 * (-1 if conic.kind[i] == 1 else 1)
            unit = sum(abs(mp.im(exact[0][k])) * units[1 - k] for k in (0, 1)) + abs(squared)
            assert abs(squared - exact[1]) <= 8 * UNIT_ROUNDING * unit, (kind, i)
            compared += 1
    assert compared > n // 3
