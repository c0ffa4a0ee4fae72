# ruff: noqa: F821
"""A map with quantities of a user's own at every door: what computes again runs a named file, where that is trusted."""

import sys

import numpy as np
import pytest
from tests.support.refusals import refused
from typer.testing import CliRunner

import fastlink as fl
from fastlink.app.cli import app

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


def extension():
    mine = fl.extend("slider_crank")
    mine.input("weight", units="1", default=2.0)

    @mine.quantity(units="1")
    def cost(transmission_angle, slider_velocity, r, omega, weight):
        """Poor transmission, and speed of the slider."""
        return weight * (1.0 - sin(transmission_angle)) + (slider_velocity / (r * omega)) ** 2

    return mine


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    path, mine = tmp_path_factory.mktemp("own") / "maps.h5", extension()
    space = fl.grid(SPACE).with_constants({"r_tolerance": 1e-4})
    with fl.sweep(mine, space, NAMES, branch=1, progress=False, to=path) as maps:
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
        np.testing.assert_allclose(found[name], expected, rtol=4 * 2.0**-52 if "rss" in name else 0.0)
        assert found[name].attrs["long_name"] == expected.attrs["long_name"]
    parts = found.cost_max_contribution.sum("toleranced").values
    errors = []
    for share in (1.0, 0.5):
        moved = {name: np.asarray(values) for name, values in SPACE.items()}
        off = fl.grid(
            moved | {"r": moved["r"] + 1e-4 * share, "weight": moved["weight"] * (1 + 1e-3 * share)}
        )
        again = fl.sweep(mine, off.with_constants({"r_tolerance": 1e-4}), NAMES, branch=1, progress=False)
        errors.append(np.abs((again.cost_max - share * parts).values - maps.cost_max.values))
    assert (errors[1] <= 0.3 * errors[0] + 1e-13).all()
    assert (errors[0] <= 1e-2 * np.abs(found.cost_max_worst_change)).all()
