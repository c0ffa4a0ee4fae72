"""The focal cubic: it goes through the points that the paper names, and its points are foci."""

import numpy as np
from tests.support.focal_configurations import positions

import fastlink as fl
from fastlink.numerics.compensated import UNIT_ROUNDING

MANY = 20_000


def with_corners(n, seed=1):
    """Return positions in which the four-bar assembles, and A, B and F as complex numbers."""
    found = positions(seed, n, "B_x", "B_y", "A_x", "A_y", "F_x", "F_y")
    return found, *(found[f"{point}_x"] + 1j * found[f"{point}_y"] for point in "ABF")


def cubic_of(inputs):
    return fl.focal.cubic(*(inputs[name] for name in ("a", "b", "c", "d", "phi", "branch")))


def value(k, z):
    """Value of the polynomial at points, and the sum of the sizes of its terms."""
    powers = [(i, j) for i in range(4) for j in range(4 - i)]
    terms = np.stack([k[..., i, j] * z.real**i * z.imag**j for i, j in powers])
    return terms.sum(axis=0), np.abs(terms).sum(axis=0)


def assert_on(k, z):
    """Assert that points are on curves: each coefficient and coordinate is some ten roundings off."""
    found, size = value(k, z)
    there = np.isfinite(z)
    assert (np.abs(found) <= 100 * UNIT_ROUNDING * size)[there].all()


def test_it_goes_through_the_corners_and_where_opposite_sides_meet():
    inputs, A, B, _ = with_corners(MANY)
    k, d = cubic_of(inputs), inputs["d"] + 0j
    assert A.size > MANY // 2
    for corner in (0 * d, d):
        found, size = value(k, corner)
        assert (np.abs(found) <= 100 * UNIT_ROUNDING * np.maximum(size, np.abs(k).max(axis=(1, 2)))).all()
    # X and Y are off by roundings over the sine of the angle in which the sides meet
    AB, v = B - A, B - d
    X = A * (d.real * v.imag) / (np.conj(A) * v).imag
    Y = (A.real - A.imag * AB.real / AB.imag) + 0j
    for point, sine in (
        (A, 1.0),
        (B, 1.0),
        (X, (np.conj(A) * v).imag / np.abs(A * v)),
        (Y, AB.imag / np.abs(AB)),
    ):
        found, size = value(k, point)
        # a corner is as far off as its vector: rounded coordinates of all corners enter
        scale = np.maximum(size, np.abs(k[:, 1, 0]) * np.abs(d) + np.abs(k[:, 0, 1]) * np.abs(d))
        assert (np.abs(found) <= 100 * UNIT_ROUNDING * scale / np.abs(sine)).all()


def test_every_F_is_on_it():
    inputs, _, _, F = with_corners(MANY)
    k = cubic_of(inputs)
    sure = np.isfinite(F) & (np.abs(F) < 10.0)
    assert sure.sum() > MANY // 4
    found, size = value(k[sure], F[sure])
    # F is some roundings off, times its condition: lambda near 0 is left out by the size of F
    assert np.quantile(np.abs(found) / size, 0.99) <= 100 * UNIT_ROUNDING
    assert (np.abs(found) <= 1e-11 * size).all()


def traced(n, samples=40, seed=1):
    inputs, A, B, _ = with_corners(n, seed)
    found = fl.focal.cubic_points(
        *(inputs[name] for name in ("a", "b", "c", "d", "phi", "branch")), samples=samples
    )
    return inputs, A[:, None], B[:, None], found[..., 0] + 1j * found[..., 1]


def test_traced_points_are_foci_of_inscribed_conics():
    """FM, FB and FN, FA have common bisectors: so the tangents from F make one symmetric involution (section 5)."""
    inputs, A, B, z = traced(2000)
    N = inputs["d"][:, None] + 0j
    product = z * (z - B) * np.conj((z - N) * (z - A))
    size = np.abs(product)
    far = np.isfinite(z) & (np.minimum.reduce([abs(z), abs(z - B), abs(z - N), abs(z - A)]) > 1e-2)
    far &= np.abs(z) < 1e3
    assert far.sum() > 100_000
    # a point that is off by roundings of its size turns its lines by that over their lengths
    assert (np.abs(product.imag) <= 1e-11 * size)[far].all()


def test_it_passes_all_real_points():
    """Where the cubic meets a line through N, which the tracing does not use, there is an arc beside."""
    inputs, _, _, z = traced(50, samples=400, seed=3)
    k = cubic_of(inputs)
    for i in range(len(z)):
        arcs = z[i][np.isfinite(z[i])]
        for angle in (0.3, 1.1, 2.0, 2.9):
            direction = np.exp(1j * angle)
            at = np.array([-1.5, -0.5, 0.5, 1.5])
            values, _ = value(k[i][None], inputs["d"][i] + at * direction)
            for root in np.roots(np.polyfit(at, values, 3)):
                if abs(root.imag) < 1e-9 and 1e-3 < abs(root.real) < 3.0:
                    point = inputs["d"][i] + root.real * direction
                    assert np.abs(arcs - point).min() < 0.1 * (1.0 + abs(point))


def test_folded_four_bars_and_parallelograms_have_their_cubics_and_what_does_not_assemble_none():
    k = fl.focal.cubic(1.0, 2.0, 1.5, 1.5, 0.0)  # A = (1, 0), B = (-0.5, 0) by AB = 1.5, NB = 2
    assert np.abs(k[:, 0]).max() <= 10 * UNIT_ROUNDING
    assert np.isfinite(fl.focal.cubic_points(1.0, 2.0, 1.5, 1.5, 0.0)).any()
    k = fl.focal.cubic(1.0, 1.0, 2.0, 2.0, 1.0, branch=2)
    assert np.abs(k[[3, 1, 2, 0], [0, 2, 1, 3]]).max() <= 10 * UNIT_ROUNDING
    assert_on(k[None, None], (lambda p: p[None, :, 0] + 1j * p[None, :, 1])(
        fl.focal.cubic_points(1.0, 1.0, 2.0, 2.0, 1.0, branch=2)))  # fmt: skip
    assert np.isnan(fl.focal.cubic(1.0, 1.0, 0.1, 5.0, 0.0)).all()
    assert np.isnan(fl.focal.cubic_points(1.0, 1.0, 0.1, 5.0, 0.0)).all()


def test_it_broadcasts_and_scales():
    k = fl.focal.cubic(1.0, 1.2, np.full((3, 1), 0.8), 1.1, np.linspace(0.5, 1.0, 4), 2)
    assert k.shape == (3, 4, 4, 4)
    large = fl.focal.cubic_points(*(2.0**70 * length for length in (1.0, 1.2, 0.8, 1.1)), 0.7, 2)
    # a power of two of all lengths changes no bit
    np.testing.assert_array_equal(large, 2.0**70 * fl.focal.cubic_points(1.0, 1.2, 0.8, 1.1, 0.7, 2))
