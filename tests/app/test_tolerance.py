"""What tolerances do to the results of maps, studies and files, at every door."""

import itertools

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from tests.support.refusals import refused
from tests.support.sweeps import BARS, sweep_4r, sweep_both
from typer.testing import CliRunner

import fastlink as fl
from fastlink.app.cli import app
from fastlink.mechanisms import catalogue

DESIGN = {"a1": 0.4, "a2": [1.1, 1.2], "a3": 0.8, "a4": 1.0, "omega1": 25.0}
NAMES = ["omega4_max", "theta1_at_omega4_max", "swing", "grashof_class"]
GIVEN = {"a1": 1e-4, "a3": "0.1 %"}
STUDY = """
mechanism = "planar_4r"
quantities = ["omega4_max", "omega4_max_worst_change"]
[design]
a1 = 0.4
a2 = {values = [1.1, 1.2]}
a3 = 0.8
a4 = 1.0
omega1 = 25.0
[cycle]
branch = [1, 2]
[tolerances]
a1 = 1e-4
a3 = "0.1 %"
"""
#: The same without tolerances.
PLAIN = STUDY.partition("[tolerances]")[0].replace(', "omega4_max_worst_change"', "")


@pytest.fixture(scope="module")
def maps():
    return sweep_4r(fl.grid(DESIGN), NAMES)


def written(folder, text=STUDY):
    path = folder / "study.toml"
    path.write_text(text)
    return path


def test_a_map_is_swept_again_with_tolerances(maps):
    found = fl.tolerance(maps, contributions=True, **GIVEN)
    space = fl.grid(DESIGN | {"a1_tolerance": 1e-4, "a3_relative_tolerance": 1e-3})
    for name in NAMES[:3]:
        swept = sweep_4r(space, [name, f"{name}_worst_change", f"{name}_rss_change"])
        for of in swept.data_vars:
            assert found[of].equals(swept[of])
        parts = found[f"{name}_contribution"]
        assert parts.dims == (*found[name].dims, "toleranced")
        assert_array_equal(abs(parts).sum("toleranced"), swept[f"{name}_worst_change"])
    slope = sweep_4r(fl.grid(DESIGN), ["d_omega4_max_d_a3"]).d_omega4_max_d_a3
    assert_array_equal(found.omega4_max_contribution.sel(toleranced="a3"), slope * (0.8 * 1e-3))
    assert "grashof_class" not in found
    assert not any(name.startswith("d_") for name in found.data_vars)


def test_the_rows_of_the_best_designs_keep_their_assembly_modes(maps):
    rows = fl.best(maps, minimise="omega4_max", top=3)
    found = fl.tolerance(rows, ["omega4_max"], **GIVEN)
    whole = fl.tolerance(maps, ["omega4_max"], **GIVEN)
    assert_array_equal(found.omega4_max, rows.omega4_max)
    for k in range(3):
        of = whole.sel(a2=float(rows.a2[k]), branch=int(rows.branch[k]))
        assert float(found.omega4_max_rss_change[k]) == float(of.omega4_max_rss_change)


def test_links_angles_and_modes_of_a_map_stay(tmp_path):
    options = {"branch": 2, "theta1": [0.2, 0.5], "extrema": "sampled", "links": BARS}
    sweep_4r(fl.grid(DESIGN), ["F21_x", "omega4_max"], to=tmp_path / "maps.h5", **options).close()
    found = fl.tolerance(tmp_path / "maps.h5", density="1 %", a1=1e-4)
    assert found.F21_x_worst_change.dims == ("a2", "theta1")
    assert int(found.branch) == 2
    assert found.omega4_max.attrs["extrema"] == "sampled"
    again = fl.tolerance(found, to=tmp_path / "robust.h5")
    assert again.F21_x_worst_change.equals(found.F21_x_worst_change)
    again.close()


def test_a_study_has_tolerances_of_its_own_or_is_given_some(tmp_path, maps):
    with fl.run(written(tmp_path), to=tmp_path / "maps.h5") as run:
        found = fl.tolerance(maps, **GIVEN)
        assert run.omega4_max_worst_change.equals(found.omega4_max_worst_change)
        assert list(run.data_vars)[2] == "omega4_max_gradient_status"
        where = {"omega4_max_gradient_status": "derivative"}
        best = fl.best(run, minimise="omega4_max_worst_change", where=where, top=1)
        assert float(best.omega4_max_worst_change[0]) == float(run.omega4_max_worst_change.min())
    plain = written(tmp_path, PLAIN)
    assert fl.tolerance(plain, **GIVEN).omega4_max_rss_change.equals(found.omega4_max_rss_change)


@pytest.mark.parametrize(
    ("section", "key", "remedy"),
    [
        ("a1 = -1.0", "tolerances.a1", "at least 0"),
        ('a1 = "1 mm"', "tolerances.a1", "write a1_mm=1"),
        ("a9 = 1.0", "tolerances.a9", "did you mean"),
        ("a1 = [1.0, 2.0]", "tolerances.a1", "at least 0"),
        ("omega1 = nan", "tolerances.omega1", "rad s-1"),
    ],
)
def test_wrong_tolerances_of_a_study_are_refused(tmp_path, section, key, remedy):
    with refused(key, remedy):
        fl.run(written(tmp_path, STUDY.partition("a1 = 1e-4")[0] + section), to=tmp_path / "maps.h5")


@pytest.mark.parametrize(
    ("given", "key", "remedy"),
    [
        ({}, "tolerance", "a1=1e-4"),
        ({"a1": "0.1"}, "a1", "0.1 %"),
        ({"a1": float("nan")}, "a1", "at least 0"),
        ({"a1": [1e-4, 1e-3]}, "a1", "at least 0"),
        ({"a9": 1.0}, "a9", "did you mean"),
        ({"P_u": 1e-4}, "quantities", "tolerance of an input"),
        ({"a1": 1e-4, "quantities": ["omega4_maxx"]}, "omega4_maxx", "omega4"),
        ({"a1": 1e-4, "quantities": ["grashof_class"]}, "grashof_class", "leave it out"),
        ({"a1": 1e-4, "to": "x.h5", "contributions": True}, "contributions", "leave one"),
    ],
)
def test_bad_requests_are_refused(maps, given, key, remedy):
    with refused(key, remedy):
        fl.tolerance(maps, **given)


def test_the_command_lists_changes(tmp_path):
    run = CliRunner()
    study = written(tmp_path, PLAIN.replace("[1.1, 1.2]", "[1.1]"))
    found = run.invoke(
        app, ["tolerance", str(study), "a1=1e-4", "a3=0.1%", "--contributions", "--quantities", "swing"]
    )
    assert found.exit_code == 0, found.output
    (row,) = [line.split() for line in found.output.splitlines() if line.startswith("swing")]
    own = fl.tolerance(study, ["swing"], a1=1e-4, a3="0.1 %")
    assert row[1] == "rad"
    assert float(row[3]) == pytest.approx(own.swing_worst_change.values.ravel()[0], rel=1e-5)
    wrong = run.invoke(app, ["tolerance", str(study), "a1=x"])
    assert wrong.exit_code == 2
    assert "a1 is 'x'; write a number" in wrong.output


# == Changes by tolerances as variables of a sweep: NAME_worst_change and NAME_rss_change ====================

DESIGN_CHANGE = {"a1": 0.4, "a2": 1.1, "a3": 0.8, "a4": 1.0, "omega1": 25.0}
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
    return sweep_4r(fl.grid(DESIGN_CHANGE | tolerances), names, **options)


@pytest.mark.parametrize(
    "mechanism", [pytest.param(name, marks=() if name in FIRST else pytest.mark.stress) for name in CASES]
)
def test_changes_are_those_of_designs_at_all_corners_of_the_tolerances(mechanism):
    ranges, names = CASES[mechanism]
    rng, n = np.random.default_rng(5), 6
    designs = {name: rng.uniform(*ends, n) for name, ends in ranges.items()}
    options = {} if mechanism in ("planar_4r", "slider_crank") else {"angles": [0.2, 0.7]}
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
        assert_allclose(found[f"{name}_worst_change"], abs(changed).max(axis=1), rtol=OFF, atol=1e-13)
        assert_allclose(found[f"{name}_rss_change"], np.sqrt((changed**2).mean(axis=1)), rtol=OFF, atol=1e-13)
        compared += int(np.isfinite(changed).any())
    assert compared == len(names)


def test_changes_are_made_of_derivatives_whose_status_comes_along():
    for name in ("omega4_max", "theta1_at_omega4_max", "omega4_mean", "omega4"):
        slopes = [f"d_{name}_d_{by}" for by in ("a1", "a2", "a3")]
        found = swept([f"{name}_worst_change", f"{name}_rss_change", *slopes], angles=8)
        terms = [abs(found[s]) * t for s, t in zip(slopes, (1e-4, 2e-4, 1e-3 * 0.8), strict=True)]
        assert_array_equal(found[f"{name}_worst_change"], sum(terms))
        # two magnitudes, each of less than four roundings
        assert_allclose(
            found[f"{name}_rss_change"], np.sqrt(sum(term**2 for term in terms)), rtol=8 * 2.0**-52
        )
        assert found[f"{name}_rss_change"].attrs["units"] == ("rad" if "theta1" in name else "rad s-1")
    # two places tie, the motion has limits
    found = swept(["B_y_min_rss_change", "theta1_at_B_y_min_worst_change"], {"a1_tolerance": 1e-4})
    assert list(found.data_vars)[:3] == [
        "B_y_min_rss_change", "B_y_min_gradient_status", "theta1_at_B_y_min_worst_change",
    ]  # fmt: skip
    stopped = fl.grid(a1=1.0, a2=0.6, a3=0.7, a4=1.2, omega1=1.0, a2_tolerance=1e-4)
    infinite = sweep_4r(stopped, ["omega4_max_worst_change"])
    assert np.isnan(infinite.omega4_max_worst_change).all()
    assert (infinite.omega4_max_gradient_status == 3).all()


def test_changes_scale_with_tolerances_and_have_extremes_over_the_cycle():
    space = fl.grid(DESIGN_CHANGE | {"a2": [1.1, 1.2], "a2_tolerance": [1e-5, 1e-4, 1e-3]})
    names = ["omega4_max_worst_change", "omega4_rms_rss_change", "omega4_rss_change"]
    found = sweep_4r(space, names, angles=4)
    assert found.attrs["scaling_axis"] == "a2_tolerance"
    for k, size in enumerate((1e-5, 1e-4, 1e-3)):
        one = swept(names, {"a2_tolerance": size}, angles=4)
        for name in names:
            assert_allclose(found[name][0, k], one[name], rtol=4 * 2.0**-52)
    # with a second tolerance that stays it does not; the speed still does
    both = fl.grid(DESIGN_CHANGE | {"omega1": [1.0, 2.0], "a1_tolerance": 1e-4, "a2_tolerance": [1e-5, 1e-4]})
    assert sweep_4r(both, names[:1]).attrs["scaling_axis"] == "omega1"
    found = swept(
        ["theta4_worst_change_max", "theta1_at_theta4_worst_change_max", "theta4_worst_change_mean"]
    )
    at = found.theta1_at_theta4_worst_change_max.values
    assert found.theta4_worst_change_max.attrs["extrema"] == "refined"
    curve = swept(["theta4_worst_change"], angles=3600).theta4_worst_change
    # the curve bends by less than three times its greatest value, samples are 0.1 degrees apart
    assert_allclose(found.theta4_worst_change_max, curve.max("theta1"), rtol=1e-5)
    for k in (0, 1):
        given = DESIGN_CHANGE | TOLERANCES | {"theta1": at[k], "branch": k + 1}
        here = fl.evaluate("planar_4r", ["theta4_worst_change"], **given)["theta4_worst_change"]
        assert here == pytest.approx(float(found.theta4_worst_change_max[k]), rel=1e-12)


def test_other_doors_have_them():
    given = DESIGN_CHANGE | TOLERANCES
    del given["a1"], given["a2"]
    both = fl.function("planar_4r", ["a1", "a2"], ["omega4_max_worst_change", "omega4_max"], **given)
    one = swept(["omega4_max_worst_change"], branch=1)
    assert both([0.4, 1.1])[0] == float(one.omega4_max_worst_change)
    by_size = fl.function("planar_4r", ["a1_tolerance"], ["omega4_max_worst_change"], **DESIGN_CHANGE)
    assert by_size([2e-4])[0] == pytest.approx(2 * by_size([1e-4])[0], rel=1e-15)
    found = fl.sweep("planar_4r", one.fastlink.designs, ["omega4_max_worst_change"], branch=1)
    assert found.omega4_max_worst_change.equals(one.omega4_max_worst_change)
    explained = fl.explain("planar_4r", fl.grid(DESIGN_CHANGE | TOLERANCES), ["omega4_max_worst_change"])
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
    fixed = {k: v for k, v in (DESIGN_CHANGE | tolerances).items() if k != "a1"}
    with refused(key, remedy):
        fl.function("planar_4r", ["a1"], ["omega4_max_rss_change"], **fixed)


def test_the_gradient_has_none_by_a_tolerance():
    given = {key: value for key, value in DESIGN_CHANGE.items() if key != "a1"}
    with refused("a1_tolerance", "stays"):
        fl.function("planar_4r", ["a1", "a1_tolerance"], ["omega4_max"], **given).gradient([0.4, 1e-4])


def test_every_input_but_a_code_has_a_tolerance():
    for mechanism in CASES:
        known = catalogue(mechanism)
        of = {name for name, one in known.known_inputs(known.variant_inputs).items() if not one.choices}
        assert {f"{name}_tolerance" for name in of} < known.tolerances.keys()
