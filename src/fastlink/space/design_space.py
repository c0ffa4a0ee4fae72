"""Numbered designs whose inputs are filled in on demand."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fastlink._text import short_repr
from fastlink.doors import door
from fastlink.errors import InputError, Problem, suggest
from fastlink.options import check_whole
from fastlink.space.column import Column, Counted, part_of, read_into
from fastlink.space.listing import Listed
from fastlink.space.values import (
    Floats,
    axis_of,
    cells_of,
    check_input_name,
    constant,
    frozen,
    numbers_of,
    units_of,
    unmasked,
)

#: Dimensions: designs that span no grid, assembly modes, the extremes of a quantity.
DESIGN, BRANCH, EXTREMUM = "design", "branch", "extremum"
MAKERS = "grid, table, sobol and latin_hypercube make design spaces"


@dataclass(frozen=True, eq=False, repr=False)
class DesignSpace(Listed):
    """A set of designs: the values of swept inputs, and the constant inputs.

    Made by `grid`, `table`, `sobol` and `latin_hypercube`. Designs are numbered 0, 1, ... in C order over the
    dimensions; a grid of 10^9 designs costs no more memory than its axes.

    Attributes
    ----------
    kind : str
        ``"grid"``, ``"table"``, ``"sobol"`` or ``"latin_hypercube"``.
    dims : tuple of str
        Swept dimensions: the axes of a grid in the order given, else ``("design",)``; ``()`` for one design. An axis
        that `with_axis` adds is the last.
    shape : tuple of int
        Length of each dimension.
    constants : dict
        Inputs that are the same for every design.
    axes : dict
        Input to its 1-D values, which span the dimension of the same name.
    columns : dict
        Table and samples only: input to its values along ``design``, an array, or a `Column` of values that are
        computed where they are looked at and read as those of an array.
    attrs : dict
        Where the designs come from, as plain file attributes.
    labels : dict
        Columns that are no inputs, such as names or numbers of parts: of texts or numbers along ``design``, or one
        for all designs. They become coordinates. One that is called ``design`` numbers the designs.
    units : dict
        Units that the source states, by input; they are compared with those of the mechanism.
    of_map : bool
        Whether the designs are those of a map.
    ignored : tuple of str
        The names of results that stood beside the designs.
    doubtful : dict
        The problem of each column that holds no finite number somewhere: of a result of a map, or of an input.
    comments : dict
        Remarks for the coordinates of inputs and of the input position.
    """

    kind: str
    dims: tuple[str, ...]
    shape: tuple[int, ...]
    constants: dict[str, float] = field(default_factory=dict)
    axes: dict[str, Floats] = field(default_factory=dict)
    columns: dict[str, Any] = field(default_factory=dict)
    attrs: dict[str, str | int] = field(default_factory=dict)
    labels: dict[str, Any] = field(default_factory=dict, repr=False)
    units: dict[str, str] = field(default_factory=dict, repr=False)
    of_map: bool = field(default=False, repr=False)
    ignored: tuple[str, ...] = field(default=(), repr=False)
    doubtful: dict[str, Problem] = field(default_factory=dict, repr=False)
    comments: dict[str, str] = field(default_factory=dict, repr=False)

    @property
    def size(self) -> int:
        """Number of designs."""
        return math.prod(self.shape)

    @property
    def names(self) -> tuple[str, ...]:
        """Every input that has a value: swept ones first, then constants."""
        return (*self.axes, *self.columns, *self.constants)

    @door
    def values(self, name: str) -> Floats:
        """Return the values of an input, 1-D: its axis, its column or its constant."""
        if not isinstance(name, str):
            raise InputError(f"is {short_repr(name)}", where=("values",), remedy="write the name of an input")
        if name in self.constants:
            return np.array([self.constants[name]])
        if name in self.axes:
            return self.axes[name]
        if name in self.columns:
            return np.asarray(self.columns[name])
        raise self._no_value(name)

    @door
    def fill(self, names: Sequence[str], start: int, stop: int, out: Floats) -> None:
        """Write inputs of designs ``start`` to ``stop - 1`` into rows; thread-safe.

        Parameters
        ----------
        names : sequence of str
            Inputs; ``out[k, :stop - start]`` receives ``names[k]``.
        start, stop : int
            Range of flat design numbers, in C order over `dims`.
        out : ndarray of float64, at least (len(names), stop - start)
            Written in place; the rest of each row is left as it is.

        Raises
        ------
        InputError
            There are no such designs or inputs, or no room for them.
        """
        start = check_whole(("fill", "start"), start, 0, self.size)
        stop = check_whole(("fill", "stop"), stop, start, self.size)
        listed = names.tolist() if isinstance(names, np.ndarray) else names
        if not isinstance(listed, (list, tuple)) or not all(isinstance(name, str) for name in listed):
            raise InputError(
                f"is {short_repr(names)}", where=("fill", "names"), remedy="write a list of inputs"
            )
        for name in listed:
            if name not in self.names:
                raise self._no_value(name)
        room = (len(listed), stop - start)
        right = type(out) is np.ndarray and out.dtype == np.float64 and out.ndim == 2 and out.flags.writeable
        if not right or out.shape[0] < room[0] or out.shape[1] < room[1]:
            remedy = f"write such as numpy.empty({room})"
            raise InputError(f"is {short_repr(out)}", where=("fill", "out"), remedy=remedy)
        self._fill(listed, start, stop, out)

    def _no_value(self, name: str) -> InputError:
        what = f"{short_repr(name)} has no value"
        return InputError(what, where=("design",), remedy=suggest(name, self.names))

    def _fill(self, names: Sequence[str], start: int, stop: int, out: Floats) -> None:
        indices = self._axis_indices(start, stop) if self.axes else {}
        for row, name in zip(out, names, strict=False):
            target = row[: stop - start]
            if name in self.constants:
                target[:] = self.constants[name]
            elif name in self.axes:
                # "clip" writes in place, the default "raise" in a copy of the output; no index needs clipping
                np.take(self.axes[name], indices[name], out=target, mode="clip")
            elif indices:
                inner = self.size // self.shape[0]
                read_into(part_of(self.columns[name], inner, start, stop), 0, stop - start, target)
            else:
                read_into(self.columns[name], start, stop, target)

    @door
    def consecutive(self, start: int, stop: int) -> DesignSpace:
        """Return designs ``start`` to ``stop - 1`` along the one dimension ``design``.

        Their inputs are computed from those of this space where they are looked at: 10^9 of 10^10 designs need no
        memory. The label ``design`` holds their numbers in the whole space, of which this one may be a part itself;
        numbers that a table gives its designs stay, if it is swept along no further axis.

        Parameters
        ----------
        start, stop : int
            Range of flat design numbers, in C order over `dims`; at least one.

        Returns
        -------
        DesignSpace
            Its `attrs` say which designs of how many these are.

        Examples
        --------
        >>> import numpy as np
        >>> import fastlink as fl
        >>> axes = {name: np.linspace(0.5, 1.5, 3000) for name in ("a2", "a3", "a4")}
        >>> some = fl.grid(a1=0.4, **axes).consecutive(5 * 10**9, 5 * 10**9 + 100)
        >>> some.dims, some.shape, some.columns["a4"][:3].round(4).tolist()
        (('design',), (100,), [1.1669, 1.1672, 1.1676])
        >>> int(some.labels["design"][0]), some.attrs["design_start"], some.attrs["design_total"]
        (5000000000, 5000000000, 27000000000)
        """
        start = check_whole(("consecutive", "start"), start, 0, self.size - 1)
        stop = check_whole(("consecutive", "stop"), stop, start + 1, self.size)
        columns, labels, inner = dict[str, Any](), dict[str, Any](), self.size
        for dim, length in zip(self.dims, self.shape, strict=True):
            inner //= length
            along = self.columns if dim == DESIGN else {dim: self.axes[dim]}
            columns |= {name: part_of(values, inner, start, stop) for name, values in along.items()}
        rows = self.size // self.shape[0] if self.dims else 1
        for name, label in self.labels.items():
            if not np.ndim(label):
                labels[name] = label
            elif name != DESIGN:
                labels[name] = part_of(label, rows, start, stop)
            elif rows == 1 and not isinstance(label, Counted):
                labels[name] = part_of(label, 1, start, stop)
        # of a part of another space, in the numbers of that one
        first = rows * int(self.attrs.get("design_start", 0)) + start
        last, total = first + stop - start, rows * int(self.attrs.get("design_total", self.size // rows))
        labels.setdefault(DESIGN, Counted(first, stop - start))
        attrs = {**self.attrs, "design_start": first, "design_stop": last, "design_total": total}
        one: dict[str, Any] = {"dims": (DESIGN,), "shape": (stop - start,), "axes": {}}
        return replace(self, **one, columns=columns, labels=labels, attrs=attrs)

    @door
    def some(self, count: int, rng: np.random.Generator) -> NDArray[np.int64]:
        """Return the numbers of random designs in order; no list of all, perhaps 10^9."""
        count = check_whole(("some", "count"), count, 0)
        if not isinstance(rng, np.random.Generator):
            remedy = "write numpy.random.default_rng(seed)"
            raise InputError(f"is {short_repr(rng)}", where=("some", "rng"), remedy=remedy)
        if count >= self.size:
            return np.arange(self.size)
        return np.sort(rng.choice(self.size, count, replace=False))

    @door
    def at(self, designs: NDArray[np.int64]) -> dict[str, Floats]:
        """Return every input of the designs with these numbers."""
        numbers = _numbers(designs, self.size)
        rows = np.empty((len(self.names), numbers.size))
        for k, design in enumerate(numbers.tolist()):
            self._fill(self.names, design, design + 1, rows[:, k : k + 1])
        return dict(zip(self.names, rows, strict=True))

    @door
    def with_constants(self, extra: Mapping[str, float]) -> DesignSpace:
        """Return this space with further constants; inputs with values keep theirs."""
        if not isinstance(extra, Mapping) or not all(isinstance(name, str) for name in extra):
            remedy = "write a mapping of names to numbers"
            raise InputError(f"is {short_repr(extra)}", where=("with_constants", "extra"), remedy=remedy)
        for name in extra:
            check_input_name("constants", name)
        given = set(self.names)
        new = {name: value for name, value in extra.items() if name not in given}
        added = {name: constant("constants", name, value) for name, value in new.items()}
        units = {key: unit for name, value in new.items() for key, unit in units_of(name, value).items()}
        return replace(self, constants={**self.constants, **added}, units={**self.units, **units})

    @door
    def with_axis(self, name: str, values: Sequence[float]) -> DesignSpace:
        """Return every design at each value of one more input, the fastest dimension."""
        if not isinstance(name, str):
            raise InputError(f"is {short_repr(name)}", where=("with_axis", "name"), remedy="write a name")
        check_input_name("with_axis", name)
        if name in (*self.names, *self.dims):
            raise InputError(
                "has values", where=("with_axis", name), remedy="write the name of another input"
            )
        axis = axis_of("with_axis", name, np.atleast_1d(numbers_of("with_axis", name, values)))
        dims, shape = (*self.dims, name), (*self.shape, len(axis))
        units = {**self.units, **units_of(name, values)}
        return replace(self, dims=dims, shape=shape, axes={**self.axes, name: axis}, units=units)

    def _axis_indices(self, start: int, stop: int) -> dict[str, NDArray[np.int64]]:
        """Return the index of each design along every dimension, the fastest first."""
        indices = {}
        rest = np.arange(start, stop, dtype=np.int64)
        for name, length in zip(reversed(self.dims), reversed(self.shape), strict=True):
            # per 4096 designs: a quotient, product and difference 3.6 us, numpy's remainder alone 7.3 us
            outer = rest // length
            indices[name] = rest - outer * length
            rest = outer
        return indices


def _numbers(designs: Any, size: int) -> NDArray[np.int64]:
    """Return the numbers of designs, or refuse what are none."""
    where, remedy = ("at", "designs"), f"write a list of whole numbers from 0 to {size - 1}"
    numbers = cells_of(unmasked(designs) if isinstance(designs, np.ma.MaskedArray) else designs)
    if numbers.ndim != 1 or numbers.dtype.kind in "mM":
        raise InputError(f"is {short_repr(designs)}", where=where, remedy=remedy)
    if numbers.dtype.kind not in "iu":
        numbers = np.array([check_whole(where, value, 0, size - 1, remedy) for value in numbers.tolist()])
    if numbers.size and not 0 <= int(numbers.min()) <= int(numbers.max()) < size:
        raise InputError(f"holds {numbers.min()} to {numbers.max()}", where=where, remedy=remedy)
    return numbers.astype(np.int64)


DesignSpace.__init__ = door(hint=MAKERS, name="DesignSpace")(DesignSpace.__init__)  # type: ignore[method-assign]


def sampled(
    kind: str,
    constants: dict[str, float],
    columns: Mapping[str, Floats | Column],
    attrs: dict[str, str | int],
    **further: Any,
) -> DesignSpace:
    """Return the space of the columns of a table or a sample, which become read-only."""
    count = len(next(iter(columns.values())))
    for values in columns.values():
        if not isinstance(values, Column):
            frozen(values)
    return DesignSpace(kind, (DESIGN,), (count,), constants, columns=dict(columns), attrs=attrs, **further)


def flat(space: DesignSpace) -> DesignSpace:
    """Return the same designs along the one dimension ``design``, in their order."""
    if space.dims == (DESIGN,) or not space.dims:
        return space
    part = space.consecutive(0, space.size)
    columns = {name: frozen(np.array(values)) for name, values in part.columns.items()}
    labels = {name: label for name, label in space.labels.items() if not label.ndim}
    return replace(part, kind="table", columns=columns, attrs={"design_kind": "table"}, labels=labels)


def held(space: DesignSpace, values: Mapping[str, NDArray[Any]]) -> DesignSpace:
    """Return a space with arrays in place of columns and labels that are computed where they are looked at."""
    columns = {name: values.get(name, column) for name, column in space.columns.items()}
    labels = {**space.labels, **{name: array for name, array in values.items() if name not in columns}}
    return replace(space, columns=columns, labels=labels)
