"""Every greatest, least and listed extreme is within its error bound, and the bound is not absurdly great.

The exact extremes are those of 50 digits (`fastlink.precision.stationary`), found by another search. There is no
tolerance: |value - exact| <= bound is what a bound is. How loose bounds are is measured, as nothing says how loose
they may be: of the planar linkage half are within 10 to 130 errors, an error being a rounding of the value at least.
"""

from __future__ import annotations

import numpy as np
import pytest
from tests.support.extrema_errors import bounded_extremes, designs_of, searched
from tests.support.refusals import refused
from tests.support.registry import ENTRIES

import fastlink as fl
from fastlink.codegen.kernel import kernel_of
from fastlink.codegen.runtime.results import of_better
from fastlink.mechanisms import catalogue
from fastlink.numerics.compensated import UNIT_ROUNDING
from fastlink.plan.programs import make_plan
from fastlink.precision.errors import MeasuredErrors
from fastlink.precision.reference import CONTEXT

LENGTHS = ("a1", "a2", "a3", "a4")
DRIVEN = [
    entry for entry in ENTRIES if entry.moves and entry.catalogue.graded and entry.solver == "eliminated"
]
#: Some of each kind: accelerations, forces, a coordinate, an angle with kinks; rates and angles with jumps are below.
SOME = {
    "theta1": ("alpha4", "F41"),
    "theta": ("slider_acceleration",),
    "sigma": ("transmission_angle_F",),
    "phi": ("F_y",),
}
LOOSENESS = 250.0


def held(entry, designs, names):
    """Assert that all bounds hold; return bounds over errors."""
    extremes = list(bounded_extremes(entry, designs, names))
    assert [one for one in extremes if not one.holds] == []
    finite = [one for one in extremes if np.isfinite(one.value) and np.isfinite(one.bound)]
    return [one.bound / max(one.error, UNIT_ROUNDING * abs(one.value)) for one in finite if one.value != 0.0]


def cases(entries):
    return [pytest.param(entry, kind, id=f"{entry}-{kind}") for entry in entries for kind in entry.families]


#: The plain planar 4R in all families, every other mechanism and input in one.
FIRST = {entry: next(iter(entry.families)) for entry in DRIVEN[1:] if not entry.about}


@pytest.mark.sample(2)
@pytest.mark.parametrize("kind", DRIVEN[0].families)
def test_extremes_of_the_planar_linkage_are_within_their_bounds(kind):
    designs = designs_of(DRIVEN[0], kind, 1, 2)
    assert np.median(held(DRIVEN[0], designs, SOME["theta1"])) < LOOSENESS


@pytest.mark.sample(2)
@pytest.mark.parametrize(("entry", "kind"), [pytest.param(*one, id=str(one[0])) for one in FIRST.items()])
def test_extremes_of_every_mechanism_are_within_their_bounds(entry, kind):
    designs = designs_of(entry, kind, 3, 3)
    names = [name for name in SOME.get(entry.input, ("joint_omega_2",)) if name in entry.names]
    assert held(entry, designs, names or ["joint_omega_3"])


@pytest.mark.stress
@pytest.mark.parametrize(("entry", "kind"), cases(DRIVEN))
def test_extremes_of_all_quantities_are_within_their_bounds(entry, kind):
    for seed in range(2):
        designs = designs_of(entry, kind, seed, 5)
        names = np.random.default_rng(seed).permutation(searched(entry, designs))[:6]
        ratios = held(entry, designs, [str(name) for name in names])
        assert entry.mechanism != "planar_4r" or not ratios or np.median(ratios) < LOOSENESS


@pytest.mark.parametrize(
    "lengths",
    [
        (1.0, 0.6, 0.7, 1.2),  # toggles on both sides: infinite rates
        (2.0, 3.0, 2.5, 2.5),  # a change point
        (4.0, 9.0, 12.0, 7.0),  # another, whose crank turns fully
        (1.0, 2.0, 1.0, 2.0),  # a parallelogram: rates are constant in one branch
    ],
)
def test_extremes_at_toggles_and_change_points_are_within_their_bounds(lengths):
    designs = {name: np.array([value]) for name, value in zip(LENGTHS, lengths, strict=True)}
    held(DRIVEN[0], designs | {"omega1": np.array([3.0])}, ("omega4", "theta4"))


def swept(names, lengths=(0.4, 1.2, 0.8, 1.0), **options):
    design = dict(zip(LENGTHS, lengths, strict=True)) | {"omega1": 1.0}
    return fl.sweep("planar_4r", fl.grid(**design), names, progress=False, allow_invalid=True, **options)


def test_no_extreme_has_no_error_and_what_is_infinite_an_infinite_one():
    names = ["omega4_max", "omega4_max_error", "omega4_extrema", "omega4_extrema_error"]
    never = swept(names, (5.0, 1.0, 1.0, 1.0))
    assert all(np.isnan(never[name]).all() for name in names)
    toggles = swept(names, (1.0, 0.6, 0.7, 1.2))
    assert (np.isinf(toggles["omega4_max"]) == np.isinf(toggles["omega4_max_error"])).all()
    listed = np.isfinite(toggles["omega4_extrema"])
    assert (listed == np.isfinite(toggles["omega4_extrema_error"])).all()


@pytest.mark.parametrize("lengths", [(7.0, 11.0, 8.0, 4.0), (2.0, 3.0, 2.5, 2.5)])
def test_forces_are_infinite_where_a_change_point_folds_under_a_load(lengths):
    """All bars lie in line there, and no finite force along them holds a weight across; along them some do."""
    links = fl.round_bar(density=7750.0, radius=0.01)
    names = ["F21_max", "F21_max_error", "F21_min", "F21_min_error"]
    space = fl.grid(**dict(zip(LENGTHS, lengths, strict=True)), omega1=1.0, gravity_y=[-9.81])
    loaded = fl.sweep("planar_4r", space, names, links=links, progress=False)
    assert np.isinf(loaded["F21_max"]).all()
    assert np.isinf(loaded["F21_max_error"]).all()
    assert (loaded["F21_min_error"] < 1e-9 * loaded["F21_min"]).all()
    assert np.isfinite(swept(["F21_max"], lengths, links=links)["F21_max"]).all()


def test_errors_change_no_value_and_stand_alone():
    values = ["omega4_max", "theta1_at_omega4_max", "omega4_extrema", "theta4_min"]
    plain = swept(values)
    both = swept([*values, "omega4_max_error", "omega4_extrema_error", "theta4_min_error"])
    alone = swept(["omega4_max_error", "theta4_min_error"])
    for name in plain.data_vars:
        np.testing.assert_array_equal(plain[name], both[name])
    for name in ("omega4_max_error", "theta4_min_error"):
        np.testing.assert_array_equal(alone[name], both[name])


def test_a_kernel_without_errors_computes_none():
    planar, names = catalogue("planar_4r"), ("omega4_max", "alpha4_extrema")
    plan = make_plan(planar, names, given=(*LENGTHS, "omega1"))
    assert not any("error" in kernel_of(program).text for program in plan.programs)


def test_labels_tell_the_error_of_the_greatest_value_from_the_greatest_error():
    found = swept(["omega4_max_error", "omega4_error_max", "omega4_extrema_error"])
    assert found["omega4_max_error"].attrs["symbol"] == "err max omega_4"
    assert found["omega4_error_max"].attrs["symbol"] == "max err omega_4"
    assert {found[name].attrs["units"] for name in found.data_vars if name != "status"} == {"rad s-1"}
    assert found["omega4_extrema_error"].dims == ("branch", "extremum")


def test_a_scaling_axis_and_units_of_a_design_leave_bounds_right():
    """An axis that multiplies results would leave out the rounding of that product; powers of two are exact."""
    one = swept(["omega4_max", "omega4_max_error"])
    design = dict(zip(LENGTHS, (0.4, 1.2, 0.8, 1.0), strict=True))
    axis = fl.grid(**design, omega1=[1.0, 3.0])
    found = fl.sweep("planar_4r", axis, ["omega4_max", "omega4_max_error"], progress=False)
    assert "scaling_axis" not in found.attrs
    np.testing.assert_array_equal(found["omega4_max_error"][0], one["omega4_max_error"])
    far = swept(["omega4_max_error"], tuple(2.0**-700 * length for length in (0.4, 1.2, 0.8, 1.0)))
    np.testing.assert_array_equal(far["omega4_max_error"], one["omega4_max_error"])


def test_verification_holds_errors_of_extremes_against_their_bounds():
    names = ["omega4_max", "omega4_max_error", "omega4_extrema", "omega4_extrema_error", "theta4_min_error"]
    found = swept(names, verify=1)
    for name in ("omega4_max_error", "omega4_extrema_error"):
        assert 0.0 <= found[name].attrs["error_max_of_bound"] <= 1.0
    assert found.attrs["verify_mismatches"] == 0
    assert found.attrs["verify_left_out"] == "theta4_min_error"  # without its value there is no error
    assert "of the bound, of 1" in fl.summary(found)


def test_verification_notices_a_bound_that_is_too_small():
    measured = MeasuredErrors("")
    measured.add_bound(0.5, 1.0, CONTEXT.mpf(1.25))
    assert measured.attrs()["error_max_of_bound"] == 0.5
    for bound, value, exact in ((0.2, 1.0, 1.25), (0.0, 1.0, 1.25), (np.nan, 1.0, 1.25), (1.0, np.inf, 1.0)):
        measured.add_bound(bound, value, CONTEXT.mpf(exact))
    assert (measured.values, measured.mismatches) == (5, 4)


@pytest.mark.parametrize(
    ("best", "bound", "value", "other", "of_best"),
    [
        (5.0, 1.0, 3.0, 1.0, 1.0),  # far apart: that of the better one
        (5.0, 1.0, 4.5, 3.0, 2.5),  # the other may reach to 7.5
        (4.5, 3.0, 5.0, 1.0, 2.5),  # in whatever order they come
        (-np.inf, 0.0, 2.0, 0.5, 0.5),  # the first one
        (5.0, 1.0, np.nan, np.inf, 1.0),  # nothing
        (5.0, 1.0, 2.0, np.inf, np.inf),  # one of which nothing is known
        (np.inf, np.inf, 2.0, 1.0, np.inf),
    ],
)
def test_the_bound_of_the_best_counts_that_another_one_may_be_it(best, bound, value, other, of_best):
    assert of_better(best, bound, value, other) == of_best


@pytest.mark.parametrize(
    ("name", "options", "remedy"),
    [
        ("omega4_mean_error", {}, "ask for omega4_error_max"),
        ("theta1_at_omega4_max_error", {}, "ask for omega4_max_error"),
        ("theta1_at_omega4_extrema_error", {}, "ask for omega4_extrema_error"),
        ("omega4_extrema_count_error", {}, "leave it out"),
        ("omega4_max_error", {"extrema": "sampled"}, "write extrema='refined', or ask for omega4_error_max"),
        ("omega4_min_error", {"theta1": [0.1, 0.2]}, "give no array of theta1"),
        ("loop_residual_max_error", {}, "ask for loop_residual_error_max"),
        ("omega4_error_max_error", {}, "leave it out"),
    ],
)
def test_what_has_no_error_bound_is_refused_with_the_reason(name, options, remedy):
    key = "omega4_error_error" if name == "omega4_error_max_error" else name
    with refused(f"quantity {key!r}", remedy):
        swept([name], **options)


def test_a_position_has_no_extremes():
    design = dict(zip(LENGTHS, (0.4, 1.2, 0.8, 1.0), strict=True))
    with refused("quantity 'omega4_max_error'", "write 'omega4_error'"):
        fl.evaluate("planar_4r", ["omega4_max_error"], theta1=1.0, omega1=1.0, **design)
