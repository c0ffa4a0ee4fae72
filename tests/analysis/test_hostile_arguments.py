"""Functions of designs refuse what is not a number that they can use, in each argument, and read all numbers alike."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from decimal import Decimal
from fractions import Fraction
from numbers import Real
from typing import Any

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from tests.hostile.objects import BadAttributes, Everything
from tests.support.hostile_values import scalars
from tests.support.refusals import refused

import fastlink as fl

LENGTHS = {"a1": 0.4, "a2": 1.2, "a3": 0.8, "a4": 1.0}
CURVE = LENGTHS | {"P_u": 0.7, "P_v": 0.5}
MASSES = (
    {"a1": 0.4, "a2": 1.2, "a3": 0.8}
    | {f"m{i}": 1.0 for i in (1, 2, 3)}
    | {f"G{i}_{x}": 0.1 for i in (1, 2, 3) for x in "uv"}
)
FOCAL = {"a": 3.0, "b": 5.0, "c": 4.0, "d": 6.0, "phi": 0.5}
#: Each function with a good call.
CALLS: dict[str, tuple[Callable[..., Any], dict[str, Any]]] = {
    "sextic": (fl.planar.sextic, CURVE),
    "curve_length": (fl.planar.curve_length, CURVE | {"branch": 2}),
    "curve_area": (fl.planar.curve_area, CURVE | {"branch": 2}),
    "curve_straightness": (fl.planar.curve_straightness, CURVE | {"samples": 8, "branch": 2}),
    "inflections": (fl.planar.inflections, CURVE | {"samples": 8, "branch": 2}),
    "crunodes": (fl.planar.crunodes, CURVE | {"tolerance": 1e-9}),
    "cusps": (fl.planar.cusps, CURVE | {"tolerance": 1e-9}),
    "crunode_count": (fl.planar.crunode_count, CURVE),
    "cusp_count": (fl.planar.cusp_count, CURVE),
    "cognates": (lambda **inputs: [one.design["P_u"] for one in fl.planar.cognates(**inputs)], CURVE),
    "io_coefficients": (fl.planar.io_coefficients, LENGTHS | {"pair": "14"}),
    "force_balance": (fl.planar.force_balance, MASSES | {"radius1": 0.1, "mass3": 2.0, "links": None}),
    "flywheel_inertia": (
        fl.planar.flywheel_inertia,
        {"maps": {"T41_fluctuation": 1.0, "omega1": 2.0}, "C_s": 0.02},
    ),
    "focal.cubic": (fl.focal.cubic, FOCAL | {"branch": 2}),
    "focal.cubic_points": (fl.focal.cubic_points, FOCAL | {"branch": 2, "samples": 3}),
    "focal.from_point": (
        lambda **given: fl.focal.from_point(**given).values,
        FOCAL | {"x": 1.0, "y": 2.0, "branch": 2},
    ),
    "focal.best_point": (lambda **given: fl.focal.best_point(**given).values, FOCAL | {"branch": 2}),
    "focal.inscribed_conics": (fl.focal.inscribed_conics, FOCAL | {"t": 0.3, "branch": 2}),
    "focal.involution": (
        lambda **given: fl.focal.involution(**given).first,
        FOCAL | {"x": 1.0, "y": 2.0, "branch": 2},
    ),
    "focal.five_bar": (
        fl.focal.five_bar,
        {"m": 1.0, "p": 1.5, "q": 2.0, "n": 1.2, "d": 2.0, "phi": 0.4, "omega_angle": 1.0, "branch": 2},
    ),
    "focal.held_at_AB": (
        fl.focal.held_at_AB,
        {name: FOCAL[name] for name in "abcd"} | {"rho": 0.8, "completion": 2},
    ),
    "hart.held_at_AB": (fl.hart.held_at_AB, {"m": 1.0, "n": 1.2, "d": 2.0, "kappa": 0.5}),
    "minkowski.sextic": (fl.minkowski.sextic, {"a": 3.0, "b": 5.0, "g": 6.0, "h": 4.0, "x": 0.0, "y": 0.0}),
}
OPTIONAL = {"links", "radius1", "mass3"}
#: Not lengths or masses: any finite number will do.
OF_ANY_SIGN = {"P_u", "P_v", "phi", "x", "y", "t", "omega_angle", "rho", "kappa"}
OF_ANY_SIGN |= {name for name in MASSES if name[0] == "G"}
#: By default each argument has another third of the values.
EVERY_THIRD = pytest.mark.parametrize("step", [3, pytest.param(1, marks=pytest.mark.stress)])


def number_of(value: Any) -> float | None:
    """Return the double that a value is, if it is a number; by its type, not by conversion."""
    if (
        isinstance(value, (np.ndarray, xr.DataArray))
        and value.dtype.kind == "f"
        and not np.ma.is_masked(value)
    ):
        return float(value)
    if not isinstance(value, (Real, Decimal)) or isinstance(value, (bool, np.timedelta64)):
        return None
    try:
        return float(value)
    except (OverflowError, ValueError):
        return None


def may_be(name: str, value: Any) -> bool:
    """Tell whether an argument may have a value, by what the documentation says."""
    number = number_of(value)
    if value is None:
        return name in OPTIONAL
    if name in ("pair", "maps", "links") or number is None or not math.isfinite(number):
        return False
    if name in ("branch", "completion"):
        return number in (1, 2)
    if name == "samples":
        return isinstance(value, (int, np.int8)) and number >= 1
    if name == "tolerance":
        return 0.0 < number < 0.1
    return name in OF_ANY_SIGN or number > 0.0 or (number == 0.0 and name in ("m1", "m2", "m3"))


@pytest.mark.sample(6)
@pytest.mark.filterwarnings(
    "ignore:overflow", "ignore:invalid value", "ignore:divide by zero", "ignore:underflow"
)
@EVERY_THIRD
@pytest.mark.parametrize("called", CALLS)
def test_each_argument_is_checked(called, step):
    """What the documentation allows is computed with, as if it were a float; all else is refused by its name."""
    function, usual = CALLS[called]
    for k, name in enumerate(usual):
        for value in scalars()[k % step :: step]:
            given = usual | {name: value}
            if not may_be(name, value):
                with pytest.raises(fl.InputError) as caught:
                    function(**given)
                for line in str(caught.value).splitlines():
                    key = "" if name == "maps" and isinstance(value, str) else name  # the path of a map
                    assert re.search(rf"\b{key}\b.*; (write|known|sweep|give)", line), line
            elif type(value) not in (int, float, type(None)) and 0.1 <= abs(number_of(value)) <= 10.0:
                number = int(value) if name == "samples" else number_of(value)
                results = (function(**usual | {name: one}) for one in (value, number))
                np.testing.assert_equal(*(list(flat(result)) for result in results))


@pytest.mark.parametrize("called", [name for name in CALLS if "." not in name and name != "flywheel_inertia"])
def test_a_design_is_given_by_name_or_as_one(called):
    """One style: names, a mapping, a table, a Dataset; whatever else these hold is not read."""
    function, usual = CALLS[called]
    if called == "cognates":
        function = fl.planar.cognates
    options = {name: value for name, value in usual.items() if name not in MASSES | CURVE}
    inputs = {name: value for name, value in usual.items() if name not in options}
    whole = inputs | {"omega1": 25.0, "theta1": 1.0}
    frame = pd.DataFrame({name: [value] for name, value in whole.items()}).assign(label="x")
    by_name = function(**inputs, **options)
    for design in (whole, xr.Dataset(whole).assign(omega4=1.0), frame):
        np.testing.assert_equal(
            np.ravel(np.array(list(flat(function(design, **options))))),
            np.ravel(np.array(list(flat(by_name)))),
        )
    with refused("a1", "leave one out"):
        function(whole, a1=1.0, **options)
    with refused("a2", "add it"):
        function({name: value for name, value in inputs.items() if name != "a2"}, **options)
    with refused("a9", "did you mean"):
        function(inputs, **options, a9=1.0)
    with refused("design", "give the inputs by name"):
        function(3.0, **options)


def flat(result: Any) -> Any:
    """Yield every number of a result."""
    if isinstance(result, dict):
        result = list(result.values())
    if isinstance(result, (tuple, list)):
        for part in result:
            yield from flat(part)
    elif hasattr(result, "design"):
        yield from flat([*result.design.values(), result.O_x, result.D_y])
    else:
        yield from np.ravel(result)


def test_dataarrays_are_broadcast_by_their_dimensions():
    """Equal lengths along other dimensions make a product, not pairs."""
    a1 = xr.DataArray([0.3, 0.4], dims="a1")
    a2 = xr.DataArray([1.1, 1.2], dims="a2")
    lengths = fl.planar.curve_length(CURVE | {"a1": a1, "a2": a2})
    assert lengths.shape == (2, 2)
    assert lengths[0, 1] == fl.planar.curve_length(CURVE | {"a1": 0.3, "a2": 1.2})
    with refused("a2", "give equal lengths"):
        fl.planar.curve_length(CURVE | {"a1": a1, "a2": xr.DataArray([1.0, 1.1, 1.2], dims="a1")})
    one, other = (xr.DataArray([1.0, 1.1], dims="k", coords={"k": k}) for k in ([0, 1], [1, 2]))
    with refused("a4", "that both have"):
        fl.planar.curve_length(CURVE | {"a2": one, "a4": other})


def test_modes_are_broadcast_with_designs():
    both = fl.planar.curve_length(CURVE, branch=[1, 2])
    assert both.tolist() == [fl.planar.curve_length(CURVE, branch=k) for k in (1, 2)]
    counts = fl.planar.inflections(CURVE, branch=[1, 2], samples=8)[3]
    assert counts.tolist() == [int(fl.planar.inflections(CURVE, branch=k, samples=8)[3]) for k in (1, 2)]


@pytest.mark.parametrize("function", [fl.planar.straightness, fl.focal.straight_line])
def test_points_are_numbers_or_gaps(function):
    for bad in (
        None,
        "x",
        [0.0, "1"],
        [0.0, np.inf],
        [True, False],
        [[0.0], [0.0, 1.0]],
        np.array([1, 2], "M8[s]"),
    ):
        with pytest.raises(fl.InputError):
            function(bad, [0.0, 1.0])
        with pytest.raises(fl.InputError):
            function([0.0, 1.0], bad)
    with_gap, without = (function(x, x) for x in ([0.0, 1.0, np.nan], [0.0, 1.0]))
    np.testing.assert_equal(np.ravel(list(flat(with_gap)))[:3], np.ravel(list(flat(without)))[:3])


@pytest.mark.parametrize(
    "called", ["sextic", "curve_area", "inflections", "cusps", "cognates", "io_coefficients"]
)
def test_lengths_whose_products_overflow_are_refused(called):
    """They gave infinity or NaN, with warnings; the least and greatest give numbers, without any."""
    function, usual = CALLS[called]
    for name, value in (("a1", 1.1e24), ("a2", 1e-200), ("a4", 5e-324), ("P_u", -1.7e308), ("P_v", 1e26)):
        if name in usual:
            with refused(name, "in another unit of length"):
                function(**usual | {name: [1.0, value]})
    lengths = [name for name in usual if name in CURVE]
    for one in lengths:
        for value, others in ((1e24, 1e-24), (1e-24, 1e24)):
            function(**usual | dict.fromkeys(lengths, others) | {one: value})
    with pytest.raises(fl.InputError) as caught:
        function(**usual | dict.fromkeys(lengths, 1e30))
    assert len(caught.value.problems) == len(lengths)


@pytest.mark.parametrize("called", ["focal.cubic", "focal.from_point", "focal.five_bar", "minkowski.sextic"])
def test_lengths_and_modes_beyond_their_limits_are_refused(called):
    function, usual = CALLS[called]
    first = next(iter(usual))
    limit = "1e-24 to 1e+24"
    for value, remedy in ((1e25, limit), (1e-80, limit), (-1.0, "greater than 0")):
        with refused(first, remedy):
            function(**usual | {first: value})
    with refused(first, "equal lengths"):
        function(**usual | {list(usual)[1]: np.ones(2), first: np.ones(3)})
    if "branch" in usual:
        with refused("branch", "write some of 1, 2"):
            function(**usual | {"branch": 3})
    with refused("samples", "from 2"):
        fl.focal.cubic_points(**FOCAL, samples=1)


@pytest.mark.parametrize("scale", [2.0**1000, 2.0**-1000])
def test_points_of_any_size(scale):
    """A strip and a line of points whose sums, differences and squares leave the range of doubles."""
    x, y = np.random.default_rng(8).uniform(-8e6, 8e6, (2, 9))  # below 2^23: the greatest is 2^1023
    assert fl.planar.straightness(scale * x, scale * y) == scale * fl.planar.straightness(x, y)
    plain, other = fl.focal.straight_line(x, y), fl.focal.straight_line(scale * x, scale * y)
    np.testing.assert_equal(other[:2], [scale * value for value in plain[:2]])
    assert other.direction == plain.direction
    np.testing.assert_array_equal(other.deviation, scale * plain.deviation)


def test_no_points_give_no_line():
    assert fl.focal.cubic_points(**FOCAL | {"a": []}, samples=3).shape == (0, 32, 2)
    for x in ([], np.zeros((2, 0))):
        assert np.isnan(fl.focal.straight_line(x, x).direction).all()
        assert np.isnan(fl.planar.straightness(x, x)).all()


def test_a_configuration_with_a_gap_has_no_branch():
    """The branch was 1."""
    for cognate in fl.planar.cognates(CURVE):
        for gap in range(3):
            angles = [[1.0, np.nan] if k == gap else 0.5 + k for k in range(3)]
            assert np.isnan(cognate.configuration(*angles)[1]).tolist() == [False, True]


@pytest.mark.parametrize(
    ("swing", "speed", "C_s"), [(6.0, 1e200, 0.02), (1e6, 1e5, 1e300), (1e-300, 1e-200, 1.0)]
)
def test_a_flywheel_within_the_range_of_doubles(swing, speed, C_s):
    """The square of the speed is not."""
    exact = Fraction(swing) / (Fraction(C_s) * Fraction(speed) ** 2)
    inertia = fl.planar.flywheel_inertia({"T41_fluctuation": swing, "omega1": speed}, C_s)
    least, greatest = Fraction(5e-324), Fraction(np.finfo(float).max)
    if least < exact < greatest:  # three quotients, and one rounding to the spacing of small numbers
        assert abs(Fraction(float(inertia)) - exact) <= exact * Fraction(3, 2**53) + least
    else:
        assert inertia == (np.inf if exact > greatest else 0.0)


def test_counterweights_beyond_doubles_are_refused():
    """They were infinite, with warnings."""
    with refused("force_balance", "usual sizes"):
        fl.planar.force_balance(MASSES | {"m2": 1.7e308, "a1": 10.0}, radius1=1e-3)
    with refused("radius1", "in another unit"):
        fl.planar.force_balance(MASSES, radius1=5e-324)


def test_objects_that_answer_to_everything_are_no_designs():
    for wrong in (Everything(), BadAttributes()):
        with refused("design", "give the inputs by name"):
            fl.planar.cognates(wrong)


def test_maps_are_maps():
    for wrong in (None, 3, [1.0], xr.DataArray([1.0]), b""):
        with refused("maps", "give the"):
            fl.planar.flywheel_inertia(wrong, 0.02)
        with refused("maps", "give the"):
            fl.focal.T_deviation(wrong)
    with refused("C_s", "one for each"):
        fl.planar.flywheel_inertia({"T41_fluctuation": np.ones(3), "omega1": 2.0}, [0.1, 0.2])


@pytest.mark.parametrize(
    ("call", "name", "unit"),
    [
        (
            lambda of: fl.planar.flywheel_inertia(
                {"T41_fluctuation": 1.0, "omega1": 2.0}, of(2.0, "percent")
            ),
            "C_s",
            "1",
        ),
        (lambda of: fl.planar.cusps(**CURVE, tolerance=of(1e-9, "mm")), "tolerance", "1"),
        (lambda of: fl.planar.curve_straightness(**CURVE, theta1=of([0.5, 1.5], "m")), "theta1", "rad"),
        (
            lambda of: fl.focal.best_point(5.0, 5.0, 2.0, 4.0, 1.2, between=of([0.1, 0.9], "m")),
            "between",
            "1",
        ),
    ],
)
def test_a_stated_unit_is_not_dropped(call, name, unit):
    with refused(name, f"convert it to {unit}"):
        call(lambda values, units: xr.DataArray(values, attrs={"units": units}))


def test_ends_of_a_range_in_degrees_are_converted():
    ends = xr.DataArray([90.0, 180.0], attrs={"units": "deg"})
    found = fl.planar.curve_straightness(**CURVE, theta1=ends)
    assert found == fl.planar.curve_straightness(**CURVE, theta1=(np.pi / 2.0, np.pi))
    assert found != fl.planar.curve_straightness(**CURVE)
