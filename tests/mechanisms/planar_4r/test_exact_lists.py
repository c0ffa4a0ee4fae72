"""Lists of extremes against exact algebra, which misses none and makes none up: the roots of polynomials."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from tests.mechanisms.planar_4r.test_near_cusps import near_cusps
from tests.support.configurations import LENGTHS
from tests.support.exact_extrema import LISTED, exact_extrema
from tests.support.neighbourhoods import folded_planar_4r

import fastlink as fl

#: Quantities that need masses.
FORCES = ("T41", "F41", "F21", "F32", "F43", "shaking_force", "F41_x", "F32_y")


def ordinary(rng, n, *, masses):
    """Return designs of links of about one length."""
    design = {name: rng.uniform(0.3, 2.0, n) for name in LENGTHS} | {"omega1": np.ones(n)}
    design |= {f"P_{axis}": rng.uniform(-1.0, 2.0, n) for axis in "uv"}
    if masses:
        design |= {f"{name}{k}": rng.uniform(0.0, 2.0, n) for k in (1, 2, 3) for name in "mI"}
        design |= {f"G{k}_{axis}": rng.uniform(-1.0, 1.0, n) for k in (1, 2, 3) for axis in "uv"}
    return design


def with_turning_load(rng, n):
    """Return designs with a load by the square of a rate of any size: slopes have a kink where it turns."""
    size = rng.choice([-1.0, 1.0], n) * 10.0 ** rng.uniform(-3.0, 9.0, n)
    return ordinary(rng, n, masses=True) | {"T_load_quadratic": size, "T_load": rng.uniform(-1.0, 1.0, n)}


def differing(designs, name):
    """Return how many lists differ from the exact ones, how many of these do not tell so by their bounds, and all."""
    asked = [f"{name}_extrema{part}" for part in ("_kind", "", "_error", "_count")]
    asked.append(f"theta1_at_{name}_extrema")
    maps = fl.sweep("planar_4r", fl.table(designs), asked, verify=0, allow_invalid=True)
    found = [maps[one].transpose("design", "branch", ...).values for one in asked]
    differ = silent = 0
    for k in range(len(found[0])):
        inputs = {key: float(values[k]) for key, values in designs.items()}
        lists = {b: [part[k, b - 1] for part in found] for b in (1, 2)}
        wrong, unlike = {1, 2}, {1, 2}
        # neither the gap that counts as zero nor that of the lengths as they are is wrong
        for zeroes in (True, False):
            places = exact_extrema(inputs, name, zeroes=zeroes) if wrong else []
            for turn in TURNS:
                exact = {b: in_order([place for place in places if place.branch == b], turn) for b in wrong}
                shown = {b: in_one_order(*lists[b], turn) for b in wrong}
                if zeroes:
                    kinds = {b: [place.kind for place in exact[b]] for b in wrong}
                    unlike -= {b for b in wrong if alike(kinds[b], shown[b][0], shown[b][3])}
                wrong = {b for b in wrong if not any(told(kinds, *shown[b]) for kinds in readings(exact[b]))}
        differ += len(unlike)
        silent += len(wrong)
    return differ, silent, 2 * len(found[0])


#: Where the turn begins anew: a place as near to it may be on either side of the fold there, as pi in doubles is off by
#: 2^-53. Both readings are right.
TURNS = (2 * np.pi, 2 * np.pi - 2.0**-49)


def in_order(places, turn):
    """Return exact places in the order of their input angles, from minima to maxima at one angle."""
    return sorted(places, key=lambda place: (0.0 if place.theta1 > turn else place.theta1, place.kind))


def in_one_order(kinds, values, bounds, count, places, turn):
    """Return a list with its entries at one double from minima to maxima: exact places order them by last bits."""
    # no place, behind the last entry, is NaN and stays there
    order = np.lexsort((kinds, np.where(places > turn, 0.0, places)))
    return kinds[order], values[order], bounds[order], count


def readings(places):
    """Return the kinds of extremes, with and without each that is next to where links align."""
    choices = itertools.product(*(([place], []) if place.at_end else ([place],) for place in places))
    return [[place.kind for chosen in choice for place in chosen] for choice in choices]


def alike(exact, kinds, count):
    """Tell whether a list has the exact kinds; it may have no room for all of them."""
    return count == len(exact) and exact[: len(kinds)] == kinds[:count].tolist()


def told(exact, kinds, values, bounds, count):
    """Tell whether a list is right, or its bounds tell that nothing is known, or that pairs of it may be none."""
    # no bound can tell that an empty list lacks an extreme; of a list that is not shown whole the count tells it
    if count > len(kinds) or alike(exact, kinds, count) or np.isinf(bounds[: max(count, 1)]).all():
        return True
    runs: list[list[int]] = [[0]]
    for k in range(1, count):
        near = abs(values[k] - values[k - 1]) <= bounds[k] + bounds[k - 1]
        runs = [*runs[:-1], [*runs[-1], k]] if near else [*runs, [k]]
    # a run of entries within their bounds of each other is one extreme, or none, beside a fold
    ways = ([run] if len(run) == 1 else [run[:1], []] for run in runs)
    choices = itertools.product(*ways)
    return any([int(kinds[k]) for run in choice for k in run] == exact for choice in choices)


@pytest.mark.parametrize("name", ["curvature"])
def test_lists_hold_the_exact_extremes(name):
    assert differing(ordinary(np.random.default_rng(3), 16, masses=False), name) == (0, 0, 32)


def test_lists_hold_the_extremes_on_both_sides_of_a_kink_of_the_slope():
    """Six of these lists lacked a pair: within 1e-5 rad the slope dips below zero as a load turns with a rate."""
    assert differing(with_turning_load(np.random.default_rng(5), 20), "F32_y") == (0, 0, 40)


def test_lists_beside_folds_hold_the_exact_extremes_or_have_no_bound():
    designs = folded_planar_4r(np.random.default_rng(11), 60)
    differ, silent, of = differing(designs, "alpha4")
    assert silent == 0
    assert differ < 0.1 * of


#: Of designs beside folds, by how many are drawn: a quantity, and those whose lists doubles do not decide, as entries
#: are lost in rounding beside the fold (F41, one list of them empty), may be on its other side (omega2), or are
#: rounding beside a toggle that is almost a fold (curvature); or as it is rounding that a parallelogram is not at rest
#: (T41, whose load is 10^57 times as great as weights and inertia).
UNDECIDED = {
    ("F41", 60): (3, 15, 54),
    ("omega2", 150): (75,),
    ("curvature", 1000): (29, 117),
    ("T41", 120): (23,),
}


@pytest.mark.parametrize(("name", "drawn"), UNDECIDED)
def test_lists_that_rounding_hides_extremes_of_have_no_bound(name, drawn):
    chosen = list(UNDECIDED[name, drawn])
    designs = {
        key: values[chosen] for key, values in folded_planar_4r(np.random.default_rng(12), drawn).items()
    }
    differ, silent, _ = differing(designs, name)
    assert differ >= len(chosen)
    assert silent == 0
    maps = fl.sweep("planar_4r", fl.table(designs), [f"{name}_extrema{part}" for part in ("", "_error")])
    values, bounds = maps[f"{name}_extrema"], maps[f"{name}_extrema_error"]
    undecided = np.isinf(bounds).all("extremum")
    # of places without an extreme, too, as nothing else of an empty list could tell
    assert (undecided.any("branch")).all()
    assert ((~undecided) & (np.isnan(values) != np.isnan(bounds)).any("extremum")).sum() == 0


def test_an_extreme_beside_a_fold_is_listed_where_the_slope_at_the_fold_is_rounding():
    """The slope of the last sample is exactly 0: the zero of rounding stood for that at 1e-6 of the fold."""
    designs = {
        key: values[120:121] for key, values in folded_planar_4r(np.random.default_rng(12), 150).items()
    }
    assert differing(designs, "F32_y") == (0, 0, 2)


#: A coupler point that passes its instant centre: a curvature below -1e15 between two of 201 within 7e-5 rad.
CUSP = {
    "a1": 0.21644546641606582,
    "a2": 1.1990216170505517,
    "a3": 2.1434978036656838,
    "a4": 1.1609216525989083,
}
CUSP |= {"omega1": 1.0, "P_u": -6.399469951710982, "P_v": -5.341676966630802}


def test_a_list_that_lacks_extremes_within_a_peak_has_no_bound():
    assert differing({name: np.array([value]) for name, value in CUSP.items()}, "curvature") == (1, 0, 2)


@pytest.mark.stress
def test_many_lists_with_peaks_hold_the_exact_extremes_or_have_no_bound():
    differ, silent, of = differing(near_cusps(6, 600)[0], "curvature")
    assert silent == 0
    assert differ < 0.02 * of


@pytest.mark.stress
@pytest.mark.parametrize("name", LISTED)
def test_many_lists_hold_the_exact_extremes(name):
    designs = ordinary(np.random.default_rng(4), 60, masses=name in FORCES)
    assert differing(designs, name) == (0, 0, 120)


@pytest.mark.stress
@pytest.mark.parametrize("name", FORCES)
def test_many_lists_hold_the_extremes_on_both_sides_of_a_kink_of_the_slope(name):
    differ, silent, of = differing(with_turning_load(np.random.default_rng(6), 120), name)
    assert silent == 0
    # sizes of forces have two extremes next to each toggle, where loads are great too close to tell
    assert differ < 0.2 * of


#: Which share of lists beside folds may lack what rounding hides, or hold what it makes up, all of them flagged: a
#: tenth, but of curvatures, whose poles at folds hide more (217 of 2,000), and of a component of a force with loads of
#: all sizes (79 of 600).
MOST = {"curvature": 0.12, "F32_y": 0.14}


@pytest.mark.stress
@pytest.mark.parametrize("name", LISTED)
def test_many_lists_beside_folds_hold_the_exact_extremes_or_have_no_bound(name):
    # exact algebra of forces takes half a second for most designs, and minutes for some with loads of all sizes
    designs = folded_planar_4r(np.random.default_rng(12), 120 if name in FORCES else 1000)
    differ, silent, of = differing(designs, name)
    assert silent == 0
    assert differ < MOST.get(name, 0.1) * of
