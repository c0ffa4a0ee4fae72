"""No extremum hides between the samples of a search: searches of sixteen times as many cells count the same.

A pair of extremes closer together than a cell leaves no sign at the samples. The search divides the cells whose samples
cannot exclude one; here all cells are as small as those that are divided once or twice.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from tests.support.registry import ENTRIES

import fastlink as fl
from fastlink.engine.resolve import _plan
from fastlink.plan.programs import find_extremum_search

#: Half the number of cells of a search that divides none; a power of two.
FINE = 512
#: A design in which two extremes of F41 stand between two samples, beside a third.
MISSED = {
    "a1": 0.8864707860744057,
    "a2": 1.9225578973808017,
    "a3": 2.6924029358619537,
    "a4": 3.728478244413491,
    "omega1": 18.550515413993015,
    "m1": 0.0018364371402731585,
    "I1": 0.5333531266423142,
    "G1_u": 2.0744880738446536,
    "G1_v": 2.4755016543218424,
    "m2": 2.247926956061958,
    "I2": 0.0006353769234236988,
    "G2_u": 1.7016715670747224,
    "G2_v": -0.2310316084531454,
    "m3": 8.579832518555953,
    "I3": 0.015982671751956518,
    "G3_u": 2.167301101251959,
    "G3_v": 0.06640858519244963,
}
#: What may still hide, of all counts: where the gap of a change point is near the rounding of the lengths, one pair of
#: extremes of a curvature in 172,000 counts was seen to, and one of a shaking moment of huge slider-cranks.
MOST_HIDDEN = {"gap 1e-13": 1e-5, "scale 1e20": 1e-5}
#: More extremes than anything has: samples so close show the rounding of a flat function (F_x of the focal crank).
MOST_REAL = 16
GRADED = [entry for entry in ENTRIES if entry.catalogue.graded is not None and not entry.about]


def searched(entry, designs):
    """Return the quantities whose searches divide cells."""
    searches = {
        name: find_extremum_search(entry.catalogue, name, designs, ()) for name in entry.catalogue.public
    }
    return [name for name, search in searches.items() if search is not None and search.divided]


def counted(entry, designs, names, cells, monkeypatch):
    """Count the extremes of quantities (quantity, design, branch), with so many cells if that is not None."""
    with monkeypatch.context() as patch:
        if cells is not None:
            graded = entry.catalogue.graded
            patch.setattr(entry.catalogue, "graded", replace(graded, cells_otherwise=cells))
        _plan.cache_clear()
        asked = [f"{name}_extrema_count" for name in names]
        maps = fl.sweep(
            entry.mechanism, fl.table(designs), asked, input=entry.input, verify=0, allow_invalid=True
        )
    _plan.cache_clear()
    return np.stack([maps[name].transpose("design", ...).values for name in asked])


def designs_of(entry, kind, seed, n):
    """Return designs of a family, without their branches and positions."""
    return {
        name: value for name, value in entry.drawn(kind, seed, n).items() if name in entry.catalogue.inputs
    }


def test_a_pair_of_extremes_between_two_samples_is_found():
    # its places are where the slope at steps of 2^-20 changes sign
    maps = fl.sweep("planar_4r", fl.grid(**MISSED), ["F41_extrema", "F41_min"], branch=1)
    theta1 = np.linspace(2.97, 3.01, 2**12)
    slope = fl.evaluate("planar_4r", ["d_F41_d_theta1"], **MISSED, theta1=theta1)["d_F41_d_theta1"]
    (cells,) = np.nonzero(np.diff(np.sign(slope)))
    places = maps.theta1_at_F41_extrema.values
    inside = places[(places > theta1[0]) & (places < theta1[-1])]
    np.testing.assert_array_equal(np.searchsorted(theta1, inside) - 1, cells)
    assert len(cells) == 3
    least = fl.evaluate("planar_4r", ["F41"], **MISSED, theta1=inside)["F41"].min()
    assert float(maps.F41_min) == pytest.approx(least, rel=2**-48)


def assert_finer_samples_show_no_more(entry, kind, n, names, monkeypatch):
    designs = designs_of(entry, kind, 31, n)
    names = [name for name in searched(entry, designs) if not names or name in names]
    seen, hidden, of = 0, {}, 0
    for start in range(0, len(names), 6):  # a kernel of all takes long to compile
        some = names[start : start + 6]
        counts = counted(entry, designs, some, None, monkeypatch)
        finer = counted(entry, designs, some, FINE, monkeypatch)
        differ = (counts != finer) & (finer <= MOST_REAL)
        hidden |= {
            name: np.argwhere(one).tolist() for name, one in zip(some, differ, strict=True) if one.any()
        }
        seen, of = seen + np.count_nonzero(counts), of + counts.size
    assert seen
    assert sum(map(len, hidden.values())) <= MOST_HIDDEN.get(kind, 0.0) * of, hidden


@pytest.mark.parametrize("entry", GRADED[:1], ids=str)
def test_finer_samples_show_no_more_extremes(entry, monkeypatch):
    assert_finer_samples_show_no_more(entry, "random", 3000, ("curvature", "F32", "T41"), monkeypatch)


def test_extremes_next_to_a_toggle_count_where_the_slope_there_is_no_rounding(monkeypatch):
    """Next to a straight line T_x has an extreme within 2^-24 of the toggle, where its slope is 1e-6 of what it is."""
    (entry,) = (entry for entry in GRADED if str(entry) == "focal sigma")
    designs = designs_of(entry, "line 1e-8", 31, 3000)
    some = {name: values[[1086, 1737, 2057, 2989]] for name, values in designs.items()}
    counts = counted(entry, some, ["T_x"], None, monkeypatch)
    assert (counts == 2).all()
    np.testing.assert_array_equal(counts, counted(entry, some, ["T_x"], FINE, monkeypatch))


@pytest.mark.stress
@pytest.mark.parametrize("entry", GRADED, ids=str)
def test_finer_samples_show_no_more_extremes_of_anything(entry, monkeypatch):
    for kind in entry.families:
        if kind.startswith(("kite", "line 1e-12")):
            continue  # much is constant but for rounding there, whose extremes are not counted alike
        assert_finer_samples_show_no_more(entry, kind, 3000, (), monkeypatch)


@pytest.mark.stress
def test_finer_samples_show_no_more_extremes_of_forces_of_a_million_designs(monkeypatch):
    forces = ("F41", "F21", "F32", "F43", "shaking_force", "T41")
    assert_finer_samples_show_no_more(GRADED[0], "random", 1_000_000, forces, monkeypatch)


def test_designs_in_a_sweep_leave_each_other_alone():
    """A speed that is constant but for rounding has zeros of its slope without end, which once filled all lists."""
    constant = {"a1": 0.0004194733386214631, "a2": 0.4003315786432696, "a3": 0.00041947333862142275}
    constant |= {
        "a4": 0.4003315786432696,
        "P_u": -0.36602983798650074,
        "P_v": 13.846241829606216,
        "omega1": 1.0,
    }
    narrow = {"a1": 1.0881782807647401, "a2": 2.1763565615294802, "a3": 2.5390826551177268}
    narrow |= {
        "a4": 1.4509043743529879,
        "P_u": 2.8528788783126706,
        "P_v": -1782570.0943710102,
        "omega1": -1.0,
    }

    def least(neighbours):
        designs = [constant] * neighbours + [narrow]
        space = fl.table({name: np.array([one[name] for one in designs]) for name in narrow})
        return fl.sweep("planar_4r", space, ["P_speed_min"]).P_speed_min.values[-1]

    alone = least(0)
    np.testing.assert_array_equal(least(40), alone)
    positions = np.linspace(-np.pi, np.pi, 20001)
    curve = fl.evaluate("planar_4r", ["P_speed"], branch=2, theta1=positions, **narrow)["P_speed"]
    assert alone[1] <= np.nanmin(curve)


def test_half_a_range_of_rounding_errors_hides_no_extreme_of_the_other():
    """Where r = l and e = 0 the slider stays at O for half a turn, and its torque is zero but for rounding."""
    design = {
        "r": 8.0,
        "l": 8.0,
        "e": 0.0,
        "omega": 0.5639,
        "m1": 0.0,
        "I1": 0.0,
        "m2": 0.0,
        "I2": 0.84,
        "m3": 0.167,
    }
    design |= {"G1_u": 8.0, "G1_v": 8.0, "G2_u": -4.2, "G2_v": 9.0, "F_load": 179.0}
    most = fl.sweep("slider_crank", fl.grid(**design), ["T41_max"], branch=1).T41_max
    # T41 = 2 r sin(theta) (F + 2 m3 r omega^2 cos(theta)) for half a turn
    theta = np.linspace(0.0, np.pi / 2, 100001)
    load = 179.0 + 2 * 0.167 * 8.0 * 0.5639**2 * np.cos(theta)
    assert float(most) == pytest.approx(np.max(16.0 * np.sin(theta) * load), rel=1e-9)


#: Designs that fold, extremes of which stand within a thousandth of the first cell beside the fold.
BESIDE_A_FOLD = {
    "rate next to a kite": (
        ("alpha4", 2, 2 * np.pi),
        {"a1": 2.0000000004051177, "a2": 7.0, "a3": 7.000000000405118, "a4": 2.0}
        | {"omega1": 5.768333217578596e-06, "alpha1": 0.5},
    ),
    "force, folded at pi": (
        ("shaking_force", 2, np.pi),
        {"a1": 3.0, "a2": 5.0, "a3": 6.0, "a4": 8.0, "m1": 0.49545469965624744, "I1": 10688955.638816047}
        | {"G1_u": -4451.49427479659, "G1_v": 0.11943080395632717, "m2": 0.0, "I2": 2.6266000961826314e-07}
        | {"G2_u": -8.0, "G2_v": -8.0, "m3": 0.8902129862714896, "I3": 0.0, "G3_u": -135569.4092782865}
        | {"G3_v": 3.3003593914815283, "omega1": 0.5, "FP_x": -27938.828850982834, "FP_y": 1.1607883583517378}
        | {"P_u": -4.641592753530091, "P_v": -8.0},
    ),
    "force, folded at 0": (
        ("shaking_force", 2, 0.0),
        {"a1": 3.0, "a2": 4.0, "a3": 6.0, "a4": 1.0, "m1": 1.0874876575139383, "I1": 0.0006047507385917382}
        | {"G1_u": 0.0, "G1_v": 6.0, "m2": 0.9590592842517134, "I2": 0.08545744027758584}
        | {"G2_u": -4.229140115425493, "G2_v": 16271.914252609764, "m3": 0.0, "I3": 4137194.4532086877}
        | {"G3_u": 0.0, "G3_v": 4.355208446092007e-05, "omega1": 1.0},
    ),
    "force of a parallelogram, infinite at the fold": (
        ("F32", 1, 0.0),
        {"a1": 9.0, "a2": 1.0, "a3": 9.0, "a4": 1.0, "m1": 5.945751727884179e-12, "I1": 0.9900953762001505}
        | {"G1_u": -0.0016384888232126612, "G1_v": -315523.2704613257, "m2": 1.0, "I2": 11853992656.703575}
        | {"G2_u": 0.0, "G2_v": 14.913587820756142, "m3": 2.061189046100257, "I3": 0.0}
        | {"G3_u": 0.8712551807810605, "G3_v": 0.0001557138883682065, "omega1": 0.0}
        | {"alpha1": 0.16582383406104487},
    ),
}


@pytest.mark.parametrize("case", BESIDE_A_FOLD)
def test_an_extreme_beside_a_fold_is_found(case):
    """No value is beyond the greatest and the least by more than the bounds of both.

    At each octave of the distance from the fold, down to 1e-12 of a radian.
    """
    (quantity, branch, fold), design = BESIDE_A_FOLD[case]
    ends = [f"{quantity}_{end}{of}" for end in ("max", "min") for of in ("", "_error")]
    found = fl.sweep("planar_4r", fl.grid(**design), ends, branch=branch, verify=0)
    most, above, least, below = (float(found[name]) for name in ends)
    distances = 2.0 ** np.linspace(-40.0, 0.0, 401)
    theta1 = np.concatenate([fold - distances, fold + distances])
    values = fl.evaluate("planar_4r", [quantity, f"{quantity}_error"], branch=branch, theta1=theta1, **design)
    value, error = values[quantity], values[f"{quantity}_error"]
    assert np.isfinite(error).sum() > 400
    told = np.isfinite(value) & np.isfinite(error)
    assert np.all(value[told] - error[told] <= most + above)
    assert np.all(value[told] + error[told] >= least - below)


def test_rounding_errors_beside_a_snapped_change_point_leave_the_list():
    """Two of eight and of eleven entries were extremes, of which the list has room for five."""
    (quantity, _, _), design = BESIDE_A_FOLD["rate next to a kite"]
    names = [f"{quantity}_extrema", f"{quantity}_extrema_count", f"{quantity}_min"]
    found = fl.sweep("planar_4r", fl.grid(**design), names, verify=0)
    listed, counts = found[names[0]].values, found[names[1]].values
    # pairs of spurious ones leave: of an odd number one stays, and so may the greatest of all and what stands beside it
    assert counts[0] <= 4
    assert counts[1] <= 5
    np.testing.assert_array_equal(np.isfinite(listed).sum(axis=-1), counts)
    np.testing.assert_array_equal(np.nanmin(listed, axis=-1), found[names[2]].values)


def test_rounding_errors_beside_the_fold_of_a_kite_are_no_extremes():
    """Forces of a kite stay finite where it folds; their slope is rounding errors over the distance from there."""
    kites = {"a1": [1.5299061143042894, 0.4009099102008036], "a2": [1.9559321078037128, 1.910416264244732]}
    kites |= {"a3": kites["a2"], "a4": kites["a1"]}
    space = fl.table(
        {name: np.array(values) for name, values in kites.items()} | {"omega1": np.full(2, 25.0)}
    )
    bars = fl.round_bar(density=7750.0, radius=0.01)
    counts = fl.sweep("planar_4r", space, ["F32_extrema_count"], links=bars, verify=0).F32_extrema_count
    assert np.all(counts == 0)


def test_a_force_of_links_without_mass_is_finite_at_a_toggle():
    """The crank alone has mass: nothing grows where coupler and output link are in line, and the least is there."""
    design = {"a1": 5.0, "a2": 2.0, "a3": 3.0, "a4": 4.0, "omega1": -0.441125, "gravity_x": -0.032687}
    design |= {"gravity_y": 0.0, "m1": 0.001349, "I1": 1.0, "G1_u": -5.0, "G1_v": 5.0, "m2": 0.0, "m3": 0.0}
    design |= {"I2": 3.8e-05, "I3": 1.680962, "G2_u": 7.0, "G2_v": 5.0, "G3_u": 0.0, "G3_v": 0.0}
    ends = [f"shaking_force_{end}{of}" for end in ("max", "min") for of in ("", "_error")]
    found = fl.sweep("planar_4r", fl.grid(**design), ends, branch=1, verify=0)
    most, above, least, below = (float(found[name]) for name in ends)
    # F = m1 |g - a|, a = omega1^2 |OG1| towards O, over the reachable range
    toggle = np.arccos((5.0**2 + 4.0**2 - (2.0 + 3.0) ** 2) / (2.0 * 5.0 * 4.0))
    theta1 = toggle * np.linspace(-1.0, 1.0, 200001)
    outward = theta1 + 0.75 * np.pi
    pull = 0.441125**2 * np.sqrt(50.0)
    force = 0.001349 * np.hypot(pull * np.cos(outward) - 0.032687, pull * np.sin(outward))
    assert force.max() <= most + above
    assert most == pytest.approx(force.max(), rel=1e-9)
    assert least - below <= force.min()
    assert least == pytest.approx(force.min(), rel=1e-12)


def test_a_limit_at_a_fold_that_has_no_value_is_flagged():
    """T of a focal kite comes to the ground line where it folds, from below; in doubles it has no place there."""
    kite = {"a": 3.0, "b": 6.0, "c": 3.0, "d": 6.0, "lambda_": -0.9999999999995224, "completion": 2.0}
    found = fl.sweep(
        "focal", fl.grid(**kite, omega=1.0), ["T_y_max", "T_y_max_error"], input="sigma", branch=2, verify=0
    )
    # within 1e-13 of the places and 2^-30 of the fold: rounding over the distance
    assert abs(float(found.T_y_max)) < 1e-4
    assert float(found.T_y_max_error) == np.inf


#: A parallelogram with a slight and a great mass: forces of branch 2 are constant but for rounding in one half.
AT_REST = {
    "a1": 9.0,
    "a2": 2.0,
    "a3": 9.0,
    "a4": 2.0,
    "omega1": 0.5,
    "m1": 2.4671355648387943e-07,
    "I1": 0.0,
    "m2": 1.7271844878678653,
    "I2": 0.9867537083850588,
    "m3": 501834486656.10767,
    "I3": 0.0,
    "G1_u": 9.0,
    "G1_v": -0.0006549136337967812,
    "G2_u": 9.0,
    "G2_v": 0.0,
    "G3_u": 15.265182336000926,
    "G3_v": 43421.32110501148,
    "P_u": 0.6000493924319583,
    "P_v": 9911.360095279775,
    "T_load": 1.0,
    "T_load_linear": 1.494155118855378,
    "T_load_quadratic": -1.0,
}


def test_an_extreme_next_to_a_toggle_is_listed_where_the_slope_at_the_toggle_is_rounding():
    """The slope of the last sample was exactly 0, and stood for the zero at 6e-5 from there."""
    design = {"a1": 0.68165602665439, "a2": 1.1857785897052784, "a3": 0.6455817174867152}
    design |= {"a4": 1.221852908872953, "P_u": 0.9839053205308379, "P_v": 1.7795725244785152}
    maps = fl.sweep("planar_4r", fl.grid(**design), ["curvature_extrema", "curvature_extrema_kind"], branch=1)
    places = maps.theta1_at_curvature_extrema.values
    at = int(np.searchsorted(places, 3.7))
    assert maps.curvature_extrema_kind.values[: at + 2].tolist() == [1, -1, 1, -1, 1]
    # exact algebra: 3.7183537875380277, which the slope, uncertain by 2^-53 / x of itself at x = 6e-5, tells to 1e-9
    assert places[at] == pytest.approx(3.7183537875380277, abs=1e-9)


@pytest.mark.parametrize("name", ["F21", "F32", "F41"])
def test_a_half_at_rest_has_no_extreme_and_may_have_the_least_value(name):
    """The least force of branch 2 is in a half in which all else is rounding errors; its place is not sought."""
    ends = [f"{name}_{end}{error}" for end in ("max", "min") for error in ("", "_error")]
    maps = fl.sweep("planar_4r", fl.grid(**AT_REST), ends, branch=2, angles=8, extrema="refined")
    most, above, least, below = (float(maps[end]) for end in ends)
    assert least < 1e6 < 1e18 < most
    for theta in np.linspace(-3.2, 3.2, 40):
        there = fl.evaluate("planar_4r", [name, f"{name}_error"], theta1=theta, branch=2, **AT_REST)
        value, error = float(there[name]), float(there[f"{name}_error"])
        assert least - below - error <= value <= most + above + error


def test_a_toggle_is_no_extreme_of_what_is_finite_there():
    # N along AB hangs on the direction of NB alone, linearly in its cosine: greatest or least at phi = pi, nowhere else
    bars = {"a": 0.9520510301671605, "b": 1.986387252757659, "c": 1.808315185841849, "d": 0.9082143395944786}
    space = fl.grid(**bars, rho=0.3749409009690977, omega=-1.7308643709937686, completion=2)
    maps = fl.sweep("focal", space, ["N_along_AB_extrema_count", "phi_at_N_along_AB_extrema"], verify=0)
    assert (maps.N_along_AB_extrema_count == 1).all()
    assert (abs(maps.phi_at_N_along_AB_extrema[..., 0] - np.pi) < 1e-15).all()
