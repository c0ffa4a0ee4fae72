"""Reductions over the cycle: one entry is all that a new one needs, and a wrong one is found."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from tests.support.study_files import written
from tests.support.sweeps import BARS, sweep_4r, sweep_both

import fastlink as fl
from fastlink.facts.formula import CatalogueError
from fastlink.plan.query import COUNT, REDUCTIONS, Reduction, register, unregister

CRANK = {"a1": 0.4, "a2": [1.1, 1.2, 1.3], "a3": [0.7, 0.8], "a4": 1.0}
#: Some of these do not assemble at all.
ANY = {"a1": 0.4, "a2": (0.1, 2.0), "a3": (0.1, 2.0), "a4": 1.0, "omega1": 25.0}
POSITIONS = 24
SPEEDS = np.array([0.3, 1.7, 25.0])
TOTAL = "{total} + select({value} == {value}, {value}, 0.0)"

SUM = Reduction(
    suffix="sum",
    phrase="sum over the positions",
    reference=lambda samples: (sum(samples), sum(map(abs, samples))),
    accumulators={"total": ("0.0", TOTAL), "count": COUNT},
    finish="select({count} > 0.0, {total}, nan)",
)
RANGE = Reduction(
    suffix="range",
    phrase="greatest minus least over the cycle",
    reference=lambda samples: (max(samples) - min(samples), max(map(abs, samples))),
    accumulators={
        "low": ("inf", "select({value} < {low}, {value}, {low})"),
        "high": ("-inf", "select({value} > {high}, {value}, {high})"),
    },
    finish="select({high} >= {low}, {high} - {low}, nan)",
)
SQUARE = Reduction(
    suffix="square",
    phrase="mean square over the cycle",
    reference=lambda samples: 2 * (sum(x * x for x in samples) / len(samples),),
    accumulators={
        "total": ("0.0", "{total} + select({value} == {value}, {value} * {value}, 0.0)"),
        "count": COUNT,
    },
    finish="{total} / {count}",
    power=2,
)
SHARE = Reduction(
    suffix="share",
    phrase="share of the cycle in which it exceeds 1",
    reference=lambda samples: 2 * (sum(1 for x in samples if x > 1) / len(samples),),
    accumulators={"above": ("0.0", "{above} + select({value} > 1.0, 1.0, 0.0)"), "count": COUNT},
    finish="{above} / {count}",
    power=None,
    units="1",
)
OWN = (SUM, RANGE, SQUARE, SHARE)


@pytest.fixture(autouse=True)
def offered():
    """Offer reductions of our own while a test runs."""
    for reduction in OWN:
        register(reduction)
    yield
    for reduction in OWN:
        unregister(reduction.suffix)


def swept(names, space=None, **options):
    space = fl.grid(**CRANK, omega1=25.0) if space is None else space
    return sweep_4r(space, names, **{"angles": POSITIONS, "verify": 0} | options)


def by_numpy(curve):
    with np.errstate(all="ignore"):
        closes = np.isfinite(curve).any(axis=-1)
        found = {
            "sum": np.nansum(curve, axis=-1),
            "range": np.fmax.reduce(curve, axis=-1) - np.fmin.reduce(curve, axis=-1),
            "square": np.nansum(curve**2, axis=-1) / np.isfinite(curve).sum(axis=-1),
            "share": (curve > 1.0).sum(axis=-1) / np.isfinite(curve).sum(axis=-1),
        }
    return {key: np.where(closes, value, np.nan) for key, value in found.items()}


def test_they_are_of_the_curves_samples():
    space = fl.sobol(64, seed=1, **ANY)
    names = ["omega4", *(f"omega4_{own.suffix}" for own in OWN), "omega4_mean", "omega4_rms"]
    maps = swept(
        names, space, extrema="sampled"
    )  # over a turn with toggles the integral of the square is infinite
    curve = maps.omega4.values
    assert np.isnan(curve).all(axis=-1).any()
    assert (np.isnan(curve).any(axis=-1) & ~np.isnan(curve).all(axis=-1)).any()
    # sums in another order: each of n additions errs by a rounding of the sum of sizes, and range by one
    size = POSITIONS * 2.0**-52 * np.nansum(np.abs(curve), axis=-1)
    for suffix, expected in by_numpy(curve).items():
        atol = np.nanmax(size * (np.nanmax(np.abs(curve)) if suffix == "square" else 1.0))
        assert_allclose(maps[f"omega4_{suffix}"], expected, rtol=0, atol=atol, err_msg=suffix)
    assert_allclose(maps.omega4_square, maps.omega4_rms**2, rtol=4 * 2.0**-52)  # root, square, two quotients


@pytest.mark.parametrize("own", OWN, ids=lambda own: own.suffix)
def test_verification_knows_their_references(own, tmp_path):
    space = fl.sobol(64, seed=2, **ANY)
    with swept([f"omega4_{own.suffix}"], space, verify=8, to=tmp_path / "map.h5") as maps:
        found = maps[f"omega4_{own.suffix}"]
        assert found.attrs["verified_values"] == 8
        assert found.attrs["verify_mismatches"] == 0
        # n - 1 additions, each within a rounding of the sum of the sizes; a quotient, squares: two more
        assert found.attrs["error_max_roundings"] <= POSITIONS + 2
        assert own.phrase in found.attrs["long_name"]
        assert own.suffix in found.attrs["symbol"]


@pytest.mark.parametrize(
    "wrong",
    [
        replace(
            SUM,
            accumulators={"total": ("0.0", TOTAL.replace("{value}, 0", "abs({value}), 0")), "count": COUNT},
        ),
        replace(SUM, finish="{total} / {count}"),
        replace(
            SUM, accumulators={"total": ("0.0", TOTAL), "count": ("1.0", COUNT[1])}, finish="{total}*{count}"
        ),
        replace(RANGE, suffix="sum", finish="{high} + {low}"),
    ],
    ids=["sizes", "mean", "times count", "high plus low"],
)
def test_a_wrong_kernel_is_found(wrong):
    """The plans of the right kernel are kept, but not for the wrong one."""
    right = swept(["alpha4_sum"], verify=6)
    assert right.alpha4_sum.attrs["error_max_roundings"] <= POSITIONS
    unregister("sum")
    register(wrong)
    said = r"alpha4_sum is wrong in 6 of 6 values, by up to \d.*e\+1[5-7] roundings"
    with pytest.warns(fl.InputWarning, match=said):
        bad = swept(["alpha4_sum"], verify=6)
    assert not np.array_equal(bad.alpha4_sum, right.alpha4_sum)
    assert bad.alpha4_sum.attrs["error_max_roundings"] > 1e6


def test_a_cycle_without_a_value_that_is_no_nan_is_found():
    unregister("sum")
    register(replace(SUM, accumulators={"total": ("0.0", TOTAL)}, finish="{total}"))
    space = fl.grid(a1=0.1, a2=[0.1, 0.2, 0.3], a3=0.1, a4=5.0, omega1=1.0)
    with pytest.warns(fl.InputWarning, match="omega4_sum is wrong in 3 of 3 values"):
        assert swept(["omega4_sum"], space, verify=3).attrs["verify_mismatches"] == 3


@pytest.mark.parametrize("order", [("omega1", "a2", "a3"), ("a2", "omega1", "a3"), ("a2", "a3", "omega1")])
def test_a_scaling_axis_scales_them_by_their_power(order):
    axes = {**CRANK, "omega1": SPEEDS}
    space = fl.grid(a1=axes["a1"], a4=axes["a4"], **{name: axes[name] for name in order})
    names = ["alpha4_sum", "alpha4_range", "alpha4_square", "omega4_square", "alpha4_mean"]
    together = swept(names, space, verify=8)
    assert together.attrs["scaling_axis"] == "omega1"
    for speed in SPEEDS:
        alone = swept([*names, "alpha4"], fl.grid(**CRANK, omega1=float(speed)))
        for name in names:
            # sums cancel: errors are relative to the sum of sizes, at most n times the greatest
            size = POSITIONS * (np.abs(alone[name]).max().item() + np.abs(alone.alpha4).max().item())
            got = together[name].sel(omega1=speed).transpose(*alone[name].dims)
            assert_allclose(got, alone[name], rtol=0, atol=(POSITIONS + 4) * 2.0**-52 * size, err_msg=name)


def test_what_does_not_scale_is_evaluated_at_every_speed():
    space = fl.grid(**CRANK, omega1=SPEEDS)
    together = swept(["omega4_share", "omega4"], space)
    assert "scaling_axis" not in together.attrs
    assert_array_equal(together.omega4_share, by_numpy(together.omega4.values)["share"])
    assert swept(["theta4_share"], space).attrs["scaling_axis"] == "omega1"  # theta4 itself does not grow


def test_units_follow_from_those_of_the_quantity():
    maps = swept(["alpha4_sum", "alpha4_square", "alpha4_share", "theta4_square", "transmission_angle_range"])
    units = {str(name): array.attrs["units"] for name, array in maps.data_vars.items() if name != "status"}
    assert units == {
        "alpha4_sum": "rad s-2",
        "alpha4_square": "rad2 s-4",
        "alpha4_share": "1",
        "theta4_square": "rad2",
        "transmission_angle_range": "rad",
    }


def test_every_door_knows_them(folder):
    text = """
mechanism = "planar_4r"
quantities = ["omega4_sum", "d_omega4_d_a2_range", "omega4_max"]
design = {a1 = 0.4, a2 = {linspace = [1.1, 1.3, 3]}, a3 = 0.8, a4 = 1.0, omega1 = 25.0}
cycle = {angles = 24}
"""
    study = written(text)
    with fl.run(study) as maps:
        assert maps.omega4_sum.attrs["error_max_roundings"] <= POSITIONS
        couplers, expected = maps.a2.values, maps.omega4_sum.values
        assert "d_omega4_d_a2_range" in maps
    fixed = {"a1": 0.4, "a3": 0.8, "a4": 1.0, "omega1": 25.0}
    compiled = fl.function("planar_4r", ["a2"], ["omega4_sum"], angles=24, **fixed)
    assert_array_equal(compiled([couplers])[0], expected)
    assert "omega4_sum" in str(fl.explain(study))
    assert "NAME_sum (sum over the positions)" in " ".join(str(fl.quantities("planar_4r")).split())
    assert fl.accuracy(study, designs=3).attrs["left_out"] == "omega4_sum d_omega4_d_a2_range"
    with pytest.raises(fl.InputError, match="did you mean 'omega4_range'"):
        swept(["omega4_rang"])


@pytest.mark.parametrize("solver", ["eliminated", "dense"])
def test_fluctuations_are_verified(solver):
    space = fl.sobol(32, seed=5, a1=0.4, a2=(0.9, 1.4), a3=(0.5, 1.1), a4=1.0, omega1=25.0)
    maps = swept(["T41_fluctuation"], space, links=BARS, verify=16, solver=solver)
    found = maps.T41_fluctuation
    assert np.isnan(found).any()
    assert found.attrs["verified_values"] == 16
    assert found.attrs["verify_mismatches"] == 0
    # The mean and the integral are each a sum of n terms, of the sizes that roundings are counted in; LU in NumPy
    # has other roundings than in the kernel, so that its samples differ (tests/mechanisms/test_precision.py: by 16).
    assert found.attrs["error_max_roundings"] <= (2 if solver == "eliminated" else 18) * POSITIONS
    assert "verify_left_out" not in maps.attrs


def test_means_and_places_of_codes_are_numbers():
    """They are not codes: an int8 would cut a mean, or an input position."""
    positions = np.linspace(-2.0, 2.0, 9) + 0.25
    space = fl.grid(a=[1.0, 2.0], b=2.0, g=3.0, h=1.5)
    names = ["configuration_status", "configuration_status_mean", "configuration_status_max"]
    place = "theta_at_configuration_status_max"
    maps = sweep_both("minkowski_4r", space, [*names, place], theta=positions, verify=4)
    codes = maps.configuration_status.values
    assert 0 < codes.mean() < 1
    # whole numbers below 2^53 are added without rounding
    assert_array_equal(maps.configuration_status_mean, codes.sum(axis=-1) / positions.size)
    assert_array_equal(maps[place], positions[codes.argmax(axis=-1)])
    assert maps.attrs["verify_mismatches"] == 0
    for name in (names[1], place):
        assert maps[name].attrs["units"] == "1"
        assert "flag_meanings" not in maps[name].attrs
    assert maps.configuration_status_max.dtype == np.int8
    assert "flag_meanings" in maps.configuration_status_max.attrs


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"power": 2}, r"not 4\^2 times"),
        ({"power": None}, "the power of its units, or its units"),
        ({"units": "m"}, "the power of its units, or its units"),
        ({"sign": 1}, "not that of its reference"),
        ({"sign": 2}, "write 1, -1 or 0"),
        ({"finish": ""}, "accumulators and finish, or"),
        ({"whole": "fluctuation.fluctuation_lanes"}, "accumulators and finish, or"),
        ({"finish": "{totl}"}, "reads totl"),
        ({"accumulators": {"value": ("0.0", "{value}")}}, "call the accumulator 'value' otherwise"),
    ],
)
def test_parts_that_do_not_fit_are_refused(change, message):
    with pytest.raises(CatalogueError, match=message):
        replace(SUM, **change)


def test_suffixes_are_declared_once_with_a_reference_and_unknown_once_taken_back():
    with pytest.raises(CatalogueError, match="max is declared twice"):
        register(REDUCTIONS["max"])
    with pytest.raises(TypeError, match="reference"):
        Reduction(suffix="median", phrase="median", accumulators={"total": ("0.0", TOTAL)}, finish="{total}")
    unregister("sum")
    with pytest.raises(fl.InputError, match="'omega4_sum' is unknown"):
        swept(["omega4_sum"])
    register(SUM)


@pytest.mark.parametrize("suffix", ["of_all", "error", "extrema"])
def test_a_suffix_that_means_something_else_is_refused(suffix):
    with pytest.raises(CatalogueError, match="cannot be called"):
        register(replace(SUM, suffix=suffix))
    assert suffix not in REDUCTIONS
