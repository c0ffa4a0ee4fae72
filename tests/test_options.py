"""Options are checked at every door, in the same words, before anything is computed."""

import os
import pickle
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_array_equal
from typer.testing import CliRunner

import fastlink as fl
from fastlink import machine
from fastlink._text import short_repr
from fastlink.app.cli import app
from fastlink.engine.options import MOST_THREADS, is_reserved
from fastlink.errors import LONGEST_FILE_NAME, InputError, Pair, Problem, Problems, Samples, Setting, Wording
from tests.support.refusals import assert_refusal, refused
from tests.support.study_files import GOOD, written
from tests.support.sweeps import sweep_4r, sweep_both

SPACE = fl.grid(a1=0.4, a2=[1.1, 1.2], a3=0.8, a4=1.0, omega1=25.0)

SWITCHES = [1, 0, "no", "false", None, [True], np.array([True, False])]
PATHS = [b"maps.h5", 5, True, {"maps.h5"}, ["maps.h5"]]
PATHS += ["", " ", "a\0b.h5", "a\nb.h5", "a\ud800.h5", "x" * 300, "d/" * 3000 + "m.h5"]


def sweep(**options):
    return sweep_4r(SPACE, ["omega4_max"], **options)


def function(**options):
    return fl.function("planar_4r", ["a2"], ["omega4_max"], a1=0.4, a3=0.8, a4=1.0, omega1=25.0, **options)


def evaluate(**options):
    inputs = {"a1": 0.4, "a2": 1.1, "a3": 0.8, "a4": 1.0, "theta1": 1.0}
    return fl.evaluate("planar_4r", ["theta4"], **inputs, **options)


def study(**options):
    return fl.run(written(GOOD), **options)


def accuracy(**options):
    return fl.accuracy(written(GOOD), **options)


def table(**options):
    return fl.table({"a1": [1.0, 2.0]}, **options)


def plot_map(**options):
    return fl.plot(sweep(), "omega4_max", **options)


def quantities(**options):
    return fl.quantities("planar_4r", **options)


def explain(**options):
    return fl.explain(written(GOOD), **options)


def integer_designs(**options):
    return fl.hart.integer_designs(**({"max_size": 3} | options))


def names(known):
    return [1, {known}, [known], known.encode(), np.array(["a", "b"])]


#: Values that are refused, by a part of the remedy and the options.
REFUSED = [
    (f"from 1 to {MOST_THREADS}", "threads", [0, -1, 1.5, True, "2", 10**9, 10**30, {1}]),
    ("0 for none", "verify", [-1, 1.5, True, "all", 10**12, [1]]),
    ("True or False", "overwrite allow_invalid degrees internal movable outside", SWITCHES),
    ("True or False", "progress measure", ["yes", 1, [], {}]),
    ("from 1 to 500", "max_size", [0, 501, 1.5, True, "8"]),
    ("from 1 to", "angles", [0, -1, 10**30]),
    ("at least 1", "block", [0, -1, 1.5, True, "64", np.array([1, 2])]),
    ("from 1 to", "designs", [0, -1, 1.5, True, 10**12, None]),
    ("from 0 to", "seed", [-1, 1.5, True, 2**63, None]),
    ("such as print", "announce", ["print", 1, True]),
    ("such as", "to picture", PATHS),
    ("a mapping", "attrs", [[("a", 1)], "text", 5]),
    ("letters", "attrs", [{1: 2}]),
    ("dense", "solver", [None, *names("dense")]),
    ("refined", "extrema", names("refined")),
    ("llvm", "backend", ["", *names("llvm")]),
    ("theta1", "input", names("theta1")),
]
#: The options of each door.
DOORS = {
    sweep: "angles threads verify overwrite progress allow_invalid block to attrs solver extrema backend input",
    evaluate: "allow_invalid solver input",
    table: "allow_invalid",
    plot_map: "degrees to",
    quantities: "internal input",
    explain: "measure",
    integer_designs: "max_size movable",
    function: "angles solver extrema backend input",
    study: "threads verify overwrite progress to",
    accuracy: "designs outside seed to picture overwrite announce",
}
CASES = [
    pytest.param(door, option, values, remedy, id=f"{door.__name__}-{option}-{remedy}")
    for door, known in DOORS.items()
    for remedy, options, values in REFUSED
    for option in options.split()
    if option in known.split()
]


@pytest.mark.parametrize(("door", "option", "values", "remedy"), CASES)
def test_a_wrong_option_is_refused_alike_at_every_door(folder, door, option, values, remedy):
    for value in values:
        with refused(option, remedy):
            door(**{option: value})
    assert sorted(path.name for path in folder.iterdir()) in ([], ["study.toml"])


@pytest.mark.parametrize(
    ("door", "key", "example"),
    [
        (fl.open, "path", "maps.h5"),
        (fl.run, "study", "study.toml"),
        (fl.accuracy, "study", "study.toml"),
        (fl.explain, "study", "study.toml"),
    ],
)
def test_what_no_file_can_be_called_is_refused_wherever_a_file_is_read(door, key, example):
    for value in PATHS:
        with refused(key, example):
            door(value)
    with refused("table", "designs.csv"):
        fl.table("a\0b.csv")


def test_a_path_may_begin_at_home_be_any_path_like_and_as_long_as_its_neighbours_allow(folder, monkeypatch):
    class Entry:
        def __fspath__(self):
            return "~/by_entry.h5"

    monkeypatch.setenv("HOME", str(folder))
    sweep(to=Entry(), verify=0).close()
    with fl.open("~/by_entry.h5") as maps:
        assert maps.sizes["a2"] == 2
    for length in (LONGEST_FILE_NAME - less for less in (20, 13, 12, 5, 0)):
        try:
            sweep(to="x" * length, verify=0).close()
        except fl.InputError as error:
            assert_refusal(error, "to", "choose another place")
    assert not [name for name in os.listdir(folder) if ".part" in name]


@pytest.mark.parametrize("name", ["map.gif", "map.csv", "map", "map.jpg", ".png", "map.png.txt"])
def test_pictures_are_png_svg_or_pdf(folder, name):
    maps = sweep()
    with refused("to", "png, svg, pdf"):
        fl.plot(maps, "omega4_max", to=name)
    with refused("picture", "png, svg, pdf"):
        accuracy(picture=name)
    assert not Path(name).exists()


@pytest.mark.parametrize(
    ("arguments", "option"),
    [
        (["run", "study.toml", "--threads", "1000000000"], "--threads"),
        (["run", "study.toml", "--verify", "1000000000000"], "--verify"),
        (["run", "study.toml", "--to", ""], "--to"),
        (["accuracy", "study.toml", "--designs", "0"], "--designs"),
        (["accuracy", "study.toml", "--picture", "x.csv"], "--picture"),
        (["accuracy", "study.toml", "--to", "study.toml", "--overwrite"], "--to"),
    ],
)
def test_the_command_line_names_its_own_options(folder, arguments, option):
    written(GOOD)
    done = CliRunner().invoke(app, arguments)
    (line,) = done.stderr.splitlines()
    assert done.exit_code == 2
    assert line.startswith(f"fastlink: {option}")
    assert Path("study.toml").read_text() == GOOD


NAMES = ["", "a/b", "a\0b", "a ", "\ud800", "_NCProperties", "CLASS", "coordinates", "a" * 300]
VALUES = [None, b"text", {}, "x\0y", "\ud800", 2**64, -(2**63) - 1, 1j, [], ["x", "y"], [[1.0], [2.0, 3.0]]]
VALUES += [np.zeros((2, 2)), np.longdouble(1), np.float16(1), np.datetime64("2020-01-01")]


GOOD_ATTRS = {
    "author": "Ü",
    "empty": "",
    "a note": "x" * 100_000,
    "number": -(2**63),
    "large": 2**64 - 1,
    "ratio": float("nan"),
    "single": np.float32(1.5),
    "flag": True,
    "list": [1, 2, 3],
    "array": np.arange(10_000.0),
    "designer": "A. Name",
    "sample_count": 3,
    "title": "of my own",
}


def test_attributes_are_kept_in_memory_and_in_files_or_refused_before_anything_is_computed(folder):
    in_memory = sweep(attrs=GOOD_ATTRS)
    with sweep(attrs=GOOD_ATTRS, to="maps.h5") as in_file:
        for name, value in GOOD_ATTRS.items():
            assert_array_equal(in_memory.attrs[name], value)
            assert_array_equal(in_file.attrs[name], value)
    for name in NAMES:
        with refused("attrs", "letters"):
            sweep(attrs={name: 1})
    for value in VALUES:
        with refused("attrs", "write "):
            sweep(attrs={"a": value})


def test_no_attribute_of_a_map_can_be_overwritten(folder):
    maps = [
        sweep(to="maps.h5", verify=1),
        sweep_4r(fl.sobol(4, a1=(0.1, 0.2), a2=1.1, a3=0.8, a4=1.0), ["theta4_max"]),
        sweep_both("hart", fl.grid(m=4.0, n=8.0, d=6.0, kappa=0.5), ["F_x"]),
        study(verify=1),
    ]
    for one in maps:
        one.close()
        for name in one.attrs.keys() - {"title", "study", "study_file"}:
            assert is_reserved(name), name
            with refused("attrs", "another name"):
                sweep(attrs={name: one.attrs[name]})
    with pytest.raises(fl.InputError) as caught:
        sweep(attrs=maps[0].attrs)
    assert all(name in caught.value.what for name in ("mechanism", "designs", "threads", "run_time_s"))


@pytest.mark.parametrize("started", [0, 1, 3])
def test_a_system_that_starts_few_threads_computes_all_the_same(monkeypatch, started):
    usual = machine.ThreadPoolExecutor.submit
    count = 0

    def limited(pool, work):
        nonlocal count
        count += 1
        if count > started:
            raise RuntimeError("can't start new thread")
        return usual(pool, work)

    space = fl.grid(a1=0.4, a2=np.linspace(1.1, 1.3, 64), a3=0.8, a4=1.0, omega1=25.0)
    expected = sweep_4r(space, ["omega4_max"], threads=1)
    monkeypatch.setattr(machine.ThreadPoolExecutor, "submit", limited)
    maps = sweep_4r(space, ["omega4_max"], threads=4, block=4)
    assert count > started
    assert maps.omega4_max.equals(expected.omega4_max)


# == Problems in parts: where, what and remedy, and the words of each door ===================================

REMEDY = ("write ", Pair(), " or ", Samples(-4.0, 4.0, 401), (", or ", Setting("solver", "dense"), " too"))


class Terse(Wording):
    """A door that has no options."""

    def piece(self, piece):
        return None if isinstance(piece, Setting) else super().piece(piece)


def test_a_problem_is_one_line_that_travels():
    error = InputError("is 0", where=("design", "a2", 3), remedy=REMEDY)
    assert (error.where, error.what, error.remedy) == (("design", "a2", 3), "is 0", REMEDY)
    assert str(error) == (
        "design: a2[3] is 0; write (lo, hi) or numpy.linspace(-4, 4, 401), or solver='dense' too"
    )
    assert Terse().line(Problem("none is given", ("branch",), REMEDY)) == (
        "branch: none is given; write (lo, hi) or numpy.linspace(-4, 4, 401)"
    )
    # Such as a key `self` of a study.
    assert Problems().attempt(dict, self=1) == {"self": 1}
    error = InputError.of([Problem("is 0", ("threads",), "write 1"), Problem("is 1", ("verify",))])
    again = pickle.loads(pickle.dumps(error))
    assert again.problems == error.problems
    assert str(again) == str(error)


def test_problems_are_noted_with_their_place_and_raised_together():
    problems = Problems()
    problems.stop()
    with problems.at("quantities", 2):
        raise InputError("is unknown")
    with problems.at("quantities", 3):
        raise InputError("is 0", where=("threads",))
    with pytest.raises(InputError) as caught:
        problems.stop()
    assert [one.where for one in caught.value.problems] == [("quantities", 2), ("threads",)]
    assert len(str(caught.value).splitlines()) == 2


def test_a_sweep_names_all_that_is_wrong_with_it():
    with pytest.raises(InputError) as caught:
        fl.sweep(
            "planar_4r",
            fl.grid(a1=-0.4, a2=1.2, a3=0.8, a9=1.0),
            ["omega4", "omga4"],
            branch=3,
            threads=0,
            block=0,
            to=b"x",
            attrs={"threads": 1},
            solver="dens",
            backend="gcc",
            theta1=[0.0, 0.0],
        )
    paths = {".".join(map(str, one.where)) for one in caught.value.problems}
    designs = {"quantities.1", "design.a1", "design.a9", "branch", "theta1"}
    assert paths == designs | {"solver", "backend", "threads", "block", "to", "attrs"}


def test_each_door_has_its_own_words(folder):
    """Of refined extremes over given angles."""
    with refused("extrema: ", "extrema='sampled'"):
        sweep(theta1=[0.0], extrema="refined")
    text = GOOD.replace("theta1 = 8", 'theta1 = {values = [0.0]}\nextrema = "refined"')
    with refused("cycle.extrema: ", 'extrema = "sampled"'):
        fl.run(written(text))


@pytest.mark.parametrize(
    "text", ["\x00", "a\nb", "\x1b[31m", "\ud800", "\u2028", "x" * 5000, "<object object at 0x7f00>"]
)
def test_a_line_is_short_and_shows_on_any_terminal(text):
    error = InputError(f"{text!s} is unknown", where=("mechanism", text), remedy="write planar_4r")
    (line,) = str(error).split("\n")
    assert line.encode()
    assert line.isprintable()
    assert len(line) < 400
    assert " at 0x" not in line
    assert line.endswith("write planar_4r")


class Sulky:
    def __repr__(self):
        raise RuntimeError


class Long:
    def __repr__(self):
        return "<" + "long\n" * 1000 + f" at {hex(id(self))}>"


@pytest.mark.parametrize(
    "value",
    [object(), len, Sulky(), [Sulky()], {"a": Sulky()}, Long(), 10**5000, "x" * 1000, iter([1])],
    ids=type,
)
def test_any_value_has_a_short_text_that_is_the_same_each_time(value):
    text = short_repr(value)
    assert 0 < len(text) < 80
    assert "\n" not in text
    assert "0x" not in text
    assert text == short_repr(value)
