"""Functions of designs: how a design is given, how arguments are broadcast, and the limits of numbers."""

from fractions import Fraction

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from numpy.testing import assert_array_equal, assert_equal
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
CALLS = {
    "sextic": (fl.planar.sextic, CURVE),
    "curve_length": (fl.planar.curve_length, CURVE | {"branch": 2}),
    "curve_area": (fl.planar.curve_area, CURVE | {"branch": 2}),
    "curve_straightness": (fl.planar.curve_straightness, CURVE | {"samples": 8, "branch": 2}),
    "inflections": (fl.planar.inflections, CURVE | {"samples": 8, "branch": 2}),
    "crunodes": (fl.planar.crunodes, CURVE | {"tolerance": 1e-9}),
    "cusps": (fl.planar.cusps, CURVE | {"tolerance": 1e-9}),
    "crunode_count": (fl.planar.crunode_count, CURVE),
    "cusp_count": (fl.planar.cusp_count, CURVE),
    "cognates": (fl.planar.cognates, CURVE),
    "io_coefficients": (fl.planar.io_coefficients, LENGTHS | {"pair": "14"}),
    "force_balance": (fl.planar.force_balance, MASSES | {"radius1": 0.1, "mass3": 2.0, "links": None}),
    "focal.cubic": (fl.focal.cubic, FOCAL | {"branch": 2}),
    "focal.from_point": (fl.focal.from_point, FOCAL | {"x": 1.0, "y": 2.0, "branch": 2}),
    "focal.five_bar": (
        fl.focal.five_bar,
        {"m": 1.0, "p": 1.5, "q": 2.0, "n": 1.2, "d": 2.0, "phi": 0.4, "omega_angle": 1.0, "branch": 2},
    ),
    "minkowski.sextic": (fl.minkowski.sextic, {"a": 3.0, "b": 5.0, "g": 6.0, "h": 4.0, "x": 0.0, "y": 0.0}),
}


@pytest.mark.parametrize("called", [name for name in CALLS if "." not in name])
def test_a_design_is_given_by_name_or_as_one(called):
    """One style: names, a mapping, a table, a Dataset; whatever else these hold is not read."""
    function, usual = CALLS[called]
    options = {name: value for name, value in usual.items() if name not in MASSES | CURVE}
    inputs = {name: value for name, value in usual.items() if name not in options}
    whole = inputs | {"omega1": 25.0, "theta1": 1.0}
    frame = pd.DataFrame({name: [value] for name, value in whole.items()}).assign(label="x")
    by_name = function(**inputs, **options)
    for design in (whole, xr.Dataset(whole).assign(omega4=1.0), frame):
        assert_equal(
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


def flat(result):
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


def test_dataarrays_and_modes_are_broadcast_by_their_dimensions():
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
    both = fl.planar.curve_length(CURVE, branch=[1, 2])
    assert both.tolist() == [fl.planar.curve_length(CURVE, branch=k) for k in (1, 2)]
    counts = fl.planar.inflections(CURVE, branch=[1, 2], samples=8)[3]
    assert counts.tolist() == [int(fl.planar.inflections(CURVE, branch=k, samples=8)[3]) for k in (1, 2)]


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
    assert_equal(other[:2], [scale * value for value in plain[:2]])
    assert other.direction == plain.direction
    assert_array_equal(other.deviation, scale * plain.deviation)


def test_no_points_give_no_line_and_a_gap_no_branch():
    assert fl.focal.cubic_points(**FOCAL | {"a": []}, samples=3).shape == (0, 32, 2)
    for x in ([], np.zeros((2, 0))):
        assert np.isnan(fl.focal.straight_line(x, x).direction).all()
        assert np.isnan(fl.planar.straightness(x, x)).all()
    # The branch was 1.
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


def test_counterweights_beyond_doubles_and_coefficients_for_other_values_are_refused():
    """They were infinite, with warnings."""
    with refused("force_balance", "usual sizes"):
        fl.planar.force_balance(MASSES | {"m2": 1.7e308, "a1": 10.0}, radius1=1e-3)
    with refused("radius1", "in another unit"):
        fl.planar.force_balance(MASSES, radius1=5e-324)
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
