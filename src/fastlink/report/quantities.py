"""List the quantities and inputs of a mechanism, from its catalogue.

``python -m fastlink.report.quantities > docs/quantities.md`` writes the documentation of all mechanisms.
"""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterable, Sequence
from dataclasses import astuple, dataclass, fields

from fastlink._text import folded
from fastlink.catalogue.catalogue import Catalogue, Fact, Input
from fastlink.doors import door
from fastlink.facts.names import Derivative, ErrorBound, ListOfExtrema, Reduced, Trust
from fastlink.facts.names import Quantity as Plain
from fastlink.mechanisms import NAMES
from fastlink.mechanisms import catalogue as find_catalogue
from fastlink.plan.pointwise import make_program
from fastlink.plan.reductions import REDUCTIONS
from fastlink.plan.validate import RULES

__all__ = ["GivenInput", "Quantity", "QuantityList", "quantities"]

DESIGN, BRANCH = "design", "branch"
NAME = Plain("NAME")
COMPONENT = re.compile("_[xy]$")
MEANING_WIDTH, SOURCE_WIDTH = 46, 34


@dataclass(frozen=True)
class Quantity:
    """One quantity of a mechanism.

    Attributes
    ----------
    name : str
        Its name, which is that of the variable in the result.
    units : str
        UDUNITS text; ``1`` for a pure number or a code.
    dims : tuple of str
        Dimensions in the result; ``design`` stands for the swept dimensions.
    meaning, source : str
        Its definition, and where its formula stands.
    """

    name: str
    units: str
    dims: tuple[str, ...]
    meaning: str
    source: str


@dataclass(frozen=True)
class GivenInput:
    """One input: name, units, allowed values, meaning, and the links that give it."""

    name: str
    units: str
    allowed: str
    meaning: str
    links: str


class QuantityList(list[Quantity]):
    """The quantities of a mechanism: a list that prints as a table.

    Attributes
    ----------
    mechanism : str
        Its name.
    inputs : list of GivenInput
        The inputs that make up a design.
    """

    def __init__(self, rows: Iterable[Quantity], catalogue: Catalogue) -> None:
        super().__init__(rows)
        self.mechanism = catalogue.name
        self.inputs = _inputs(catalogue)
        self._catalogue = catalogue

    def __repr__(self) -> str:
        return "\n\n".join(
            (
                f"{self.mechanism}: {self._catalogue.title}",
                _text_table(_header(Quantity), self._cells()),
                textwrap.fill(self._naming().replace("`", ""), 110),
                "Inputs; only those that the requested quantities depend on are needed:",
                _text_table(_header(GivenInput), [astuple(given) for given in self.inputs]),
            )
        )

    __str__ = __repr__

    def markdown(self) -> str:
        """Return the list as Markdown, as it stands in the documentation."""
        branches = self._catalogue.branches.items()
        return "\n\n".join(
            (
                f"## `{self.mechanism}`",
                f"{self._catalogue.title}. Assembly modes:",
                "\n".join(f"- `branch` {number}: {meaning}" for number, meaning in branches),
                "### Quantities",
                _markdown_table(_header(Quantity), self._cells()),
                self._naming(),
                "### Inputs",
                "Any input can be swept. Only the inputs that the requested quantities depend on are needed. Inputs "
                "that a model of links gives need not be given; if they are, they replace the model's. Inputs with a "
                "default belong to a load or a further motion, which exists only if one of its inputs is given.",
                _markdown_table(_header(GivenInput), [astuple(given) for given in self.inputs]),
            )
        )

    def _cells(self) -> list[tuple[str, ...]]:
        return [(row.name, row.units, f"({', '.join(row.dims)})", row.meaning, row.source) for row in self]

    def _naming(self) -> str:
        """Return how names of reductions, derivatives and bounds are formed, as Markdown."""
        position = self._catalogue.position
        unit = "" if position.units == "1" else f" in {position.units}"
        reductions = [f"`{Reduced(NAME, each.suffix)}` ({each.phrase})" for each in REDUCTIONS.values()]
        positions = [
            f"`{Reduced(NAME, each.suffix, position.name)}`"
            for each in REDUCTIONS.values()
            if each.has_position
        ]
        lists = (
            f"`{ListOfExtrema(NAME)}` lists all extremes over the reachable range by growing {position.name}, along "
            f"the dimension `extremum`, together with `{ListOfExtrema(NAME, position=position.name)}`, "
            f"`{ListOfExtrema(NAME, 'count')}` and `{ListOfExtrema(NAME, 'kind')}`. "
        )
        return (
            f"Any NAME with the dimension `{position.name}` has {_and(reductions)}, and {_and(positions)} (the "
            f"{position.name}{unit} there), with the dimensions ({DESIGN}, {BRANCH}). "
            f"{lists if self._catalogue.graded is not None else ''}"
            "Configurations that do not assemble are NaN and do not count. "
            f"`{Derivative(NAME, 'PARAM')}` is the derivative of NAME with respect to an input or to "
            f"`{position.name}`, and is itself such a NAME. "
            f"`{ErrorBound(NAME)}` bounds the rounding error of NAME, and `{Trust(NAME)}` flags where that bound "
            f"exceeds a millionth of NAME. `{DESIGN}` stands for the swept dimensions."
        )


@door
def quantities(mechanism: str, internal: bool = False, input: str | None = None) -> QuantityList:
    """List the quantities and inputs of a mechanism.

    Parameters
    ----------
    mechanism : str
        Its name, such as ``"planar_4r"``.
    internal : bool, default False
        List intermediate facts too, which cannot be requested by name.
    input : str, optional
        The driven input, as in `fastlink.sweep`.

    Returns
    -------
    QuantityList
        A list of `Quantity` that prints as a table.

    Raises
    ------
    InputError
        The mechanism or the input is unknown.

    Examples
    --------
    >>> rows = quantities("planar_4r")
    >>> [(row.name, row.units, row.dims) for row in rows if row.name == "omega4"]
    [('omega4', 'rad s-1', ('design', 'branch', 'theta1'))]
    """
    catalogue = find_catalogue(mechanism, input)
    every = (DESIGN, BRANCH, catalogue.position.name)
    public = _ordered(catalogue)
    rows = [_quantity(fact, every if catalogue.varies(fact.name) else (DESIGN,)) for fact in public]
    if internal:
        plan = make_program(catalogue, catalogue.public, given=catalogue.inputs)
        for name, fact in (*catalogue.tables.items(), *catalogue.facts.items()):
            if fact.internal and name in plan.axes and name == fact.name:
                axes = plan.axes[name]
                rows.append(_quantity(fact, tuple(axis for axis in every if axis in axes)))
    return QuantityList(rows, catalogue)


def document() -> str:
    """Return the text of docs/quantities.md."""
    head = (
        "# Quantities and inputs\n\n"
        "Written by `python -m fastlink.report.quantities > docs/quantities.md`; do not edit. "
        "`fastlink quantities MECHANISM` prints the same."
    )
    return "\n\n".join((head, *(quantities(name).markdown() for name in NAMES))) + "\n"


def _ordered(catalogue: Catalogue) -> list[Fact]:
    """Return the public facts: of the design first, then by the number of their steps.

    Components of one vector stay together.
    """
    position = catalogue.position.name
    leaves = (*catalogue.inputs, *catalogue.tables, *catalogue.table_low_parts, BRANCH, position)
    effort: dict[str, int] = {}
    for name in catalogue.public:
        steps = sum(1 for _ in catalogue.dependencies([name], leaves))
        vector = COMPONENT.sub("", name)
        effort[vector] = max(steps, effort.get(vector, 0))

    def order(fact: Fact) -> tuple[bool, int, str, str]:
        vector = COMPONENT.sub("", fact.name)
        return catalogue.varies(fact.name), effort[vector], vector, fact.name

    return sorted(catalogue.public.values(), key=order)


def _quantity(fact: Fact, dims: tuple[str, ...]) -> Quantity:
    return Quantity(fact.name, fact.units, dims, fact.meaning, fact.source)


def _inputs(catalogue: Catalogue) -> list[GivenInput]:
    rows = []
    for given in catalogue.inputs.values():
        models = [model.name for model in catalogue.models_of(given.name)]
        links = f"given by {', '.join(models)}" if models else _instead(catalogue, given)
        rows.append(_given(given, links))
    for model, inputs in catalogue.variant_inputs.items():
        for given in inputs.values():
            default = "" if given.default is None else f", {given.default:.6g} by default"
            rows.append(_given(given, _instead(catalogue, given) or f"of {model}{default}"))
    return rows


def _given(given: Input, links: str) -> GivenInput:
    codes = "; ".join(f"{code}: {meaning}" for code, meaning in given.choices.items())
    allowed = ", ".join(map(str, given.choices)) or RULES.get(given.rule, "any")
    links = links or ("all unless one is given" if codes else "")
    meaning = f"{given.meaning} ({codes})" if codes else given.meaning
    return GivenInput(given.name, given.units, allowed, meaning, links)


def _instead(catalogue: Catalogue, given: Input) -> str:
    others = catalogue.mutually_exclusive_inputs(given.name)
    return f"or {', '.join(others)} instead" if others else ""


def _and(parts: Sequence[str]) -> str:
    return " and ".join((", ".join(parts[:-1]), parts[-1])) if len(parts) > 1 else "".join(parts)


def _header(row: type) -> tuple[str, ...]:
    return tuple(column.name for column in fields(row))


def _text_table(header: tuple[str, ...], rows: Sequence[tuple[str, ...]]) -> str:
    """Return a table as aligned text, long cells folded."""
    return folded(
        header, rows, [{"meaning": MEANING_WIDTH, "source": SOURCE_WIDTH}.get(name) for name in header]
    )


def _markdown_table(header: tuple[str, ...], rows: Sequence[tuple[str, ...]]) -> str:
    quoted = [
        [
            f"`{cell}`" if name == "name" else cell.replace("|", "\\|")
            for name, cell in zip(header, row, strict=True)
        ]
        for row in rows
    ]
    lines = [list(header), ["---"] * len(header), *quoted]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


if __name__ == "__main__":
    print(document(), end="")
