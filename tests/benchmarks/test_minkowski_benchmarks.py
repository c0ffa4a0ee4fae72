"""The baselines of the Minkowskian 4R agree with the engine, so that what is timed is the same."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from benchmarks import minkowski
from fastlink.numerics.compensated import UNIT_ROUNDING


def test_eq3_has_the_same_roots():
    x, theta = minkowski.designs(40), np.linspace(-4.0, 4.0, 57)
    psi, orientation = minkowski.bind(x, theta).arrays
    by_eq3, sign = minkowski.eq3(x, theta)
    np.testing.assert_array_equal(np.isnan(by_eq3), np.isnan(psi))
    np.testing.assert_array_equal(np.nan_to_num(sign), orientation)
    # Of 16 digits eq. (3) loses those of e^(psi + theta): four at most here.
    np.testing.assert_allclose(by_eq3, psi, rtol=0, atol=1e-10)


def test_compiled_eq3_is_eq3():
    x, theta = minkowski.designs(20), np.linspace(-3.0, 3.0, 31)
    psi, orientation = np.empty((20, 2, 31)), np.empty((20, 2, 31), dtype=np.int8)
    minkowski.compiled_eq3(x, np.cosh(theta), np.sinh(theta), psi, orientation)
    by_numpy, sign = minkowski.eq3(x, theta)
    # Two libraries' artanh, of 2 units in the last place each, where y is the same.
    np.testing.assert_allclose(psi, by_numpy, rtol=16 * UNIT_ROUNDING, atol=16 * UNIT_ROUNDING)
    np.testing.assert_array_equal(orientation, np.nan_to_num(sign))


def test_errors_are_measured():
    families = {name: (own, by_eq3) for name, own, by_eq3 in minkowski.errors(4)}
    assert len(families) == len(minkowski.families(1))
    assert max(own for own, _ in families.values()) <= 4.0
    # Where cosh overflows there is no value.
    assert families["theta from 400 to 700"][1] == math.inf
    # The measure tells a wrong value.
    x, theta = next(iter(minkowski.families(4).values()))
    assert minkowski.worst(minkowski.ours(x, theta) + 1e-12, x, theta) > 100.0


def test_the_table_of_the_docs_is_the_one_that_is_measured():
    page = Path(__file__).parents[2].joinpath("docs", "minkowski.md").read_text()
    head, _, *rows = minkowski.error_table(2, rounds=1).splitlines()
    short_repr = page[page.index(head) :].split("\n\n")[0].splitlines()[2:]
    assert len(short_repr) == len(rows)
    for row, measured in zip(short_repr, rows, strict=True):
        (name, own, by_eq3, *times), (of, _, now, *others) = (
            [cell.strip() for cell in line.strip("|").split("|")] for line in (row, measured)
        )
        assert name == of
        assert float(own) <= 4.0
        # What has no value in two configurations has none in a hundred.
        assert by_eq3 == "no value" if now == "no value" else by_eq3 == "no value" or float(by_eq3) > 1.0
        assert len(times) == len(others) == 3
        assert all(float(time) > 0.0 for time in times + others)
