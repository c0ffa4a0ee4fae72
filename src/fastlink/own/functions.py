"""The functions that a user's text may call, and what is written for them in the text of a fact."""

from __future__ import annotations

import builtins
import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from fastlink.numerics import elementary, logarithm, vectors

__all__ = [
    "CONSTANTS",
    "HELPERS",
    "MODULES",
    "OwnFunction",
    "constant_of",
    "function_named",
    "names_of_functions",
]

#: What the text of a fact calls.
HELPERS: dict[str, Any] = {
    function.__name__: function
    for function in (
        *(
            elementary.sqrt,
            elementary.atan2,
            elementary.cosine,
            elementary.sine,
            elementary.select,
            logarithm.log,
        ),
        *(vectors.absolute, vectors.choice, vectors.magnitude),
    )
}
HELPERS["NOT_A_NUMBER"] = elementary.NOT_A_NUMBER
#: Modules whose functions may be called by an attribute.
MODULES = (math, np)
CONSTANTS = {"pi": math.pi, "tau": math.tau, "e": math.e}
#: NaN where either number is.
_OUTER = "choice({{a}} != {{a}}, {{a}}, choice({{a}} {sign} {{b}}, {{a}}, {{b}}))"


@dataclass(frozen=True)
class OwnFunction:
    """A function that may be called: how many numbers it takes, and its text, with a, b for them.

    Where it takes any number, the text is that of two, and others follow one by one; a choice by a condition has none.
    """

    count: int | None
    text: str = ""

    @property
    def is_choice(self) -> bool:
        """Whether its first argument is a condition."""
        return not self.text


_FUNCTIONS = {
    "abs": OwnFunction(1, "absolute({a})"),
    "sqrt": OwnFunction(1, "sqrt({a})"),
    "hypot": OwnFunction(2, "magnitude({a}, {b})"),
    "atan2": OwnFunction(2, "atan2({a}, {b})"),
    "sin": OwnFunction(1, "sine({a})"),
    "cos": OwnFunction(1, "cosine({a})"),
    "tan": OwnFunction(1, "sine({a}) / cosine({a})"),
    "atan": OwnFunction(1, "atan2({a}, 1.0)"),
    "asin": OwnFunction(1, "atan2({a}, sqrt((1.0 - {a}) * (1.0 + {a})))"),
    "acos": OwnFunction(1, "atan2(sqrt((1.0 - {a}) * (1.0 + {a})), {a})"),
    "log": OwnFunction(1, "log({a})"),
    "degrees": OwnFunction(1, f"{180.0 / math.pi!r} * {{a}}"),
    "radians": OwnFunction(1, f"{math.pi / 180.0!r} * {{a}}"),
    "max": OwnFunction(None, _OUTER.format(sign=">")),
    "min": OwnFunction(None, _OUTER.format(sign="<")),
    "where": OwnFunction(3),
}
#: Their names in Python's modules and NumPy.
_ALSO = {
    "fabs": "abs",
    "absolute": "abs",
    "arctan2": "atan2",
    "arctan": "atan",
    "arcsin": "asin",
    "arccos": "acos",
}
_ALSO |= {"maximum": "max", "minimum": "min", "rad2deg": "degrees", "deg2rad": "radians"}


def _known() -> dict[Any, str]:
    """Return the names of functions by the objects of Python and NumPy that they are."""
    found: dict[Any, str] = {}
    for name in (*_FUNCTIONS, *_ALSO):
        for module in (builtins, math, np):
            function = getattr(module, name, None)
            if function is not None and not (module is np and name in ("max", "min")):
                found[function] = _ALSO.get(name, name)
    return found


_OBJECTS = _known()


def function_named(name: str, meant: Any) -> OwnFunction | None:
    """Return a function by its name, or by the object that the name stands for, None of any other.

    A name that stands for nothing is taken by its letters.
    """
    try:
        known = _OBJECTS.get(meant) if meant is not None else _ALSO.get(name, name)
    except TypeError:  # what has no hash
        return None
    return None if known is None else _FUNCTIONS.get(known)


def names_of_functions() -> tuple[str, ...]:
    """Return the names of all functions, for messages."""
    return tuple(sorted(_FUNCTIONS))


def constant_of(value: Any) -> float | None:
    """Return a mathematical constant, None of any other value."""
    return value if isinstance(value, float) and value in CONSTANTS.values() else None
