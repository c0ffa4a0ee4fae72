"""The shape of a study file: its tables, keys and types, and one line for each thing that is wrong."""

from __future__ import annotations

import contextlib
import re
from collections.abc import Callable, Collection, Iterator
from pathlib import Path
from typing import Annotated, Any, TypeVar

from pydantic import BaseModel, ConfigDict, Discriminator, Field, Tag, ValidationError, WrapValidator
from pydantic_core import PydanticCustomError

from fastlink.errors import InputError, suggest
from fastlink.space import shown

__all__ = ["LONGEST_AXIS", "Angles", "Design", "LinkModel", "Problems", "StudyFile", "problems"]

LONGEST_AXIS = 10_000_000  # 80 MB: axes are held in memory

MOST_LINES = 20
WHERE = re.compile(
    r"^(grid|table|sobol|latin_hypercube|design|links|backend|branch|theta1?|phi|sigma|joint_angle_\d): "
)
# what the functions say to who calls them in Python, and how a study file has it
PHRASES = {
    "(lo, hi)": "[lo, hi]",
    ", or pass allow_invalid=True to keep such designs": "",
    "an array, such as numpy.linspace(-4, 4, 401)": "such as {linspace = [-4, 4, 401]}",
}

T = TypeVar("T")


def _or_say(allowed: str, *, and_inside: bool = False) -> WrapValidator:
    """Whatever is wrong with a value, say in one line what would be right.

    With `and_inside` the entries of a list speak for themselves.
    """

    def check(value: Any, handler: Callable[[Any], T]) -> T:
        try:
            return handler(value)
        except ValidationError as error:
            if and_inside and any(entry["loc"] for entry in error.errors(include_url=False)):
                raise
            context = {"found": shown(value), "allowed": allowed}
            raise PydanticCustomError("allowed", "is {found}; write {allowed}", context) from None

    return WrapValidator(check)


AXIS = "{linspace = [lo, hi, n]}, {geomspace = [lo, hi, n]} or {values = [...]}"
COUNT = f"a whole number n from 1 to {LONGEST_AXIS}"

Finite = Annotated[float, Field(strict=True, allow_inf_nan=False)]
Count = Annotated[int, Field(strict=True, ge=1, le=LONGEST_AXIS)]
Whole = Annotated[int, Field(strict=True)]
Text = Annotated[str, Field(strict=True, min_length=1), _or_say("a text that is not empty")]
Switch = Annotated[bool, Field(strict=True), _or_say("true or false")]
Name = Annotated[str, Field(strict=True), _or_say("the name of a quantity as text")]
Names = Annotated[
    list[Name],
    Field(strict=True, min_length=1),
    _or_say('a list of names, such as ["omega4_max"]', and_inside=True),
]
Number = Annotated[Finite, _or_say("a finite number")]
Numbers = Annotated[
    list[Number],
    Field(strict=True, min_length=1),
    _or_say("a list of one or more finite numbers", and_inside=True),
]
Linspace = Annotated[tuple[Finite, Finite, Count], _or_say(f"[lo, hi, n] with finite lo and hi and {COUNT}")]
Geomspace = Annotated[
    tuple[Finite, Finite, Count],
    _or_say(f"[lo, hi, n] with finite lo and hi of one sign, neither 0, and {COUNT}"),
]
Range = Annotated[
    tuple[Finite, Finite] | Finite, _or_say("[lo, hi] with finite lo < hi, or one finite number")
]


class _Table(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class Angles(_Table):
    """Input angles in rad: exactly one key."""

    linspace: Linspace | None = None
    values: Numbers | None = None


class Axis(Angles):
    """A swept axis: exactly one key."""

    geomspace: Geomspace | None = None


def _kind(value: Any) -> str:
    return "<axis>" if isinstance(value, (dict, Angles)) else "<number>"


Entry = Annotated[
    Annotated[Finite, _or_say(f"a finite number, or {AXIS}"), Tag("<number>")]
    | Annotated[Axis, Tag("<axis>")],
    Discriminator(_kind),
]


class Sample(BaseModel):
    """A space-filling sample: number of designs, seed, and a range for each sampled input."""

    model_config = ConfigDict(extra="allow", frozen=True)
    __pydantic_extra__: dict[str, Range]

    n: Annotated[Whole, _or_say("a whole number of designs of at least 1")]
    seed: Annotated[Whole, _or_say("a whole number of at least 0")] = 0


class Design(BaseModel):
    """The design space: numbers and axes, or numbers and one sample or table."""

    model_config = ConfigDict(extra="allow", frozen=True)
    __pydantic_extra__: dict[str, Entry]

    sobol: Sample | None = None
    latin_hypercube: Sample | None = None
    table: Annotated[Text | None, _or_say('the path of a CSV file, such as "designs.csv"')] = None


class LinkModel(BaseModel):
    """The model of the links, and its inputs that are the same for all designs."""

    model_config = ConfigDict(extra="allow", frozen=True)
    __pydantic_extra__: dict[
        str, Annotated[Finite, _or_say("one finite number; to sweep it, make it an axis in [design]")]
    ]

    model: Text


InputAngles = Annotated[
    Annotated[
        Count,
        _or_say(
            f"a number of angles from 1 to {LONGEST_AXIS}, {{linspace = [lo, hi, n]}} or "
            "{values = [...]} in rad"
        ),
        Tag("<number>"),
    ]
    | Annotated[Angles, Tag("<axis>")],
    Discriminator(_kind),
]


class Cycle(BaseModel):
    """The input, its positions (as ``angles`` or by its own name), the assembly modes and the solver."""

    model_config = ConfigDict(extra="allow", frozen=True)
    __pydantic_extra__: dict[str, InputAngles]

    input: Text | None = None
    angles: InputAngles | None = None
    branch: Annotated[Whole | list[Whole], _or_say("assembly modes, such as [1, 2]")] = [1, 2]
    solver: Annotated[str, Field(strict=True), _or_say('"eliminated" or "dense"')] = "eliminated"
    extrema: Annotated[str | None, Field(strict=True), _or_say('"refined" or "sampled"')] = None


class Run(_Table):
    """How kernels are compiled."""

    backend: Annotated[str | None, Field(strict=True), _or_say('"llvm" or "numba"')] = None


class OutputFile(_Table):
    """Where the result goes, and how many of its designs are computed again."""

    file: Text | None = None
    overwrite: Switch = False
    verify: Annotated[
        int | None,
        Field(strict=True, ge=0),
        _or_say("how many designs to compute again with 50 digits, 0 for none"),
    ] = None


class StudyFile(_Table):
    """A whole study file."""

    mechanism: Text
    title: Text | None = None
    quantities: Names
    design: Design
    links: LinkModel | None = None
    cycle: Cycle = Cycle.model_validate({})
    run: Run = Run()
    output: OutputFile = OutputFile()


_TABLES: dict[str, type[BaseModel]] = {"cycle": Cycle, "run": Run, "output": OutputFile}
_EXAMPLES = {
    "mechanism": 'mechanism = "planar_4r"',
    "quantities": 'quantities = ["omega4_max"]',
    "design": "a table [design] with a number or an axis for each input",
    "n": "n = 1024, the number of designs",
    "model": 'model = "round_bar"',
}


def problems(error: ValidationError, positions: Collection[str]) -> list[tuple[str, str]]:
    """Return the dotted key and the fault of everything that pydantic refused.

    A missing key is left out where a misspelt one stands for it; what stands under a key that is neither an option of
    [cycle] nor one of the input `positions` is left to the check of that key.
    """
    entries = [
        entry
        for entry in error.errors(include_url=False)
        if entry["loc"][:1] != ("cycle",) or {*entry["loc"][1:2]} <= {*Cycle.model_fields, *positions}
    ]
    # a sample's keys under a name that is no kind of sample: that name is what is wrong
    samples = {entry["loc"][:3] for entry in entries if entry["loc"][2:] == ("<axis>", "n")}
    found = [
        (dotted(loc), f"is no key here; {suggest(str(loc[1]), ['sobol', 'latin_hypercube'])}")
        for loc in sorted(samples, key=str)
    ]
    for entry in entries:
        loc = entry["loc"]
        if loc[:3] in samples:
            continue
        kind, name = entry["type"], str(loc[-1])
        if kind == "extra_forbidden":
            text = f"is no key here; {suggest(name, _model_at(loc[:-1]).model_fields)}"
        elif kind == "missing":
            text = f"is missing; write {_EXAMPLES.get(name, name)}"
        elif kind == "allowed":
            text = entry["msg"]
        else:
            text = f"is {shown(entry['input'])}; write a table of keys, such as [{name}]"
        found.append((dotted(loc), text))
    misspelt = " ".join(text for _, text in found)
    return [
        (key, text)
        for key, text in found
        if not (text.startswith("is missing") and f"did you mean {key.rpartition('.')[2]!r}?" in misspelt)
    ]


def dotted(loc: tuple[int | str, ...]) -> str:
    """Return a place in a study file as text, such as ``design.a2.values[3]``.

    Examples
    --------
    >>> dotted(("design", "a2", "<axis>", "values", 3))
    'design.a2.values[3]'
    """
    text = ""
    for part in loc:
        if isinstance(part, int):
            text += f"[{part}]"
        elif not part.startswith("<"):
            text += f".{part}" if text else part
    return text


def _model_at(loc: tuple[int | str, ...]) -> type[BaseModel]:
    if loc and loc[-1] == "<axis>":
        return Angles if loc[0] == "cycle" else Axis
    return _TABLES[str(loc[0])] if loc else StudyFile


class Problems:
    """What is wrong with a study, a line for each."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.lines: list[str] = []

    def add(self, key: str, fault: str) -> None:
        """Note what is wrong with a dotted key; with an empty one, of the study as a whole."""
        for phrase, ours in PHRASES.items():
            fault = fault.replace(phrase, ours)
        name = re.escape(key.rpartition(".")[2])
        if own := re.match(rf"{name}(\[\d+\])? (?=is )", fault):  # "a2[3] is 0": the key says that it is a2
            key, fault = key + (own[1] or ""), fault[own.end() :]
        place = f"{self.path}: {key}" if key else f"{self.path}:"
        # "a2 is 3" reads on after the key, a sentence of its own stands after a colon
        colon = ":" if key and not fault.startswith(("is ", "has ")) else ""
        self.lines.append(f"{place}{colon} {fault}")

    @contextlib.contextmanager
    def at(self, key: str) -> Iterator[None]:
        """Note an InputError as a problem of this key, and go on."""
        try:
            yield
        except InputError as error:
            for line in str(error).splitlines():
                self.add(key, WHERE.sub("", line))

    def error(self) -> InputError:
        """Return the error that holds the lines."""
        lines, more = self.lines[:MOST_LINES], len(self.lines) - MOST_LINES
        if more > 0:
            lines.append(f"{self.path}: and {more} more problems")
        return InputError("\n".join(lines))

    def stop(self) -> None:
        """Raise InputError if anything was found."""
        if self.lines:
            raise self.error()
