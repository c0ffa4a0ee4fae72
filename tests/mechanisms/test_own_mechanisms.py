"""A mechanism of a user's own, from a sheet: the same numbers as one that is built in, and the refusals of sheets."""

import pickle
import re
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from tests.support.commands import code_blocks
from tests.support.sweeps import sweep_both
from typer.testing import CliRunner

import fastlink as fl
from fastlink.app.cli import app
from fastlink.errors import InputError

PAGE = Path(__file__).parents[2] / "docs" / "own_mechanisms.md"
#: The sheet of the page, an inverted slider-crank.
QUICK_RETURN = code_blocks(PAGE.read_text(encoding="utf-8"), "facts")[0]
#: The slider-crank as a sheet, with the angle of the crank from the normal of the line of the slider.
SLIDER = """
[mechanism]
slider: Offset slider-crank
[position]
tilt [rad] t: crank angle from the downward normal of the line of the slider
[branches]
1: to the right
2: to the left
[inputs]
r [m] r: crank
    rule: positive
l [m] l: rod
    rule: positive
e [m] e: offset
omega [rad s-1] omega: speed, constant
[facts]
## the rod is square to the line at the toggles
step Z0 [1] Z_0: upper toggle
    = -0.5 * (l - r + e) / r
step {0} [1] C_0: lower toggle
    = -0.5 * (l - r - e) / r
x [m] x: Slider
    = r * sin_tilt + branch_sign * (2.0 * (r * sigma))
velocity [m s-1] v: Velocity
    = -(omega * d_x_d_tilt)
"""


def written(folder, text, name="mine.facts"):
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


def test_extremes_of_a_sheet_are_those_of_the_mechanism_that_is_built_in(tmp_path):
    """Cranks that turn fully, and such that stop at one toggle or at both; the angle is half a turn on."""
    # (l + u) / (2 r) with u = -r cos(tilt) - e is C - C0: heights are measured downwards
    mine = fl.mechanism(written(tmp_path, SLIDER.replace("{0}", "C0")))
    rng = np.random.default_rng(11)
    design = {"r": rng.uniform(0.5, 1.5, 40), "l": rng.uniform(0.5, 3.0, 40), "e": rng.uniform(-0.6, 0.6, 40)}
    space = fl.table({**design, "omega": np.full(40, 2.0)})
    own = sweep_both(mine, space, ["x_max", "x_min", "velocity_max"])
    theirs = {
        "slider_position_max": "x_max",
        "slider_position_min": "x_min",
        "slider_velocity_max": "velocity_max",
    }
    known = sweep_both("slider_crank", fl.table({**design, "omega": np.full(40, 2.0)}), list(theirs))
    differ = 0
    for name, other in theirs.items():
        one, two = known[name].values, own[other].values
        assert_array_equal(np.isnan(one), np.isnan(two))
        finite = np.isfinite(one)
        assert_array_equal(one[~finite], two[~finite])
        # some dozens of roundings of lengths up to 5 m, and of velocities beyond a toggle's neighbourhood
        assert_allclose(two[finite], one[finite], rtol=1e-12, atol=1e-12, err_msg=name)
        differ += np.count_nonzero(finite)
    assert differ > 150


def test_a_sheet_stands_for_a_mechanism_at_every_door(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    quick_return = fl.mechanism(written(tmp_path, QUICK_RETURN, "quick_return.facts"))
    design = {"r": [0.1, 0.12], "d": 0.2, "e": 0.02, "omega": 1.0}
    names = ["psi_rate_max", "psi_rate_extrema", "psi_error_max"]
    maps = sweep_both(quick_return, design, names, to="m.h5")
    assert maps.attrs["mechanism_sheet"] == QUICK_RETURN
    assert maps.attrs["verify_mismatches"] == 0
    assert maps.psi_rate_max.attrs["independent_max_difference"] < 1e-40
    maps.close()
    assert pickle.loads(pickle.dumps(quick_return)).text == quick_return.text
    sweep_both(quick_return, design, ["psi_rate_max"], to="few.h5", verify=0).close()
    assert len(fl.best("few.h5", maximise="psi_rate_max", refine=True).psi_rate_max) == 2
    Path("study.toml").write_text(
        f'mechanism = "quick_return.facts"\nquantities = {names}\n'
        "[design]\nr = { values = [0.1, 0.12] }\nd = 0.2\ne = 0.02\nomega = 1.0\n"
        '[cycle]\nbranch = [1, 2]\n[output]\nfile = "s.h5"\n'
    )
    for line in (
        "run study.toml",
        "check s.h5",
        "quantities quick_return.facts",
        "best s.h5 --maximise psi_rate_max",
    ):
        done = CliRunner().invoke(app, line.split())
        assert done.exit_code == 0, done.output
    with fl.open("s.h5") as one, fl.open("m.h5") as other:
        assert_array_equal(one.psi_rate_max.values, other.psi_rate_max.values)
    done = CliRunner().invoke(
        app, ["draw", "quick_return.facts", "r=0.1", "d=0.2", "e=0.02", "--to", "x.png"]
    )
    assert done.exit_code == 2
    assert "has no picture; plot its curves" in done.output


def test_a_wrong_formula_of_a_sheet_is_a_mismatch_with_its_loops(tmp_path):
    wrong = QUICK_RETURN.replace(
        "cos_theta * lever_y - sin_theta", "1.000001 * cos_theta * lever_y - sin_theta"
    )
    mine = fl.mechanism(written(tmp_path, wrong))
    design = {"r": 0.1, "d": 0.2, "e": 0.02, "omega": 1.0}
    with pytest.warns(fl.InputWarning, match="slide_rate is wrong in .* that contradict the loops"):
        maps = sweep_both(mine, design, ["slide_rate", "psi_rate"], theta=5, to=tmp_path / "m.h5")
    with maps:
        assert maps.slide_rate.attrs["independent_max_difference"] > 1e-8
        assert maps.psi_rate.attrs["independent_max_difference"] < 1e-40
        assert maps.attrs["verify_mismatches"] > 0


REFUSED = {
    "no mechanism": (r"\[mechanism\]\nquick_return: Inverted.*?\n", "", r"\[mechanism\] has 0 entries"),
    "no angle": (r"theta \[rad\]", "theta [m]", "the position is no angle in rad"),
    "one mode": ("2: the pin behind it\n", "", "the branches are not 1 and 2"),
    "unknown name": (r"= r \* sin_theta", "= r * sine_theta", "line 28: CA_y depends on sine_theta"),
    "no Python": (r"= r \* sin_theta", "= r * * sin_theta", "line 28: formula of CA_y"),
    "a call": (r"= r \* sin_theta", "= open(r)", "line 28: .*open"),
    "an attribute": (r"= r \* sin_theta", "= r.real", "line 28: .*Attribute"),
    "too few equations": (r"    \| slide \* sin.*?\n", "", "the loops have 1 equations for 2 unknowns"),
    "another unknown": ("slide by omega", "side by omega", "side is none of the unknowns"),
    "units": (r"psi_rate \[rad s-1\]", "psi_rate [m s-1]", "psi_rate declares m s-1 and s-1"),
    "a sum of units": (r"= r \* sin_theta", "= r + sin_theta", "CA_y adds m and a number"),
    "a word of kernels": (r"step CA_y \[m\]", "step width [m]", "width is a word of fastlink's own"),
    "a function of tables": (
        r"= r \* sin_theta",
        "= r * sin(theta)",
        "CA_y calls sin, which kernels do not have",
    ),
    "unknown units": (r"e \[m\]", "e [metre]", "e has the units 'metre'"),
    "a name in loops": (r"r \* cos\(theta\)", "rr * cos(theta)", "rr of the loops is none of their unknowns"),
    "a tab": ("    rule: positive", "\trule: positive", "line 16: the line has a tab"),
    "no number": (r"= r \* sin_theta", "= r * (1.0 / 0.0)", "CA_y cannot be computed"),
    "status without codes": ("psi_acceleration ", "status ", "status has no code beyond_range"),
    "too long": (r"= r \* sin_theta", "= r" + " + r" * 5000, "too many terms"),
    "a rule": ("rule: positive", "rule: great", "'great' is no rule"),
}


@pytest.mark.parametrize("kind", REFUSED)
def test_wrong_sheets_are_refused_with_their_line(tmp_path, kind):
    pattern, other, message = REFUSED[kind]
    text, count = re.subn(pattern, lambda _: other, QUICK_RETURN, count=1, flags=re.DOTALL)
    assert count == 1
    with pytest.raises(InputError, match=message):
        fl.mechanism(written(tmp_path, text))


@pytest.mark.parametrize("file", [None, 3, "quick_return.toml", "nowhere.facts"])
def test_what_is_no_sheet_is_refused(file):
    with pytest.raises(InputError, match="mechanism"):
        fl.mechanism(file)


def test_facts_of_derivatives_and_of_what_ends_within_the_range_are_evaluated(tmp_path):
    height = "h [m] h: Height\n    = r * cos_tilt\nh_rate [m s-1] h: Rate\n    = omega * d_h_d_tilt\n"
    mine = fl.mechanism(written(tmp_path, SLIDER.replace("{0}", "C0") + height))
    found = fl.evaluate(mine, ["h_rate"], r=0.5, l=1.0, e=0.1, omega=2.0, tilt=0.3, branch=1)["h_rate"]
    assert found == pytest.approx(-np.sin(0.3), rel=1e-15)
    # A second dyad ends where its own root does, which Z0 and C0 do not know.
    dyad = "y [m] y: A second dyad\n    square = 4.0 * r * r - x * x\n    = sqrt(square)\n"
    mine = fl.mechanism(written(tmp_path, SLIDER.replace("{0}", "C0") + dyad))
    maps = fl.sweep(
        mine, {"r": 0.5, "l": 0.9, "e": 0.1, "omega": 2.0}, ["y", "y_min", "x_min"], tilt=64, branch=1
    )
    assert 0 < np.isnan(maps.y.values).sum() < 64
    assert float(maps.y_min.squeeze()) == np.nanmin(maps.y.values)


def test_a_quantity_of_a_sheet_passes_infinity_where_its_divisor_vanishes(tmp_path):
    ratio = """
torque_ratio [1] m: Torque on the lever over that on the crank
    = 1.0 / (psi_rate / omega + 0.0)
within [1] m2: Twice that
    = torque_ratio + torque_ratio
"""
    mine = fl.mechanism(
        written(tmp_path, QUICK_RETURN.replace("\npsi_acceleration", f"{ratio}psi_acceleration"))
    )
    design = {"r": 0.2, "d": 0.5, "e": 0.05, "omega": 1.0}  # a lever that swings
    names = [f"{name}_{end}" for name in ("torque_ratio", "within") for end in ("max", "min")]
    for r, infinite in ((0.2, True), (0.8, False)):
        found = fl.sweep(mine, design | {"r": r}, [*names, "psi_rate_min"], verify=1)
        assert found.attrs["verify_mismatches"] == 0
        assert [bool(np.isinf(found[name])) for name in names] == [infinite] * 4
    assert found.torque_ratio_max.item() == pytest.approx(1.0 / found.psi_rate_min.item(), rel=1e-14)
