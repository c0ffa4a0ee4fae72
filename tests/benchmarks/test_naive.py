"""The table of naive and stable forms in docs/accuracy.md is what `benchmarks.naive` finds."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from benchmarks import naive

PAGE = (Path(__file__).parents[2] / "docs" / "accuracy.md").read_text()
NUMBER = r"[\d.e+-]+"


@pytest.fixture(scope="module")
def errors():
    return {family: naive.errors(family, 200) for family in naive.FAMILIES}


def test_the_page_has_the_measured_errors(errors):
    for quantity in naive.QUANTITIES:
        (row,) = re.findall(rf"^\| {quantity} \| (.*) \|$", PAGE, flags=re.MULTILINE)
        for family, text in zip(naive.FAMILIES, row.split(" | "), strict=True):
            printed = [float(number) for number in re.findall(rf"({NUMBER}) \(", text)]
            # The sines and arctangents of another machine's library: a rounding of each, whose median it is.
            np.testing.assert_allclose(
                np.median(errors[family][quantity], axis=1), printed, rtol=0.5, atol=0.3
            )


def test_the_textbook_loses_digits_with_the_distance_and_fastlink_none(errors):
    """Next to a toggle or a fold the naive forms subtract squares of lengths that agree to the distance."""
    for quantity in naive.QUANTITIES:
        for family in ("gap 1e-8", "gap 1e-15", "toggle 1e-5", "toggle 1e-8"):
            textbook, stable = np.median(errors[family][quantity], axis=1)
            # theta4 itself has a square-root's sensitivity there: half of the digits.
            assert textbook > (100.0 if quantity == "theta4" else 5e4), (quantity, family)
            # Some twelve operations on factors right to a rounding each, half of their errors cancelling.
            assert stable < 5.0, (quantity, family)


def test_random_linkages_do_well_by_either(errors):
    assert all(np.median(errors["random"][quantity]) < 5.0 for quantity in naive.QUANTITIES)
