"""Extremes at folds, where a slope in doubles is its own rounding error: of the reference, and lists of kernels."""

import numpy as np
import pytest
from tests.support.configurations import masses_and_points
from tests.support.precision import in_every_mode, plain, wrong
from tests.support.registry import ENTRIES
from tests.support.sweeps import sweep_4r

import fastlink as fl
from fastlink.mechanisms import catalogue
from fastlink.precision.errors import outermost
from fastlink.precision.reference import CONTEXT
from fastlink.precision.stationary import Stationary, side_of, turning_cells

LENGTHS = ("a1", "a2", "a3", "a4")
PLANAR = catalogue("planar_4r")
BARS = fl.round_bar(density=7750.0, radius=0.01)


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
    np.testing.assert_array_equal(turning, true[..., 1:] != true[..., :-1])
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
            np.testing.assert_array_equal(count, [len(each) for each in exact])
    listed = found["T41_extrema"].values
    assert (abs(listed[np.isfinite(listed)]) > 1e-3).all()


def test_an_end_of_the_range_is_a_limit_to_more_digits_than_doubles_have():
    """B of Hart's linkage with kappa = 1 + 1e-15 is at 1e-30 of the lengths there, and its slope 1e15 times that."""
    design = {
        "m": 1.3828348684464724,
        "n": 1.851684481372127,
        "d": 4.386786496711176,
        "kappa": 1.000000000000001,
    }
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
        np.testing.assert_allclose(abs(least[name]), abs(zero[name]), rtol=0, atol=1e-300, err_msg=name)
