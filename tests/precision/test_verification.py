"""What a sweep says of its own errors: right where it is right, and not silent where it is not."""

from functools import partial
from importlib import import_module

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from tests.support.configurations import PLANAR, masses_and_points, numbers
from tests.support.hart_configurations import WUNDERLICH
from tests.support.precision import in_every_mode, plain, wrong
from tests.support.registry import ENTRIES
from tests.support.sweeps import BARS, CRANK, sweep_4r
from typer.testing import CliRunner

import fastlink as fl
from fastlink.app.cli import app
from fastlink.mechanisms import catalogue
from fastlink.numerics.compensated import UNIT_ROUNDING
from fastlink.precision import Verification
from fastlink.precision.errors import outermost
from fastlink.precision.reference import CONTEXT, HighPrecision
from fastlink.precision.stationary import Stationary, side_of, turning_cells

# What tests/mechanisms/test_precision.py allows of every quantity.
ROUNDINGS = 4
LENGTHS = {"a1": (0.2, 1.8), "a2": (0.3, 2.0), "a3": (0.3, 2.0), "a4": (0.3, 2.0)}


def errors(maps):
    """Return by variable the largest error in roundings, where one was measured."""
    return {
        str(name): float(array.attrs["error_max_roundings"])
        for name, array in maps.data_vars.items()
        if "error_max_roundings" in array.attrs
    }


def assert_right(maps, names):
    found = errors(maps)
    assert set(names) <= set(found)
    assert max(found.values()) <= ROUNDINGS
    assert maps.attrs["verify_mismatches"] == 0
    assert "verify_failed" not in maps.attrs


def test_every_kind_of_result_is_measured():
    space = fl.sobol(40, seed=3, **LENGTHS, omega1=25.0)
    names = ["theta4", "theta1_low", "omega4_max", "theta1_at_omega4_max", "omega4_extrema"]
    maps = sweep_4r(space, [*names, "omega4_rms", "loop_residual"], theta1=24, verify=12)
    assert_right(maps, [*names, "theta1_at_omega4_extrema", "omega4_rms"])
    assert maps.verified_designs == 12
    assert maps.attrs["verify_left_out"] == "loop_residual"  # it is an error itself
    for code in ("status", "omega4_extrema_count", "omega4_extrema_kind"):
        assert maps[code].attrs["verified_values"] > 0
        assert "error_max_relative" not in maps[code].attrs
    assert maps.omega4_max.attrs["error_max_relative"] < 1e-13
    assert maps.omega4_max.attrs["error_median_relative"] < 4 * UNIT_ROUNDING


@pytest.mark.parametrize("options", [{}, {"solver": "dense"}, {"extrema": "sampled"}])
def test_forces_by_every_solver(options):
    space = fl.sobol(16, seed=4, **LENGTHS, omega1=25.0)
    names = ["T41_max", "T41_mean"]
    maps = sweep_4r(space, names, links=BARS, theta1=12, verify=8, **options)
    # LU of the 9x9 has 4 times the error (tests/mechanisms/test_precision.py)
    assert maps.attrs["verify_mismatches"] == 0
    assert set(names) <= set(errors(maps))
    assert max(errors(maps).values()) <= 4 * ROUNDINGS


def test_a_file_states_its_errors_and_the_summary_shows_them(tmp_path):
    """All designs of a small sweep, those in memory on request; without a warning where a bound divides by zero."""
    maps = sweep_4r(fl.grid(**CRANK), ["theta4"], theta1=8)
    assert not [name for name in {**maps.attrs, **maps.theta4.attrs} if "verif" in name or "error" in name]
    maps = sweep_4r(fl.grid(**CRANK | {"a2": 1.4}), ["theta4", "swing"], theta1=8, verify=64)
    assert (maps.verified_designs, maps.theta4.attrs["verified_values"]) == (1, 4)
    assert maps.attrs["verify_mismatches"] == 0
    with sweep_4r(fl.grid(**CRANK), ["theta4"], theta1=8, to=tmp_path / "m.h5") as maps:
        assert maps.theta4.attrs["error_max_roundings"] <= ROUNDINGS
        assert maps.attrs["verify_seed"] == 0
        assert maps.attrs["verify_time_s"] > 0.0
        lines = [line for line in maps.fastlink.summary().splitlines() if line.startswith("largest error")]
    assert len(lines) == 1
    assert "theta4" in lines[0]
    assert "roundings, of 4" in lines[0]
    with sweep_4r(fl.grid(**CRANK), ["theta4"], theta1=8, verify=0, to=tmp_path / "n.h5") as maps:
        assert "verified_designs" not in maps.attrs


def test_the_same_designs_give_the_same_errors_and_bits_do_not_depend_on_them():
    space = fl.sobol(64, seed=5, **LENGTHS, omega1=25.0)
    first, second = (sweep_4r(space, ["omega4_max"], verify=10, block=b) for b in (None, 7))
    assert errors(first) == errors(second)
    without = sweep_4r(space, ["omega4_max"])
    assert_array_equal(first.omega4_max, without.omega4_max)


def spoil(monkeypatch, change):
    """Let sweeps verify results that are not what they have found."""

    class Spoiled(Verification):
        def collect(self, start, stop, arrays):
            spoiled = [change(array) if array.dtype == np.float64 else array + 1 for array in arrays]
            super().collect(start, stop, spoiled)

    monkeypatch.setattr(import_module("fastlink.engine.sweep"), "Verification", Spoiled)


@pytest.mark.parametrize("name", ["theta4", "omega4_max", "omega4_rms", "omega4_extrema"])
def test_a_wrong_digit_is_seen_and_a_missing_value_is_a_mismatch(monkeypatch, name):
    space = fl.grid(**CRANK, omega1=25.0)
    spoil(monkeypatch, lambda array: array * (1.0 + 1e-9))
    with pytest.warns(fl.InputWarning, match=rf"{name} is wrong in \d of \d+ values, by .* NAME_error"):
        maps = sweep_4r(space, [name], theta1=12, verify=4)
    assert maps[name].attrs["error_max_relative"] == pytest.approx(1e-9, rel=1e-5)
    assert maps.status.attrs["verify_mismatches"] > 0  # the code is another
    spoil(monkeypatch, lambda array: np.full_like(array, np.nan))
    with pytest.warns(fl.InputWarning, match=f"{name} is wrong"):
        maps = sweep_4r(space, [name], theta1=12, verify=4)
    assert maps[name].attrs["verify_mismatches"] > 0
    assert "NOT AS WITH 50 DIGITS" in maps.fastlink.summary()


def test_a_value_that_is_wrong_by_more_than_its_bound_is_a_mismatch(monkeypatch):
    spoil(monkeypatch, lambda array: array * (1.0 + 1e-12))
    with pytest.warns(fl.InputWarning, match="is wrong in"):
        maps = sweep_4r(fl.grid(**CRANK, omega1=25.0), ["theta4", "omega4"], theta1=12, verify=4)
    for name in ("theta4", "omega4"):
        assert maps[name].attrs["verify_mismatches"] == maps[name].attrs["verified_values"]


def test_every_door_warns_of_what_is_wrong(monkeypatch, tmp_path):
    """In memory, in a file, where that is there already, in a search and its file, joined, and with a status."""
    spoil(monkeypatch, lambda array: array * (1.0 + 1e-9))
    space, path = fl.grid(**CRANK | {"a2": [1.2, 1.3]}, omega1=25.0), tmp_path / "m.h5"
    sweep = partial(fl.sweep, "planar_4r", space, ["omega4_max"])
    search = partial(fl.search, "planar_4r", space, minimise="omega4_max", verify=2, refine=False)
    parts = [tmp_path / f"m.part-{k}-of-2.h5" for k in (1, 2)]
    text = "mechanism = 'planar_4r'\nquantities = ['omega4_max']\n[design]\na1 = 0.4\na2 = 1.2\na3 = 0.8\n"
    (tmp_path / "study.toml").write_text(f"{text}a4 = 1.0\nomega1 = 25.0\n")
    for door in (
        lambda: sweep(verify=2),
        lambda: sweep(to=path),
        lambda: sweep(to=path),
        lambda: search(),
        lambda: search(to=tmp_path / "s.h5"),
        lambda: search(to=tmp_path / "s.h5"),
        *(partial(sweep, part=(k, 2), to=parts[k - 1]) for k in (1, 2)),
        lambda: fl.join(parts, to=tmp_path / "j.h5"),
        lambda: fl.run(tmp_path / "study.toml", to=tmp_path / "r.h5"),
    ):
        with pytest.warns(fl.InputWarning, match=r"omega4_max is wrong in .* by up to .*e\+06 roundings"):
            door().close()
    done = CliRunner().invoke(
        app, ["run", str(tmp_path / "study.toml"), "--to", str(tmp_path / "c.h5"), "--quiet"]
    )
    assert done.exit_code == 1
    assert done.stderr.startswith("fastlink: omega4_max is wrong in 1 of 1 values")


def test_what_fails_or_is_interrupted_leaves_the_file(monkeypatch, tmp_path):
    def fail(self):
        raise ZeroDivisionError("of all things")

    monkeypatch.setattr(Verification, "_groups_with_results", fail)
    with pytest.warns(fl.InputWarning, match="not known: .* ZeroDivisionError"):
        maps = sweep_4r(fl.grid(**CRANK), ["theta4"], theta1=8, to=tmp_path / "m.h5")
    with maps:
        assert maps.attrs["verify_failed"] == "ZeroDivisionError: of all things"
        assert "errors" in maps.fastlink.summary()

    def interrupt(self):
        raise KeyboardInterrupt

    monkeypatch.setattr(Verification, "_groups_with_results", interrupt)
    with pytest.raises(KeyboardInterrupt) as caught:
        sweep_4r(fl.grid(**CRANK), ["theta4"], theta1=8, to=tmp_path / "n.h5")
    assert "100% of the designs are kept" in caught.value.__notes__[0]
    monkeypatch.undo()
    with sweep_4r(fl.grid(**CRANK), ["theta4"], theta1=8, to=tmp_path / "n.h5") as maps:
        assert maps.attrs["designs_of_earlier_runs"] == maps.attrs["designs"]
        assert "error_max_relative" in maps.theta4.attrs


#: Of Wunderlich's linkage, which in branch 1 is a folded kite for phi < pi: F stands still at M.
VANISHING = ["F_y", "B_x", "B_y", "dF_y_dphi", "dpsi_dphi", "omega_angle", "psi"]


def test_vanishing_values_are_measured_against_the_lengths_and_mismatches_where_they_should_vanish(
    monkeypatch,
):
    kites = {name: WUNDERLICH[name] * np.arange(1.0, 33.0) for name in ("m", "n", "d")} | {
        "kappa": np.full(32, 0.5)
    }
    maps = fl.sweep("hart", fl.table(kites), VANISHING, phi=np.linspace(0.3, 2.8, 40), branch=1, verify=32)
    assert_right(maps, VANISHING)
    assert maps.F_y.attrs["error_max_relative"] > 0.0
    for name in VANISHING:  # at most 4 roundings of the value, or of the power of two near the longest bar
        assert maps[name].attrs["error_max_relative"] <= 4 * UNIT_ROUNDING * 8, name
    spoil(monkeypatch, lambda array: array + 1e-12)
    with pytest.warns(fl.InputWarning, match="F_y"):
        maps = fl.sweep(
            "hart", fl.grid(**WUNDERLICH), ["F_y", "B_y"], phi=np.linspace(0.3, 2.8, 40), branch=1, verify=1
        )
    for name in ("F_y", "B_y"):
        assert maps[name].attrs["verify_mismatches"] == maps[name].attrs["verified_values"]
        assert maps[name].attrs["error_max_roundings"] > 100
    assert "NOT AS WITH 50 DIGITS" in maps.fastlink.summary()


def test_division_by_zero_and_choices_are_as_in_doubles():
    """At the fold of a change point rates are NaN; a massless link has no torque."""
    folded = {"a1": 0.5, "a2": 1.0, "a3": 0.5, "a4": 1.0, "omega1": 1.0, "theta1": 0.0, "branch": 1}
    found = HighPrecision(PLANAR, ["omega4", "status"], folded).at(folded)
    assert CONTEXT.isnan(found["omega4"])
    assert (
        found["status"] == sweep_4r(fl.grid(**CRANK | {"a1": 0.5, "a2": 1.0, "a3": 0.5}), ["status"]).status
    )


def test_studies_say_how_many_designs_are_verified(folder):
    study = """
mechanism = "planar_4r"
quantities = ["theta4"]
design = {a1 = 0.4, a2 = {values = [1.0, 1.1, 1.2]}, a3 = 0.8, a4 = 1.0}
cycle = {theta1 = 8}
output = {verify = VERIFY}
"""
    place = folder / "study.toml"
    place.write_text(study.replace("VERIFY", "2"))
    with fl.run(place) as maps:
        assert maps.verified_designs == 2
    with fl.run(place, overwrite=True, verify=0) as maps:
        assert "verified_designs" not in maps.attrs
    place.write_text(study.replace("VERIFY", "-1"))
    with pytest.raises(fl.InputError, match=r"output.verify is -1; write how many designs to compute again"):
        fl.run(place, overwrite=True)


# == Extremes at folds, where a slope in doubles is its own rounding error: of the reference, and lists of kernels


def inner(quantity, designs, branch, variants=()):
    """Return the stationary extremes of each design by the reference, and the reference."""
    n = designs["a1"].size
    found = Stationary(PLANAR, quantity, designs, np.full(n, float(branch)), variants)
    return [[one for one in each if one.kind in (1, -1)] for each in found.candidates], found


@pytest.mark.parametrize(
    ("doubles", "exact", "finer", "side"),
    [
        (2.0, "2", "2", 1.0),
        (-1e-3, "1e-9", "1e-9", 1.0),  # doubles have the wrong sign
        (1e-3, "1e-36", "1e-60", 0.0),  # noise
        (1e-30, "1e-100", "-1e-137", 0.0),  # a product of two errors
        (0.0, "1e-49", "-1e-99", 0.0),
        (0.0, "-1e-49", "-1e-49", -1.0),  # tiny, but known
        (0.0, "0", "0", 0.0),
        (1.0, "nan", "nan", 1.0),
        (np.inf, "1", "1", 1.0),
    ],
)
def test_the_sign_of_a_slope_is_that_of_as_many_digits_as_it_takes(doubles, exact, finer, side):
    def slope():
        return CONTEXT.mpf(exact if CONTEXT.dps == 50 else finer)

    assert side_of(doubles, slope) == side


def test_only_true_changes_of_sign_are_cells_with_an_extreme():
    rng = np.random.default_rng(1)
    true = np.where(np.arange(20) < 13, 1.0, -1.0) * np.ones((1, 2, 1))
    true[:, 1] = true[:, 0, ::-1]
    true[:, :, [0, -1]] = 1.0, -1.0  # both ends are counted from one position
    noisy = true.copy()
    noisy[0, 0, 2:9] = rng.choice([-1.0, 0.0, 1.0], 7)
    turning, signs = turning_cells(noisy, np.zeros((1, 2, 19), bool), lambda *at: true[at])
    assert_array_equal(turning, true[..., 1:] != true[..., :-1])
    assert (signs[turning.nonzero()] == true[turning.nonzero()]).all()


def test_noise_of_a_slope_at_a_fold_is_no_extreme():
    """Forces of 7, 11, 8, 4 without weights only rise or fall over the turn: the list of kernels is empty, too."""
    designs = {name: np.array([value]) for name, value in zip(LENGTHS, (7.0, 11.0, 8.0, 4.0), strict=True)}
    bars = {"density": np.array([7750.0]), "radius": np.array([0.01]), "omega1": np.ones(1)}
    for branch in (1, 2):
        assert inner("F32", designs | bars, branch, ("round_bar",))[0] == [[]]
    listed = sweep_4r(fl.grid(**designs, omega1=1.0), ["F32_extrema"], links=BARS, verify=1)
    assert np.isnan(listed["F32_extrema"]).all()
    assert listed.attrs["verify_mismatches"] == 0


@pytest.mark.stress
def test_lists_leave_out_rounding_errors_where_a_kite_or_parallelogram_rests():
    """A crank that turns its coupler alone, or its output at its own speed, needs no torque: 0 has no extremes."""
    rng = np.random.default_rng(7)
    lengths = np.array([(9, 9, 7, 7), (2, 4, 2, 4)], float)
    designs = dict(zip(LENGTHS, lengths.T, strict=True)) | masses_and_points(rng, 2)
    names = ["T41_extrema_count", "T41_extrema", "shaking_force_extrema_count"]
    found = sweep_4r(fl.table(designs), names)
    for branch in (1, 2):
        for name in ("T41", "shaking_force"):
            exact = inner(name, designs, branch)[0]
            count = found.sel(branch=branch)[f"{name}_extrema_count"]
            assert_array_equal(count, [len(each) for each in exact])
    listed = found["T41_extrema"].values
    assert (abs(listed[np.isfinite(listed)]) > 1e-3).all()


def test_an_end_of_the_range_is_a_limit_to_more_digits_than_doubles_have():
    """B of Hart's linkage with kappa = 1 + 1e-15 is at 1e-30 of the lengths there, and its slope 1e15 times that."""
    design = numbers("m=1.3828348684464724 n=1.851684481372127 d=4.386786496711176 kappa=1.000000000000001")
    found = fl.sweep("hart", fl.grid(**design), ["B_y_max", "B_y_max_error"], branch=1)
    columns = {name: np.array([value]) for name, value in design.items()}
    reference = Stationary(catalogue("hart"), "B_y", columns, np.ones(1))
    greatest = outermost(reference, 0, 1, of_all=True)
    assert abs(CONTEXT.mpf(float(found["B_y_max"])) - greatest.value) <= float(found["B_y_max_error"])
    assert float(found["B_y_max_error"]) < 1e-14 * float(found["B_y_max"]) < 1e-43


# == Positions from the least to the greatest double are held to a few roundings, as all others ==============

#: Angles are periodic, to the last double; the rapidities of the Minkowskian plane are not.
ANGLES = (0.0, 1e-300, 1e-160, -1e-8, np.pi / 2, -np.pi / 2, 2e6 * np.pi, 1e22, 1.7e308)
RAPIDITIES = (0.0, 1e-300, 1e-160, -1e-8, 30.0, -150.0, 350.0)
TURNED = [
    entry
    for entry in ENTRIES
    if entry.moves and entry.solver == "eliminated" and entry.catalogue.position.units != "m"
]


@pytest.mark.sample(5)
@pytest.mark.parametrize("entry", TURNED, ids=str)
def test_any_position_has_the_digits_of_others(entry):
    names = tuple(name for name in entry.names if name != "v1_ddot")  # beyond doubles next to its pole at 0
    positions = np.array(RAPIDITIES if entry.mechanism == "minkowski_4r" else ANGLES)
    inputs = in_every_mode(entry, entry.drawn("random", 5, positions.size) | {entry.input: positions})
    with np.errstate(all="ignore"):
        found, least, zero = (
            plain(entry, names, inputs | at)
            for at in ({}, *({entry.input: np.full(inputs["branch"].size, x)} for x in (5e-324, 0.0)))
        )
    too_far_off, numbers = wrong(entry, names, inputs, found)
    assert not too_far_off
    assert numbers > positions.size * len(names) // 8
    for name in names:  # of products with the least position no digit is left; and pi is -pi
        assert_allclose(abs(least[name]), abs(zero[name]), rtol=0, atol=1e-300, err_msg=name)
