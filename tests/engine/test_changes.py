"""Changes by tolerances as variables of a sweep: NAME_worst_change and NAME_rss_change."""

import itertools

import numpy as np
import pytest
from tests.support.refusals import refused
from tests.support.sweeps import sweep_4r, sweep_both

import fastlink as fl
from fastlink.mechanisms import catalogue

DESIGN = {"a1": 0.4, "a2": 1.1, "a3": 0.8, "a4": 1.0, "omega1": 25.0}
TOLERANCES = {"a1_tolerance": 1e-4, "a2_tolerance": 2e-4, "a3_relative_tolerance": 1e-3}
#: Mechanisms with ranges of their inputs, and what changes: an extreme, its place, a mean, a value.
CASES = {
    "planar_4r": (
        {"a1": (0.3, 0.4), "a2": (1.0, 1.3), "a3": (0.7, 0.9), "a4": (1.0, 1.1), "omega1": (20.0, 25.0)},
        ["omega4_max", "theta1_at_omega4_max", "omega4_rms"],
    ),
    "slider_crank": (
        {"r": (0.1, 0.2), "l": (0.5, 0.6), "e": (0.03, 0.05), "omega": (10.0, 12.0)},
        ["slider_acceleration_max", "slider_velocity_mean", "theta_at_slider_velocity_max"],
    ),
    "minkowski_4r": (
        {"a": (1.0, 1.1), "b": (1.2, 1.3), "g": (1.0, 1.1), "h": (1.2, 1.3)},
        ["psi", "dpsi_dtheta_max"],
    ),
    "focal": (
        {"a": (5.0, 5.2), "b": (4.4, 4.6), "c": (1.6, 1.8), "d": (4.0, 4.1), "rho": (0.9, 1.1)},
        ["r", "F_y"],
    ),
    "hart": ({"m": (0.25, 0.3), "n": (0.8, 0.9), "d": (0.6, 0.7), "kappa": (0.4, 0.5)}, ["F_y", "dF_y_dphi"]),
}
#: Tolerances over the inputs. Differences between opposite corners are off by the third power; of two such, one of half
#: the size, that cancels. Left: a fifth power, (1e-5)^4 times what grows towards toggles, and roundings, 1e-16 to 1e-5.
SHARE, OFF = 1e-5, 1e-8
FIRST = ("slider_crank", "minkowski_4r")


def swept(names, tolerances=TOLERANCES, **options):
    return sweep_4r(fl.grid(DESIGN | tolerances), names, **options)


@pytest.mark.parametrize(
    "mechanism", [pytest.param(name, marks=() if name in FIRST else pytest.mark.stress) for name in CASES]
)
def test_changes_are_those_of_designs_at_all_corners_of_the_tolerances(mechanism):
    ranges, names = CASES[mechanism]
    rng, n = np.random.default_rng(5), 6
    designs = {name: rng.uniform(*ends, n) for name, ends in ranges.items()}
    options = {
        "progress": False,
        **({} if mechanism in ("planar_4r", "slider_crank") else {"angles": [0.2, 0.7]}),
    }
    given = designs | {f"{name}_relative_tolerance": np.full(n, SHARE) for name in designs}
    changes = [f"{name}_{how}_change" for name in names for how in ("worst", "rss")]
    found = sweep_both(mechanism, fl.table(given), changes, **options)
    signs = np.array(list(itertools.product((-1.0, 1.0), repeat=len(designs))))

    def at_corners(share):
        moved = {
            name: (column[:, None] * (1.0 + share * signs[:, k])).ravel()
            for k, (name, column) in enumerate(designs.items())
        }
        return sweep_both(mechanism, fl.table(moved), names, **options)

    whole, half = at_corners(SHARE), at_corners(SHARE / 2)
    compared = 0
    for name in names:
        corners = (8.0 * half[name].values - whole[name].values) / 3.0
        corners = corners.reshape(n, len(signs), *corners.shape[1:])
        changed = 0.5 * (corners - corners[:, ::-1])  # opposite corners
        np.testing.assert_allclose(
            found[f"{name}_worst_change"], abs(changed).max(axis=1), rtol=OFF, atol=1e-13
        )
        np.testing.assert_allclose(
            found[f"{name}_rss_change"], np.sqrt((changed**2).mean(axis=1)), rtol=OFF, atol=1e-13
        )
        compared += int(np.isfinite(changed).any())
    assert compared == len(names)


def test_changes_are_made_of_the_derivatives_that_are_offered():
    for name in ("omega4_max", "theta1_at_omega4_max", "omega4_mean", "omega4"):
        slopes = [f"d_{name}_d_{by}" for by in ("a1", "a2", "a3")]
        found = swept([f"{name}_worst_change", f"{name}_rss_change", *slopes], angles=8)
        terms = [abs(found[s]) * t for s, t in zip(slopes, (1e-4, 2e-4, 1e-3 * 0.8), strict=True)]
        np.testing.assert_array_equal(found[f"{name}_worst_change"], sum(terms))
        # two magnitudes, each of less than four roundings
        np.testing.assert_allclose(
            found[f"{name}_rss_change"], np.sqrt(sum(term**2 for term in terms)), rtol=8 * 2.0**-52
        )
        assert found[f"{name}_rss_change"].attrs["units"] == ("rad" if "theta1" in name else "rad s-1")


def test_the_status_of_the_derivatives_comes_along():
    # two places tie, the motion has limits
    found = swept(["B_y_min_rss_change", "theta1_at_B_y_min_worst_change"], {"a1_tolerance": 1e-4})
    assert list(found.data_vars)[:3] == [
        "B_y_min_rss_change", "B_y_min_gradient_status", "theta1_at_B_y_min_worst_change",
    ]  # fmt: skip
    stopped = fl.grid(a1=1.0, a2=0.6, a3=0.7, a4=1.2, omega1=1.0, a2_tolerance=1e-4)
    infinite = sweep_4r(stopped, ["omega4_max_worst_change"])
    assert np.isnan(infinite.omega4_max_worst_change).all()
    assert (infinite.omega4_max_gradient_status == 3).all()


def test_an_axis_of_tolerances_only_scales_the_changes():
    space = fl.grid(DESIGN | {"a2": [1.1, 1.2], "a2_tolerance": [1e-5, 1e-4, 1e-3]})
    names = ["omega4_max_worst_change", "omega4_rms_rss_change", "omega4_rss_change"]
    found = sweep_4r(space, names, angles=4)
    assert found.attrs["scaling_axis"] == "a2_tolerance"
    for k, size in enumerate((1e-5, 1e-4, 1e-3)):
        one = swept(names, {"a2_tolerance": size}, angles=4)
        for name in names:
            np.testing.assert_allclose(found[name][0, k], one[name], rtol=4 * 2.0**-52)
    # with a second tolerance that stays it does not; the speed still does
    both = fl.grid(DESIGN | {"omega1": [1.0, 2.0], "a1_tolerance": 1e-4, "a2_tolerance": [1e-5, 1e-4]})
    assert sweep_4r(both, names[:1]).attrs["scaling_axis"] == "omega1"


def test_a_change_over_the_cycle_has_its_extremes():
    found = swept(
        ["theta4_worst_change_max", "theta1_at_theta4_worst_change_max", "theta4_worst_change_mean"]
    )
    at = found.theta1_at_theta4_worst_change_max.values
    assert found.theta4_worst_change_max.attrs["extrema"] == "refined"
    curve = swept(["theta4_worst_change"], angles=3600).theta4_worst_change
    # the curve bends by less than three times its greatest value, samples are 0.1 degrees apart
    np.testing.assert_allclose(found.theta4_worst_change_max, curve.max("theta1"), rtol=1e-5)
    for k in (0, 1):
        given = DESIGN | TOLERANCES | {"theta1": at[k], "branch": k + 1}
        here = fl.evaluate("planar_4r", ["theta4_worst_change"], **given)["theta4_worst_change"]
        assert here == pytest.approx(float(found.theta4_worst_change_max[k]), rel=1e-12)


def test_other_doors_have_them():
    given = DESIGN | TOLERANCES
    del given["a1"], given["a2"]
    both = fl.function("planar_4r", ["a1", "a2"], ["omega4_max_worst_change", "omega4_max"], **given)
    one = swept(["omega4_max_worst_change"], branch=1)
    assert both([0.4, 1.1])[0] == float(one.omega4_max_worst_change)
    by_size = fl.function("planar_4r", ["a1_tolerance"], ["omega4_max_worst_change"], **DESIGN)
    assert by_size([2e-4])[0] == pytest.approx(2 * by_size([1e-4])[0], rel=1e-15)
    found = fl.sweep("planar_4r", one.fastlink.designs, ["omega4_max_worst_change"], branch=1)
    assert found.omega4_max_worst_change.equals(one.omega4_max_worst_change)
    explained = fl.explain(
        "planar_4r", fl.grid(DESIGN | TOLERANCES), ["omega4_max_worst_change"], branch=(1, 2)
    )
    assert any("d_omega4_d_a2" in kernel.facts for kernel in explained.kernels)


@pytest.mark.parametrize(
    ("name", "key", "remedy"),
    [
        ("status_worst_change", "code", "leave it out"),
        ("omega4_extrema_rss_change", "list", "omega4_max_rss_change"),
        ("omega4_max_worst_change_error", "error bound", "leave it out"),
        ("d_omega4_max_worst_change_d_a1", "omega4_max", "omega4_max_worst_change"),
        ("omega4_worst_change_rss_change", "change", "omega4_worst_change"),
        ("omega4_fluctuation_worst_change", "omega4_fluctuation", "leave it out"),
        ("P_u_worst_change", "quantity", ""),
    ],
)
def test_what_has_no_change_is_refused(name, key, remedy):
    with refused(key, remedy):
        swept([name])


@pytest.mark.parametrize(
    ("tolerances", "key", "remedy"),
    [
        ({}, "omega4", "a1_tolerance, a2_tolerance"),
        ({"a1_tolerance": -1.0}, "a1_tolerance", "at least 0"),
        ({"a1_tolerance": 1.0, "a1_relative_tolerance": 1.0}, "a1_tolerance", "leave one"),
    ],
)
def test_tolerances_that_are_missing_or_wrong_are_refused(tolerances, key, remedy):
    with refused(key, remedy):
        swept(["omega4_worst_change"], tolerances)
    with refused(key, remedy):
        fl.function(
            "planar_4r",
            ["a1"],
            ["omega4_max_rss_change"],
            **{k: v for k, v in (DESIGN | tolerances).items() if k != "a1"},
        )


def test_the_gradient_has_none_by_a_tolerance():
    given = {key: value for key, value in DESIGN.items() if key != "a1"}
    with refused("a1_tolerance", "stays"):
        fl.function("planar_4r", ["a1", "a1_tolerance"], ["omega4_max"], **given).gradient([0.4, 1e-4])


def test_every_input_but_a_code_has_a_tolerance():
    for mechanism in CASES:
        known = catalogue(mechanism)
        of = {name for name, one in known.known_inputs(known.variant_inputs).items() if not one.choices}
        assert {f"{name}_tolerance" for name in of} < known.tolerances.keys()
