"""Precision of Hart's linkage: every quantity and derivative against 50 digits, near all where digits get lost."""

from __future__ import annotations

import mpmath as mp
import numpy as np
import pytest

import fastlink as fl
from configurations import UNIT
from fastlink.exact import CONTEXT, Exact, in_roundings
from hart_configurations import (
    FAMILIES,
    HART,
    INPUTS,
    MEASURES,
    OF_THE_CRANK,
    QUANTITIES,
    WUNDERLICH,
    at,
    family,
)

#: In roundings of a double; 3.7 is the worst seen in 10^4 configurations of the families.
MULTIPLE = 4


# -- every digit ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("n", [4, pytest.param(300, marks=pytest.mark.stress)])
@pytest.mark.parametrize("kind", FAMILIES)
def test_every_quantity_is_a_few_roundings_off(kind, n):
    inputs = family(kind, np.random.default_rng(n), n)
    facts = Exact(HART, ["sigma", *QUANTITIES], [*INPUTS, "branch"])
    tested = 0
    for i in range(n):
        one = {name: float(values[i]) for name, values in inputs.items()}
        got = at([*QUANTITIES, *MEASURES], branch=np.array([1, 2]), **one)
        for k, branch in enumerate((1, 2)):
            true = facts.at(one | {"branch": branch})
            if mp.isnan(true["sigma"]):
                assert all(
                    np.isnan(got[q][k]) for q in QUANTITIES if HART.varies(q) and q not in OF_THE_CRANK
                )
                continue
            # Three roundings of MP and PF, which sum to MP + PF; of each bar eight in its joints.
            assert got["F_deviation"][k] <= 6
            assert got["closure_residual"][k] <= 32 * UNIT
            if abs(true["F_y"]) <= 1e-10 * true["stroke"]:  # a kite that is folded: B stays at M, and F
                assert kind.startswith("kite")
                continue
            condition = facts.condition(true, INPUTS)
            for name in QUANTITIES:
                value = float(np.broadcast_to(got[name], 2)[k])
                if mp.isnan(true[name]):  # the ellipse of what is no kite
                    assert np.isnan(value)
                    continue
                assert in_roundings(value, true[name], condition[name]) <= MULTIPLE, (name, i, branch)
            tested += 1
    assert tested >= n / 2


def test_the_compiled_sweep_has_the_bits_of_the_plain_reading():
    phi = np.array([-2.5, -0.4, 0.0, 0.3, 1.0, 2.9])
    names = list(HART.public)
    for design in (WUNDERLICH, {"m": 1.3, "n": 0.8, "d": 1.1, "kappa": -1.7}):
        swept = fl.sweep("hart", fl.grid(**design), names, phi=phi, threads=1)
        for k, branch in enumerate((1, 2)):
            plain = at(names, branch=branch, phi=phi, **design)
            for name in names:
                found = swept[name].values
                np.testing.assert_array_equal(found[k] if HART.varies(name) else found, plain[name])


@pytest.mark.parametrize("power", [-490, -7, 3, 490])
def test_a_power_of_two_of_all_lengths_changes_no_bit(power):
    design = {"m": 0.7, "n": 1.3, "d": 1.1}
    given = {"kappa": 0.6, "phi": np.array([0.3, 1.0, 2.0])}
    here = at(list(HART.public), **design, **given)
    there = at(list(HART.public), **{name: value * 2.0**power for name, value in design.items()}, **given)
    for name, fact in HART.public.items():
        length = fact.units in ("m", "m rad-1")
        np.testing.assert_array_equal(there[name], here[name] * (2.0**power if length else 1.0))


# -- derivatives ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("by", INPUTS)
def test_every_quantity_has_its_derivative(by):
    one = {"m": 0.8, "n": 1.1, "d": 1.3, "kappa": 0.6, "phi": 1.2, "branch": 2}
    facts = Exact(HART, QUANTITIES, one)
    here, step = facts.at(one), CONTEXT.mpf(10) ** -18
    low, high = (facts.moved(here, {by: here[by] + k * step}) for k in (-1, 1))
    tested = 0
    for name in QUANTITIES:
        slope, derivative = (high[name] - low[name]) / (2 * step), f"d_{name}_d_{by}"
        if slope == 0 or mp.isnan(slope):
            continue
        found = at([derivative], **one)[derivative]
        slopes = Exact(HART, [derivative], one)
        condition = slopes.condition(slopes.at(one), INPUTS)[derivative]
        # The rule of precision; the difference quotient is right to 1e-30.
        assert in_roundings(float(found), slope, condition) <= MULTIPLE, name
        tested += 1
    assert tested >= (15 if by != "phi" else 8)
