"""Crunodes and cusps of coupler curves against polylines and the instant centre."""

from functools import cache

import numpy as np
import pytest
from tests.support.configurations import LENGTHS
from tests.support.curve_designs import (
    CURVE,
    apart_from_change_points,
    design_of,
    evaluate,
    random_designs,
    traced,
)

from fastlink.numerics.compensated import UNIT_ROUNDING
from fastlink.planar import crunode_count, crunodes, cusp_count, cusps

# -- crunodes ----------------------------------------------------------------------------------------


def test_two_configurations_of_the_linkage_meet_at_a_crunode():
    """Place A on its circles around O and the point, B beside it: B is on its circle both times."""
    inputs, _ = random_designs(37, 5000)
    a1, a2, a3, a4, u, v = (inputs[name][:, None] for name in CURVE)
    X, Y, count = crunodes(**inputs)
    assert X.shape == Y.shape == (5000, 3)
    np.testing.assert_array_equal(np.isfinite(X).sum(axis=-1), count)
    assert min(np.bincount(count, minlength=4)) > 300
    z, p = X + 1j * Y, u + 1j * v
    square, length = np.abs(z) ** 2, np.abs(p)
    along = (square + a1**2 - length**2) / (2 * square)
    height = np.sqrt(a1**2 / square - along**2)
    flat = height * np.sqrt(square) / a1
    size = np.abs(z) + a1 + a2 + a3 + a4 + length
    # Roundings of z: of a cubic's root (by its companion: 1/distance to the other roots) and of the triangles.
    good = (flat > 1e-2) & (length > 1e-2) & (np.abs(z) > 1e-2)
    assert good.sum() > 0.9 * count.sum()
    for side in (-1, 1):
        A = z * (along + 1j * side * height)
        B = A + a2 * (z - A) / p
        error = np.abs(np.abs(B - a4) - a3)
        # |A P| = |p| holds by construction; what is left is the third side, 1e4 for the three divisors above.
        assert np.all((error <= 1e4 * UNIT_ROUNDING * size / flat)[good])


def test_a_curve_through_the_pivot_of_the_crank_crosses_itself_there():
    """With |AP| = a1 every coupler angle puts P on O, and two of them put B on its circle."""
    X, Y, count = crunodes(design_of(1.0, 2.5, 2.5, 2.0, 0.6, 0.8))
    assert count >= 1
    # A few roundings of the lengths.
    assert np.nanmin(np.hypot(X, Y)) <= 16 * UNIT_ROUNDING
    assert crunode_count(design_of(1.0, 2.5, 2.5, 2.0, 0.6, 0.8 + 1e-6)) == count


@cache
def pairs(n):
    return np.triu_indices(n, 2)


def crossings(parts):
    """Return every crossing of the segments of polylines with another segment not beside it."""
    start = np.concatenate([part[:-1] for part in parts])
    step = np.concatenate([np.diff(part) for part in parts])
    first, second = pairs(start.size)
    ends = np.cumsum([part.size - 1 for part in parts])
    last = {int(end) - 1: int(end) - part.size + 1 for end, part in zip(ends, parts, strict=True)}
    between, d1, d2 = start[second] - start[first], step[first], step[second]

    def cross(f, g):
        return f.real * g.imag - f.imag * g.real

    with np.errstate(all="ignore"):
        s, t = cross(between, d2) / cross(d1, d2), cross(between, d1) / cross(d1, d2)
    hit = np.flatnonzero((s >= 0) & (s < 1) & (t >= 0) & (t < 1))
    closing = np.array([last.get(int(second[k])) == first[k] for k in hit], dtype=bool)
    hit = hit[~closing]
    return start[first[hit]] + s[hit] * d1[hit]


@pytest.mark.parametrize("n", [60, pytest.param(1000, marks=pytest.mark.stress)])
def test_crunodes_against_crossings_of_polylines(n):
    """Of cranks that turn fully, whose curves close after one turn."""
    inputs, _ = random_designs(38, 8 * n)
    a, b, c, d = (inputs[name] for name in LENGTHS)
    turns = np.flatnonzero((abs(a - d) > abs(b - c)) & (a + d < b + c))[:n]
    inputs = {name: values[turns] for name, values in inputs.items()}
    X, Y, count = crunodes(**inputs)
    # Denser at theta1 = 0 and pi, where a linkage near a change point moves fast.
    even = np.linspace(0.0, 2 * np.pi, 301)
    turn = even - 0.497 * np.sin(2 * even)
    same = coarse = 0
    for i in range(n):
        one = {name: float(values[i]) for name, values in inputs.items()}
        parts = [traced(one, branch, turn) for branch in (1, 2)]
        found = crossings(parts)
        nodes = (X[i] + 1j * Y[i])[: count[i]]
        # A chord is off its curve by an eighth of its length times the angle it turns through: less than a
        # quarter of its length below a half turn, so that its crossings are off by less than it is long.
        allowed = max(np.abs(np.diff(part)).max() for part in parts)
        for point in found:
            assert nodes.size, (i, point)
            assert np.abs(nodes - point).min() <= allowed, (i, point)
        coarse += allowed > 0.05 * sum(one[name] for name in CURVE[:4])
        same += found.size == count[i]
    # A polyline misses loops smaller than its steps and may double crossings of nearly tangent arcs (none seen).
    assert same >= 0.99 * n
    assert coarse <= 0.05 * n


# -- cusps -------------------------------------------------------------------------------------------


def coupler_motion(lengths, point, e):
    """A, AB and the coupler point seen from A, at theta1 and theta2."""
    A, AB = lengths[0] * np.exp(1j * e[0]), lengths[1] * np.exp(1j * e[1])
    return A, AB, point * AB / lengths[1]


def designs_with_a_cusp(seed, n):
    """Designs whose P is where OA and DB meet at some configuration, and that configuration's place of P."""
    inputs, theta = random_designs(seed, 6 * n)
    lengths = np.array([inputs[name] for name in LENGTHS])
    theta2 = evaluate(["theta2"], inputs, theta, 1)["theta2"]
    A, AB, _ = coupler_motion(lengths, 1.0, (theta, theta2))
    DB, along = A + AB - lengths[3], A / lengths[0]
    with np.errstate(invalid="ignore"):
        pole = along * (DB.conj() * lengths[3]).imag / (DB.conj() * along).imag
        point = (pole - A) * AB.conj() / lengths[1]
        # Neither at infinity nor at a pivot, where P moves on a circle.
        far, near = np.abs(point), np.minimum(np.abs(point), np.abs(point - lengths[1]))
        good = np.flatnonzero(apart_from_change_points(lengths) & (far < 5.0) & (near > 0.1))[:n]
    assert good.size == n
    chosen = {name: inputs[name][good] for name in LENGTHS}
    return chosen | {"P_u": point[good].real, "P_v": point[good].imag}, pole[good]


def test_where_p_lies_on_the_moving_centrode_the_curve_has_a_cusp():
    inputs, pole = designs_with_a_cusp(39, 1000)
    X, Y, count = cusps(**inputs)
    assert np.all(count >= 1)
    # Roundings of P shift the cusp by as much as they do the double point: by the condition number of the cubic's
    # root, some 1e5 at worst, of the lengths.
    distance = np.nanmin(np.abs(X + 1j * Y - pole[:, None]), axis=1)
    assert np.median(distance) < 100 * UNIT_ROUNDING
    assert np.all(distance < 1e-9)
    # Beside the centrode, by far more than the tolerance, the cusp is a loop or nothing at all.
    beside = inputs | {"P_u": inputs["P_u"] + 1e-5}
    gone = cusp_count(**beside) < count
    # All but those whose centrode runs along AB there.
    assert gone.mean() > 0.99
    change = crunode_count(**beside) - crunode_count(**inputs)
    assert set(np.unique(change[gone])) == {0, 1}
