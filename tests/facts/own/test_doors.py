# ruff: noqa: F821
"""A map with quantities of a user's own at every door: what computes again runs a named file, where that is trusted."""

import linecache
import math
import re
import sys

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from tests.support.refusals import refused
from tests.support.toys import function_of
from typer.testing import CliRunner

import fastlink as fl
from fastlink.app.cli import app
from fastlink.app.study import load_extension
from fastlink.errors import InputError

MINE = '''
import fastlink as fl
from pathlib import Path

Path("ran").touch()
mine = fl.extend("slider_crank")
mine.input("weight", units="1", default=2.0)


@mine.quantity(units="1")
def cost(transmission_angle, slider_velocity, r, omega, weight):
    """Poor transmission, and speed of the slider."""
    return weight * (1.0 - sin(transmission_angle)) + (slider_velocity / (r * omega)) ** 2
'''
SLOPES = ["d_cost_max_d_r", "d_cost_max_d_weight"]
NAMES = ["cost_max", "slider_velocity_max", "cost_max_worst_change", *SLOPES]
SPACE = {"r": [0.1, 0.12, 0.14], "l": [0.4, 0.5], "e": 0.02, "omega": 25.0, "weight": [1.0, 2.0]}
OWN = ["--quantities-file", "mine.py"]


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    folder = tmp_path_factory.mktemp("own")
    (folder / "mine.py").write_text(MINE.replace('Path("ran").touch()', ""))
    mine = load_extension(folder / "study.toml", "mine.py", "slider_crank", True)
    space, path = fl.grid(SPACE).with_constants({"r_tolerance": 1e-4}), folder / "maps.h5"
    with fl.sweep(mine, space, NAMES, branch=1, to=path) as maps:
        return mine, maps.load(), path


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine.py").write_text(MINE)
    return tmp_path


def said(*arguments):
    found = CliRunner().invoke(app, [*map(str, arguments)])
    return found.exit_code, found.output


COMMANDS = {
    "best": ["best", "--minimise", "cost_max", "--refine", "--top", "1"],
    "best by a condition": ["best", "--minimise", "slider_velocity_max", "--where", "cost_max=:9", "--refine"],
    "tolerance": ["tolerance", "l=1e-4"],
    "tolerance of one": ["tolerance", "weight=1%", "--quantities", "cost_max"],
}  # fmt: skip


@pytest.mark.sample(1)
@pytest.mark.parametrize(
    "command", [one if " " not in one else pytest.param(one, marks=pytest.mark.stress) for one in COMMANDS]
)
def test_a_command_runs_the_named_file_where_it_is_trusted(made, folder, command):
    name, *options = COMMANDS[command]
    code, text = said(name, made[2], *options)
    assert (code, "--quantities-file mine.py" in text) == (2, True)
    code, text = said(name, made[2], *options, *OWN)
    assert (code, "--trust-code" in text) == (2, True)
    assert not (folder / "ran").exists()
    code, text = said(name, made[2], *options, *OWN, "--trust-code")
    assert (code, "cost_max" in text) == (0, True), text
    assert (folder / "ran").exists()
    (folder / "mine.py").write_text(MINE.replace("1.0 - ", "2.0 - "))
    code, text = said(name, made[2], *options, *OWN, "--trust-code")
    assert (code, "other declarations" in text) == (2, True)


def test_it_is_said_where_the_file_is_of_no_use(made, folder):
    code, text = said("best", made[2], "--minimise", "cost_max", *OWN)
    assert (code, "add --refine" in text) == (2, True)
    (folder / "study.toml").write_text("mechanism = 'slider_crank'")
    code, text = said("tolerance", "study.toml", "r=1e-4", *OWN)
    assert (code, "leave it out" in text) == (2, True)
    with refused("curves", "trust_code=True"):
        fl.draw(made[1], design=0, curves=["cost"])


@pytest.mark.sample(2)
@pytest.mark.parametrize("command", [
    ["info"], ["check"], ["best", "--minimise", "cost_max"], ["plot", "cost_max", "--at", "weight=1"],
    ["plot", "--minimise", "cost_max", "--minimise", "slider_velocity_max"], ["draw", "--design", "0", "--to", "d.png"],
    ["convert", "--to", "maps.csv", "--quantities", "cost_max"], ["explore", "--to", "page.html"],
], ids=" ".join)  # fmt: skip
def test_what_reads_a_map_runs_nothing(made, folder, command):
    name, *options = command
    code, text = said(name, made[2], *options)
    assert code == 0, text
    assert not (folder / "ran").exists()


@pytest.mark.stress
def test_refined_designs_of_own_quantities_with_tolerances(made):
    mine, maps, _ = made
    found = fl.best(maps, minimise="cost_max_worst_change", top=1, refine=True, mechanism=mine)
    assert float(found.cost_max_worst_change[0]) <= float(maps.cost_max_worst_change.min())
    assert float(found.r_tolerance) == 1e-4


def test_tolerances_of_own_quantities_come_from_the_derivatives_of_a_map(made, monkeypatch):
    """Held against a sweep, and against values where the inputs are off: to first order, whose error falls fourfold."""
    mine, maps, _ = made
    given = {"r": 1e-4, "weight": "0.1 %", "mechanism": mine, "contributions": True}
    swept = fl.tolerance(maps.drop_vars(SLOPES), ["cost_max"], **given)
    with monkeypatch.context() as patch:
        module = sys.modules["fastlink.app.tolerance"]
        patch.setattr(module, "sweep", lambda *given, **options: pytest.fail("it was swept again"))
        found = fl.tolerance(maps, ["cost_max"], **given)
    assert list(found.data_vars) == list(swept.data_vars)
    for name, expected in swept.data_vars.items():
        # roots of sums of squares are taken by another routine: a rounding for each of two terms, at both
        assert_allclose(found[name], expected, rtol=4 * 2.0**-52 if "rss" in name else 0.0)
        assert found[name].attrs["long_name"] == expected.attrs["long_name"]
    parts = found.cost_max_contribution.sum("toleranced").values
    errors = []
    for share in (1.0, 0.5):
        moved = {name: np.asarray(values) for name, values in SPACE.items()}
        off = fl.grid(
            moved | {"r": moved["r"] + 1e-4 * share, "weight": moved["weight"] * (1 + 1e-3 * share)}
        )
        again = fl.sweep(mine, off.with_constants({"r_tolerance": 1e-4}), NAMES, branch=1)
        errors.append(np.abs((again.cost_max - share * parts).values - maps.cost_max.values))
    assert (errors[1] <= 0.3 * errors[0] + 1e-13).all()
    assert (errors[0] <= 1e-2 * np.abs(found.cost_max_worst_change)).all()


# == A study names the Python file that declares its quantities, which is run only by who trusts it ==========

MINE_STUDY = """
import fastlink as fl
from pathlib import Path

Path("ran").touch()
mine = fl.extend("planar_4r")
mine.input("weight", units="1", default=2.0)


@mine.quantity(units="rad")
def weighted(transmission_angle, weight):
    "Transmission angle, by its weight."
    return weight * transmission_angle
"""
STUDY = """
mechanism = "planar_4r"
quantities_file = "mine.py"
quantities = ["weighted_max", "transmission_angle_max"]
design = {a1 = 0.4, a2 = {linspace = [1.0, 1.3, 3]}, a3 = 0.8, a4 = 1.0}
output = {verify = 0}
"""


@pytest.fixture
def study(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    folder = tmp_path / "studies"
    folder.mkdir()
    (folder / "mine.py").write_text(MINE_STUDY)
    path = folder / "study.toml"
    path.write_text(STUDY)
    return path


def test_a_study_alone_runs_no_code(study, tmp_path):
    for door in (fl.run, fl.explain, fl.accuracy):
        with refused("quantities_file", "trust_code=True"):
            door(study)
    found = CliRunner().invoke(app, ["run", str(study)])
    assert found.exit_code == 2
    assert "--trust-code" in found.output
    assert not (tmp_path / "ran").exists()
    with refused("trust_code", "True or False"):
        fl.run(study, trust_code="yes")


def test_a_trusted_study_has_its_own_quantities(study, tmp_path):
    with fl.run(study, to="maps.h5", trust_code=True) as maps:
        assert_array_equal(maps.weighted_max, 2.0 * maps.transmission_angle_max)
        assert "def weighted" in maps.attrs["own_quantities"]
        assert maps.attrs["study"] == STUDY
    (tmp_path / "ran").unlink()
    shown = CliRunner().invoke(app, ["info", "maps.h5"])
    assert "weight, weighted" in shown.output
    with fl.open("maps.h5") as maps:  # which runs nothing
        fl.best(maps, minimise="weighted_max", top=1)
    assert not (tmp_path / "ran").exists()
    explained = CliRunner().invoke(app, ["explain", str(study), "--trust-code", "--no-measure"])
    assert "weighted (mine.py, line 11)" in explained.output


def test_another_text_is_another_map(study):
    fl.run(study, to="maps.h5", trust_code=True).close()
    fl.run(study, to="maps.h5", trust_code=True).close()  # up to date
    file = study.with_name("mine.py")
    file.write_text(MINE_STUDY.replace("return weight *", "return 2.0 * weight *"))
    with pytest.raises(InputError, match="own_quantities"):
        fl.run(study, to="maps.h5", trust_code=True)


@pytest.mark.parametrize(
    ("text", "what"),
    [
        ("import fastlink", "no extension"),
        ("import fastlink as fl\nmine = fl.extend('hart')", "mine of hart"),
        ("import fastlink as fl\na, b = fl.extend('planar_4r'), fl.extend('planar_4r')", "a of planar_4r"),
        ("def f(:", "line 1"),
        ("\n1 / 0", "line 2"),
        (MINE_STUDY.replace("weight * ", "other * "), "line 13 of mine.py"),
        (MINE_STUDY.replace('units="rad"', 'units="N"'), "gives"),
    ],
)
def test_a_file_that_declares_nothing_is_refused(study, text, what):
    study.with_name("mine.py").write_text(text)
    with pytest.raises(InputError) as caught:
        fl.run(study, trust_code=True)
    assert "study.toml: quantities_file" in str(caught.value)
    assert what in str(caught.value)
    study.with_name("mine.py").unlink()
    with refused("quantities_file", "Python code"):
        fl.run(study, trust_code=True)


# == What no quantity of one's own can say is refused when it is declared, with its line and what to write instead

FACTOR = 3.0


def helper(x):
    return x


#: A function by its head and its text, what is wrong with it, and what to write instead.
REFUSED = {
    "branches(F21, F41)": (
        "if F21 > F41:\n        return F21\n    return F41",
        "branches",
        "if condition else",
    ),
    "loops(F21)": ("for _ in range(3):\n        F21 = F21 + F21\n    return F21", "is a loop", "each term"),
    "calls(F21)": ("return helper(F21)", "`helper(F21)`", "make it a quantity"),
    "calls_itself(F21)": ("return calls_itself(F21)", "calls itself", "formula"),
    "takes_a_global(F21)": ("return FACTOR * F21", "`FACTOR`", "default=3.0"),
    "adds_a_list(F21, F41)": ("return sum([F21, F41])", "`sum([F21, F41])`", "formula"),
    "returns_two(F21, F41)": ("return F21, F41", "several values", "one number"),
    "ends_without(F21)": ("F21 + F21", "ends without a value", "return"),
    "has_default(F21, factor=2.0)": (
        "return factor * F21",
        "factor",
        'input("factor", units=..., default=2.0)',
    ),
    "any_number(*forces)": ("return forces", "any number of arguments", "name each"),
    "powers(F21)": ("return F21**0.3", "`F21 ** 0.3`", "x**0.5"),
    "inverted_power(F21)": ("return F21**~2", "is a power", "x**0.5"),
    "infinite_power(F21)": ("return F21**1e400", "is a power", "x**0.5"),
    "negates(F21, F41)": ("return F21 if not F21 > F41 else F41", "negates", "turn"),
    "of_the_cycle(F21_max)": ("return F21_max", "F21_max", "take F21"),
    "of_a_bound(F21_error)": ("return F21_error", "F21_error", "take F21"),
    "misspelt(F_21)": ("return F_21", "F_21", "'F21'"),
    "of_itself(of_itself)": ("return of_itself", "itself", "before"),
    "compares_units(F21)": ("return max(F21, 100.0)", "compares N and a number", "mine.input"),
    "divides_by_zero(F21)": ("return F21 * (1 / 0)", "cannot be computed", "mend"),
    "wrong_units(F21, a1)": ("return F21 * a1", "gives J", "units='J'"),
    "sine_of_a_force(F21)": ("return math.sin(F21) * F21", "function of N", "mine.input"),
    "omega4(omega2)": ("return omega2", "is a quantity of planar_4r", "otherwise"),
    "sigma(F21)": ("return F21", "step within the facts", "otherwise"),
    "width(F21)": ("return F21", "word of fastlink's own", "my_width"),
    "constant_alone()": ("return 2.0", "no parameter", "name the quantities"),
}


@pytest.mark.parametrize("head", REFUSED)
def test_a_text_is_refused_at_its_line(head):
    text, what, remedy = REFUSED[head]
    mine = fl.extend("planar_4r")
    with pytest.raises(InputError) as caught:
        mine.quantity(units="N")(function_of(head, text, FACTOR=FACTOR, helper=helper))
    line = str(caught.value).splitlines()[0]
    found, _, mended = line.partition("; ")
    assert line.startswith(head.partition("(")[0]), line
    assert what in found, line
    assert remedy in mended, line
    if number := re.search(r"line (\d+) of <", line):
        assert int(number[1]) <= 4
    assert "nothing of its own" in repr(mine)


def test_all_problems_are_told_together():
    mine = fl.extend("planar_4r")

    def several(F21):
        x = helper(F21)
        y = FACTOR * x
        return z + y

    with pytest.raises(InputError) as caught:
        mine.quantity(units="N")(several)
    assert len(str(caught.value).splitlines()) == 3


def test_what_has_no_text_is_refused():
    mine = fl.extend("planar_4r")
    held = 2.0

    def closure(F21):
        return held * F21

    scope = {}
    exec("def typed(F21):\n    return F21", scope)
    for function, what in (
        (lambda F21: F21, "lambda"),
        (closure, "held"),
        (scope["typed"], "text"),
        (len, "function"),
        (math.sin, "function"),
    ):
        with pytest.raises(InputError, match=what):
            mine.quantity(units="N")(function)


def test_a_text_that_was_changed_since_is_refused(tmp_path):
    file, text = tmp_path / "texts.py", "def f(F21, F41):\n    return F21 - F41\n"
    for new in ("F21 + F41", "F41 - F21", "F21 - 2.0 * F41"):
        scope = {}
        exec(compile(text, str(file), "exec"), scope)
        file.write_text(text.replace("F21 - F41", new))
        linecache.checkcache(str(file))
        with refused("f", "load the file again"):
            fl.extend("planar_4r").quantity(units="N")(scope["f"])


def test_a_quotient_by_zero_has_derivatives_and_bounds():
    mine = fl.extend("planar_4r")

    @mine.quantity(units="rad")
    def infinite(theta4):
        return theta4 / 0.0

    names = ["infinite", "infinite_error", "d_infinite_d_theta1"]
    assert not any(map(math.isfinite, fl.evaluate(mine, names, **DESIGN, branch=1).values()))


def test_names_are_declared_once_and_cells_again():
    mine = fl.extend("planar_4r")
    mine.input("limit", units="N", default=1.0)
    mine.input("limit", units="N", default=2.0)  # as when a cell of a notebook runs again
    with refused("omega1", "otherwise"):
        mine.input("omega1", units="rad s-1")

    @mine.quantity(units="1")
    def ratio(F21, limit):
        return F21 / limit

    with refused("ratio", "otherwise"):

        @mine.quantity(units="1")
        def ratio(F41, limit):
            return F41 / limit

    assert fl.evaluate(mine, ["ratio"], **DESIGN)["ratio"] > 0.0


DESIGN = dict(
    a1=0.4, a2=1.2, a3=0.8, a4=1.0, omega1=5.0, theta1=1.0, links=fl.round_bar(density=7750.0, radius=0.01)
)


@pytest.mark.parametrize(
    ("units", "remedy"),
    [("m/s", "'m s-1'"), ("deg", "'rad'"), ("furlong", "kg, m, s"), (None, "kg, m, s"), ("", "'1'")],
)
def test_units_are_those_of_files(units, remedy):
    with refused("units", remedy):
        fl.extend("planar_4r").input("x1", units=units)
    with refused("units", remedy):
        fl.extend("planar_4r").quantity(units=units)


def test_a_default_fits_its_rule():
    for rule, value in (("positive", 0.0), ("non-negative", -1.0), ("any", math.nan)):
        with refused("default", "finite"):
            fl.extend("planar_4r").input("x1", units="1", rule=rule, default=value)
    with refused("rule", "non-negative"):
        fl.extend("planar_4r").input("x1", units="1", rule="negative")
