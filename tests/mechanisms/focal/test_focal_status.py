"""Status of focal mechanisms at and next to every boundary, and a study at reduced size."""

from fractions import Fraction
from pathlib import Path

import mpmath as mp
import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from tests.support.focal_designs import FACTS, FOCAL, GIVEN, LENGTHS, NUMBERS, facts, random_designs

import fastlink as fl
from fastlink.mechanisms import catalogue
from fastlink.numerics.compensated import UNIT_ROUNDING

STATUS_FLAGS = catalogue("focal").facts["status"].flags

STUDIES = Path(__file__).parents[3] / "data" / "studies"
CODES = {meaning: float(code) for code, meaning in STATUS_FLAGS.items()}
FOUR_BAR = {"a": 5.0, "b": 5.0, "c": 2.0, "d": 4.0}
#: What needs the bars of the completion, and what needs the crank.
BARS, CRANK = ("m", "n", "p", "q"), ("r", "FT", "transmission_angle_PQ_least")
UP, DOWN = np.inf, -np.inf


def beside(x, where):
    """Return the next double."""
    return float(np.nextafter(x, where))


# In small numbers W is exact: 4 for rho = 1, a = b = 1; 1 for rho = -2, a = 2, b = 1; 9 for rho = -4, a = 4, b = 1.
BOUNDARIES = [
    ("completed", {"a": 1.0, "b": 1.0, "c": 0.5, "d": 1.5, "rho": 1.0}),
    ("no_real_lambda_or_rho", {"a": 1.0, "b": 1.0, "c": 0.5, "d": beside(1.5, UP), "rho": 1.0}),
    ("no_real_lambda_or_rho", {"a": 1.0, "b": beside(1.0, DOWN), "c": 0.5, "d": 1.5, "rho": 1.0}),
    ("completed", {"a": 2.0, "b": 1.0, "c": 2.0, "d": 1.0, "rho": -2.0}),
    ("completed", {"a": 2.0, "b": 1.0, "c": beside(2.0, UP), "d": 1.0, "rho": -2.0}),
    ("no_real_lambda_or_rho", {"a": 2.0, "b": 1.0, "c": beside(2.0, DOWN), "d": 1.0, "rho": -2.0}),
    ("no_real_lambda_or_rho", {"a": 4.0, "b": 1.0, "c": 1.0, "d": 2.0, "rho": -4.0}),
    ("p_q_and_r_imaginary", {"a": 4.0, "b": 1.0, "c": 1.0, "d": beside(2.0, DOWN), "rho": -4.0}),
    ("four_bar_never_assembles", {"a": 4.0, "b": 1.0, "c": 1.0, "d": beside(2.0, DOWN), "rho": 4.0}),
    ("four_bar_never_assembles", {"a": 1.0, "b": 1.0, "c": 1.0, "d": beside(3.0, UP), "rho": 4.0}),
    ("F_on_a_straight_line", {"a": 3.0, "b": 6.0, "c": 7.0, "d": 6.0, "rho": -1.0}),
    ("completed", {"a": 3.0, "b": 6.0, "c": 7.0, "d": 6.0, "rho": beside(-1.0, UP)}),
    ("completed", {"a": 3.0, "b": 6.0, "c": 7.0, "d": 6.0, "rho": beside(-1.0, DOWN)}),
    ("lambda_is_0", {"a": 3.0, "b": 6.0, "c": 3.0, "d": 6.0, "rho": -1.0}),
    ("lambda_is_0", {"a": 3.0, "b": 6.0, "c": 3.0, "d": 6.0, "rho": -0.25}),
    ("completed", {"a": 3.0, "b": 6.0, "c": 3.0, "d": 6.0, "rho": beside(-0.25, UP)}),
    ("S_in_M_or_N", {**FOUR_BAR, "rho": 0.0}),
    ("S_in_M_or_N", {**FOUR_BAR, "s": 0.0}),
    ("S_in_M_or_N", {**FOUR_BAR, "s": 4.0}),
    ("completed", {**FOUR_BAR, "s": beside(4.0, UP)}),
    ("completed", {**FOUR_BAR, "s": beside(4.0, DOWN)}),
    ("S_in_M_or_N", {**FOUR_BAR, "lambda_": 1.0}),
    ("completed", {**FOUR_BAR, "lambda_": 6.0}),
    ("no_real_lambda_or_rho", {**FOUR_BAR, "lambda_": 2.0}),
    ("lambda_is_0", {"a": 3.0, "b": 6.0, "c": 3.0, "d": 6.0, "lambda_": 0.0}),
    ("F_on_a_straight_line", {"a": 3.0, "b": 6.0, "c": 3.0, "d": 6.0, "lambda_": 0.75}),
    ("invalid_input", {**FOUR_BAR, "a": -5.0, "rho": 1.0}),
    ("invalid_input", {**FOUR_BAR, "c": np.nan, "rho": 1.0}),
    ("invalid_input", {**FOUR_BAR, "d": np.inf, "rho": 1.0}),
    ("invalid_input", {**FOUR_BAR, "rho": np.nan}),
    ("invalid_input", {**FOUR_BAR, "completion": 3.0, "rho": 1.0}),
]


@pytest.mark.parametrize(("meaning", "design"), BOUNDARIES)
def test_status_at_and_next_to_its_boundaries(meaning, design):
    """With what has a number there, and what has none."""
    design = dict(design)
    given = next(name for name in ("rho", "s", "lambda_") if name in design)
    completion = design.pop("completion", 1.0)
    found = facts({name: [value] for name, value in design.items()}, completion, FACTS, given)
    assert found["status"][0] == CODES[meaning]
    there = {name: bool(np.isfinite(found[name][0])) for name in NUMBERS}
    assert {there[name] for name in CRANK} == {meaning == "completed"}
    assert {there[name] for name in BARS} == {meaning in ("completed", "F_on_a_straight_line")}
    assert there["line_x"] == (meaning == "F_on_a_straight_line")
    assert (found["crank_type"][0] == 5.0) == (meaning != "completed")
    if meaning == "F_on_a_straight_line":
        assert not any(there[name] for name in ("s", "S_x", "T_ratio"))
    if meaning == "invalid_input" and completion != 3.0 and not np.isnan(design.get("rho", 0.0)):
        # the sum of the lengths alone says of what is not a linkage
        assert not any(there[name] for name in NUMBERS if name != "lambda_")


def test_change_points_and_equal_completions_are_told_as_such_and_every_status_is_met():
    # a + b = c + d: everything may lie in line
    found = facts({"a": [5.0], "b": [3.0], "c": [2.0], "d": [6.0], "rho": [1.0]}, 1.0)
    assert found["crank_type"][0] == 4.0
    assert found["transmission_angle_PQ_least"][0] == found["transmission_angle_F_least"][0] == 0.0
    flags = FOCAL.facts["grashof_class"].flags
    kites = {"a": [2.0, 1.0], "b": [1.0, 2.0], "c": [1.0, 1.0], "d": [2.0, 2.0], "rho": [1.0, 1.0]}
    found = facts(kites, 1.0)["grashof_class"]
    assert [flags[int(code)] for code in found] == ["change_point_kite_a_d", "change_point_kite_a_c"]
    one, other = (facts({name: [value] for name, value in BOUNDARIES[0][1].items()}, k) for k in (1.0, 2.0))
    for name in FACTS:
        # S/d and c/S are two roundings off one number, of which lambda is made
        assert_allclose(one[name], other[name], rtol=16 * UNIT_ROUNDING, err_msg=name)
    assert {meaning for meaning, _ in BOUNDARIES} == set(STATUS_FLAGS.values()) - {"beyond_range"}


def quadratic(given, lengths, sign):
    """Return the coefficients of the discriminant times the denominators, by powers of what is given, least first.

    W - (u +- v)^2 = 0 with W = (1 + x)(f^2 + x g^2)/x, where x is the given ratio; s = d x/(1 + x).
    """
    a, b, c, d = map(Fraction, lengths)
    f, g, u, v = (c, d, a, b) if given == "lambda_" else (a, b, c, d)
    of_ratio = (f * f, f * f + g * g - (u + sign * v) ** 2, g * g)
    if given == "rho":
        return of_ratio
    p, q, r = of_ratio
    if given == "lambda_":  # x = lambda - 1
        return p - q + r, q - 2 * r, r
    return p * d * d, q * d - 2 * p * d, p - q + r  # x = s/(d - s), times (d - s)^2


def ratio_of(given, value, d):
    """Return rho of s, lambda - 1 of lambda, exactly."""
    value = Fraction(value)
    if given == "s":
        return value / (Fraction(d) - value)
    return value - 1 if given == "lambda_" else value


def meeting(rng, n, given):
    """Yield lengths, a ratio within three last bits of where completions meet, and whether they exist, exactly."""
    designs = random_designs(rng, n)
    for lengths in zip(*(designs[name].tolist() for name in LENGTHS), strict=True):
        if 2 * max(lengths) >= sum(lengths):  # the four-bar never assembles
            continue
        for sign in (1, -1):
            p, q, r = (mp.mpf(one.numerator) / one.denominator for one in quadratic(given, lengths, sign))
            if q * q < 4 * p * r:
                continue
            root = float((-q + rng.choice([-1, 1]) * mp.sqrt(q * q - 4 * p * r)) / (2 * r))
            for steps in range(-3, 4):
                value = root + steps * float(np.spacing(root))
                x = ratio_of(given, value, lengths[3])
                if (x > 0) == (sign > 0):
                    parts = enumerate(quadratic(given, lengths, sign))
                    excess = sum(part * Fraction(value) ** k for k, part in parts)
                    # W - (u +- v)^2 is that over x: real roots need it positive, or with a negative x negative
                    yield lengths, value, excess >= 0


@pytest.mark.parametrize("given", GIVEN)
def test_the_last_bit_decides_whether_there_is_a_completion(given):
    with mp.workdps(60):
        lengths, values, exist = zip(*meeting(np.random.default_rng(5), 60, given), strict=True)
    design = dict(zip(LENGTHS, np.array(lengths).T, strict=True)) | {given: np.array(values)}
    names = [name for name in ("lambda_", *BARS, "r", "FT") if name != given]
    for completion in (1, 2):
        found = fl.evaluate("focal", ["status", *names], **design, completion=completion, phi=1.0, branch=1)
        assert_array_equal(
            found["status"], np.where(exist, CODES["completed"], CODES["no_real_lambda_or_rho"])
        )
        for name in names:
            assert_array_equal(np.isfinite(found[name]), exist)
    assert 0.2 < np.mean(exist) < 0.8
    assert len(exist) > 200


def test_the_study_of_chebyshev_s_linkage(tmp_path):
    text = (STUDIES / "chebyshev_drive.toml").read_text(encoding="utf-8")
    asked = text[text.index("quantities") : text.index("[design]")]
    study = tmp_path / "drive.toml"
    study.write_text(text.replace(asked, 'quantities = ["crank_type", "T_x", "T_y"]\n\n'), encoding="utf-8")
    with fl.run(study, to=tmp_path / "drive.h5") as maps:
        found = maps.load()
    assert int(found.crank_type) == 0
    one = found.sel(branch=1)
    assert bool(np.isfinite(one.T_y).all())
    # T moves in a straight line for some two fifths of the turn, 4 above MN
    straight = abs(one.T_y - 4.0) < 0.01
    assert 0.3 < float(straight.mean()) < 0.6
    assert float(one.T_x.where(straight).max() - one.T_x.where(straight).min()) > 3.0
