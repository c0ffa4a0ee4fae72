"""What tolerances do to the results of maps, studies and files, at every door."""

import numpy as np
import pytest
from tests.support.refusals import refused
from tests.support.sweeps import sweep_4r
from typer.testing import CliRunner

import fastlink as fl
from fastlink.app.cli import app

DESIGN = {"a1": 0.4, "a2": [1.1, 1.2], "a3": 0.8, "a4": 1.0, "omega1": 25.0}
NAMES = ["omega4_max", "theta1_at_omega4_max", "swing", "grashof_class"]
GIVEN = {"a1": 1e-4, "a3": "0.1 %"}
STUDY = """
mechanism = "planar_4r"
quantities = ["omega4_max", "omega4_max_worst_change"]
[design]
a1 = 0.4
a2 = {values = [1.1, 1.2]}
a3 = 0.8
a4 = 1.0
omega1 = 25.0
[cycle]
branch = [1, 2]
[tolerances]
a1 = 1e-4
a3 = "0.1 %"
"""
#: The same without tolerances.
PLAIN = STUDY.partition("[tolerances]")[0].replace(', "omega4_max_worst_change"', "")


@pytest.fixture(scope="module")
def maps():
    return sweep_4r(fl.grid(DESIGN), NAMES)


def written(folder, text=STUDY):
    path = folder / "study.toml"
    path.write_text(text)
    return path


def test_a_map_is_swept_again_with_tolerances(maps):
    found = fl.tolerance(maps, contributions=True, **GIVEN)
    space = fl.grid(DESIGN | {"a1_tolerance": 1e-4, "a3_relative_tolerance": 1e-3})
    for name in NAMES[:3]:
        swept = sweep_4r(space, [name, f"{name}_worst_change", f"{name}_rss_change"])
        for of in swept.data_vars:
            assert found[of].equals(swept[of])
        parts = found[f"{name}_contribution"]
        assert parts.dims == (*found[name].dims, "toleranced")
        np.testing.assert_array_equal(abs(parts).sum("toleranced"), swept[f"{name}_worst_change"])
    slope = sweep_4r(fl.grid(DESIGN), ["d_omega4_max_d_a3"]).d_omega4_max_d_a3
    np.testing.assert_array_equal(found.omega4_max_contribution.sel(toleranced="a3"), slope * (0.8 * 1e-3))
    assert "grashof_class" not in found
    assert not any(name.startswith("d_") for name in found.data_vars)


def test_the_rows_of_the_best_designs_keep_their_assembly_modes(maps):
    rows = fl.best(maps, minimise="omega4_max", top=3)
    found = fl.tolerance(rows, ["omega4_max"], **GIVEN)
    whole = fl.tolerance(maps, ["omega4_max"], **GIVEN)
    np.testing.assert_array_equal(found.omega4_max, rows.omega4_max)
    for k in range(3):
        of = whole.sel(a2=float(rows.a2[k]), branch=int(rows.branch[k]))
        assert float(found.omega4_max_rss_change[k]) == float(of.omega4_max_rss_change)


def test_links_angles_and_modes_of_a_map_stay(tmp_path):
    links = fl.round_bar(density=7750.0, radius=0.01)
    options = {
        "branch": 2,
        "theta1": [0.2, 0.5],
        "extrema": "sampled",
        "links": links,
        "to": tmp_path / "maps.h5",
        "progress": False,
    }
    sweep_4r(fl.grid(DESIGN), ["F21_x", "omega4_max"], **options).close()
    found = fl.tolerance(tmp_path / "maps.h5", density="1 %", a1=1e-4)
    assert found.F21_x_worst_change.dims == ("a2", "theta1")
    assert int(found.branch) == 2
    assert found.omega4_max.attrs["extrema"] == "sampled"
    again = fl.tolerance(found, to=tmp_path / "robust.h5")
    assert again.F21_x_worst_change.equals(found.F21_x_worst_change)
    again.close()


def test_a_study_has_tolerances_of_its_own_or_is_given_some(tmp_path, maps):
    with fl.run(written(tmp_path), to=tmp_path / "maps.h5") as run:
        found = fl.tolerance(maps, **GIVEN)
        assert run.omega4_max_worst_change.equals(found.omega4_max_worst_change)
        assert list(run.data_vars)[2] == "omega4_max_gradient_status"
        best = fl.best(
            run, minimise="omega4_max_worst_change", where={"omega4_max_gradient_status": "derivative"}, top=1
        )
        assert float(best.omega4_max_worst_change[0]) == float(run.omega4_max_worst_change.min())
    plain = written(tmp_path, PLAIN)
    assert fl.tolerance(plain, **GIVEN).omega4_max_rss_change.equals(found.omega4_max_rss_change)


@pytest.mark.parametrize(
    ("section", "key", "remedy"),
    [
        ("a1 = -1.0", "tolerances.a1", "at least 0"),
        ('a1 = "1 mm"', "tolerances.a1", "write a1_mm=1"),
        ("a9 = 1.0", "tolerances.a9", "did you mean"),
        ("a1 = [1.0, 2.0]", "tolerances.a1", "at least 0"),
        ("omega1 = nan", "tolerances.omega1", "rad s-1"),
    ],
)
def test_wrong_tolerances_of_a_study_are_refused(tmp_path, section, key, remedy):
    with refused(key, remedy):
        fl.run(written(tmp_path, STUDY.partition("a1 = 1e-4")[0] + section), to=tmp_path / "maps.h5")


@pytest.mark.parametrize(
    ("given", "key", "remedy"),
    [
        ({}, "tolerance", "a1=1e-4"),
        ({"a1": "0.1"}, "a1", "0.1 %"),
        ({"a1": float("nan")}, "a1", "at least 0"),
        ({"a1": [1e-4, 1e-3]}, "a1", "at least 0"),
        ({"a9": 1.0}, "a9", "did you mean"),
        ({"P_u": 1e-4}, "quantities", "tolerance of an input"),
        ({"a1": 1e-4, "quantities": ["omega4_maxx"]}, "omega4_maxx", "omega4"),
        ({"a1": 1e-4, "quantities": ["grashof_class"]}, "grashof_class", "leave it out"),
        ({"a1": 1e-4, "to": "x.h5", "contributions": True}, "contributions", "leave one"),
    ],
)
def test_bad_requests_are_refused(maps, given, key, remedy):
    with refused(key, remedy):
        fl.tolerance(maps, **given)


def test_the_command_lists_changes(tmp_path):
    run = CliRunner()
    study = written(tmp_path, PLAIN.replace("[1.1, 1.2]", "[1.1]"))
    found = run.invoke(
        app, ["tolerance", str(study), "a1=1e-4", "a3=0.1%", "--contributions", "--quantities", "swing"]
    )
    assert found.exit_code == 0, found.output
    (row,) = [line.split() for line in found.output.splitlines() if line.startswith("swing")]
    own = fl.tolerance(study, ["swing"], a1=1e-4, a3="0.1 %")
    assert row[1] == "rad"
    assert float(row[3]) == pytest.approx(own.swing_worst_change.values.ravel()[0], rel=1e-5)
    wrong = run.invoke(app, ["tolerance", str(study), "a1=x"])
    assert wrong.exit_code == 2
    assert "a1 is 'x'; write a number" in wrong.output
