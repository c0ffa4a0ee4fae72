"""The errors of docs/accuracy.md: of textbook formulas, and of methods that fastlink does not offer."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
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
PAGE = (Path(__file__).parents[2] / "docs" / "accuracy.md").read_text()
NUMBER = r"[\d.e+-]+"


@pytest.fixture(scope="module")
def errors(tmp_path_factory):
    study = tmp_path_factory.mktemp("accuracy") / "study.toml"
    study.write_text(STUDY)
    measured = measure(read_study(study), accuracy.all_methods, designs=6)["error_max"]
    return {
        quantity: measured.sel(quantity=quantity).dropna("way").to_series().to_dict()
        for quantity in ("omega4_max", "transmission_angle")
    }


@pytest.mark.stress
def test_relaxed_kernels_and_scipy_find_the_extremes_of_cranks(errors):
    found = errors["omega4_max"]
    assert found["refined, relaxed"] < SMALL
    assert found["scipy, brentq"] < SMALL


@pytest.mark.stress
def test_single_precision_has_single_errors(errors):
    curves = errors["transmission_angle"]
    assert set(curves) == {"eliminated", "NumPy", "eliminated, relaxed", "NumPy, single precision"}
    assert curves["eliminated, relaxed"] < SMALL
    # a rounding to 24 bits at least, and a condition number of at most 1000
    assert 1e-9 < curves["NumPy, single precision"] < 1e-3


# ---- textbook formulas ----


@pytest.fixture(scope="module")
def textbook_errors():
    return {family: accuracy.errors(family, 200) for family in accuracy.CLOSE}


def test_the_page_has_the_measured_errors(textbook_errors):
    for quantity in accuracy.QUANTITIES:
        (row,) = re.findall(rf"^\| {quantity} \| (.*) \|$", PAGE, flags=re.MULTILINE)
        for family, text in zip(accuracy.CLOSE, row.split(" | "), strict=True):
            printed = [float(number) for number in re.findall(rf"({NUMBER}) \(", text)]
            # The sines and arctangents of another machine's library: a rounding of each, whose median it is.
            np.testing.assert_allclose(
                np.median(textbook_errors[family][quantity], axis=1), printed, rtol=0.5, atol=0.3
            )


def test_the_textbook_loses_digits_with_the_distance_and_fastlink_none(textbook_errors):
    """Next to a toggle or a fold the naive forms subtract squares of lengths that agree to the distance."""
    for quantity in accuracy.QUANTITIES:
        for family in ("gap 1e-8", "gap 1e-15", "toggle 1e-5", "toggle 1e-8"):
            textbook, stable = np.median(textbook_errors[family][quantity], axis=1)
            # theta4 itself has a square-root's sensitivity there: half of the digits.
            assert textbook > (100.0 if quantity == "theta4" else 5e4), (quantity, family)
            # Some twelve operations on factors right to a rounding each, half of their errors cancelling.
            assert stable < 5.0, (quantity, family)


def test_random_linkages_do_well_by_either(textbook_errors):
    assert all(np.median(textbook_errors["random"][quantity]) < 5.0 for quantity in accuracy.QUANTITIES)
