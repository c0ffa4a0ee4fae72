"""Every kind of dyad against the loops of its declaration; what is refused, where, and with what remedy."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

import fastlink as fl

O, OD = {"O": (0, 0)}, {"O": (0, 0), "D": ("a4", 0)}
RRR = {"rrr": ("A", "D"), "lengths": ("a2", "a3")}
FOUR_BAR = {"a1": 0.1, "a2": 0.3, "a3": 0.35, "a4": 0.4}
#: Each kind: its declaration, a design, and how many branches there are.
KINDS: dict[str, tuple[dict[str, Any], dict[str, float], int]] = {
    "rrp": (
        {
            "ground": O | {"C": ("c", 0.1)},
            "dyads": {"B": {"rrp": "A", "length": "l", "along": ("C", "beta")}},
        },
        {"a1": 0.1, "l": 0.3, "c": 0.02, "beta": 0.4},
        2,
    ),
    "rrp on a moving line": (
        {
            "ground": OD,
            "dyads": {
                "B": RRR,
                "P": {"on": ("D", "B"), "at": ("p", "q_left")},
                "S": {"rrp": "A", "length": "l", "along": ("P", "B")},
            },
        },
        FOUR_BAR | {"p": 0.1, "q_left": 0.05, "l": 0.5},
        4,
    ),
    "rpr": (
        {
            "ground": O | {"C": (0, "d")},
            "dyads": {"lever": {"rpr": ("A", "C"), "offset": "e"}, "Q": {"on": "lever", "at": (0.6, 0.01)}},
        },
        {"a1": 0.1, "d": -0.3, "e": 0.02},
        2,
    ),
    "rpp": (
        {"ground": O, "dyads": {"Y": {"rpp": "A", "along": ("O", 0.2), "angle": "slope_of_slot"}}},
        {"a1": 0.1, "slope_of_slot": 1.2},
        1,
    ),
    "prp": (
        {"ground": OD, "dyads": {"B": RRR, "X": {"prp": (("A", "B"), ("D", "gamma"))}}},
        FOUR_BAR | {"gamma": -0.3},
        2,
    ),
    "a plate by its sides": (
        {"ground": OD, "dyads": {"B": RRR, "P": {"on": ("A", "B"), "lengths": ("d", "e"), "side": "right"}}},
        FOUR_BAR | {"d": 0.2, "e": 0.25},
        2,
    ),
    "gear": (
        {
            "ground": OD,
            "dyads": {
                "E": {"gear": ("O", "A"), "about": "D", "ratio": -2, "length": "b", "phase": "f"},
                "F": {"rrr": ("A", "E"), "lengths": ("a2", "a3")},
            },
        },
        FOUR_BAR | {"b": 0.08, "a2": 0.4, "a4": 0.3, "f": 0.3},
        2,
    ),
}


@pytest.mark.parametrize("kind", KINDS)
def test_positions_and_rates_are_those_of_the_loops(kind: str, tmp_path: Any) -> None:
    declared, design, branches = KINDS[kind]
    mechanism = fl.linkage(kind.split()[0] + "_1", crank={"A": ("O", "a1")}, **declared)
    every = [one.name for one in fl.quantities(mechanism) if "theta" not in one.name and one.name != "status"]
    varied = {name: value * np.array([1.0, 1.03, 0.97]) for name, value in design.items()}
    maps = fl.sweep(
        mechanism,
        varied | {"omega": 3.0},
        every,
        branch=tuple(range(1, branches + 1)),
        positions=24,
        to=tmp_path / "maps.h5",
    )
    assert maps.attrs["verify_mismatches"] == 0
    told = {name: maps[name].attrs.get("independent_max_difference") for name in every}
    compared = [name for name, difference in told.items() if difference is not None]
    # all but sizes, curvatures and transmission angles, which have no loop
    assert len(compared) > 0.6 * len(every)
    assert max(told[name] for name in compared) < 1e-40


REFUSED = {
    "one link": (
        {"dyads": {"B": {"rrr": ("O", "D"), "lengths": ("a", "b")}}},
        "dyads.B.rrr: O and D are of one link, on which B would be fixed",
        '"on"',
    ),
    "later": (
        {
            "dyads": {
                "B": {"rrr": ("A", "C"), "lengths": ("a", "b")},
                "C": {"rrr": ("B", "D"), "lengths": ("c", "d")},
            }
        },
        "dyads.B.rrr: C is placed later",
        "declare C before it",
    ),
    "no point": ({"dyads": {"B": {"rrr": ("A", "X"), "lengths": ("a", "b")}}}, "'X' is no point", "known"),
    "no kind": ({"dyads": {"B": {"lengths": ("a", "b")}}}, "has no kind", "write one of"),
    "no lengths": ({"dyads": {"B": {"rrr": ("A", "D")}}}, "has no 'lengths'", '"lengths"'),
    "unknown word": (
        {"dyads": {"B": {"rrr": ("A", "D"), "length": ("a", "b")}}},
        "'length' is unknown",
        "did you mean 'lengths'",
    ),
    "a word of ours": ({"dyads": {"B": {"rrr": ("A", "D"), "lengths": ("i", "b")}}}, "'i' is a word", "my_i"),
    "no number": ({"dyads": {"B": {"rrr": ("A", "D"), "lengths": (True, "b")}}}, "is True", "a number"),
    "placed twice": ({"dyads": {"A": RRR}}, "A is placed twice", "call one"),
    "two units": (
        {"dyads": {"B": {"rrp": "A", "length": "l", "along": ("D", "l")}}},
        "l is an input in m already, here in rad",
        "call one",
    ),
    "two places": (
        {"dyads": {"B": RRR, "P": {"on": ("A", "B"), "at": (0, 1), "lengths": ("a", "b")}}},
        "has no place, or two",
        "write",
    ),
    "broken ratio": (
        {"dyads": {"E": {"gear": ("O", "A"), "about": "D", "ratio": 1.5, "length": "b"}}},
        "is 1.5: another ratio goes on for several turns",
        "a whole number",
    ),
    "no crank": ({"crank": {}, "dyads": {"B": RRR}}, "crank is {}", '{"A": ("O", "a1")}'),
    "no pivot": ({"crank": {"A": ("Q", "a1")}, "dyads": {"B": RRR}}, "'Q' is no point", "known"),
    "no ground": ({"ground": 3, "dyads": {"B": RRR}}, "ground is 3", "write pivots"),
    "no dyads": ({"dyads": {}}, "dyads is {}", "write such as"),
    "no pivot and no dyads": ({"crank": {"A": ("Q", "a1")}, "dyads": 3}, "'Q' is no point", "known"),
    "driven by the ground": (
        {"dyads": {"E": {"gear": ("O", "D"), "about": "D", "ratio": 2, "length": "b"}}},
        "dyads.E.gear: O and D are of the ground",
        '"gear"',
    ),
    "no direction": (
        {"dyads": {"B": {"rpp": "A", "along": ("O", "O")}}},
        "dyads.B.along is O twice",
        "two points",
    ),
    "no slot": ({"dyads": {"B": {"rpr": ("A", "A")}}}, "dyads.B.rpr is A twice", '"rpr"'),
    "no angle": ({"dyads": {"B": {"rpp": "A", "along": ("O", ["D"])}}}, "dyads.B.along is ['D']", "a number"),
    "no pivot of a line": (
        {"dyads": {"B": RRR, "X": {"prp": (("A", "B"), ("Q", 0))}}},
        "dyads.X.prp: 'Q' is no point",
        "known",
    ),
    "no name": ({"name": "4 bar", "dyads": {"B": RRR}}, "name is '4 bar'", "letters"),
    "no default": ({"dyads": {"B": RRR}, "defaults": {"a1": "x"}}, "defaults.a1 is 'x'", "write a number"),
    "no defaults": ({"dyads": {"B": RRR}, "defaults": 3}, "defaults is 3", "write numbers"),
    "default of nothing": ({"dyads": {"B": RRR}, "defaults": {"b1": 1.0}}, "b1 is no input", "a1"),
    "no title": ({"dyads": {"B": RRR}, "title": 3}, "title is 3", "a text"),
    "an input called as a coordinate": (
        {"dyads": {"B": {"rrr": ("A", "D"), "lengths": ("A_x", "b")}}},
        "A_x is declared twice",
        "call one",
    ),
}


@pytest.mark.parametrize("case", REFUSED)
def test_a_declaration_that_is_none_is_refused(case: str) -> None:
    given, what, remedy = REFUSED[case]
    with pytest.raises(fl.InputError) as caught:
        fl.linkage(**{"ground": OD, "crank": {"A": ("O", "a1")}} | given)
    assert what in str(caught.value)
    assert remedy in str(caught.value)


def test_impossible_lengths_are_invalid_and_far_plates_never_assemble() -> None:
    declared, design, _ = KINDS["a plate by its sides"]
    plate = fl.linkage("plate", crank={"A": ("O", "a1")}, **declared)
    columns = fl.table(
        {name: [value, value] for name, value in design.items()} | {"a2": [-0.3, 0.3]}, allow_invalid=True
    )
    found = fl.sweep(plate, columns, ["B_x_max", "status"], branch=1, allow_invalid=True)
    words = found.status.attrs["flag_meanings"].split()
    assert [words[code] for code in found.status.values.ravel()] == ["invalid_input", "rotates_fully"]
    assert np.isnan(found.B_x_max.values.ravel()[0])


def with_one_changed(declared: Any, to: Any) -> Iterator[Any]:
    """Yield declarations of which one part, of any depth, is another."""
    yield to
    if isinstance(declared, dict):
        for key, part in declared.items():
            yield from (declared | {key: one} for one in with_one_changed(part, to))
    elif isinstance(declared, tuple):
        for k, part in enumerate(declared):
            yield from ((*declared[:k], one, *declared[k + 1 :]) for one in with_one_changed(part, to))


OF_STRESS = [3, 0.5, None, True, "", "no name", [], ["O", "A"], {}, {"O": 1}]


@pytest.mark.parametrize(
    "to", ["O", *(pytest.param(one, marks=pytest.mark.stress) for one in OF_STRESS)], ids=repr
)
@pytest.mark.parametrize("kind", KINDS)
def test_whatever_part_is_another_it_is_refused_with_a_remedy_or_means_something(kind: str, to: Any) -> None:
    declared = {"crank": {"A": ("O", "a1")}} | KINDS[kind][0]
    for changed in with_one_changed(declared, to):
        if not isinstance(changed, dict) or not {"ground", "crank", "dyads"} <= changed.keys():
            continue
        problems: list[Any] = []
        try:
            fl.linkage("changed", **changed)
        except fl.InputError as error:
            problems = error.problems
        assert all(one.remedy for one in problems), changed
