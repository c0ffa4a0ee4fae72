"""The slider-crank: classes and dead centres by exact arithmetic, toggles, and links of round bars."""

import re
from fractions import Fraction
from itertools import product

import mpmath as mp
import numpy as np
import pytest
from tests.support.sweeps import sweep_both

import fastlink as fl
from fastlink.errors import InputError
from fastlink.mechanisms import catalogue
from fastlink.numerics.compensated import UNIT_ROUNDING

SLIDER_CRANK = catalogue("slider_crank")
#: A pump of a crank of 50 mm.
PUMP = {"r": 0.05, "l": 0.17, "e": 0.02, "omega": 100.0}
CLASS_FLAGS = SLIDER_CRANK.facts["grashof_class"].flags

STATUS_FLAGS = SLIDER_CRANK.facts["status"].flags


def at(names, **given):
    with np.errstate(all="ignore"):
        return fl.evaluate("slider_crank", names, allow_invalid=True, **{"theta": 1.0} | given)


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


def test_beyond_a_toggle_rates_grow_without_bound():
    designs = {"r": [2.0], "l": [1.0], "e": [0.25], "omega": [1.0]}
    names = ["slider_velocity_max", "slider_position_max", "omega2_max", "omega2_min"]
    found = sweep_both("slider_crank", fl.table(designs), names)
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
