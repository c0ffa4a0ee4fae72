"""`T_deviation`, which is made of whole curves: by both drives, in blocks, files and studies, and where it is not."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_array_equal
from tests.support.focal_configurations import DRIVES, random_designs

import fastlink as fl
from fastlink.errors import InputError
from fastlink.io import writer as store
from fastlink.precision.reference import CONTEXT as MP
from fastlink.precision.reference import UNIT

CHEBYSHEV = {"a": 5.0, "b": 5.0, "c": 2.0, "d": 4.0}
DESIGNS = random_designs(np.random.default_rng(12), 150)
del DESIGNS["branch"], DESIGNS["completion"]
ANGLES = np.sort(np.random.default_rng(13).uniform(-3.0, 3.0, 50))


def sweep(names, drive, **options):
    return fl.sweep("focal", fl.table(DESIGNS), names, input=drive, **{drive: ANGLES}, **options)


@pytest.mark.parametrize("drive", DRIVES)
def test_it_is_the_distance_from_the_line_that_fits_T(drive):
    found = sweep(["T_x", "T_deviation", "T_y", "T_y_max"], drive)
    line = fl.focal.straight_line(found.T_x.values, found.T_y.values)
    assert_array_equal(found.T_deviation, line.deviation)
    assert found.T_deviation.dims == found.T_x.dims == ("design", "completion", "branch", drive)
    missing = np.isnan(found.T_x.values)
    assert_array_equal(np.isnan(found.T_deviation), missing)
    # T there along all of a path, along a part, nowhere
    assert {0, ANGLES.size} < set(missing.sum(axis=-1).ravel())
    # alone, and in any blocks and threads: the same bits
    for options in ({}, {"block": 1, "threads": 1}, {"block": 7, "threads": 2}):
        assert_array_equal(sweep(["T_deviation"], drive, **options).T_deviation, line.deviation)


@pytest.mark.parametrize("drive", DRIVES)
def test_it_is_exact_for_the_places_of_T(drive):
    found = sweep(["T_x", "T_y", "T_deviation"], drive)
    paths = [found[name].values.reshape(-1, ANGLES.size) for name in ("T_x", "T_y", "T_deviation")]
    chosen = np.flatnonzero(np.isfinite(paths[0]).sum(axis=-1) > 2)[:40]
    assert chosen.size == 40
    for row in chosen:
        there = np.isfinite(paths[0][row])
        x, y = ([MP.mpf(value) for value in path[row][there]] for path in paths[:2])
        along, across = ([value - sum(values) / len(values) for value in values] for values in (x, y))
        squares = sum(p * p - q * q for p, q in zip(along, across, strict=True))
        products = 2 * sum(p * q for p, q in zip(along, across, strict=True))
        half = MP.atan2(products, squares) / 2
        exact = [q * MP.cos(half) - p * MP.sin(half) for p, q in zip(along, across, strict=True)]
        # Sums of up to 50: in each of 8 lanes 6 roundings, then 3; so the middle has 10 of the size of the path. The
        # direction has as many of all squares over those that tell along from across, and 5 of its functions.
        size = max(abs(value) for value in (*x, *y))
        spread = sum(p * p + q * q for p, q in zip(along, across, strict=True))
        bound = UNIT * size * (20 + 40 * spread / MP.hypot(squares, products))
        errors = [abs(a - b) for a, b in zip(paths[2][row][there], exact, strict=True)]
        assert max(errors) <= bound


def test_an_axis_that_only_scales_is_spread():
    one = fl.grid(**CHEBYSHEV, rho=[0.5, 1.0], omega=[1.0, 2.0, 3.0])
    found = fl.sweep("focal", one, ["T_deviation", "phi_rate"], input="sigma", sigma=40)
    assert found.attrs["scaling_axis"] == "omega"
    alone = fl.sweep("focal", fl.grid(**CHEBYSHEV, rho=[0.5, 1.0]), ["T_deviation"], input="sigma", sigma=40)
    for k in range(3):
        assert_array_equal(found.T_deviation.isel(omega=k), alone.T_deviation)


def test_a_file_holds_it_after_an_interruption_too(tmp_path, monkeypatch):
    options = {"block": 8, "threads": 1, "to": tmp_path / "map.h5"}
    record = store.Writer.record

    def interrupted(self, start, stop):
        record(self, start, stop)
        if stop == 40:
            raise KeyboardInterrupt

    with monkeypatch.context() as patched:
        patched.setattr(store.Writer, "record", interrupted)
        with pytest.raises(KeyboardInterrupt):
            sweep(["T_deviation"], "phi", **options)
    with sweep(["T_deviation"], "phi", **options) as found:
        assert found.attrs["designs_of_earlier_runs"] == 40
        # no position says what it is, so 50 digits of single ones do not either
        assert found.attrs["verify_left_out"] == "T_deviation"
        assert found.attrs["verify_mismatches"] == 0
        assert_array_equal(found.T_deviation, sweep(["T_deviation"], "phi").T_deviation)


def test_a_study_has_it_and_explain_tells_what_of(tmp_path):
    place = tmp_path / "study.toml"
    place.write_text(
        'mechanism = "focal"\nquantities = ["T_deviation"]\n'
        "design = {a = 5.0, b = 5.0, c = 2.0, d = 4.0, rho = 1.0, completion = 1}\n"
        'cycle = {input = "sigma", sigma = 90}\n'
    )
    told = fl.explain(place)
    gives, facts, loops, text = told.kernels[-1]
    assert gives == "T_deviation; by NumPy, of whole curves of T_x, T_y"
    assert facts[-1] == "T_deviation"
    assert "design and sigma" in [loop.per for loop in loops]
    assert "def kernel" in text
    assert "def fitted_line" in text
    assert {"T_deviation", "T_x", "T_y"}.isdisjoint(told.left_out)
    with fl.run_study(place, to=tmp_path / "map.h5") as found:
        # Chebyshev's linkage, about the line y = const by symmetry
        turn = np.arange(90) * (2.0 * np.pi / 90)
        path = fl.evaluate("focal", "T_y", input="sigma", sigma=turn, rho=1.0, completion=1, **CHEBYSHEV)[
            "T_y"
        ]
        # the bound above: the path is within 6 of the origin, and all squares at most twice what tells its direction
        assert np.abs(found.T_deviation.isel(branch=0) - (path - path.mean())).max() <= 6.0 * 100 * UNIT


@pytest.mark.parametrize("drive", DRIVES)
@pytest.mark.parametrize(
    "name",
    [
        *("T_deviation_max", "{}_at_T_deviation_min", "T_deviation_mean", "T_deviation_extrema"),
        *(
            "d_T_deviation_d_a",
            "d_T_deviation_d_{}",
            "T_deviation_error",
            "T_deviation_trust",
            "T_deviation_max_error",
        ),
    ],
)
def test_what_is_not_there_is_told(drive, name):
    name = name.format(drive)
    told = f"quantity '{name}': T_deviation is made of whole curves, .*; ask for T_deviation, and take"
    with pytest.raises(InputError, match=told):
        sweep([name], drive)
    with pytest.raises(InputError, match=told):
        fl.evaluate("focal", name, input=drive, **CHEBYSHEV, rho=1.0, **{drive: 1.0})


def test_evaluate_and_repeated_names_are_told():
    with pytest.raises(
        InputError, match=r"evaluate: T_deviation is made of whole curves, .*; ask fastlink.sweep"
    ):
        fl.evaluate("focal", ["T_deviation"], phi=1.0, rho=1.0, **CHEBYSHEV)
    with pytest.raises(InputError, match="'T_deviation' is named twice"):
        sweep(["T_deviation", "T_deviation"], "phi")
    with pytest.raises(InputError, match="'T_y_max' is named twice"):
        fl.sweep("focal", fl.grid(**CHEBYSHEV, rho=1.0), ["T_y_max", "T_y_max"])
    with pytest.raises(InputError, match="did you mean 'T_deviation'"):
        sweep(["T_deviatio"], "sigma")
