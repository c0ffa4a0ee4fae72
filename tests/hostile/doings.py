"""What cases name: calls that need a file of their own, and objects that fail where a caller looks at them."""

import enum
import io
from contextlib import redirect_stderr
from pathlib import Path

import numpy as np
from typer.testing import CliRunner

import fastlink as fl
from fastlink.app.cli import app
from fastlink.app.study import read_study
from fastlink.errors import InputError
from tests.hostile.judge import complaint_about
from tests.hostile.texts import meant
from tests.support.sweeps import sweep_4r

USAGE = 2


def written(data, name="table.csv"):
    """Write a file, and return its path."""
    Path(name).write_bytes(data)
    return name


def checked(maps):
    """Return a map, of the planar 4R with the angles that the same facts give without a kernel."""
    if maps.attrs["mechanism"] == "planar_4r" and "theta1" in maps.get("theta4", maps.status).dims:
        given = {name: maps[name] for name in ("a1", "a2", "a3", "a4", "theta1", "branch")}
        facts = fl.evaluate("planar_4r", ["theta4"], **given, allow_invalid=True)["theta4"]
        np.testing.assert_array_equal(
            maps.theta4, facts.broadcast_like(maps.theta4).transpose(*maps.theta4.dims)
        )
    return maps


def filled(space, names, start, stop, out):
    """Return the rows into which inputs are written."""
    space.fill(names, start, stop, out)
    return out


def swept(space, **options):
    """Return a small map of some designs."""
    return checked(sweep_4r(space, ["theta4", "omega4_max"], angles=8, threads=1, **options))


def read(data):
    """Read a study, and return its designs, which are those that it means."""
    study = read_study(written(data, "changed.toml"))
    for name, wanted in meant(data).items():
        assert np.array_equal(study.space.values(name), np.atleast_1d(wanted)), f"{name} is not {wanted!r}"
    return study.space


def explained(data):
    """Return the explanation of a study, whose designs are those that it means."""
    read(data)
    return str(fl.explain("changed.toml"))


def ran(data):
    """Run a small study, and return its map, whose designs are those that it means."""
    path = written(data, "changed.toml")
    with fl.run(path, to="changed.h5", overwrite=True, threads=1, progress=False) as maps:
        maps = maps.load()
    for name, wanted in meant(data).items():
        assert np.array_equal(maps[name], wanted), f"{name} is not {wanted!r}"
    return checked(maps)


def commanded(data):
    """Run a small study by the command line, and return its map."""
    to_end("run", written(data, "changed.toml"), "--to", "changed.h5", "--overwrite", "--threads", "1")
    with fl.open("changed.h5") as maps:
        return checked(maps.load())


def to_end(*words):
    """Run a command, and return what it prints; its refusal is an InputError with its lines."""
    with redirect_stderr(io.StringIO()):
        result = CliRunner().invoke(app, list(words), catch_exceptions=False)
    if result.exit_code == 0:
        return result.stdout
    assert result.exit_code == USAGE, f"ends with {result.exit_code}"
    assert not result.stdout, f"prints {result.stdout[:80]!r} although it refuses"
    # a line about usage, by typer, repeats a word however long it is
    usage = result.stderr.startswith("Usage: ")
    wrong = "" if usage else complaint_about(result.stderr.replace("fastlink: ", ""))
    assert not wrong, f"its refusal {wrong}"
    assert result.stderr.strip(), "its refusal is empty"
    raise InputError(result.stderr.strip(), where=("command",), remedy="see the lines")


def _failing(name, *methods):
    """Return a class of which some methods raise."""

    def fail(*_, **__):
        raise RuntimeError(f"no {methods[0]}")

    return type(name, (), dict.fromkeys(methods, fail))


Sulky = _failing("Sulky", "__repr__", "__str__")
BadArray = _failing("BadArray", "__array__")
BadFloat = _failing("BadFloat", "__float__", "__index__")
BadLength = _failing("BadLength", "__len__", "__getitem__")
BadIteration = _failing("BadIteration", "__iter__")
BadTruth = _failing("BadTruth", "__eq__", "__bool__")
BadAttributes = _failing("BadAttributes", "__getattr__")
BadPath = _failing("BadPath", "__fspath__")


class Everything:
    """Has every attribute, and each is itself."""

    def __getattr__(self, name):
        if name.startswith("__"):
            raise AttributeError(name)
        return self

    def __call__(self, *args, **options):
        return self


class Real(float):
    """A float of another class."""


class Whole(int):
    """An int of another class."""


class Name(str):
    """A text of another class."""


class Code(enum.IntEnum):
    """Assembly modes as somebody may enumerate them."""

    RIGHT = 1
    LEFT = 2


def circle():
    """Return a list that holds itself."""
    inside = []
    inside.append(inside)
    return inside


def deep():
    """Return a list in a list, a thousand times."""
    inside = []
    for _ in range(1000):
        inside = [inside]
    return inside
