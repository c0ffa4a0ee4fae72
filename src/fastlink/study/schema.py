"""The keys of a study file and the values that they may have, as models of pydantic."""

from __future__ import annotations

import tomllib
from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from importlib.resources import files
from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import BaseModel, Discriminator, Field, Tag, ValidationError, model_validator
from pydantic_core import PydanticCustomError, core_schema

from fastlink._text import short_repr
from fastlink.errors import KeyPath, Problem, path_text, suggest
from fastlink.mechanisms import NAMES

__all__ = ["A_STUDY", "KEEP", "KEYS", "SAMPLES", "TOLERANCES", "read_tables"]

#: The remedy of those who have no study yet.
A_STUDY = (
    "give the path of a study, a TOML file that names mechanism, designs and quantities; "
    "`fastlink new planar_4r > study.toml` writes one"
)
LONGEST = 10_000_000  # values of an axis: 80 MB in memory


@dataclass(frozen=True)
class Write:
    """The remedy for a value that is refused, whatever is wrong with it; entries of a list have their own."""

    allowed: str

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> core_schema.CoreSchema:
        schema = handler(source)
        checked = core_schema.list_schema(min_length=1) if schema["type"] == "list" else schema
        worded = core_schema.custom_error_schema(
            checked, custom_error_type="write", custom_error_message=self.allowed
        )
        return worded if checked is schema else core_schema.chain_schema([worded, schema])


String = Annotated[str, Field(strict=True)]
Whole = Annotated[int, Field(strict=True)]
Count = Annotated[Whole, Field(ge=1, le=LONGEST)]
Finite = Annotated[float, Field(strict=True, allow_inf_nan=False)]
Number = Annotated[float, Field(strict=True)]
Positive = Annotated[Finite, Field(gt=0)]
Negative = Annotated[Finite, Field(lt=0)]
Text = Annotated[String, Field(min_length=1), Write("a text that is not empty")]
Name = Annotated[String, Write("the name of a quantity as text")]
Entry = Annotated[Finite, Write("a finite number")]
LinkInput = Annotated[Finite, Write("one finite number; to sweep it, make it an axis in [design]")]
Range = Annotated[tuple[Finite, Finite] | Finite, Write("[lo, hi] with finite lo < hi, or one finite number")]
Verified = Annotated[Whole, Field(ge=0), Write("how many designs to compute again with 50 digits, or 0")]
LINSPACE = f"[lo, hi, n] with finite lo and hi and a whole number n from 1 to {LONGEST}"
GEOMSPACE = LINSPACE.replace("and hi", "and hi of one sign, neither 0,")
WHERE = 'such as {status = "rotates_fully", a1 = [0.2, inf]}'
Wanted = Annotated[
    tuple[Number, Number] | String | list[String],
    Write("[lo, hi], inf or -inf for no limit, or the meaning of a code as text"),
]
Names = Annotated[String | list[String], Write("the name of a quantity, or a list of names")]
Refined = Annotated[bool, Field(strict=True)] | list[String]
Linspace = Annotated[tuple[Finite, Finite, Count], Write(LINSPACE)]
OfOneSign = tuple[Positive, Positive, Count] | tuple[Negative, Negative, Count]


class Angles(BaseModel, extra="forbid"):
    """An axis of input positions: exactly one key."""

    linspace: Linspace | None = None
    values: Annotated[list[Entry], Write("a list of one or more finite numbers")] | None = None

    @model_validator(mode="after")
    def _has_one_key(self) -> Self:
        if len(self.model_fields_set) != 1:
            keys = ", ".join(sorted(type(self).model_fields))
            raise PydanticCustomError("write", "exactly one of {keys}", {"keys": keys})
        return self


class Axis(Angles):
    """An axis of an input: exactly one key."""

    geomspace: Annotated[OfOneSign, Write(GEOMSPACE)] | None = None


def _kind(value: Any) -> str:
    return "axis" if isinstance(value, dict) else "number"


def _kind_in_design(value: Any) -> str:
    return "sample" if isinstance(value, dict) and "n" in value else _kind(value)


ANGLES = f"a number of angles from 1 to {LONGEST}, {{linspace = [lo, hi, n]}} or {{values = [...]}}"
INPUT = "a finite number, or {linspace = [lo, hi, n]}, {geomspace = [lo, hi, n]} or {values = [...]}"
Positions = Annotated[
    Annotated[Count, Write(ANGLES), Tag("number")] | Annotated[Angles, Tag("axis")], Discriminator(_kind)
]
DesignInput = Annotated[
    Annotated[Finite, Write(INPUT), Tag("number")] | Annotated[Axis, Tag("axis")],
    Discriminator(_kind_in_design),
]


class Sample(BaseModel, extra="allow"):
    """A space-filling sample: the number of designs, a seed, and a range or a number for each input."""

    __pydantic_extra__: dict[str, Range]
    n: Annotated[Whole, Write("a whole number of designs of at least 1")]
    ranges: dict[String, Range] | None = None
    seed: Annotated[Whole, Write("a whole number of at least 0")] | None = None


class Design(BaseModel, extra="allow"):
    """The table [design]: inputs, and the keys that are not inputs."""

    __pydantic_extra__: dict[str, DesignInput]
    sobol: Sample | None = None
    latin_hypercube: Sample | None = None
    table: Annotated[Text, Write('the path of a CSV or Parquet file, such as "designs.csv"')] | None = None
    keep: Annotated[list[String], Write('names of columns, such as ["part_no"]')] | None = None


class Links(BaseModel, extra="allow"):
    """The table [links]: a model of the links, and its inputs."""

    __pydantic_extra__: dict[str, LinkInput]
    model: Text


class Cycle(BaseModel, extra="allow"):
    """The table [cycle]: options, and input positions by the name of the input."""

    __pydantic_extra__: dict[str, Positions]
    input: Text | None = None
    angles: Positions | None = None
    branch: Annotated[Whole | list[Whole], Write("assembly modes, such as [1, 2]")] | None = None
    solver: Annotated[String, Write('"eliminated" or "dense"')] | None = None
    extrema: Annotated[String, Write('"refined" or "sampled"')] | None = None


class Run(BaseModel, extra="forbid"):
    """The table [run]."""

    backend: Annotated[String, Write('"llvm" or "numba"')] | None = None


class Search(BaseModel, extra="forbid"):
    """The table [search]."""

    minimise: Names | None = None
    maximise: Names | None = None
    where: Annotated[dict[String, Wanted], Write(WHERE)] | None = None
    top: Annotated[Whole, Field(ge=1), Write("how many designs, a whole number of at least 1")] | None = None
    infinite: Annotated[bool, Field(strict=True), Write("true or false")] | None = None
    refine: Annotated[Refined, Write('true, false or names of inputs, such as ["a1", "a2"]')] | None = None
    bounds: Annotated[dict[String, tuple[Finite, Finite]], Write("such as {a1 = [0.2, 0.5]}")] | None = None
    samples: Annotated[Whole, Field(ge=1), Write("how many designs to sample, at least 1")] | None = None
    seed: Annotated[Whole, Field(ge=0), Write("a whole number of at least 0")] | None = None


class Output(BaseModel, extra="forbid"):
    """The table [output]."""

    file: Text | None = None
    overwrite: Annotated[bool, Field(strict=True), Write("true or false")] | None = None
    layout: Annotated[Literal["curves", "maps"], Write('"curves" or "maps"')] | None = None
    verify: Verified | None = None


class StudyFile(BaseModel, extra="forbid"):
    """A study file."""

    mechanism: Text
    title: Text | None = None
    quantities_file: Annotated[Text, Write('the path of a Python file, such as "mine.py"')] | None = None
    quantities: Annotated[list[Name], Write('a list of names, such as ["omega4_max"]')]
    design: Design
    links: Links | None = None
    tolerances: dict[String, Any] | None = None
    cycle: Cycle | None = None
    run: Run | None = None
    search: Search | None = None
    output: Output | None = None


#: The table of tolerances, by the names of inputs.
TOLERANCES = "tolerances"
#: The tables of options, and their keys.
KEYS = {
    "cycle": Cycle.model_fields,
    "run": Run.model_fields,
    "search": Search.model_fields,
    "output": Output.model_fields,
}
#: The key of [design] for columns of a table that are kept as labels; those that give all designs at once.
KEEP = "keep"
SAMPLES = [name for name in Design.model_fields if name != KEEP]
#: The keys of tables without other keys, by the table of the study that they are in.
KNOWN = KEYS | {"design": Axis.model_fields, "cycle": Angles.model_fields}
#: What stands for a required key that is missing, to read the others; how often what is wrong is left out.
REQUIRED: dict[str, Any] = {"mechanism": "?", "quantities": ["status"], "design": {}}
PASSES = 4
#: The quantity in examples, which stands for one of the mechanism of the study.
EXAMPLE = "omega4_max"
#: Examples of required keys.
EXAMPLES = {
    "mechanism": 'mechanism = "planar_4r"',
    "quantities": 'quantities = ["omega4_max"]',
    "design": "a table [design] with a number or an axis for each input",
    "n": "n = 1024, the number of designs",
    "model": 'model = "round_bar"',
}


def read_tables(raw: Mapping[str, Any], positions: Collection[str]) -> tuple[dict[str, Any], list[Problem]]:
    """Return the tables of a study with values as a sweep takes them, and the problems of the rest, left out.

    Parameters
    ----------
    raw : mapping
        The contents of the file.
    positions : collection of str
        The names of input positions; values of other unknown keys of [cycle] are left to a check of their names.

    Returns
    -------
    tables : dict
        What is without problems.
    problems : list of Problem
        Every key that is unknown or missing, and every value of another type.
    """
    problems: list[Problem] = []
    empty: dict[str, Any] = {"cycle": {}, "run": {}, "output": {}}
    absent: set[str] = set()
    example = _example(raw.get("mechanism"))
    for _ in range(PASSES):
        try:
            tables = _plain(StudyFile.model_validate(raw))
            return {**empty, **{name: tables[name] for name in tables if name not in absent}}, problems
        except ValidationError as error:
            problems += [_with_example(one, example) for one in _problems(error, positions)]
            raw = _without(raw, [entry["loc"] for entry in error.errors(include_url=False)], absent)
    return empty, problems


def _example(mechanism: Any) -> str:
    """Return a quantity of a mechanism for messages: the first one of its template."""
    if mechanism not in NAMES:
        return EXAMPLE
    template = files("fastlink").joinpath("mechanisms", str(mechanism), "study.toml")
    return str(tomllib.loads(template.read_text(encoding="utf-8"))["quantities"][0])


def _with_example(problem: Problem, name: str) -> Problem:
    """Return a problem whose remedy has a quantity of the mechanism for an example."""
    remedy = problem.remedy
    return replace(problem, remedy=remedy.replace(EXAMPLE, name)) if isinstance(remedy, str) else problem


def _without(raw: Mapping[str, Any], paths: list[Any], absent: set[str]) -> dict[str, Any]:
    """Return a study without the keys of some paths; a placeholder stands for one that a study must have."""
    rest = {name: dict(value) if isinstance(value, dict) else value for name, value in raw.items()}
    for head, *inner in paths:
        if head in REQUIRED and not inner:
            rest[head] = REQUIRED[head]
            absent.add(head)
        elif head == "quantities":
            rest[head] = [name for name in rest[head] if isinstance(name, str)] or REQUIRED[head]
        elif inner and isinstance(rest.get(head), dict) and inner[0] in rest[head]:
            del rest[head][inner[0]]
        elif not inner or head not in REQUIRED:
            rest.pop(head, None)
    return rest


def _plain(value: Any) -> Any:
    """Return a table as a dictionary of its given keys, an axis as an array, other values as they are."""
    if not isinstance(value, BaseModel):
        return value
    given = {name: _plain(entry) for name, entry in value if name in value.model_fields_set}
    if not isinstance(value, Angles):
        return given
    ((kind, numbers),) = given.items()
    if kind == "values":
        return np.array(numbers)
    with np.errstate(all="ignore"):  # a value that overflows is refused with its index, as any infinite one
        return (np.linspace if kind == "linspace" else np.geomspace)(*numbers)


def _table(where: KeyPath) -> str:
    """Return the table that holds a key, as its author writes it."""
    return f"[{path_text(where[:-1])}]" if where[1:] else "a study"


def _problems(error: ValidationError, positions: Collection[str]) -> list[Problem]:
    """Return the errors of pydantic as problems; a misspelt key stands for the one that is missing."""
    problems, misspelt = [], set()
    for entry in reversed(error.errors(include_url=False)):  # unknown keys come after missing ones
        path, kind = entry["loc"], entry["type"]
        if path[0] == "cycle" and path[1:] and path[1] not in (*KEYS["cycle"], *positions):
            continue
        # The third part of a path is the tag of a number or an axis, except in a sample.
        whole = path[0] == "search" or {*SAMPLES, KEEP} & {*path[1:2]}
        where = path if whole else (*path[:2], *path[3:])
        what, name = f"is {short_repr(entry['input'])}", str(path[-1])
        if kind == "write":
            remedy = f"write {entry['msg']}"
        elif kind == "missing":
            what, remedy = "is missing", f"write {EXAMPLES[name]}"
        elif kind == "union_tag_invalid":
            what, remedy = f"is not a key of {_table(where)}", suggest(name, ["sobol", "latin_hypercube"])
        elif kind == "extra_forbidden":
            known = KNOWN[str(path[0])] if path[1:] else StudyFile.model_fields
            what, remedy = f"is not a key of {_table(where)}", suggest(name, known)
            misspelt.add((*where[:-1], remedy))
        else:
            remedy = f"write a table of keys, such as [{name}]"
        if kind != "missing" or (*where[:-1], f"did you mean {name!r}?") not in misspelt:
            problems.append(Problem(what, where, remedy))
    return problems[::-1]
