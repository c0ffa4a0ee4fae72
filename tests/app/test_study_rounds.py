"""All that is wrong with a study is said in one round; files that are no study are told what they are."""

import json
import os
from pathlib import Path

import pytest
from tests.support.refusals import refused
from tests.support.study_files import BARE, GOOD, LENGTHS, written

import fastlink as fl
from fastlink.app import study
from fastlink.app.study import read_study

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
KEYS = (
    "quantities[0]",
    "quantities[1]",
    "design.omga1",
    "design.a1",
    "design.a2",
    "design.a3.linspce",
    "links.model",
    "cycle.branch",
    "cycle.theta1",
    "cycle.teta1",
    "output.fil",
    "run.backend",
)


def lines_of(text, door=read_study):
    with pytest.raises(fl.InputError) as caught:
        door(written(text))
    return [line.removeprefix("study.toml: ") for line in str(caught.value).splitlines()]


def keys_of(text):
    return sorted(line.split(" ")[0].rstrip(":") for line in lines_of(text))


@pytest.mark.parametrize(("mechanism", "further"), [("planar_4r", ()), ("planar_4", ("mechanism",))])
def test_shapes_names_and_values_are_refused_together(folder, mechanism, further):
    """A misspelt mechanism is taken for the nearest meanwhile."""
    assert keys_of(WRONG.replace("MECHANISM", mechanism)) == sorted((*KEYS, *further))


@pytest.mark.parametrize("door", [read_study, fl.run, fl.explain, fl.accuracy])
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
    Path("latin.toml").write_bytes("# Länge".encode("latin-1"))
    for name, what, remedy in (
        ("inner", "is a folder", "give the path of a study"),
        ("study.json", "is JSON, not TOML", "fastlink new"),
        ("study.yaml", "is YAML, not TOML", "fastlink new"),
        ("designs.csv", "is a table of designs", '[design] table = "designs.csv"'),
        ("table.toml", "is a table of designs", '[design] table = "table.toml"'),
        ("empty.toml", "is empty", "fastlink new planar_4r"),
        ("latin.toml", "is not UTF-8 text", "save it as UTF-8"),
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
