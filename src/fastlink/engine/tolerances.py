"""Read tolerances of inputs as callers and studies give them: in the units of the inputs, or in per cent."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from fastlink._text import short_repr
from fastlink.errors import InputError, Problems
from fastlink.plan.validate import unknown_input
from fastlink.space.degrees import angle_of, in_unit
from fastlink.space.values import numbers_of
from fastlink.symbolic.changes import is_tolerance, tolerance_name

if TYPE_CHECKING:
    from fastlink.catalogue.catalogue import Catalogue, Input

__all__ = ["given_tolerances"]


def given_tolerances(
    catalogue: Catalogue, tolerances: Mapping[str, Any], parent: str, problems: Problems
) -> dict[str, float]:
    """Return tolerances by the names that they have in a design: numbers, or texts in per cent.

    Parameters
    ----------
    catalogue : Catalogue
        The mechanism.
    tolerances : mapping
        By the names of inputs.
    parent : str
        What heads the paths of problems.
    problems : Problems
        Receives what is wrong; such tolerances are left out.
    """
    known = {name: one for name, one in catalogue.all_inputs.items() if not is_tolerance(name)}
    known[catalogue.position.name] = catalogue.position
    found: dict[str, float] = {}
    for name, value in tolerances.items():
        of = name if name in known else angle_of(name)
        if of not in known:
            problems.noted.append(unknown_input(catalogue, name, known, parent))
        elif known[of].choices:
            problems.add("is a code, which has no tolerance", (parent, name), "leave it out")
        else:
            with problems.at():
                own, number = _tolerance(name, of, value, known[of], parent)
                found[own] = number
    return found


def _tolerance(name: str, of: str, value: Any, declared: Input, parent: str) -> tuple[str, float]:
    """Return a tolerance and the name that it has in a design."""
    unit = "degrees" if name != of else declared.units
    remedy = f"write a number of at least 0{'' if unit == '1' else f' in {unit}'}"
    remedy += "" if name != of else ', or a text such as "0.1 %"'
    if share := isinstance(value, str):
        number = _percent(value) if name == of else None
    else:
        numbers = in_unit(
            (parent, name), value, numbers_of(parent, name, value), "" if name != of else declared.units
        )
        number = float(numbers) if numbers.ndim == 0 else None
    if number is None or not 0.0 <= number < math.inf:
        raise InputError(f"is {short_repr(value)}", where=(parent, name), remedy=remedy)
    own = tolerance_name(of, relative=share)
    return own if name == of else f"{own}_deg", number


def _percent(text: str) -> float | None:
    """Return the share that a text in per cent means, None for another text."""
    number, sign, rest = text.partition("%")
    try:
        return float(number) / 100.0 if sign and not rest.strip() else None
    except ValueError:
        return None
