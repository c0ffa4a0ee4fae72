"""Every kind of dyad against the loops of its declaration; what is refused, where, and with what remedy."""

import numpy as np
import pytest

import fastlink as fl

O, OD = {"O": (0, 0)}, {"O": (0, 0), "D": ("a4", 0)}
RRR = {"rrr": ("A", "D"), "lengths": ("a2", "a3")}
CRANK = {"crank": {"A": ("O", "a1")}}
FOUR_BAR = {"a1": 0.1, "a2": 0.3, "a3": 0.35, "a4": 0.4}


def of_crank(ground=OD, **dyads):
    """Return the declaration of dyads on a crank and pivots."""
    return {"ground": ground, "dyads": dyads}


def of_four_bar(**dyads):
    """Return the declaration of dyads on a four-bar."""
    return of_crank(B=RRR, **dyads)


#: Each kind: its declaration, a design, and how many branches there are.
KINDS = {
    "rrp": (
        of_crank(O | {"C": ("c", 0.1)}, B={"rrp": "A", "length": "l", "along": ("C", "beta")}),
        {"a1": 0.1, "l": 0.3, "c": 0.02, "beta": 0.4},
        2,
    ),
    "rrp on a moving line": (
        of_four_bar(
            P={"on": ("D", "B"), "at": ("p", "q_left")}, S={"rrp": "A", "length": "l", "along": ("P", "B")}
        ),
        FOUR_BAR | {"p": 0.1, "q_left": 0.05, "l": 0.5},
        4,
    ),
    "rpr": (
        of_crank(
            O | {"C": (0, "d")},
            lever={"rpr": ("A", "C"), "offset": "e"},
            Q={"on": "lever", "at": (0.6, 0.01)},
        ),
        {"a1": 0.1, "d": -0.3, "e": 0.02},
        2,
    ),
    "rpp": (
        of_crank(O, Y={"rpp": "A", "along": ("O", 0.2), "angle": "slope_of_slot"}),
        {"a1": 0.1, "slope_of_slot": 1.2},
        1,
    ),
    "rpp on a moving line": (
        of_four_bar(
            Y={"rpp": "A", "along": ("D", "B"), "angle": "slope_of_slot"}, Z={"rpp": "Y", "along": ("D", "B")}
        ),
        FOUR_BAR | {"slope_of_slot": 1.1},
        2,
    ),
    "rpp on lines of two pivots": (
        of_crank(
            OD | {"E": (0, 0.2)}, Y={"rpp": "A", "along": ("O", "D")}, Z={"rpp": "A", "along": ("E", "O")}
        ),
        {"a1": 0.1, "a4": 0.4},
        1,
    ),
    "prp of two links": (of_four_bar(X={"prp": (("D", "B"), ("O", "A"))}), FOUR_BAR, 2),
    "prp": (of_four_bar(X={"prp": (("A", "B"), ("D", "gamma"))}), FOUR_BAR | {"gamma": -0.3}, 2),
    "a plate by its sides": (
        of_four_bar(P={"on": ("A", "B"), "lengths": ("d", "e"), "side": "right"}),
        FOUR_BAR | {"d": 0.2, "e": 0.25},
        2,
    ),
    "gear": (
        of_crank(
            E={"gear": ("O", "A"), "about": "D", "ratio": -2, "length": "b", "phase": "f"},
            F={"rrr": ("A", "E"), "lengths": ("a2", "a3")},
        ),
        FOUR_BAR | {"b": 0.08, "a2": 0.4, "a4": 0.3, "f": 0.3},
        2,
    ),
    "gear on a crank": (
        of_crank(
            E={"gear": ("O", "D"), "about": "A", "ratio": -3, "length": "b", "phase": "f"},
            F={"rrr": ("E", "D"), "lengths": ("a2", "a3")},
            H={"gear": ("E", "F"), "about": "A", "ratio": 2, "length": "b"},
        ),
        FOUR_BAR | {"b": 0.08, "a2": 0.4, "a3": 0.45, "f": 0.3},
        2,
    ),
    "slider that drives": (
        of_crank(
            O | {"D": (0.3, 0.4)},
            B={"rrr": ("A", "D"), "lengths": (0.35, 0.3)},
            lever={"rpr": ("B", "O"), "offset": 0.02},
        )
        | {"slider": {"A": {"along": ("O", 0.3), "stroke": ("s1", "s2")}}},
        {"s1": 0.1, "s2": 0.25},
        4,
    ),
    "all of them": (
        of_crank(
            OD | {"C": (0.1, -0.3)},
            B=RRR,
            P={"on": ("A", "B"), "at": (0.1, 0.05)},
            lever={"rpr": ("P", "C")},
            Q={"on": "lever", "at": (0.5, 0.02)},
            second={"rpr": ("B", "Q"), "offset": 0.01},
            R={"rrr": ("Q", "D"), "lengths": (0.6, 0.7)},
            E={"gear": ("D", "B"), "about": "C", "ratio": 2, "length": 0.1},
            H={"rrr": ("E", "R"), "lengths": (0.7, 0.8)},
        ),
        FOUR_BAR,
        16,
    ),
}
EACH = [kind for kind in KINDS if kind != "all of them"]


def body(k):
    """Return the mass of a link, unlike that of others."""
    return {"mass": 1.0 + 0.3 * k, "inertia": 0.01 * (1 + k), "centre": (0.05 + 0.01 * k, 0.02 - 0.01 * k)}


#: Masses and loads of each kind: of every link, in points, and on both.
LOADED = {
    "rrp": ({"AB": body(1), "B": 2.0}, {"B": (3.0, -2.0), "AB": 1.5}),
    "rrp on a moving line": (
        {"AB": body(1), "DB": body(2), "AS": body(3), "S": 0.7, "P": 0.2},
        {"S": (3.0, -2.0), "DB": 1.5, "P": (1.0, 2.0)},
    ),
    "rpr": ({"lever": body(1), "Q": 2.0}, {"Q": (3.0, -2.0), "lever": 1.5}),
    "rpp": ({"sliderY": body(1), "Y": 2.0}, {"Y": (3.0, -2.0)}),
    "rpp on a moving line": (
        {"AB": body(1), "DB": body(2), "sliderY": body(3), "Y": 1.0, "sliderZ": body(1)},
        {"Y": (1.0, 2.0), "sliderY": 3.0},
    ),
    "prp": ({"AB": body(1), "DB": body(2), "X": 2.0}, {"X": (3.0, -2.0)}),
    "rpp on lines of two pivots": ({"Y": 2.0, "sliderZ": body(1)}, {"Z": (3.0, -2.0)}),
    "prp of two links": ({"AB": body(1), "DB": body(2), "X": 1.0}, {"X": (1.0, 2.0)}),
    "a plate by its sides": ({"AB": body(1), "DB": body(2), "P": 2.0}, {"P": (3.0, -2.0)}),
    "gear": ({"DE": body(1), "AF": body(2), "EF": "round_bar"}, {"F": (3.0, -2.0), "DE": 0.3}),
    "gear on a crank": (
        {"AE": body(1), "EF": body(2), "DF": body(1), "AH": body(3)},
        {"F": (3.0, -2.0), "AH": 0.3, "AE": 0.2},
    ),
    "slider that drives": (
        {"A": 1.5, "AB": body(1), "DB": body(2), "lever": body(3)},
        {"B": (3.0, -2.0), "lever": 0.3},
    ),
    "all of them": (
        {"AB": body(1), "DB": body(2), "lever": body(3), "second": body(1), "QR": body(2), "EH": body(2)}
        | {"Q": 1.0, "DR": "round_bar", "CE": body(1)},
        {"Q": (1.0, 2.0), "second": 3.0, "H": (2.0, 3.0)},
    ),
}


def loaded(kind):
    """Return the mechanism of a kind with masses, loads and gravity, three designs, its quantities, a model of bars."""
    declared, design, _ = KINDS[kind]
    masses, loads = LOADED[kind]
    mechanism = fl.linkage(
        kind.split()[0] + "_1",
        masses=masses if "slider" in declared else {"OA": body(0)} | masses,
        loads=loads,
        gravity=(0.5, -9.81),
        **({} if "slider" in declared else CRANK),
        **declared,
    )
    varied = {name: value * np.array([1.0, 1.03, 0.97]) for name, value in design.items()} | {"omega": 3.0}
    of_bars = {"links": fl.round_bar(density=7800.0, radius=0.01)} if "round_bar" in masses.values() else {}
    every = [one.name for one in fl.quantities(mechanism) if "theta" not in one.name and one.name != "status"]
    return mechanism, varied, every, of_bars


@pytest.mark.sample(6)
@pytest.mark.parametrize("kind", [*EACH, pytest.param("all of them", marks=pytest.mark.stress)])
def test_motion_and_forces_are_those_of_the_loops_and_of_all_links_at_once(kind, tmp_path):
    mechanism, varied, every, of_bars = loaded(kind)
    branch = tuple({1, min(2, KINDS[kind][2]), KINDS[kind][2]})
    maps = fl.sweep(mechanism, varied, every, branch=branch, positions=12, to=tmp_path / "maps.h5", **of_bars)
    assert maps.attrs["verify_mismatches"] == 0
    told = {name: maps[name].attrs.get("independent_max_difference") for name in every}
    # the angles of transmission alone have no loop, and are in no equation of forces
    assert {name for name in every if told[name] is None} == {one for one in every if "transmission" in one}
    assert max(difference for difference in told.values() if difference is not None) < 1e-40
    assert all(np.isfinite(maps[name]).any() for name in every)


@pytest.mark.stress
@pytest.mark.parametrize("kind", KINDS)
def test_the_equations_of_all_links_by_kernels_are_solved_by_the_dyads(kind):
    mechanism, varied, every, of_bars = loaded(kind)
    forces = [name for name in every if any(word in name for word in ("force", "torque", "moment"))]
    branch = tuple({1, min(2, KINDS[kind][2]), KINDS[kind][2]})
    by_dyads, at_once = (
        fl.sweep(mechanism, varied, forces, branch=branch, positions=24, solver=one, verify=2, **of_bars)
        for one in ("eliminated", "dense")
    )
    assert at_once.attrs["verify_mismatches"] == 0
    # components may vanish in one way, and be the rounding of others in the other
    size = max(float(abs(by_dyads[name]).max()) for name in forces)
    for name in forces:
        # up to 30 equations, whose condition is some ten at the distance from limits that 24 positions leave
        assert float(abs(by_dyads[name] - at_once[name]).max()) <= 30 * 64 * 2.0**-52 * size


def at_B(**words):
    return {"dyads": {"B": words}}


#: What is declared otherwise than a four-bar, what is said of it, and the remedy.
REFUSED = {
    "one link": (
        at_B(rrr=("O", "D"), lengths=("a", "b")),
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
        "dyads.B.rrr: C stands on B itself: B, C are an Assur group of higher class",
        "stands on points before it",
    ),
    "later, in another order": (
        {"dyads": {"B": {"rrr": ("A", "C"), "lengths": ("a", "b")}, "C": RRR}},
        "dyads.B.rrr: C is placed later",
        "declare C before it",
    ),
    "no point": (at_B(rrr=("A", "X"), lengths=("a", "b")), "'X' is no point", "known"),
    "no kind": (at_B(lengths=("a", "b")), "has no kind", "write one of"),
    "no lengths": (at_B(rrr=("A", "D")), "has no 'lengths'", '"lengths"'),
    "unknown word": (
        at_B(rrr=("A", "D"), length=("a", "b")),
        "'length' is unknown",
        "did you mean 'lengths'",
    ),
    "a word of ours": (at_B(rrr=("A", "D"), lengths=("i", "b")), "'i' is a word", "my_i"),
    "no number": (at_B(rrr=("A", "D"), lengths=(True, "b")), "is True", "a number"),
    "placed twice": ({"dyads": {"A": RRR}}, "A is placed twice", "call one"),
    "two units": (
        at_B(rrp="A", length="l", along=("D", "l")),
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
        "is 1.5: the motion goes on for several turns",
        "a whole number",
    ),
    "no crank": ({"crank": {}}, "crank is {}", '{"A": ("O", "a1")}'),
    "no such link": ({"masses": {"AX": 1}}, "masses.AX is no link", "did you mean"),
    "no mass": ({"masses": {"AB": {"centre": (0, 0)}}}, "masses.AB has no 'mass'", '"m2"'),
    "no centre": ({"masses": {"AB": {"mass": 1}}}, "masses.AB has no 'centre'", '"centre"'),
    "mass of a link as a number": ({"masses": {"AB": 2}}, "masses.AB is 2", "round_bar"),
    "no bar": (
        {"dyads": {"lever": {"rpr": ("A", "D")}}, "masses": {"lever": "round_bar"}},
        "masses.lever is 'round_bar'",
        "for a bar of two pins",
    ),
    "negative mass": ({"masses": {"B": -1}}, "masses.B is -1.0, not non-negative", "write another"),
    "force on a link": ({"loads": {"AB": (1, 2)}}, "loads.AB is [1, 2]", "or a number"),
    "torque on a point": ({"loads": {"B": 3}}, "loads.B is 3", "two components"),
    "load on the ground": ({"loads": {"D": (1, 2)}}, "loads.D is no link and no point", "did you mean"),
    "gravity of one number": ({"gravity": 9.81}, "gravity is 9.81", "two components"),
    "a unit in a name": ({"loads": {"B": (0, "F_kN")}}, "loads.B is 'F_kN', which ends in", "call it 'F'"),
    "degrees in a name": (
        at_B(rrp="A", length="l", along=("D", "beta_deg")),
        "dyads.B.along is 'beta_deg', which ends in a unit",
        "give 'beta_deg'",
    ),
    "gravity alone": ({"gravity": (0, -9.81)}, "gravity: pulls at nothing", "declare masses="),
    "a link backwards": ({"masses": {"BA": 1}}, "masses.BA is no link", "write 'AB'"),
    "a point of a bar": ({"masses": {"B": "round_bar"}}, "and B is a point", "write its mass"),
    "a number in quotes": ({"masses": {"B": "1.5"}}, "masses.B is '1.5'", "without quotes"),
    "a name of ours": ({"name": "hart"}, "name: 'hart' is a mechanism", "call it otherwise"),
    "no drive": ({"crank": None}, "linkage has no drive", "slider="),
    "two drives": ({"slider": {"A": {}}}, "linkage has two drives", "or slider="),
    "no stroke": ({"crank": None, "slider": {"A": ("O", 0)}}, "slider.A is ['O', 0]", '"stroke"'),
    "no ground": ({"ground": 3}, "ground is 3", "write pivots"),
    "no dyads": ({"dyads": {}}, "dyads is {}", "write such as"),
    "no pivot and no dyads": ({"crank": {"A": ("Q", "a1")}, "dyads": 3}, "'Q' is no point", "known"),
    "driven by the ground": (
        {"dyads": {"E": {"gear": ("O", "D"), "about": "D", "ratio": 2, "length": "b"}}},
        "dyads.E.gear: O, D and D are of one link, on which nothing turns",
        '"gear"',
    ),
    "two pivots in one place": (
        {"ground": OD | {"E": (0, 0)}, "dyads": {"Y": {"rpp": "A", "along": ("O", "E")}}},
        "dyads.Y: O and E are in one place",
        "that are apart",
    ),
    "no direction": (at_B(rpp="A", along=("O", "O")), "dyads.B.along is O twice", "two points"),
    "no slot": (at_B(rpr=("A", "A")), "dyads.B.rpr is A twice", '"rpr"'),
    "no angle": (at_B(rpp="A", along=("O", ["D"])), "dyads.B.along is ['D']", "a number"),
    "no pivot of a line": (
        {"dyads": {"B": RRR, "X": {"prp": (("A", "B"), ("Q", 0))}}},
        "dyads.X.prp: 'Q' is no point",
        "known",
    ),
    "no name": ({"name": "4 bar"}, "name: '4 bar' cannot be a name", "letters"),
    "no default": ({"defaults": {"a1": "x"}}, "defaults.a1 is 'x'", "write a number"),
    "no defaults": ({"defaults": 3}, "defaults is 3", "write numbers"),
    "default of nothing": ({"defaults": {"b1": 1.0}}, "b1 is no input", "a1"),
    "no title": ({"title": 3}, "title is 3", "a text"),
    "an input called as a coordinate": (
        at_B(rrr=("A", "D"), lengths=("A_x", "b")),
        "A_x is declared twice",
        "call one",
    ),
}


@pytest.mark.parametrize("case", REFUSED)
def test_a_declaration_that_is_none_is_refused(case):
    given, what, remedy = REFUSED[case]
    with pytest.raises(fl.InputError) as caught:
        fl.linkage(**{"ground": OD, "dyads": {"B": RRR}} | CRANK | given)
    assert what in str(caught.value)
    assert remedy in str(caught.value)


def test_impossible_lengths_are_invalid_and_far_plates_never_assemble():
    declared, design, _ = KINDS["a plate by its sides"]
    plate = fl.linkage("plate", crank={"A": ("O", "a1")}, **declared)
    columns = fl.table(
        {name: [value, value] for name, value in design.items()} | {"a2": [-0.3, 0.3]}, allow_invalid=True
    )
    found = fl.sweep(plate, columns, ["B_x_max", "status"], branch=1, allow_invalid=True)
    words = found.status.attrs["flag_meanings"].split()
    assert [words[code] for code in found.status.values.ravel()] == ["invalid_input", "rotates_fully"]
    assert np.isnan(found.B_x_max.values.ravel()[0])


def test_a_stroke_may_go_backwards_and_angles_in_degrees_are_remarked_on():
    drive = {"A": {"along": ("O", 0.0), "stroke": ("s_1", "s_2")}}
    lift = fl.linkage(ground=O, slider=drive, dyads={"M": {"rrr": ("A", "O"), "lengths": (0.5, 0.5)}})
    there, back = (
        fl.evaluate(lift, ["M_y"], s_1=one, s_2=two, omega=1.0, branch=1, theta=np.array([0.7, np.pi - 0.7]))[
            "M_y"
        ]
        for one, two in ((0.4, 0.9), (0.9, 0.4))
    )
    # numbers below 1, each of some ten roundings
    assert np.allclose(there, back[::-1], rtol=0, atol=16 * 2.0**-52)
    along = {"rrp": "A", "length": "l", "along": ("D", 90)}
    with pytest.warns(fl.InputWarning, match=r"if these are degrees, write 1\.5708"):
        fl.linkage(ground=OD, **CRANK, dyads={"B": along})
    with pytest.warns(fl.InputWarning, match=r"beta is 45.*write 0\.785398"):
        fl.linkage(ground=OD, **CRANK, dyads={"B": along | {"along": ("D", "beta")}}, defaults={"beta": 45})


def with_one_changed(declared, to):
    """Yield declarations of which one part, of any depth, is another."""
    yield to
    if isinstance(declared, dict):
        for key, part in declared.items():
            yield from (declared | {key: one} for one in with_one_changed(part, to))
    elif isinstance(declared, tuple):
        for k, part in enumerate(declared):
            yield from ((*declared[:k], one, *declared[k + 1 :]) for one in with_one_changed(part, to))


OF_STRESS = [3, 0.5, None, True, "", "no name", [], ["O", "A"], {}, {"O": 1}]
CHANGED = [(kind, "O") for kind in ("rrp", "rpr", "rpp", "slider that drives")]
CHANGED += [
    pytest.param(kind, to, marks=pytest.mark.stress)
    for kind in KINDS
    for to in ("O", *OF_STRESS)
    if (kind, to) not in CHANGED
]


@pytest.mark.parametrize(("kind", "to"), CHANGED)
def test_whatever_part_is_another_it_is_refused_with_a_remedy_or_means_something(kind, to):
    masses, loads = LOADED[kind]
    forces = {"masses": masses, "loads": loads, "gravity": (0, "g")}
    declared = ({} if "slider" in KINDS[kind][0] else CRANK) | KINDS[kind][0]
    declared |= forces if to in (3, 0.5, None, True, "", [], {}) or kind in ("rpr", "gear") else {}
    for changed in with_one_changed(declared, to):
        if not isinstance(changed, dict) or not {"ground", "dyads"} < changed.keys():
            continue
        problems = []
        try:
            fl.linkage("changed", **changed)
        except fl.InputError as error:
            problems = error.problems
        assert all(one.remedy for one in problems), changed
