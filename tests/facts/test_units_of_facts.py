"""The units of every fact, internal ones too, are those that its text gives numbers of the units it depends on."""

from __future__ import annotations

from dataclasses import replace

import pytest

from fastlink.facts.catalogue import plain_and_above
from fastlink.facts.fact import System
from fastlink.facts.powers import Powers, UnlikePowers, dimensions
from fastlink.mechanisms import NAMES, catalogue, inputs_of

#: Texts that mix units on purpose, and why.
MIXED = {
    "lift": "compares a length with powers of two beyond which products of any numbers overflow",
    **dict.fromkeys(("per_mass1", "per_mass3"), "divides by 1 without a mass, where it selects 0"),
    **dict.fromkeys(("r_AX", "s_BX"), "are divided by a power of two near their size, but never by 0"),
    **dict.fromkeys(
        ("cosh_theta_branching", "theta_branching"), "divides by 1 at g = b, where it selects NaN"
    ),
}


def number(units):
    return Powers(tuple(map(float, dimensions(units))))


def numbers_by_name(known):
    """Return numbers of the units of all names of a catalogue; what a variant replaces must have the same."""
    pure = {
        "branch",
        *known.tables,
        *known.table_low_parts,
        *(known.graded.coordinates if known.graded else ()),
    }
    given = {**known.all_inputs, known.position.name: known.position}
    found = {name: number("1") for name in pure} | {name: number(one.units) for name, one in given.items()}
    for facts in (known.facts, *known.variants.values()):
        for name, fact in facts.items():
            if not isinstance(fact, System):
                found.setdefault(name, number(fact.units)).like(number(fact.units), f"{name} has")
    return found


def problem_of(step, known, numbers):
    """Return what is wrong with the units of a fact or a linear system, None if nothing is."""
    given = [numbers[plain_and_above(known.parse(name))[0]] for name in step.depends_on]
    try:
        if isinstance(step, System):
            for *factors, value in step.formula(*given):
                terms = (factor * numbers[name] for factor, name in zip(factors, step.unknowns, strict=True))
                sum(terms, start=value)
        elif given and not any(any(one.powers) for one in given):  # what is made of pure numbers is one
            number(step.units).like(1.0, "declares")
        else:
            value = step.formula(*given)
            for part in (value,) if step.low is None else value:
                number(step.units).like(part, "declares")
    except UnlikePowers as error:
        return str(error)
    return None


@pytest.mark.parametrize(
    ("mechanism", "drive"), [(name, drive) for name in NAMES for drive in inputs_of(name)]
)
def test_the_units_of_a_fact_follow_from_its_text(mechanism, drive):
    known = catalogue(mechanism, drive)
    numbers = numbers_by_name(known)
    steps = [
        (name, step)
        for facts in (known.facts, known.tables, *known.variants.values())
        for name, step in facts.items()
    ]
    problems = {name: found for name, step in steps if (found := problem_of(step, known, numbers))}
    assert problems.keys() == MIXED.keys() & dict(steps), problems


def test_wrong_units_are_noticed():
    known = catalogue("planar_4r")
    numbers = numbers_by_name(known)
    assert problem_of(replace(known.facts["P_x"], units="m2"), known, numbers) == "declares m2 and m"
    assert problem_of(known.facts["P_x"], known, numbers | {"A_x": number("1")}) == "adds a number and m"
    solved = known.variants["dense"]["T41"]
    assert problem_of(solved, known, numbers | {"T41": number("N")}) is not None
