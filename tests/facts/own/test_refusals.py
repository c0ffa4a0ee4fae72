"""What no quantity of one's own can say is refused when it is declared, with its line and what to write instead."""

import linecache
import math
import re

import pytest
from tests.support.refusals import refused

import fastlink as fl
from fastlink.errors import InputError

FACTOR = 3.0


def helper(x):
    return x


def branches(F21, F41):
    if F21 > F41:
        return F21
    return F41


def loops(F21):
    for _ in range(3):
        F21 = F21 + F21
    return F21


def calls(F21):
    return helper(F21)


def calls_itself(F21):
    return calls_itself(F21)


def takes_a_global(F21):
    return FACTOR * F21


def adds_a_list(F21, F41):
    return sum([F21, F41])


def returns_two(F21, F41):
    return F21, F41


def ends_without(F21):
    F21 + F21


def has_default(F21, factor=2.0):
    return factor * F21


def any_number(*forces):
    return forces


def powers(F21):
    return F21**0.3


def inverted_power(F21):
    return F21**~2


def infinite_power(F21):
    return F21**1e400


def negates(F21, F41):
    return F21 if not F21 > F41 else F41


def of_the_cycle(F21_max):
    return F21_max


def of_a_bound(F21_error):
    return F21_error


def misspelt(F_21):
    return F_21


def of_itself(of_itself):
    return of_itself


def compares_units(F21):
    return max(F21, 100.0)


def divides_by_zero(F21):
    return F21 * (1 / 0)


def wrong_units(F21, a1):
    return F21 * a1


def sine_of_a_force(F21):
    return math.sin(F21) * F21


def omega4(omega2):
    return omega2


def sigma(F21):
    return F21


def width(F21):
    return F21


def constant_alone():
    return 2.0


REFUSED = [
    (branches, "branches", "if condition else"),
    (loops, "is a loop", "each term"),
    (calls, "`helper(F21)`", "make it a quantity"),
    (calls_itself, "calls itself", "formula"),
    (takes_a_global, "`FACTOR`", "default=3.0"),
    (adds_a_list, "`sum([F21, F41])`", "formula"),
    (returns_two, "several values", "one number"),
    (ends_without, "ends without a value", "return"),
    (has_default, "factor", 'input("factor", units=..., default=2.0)'),
    (any_number, "any number of arguments", "name each"),
    (powers, "`F21 ** 0.3`", "x**0.5"),
    (inverted_power, "is a power", "x**0.5"),
    (infinite_power, "is a power", "x**0.5"),
    (negates, "negates", "turn"),
    (of_the_cycle, "F21_max", "take F21"),
    (of_a_bound, "F21_error", "take F21"),
    (misspelt, "F_21", "'F21'"),
    (of_itself, "itself", "before"),
    (compares_units, "compares N and a number", "mine.input"),
    (divides_by_zero, "cannot be computed", "mend"),
    (wrong_units, "gives J", "units='J'"),
    (sine_of_a_force, "function of N", "mine.input"),
    (omega4, "is a quantity of planar_4r", "otherwise"),
    (sigma, "step within the facts", "otherwise"),
    (width, "word of fastlink's own", "my_width"),
    (constant_alone, "no parameter", "name the quantities"),
]


@pytest.mark.parametrize(
    ("function", "what", "remedy"), REFUSED, ids=lambda one: getattr(one, "__name__", "")
)
def test_a_text_is_refused_at_its_line(function, what, remedy):
    mine = fl.extend("planar_4r")
    with pytest.raises(InputError) as caught:
        mine.quantity(units="N")(function)
    line = str(caught.value).splitlines()[0]
    found, _, mended = line.partition("; ")
    assert line.startswith(function.__name__), line
    assert what in found, line
    assert remedy in mended, line
    if number := re.search(r"line (\d+) of test_refusals.py", line):
        start = function.__code__.co_firstlineno
        assert start <= int(number[1]) <= start + 4
    assert "nothing of its own" in repr(mine)


def test_all_problems_are_told_together():
    mine = fl.extend("planar_4r")

    def several(F21):
        x = helper(F21)
        y = FACTOR * x
        return z + y  # noqa: F821

    with pytest.raises(InputError) as caught:
        mine.quantity(units="N")(several)
    assert len(str(caught.value).splitlines()) == 3


def test_what_has_no_text_is_refused():
    mine = fl.extend("planar_4r")
    held = 2.0

    def closure(F21):
        return held * F21

    scope = {}
    exec("def typed(F21):\n    return F21", scope)
    for function, what in (
        (lambda F21: F21, "lambda"),
        (closure, "held"),
        (scope["typed"], "text"),
        (len, "function"),
        (math.sin, "function"),
    ):
        with pytest.raises(InputError, match=what):
            mine.quantity(units="N")(function)


def test_a_text_that_was_changed_since_is_refused(tmp_path):
    file, text = tmp_path / "texts.py", "def f(F21, F41):\n    return F21 - F41\n"
    for new in ("F21 + F41", "F41 - F21", "F21 - 2.0 * F41"):
        scope = {}
        exec(compile(text, str(file), "exec"), scope)
        file.write_text(text.replace("F21 - F41", new))
        linecache.checkcache(str(file))
        with refused("f", "load the file again"):
            fl.extend("planar_4r").quantity(units="N")(scope["f"])


def test_a_quotient_by_zero_has_derivatives_and_bounds():
    mine = fl.extend("planar_4r")

    @mine.quantity(units="rad")
    def infinite(theta4):
        return theta4 / 0.0

    names = ["infinite", "infinite_error", "d_infinite_d_theta1"]
    assert not any(map(math.isfinite, fl.evaluate(mine, names, **DESIGN, branch=1).values()))


def test_names_are_declared_once_and_cells_again():
    mine = fl.extend("planar_4r")
    mine.input("limit", units="N", default=1.0)
    mine.input("limit", units="N", default=2.0)  # as when a cell of a notebook runs again
    with refused("omega1", "otherwise"):
        mine.input("omega1", units="rad s-1")

    @mine.quantity(units="1")
    def ratio(F21, limit):
        return F21 / limit

    with refused("ratio", "otherwise"):

        @mine.quantity(units="1")
        def ratio(F41, limit):
            return F41 / limit

    assert fl.evaluate(mine, ["ratio"], **DESIGN)["ratio"] > 0.0


DESIGN = dict(
    a1=0.4, a2=1.2, a3=0.8, a4=1.0, omega1=5.0, theta1=1.0, links=fl.round_bar(density=7750.0, radius=0.01)
)


@pytest.mark.parametrize(
    ("units", "remedy"),
    [("m/s", "'m s-1'"), ("deg", "'rad'"), ("furlong", "kg, m, s"), (None, "kg, m, s"), ("", "'1'")],
)
def test_units_are_those_of_files(units, remedy):
    with refused("units", remedy):
        fl.extend("planar_4r").input("x1", units=units)
    with refused("units", remedy):
        fl.extend("planar_4r").quantity(units=units)


def test_a_default_fits_its_rule():
    for rule, value in (("positive", 0.0), ("non-negative", -1.0), ("any", math.nan)):
        with refused("default", "finite"):
            fl.extend("planar_4r").input("x1", units="1", rule=rule, default=value)
    with refused("rule", "non-negative"):
        fl.extend("planar_4r").input("x1", units="1", rule="negative")
