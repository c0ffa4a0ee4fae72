"""A result has the same bits whatever else is requested: extremes, lists of them, means, derivatives, error bounds.

Kernels share samples, arrays and lists between all that is requested. Next to folds, where rounding errors fill lists,
each part of that is used to its end.
"""

from __future__ import annotations

import numpy as np
import pytest
from tests.support.extrema_errors import designs_of, searched
from tests.support.neighbourhoods import folded_planar_4r
from tests.support.registry import ENTRIES

import fastlink as fl

#: Lists beside folds that once hung on what else was requested: alpha4 had 20 or 14 entries in branch 2, by the longest
#: list of the request; F41 8 or 6, by whether its greatest value was requested too.
BESIDE_FOLDS = (
    {"a1": 1.0, "a2": 3.0000000000114055, "a3": 1.0, "a4": 3.000000000011406, "omega1": -1.0693256663108537}
    | {
        "alpha1": 0.6323824071175199,
        "P_u": 1439020.643937921,
        "P_v": 1.500000000005703,
        "m3": 0.0003777866257,
    }
    | {"m1": 4.222560468189881e-06, "m2": 1.0, "G1_u": 605.7, "G1_v": -0.94, "G2_u": 2.8, "G2_v": 45717.0}
    | {"G3_u": 4.18, "G3_v": 1.5, "I1": 0.646, "I2": 0.008, "I3": 38.15},
    {"a1": 5.0, "a2": 2.0, "a3": 5.0, "a4": 2.0, "omega1": -1.0, "alpha1": 0.0, "P_u": 5.0, "P_v": -0.55}
    | {
        "m1": 9811303803.837708,
        "m2": 4.2157848485667765e-06,
        "m3": 0.6957302268672849,
        "I1": 1.8498274606725298,
    }
    | {
        "I2": 2.0424549442650713e-06,
        "I3": 0.0,
        "G1_u": 0.18387098872196422,
        "G1_v": 1.237072188203585,
        "G2_u": 0.0,
    }
    | {"G2_v": 9.629311798344673, "G3_u": 6.411342337060885e-06, "G3_v": 0.0},
)


def parts_of(name, position, by):
    """Return what may be requested of a quantity."""
    lists = [
        f"{name}_extrema",
        f"{name}_extrema_count",
        f"{name}_extrema_kind",
        f"{position}_at_{name}_extrema",
    ]
    best = [f"{name}_max", f"{position}_at_{name}_max", f"{name}_min", f"{position}_at_{name}_min"]
    others = [f"{name}_mean", f"{name}_rms", f"{name}_fluctuation"]
    slopes = [f"d_{name}_max_d_{by}", f"d_{name}_min_d_{by}", f"{name}_max_gradient_status"]
    return [
        lists,
        best,
        others,
        slopes,
        [f"{name}_max_error", f"{name}_min_error"],
        [f"{name}_extrema_error"],
    ]


def differing(entry, designs, names, by):
    """Return the results that are not the same alone and together, by name."""

    def found(asked):
        maps = fl.sweep(
            entry.mechanism, fl.table(designs), asked, input=entry.input, verify=0, allow_invalid=True
        )
        return {name: maps[name].values for name in asked}

    parts = {name: parts_of(name, entry.input, by) for name in names}
    requests = [part for name in names for part in parts[name]]
    # all; all of one quantity; each part of it
    every = found([name for part in requests for name in part])
    wholes = [[name for part in parts[name] for name in part] for name in names] if len(names) > 1 else []
    return {
        name: of
        for asked in (*wholes, *requests)
        for name, of in found(asked).items()
        if not same(every[name], of)
    }


def same(one, other):
    """Compare to the bit; lists of one request may be longer than those of another, by what is NaN, or 0 as a kind."""
    if one.ndim == other.ndim and one.shape != other.shape:
        length = min(one.shape[-1], other.shape[-1])
        one, other = (values[..., :length] for values in (one, other))
    return np.array_equal(one, other, equal_nan=one.dtype.kind == "f")


@pytest.mark.parametrize("name", ["alpha4", "F41"])
def test_lists_beside_folds_are_the_same_whatever_else_is_requested(name):
    designs = {key: np.array([one[key] for one in BESIDE_FOLDS]) for key in BESIDE_FOLDS[0]}
    asked = [f"{name}_extrema_count", f"{name}_extrema", f"theta1_at_{name}_extrema"]

    def found(*others):
        return fl.sweep("planar_4r", fl.table(designs), [*asked, *others], verify=0, allow_invalid=True)

    alone, among = found(), found(f"{name}_max", f"{name}_min", "shaking_force_extrema")
    for key in asked:
        assert same(alone[key].values, among[key].values), key


@pytest.mark.stress
@pytest.mark.parametrize(
    "entry", [e for e in ENTRIES if e.catalogue.graded and not e.about and e.moves], ids=str
)
def test_results_of_a_mechanism_are_the_same_whatever_else_is_requested(entry):
    for seed, kind in enumerate(entry.families):
        designs = designs_of(entry, kind, seed, 60)
        rng = np.random.default_rng(seed)
        names = [str(name) for name in rng.permutation(searched(entry, designs))[:3]]
        by = next(name for name in designs if not entry.catalogue.known_inputs(())[name].choices)
        assert differing(entry, designs, names, by) == {}, kind


@pytest.mark.stress
@pytest.mark.parametrize("seed", range(3))
def test_results_beside_folds_are_the_same_whatever_else_is_requested(seed):
    designs = folded_planar_4r(np.random.default_rng(seed), 3000)
    names = [("alpha4", "F41"), ("F32", "P_speed", "T41"), ("curvature", "theta4")][seed]
    assert differing(ENTRIES[0], designs, names, "a2") == {}
