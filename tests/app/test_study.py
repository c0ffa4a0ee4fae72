"""Study files: what they mean."""

from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from numpy.testing import assert_array_equal
from tests.support.study_files import BARE, GOOD, LENGTHS, written

import fastlink as fl
from fastlink.app.study import read_study
from fastlink.engine.resolve import resolve

STUDIES = Path(__file__).parents[2] / "data" / "studies"


def test_a_study_gives_what_sweep_gives(folder):
    with fl.run(written(GOOD)) as maps:
        space = fl.grid(a1=0.4, a2=np.linspace(1.0, 1.4, 3), a3=[0.8, 0.7], a4=1.0, omega1=25.0)
        expected = fl.sweep("planar_4r", space, ["omega4_max", "theta4"], theta1=8, branch=1)
        xr.testing.assert_identical(maps.drop_attrs(), expected.drop_attrs())
        assert maps.attrs["study"] == GOOD
        assert maps.attrs["study_file"] == "study.toml"
        assert maps.encoding["source"] == str(folder / "study.h5")


def test_every_key_reaches_the_sweep(folder):
    text = """
mechanism = "planar_4r"
title = "Längen"
quantities = ["T41", "status"]
[design]
a1 = 0.4
a2 = {geomspace = [1.0, 1.44, 3]}
a3 = 0.8
a4 = 1.0
omega1 = 25.0
radius = {values = [0.01, 0.02]}
[links]
model = "round_bar"
density = 7750.0
[cycle]
theta1 = {linspace = [0.5, 1.5, 5]}
branch = 2
solver = "dense"
[output]
file = "torque.h5"
"""
    with fl.run(written(text)) as maps:
        assert maps.attrs["title"] == "Längen"
        assert maps.attrs["solver"] == "dense"
        assert maps["T41"].dims == ("a2", "radius", "theta1")
        assert_array_equal(maps["a2"], np.geomspace(1.0, 1.44, 3))
        assert_array_equal(maps["theta1"], np.linspace(0.5, 1.5, 5))
        assert_array_equal(maps["branch"], [2])
        assert float(maps["density"]) == 7750.0
    assert Path("torque.h5").exists()


def test_theta1_and_branch_by_default(folder):
    study = read_study(written(BARE + "[design]\n" + LENGTHS))
    resolved = resolve(study.mechanism, study.space, study.quantities, **{"branch": (1, 2)} | study.options)
    assert resolved.branches == (1, 2)
    assert_array_equal(resolved.positions, np.arange(360) * (2 * np.pi / 360))


@pytest.mark.parametrize("kind", ["sobol", "latin_hypercube"])
def test_a_sample_beside_constants(folder, kind):
    text = f"{BARE}[design]\n{kind} = {{n = 8, seed = 3, a1 = [0.2, 0.4], a2 = 1.2}}\na3 = 0.8\na4 = 1.0\n"
    space = read_study(written(text)).space
    expected = getattr(fl, kind)(8, seed=3, a1=(0.2, 0.4), a2=1.2)
    assert_array_equal(space.columns["a1"], expected.columns["a1"])
    assert space.constants == {"a2": 1.2, "a3": 0.8, "a4": 1.0}


def test_a_table_is_found_beside_the_study(folder):
    Path("inner").mkdir()
    Path("inner/designs.csv").write_text("a1,a2\n0.4,1.2\n0.3,1.1\n")
    text = f'{BARE}[design]\ntable = "designs.csv"\na3 = 0.8\na4 = 1.0\n'
    space = read_study(written(text, "inner/study.toml")).space
    assert_array_equal(space.columns["a2"], [1.2, 1.1])


def test_a_long_study_is_kept_whole(folder):
    text = GOOD + "".join(f"# line {k} of a long comment\n" for k in range(5000))
    assert len(text) > 2**16
    with fl.run(written(text), to="long.h5") as maps:
        assert maps.attrs["study"] == text


def test_the_main_study_is_as_large_as_promised():
    study = read_study(STUDIES / "crank_rocker_map.toml")
    assert study.space.size >= 10**6
    assert study.space.dims == ("a2", "a3", "a4")
    centre = {"a2": 1.2, "a3": 0.8, "a4": 1.0}
    for name, value in centre.items():
        assert np.abs(study.space.axes[name] - value).min() < 1e-12
    assert study.output["file"] == "crank_rocker_map.h5"
