"""The Minkowskian plane against exact rational arithmetic, and 60 digits of what the definitions say.

Rational boosts: ch = (1 + t^2)/(1 - t^2) and sh = 2 t/(1 - t^2) with t = p/q, so that (q^2 + p^2, 2 p q) times a vector
of whole numbers is one of whole numbers, boosted by 2 artanh(p/q) exactly.
"""

from fractions import Fraction

import mpmath as mp
import numpy as np
import pytest
import xarray as xr
from numpy.testing import assert_allclose, assert_array_equal
from tests.support.refusals import refused

import fastlink as fl
from fastlink.numerics.compensated import UNIT_ROUNDING

plane = fl.minkowski
N = 400


def vectors(seed, n=N):
    """Vectors of whole numbers of every causal type: anywhere, and by a few units beside the light cone."""
    rng = np.random.default_rng(seed)
    x, y = rng.integers(-1000, 1001, (2, n))
    near = np.arange(n) % 3 == 0
    y = np.where(near, rng.choice([-1, 1], n) * (x + rng.integers(-2, 3, n)), y)
    return np.stack([x, y], axis=-1).astype(float)


def boosts(seed, n=N):
    """Whole p and q, p/q from 2^-14 to nearly 1, of either sign."""
    rng = np.random.default_rng(seed)
    q = 2 ** rng.integers(1, 15, n)
    return rng.choice([-1, 1], n) * rng.integers(1, q), q


def exact(vector):
    return tuple(Fraction(float(value)) for value in vector)


def square(vector):
    x, y = exact(vector)
    return x * x - y * y


def big(x):
    """A rational number with all digits that the context has."""
    return mp.mpf(x.numerator) / x.denominator if isinstance(x, Fraction) else mp.mpf(float(x))


def modulus(vector):
    return mp.sqrt(abs(big(square(vector))))


def assert_near(found, true, roundings):
    """Assert that doubles are right to so many roundings of each."""
    assert np.shape(found) == (len(true),)
    for value, number in zip(found, true, strict=True):
        if mp.isnan(number):
            assert np.isnan(value)
        else:
            assert abs(mp.mpf(float(value)) - number) <= roundings * UNIT_ROUNDING * abs(number), (
                value,
                number,
            )


def test_products_of_double_numbers_are_exact_to_a_rounding():
    z, w = 1.0 / (vectors(1) + 0.5), 1.0 / (vectors(2) + 0.25)  # no whole numbers: products are rounded
    w[::4] = z[::4, ::-1] * (1.0 + 2.0**-52)  # nearly orthogonal
    product, scalar = plane.multiply(z, w), plane.scalar_product(z, w)
    opposite = plane.multiply(z, plane.conjugate(w))
    for k in range(N):
        (x, y), (r, s) = exact(z[k]), exact(w[k])
        for found, true in (
            (product[k, 0], x * r + y * s),
            (product[k, 1], x * s + y * r),
            (scalar[k], x * r - y * s),
            (opposite[k, 0], x * r - y * s),  # <z, w> = Re(z conj(w))
        ):
            # sum_of_four has twice the working precision, and is rounded once.
            assert abs(Fraction(found) - true) <= Fraction(UNIT_ROUNDING) * abs(true) * Fraction(1001, 1000)


def test_the_sign_of_a_scalar_product_holds_where_products_leave_the_doubles():
    scalar = plane.scalar_product([[1e300, 1e-300], [3e-200, 2e-200]], [[0.0, 1.0], [3e-200, 4.5e-200]])
    assert_array_equal(scalar, [-1e-300, 0.0])
    assert plane.scalar_product([1e200, 0.0], [1e200, 0.0]) == np.inf


def test_norms_causal_types_and_orientations():
    z = vectors(3)
    z[::5] *= 2.0**900
    z[1::5] *= 2.0**-900
    with mp.workdps(60):
        # Difference, sum and product, halved by the root, and the root: 5/2 roundings.
        assert_near(plane.norm(z), [modulus(one) for one in z], 3)
    squares = [square(one) for one in z]
    signs = [(one > 0) - (one < 0) for one in squares]
    assert_array_equal(plane.causal_type(z), signs)
    ahead = [
        0 if sign == 0 else np.sign(one[0] if sign > 0 else one[1])
        for sign, one in zip(signs, z, strict=True)
    ]
    assert_array_equal(plane.orientation(z), ahead)
    assert set(signs) == {-1, 0, 1}
    assert plane.causal_type([0.0, 0.0]) == 0.0


def test_one_unit_beside_the_light_cone():
    """The square of the textbook, x^2 - y^2, has no digit there."""
    x = 0.1
    for y in (np.nextafter(x, 1.0), np.nextafter(x, 0.0)):
        true = np.sqrt(float(abs(square([x, y]))))
        assert plane.norm([x, y]) == pytest.approx(true, rel=4 * UNIT_ROUNDING, abs=0.0)
        assert plane.causal_type([x, y]) == np.sign(x - y)
        assert abs(x * x - y * y) != pytest.approx(true**2, rel=0.1, abs=0.0)


def test_boosts_turn_vectors_by_their_angle():
    """The definition of the angle, A(phi) z/|z| = w/|w|, in whole numbers."""
    z, (p, q) = vectors(4), boosts(5)
    ch, sh = (q * q + p * p).astype(float), (2 * p * q).astype(float)
    x, y = z.T
    w = np.stack([ch * x + sh * y, sh * x + ch * y], axis=-1)
    assert (abs(w) < 2.0**53).all()
    lightlike = plane.causal_type(z) == 0.0
    with mp.workdps(60):
        angles = [mp.log(mp.mpf(int(b + a)) / int(b - a)) for a, b in zip(p, q, strict=True)]
        true = [mp.nan if light else phi for light, phi in zip(lightlike, angles, strict=True)]
        # The moment 2, each norm 3, quotients 2, arsinh at most the 10 of its argument and 2.
        assert_near(plane.hyperbolic_angle(z, w), true, 12)
        assert_near(plane.hyperbolic_angle(-z, -w), true, 12)
        assert_near(plane.hyperbolic_angle(w, z), [-one for one in true], 12)
    assert np.isnan(plane.hyperbolic_angle(z, -w)).all()
    assert np.isnan(plane.hyperbolic_angle(z, w[:, ::-1])).all()


def test_rapidities_and_polar_coordinates():
    z = vectors(8)
    with mp.workdps(60):
        true = []
        for one in z:
            x, y = map(abs, exact(one))
            angle = mp.nan if x == y else mp.atanh(big(min(x, y) / max(x, y)))
            true.append(angle * int(np.sign(one[0]) * np.sign(one[1])) if x != y else angle)
        # The norm 3, a quotient, arsinh 2.
        assert_near(plane.rapidity(z), true, 7)
        phi = np.concatenate([np.linspace(-3.0, 3.0, 41), [1e-9, -1e-300, 0.0, 40.0, -700.0, 709.0]])
        points = plane.polar(2.0, phi)
        # e^phi 2, a product and a sum, where nothing cancels; sh alone below 1.
        assert_near(points[:, 0], [2 * mp.cosh(mp.mpf(t)) for t in phi], 5)
        assert_near(points[:, 1], [2 * mp.sinh(mp.mpf(t)) for t in phi], 7)
        far = plane.polar([1e-300, 1e300, 0.0], [1000.0, -1000.0, 1e9])
        assert_near(far[0], [mp.exp(1000) / 2 * mp.mpf(1e-300)] * 2, 7)
    assert_array_equal(far[1:], [[np.inf, -np.inf], [0.0, 0.0]])
    assert_array_equal(plane.multiply(plane.polar(1.0, 1.5), plane.polar(1.0, -1.5))[1], 0.0)


def test_motions_are_a_group_that_keeps_what_the_plane_measures():
    rng = np.random.default_rng(9)
    t, a, b = rng.uniform(-3.0, 3.0, (3, N))
    z, w = vectors(10), vectors(11)
    one, other = plane.motion(t, a, b), plane.motion(0.5 * t, b, -a)
    # A(s) A(t) = A(s + t), entries of at most e^4.5, each a sum of two products of roundings of 2 units.
    assert_allclose(plane.boost(t) @ plane.boost(0.5 * t), plane.boost(1.5 * t), atol=6e-16 * 2 * np.exp(4.5))
    both = (one @ other @ np.append(z, np.ones((N, 1)), axis=1)[..., None])[..., :2, 0]
    twice = plane.moved(plane.moved(z, 0.5 * t, b, -a), t, a, b)
    sizes = (abs(z).sum(axis=1) + 6.0) * np.exp(1.5 * abs(t))
    assert (abs(both - twice).max(axis=1) <= 40 * UNIT_ROUNDING * sizes).all()
    back = plane.moved(plane.moved(z, t), -t)
    assert (abs(back - z).max(axis=1) <= 20 * UNIT_ROUNDING * abs(z).sum(axis=1) * np.exp(2 * abs(t))).all()
    there = plane.moved(z, t), plane.moved(w, t)
    sizes = abs(z).sum(axis=1) * abs(w).sum(axis=1) * np.exp(2 * abs(t))
    changes = plane.scalar_product(*there) - plane.scalar_product(z, w)
    assert (abs(changes) <= 20 * UNIT_ROUNDING * sizes).all()


def test_points_are_moved_with_the_digits_of_both_null_coordinates():
    rng = np.random.default_rng(12)
    z, t = vectors(13), rng.uniform(-30.0, 30.0, N)
    found = plane.moved(z, t)
    with mp.workdps(60):
        for k in range(N):
            x, y, angle = (mp.mpf(float(value)) for value in (*z[k], t[k]))
            true = x * mp.cosh(angle) + y * mp.sinh(angle), x * mp.sinh(angle) + y * mp.cosh(angle)
            size = abs(x + y) * mp.exp(angle) / 2 + abs(x - y) * mp.exp(-angle) / 2
            # A sum, e^t 2 and a product each, and their sum.
            assert all(
                abs(mp.mpf(f) - v) <= 5 * UNIT_ROUNDING * size
                for f, v in zip(map(float, found[k]), true, strict=True)
            )
    # Lightlike vectors stay so at any angle.
    assert_array_equal(plane.moved([1.0, -1.0], 1000.0), [0.0, 0.0])
    assert_array_equal(plane.moved([1e-300, 1e-300], 800.0), plane.polar(1e-300, 800.0) * 2.0)


def pure_triangles(seed, n=N):
    """Vertices of whole numbers with AB and BC future-pointing timelike: any, nearly lightlike, nearly flat, flat."""
    rng = np.random.default_rng(seed)
    points = []
    for k in range(n):
        kind = k % 4
        size = 2 ** int(rng.integers(3, 20))
        c = np.array([int(rng.integers(-size, size)), size + int(rng.integers(1, 3 if kind == 1 else size))])
        a = np.array([int(rng.integers(-size, size)), size + int(rng.integers(1, 3 if kind == 1 else size))])
        if kind == 2:
            a = int(rng.integers(1, 9)) * c + [0, 1]
        elif kind == 3:
            a = int(rng.integers(1, 9)) * c
        A = rng.integers(-size, size, 2)
        points.append([A, A + c, A + c + a])
    return np.array(points, dtype=float)


def test_pure_triangles_obey_the_cosine_rule_and_the_reversed_inequality():
    points = pure_triangles(20)
    A, B, C = points.transpose(1, 0, 2)
    found = plane.pure_triangle(A, B, C)
    assert found.pure.all()
    with mp.workdps(80):
        a, b, c = ([modulus(one) for one in side] for side in (C - B, C - A, B - A))
        # Sums of four rounded once, halved by the roots, the roots and their product.
        for side, true in ((found.a, a), (found.b, b), (found.c, c)):
            assert_near(side, true, 4)
        # Theorem 2.4 at each vertex; at B the exterior angle, whose rule has a plus.
        angle_A = [
            mp.acosh(max((z**2 + y**2 - x**2) / (2 * y * z), 1)) for x, y, z in zip(a, b, c, strict=True)
        ]
        angle_C = [
            mp.acosh(max((x**2 + y**2 - z**2) / (2 * x * y), 1)) for x, y, z in zip(a, b, c, strict=True)
        ]
        angle_B = [
            mp.acosh(max((y**2 - x**2 - z**2) / (2 * x * z), 1)) for x, y, z in zip(a, b, c, strict=True)
        ]
        sides = zip(B - A, C - B, strict=True)
        flat = np.array([x[0] * y[1] == x[1] * y[0] for x, y in sides])  # products below 2^53
        assert flat[3::4].all()
        for angle, true in ((found.angle_A, angle_A), (found.angle_B, angle_B), (found.angle_C, angle_C)):
            assert_near(angle[~flat], [one for one, out in zip(true, flat, strict=True) if not out], 14)
            assert not angle[flat].any()
        sums = [x + y for x, y in zip(angle_A, angle_C, strict=True)]
        assert max(abs(x - y) for x, y in zip(sums, angle_B, strict=True)) < mp.mpf("1e-30")
        excess = [y - x - z for x, y, z in zip(a, b, c, strict=True)]
        assert_near(found.excess[~flat], [one for one, out in zip(excess, flat, strict=True) if not out], 20)
    assert (found.excess[~flat] > 0.0).all()
    assert not found.excess[flat].any()  # the equality: BC is a multiple of AB
    # Not one of them is pure in another order, or spacelike.
    for order in ((C, B, A), (B, A, C), (A, C, B)):
        turned = plane.pure_triangle(*order)
        assert not turned.pure.any()
        assert all(np.isnan(part).all() for part in turned[1:])
    assert not plane.pure_triangle(A[:, ::-1], B[:, ::-1], C[:, ::-1]).pure.any()


def test_purity_is_decided_exactly():
    """By the last unit of a coordinate, whose difference from another is rounded."""
    A, C = [1.0, 2.0**-54], [1.0, 64.0]
    B = [2.0, 1.0]  # AB = (1, 1 - 2^-54), rounded to (1, 1)
    assert not plane.pure_triangle(A, B, C).pure
    assert plane.pure_triangle([1.0, -(2.0**-54)], B, C).pure


def test_sides_and_angles_by_the_cosine_rule():
    rng = np.random.default_rng(21)
    a, b = np.exp(rng.uniform(-3.0, 3.0, (2, N)))
    angle = np.exp(rng.uniform(-20.0, 2.0, N))
    c = plane.cosine_rule(a, b, angle)
    with mp.workdps(80):
        for k in range(N):
            x, y, phi = (mp.mpf(float(value)) for value in (a[k], b[k], angle[k]))
            square = x * x + y * y - 2 * x * y * mp.cosh(phi)
            assert np.isnan(c[k]) == (square < 0)
            if square > 0:
                true = mp.sqrt(square)
                turned = (
                    abs(x - y * mp.cosh(phi)) * x + abs(y - x * mp.cosh(phi)) * y + x * y * phi * mp.sinh(phi)
                )
                assert abs(mp.mpf(float(c[k])) - true) <= 4 * UNIT_ROUNDING * (true + turned / true), k
        there = np.isfinite(c) & (c > 0.0)
        assert N // 4 < there.sum() < N
        sides = [[mp.mpf(float(one)) for one in side[there]] for side in (a, b, c)]
        cosines = [(x * x + y * y - z * z) / (2 * x * y) for x, y, z in zip(*sides, strict=True)]
        true = [mp.acosh(one) if one >= 1 else mp.nan for one in cosines]  # c is rounded
        # Four factors of 1 rounding and their quotients, halved, two roots, three more and arsinh.
        assert_near(plane.cosine_rule_angle(a[there], b[there], c[there]), true, 10)
        for sides in ((5e-324, 10.0, 4.0), (4.0, 1e-310, 3.0), (5e-324, 1e300, 1.0), (1e300, 1e-300, 1e299)):
            x, y, z = map(mp.mpf, sides)
            true = [mp.acosh((x * x + y * y - z * z) / (2 * x * y))]
            # beside the 10 roundings those of ln 2 and its product
            assert_near(plane.cosine_rule_angle(*np.array(sides)[:, None]), true, 12)
    assert plane.cosine_rule_angle(5.0, 3.0, 2.0) == 0.0
    assert np.isnan(plane.cosine_rule_angle(5.0, 3.0, 2.0 + 2.0**-51))
    for scale in (2.0**-900, 2.0**900):
        assert_array_equal(plane.cosine_rule(scale * a, scale * b, angle), scale * c)


@pytest.mark.parametrize("mirror", [False, True])
def test_the_reversed_triangle_inequality(mirror):
    """Lemma 2.1, and Lemma 2.2 by its reflection in the line y = x."""
    points = pure_triangles(22)
    A, B, C = points.transpose(1, 0, 2)[..., ::-1] if mirror else points.transpose(1, 0, 2)
    z, w = B - A, C - B
    for sign in (1.0, -1.0):
        found = plane.triangle_excess(sign * z, sign * w)
        with mp.workdps(80):
            true = [modulus(y + x) - modulus(x) - modulus(y) for x, y in zip(z, w, strict=True)]
            collinear = np.array([x[0] * y[1] == x[1] * y[0] for x, y in zip(z, w, strict=True)])
            assert collinear.sum() >= N // 4
            apart = [one for one, out in zip(true, collinear, strict=True) if not out]
            # Six norms or roots of products of 3 roundings, twice in a square, and some 6 operations.
            assert_near(found[~collinear], apart, 20)
        assert (found[~collinear] > 0.0).all()
        assert not found[collinear].any()
    assert np.isnan(plane.triangle_excess(z, -w)).all()
    assert np.isnan(plane.triangle_excess(z, w[:, ::-1])).all()
    assert np.isnan(plane.triangle_excess([1.0, 1.0], [2.0, 1.0]))


def test_the_ground_link_is_at_least_as_long_as_the_others_together():
    """Corollary 2.3."""
    rng = np.random.default_rng(23)
    y = rng.integers(-1000, 1001, (3, N))
    steps = np.stack([abs(y) + rng.integers(1, 2000, (3, N)), y], axis=-1).astype(float)
    steps[1:, ::4] = steps[0, ::4] * [[[2.0]], [[3.0]]]  # in line
    O, A, B, C = np.cumsum(np.concatenate([rng.integers(-9, 9, (1, N, 2)), steps]), axis=0)
    found = plane.quadrilateral_excess(O, A, B, C)
    with mp.workdps(60):
        true = [modulus(C[k] - O[k]) - mp.fsum(modulus(step[k]) for step in steps) for k in range(N)]
        assert_near(found[np.arange(N) % 4 > 0], [one for k, one in enumerate(true) if k % 4], 22)
    assert not found[::4].any()
    assert (np.delete(found, np.s_[::4]) > 0.0).all()
    assert np.isnan(plane.quadrilateral_excess(O, B, A, C)).all()


def test_vectors_broadcast_and_gaps_stay():
    z = np.array([[5.0, 3.0], [np.nan, 1.0], [3.0, 5.0]])
    assert_array_equal(plane.norm(z), [4.0, np.nan, 4.0])
    assert_array_equal(plane.causal_type(z), [1.0, np.nan, -1.0])
    assert_array_equal(plane.orientation(z), [1.0, np.nan, 1.0])
    assert plane.scalar_product(z[:, None], z).shape == (3, 3)
    assert plane.moved(z, np.zeros((4, 1))).shape == (4, 3, 2)
    assert plane.motion([0.0, 1.0], a=np.ones((3, 1))).shape == (3, 2, 3, 3)
    assert plane.pure_triangle([0, 0], [[0, 1], [1, 3]], [0, 9]).a.shape == (2,)
    assert plane.norm(np.ones((0, 2))).shape == (0,)
    assert isinstance(plane.norm([5, 3]), float)
    masked = np.ma.masked_array(z, [[False, False], [True, False], [False, False]])
    assert_array_equal(plane.norm(masked), plane.norm(z))
    by_name = plane.scalar_product(xr.DataArray(z[:2], dims=("k", "xy")), xr.DataArray(z, dims=("m", "xy")))
    assert_array_equal(by_name, plane.scalar_product(z[:2, None], z))


@pytest.mark.parametrize(
    ("call", "key", "remedy"),
    [
        (lambda: plane.norm(3.0), "z", "two coordinates"),
        (lambda: plane.norm([1.0, 2.0, 3.0]), "z", "such as [5.0, 3.0]"),
        (lambda: plane.norm([1.0, np.inf]), "z", "write a finite number"),
        (lambda: plane.norm([1.0, 2e300]), "z", "in another unit of length"),
        (lambda: plane.rapidity(["1", 2.0]), "z", "write a number"),
        (lambda: plane.multiply([1.0, 2.0], [True, False]), "w", "write"),
        (lambda: plane.norm(xr.DataArray([1.0, 2.0], attrs={"units": "s"})), "z", "m"),
        (lambda: plane.hyperbolic_angle(np.ones((2, 2)), np.ones((3, 2))), "w", "give equal lengths"),
        (lambda: plane.moved([1.0, 2.0], None), "t", "write"),
        (lambda: plane.boost(np.inf), "phi", "write a finite number"),
        (lambda: plane.motion(0.0, a="1"), "a", "write a number"),
        (lambda: plane.polar(-1.0, 0.0), "r", "at least 0"),
        (lambda: plane.cosine_rule(1.0, 0.0, 1.0), "b", "greater than 0"),
        (lambda: plane.cosine_rule_angle(1.0, 2.0, -1.0), "c", "greater than 0"),
        (lambda: plane.pure_triangle([0, 0], [0, 1], 2.0), "C", "two coordinates"),
    ],
)
def test_what_is_no_vector_is_refused(call, key, remedy):
    with refused(key, remedy):
        call()


def test_all_problems_are_told_together():
    with pytest.raises(fl.InputError) as caught:
        plane.quadrilateral_excess(1.0, [0.0], [np.inf, 0.0], [1.0, 2.0])
    assert [one.where[1] for one in caught.value.problems] == ["O", "A", "B"]
