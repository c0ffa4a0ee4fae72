"""Find the design that is drawn: by numbers, in a study, or in a map."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from fastlink._text import short_repr
from fastlink.errors import InputError
from fastlink.mechanisms import catalogue
from fastlink.space.links import Links

__all__ = ["Source", "read_source"]


@dataclass(frozen=True)
class Source:
    """A design and what else its source says.

    Attributes
    ----------
    mechanism : str
        The name of the mechanism.
    inputs : dict
        Inputs, and the input position, as they were given.
    branch : int or None
        The assembly mode of a row.
    links : Links or None
        Where mass data come from.
    input : str or None
        What drives.
    """

    mechanism: str
    inputs: dict[str, Any]
    branch: int | None = None
    links: Links | None = None
    input: str | None = None


def read_source(mechanism: Any, design: Any, at: Any, inputs: Mapping[str, Any]) -> Source:
    """Return the design that a caller names, or refuse it."""
    catalogue(mechanism)
    if design is not None and not isinstance(design, Mapping):
        what = f"is {short_repr(design)}"
        raise InputError(what, where=("design",), remedy="write the inputs by name, such as a1=0.4")
    own = dict(design or {})
    twice = [name for name in own if name in inputs]
    if twice:
        raise InputError(f"{twice[0]} is given twice", where=("design",), remedy="write it once")
    return Source(mechanism, {**own, **inputs})
