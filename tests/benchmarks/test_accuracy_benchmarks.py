"""The methods of `benchmarks.accuracy` that fastlink does not offer: what errors they have."""

from __future__ import annotations

import pytest

from benchmarks import accuracy
from fastlink.app.accuracy import measure
from fastlink.app.study import read_study
from fastlink.numerics.compensated import UNIT_ROUNDING

STUDY = """
mechanism = "planar_4r"
quantities = ["omega4_max", "transmission_angle"]
design = {a1 = {linspace = [0.3, 0.5, 40]}, a2 = 1.2, a3 = 0.8, a4 = 1.0, omega1 = 25.0}
"""
# What tests/mechanisms/test_precision.py allows, times a condition number of at most 100.
SMALL = 400 * UNIT_ROUNDING


@pytest.fixture(scope="module")
def errors(tmp_path_factory):
    study = tmp_path_factory.mktemp("accuracy") / "study.toml"
    study.write_text(STUDY)
    measured = measure(read_study(study), accuracy.all_methods, designs=6)["error_max"]
    return {
        quantity: measured.sel(quantity=quantity).dropna("way").to_series().to_dict()
        for quantity in ("omega4_max", "transmission_angle")
    }


def test_relaxed_kernels_and_scipy_find_the_extremes_of_cranks(errors):
    found = errors["omega4_max"]
    assert found["refined, relaxed"] < SMALL
    assert found["scipy, brentq"] < SMALL
    # where the slope is flat, the value is right to the square of the tolerance of the place
    assert found["scipy, minimize_scalar"] < SMALL
    assert found["360 angles, relaxed"] == pytest.approx(found["360 angles"], rel=1e-6)


def test_single_precision_has_single_errors(errors):
    curves = errors["transmission_angle"]
    assert set(curves) == {"eliminated", "NumPy", "eliminated, relaxed", "NumPy, single precision"}
    assert curves["eliminated, relaxed"] < SMALL
    # a rounding to 24 bits at least, and a condition number of at most 1000
    assert 1e-9 < curves["NumPy, single precision"] < 1e-3
