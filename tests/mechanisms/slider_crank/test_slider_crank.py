"""The slider-crank: classes and dead centres by exact arithmetic, textbooks, extremes, the planar 4R as a limit.

Its formulas are held by the loops (tests/precision/test_loops.py).
"""

from __future__ import annotations

import re
from fractions import Fraction
from itertools import product
from pathlib import Path

import mpmath as mp
import numpy as np
import pytest
from tests.support.slider_crank_configurations import MASSES, PUMP, SLIDER_CRANK, lengths

import fastlink as fl
from fastlink.app.study import run_study
from fastlink.errors import InputError
from fastlink.mechanisms import catalogue
from fastlink.numerics.compensated import UNIT_ROUNDING

CLASS_FLAGS = catalogue("slider_crank").facts["grashof_class"].flags

STATUS_FLAGS = SLIDER_CRANK.facts["status"].flags
STUDY = Path(__file__).parents[3] / "data" / "studies" / "slider_crank_press.toml"


def at(names, **given):
    with np.errstate(all="ignore"):
        return fl.evaluate("slider_crank", names, allow_invalid=True, **{"theta": 1.0} | given)


# -- classes ------------------------------------------------------------------------------------------------------


def exact_class(r, l, e):
    e = abs(e)
    if e > r + l:
        return "never_assembles"
    if e == abs(l - r):
        return "change_point_isosceles" if e == 0 else "change_point"
    if e > abs(l - r):
        return "neither_turns_fully"
    return "crank_turns_fully" if l > r else "rod_turns_fully"


def test_classes_are_those_of_exact_arithmetic():
    # Of lengths that assemble at one angle the next doubles assemble at none. Tenths are not doubles: a gap that is
    # zero for the lengths meant is zero here.
    cases = [(r, l, e) for r, l, e in product(range(1, 8), range(1, 8), range(-15, 16)) if abs(e) != r + l]
    tenths = {
        name: np.array(values) / 10 for name, values in zip("rle", zip(*cases, strict=True), strict=True)
    }
    found = at(["grashof_class", "grashof_excess", "status"], **tenths)
    status = {"crank_turns_fully": "rotates_fully", "never_assembles": "never_assembles"}
    status |= dict.fromkeys(("change_point", "change_point_isosceles"), "change_point")
    seen = set()
    for i, (r, l, e) in enumerate(cases):
        expected = exact_class(r, l, e)
        seen.add(expected)
        assert CLASS_FLAGS[int(found["grashof_class"][i])] == expected, (r, l, e)
        assert STATUS_FLAGS[int(found["status"][i])] == status.get(
            expected, "assembles_over_part_of_the_turn"
        )
        excess, value = Fraction(abs(e) - abs(l - r), 10), float(found["grashof_excess"][i])
        assert abs(Fraction(value) - excess) <= 4 * UNIT_ROUNDING * (r + l + abs(e)) / 10
        assert (value == 0) == (excess == 0)
    assert seen == set(CLASS_FLAGS.values()) - {"invalid_input"}


@pytest.mark.parametrize(
    "wrong", [{"r": 0.0}, {"l": -1.0}, {"r": np.inf}, {"l": np.nan}, {"e": np.inf}, {"e": np.nan}]
)
def test_what_is_no_length_is_invalid(wrong):
    given = {"r": 1.0, "l": 2.0, "e": 0.5} | wrong
    found = at(["status", "grashof_class", "stroke", "slider_position"], **given, branch=1)
    assert STATUS_FLAGS[int(found["status"])] == "invalid_input"
    assert CLASS_FLAGS[int(found["grashof_class"])] == "invalid_input"
    assert np.isnan(found["stroke"])
    assert np.isnan(found["slider_position"])


# -- dead centres, ranges -----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("r", "l", "e"), [(0.05, 0.17, e) for e in (0.02, -0.02, 0.0, 0.1199)] + [(0.5, 0.75 + 2.0**-50, 0.25)]
)
def test_dead_centres_and_quick_return_of_a_crank_that_turns(r, l, e):
    """Of sin(theta) = e/(l + r) and -e/(l - r): near a change point, too, where the inner one is near the axis."""
    names = ["theta_outer", "theta_inner", "time_ratio", "stroke", "outer_dead_centre", "inner_dead_centre"]
    found = {name: float(value) for name, value in at(names, r=r, l=l, e=e).items()}
    with mp.workdps(40):
        far, near = mp.mpf(l) + r, mp.mpf(l) - r
        x_o, x_i = mp.sqrt(far**2 - mp.mpf(e) ** 2), mp.sqrt(near**2 - mp.mpf(e) ** 2)
        outer, inner = mp.asin(e / far), mp.pi + mp.asin(e / near)
        beta = abs(inner - mp.pi - outer)
        true = {"outer_dead_centre": x_o, "inner_dead_centre": x_i, "stroke": x_o - x_i}
        true["time_ratio"] = (mp.pi + beta) / (mp.pi - beta)
        for name, value in true.items():
            assert abs(found[name] - value) <= 12 * UNIT_ROUNDING * value, name
        for name, value in (("theta_outer", outer), ("theta_inner", inner)):
            assert abs(mp.expj(found[name]) - mp.expj(value)) <= 8 * mp.pi * UNIT_ROUNDING
    assert (found["time_ratio"] == 1.0) == (e == 0.0)


@pytest.mark.parametrize(("r", "l", "e"), [(1, 3, -1.5), (3, 1, 0.5), (2, 2.5, 1), (2, 1.5, -1), (1, 1, 1.5)])
def test_ranges_are_where_the_rod_reaches_the_line(r, l, e):
    """r sin(theta) from e - l to e + l; where the rod turns fully, the slider stays on one side."""
    names = ["theta_low", "theta_high", "stroke", "outer_dead_centre", "inner_dead_centre", "time_ratio"]
    found = at(names, r=float(r), l=float(l), e=float(e))
    for name, sine in (("theta_low", (e - l) / r), ("theta_high", (e + l) / r)):
        assert found[name] == pytest.approx(np.arcsin(np.clip(sine, -1.0, 1.0)), rel=1e-14)
    outer, inner = np.sqrt((l + r) ** 2 - e * e), (l - r) ** 2 - e * e
    assert found["outer_dead_centre"] == pytest.approx(outer, rel=1e-14)
    through = inner < 0
    assert found["stroke"] == pytest.approx(2 * outer if through else outer - np.sqrt(inner), rel=1e-14)
    assert np.isnan(found["inner_dead_centre"]) == through
    assert np.isnan(found["time_ratio"]) == (not l > r + abs(e))


# -- extremes -----------------------------------------------------------------------------------------------------


def swept(names, designs, **options):
    return fl.sweep("slider_crank", fl.table(designs), names, threads=1, **options)


def random_designs(n):
    drawn = dict(zip("rle", lengths("random", np.random.default_rng(3), n), strict=True))
    return drawn | {"omega": np.full(n, 1.5)} | {name: np.full(n, value) for name, value in MASSES.items()}


def test_the_extremes_of_the_position_are_the_dead_centres():
    ends = ["slider_position_max", "slider_position_min"]
    places = [f"theta_at_{name}" for name in ends]
    facts = ["theta_outer", "theta_inner", "stroke", "outer_dead_centre", "inner_dead_centre"]
    found = swept([*ends, *places, *facts, "grashof_class"], random_designs(300))
    turns = found.grashof_class.values == 0
    assert np.count_nonzero(turns) > 30
    of = {name: found[name].values[turns] for name in (*ends, *places, *facts)}
    greatest, least = of["slider_position_max"], of["slider_position_min"]
    size = 16 * UNIT_ROUNDING * of["outer_dead_centre"]
    for one, other in (
        (greatest[:, 0], of["outer_dead_centre"]),
        (least[:, 0], of["inner_dead_centre"]),
        (greatest[:, 1], -of["inner_dead_centre"]),
        (least[:, 1], -of["outer_dead_centre"]),
        (greatest[:, 0] - least[:, 0], of["stroke"]),
    ):
        assert np.all(abs(one - other) <= size)
    # Two units in the last place of the place in the range, whose angle is its arctangent, and roundings of pi.
    for name, angle in (
        ("slider_position_max", [of["theta_outer"], np.pi - of["theta_inner"]]),
        ("slider_position_min", [of["theta_inner"], np.pi - of["theta_outer"]]),
    ):
        off = of[f"theta_at_{name}"] - np.transpose(angle)
        assert np.all(abs(off - 2 * np.pi * np.rint(off / (2 * np.pi))) < 1e-13)


def test_least_and_greatest_transmission_angle_are_those_of_the_turn():
    designs = {name: values for name, values in random_designs(200).items() if name in "rle"}
    ends = {"least": "min", "greatest": "max"}
    names = [f"transmission_angle_{end}" for pair in ends.items() for end in pair]
    found = swept(names, designs, branch=1)
    for of_design, of_turn in ends.items():
        one, other = (found[f"transmission_angle_{end}"].values for end in (of_design, of_turn))
        assert np.count_nonzero(np.isfinite(one)) > 100
        # Near 0 and pi as the root of a gap that is right to a few roundings.
        np.testing.assert_allclose(one, other, rtol=16 * UNIT_ROUNDING, atol=0)


def test_rates_of_the_rod_have_one_maximum_and_one_minimum_where_the_polynomial_says():
    """omega2' = 0 is (l^2 - r^2 - e^2) s + e r (1 + s^2) = 0 in s = sin(theta): two angles of a turning crank."""
    designs = random_designs(400)
    found = swept(["omega2_extrema", "grashof_class"], designs)
    turning = np.flatnonzero(found.grashof_class.values == 0)
    assert turning.size > 30
    for i in turning:
        r, l, e = (designs[name][i] for name in "rle")
        np.testing.assert_array_equal(found.omega2_extrema_count.values[i], 2)
        roots = np.roots([e * r, l * l - r * r - e * e, e * r])
        (sine,) = roots[abs(roots) < 1.0]
        for k in range(2):
            places = found.theta_at_omega2_extrema.values[i, k]
            assert sorted(np.sign(found.omega2_extrema_kind.values[i, k])) == [-1, 1]
            # a root of a quadratic equation of coefficients right to a rounding
            np.testing.assert_allclose(np.sin(places), sine, rtol=1e-10, atol=1e-13)
            np.testing.assert_allclose(np.sum(np.cos(places)), 0.0, atol=1e-10)


def test_beyond_a_toggle_rates_grow_without_bound():
    designs = {"r": [2.0], "l": [1.0], "e": [0.25], "omega": [1.0]}
    found = swept(["slider_velocity_max", "slider_position_max", "omega2_max", "omega2_min"], designs)
    assert np.all(found.slider_velocity_max.values == np.inf)
    assert np.all(found.omega2_max.values == np.inf)
    assert np.all(found.omega2_min.values == -np.inf)
    assert np.all(np.isfinite(found.slider_position_max))
    # exactly there, e - r sin(0) = l: the rod is square to the line; beyond, nothing but the crank has a place
    given = {"r": 2.0, "l": 1.0, "e": 1.0, "omega": 1.0, "theta": [0.0, -0.5], "branch": 1}
    there = at(["slider_position", "omega2", "A_x"], **given)
    assert (there["slider_position"][0], abs(there["omega2"][0])) == (2.0, np.inf)
    assert np.isnan([there["slider_position"][1], there["omega2"][1]]).all()
    assert np.isfinite(there["A_x"][1])


def test_where_the_rod_passes_pi_its_direction_reaches_both():
    found = swept(["theta2_max", "theta2_min"], {name: [PUMP[name]] for name in "rle"})
    assert (found.theta2_max.values[0, 1], found.theta2_min.values[0, 1]) == (np.pi, -np.pi)
    # sin(theta2) = (e - r sin(theta))/l is extreme where the crank is square to the line
    r, l, e = (PUMP[name] for name in "rle")
    np.testing.assert_allclose(found.theta2_max.values[0, 0], np.arcsin((e + r) / l), rtol=8 * UNIT_ROUNDING)
    np.testing.assert_allclose(found.theta2_min.values[0, 0], np.arcsin((e - r) / l), rtol=16 * UNIT_ROUNDING)


def test_mirrored_searches_are_those_of_each_branch():
    """What the mirror theta to pi - theta says of the other branch is what a search of that branch says."""
    designs = random_designs(50)
    names = ["slider_velocity_max", "slider_acceleration_min", "theta_at_slider_acceleration_max"]
    both = swept(names, designs)
    for k, branch in enumerate((1, 2)):
        alone = swept(names, designs, branch=branch)
        for name in names:
            one, other = both[name].values[:, k], alone[name].values
            np.testing.assert_allclose(one, other, rtol=1e-13, atol=1e-13, err_msg=name)
    assert catalogue("slider_crank").graded.axis == np.pi / 2


# -- textbooks, limits, studies -----------------------------------------------------------------------------------


def test_the_series_of_textbooks_for_no_offset():
    """x = l + r cos(theta) - r (lambda/2 sin^2 + lambda^3/8 sin^4 + lambda^5/16 sin^6) - ..., lambda = r/l."""
    r, l, theta = 0.03, 1.0, np.linspace(-3.0, 3.0, 25)
    ratio, s2 = r / l, np.sin(theta) ** 2
    found = at(["slider_position", "slider_acceleration"], r=r, l=l, e=0.0, omega=2.0, theta=theta, branch=1)
    series = l + r * np.cos(theta) - r * (ratio / 2 * s2 + ratio**3 / 8 * s2**2 + ratio**5 / 16 * s2**3)
    # What is left out is below 5/128 lambda^7 r/(1 - lambda^2), 3e-14; both sides take a few roundings of l.
    left_out = 0.05 * ratio**7 * r + 4 * UNIT_ROUNDING * l
    np.testing.assert_allclose(found["slider_position"], series, rtol=0, atol=left_out)
    A2, A4 = ratio + ratio**3 / 4 + 15 * ratio**5 / 128, ratio**3 / 4 + 3 * ratio**5 / 16
    harmonics = np.cos(theta) + A2 * np.cos(2 * theta) - A4 * np.cos(4 * theta)
    harmonics += 9 * ratio**5 / 128 * np.cos(6 * theta)
    # The second derivative of what is left out: at most 64 times as much.
    left_out = 4 * r * (3 * ratio**7 + 16 * UNIT_ROUNDING)
    np.testing.assert_allclose(found["slider_acceleration"], -r * 4.0 * harmonics, rtol=0, atol=left_out)


@pytest.mark.parametrize("branch", [1, 2])
def test_a_planar_4r_with_ground_and_output_link_ever_longer(branch):
    """D goes to infinity across the line: what is left of the difference halves when the lengths double.

    The slider is a point mass at B: the output link with its mass centre there.
    """
    theta, (r, l, e) = np.array([-2.0, -0.7, 0.4, 1.2, 2.6]), (0.25, 1.0, 0.125)
    bars = {name: value for name, value in MASSES.items() if name != "m3"} | {"m3": 0.5}
    names = ["omega2", "alpha2", "jerk2", "transmission_angle", "T41", "F21", "F41"]
    here = at(names, r=r, l=l, e=e, omega=2.0, theta=theta, branch=branch, **bars)
    left = []
    for far in (2.0**12, 2.0**13):
        four_bar = {"a1": r, "a2": l, "a3": far, "a4": far + e, "omega1": 2.0, "theta1": theta - np.pi / 2}
        output = {"I3": 0.0, "G3_u": far, "G3_v": 0.0}
        there = fl.evaluate("planar_4r", names, **four_bar, **bars, **output, branch=branch)
        left.append({name: there[name] - here[name] for name in names})
    for name in names:
        # (l + r)^2/(2 far) is how far B is off the line; the next term is as much smaller again, and (e/far).
        np.testing.assert_allclose(left[0][name], 2.0 * left[1][name], rtol=0.01, atol=1e-9, err_msg=name)
        assert 0.0 < np.max(abs(left[0][name])) < 1e-2


def test_the_mirror_image_at_the_line_through_O_has_the_same_bits():
    """theta to -theta and e to -e: every operation has its mirror image."""
    rng = np.random.default_rng(11)
    r, l, e, theta = (
        *rng.uniform(0.2, 2.0, (2, 500)),
        rng.uniform(0.01, 1.5, 500),
        rng.uniform(-3.1, 3.1, 500),
    )
    along, across = (
        ["slider_position", "slider_velocity", "slider_jerk"],
        ["theta2", "A_y", "omega2", "jerk2"],
    )
    for branch in (1, 2):
        one = at([*along, *across], r=r, l=l, e=e, omega=1.3, theta=theta, branch=branch)
        other = at([*along, *across], r=r, l=l, e=-e, omega=-1.3, theta=-theta, branch=branch)
        for name in one:
            sign = -1.0 if name in across else 1.0
            np.testing.assert_array_equal(other[name], sign * one[name], err_msg=name)


def test_links_of_a_round_bar_are_those_of_the_planar_4r_and_the_slider_s_mass_is_asked_for():
    planar, links = catalogue("planar_4r"), fl.round_bar(7850.0, 0.01)
    for name in ("m1", "I1", "G1_u", "m2", "I2", "G2_u", "G2_v"):
        one, other = (known.variants["round_bar"][name] for known in (planar, SLIDER_CRANK))
        text = "\n".join(one.formula.lines)
        for own, here in {"a1": "r", "a2": "l"}.items():
            text = re.sub(rf"\b{own}\b", here, text)
        assert text == "\n".join(other.formula.lines)
    mass, given = 7850.0 * np.pi * 0.01**2, {}
    for i, a in ((1, PUMP["r"]), (2, PUMP["l"])):
        given |= {
            f"m{i}": mass * a,
            f"I{i}": mass * a * (a * a / 12 + 0.25e-4),
            f"G{i}_u": a / 2,
            f"G{i}_v": 0.0,
        }
    found, same = (at(["T41"], **PUMP, m3=0.8, branch=1, **of)["T41"] for of in ({"links": links}, given))
    # the masses here are rounded a few times themselves
    np.testing.assert_allclose(found, same, rtol=32 * UNIT_ROUNDING)
    with pytest.raises(InputError, match="m3"):
        at(["T41"], **PUMP, branch=1, links=links)


def test_the_study_of_quick_return(folder):
    path = Path(STUDY.name)
    text = STUDY.read_text(encoding="utf-8").replace(", 31]", ", 7]")
    path.write_text(text, encoding="utf-8")
    with run_study(path) as maps:
        maps = maps.load()
    assert maps.sizes["l"] == maps.sizes["e"] == 7
    turns = maps.l > 0.1 + maps.e + 1e-12  # tenths are not doubles
    np.testing.assert_array_equal(np.isfinite(maps.time_ratio), turns)
    np.testing.assert_array_equal(maps.time_ratio.sel(e=0.0), 1.0)
    # The farther the line is off, the quicker the return and the worse the transmission.
    for name in ("time_ratio", "transmission_angle_greatest"):
        steps = np.diff(maps[name].where(turns).values, axis=maps[name].dims.index("e"))
        assert np.nanmin(steps) > 0.0, name
    # of a whole turn: both ends of the stroke are extremes of the position
    way = 4.0 * 0.1 * maps.l / (maps.outer_dead_centre + maps.inner_dead_centre)
    np.testing.assert_allclose(maps.stroke.where(turns), way.where(turns), rtol=16 * UNIT_ROUNDING)
    assert np.all(maps.T41_fluctuation.where(turns).fillna(1.0) > 0.0)
