"""Lists of extremes beside folds, where a slope in doubles is its own rounding error."""

from __future__ import annotations

import numpy as np
import pytest

import fastlink as fl
from fastlink.codegen.runtime.results import (
    BEST_ROWS,
    COUNT,
    DOUBTFUL,
    GREATEST,
    LEAST,
    LIST_KIND,
    LIST_NOISE,
    LIST_ROWS,
    LIST_THETA,
    LIST_VALUE,
)
from fastlink.codegen.runtime.undecided import thin
from fastlink.mechanisms import catalogue
from fastlink.plan.request import variants_of
from fastlink.precision.stationary import Stationary

#: Near kites that are change points, speeds and accelerations of the crank: beside their folds accelerations of the
#: output link are differences of numbers up to 1e32 times as great, whose rounding once was 2 to 4 entries of a list.
NOISY = np.array(
    [
        (5.000000000000447, 6.0, 6.000000000000447, 5.0, 0.20680010320679912, 0.0),
        (7.000000002915849, 1.0, 1.000000002915849, 7.0, 1.0, 0.0),
        (1.0000000091700842, 4.0, 4.000000009170084, 1.0, 1.0, 0.0),
        (4.0000000000000275, 7.0, 7.0000000000000275, 4.0, 51.55708830532486, 0.5),
    ]
)


def test_lists_beside_folds_hold_what_fifty_digits_show():
    designs = dict(zip(("a1", "a2", "a3", "a4", "omega1", "alpha1"), NOISY.T, strict=True))
    names = ["alpha4_extrema_kind", "theta1_at_alpha4_extrema", "alpha4_extrema_count"]
    found = fl.sweep("planar_4r", fl.table(designs), names, verify=0)
    of, n = catalogue("planar_4r"), len(NOISY)
    for branch in (1, 2):
        known = variants_of(of, None, "eliminated", designs)
        reference = Stationary(of, "alpha4", designs, np.full(n, float(branch)), known, zeroes=True)
        here = found.sel(branch=branch)
        for k, candidates in enumerate(reference.candidates):
            exact = sorted((reference.angle(k, one), one.kind) for one in candidates if one.kind in (1, -1))
            kinds = here["alpha4_extrema_kind"].values[k, : len(exact)].tolist()
            assert here["alpha4_extrema_count"].values[k] == len(exact)
            assert kinds == [kind for _, kind in exact]


def listed(*entries):
    """Return lists of one column with room for eight, and the greatest and least values beside."""
    lists, best = np.full((LIST_ROWS, 1, 8), np.nan), np.zeros((BEST_ROWS, 1))
    for k, (value, kind, doubt) in enumerate(entries):
        lists[[LIST_THETA, LIST_VALUE, LIST_KIND, LIST_NOISE], 0, k] = k, value, kind, doubt
    best[[GREATEST, LEAST, COUNT], 0] = 100.0, -100.0, len(entries)
    return lists, best


@pytest.mark.parametrize(
    ("entries", "stay"),
    [
        ("+5 -1 +5 -1", [0, 1, 2, 3]),  # all are certain
        ("+5 -1? +3? -1", [0, 3]),  # none between a maximum and a minimum
        ("+5 -1? +3? -0? +5 -2", [0, 3, 4, 5]),  # one between two maxima, the least
        ("-1? +5 -2 +5 -0?", [1, 2, 3, 4]),  # the turn goes on
        ("+5? -1? +5?", []),  # nothing but rounding
        ("+5? -1 +4?", [0, 1]),  # one of each kind: a turn ends where it begins
    ],
)
def test_of_doubtful_entries_one_stays_between_two_of_a_kind(entries, stay):
    kinds = {"+": 1.0, "-": -1.0}
    told = [(float(e[1]), kinds[e[0]], DOUBTFUL if "?" in e else 0.0) for e in entries.split()]
    lists, best = listed(*told)
    thin(lists, best, 0, 1, 8)
    assert lists[LIST_THETA, 0, : len(stay)].tolist() == stay
    assert np.isnan(lists[LIST_THETA, 0, len(stay) :]).all()
    assert best[COUNT, 0] == len(stay)
