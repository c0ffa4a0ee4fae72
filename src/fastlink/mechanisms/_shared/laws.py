"""Laws of facts in several mechanisms: products, quotients, signs, points along a direction."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import replace
from typing import Any

from fastlink.errors import InputError, Setting
from fastlink.facts.catalogue import Catalogue
from fastlink.facts.fact import Fact, Input
from fastlink.facts.names import Derivative, Quantity, innermost
from fastlink.numerics.compensated import power_of_two_below
from fastlink.numerics.elementary import INFINITY, NOT_A_NUMBER, PI, atan2, select
from fastlink.numerics.vectors import cross, largest, magnitude

__all__ = [
    "ACROSS",
    "ALONG",
    "KNOWN_OF_MABN",
    "ROUND_BAR",
    "ByOtherInput",
    "M_across",
    "M_along",
    "across",
    "bar_volume",
    "borrow",
    "borrow_range",
    "borrow_tables",
    "build_on",
    "declare",
    "facts_of",
    "renaming",
    "with_derivatives",
]


def same(x: Any) -> Any:
    """Return x."""
    return x


def opposite(x: Any) -> Any:
    """Return -x."""
    return -x


def twice(x: Any) -> Any:
    """Return 2 x."""
    return 2.0 * x


def half(x: Any) -> Any:
    """Return x/2."""
    return 0.5 * x


def square(x: Any) -> Any:
    """Return x^2."""
    return x * x


def size(x: Any) -> Any:
    """Return |x|."""
    return abs(x)


def total(x: Any, y: Any) -> Any:
    """Return x + y."""
    return x + y


def difference(x: Any, y: Any) -> Any:
    """Return x - y."""
    return x - y


def mean(x: Any, y: Any) -> Any:
    """Return the mean of two numbers."""
    return 0.5 * (x + y)


def product(x: Any, y: Any) -> Any:
    """Return x y."""
    return x * y


def opposite_product(x: Any, y: Any) -> Any:
    """Return -x y."""
    return -(x * y)


def twice_product(x: Any, y: Any) -> Any:
    """Return 2 x y."""
    return 2.0 * (x * y)


def square_difference(x: Any, y: Any) -> Any:
    """Return x^2 - y^2."""
    return (x - y) * (x + y)


def quotient(x: Any, y: Any) -> Any:
    """Return x/y."""
    return x / y


def along(start: Any, length: Any, direction: Any) -> Any:
    """Return the coordinate at a length along a direction from a point."""
    return start + length * direction


def turned_x(u: Any, v: Any, x: Any, y: Any) -> Any:
    """Return the first component of (u, v) in a frame whose first axis is (x, y): u x - v y."""
    return u * x - v * y


def turned_y(u: Any, v: Any, x: Any, y: Any) -> Any:
    """Return the second component: u y + v x."""
    return u * y + v * x


#: The product of two complex numbers, u + i v and x + i y.
turned = turned_x, turned_y


def norm(x: Any, y: Any) -> Any:
    """Return the length of a vector."""
    return magnitude(x, y)


def moment(x: Any, y: Any, F_x: Any, F_y: Any) -> Any:
    """Return the moment of a force at (x, y) about the origin."""
    return cross(x, y, F_x, F_y)


def angle(x: Any, y: Any) -> Any:
    """Return the angle of a vector in (-pi, pi]."""
    # + 0.0 turns -0.0 into 0.0, so that the straight angle is pi and never -pi.
    return atan2(y + 0.0, x)


# -- Laws of joints in the frame of a coupler AB: the x-axis from A towards B, the y-axis to its left


#: The meaning of a coordinate, of a joint.
ALONG, ACROSS = (
    "Joint {} in the frame of AB, from A towards B",
    "Joint {} in the frame of AB, to the left of AB",
)


def M_along(a: Any, u_x: Any, u_y: Any, e_x: Any, e_y: Any) -> Any:
    """Return how far the pivot of a bar MA is along AB from A."""
    return -(a * (u_x * e_x + u_y * e_y))


def M_across(a: Any, u_x: Any, u_y: Any, e_x: Any, e_y: Any) -> Any:
    """Return how far the pivot of a bar MA is to the left of AB."""
    return a * (u_x * e_y - u_y * e_x)


def AB_along(place: Any, a: Any, u_x: Any, u_y: Any, e_x: Any, e_y: Any) -> Any:
    """Return how far a point of the ground line is along AB from A."""
    return (place - a * u_x) * e_x - a * u_y * e_y


def across(place: Any, a: Any, u_x: Any, u_y: Any, e_x: Any, e_y: Any) -> Any:
    """Return how far a point of the ground line is to the left of AB."""
    return -((place - a * u_x) * e_y + a * u_y * e_x)


# -- Facts of the four lengths of a linkage, of whatever plane: validity, and a scale that is exact

# Lengths enter the kinematics as ratios only. They are first divided by a power of two near the longest,
# which keeps their products from overflow and underflow.


# Powers of two: beyond SMALL and LARGE the products of lengths need a lift.
SMALL, LARGE = 2.0**-500, 2.0**500
UP, DOWN = 2.0**540, 2.0**-540


def valid(a1: Any, a2: Any, a3: Any, a4: Any) -> Any:
    """1 where all four lengths are positive and finite, else NaN."""
    positive = (a1 > 0.0) & (a2 > 0.0) & (a3 > 0.0) & (a4 > 0.0)
    finite = (a1 < INFINITY) & (a2 < INFINITY) & (a3 < INFINITY) & (a4 < INFINITY)
    return select(positive & finite, 1.0, NOT_A_NUMBER)


def lift(a1: Any, a2: Any, a3: Any, a4: Any) -> Any:
    """A power of two that brings the longest link into the middle of the exponents."""
    longest = largest(a1, a2, a3, a4)
    return select(longest < SMALL, UP, select(longest > LARGE, DOWN, 1.0))


def unit(a1: Any, a2: Any, a3: Any, a4: Any, lift: Any) -> Any:
    """The power of two at or below the longest link, times lift."""
    return power_of_two_below(largest(a1, a2, a3, a4) * lift)


def scaled(length: Any, lift: Any, unit: Any) -> Any:
    """Length over the power of two near the longest."""
    return length * lift / unit


# -- Facts of one mechanism under the names that they have in another, which has it as a part


Renaming = Callable[[str], str]

#: What is known of the four-bar MABN, by names of the focal mechanism and of Hart's linkage: the quantity of the planar
#: 4R whose extremes are at the same places. P and Q are on MA and NB.
KNOWN_OF_MABN = {
    "psi": "theta4",
    "A_x": "A_x",
    "A_y": "A_y",
    "P_x": "A_x",
    "P_y": "A_y",
    "B_x": "B_x",
    "Q_x": "B_x",
}


def facts_of(lender: Catalogue, names: Iterable[str], known: Iterable[str] = ()) -> list[Fact]:
    """Return the facts that the names depend on, in order, except the known ones."""
    leaves = {*known, *lender.inputs, *lender.tables, *lender.table_low_parts, "branch"}
    return [step for step in lender.dependencies(names, leaves) if isinstance(step, Fact)]


def with_derivatives(lender: Catalogue, names: Iterable[str], known: Iterable[str] = ()) -> dict[str, Fact]:
    """Return the facts that the names depend on, with their declared derivatives."""
    facts: dict[str, Fact] = {}
    new = list(names)
    while new:
        found = {fact.name: fact for fact in facts_of(lender, new, (*known, *facts))}
        tables = {need for fact in found.values() for need in fact.depends_on}.intersection(lender.tables)
        slopes = [
            str(Derivative(Quantity(name), by))
            for name in (*found, *sorted(tables))
            for by in lender.variables
        ]
        declared = {name: lender.facts[name] for name in slopes if name in lender.facts}
        facts |= found | declared
        depends_on = {need for fact in declared.values() for need in fact.depends_on}
        new = sorted(depends_on.intersection(lender.facts).difference(facts, known))
    return facts


def renaming(lender: Catalogue, names: Mapping[str, str], prefix: str) -> Renaming:
    """Return a renaming: some names by a mapping, derivatives by their parts, all others by a prefix."""

    def rename(name: str) -> str:
        if name in names or name == "branch":
            return names.get(name, name)
        tree = lender.parse(name)
        if isinstance(tree, Derivative):
            return str(Derivative(Quantity(rename(str(tree.of))), rename(tree.by)))
        return prefix + name

    return rename


def borrow_tables(borrower: Catalogue, lender: Catalogue, names: Mapping[str, str]) -> None:
    """Declare tables of one mechanism in another, those that `names` has, by their names there."""
    position, symbol = borrower.position.name, borrower.position.symbol
    for name, table in lender.tables.items():
        if name in names:
            symbols = table.symbol.replace(lender.position.symbol, symbol)
            here = replace(table, name=names[name], depends_on=(position,), symbol=symbols)
            borrower.tables[here.name] = here
    for low, high in lender.table_low_parts.items():
        if low in names:
            borrower.table_low_parts[names[low]] = names[high]


def borrow(
    borrower: Catalogue,
    lender: Catalogue,
    names: Mapping[str, str],
    prefix: str,
    labels: Mapping[str, Mapping[str, Any]],
) -> None:
    """Declare facts of one mechanism in another, with their dependencies and declared derivatives.

    `names` are the borrower's for the lender's inputs, position, tables and some facts; others get the prefix. A fact
    that the borrower has already is its own. `labels` has the facts that are public here, and what differs in them.
    """
    rename = renaming(lender, names, prefix)
    own = [name for name, other in names.items() if other in borrower.facts]
    for name, fact in with_derivatives(lender, labels, own).items():
        own_labels = {"internal": fact.internal, **labels[name]} if name in labels else {"internal": True}
        found = replace(fact.renamed(rename), **own_labels)
        for each in found.names:
            borrower.facts.setdefault(each, found)


def borrow_range(
    borrower: Catalogue,
    lender: Catalogue,
    names: Mapping[str, str],
    prefix: str,
    known: Mapping[str, str],
    **fields: Any,
) -> None:
    """Declare the graded range of one mechanism in another, with all that it needs, see `borrow`.

    `known` has for quantities of the borrower those of the lender with extremes at the same places.
    """
    graded = lender.graded
    assert graded is not None
    rename = renaming(lender, {leaf: leaf for leaf in graded.coordinates} | dict(names), prefix)
    places = [fact for fact in lender.variants[graded.name].values() if isinstance(fact, Fact)]
    needed = {need for fact in places for need in fact.depends_on}.intersection(lender.facts)
    needed |= {graded.bounded_factor, graded.reciprocal, *(name for end in graded.ends for name in end)}
    at = {name: graded.known[lent] for name, lent in known.items()}
    needed |= {fact for of in at.values() for fact in of.facts}
    borrow(borrower, lender, names, prefix, {name: {} for name in sorted(needed)})
    borrower.variants[graded.name] = {rename(fact.name): fact.renamed(rename) for fact in places}
    (low, high) = graded.ends
    borrower.graded = replace(
        graded,
        ends=(
            (rename(low[0]), rename(low[1]), rename(low[2])),
            (rename(high[0]), rename(high[1]), rename(high[2])),
        ),
        antisymmetric=tuple(map(rename, graded.antisymmetric)),
        vanishes_at_toggle=rename(graded.vanishes_at_toggle),
        reciprocal=rename(graded.reciprocal),
        bounded_factor=rename(graded.bounded_factor),
        known={name: of.renamed(rename) for name, of in at.items()},
        **fields,
    )


def build_on(
    catalogue: Catalogue,
    variant: str,
    name: str,
    law: Callable[..., Any],
    *,
    source: str | None = None,
    **given: str,
) -> None:
    """Declare a fact of a variant that builds on the one it replaces, the law's parameter `replaced`."""
    base = catalogue.facts[name]
    catalogue.quantity(
        units=base.units,
        symbol=base.symbol,
        source=source or base.source,
        internal=True,
        variant=variant,
        name=name,
        meaning=base.meaning,
        given={"replaced": name, **given},
    )(law)


# -- A mechanism driven by another of its inputs than the first: fewer quantities, and why others are
#    missing


class ByOtherInput(Catalogue):
    """The catalogue of a mechanism by another input; messages name `instead` where a quantity is not offered."""

    def __init__(
        self,
        first: Catalogue,
        title: str,
        branches: Mapping[int, str],
        position: Input,
        positions: tuple[float, float, int] | None = None,
        *,
        instead: Iterable[str],
    ) -> None:
        super().__init__(f"{first.name} driven by {position.name}", title, branches, position, positions)
        self.first, self.instead = first, tuple(instead)
        self.keywords = first.keywords

    def absence(self, name: str) -> InputError | None:
        """Return why a name is not offered by this input."""
        if name in self.inputs:
            what = f"quantity {name!r} is given, and a coordinate of the result"
            return InputError(what, remedy="leave it out")
        if not self.is_of_position(name) and innermost(name, self.first) in self.first.public:
            what = f"quantity {name!r} is defined for input {self.first.position.name!r} alone"
            here = ("with ", Setting("input", self.position.name), " ")
            instead = ", ".join(map(repr, self.instead))
            return InputError(what, remedy=(here, f"ask for such as {instead}, or leave input out"))
        return super().absence(name)

    def adopt_design_facts(self, further: Collection[str] = ()) -> None:
        """Adopt the facts of the design as a whole, and further ones that hold for every input."""
        for name, fact in self.first.facts.items():
            of_design = not (self.first.is_derivative(name) or self.first.varies(name))
            if of_design or name in further:
                self.facts.setdefault(name, fact)


# -- Links made of a round bar: masses, inertias and mass centres from the lengths


ROUND_BAR = "round_bar"
SOURCE = "Hayes, Hninn, Irani, Table 1"


def bar_mass_per_length(density: Any, radius: Any) -> Any:
    """Mass of a round bar per length."""
    return density * PI * (radius * radius)


def bar_section(radius: Any) -> Any:
    """Squared radius of gyration of the round section about a diameter."""
    return 0.25 * (radius * radius)


def bar_volume(length: Any, radius: Any) -> Any:
    """Volume of a solid cylinder."""
    return PI * (radius * radius) * length


def bar_mass(length: Any, bar_mass_per_length: Any) -> Any:
    """Mass of a solid cylinder."""
    return bar_mass_per_length * length


def bar_inertia(mass: Any, length: Any, bar_section: Any) -> Any:
    """Moment of inertia of a solid cylinder about a transverse axis through its centre."""
    return mass * (length * length / 12.0 + bar_section)


def mid_length(length: Any) -> Any:
    """Half the length."""
    return 0.5 * length


def on_axis(length: Any) -> Any:
    """Zero, in the length's unit and reading."""
    return 0.0 * length


def declare(catalogue: Catalogue, bars: Mapping[int, tuple[str, str]]) -> None:
    """Declare `ROUND_BAR`: masses, inertias and centres of links, `bars` having the name and length of each."""
    step = catalogue.steps(units="m2", source=SOURCE, variant=ROUND_BAR)
    bar = catalogue.quantities(units="m", source=SOURCE, variant=ROUND_BAR)
    for name, units, symbol, meaning in (
        ("density", "kg m-3", "rho", "density of the round bars"),
        ("radius", "m", "r_b", "radius of the round bars"),
    ):
        catalogue.input(
            name, units=units, symbol=symbol, meaning=meaning, rule="non-negative", variant=ROUND_BAR
        )
    step(bar_mass_per_length, "bar_mass_per_length", "rho pi r_b^2", units="kg m-1")
    step(bar_section, "bar_section", "r_b^2/4")
    for i, (link, a) in bars.items():
        about = f"moment of inertia of the {link} about its centre"
        bar(bar_mass, f"m{i}", f"m_{i}", f"mass of the {link}", length=a, units="kg")
        bar(bar_inertia, f"I{i}", f"I_{i}", about, mass=f"m{i}", length=a, units="kg m2")
        bar(mid_length, f"G{i}_u", f"G_{i}u", f"mass centre of the {link} at mid-length", length=a)
        bar(on_axis, f"G{i}_v", f"G_{i}v", f"mass centre of the {link} on its axis", length=a)
