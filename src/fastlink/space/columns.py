"""Collect the columns and constants of a table: the numbers of inputs, and labels of its rows."""

from __future__ import annotations

from collections.abc import Callable, Collection
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fastlink._text import counted, short_repr, unwritable
from fastlink.errors import InputError, KeyPath, Problem, Problems, Remedy, Setting
from fastlink.space.column import Column
from fastlink.space.design_space import DESIGN, DesignSpace, sampled
from fastlink.space.values import (
    Floats,
    cells_of,
    check_input_name,
    check_no_quantity,
    constant,
    first_invalid,
    numbers_of,
    units_of,
)

__all__ = ["Columns", "check_name", "is_label", "label_of", "or_keep", "refused"]

#: Names of columns that tell designs apart and are no inputs, whatever they hold; and endings of such names.
LABELS = frozenset({DESIGN, "id", "uuid", "name", "label", "index", "key"})
LONGEST_NAME = 200
LABEL_ENDINGS = ("_id", "_name", "_label")
#: A result that every map has: a table with such a column is made of the rows of a map.
OF_EVERY_MAP = "status"


def refused(what: str, remedy: Remedy) -> InputError:
    """Return the error of a table as a whole."""
    return InputError(what, where=("table",), remedy=remedy)


def or_keep(remedy: str, name: str) -> Remedy:
    """Return a remedy with another one, at doors that can: to keep the column as a coordinate."""
    link = " Or" if remedy.endswith("?") else ", or"
    return (remedy, (f"{link} pass ", Setting("keep", [name]), " to keep it as a coordinate of the result"))


def check_name(name: Any, position: int, others: Collection[str], inside: str = "") -> None:
    """Refuse a name of a column that is no text, empty or taken."""
    if not isinstance(name, str) or not name:
        raise refused(f"{inside}column {position + 1} is named {name!r}", "name it by the input it holds")
    if name in others:
        raise refused(f"{inside}two columns are named {name!r}", "name each by the input it holds")


def _check_label_name(name: str) -> None:
    """Refuse a name that no coordinate of a file can have."""
    if not name.isprintable() or "/" in name or len(name) > LONGEST_NAME:
        remedy = "write a short name without '/' and control characters"
        raise refused(f"a column is named {short_repr(name)}", remedy)


def is_label(name: str, keep: Collection[str]) -> bool:
    """Tell whether a column labels designs by its name alone."""
    low = name.lower()
    return name in keep or low in LABELS or low.endswith(LABEL_ENDINGS)


def is_text(values: NDArray[Any]) -> bool:
    """Tell whether values are texts alone, some of which may be missing."""
    if values.dtype.kind in "UT":
        return bool(values.size)
    if values.dtype.kind != "O":
        return False
    cells = values.ravel()
    first = next((cell for cell in cells if not _is_missing(cell)), None)
    return isinstance(first, str) and all(isinstance(cell, str) or _is_missing(cell) for cell in cells)


def _is_missing(cell: Any) -> bool:
    """Tell whether a cell holds None, NaN or the NA of pandas, which does not say whether it equals itself."""
    return (
        cell is None
        or type(cell).__name__ in ("NAType", "NaTType")
        or (isinstance(cell, float) and cell != cell)
    )


def label_of(values: Any, where: KeyPath) -> NDArray[Any]:
    """Return labels as numbers or as texts, which files can hold."""
    array = np.asarray(values)
    if array.dtype.kind in "iuf":
        return np.array(array)
    if array.dtype.kind == "b":
        return array.astype(np.int8)
    if array.dtype.kind in "mM":
        return array.astype(str)
    cells = ["" if _is_missing(cell) else str(cell) for cell in np.asarray(values, dtype=object).ravel()]
    for row, cell in enumerate(cells):
        if sign := unwritable(cell):
            what = f"holds {sign!r}, which no file can hold"
            raise InputError(what, where=(*where, row), remedy="write letters alone")
    return np.array(cells, dtype=str).reshape(array.shape)


class Columns:
    """The columns, constants and labels of a table, checked one by one.

    Parameters
    ----------
    keep : collection of str
        Columns that are kept as labels whatever they hold.
    allow_invalid : bool
        Whether numbers may be NaN or infinite.
    names : collection of str
        All names of the table. Where ``status`` is among them it holds the rows of a map, and NaN is refused only in
        inputs, which are known with the mechanism.
    """

    def __init__(self, keep: Collection[str], allow_invalid: bool, names: Collection[str] = ()) -> None:
        self.keep, self.allow_invalid = keep, allow_invalid
        self.of_map = OF_EVERY_MAP in names
        self.constants: dict[str, float] = {}
        self.columns: dict[str, Floats | Column] = {}
        self.labels: dict[str, NDArray[Any]] = {}
        self.units: dict[str, str] = {}
        self.doubtful: dict[str, Problem] = {}
        self.problems = Problems()
        for name in keep:
            if names and name not in names:
                self.problems.add(f"there is no column {name!r} to keep", ("table",), "leave it out")

    def add(self, name: str, given: Any) -> None:
        """Add a column or a constant; what is wrong with it is noted."""
        with self.problems.at():
            check_no_quantity("table", name, given)
            if is_label(name, self.keep) or is_text(cells_of(given)):
                self.add_label(name, given)
                return
            check_input_name("table", name)
            values = numbers_of("table", name, given)
            self.units |= units_of(name, given)
            if values.ndim == 0:
                self.constants[name] = constant("table", name, values)
            else:
                self.add_numbers(name, values, lambda row: f"row {row} (counted from 0) of column {name}")

    def add_label(self, name: str, given: Any) -> None:
        """Add labels of the designs."""
        _check_label_name(name)
        values = label_of(given, ("table", name))
        if values.ndim > 1:
            raise refused(f"column {name} has {values.ndim} dimensions", "give one label per design")
        if values.ndim:
            self._check_length(name, values)
        self.labels[name] = values

    def add_numbers(self, name: str, values: Floats, cell: Callable[[int], str]) -> None:
        """Add a column of numbers; `cell` words the place of one."""
        self._check_length(name, values)
        bad = None if self.allow_invalid else first_invalid(values)
        if bad is not None:
            self.doubt(name, cell(bad), values[bad])
        self.columns[name] = values

    def doubt(self, name: str, cell: str, value: object) -> None:
        """Note the first cell of a column that holds no finite number."""
        keep = (", or pass ", Setting("allow_invalid", True), " to keep such designs")
        problem = Problem(f"{cell} is {value}", ("table",), ("write a finite number", keep))
        if self.of_map:
            self.doubtful.setdefault(name, problem)
        else:
            self.problems.noted.append(problem)

    def _check_length(self, name: str, values: NDArray[Any]) -> None:
        if values.size == 0:
            raise refused(f"column {name} is empty", "give at least one row")
        others = {**self.columns, **{key: label for key, label in self.labels.items() if label.ndim}}
        for other, known in others.items():
            if len(known) != len(values):
                what = f"column {name} has {counted(len(values), 'value')} but {other} has {len(known)}"
                remedy = "give one per design, or combine all values by fl.grid(**...)"
                raise refused(what, remedy)

    def space(self, attrs: dict[str, str | int], *, single: bool = False) -> DesignSpace:
        """Return the designs, or refuse them with all their problems.

        Parameters
        ----------
        attrs : dict
            Where they come from.
        single : bool
            Whether single numbers alone are one design.
        """
        self.problems.stop()
        further: dict[str, Any] = {"units": self.units, "of_map": self.of_map, "doubtful": self.doubtful}
        if self.columns:
            return sampled("table", self.constants, self.columns, attrs, labels=self.labels, **further)
        if self.constants and single and not any(label.ndim for label in self.labels.values()):
            attrs = {"design_kind": "grid"}
            return DesignSpace("grid", (), (), self.constants, attrs=attrs, labels=self.labels, **further)
        for name, label in self.labels.items():
            text = next((str(cell) for cell in label.ravel()), "")
            raise refused(
                f"column {name} holds {short_repr(text)}, and no column holds numbers",
                "write a number for each input",
            )
        what = f"holds only single numbers ({', '.join(self.constants)})" if self.constants else "is empty"
        raise refused(f"the table {what}", "give at least one column of values, or use grid")
