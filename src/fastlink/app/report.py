"""Lists and summaries: quantities and inputs of a mechanism, what a map holds, designs, tolerances."""

from __future__ import annotations

import itertools
import math
import numbers
import re
import textwrap
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, SupportsIndex, overload

import numpy as np

from fastlink._text import (
    aligned,
    counted,
    duration,
    folded,
    html_table,
    in_words,
    joined,
    scaled,
    short_number,
    size,
)
from fastlink.app.accuracy import accuracy_table
from fastlink.engine.labels import request_labels
from fastlink.engine.options import check_options
from fastlink.errors import InputError, Remedy, Setting, door
from fastlink.facts.catalogue import Catalogue
from fastlink.facts.fact import Fact, Input
from fastlink.facts.find import index_of_inputs
from fastlink.facts.names import (
    Change,
    Derivative,
    ErrorBound,
    GradientStatus,
    ListOfExtrema,
    Reduced,
    Trust,
    signed,
)
from fastlink.facts.names import Quantity as NameOf
from fastlink.facts.own import declared_names
from fastlink.io.joining import JOINED
from fastlink.io.layout import SOURCE
from fastlink.io.reader import PartOfMap, as_map, files_of
from fastlink.maps.best import GAIN, REFINEMENT, STARTS
from fastlink.maps.units import convert, flag_counts, flags_of
from fastlink.maps.units import degrees as in_degrees
from fastlink.mechanisms import NAMES
from fastlink.mechanisms import catalogue as find_catalogue
from fastlink.plan.programs import make_program
from fastlink.plan.query import REDUCTIONS, parse_request, rank_quantities
from fastlink.plan.request import RULES
from fastlink.space.design_space import BRANCH, DESIGN, EXTREMUM
from fastlink.space.units import DEGREES, split

if TYPE_CHECKING:
    import xarray as xr

    from fastlink.engine.extend import Extension


# -- List designs that were selected from a map, a row each


#: Rows of a list that are shown.
MOST_ROWS = 100


def listed(found: xr.Dataset, names: Sequence[str], *, degrees: bool = False) -> str:
    """Return designs as a table of their inputs and of some variables, below how they were selected."""
    about = str(found.attrs.get("selection", ""))
    maps = in_degrees(found) if degrees else found
    named = [split(name, maps.variables) for name in names]
    maps = convert(maps, (), {of: unit for of, unit in named if unit and unit not in DEGREES})
    along = [(str(name), array) for name, array in maps.coords.items() if array.dims == (DESIGN,)]
    inputs = [name for name, array in along if array.dtype.kind in "iuf"]
    texts = [name for name, array in along if name not in inputs]
    arrays = [maps[name] for name in dict.fromkeys([*inputs, *(of for of, _ in named), *texts])]
    rows = list(zip(*(_column(array) for array in arrays if array.dims == (DESIGN,)), strict=True))
    hidden = len(rows) - 2 - MOST_ROWS
    more = f"\n... and {hidden:,} more" if hidden > 0 else ""
    same = [maps[name] for name in maps.coords if not maps[name].dims and "units" in maps[name].attrs]
    constants = ", ".join(f"{one.name} = {short_number(one.item())}{_units(one, ' ')}" for one in same)
    below = f"\nthe same for all: {constants}" if constants else ""
    return f"{about}\n{aligned(rows[: 2 + MOST_ROWS], right=0)}{more}{below}"


def refinement_columns(found: xr.Dataset) -> list[str]:
    """Return the columns that a refinement has added: what was gained, how it ended, from how many starts."""
    names = [str(name) for name in found.data_vars]
    gains = [name for name in names if name.endswith(f"_{GAIN}")]
    return [*gains, *(name for name in names if name in (REFINEMENT, STARTS))]


def _column(array: xr.DataArray) -> list[str]:
    """Return name, units and values of a variable."""
    meanings = {code: meaning for meaning, code in flags_of(array).items()}
    values = [str(meanings.get(value, short_number(value))) for value in array.values.tolist()]
    return [str(array.name), _units(array), *values]


def _units(array: xr.DataArray, before: str = "") -> str:
    units = str(array.attrs.get("units", "1"))
    return "" if units == "1" else before + units


# -- How names of reductions, derivatives and bounds are formed from those of quantities, for the list of
#    these


NAME = NameOf("NAME")


def naming(catalogue: Catalogue) -> str:
    """Return how names of reductions, derivatives and bounds are formed, as Markdown."""
    position = catalogue.position
    unit = "" if position.units == "1" else f" in {position.units}"
    every = REDUCTIONS.values()
    placed = [each.suffix for each in every if each.has_position]
    reductions = [f"`{Reduced(NAME, each.suffix)}` ({each.phrase})" for each in every if not each.of_path]
    paths = [f"`{Reduced(NameOf('POINT'), each.suffix)}` ({each.phrase})" for each in every if each.of_path]
    positions = [f"`{Reduced(NAME, how, position.name)}`" for how in placed]
    bounds = [f"`{ErrorBound(Reduced(NAME, how))}`" for how in placed]
    extreme = Reduced(NAME, "max")
    lists = (
        f"`{ListOfExtrema(NAME)}` lists all extremes over the reachable range by growing {position.name}, along "
        f"the dimension `extremum`, together with `{ListOfExtrema(NAME, position=position.name)}`, "
        f"`{ListOfExtrema(NAME, 'count')}` and `{ListOfExtrema(NAME, 'kind')}`. "
        f"{', '.join(bounds)} and `{ListOfExtrema(NAME, 'error')}` bound the errors of exact extremes. "
    )
    known = [f"`{name}`" for name in catalogue.graded.known] if catalogue.graded is not None else []
    sure = (
        f"The greatest and least {joined(known)} are known in closed form and not searched. " if known else ""
    )
    return (
        f"Any NAME with the dimension `{position.name}` has {joined(reductions)}, and {joined(positions)} (the "
        f"{position.name}{unit} there), with the dimensions ({DESIGN}, {BRANCH}). "
        f"The path of a POINT with POINT_x and POINT_y has {joined(paths)}, of the positions. "
        f"{lists if catalogue.graded is not None else ''}{sure}"
        f"`{Derivative(extreme, 'PARAM')}` is the derivative of such a number by an input, "
        f"`{GradientStatus(extreme)}` tells what it is worth. "
        "Positions at which it does not assemble do not count: all is NaN there but "
        "what the driven link alone determines, such as the place of its pin. "
        f"`{Derivative(NAME, 'PARAM')}` is the derivative of NAME with respect to an input or to "
        f"`{position.name}`, and is itself such a NAME. "
        f"`{Change(NAME, 'worst')}` and `{Change(NAME, 'rss')}` are the changes of any of these numbers by the "
        "tolerances of the inputs. "
        f"`{ErrorBound(NAME)}` bounds the rounding error of NAME, and `{Trust(NAME)}` flags where that bound "
        f"exceeds a millionth of NAME. `{DESIGN}` stands for the swept dimensions."
    )


# -- Rows of the lists of quantities and inputs: what each is, what it needs, in which group it stands


COMPONENT = re.compile("(?<=_)[av]?[xy]$")

#: The groups of a list, in its order.
GROUPS = (
    "What designers ask for most",
    "Positions and angles",
    "Transmission angle",
    "Velocities and accelerations",
    "Coupler point",
    "Forces, torques and power",
    "Joint angles",
    "The design as a whole",
    "Residuals and causes",
)
MOST_ASKED, MOTION, TRANSMISSION, RATES, COUPLER, FORCES, JOINTS, WHOLE, CHECKS = GROUPS
#: Signs in the name and meaning of a quantity over the cycle, or in its units, of its group; the first counts.
SIGNS = (
    (
        "meaning",
        re.compile("residual|closure error| why |whether the loop|from the line|distance of the computed"),
        CHECKS,
    ),
    ("units", re.compile(r"\b[NW]\b"), FORCES),
    ("meaning", re.compile("joint angle"), JOINTS),
    ("meaning", re.compile("coupler (point|curve)"), COUPLER),
    ("meaning", re.compile("transmission angle"), TRANSMISSION),
    ("units", re.compile(r"\bs-\d|\brad-1"), RATES),
    ("meaning", re.compile(r"rate of|\bratio\b|angular velocity"), RATES),
)


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
    symbol : str
        Its symbol there.
    needs : tuple of str
        The inputs that it depends on; masses may be left to a model of the links.
    mechanism, group : str
        The mechanism, and the group of its list.
    """

    name: str
    units: str
    dims: tuple[str, ...]
    meaning: str
    source: str
    symbol: str = field(default="", repr=False)
    needs: tuple[str, ...] = ()
    mechanism: str = ""
    group: str = ""


@dataclass(frozen=True)
class GivenInput:
    """One input: name, units, allowed values, meaning, and the links that give it."""

    name: str
    units: str
    allowed: str
    meaning: str
    links: str
    mechanism: str = field(default="", repr=False)


def row_of(name: str, catalogue: Catalogue) -> Quantity:
    """Return the row of any name that may be requested."""
    request = parse_request(name, catalogue)
    over_cycle = request.reduction is not None or request.listed
    varies = catalogue.varies(request.quantity)
    inside = (BRANCH, catalogue.position.name) if varies else ()
    axes: tuple[str, ...] = (BRANCH,) if over_cycle else inside
    if request.listed and request.listed != "count":
        axes += (EXTREMUM,)
    fact, labels = catalogue.public_fact(request.quantity), request_labels(catalogue, request)
    units = labels.get("units", "1")
    meaning = "; ".join(filter(None, (labels["long_name"], labels.get("comment"))))
    texts = units, (DESIGN, *axes), meaning, labels["references"], labels["symbol"]
    needs = _steps_and_needs(request.quantity, catalogue)[1]
    return Quantity(name, *texts, needs, catalogue.name, _group(fact, varies))


def public_rows(catalogue: Catalogue) -> list[Quantity]:
    """Return the rows of the public quantities: what is most asked for, then by group and the number of steps.

    Components of one vector stay together.
    """
    effort: dict[str, int] = {}
    most = catalogue.most_asked.split()
    first = [replace(row_of(name, catalogue), group=MOST_ASKED) for name in most]
    rows = [row_of(name, catalogue) for name in catalogue.public if name not in most]
    for row in rows:
        vector = COMPONENT.sub("", row.name)
        effort[vector] = max(_steps_and_needs(row.name, catalogue)[0], effort.get(vector, 0))

    def order(row: Quantity) -> tuple[int, int, str, str]:
        vector = COMPONENT.sub("", row.name)
        return GROUPS.index(row.group), effort[vector], vector, row.name

    return first + sorted(rows, key=order)


def _steps_and_needs(name: str, catalogue: Catalogue) -> tuple[int, tuple[str, ...]]:
    """Return the number of steps to a quantity, and the inputs that they read."""
    position = catalogue.position.name
    leaves = (*catalogue.inputs, *catalogue.tables, *catalogue.table_low_parts, BRANCH, position)
    steps = list(catalogue.dependencies([name], leaves))
    read = {part for step in steps for part in step.depends_on}
    return len(steps), tuple(name for name in catalogue.inputs if name in read)


def _group(fact: Fact, varies: bool) -> str:
    """Return the group of a quantity."""
    if not varies:
        return WHOLE
    texts = {"units": fact.units, "meaning": f"{fact.name} {fact.meaning}".lower()}
    return next((group for label, sign, group in SIGNS if sign.search(texts[label])), MOTION)


def given_inputs(catalogue: Catalogue) -> list[GivenInput]:
    """Return the inputs of a mechanism, then those of its links and loads."""
    rows = []
    for given in catalogue.inputs.values():
        models = [model.name for model in catalogue.models_of(given.name)]
        links = f"given by {', '.join(models)}" if models else _instead(catalogue, given)
        rows.append(_given(given, links, catalogue))
    for model, inputs in catalogue.variant_inputs.items():
        for given in inputs.values():
            default = "" if given.default is None else f", {given.default:.6g} by default"
            links = _instead(catalogue, given) or f"of {model}{default}"
            rows.append(_given(given, links, catalogue))
    return rows


def _given(given: Input, links: str, catalogue: Catalogue) -> GivenInput:
    codes = "; ".join(f"{code}: {meaning}" for code, meaning in given.choices.items())
    allowed = ", ".join(map(str, given.choices)) or RULES.get(given.rule, "any")
    links = links or ("all unless one is given" if codes else "")
    meaning = f"{given.meaning} ({codes})" if codes else given.meaning
    return GivenInput(given.name, given.units, allowed, meaning, links, catalogue.name)


def _instead(catalogue: Catalogue, given: Input) -> str:
    others = catalogue.mutually_exclusive_inputs(given.name)
    return f"or {', '.join(others)} instead" if others else ""


# -- List the quantities and inputs of a mechanism, or find them by what they mean

COLUMNS = ("name", "units", "dims", "meaning", "source")
INPUT_COLUMNS = ("name", "units", "allowed", "meaning", "links")
#: Columns that are folded, and their widths.
WIDTHS = {"meaning": 46, "source": 34}
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
        found: list[GivenInput] | None = None,
    ) -> None:
        super().__init__(rows)
        self._catalogues, self._is_found = tuple(catalogues), found is not None
        self.mechanism = catalogues[0].name if len(catalogues) == 1 else ""
        self.inputs = given_inputs(catalogues[0]) if found is None else found

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
        if self._is_found:
            return self._repr_found()
        (catalogue,) = self._catalogues
        return "\n\n".join(
            (
                f"{self.mechanism}: {catalogue.title}",
                _text_table(COLUMNS, self, grouped=True),
                textwrap.fill(naming(catalogue).replace("`", ""), 110),
                "Inputs; only those that the requested quantities depend on are needed:",
                _text_table(INPUT_COLUMNS, self.inputs),
            )
        )

    __str__ = __repr__

    def _repr_found(self) -> str:
        """Return what was found as text: quantities, then inputs, each with its mechanism if there are several."""
        of = ("mechanism",) if len(self._catalogues) > 1 else ()
        parts = [_text_table((*of, *COLUMNS), self)] if self else []
        if self.inputs:
            parts += ["Inputs:", _text_table((*of, *INPUT_COLUMNS), self.inputs)]
        return "\n\n".join(parts) or "Nothing was found; try another word, or list all quantities."

    def _repr_html_(self) -> str:
        """Return the quantities as a notebook shows them."""
        columns = ("mechanism", *COLUMNS)
        return html_table(columns, [_cells(row, columns) for row in self])

    def formulas(self) -> str:
        """Return the formula of each quantity as text, with the sheet and the line where it stands."""
        known = {catalogue.name: catalogue for catalogue in self._catalogues}
        parts = {}
        for row in self:
            catalogue = known[row.mechanism]
            fact = catalogue.facts.get(row.name) or catalogue.tables.get(row.name)
            if fact is None:  # a result over the cycle
                fact = catalogue.facts[signed(parse_request(row.name, catalogue).quantity)]
            *assignments, last = fact.formula.lines
            lines = (*assignments, last.replace("return", "=", 1))
            head = f"{fact.name} [{fact.units}] {fact.symbol}: {fact.meaning}"
            parts[row.mechanism, fact.name] = "\n".join(
                [f"{fact.formula.place or fact.source}:", head, *(f"    {line}" for line in lines)]
            )
        return "\n\n".join(parts.values())

    def markdown(self) -> str:
        """Return the list as Markdown, as it stands in the documentation."""
        (catalogue,) = self._catalogues
        branches = catalogue.branches.items()
        tables = [
            part
            for group, rows in itertools.groupby(self, lambda row: row.group)
            for part in (f"#### {group}", _markdown_table(COLUMNS, rows))
        ]
        return "\n\n".join(
            (
                f"## `{self.mechanism}`",
                f"{catalogue.title}. Assembly modes:",
                "\n".join(f"- `branch` {number}: {meaning}" for number, meaning in branches),
                "### Quantities",
                naming(catalogue),
                *tables,
                "### Inputs",
                "Any input can be swept. Only the inputs that the requested quantities depend on are needed. Inputs "
                "that a model of links gives need not be given; if they are, they replace the model's. Inputs with a "
                "default belong to a load or a further motion, which exists only if one of its inputs is given.",
                _markdown_table(INPUT_COLUMNS, self.inputs),
            )
        )


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

    Examples
    --------
    >>> row = fl.quantities("planar_4r")["omega4"]
    >>> row.units, row.dims, row.needs
    ('rad s-1', ('design', 'branch', 'theta1'), ('a1', 'a2', 'a3', 'a4', 'omega1'))
    >>> [row.name for row in fl.quantities("planar_4r", find="mu min")]
    ['transmission_angle_min', 'least_transmission_angle']
    """
    if isinstance(internal, str):
        remedy: Remedy = ("write True or False", (", or ", Setting("find", internal)))
        raise InputError(f"is {internal!r}", ("internal",), remedy)
    internal = check_options({"internal": internal})["internal"]
    known = f"write one of {', '.join(map(repr, NAMES))}"
    if mechanism is None and find is None:
        remedy = (known, (", or ", Setting("find", "torque"), " to search them all"))
        raise InputError("is missing", ("mechanism",), remedy)
    if find is not None:
        return _found(
            find, [find_catalogue(name, input) for name in (NAMES if mechanism is None else [mechanism])]
        )
    assert mechanism is not None
    try:
        catalogue = find_catalogue(mechanism, input)
    except InputError as error:
        if not isinstance(mechanism, str) or mechanism in NAMES or not str(error.remedy).startswith("known"):
            raise  # what it is about is no word that could be searched for
        raise InputError(error.what, error.where, (known, (", or ", Setting("find", mechanism)))) from None
    rows = public_rows(catalogue)
    if internal:
        every = (DESIGN, BRANCH, catalogue.position.name)
        plan = make_program(catalogue, catalogue.public, given=catalogue.inputs)
        for name, fact in (*catalogue.tables.items(), *catalogue.facts.items()):
            if fact.internal and name in plan.axes and name == fact.name:
                dims = tuple(axis for axis in every if axis in plan.axes[name])
                texts = fact.name, fact.units, dims, fact.meaning, fact.source, fact.symbol
                rows.append(Quantity(*texts, (), catalogue.name, "Steps"))
    return QuantityList(rows, [catalogue])


def _found(phrase: str, catalogues: Sequence[Catalogue]) -> QuantityList:
    """Return the quantities and inputs that a phrase may mean, the best first."""
    if not isinstance(phrase, str) or not phrase.strip():
        raise InputError("is not a word", ("find",), "write a word or a phrase, such as 'torque'")
    ranked = [(one, catalogue) for catalogue in catalogues for one in rank_quantities(phrase, catalogue)]
    given = [(one, of) for of in catalogues for one in index_of_inputs(of).ranked(phrase)]
    best = max((one.score for one, _ in (*ranked, *given)), default=0.0)
    least = max(LEAST, SHARE * best)
    ranked, given = (
        [(one, of) for one, of in sorted(found, key=lambda pair: pair[0]) if one.score >= least]
        for found in (ranked, given)
    )
    inputs = [row for one, of in given for row in given_inputs(of) if row.name == one.name]
    return QuantityList([row_of(one.name, of) for one, of in ranked], catalogues, inputs)


def document() -> str:
    """Return the page of all quantities, which the site has as docs/quantities.md."""
    head = "# Quantities and inputs\n\n`fastlink quantities MECHANISM` prints the same, for one mechanism."
    return "\n\n".join((head, *(quantities(name).markdown() for name in NAMES))) + "\n"


def _cells(row: Quantity | GivenInput, columns: Sequence[str]) -> list[str]:
    values = [getattr(row, name) for name in columns]
    return [value if isinstance(value, str) else f"({', '.join(value)})" for value in values]


def _text_table(columns: Sequence[str], rows: Iterable[Quantity | GivenInput], grouped: bool = False) -> str:
    """Return a table as aligned text, long cells folded; where wanted, each group below its name."""
    lines: list[list[str]] = []
    for group, members in itertools.groupby(rows, lambda row: getattr(row, "group", "")):
        rest = [""] * (len(columns) - 1)
        lines += [["", *rest], [f"{group}:", *rest]] if grouped else []
        lines += [_cells(row, columns) for row in members]
    return folded(columns, lines, [WIDTHS.get(name) for name in columns])


def _markdown_table(columns: Sequence[str], rows: Iterable[Quantity | GivenInput]) -> str:
    lines = [[*columns], ["---"] * len(columns)]
    for row in rows:
        name, *others = _cells(row, columns)
        lines.append([f"`{name}`", *(cell.replace("|", "\\|") for cell in others)])
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


# -- Say in a few lines what a sweep did, and what its map holds


MULTIPLES = ("", " thousand", " million", " billion")


def summary(maps: xr.Dataset) -> str:
    """Return what a sweep did, or what an accuracy is, as lines of text."""
    if {"way", "pareto"} <= {*maps.variables}:
        return accuracy_table(maps)
    with as_map(maps) as dataset:
        return _summary(dataset)


def _summary(dataset: xr.Dataset) -> str:
    figures = _Numbers(dataset.attrs)
    rows = _designs(dataset, figures)
    if (part := PartOfMap.of(dataset.attrs)) is not None:
        start, stop = part.range
        rows.append(("part", f"{part.part}: designs {start:,} to {stop - 1:,} of {part.designs:,}"))
    rows += _searched(dataset, figures)
    if "selection" in dataset.attrs:
        rows.append(("selection", str(dataset.attrs["selection"])))
    if figures.has("configurations"):
        rows.append(("configurations", f"{figures['configurations']:,.0f}"))
    if figures.has("designs_of_earlier_runs"):
        earlier = counted(int(figures["designs_of_earlier_runs"]), "design")
        rows.append(("resumed", f"{earlier} from an earlier run"))
    if figures.has("run_time_s"):
        text = duration(figures["run_time_s"])
        if figures.has("set_up_time_s"):
            text += f", after {duration(figures['set_up_time_s'])} of setting up and compiling"
        if figures.has("threads"):
            text += f", {counted(int(figures['threads']), 'thread')}"
        if figures.has("verify_time_s"):
            text += f"; then {duration(figures['verify_time_s'])} of verification"
        if figures.has(JOINED):
            text += f"; of {counted(int(figures[JOINED]), 'part')} together"
        rows.append(("run time", text))
    for unit in ("configurations", "designs"):
        if figures.has(f"{unit}_per_second"):
            units = [f"{multiple} {unit}/s" for multiple in MULTIPLES]
            rows.append(("speed", scaled(figures[f"{unit}_per_second"], units)))
            break
    rows += _errors(dataset)
    notes = {str(one.attrs["rounding"]) for one in dataset.data_vars.values() if "rounding" in one.attrs}
    rows += [("rounding", note) for note in sorted(notes)]
    files = [path for path in files_of(dataset) if path.is_file()]
    if files:
        text = f"{files[0]} ({size(files[0].stat().st_size)})"
        if parts := files[1:]:
            nbytes = sum(part.stat().st_size for part in parts)
            text += f", which shows values of {counted(len(parts), 'part')} ({size(nbytes)})"
        rows.append(("file", text))
    return aligned(rows)


def _searched(dataset: xr.Dataset, figures: _Numbers) -> list[tuple[str, str]]:
    """Return what was searched to find these designs, and how many rows were left out, why."""
    if "search" not in dataset.attrs or not figures.has("searched_designs"):
        return []
    rows = [("searched", f"{figures['searched_designs']:,.0f} designs for {dataset.attrs['search']}")]
    texts = []
    for name, why in ((name, name.removeprefix("excluded_")) for name, count in figures.items() if count):
        if why != name:  # names of results keep their underscores
            why = in_words(why) if why.startswith("as_") else why.replace("by_", "by ", 1)
            texts.append(f"{figures[name]:,.0f} {why}")
    if texts:
        rows.append(("excluded", f"{', '.join(texts)}, of {figures.get('searched_rows', 0.0):,.0f} rows"))
    return rows


class _Numbers(dict[str, float]):
    """The attributes that are finite numbers; users may have changed the others."""

    def __init__(self, attrs: Mapping[Any, Any]) -> None:
        for name, value in attrs.items():
            if isinstance(value, numbers.Real) and math.isfinite(value):
                self[str(name)] = float(value)

    def has(self, name: str) -> bool:
        """Tell whether there is such a number, and it is not negative."""
        return self.get(name, -1.0) >= 0.0


def _designs(dataset: xr.Dataset, figures: _Numbers) -> list[tuple[str, str]]:
    """Return how many designs there are, and how many of them have each status, if these are codes still."""
    if not figures.has("designs"):
        return []
    swept = int(figures["designs"])
    status = dataset["status"] if "status" in dataset.variables else None
    designs = swept if status is None else status.size
    text, counts = f"{designs:,}", None
    if designs != swept:
        text += f" of the {swept:,} of the sweep"
        counts = None if status is None else flag_counts(status)
    elif status is not None and status.dtype.kind in "iu":
        names = flags_of(status)
        counts = {name: int(figures[f"designs_{name}"]) for name in names if figures.has(f"designs_{name}")}
    rows = [("designs", text)]
    label_width, count_width = max(map(len, counts or ()), default=0), len(f"{designs:,}")
    for name, count in (counts or {}).items():
        label = f"{in_words(name):<{label_width}}"
        rows.append(("", f"{count:>{count_width},}  {label}  {_percent(count, designs)}"))
    return rows


def _errors(dataset: xr.Dataset) -> list[tuple[str, str]]:
    """Return the largest error of each variable, by the verification of a sweep."""
    if "verify_failed" in dataset.attrs:
        return [("errors", f"not measured: {dataset.attrs['verify_failed']}")]
    errors, title = [], "largest error"
    for name, array in dataset.data_vars.items():
        figures = _Numbers(array.attrs)
        if not figures.has("verified_values") and figures.has(f"{SOURCE}verified_values"):
            title = "of the whole map"  # of which this is a part
            figures = _Numbers({str(key).removeprefix(SOURCE): value for key, value in array.attrs.items()})
        if not figures.has("verified_values"):
            continue
        forms = (("relative", ".1e", ""), ("roundings", ".2g", ""), ("of_bound", ".2g", "of the bound"))
        told = [(figures.get(f"error_max_{name}", -1.0), form, of or name) for name, form, of in forms]
        texts = [f"{most:{form}} {of}" for most, form, of in told if most >= 0.0]
        if figures.get("verify_mismatches"):
            texts.append(f"{counted(int(figures['verify_mismatches']), 'value')} NOT AS WITH 50 DIGITS")
        if texts:
            errors.append((str(name), f"{', '.join(texts)}, of {figures['verified_values']:,.0f}"))
    return [("" if k else title, line) for k, line in enumerate(aligned(errors).splitlines())]


def _percent(count: int, total: int) -> str:
    share = 100 * count / total if total else 0.0
    return " <0.1 %" if 0 < share < 0.05 else f"{share:5.1f} %"


def contents(maps: Any) -> str:
    """Return what a result holds: mechanism, axes, constants, variables, its summary."""
    with as_map(maps) as dataset:
        return _contents(dataset)


def _contents(dataset: xr.Dataset) -> str:
    attrs, coords = dataset.attrs, {str(name): coord for name, coord in dataset.coords.items()}
    keys = ("title", "mechanism", "input", "study_file", "solver", "source")
    declared = declared_names(str(attrs.get("own_quantities", "")))
    head = [(in_words(key), str(attrs[key])) for key in keys if key in attrs]
    head += [("own quantities", ", ".join(declared))] if declared else []
    dims = [(str(dim), _axis(dataset, str(dim), length)) for dim, length in dataset.sizes.items()]
    sampled = [(n, _span(coord)) for n, coord in coords.items() if coord.ndim == 1 and n not in dataset.dims]
    constants = [(n, _of_all(coord)) for n, coord in coords.items() if coord.ndim == 0]
    variables = [
        (str(n), f"({', '.join(map(str, array.dims))})  [{array.attrs.get('units', '1')}]{_meaning(array)}")
        for n, array in dataset.data_vars.items()
    ]
    titled = [("dimensions", dims), ("inputs along them", sampled), ("constants", constants)]
    titled.append(("variables", variables))
    blocks = [f"{title}\n{aligned(rows, indent='  ')}" for title, rows in titled if rows]
    return "\n\n".join(filter(None, [aligned(head), *blocks, _summary(dataset)]))


def _axis(dataset: xr.Dataset, dim: str, length: int) -> str:
    known = dim in dataset.coords
    return f"{length:,}: {_span(dataset[dim])}{_comment(dataset[dim])}" if known else f"{length:,}"


def _of_all(coord: xr.DataArray) -> str:
    """Return the value that a scalar coordinate has for all designs, with what its number stands for."""
    value = short_number(coord.values[()])
    return f"{value} {coord.attrs.get('units', '')}{_meaning(coord)}{_comment(coord)}"


def _comment(array: xr.DataArray) -> str:
    return f"; {array.attrs['comment']}" if "comment" in array.attrs else ""


def _span(coord: xr.DataArray) -> str:
    values = coord.values
    if not values.size:
        return "no values"
    ends = [values.min(), values.max()] if values.dtype.kind in "iuf" else [values[0], values[-1]]
    units = coord.attrs.get("units", "")
    text = f"{' to '.join(map(short_number, ends[: len(values)]))} {'' if units == '1' else units}"
    return text.rstrip() + _meaning(coord)


def _meaning(array: xr.DataArray) -> str:
    return f"  {array.attrs['long_name']}" if "long_name" in array.attrs else ""


# -- List what tolerances do to the results of a map, a row for each result


#: What `fastlink.tolerance` calls the changes by each input, and their dimension.
CONTRIBUTION, TOLERANCED = "contribution", "toleranced"


def changes_listed(found: xr.Dataset) -> str:
    """Return the changes of each result as a table: those of one design, else medians and the greatest."""
    names = [str(name) for name in found.data_vars if change_name(str(name)) in found.data_vars]
    inputs = [str(name) for name in found[TOLERANCED].values] if TOLERANCED in found.dims else []
    one = all(found[name].size == 1 for name in names)
    head = ["", "", "value", "worst change", *([] if one else ["greatest"]), "rss change"]
    rows = [[*head, *(f"by {name}" for name in inputs), "flagged"]]
    for name in names:
        worst, rss = found[change_name(name)], found[change_name(name, "rss")]
        row = [name, found[name].attrs.get("units", ""), _median(found[name]), _median(worst)]
        finite = np.isfinite(worst.values).any()
        row += [] if one else [short_number(float(np.nanmax(worst.values)) if finite else math.nan)]
        row.append(_median(rss))
        for of in inputs:
            part = found[f"{name}_{CONTRIBUTION}"].sel({TOLERANCED: of})
            row.append(_median(part if one else abs(part)))
        rows.append([*row, _flagged(found, name)])
    sizes = max((found[name].size for name in names), default=0)
    about = "" if one else f"medians of {counted(sizes, 'value')}, and the greatest worst change\n"
    return about + aligned(rows, right=2)


def change_name(name: str, how: str = "worst") -> str:
    """Return the name of the change of a result."""
    return str(Change(NameOf(name), how))


def _median(array: xr.DataArray) -> str:
    """Return the median of the numbers among some values, as text."""
    values = np.asarray(array.values, dtype=float).ravel()
    values = values[np.isfinite(values)]
    return short_number(float(np.median(values))) if values.size else "nan"


def _flagged(found: xr.Dataset, name: str) -> str:
    """Return how many derivatives of a result are none or one-sided, as text."""
    if (status := str(GradientStatus(NameOf(name)))) not in found.variables:
        return "-"
    codes, meanings = found[status].values, {code: of for of, code in flags_of(found[status]).items()}
    bad = codes[codes != 0]
    if codes.size == 1:
        return in_words(meanings[int(codes.ravel()[0])]) if bad.size else "-"
    return f"{bad.size} of {codes.size}"
