"""The studies of the repository run, at reduced size, and their numbers are those that their comments promise."""

import json
import os
import re
from pathlib import Path

import h5py
import numpy as np
import pytest
import xarray as xr
from numpy.testing import assert_allclose, assert_array_equal
from tests.support.refusals import refused
from tests.support.study_files import BARE, GOOD, LENGTHS, written
from tests.support.sweeps import sweep_4r
from typer.testing import CliRunner

import fastlink as fl
from fastlink.app import study
from fastlink.app.cli import app
from fastlink.app.study import read_study
from fastlink.engine.resolve import resolve
from fastlink.errors import MOST_LINES
from fastlink.mechanisms import catalogue
from fastlink.numerics.compensated import UNIT_ROUNDING

CLASS_FLAGS = catalogue("planar_4r").facts["grashof_class"].flags

STUDIES = Path(__file__).parents[2] / "data" / "studies"
TURN = 2.0 * np.pi


def reduced(name, angles=24, points=3):
    """Run a study with few points on each axis and given input angles, which extremes are then taken over."""
    text = (STUDIES / name).read_text(encoding="utf-8")
    axis = rf"linspace = [\1, {points}]"
    small = re.sub(r"linspace = \[([^]]*), \d+\]", axis, text)
    turn = f'theta1 = {{linspace = [0.0, {TURN * (angles - 1) / angles}, {angles}]}}\nextrema = "sampled"'
    small = re.sub(r"^theta1 = \d+$", turn, small, flags=re.MULTILINE)
    path = Path(name)
    path.write_text(small, encoding="utf-8")
    with fl.run(path) as maps:
        return maps.load()


#: Table 2 and what docs/papers.md has for Table 3, in both assembly modes: value and place.
TABLES = (
    ("omega4_min", (-23.95938172, -23.95938172), (0.36933536497, 5.91384994221)),
    ("omega4_max", (13.51343678, 13.51343678), (TURN - 1.66716501134, 1.66716501134)),
    ("alpha4_max", (462.6986574, 1062.775829), (0.8382412814, 0.1482557001)),
    ("alpha4_min", (-1062.775829, -462.6986574), (TURN - 0.1482557001, 5.44494402572)),
)
SHAKING = ("shaking_force_max", (2512.318, 2512.318), (TURN - 0.1096, 0.1096))


def assert_tables(maps, tables, value, place):
    for name, values, places in tables:
        assert_allclose(maps[name], values, rtol=value, err_msg=name)
        assert_allclose(maps[f"theta1_at_{name}"] % TURN, places, rtol=0, atol=place, err_msg=name)


def test_the_example_of_the_paper_to_every_digit(folder):
    with fl.run(STUDIES / "hayes_table1.toml") as maps:
        # Half a unit of the last of ten digits printed; of the places the errata give eleven decimals.
        assert_tables(maps, TABLES, value=5e-10, place=1e-10)
        assert_tables(maps, [SHAKING], value=3e-7, place=5e-5)
        assert CLASS_FLAGS[int(maps.grashof_class)] == "crank_rocker"
        assert {"omega4", "alpha4", "T41", "shaking_force", "shaking_moment"} <= set(maps)


def test_the_quick_return_atlas(folder):
    maps = reduced("quick_return_atlas.toml")
    assert set(maps.time_ratio.dims) == {"a1", "a2", "a3"}
    cranks = maps.grashof_class.values == 0
    assert cranks.any()
    assert_array_equal(np.isfinite(maps.time_ratio.values), cranks)
    assert maps.time_ratio.min() >= 1.0
    assert maps.swing.values[cranks].max() < np.pi


def test_the_map_of_counterweights(folder):
    maps = reduced("counterweights.toml")
    design = {"a1": 0.4, "a2": 1.2, "a3": 0.8, "a4": 1.0, "omega1": 25.0}
    bars = fl.round_bar(7750.0, 0.01)
    force = maps.shaking_force_max.values
    angles = np.linspace(0.0, TURN * 23 / 24, 24)
    options = {"links": bars, "theta1": angles, "extrema": "sampled"}
    without = sweep_4r(fl.grid(**design), ["shaking_force_max"], **options)
    # Masses of zero change no bit.
    assert_array_equal(force[0, 0], without.shaking_force_max)
    # The middle is the balance of Berkof and Lowen: the masses are products of a dozen roundings at most.
    weights = fl.planar.force_balance(design, links=bars, radius1=0.2, radius3=0.4)
    for i in (1, 3):
        name = f"counterweight{i}_mass"
        assert_allclose(maps[name][1], weights[name], rtol=16 * UNIT_ROUNDING)
    # What is left there are roundings of some ten terms of the force that the counterweights take away.
    assert np.all(force[1, 1] <= 32 * UNIT_ROUNDING * force[0, 0])


@pytest.mark.sample(2)
@pytest.mark.parametrize("name", sorted(path.name for path in STUDIES.glob("*.toml")))
def test_every_study_says_what_it_is_for_and_how_to_run_it(name):
    text = (STUDIES / name).read_text(encoding="utf-8")
    assert text.startswith("# ")
    assert f"#     fastlink run data/studies/{name}" in text
    assert "fastlink plot" in text or "fastlink draw" in text  # a search has a few designs, which are drawn
    study = read_study(STUDIES / name)
    inputs = catalogue(study.mechanism).inputs
    assert {name for name, one in inputs.items() if one.rule == "positive"} <= set(study.space.names)


# == Study files: what they mean =============================================================================


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


@pytest.mark.parametrize("kind", ["sobol", "latin_hypercube"])
def test_a_sample_beside_constants(folder, kind):
    text = f"{BARE}[design]\n{kind} = {{n = 8, seed = 3, a1 = [0.2, 0.4], a2 = 1.2}}\na3 = 0.8\na4 = 1.0\n"
    space = read_study(written(text)).space
    expected = getattr(fl, kind)(8, seed=3, a1=(0.2, 0.4), a2=1.2)
    assert_array_equal(space.columns["a1"], expected.columns["a1"])
    assert space.constants == {"a2": 1.2, "a3": 0.8, "a4": 1.0}


def test_a_table_is_found_beside_the_study_and_a_long_study_is_kept_whole(folder):
    Path("inner").mkdir()
    Path("inner/designs.csv").write_text("a1,a2\n0.4,1.2\n0.3,1.1\n")
    text = f'{BARE}[design]\ntable = "designs.csv"\na3 = 0.8\na4 = 1.0\n'
    space = read_study(written(text, "inner/study.toml")).space
    assert_array_equal(space.columns["a2"], [1.2, 1.1])
    text = GOOD + "".join(f"# line {k} of a long comment\n" for k in range(5000))
    assert len(text) > 2**16
    with fl.run(written(text), to="long.h5") as maps:
        assert maps.attrs["study"] == text
    study = read_study(written(BARE + "[design]\n" + LENGTHS))
    resolved = resolve(study.mechanism, study.space, study.quantities, **{"branch": (1, 2)} | study.options)
    assert resolved.branches == (1, 2)
    assert_array_equal(resolved.positions, np.arange(360) * (2 * np.pi / 360))


def test_the_main_study_is_as_large_as_promised():
    study = read_study(STUDIES / "crank_rocker_map.toml")
    assert study.space.size >= 10**6
    assert study.space.dims == ("a2", "a3", "a4")
    centre = {"a2": 1.2, "a3": 0.8, "a4": 1.0}
    for name, value in centre.items():
        assert np.abs(study.space.axes[name] - value).min() < 1e-12
    assert study.output["file"] == "crank_rocker_map.h5"


# == All that is wrong with a study is said in one round; files that are no study are told what they are =====

#: Wrong in every table: types, names and values.
WRONG = """
mechanism = "MECHANISM"
quantities = ["omga4_max", 3, "theta4"]
[design]
omga1 = 2.0
a1 = "x"
a2 = -1.0
a3 = {linspce = [1, 2, 3]}
[links]
model = "round_ba"
[cycle]
branch = 7
theta1 = "x"
teta1 = "y"
[output]
fil = "x.h5"
[run]
backend = "nmba"
"""
KEYS = ["quantities[0]", "quantities[1]", "design.omga1", "design.a1", "design.a2", "design.a3.linspce"]
KEYS += ["links.model", "cycle.branch", "cycle.theta1", "cycle.teta1", "output.fil", "run.backend"]


def lines_of(text, door=fl.run):
    """Return the lines with which a study is refused, without the name of the file."""
    with pytest.raises(fl.InputError) as caught:
        door(written(text))
    lines = str(caught.value).splitlines()
    assert all(line.startswith("study.toml: ") for line in lines)
    return [line.removeprefix("study.toml: ") for line in lines]


def keys_of(text):
    return sorted(line.split(" ")[0].rstrip(":") for line in lines_of(text))


@pytest.mark.parametrize(("mechanism", "further"), [("planar_4r", ()), ("planar_4", ("mechanism",))])
def test_shapes_names_and_values_are_refused_together(folder, mechanism, further):
    """A misspelt mechanism is taken for the nearest meanwhile."""
    assert keys_of(WRONG.replace("MECHANISM", mechanism)) == sorted((*KEYS, *further))


@pytest.mark.parametrize("door", [read_study, fl.explain, fl.accuracy])
def test_every_door_says_the_same(folder, door):
    assert lines_of(WRONG, door) == lines_of(WRONG)


def test_each_problem_of_many_is_the_only_one_when_the_others_are_mended(folder):
    """What is said of a broken study is not a consequence of its other faults."""
    for old, new, key in (
        ('"omega4_max", "theta4"', '"omega4_max", 4, "thta4"', ["quantities[1]", "quantities[2]"]),
        ("a1 = 0.4", "a1 = 'x'\nomga1 = 1.0", ["design.a1", "design.omga1"]),
        ("theta1 = 8", "theta1 = 'x'\nbranch = 7", ["cycle.branch", "cycle.theta1"]),
        ("omega1 = 25.0", "radius = 0.1\n[links]\nmodel = 'x'", ["links.model"]),
        ("omega1 = 25.0", "[links]\ndensity = 1.0", ["links.model"]),
    ):
        assert old in GOOD
        assert keys_of(GOOD.replace(old, new)) == key


@pytest.mark.parametrize(
    ("text", "key", "remedy"),
    [
        (BARE + LENGTHS, "a1 stands outside of every table", "write it under [design]"),
        (
            f'mechanism = "planar_4r"\n[design]\n{LENGTHS}quantities = ["theta4"]\n',
            "quantities",
            "above the first [table]",
        ),
        (f"{BARE}theta1 = 8\n[design]\n{LENGTHS}", "theta1", "write it under [cycle]"),
        (f"{BARE}[design]\n{LENGTHS}branch = 1\n", "branch stands under [design]", "write it under [cycle]"),
        (f"{BARE}[design]\n{LENGTHS}[cycle]\nomega1 = 2.0\n", "omega1", "write it under [design]"),
        (f"{BARE}file = 'x.h5'\n[design]\n{LENGTHS}", "file", "write it under [output]"),
        (f"{BARE}[design]\n{LENGTHS}[output]\nbackend = 'numba'\n", "backend", "write it under [run]"),
        (f"{BARE}[design]\n{LENGTHS}[output]\nradius = 1.0\n", "radius", "write it under [links]"),
        (
            f"{BARE}[design]\nmodel = 'round_bar'\n{LENGTHS}[links]\ndensity = 1.0\n",
            "model",
            "write it under [links]",
        ),
    ],
)
def test_a_key_in_another_table_is_sent_home(folder, text, key, remedy):
    """It is read there meanwhile, so that nothing else is missing."""
    first, *others = [line for line in lines_of(text) if not line.startswith("links.radius")]
    assert key in first.partition("; ")[0]
    assert remedy in first.partition("; ")[2]
    assert all(remedy in line for line in others)


def test_what_is_no_study_is_told_what_it_is(folder, monkeypatch):
    Path("inner").mkdir()
    written(json.dumps({"mechanism": "planar_4r"}, indent=1), "study.json")
    written("# a study\nmechanism: planar_4r\nquantities: [swing]\n", "study.yaml")
    written("a1,a2\n0.4,1.2\n", "designs.csv")
    written("a1,a2\n0.4,1.2\n", "table.toml")
    written("# nothing yet\n", "empty.toml")
    written(GOOD.replace("a1 = 0.4", "a1 = "), "value.toml")
    written(GOOD + "a1\n", "key.toml")
    sweep_4r(fl.grid(a1=0.4, a2=1.2, a3=0.8, a4=1.0), ["grashof_class"], to="map.h5").close()
    Path("latin.toml").write_bytes("# Länge".encode("latin-1"))
    for name, what, remedy in (
        ("inner", "is a folder", "give the path of a study"),
        ("study.json", "is JSON, not TOML", "fastlink new"),
        ("study.yaml", "is YAML, not TOML", "fastlink new"),
        ("designs.csv", "is a table of designs", '[design] table = "designs.csv"'),
        ("table.toml", "is a table of designs", '[design] table = "table.toml"'),
        ("empty.toml", "is empty", "fastlink new planar_4r"),
        ("latin.toml", "is not UTF-8 text", "save it as UTF-8"),
        ("value.toml", "is not TOML: Invalid value (at line 5, column 6)", ""),
        ("key.toml", "is not TOML: Expected '=' after a key in a key/value pair (at line 12, column 3)", ""),
        ("absent.toml", "cannot be read (No such file", ""),
        ("map.h5", "is a map, not a study", "`fastlink info map.h5` shows it"),
    ):
        for door in (fl.run, fl.explain, fl.accuracy):
            with refused(f"{name}: {what}", remedy):
                door(name)
    monkeypatch.setattr(study, "MOST_BYTES", 100)
    with refused("too long for a study", "Parquet file"):
        fl.run(written(GOOD))


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no pipes here")
def test_pipes_and_devices_are_not_read(folder):
    os.mkfifo("pipe.toml")
    for name in ("pipe.toml", "/dev/zero"):
        with refused("is a device or a pipe, not a study", "give the path of a study"):
            fl.run(name)


# == Study files: one clear line for each thing that is wrong with them ======================================


def assert_problem(text, key, remedy):
    """Assert that one problem of a study is told: at its key, with its remedy."""
    (line,) = lines_of(text)
    assert line.split(" ")[0].rstrip(":") == key
    assert remedy in line.partition("; ")[2]
    assert not any(word in line for word in ("numpy", "allow_invalid=True", "(lo, hi)"))


NUMBER = "write a finite number, or {linspace = [lo, hi, n]},"
LINSPACE = "write [lo, hi, n] with finite lo and hi and a whole number"
ONE_SIGN = "write [lo, hi, n] with finite lo and hi of one sign,"
LIST = 'write a list of names, such as ["omega4_max"]'
BARS = "[links]\nmodel = 'round_bar'\n"


@pytest.mark.parametrize(
    ("old", "new", "key", "remedy"),
    [
        ("mechanism", "mechanim", "mechanim", "did you mean 'mechanism'?"),
        ("[design]", "[desing]", "desing", "did you mean 'design'?"),
        ("linspace", "linspce", "design.a2.linspce", "did you mean 'linspace'?"),
        ("theta1", "teta1", "cycle.teta1", "did you mean 'theta1'?"),
        ("a4 = 1", "a4 = 1\nomega_1 = 2", "design.omega_1", "did you mean 'omega1'?"),
        ("[cycle]", f"{BARS}radus = 1\n[cycle]", "links.radus", "did you mean 'radius'?"),
        ("a2 = {linspace = [1.0, 1.4, 3]}", "sobool = {n = 4}", "design.sobool", "did you mean 'sobol'?"),
        ("theta1 = 8", "theta1 = {geomspace = [1]}", "cycle.theta1.geomspace", "did you mean 'linspace'?"),
        ('"planar_4r"', '"planar_4"', "mechanism", "did you mean 'planar_4r'?"),
        ("omega4_max", "omga4_max", "quantities[0]", "did you mean 'omega4_max'"),
        ("[cycle]", "[links]\nmodel = 'round_ba'\n[cycle]", "links.model", "did you mean 'round_bar'?"),
        ("[cycle]", "[links]\nmodel = 3\n[cycle]", "links.model", "write a text that is not empty"),
        ("[cycle]", "[cycle]\nsolver = 'dens'", "cycle.solver", "did you mean 'dense'?"),
        ("[cycle]", "[cycle]\nbranch = 3", "cycle.branch", "write some of 1, 2"),
        ('"planar_4r"', "4", "mechanism", "write a text that is not empty"),
        ('["omega4_max", "theta4"]', '"theta4"', "quantities", LIST),
        ('"theta4"]', "4]", "quantities[1]", "write the name of a quantity as text"),
        ("a1 = 0.4", 'a1 = "0.4"', "design.a1", NUMBER),
        ("a1 = 0.4", "a1 = 1e999", "design.a1", NUMBER),
        ("1.4, 3]", "1.4, 3.0]", "design.a2.linspace", LINSPACE),
        ("1.4, 3]", "1.4, 10000001]", "design.a2.linspace", LINSPACE),
        ("linspace = [1.0", "geomspace = [-1.0", "design.a2.geomspace", ONE_SIGN),
        ("[0.8, 0.7]", '[0.8, "x"]', "design.a3.values[1]", "write a finite number"),
        (
            "theta1 = 8",
            "theta1 = 8.5",
            "cycle.theta1",
            "write a number of angles from 1 to 10000000, {linspace =",
        ),
        ("[cycle]", "[cycle]\nbranch = 'left'", "cycle.branch", "2 (B to the left"),
        ("[cycle]", "[cycle]\nbranch = 'both'", "cycle.branch", "write branch = [1, 2]"),
        ("[cycle]", "[cycle]\nbranch = true", "cycle.branch", "write branches, such as [1, 2]"),
        ("a1 = 0.4", "a1 = '400 mm'", "design.a1", "write a1_mm=400"),
        ("[cycle]", "[output]\noverwrite = 1\n[cycle]", "output.overwrite", "write true or false"),
        ("[cycle]", f"{BARS}radius = {{values = [1]}}\n[cycle]", "links.radius", "make it an axis in"),
        ("[0.8, 0.7]", "[]", "design.a3.values", "write a list of one or more finite numbers"),
        ("{values = [0.8, 0.7]}", "{}", "design.a3", "write exactly one of geomspace, linspace, values"),
        ("values = [0.8", "linspace = [1, 2, 3], values = [0.8", "design.a3", "write exactly one of"),
        ("[0.8, 0.7]", "[0.8, 0.8]", "design.a3", "give each value once"),
        ("[0.8, 0.7]", "[0.8, 0.0]", "design.a3[1]", "write a finite number greater than 0"),
        ("[cycle]", "[cycle]\nbranch = [1, 1]", "cycle.branch", "write each once"),
        ("theta1 = 8", "theta1 = {values = [1, 1]}", "cycle.theta1", "give each position once"),
        ('"theta4"]', '"omega4_max"]', "quantities[1]", "name it once"),
        ('quantities = ["omega4_max", "theta4"]', "", "quantities", 'write quantities = ["omega4_max"]'),
        ("omega1 = 25.0", "", "design.omega1", "omega4_max depends on it: add it"),
        ("[cycle]", "[links]\ndensity = 1.0\n[cycle]", "links.model", 'write model = "round_bar"'),
    ],
)
def test_bad_input(folder, old, new, key, remedy):
    assert old in GOOD
    assert_problem(GOOD.replace(old, new, 1), key, remedy)


SOBOL = "sobol = {n = 4, a1 = [1, 2]}\n"


@pytest.mark.parametrize(
    ("design", "key", "remedy"),
    [
        ("", "design", "write a table [design] with a number or an axis for each"),
        ("[design]\n", "design", "write a number or an axis for each input"),
        ("[[design]]\na1 = 1\n", "design", "write a table of keys, such as [design]"),
        (f"[design]\n{SOBOL}a2 = {{values = [1]}}\n", "design", "write one of them, beside"),
        (
            f"[design]\n{SOBOL}latin_hypercube = {{n = 4, a1 = [1, 2]}}\n",
            "design",
            "write one of them, beside",
        ),
        (
            "[design]\nsobol = {n = 0, a1 = [1, 2]}\n",
            "design.sobol.n",
            "an integer from 1 to 1125899906842624",
        ),
        ("[design]\nsobol = {a1 = [1, 2]}\n", "design.sobol.n", "write n = 1024, the number of designs"),
        ("[design]\nsobol = {n = 4}\n", "design.sobol", "write [lo, hi] for at least one, or use a grid"),
        ("[design]\nsobol = {n = 4, a1 = [2, 1]}\n", "design.sobol.a1", "write [lo, hi] with lo < hi"),
        (
            "[design]\nsobol = {n = 4, a1 = [1, 2, 3]}\n",
            "design.sobol.a1",
            "with finite lo < hi, or one finite",
        ),
        (f"[design]\n{SOBOL}a1 = 3\n", "design.sobol", "write it once"),
        (f"[design]\n{LENGTHS}sobol = {{n = 4, omga1 = [1, 2]}}\n", "design.sobol.omga1", "'omega1'?"),
        ("[design]\ntable = 3\n", "design.table", 'a CSV or Parquet file, such as "designs.csv"'),
        ("[design]\ntable = 'absent.csv'\n", "design.table", "give the path of a CSV file"),
        ("[design]\ntable = 'holes.csv'\n", "design.table", "write a finite number"),
        (f"[design]\n{LENGTHS}radius = 0.01\n", "design.radius", '[links] model = "round_bar"'),
    ],
)
def test_bad_designs(folder, design, key, remedy):
    Path("holes.csv").write_text("a1,a2\n1,2\n1,\n")
    assert_problem(BARE + design, key, remedy)


def test_lacking_links_and_very_many_problems_are_told(folder):
    text = BARE.replace("theta4", "T41") + f"[design]\nomega1 = 1\n{LENGTHS}[links]\nmodel = 'round_bar'\n"
    assert lines_of(text) == [
        "links.density is missing (density of the round bars [kg m-3]); T41 depends on it: add it",
        "links.radius is missing (radius of the round bars [m]); T41 depends on it: add it",
    ]
    names = ", ".join(f'"wrong{k}"' for k in range(MOST_LINES + 5))
    lines = lines_of(GOOD.replace('"omega4_max", "theta4"', names))
    assert len(lines) == MOST_LINES + 1
    assert lines[-1] == "and 5 more problems"


def of_the_caller(text, **options):
    """Return the error of what the study does not say, but its caller."""
    with pytest.raises(fl.InputError) as caught:
        fl.run(written(text), **options)
    return caught.value


def test_output_that_cannot_be_written_is_told_in_the_words_of_the_caller(folder):
    (line,) = lines_of(GOOD + '[output]\nfile = "no/map.h5"\n')
    assert line.startswith("output.file: ")
    assert line.endswith("there is no folder " + f"{folder / 'no'}; create it or choose another")
    assert of_the_caller(GOOD, to="no/map.h5").where == ("to",)
    assert_problem(GOOD + '[output]\nfile = ""\n', "output.file", "write a text that is not empty")
    assert not Path("study.h5").exists()


@pytest.mark.parametrize("name", ["study.toml", "designs.csv"])
def test_a_study_never_replaces_what_it_is_read_from(folder, name):
    Path("designs.csv").write_text("a1,a2\n0.4,1.2\n")
    text = f'{BARE}[design]\ntable = "designs.csv"\na3 = 0.8\na4 = 1.0\n'
    error = of_the_caller(text, to=name, overwrite=True)
    assert (error.where, error.what) == (("to",), f"{name!r} is not the name of an HDF5 file")
    Path("link.h5").symlink_to(name)
    error = of_the_caller(text, to="link.h5", overwrite=True)
    assert (error.where, error.what) == (("to",), "link.h5 is a file that is read for it")
    assert Path("designs.csv").read_text() == "a1,a2\n0.4,1.2\n"


def test_an_existing_file_is_replaced_when_the_study_or_the_caller_says_so(folder):
    path = written(GOOD)
    fl.run(path).close()
    fl.run(path).close()  # the same again is up to date
    (line,) = lines_of(GOOD + "# and more\n")
    assert line.startswith("output.file: ")
    assert line.endswith("overwrite=True")
    fl.run(path, overwrite=True).close()
    fl.run(written(GOOD + "[output]\noverwrite = true\n")).close()


@pytest.mark.parametrize("search", ["", '[search]\nminimise = ["omega4_max"]\ntop = 1\n'])
def test_a_study_of_its_own_replaces_maps_alone(folder, search):
    text = GOOD + search + "[output]\noverwrite = true\n"
    with h5py.File("theirs.h5", "w") as file:
        file["measured"] = [1.0, 2.0]
    for other in (Path("theirs.h5").read_bytes(), b"", b"years of work"):
        Path("study.h5").write_bytes(other)
        (line,) = lines_of(text)
        assert line.startswith("output.file: ")
        assert "is no map" in line
        assert line.endswith("overwrite=True")
        assert Path("study.h5").read_bytes() == other
    done = CliRunner().invoke(app, ["run", "study.toml", "--quiet"])
    assert done.exit_code == 2
    assert done.output.endswith("or write --overwrite\n")
    fl.run(written(text), overwrite=True).close()
    fl.run(written(text + "# and more\n")).close()


def test_columns_of_a_table_are_kept(folder):
    Path("designs.csv").write_text("a2,part_no\n1.1,7\n1.2,8\n")
    rest = "a1 = 0.4\na3 = 0.8\na4 = 1.0\n"
    text = BARE + "[design]\n{}table = 'designs.csv'\n" + rest
    assert_problem(text.format(""), "design.table.part_no", 'keep = ["part_no"]')
    with fl.run(written(text.format("keep = ['part_no']\n"))) as maps:
        assert maps.part_no.values.tolist() == [7, 8]
    assert_problem(BARE + "[design]\nkeep = ['part_no']\na2 = 1.2\n" + rest, "design.keep", "table = ...")
    assert lines_of(text.format("keep = 7\n"))[0].startswith("design.keep is 7; write names of columns")
    assert (
        lines_of(text.format("keep = [7]\n"))[0] == "design.keep[0] is 7; write the name of a column as text"
    )


def test_an_input_called_as_a_parameter_of_a_sample(folder):
    text = """mechanism = "hart"
quantities = ["stroke"]
[design]
sobol = {n = 8, ranges = {n = [1.0, 2.0]}, m = [1.5, 2.5], d = 1.0, kappa = 0.5}
"""
    with fl.run(written(text)) as maps:
        assert (maps.n.dims, maps.attrs["design_n"]) == (("design",), 8)
        assert 1.0 <= maps.n.values.min() < maps.n.values.max() <= 2.0
