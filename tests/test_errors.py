"""Problems in parts: where, what and remedy, and the words of each door."""

import pickle

import pytest

import fastlink as fl
from fastlink._text import short_repr
from fastlink.errors import InputError, Pair, Problem, Problems, Samples, Setting, Wording
from tests.support.four_bar import sweep_4r
from tests.support.study_files import GOOD, written

REMEDY = ("write ", Pair(), " or ", Samples(-4.0, 4.0, 401), (", or ", Setting("solver", "dense"), " too"))


class Terse(Wording):
    """A door that has no options."""

    def piece(self, piece):
        return None if isinstance(piece, Setting) else super().piece(piece)


def test_a_problem_is_one_line_in_python():
    error = InputError("is 0", where=("design", "a2", 3), remedy=REMEDY)
    assert (error.where, error.what, error.remedy) == (("design", "a2", 3), "is 0", REMEDY)
    assert str(error) == (
        "design: a2[3] is 0; write (lo, hi) or numpy.linspace(-4, 4, 401), or solver='dense' too"
    )


def test_an_option_that_a_door_lacks_is_left_out():
    assert Terse().line(Problem("none is given", ("branch",), REMEDY)) == (
        "branch: none is given; write (lo, hi) or numpy.linspace(-4, 4, 401)"
    )


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


def test_an_error_of_another_process_keeps_its_parts():
    error = InputError.of([Problem("is 0", ("threads",), "write 1"), Problem("is 1", ("verify",))])
    again = pickle.loads(pickle.dumps(error))
    assert again.problems == error.problems
    assert str(again) == str(error)


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
    paths = {one.where for one in caught.value.problems}
    assert paths == {
        ("quantities", 1),
        ("solver",),
        ("threads",),
        ("block",),
        ("to",),
        ("attrs",),
        ("design", "a1"),
        ("design", "a9"),
        ("branch",),
        ("theta1",),
        ("backend",),
    }


def message_of(door):
    """Return the message of each door about refined extremes over given angles."""
    if door == "python":
        with pytest.raises(InputError) as caught:
            sweep_4r(fl.grid(a1=0.4, a2=1.2, a3=0.8, a4=1.0), ["theta4_max"], theta1=[0.0], extrema="refined")
        return str(caught.value)
    text = GOOD.replace("theta1 = 8", 'theta1 = {values = [0.0]}\nextrema = "refined"')
    with pytest.raises(InputError) as caught:
        fl.run(written(text))
    return str(caught.value)


@pytest.mark.parametrize(
    ("door", "path", "remedy"),
    [("python", "extrema: ", "extrema='sampled'"), ("study", "cycle.extrema: ", 'extrema = "sampled"')],
)
def test_each_door_has_its_own_words(folder, door, path, remedy):
    line = message_of(door)
    assert path in line
    assert remedy in line


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


def test_an_attempt_takes_arguments_of_any_name():
    """Such as a key `self` of a study."""
    assert Problems().attempt(dict, self=1) == {"self": 1}
