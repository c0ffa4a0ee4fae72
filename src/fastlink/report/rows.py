"""Rows of the lists of quantities and inputs: what each is, what it needs, in which group it stands."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass, field

from fastlink.catalogue.catalogue import Catalogue, Fact, Input
from fastlink.engine.labels import request_labels
from fastlink.plan.query import parse_request
from fastlink.plan.validate import RULES
from fastlink.space.design_space import BRANCH, DESIGN, EXTREMUM

__all__ = [
    "GROUPS",
    "GivenInput",
    "Quantity",
    "given_inputs",
    "public_rows",
    "row_of",
    "step_row",
]

COMPONENT = re.compile("(?<=_)[av]?[xy]$")

#: The groups of a list, in its order.
GROUPS = (
    "Positions and angles",
    "Transmission angle",
    "Velocities and accelerations",
    "Coupler point",
    "Forces, torques and power",
    "Joint angles",
    "The design as a whole",
    "Residuals and causes",
)
MOTION, TRANSMISSION, RATES, COUPLER, FORCES, JOINTS, WHOLE, CHECKS = GROUPS
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


def row_of(name: str, catalogue: Catalogue) -> Quantity:
    """Return the row of any name that may be requested.

    Raises
    ------
    InputError
        The name is unknown.
    """
    request = parse_request(name, catalogue)
    over_cycle = request.reduction is not None or request.listed
    axes: tuple[str, ...] = (BRANCH,) if over_cycle else _axes(request.quantity, catalogue)
    if request.listed and request.listed != "count":
        axes += (EXTREMUM,)
    fact, labels = catalogue.public_fact(request.quantity), request_labels(catalogue, request)
    texts = (labels.get("units", "1"), (DESIGN, *axes), labels["long_name"], labels["references"])
    needs = _steps_and_needs(request.quantity, catalogue)[1]
    return Quantity(
        name,
        *texts,
        labels["symbol"],
        needs,
        catalogue.name,
        _group(fact, catalogue.varies(request.quantity)),
    )


def public_rows(catalogue: Catalogue) -> list[Quantity]:
    """Return the rows of the public quantities: by group, then by the number of their steps.

    Components of one vector stay together.
    """
    effort: dict[str, int] = {}
    rows = [row_of(name, catalogue) for name in catalogue.public]
    for row in rows:
        vector = COMPONENT.sub("", row.name)
        effort[vector] = max(_steps_and_needs(row.name, catalogue)[0], effort.get(vector, 0))

    def order(row: Quantity) -> tuple[int, int, str, str]:
        vector = COMPONENT.sub("", row.name)
        return GROUPS.index(row.group), effort[vector], vector, row.name

    return sorted(rows, key=order)


def step_row(fact: Fact, dims: Iterable[str], mechanism: str) -> Quantity:
    """Return the row of an intermediate fact."""
    return Quantity(
        fact.name, fact.units, tuple(dims), fact.meaning, fact.source, fact.symbol, (), mechanism, "Steps"
    )


def _axes(name: str, catalogue: Catalogue) -> tuple[str, ...]:
    return (BRANCH, catalogue.position.name) if catalogue.varies(name) else ()


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
