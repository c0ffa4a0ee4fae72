"""Derivatives of every quantity of every mechanism: against 50-digit differences, and how exact they are in doubles."""

from __future__ import annotations

import pytest
from tests.support.precision import Truth, derivatives, in_every_mode, numbers_of, plain, wrong
from tests.support.registry import ENTRIES

from fastlink.precision.reference import CONTEXT as MP

DIFFERENTIATED = [
    entry for entry in ENTRIES if entry.solver == "eliminated"
]  # a linear system has no derivatives
DIGITS_LEFT = MP.mpf(10) ** -44


def given_by(entry):
    """Return the inputs with the position, which derivatives are by, and the sets of facts that they choose."""
    truth = Truth(entry, (), in_every_mode(entry, entry.drawn("random", 1, 2)))
    return truth.numbers, truth.variants


def differences(facts, names, true, by, step):
    """Return central differences by an input, with 50 digits."""
    high, low = (facts.moved(true, {by: true[by] + sign * step}) for sign in (1, -1))
    return {name: (high[name] - low[name]) / (2 * step) for name in names}


def assert_limits_of_differences(entry, kind, n):
    """Compare the facts of derivatives with differences of two steps; return how many are not zero."""
    inputs, names, tested = in_every_mode(entry, entry.drawn(kind, 11, n)), numbers_of(entry), 0
    variables, variants = given_by(entry)
    for by in variables:
        made = derivatives(entry, names, by, variants)
        truth = Truth(entry, (*names, *made.values()), inputs, kind)
        for _, one, true in truth.rows():
            step = abs(true[by]) * MP.mpf(10) ** -18
            near, far = (differences(truth.facts, names, true, by, k * step) for k in (1, 2))
            for name in names:
                slope = true[made[name]] if name in made else MP.zero
                if MP.isnan(true[name]) or (name not in made and MP.isnan(near[name])):
                    continue
                assert MP.isnan(slope) == MP.isnan(near[name]), (name, by, one)
                # A third derivative leaves h^2/6 f''', a third of what twice the step leaves more; and of the 50 digits
                # of f the facts lose a few.
                allowed = abs(far[name] - near[name]) + DIGITS_LEFT * abs(true[name]) / step
                assert MP.isnan(slope) or abs(near[name] - slope) <= allowed + abs(slope) * 1e-20, (
                    name,
                    by,
                    one,
                )
                tested += slope != 0
    return tested


@pytest.mark.sample(5)
@pytest.mark.parametrize("entry", DIFFERENTIATED, ids=str)
def test_every_derivative_is_the_limit_of_differences(entry):
    kinds = [kind for kind in list(entry.families)[::12] if kind not in entry.kinks]
    assert sum(assert_limits_of_differences(entry, kind, 1) for kind in kinds) > len(entry.names)


@pytest.mark.stress
@pytest.mark.parametrize("entry", DIFFERENTIATED, ids=str)
def test_every_derivative_is_the_limit_of_differences_in_all_families(entry):
    for kind in entry.families:
        if kind not in entry.kinks:
            assert_limits_of_differences(entry, kind, 4)


def held():
    """Yield the derivatives that are held to the rule: of a mechanism of many inputs by two of them in each run."""
    for entry in DIFFERENTIATED:
        variables = given_by(entry)[0]
        for kind in entry.slopes:
            for k, by in enumerate(variables):
                marks = [pytest.mark.stress] if k > 1 and len(variables) > 8 else []
                yield pytest.param(entry, kind, by, id=f"{entry}-{kind}-{by}", marks=marks)


@pytest.mark.sample(42)
@pytest.mark.parametrize(("entry", "kind", "by"), list(held()))
def test_derivatives_are_a_few_roundings_off(entry, kind, by):
    names = tuple(derivatives(entry, numbers_of(entry), by, given_by(entry)[1]).values())
    inputs = in_every_mode(entry, entry.drawn(kind, 31, 8))
    if names:
        beyond, numbers = wrong(entry, names, inputs, plain(entry, names, inputs), kind)
        assert len(beyond) <= (1.0 - entry.slopes[kind]) * numbers, beyond
