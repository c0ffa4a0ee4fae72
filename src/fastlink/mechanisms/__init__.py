"""The mechanisms: inputs and facts, nothing else; called, ``fastlink.mechanisms()`` lists them.

>>> import fastlink as fl
>>> fl.mechanisms()[0].name
'planar_4r'
"""

from __future__ import annotations

import copyreg
import os
import sys
import threading
from hashlib import sha256
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any
from weakref import WeakKeyDictionary

from fastlink._text import short_repr
from fastlink.errors import InputError, check_choice, door, suggest
from fastlink.facts.arc import with_arc

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

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


class Mechanism(str):
    """A mechanism of a user's own, from a sheet of formulas: a name that stands for it at every door.

    Attributes
    ----------
    text : str
        The sheet, or the declaration of a linkage by its joints as JSON.
    """

    text: str
    file: str

    def __new__(cls, text: str, file: str) -> Mechanism:
        """Return the name of the mechanism that a sheet declares: its own, and of which text it is."""
        from fastlink.facts.formula import SheetError
        from fastlink.facts.sheet import mechanism_of

        for read in _sheets.values():  # a study and a command name their file at every door
            if read.text == text:
                return read
        sheet, picture = text, None
        if text.startswith("{"):
            from fastlink.mechanisms.linkage import sheet_of_linkage

            sheet, picture = sheet_of_linkage(text)
        try:
            known = mechanism_of(sheet, file)
        except RecursionError:
            what, remedy = (
                "has an expression of too many terms",
                "write it in several lines: y = ..., y = y + ...",
            )
            raise InputError(f"{file} {what}", where=("mechanism",), remedy=remedy) from None
        except SheetError as error:
            raise InputError(error.what, where=("mechanism", error.place), remedy=error.remedy) from None
        if picture is not None and not picture.forces:
            known.lacking = LACKING
        own = super().__new__(cls, f"{known.name}@{sha256(text.encode()).hexdigest()[:8]}")
        own.text, own.file, own.known, own.picture = text, file, with_arc(known), picture
        return _sheets.setdefault(str(own), own)

    known: Catalogue
    picture: Any

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.text, self.file)


#: What a linkage lacks that was declared without masses.
LACKING = (
    (
        "torque",
        "input_power",
        "shaking_",
        "force_",
        "normal_force",
        "driving_force",
        "slot_force",
        "guide_moment",
    ),
    "there are no forces without masses",
    "declare masses= or loads=",
)
#: The mechanisms of sheets by name.
_sheets: dict[str, Mechanism] = {}
SHEET = ".facts"


@door
def mechanism(file: str | os.PathLike[str]) -> Mechanism:
    """Read a mechanism of your own from a sheet of formulas.

    The sheet is data: its formulas are checked against a grammar of arithmetic, and nothing else in it is run.

    Parameters
    ----------
    file : path
        The sheet, a file that ends in ``.facts``: see docs/own_mechanisms.md.

    Returns
    -------
    str
        A name that stands for the mechanism wherever the name of one does: `fastlink.sweep`, `fastlink.function`,
        `fastlink.extend` and so on. Studies and commands take the file itself.

    Raises
    ------
    InputError
        The file cannot be read, or is no sheet of a mechanism: with the line, the reason and the remedy.

    Examples
    --------
    >>> import fastlink as fl
    >>> fl.mechanism("crank.facts")
    Traceback (most recent call last):
    fastlink.errors.InputError: mechanism: cannot read crank.facts: No such file or directory; write the path of a sheet
    """
    if not isinstance(file, (str, os.PathLike)) or not str(file).endswith(SHEET):
        remedy = f"write the path of a sheet, which ends in {SHEET}"
        raise InputError(f"is {short_repr(file)}", where=("mechanism",), remedy=remedy)
    try:
        text = Path(file).read_text(encoding="utf-8")
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or "it is no text in UTF-8"
        what = f"cannot read {file}: {reason}"
        raise InputError(what, where=("mechanism",), remedy="write the path of a sheet") from None
    return Mechanism(text, Path(file).name)


def mechanism_of_map(attrs: Mapping[str, Any]) -> str:
    """Return the name of the mechanism of a map by its attributes, which hold the sheet of a user's own."""
    name = str(attrs.get("mechanism"))
    if "@" in name and name not in _sheets and isinstance(attrs.get("mechanism_sheet"), str):
        return Mechanism(attrs["mechanism_sheet"], f"the sheet of {name}")
    return name


def sheet_of(mechanism: str) -> str:
    """Return the sheet of a mechanism of a user's own, empty for others."""
    return _sheets[mechanism].text if mechanism in _sheets else ""


def picture_of_own(mechanism: str) -> Any:
    """Return the picture of a linkage that a user declared, None for others."""
    return _sheets[mechanism].picture if mechanism in _sheets else None


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


_mechanism_of_file = mechanism


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
        by_input = with_arc(driven[input]())
    return _travelling(by_input, mechanism, input)


def _meant(text: str) -> str:
    """Return the remedy for an unknown mechanism that goes by another name, else an empty text."""
    from fastlink.facts.find import Entry, Index, best_names, did_you_mean

    index = Index(Entry(name, keywords=tuple(KEYWORDS[name].split(", "))) for name in NAMES)
    names = best_names(index.ranked(text))
    return did_you_mean(names) if names else ""


def _package(mechanism: str | None) -> tuple[Catalogue, dict[str, Callable[[], Catalogue]]]:
    """Return the catalogue of a mechanism, and factories of those by its other inputs, by name."""
    if isinstance(mechanism, str) and mechanism.endswith(SHEET):
        mechanism = _mechanism_of_file(mechanism)
    if isinstance(mechanism, str) and mechanism in _sheets:
        return _travelling(_sheets[mechanism].known, _sheets[mechanism]), {}
    mechanism = check_choice(("mechanism",), mechanism, NAMES, meant=_meant)
    package = import_module(f"fastlink.mechanisms.{mechanism}")
    first = with_arc(getattr(package, mechanism))
    return _travelling(first, mechanism), package.DRIVEN


def _travelling(known: Catalogue, *names: Any) -> Catalogue:
    """Return a catalogue that is pickled by its names, for it holds functions."""
    copyreg.pickle(type(known), _by_names)
    _names[known] = names
    return known


def _by_names(known: Catalogue) -> Any:
    return (catalogue, _names[known]) if known in _names else known.__reduce_ex__(2)
