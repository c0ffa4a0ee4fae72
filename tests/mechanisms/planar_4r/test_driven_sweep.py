"""Sweeps, studies and listings of the planar 4R driven by another joint: labels, bits, errors."""

from __future__ import annotations

import numpy as np
import pytest
from tests.support.refusals import refused
from tests.support.study_files import written

import fastlink as fl
from fastlink.app.study import read_study

SPACE = {"a1": 0.4, "a2": [1.1, 1.2], "a3": 0.8, "a4": 1.0, "joint_omega_2": 2.0}
NAMES = ["joint_angle_1", "joint_omega_4", "joint_alpha_3", "v2", "io_residual_34", "transmission_angle"]


@pytest.mark.parametrize("angles", [8, 40])
def test_a_sweep_has_the_bits_of_evaluate_and_the_labels_of_its_input(angles):
    reduced = ["joint_omega_4_max", "joint_omega_4_rms", "joint_angle_2_at_joint_omega_4_max"]
    options = {"input": "joint_angle_2", "angles": angles, "extrema": "sampled"}
    maps = fl.sweep("planar_4r", fl.grid(**SPACE), [*NAMES, *reduced], **options)
    assert maps.joint_omega_4.dims == ("a2", "branch", "joint_angle_2")
    np.testing.assert_array_equal(maps.joint_angle_2, np.arange(angles) * (2 * np.pi / angles))
    assert maps.joint_angle_2.attrs["units"] == "rad"
    assert maps.attrs["mechanism"] == "planar_4r"
    assert maps.attrs["input"] == "joint_angle_2"
    assert "driven at A" in maps.attrs["title"]
    assert "1: joint_angle_4 from 0 to pi: D to the right" in maps.branch.attrs["comment"]
    for b in (1, 2):
        inputs = SPACE | {"a2": maps.a2, "joint_angle_2": maps.joint_angle_2}
        for name, values in fl.evaluate(
            "planar_4r", NAMES, input="joint_angle_2", branch=b, **inputs
        ).items():
            np.testing.assert_array_equal(maps[name].sel(branch=b).values, values.values, err_msg=name)
    assert maps.joint_omega_4_max.dims == ("a2", "branch")
    at = maps.joint_omega_4.sel(joint_angle_2=maps.joint_angle_2_at_joint_omega_4_max)
    np.testing.assert_array_equal(at, maps.joint_omega_4_max)


@pytest.mark.parametrize("k", [1, 2, 3, 4])
def test_refined_extremes_are_those_of_a_dense_curve(k):
    """As over theta1: exact over the turn of the driven joint, with their places."""
    place, rate = f"joint_angle_{k}", f"joint_omega_{k}"
    names = [f"joint_omega_{(k + 2) % 4 + 1}", f"joint_alpha_{k % 4 + 1}"]
    # The shortest link beside the driven joint, so that it turns fully.
    design = {f"a{(i + k - 1) % 4 + 1}": length for i, length in enumerate((0.4, 1.2, 0.8, 1.0))} | {
        rate: 2.0
    }
    asked = [prefix + f"{name}_max" for name in names for prefix in ("", f"{place}_at_")]
    refined = fl.sweep("planar_4r", fl.grid(**design), asked, input=place)
    curves = fl.sweep("planar_4r", fl.grid(**design), names, input=place, angles=2000)
    assert int(refined.status) == 0
    for name in names:
        curve, found = curves[name].values, refined[f"{name}_max"].values
        # Half a step off its top a curve is lower by an eighth of its second difference there.
        steps = np.abs(np.roll(curve, 1, -1) - 2 * curve + np.roll(curve, -1, -1)).max(axis=-1)
        short = found - curve.max(axis=-1)
        assert np.all((short >= -1e-13) & (short <= 0.2 * steps)), name
        at = {place: refined[f"{place}_at_{name}_max"].values}
        there = fl.evaluate("planar_4r", [name], input=place, branch=np.array([1, 2]), **design, **at)
        # The place is right to 1e-13 or better, and the curve is flat there.
        np.testing.assert_allclose(there[name], found, rtol=1e-12)


@pytest.mark.parametrize(
    ("quantity", "options", "key", "remedy"),
    [
        (
            "theta2",
            {},
            "quantity 'theta2'",
            "with input='joint_angle_2' ask for",
        ),
        ("shaking_force_max", {}, "'shaking_force_max'", ""),
        ("theta1_at_v1_max", {}, "'theta1_at_v1_max'", ""),
        ("joint_angle_2", {}, "'joint_angle_2'", "leave it out"),
        ("joint_omega_2", {}, "'joint_omega_2'", "leave it out"),
        ("joint_omga_3", {}, "'joint_omga_3'", "did you mean 'joint_omega_3'?"),
        ("v1", {"theta1": 8}, "theta1", "joint_angle_2"),
        ("v1", {"angles": 0}, "angles", "a number from 1 to"),
        (
            "v1",
            {"links": fl.round_bar(1.0, 1.0)},
            "links",
            "",
        ),
        ("v1", {"input": "joint_angle_5"}, "input: 'joint_angle_5'", "did you mean"),
        ("v1", {"input": "theta1"}, "design: joint_omega_2", ""),
    ],
)
def test_a_sweep_says_what_is_wrong(quantity, options, key, remedy):
    with refused(key, remedy):
        fl.sweep("planar_4r", fl.grid(**SPACE), [quantity], **{"input": "joint_angle_2"} | options)


def test_angles_and_theta1_are_two_names_of_one_thing():
    space = fl.grid(a1=0.4, a2=1.2, a3=0.8, a4=1.0)
    one, two = (fl.sweep("planar_4r", space, ["theta4"], **given) for given in ({"angles": 5}, {"theta1": 5}))
    np.testing.assert_array_equal(one.theta4, two.theta4)
    assert one.theta4.dims == ("branch", "theta1")
    with pytest.raises(fl.InputError, match="theta1: angles are given too; write one of them"):
        fl.sweep("planar_4r", space, ["theta4"], angles=5, theta1=5)


def test_the_missing_rate_is_asked_for():
    space = fl.grid(a1=0.4, a2=1.2, a3=0.8, a4=1.0)
    with pytest.raises(fl.InputError, match=r"joint_omega_3 is missing \(rate of the driven joint"):
        fl.sweep("planar_4r", space, ["joint_omega_1"], input="joint_angle_3")


STUDY = """
mechanism = "planar_4r"
quantities = ["joint_angle_1", "joint_omega_4_rms"]
[design]
a1 = 0.4
a2 = {values = [1.1, 1.2]}
a3 = 0.8
a4 = 1.0
joint_omega_2 = 2.0
[cycle]
input = "joint_angle_2"
angles = 12
"""


def test_a_study_names_its_input(folder):
    with fl.run_study(written(STUDY)) as maps:
        quantities = ["joint_angle_1", "joint_omega_4_rms"]
        expected = fl.sweep("planar_4r", fl.grid(**SPACE), quantities, input="joint_angle_2", angles=12)
        np.testing.assert_array_equal(maps.joint_angle_1, expected.joint_angle_1)
        np.testing.assert_array_equal(maps.joint_omega_4_rms, expected.joint_omega_4_rms)
        assert maps.attrs["input"] == "joint_angle_2"


@pytest.mark.parametrize(
    ("old", "new", "key", "remedy"),
    [
        ("joint_angle_2", "joint_angle_9", "cycle.input", "did you mean"),
        (
            "angles",
            "theta1",
            "cycle.theta1",
            "joint_angle_2",
        ),
        ("12", "{values = [1.0, 1.0]}", "cycle.angles", "once"),
        ("12", "0", "cycle.angles", "from 1"),
        ("joint_omega_2", "omega1", "design.omega1", "did you mean"),
        (
            '"joint_angle_1"',
            '"theta4"',
            "quantities[0]",
            "joint_angle_2",
        ),
        ("[cycle]", "[links]\nmodel = 'round_bar'\n[cycle]", "links", "leave"),
    ],
)
def test_a_study_says_what_is_wrong_with_its_input(folder, old, new, key, remedy):
    with refused(key, remedy):
        read_study(written(STUDY.replace(old, new, 1)))


def test_the_listing_is_of_the_input():
    listed = fl.quantities("planar_4r", input="joint_angle_3")
    rows = {row.name: row for row in listed}
    assert rows["joint_omega_1"].dims == ("design", "branch", "joint_angle_3")
    assert rows["joint_omega_1"].meaning == "Rate of the first joint angle"
    assert "joint_angle_3" not in rows
    assert "joint_omega_3" in {given.name for given in listed.inputs}
    assert "joint_angle_3_at_NAME_max" in str(listed)
