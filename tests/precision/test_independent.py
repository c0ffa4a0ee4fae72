"""The second reference: it agrees with the facts everywhere, and a wrong formula of theirs does not escape it."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
from tests.support.neighbourhoods import DRAWN
from tests.support.precision import in_every_mode
from tests.support.registry import ENTRIES

import fastlink as fl
from fastlink.mechanisms import NAMES, catalogue, inputs_of
from fastlink.plan.request import constants_of, variants_of
from fastlink.precision.errors import unit_of
from fastlink.precision.independent import TOLERANCE, IndependentValues
from fastlink.precision.reference import CONTEXT, HighPrecision

ENTRY = {str(entry): entry for entry in ENTRIES if entry.solver == "eliminated"}
CRANK = {"a1": 0.4, "a2": 1.2, "a3": 0.8, "a4": 1.0, "omega1": 25.0}
BARS = fl.round_bar(density=7750.0, radius=0.01)

#: How many quantities have an independent value, by mechanism and input; more may.
CONFIRMED = {
    ("planar_4r", "theta1"): 62,
    ("planar_4r", "joint_angle_1"): 21,
    ("planar_4r", "joint_angle_2"): 21,
    ("planar_4r", "joint_angle_3"): 21,
    ("planar_4r", "joint_angle_4"): 21,
    ("minkowski_4r", "theta"): 37,
    ("focal", "phi"): 57,
    ("focal", "sigma"): 57,
    ("hart", "phi"): 33,
    ("hart", "F_y"): 33,
    ("slider_crank", "theta"): 30,
}


def covered(known):
    """Return the quantities that have an independent value."""
    return IndependentValues(known, known.public).names


@pytest.mark.parametrize(
    ("mechanism", "drive"), [(name, drive) for name in NAMES for drive in inputs_of(name)]
)
def test_what_has_an_independent_value(mechanism, drive):
    known = catalogue(mechanism, drive)
    names = covered(known)
    assert len(names) >= CONFIRMED[mechanism, drive]
    derivative = f"d_{names[0]}_d_{known.position.name}"
    assert IndependentValues(known, [derivative, f"{names[0]}_error", "status"]).names == (derivative,)


def compared(entry, kind, n):
    """Assert that facts and loops agree in n configurations of a family; return how many values were compared."""
    inputs = in_every_mode(entry, entry.drawn(kind, n, n))
    position = entry.catalogue.position.name
    inputs = {position: np.ones_like(next(iter(inputs.values())))} | inputs
    independent = IndependentValues(entry.catalogue, entry.names)
    facts = HighPrecision(
        entry.catalogue, independent.names, inputs, variants_of(entry.catalogue, None, entry.solver, inputs)
    )
    numbers = [name for name in inputs if name not in ("branch", "completion")]
    count = 0
    for i in range(len(inputs[position])):
        at = {name: float(values[i]) for name, values in inputs.items()}
        exact = facts.at(at)
        condition = facts.condition(exact, numbers)
        units = {name: unit_of(exact[name], condition[name], 1.0) for name in independent.names}
        found = independent.differences(at, exact, units)
        assert {name: value for name, value in found.items() if value > TOLERANCE} == {}, at
        count += len(found)
    return count


@pytest.mark.sample(4)
@pytest.mark.parametrize("name", ENTRY)
def test_facts_and_loops_agree_to_fifty_digits(name):
    first, *others = ENTRY[name].families
    assert compared(ENTRY[name], first, 1)
    for kind in others[:1]:
        compared(ENTRY[name], kind, 1)


@pytest.mark.stress
@pytest.mark.parametrize("name", ENTRY)
def test_facts_and_loops_agree_in_many_configurations(name):
    kinds = list(ENTRY[name].families)
    assert sum(compared(ENTRY[name], kind, 40) for kind in kinds) > 1000


def agreed(mechanism, drive, n):
    """Assert that no quantity has a number by the facts alone or by the loops alone; count what closes and not."""
    known = catalogue(mechanism, drive)
    inputs = DRAWN[mechanism, drive](np.random.default_rng(n), n) | {"branch": np.ones(n)}
    variants = known.variants_selected_by(inputs)
    inputs |= {
        name: np.full(n, value) for name, value in constants_of(known, None, variants).items()
    } | inputs
    names = [name for name in covered(known) if name not in inputs]
    independent = IndependentValues(known, names)
    facts = HighPrecision(known, names, inputs, variants)
    counts = Counter()
    for i in range(n):
        at = {name: float(values[i]) for name, values in inputs.items()}
        exact = facts.at(at)
        found = independent.differences(at, exact, dict.fromkeys(names, 1.0))
        assert [name for name, difference in found.items() if difference == np.inf] == [], at
        counts[any(CONTEXT.isnan(exact[name]) for name in found)] += 1
    return counts


@pytest.mark.sample(3)
@pytest.mark.parametrize(("mechanism", "drive"), DRAWN)
def test_both_references_have_the_same_numbers(mechanism, drive):
    """Most configurations are next to something degenerate.

    Where the loop does not close the end of the driven bar alone has a place, where links are in line rates have no
    number: a map whose references differ there has a mismatch in its file.
    """
    counts = agreed(mechanism, drive, 60)
    assert min(counts[True], counts[False]) > 5


@pytest.mark.stress
@pytest.mark.parametrize(("mechanism", "drive"), DRAWN)
def test_both_references_have_the_same_numbers_in_many_configurations(mechanism, drive):
    counts = agreed(mechanism, drive, 4000)
    assert min(counts[True], counts[False]) > 400


def nearly(right):
    """Return what a formula says that is wrong in the twelfth digit."""
    return right * 1.000000000001


#: A mechanism, a fact on the way, a quantity that it makes wrong, and inputs of a sweep.
WRONG = [
    ("planar_4r", "torque2", "T41", CRANK, {"links": BARS}),
    ("planar_4r", "jerk4", "jerk4", CRANK, {}),
    ("planar_4r", "joint_angle_3", "joint_angle_3", CRANK, {}),
    (
        "slider_crank",
        "slider_acceleration",
        "slider_acceleration",
        {"r": 1.0, "l": 2.5, "e": 0.3, "omega": 2.0},
        {},
    ),
    ("minkowski_4r", "dpsi_dtheta", "dpsi_dtheta", {"a": 0.6, "b": 1.0, "g": 0.7, "h": 0.5}, {}),
    ("focal", "lambda_", "F_x", {"a": 4.0, "b": 5.0, "c": 2.0, "d": 4.0, "s": 1.5, "completion": 1}, {}),
    ("hart", "PF_across", "F_y", {"m": 4.0, "n": 7.0, "d": 6.0, "kappa": 0.5}, {}),
]


#: Those that are tested in each run; every one compiles two kernels.
QUICK = (0, 5)


@pytest.mark.parametrize(
    ("mechanism", "fact", "quantity", "design", "options"),
    [pytest.param(*row, marks=[] if k in QUICK else pytest.mark.stress) for k, row in enumerate(WRONG)],
)
def test_a_wrong_formula_is_a_mismatch_in_the_file(
    monkeypatch, tmp_path, mechanism, fact, quantity, design, options
):
    """Kernels and 50-digit facts share their formulas: only what does not can tell that one is wrong."""
    known = catalogue(mechanism)
    law = known.facts[fact]
    angles = {known.position.name: np.linspace(0.9, 1.1, 5)}

    def swept(name):
        with fl.sweep(
            mechanism, fl.grid(**design), [quantity], **angles, **options, to=tmp_path / name, verify=1
        ) as maps:
            return dict(maps[quantity].attrs), maps.attrs["verify_mismatches"], fl.summary(maps)

    attrs, mismatches, summary = swept("right.h5")
    assert mismatches == 0
    assert attrs["independent_values"] == 1
    assert attrs["independent_max_difference"] < TOLERANCE
    assert "NOT AS" not in summary
    monkeypatch.setitem(known.facts, "right", replace(law, name="right", internal=True))
    monkeypatch.setitem(known.facts, fact, replace(law, function=nearly, depends_on=("right",)))
    attrs, mismatches, summary = swept("wrong.h5")
    assert attrs["verify_mismatches"] == attrs["independent_values"] == 1 <= mismatches
    assert attrs["independent_max_difference"] > 1e-16
    assert "NOT AS WITH 50 DIGITS" in summary
