"""Names of mechanisms, inputs and quantities as types, for annotations and for editors.

For each mechanism, such as ``planar_4r``: `Planar4rDriver`, the inputs that may drive it; `Planar4rInput`, all inputs
and their positions; `Planar4rQuantity`, a value at one position; `Planar4rResult`, with reductions over the cycle.
Derivatives, error bounds and lists of extremes are not among them. `MechanismName` is any mechanism.

Type checkers read ``typing.pyi``, which ``python -m tests.support.stub`` writes from the same catalogues.
"""

from __future__ import annotations

import string
from collections.abc import Callable, Iterator
from typing import Any, Literal

from fastlink.facts.catalogue import Catalogue
from fastlink.facts.names import Quantity, Reduced
from fastlink.mechanisms import NAMES, inputs_of
from fastlink.mechanisms import catalogue as find_catalogue
from fastlink.plan.query import REDUCTIONS, points_of


def _catalogues(mechanism: str) -> Iterator[Catalogue]:
    return (find_catalogue(mechanism, driver) for driver in inputs_of(mechanism))


def _results(mechanism: str) -> Iterator[str]:
    """Yield the quantities of a mechanism, their reductions over the cycle and positions of extremes, and of paths."""
    for catalogue in _catalogues(mechanism):
        yield from catalogue.public
    for catalogue in _catalogues(mechanism):
        for name in filter(catalogue.varies, catalogue.public):
            for how, each in REDUCTIONS.items():
                if each.of_path or (each.of_size and catalogue.public[name].flags):
                    continue  # a code has no magnitude
                for position in ("", catalogue.position.name) if each.has_position else ("",):
                    yield str(Reduced(Quantity(name), how, position))
        of_paths = [how for how, each in REDUCTIONS.items() if each.of_path]
        yield from (str(Reduced(Quantity(one), how)) for one in points_of(catalogue) for how in of_paths)


#: What each type of a mechanism lists, by the ending of its name.
_LISTED: dict[str, Callable[[str], Iterator[str]]] = {
    "Driver": lambda mechanism: iter(inputs_of(mechanism)),
    "Input": lambda mechanism: (name for each in _catalogues(mechanism) for name in each.variables),
    "Quantity": lambda mechanism: (name for each in _catalogues(mechanism) for name in each.public),
    "Result": _results,
}


def _alias(mechanism: str, noun: str) -> str:
    """Return the name of a type, such as Planar4rInput."""
    return string.capwords(mechanism, "_").replace("_", "") + noun


#: The mechanism and the ending of each type.
_TYPES = {_alias(mechanism, noun): (mechanism, noun) for mechanism in NAMES for noun in _LISTED}
__all__ = sorted(("MechanismName", *_TYPES))


def _members(name: str) -> tuple[str, ...]:
    """Return the names that a type lists."""
    if name == "MechanismName":
        return NAMES
    mechanism, noun = _TYPES[name]
    return tuple(dict.fromkeys(_LISTED[noun](mechanism)))


def __getattr__(name: str) -> Any:
    if name not in __all__:
        raise AttributeError(f"module 'fastlink.typing' has no attribute {name!r}")
    return globals().setdefault(name, Literal[_members(name)])  # type: ignore[valid-type]


def __dir__() -> list[str]:
    return __all__
