"""Facts of one mechanism in another, which has it as a part, and mechanisms driven by another of their inputs."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import replace
from typing import Any

from fastlink.errors import InputError, Setting
from fastlink.facts.catalogue import Catalogue
from fastlink.facts.fact import Fact, Input
from fastlink.facts.names import Derivative, Quantity, innermost

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
#: And those of the planar 4R whose searches theirs are as long as.
SEARCHED_OF_MABN = {"psi": "theta4", "dpsi_dphi": "omega4"}


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
    borrower: Catalogue, lender: Catalogue, names: Mapping[str, str], prefix: str, **fields: Any
) -> None:
    """Declare the graded range of the four-bar MABN, with all that it needs, in another mechanism; see `borrow`."""
    graded = lender.graded
    assert graded is not None
    rename = renaming(lender, {leaf: leaf for leaf in graded.coordinates} | dict(names), prefix)
    places = [fact for fact in lender.variants[graded.name].values() if isinstance(fact, Fact)]
    needed = {need for fact in places for need in fact.depends_on}.intersection(lender.facts)
    needed |= {graded.bounded_factor, graded.reciprocal, *(name for end in graded.ends for name in end)}
    at = {name: graded.known[lent] for name, lent in KNOWN_OF_MABN.items()}
    needed |= {fact for of in at.values() for fact in of.facts}
    borrow(borrower, lender, names, prefix, {name: {} for name in sorted(needed)})
    borrower.variants[graded.name] = {rename(fact.name): fact.renamed(rename) for fact in places}
    ends: Any = tuple(tuple(map(rename, end)) for end in graded.ends)
    borrower.graded = replace(
        graded,
        ends=ends,
        antisymmetric=tuple(map(rename, graded.antisymmetric)),
        vanishes_at_toggle=rename(graded.vanishes_at_toggle),
        reciprocal=rename(graded.reciprocal),
        bounded_factor=rename(graded.bounded_factor),
        cells={name: graded.cells[lent] for name, lent in SEARCHED_OF_MABN.items()},
        max_extrema={name: graded.max_extrema[lent] for name, lent in SEARCHED_OF_MABN.items()},
        known={name: of.renamed(rename) for name, of in at.items()},
        **fields,
    )


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
