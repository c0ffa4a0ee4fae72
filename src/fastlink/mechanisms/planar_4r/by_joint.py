"""The planar 4R driven by any of its four joints.

Joint k stands between links k - 1 and k: O, A, B, D between links 4 and 1, 1 and 2, 2 and 3, 3 and 4. Seen from
link k - 1 and driven at joint k, the linkage is again a planar 4R, with crank a_k and the other lengths in cyclic
order; how the links move relative to each other does not depend on which of them is held. So every fact of the joints
is the same law under another name: what holds in `planar_4r` of joint i and length i holds of joint and length
i + k - 1, with joint_angle_k + pi for theta1.

Steps on the way are in the frame of link k - 1 and keep the names that they have in `planar_4r`. What belongs to
the linkage whichever joint is driven (its class, the input-output equations) is adopted as it is. Of quantities in
the ground frame the places of A, B and P are offered.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from functools import cache, partial

from fastlink.facts.catalogue import Catalogue
from fastlink.facts.fact import Fact, Input
from fastlink.facts.formula import Formula
from fastlink.facts.names import Derivative, Quantity
from fastlink.facts.sheet import read_sheets
from fastlink.mechanisms._shared.borrow import ByOtherInput, facts_of, with_derivatives
from fastlink.mechanisms.planar_4r import AT_ENDS, PAIRS, planar_4r

#: The inputs of the coupler point, and the places in the ground frame that are offered.
POINT = ("P_u", "P_v")
PLACES = tuple(f"{name}_{xy}" for name in "ABP" for xy in "xy")
#: Names that carry the number of a joint or a length.
NUMBERED = re.compile(
    r"(a|s|v|joint_angle_|joint_omega_|joint_alpha_|joint_[SCY])([1-4])(_slope|_dot|_ddot|)"
)
ORDINALS = ("first", "second", "third", "fourth")
RATES = {
    "joint_omega_": ("Rate", "d theta_{}/dt (eqs. 1-6)"),
    "joint_alpha_": ("Second derivative", "d2 theta_{}/dt2 (eqs. 1-6)"),
}
POINTS = ("O", "A", "B", "D")
LINKS = ("OA", "AB", "DB", "OD")

#: The quantities that are offered: of the driven joint and the others (moved), and of the linkage (kept).
MOVED = (
    *(f"joint_angle_{i}" for i in (2, 3, 4)),
    *(f"v{i}{of}" for i in (1, 2, 3, 4) for of in ("", "_dot", "_ddot")),
    *(f"joint_omega_{i}" for i in (2, 3, 4)),
    *(f"joint_alpha_{i}" for i in (2, 3, 4)),
    "transmission_angle",
    "loop_residual",
    "status",
)
#: The half-angles of which the residuals of the equations are made.
HALF_ANGLES = tuple(f"joint_{letter}{i}" for letter in "SCY" for i in (1, 2, 3, 4))
KEPT = (
    "grashof_class",
    "grashof_excess",
    *(f"io_residual_{pair}" for pair in PAIRS),
)


#: The driven joint angle in [0, 2 pi) at a place of the graded range: half a turn from theta1 there.
ANGLE_OF_PLACE = Formula(
    "joint_angle",
    ["side", "Z", "C"],
    [
        "half_turn = 2.0 * atan2(sqrt(C), sqrt(Z))",
        "mirrored = TWO_PI - half_turn",
        "return select(side < 0.0, half_turn, select(mirrored < TWO_PI, mirrored, 0.0))",
    ],
)


def moved_number(number: int, joint: int) -> int:
    """Return the joint or length of the linkage that is called `number` where `joint` is called 1."""
    return (number + joint - 2) % 4 + 1


def moved_name(name: str, joint: int) -> str:
    """Return the name of a fact of `planar_4r` where `joint` is driven."""
    if name == planar_4r.position.name:
        return f"joint_angle_{joint}"
    tree = planar_4r.parse(name)
    if isinstance(tree, Derivative) and tree.by == planar_4r.position.name:
        return str(Derivative(Quantity(moved_name(str(tree.of), joint)), moved_name(tree.by, joint)))
    if numbered := NUMBERED.fullmatch("joint_omega_1" if name == "omega1" else name):
        return f"{numbered[1]}{moved_number(int(numbered[2]), joint)}{numbered[3]}"
    # A and the factors of the equations keep their names; those of another cyclic order stand beside them
    return f"driven_{name}" if joint != 1 and name.startswith(("factor_", "sure_", "A_")) else name


def driven_by(joint: int) -> Catalogue:
    """Return the catalogue of the planar 4R with this joint's angle as input."""
    driven = _declared(joint)
    driven.closes = planar_4r.closes
    graded = planar_4r.graded
    assert graded is not None
    places = [fact for fact in planar_4r.variants[graded.name].values() if isinstance(fact, Fact)]
    of_places = {need for fact in places for need in fact.depends_on}.intersection(planar_4r.facts)
    of_ends = {graded.bounded_factor, *(name for end in graded.ends for name in end)}
    moved = (*MOVED, *PLACES) if joint == 1 else MOVED
    offered = {*KEPT, *(moved_name(name, joint) for name in moved)}
    for fact in with_derivatives(planar_4r, (*moved, "A_x", *HALF_ANGLES, *of_places, *of_ends)).values():
        found = _moved(fact, joint)
        driven.facts |= dict.fromkeys(found.names, replace(found, internal=found.name not in offered))
    for fact in facts_of(planar_4r, KEPT, driven.facts):
        driven.facts |= dict.fromkeys(fact.names, fact)
    if joint != 1:
        driven.facts |= {name: planar_4r.facts[name] for name in ("P_along", "P_across")}
        read_sheets(__file__, [f"places_{joint}", "places"], driven)
        for name in PLACES:
            driven.facts[name] = replace(driven.facts[name], meaning=planar_4r.facts[name].meaning)
    # Angles jump where they pass pi, where they have no derivative: their extremes are those over the given angles.
    angles = (f"joint_angle_{i}" for i in (1, 2, 3, 4))
    none = (*graded.not_differentiable, *angles)
    known = {name: AT_ENDS[name] for name in MOVED if name in AT_ENDS and name not in none}
    driven.graded = replace(graded, not_differentiable=none, known=known)
    placed = {fact.name: fact for fact in (_moved(place, joint) for place in places)}
    placed[driven.position.name] = replace(
        placed[driven.position.name], formula=ANGLE_OF_PLACE, depends_on=ANGLE_OF_PLACE.parameters
    )
    driven.variants[graded.name] = dict(placed)
    return driven


def driven_catalogues() -> dict[str, Callable[[], Catalogue]]:
    """Return a factory of the catalogue for each joint angle that may be the input, by its name: 10 ms each."""
    return {f"joint_angle_{joint}": cache(partial(driven_by, joint)) for joint in (1, 2, 3, 4)}


def _points(joint: int) -> tuple[str, str, str, str]:
    """Return the points that correspond to O, A, B, D where `joint` is driven."""
    first, second, third, fourth = (POINTS[moved_number(i, joint) - 1] for i in (1, 2, 3, 4))
    return first, second, third, fourth


def _declared(joint: int) -> Catalogue:
    """Return the catalogue with its inputs and tables."""
    point, left, opposite, right = _points(joint)
    angle = planar_4r.facts[f"joint_angle_{joint}"]
    far = f"joint_angle_{moved_number(3, joint)}"
    line = f"of the directed line from {left} to {right}"
    other = f"joint_angle_{moved_number(2, joint)}"
    driven = ByOtherInput(
        planar_4r,
        f"{planar_4r.title.removesuffix(POINTS[0])}{point}",
        branches={
            1: f"{far} from 0 to pi: {opposite} to the right {line}",
            2: f"{far} from -pi to 0: {opposite} to the left {line}",
        },
        position=Input(angle.name, angle.units, angle.symbol, angle.meaning),
        instead=(other, other.replace("angle", "omega"), other.replace("angle", "alpha")),
    )
    for i, link in enumerate(LINKS, 1):
        driven.inputs[f"a{i}"] = replace(planar_4r.inputs[f"a{i}"], meaning=f"length of the link {link}")
    omega = f"joint_omega_{joint}"
    symbol, meaning = f"d theta_{joint}/dt (eqs. 1-6)", "rate of the driven joint angle, constant"
    driven.declare_input(Input(omega, "rad s-1", symbol, meaning))
    driven.inputs |= {name: planar_4r.inputs[name] for name in POINT}
    tables = {name: table.formula for name, table in planar_4r.tables.items()}
    turned = {
        "cos_theta1": Formula("cos_theta1", ["angle"], ["return -cos(angle)"]),
        "sin_theta1": Formula("sin_theta1", ["angle"], ["return -sin(angle)"]),
        "Z": tables["C"],
        "C": tables["Z"],
    }
    for name, table in planar_4r.tables.items():
        meaning = f"{table.meaning} plus pi"
        driven.tables[name] = replace(table, formula=turned[name], depends_on=(angle.name,), meaning=meaning)
    driven.table_low_parts = dict(planar_4r.table_low_parts)
    return driven


def _moved(fact: Fact, joint: int) -> Fact:
    """Return a fact under the names that it has where `joint` is driven, with their labels."""
    name = moved_name(fact.name, joint)
    law = fact.renamed(lambda other: moved_name(other, joint))
    if name == "transmission_angle":
        _, left, far, right = _points(joint)
        return replace(law, meaning=f"Transmission angle; between {far}{left} and {far}{right}")
    numbered = NUMBERED.fullmatch(name)
    if numbered is None:
        return law
    family, number = numbered[1], int(numbered[2])
    if family in RATES:
        what, symbol = RATES[family]
        meaning = f"{what} of the {ORDINALS[number - 1]} joint angle"
        return replace(law, symbol=symbol.format(number), meaning=meaning)
    labels = planar_4r.facts[name]
    return replace(law, symbol=labels.symbol, meaning=labels.meaning, source=labels.source)
