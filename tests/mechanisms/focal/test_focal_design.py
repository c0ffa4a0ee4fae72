"""Completions of a four-bar to a focal mechanism: the paper's equations, its example, and brute force."""

import itertools

import numpy as np
import pytest
from tests.support.focal_designs import LENGTHS, exact, facts, one, random_designs
from tests.support.sweeps import sweep_both

import fastlink as fl
from fastlink.numerics.compensated import UNIT_ROUNDING
from fastlink.precision.reference import CONTEXT as MP

BARS = ("lambda_", "m", "n", "p", "q", "r", "FT", "s", "T_ratio")
#: 50 digits, of which the worst of these designs loses some ten by cancellation.
LEFT = MP.mpf(10) ** -38
CHEBYSHEV = {"a": 5.0, "b": 5.0, "c": 2.0, "d": 4.0, "rho": 1.0}


def test_s_and_lambda_make_the_design_that_rho_makes():
    """Which the loops hold (test_loops.py)."""
    designs, compared = random_designs(np.random.default_rng(1), 60), 0
    by_rho = exact((*BARS, "rho", "status"))
    for given in ("s", "lambda_"):
        found = exact((*BARS, "rho", "status"), given)
        for i, completion in itertools.product(range(60), (1.0, 2.0)):
            at = by_rho.at(one(designs, i, completion))
            if at["status"] != 0:
                continue
            # of lambda either completion may be that of rho
            inputs = {name: at[name] for name in (*LENGTHS, given)}
            both = [found.at(inputs | {"completion": other}) for other in (1.0, 2.0)]
            alike = [
                all(abs(of[name] - at[name]) <= LEFT * (1 + abs(at[name])) for name in BARS) for of in both
            ]
            assert any(alike), (given, i, completion)
            compared += 1
    assert compared > 100


def test_the_chebyshev_linkage_to_every_digit():
    maps = sweep_both(
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


ANGLES = ("transmission_angle_PQ_least", "transmission_angle_F_least")


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
    designs = random_designs(np.random.default_rng(11), 20_000)
    first, second = (facts(designs, k, ["grashof_class", "crank_type", "status"]) for k in (1.0, 2.0))
    rockers = first["grashof_class"] == 2.0
    between = rockers & (designs["rho"] > 0.0)
    assert between.sum() > 800
    assert (first["status"][between] == 0.0).all()
    real = rockers & (first["status"] == 0.0)
    assert real.sum() > between.sum() + 200
    assert (first["crank_type"][real] == 0.0).all()
    assert (second["crank_type"][real] == 3.0).all()
    # double cranks have it the other way round, triple rockers have none
    cranks = (first["grashof_class"] == 1.0) & (first["status"] == 0.0)
    assert (second["crank_type"][cranks] == 0.0).all()
    assert (first["crank_type"][cranks] == 3.0).all()
    triple = (first["grashof_class"] >= 4.0) & (first["grashof_class"] <= 7.0)
    assert not (first["crank_type"][triple] == 0.0).any()
