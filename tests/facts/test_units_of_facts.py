"""The units of every fact, internal ones too, are those that its text gives numbers of the units it depends on."""

from dataclasses import replace

import pytest
from tests.support.registry import every_input

from fastlink.facts.fact import Fact
from fastlink.facts.powers import Powers
from fastlink.facts.sheet import wrong_units
from fastlink.mechanisms import NAMES, catalogue

#: Texts that mix units on purpose, and why.
MIXED = {
    **dict.fromkeys(("per_mass1", "per_mass3"), "divides by 1 without a mass, where it selects 0"),
    **dict.fromkeys(("r_AX", "s_BX"), "are divided by a power of two near their size, but never by 0"),
    **dict.fromkeys(
        ("cosh_theta_branching", "theta_branching"), "divides by 1 at g = b, where it selects NaN"
    ),
}


@every_input
def test_the_units_of_a_fact_follow_from_its_formula(mechanism, drive):
    known = catalogue(mechanism, drive)
    names = {name for facts in (known.facts, known.tables, *known.variants.values()) for name in facts}
    problems = wrong_units(known)
    assert problems.keys() == MIXED.keys() & names, problems


def test_what_a_variant_replaces_has_the_same_units():
    for mechanism in NAMES:
        known = catalogue(mechanism)
        for facts in known.variants.values():
            for name, one in facts.items():
                other = known.facts.get(name) or known.inputs.get(name)
                if isinstance(one, Fact) and other is not None:
                    Powers.of_units(one.units).like(Powers.of_units(other.units), name)


@pytest.mark.parametrize(("name", "units"), [("P_x", "m2"), ("A_x", "1"), ("T41", "N")])
def test_wrong_units_are_noticed(name, units):
    known = catalogue("planar_4r").copied()
    known.facts[name] = replace(known.facts[name], units=units)
    assert wrong_units(known).keys() > MIXED.keys() & known.facts.keys()
    assert "declares m2 and m" in wrong_units(known).values() or name != "P_x"
