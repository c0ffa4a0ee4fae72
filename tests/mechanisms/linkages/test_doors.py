"""A declared linkage goes wherever the name of a mechanism goes, and comes back out of files and studies."""

import pickle

import numpy as np
import pytest
from tests.mechanisms.linkages.declared import DECLARED, SIX_BAR, TURNING, six_bars
from tests.support.refusals import refused as refusing
from tests.test_cli import called

import fastlink as fl
from fastlink.engine.sinks import ProgressBar

STUDY = """
quantities = ["F_x_max", "theta_low"]
{mechanism}
[linkage]
name = "six_bar"
ground = {{O = [0, 0], D = ["a4", 0], G = ["G_x", "G_y"]}}
crank = {{A = ["O", "a1"]}}
{more}
[linkage.dyads]
B = {{rrr = ["A", "D"], lengths = ["a2", "a3"]}}
P = {{on = ["A", "B"], at = ["P_u", "P_v"]}}
F = {{rrr = ["P", "G"], {lengths} = ["a5", "a6"]}}

[cycle]
branch = 3

[design]
{design}
"""


def study_of(path, mechanism="", more="", lengths="lengths", **changes):
    design = "\n".join(f"{name} = {value}" for name, value in (TURNING | changes).items())
    path.write_text(STUDY.format(mechanism=mechanism, more=more, lengths=lengths, design=design))
    return path


def test_a_study_and_its_map(tmp_path):
    path = study_of(tmp_path / "six_bar.toml", a1="{linspace = [0.05, 0.15, 3]}")
    maps = fl.run(path, to=path.with_suffix(".h5"))
    swept = fl.sweep(SIX_BAR, fl.grid(**(TURNING | {"a1": [0.05, 0.1, 0.15]})), ["F_x_max"], branch=3)
    assert (maps.F_x_max.values == swept.F_x_max.values).all()
    best = fl.best(path.with_suffix(".h5"), maximise="F_x_max", top=1)
    assert float(best.a1[0]) == 0.15
    found = fl.tolerance(path.with_suffix(".h5"), ["F_x_max"], a1=1e-4)
    assert found.sizes["a1"] == 3
    fl.draw(path.with_suffix(".h5"), design=1, theta=0.5, to=tmp_path / "drawn.svg")
    assert "bar P F" in (tmp_path / "drawn.svg").read_text()


def test_a_study_with_forces(tmp_path):
    more = 'gravity = [0, "g"]\nmasses = {AB = {mass = 1.0, centre = ["c", 0]}, F = "m"}\nloads = {GF = "T_load"}'
    given = {"g": -9.81, "c": 0.1, "m": 0.3, "T_load": -2.0, "omega": 3.0}
    path = study_of(tmp_path / "six_bar.toml", more=more, **given)
    path.write_text(path.read_text().replace('"F_x_max"', '"torque_max"'))
    linkage = fl.linkage(
        **(DECLARED | {"gravity": (0, "g"), "loads": {"GF": "T_load"}}),
        masses={"AB": {"mass": 1.0, "centre": ("c", 0)}, "F": "m"},
    )
    swept = fl.sweep(linkage, TURNING | given, ["torque_max"], branch=3)
    assert fl.run(path, to=path.with_suffix(".h5")).torque_max.item() == swept.torque_max.item()


@pytest.mark.stress
def test_the_accuracy_of_a_study(tmp_path):
    path = study_of(tmp_path / "six_bar.toml")
    measured = fl.accuracy(path, designs=2)
    # curves are measured by themselves: ends of ranges are lists, of which a design may have several
    assert measured["quantity"].values.tolist() == ["F_x_max"]
    assert float(measured.error_max.min()) < 1e-12


def test_bars_whose_lengths_are_numbers_are_drawn(tmp_path):
    linkage = fl.linkage(
        ground={"O": (0, 0), "D": (0.4, 0)},
        crank={"A": ("O", 0.1)},
        dyads={"B": {"rrr": ("A", "D"), "lengths": (0.3, 0.35)}},
    )
    fl.draw(linkage, theta=0.5, to=tmp_path / "drawn.svg", omega=1.0)
    drawn = (tmp_path / "drawn.svg").read_text()
    assert all(f"bar {bar}" in drawn for bar in ("O A", "A B", "D B"))


def test_pickles_stand_for_the_same_linkage():
    assert pickle.loads(pickle.dumps(SIX_BAR)) == SIX_BAR
    given = {name: value for name, value in TURNING.items() if name != "a1"}
    reach = fl.function(SIX_BAR, ["a1"], ["F_x_max"], branch=3, **given)
    assert pickle.loads(pickle.dumps(reach))([0.1]) == reach([0.1])


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"mechanism": 'mechanism = "hart"'}, "mechanism is given twice, here and by"),
        ({"lengths": "length"}, "linkage.dyads.F.length: 'length' is unknown; did you mean 'lengths'"),
        ({"more": "dyad = 3"}, "linkage.dyad is not a parameter; did you mean 'dyads'"),
    ],
)
def test_mistakes_in_a_study_name_table_and_key(tmp_path, changes, message):
    path = study_of(tmp_path / "wrong.toml", **changes)
    with pytest.raises(fl.InputError) as refused:
        fl.run(path)
    assert message in str(refused.value)


def test_what_a_linkage_has_not_is_refused_and_what_it_has_is_listed(tmp_path):
    with pytest.raises(fl.InputError, match="is not synthesised"):
        fl.synthesise(SIX_BAR, path=[(0.0, 0.0), (1.0, 1.0), (2.0, 1.0)])
    with pytest.raises(fl.InputError, match="no forces without masses; declare masses="):
        fl.sweep(SIX_BAR, TURNING | {"omega": 1.0}, ["d_torque_peak_d_a1"], branch=3)
    done = called("quantities", str(study_of(tmp_path / "six_bar.toml")), "--find", "speed of F")
    assert "F_speed" in done.stdout


def test_the_study_to_begin_with_runs(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "study.toml").write_text(called("new", "linkage").stdout)
    maps = fl.run("study.toml", to="study.h5", verify=8)  # 64 by default, whose 50 digits take four seconds
    assert maps.attrs["verify_mismatches"] == 0
    assert float(maps.torque_peak.min()) < np.inf


def test_what_a_search_finds_of_a_linkage_is_written_and_read(tmp_path, monkeypatch):
    place, given = tmp_path / "found.h5", {name: value for name, value in TURNING.items() if name != "a1"}
    space, shown = fl.sobol(64, a1=(0.05, 0.12), omega=1.0, **given), []
    monkeypatch.setattr(ProgressBar, "merge", lambda _, count: shown.append(count))
    found = fl.search(SIX_BAR, space, maximise="F_x_max", branch=(1, 3), top=1, to=place)
    # the branches of a linkage have a status each, and a search counts designs
    flags = [count for name, count in found.attrs.items() if name.startswith("searched_branches_")]
    assert (sum(flags), found.attrs["searched_designs"]) == (128, 64)
    assert 64 <= sum(shown) < 2 * 64  # the found one is swept again
    with fl.open(place) as written:
        assert written.F_x_max.item() == found.F_x_max.item()
        assert written.attrs["mechanism"] == str(SIX_BAR)


@pytest.mark.parametrize("name", ["omega_AB_rms", "alpha_GF_mean", "omega_PF_fluctuation"])
def test_integrals_that_a_limit_of_motion_may_spoil_are_refused_but_of_samples(name):
    designs = six_bars(3, 5) | {"omega": 1.0}
    with refusing(name, "write extrema='sampled'"):
        fl.sweep(SIX_BAR, designs, [name], branch=1)
    assert name in fl.sweep(SIX_BAR, designs, [name], branch=1, extrema="sampled")
