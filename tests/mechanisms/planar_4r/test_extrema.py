"""Every extremum of the rates against exact root counts, and the rules that extrema obey, by the million."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from tests.support.extrema_counts import exact_count
from tests.support.extrema_families import FAMILIES, found, names_of, space
from tests.support.extrema_oracle import RATES, extrema
from tests.support.extrema_rules import TURN, ends

import fastlink as fl
from fastlink.numerics.compensated import UNIT_ROUNDING

# Errors of a value, in roundings of the terms that make it up, each a product of a dozen factors: 10 is the worst seen.
VALUE_ROUNDINGS = 16
# Of a place, in roundings of the terms of the derivative, over the second derivative: 2 is the worst seen.
PLACE_ROUNDINGS = 8


#: A maximum and a minimum lie closer than two samples of the graded range: once lost.
CLOSE_PAIRS = (
    ("omega2", "0x1.e3c0507757806p-5 0x1.05a089228ac14p-1 0x1.1855aba3b20c5p-1 0x1.ffba3a14b9370p-1"),
    ("alpha2", "0x1.474ec0961a020p-1 0x1.bcd14b5615ba8p-1 0x1.a738686b2965ep-1 0x1.31d3853a76442p-1"),
    ("alpha4", "0x1.d3039c9028804p-1 0x1.d3039d8c3cd9fp-1 0x1.fa2c3bd74af26p-1 0x1.f9f4ce2efe95fp-1"),
    ("alpha4", "0x1.b3d726abf5828p-1 0x1.b436b62c41483p-1 0x1.61b65f6c0d49ap-1 0x1.61b61c0a60451p-1"),
    ("alpha4", "0x1.67d5089fa617dp-2 0x1.65cf1d6658557p-2 0x1.ca27dbece0cb4p-1 0x1.c92f43b8548c4p-1"),
    ("alpha4", "0x1.2677339bf9146p-1 0x1.c7c55617245acp-2 0x1.267738e72bee3p-1 0x1.c88897b8db295p-2"),
    ("alpha4", "0x1.e19fa7ab2b728p-2 0x1.532831e660cafp-1 0x1.e065ccbfc24a3p-2 0x1.535366117ffe7p-1"),
    ("alpha4", "0x1.ac54ef7ecab5ap-1 0x1.4d10041aeb1a4p-1 0x1.ace3aed5a592cp-1 0x1.4d0f958befc50p-1"),
    ("alpha4", "0x1.b1a46e04b45acp-1 0x1.d255f5a012f5ep-1 0x1.b1a4cc3485c88p-1 0x1.d231078f62e2bp-1"),
    ("alpha4", "0x1.25589db5b6951p-1 0x1.1f40c24b99b0ap-1 0x1.255ef47e51efbp-1 0x1.1f40eaa8e391cp-1"),
    ("alpha2", "0x1.6a7c05ec757a2p-1 0x1.85c6c662c5446p-2 0x1.6b2445c1214b6p-1 0x1.85c6e1f16056cp-2"),
    ("alpha2", "0x1.a24373d3ab0d6p-2 0x1.e05dc1d19ccd2p-1 0x1.a2435895f2152p-2 0x1.de6a13c59994cp-1"),
    ("alpha2", "0x1.25589db5b6951p-1 0x1.1f40c24b99b0ap-1 0x1.255ef47e51efbp-1 0x1.1f40eaa8e391cp-1"),
    ("omega2", "0x1.c3bc7fbe3a453p-4 0x1.8bff7b5676eedp-1 0x1.7bf6dd80b1f1bp-1 0x1.668db043e8231p-4"),
    ("omega2", "0x1.26ae37ded32cdp-2 0x1.e58dc20845636p-1 0x1.8ae56dbe3062bp-1 0x1.d3d6ead5c49f7p-4"),
    ("omega2", "0x1.eafb308932733p-1 0x1.2c3e8de451cd4p-3 0x1.7d6151c1f3783p-1 0x1.610963aba2035p-2"),
    ("omega4", "0x1.cf7353e5174a9p-2 0x1.367731e95ea8cp-2 0x1.aec30973e395cp-3 0x1.37973bdb900edp-4"),
    ("omega4", "0x1.d9fcb942dc0cfp-1 0x1.0da514e60f50dp-1 0x1.01c6ead562789p-1 0x1.e8a0091f9e782p-4"),
    ("omega4", "0x1.dfd070d6513efp-1 0x1.db6b672190e4ap-2 0x1.1b0305110c76dp-1 0x1.52caa1b84342ep-4"),
    ("omega2", "0x1.2a8f79c9e035ap-5 0x1.74af362236deep-6 0x1.1db7552896d8fp-6 0x1.25e49316a700cp-8"),
    ("omega2", "0x1.62201e7990eccp+4 0x1.79d3d72c42d1bp+4 0x1.ed039f431c87ep+0 0x1.574883638fda9p-1"),
    ("omega4", "0x1.1e7bd89cbeb51p+6 0x1.f55f94b87191bp+5 0x1.5629dc2214726p+3 0x1.26e4e9343686cp+4"),
    ("omega4", "0x1.a8ef6122b227fp-2 0x1.0adffbf59b3e8p-2 0x1.e494a46ef1dfbp-5 0x1.a4bce3c18cd79p-3"),
    ("omega4", "0x1.36a1b410ddbc5p-5 0x1.94613b90f5b42p-6 0x1.293dc16af09adp-8 0x1.1eed221412eb0p-6"),
    ("omega2", "0x1.3e550196c02a5p+1 0x1.7b417efb150a4p+2 0x1.1171d0781fb31p+2 0x1.4a9f3f4d6c521p+0"),
    ("omega2", "0x1.3c42bc9636ba3p+5 0x1.a6409a4e90998p+2 0x1.0a8d6260097f2p+5 0x1.0a95c33264bb1p+6"),
    ("omega2", "0x1.1368ceda20531p+9 0x1.09384756a1940p+8 0x1.617ed01286839p+8 0x1.36449d19cb542p+6"),
)


def hexadecimal(lengths: np.ndarray) -> str:
    return ", ".join(float(length).hex() for length in lengths)


def circular(difference: np.ndarray) -> np.ndarray:
    """Return the distance of angles over the turn."""
    return np.abs((difference + np.pi) % TURN - np.pi)


@pytest.mark.sample(2)
@pytest.mark.parametrize("n", [150, pytest.param(2500, marks=pytest.mark.stress)])
@pytest.mark.parametrize("family", FAMILIES)
def test_none_is_missed_and_each_is_right_to_rounding(family, n):
    """2000 designs, 20000 in the long run, by exact real root counts."""
    lengths = FAMILIES[family](np.random.default_rng(n + len(family)), n)
    engine = found(lengths, RATES)
    for quantity in RATES:
        value, theta1, count, kind = engine[quantity]
        for i in range(n):
            exact = extrema(lengths[:, i], quantity)
            for k, branch in enumerate((1, 2)):
                points = [point for point in exact if point.branch == branch]
                about = f"{quantity}, branch {branch}, lengths {hexadecimal(lengths[:, i])}"
                m = len(points)
                assert count[i, k] == m, f"{count[i, k]} found, {m} exist: {about}"
                padding = [value[i, k, m:], theta1[i, k, m:], np.where(kind[i, k, m:] == 0, np.nan, 0.0)]
                assert np.all(np.isnan(padding)), about
                for j, point in enumerate(points):
                    assert kind[i, k, j] == point.kind, about
                    # 1e-14 relative, unless the terms of the value cancel.
                    allowed = max(
                        1e-14 * abs(point.value), VALUE_ROUNDINGS * UNIT_ROUNDING * point.value_terms
                    )
                    assert abs(value[i, k, j] - point.value) <= allowed, about
                    # The last of these is a rounding of an angle up to 2 pi, in the oracle and in the engine.
                    allowed = PLACE_ROUNDINGS * UNIT_ROUNDING * point.theta1_terms + 4 * UNIT_ROUNDING * TURN
                    assert circular(theta1[i, k, j] - point.theta1) <= allowed, about


@pytest.mark.parametrize("longest", [5, pytest.param(12, marks=pytest.mark.stress)])
@pytest.mark.parametrize("quantity", RATES)
def test_extremes_of_whole_lengths_are_counted_exactly(quantity, longest):
    """Many of these linkages are degenerate: (5, 3, 2, 2) has an inflection that looked like a pair."""
    lengths = [
        (a, b, c, d)
        for a, b, c, d in itertools.product(range(1, longest + 1), repeat=4)
        if math.gcd(a, b, c, d) == 1 and 2 * max(a, b, c, d) < a + b + c + d
        if a + b != c + d and a + c != b + d and a + d != b + c
    ]
    _, _, count, _ = found(np.array(lengths, dtype=float).T, [quantity])[quantity]
    expected = [exact_count(each, quantity) for each in lengths]
    np.testing.assert_array_equal(count, np.stack([expected, expected], axis=-1))


def test_close_pairs_are_found():
    lengths = np.array([[float.fromhex(length) for length in text.split()] for _, text in CLOSE_PAIRS]).T
    engine = found(lengths, RATES)
    for i, (quantity, text) in enumerate(CLOSE_PAIRS):
        counted = [point.branch for point in extrema(lengths[:, i], quantity)]
        _, _, count, _ = engine[quantity]
        assert count[i].tolist() == [counted.count(1), counted.count(2)], (quantity, text)


@pytest.mark.parametrize(
    ("lengths", "greatest", "least"),
    [
        ((0.5, 1.0, 0.5, 1.0), 1.0, -3.0),
        ((0.5, 1.0, 1.0, 0.5), 0.75, 0.25),
        ((0.5, 0.5, 1.0, 1.0), 2.0 / 3.0, -2.0),
        ((1.0, 1.0, 1.0, 1.0), 1.0, 0.0),
    ],
)
def test_at_a_change_point_limits_count_and_errors_are_no_extrema(lengths, greatest, least):
    """Both modes meet at folds, where omega4 has its limits; where it is constant there is no extreme."""
    one = fl.grid(**dict(zip(("a1", "a2", "a3", "a4"), lengths, strict=True)), omega1=1.0)
    result = fl.sweep("planar_4r", one, ["omega4_max", "omega4_min", "omega4_extrema_count"])
    # Ten roundings of terms of a size of 4.
    np.testing.assert_allclose(result.omega4_max, greatest, rtol=0, atol=40 * UNIT_ROUNDING)
    np.testing.assert_allclose(result.omega4_min, least, rtol=0, atol=40 * UNIT_ROUNDING)
    assert (result.omega4_extrema_count == 0).all()


def taken(lengths: np.ndarray, quantity: str, **options):
    """Return max, min and their places, and the extrema with their places."""
    names = [f"{quantity}_max", f"{quantity}_min"]
    asked = [*names, *(f"theta1_at_{name}" for name in names), f"{quantity}_extrema"]
    result = fl.sweep("planar_4r", space(lengths), asked, **options)
    return [result[name].values for name in (*asked, f"theta1_at_{quantity}_extrema")]


@pytest.mark.sample(5)
@pytest.mark.parametrize("family", FAMILIES)
@pytest.mark.parametrize("quantity", RATES)
def test_max_and_min_are_the_outermost_extrema_or_infinite_at_a_toggle(family, quantity):
    lengths = FAMILIES[family](np.random.default_rng(90), 200)
    *taken_over, extremum, place = taken(lengths, quantity)
    angles, grows = ends(lengths, quantity)
    for sign, value, theta1 in ((1, *taken_over[::2]), (-1, *taken_over[1::2])):
        unbounded = np.any(grows * ~np.isnan(angles) == sign, axis=2)
        np.testing.assert_array_equal(value[unbounded], sign * np.inf)
        # Where it is: at one of the toggles where the ratio grows that way, as theta1_low and theta1_high have it.
        near = circular(theta1[:, :, None] - angles) <= 8 * UNIT_ROUNDING * TURN
        assert np.all(np.any(near & (grows == sign), axis=2)[unbounded])
        bounded = ~unbounded
        best = np.nanargmax(sign * extremum[bounded], axis=1)[:, None]
        np.testing.assert_array_equal(value[bounded], np.take_along_axis(extremum[bounded], best, 1)[:, 0])
        np.testing.assert_array_equal(theta1[bounded], np.take_along_axis(place[bounded], best, 1)[:, 0])


@pytest.mark.parametrize("family", ["crank", "drag-link", "rocker input", "non-Grashof"])
def test_the_transmission_angle_has_its_extremes_at_0_pi_and_toggles(family):
    """A bounded quantity counts at a toggle, too; stationary it is where the input is aligned with the ground."""
    lengths = FAMILIES[family](np.random.default_rng(91), 200)
    greatest, least, at_greatest, at_least, extremum, place = taken(lengths, "transmission_angle")
    closed = ["transmission_angle_least", "transmission_angle_greatest", "theta1_low", "theta1_high"]
    facts = fl.sweep("planar_4r", space(lengths), closed, theta1=[0.0])
    low, high = facts.theta1_low.values[:, None], facts.theta1_high.values[:, None]
    # Both are within a few roundings of the exact angle.
    for one, other in (("greatest", greatest), ("least", least)):
        np.testing.assert_allclose(
            other, np.tile(facts[f"transmission_angle_{one}"], (2, 1)).T, rtol=16 * UNIT_ROUNDING
        )
    assert np.all(np.abs(np.minimum(at_least, TURN - at_least) - low) <= 8 * UNIT_ROUNDING * TURN)
    assert np.all(np.abs(np.minimum(at_greatest, TURN - at_greatest) - high) <= 8 * UNIT_ROUNDING * TURN)
    # Stationary at 0 and at pi, where these are within reach.
    np.testing.assert_array_equal(
        np.sum(~np.isnan(extremum), axis=2), np.tile((low == 0) + 0 + (high == np.pi), 2)
    )
    assert np.all(np.isnan(place) | (np.abs(np.sin(place)) <= 8 * UNIT_ROUNDING * TURN))


def test_the_swing_of_a_crank_rocker_lies_between_extrema_of_theta4():
    """Crank and coupler in line, stretched and folded: triangles of sides a2 + a1 and a2 - a1, a3, a4."""
    lengths = FAMILIES["crank"](np.random.default_rng(92), 200)
    a, b, c, d = lengths
    greatest, least, *_ = taken(lengths, "theta4")
    interior = [np.arccos((c**2 + d**2 - (b + sign * a) ** 2) / (2 * c * d)) for sign in (1, -1)]
    upper = np.pi - np.array(interior)
    # The law of cosines cancels; of lengths between 0.05 and 1 and angles away from 0 and pi it leaves twelve digits.
    good = np.min(np.sin(upper), axis=0) > 0.1
    assert good.sum() > 100
    np.testing.assert_allclose(greatest[good, 1], np.max(upper, axis=0)[good], rtol=1e-11)
    np.testing.assert_allclose(least[good, 1], np.min(upper, axis=0)[good], rtol=1e-11)
    np.testing.assert_array_equal(greatest[:, 0], -least[:, 1])
    np.testing.assert_array_equal(least[:, 0], -greatest[:, 1])


@pytest.mark.sample(2)
@pytest.mark.parametrize("quantity", [*RATES, "transmission_angle", "B_x"])
def test_samples_never_exceed_the_refined_extremes_and_come_close(quantity):
    rng = np.random.default_rng(93)
    # Cranks far from a change point: what happens between two of 3600 samples is a parabola.
    lengths = rng.uniform([[0.2], [0.8], [0.8], [0.8]], [[0.4], [1.2], [1.2], [1.2]], (4, 200))
    refined = taken(lengths, quantity)[:2]
    names = [f"{quantity}_max", f"{quantity}_min"]
    samples = fl.sweep("planar_4r", space(lengths), names, theta1=3600, extrema="sampled")
    sampled = [samples[name].values for name in names]
    for sign, exact, seen in zip((1, -1), refined, sampled, strict=True):
        size = np.abs(exact) + 1.0
        gain = sign * (exact - seen)
        assert np.all(gain >= -16 * UNIT_ROUNDING * size)
        # f'' h^2/8 at most, h the step of 2 pi/3600; f'' of these linkages is below 30 times 1 + |f|.
        assert np.all(gain <= 30 * (TURN / 3600) ** 2 / 8 * size)
    assert np.any(refined[0] != sampled[0])


@pytest.mark.parametrize("family", ["crank", "non-Grashof", "change-point gap"])
def test_bits_do_not_depend_on_how_or_what_else_is_asked(family, tmp_path):
    lengths = FAMILIES[family](np.random.default_rng(94), 150)
    whole = found(lengths, RATES)

    def assert_same(other, branches=slice(None)):
        for quantity, arrays in other.items():
            for one, two in zip(whole[quantity], arrays, strict=True):
                # The dimension is as long as the longest list that is asked for: what one of them has more is padding.
                padding = [(0, 0)] * (two.ndim - 1) + [(0, one.shape[-1] - two.shape[-1])]
                empty = np.nan if two.dtype == float else 0
                wide = np.pad(two, padding, constant_values=empty) if two.ndim == 3 else two
                np.testing.assert_array_equal(one[:, branches], wide)

    assert_same(found(lengths, RATES, threads=1))
    assert_same(found(lengths, RATES, threads=2, block=16))
    assert_same(found(lengths, RATES, block=7))
    assert_same(found(lengths, ["alpha4"]))
    assert_same(found(lengths, ["omega2", "omega4"]))
    assert_same(found(lengths, ["alpha2"], branch=[1]), slice(0, 1))
    assert_same(found(lengths, RATES, branch=[2]), slice(1, 2))
    assert_same(found(lengths, RATES, to=tmp_path / "map.h5", verify=0))
    for i in (0, 77):
        one = found(lengths[:, i : i + 1], RATES)
        for quantity in RATES:
            for first, second in zip(whole[quantity], one[quantity], strict=True):
                np.testing.assert_array_equal(first[i : i + 1], second)


def test_the_unit_of_length_changes_no_bit():
    lengths = FAMILIES["crank"](np.random.default_rng(95), 50)
    one = found(lengths, RATES)
    for exponent in (-600, 700):
        other = found(lengths * 2.0**exponent, RATES)
        for quantity in RATES:
            for first, second in zip(one[quantity], other[quantity], strict=True):
                np.testing.assert_array_equal(first, second)


def test_the_input_speed_scales_and_turns_the_extrema_round():
    lengths = FAMILIES["crank"](np.random.default_rng(96), 50)
    one, other = found(lengths, RATES), found(lengths, RATES, omega1=-4.0)
    for quantity in RATES:
        factor = -4.0 if quantity.startswith("omega") else 16.0
        (value, theta1, count, kind), scaled = one[quantity], other[quantity]
        np.testing.assert_array_equal(scaled[0], factor * value)
        np.testing.assert_array_equal(scaled[1], theta1)
        np.testing.assert_array_equal(scaled[2], count)
        np.testing.assert_array_equal(scaled[3], np.sign(factor) * kind)


def test_what_is_constant_has_no_extremum():
    lengths = FAMILIES["crank"](np.random.default_rng(97), 10)
    for quantity, (value, theta1, count, kind) in found(lengths, RATES, omega1=0.0).items():
        np.testing.assert_array_equal([value, theta1], np.nan, err_msg=quantity)
        assert not np.any(count), quantity
        assert not np.any(kind), quantity
    asked = [f"{quantity}_{which}" for quantity in RATES for which in ("max", "min")]
    result = fl.sweep("planar_4r", space(lengths, 0.0), asked)
    for name in asked:
        assert np.all(result[name] == 0), name


def test_what_never_assembles_has_no_extremum():
    lengths = np.array([[1.0], [1.0], [1.0], [5.0]])
    for value, theta1, count, kind in found(lengths, RATES).values():
        np.testing.assert_array_equal([value, theta1], np.nan)
        assert not np.any(count)
        assert not np.any(kind)
    greatest, least, *places, _, _ = taken(lengths, "omega4")
    assert np.all(np.isnan([greatest, least, *places]))


# Table 2 of Hayes et al. (the wrong figures corrected, docs/errata.md): mode, quantity, theta1, value, kind.
TABLE_2 = [
    (1, "omega4", "0.36933536508", "-23.95938172", -1),
    (1, "omega4", "4.616020295", "13.51343678", 1),
    (1, "alpha4", "0.8382412814", "462.6986574", 1),
    (1, "alpha4", "6.134929607", "-1062.775829", -1),
    (2, "omega4", "1.667165012", "13.51343678", 1),
    (2, "omega4", "5.913849943", "-23.95938172", -1),
    (2, "alpha4", "0.1482557001", "1062.775829", 1),
    (2, "alpha4", "5.444944024", "-462.6986574", -1),
]


def test_table_2_of_the_paper():
    result = fl.sweep(
        "planar_4r",
        fl.grid(a1=0.4, a2=1.2, a3=0.8, a4=1.0, omega1=25.0),
        ["omega4_extrema", "alpha4_extrema"],
    )
    for mode, quantity, theta1, value, kind in TABLE_2:
        one = {name: result[name].sel(branch=mode).values for name in names_of(quantity)}
        values, places, count, kinds = one.values()
        assert count == 2
        (j,) = np.flatnonzero(kinds == kind)
        # The printed angles come from a search of flat extrema: up to 1.8e-9 off (test_planar_4r.py).
        assert abs(places[j] - float(theta1)) <= 2e-9
        # All printed digits of the value: some are cut, not rounded.
        assert abs(values[j] - float(value)) <= 10.0 ** -len(value.partition(".")[2])


def test_dimensions_types_and_labels():
    result = fl.sweep(
        "planar_4r", fl.grid(a1=[0.3, 0.4], a2=1.2, a3=0.8, a4=1.0, omega1=25.0), ["omega4_extrema"]
    )
    value, place, count, kind = (result[name] for name in names_of("omega4"))
    assert value.dims == place.dims == kind.dims == ("a1", "branch", "extremum")
    assert count.dims == ("a1", "branch")
    assert count.dtype == kind.dtype == np.int8
    assert value.attrs["units"] == "rad s-1"
    assert place.attrs["units"] == "rad"
    assert "theta1" not in result.dims


def test_bad_input_is_one_clear_line():
    design = fl.grid(a1=0.4, a2=1.2, a3=0.8, a4=1.0, omega1=25.0)
    for quantities, options, message in (
        (["omega4_max"], {"extrema": "foo"}, "extrema: 'foo'.*refined"),
        (["omega4_max"], {"extrema": "refined", "theta1": [0.1, 0.2]}, "extrema.*sampled"),
        (["status_extrema"], {}, "status_extrema"),
    ):
        with pytest.raises(fl.InputError, match=message) as error:
            fl.sweep("planar_4r", design, quantities, **options)
        assert "\n" not in str(error.value)


@pytest.mark.parametrize("crank", [0.3, 0.5])
def test_angles_of_a_kite_come_to_their_limits_at_the_fold(crank):
    """At theta1 = 0 the pins A and D of a kite coincide: its angles have limits there, and no values."""
    space = fl.grid(a1=crank, a2=1.0, a3=1.0, a4=crank)
    found = fl.sweep("planar_4r", space, ["theta4_max", "theta4_min", "theta2_max", "theta2_min"])
    for name in ("theta4", "theta2"):
        # half-turns to the last bit: pi is rounded, and so is the angle next to it
        np.testing.assert_allclose(found[f"{name}_max"], [0.0, np.pi], atol=2.0**-51)
        np.testing.assert_allclose(found[f"{name}_min"], [-np.pi, 0.0], atol=2.0**-51)
