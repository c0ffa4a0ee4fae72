"""List a design space: how many designs, along which axes, from where to where, and what it keeps in memory."""

from __future__ import annotations

import html
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from fastlink._text import aligned, counted, html_table, in_words, short_number, size

if TYPE_CHECKING:
    from fastlink.space.design_space import DesignSpace

__all__ = ["Listed"]

HEADER = ("input", "values", "from", "to", "units")
DOUBLE = 8


class Listed:
    """Prints a design space as a table, in a notebook as one of the page."""

    def __repr__(self) -> str:
        space = cast("DesignSpace", self)
        return f"{_title(space)}\n{aligned([HEADER, *_rows(space)], indent='  ')}"

    def _repr_html_(self) -> str:
        """Return the table as a notebook shows it."""
        space = cast("DesignSpace", self)
        return f"<div><b>{html.escape(_title(space))}</b>{html_table(HEADER, _rows(space))}</div>"


def _title(space: DesignSpace) -> str:
    """Return kind, number and memory."""
    arrays = [*space.axes.values(), *(one for one in space.columns.values() if isinstance(one, np.ndarray))]
    held, all_of_them = sum(one.nbytes for one in arrays), DOUBLE * space.size * len(space.names)
    shape = f" ({' x '.join(map(str, space.shape))})" if len(space.shape) > 1 else ""
    about = f"{in_words(space.kind)} of {counted(space.size, 'design')}{shape}"
    return f"{about}, {size(held)} in memory, {size(all_of_them)} as a table of doubles"


def _rows(space: DesignSpace) -> Iterator[tuple[str, ...]]:
    """Yield a row for each input: those that vary, then constants."""
    for name in space.names:
        units = space.units.get(name, "")
        if name in space.constants:
            yield name, "one", short_number(space.constants[name]), "", units
            continue
        values: Any = space.axes.get(name, space.columns.get(name))
        if isinstance(values, np.ndarray) and values.size:
            yield name, f"{values.size:,}", short_number(values.min()), short_number(values.max()), units
        else:
            yield name, f"{len(values):,}", "computed", "", units
