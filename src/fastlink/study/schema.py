"""The shape of a study file: its tables, keys and types, and what is wrong with them."""

from __future__ import annotations

from collections.abc import Callable, Collection
from typing import TYPE_CHECKING, Annotated, Any, Self, TypeVar

import numpy as np
from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Discriminator,
    Field,
    Tag,
    ValidationError,
    WrapValidator,
    model_validator,
)
from pydantic_core import PydanticCustomError

from fastlink.errors import Problem, suggest
from fastlink.space.design_space import short_repr

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["LONGEST_AXIS", "TABLES", "Angles", "Design", "LinkModel", "StudyFile", "problems"]

LONGEST_AXIS = 10_000_000  # 80 MB: axes are held in memory

T = TypeVar("T")


def _refused(what: str, remedy: str) -> PydanticCustomError:
    return PydanticCustomError("allowed", "{what}; {remedy}", {"what": what, "remedy": remedy})


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
            raise _refused(f"is {short_repr(value)}", f"write {allowed}") from None

    return WrapValidator(check)


AXIS = "{linspace = [lo, hi, n]}, {geomspace = [lo, hi, n]} or {values = [...]}"
COUNT = f"a whole number n from 1 to {LONGEST_AXIS}"


def _of_one_sign(given: tuple[float, float, int]) -> tuple[float, float, int]:
    low, high, _ = given
    if not (low and high and (low > 0) == (high > 0)):
        raise ValueError("the ends have not one sign")
    return given


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
    AfterValidator(_of_one_sign),
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

    @model_validator(mode="after")
    def _has_one_key(self) -> Self:
        given = [name for name, value in self if value is not None]
        if len(given) != 1:
            known = ", ".join(sorted(type(self).model_fields))
            raise _refused(f"has {' and '.join(given) or 'no key'}", f"write exactly one of {known}")
        return self

    def array(self) -> NDArray[Any]:
        """Return the values, from the one key."""
        ((kind, value),) = [(name, value) for name, value in self if value is not None]
        if kind == "values":
            return np.array(value)
        low, high, n = value
        with np.errstate(all="ignore"):  # what overflows is found with its index, as any infinite value
            return (np.linspace if kind == "linspace" else np.geomspace)(low, high, n)


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


#: The tables of options.
TABLES: dict[str, type[BaseModel]] = {"cycle": Cycle, "run": Run, "output": OutputFile}
_EXAMPLES = {
    "mechanism": 'mechanism = "planar_4r"',
    "quantities": 'quantities = ["omega4_max"]',
    "design": "a table [design] with a number or an axis for each input",
    "n": "n = 1024, the number of designs",
    "model": 'model = "round_bar"',
}


def problems(error: ValidationError, positions: Collection[str]) -> list[Problem]:
    """Return everything that pydantic refused.

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
        Problem("is no key here", _where(loc), suggest(str(loc[1]), ["sobol", "latin_hypercube"]))
        for loc in sorted(samples, key=str)
    ]
    for entry in entries:
        loc = entry["loc"]
        if loc[:3] in samples:
            continue
        kind, name = entry["type"], str(loc[-1])
        if kind == "extra_forbidden":
            what, remedy = "is no key here", suggest(name, _model_at(loc[:-1]).model_fields)
        elif kind == "missing":
            what, remedy = "is missing", f"write {_EXAMPLES.get(name, name)}"
        elif kind == "allowed":
            what, remedy = entry["ctx"]["what"], entry["ctx"]["remedy"]
        else:
            what, remedy = f"is {short_repr(entry['input'])}", f"write a table of keys, such as [{name}]"
        found.append(Problem(what, _where(loc), remedy))
    meant = {(*one.where[:-1], one.remedy) for one in found if one.what == "is no key here"}
    return [
        one
        for one in found
        if one.what != "is missing" or (*one.where[:-1], f"did you mean {one.where[-1]!r}?") not in meant
    ]


def _where(loc: tuple[int | str, ...]) -> tuple[int | str, ...]:
    """Return a place in a study file without pydantic's tags."""
    return tuple(part for part in loc if isinstance(part, int) or not part.startswith("<"))


def _model_at(loc: tuple[int | str, ...]) -> type[BaseModel]:
    if loc and loc[-1] == "<axis>":
        return Angles if loc[0] == "cycle" else Axis
    return TABLES[str(loc[0])] if loc else StudyFile
