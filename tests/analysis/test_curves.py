"""The coupler curve: sextic, cognates, straightness and inflections, each against another way to it."""

from functools import cache, partial
from itertools import pairwise

import mpmath as mp
import numpy as np
import pytest
from flint import arb, ctx, fmpq
from numpy.testing import assert_array_equal
from tests.support.configurations import (
    CURVE,
    LENGTHS,
    apart_from_change_points,
    design_of,
    evaluate,
    random_designs,
    traced,
)
from tests.support.refusals import refused

import fastlink as fl
from fastlink.numerics.compensated import UNIT_ROUNDING
from fastlink.planar import (
    cognates,
    crunode_count,
    crunodes,
    curve_area,
    curve_length,
    curve_straightness,
    cusp_count,
    cusps,
    inflections,
    sextic,
    straightness,
)


def majorant(inputs, X, Y):
    """Every term of the sextic with its absolute value: what one relative rounding each may do to it.

    Lengths, coordinates and their errors enter it homogeneously, of degree eight before the division by a2^2.
    """
    a1, a2, a3, a4, u, v = (np.abs(inputs[name]) for name in CURVE)
    z = np.abs(X) + np.abs(Y)
    p = u + v
    k = p * p + a1 * a1
    middle = 2 * a2 * u + a1 * a1 + a2 * a2 + a3 * a3 + a4 * a4
    W = (z * z + k) * (z + a4) + p / a2 * (a4 * z * z + middle * z + k * a4)
    V = a4 * z * (p * p / a2 + u) + v * (z * z + a4 * z)
    return W * W + 4 * V * V


def test_the_sextic_anywhere_is_the_product_over_both_assemblies_with_the_crank():
    """At any point, place A on its two circles, B beside it, and ask how far B is from its circle."""
    inputs, _ = random_designs(33, 60)
    c = sextic(**inputs)
    points = np.random.default_rng(34).uniform(-3.0, 3.0, (2, 60))
    with mp.workdps(50):
        for i in range(60):
            a1, a2, a3, a4, u, v = (mp.mpf(float(inputs[name][i])) for name in CURVE)
            X, Y = (mp.mpf(float(x)) for x in points[:, i])
            z, p, square = mp.mpc(X, Y), mp.mpc(u, v), X * X + Y * Y
            # A = z - p e with |A| = a1: e is a unit (or, off the reach, complex reciprocal) root of a quadratic.
            lead, middle = -p * mp.conj(z), square + abs(p) ** 2 - a1**2
            root = mp.sqrt(middle**2 - 4 * lead * mp.conj(lead))
            e1, e2 = (root - middle) / (2 * lead), (-root - middle) / (2 * lead)
            product = mp.mpf(1)
            for e in (e1, e2):
                # (B - a4)(conj B - a4), the conjugate written with 1/e.
                B, mirror = z - (p - a2) * e, mp.conj(z) - (mp.conj(p) - a2) / e
                product *= (B - a4) * (mirror - a4) - a3**2
            expected = (square * abs(p) ** 2 * product / a2**2).real
            found = mp.fsum(float(c[i, m, n]) * X**m * Y**n for m in range(7) for n in range(7))
            size = majorant({name: float(inputs[name][i]) for name in CURVE}, float(X), float(Y))
            # The coefficients alone are rounded here: sums of products of at most 24 operations each.
            assert abs(found - expected) <= 32 * UNIT_ROUNDING * size


def test_the_sextic_is_tricircular_and_sees_both_branches_of_a_design():
    c = sextic(design_of([0.4, 0.5], 1.2, 0.8, 1.0, 0.3, 0.2))
    top = np.array([[c[0, i, 6 - i] for i in range(7)], [c[1, i, 6 - i] for i in range(7)]])
    assert_array_equal(top, [[1, 0, 3, 0, 3, 0, 1]] * 2)
    assert not any(c[:, i, j].any() for i in range(7) for j in range(7 - i, 7))
    assert_array_equal(c[1], sextic(design_of(0.5, 1.2, 0.8, 1.0, 0.3, 0.2)))


@pytest.mark.parametrize("branch", [1, 2])
def test_cognates_trace_the_same_points(branch):
    inputs, theta = random_designs(35, 4000)
    names = ["P_x", "P_y", "theta2", "theta4"]
    got = evaluate(names, inputs, theta, branch)
    closes = np.isfinite(got["P_x"])
    assert closes.sum() > 1500
    lengths = np.array([inputs[name] for name in LENGTHS])
    reach = lengths.sum(axis=0) + np.hypot(inputs["P_u"], inputs["P_v"])
    sine = np.abs(np.sin(got["theta4"] - got["theta2"]))
    sine_cognate = np.abs(np.sin(got["theta4"] - theta))
    for cognate in cognates(inputs):
        angle, side = cognate.configuration(theta, got["theta2"], got["theta4"])
        assert_array_equal(side[closes & (cognate.number == 1)], branch)
        own = cognate.design
        traced = evaluate(["P_x", "P_y"], own, angle, side)
        X, Y = cognate.to_ground(traced["P_x"], traced["P_y"])
        # Each closure amplifies the roundings of lengths and angles by 1/sine of its own transmission angle and
        # by the ratio of its sizes; where the product nears 1e-6 even the branch may be rounded away.
        shortest = np.minimum(lengths.min(axis=0), np.min([own[name] for name in LENGTHS], axis=0))
        spread = (1 + reach / shortest) / (sine * (sine_cognate if cognate.number > 1 else sine))
        good = closes & (spread < 1e6)
        assert good.sum() > 0.95 * closes.sum()
        allowed = 8 * UNIT_ROUNDING * reach * spread
        assert np.all(np.hypot(X - got["P_x"], Y - got["P_y"])[good] <= allowed[good]), cognate.number


def test_straightness():
    s = np.linspace(-1.0, 1.0, 101)
    bow = 0.01 * (1 - s**2)
    for angle in (0.0, 0.7, 2.0, -1.5):
        x, y = s * np.cos(angle) - bow * np.sin(angle), s * np.sin(angle) + bow * np.cos(angle)
        # Half of the bow's height: coordinates of size 1 and edges as directions, a few roundings of the length 2.
        assert straightness(x, y) == pytest.approx(0.005, abs=32 * UNIT_ROUNDING)
        assert straightness(s * np.cos(angle), s * np.sin(angle)) <= 32 * UNIT_ROUNDING
    assert straightness(np.r_[s, np.nan], np.r_[bow, 0.0]) == pytest.approx(0.005, abs=32 * UNIT_ROUNDING)
    assert np.isnan(straightness([np.nan], [0.0]))
    assert straightness([2.0, 3.0], [1.0, 1.0]) == straightness([2.0], [1.0]) == 0.0
    assert straightness(s * 2.0**600, bow * 2.0**600) == straightness(s, bow) * 2.0**600
    # Against strips of 7200 directions, which are off by half a step times the extent at most.
    x, y = np.random.default_rng(42).normal(size=(2, 20, 3, 50))
    angle = np.linspace(0.0, np.pi, 7200)[:, None]
    found = straightness(x, y)
    assert found.shape == (20, 3)
    for place in np.ndindex(found.shape):
        strips = 0.5 * np.ptp(np.cos(angle) * y[place] - np.sin(angle) * x[place], axis=1)
        assert strips.min() - 8 * np.pi / 14400 <= found[place] <= strips.min() + 32 * UNIT_ROUNDING


def test_straightness_of_curves():
    # Chebyshev's approximate straight line, 1 : 2.5 : 2.5 : 2, P at 2 a2: flat around theta1 = pi.
    theta = np.linspace(np.pi - 1.2, np.pi + 1.2, 201)
    lambda_linkage = {"a1": 1.0, "a2": 2.5, "a3": 2.5, "a4": 2.0, "P_u": 5.0, "P_v": 0.0}
    got = evaluate(["P_x", "P_y"], lambda_linkage, theta, 2)
    length = np.hypot(np.ptp(got["P_x"]), np.ptp(got["P_y"]))
    part = straightness(got["P_x"], got["P_y"])
    assert part < 0.01 * length
    ends = {"theta1": (np.pi - 1.2, np.pi + 1.2), "branch": 2}
    assert curve_straightness(**lambda_linkage, **ends, samples=201) == part
    assert curve_straightness(**lambda_linkage, branch=2) > 50 * part


def test_inflections_next_to_toggles_are_found():
    """Within a step of 2 pi/720 of a toggle, where 4 of 100 rockers have one; against polylines that are fine there."""
    inputs, _ = random_designs(5, 200)
    places, _X, _Y, count = inflections(inputs, branch=2)
    compared = 0
    for i in range(200):
        one = {name: float(values[i]) for name, values in inputs.items()}
        a, b, c, d = (one[name] for name in LENGTHS)
        inner, outer = ((a * a + d * d - (b + sign * c) ** 2) / (2 * a * d) for sign in (-1, 1))
        if inner <= -1 or outer >= 1 or (inner > 1 and outer < -1):
            continue
        ends = np.arccos([min(inner, 1.0), max(outer, -1.0)])
        # By the cosine the distance from a toggle is a square: 1e-3 of a sample's step there is 1e-9 rad.
        theta = ends.mean() - 0.5 * np.ptp(ends) * np.cos(np.pi * (np.arange(4000) + 0.5) / 4000)
        parts = [theta, -theta] if inner < 1 and outer > -1 else [np.r_[-theta[::-1], theta]]
        if outer < -1:
            parts = [np.r_[theta, 2 * np.pi - theta[::-1]]]
        turns = 0
        for part in parts:
            chord = np.diff(traced(one, 2, part))
            turn = np.sign((chord[:-1].conj() * chord[1:]).imag)
            turns += np.count_nonzero(turn[1:] != turn[:-1])
        compared += 1
        # The polyline has its first vertex at theta[1]: an inflection still nearer to the toggle is not in it.
        size = np.arccos(np.cos(places[i, : count[i]]))
        seen = (size > (theta[1] if inner < 1 else -1.0)) & (size < (theta[-2] if outer > -1 else 4.0))
        assert turns == np.count_nonzero(seen), one
    assert compared > 50


def test_inflections_of_circles_and_of_many_designs():
    assert inflections(design_of(0.4, 1.2, 0.8, 1.0, 0.0, 0.0))[3] == 0
    theta1, X, _Y, count = inflections(
        design_of([[0.4], [0.3]], 1.2, 0.8, 1.0, [0.0, 0.7, 0.8], 0.5), branch=2
    )
    assert count.shape == (2, 3)
    assert theta1.shape == X.shape == (2, 3, count.max())
    assert_array_equal(np.isfinite(theta1).sum(axis=-1), count)


# == Crunodes and cusps of coupler curves against polylines and the instant centre ===========================


def test_two_configurations_of_the_linkage_meet_at_a_crunode():
    """Place A on its circles around O and the point, B beside it: B is on its circle both times."""
    inputs, _ = random_designs(37, 5000)
    a1, a2, a3, a4, u, v = (inputs[name][:, None] for name in CURVE)
    X, Y, count = crunodes(**inputs)
    assert X.shape == Y.shape == (5000, 3)
    assert_array_equal(np.isfinite(X).sum(axis=-1), count)
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


def designs_with_a_cusp(seed, n):
    """Designs whose P is where OA and DB meet at some configuration, and that configuration's place of P."""
    inputs, theta = random_designs(seed, 6 * n)
    lengths = np.array([inputs[name] for name in LENGTHS])
    theta2 = evaluate(["theta2"], inputs, theta, 1)["theta2"]
    A, AB = lengths[0] * np.exp(1j * theta), lengths[1] * np.exp(1j * theta2)
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


# == Length and area of coupler curves with 40 digits, from the loop equations alone =========================

#: Digits of the arithmetic, nodes of a rule, what its two halves may change on a panel, panels towards each end.
DIGITS, NODES, TOLERANCE, DYADIC = 40, 32, 1e-17, 2


def exact(x):
    """Return a double as it is."""
    return arb(fmpq(*float(x).as_integer_ratio()))


@cache
def rule():
    """Return nodes and weights of Clenshaw and Curtis on (0, 1): with the ends, so that no kink hides next to them."""
    pairs = []
    for k in range(NODES + 1):
        cosines = sum(
            (2 if 2 * j < NODES else 1) * (2 * j * k * arb.pi() / NODES).cos() / (4 * j * j - 1)
            for j in range(1, NODES // 2 + 1)
        )
        weight = (1 - cosines) / NODES
        node = (1 + (k * arb.pi() / NODES).cos()) / 2
        pairs.append((node, weight / 2 if k in (0, NODES) else weight))
    return pairs


def panel(along, a, b):
    """Return the rule on one panel."""
    return (b - a) * sum((weight * along(a + (b - a) * node) for node, weight in rule()), arb(0))


def integrated(along, low, high, whole, allowed):
    """Return an integral by halving until nothing changes."""
    middle = (low + high) / 2
    halves = panel(along, low, middle), panel(along, middle, high)
    if abs(float(halves[0] + halves[1] - whole)) <= allowed:
        return halves[0] + halves[1]
    first = integrated(along, low, middle, halves[0], allowed)
    return first + integrated(along, middle, high, halves[1], allowed)


def reference(design, branch, area=False):
    """Return length or area of an assembly mode; None where it does not assemble or is not closed.

    The circles about A and D meet in B, P turns with AB, and the velocities of the loop are solved for theta2'. With
    c = cos(theta1), AD is as long as abs(a2 - a3) at c = inner, as a2 + a3 at c = outer; the range of c is that of
    middle - half cos(s), 0 < s < pi. Of the roots of 1 + c and c - outer one, t, is a sine there, the other, g, has no
    zero; so at the other end. No quotient of zeros is left, but at a change point.
    """
    old, ctx.dps = ctx.dps, DIGITS
    try:
        a1, a2, a3, a4, u, v = (exact(x) for x in design)
        inner, outer = ((a1 * a1 + a4 * a4 - (a2 + sign * a3) ** 2) / (2 * a1 * a4) for sign in (-1, 1))
        toggles = outer > -1, inner < 1
        if not inner > -1 or not outer < 1 or (area and any(toggles)):
            return None
        low, high = (outer if toggles[0] else arb(-1)), (inner if toggles[1] else arb(1))
        side = 1 if branch == 2 else -1

        def along(s, sign):
            t = [(high - low).sqrt() * root for root in ((s / 2).sin(), (s / 2).cos())]
            c = low + t[0] * t[0]
            other = (1 + c if toggles[0] else c - outer), (1 - c if toggles[1] else inner - c)
            g = [part.sqrt() for part in other]
            sines = [(g if toggle else t)[k] for k, toggle in enumerate(toggles)]
            roots = [(t if toggle else g)[k] for k, toggle in enumerate(toggles)]
            rate = [t[k] / g[k] if toggle else 1 for k, toggle in enumerate(toggles)]
            A_x, A_y = a1 * c, sign * a1 * sines[0] * sines[1]
            x, y = a4 - A_x, -A_y
            square = a1 * a1 + a4 * a4 - 2 * a1 * a4 * c
            forth = (a2 * a2 - a3 * a3 + square) / (2 * square)
            across = side * a1 * a4 * roots[0] * roots[1] / square
            B_x, B_y = forth * x - across * y, forth * y + across * x  # from A
            C_x, C_y = B_x - x, B_y - y  # B from D
            # J A + n J (B - A) = m J (B - D): the product with B - D leaves n.
            crank, coupler = rate[0] * rate[1], -(A_x * C_y - A_y * C_x) / (side * a1 * a4 * g[0] * g[1])
            w_x, w_y = (u * B_x - v * B_y) / a2, (v * B_x + u * B_y) / a2
            d_x, d_y = -(crank * A_y + coupler * w_y), crank * A_x + coupler * w_x
            if area:
                return ((A_x + w_x) * d_y - (A_y + w_y) * d_x) / 2
            return (d_x * d_x + d_y * d_y).sqrt()

        ends = [arb.pi() / 2 ** (k + 1) for k in range(DYADIC)][::-1]
        marks = [arb(0), *ends, *(arb.pi() - end for end in ends[-2::-1]), arb.pi()]
        pieces = [(partial(along, sign=sign), a, b) for sign in (1, -1) for a, b in pairwise(marks)]
        coarse = [panel(*piece) for piece in pieces]
        allowed = TOLERANCE * sum(abs(float(part)) for part in coarse)
        return sum(
            (integrated(*one, part, allowed) for one, part in zip(pieces, coarse, strict=True)), arb(0)
        )
    finally:
        ctx.dps = old


# == Length and area of coupler curves: each within its own bound, and that below 1e-12, against 40 digits ===

#: What the documentation promises of lengths, and of areas in parts of the area that is swept.
PROMISED = 1e-12


def miss(value, true):
    """Return the distance of a double from a number of 40 digits; its subtraction by pairs of doubles."""
    return abs(float((true - exact(float(value))).mid()))


def near_cusp(design, branch, angle, gap):
    """Return the design with P at a gap from the pole of the coupler, which rests at that angle."""
    ends = evaluate(["theta2"], design_of(*design), np.array([-1e-6, 0.0, 1e-6]) + angle, branch)["theta2"]
    if not np.isfinite(ends).all():
        return None
    ratio = (ends[2] - ends[0]) / 2e-6
    pole = gap - design[0] * np.exp(1j * (angle - ends[1])) / ratio
    return [*design, pole.real, pole.imag]


def designs(seed, count):
    """Yield designs and branches: anywhere, next to change points, next to cusps and at them up to 1e-9."""
    rng = np.random.default_rng(seed)
    while count:
        kind, branch, gap = count % 6, int(rng.integers(1, 3)), 10.0 ** rng.uniform(-14.0, -1.0)
        lengths = rng.uniform(0.1, 3.0, 4)
        if kind == 1:
            lengths[3] = lengths[1] + lengths[2] - lengths[0] + gap * rng.choice([-1, 1])
        elif kind == 2:
            lengths[0] = abs(lengths[1] - lengths[2] + lengths[3]) + gap * rng.choice([-1, 1])
        elif kind == 3:
            lengths[2:] = lengths[0] * (1 + gap), lengths[1]
        if lengths.min() < 0.01:
            continue
        one = [*lengths, *rng.uniform(-2.0, 2.0, 2) * 10.0 ** rng.uniform(-3.0, 1.0)]
        if kind >= 4:
            one = near_cusp([*lengths], branch, rng.uniform(-3.0, 3.0), gap * (kind == 4))
        if one is not None:
            count -= 1
            yield list(map(float, one)), branch


@pytest.mark.parametrize("count", [12, pytest.param(1500, marks=pytest.mark.stress)])
def test_lengths_and_areas_lie_within_their_bounds(count):
    for design, branch in designs(61, count):
        length, bound = curve_length(design_of(*design), branch=branch, error=True)
        true = reference(design, branch)
        if true is None:
            assert np.isnan(length)
            assert np.isnan(bound)
            continue
        assert miss(length, true) <= bound, (design, branch)
        assert bound <= PROMISED * length, (design, branch)
        area, bound = curve_area(design_of(*design), branch=branch, error=True)
        true = reference(design, branch, area=True)
        if true is None:
            assert np.isnan(area)
            continue
        # |r x dr| is below |r| |dr|: a bound of the swept area, of which the error is a part.
        reach = design[0] + np.hypot(*design[4:])
        assert miss(area, true) <= bound <= PROMISED * 0.5 * reach * length, (design, branch)


def angle_of(a, b, opposite):
    """Return an angle of a triangle by the law of cosines."""
    return np.arccos((a * a + b * b - opposite * opposite) / (2.0 * a * b))


def test_circles_and_arcs_have_closed_forms():
    """A or B as the coupler point: turns and swings of the crank and the output link, whose ends are cusps."""
    cases = [
        ((0.5, 1.2, 0.8, 1.0, 0.0, 0.0), 2 * np.pi * 0.5),
        ((0.8, 1.2, 0.8, 0.3, 1.2, 0.0), 2 * np.pi * 0.8),
        ((0.4, 1.2, 0.8, 1.0, 1.2, 0.0), 1.6 * (angle_of(0.8, 1.0, 1.6) - angle_of(0.8, 1.0, 0.8))),
        # Rockers: one range around 0, around pi, and two, each between AD = abs(a2 - a3) and a2 + a3
        ((1.1, 0.7, 0.8, 1.3, 0.0, 0.0), 2.2 * angle_of(1.1, 1.3, 1.5)),
        ((1.5, 0.4, 1.2, 1.0, 0.0, 0.0), 3.0 * (angle_of(1.5, 1.0, 1.6) - angle_of(1.5, 1.0, 0.8))),
        ((1.2, 2.0, 0.5, 1.0, 0.0, 0.0), 2.4 * (np.pi - angle_of(1.2, 1.0, 1.5))),
    ]
    for branch in (1, 2):
        for design, length in cases:
            got, bound = curve_length(design_of(*design), branch=branch, error=True)
            # The closed forms in doubles: arccos of 3 roundings, magnified up to 3 times by its slope.
            assert abs(got - length) <= bound + 32 * 2.0**-53 * length, design
            assert bound <= PROMISED * length
    area, bound = curve_area(design_of(0.5, 1.2, 0.8, 1.0, 0.0, 0.0), error=True)
    assert abs(area - np.pi * 0.25) <= bound <= PROMISED * area


def test_lengths_of_any_size_of_single_positions_and_of_none():
    design = np.array([0.4, 1.2, 0.8, 1.0, 0.7, 0.5])
    length, bound = curve_length(design_of(*design), branch=2, error=True)
    for exponent in (-75, -30, 30, 75):
        scaled, its_bound = curve_length(design_of(*np.ldexp(design, exponent)), branch=2, error=True)
        assert (scaled, its_bound) == (np.ldexp(length, exponent), np.ldexp(bound, exponent))
    # A link of almost no length: the crank, whose turn moves P by a share of it; and the ground.
    for lengths in ((1e-24, 1.2, 0.8, 1.0), (1.0, 1.2, 0.8, 1e-24), (1.0, 1.2, 1e-24, 1.0)):
        got, bound = curve_length(design_of(*lengths, 0.7, 0.5), branch=2, error=True)
        assert 0.0 < bound <= PROMISED * got, lengths
    length, bound = curve_length(design_of(1.0, 1.0, 1.0, [3.0, 3.1], 0.3, 0.2), error=True)
    assert length[0] == bound[0] == 0.0  # stretched: it cannot move
    assert np.isnan([length[1], bound[1]]).all()
    design = dict(zip(CURVE, (0.4, 1.2, 0.8, 1.0, 0.7, 0.5), strict=True))
    length, bound = curve_length(design, branch=[1, 2], error=True)
    assert length.shape == bound.shape == (2,)
    assert_array_equal(curve_length(design, branch=[1, 2]), length)
    for function in (fl.planar.curve_length, fl.planar.curve_area):
        with refused("error", "True or False"):
            function(design, error="yes")
