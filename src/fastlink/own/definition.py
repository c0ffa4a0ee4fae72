"""Declarations of users as data: inputs, and quantities by their texts, from which catalogues are made anywhere."""

from __future__ import annotations

import linecache
import re
import traceback
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from functools import lru_cache
from hashlib import sha256
from typing import Any

from fastlink.catalogue.sizes import dimensions
from fastlink.errors import InputError
from fastlink.facts.fact import Rule
from fastlink.own.dimension import WrongDimension, dimension_of_text, units_text
from fastlink.own.functions import HELPERS

__all__ = [
    "Definition",
    "OwnInput",
    "OwnQuantity",
    "check_dimension",
    "declared_names",
    "definition_text",
    "function_of",
]


@dataclass(frozen=True)
class OwnInput:
    """An input that a user declares."""

    name: str
    units: str
    symbol: str
    meaning: str
    rule: Rule
    default: float | None

    @property
    def text(self) -> str:
        """Its declaration, to be read and run."""
        given = {"units": self.units, "default": self.default, "rule": self.rule, "description": self.meaning}
        given |= {} if self.symbol == self.name else {"symbol": self.symbol}
        usual = {"rule": "any", "default": None, "description": self.name}
        shown = (f"{key}={value!r}" for key, value in given.items() if value != usual.get(key, ""))
        return f"mine.input({self.name!r}, {', '.join(shown)})"


@dataclass(frozen=True)
class OwnQuantity:
    """A quantity that a user declares.

    Attributes
    ----------
    name, units, symbol, meaning : str
        Its labels.
    parameters : tuple of str
        The names that it depends on.
    fact : str
        Its text as that of a fact.
    written : str
        Its text as the user wrote it.
    imports : tuple of str
        The imports by which that can be run.
    jumps : bool
        Whether it may jump.
    file, line
        Where it stands.
    lines : tuple of int
        The lines there of each line of `fact`, from its second one.
    """

    name: str
    units: str
    symbol: str
    meaning: str
    parameters: tuple[str, ...]
    fact: str
    written: str
    imports: tuple[str, ...]
    jumps: bool
    file: str = field(compare=False, repr=False)
    line: int = field(compare=False, repr=False)
    lines: tuple[int, ...] = field(compare=False, repr=False)

    @property
    def text(self) -> str:
        """Its declaration, to be read and run."""
        symbol = "" if self.symbol == self.name else f", symbol={self.symbol!r}"
        return f"@mine.quantity(units={self.units!r}, description={self.meaning!r}{symbol})\n{self.written}"

    @property
    def function(self) -> Callable[..., Any]:
        """Its text as a function."""
        return function_of(self.name, self.fact)


#: What a user declares, each after what it depends on.
Definition = tuple[OwnInput | OwnQuantity, ...]


@lru_cache(maxsize=1024)
def function_of(name: str, text: str) -> Callable[..., Any]:
    """Return the function of a text, once."""
    file = f"<own quantity {name} {sha256(text.encode()).hexdigest()[:16]}>"
    # kernels read the text of functions there
    linecache.cache[file] = (len(text), None, text.splitlines(keepends=True), file)
    namespace: dict[str, Any] = dict(HELPERS)
    exec(compile(text, file, "exec"), namespace)
    function: Callable[..., Any] = namespace[name]
    return function


def check_dimension(quantity: OwnQuantity, units: Iterable[str]) -> None:
    """Refuse a text that does not give the units of its quantity, for parameters of some units.

    Raises
    ------
    InputError
        With the line, and what to declare.
    """
    declare = "constants have no units: declare mine.input(NAME, units=..., default=...), and write NAME"
    try:
        found = dimension_of_text(quantity.function, dict(zip(quantity.parameters, units, strict=True)))
    except WrongDimension as error:
        own = quantity.function.__code__.co_filename
        numbers = [
            frame.lineno for frame in traceback.extract_tb(error.__traceback__) if frame.filename == own
        ]
        line = quantity.lines[(numbers[-1] or 2) - 2] if numbers else quantity.line
        what = f"line {line} of {quantity.file} {error}"
        raise InputError(what, where=(quantity.name,), remedy=declare) from None
    expected = tuple(map(float, dimensions(quantity.units)))
    if found != expected:
        gives = "a number without units" if not any(found) else units_text(found)
        what = f"is declared in {quantity.units!r}, and its text gives {gives}"
        if any(found) and not any(expected):
            remedy = (
                f'divide by an input of that unit: mine.input(NAME, units="{units_text(found)}", default=...)'
            )
        else:
            remedy = f"declare units={'1' if not any(found) else units_text(found)!r}, or mend the text"
        raise InputError(what, where=(quantity.name,), remedy=remedy)


def declared_names(text: str) -> list[str]:
    r"""Return the names that a text of `definition_text` declares.

    Examples
    --------
    >>> declared_names("mine.input('weight', units='1')\n\n@mine.quantity(units='N')\ndef load(F21):")
    ['weight', 'load']
    """
    return ["".join(found) for found in re.findall(r"^def (\w+)|^mine\.input\('(\w+)'", text, re.M)]


def definition_text(mechanism: str, definition: Definition) -> str:
    """Return declarations as a text of Python that makes them again."""
    imports = {line for one in definition if isinstance(one, OwnQuantity) for line in one.imports}
    head = "\n".join([*sorted(imports), "import fastlink as fl", "", f"mine = fl.extend({mechanism!r})"])
    parts = [f"\n{one.text}" if isinstance(one, OwnQuantity) else one.text for one in definition]
    return "\n".join([head, *parts]) + "\n"
