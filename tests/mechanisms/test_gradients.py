"""Derivatives of extremes by the inputs are those of the extremes, as differences with 50 digits tell."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from tests.support.configurations import LENGTHS, numbers
from tests.support.extremes import SEARCHED, designs_of, held_slopes, searched, swept_4r
from tests.support.sweeps import sweep_4r, sweep_both

import fastlink as fl
from fastlink.facts.derivative import NoDerivative
from fastlink.facts.names import derivative_name
from fastlink.numerics import compiler as codes

#: Quantities with and without limits of motion, finite there and not, and the input that they are differentiated by.
SOME = {
    "theta1": (("omega4", "B_y", "theta2"), "a1"),
    "theta": (("slider_acceleration", "transmission_angle"), "r"),
    "sigma": (("F_y",), "a"),
    "phi": (("F_y",), "a"),
    "joint_angle_2": (("transmission_angle",), "a1"),
}
#: Of few inputs each, and no kind of their own.
LATER = ("slider_crank theta", "hart phi", "focal sigma")


def has(entry, designs, name, by):
    """Tell whether a quantity has a derivative by an input."""
    try:
        entry.catalogue.resolve(
            derivative_name(name, by), entry.catalogue.variants_selected_by(designs), tuple(designs)
        )
    except NoDerivative:
        return False
    return True


@pytest.mark.parametrize(
    "entry",
    [
        pytest.param(e, id=str(e), marks=pytest.mark.stress if str(e) in LATER else [])
        for e in SEARCHED
        if e.input in SOME
    ],
)
def test_derivatives_of_extremes_are_their_differences(entry):
    designs, (names, by) = designs_of(entry, "random", 11, 3), SOME[entry.input]
    by = by if by in designs else next(iter(designs))
    names = [name for name in names if name in entry.names]
    assert held_slopes(entry, designs, names, [by], places=False) >= 2


def test_derivatives_of_places_are_their_differences():
    designs = designs_of(SEARCHED[0], "random", 12, 3)
    assert held_slopes(SEARCHED[0], designs, ["omega2", "B_y"], ["a2"], places=True) >= 4


@pytest.mark.stress
@pytest.mark.parametrize("entry", SEARCHED, ids=str)
def test_derivatives_of_extremes_of_many_designs(entry):
    for seed in range(20):
        rng, designs = np.random.default_rng(seed), designs_of(entry, "random", seed, 25)
        by = str(rng.choice([name for name in designs if name in entry.catalogue.variables][:4]))
        names = [name for name in searched(entry, designs) if has(entry, designs, name, by)]
        names = [str(name) for name in rng.permutation(names)[:2]]
        held_slopes(entry, designs, names, [by], places=False)


@pytest.mark.sample(2)
@pytest.mark.parametrize(
    ("name", "lengths", "codes"),
    [
        ("omega4_max", (0.4, 1.2, 0.8, 1.0), (codes.SMOOTH, codes.SMOOTH)),
        ("omega4_max", (1.0, 0.6, 0.7, 1.2), (codes.INFINITE, codes.INFINITE)),
        ("B_y_min", (1.0, 0.6, 0.7, 1.2), (codes.TIED, codes.AT_LIMIT)),
        ("theta4_max", (1.0, 0.6, 0.7, 1.2), (codes.JUMP, codes.JUMP)),
        ("omega4_max", (5.0, 1.0, 1.0, 1.0), (codes.NOTHING, codes.NOTHING)),
        ("omega4_mean", (0.4, 1.2, 0.8, 1.0), (codes.SMOOTH, codes.SMOOTH)),
        ("theta4_mean", (1.0, 0.6, 0.7, 1.2), (codes.MOVING, codes.MOVING)),
        ("omega4_rms", (5.0, 1.0, 1.0, 1.0), (codes.NOTHING, codes.NOTHING)),
        ("loop_residual_max", (0.4, 1.2, 0.8, 1.0), (codes.OF_SAMPLES, codes.OF_SAMPLES)),
    ],
)
def test_the_status_tells_what_derivatives_are_worth(name, lengths, codes):
    status = swept_4r([f"{name}_gradient_status"], lengths)[f"{name}_gradient_status"]
    assert tuple(status.values.tolist()) == codes
    assert len(status.attrs["flag_meanings"].split()) == status.attrs["flag_values"].size


def test_what_stands_still_folds_or_is_verified_has_its_own_derivatives():
    speed = swept_4r(["P_speed_max_gradient_status", "d_P_speed_max_d_a1"], point={"P_u": 0.0, "P_v": 0.0})
    assert (speed["P_speed_max_gradient_status"] == codes.CONSTANT).all()
    assert (speed["d_P_speed_max_d_a1"] == 1.0).all()
    still = swept_4r(["omega4_rms_gradient_status", "d_omega4_rms_d_a1"], omega1=0.0)
    assert (still["omega4_rms_gradient_status"] == codes.KINK).all()
    assert np.isnan(still["d_omega4_rms_d_a1"]).all()
    found = swept_4r(
        ["transmission_angle_min", "transmission_angle_min_gradient_status"], (4.0, 9.0, 12.0, 7.0)
    )
    assert (found["transmission_angle_min_gradient_status"] == codes.AT_CHANGE_POINT).all()
    assert (
        swept_4r(["omega4_max", "d_omega4_max_d_a2"], verify=1).attrs["verify_left_out"]
        == "d_omega4_max_d_a2"
    )


def test_means_and_samples_change_as_differences_of_theirs():
    """A central difference over 2^-16 is off by 2^-32 of the third derivative, and by rounding errors over 2^-16."""
    h = 2.0**-16
    for names, options in (
        (("omega4_mean", "alpha4_rms"), {}),
        (("omega4_max", "B_y_min"), {"extrema": "sampled"}),
    ):
        found = swept_4r([f"d_{name}_d_a2" for name in names], **options)
        up, down = (swept_4r(names, (0.4, 1.2 + step, 0.8, 1.0), **options) for step in (h, -h))
        for name in names:
            difference = (up[name] - down[name]) / (2.0 * h)
            assert_allclose(found[f"d_{name}_d_a2"], difference, atol=1e-8, rtol=1e-8)


def test_mechanisms_without_a_graded_range_have_derivatives_of_samples():
    """The step is so small that the same sample is the greatest."""
    design = {"a": 1.0, "b": 2.0, "g": 2.2, "h": 1.5}
    h = 2.0**-20

    def extreme(name, **moved):
        space = fl.grid(**design | moved)
        return sweep_both("minkowski_4r", space, [name], allow_invalid=True)[name]

    found = extreme("d_A_y_max_d_a")
    difference = (extreme("A_y_max", a=1.0 + h) - extreme("A_y_max", a=1.0 - h)) / (2.0 * h)
    assert_allclose(found, difference, rtol=1e-7)
    assert (extreme("A_y_max_gradient_status") == codes.OF_SAMPLES).all()


def test_labels_units_and_axes_that_scale():
    names = ["d_omega4_max_d_a2", "d_theta1_at_omega4_max_d_a2", "omega4_max_gradient_status"]
    one = swept_4r(names)
    assert one["d_omega4_max_d_a2"].attrs["units"] == "rad s-1 m-1"
    assert one["d_theta1_at_omega4_max_d_a2"].attrs["units"] == "rad m-1"
    assert one["d_omega4_max_d_a2"].attrs["symbol"] == "d max omega_4/d a_2"
    assert "units" not in one["omega4_max_gradient_status"].attrs
    axis = swept_4r(names, omega1=[1.0, 2.0])
    assert axis.attrs["scaling_axis"] == "omega1"
    for name, power in zip(names, (1, 0, 0), strict=True):
        assert_array_equal(axis[name][0], one[name])
        assert_array_equal(axis[name][1], 2**power * one[name])


def test_an_extreme_at_a_limit_of_motion_changes_with_what_moves_the_limit_alone():
    # A_y = a1 sin theta1, whose range a3 and a4 limit
    names, step = ["A_y_max", "theta1_at_A_y_max", "A_x_max"], 2.0**-17
    for by, place in (("a3", 2), ("a4", 3)):
        lengths = [1.0, 0.6, 0.7, 1.2]
        slopes = swept_4r([*(f"d_{name}_d_{by}" for name in names), "A_y_max_gradient_status"], lengths)
        assert (slopes["A_y_max_gradient_status"] == codes.AT_LIMIT).all()
        below, above = (
            swept_4r(names, [x + sign * step * (k == place) for k, x in enumerate(lengths)])
            for sign in (-1, 1)
        )
        for name in names:
            # differences are off by a third power, 2^-34, and by roundings of 2^-52 over 2^-16
            differences = (above[name] - below[name]) / (2 * step)
            assert_allclose(slopes[f"d_{name}_d_{by}"], differences, rtol=1e-8, atol=1e-9)
        assert (abs(slopes[f"d_A_y_max_d_{by}"]) > 0.1).all()
        numbers = fl.function(
            "planar_4r", [by], names, **{key: x for key, x in zip(LENGTHS, lengths, strict=True) if key != by}
        )
        of_function = numbers.gradient([lengths[place]])[:, 0]
        assert_array_equal(of_function, [slopes[f"d_{name}_d_{by}"][0] for name in names])
    # where the crank turns fully, nothing moves
    assert (swept_4r(["d_A_y_max_d_a3"])["d_A_y_max_d_a3"] == 0.0).all()
    tolerances = {"a1": 1.0, "a2": 0.6, "a3": 0.7, "a4": 1.2, "a3_tolerance": 1e-4}
    changed = sweep_4r(fl.grid(tolerances), ["A_y_max_worst_change"])
    assert (changed["A_y_max_worst_change"] > 1e-5).all()


def test_an_angle_that_folds_at_pi_keeps_its_greatest_value():
    # the bars at P pass the straight line in the middle of the motion: mu_P is pi there whatever the lengths
    bars = numbers("a=1.3828348684464724 b=0.9522518422452018 c=1.6380671227307617 d=1.0228886622434283")
    names = ["transmission_angle_P_max", "d_transmission_angle_P_max_d_d"]
    found = sweep_both(
        "focal",
        fl.grid(**bars, rho=-0.21249720035072545, omega=1.9386164640461634, completion=1),
        [*names, "transmission_angle_P_max_gradient_status"],
    )
    assert (found[names[0]] > np.pi - 1e-15).all()
    assert (found[names[1]] == 0.0).all()
    assert (found["transmission_angle_P_max_gradient_status"] == codes.JUMP).all()
