"""Completions of a four-bar to a focal mechanism: the paper's equations, its example, and brute force."""

from __future__ import annotations

import numpy as np
import pytest
from tests.support.focal_designs import GIVEN, LENGTHS, exact, facts, family, given_by, one, random_designs

import fastlink as fl
from fastlink.mechanisms import catalogue
from fastlink.numerics.compensated import UNIT_ROUNDING
from fastlink.precision.reference import CONTEXT as MP
from fastlink.precision.reference import HighPrecision

BARS = ("lambda_", "m", "n", "p", "q", "r", "FT", "s", "T_ratio")
#: 50 digits, of which the worst of these designs loses some ten by cancellation.
LEFT = MP.mpf(10) ** -38
CHEBYSHEV = {"a": 5.0, "b": 5.0, "c": 2.0, "d": 4.0, "rho": 1.0}


def completed(rng, n, given="rho"):
    """Yield lengths, rho and bars of completed designs with 50 digits."""
    designs = given_by(given, random_designs(rng, n))
    found = exact((*BARS, "rho", "status"), given)
    for i in range(len(designs["a"])):
        for completion in (1.0, 2.0):
            at = found.at(one(designs, i, completion, given))
            if at["status"] == 0:
                yield *(at[name] for name in LENGTHS), at["rho"], *(at[name] for name in BARS)


def same(x, y, *sizes):
    return abs(x - y) <= LEFT * max([abs(x), abs(y), *map(abs, sizes)])


def radius_and_share(m, n, p, q, d):
    """Return r^2 and s/d by eq. (1.8), s corrected."""
    sizes = m * m * n * n * (p * p + q * q) + (m * m + n * n) * p * p * q * q
    mixed = m * n * p * q * (m * m + n * n + p * p + q * q - d * d)
    return (sizes + mixed) / (m * p + n * q) ** 2, m * p / (m * p + n * q)


@pytest.mark.parametrize("given", GIVEN)
def test_the_equations_of_sections_1_to_3(given):
    count = 0
    for a, b, c, d, rho, L, m, n, p, q, r, FT, s, share in completed(np.random.default_rng(1), 150, given):
        # (2.5) and (2.6)
        assert same(a, L * m)
        assert same(b, L * n)
        assert same(L - 1, p * q / (m * n), 1)
        assert same(a * b, L * (m * n + p * q), L * m * n)
        scale = a * a + b * b + c * c + d * d
        lost = L * (m * m + n * n - p * p - q * q + d * d)
        assert same(a * a + b * b - c * c + d * d, lost, scale, L * m * m, L * p * p, L * q * q, L * n * n)
        # (1.9), and (1.8) for the five-bar on MN and for that on AB
        assert same(m * p, rho * n * q)
        assert same(s, d * share)
        squared, ratio = radius_and_share(m, n, p, q, d)
        lost = max(map(abs, (m * m, n * n, p * p, q * q, d * d))) * max(1, abs(m * p / (m * p + n * q))) ** 2
        assert same(squared, r * r, lost)
        assert same(ratio, share)
        assert r > 0
        squared, ratio = radius_and_share((L - 1) * n, (L - 1) * m, q, p, c)
        assert same(squared, FT * FT, lost * max(1, abs(L - 1)) ** 2)
        assert same(1 - ratio, share, 1)
        # the quadratic equation of lambda that section 6 asks for
        A, B = a * a + b * b, rho * b * b + a * a / rho
        terms = d * d * L * L, (A + d * d - c * c + B) * L, A + B
        assert same(terms[0] - terms[1] + terms[2], 0, *terms, A * L, B * L)
        count += 1
    assert count > 150


def test_both_completions_exchange_r_and_FT():
    designs = random_designs(np.random.default_rng(2), 60)
    found = exact((*BARS, "x"))
    for i in range(60):
        first, second = (found.at(one(designs, i, completion)) for completion in (1.0, 2.0))
        if not MP.isnan(first["r"]):
            assert same(first["r"], second["FT"])
            assert same(first["FT"], second["r"])
            assert abs(first["x"]) >= abs(second["x"]) > 0


def test_completions_of_a_given_lambda_have_the_product_of_rho():
    designs = given_by("lambda_", random_designs(np.random.default_rng(3), 60))
    found = exact(("rho", "lambda_", "r"), "lambda_")
    for i in range(len(designs["a"])):
        first, second = (found.at(one(designs, i, completion, "lambda_")) for completion in (1.0, 2.0))
        assert same(first["rho"] * second["rho"], (first["a"] / first["b"]) ** 2)
        # one of them is what lambda came from
        rho = MP.mpf(float(designs["rho"][i]))
        near = min(abs(x["rho"] - rho) / abs(rho) for x in (first, second))
        assert near < 1e-5  # lambda was rounded: 1e-16 of it, and more where both completions are near


def test_what_is_given_does_not_matter():
    designs = random_designs(np.random.default_rng(4), 60)
    by_rho, by_s = exact(BARS), exact(tuple(name for name in BARS if name != "s"), "s")
    for i in range(60):
        at = by_rho.at(one(designs, i, 1.0))
        other = by_s.at({name: at[name] for name in (*LENGTHS, "completion", "s")})
        if not MP.isnan(at["m"]):
            assert all(same(at[name], other[name]) for name in BARS)


def test_the_chebyshev_linkage_to_every_digit():
    maps = fl.sweep(
        "focal", fl.grid(**CHEBYSHEV), ["m", "n", "p", "q", "r", "FT", "h1", "h2", "S_x", "T_ratio"]
    )
    first = maps.sel(completion=1)
    root = MP.sqrt(6)
    expected = {
        **dict.fromkeys("mn", 2 * (7 - 2 * root) / 5),
        **dict.fromkeys("pq", (2 + 3 * root) / 5),
        "r": root - 2,
        "FT": root + 2,
        "h1": 2 * root,
        "h2": 4,
        "S_x": 2,
        "T_ratio": 0.5,
    }
    for name, value in expected.items():
        # condition numbers of m and r are below 10 here: the doubles are right to some units in the last place
        assert abs(MP.mpf(float(first[name])) - value) <= 16 * UNIT_ROUNDING * value, name
    assert float(maps.r.sel(completion=2)) == pytest.approx(float(first.FT), rel=8 * UNIT_ROUNDING)
    # as printed
    assert [round(float(first[name]), 4) for name in ("m", "p", "r")] == [0.8404, 1.8697, 0.4495]


def test_the_symmetric_formulas_of_section_6():
    rng = np.random.default_rng(5)
    found = exact(("m", "n", "p", "q", "r", "FT", "h1", "h2"))
    tested = 0
    for _ in range(40):
        a, c, d = (float(x) for x in rng.uniform(0.3, 2.0, 3))
        at = found.at({"a": a, "b": a, "c": c, "d": d, "rho": 1.0, "completion": 1.0})
        if MP.isnan(at["m"]):
            assert 2 * a < c + d or c > 2 * a + d or d > 2 * a + c
            continue
        a, c, d, m, p, h1, h2 = (at[name] for name in ("a", "c", "d", "m", "p", "h1", "h2"))
        assert same(h1**2, a * a - (d - c) ** 2 / 4)
        assert same(h2**2, a * a - (d + c) ** 2 / 4, a * a)
        assert same(m, at["n"])
        assert same(p, at["q"])
        # (6.1)
        assert same(m * m + p * p, a * m)
        assert same(2 * a * m * m - 2 * a * p * p + a * d * d, (2 * a * a - c * c + d * d) * m, a**3)
        # (6.3)
        assert same(m, (4 * a * a - c * c + d * d - 4 * h1 * h2) / (8 * a), a)
        assert same(p, ((c + d) * h1 - (c - d) * h2) / (4 * a), a)
        assert same(at["r"], (h1 - h2) / 2, a)
        assert same(at["FT"], (h1 + h2) / 2)
        tested += 1
    assert tested > 20


def test_heights_are_of_symmetric_four_bars_only():
    found = facts(random_designs(np.random.default_rng(6), 20), 1.0, ["h1", "h2"])
    assert np.isnan(found["h1"]).all()
    assert np.isnan(found["h2"]).all()


def test_the_mirror_exchanges_M_and_N():
    designs = random_designs(np.random.default_rng(7), 40)
    found = exact(BARS)
    for i in range(40):
        given = one(designs, i, 1.0)
        mirrored = given | {"a": given["b"], "b": given["a"], "rho": 1 / MP.mpf(given["rho"])}
        at, other = found.at(given), found.at(mirrored)
        if not MP.isnan(at["m"]):
            pairs = ("m", "n"), ("p", "q"), ("r", "r"), ("FT", "FT"), ("lambda_", "lambda_")
            assert all(same(abs(at[x]), abs(other[y])) for x, y in pairs)


def test_the_straight_line_is_where_the_circle_goes():
    designs = random_designs(np.random.default_rng(8), 60)
    line, circle = exact(("line_x", "status")), exact(("r", "s"))
    tested = 0
    for i in range(60):
        given = one(designs, i, 1.0)
        at = line.at(given | {"rho": -1.0})
        if at["status"] == 3:
            # r and s grow to the 25th power of ten: half of the 50 digits is left, and the tangent leaves by as much
            near = circle.at(given | {"rho": -1 + MP.mpf(10) ** -25})
            meets = min((near["s"] - near["r"], near["s"] + near["r"]), key=abs)
            assert abs(meets - at["line_x"]) <= 1e-15 * (1 + abs(at["line_x"]))
            tested += 1
        else:
            assert MP.isnan(at["line_x"])
    assert tested > 20


def test_hart_s_linkages_are_the_completions_with_rho_minus_1():
    rng = np.random.default_rng(14)
    hart = HighPrecision(catalogue("hart"), ("a", "b", "c", "p", "q", "line_x"), ("m", "n", "d", "kappa"))
    found = exact(("m", "n", "p", "q", "line_x", "status"))
    tested = 0
    for m, n, d, kappa in rng.uniform(0.1, 2.0, (60, 4)):
        at = hart.at({"m": m, "n": n, "d": d, "kappa": kappa / 2.5})
        given = {name: at[name] for name in LENGTHS} | {"rho": -1.0, "completion": 2.0}
        ours = found.at(given)
        if ours["status"] == 3:
            assert same(ours["m"], at["m"])
            assert same(ours["n"], at["n"])
            # the same but for the signs of p and q, and omega + pi
            assert same(ours["p"], -at["p"])
            assert same(ours["q"], -at["q"])
            assert same(ours["line_x"], at["line_x"], d)
            tested += 1
    assert tested > 20


# -- brute force over the crank -------------------------------------------------------------------------------

RANGES = ("phi_low", "phi_high", "psi_low", "psi_high")
ANGLES = ("transmission_angle_PQ_least", "transmission_angle_F_least")


def test_the_coupler_closes_by_itself():
    """At any direction of the crank the dyads MPF and NQF hold A and B as far apart as AB is long."""
    tested = 0
    turns = [MP.expj(float(sigma)) for sigma in np.random.default_rng(15).uniform(-3.0, 3.0, 8)]
    for a, b, c, d, _, _, m, n, p, q, r, _, s, _ in completed(np.random.default_rng(16), 40):
        for turn in turns:
            z = s + r * turn
            cosine = (m * m + p * p - abs(z) ** 2) / (2 * m * p)
            if abs(cosine) < 0.999:  # F is in reach, and not so near its end that digits are lost
                w = MP.mpc(cosine, MP.sqrt(1 - cosine * cosine))
                at_M, at_N = m - p * w, n + q * w
                u, v = z / at_M, (z - d) / at_N
                lost = max(abs(m / at_M), abs(p / at_M), abs(n / at_N), abs(q / at_N), 1) ** 2
                assert same(abs(d + b * v - a * u), c, lost * max(a, b, d, abs(z)))
                tested += 1
    assert tested > 100


def around(a, b, c, d, m, n, p, q, r, s, steps=4000):
    """Return omega and the directions of MA and NB over a turn of the crank, from the dyads MPF and NQF alone.

    The last one is how far off they may be by rounding: of each length 4 times in units of itself, and of z 8 times.
    """
    sigma = np.linspace(-np.pi, np.pi, steps + 1)
    z = s + r * np.exp(1j * sigma)
    cosine = (m * m + p * p - abs(z) ** 2) / (2 * m * p)
    closes = abs(cosine) <= 1.0
    z, cosine = z[closes], cosine[closes]
    omega = np.arccos(cosine)
    w = np.exp(1j * omega)
    u, v = z / (m - p * w), (z - d) / (n + q * w)
    lost_of_z = 8 * UNIT_ROUNDING * (abs(s) + abs(r))
    terms = 8 * UNIT_ROUNDING * (2 * (m * m + p * p + abs(z) ** 2)) + 2 * abs(z) * lost_of_z
    lost = terms / abs(2 * m * p)
    # an arccosine by its slope, or by what the error may do at its end
    lost = np.minimum(lost / np.sqrt(np.maximum(1 - cosine * cosine, 1e-300)), np.sqrt(2 * lost))
    directions = [
        abs(x / y) * lost + lost_of_z / abs(along) + 16 * UNIT_ROUNDING
        for x, y, along in ((p, m - p * w, z), (q, n + q * w, z - d))
    ]
    return closes, omega, np.angle(u), np.angle(v), np.max([lost, *directions])


@pytest.mark.parametrize("completion", [1.0, 2.0])
def test_crank_type_by_brute_force(completion):
    designs = random_designs(np.random.default_rng(9), 400)
    found = facts(designs, completion)
    codes = set()
    for i in np.flatnonzero(found["crank_type"] < 5.0):
        values = [designs[name][i] for name in LENGTHS] + [found[name][i] for name in "mnpqrs"]
        closes = around(*values)[0]
        code = int(found["crank_type"][i])
        m, p, r, s = (abs(found[name][i]) for name in "mprs")
        assert bool(closes.all()) == (code == 0)
        assert (code in (1, 3)) == (s + r > m + p)
        assert (code in (2, 3)) == (abs(s - r) < abs(m - p))
        codes.add(code)
    assert codes == {0, 1, 2, 3}


@pytest.mark.parametrize("completion", [1.0, 2.0])
def test_ranges_and_transmission_angles_by_brute_force(completion):
    designs = random_designs(np.random.default_rng(10), 1500)
    found = facts(designs, completion)
    turning = np.flatnonzero((found["crank_type"] == 0.0) & (found["r"] < 100.0))
    assert len(turning) > 60
    for i in turning[:60]:
        values = [designs[name][i] for name in LENGTHS] + [found[name][i] for name in "mnpqrs"]
        _, omega, phi, psi, lost = around(*values)

        def check(name, curve, extreme, i=i, lost=lost):
            # Where the samples are nearest to a smooth extreme they are off it by an eighth of a second difference.
            off = abs(extreme(curve) - found[name][i])
            assert off <= 0.25 * abs(np.diff(curve, 2)).max() + 2 * lost, (name, i)

        for name, curve in (("phi", phi), ("psi", psi)):
            # on one side of MN, unless it turns fully or crosses MN
            full = found[f"{name}_low"][i] == 0.0 or found[f"{name}_high"][i] == np.pi
            if not full:
                check(f"{name}_low", abs(curve), np.min)
                check(f"{name}_high", abs(curve), np.max)
        check(ANGLES[0], np.minimum(omega, np.pi - omega), np.min)
        between = np.unwrap(phi - psi)
        acute = abs((between + np.pi / 2) % np.pi - np.pi / 2)
        if found[ANGLES[1]][i] > 0.0:
            check(ANGLES[1], acute, np.min)
        else:
            assert np.ptp(between // np.pi) >= 1.0 or np.min(acute) < 1e-2


def test_every_double_rocker_of_grashof_s_kind_has_a_crank_that_turns_fully():
    designs = random_designs(np.random.default_rng(11), 100_000)
    first, second = (facts(designs, k, ["grashof_class", "crank_type", "status"]) for k in (1.0, 2.0))
    rockers = first["grashof_class"] == 2.0
    between = rockers & (designs["rho"] > 0.0)
    assert between.sum() > 4000
    assert (first["status"][between] == 0.0).all()
    real = rockers & (first["status"] == 0.0)
    assert real.sum() > between.sum() + 1000
    assert (first["crank_type"][real] == 0.0).all()
    assert (second["crank_type"][real] == 3.0).all()
    # double cranks have it the other way round, triple rockers have none
    cranks = (first["grashof_class"] == 1.0) & (first["status"] == 0.0)
    assert (second["crank_type"][cranks] == 0.0).all()
    assert (first["crank_type"][cranks] == 3.0).all()
    triple = (first["grashof_class"] >= 4.0) & (first["grashof_class"] <= 7.0)
    assert not (first["crank_type"][triple] == 0.0).any()


def test_the_transmission_angle_at_F_belongs_to_the_four_bar():
    designs = family("random", np.random.default_rng(12), 200)
    name = "transmission_angle_F_least"
    found = [facts(designs | {"rho": np.full(200, rho)}, 1.0, [name])[name] for rho in (0.5, 1.0, -3.0)]
    np.testing.assert_array_equal(found[0], found[1])
    np.testing.assert_array_equal(found[0], found[2])


def test_the_crank_s_four_bar_is_tied_to_the_rockers():
    count = 0
    for a, b, c, d, _, L, m, n, p, q, r, _, s, share in completed(np.random.default_rng(13), 60):
        for (e, f), (x, y), sizes in (((a, b), (m, p), (s, share)), ((b, a), (n, q), (d - s, 1 - share))):
            # N S F Q is the same with M and N exchanged
            mu = sizes[1] / L
            assert same(abs(x * sizes[0]), abs(mu * e * d))
            assert same(abs(y) * r, abs(mu) * f * c)
            left, right = x * x + sizes[0] ** 2 - y * y - r * r, mu * (e * e + d * d - f * f - c * c)
            assert same(left, right, x * x, sizes[0] ** 2, y * y, r * r)
        M, P, S = abs(m), abs(p), abs(s)
        stretched, folded = (M + P) ** 2 - (S + r) ** 2, (S - r) ** 2 - (M - P) ** 2
        gaps = (a + b - c - d) * (a + c - b - d) * (a + d - b - c) * (a + b + c + d)
        assert same(stretched * folded, -((share / L) ** 2) * gaps, (M + P + S + r) ** 4)
        count += 1
    assert count > 60
