"""Studies: TOML files that name a mechanism, designs and quantities; read, checked and run."""

from __future__ import annotations

import json
import linecache
import os
import re
import tomllib
import traceback
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from importlib.resources import files
from inspect import signature
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

import numpy as np
from pydantic import AliasChoices, BaseModel, Discriminator, Field, Tag, ValidationError, model_validator
from pydantic_core import PydanticCustomError, core_schema

from fastlink._text import short_repr, size, writable
from fastlink.design.search import SearchRequest, request_of, search
from fastlink.engine.designs import designs_of
from fastlink.engine.extend import Extension
from fastlink.engine.options import check_options
from fastlink.engine.resolve import check, given_tolerances, resolve
from fastlink.engine.sweep import sweep
from fastlink.errors import (
    InputError,
    KeyPath,
    Model,
    Pair,
    Piece,
    Problem,
    Problems,
    Samples,
    Setting,
    Wording,
    check_path,
    door,
    nearest,
    not_a_file,
    path_text,
    suggest,
)
from fastlink.facts.derivative import toleranced
from fastlink.facts.own import TOO_LONG
from fastlink.io.output_path import existing_file, exists_error
from fastlink.io.partial_file import check_target
from fastlink.io.reader import Part, is_hdf5, open_map
from fastlink.mechanisms import NAMES, SHEET, is_extension, name_of
from fastlink.mechanisms import catalogue as find_catalogue
from fastlink.mechanisms import mechanism as read_mechanism
from fastlink.mechanisms.linkage import linkage
from fastlink.plan.query import Results, parse_request, units_of
from fastlink.plan.request import POSITIONS, check_keywords, drivers
from fastlink.space.design_space import MODELS, DesignSpace, Links, bounds_of
from fastlink.space.samplers import grid, latin_hypercube, sobol
from fastlink.space.tables import CURVES, as_space
from fastlink.space.units import KINDS, InUnit, factor_of, named_with_unit, split, with_unit

if TYPE_CHECKING:
    import xarray as xr
    from distributed import Client

    from fastlink.facts.catalogue import Catalogue


# -- Quantities of one's own beside a study: the Python file that declares them, run only by who trusts it


#: The key of a study that names the file, and the option by which it is run.
KEY, TRUST = "quantities_file", "trust_code"
#: The table of a linkage by its joints.
LINKAGE = "linkage"


def load_extension(study: Path, name: Any, mechanism: str, trusted: bool) -> Extension:
    """Return the extension of a mechanism that a file beside a study declares."""
    path = study.parent / check_path((KEY,), name, "mine.py")
    if not trusted:
        what = f"names {str(name)!r}, Python code that is run to declare quantities, by who has read it alone"
        raise InputError(what, (KEY,), (f"read {path}, and if you trust it write ", Setting(TRUST, True)))
    scope = _run(path)
    found = {id(one): (key, one) for key, one in scope.items() if isinstance(one, Extension)}
    fitting = [(key, one) for key, one in found.values() if one.mechanism == mechanism]
    if len(fitting) != 1:
        others = ", ".join(f"{key} of {one.mechanism}" for key, one in found.values())
        what = f"{str(name)!r} declares {others or 'no extension of a mechanism'}"
        raise InputError(what, (KEY,), f'write one: mine = fl.extend("{mechanism}")')
    return fitting[0][1]


def _run(path: Path) -> dict[str, Any]:
    """Return the names that a file defines."""
    try:
        if other := not_a_file(path):
            raise InputError(f"{str(path)!r} {other}", where=(KEY,), remedy="name a file of Python code")
        text = path.read_text(encoding="utf-8-sig")
        code = compile(text, str(path), "exec")
    except (OSError, SyntaxError, ValueError) as error:
        why = f"line {error.lineno}: {error.msg}" if isinstance(error, SyntaxError) else str(error)
        what = f"{str(path)!r} cannot be read ({why})"
        raise InputError(what, (KEY,), "name a file of Python code beside the study") from None
    except (RecursionError, MemoryError):
        raise InputError(f"{str(path)!r} has {TOO_LONG[0]}", (KEY,), TOO_LONG[1]) from None
    linecache.checkcache(str(path))
    scope: dict[str, Any] = {"__name__": path.stem, "__file__": str(path)}
    try:
        exec(code, scope)
    except InputError as error:
        raise InputError.of(_within(error)) from None
    except Exception as error:
        lines = [one.lineno for one in traceback.extract_tb(error.__traceback__) if one.filename == str(path)]
        line = f"line {lines[-1]}: " if lines else ""
        what = f"{path.name} fails with {type(error).__name__} ({line}{error})"
        raise InputError(what, (KEY,), "mend it, and run it by itself: `python FILE`") from None
    return scope


def _within(error: InputError) -> list[Problem]:
    """Return the problems of a declaration, at the key of the study."""
    named = [(one, f"{path_text(one.where)}: {one.what}".removeprefix(": ")) for one in error.problems]
    return [replace(one, where=(KEY,), what=what) for one, what in named]


# -- The keys of a study file and the values that they may have, as models of pydantic


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
Column = Annotated[String, Write("the name of a column as text")]
Entry = Annotated[Finite, Write("a finite number")]
LinkInput = Annotated[Finite, Write("one finite number; to sweep it, make it an axis in [design]")]
Range = Annotated[tuple[Finite, Finite] | Finite, Write("[lo, hi] with finite lo < hi, or one finite number")]
Verified = Annotated[Whole, Field(ge=0), Write("how many designs to compute again with 50 digits, or 0")]
LINSPACE = f"[lo, hi, n] with finite lo and hi and a whole number n from 1 to {LONGEST}"
GEOMSPACE = LINSPACE.replace("and hi", "and hi of one sign, neither 0,")
WHERE = 'such as {status = "rotates_fully", a1 = [0.2, inf]}'
Wanted = Annotated[
    tuple[Number, Number] | Number | String | list[String],
    Write("[lo, hi], inf or -inf for no limit, a number to be met, or the meaning of a code as text"),
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
    keep: Annotated[list[Column], Write('names of columns, such as ["part_no"]')] | None = None
    allow_invalid: Annotated[bool, Field(strict=True), Write("true or false")] | None = None


class LinksTable(BaseModel, extra="allow"):
    """The table [links]: a model of the links, and its inputs."""

    __pydantic_extra__: dict[str, LinkInput]
    model: Text


class Cycle(BaseModel, extra="allow"):
    """The table [cycle]: options, and input positions by the name of the input."""

    __pydantic_extra__: dict[str, Positions]
    input: Text | None = None
    angles: Positions | None = None
    positions: Positions | None = None
    branch: Annotated[Whole | list[Whole] | String, Write("branches, such as [1, 2]")] | None = None
    solver: Annotated[String, Write('"eliminated" or "dense"')] | None = None
    extrema: Annotated[String, Write('"refined" or "sampled"')] | None = None


class Run(BaseModel, extra="forbid"):
    """The table [run]."""

    backend: Annotated[String, Write('"llvm" or "numba"')] | None = None


class Search(BaseModel, extra="forbid"):
    """The table [search]."""

    minimise: Names | None = Field(None, validation_alias=AliasChoices("minimise", "minimize"))
    maximise: Names | None = Field(None, validation_alias=AliasChoices("maximise", "maximize"))
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
    links: LinksTable | None = None
    tolerances: dict[String, Any] | None = None
    units: dict[String, Any] | None = None
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
ALLOW = "allow_invalid"
SAMPLES = [name for name in Design.model_fields if name not in (KEEP, ALLOW)]
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
    """Return the tables of a study with values as a sweep takes them, and the problems of the rest, left out."""
    problems: list[Problem] = []
    empty: dict[str, Any] = {"cycle": {}, "run": {}, "output": {}}
    absent: set[str] = set()
    example = _example(raw.get("mechanism"))
    raw = {"quantities": REQUIRED["quantities"], **raw} if "search" in raw else raw
    raw = {"design": {}, **raw} if _bounds_of(raw) else raw
    for _ in range(PASSES):
        try:
            tables = _plain(StudyFile.model_validate(raw))
            return {**empty, **{name: tables[name] for name in tables if name not in absent}}, problems
        except ValidationError as error:
            problems += _problems(error, positions, example)
            raw = _without(raw, [entry["loc"] for entry in error.errors(include_url=False)], absent)
    return empty, problems


def _bounds_of(tables: Mapping[str, Any]) -> Any:
    """Return the ranges of the sample of a study's search, which may give all its designs."""
    search = tables.get("search")
    return search.get("bounds") if isinstance(search, Mapping) and "samples" in search else None


def _example(mechanism: Any) -> str:
    """Return a quantity of a mechanism for messages: the first one of its template."""
    if mechanism not in NAMES:
        return EXAMPLE
    template = files("fastlink").joinpath("mechanisms", str(mechanism), "study.toml")
    return str(tomllib.loads(template.read_text(encoding="utf-8"))["quantities"][0])


def _without(raw: Mapping[str, Any], paths: list[Any], absent: set[str]) -> dict[str, Any]:
    """Return a study without the keys of some paths; a placeholder stands for one that a study must have."""
    rest = {name: dict(value) if isinstance(value, dict) else value for name, value in raw.items()}
    for head, *inner in paths:
        if head in REQUIRED and not inner:
            rest[head] = REQUIRED[head]
            absent.add(head)
        elif head == "links" and inner[:1] == ["model"]:  # without which its inputs say nothing
            rest.pop(head, None)
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


def _problems(error: ValidationError, positions: Collection[str], example: str) -> list[Problem]:
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
            remedy = named_with_unit(str(where[-1]), entry["input"]) or f"write {entry['msg']}"
        elif kind == "missing":
            what, remedy = "is missing", f"write {EXAMPLES[name]}"
        elif kind == "union_tag_invalid":
            near = nearest(name, ["sobol", "latin_hypercube"])
            what = f"is not a key of {_table(where)}" if near else "is a sample, and named as none"
            remedy = f"did you mean {near!r}?" if near else f"write {INPUT}"
        elif kind == "extra_forbidden":
            known = list(KNOWN[str(path[0])] if path[1:] else StudyFile.model_fields)
            if not path[1:] and isinstance(entry["input"], dict):
                known = [name for name in known if name in (*KNOWN, "links", "units", TOLERANCES)]
            what, remedy = f"is not a key of {_table(where)}", suggest(name, known)
            misspelt.add((*where[:-1], remedy))
        else:
            remedy = f"write a table of keys, such as [{name}]"
        if kind != "missing" or (*where[:-1], f"did you mean {name!r}?") not in misspelt:
            problems.append(Problem(what, where, remedy.replace(EXAMPLE, example)))
    return problems[::-1]


# -- Keys that stand in the wrong table of a study: named with their table, and read there


#: The tables of a study.
PLACES = ("design", "links", *KEYS)
#: Keys at the top of a study, besides its tables.
TOP = [name for name in StudyFile.model_fields if name not in PLACES]
WRITE_ABOVE = "write it above the first [table]: what follows a head such as [design] belongs to that table"


def in_own_tables(
    raw: Mapping[str, Any], catalogue: Catalogue | None
) -> tuple[dict[str, Any], list[Problem]]:
    """Return a study with each key in its table, and a problem for each one that was in another."""
    homes: dict[str, tuple[str, ...]] = {
        "model": ("links",),
        **dict.fromkeys((*SAMPLES, KEEP, ALLOW), ("design",)),
        **dict.fromkeys(TOP, ("",)),
    }
    homes |= {key: (table,) for table, keys in KEYS.items() for key in keys}
    if catalogue is not None:
        of_links = {name for model in MODELS for name in catalogue.variant_inputs.get(model, {})}
        homes |= dict.fromkeys(catalogue.all_inputs, ("design",))
        homes |= dict.fromkeys(of_links, ("links", "design"))
        position = catalogue.position.name
        homes[position] = ("cycle",)
        keys = [key for table in raw.values() if isinstance(table, dict) for key in table]
        homes |= {key: homes[split(key, homes)[0]] for key in keys if split(key, homes)[1]}
    tables = {name: dict(table) for name, table in raw.items() if isinstance(table, dict) and name in PLACES}
    tables[""] = {name: value for name, value in raw.items() if name not in tables}
    problems = []
    for place, given in list(tables.items()):
        for key in list(given):
            home = homes.get(key, (place,))
            if place in home or (place == "" and isinstance(given[key], dict) and key in PLACES):
                continue
            value = given.pop(key)
            if home[0] != "links" or "links" in tables or key == "model":  # without a model they say nothing
                tables.setdefault(home[0], {}).setdefault(key, value)
            what = f"{key} stands {f'under [{place}]' if place else 'outside of every table'}"
            remedy = f"write it under [{home[0]}]" if home[0] else WRITE_ABOVE
            problems.append(Problem(what, ("study", key), remedy))
    top = tables.pop("")
    return {**top, **tables}, problems


def in_own_units(raw: Mapping[str, Any], catalogue: Catalogue) -> dict[str, Any]:
    """Return a study whose numbers are named with the units of its table [units], or refuse that table."""
    units, problems = raw["units"], Problems()
    kinds = {noun: one for one, (noun, _) in KINDS.items()}
    own = {name: one.units for name, one in catalogue.variables.items()}

    def of(name: str) -> str:
        if name not in own and name in Results(catalogue):
            own[name] = units_of(parse_request(name, catalogue), catalogue)
        return own.get(name, "")

    if not isinstance(units, dict):
        raise InputError(f"is {short_repr(units)}", ("units",), "write a table of keys, such as [units]")
    for key, unit in units.items():
        with problems.at("units", key):
            if not (expected := kinds.get(key) or of(key)):
                raise InputError("is unknown", remedy=suggest(key, [*kinds, *own]))
            if factor_of(str(unit), expected) is None:
                usual = KINDS.get(expected, ("", expected))[1]
                what = f"is {short_repr(unit)}, no unit of {key}"
                raise InputError(what, remedy=f'write such as "{usual}"')
    problems.stop()

    def named(name: str, value: Any) -> str:
        is_number = name == catalogue.position.name and not isinstance(value, dict)  # of positions
        is_share = isinstance(value, str) and "%" in value
        unit = "" if is_number or is_share else units.get(name) or units.get(KINDS.get(of(name), ("",))[0])
        return with_unit(name, unit) if unit else name

    def renamed(table: Any, inner: Sequence[str] = (), apart: Collection[str] = ()) -> Any:
        if not isinstance(table, dict):
            return table
        deep = {
            name: renamed(table[name], ("ranges",), Sample.model_fields if name in SAMPLES else ())
            for name in inner
            if name in table
        }
        names = {name: named(name, value) for name, value in table.items() if name not in (*deep, *apart)}
        # a value that is given in its unit too stays, and is refused as such
        return {names.get(n, n) if names.get(n) not in table else n: deep.get(n, table[n]) for n in table}

    inside = {"design": SAMPLES, "links": (), "cycle": (), TOLERANCES: (), "search": ("where", "bounds")}
    return {**raw, **{name: renamed(raw[name], inner) for name, inner in inside.items() if name in raw}}


# -- The table [search] of a study: the designs that it searches, and what for


#: The options of a search, and what they are unless a study gives them.
DEFAULTS = {name: one.default for name, one in signature(search).parameters.items() if name in KEYS["search"]}


def searched_space(space: DesignSpace, table: Mapping[str, Any]) -> DesignSpace:
    """Return the designs of a search: those of the study, or a sample of their ranges, or of other ones."""
    if "samples" not in table:
        if "seed" in table:
            raise InputError("is given without samples", ("seed",), "write samples = 1_000_000")
        return space
    given = {**space.axes, **space.columns}
    ranges: dict[str, Any] = {name: bounds_of(values) for name, values in given.items()}
    ranges |= dict(table.get("bounds", {}))
    constants = {name: value for name, value in space.constants.items() if name not in ranges}
    try:
        return sobol(table["samples"], {**ranges, **constants}, seed=table.get("seed", 0))
    except InputError as error:
        raise InputError.of([_of_search(one) for one in error.problems]) from None


def _of_search(problem: Problem) -> Problem:
    """Return a problem of a sample with the path of the key of [search] that makes it."""
    _, *rest = problem.where or ("",)
    keys: dict[Any, tuple[str, ...]] = {"n": ("samples",), "seed": ("seed",)}
    name = rest[0] if rest else ""
    if name:
        return replace(problem, where=keys.get(name, ("bounds", str(name))))
    remedy = "write bounds = {a1 = [0.2, 0.5]}, or axes in [design]"
    return replace(problem, where=("samples",), remedy=remedy)


def search_options(table: Mapping[str, Any]) -> dict[str, Any]:
    """Return objectives, conditions and the refinement of a table [search], as a search takes them."""
    options = DEFAULTS | {name: value for name, value in table.items() if name in DEFAULTS}
    return options | ({"bounds": None} if "samples" in table else {})  # they are those of the sample


def request_of_search(
    mechanism: Any,
    space: DesignSpace,
    names: list[str],
    table: Mapping[str, Any],
    **options: Any,
) -> SearchRequest:
    """Return the request of the search of a study, or refuse it with all its problems; nothing is compiled."""
    of_sweep = {"input": None, "options": KEYS["cycle"], **options}
    return request_of(mechanism, space, names, search_options(table), **of_sweep)


# -- The wording of problems for the author of a study


class StudyWording(Wording):
    """The wording of problems for the author of a study: in its own keys and grammar."""

    def __init__(
        self, file: Path, tables: Mapping[str, Any] | None = None, space: DesignSpace | None = None
    ) -> None:
        self.file, self.tables, self.space = file, tables or {}, space
        self.door = Wording()

    def within(self, door: Wording) -> Wording:
        """Return this wording with the options of the door that the study was given at."""
        worded = StudyWording(self.file, self.tables, self.space)
        worded.door = door
        return worded

    def line(self, problem: Problem) -> str:
        """Return a problem as one line, after the file."""
        return f"{self.file}: {super().line(problem)}"

    def path(self, where: KeyPath) -> str:
        """Return a path as the key of the study."""
        return "" if where[:1] == ("study",) else path_text(self._key(where))

    def _key(self, where: KeyPath) -> KeyPath:
        where = where[1:] if where[:1] == ("attrs",) else where  # the title, and the names of files
        head, *rest = where or ("",)
        if head in SAMPLES:
            return ("design", *where)
        if head in ("grid", "design"):
            return ("design", *self._sample(rest), *rest)
        key = "file" if head == "to" else head
        for name, keys in KEYS.items():
            if key in keys or key in self._table(name):
                return (name, key, *rest)
        return where

    def _table(self, name: str) -> Mapping[str, Any]:
        table = self.tables.get(name)
        return table if isinstance(table, Mapping) else {}

    def _sample(self, rest: Sequence[str | int]) -> KeyPath:
        """Return the key of the sample or the table that gives an input, if one does."""
        design = self._table("design")
        if self.space is None or not rest or rest[0] not in self.space.names or rest[0] in design:
            return ()
        return tuple(kind for kind in SAMPLES if kind in design)

    def piece(self, piece: Piece) -> str | None:
        """Return a piece of a remedy in the grammar of studies, or None where they have no such key."""
        if isinstance(piece, Samples):
            return f"{{linspace = [{piece.first:g}, {piece.last:g}, {piece.count}]}}"
        if isinstance(piece, Pair):
            return "[lo, hi], inf or -inf for no limit" if piece.unlimited else "[lo, hi]"
        if isinstance(piece, Model):
            keys = "".join(f" {name} = ..." for name in piece.inputs)
            return f'[links] model = "{piece.name}"{keys}'
        if isinstance(piece, Setting):
            if piece.name in ("overwrite", "part", "restart", "trust_code"):
                return self.door.piece(piece)  # for once, by who runs the study
            known = piece.name in (KEEP, ALLOW) or any(piece.name in keys for keys in KEYS.values())
            return f"{piece.name} = {json.dumps(piece.value)}" if known else None
        return piece


# -- The request of a study, from its tables: checked as far as they are without problems


class StudyRequest:
    """The request of a study: its designs as soon as they are read, options of a sweep, input positions by name."""

    def __init__(
        self,
        path: Path,
        raw: Mapping[str, Any],
        tables: dict[str, Any],
        catalogue: Catalogue,
        problems: Problems,
        mechanism: Any,
    ) -> None:
        self.path, self.tables, self.catalogue, self.problems = path, tables, catalogue, problems
        self.mechanism, cycle = mechanism, tables["cycle"]
        options = [name for name in KEYS["cycle"] if name != POSITIONS]
        self.positions = {name: values for name, values in cycle.items() if name not in options}
        own = {**cycle, **tables["run"]}
        self.options = {name: value for name, value in own.items() if name not in self.positions}
        self.of_cycle = {"positions": self.positions, "options": KEYS["cycle"]}
        self.raw = raw
        self.space: DesignSpace | None = None
        #: Tables with problems: what follows from their absence is not a problem of its own.
        self.broken = {str(one.where[0]) for one in problems.noted if one.where} - {"study"}

    def check(self) -> None:
        """Read links and designs, and check all parts together."""
        if any(one.where in (("mechanism",), ("input",)) for one in self.problems.noted):
            self.options.pop("input", None)
        self._check_names_of_cycle()
        if "links" in self.tables and "links" not in self.broken:
            known = len(self.problems.noted)
            with self.problems.at():
                values = dict(self.tables["links"])
                self.options["links"] = Links(values.pop("model"), values)
            self.broken |= {"links"} if len(self.problems.noted) > known else set()
        if "design" in self.tables:
            with self.problems.at():
                self.space = self._space()
                self.problems.wording = StudyWording(self.path, self.raw, self.space)
        names = self.tables.get("quantities", REQUIRED["quantities"])
        found = Problems()
        of_driven = ("input",) in {one.where for one in self.problems.noted}
        found.attempt(self._examine, check if self.problems.noted else resolve, names)
        if of_driven:  # whose inputs are unknown
            found.noted = [one for one in found.noted if one.where[:1] != ("design",)]
        self._add(found.noted)
        self._check_search(names)
        if self.problems.noted and not of_driven:
            self._add_missing(names, found.noted)

    def _examine(self, function: Any, names: list[str]) -> None:
        misspelt = ("mechanism",) in [one.where for one in self.problems.noted]
        mechanism = self.catalogue.name if misspelt else self.mechanism
        space, problems = self.space, Problems()
        if function is check and space is not None:  # which takes inputs by their own names alone
            links = self.options.get("links")
            space = designs_of(self.catalogue, space, links, problems, ALLOW in self.options)
        problems.attempt(function, mechanism, space, names, **self.of_cycle, **self.options)
        problems.stop()

    def _check_search(self, names: list[str]) -> None:
        """Check the table [search], once all else is known to be right."""
        others = any(one.where[:1] != ("search",) for one in self.problems.noted)
        if others or self.space is None or "search" not in self.tables:
            return
        with self.problems.at("search"):
            options = {**self.of_cycle, **self.options}
            made = request_of_search(self.mechanism, self.space, names, self.tables["search"], **options)
            if "quantities" not in self.raw:  # objectives and conditions come along
                self.tables["quantities"] = [one for one in made.quantities if one not in names] or names

    def _check_names_of_cycle(self) -> None:
        """Refuse unknown keys of [cycle] whose values were refused already."""
        cycle = self.raw.get("cycle")
        given = list(cycle) if isinstance(cycle, dict) else []
        lost = [name for name in given if name not in (*self.tables["cycle"], *KEYS["cycle"])]
        self.problems.attempt(check_keywords, self.catalogue.name, self.catalogue, lost, KEYS["cycle"])

    def _add(self, found: list[Problem]) -> None:
        """Add problems, but those that only follow from others, with the numbers that names have in the file."""
        listed = self.raw.get("quantities")
        numbers = (
            [k for k, name in enumerate(listed) if isinstance(name, str)] if isinstance(listed, list) else []
        )
        for one in found:
            head, *rest = one.where or ("",)
            position = self.catalogue.position.name
            if split(str(head), (position,))[0] in ("angles", position) and "cycle" in self.broken:
                continue
            if head == "quantities" and rest and isinstance(rest[0], int) and rest[0] < len(numbers):
                one = replace(one, where=(head, numbers[rest[0]]))
            self.problems.noted.append(one)

    def _add_missing(self, names: list[str], found: list[Problem]) -> None:
        """Add the inputs that are missing for the quantities without problems, if the designs have none."""
        if self.space is None or self.broken & {"design", "links"}:
            return
        if any(one.where[:1] != ("quantities",) or len(one.where) != 2 for one in found):
            return
        wrong = [one.where[1] for one in found]
        try:
            self._examine(resolve, [name for k, name in enumerate(names) if k not in wrong] or ["status"])
        except InputError as error:
            self._add([one for one in error.problems if one.where[:1] in (("design",), ("links",))])

    def _space(self) -> DesignSpace:
        """Return the design space, or refuse it with all its problems."""
        design, path, problems = self.tables["design"], self.path, Problems()
        if "links" in self.broken:  # whose inputs are unknown without their model
            of_links = {name for model in MODELS for name in self.catalogue.variant_inputs.get(model, {})}
            design = {name: value for name, value in design.items() if name not in of_links}
        entries = {name: value for name, value in design.items() if name not in (*SAMPLES, KEEP, ALLOW)}
        constants = {name: value for name, value in entries.items() if isinstance(value, float)}
        swept = [name for name in entries if name not in constants]
        kinds = [name for name in SAMPLES if name in design]
        if len(kinds) + bool(swept) > 1:
            both = [*kinds, *([f"axes ({', '.join(swept)})"] if swept else [])]
            problems.add(f"has {' and '.join(both)}", ("design",), "write one of them, beside constants")
        if KEEP in design and "table" not in design:
            problems.add("names columns of a table", ("design", KEEP), "leave it out, or write table = ...")
        if design.get(ALLOW):
            self.options[ALLOW] = True
            if self.tables.get("search"):
                problems.add("counts for maps alone", ("design", ALLOW), "leave it out")
        if not (design or _bounds_of(self.tables) or self.broken & {"design", "links"}):
            problems.add("is empty", ("design",), "write a number or an axis for each input")
        space: DesignSpace | None = problems.attempt(grid, **entries)
        if len(kinds) == 1:
            (kind,) = kinds
            with problems.at("design", kind):
                if kind == "table":
                    ways = {KEEP: design.get(KEEP, ()), ALLOW: bool(design.get(ALLOW))}
                    space = as_space(path.parent / design["table"], **ways)
                else:
                    space = (sobol if kind == "sobol" else latin_hypercube)(**design[kind])
                for name in constants:
                    if name in space.names:
                        what = f"gives {name}, which stands in [design] too"
                        problems.add(what, ("design", kind), "write it once")
        given = self._tolerances({*design, *(() if space is None else space.names)}, problems)
        problems.stop()
        assert space is not None
        return searched_space(space.with_constants(constants | given), self.tables.get("search", {}))

    def _tolerances(self, in_design: set[str], problems: Problems) -> dict[str, float]:
        """Return the table of tolerances by the names that they have in a design, where they may stand too."""
        given = given_tolerances(self.catalogue, self.tables.get(TOLERANCES, {}), TOLERANCES, problems)
        for name in in_design & given.keys():
            of = (TOLERANCES, toleranced(name))
            problems.add(f"is given, and so is {name} in [design]", of, "write it once")
        return given


# -- The text of a study file, and what is said to files that are something else


#: The table of a study that asks for linkages for a task.
SYNTHESIS = "synthesis"
#: Bytes of a study at most: tables of designs have files of their own.
MOST_BYTES = 16 << 20
#: The remedy for what is not TOML.
TOML = "a study has lines `key = value` under heads such as [design]; `fastlink new planar_4r` prints one"
#: Endings of other files, and the text that they begin with, by what they hold.
OTHERS = (
    ("JSON", (".json",), re.compile(r"\s*\{")),
    ("YAML", (".yaml", ".yml"), re.compile(r"(\s*#.*\n|\s*\n|---\n)*[A-Za-z_]\w*:(\s|$)")),
)
TABLE = re.compile(r"[^=\[\n]*,[^=\[\n]*(\n|$)")


def text_of(path: Path) -> str:
    """Return the text of a study, or refuse what is no file of text."""
    try:
        length = path.stat().st_size
        if other := not_a_file(path):
            raise _refused(path, f"{other}, not a study", A_STUDY)
        if is_hdf5(path):
            raise _refused(path, "is a map, not a study", f"`fastlink info {path}` shows it")
        if length > MOST_BYTES:
            remedy = 'keep designs in a CSV or Parquet file: [design] table = "designs.csv"'
            raise _refused(path, f"has {size(length)}, too long for a study", remedy)
        return path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError as error:
        what = f"is not UTF-8 text ({error.reason} at byte {error.start})"
        raise _refused(path, what, "save it as UTF-8") from None
    except InputError:
        raise
    except (OSError, ValueError) as error:  # ValueError: a NUL in the path
        why = getattr(error, "strerror", None) or str(error)
        what = "is a mechanism, not a study" if str(path) in NAMES else f"cannot be read ({why})"
        raise _refused(path, what, A_STUDY) from None


def contents_of(path: Path, text: str) -> dict[str, Any]:
    """Return the contents of a study as TOML, or say what its text is instead."""
    try:
        contents = tomllib.loads(text)
    except (tomllib.TOMLDecodeError, RecursionError) as error:
        for language, endings, beginning in OTHERS:
            if path.suffix.lower() in endings or beginning.match(text):
                raise _refused(path, f"is {language}, not TOML", TOML) from None
        if path.suffix.lower() in (".csv", ".tsv") or TABLE.match(text):
            remedy = f'name it in one: [design] table = "{path.name}"'
            raise _refused(path, "is a table of designs, not a study", remedy) from None
        raise _refused(path, f"is not TOML: {error}", TOML) from None
    if not contents:
        raise _refused(path, "is empty", A_STUDY)
    return contents


def _refused(path: Path, what: str, remedy: str) -> InputError:
    return InputError.of([Problem(what, ("study",), remedy)], StudyWording(path))


# -- Read, check and run studies


@dataclass(frozen=True, eq=False)
class Study:
    """A study without problems, as `fastlink.sweep` takes it."""

    #: The file.
    path: Path
    #: Its text.
    text: str
    #: Its tables and keys.
    tables: dict[str, Any]
    #: The designs.
    space: DesignSpace
    #: The options of the sweep besides mechanism, designs and quantities.
    options: dict[str, Any]
    #: The mechanism: its name, or one with the quantities that a file beside the study declares.
    mechanism: str | Extension

    @property
    def sources(self) -> tuple[Path, ...]:
        """The files that it was read from: itself, a table of designs, and Python code that declares quantities."""
        others = (self.tables["design"].get("table"), self.tables.get(KEY))
        return (self.path, *(self.path.parent / other for other in others if other is not None))

    @property
    def quantities(self) -> list[str]:
        """The names of the quantities."""
        return list(self.tables["quantities"])

    @property
    def search(self) -> dict[str, Any] | None:
        """Objectives and conditions, as `fastlink.search` takes them; None of a study whose map is written."""
        return search_options(self.tables["search"]) if "search" in self.tables else None

    @property
    def output(self) -> dict[str, Any]:
        """Its table [output]."""
        return dict(self.tables["output"])

    def target(self, to: str | Path | None = None, part: Part | None = None) -> Path:
        """Return the file to write: a given one, else its own or one of its name here, with the part in its name."""
        target = Path(os.path.expanduser(to or self.output.get("file") or f"{self.path.stem}.h5"))
        return target if to or part is None else part.path(target)


def in_study(name: str) -> str:
    """Return where a study has what is no parameter of a function that takes one; "" of other names, or what one is."""
    if not name:
        return A_STUDY
    if name in ("quantities", "links", "mechanism", TOLERANCES):
        return f"write {name} in the study"
    tables = {one: "design" for mechanism in NAMES for one in find_catalogue(mechanism).all_inputs}
    tables |= dict.fromkeys((ALLOW, *SAMPLES), "design") | dict.fromkeys(drivers(), "cycle")
    tables |= {key: table for table in ("cycle", "search", "run") for key in KEYS[table]}
    of, _ = split(name, tables)
    return f"write {name} in the study, under [{tables[of]}]" if of in tables else ""


@door(hint=in_study)
def run(
    path: str | Path,
    to: str | Path | None = None,
    threads: int | None = None,
    overwrite: bool = False,
    progress: bool | None = None,
    verify: int | None = None,
    *,
    restart: bool = False,
    part: tuple[int, int] | str | None = None,
    layout: str | None = None,
    client: Client | None = None,
    trust_code: bool = False,
) -> xr.Dataset:
    """Run a study file and write its map; with a table [search] or [synthesis] that of the designs that are found.

    Parameters
    ----------
    path : str or path
        The study, a TOML file.
    to : path, optional
        The HDF5 file to write; by default that of the study, else the study's name with ``.h5``, in the
        current folder.
    threads : int, optional
        All processors unless given.
    overwrite : bool, default False
        Compute anew and replace an existing file, whatever it holds. A study that says ``overwrite = true`` has a map
        replaced, and no other file. Without either, an existing map of the same study, unchanged since, is opened as it
        is; nothing is computed.
    progress : bool, optional
        Show a progress bar on standard error; by default only on a terminal.
    verify : int, optional
        How many designs are computed again with 50 digits (see `fastlink.sweep`); by default what the study says, else
        64.
    restart : bool, default False
        Throw away what an interrupted run has left in ``FILE.part``. Without it, the same study goes on there, and
        another one is refused.
    part : (k, n) or "k/n", optional
        Run the k-th of n parts of the designs (see `fastlink.sweep`, `fastlink.search`), by default into the file of
        the study with the part in its name, such as ``maps.part-03-of-16.h5``.
    layout : {"curves", "maps"}, optional
        How the map is to be read (see `fastlink.sweep`); by default what the study says, else ``"curves"``.
    client : distributed.Client, optional
        Evaluate the designs on the workers of a dask.distributed cluster (see `fastlink.sweep`).
    trust_code : bool, default False
        Run the Python file that the study names as ``quantities_file``, which declares quantities of its own (see
        docs/own_quantities.md). A study alone is data and runs nothing.

    Returns
    -------
    xarray.Dataset
        Opened lazily from the file. The text of the study is in its attribute ``study``.

    Examples
    --------
    >>> import tempfile, pathlib
    >>> text = '''
    ... mechanism = "planar_4r"
    ... quantities = ["transmission_angle_min"]
    ... [design]
    ... a1 = 0.4
    ... a2 = {linspace = [1.0, 1.4, 5]}
    ... a3 = 0.8
    ... a4 = 1.0
    ... '''
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     study = pathlib.Path(folder, "study.toml")
    ...     _ = study.write_text(text)
    ...     with run(study, to=f"{folder}/maps.h5") as maps:
    ...         dict(maps.transmission_angle_min.sizes)
    {'a2': 5}
    """
    call = dict(locals())
    checked = check_options(call | {"layout": CURVES if layout is None else layout})
    if (asked := _synthesis_of(path)) is not None:
        return _run_synthesis(asked, to, overwrite)
    study = read_study(path, trust_code)
    target = study.target(to, checked["part"])
    title = {name: study.tables[name] for name in ("title",) if name in study.tables}
    try:
        # the sweep knows whether the file that exists is its map
        check_target(target, 0, True, study.sources)
        if not overwrite and study.output.get("overwrite", False):
            _refuse_other_file(target)
            overwrite = True
        attrs = {**title, "study_file": writable(study.path.name), "study": study.text}
        verify = study.output.get("verify") if verify is None else verify
        given = {name: call[name] for name in ("restart", "part", "threads", "client", "progress")}
        given |= {"verify": verify, "to": target, "overwrite": overwrite, "attrs": attrs}
        if study.search is None:
            given["layout"] = layout or study.output.get("layout") or CURVES
            return sweep(study.mechanism, study.space, study.quantities, **study.options, **given)
        if layout is not None:
            remedy = "leave it out: a search keeps the best of all designs alone"
            raise InputError("is for maps, not for a search", ("layout",), remedy)
        return search(
            study.mechanism, study.space, study.quantities, **study.search, **study.options, **given
        )
    except InputError as error:
        if call.get(str(error.where[0]) if error.where else "") is not None:
            raise  # the caller's own, not the study's
        raise InputError.of(error.problems, StudyWording(study.path, study.tables, study.space)) from None


def _synthesis_of(path: Any) -> tuple[Path, str, dict[str, Any]] | None:
    """Return a study with a table [synthesis], its text and its tables; None of another, or of no study."""
    path = check_path(("study",), path, "study.toml")
    text = text_of(path)
    contents = contents_of(path, text) if SYNTHESIS in text else {}
    return (path, text, dict(contents)) if SYNTHESIS in contents else None


def _run_synthesis(asked: tuple[Path, str, dict[str, Any]], to: Any, overwrite: bool) -> xr.Dataset:
    """Find the linkages for the task of a study, and write them."""
    from fastlink.synthesis.found import synthesise

    path, text, contents = asked
    table, problems = contents.pop(SYNTHESIS), Problems(StudyWording(path))
    mechanism, names = contents.pop("mechanism", None), contents.pop("quantities", [])
    output, title = contents.pop("output", {}), contents.pop("title", None)
    if mechanism is None:
        problems.add("is missing", ("mechanism",), 'write mechanism = "planar_4r" or "slider_crank"')
    if not isinstance(table, dict) or not isinstance(output, dict):
        problems.add("is not a table", (SYNTHESIS,), "write keys below [synthesis] and [output]")
    for name in contents:
        problems.add("is of another study", (name,), "leave it out beside [synthesis]")
    problems.stop()
    known = [
        n for n in signature(synthesise).parameters if n not in ("mechanism", "quantities", "to", "attrs")
    ]
    for name in table:
        if name not in (*known, "file"):
            problems.add("is no key of it", (SYNTHESIS, name), suggest(name, known))
    given = dict(table)
    if (file := given.pop("file", None)) is not None:
        tasks = [name for name in ("motion", "function") if given.get(name) is True]
        given[tasks[0] if tasks else "path"] = path.parent / str(file)
    problems.stop()
    target = Path(os.path.expanduser(to or output.get("file") or f"{path.stem}.h5"))
    attrs = {**({} if title is None else {"title": title}), "study_file": writable(path.name), "study": text}
    try:
        again = overwrite or bool(output.get("overwrite", False))
        return synthesise(mechanism, names, to=target, overwrite=again, attrs=attrs, **given)
    except InputError as error:
        raise InputError.of(error.problems, StudyWording(path)) from None


def _refuse_other_file(target: Path) -> None:
    """Refuse a file that is no map: a study, which may be a stranger's, does not replace it by its own word."""
    if existing_file(target) is not None:
        try:
            open_map(target).close()
        except InputError:
            raise exists_error(target, "and is no map, which alone a study replaces") from None


def read_study(path: str | Path, trust_code: bool = False) -> Study:
    """Read a study file and check everything that can be checked before running it.

    The Python file that it may name is run only if that code is trusted.
    """
    path = check_path(("study",), path, "study.toml")
    trusted = check_options({TRUST: trust_code})[TRUST]
    text = text_of(path)
    contents, problems = contents_of(path, text), Problems(StudyWording(path))
    if SYNTHESIS in contents:
        raise _refused(
            path, "asks for linkages for a task, which is no sweep", f"`fastlink run {path}` finds them"
        )
    mechanism = _mechanism(path, contents, problems, trusted)
    driven = _driven(mechanism, contents, problems)
    raw, misplaced = in_own_tables(contents, driven)
    name = "" if driven is None else driven.position.name
    if driven is not None and "units" in raw:
        with problems.at():
            raw = in_own_units(raw, driven)
        problems.stop()  # what other numbers mean is not known
    tables, found = read_tables(raw, [key for key in raw.get("cycle", {}) if split(key, (name,))[0] == name])
    problems.noted += [*misplaced, *found]
    problems.wording = StudyWording(path, raw)
    if driven is None or "mechanism" not in tables:
        problems.stop()
    assert driven is not None
    request = StudyRequest(path, raw, tables, driven, problems, mechanism)
    request.check()
    problems.stop()
    assert request.space is not None
    for name, values in request.positions.items():
        unit = split(name, (driven.position.name,))[1]
        request.options["angles"] = InUnit(values, unit) if unit else values
    return Study(path, text, tables, request.space, request.options, mechanism)


def mechanism_of_study(path: str | Path) -> Any:
    """Return the mechanism of a study file; Python files that it names are not run."""
    path = check_path(("study",), path, "study.toml")
    contents, problems = contents_of(path, text_of(path)), Problems(StudyWording(path))
    found = _mechanism(path, contents, problems, False)
    problems.stop()
    return found


def _mechanism(path: Path, contents: dict[str, Any], problems: Problems, trusted: bool) -> Any:
    """Return the mechanism of a study: its name, or with the quantities that a file declares."""
    mechanism, own = contents.get("mechanism"), contents.get(KEY)
    if LINKAGE in contents:
        declared = contents.pop(LINKAGE)
        with problems.at():
            if mechanism is not None:
                raise InputError(
                    "is given twice, here and by [linkage]", ("mechanism",), "leave one of both out"
                )
            contents["mechanism"] = "linkage"
            if not isinstance(declared, dict):
                what = f"is {short_repr(declared)}, which is no table"
                raise InputError(what, (LINKAGE,), "write [linkage] with ground, crank and dyads")
            return linkage(**declared)
        problems.stop()
    if isinstance(mechanism, str) and mechanism.endswith(SHEET):
        with problems.at():
            return read_mechanism(path.parent / mechanism)
        return None
    if not isinstance(own, str) or not own or mechanism not in NAMES:
        return mechanism
    with problems.at():
        return load_extension(path, own, mechanism, trusted)
    problems.stop()  # what depends on its quantities is not worth telling
    return mechanism


def _driven(mechanism: Any, contents: Mapping[str, Any], problems: Problems) -> Catalogue | None:
    """Return the catalogue of a study; a misspelt mechanism is noted and taken for the nearest."""
    cycle = contents.get("cycle")
    input = cycle.get("input") if isinstance(cycle, dict) else None
    if not isinstance(mechanism, str) and not is_extension(mechanism):
        return None
    with problems.at():
        return find_catalogue(mechanism, input if isinstance(input, str) else None)
    name = name_of(mechanism)
    meant = mechanism if name in NAMES else nearest(name, NAMES)
    return None if meant is None else find_catalogue(meant, None)
