"""Every quantity of every mechanism is right to a few roundings of its inputs and itself, and so are derivatives.

How many is the `multiple` of an entry of `support/registry.py`.
"""

import re
from collections import Counter

import numpy as np
import pytest
from numpy.testing import assert_array_equal
from tests.support.neighbourhoods import DRAWN
from tests.support.precision import (
    Truth,
    compiled,
    derivatives,
    error_by_quantity,
    in_every_mode,
    numbers_of,
    plain,
    wrong,
)
from tests.support.registry import ENTRIES, every_input

from fastlink.facts.powers import any_beyond_range
from fastlink.mechanisms import NAMES
from fastlink.precision.reference import CONTEXT as MP

FAMILIES = [pytest.param(entry, kind, id=f"{entry}-{kind}") for entry in ENTRIES for kind in entry.families]
#: Gaussian elimination has no derivatives, and chooses its pivots by the sizes of forces and moments.
DIFFERENTIATED = [entry for entry in ENTRIES if entry.solver == "eliminated"]
DIGITS_LEFT = MP.mpf(10) ** -44


@every_input
def test_every_mechanism_and_input_is_tested_and_every_quantity(mechanism, drive):
    entries = [entry for entry in ENTRIES if (entry.mechanism, entry.input) == (mechanism, drive)]
    assert entries, f"no entry of {mechanism} driven by {drive} in tests/support/registry.py"
    tested = {name for entry in entries for name in entry.names}
    reasons = {name for entry in entries for name, reason in entry.left_out.items() if reason}
    assert tested | reasons >= set(entries[0].catalogue.public)


def held(entry, kind, n):
    """Assert the rule for n configurations of a family; return how many numbers were held to it."""
    inputs = in_every_mode(entry, entry.drawn(kind, n, n))
    found = compiled(entry, entry.names, inputs)
    if entry.solver == "eliminated":  # NumPy's LU is another than that of the kernels
        for name, values in plain(entry, entry.names, inputs).items():
            assert_array_equal(found[name], values, err_msg=name)
    too_far_off, numbers = wrong(entry, entry.names, inputs, found)
    assert not too_far_off
    return numbers


@pytest.mark.sample(12)
@pytest.mark.parametrize("count", ["few", pytest.param("many", marks=pytest.mark.stress)])
@pytest.mark.parametrize(("entry", "kind"), FAMILIES)
def test_every_quantity_is_a_few_roundings_off(entry, kind, count):
    n = getattr(entry, count)
    assert held(entry, kind, n) >= n * len(entry.names) // 8


@pytest.mark.sample(3)
@pytest.mark.parametrize("n", [40, pytest.param(400, marks=pytest.mark.stress)])
@pytest.mark.parametrize(("mechanism", "drive"), DRAWN)
def test_quantities_are_a_few_roundings_off_beside_what_is_degenerate(mechanism, drive, n):
    """Wherever their bound is finite, but for chance: a formula that cancels does so in most of some neighbourhood."""
    entry = next(one for one in ENTRIES if (one.mechanism, one.input) == (mechanism, drive))
    rng, tested, often = np.random.default_rng(n), 0, Counter()
    for _ in range(4):  # of each set of inputs and loads by chance
        drawn = DRAWN[mechanism, drive](rng, n // 4)
        far = any_beyond_range(
            entry.catalogue.known_inputs(entry.catalogue.variants_selected_by(drawn)), drawn
        )
        inputs = in_every_mode(entry, {name: values[~far] for name, values in drawn.items()})
        left_out = {*inputs, *({"shaking_moment_at"} if not {"M_x", "M_y"} <= set(inputs) else ())}
        names = tuple(name for name in numbers_of(entry) if name not in left_out)
        bounds = plain(entry, tuple(f"{name}_error" for name in names), inputs)
        rows = len(inputs[drive])
        known = {name: np.broadcast_to(bounds[f"{name}_error"] < np.inf, (rows,)) for name in names}
        values = {name: np.broadcast_to(of, (rows,)) for name, of in plain(entry, names, inputs).items()}
        beyond, numbers = wrong(entry, names, inputs, values, known=known)
        often.update(name for name, *_ in beyond)
        tested += numbers
    assert tested > 5 * n
    assert often.total() <= 0.03 * tested, often
    assert all(count <= n / 8 for count in often.values()), often


@pytest.mark.parametrize("mechanism", NAMES)
def test_an_error_in_the_fifteenth_digit_is_noticed(mechanism):
    entry = next(entry for entry in ENTRIES if entry.mechanism == mechanism)
    inputs = in_every_mode(entry, entry.drawn("random", 1, 2))
    computed = {name: values * (1.0 + 2.0**-46) for name, values in plain(entry, entry.names, inputs).items()}
    noticed = {name for name, *_ in wrong(entry, entry.names, inputs, computed)[0]}
    # All but what is nothing but an error, zeros, and what has a condition beyond 30: 2^-46 is 128 roundings.
    assert len(noticed) > 0.7 * len(entry.names)


def variables(entry):
    """Return the inputs with the position, which derivatives are by, and the sets of facts that they choose."""
    truth = Truth(entry, (), in_every_mode(entry, entry.drawn("random", 1, 2)))
    return truth.numbers, truth.variants


def limits_of_differences(entry, kind, n):
    """Compare derivatives with central differences of two steps, with 50 digits; return how many are not zero."""
    inputs, names, tested = in_every_mode(entry, entry.drawn(kind, 11, n)), numbers_of(entry), 0
    numbers, variants = variables(entry)
    for by in numbers:
        made = derivatives(entry, names, by, variants)
        truth = Truth(entry, (*names, *made.values()), inputs)
        for _, one, true in truth.rows():
            step = abs(true[by]) * MP.mpf(10) ** -18
            ends = {k: truth.facts.moved(true, {by: true[by] + k * step}) for k in (-2, -1, 1, 2)}
            for name in names:
                near, far = ((ends[k][name] - ends[-k][name]) / (2 * k * step) for k in (1, 2))
                slope = true[made[name]] if name in made else MP.zero
                if MP.isnan(true[name]) or (name not in made and MP.isnan(near)):
                    continue
                assert MP.isnan(slope) == MP.isnan(near), (name, by, one)
                # A third derivative leaves h^2/6 f''', a third of what twice the step leaves more; and of the 50
                # digits of f the facts lose a few.
                allowed = abs(far - near) + DIGITS_LEFT * abs(true[name]) / step + abs(slope) * 1e-20
                assert MP.isnan(slope) or abs(near - slope) <= allowed, (name, by, one)
                tested += slope != 0
    return tested


@pytest.mark.sample(3)
@pytest.mark.parametrize("entry", [entry for entry in DIFFERENTIATED if not entry.about], ids=str)
def test_every_derivative_is_the_limit_of_differences(entry):
    assert limits_of_differences(entry, "random", 1) > len(entry.names)


@pytest.mark.stress
@pytest.mark.parametrize("entry", DIFFERENTIATED, ids=str)
def test_every_derivative_is_the_limit_of_differences_in_all_families(entry):
    for kind in entry.families:
        limits_of_differences(entry, kind, 4)


SLOPES = [
    pytest.param(entry, kind, by, id=f"{entry}-{kind}-{by}")
    for entry in DIFFERENTIATED
    for kind in entry.slopes
    for by in variables(entry)[0]
]


@pytest.mark.sample(6)
@pytest.mark.parametrize(("entry", "kind", "by"), SLOPES)
def test_derivatives_are_a_few_roundings_off(entry, kind, by):
    """By their own condition, but for chance; and all of them by the terms of what they are derivatives of.

    A derivative and its condition may vanish where its terms do not: 490 of 618,000. A formula that cancels does so in
    most of a family.
    """
    made = derivatives(entry, numbers_of(entry), by, variables(entry)[1])
    quantities = {derivative: name for name, derivative in made.items()}
    if not made:
        return
    names, inputs = tuple(quantities), in_every_mode(entry, entry.drawn(kind, 31, 8))
    beyond, numbers = wrong(entry, names, inputs, plain(entry, names, inputs))
    assert len(beyond) <= 0.05 * numbers, beyond
    often = Counter(name for name, *_ in beyond)
    assert all(count <= len(inputs[by]) / 4 for count in often.values()), often
    errors = {name: error_by_quantity(entry, quantities[name], by, one) for name, _, one in beyond}
    assert all(error <= entry.multiple for error in errors.values()), errors


def power_of_length(units):
    """Return how a number with these units grows with the unit of length, where masses and times stay."""
    of = {"m": 1, "N": 1, "J": 2, "W": 2}
    found = (re.fullmatch("([A-Za-z]+)(-?[0-9]*)", unit) for unit in units.split() if unit != "1")
    return sum(of.get(unit, 0) * int(power or 1) for unit, power in (match.groups() for match in found))


@pytest.mark.sample(3)
@pytest.mark.parametrize("entry", DIFFERENTIATED, ids=str)
def test_a_power_of_two_of_all_lengths_changes_no_bit(entry):
    """Every operation is exact in the exponent as long as nothing leaves the range of the doubles."""
    catalogue, tested = entry.catalogue, 0
    for kind in entry.families:
        inputs = in_every_mode(entry, entry.drawn(kind, 5, 14))
        declared = catalogue.known_inputs(catalogue.variants_selected_by(inputs)) | {
            entry.input: catalogue.position
        }
        powers = {name: power_of_length(declared[name].units) for name in inputs if name != "branch"}
        lengths = np.abs([inputs[name] for name, of in powers.items() if of == 1])
        ordinary = np.all((lengths > 1e-16) & (lengths < 1e16), axis=0)
        if not ordinary.any():
            continue
        inputs = {name: values[ordinary] for name, values in inputs.items()}
        here = plain(entry, entry.names, inputs)
        labels = {name: catalogue.public_fact(name) for name in entry.names}
        of = {name: 0 if one.flags else power_of_length(one.units) for name, one in labels.items()}
        for power in (-20, -7, 3, 20):
            scaled = {name: np.ldexp(values, power * powers.get(name, 0)) for name, values in inputs.items()}
            there = plain(entry, entry.names, scaled)
            sizes = [np.frexp(here[name])[1] + power * of[name] for name in entry.names]
            within = np.all(np.abs(sizes) < 1000, axis=0)  # beyond, codes may say so
            for name in entry.names:
                expected = np.ldexp(here[name][within], power * of[name])
                assert_array_equal(there[name][within], expected, err_msg=name)
                tested += np.count_nonzero(np.isfinite(expected))
    assert tested > 40 * len(entry.names)
