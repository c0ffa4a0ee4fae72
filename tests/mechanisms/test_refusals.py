"""What a sweep over any mechanism says of a wrong request: the key that is wrong, and what to write instead."""

import subprocess
import sys

import pytest
from tests.support.refusals import refused
from tests.support.registry import every_input
from tests.support.sweeps import BARS, TURNING, sweep_4r, sweep_both

import fastlink as fl
from fastlink.mechanisms import NAMES, catalogue, inputs_of

FOCAL = {"a": 5.0, "b": 5.0, "c": 2.0, "d": 4.0}
HART = {"m": 4.0, "n": 8.0, "d": 6.0, "kappa": 0.5}
BY_2 = {"input": "joint_angle_2"}
DRIVEN = {"a1": 0.4, "a2": 1.2, "a3": 0.8, "a4": 1.0, "joint_omega_2": 2.0}


@every_input
def test_every_mechanism_refuses_in_the_same_words(mechanism, drive):
    known = catalogue(mechanism, drive)
    design = {name: 1.0 for name, one in known.inputs.items() if one.default is None}
    moving = next(name for name in known.public if known.varies(name))
    length = next(name for name, one in known.inputs.items() if one.rule == "positive")
    of_position = {drive, f"{drive}_max", f"{drive}_error", f"d_{drive}_d_{length}"} - set(known.public)
    for asked, changes, options, key, remedy in (
        *((name, {}, {}, f"'{name}'", "leave it out") for name in of_position),
        (f"{moving}q", {}, {}, f"'{moving}q'", "did you mean"),
        (moving, {length: -1.0}, {}, f"design: {length}", "greater than 0"),
        (moving, {"xyzzy": 1.0}, {}, "design: xyzzy", "known: "),
        (moving, {}, {"branch": 3}, "branch: 3", "write some of 1, 2"),
        (moving, {}, {"input": "xyzzy"}, "input: 'xyzzy'", "known: "),
        (moving, {}, {drive: [[0.1]]}, drive, "flat array of "),
        (moving, {}, {"angles": 0}, "angles", "write "),
        (moving, {}, {"angles": 5, drive: [0.1]}, f"{drive}: angles are given too", "one of them"),
    ):
        with refused(key, remedy):
            sweep_both(mechanism, fl.grid(**design | changes), [asked], **{"input": drive} | options)


@pytest.mark.parametrize(
    ("mechanism", "design", "name", "options", "key", "remedy"),
    [
        # what another input has, and inputs by the names of another
        ("focal", FOCAL | {"rho": 1.0}, "dsigma_dphi", {"input": "sigma"}, "'dsigma_dphi'", "'dphi_dsigma'"),
        ("focal", FOCAL | {"rho": 1.0}, "F_x", {"sigma": 36}, "sigma: the input is phi", "as phi"),
        ("hart", HART, "dF_y_dphi", {"input": "F_y"}, "'dF_y_dphi'", "'dphi_dF_y'"),
        ("hart", HART, "psi", {"input": "F_x"}, "input", "did you mean 'F_y'?"),
        ("hart", HART, "psi", {"input": "F_y", "angles": 12}, "angles", "numpy.linspace"),
        ("planar_4r", DRIVEN, "theta2", BY_2, "'theta2'", "with input='joint_angle_2' ask"),
        ("planar_4r", DRIVEN, "joint_omega_2", BY_2, "'joint_omega_2'", "leave it out"),
        ("planar_4r", DRIVEN, "v1", {"input": "theta1"}, "design: joint_omega_2", ""),
        ("planar_4r", DRIVEN, "v1", {"input": "joint_angle_2", "links": BARS}, "links", ""),
        # ratios of which one is given, loads that are whole
        ("focal", FOCAL | {"rho": 1.0, "s": 2.0}, "m", {}, "s", "leave one of them out"),
        ("focal", FOCAL | {"s": 1.0, "lambda_": 2.0}, "m", {}, "lambda_", "leave one of them out"),
        ("focal", FOCAL, "m", {}, "rho", ""),
        ("focal", FOCAL | {"rho": 1.0, "completion": 3}, "m", {}, "completion", ""),
        ("focal", FOCAL | {"s": 1.0}, "s", {}, "quantity 's'", "leave it out"),
        (
            "planar_4r",
            TURNING | {"counterweight1_radius": 0.1},
            "F41",
            {"links": BARS},
            "counterweight1_mass",
            "",
        ),
        # extremes of what has none
        ("planar_4r", TURNING, "omega4_max", {"extrema": "foo"}, "extrema: 'foo'", "refined"),
        ("planar_4r", TURNING, "omega4_max", {"extrema": "refined", "theta1": [0.1]}, "extrema", "sampled"),
        ("planar_4r", TURNING, "status_extrema", {}, "'status_extrema'", ""),
    ],
)
def test_what_a_mechanism_has_not_is_told(mechanism, design, name, options, key, remedy):
    with refused(key, remedy):
        sweep_both(mechanism, fl.grid(**design), [name], **options)


# == The list of mechanisms ==================================================================================


def test_every_mechanism_is_listed_within_a_screen():
    listed = fl.mechanisms()
    assert [one.name for one in listed] == list(NAMES)
    assert [one.inputs for one in listed] == [inputs_of(name) for name in NAMES]
    assert [one.quantities for one in listed] == [len(catalogue(name).public) for name in NAMES]
    assert max(map(len, str(listed).splitlines())) <= 132
    text = fl.mechanisms()._repr_html_()
    assert text.count("<tr>") == len(NAMES) + 1
    assert "Burmester&#x27;s" in text
    design = fl.grid(a1=0.4, a2=1.2, a3=0.8, a4=1.0)
    source = sweep_4r(design, ["grashof_class"]).attrs["source"]
    assert source.startswith(f"fastlink {fl.__version__},")


@pytest.mark.parametrize("first", ["fl.mechanisms()", "import fastlink.mechanisms.planar_4r as _"])
def test_the_package_of_that_name_stays_one(first):
    """A function and a package share the name, whichever is used first."""
    script = f"""
import fastlink as fl
{first}
import fastlink.mechanisms.planar_4r.by_joint as by_joint
from fastlink.mechanisms import NAMES
assert [one.name for one in fl.mechanisms()] == list(NAMES)
assert fl.mechanisms.planar_4r.by_joint is by_joint
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
