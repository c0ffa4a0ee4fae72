"""The mechanisms: inputs and facts, nothing else; called, ``fastlink.mechanisms()`` lists them.

>>> import fastlink as fl
>>> fl.mechanisms()[0].name
'planar_4r'
"""

from __future__ import annotations

import copyreg
import sys
import threading
from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING, Any
from weakref import WeakKeyDictionary

from fastlink.errors import check_choice, suggest

if TYPE_CHECKING:
    from collections.abc import Callable

    from fastlink.engine.extend import Extension
    from fastlink.facts.catalogue import Catalogue
    from fastlink.mechanisms.listing import MechanismList
    from fastlink.typing import MechanismName

_lock = threading.Lock()
#: The arguments of `catalogue` that give each one that was asked for.
_names: WeakKeyDictionary[Catalogue, tuple[Any, ...]] = WeakKeyDictionary()
NAMES: tuple[MechanismName, ...] = ("planar_4r", "minkowski_4r", "focal", "hart", "slider_crank")
#: What mechanisms are called elsewhere, by which they are found.
KEYWORDS = {
    "planar_4r": "four-bar, fourbar, 4-bar, four-bar linkage, 4R, crank-rocker, double crank, quadrilateral",
    "minkowski_4r": "minkowski, minkowskian, lorentz, pseudo-euclidean, spacetime",
    "focal": "burmester, focal mechanism, focal linkage",
    "hart": "six-bar, sixbar, straight line, inversor, straight-line linkage",
    "slider_crank": "crank-slider, crankslider, piston, engine, slider, offset slider",
}


class _Package(ModuleType):
    """A package that can be called: a user's ``fastlink.mechanisms`` is both a function and this package."""

    def __call__(self, /, *args: Any, **options: Any) -> MechanismList:
        from fastlink.mechanisms.listing import mechanisms

        return mechanisms(*args, **options)

    def __reduce__(self) -> tuple[Callable[[str], ModuleType], tuple[str]]:
        return import_module, (self.__name__,)


sys.modules[__name__].__class__ = _Package


def is_extension(mechanism: Any) -> bool:
    """Tell whether this is a mechanism with quantities of a user, see `fastlink.engine.extend`."""
    extending = sys.modules.get("fastlink.engine.extend")
    return extending is not None and isinstance(mechanism, extending.Extension)


def name_of(mechanism: str | Extension) -> str:
    """Return the name of a mechanism, also of one with quantities of a user."""
    return mechanism.mechanism if is_extension(mechanism) else mechanism  # type: ignore[return-value,union-attr]


def inputs_of(mechanism: str | Extension) -> tuple[str, ...]:
    """Return the names of the inputs that may drive a mechanism; the first does unless another is named."""
    first, driven = _package(name_of(mechanism))
    return (first.position.name, *driven)


def catalogue(mechanism: str | Extension | None, input: str | None = None) -> Catalogue:
    """Return the catalogue of a mechanism, driven by the named input or else by its first.

    Raises
    ------
    InputError
        The mechanism or the input is unknown.
    """
    if is_extension(mechanism):
        now: Extension = mechanism.copy()  # type: ignore[union-attr]
        return _travelling(now.catalogue(input), now, input)
    return base_catalogue(mechanism, input)  # type: ignore[arg-type]


def base_catalogue(mechanism: str | None, input: str | None = None) -> Catalogue:
    """Return the catalogue of a mechanism by its name, see `catalogue`."""
    first, driven = _package(mechanism)
    if input is None:
        return first
    known = (first.position.name, *driven)

    def of_that_joint(text: str) -> str:  # theta4 is nearer to theta1 than to joint_angle_4
        numbered = [name for name in known if text[-1:].isdigit() and name.endswith(text[-1])]
        if len(numbered) == 1:
            return f"did you mean {numbered[0]!r}?"
        return suggest(text, numbered) if numbered else ""

    input = check_choice(("input",), input, known, f" to {mechanism}", of_that_joint)
    if input == first.position.name:
        return first
    with _lock:
        by_input = driven[input]()
    return _travelling(by_input, mechanism, input)


def _meant(text: str) -> str:
    """Return the remedy for an unknown mechanism that goes by another name, else an empty text."""
    from fastlink.facts.find import Entry, Index, best_names, did_you_mean

    index = Index(Entry(name, keywords=tuple(KEYWORDS[name].split(", "))) for name in NAMES)
    names = best_names(index.ranked(text))
    return did_you_mean(names) if names else ""


def _package(mechanism: str | None) -> tuple[Catalogue, dict[str, Callable[[], Catalogue]]]:
    """Return the catalogue of a mechanism, and factories of those by its other inputs, by name."""
    mechanism = check_choice(("mechanism",), mechanism, NAMES, meant=_meant)
    package = import_module(f"fastlink.mechanisms.{mechanism}")
    first = getattr(package, mechanism)
    return _travelling(first, mechanism), package.DRIVEN


def _travelling(known: Catalogue, *names: Any) -> Catalogue:
    """Return a catalogue that is pickled by its names, for it holds functions."""
    copyreg.pickle(type(known), _by_names)
    _names[known] = names
    return known


def _by_names(known: Catalogue) -> Any:
    return (catalogue, _names[known]) if known in _names else known.__reduce_ex__(2)
