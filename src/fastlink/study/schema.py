"""The keys of a study file and the values that they may have.

A reader takes a value of the file and its place, and returns the value as a sweep takes it, or raises InputError.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from fastlink.errors import InputError, KeyPath, Problems, suggest
from fastlink.space.values import short_repr

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["KEYS", "SAMPLES", "read_tables"]

LONGEST_AXIS = 10_000_000  # 80 MB: axes are held in memory

Reader: TypeAlias = Callable[[Any, KeyPath], Any]


def _value(allowed: str, convert: Callable[[Any], Any]) -> Reader:
    """Return the reader of a value that `convert` returns, or refuses by ValueError."""

    def read(value: Any, where: KeyPath) -> Any:
        try:
            return convert(value)
        except (ValueError, TypeError, OverflowError):
            raise InputError(f"is {short_repr(value)}", where=where, remedy=f"write {allowed}") from None

    return read


def _list(allowed: str, entry: Reader) -> Reader:
    """Return the reader of a list of one or more entries, which have a reader."""

    def read(value: Any, where: KeyPath) -> list[Any]:
        if not isinstance(value, list) or not value:
            raise InputError(f"is {short_repr(value)}", where=where, remedy=f"write {allowed}")
        problems, entries = Problems(), []
        for k, one in enumerate(value):
            with problems.at():
                entries.append(entry(one, (*where, k)))
        problems.stop()
        return entries

    return read


def _table(
    keys: Mapping[str, Reader], other: Reader | None = None, required: Mapping[str, str] | None = None
) -> Reader:
    """Return the reader of a table.

    Parameters
    ----------
    keys : mapping of str to reader
        Its keys.
    other : reader, optional
        The reader of all other keys, which are refused without it.
    required : mapping of str to str, optional
        The keys that must stand in it, with examples.
    """

    def read(value: Any, where: KeyPath) -> dict[str, Any]:
        if not isinstance(value, dict):
            remedy = f"write a table of keys, such as [{where[-1]}]"
            raise InputError(f"is {short_repr(value)}", where=where, remedy=remedy)
        problems, misspelt, values = Problems(), [], {}
        for name, given in value.items():
            reader = keys.get(name, other)
            if reader is None:
                misspelt.append(suggest(name, keys))
                problems.add("is no key here", (*where, name), misspelt[-1])
                continue
            with problems.at():
                values[name] = reader(given, (*where, name))
        for name, example in (required or {}).items():
            if name not in value and f"did you mean {name!r}?" not in misspelt:
                problems.add("is missing", (*where, name), f"write {example}")
        problems.stop()
        return values

    return read


def _either(number: Reader, table: Reader) -> Reader:
    """Return the reader of a value that is a number or a table."""
    return lambda value, where: (table if isinstance(value, dict) else number)(value, where)


def _is(condition: bool, value: Any) -> Any:
    """Return a value that fulfils a condition."""
    if not condition:
        raise ValueError
    return value


def _finite(value: Any) -> float:
    number = isinstance(value, (int, float)) and not isinstance(value, bool)
    return float(_is(number and math.isfinite(value), value))


def _whole(value: Any, least: float = -math.inf, most: float = math.inf) -> int:
    return int(_is(type(value) is int and least <= value <= most, value))


def _count(value: Any) -> int:
    return _whole(value, 1, LONGEST_AXIS)


def _text(value: Any) -> str:
    return str(_is(isinstance(value, str), value))


def _filled(value: Any) -> str:
    return str(_is(bool(_text(value)), value))


def _samples(value: Any) -> tuple[float, float, int]:
    low, high, count = value
    return _finite(low), _finite(high), _count(count)


def _samples_of_one_sign(value: Any) -> tuple[float, float, int]:
    low, high, count = _samples(value)
    return _is(low != 0.0 != high and (low > 0.0) == (high > 0.0), (low, high, count))  # type: ignore[no-any-return]


def _range(value: Any) -> float | tuple[float, float]:
    if not isinstance(value, list):
        return _finite(value)
    low, high = value
    return _finite(low), _finite(high)


def _branches(value: Any) -> int | list[int]:
    return [_whole(one) for one in value] if isinstance(value, list) else _whole(value)


COUNT = f"a whole number n from 1 to {LONGEST_AXIS}"
#: The keys of an axis.
LINSPACE: dict[str, Reader] = {
    "linspace": _value(f"[lo, hi, n] with finite lo and hi and {COUNT}", _samples),
    "values": _list("a list of one or more finite numbers", _value("a finite number", _finite)),
}
AXIS: dict[str, Reader] = LINSPACE | {
    "geomspace": _value(
        f"[lo, hi, n] with finite lo and hi of one sign, neither 0, and {COUNT}", _samples_of_one_sign
    )
}


def _axis(keys: Mapping[str, Reader]) -> Reader:
    """Return the reader of an axis, which has exactly one of some keys."""
    table = _table(keys)

    def read(value: Any, where: KeyPath) -> NDArray[Any]:
        given = table(value, where)
        if len(given) != 1:
            remedy = f"write exactly one of {', '.join(sorted(keys))}"
            raise InputError(f"has {' and '.join(given) or 'no key'}", where=where, remedy=remedy)
        ((kind, numbers),) = given.items()
        if kind == "values":
            return np.array(numbers)
        with np.errstate(
            all="ignore"
        ):  # a value that overflows is refused with its index, as any infinite one
            return (np.linspace if kind == "linspace" else np.geomspace)(*numbers)

    return read


TEXT = _value("a text that is not empty", _filled)
ANGLES = _either(
    _value(
        f"a number of angles from 1 to {LONGEST_AXIS}, {{linspace = [lo, hi, n]}} or {{values = [...]}} in rad",
        _count,
    ),
    _axis(LINSPACE),
)
#: The tables of options, and their keys.
KEYS: dict[str, dict[str, Reader]] = {
    "cycle": {
        "input": TEXT,
        "angles": ANGLES,
        "branch": _value("assembly modes, such as [1, 2]", _branches),
        "solver": _value('"eliminated" or "dense"', _text),
        "extrema": _value('"refined" or "sampled"', _text),
    },
    "run": {"backend": _value('"llvm" or "numba"', _text)},
    "output": {
        "file": TEXT,
        "overwrite": _value("true or false", lambda value: _is(isinstance(value, bool), value)),
        "verify": _value(
            "how many designs to compute again with 50 digits, 0 for none", lambda value: _whole(value, 0)
        ),
    },
}
_SAMPLE = _table(
    {
        "n": _value("a whole number of designs of at least 1", _whole),
        "seed": _value("a whole number of at least 0", _whole),
    },
    _value("[lo, hi] with finite lo < hi, or one finite number", _range),
    {"n": "n = 1024, the number of designs"},
)
#: The keys of [design] that are not inputs.
SAMPLES: dict[str, Reader] = {
    "sobol": _SAMPLE,
    "latin_hypercube": _SAMPLE,
    "table": _value('the path of a CSV file, such as "designs.csv"', _filled),
}
_ENTRY = _either(
    _value(
        "a finite number, or {linspace = [lo, hi, n]}, {geomspace = [lo, hi, n]} or {values = [...]}", _finite
    ),
    _axis(AXIS),
)
_NUMBER_OF_LINKS = _value("one finite number; to sweep it, make it an axis in [design]", _finite)


def _entry(value: Any, where: KeyPath) -> Any:
    """Return the number or the axis of an input."""
    if isinstance(value, dict) and "n" in value:  # a sample under another name
        remedy = suggest(str(where[-1]), ["sobol", "latin_hypercube"])
        raise InputError("is no key here", where=where, remedy=remedy)
    return _ENTRY(value, where)


def read_tables(raw: Mapping[str, Any], position: str) -> dict[str, Any]:
    """Return the tables of a study with values as a sweep takes them.

    Parameters
    ----------
    raw : mapping
        The contents of the file.
    position : str
        The name of the input; other keys of [cycle] that are unknown are kept as None, for a check of their names.

    Raises
    ------
    InputError
        With every key that is unknown or missing, and every value of another type.
    """

    def cycle(value: Any, where: KeyPath) -> Any:
        return ANGLES(value, where) if where[-1] == position else None

    names = _list('a list of names, such as ["omega4_max"]', _value("the name of a quantity as text", _text))
    examples = {
        "mechanism": 'mechanism = "planar_4r"',
        "quantities": 'quantities = ["omega4_max"]',
        "design": "a table [design] with a number or an axis for each input",
    }
    keys: dict[str, Reader] = {
        "mechanism": TEXT,
        "title": TEXT,
        "quantities": names,
        "design": _table(SAMPLES, _entry),
        "links": _table({"model": TEXT}, _NUMBER_OF_LINKS, {"model": 'model = "round_bar"'}),
        "cycle": _table(KEYS["cycle"], cycle),
        "run": _table(KEYS["run"]),
        "output": _table(KEYS["output"]),
    }
    tables: dict[str, Any] = _table(keys, required=examples)(raw, ())
    return {"cycle": {}, "run": {}, "output": {}, **tables}
