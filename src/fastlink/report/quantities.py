"""List the quantities and inputs of a mechanism, or find them by what they mean.

``python -m fastlink.report.quantities > docs/quantities.md`` writes the documentation of all mechanisms.
"""

from __future__ import annotations

import itertools
import textwrap
from collections.abc import Iterable, Sequence
from dataclasses import astuple, fields
from typing import TYPE_CHECKING, Any, SupportsIndex, overload

from fastlink._text import folded, html_table
from fastlink.catalogue.catalogue import Catalogue
from fastlink.catalogue.search import index_of_inputs
from fastlink.doors import door
from fastlink.errors import InputError, Setting
from fastlink.mechanisms import NAMES
from fastlink.mechanisms import catalogue as find_catalogue
from fastlink.options import check_switch
from fastlink.plan.pointwise import make_program
from fastlink.plan.suggestions import rank_quantities
from fastlink.report.naming import naming
from fastlink.report.rows import (
    GivenInput,
    Quantity,
    given_inputs,
    public_rows,
    row_of,
    step_row,
)
from fastlink.space.design_space import BRANCH, DESIGN

if TYPE_CHECKING:
    from fastlink.engine.extending import Extension

__all__ = ["GivenInput", "Quantity", "QuantityList", "quantities"]

COLUMNS = ("name", "units", "dims", "meaning", "source")
MEANING_WIDTH, SOURCE_WIDTH = 46, 34
#: The least score of a name that is found, and its least share of the best one.
LEAST, SHARE = 0.42, 0.6


class QuantityList(list[Quantity]):
    """The quantities of a mechanism: a list that prints as a table; a name between brackets gives its row.

    Attributes
    ----------
    mechanism : str
        Its name; empty where several were searched.
    inputs : list of GivenInput
        The inputs that make up a design; where a phrase was searched for, those that it may mean.
    """

    def __init__(
        self,
        rows: Iterable[Quantity],
        catalogues: Sequence[Catalogue],
        found: Sequence[tuple[str, GivenInput]] | None = None,
    ) -> None:
        super().__init__(rows)
        self._catalogues, self._found = tuple(catalogues), found
        self.mechanism = catalogues[0].name if len(catalogues) == 1 else ""
        self.inputs = given_inputs(catalogues[0]) if found is None else [given for _, given in found]

    @overload
    def __getitem__(self, key: SupportsIndex | str, /) -> Quantity: ...

    @overload
    def __getitem__(self, key: slice, /) -> list[Quantity]: ...

    def __getitem__(self, key: Any, /) -> Any:
        """Return a row by its number, or by any name that may be requested, such as ``"omega4_max"``."""
        if not isinstance(key, str):
            return super().__getitem__(key)
        for row in self:
            if row.name == key:
                return row
        return row_of(key, self._catalogues[0])

    def __repr__(self) -> str:
        if self._found is not None:
            return self._repr_found(self._found)
        (catalogue,) = self._catalogues
        return "\n\n".join(
            (
                f"{self.mechanism}: {catalogue.title}",
                _text_table(COLUMNS, self._cells(grouped=True)),
                textwrap.fill(naming(*self._catalogues).replace("`", ""), 110),
                "Inputs; only those that the requested quantities depend on are needed:",
                _text_table(_header(GivenInput), [astuple(given) for given in self.inputs]),
            )
        )

    __str__ = __repr__

    def _repr_found(self, found: Sequence[tuple[str, GivenInput]]) -> str:
        """Return what was found as text: quantities, then inputs, each with its mechanism if there are several."""
        named = len(self._catalogues) > 1
        parts = []
        if self:
            rows = [
                ((row.mechanism,) if named else ()) + cells
                for row, cells in zip(self, self._cells(), strict=True)
            ]
            parts.append(_text_table(("mechanism", *COLUMNS) if named else COLUMNS, rows))
        if found:
            header = ("mechanism", *_header(GivenInput)) if named else _header(GivenInput)
            given = [((mechanism,) if named else ()) + astuple(one) for mechanism, one in found]
            parts += ["Inputs:", _text_table(header, given)]
        return "\n\n".join(parts) or "Nothing was found; try another word, or list all quantities."

    def _repr_html_(self) -> str:
        """Return the quantities as a notebook shows them."""
        rows = [(row.mechanism, *cells) for row, cells in zip(self, self._cells(), strict=True)]
        return html_table(("mechanism", *COLUMNS), rows)

    def markdown(self) -> str:
        """Return the list as Markdown, as it stands in the documentation."""
        (catalogue,) = self._catalogues
        branches = catalogue.branches.items()
        tables = [
            part
            for group, rows in itertools.groupby(self, lambda row: row.group)
            for part in (f"#### {group}", _markdown_table(COLUMNS, [_cells(row) for row in rows]))
        ]
        return "\n\n".join(
            (
                f"## `{self.mechanism}`",
                f"{catalogue.title}. Assembly modes:",
                "\n".join(f"- `branch` {number}: {meaning}" for number, meaning in branches),
                "### Quantities",
                naming(*self._catalogues),
                *tables,
                "### Inputs",
                "Any input can be swept. Only the inputs that the requested quantities depend on are needed. Inputs "
                "that a model of links gives need not be given; if they are, they replace the model's. Inputs with a "
                "default belong to a load or a further motion, which exists only if one of its inputs is given.",
                _markdown_table(_header(GivenInput), [astuple(given) for given in self.inputs]),
            )
        )

    def _cells(self, grouped: bool = False) -> list[tuple[str, ...]]:
        lines = []
        for group, rows in itertools.groupby(self, lambda row: row.group):
            if grouped:
                lines += [("",) * len(COLUMNS), (f"{group}:", *[""] * (len(COLUMNS) - 1))]
            lines += map(_cells, rows)
        return lines


@door
def quantities(
    mechanism: str | Extension | None = None,
    internal: bool = False,
    input: str | None = None,
    *,
    find: str | None = None,
) -> QuantityList:
    """List the quantities and inputs of a mechanism, or find them by what they mean.

    Parameters
    ----------
    mechanism : str or Extension, optional
        Its name, such as ``"planar_4r"``; or one with quantities of one's own, from `fastlink.extend`. With `find` it
        may be left out: all mechanisms are searched.
    internal : bool, default False
        List intermediate facts too, which cannot be requested by name.
    input : str, optional
        The driven input, as in `fastlink.sweep`.
    find : str, optional
        A word, a phrase or a symbol, such as ``"torque"``, ``"rocker speed"`` or ``"mu_min"``: only quantities and
        inputs that it may mean, the best first.

    Returns
    -------
    QuantityList
        A list of `Quantity` that prints as a table; ``quantities("planar_4r")["T41_max"]`` is one row.

    Raises
    ------
    InputError
        The mechanism or the input is unknown.

    Examples
    --------
    >>> import fastlink as fl
    >>> row = fl.quantities("planar_4r")["omega4"]
    >>> row.units, row.dims, row.needs
    ('rad s-1', ('design', 'branch', 'theta1'), ('a1', 'a2', 'a3', 'a4', 'omega1'))
    >>> [row.name for row in fl.quantities("planar_4r", find="mu min")]
    ['transmission_angle_min', 'transmission_angle_least']
    """
    internal = check_switch(("internal",), internal)
    if mechanism is None and find is None:
        known = ", ".join(map(repr, NAMES))
        remedy = (f"write one of {known}", (", or ", Setting("find", "torque"), " to search them all"))
        raise InputError("is missing", where=("mechanism",), remedy=remedy)
    if find is not None:
        return _found(
            find, [find_catalogue(name, input) for name in (NAMES if mechanism is None else [mechanism])]
        )
    assert mechanism is not None
    try:
        catalogue = find_catalogue(mechanism, input)
    except InputError as error:
        raise _or_find(mechanism, error) from None
    rows = public_rows(catalogue)
    if internal:
        every = (DESIGN, BRANCH, catalogue.position.name)
        plan = make_program(catalogue, catalogue.public, given=catalogue.inputs)
        for name, fact in (*catalogue.tables.items(), *catalogue.facts.items()):
            if fact.internal and name in plan.axes and name == fact.name:
                dims = [axis for axis in every if axis in plan.axes[name]]
                rows.append(step_row(fact, dims, catalogue.name))
    return QuantityList(rows, [catalogue])


def _or_find(mechanism: object, error: InputError) -> InputError:
    """Return the error of an unknown mechanism; a word that finds quantities is to be written as one."""
    if isinstance(mechanism, str) and mechanism not in NAMES and str(error.remedy).startswith("known"):
        known = ", ".join(map(repr, NAMES))
        remedy = (f"write one of {known}", (", or ", Setting("find", mechanism)))
        return InputError(error.what, where=error.where, remedy=remedy)
    return error


def _found(phrase: str, catalogues: Sequence[Catalogue]) -> QuantityList:
    """Return the quantities and inputs that a phrase may mean, the best first."""
    if not isinstance(phrase, str) or not phrase.strip():
        raise InputError(
            "is not a word", where=("find",), remedy="write a word or a phrase, such as 'torque'"
        )
    ranked = [(one, catalogue) for catalogue in catalogues for one in rank_quantities(phrase, catalogue)]
    given = [
        (one, catalogue) for catalogue in catalogues for one in index_of_inputs(catalogue).ranked(phrase)
    ]
    best = max((one.score for one, _ in (*ranked, *given)), default=0.0)
    least = max(LEAST, SHARE * best)
    rows = [
        row_of(one.name, of) for one, of in sorted(ranked, key=lambda pair: pair[0]) if one.score >= least
    ]
    inputs = [
        (of.name, next(row for row in given_inputs(of) if row.name == one.name))
        for one, of in sorted(given, key=lambda pair: pair[0])
        if one.score >= least
    ]
    return QuantityList(rows, catalogues, inputs)


def document() -> str:
    """Return the text of docs/quantities.md."""
    head = (
        "# Quantities and inputs\n\n"
        "Written by `python -m fastlink.report.quantities > docs/quantities.md`; do not edit. "
        "`fastlink quantities MECHANISM` prints the same."
    )
    return "\n\n".join((head, *(quantities(name).markdown() for name in NAMES))) + "\n"


def _cells(row: Quantity) -> tuple[str, ...]:
    return row.name, row.units, f"({', '.join(row.dims)})", row.meaning, row.source


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
