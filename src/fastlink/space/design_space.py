"""Design spaces: numbered designs whose inputs are filled in on demand; angles, columns, links."""

from __future__ import annotations

import hashlib
import html
import math
import numbers
import re
import sys
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from decimal import Decimal
from fractions import Fraction
from typing import Any, SupportsFloat, TypeVar, cast

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin
from numpy.typing import NDArray

from fastlink._text import aligned, counted, html_table, in_words, short_number, short_repr, size
from fastlink.errors import InputError, KeyPath, Problem, Problems, Remedy, check_whole, door, suggest
from fastlink.machine import check_memory
from fastlink.space.units import check_unit, conversion, named_with_unit, scaled, split

# -- Check the values that are given for inputs


T = TypeVar("T")
Floats = NDArray[np.float64]
NUMBERS = "write a number or a flat list of numbers"
#: A text that means a range, and perhaps how many values of it.
RANGE = re.compile(r"\s*([-+]?\d+\.?\d*)\s*:\s*([-+]?\d+\.?\d*)\s*(?::\s*(\d+)\s*)?")
#: Most values of a list or range: 10^8 take 10 s and 0.8 GB to read.
MOST_LISTED = 10**8
#: Most axes of an array of NumPy.
MOST_DIMS = 64
#: Packages whose objects are read by their own rules: an error inside is a defect, and shows.
OWN = ("builtins", "numpy", "pandas", "xarray")


def units_of(name: str, given: Any) -> dict[str, str]:
    """Return the unit that labelled values state in their attributes, by name; empty without one."""
    attrs = given.attrs if has(given, "dtype") and has(given, "attrs") else None
    unit = attrs.get("units") if isinstance(attrs, Mapping) else None
    return {} if unit is None else {name: str(unit)}


def check_no_quantity(where: str, name: str, given: Any) -> None:
    """Refuse values of a package for units, whose units a conversion to an array would drop in silence."""
    if type(given) in (float, int, np.ndarray):
        return
    try:
        unit = _unit_of_quantity(given)
    except Exception:  # whatever a class of somebody's does when it is asked
        return
    if unit is not None:
        remedy = "write plain numbers in SI units, angles in rad, such as by .m_as('m') or .to_value('m')"
        raise InputError(f"has the unit {short_repr(unit)}", where=(where, name), remedy=remedy)


def _unit_of_quantity(given: Any) -> Any:
    """Return the unit of a value of a package for units, of labelled ones or of a list of these; None without."""
    if hasattr(given, "dims"):  # a DataArray, whose data may have units
        given = given.data
    values = [given]
    if isinstance(given, (list, tuple)) and given and type(given[0]) is not float:
        values += (given[0], given[-1])
    for value in values:
        if hasattr(value, "magnitude") or hasattr(value, "to_value"):
            return getattr(value, "units", None) or getattr(value, "unit", None)
    return getattr(getattr(given, "dtype", None), "units", None)  # of pandas with a package for units


def numbers_of(where: str, name: str, given: Any, most_dims: int = 1) -> Floats:
    """Return the values given for an input as a new array of at most so many dimensions, or refuse them."""
    path = (where, name)
    if type(given) is float or (  # the most common ones, at once: a third of the time
        type(given) is np.ndarray and given.dtype == np.float64 and given.ndim <= most_dims
    ):
        return np.array(given)
    check_no_quantity(where, name, given)
    if isinstance(given, (bytes, bytearray, memoryview)):
        raise InputError(f"is {short_repr(given)}, not a number", where=path, remedy=NUMBERS)
    if isinstance(given, (list, tuple)) and not {bool, np.bool_}.isdisjoint(map(type, given)):
        _refuse_non_numbers(where, name, given)  # numpy takes True among numbers for 1
    if isinstance(given, np.ma.MaskedArray):
        given = unmasked(given)
    check_length(path, given)
    try:
        values = np.asarray(given)
    except ValueError:  # nested lists of unequal length
        raise InputError("is a ragged list", where=path, remedy=NUMBERS) from None
    except Exception:  # whatever a class of somebody's does when it is converted
        raise InputError(f"is {short_repr(given)}, not a number", where=path, remedy=NUMBERS) from None
    if values.ndim > most_dims:
        raise InputError(f"has {values.ndim} dimensions", where=path, remedy=NUMBERS)
    if values.dtype.kind in "mM":
        raise InputError("holds dates or durations", where=path, remedy="write numbers")
    if values.dtype.kind not in "iuf":
        _refuse_non_numbers(where, name, given)
    try:
        with np.errstate(over="raise"):  # a longer float than a double
            return values.astype(np.float64)
    except (OverflowError, ValueError, FloatingPointError):  # Decimal("sNaN") is a ValueError
        what = "holds a number beyond the range of a double"
        raise InputError(what, where=path, remedy="write a smaller one") from None


def check_length(where: KeyPath, given: Any, remedy: Remedy = f"write at most {MOST_LISTED}") -> None:
    """Refuse a list or a range of more values than can be read in seconds."""
    if not has(given, "dtype") and listed(given) > MOST_LISTED:
        raise InputError(f"holds {counted(listed(given), 'value')}", where=where, remedy=remedy)


def has(value: Any, name: str) -> bool:
    """Tell whether an object has an attribute, whatever its class does when it is asked."""
    try:
        return hasattr(value, name)
    except Exception:
        return False


def read_or_none(read: Callable[..., T], source: Any, *args: Any, **options: Any) -> T | None:
    """Return what a function reads from an object, None where somebody's class fails when it is read."""
    try:
        return read(source, *args, **options)
    except InputError:
        raise
    except Exception:  # whatever a class of somebody's does when it is asked
        if type(source).__module__.partition(".")[0] in OWN:
            raise
        return None


def unmasked(given: np.ma.MaskedArray[Any, Any]) -> NDArray[Any]:
    """Return an array with NaN in place of what is masked."""
    cells: Any = given.astype(np.float64 if given.dtype.kind in "iuf" else object)
    return np.asarray(cells.filled(np.nan))


def cells_of(given: Any) -> NDArray[Any]:
    """Return the elements of an array in its own type, those of a list as objects; all that is neither as one."""
    try:
        return np.asarray(given, dtype=None if has(given, "dtype") else object)
    except Exception:  # whatever a class of somebody's does when it is converted
        cell = np.empty((), dtype=object)
        cell[()] = given
        return cell


def listed(given: Any) -> int:
    """Return the number of elements of a list or the like, 0 of what has none."""
    try:
        return len(given)
    except OverflowError:  # range(10**30)
        return sys.maxsize
    except Exception:  # whatever a class of somebody's does
        return 0


def check_input_name(where: str, name: str) -> None:
    """Refuse a name that no input can have."""
    if not (name.isascii() and name.isidentifier()):
        what, remedy = f"{short_repr(name)} is no name of an input", "name it by the input, such as a2"
        raise InputError(what, where=(where,), remedy=remedy)


def _refuse_non_numbers(where: str, name: str, given: Any) -> None:
    cells = np.asarray(given, dtype=object)
    if cells.ndim == 0 and not is_number(cells[()]):
        ends = RANGE.fullmatch(cells[()]) if isinstance(cells[()], str) else None
        remedy = named_with_unit(name, cells[()]) or NUMBERS
        if ends is not None:
            axis = f"numpy.linspace({ends[1]}, {ends[2]}, {ends[3] or 11})"
            remedy = f"write {axis if where == 'grid' else '(lo, hi)'}"
        raise InputError(f"is {short_repr(cells[()])}, not a number", where=(where, name), remedy=remedy)
    for index, cell in np.ndenumerate(cells):
        if not is_number(cell):
            what = f"is {short_repr(cell)}, not a number"
            remedy = named_with_unit(name, cell, shown=False) or "write a number"
            raise InputError(what, where=(where, name, *index), remedy=remedy)


def is_number(cell: object) -> bool:
    """Tell whether an object is a real number; True and False are not."""
    # to NumPy a duration is a kind of integer
    return isinstance(cell, (numbers.Real, Decimal)) and not isinstance(cell, (bool, np.timedelta64))


def as_real(value: object) -> float | None:
    """Return a real number as a float, and None of anything else: of NaN and of what is beyond doubles too."""
    if not is_number(value):
        return None
    try:
        number = float(cast(SupportsFloat, value))
    except (OverflowError, ValueError):  # Decimal("sNaN") is a ValueError
        return None
    return None if math.isnan(number) else number


def constant(where: str, name: str, given: Any) -> float:
    """Return the number given for one input, or refuse it."""
    values = numbers_of(where, name, given)
    if values.ndim:
        what = f"holds {counted(len(values), 'value')}"
        raise InputError(what, where=(where, name), remedy="write one number")
    value = float(values)
    if not math.isfinite(value):
        raise InputError(f"is {value}", where=(where, name), remedy="write a finite number")
    return value


def axis_of(where: str, name: str, values: Floats) -> Floats:
    """Return the values of an axis, or refuse them: there is none, or one is not finite or repeated."""
    if values.size == 0:
        raise InputError("is an empty axis", where=(where, name), remedy="give it at least one value")
    bad = first_invalid(values)
    if bad is not None:
        raise InputError(f"is {values[bad]}", where=(where, name, bad), remedy="write a finite number")
    order = np.argsort(values, kind="stable")
    repeats = np.flatnonzero(np.diff(values[order]) == 0)
    if repeats.size:
        first, second = order[repeats[0]], order[repeats[0] + 1]
        what = f"holds {values[first]} twice (at {first} and {second})"
        raise InputError(what, where=(where, name), remedy="give each value once")
    return frozen(values)


def first_invalid(values: Floats) -> int | None:
    """Return the index of the first value that is NaN or infinite."""
    bad = np.flatnonzero(~np.isfinite(values))
    return int(bad[0]) if bad.size else None


def frozen(values: Floats) -> Floats:
    """Return the array itself, made read-only."""
    values.setflags(write=False)
    return values


def in_unit(where: KeyPath, given: Any, numbers: Floats, expected: str) -> Floats:
    """Return the numbers of labelled values in the expected unit, or refuse those that state one of another kind."""
    for unit in units_of("", given).values():
        factor, _ = conversion("", "", unit, expected, where=where)
        numbers = np.asarray(scaled(numbers, factor))
    return numbers


def ends_of(where: str, name: str, given: Any, unit: str, remedy: Remedy) -> tuple[float, float]:
    """Return the ends of a range, or refuse it: not two numbers, not in order, or farther apart than any double."""
    ends = in_unit((where, name), given, numbers_of(where, name, given), unit)
    with np.errstate(over="ignore", invalid="ignore"):
        if ends.shape != (2,) or not 0.0 < ends[1] - ends[0] < np.inf:
            raise InputError(f"is {short_repr(given)}", where=(where, name), remedy=remedy)
    return float(ends[0]), float(ends[1])


# -- Columns of designs whose values are computed where they are looked at


#: Values that are computed at once where many are walked through.
STEP = 1 << 16
#: Values that show in what unit all are given.
FEW = 100
FEWER = "read a part of it, such as column[:1000]"


class Column(NDArrayOperatorsMixin, ABC):
    """Values along the designs that are computed where they are looked at, and held nowhere.

    It reads as a 1-D array: ``column[10:20]``, ``numpy.asarray(column)``, ``column.min()``. Any division into blocks
    gives the same bits, from any thread.

    Attributes
    ----------
    dtype : numpy.dtype
        Of numbers.
    """

    dtype: np.dtype[Any] = np.dtype(np.float64)
    ndim = 1

    def __init__(self, length: int, bounds: tuple[float, float]) -> None:
        self.length, self.bounds = length, bounds

    @abstractmethod
    def read(self, start: int, stop: int, out: NDArray[Any]) -> None:
        """Write values ``start`` to ``stop - 1`` into an array of as many; thread-safe."""

    @property
    @abstractmethod
    def definition(self) -> tuple[Any, ...]:
        """A tuple that tells these values from all others: its text is the same on any machine."""

    @property
    def shape(self) -> tuple[int]:
        """The number of values, as that of an array."""
        return (self.length,)

    @property
    def size(self) -> int:
        """The number of values."""
        return self.length

    @property
    def nbytes(self) -> int:
        """The bytes of all values in memory."""
        return self.length * self.dtype.itemsize

    def piece(self, start: int, stop: int) -> NDArray[Any]:
        """Return values ``start`` to ``stop - 1`` as a new array."""
        values = np.empty(stop - start, self.dtype)
        for first, last in steps(start, stop):
            self.read(first, last, values[first - start : last - start])
        return values

    def sample(self) -> list[float]:
        """Return the bounds and the first values, which show in what unit they are given."""
        return [*self.bounds, *self.piece(0, min(self.length, FEW)).tolist()]

    def __len__(self) -> int:
        return self.length

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        if copy is False:
            raise ValueError("the values are held nowhere: there is no array without a copy")
        check_memory(self.nbytes, f"an array of {self.length:,} values", remedy=FEWER)
        values = self.piece(0, self.length)
        return values if dtype is None else values.astype(dtype, copy=False)

    def __getitem__(self, key: Any) -> Any:
        if isinstance(key, slice):
            start, stop, step = key.indices(self.length)
            if step == 1:
                return self.piece(start, max(start, stop))
        elif isinstance(key, (int, np.integer)) and not isinstance(key, bool):
            number = range(self.length)[key]
            return self.piece(number, number + 1)[0]
        return np.asarray(self)[key]

    def __iter__(self) -> Iterator[Any]:
        for start, stop in steps(0, self.length):
            yield from self.piece(start, stop)

    def __array_ufunc__(self, ufunc: Any, method: str, *inputs: Any, **options: Any) -> Any:
        arrays = [np.asarray(given) if isinstance(given, Column) else given for given in inputs]
        return getattr(ufunc, method)(*arrays, **options)

    def __getattr__(self, name: str) -> Any:
        if not name.startswith("_") and hasattr(np.ndarray, name):
            return getattr(np.asarray(self), name)
        raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")

    def __repr__(self) -> str:
        low, high = self.bounds
        return f"<{self.length:,} values from {low!r} to {high!r}, computed where they are looked at>"


class Gathered(Column):
    """Values of an axis or column of a design space at consecutive designs."""

    def __init__(self, source: NDArray[Any] | Column, inner: int, first: int, length: int) -> None:
        super().__init__(length, bounds_of(source))
        self.source, self.inner, self.first, self.dtype = source, inner, first, source.dtype

    def read(self, start: int, stop: int, out: NDArray[Any]) -> None:
        """Write some values."""
        if start == stop:
            return
        if isinstance(self.source, Column) and self.inner == 1:
            self.source.read(self.first + start, self.first + stop, out)
            return
        index = np.arange(self.first + start, self.first + stop)
        if self.inner > 1:
            index //= self.inner
        if isinstance(self.source, Column):
            low = int(index[0])
            index -= low
            np.take(self.source.piece(low, low + int(index[-1]) + 1), index, out=out, mode="clip")
            return
        count = len(self.source)
        if (self.first + self.length - 1) // self.inner >= count:
            index -= index // count * count  # 3.6 us per 4096, numpy's remainder 7.3 us
        # "clip" writes in place, the default "raise" in a copy of the output; no index needs clipping
        np.take(self.source, index, out=out, mode="clip")

    @property
    def definition(self) -> tuple[Any, ...]:
        """The class and its parameters."""
        if isinstance(self.source, Column) and self.inner == 1:
            return "consecutive", self.first, self.length, self.source.definition
        return "gathered", self.inner, self.first, self.length, definition_of(self.source)


class Counted(Column):
    """Whole numbers that follow each other."""

    dtype = np.dtype(np.int64)

    def __init__(self, first: int, length: int) -> None:
        super().__init__(length, (float(first), float(first + length)))
        self.first = first

    def read(self, start: int, stop: int, out: NDArray[Any]) -> None:
        """Write some numbers."""
        out[:] = np.arange(self.first + start, self.first + stop)

    @property
    def definition(self) -> tuple[Any, ...]:
        """The class and its parameters."""
        return "counted", self.first, self.length


class Converted(Column):
    """Values of another column in another unit."""

    def __init__(self, source: Column, factor: Fraction) -> None:
        low, high = (float(scaled(end, factor)) for end in source.bounds)
        super().__init__(source.length, (low, high))
        self.source, self.factor = source, factor

    def read(self, start: int, stop: int, out: NDArray[Any]) -> None:
        """Write some values."""
        self.source.read(start, stop, out)
        out[:] = scaled(out, self.factor)

    @property
    def definition(self) -> tuple[Any, ...]:
        """The class and its parameters."""
        return "converted", str(self.factor), self.source.definition


def steps(start: int, stop: int) -> Iterator[tuple[int, int]]:
    """Yield the pieces in which many values are walked through."""
    for first in range(start, stop, STEP):
        yield first, min(first + STEP, stop)


def bounds_of(values: NDArray[Any] | Column) -> tuple[float, float]:
    """Return two numbers between which all values are, NaN where one is no number, or there is none."""
    if isinstance(values, Column):
        return values.bounds
    if not values.size or values.dtype.kind not in "iuf":
        return np.nan, np.nan
    return float(values.min()), float(values.max())


def definition_of(values: NDArray[Any] | Column) -> tuple[Any, ...]:
    """Return what values follow from, of an array a hash of them."""
    if isinstance(values, Column):
        return values.definition
    if values.dtype.kind in "iuf":
        return "values", str(values.dtype), hashlib.sha256(np.ascontiguousarray(values).data).hexdigest()
    return "texts", hashlib.sha256(repr(values.tolist()).encode()).hexdigest()


def part_of(values: NDArray[Any] | Column, inner: int, start: int, stop: int) -> NDArray[Any] | Column:
    """Return the values along one dimension at consecutive designs."""
    repeated = inner > 1 or stop > len(values)
    if repeated and values.dtype.kind not in "iuf":  # texts, which no file takes block by block
        return values[np.arange(start, stop) // inner % len(values)]
    if repeated or isinstance(values, Column):
        return Gathered(values, inner, start, stop - start)
    return values[start:stop]


# -- Models of the links, which give mass data from the lengths


MODELS: dict[str, dict[str, str]] = {"round_bar": {"density": "kg m-3", "radius": "m"}}


@dataclass(frozen=True)
class Links:
    """A model of the links, with its inputs that are the same for all designs."""

    model: str
    values: Mapping[str, float]

    def __post_init__(self) -> None:
        if not isinstance(self.model, str) or self.model not in MODELS:
            what = f"{short_repr(self.model)} is unknown"
            raise InputError(what, where=("links", "model"), remedy=suggest(self.model, MODELS))
        problems, known = Problems(), MODELS[self.model]
        numbers: dict[str, float] = {}
        others = {name: name for name in self.values}
        for name, value in self.values.items():
            where = ("links", name)
            of, unit = split(name, known)
            value = value[()] if isinstance(value, np.ndarray) and value.ndim == 0 else value
            if of not in known:
                problems.add(f"{self.model} has no {short_repr(name)}", where, suggest(name, known))
            elif not is_number(value):
                remedy = f"write one number, or leave it out and give {name} in the design"
                problems.add(f"is {short_repr(value)}", where, named_with_unit(name, value) or remedy)
            else:
                number = as_real(value)
                if number is None or not 0 <= number < math.inf:
                    problems.add(f"is {short_repr(value)}", where, "write a finite number of at least 0")
                else:
                    with problems.at(*where):
                        factor = check_unit(of, unit, known[of], others)
                        numbers[of] = float(scaled(number, factor))
        problems.stop()
        object.__setattr__(self, "values", numbers)


def taken_links(given: dict[str, Any]) -> Links | None:
    """Take the numbers of a model of the links out of what is given, and return it; None without any."""
    for model, names in MODELS.items():
        values = {name: given.pop(name) for name in list(given) if split(name, names)[0] in names}
        if values:
            return Links(model, values)
    return None


@door
def round_bar(density: float | None = None, radius: float | None = None, **in_units: float) -> Links:
    """Links made of solid round bars.

    Each link of length a has the mass ``density * pi * radius**2 * a``, the moment of inertia
    ``m (a**2/12 + radius**2/4)`` about its mass centre, and its mass centre at mid-length (Hayes et al.,
    Table 1). Mass data that the design itself gives replace the model's.

    Parameters
    ----------
    density : float, optional
        In kg m-3. Left out, the design gives it (to sweep it, make it an axis there).
    radius : float, optional
        In m. Left out, the design gives it.
    **in_units : float
        Either in another unit: ``density_g_cm3=7.75, radius_mm=10``.

    Raises
    ------
    InputError
        A value is not a finite number, or is negative.

    Examples
    --------
    >>> round_bar(density=7750.0, radius=0.01).values["radius"]
    0.01
    """
    given = {"density": density, "radius": radius, **in_units}
    return Links("round_bar", {name: value for name, value in given.items() if value is not None})


# -- Designs: the values of swept inputs, and the constant inputs


HEADER = ("input", "values", "from", "to", "units")
DOUBLE = 8
#: Dimensions: designs that span no grid, branches, the extremes of a quantity.
DESIGN, BRANCH, EXTREMUM = "design", "branch", "extremum"
MAKERS = "grid, table, sobol and latin_hypercube make design spaces"


@dataclass(frozen=True, eq=False, repr=False)
class DesignSpace:
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

    def __repr__(self) -> str:
        return f"{self._title()}\n{aligned([HEADER, *self._rows()], indent='  ')}"

    def _repr_html_(self) -> str:
        """Return the table as a notebook shows it."""
        return f"<div><b>{html.escape(self._title())}</b>{html_table(HEADER, self._rows())}</div>"

    def _title(self) -> str:
        """Return kind, number and memory."""
        arrays = [*self.axes.values(), *(one for one in self.columns.values() if isinstance(one, np.ndarray))]
        held, all_of_them = sum(one.nbytes for one in arrays), DOUBLE * self.size * len(self.names)
        shape = f" ({' x '.join(map(str, self.shape))})" if len(self.shape) > 1 else ""
        about = f"{in_words(self.kind)} of {counted(self.size, 'design')}{shape}"
        return f"{about}, {size(held)} in memory, {size(all_of_them)} as a table of doubles"

    def _rows(self) -> Iterator[tuple[str, ...]]:
        """Yield a row for each input: those that vary, then constants."""
        for name in self.names:
            units = self.units.get(name, "")
            if name in self.constants:
                yield name, "one", short_number(self.constants[name]), "", units
                continue
            values: Any = self.axes.get(name, self.columns.get(name))
            if isinstance(values, np.ndarray) and values.size:
                yield name, f"{values.size:,}", short_number(values.min()), short_number(values.max()), units
            else:
                yield name, f"{len(values):,}", "computed", "", units

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
            else:
                piece = part_of(self.columns[name], self.size // self.shape[0], start, stop)
                if isinstance(piece, Column):
                    piece.read(0, stop - start, target)
                else:
                    target[:] = piece

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
            elif name != DESIGN or (rows == 1 and not isinstance(label, Counted)):
                labels[name] = part_of(label, rows, start, stop)
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
