"""Checks of a request: inputs, branches, links, solver, input positions, the search for extrema."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import lru_cache
from numbers import Real
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink._text import counted, joined, short_repr
from fastlink.errors import (
    OTHER_NAMES,
    InputError,
    KeyPath,
    Model,
    Problem,
    Problems,
    Remedy,
    Samples,
    Setting,
    check_choice,
    listed,
    nearest,
    remark,
    suggest,
)
from fastlink.facts.arc import ARC_ENDS
from fastlink.facts.catalogue import ELIMINATED, Catalogue
from fastlink.facts.derivative import is_tolerance
from fastlink.facts.fact import Input
from fastlink.facts.find import did_you_mean
from fastlink.facts.powers import beyond_range, limits
from fastlink.mechanisms import NAMES, inputs_of
from fastlink.mechanisms import catalogue as find_catalogue
from fastlink.plan.query import Extrema, Request, parse_request, suggest_input
from fastlink.space import design_space as spaces
from fastlink.space import units
from fastlink.space.design_space import DesignSpace, Floats, steps

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from fastlink.engine.extend import Extension


# -- Checks of a request: inputs and their values, branches, links and solver


RULES = {"positive": "greater than 0", "non-negative": "at least 0"}


def check_model(catalogue: Catalogue, links: spaces.Links | None, solver: str) -> None:
    """Refuse a solver and a model of the links that the mechanism does not have."""
    problems = Problems()
    with problems.at():
        if catalogue.solvers == (ELIMINATED,) and not (isinstance(solver, str) and solver == ELIMINATED):
            what = f"{short_repr(solver)} is not a solver of {catalogue.name}, which has no linear system"
            raise InputError(what, where=("solver",), remedy="leave solver out")
        check_choice(("solver",), solver, catalogue.solvers)
    if links is not None and not isinstance(links, spaces.Links):
        remedy = "write fastlink.round_bar(density=..., radius=...), or leave links out"
        problems.add(f"is {short_repr(links)}, not a model of the links", ("links",), remedy)
    elif links is not None and links.model not in catalogue.variant_inputs:
        problems.add(f"nothing of {catalogue.name} depends on mass", ("links",), "leave them out")
    elif links is not None:
        inputs = catalogue.variant_inputs[links.model]
        for name, value in links.values.items():
            problems.noted += value_problems(inputs[name], np.asarray(value), "links", check=in_range)
    problems.stop()


def selected_variants(
    catalogue: Catalogue, links: spaces.Links | None, solver: str, given: Iterable[str] = ()
) -> tuple[str, ...]:
    """Return the selected variants, each before those that it replaces facts of; what is refused selects none."""
    solved = (solver,) if isinstance(solver, str) and solver != ELIMINATED else ()
    model = (links.model,) if isinstance(links, spaces.Links) else ()
    return (*solved, *catalogue.variants_selected_by(given), *model)


def constants_of(
    catalogue: Catalogue, links: spaces.Links | None, variants: Iterable[str]
) -> dict[str, float]:
    """Return the inputs that a design need not give: those of the links, and the defaults of the variants."""
    inputs = catalogue.known_inputs(variants).values()
    defaults = {known.name: known.default for known in inputs if known.default is not None}
    return defaults if links is None else defaults | dict(links.values)


def all_choices(
    catalogue: Catalogue, given: Iterable[str], variants: Iterable[str]
) -> dict[str, tuple[int, ...]]:
    """Return the codes of each input that has choices and is not given."""
    inputs = catalogue.known_inputs(variants)
    return {name: tuple(i.choices) for name, i in inputs.items() if i.choices and name not in given}


def check_inputs(
    catalogue: Catalogue, space: DesignSpace, variants: Sequence[str], allow_invalid: bool
) -> None:
    """Refuse an unknown input, and values that an input cannot have."""
    known = catalogue.known_inputs(variants)
    problems = Problems()
    of_sample = ("n", "seed") if space.kind in ("sobol", "latin_hypercube") else ()
    allow: Remedy = (ALLOW,) if space.attrs.get("design_kind") == "table" else ""
    problems.noted += name_problems(catalogue, space.names, known, options=of_sample)
    for name in filter(known.__contains__, space.names):
        value = space.constants.get(name)
        if not allow_invalid and (value is None or not in_range(known[name], value)):
            column = space.columns.get(name)
            if isinstance(column, spaces.Column):
                problems.noted += _column_problems(known[name], column, allow)
            else:  # designs of a space beyond the range are flagged, as those that never assemble are
                values, check = space.values(name), Input.allows if value is None else in_range
                if name in space.doubtful:  # whose cells without numbers are named already
                    values = np.where(np.isfinite(values), values, 1.0)
                problems.noted += value_problems(known[name], values, "design", allow, check)
    problems.stop()


def name_problems(
    catalogue: Catalogue,
    names: Sequence[str],
    known: Iterable[str],
    parent: str = "design",
    options: Sequence[str] = (),
) -> list[Problem]:
    """Return the problems of names that are given for inputs: unknown ones, and pairs that determine each other.

    `parent` heads their paths; `options` are what else may be given there by name, for a hint.
    """
    problems = Problems()
    for name, other in _exclusive(catalogue, catalogue.version, tuple(names))[:1]:
        problems.add(f"{other} and {name} determine each other", (parent,), "leave one of them out")
    unknown = [unknown_input(catalogue, name, known, parent, options) for name in names if name not in known]
    return problems.noted + unknown


@lru_cache(maxsize=256)
def _exclusive(catalogue: Catalogue, version: int, names: tuple[str, ...]) -> list[tuple[str, str]]:
    """Return the pairs of given inputs that determine each other."""
    pairs = ((name, other) for name in names for other in catalogue.mutually_exclusive_inputs(name))
    return [(name, other) for name, other in pairs if other in names]


def in_range(declared: Input, value: Any) -> Any:
    """Tell whether an input may have a value, and all steps with it stay within the range of doubles."""
    return declared.allows(value) & ~np.bool_(beyond_range(declared, value))


def flag_beyond_range(catalogue: Catalogue, names: Sequence[str]) -> tuple[int, int] | None:
    """Return the place of the status among results, and its code for designs with a number beyond the range."""
    if "status" not in names:
        return None
    flags = catalogue.facts["status"].flags
    return names.index("status"), next(code for code, of in flags.items() if of == "beyond_range")


def unknown_input(
    catalogue: Catalogue,
    name: str,
    known: Iterable[str],
    parent: str = "design",
    options: Sequence[str] = (),
) -> Problem:
    """Return the problem of a name that is not among the known inputs."""
    where, what = (parent, name), f"is unknown to {catalogue.name}"
    for model, inputs in catalogue.variant_inputs.items():
        if name in inputs:
            mend = ("write ", Model(model, tuple(inputs)), ", or leave it out")
            return Problem(f"belongs to links of model {model!r}", where, mend)
    if "tol" in name and parent != "tolerance" and (near := nearest(name, catalogue.tolerances)):
        return Problem(what, where, did_you_mean([near]))
    driving, unit = units.split(name, given := {*drivers(), POSITIONS, "angle", "position"})
    if driving in given:
        what += f", whose input is {catalogue.position.name}"
        return Problem(what, where, f"write {units.with_unit(catalogue.position.name, unit)}")
    every = dict.fromkeys((*known, *(key for inputs in catalogue.variant_inputs.values() for key in inputs)))
    names = [key for key in every if not is_tolerance(key)]  # each input has two, by a rule
    others = [one for one in NAMES if one != getattr(catalogue, "first", catalogue).name]
    if elsewhere := [other for other in others if name in find_catalogue(other).all_inputs]:
        return Problem(f"{what}, known to {joined(elsewhere)}", where, listed(names))
    meant = suggest_input(name, catalogue)
    remedy: Remedy = did_you_mean(meant) if meant else listed(names)
    if catalogue.is_quantity(name):
        return Problem("is a quantity, not an input", where, remedy if meant else "leave it out")
    if not meant and nearest(name, options) and not nearest(name, names):
        remedy = suggest(name, options)
    of = next((key for key in names if key in catalogue.variables and name.startswith(f"{key}_")), "")
    if of and (usual := units.usual_name(of, catalogue.variables[of].units)) != of:
        remedy = f"write {of}, or in another unit such as {usual}"
    return Problem(what, where, remedy)


#: How rows of a table that are no designs are kept, at doors that can; wrong values of an input that a message names.
ALLOW = (", or pass ", Setting("allow_invalid", True), " to keep such designs")
MOST_SHOWN = 6


def value_problems(
    declared: Input,
    values: NDArray[np.float64],
    parent: str,
    remedy: Remedy = "",
    check: Callable[[Input, Any], Any] = Input.allows,
    first: int = 0,
) -> list[Problem]:
    """Return the values that an input cannot have as one problem, if there are any; a further remedy may be given.

    The first one of the values has the number `first`.
    """
    bad = np.flatnonzero(~check(declared, values))
    if not bad.size:
        return []
    index: Sequence[Any] = np.unravel_index(bad[0], values.shape) if values.size > 1 else ()
    value = values.flat[bad[0]]
    rule = RULES.get(declared.rule, "")
    mend = f"write a finite number{' ' if rule else ''}{rule}"
    if declared.choices and np.isfinite(value):
        mend = "write one of " + ", ".join(
            f"{code} ({meaning})" for code, meaning in declared.choices.items()
        )
    if declared.allows(value):
        least, most = limits(declared.units, declared.rule)
        zero = "" if declared.rule == "positive" else "0 or "
        sizes = f"of {least:.1e} to {most:.1e}" if least else f"below {most:.1e}"
        mend = f"write {zero if least else ''}a magnitude {sizes} {declared.units}"
    where: KeyPath = (parent, declared.name, *(int(k) for k in index))
    others = ", ".join(f"{values.flat[k]} at {first + k}" for k in bad[1:MOST_SHOWN].tolist())
    more = f" and {bad.size - MOST_SHOWN:,} more" if bad.size > MOST_SHOWN else ""
    also = f", {others}{more}" if others else ""
    return [Problem(f"is {value}{also} ({declared.meaning})", where, (mend, *remedy) if remedy else mend)]


def _column_problems(declared: Input, column: spaces.Column, allow: Remedy) -> list[Problem]:
    """Return the values of a column that an input cannot have as one problem, if its bounds do not rule them out."""
    if not declared.choices and all(declared.allows(end) for end in column.bounds):
        return []
    for start, stop in steps(0, len(column)):
        values = column.piece(start, stop)
        if not declared.allows(values).all():
            (problem,) = value_problems(declared, values, "design", allow, first=start)
            row = start + int(np.argmin(declared.allows(values)))
            return [replace(problem, where=(*problem.where[:2], row))]
    return []


def missing_inputs(
    catalogue: Catalogue, name: str, variants: Sequence[str], given: Iterable[str], parent: str = "design"
) -> list[Problem]:
    """Return a problem for each input that a quantity depends on and nothing gives."""
    of_links = {name for model in spaces.MODELS for name in catalogue.variant_inputs.get(model, {})}
    known, has = catalogue.known_inputs(variants), set(given)
    asked = [name for name in known if name not in has and not is_tolerance(name)]
    absent = {name for name in asked if catalogue.resolve(name, variants) is None}
    tables = (catalogue.position.name, *catalogue.tables, *catalogue.table_low_parts)
    request = parse_request(name, catalogue)
    steps = catalogue.dependencies([request.quantity], {*has, *absent, *tables, "branch"}, variants)
    needed = absent & {need for step in steps for need in step.depends_on}
    parents = {key: "links" if key in of_links else parent for key in known if key in needed}
    return [catalogue.missing_problem(known[key], request.name, where) for key, where in parents.items()]


def joined_missing(problems: Iterable[Problem]) -> list[Problem]:
    """Return missing inputs with one problem for all mass data that a model of the links would give at once."""
    groups: dict[tuple[KeyPath, Remedy], list[Problem]] = {}
    for one in problems:
        models = one.remedy[1:] if isinstance(one.remedy, tuple) else ()
        groups.setdefault((one.where[:-1], models) if models else (one.where, ""), []).append(one)
    return [group[0] if len(group) == 1 else _joined(group) for group in groups.values()]


def _joined(group: Sequence[Problem]) -> Problem:
    names = joined([str(one.where[-1]) for one in group])
    dependents = list(dict.fromkeys(str(one.remedy[0]).partition(" ")[0] for one in group))
    needed = f"{joined(dependents)} depend{'' if dependents[1:] else 's'} on them: add them"
    return Problem(f"{names} are missing", group[0].where[:-1], (needed, *group[0].remedy[1:]))


#: What both branches are called, and the two ways of a four-bar.
BOTH, OPEN_OR_CROSSED = ("all", "any", "both", "each", "every", "*", ":"), ("open", "crossed")


def _branches_meant(catalogue: Catalogue, branch: Any) -> Remedy:
    """Return what to write for a branch: of a word, what it may mean."""
    codes = ", ".join(map(str, catalogue.branches))
    if not isinstance(branch, str):
        return f"write some of {codes}"
    if branch in BOTH:
        return ("write ", Setting("branch", tuple(catalogue.branches)))
    if branch in OPEN_OR_CROSSED and catalogue.position.name == "theta1":
        return "write 2, which is open where theta1 is in (0, pi) and crossed elsewhere, or 1, the other way round"
    each = " or ".join(f"{code} ({meaning})" for code, meaning in catalogue.branches.items())
    return f"write {each}, or {codes} for both"


def branch_codes(catalogue: Catalogue, branch: Any, *, gaps: bool = False) -> NDArray[np.float64]:
    """Return branches as numbers of the same shape, among which NaN may stand if there may be gaps."""
    if isinstance(branch, np.ma.MaskedArray):
        branch = spaces.unmasked(branch)
    remedy = _branches_meant(catalogue, branch)
    spaces.check_length(("branch",), branch, remedy)
    values = spaces.cells_of(branch)
    if values.dtype.kind in "iuf":
        known = np.isin(values, tuple(catalogue.branches))
        bad = values[~(known | np.isnan(values) if gaps else known)].ravel()[:1].tolist()
    else:
        cells = values.ravel().tolist()
        bad = [cell for cell in cells if not _is_branch(catalogue, cell, gaps)][:1]
    for value in bad:
        what = f"{short_repr(value)} is not a branch of {catalogue.name}"
        raise InputError(what, ("branch",), remedy)
    return values.astype(np.float64)


def _is_branch(catalogue: Catalogue, value: object, gaps: bool) -> bool:
    is_gap = gaps and isinstance(value, float) and math.isnan(value)
    return is_gap or (spaces.is_number(value) and isinstance(value, Real) and value in catalogue.branches)


def check_branches(catalogue: Catalogue, branch: Any) -> tuple[int, ...]:
    """Return the branches as a tuple."""
    where, codes = ("branch",), branch_codes(catalogue, branch)
    if codes.ndim > 1:
        raise InputError(f"has {codes.ndim} dimensions", where, "write one number or a flat list of numbers")
    if not codes.size:
        raise InputError("none is given", where, f"write some of {', '.join(map(str, catalogue.branches))}")
    given = tuple(int(code) for code in codes.ravel()[: len(catalogue.branches) + 1])
    for k, value in enumerate(given):
        if value in given[:k]:
            raise InputError(f"{value} is given twice", where, "write each once")
    return given


# -- Checks of a request: input positions, by whatever name they are given, and the search for extrema


EXTREMA: tuple[Extrema, ...] = ("refined", "sampled")
ANGLES = 360
#: Another name of the option for input positions, or their number, whatever drives.
POSITIONS = "positions"
#: What users call an option that takes degrees.
IN_DEGREES = ("deg", "degree", "degrees", "in_degrees")


@lru_cache(maxsize=1)
def drivers() -> frozenset[str]:
    """Return the inputs that drive some mechanism."""
    return frozenset(name for mechanism in NAMES for name in inputs_of(mechanism))


def check_keywords(
    mechanism: str | Extension, catalogue: Catalogue, names: Iterable[str], options: Iterable[str]
) -> None:
    """Refuse a keyword that is neither an option nor the name of the input that drives the mechanism.

    `names` are the keywords that are not options, `options` those that are, for a hint.
    """
    position, problems = catalogue.position.name, Problems()
    for name in names:
        of, unit = units.split(name, (position, "angles"))
        if of in (position, POSITIONS):  # whose unit is looked at with its values
            continue
        in_degrees = units.usual_name(position, units.RADIANS)
        if unit:
            problems.add("is not an option", (name,), f"write {units.with_unit(position, unit)}")
        elif name in ("over", "arc"):
            problems.add("is not an option", (name,), f"give {joined(ARC_ENDS)} with the design")
        elif units.split(name, inputs := catalogue.all_inputs)[0] in inputs:
            problems.add("is an input, not an option", (name,), "give it with the design")
        elif name in IN_DEGREES and catalogue.position.units == units.RADIANS:
            problems.add("is not an option", (name,), f"write angles in degrees as {in_degrees}")
        elif (driving := units.split(name, drivers()))[0] in drivers():
            named = units.with_unit(position, driving[1])
            own = driving[0] in inputs_of(mechanism)
            other = (f", or, to drive {driving[0]}, write ", Setting("input", driving[0])) if own else ()
            problems.add(f"the input is {position}", (name,), (f"write its positions as {named}", other))
        elif name in ("unit", "units"):
            remedy = f"write units in names, such as {in_degrees}; results are in SI, which `convert` changes"
            problems.add("is not an option", (name,), remedy)
        elif name in OTHER_NAMES["n"]:
            problems.add("is not an option", (name,), "the designs have a number: fl.sobol(n, a2=(1.0, 1.4))")
        else:
            problems.add("is not an option", (name,), suggest(name, {*options, position, POSITIONS}))
    problems.stop()


def _are_several(values: Any) -> bool:
    """Tell whether input positions are an array, or at least no scalar."""
    if isinstance(values, (list, tuple, range)):  # one of 10^8 takes 10 s to convert
        return True
    try:
        return np.ndim(values) > 0
    except Exception:  # ragged lists, and whatever a class of somebody's does; `check_positions` refuses them
        return True


def given_angles(catalogue: Catalogue, angles: Any, positions: Mapping[str, Any]) -> tuple[str, Any]:
    """Return the input positions that were given, and by which name; else the usual ones.

    Those in another unit are converted. A warning tells of numbers that can hardly be radians.
    """
    name, own, problems = catalogue.position.name, catalogue.position.units, Problems()
    named = {key: one for key, one in positions.items() if units.split(key, (name,))[0] in (POSITIONS, name)}
    given = {key: values for key, values in {"angles": angles, **named}.items() if values is not None}
    if len(given) > 1:
        first, second, *_ = given
        are = "angles are" if first == "angles" else f"{first} is"
        raise InputError(f"{are} given too", (second,), "write one of them")
    for key, values in given.items():
        if isinstance(values, units.InUnit):
            key, values = units.with_unit(name, values.unit), values.values
        unit = units.split(key, (name,))[1]
        spaces.check_length((key,), values)
        try:
            if not isinstance(values, (list, tuple, range)):
                np.ndim(values)
        except Exception:  # whatever a class of somebody's does when it is converted
            raise InputError(f"is {short_repr(values)}", (key,), "write a flat array of numbers") from None
        stated = spaces.units_of(key, values).get(key, "")
        with problems.at(key):
            factor, unit = units.conversion(name, unit, stated, own)
            if unit:
                return key, _converted(catalogue, key, values, unit, factor)
        problems.stop()
        if own == units.RADIANS and _are_several(values):
            units.remark_on_angles(name, values)
        return key, values
    return name, ANGLES if catalogue.positions is None else np.linspace(*catalogue.positions)


def _converted(catalogue: Catalogue, key: str, values: Any, unit: str, factor: Fraction) -> NDArray[Any]:
    """Return input positions that are given in another unit in that of SI, or refuse what is no array."""
    name = catalogue.position.name
    if spaces.listed(values) == 0 or not _are_several(values):
        other = f"; {name} may be a number of angles" if catalogue.positions is None else ""
        remedy = f"write a flat array of {units.in_words(unit)}{other}"
        raise InputError(f"is {short_repr(values)}", (key,), remedy)
    return np.asarray(units.scaled(check_positions(catalogue, values, key), factor))


def keywords_in_si(
    catalogue: Catalogue, door: str, given: Mapping[str, Any], problems: Problems, *, position: bool
) -> dict[str, Any]:
    """Return inputs that are given by keywords, each by its own name and in SI."""
    declared = catalogue.all_inputs
    if position:
        declared[catalogue.position.name] = catalogue.position
    result: dict[str, Any] = {}
    others = {name: name for name in given}
    for name, value in given.items():
        of, unit = units.split(name, declared)
        if not unit:
            result[name] = value
            continue
        try:
            stated = spaces.units_of("", value).get("", "")
            factor, _ = units.conversion(of, unit, stated, declared[of].units, others)
            numbers = spaces.numbers_of(door, name, value, spaces.MOST_DIMS)
            plain = units.scaled(numbers, factor)
            result[of] = _relabelled(value, plain) if hasattr(value, "dims") else plain
        except InputError as error:
            problems.noted += [replace(one, where=(door, name, *one.where[2:])) for one in error.problems]
            result.setdefault(of, 0.5)  # so that it is not reported as missing too
    return result


def _relabelled(value: Any, numbers: Any) -> Any:
    """Return other numbers with the dimensions and coordinates of labelled ones."""
    result = value.copy(data=numbers)
    result.attrs = {}  # with the unit
    return result


def check_extrema(
    extrema: str | None, catalogue: Catalogue, angles: Any, names: Iterable[str] = ()
) -> Extrema:
    """Return the search for extrema: refined over a whole turn, unless the angles themselves are given."""
    chosen = _are_several(angles)
    turns = extrema is None and chosen and catalogue.positions is None
    if turns and any(parse_request(name, catalogue).can_be_refined for name in names):
        what = (
            f"extremes are those of the {counted(spaces.listed(angles), 'position')} given, not of the turn"
        )
        remark(what, remedy=("write ", Setting("extrema", "sampled"), ", or a number of positions"))
    if extrema is None:
        return "sampled" if chosen else "refined"
    extrema = check_choice(("extrema",), extrema, EXTREMA)
    if chosen and extrema == "refined":
        name = catalogue.position.name
        what = f"'refined' is over the whole turn of {name}, but {name} is an array"
        other = ", or a number of angles" if catalogue.positions is None else ""
        raise InputError(what, ("extrema",), ("write ", Setting("extrema", "sampled"), other))
    return "refined" if extrema == "refined" else "sampled"


def check_turn(catalogue: Catalogue, names: Iterable[str], angles: Any) -> None:
    """Refuse an array of angles for a reduction that needs equal steps over a whole turn."""
    if _are_several(angles):
        remedy = "write a number of angles" if catalogue.positions is None else "leave it out"
        requests = [parse_request(name, catalogue) for name in names]
        _refuse_whole(requests, f"but {catalogue.position.name} is an array", remedy)


def _refuse_whole(requests: Iterable[Request], but: str, remedy: str) -> None:
    """Refuse reductions over a whole turn, with what there is instead."""
    problems = Problems()
    for k, request in enumerate(requests):
        if request.reduction is not None and request.reduction.whole and not request.other:
            problems.add(f"{request.name!r} is over a whole turn, {but}", ("quantities", k), remedy)
    problems.stop()


def check_arcs(space: DesignSpace, allow_invalid: bool) -> None:
    """Refuse arcs with one end alone, and those that end before they start or are longer than a turn.

    Of arcs that differ from design to design, invalid ones may be allowed.
    """
    for name, other in (ARC_ENDS, ARC_ENDS[::-1]):
        if name not in space.names:
            raise InputError(
                f"is missing beside {other}", ("design", name), f"write it, or leave {other} out"
            )
    for first, starts, ends in () if allow_invalid and _arc_varies(space) else _arcs(space):
        lengths = ends - starts
        bad = np.flatnonzero(~((lengths > 0.0) & (lengths <= 2.0 * np.pi * (1.0 + 2.0**-50))))
        if bad.size:
            what = f"is {_in_degrees(ends[bad[0]])}, and arc_start is {_in_degrees(starts[bad[0]])}"
            where = () if first is None else (first + int(bad[0]),)
            remedy = "write an end beyond the start, by a turn at most"
            raise InputError(what, ("design", ARC_ENDS[1], *where), remedy)


def _arc_varies(space: DesignSpace) -> list[str]:
    return [name for name in ARC_ENDS if name not in space.constants]


def _arcs(space: DesignSpace) -> Iterator[tuple[int | None, Floats, Floats]]:
    """Yield the starts and ends of all arcs, with the number of the first one's design where each is one of many."""
    starts, ends = ({**space.constants, **space.axes, **space.columns}[name] for name in ARC_ENDS)
    if not {*ARC_ENDS} & {*space.columns}:
        grid = np.meshgrid(starts, ends)
        yield None, grid[0].ravel(), grid[1].ravel()
        return
    for start, stop in steps(0, space.size):
        found = np.empty((2, stop - start))
        space.fill(ARC_ENDS, start, stop, found)
        yield start, *found


def _in_degrees(angle: float) -> str:
    return f"{angle:.6g} rad ({math.degrees(angle):.6g} degrees)"


def positions_of_arc(
    catalogue: Catalogue, space: DesignSpace, given: Any, key: str, names: Sequence[str]
) -> NDArray[Any]:
    """Return so many input positions of the arc that designs give, its ends among them; else refuse them."""
    position = catalogue.position.name
    if _are_several(given):
        what = f"{position} is an array, and the designs give an arc"
        raise InputError(what, (key,), f"write a number of positions, or leave out {joined(ARC_ENDS)}")
    requests, problems = [parse_request(name, catalogue) for name in names], Problems()
    _refuse_whole(requests, "not an arc", f"leave out {joined(ARC_ENDS)}")
    n = int(given)
    if varying := _arc_varies(space):
        for k, request in enumerate(requests):
            if catalogue.varies(request.quantity) and not (request.can_be_refined or request.listed):
                what = f"{request.name!r} is of positions that all designs share, and {varying[0]} differs"
                problems.add(what, ("quantities", k), "give one arc, or ask for extremes alone")
        problems.stop()
        return np.arange(n) * (2.0 * np.pi / n)
    start, end = (space.constants[name] for name in ARC_ENDS)
    return np.linspace(start, end, n)


def check_positions(catalogue: Catalogue, given: int | ArrayLike, key: str = "angles") -> NDArray[Any]:
    """Return the input positions: a number of equal steps over one turn, or the positions themselves."""
    name, noun = catalogue.position.name, "angles in rad" if catalogue.positions is None else "numbers"
    if unit := units.split(key, (name,))[1]:
        noun = "angles in degrees" if unit == "deg" else f"numbers in {unit}"
    if catalogue.positions is not None and not _are_several(given):
        what = f"{short_repr(given)} is not an array, and {name} has no bounds"
        remedies = ("write them all, such as ", Samples(*catalogue.positions))
        raise InputError(what, (key,), remedies)
    if isinstance(given, (int, np.integer)) and not isinstance(given, (bool, np.timedelta64)):
        if not 1 <= given <= spaces.MOST_LISTED:
            what = f"{short_repr(given)} input angles"
            remedy = f"write a number from 1 to {spaces.MOST_LISTED}, or an array in rad"
            raise InputError(what, where=(key,), remedy=remedy)
        return np.arange(int(given)) * (2.0 * np.pi / int(given))
    turning = "a number of angles, or " if catalogue.positions is None else ""
    remedy = f"write {turning}a flat array of {noun}"
    try:
        values = spaces.numbers_of("", key, given)
    except InputError as error:
        of_unit = units.named_with_unit(key, given, shown=False)
        raise InputError(error.what, error.where[1:], of_unit or remedy) from None
    if values.ndim != 1:
        raise InputError(f"is {short_repr(given)}", (key,), remedy)
    if values.size == 0:
        raise InputError("the array of input positions is empty", (key,), "give at least one")
    if (bad := spaces.first_invalid(values)) is not None:
        raise InputError(f"is {values[bad]}", (key, bad), f"write finite {noun}")
    order = np.argsort(values, kind="stable")
    twice = np.flatnonzero(np.diff(values[order]) == 0.0)
    if twice.size:
        first, second = sorted(order[twice[0] : twice[0] + 2].tolist())
        what = f"{values[first]} stands twice (at {first} and {second})"
        raise InputError(what, (key,), "give each position once")
    return np.array(values)
