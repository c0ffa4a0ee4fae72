"""A study names the Python file that declares its quantities, which is run only by who trusts it."""

import numpy as np
import pytest
from tests.support.refusals import refused
from typer.testing import CliRunner

import fastlink as fl
from fastlink.app.cli import app
from fastlink.errors import InputError

MINE = """
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
    (folder / "mine.py").write_text(MINE)
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
        np.testing.assert_array_equal(maps.weighted_max, 2.0 * maps.transmission_angle_max)
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
    file.write_text(MINE.replace("return weight *", "return 2.0 * weight *"))
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
        (MINE.replace("weight * ", "other * "), "line 13 of mine.py"),
        (MINE.replace('units="rad"', 'units="N"'), "gives"),
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
