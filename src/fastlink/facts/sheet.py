"""Formula sheets: the facts of a mechanism as data, in files that an engineer reads beside the paper.

::

    ## Hayes, Hninn, Irani, eq. (7)

    step H [1] H: Part of the ratios that changes sign with the branch
        = half_sine * per_sigma
    omega4 [rad s-1] omega_4: Angular velocity of the output link
        = mean_rate + branch_sign * (odd_rate * output_share)
    F21_{x,y} [N] F_21{x,y}: Force on the crank at A, {x,y}
        = F32_{x,y} - p2_{x,y}
    d_omega4_d_theta1 = omega1 * output_slope

An entry is a head and indented lines. The head has a name, units, a symbol and a meaning: the title of a picture of
it, of at most 60 characters, and perhaps ``; `` and a remark. ``step`` makes a fact internal; a derivative has the
labels of its quantity. A formula is Python's: assignments to local names, then what is returned after ``=``. What it
depends on are the names that are neither local nor functions. A line that is indented
further goes on with the one before. Braces stand for several entries, part by part. ``##`` is the source of what
follows, ``#`` a remark; ``[inputs]``, ``[tables]``, ``[facts]`` and ``[variant NAME]`` begin a section, and
``let NAME = number`` is a constant of the sheet. Further lines of an entry:

- ``also: names`` by which it is found, with commas between;
- ``0: meaning`` of a code; ``rule: positive`` and ``default: 0.0`` of an input;
- ``low: name`` of the low part, where a formula returns an unevaluated sum of two doubles;
- ``hides: its reduction`` where a quantity has the name of an extreme of another;
- ``| a, b`` a row of a linear system, whose head is ``system NAME: unknowns``, in the section of a variant.

The sheet of a whole mechanism (`mechanism_of`) has three further sections: ``[mechanism]`` with ``NAME: title``,
``[position]`` with the angle that drives, ``[branches]`` with ``1: meaning`` and ``2: meaning``. It may have
``[loops]``: ``loops NAME: unknowns``, rows ``| a`` that vanish, and ``psi by omega: psi_rate, ...`` with the first and
further derivatives of an unknown by time, ``omega`` being the speed of the position.

``also NAME: names`` at the margin is of a name that is declared elsewhere. Expressions are parsed when they are used,
and by `Catalogue.check`, which refuses what is no formula; all else is refused when a sheet is read.
"""

from __future__ import annotations

import ast
import math
import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import count
from keyword import kwlist
from pathlib import Path
from typing import Any, get_args

from fastlink.errors import InputError, suggest
from fastlink.facts.asymptotics import asymptotics
from fastlink.facts.catalogue import Catalogue, plain_and_above
from fastlink.facts.expression import (
    OPERATORS,
    GraphAsWritten,
    beneath,
    divisors,
    generate_formula,
    value_of,
    winding,
)
from fastlink.facts.fact import (
    PIECE_ENDS,
    Fact,
    GradedRange,
    Input,
    Loops,
    Rule,
    System,
    root_of_gap,
    slope_of_gap,
)
from fastlink.facts.formula import NAMESPACE, WORD, Formula, SheetError
from fastlink.facts.names import derivative_name, root_of
from fastlink.facts.own import check_units, declared_step, is_reserved
from fastlink.facts.powers import Powers, UnlikePowers
from fastlink.numerics.elementary import atan2, sqrt
from fastlink.numerics.vectors import magnitude

HEAD = re.compile(
    r"(?P<kind>step |system |loops |also |let )?(?P<name>[A-Za-z_]\w*)"
    r"(?: \[(?P<units>[^\]]*)\] (?P<symbol>.*?): (?P<meaning>.+)|: (?P<unknowns>.+)| = (?P<value>.+))?"
)
SECTION = re.compile(r"\[(mechanism|position|branches|closes|inputs|tables|facts|loops|variant (\w+))\]")
#: The sections of a whole mechanism that `read_sheet` leaves to `mechanism_of`.
OF_MECHANISM = ("mechanism", "position", "branches", "closes")
RULES = get_args(Rule)
#: Words that are no names of values.
RESERVED = frozenset((*kwlist, "abs"))
#: What a line of an entry says that is no formula.
SAYING = re.compile(r"(also|rule|default|low|hides|-?\d+|\w+ by \w+): (.+)")
REMARK = re.compile(r"(^|\s+)#(?!#).*")
#: What a constant is made of.
OF_NUMBERS = ast.Expression, ast.BinOp, ast.UnaryOp, ast.Constant, ast.Name, ast.Load, ast.operator, ast.USub
BRACES = re.compile(r"\{([^{}]*,[^{}]*)\}")


@dataclass
class Entry:
    """One entry of a sheet, as it is written."""

    place: str
    head: str
    section: str
    source: str
    lines: list[str] = field(default_factory=list)

    @property
    def parts(self) -> Mapping[str, str]:
        """The parts of its head, empty where it has none; of a derivative there is no meaning."""
        if found := HEAD.fullmatch(self.head):
            return found.groupdict("")
        what = f"{self.head!r} is no head of an entry"
        raise self.refused(what, "write NAME [units] symbol: meaning, or step NAME [units] symbol: meaning")

    def refused(self, what: str, remedy: str) -> SheetError:
        """Return the error of an entry."""
        return SheetError(self.place, what, remedy)

    def expanded(self) -> Iterator[Entry]:
        """Yield the entries that braces stand for."""
        text = "\n".join([self.head, *self.lines])
        if "{" not in text:
            yield self
            return
        counts = {group.count(",") + 1 for group in BRACES.findall(text)}
        if len(counts) > 1:
            what = "braces of one entry have different numbers of parts"
            raise self.refused(what, "write as many parts in each")
        for k in range(max(counts, default=1)):
            own = text
            for group in reversed([*BRACES.finditer(text)]):
                own = own[: group.start()] + group[1].split(",")[k].strip() + own[group.end() :]
            head, *lines = own.split("\n")
            yield Entry(self.place, head, self.section, self.source, lines)


def entries_of(text: str, file: str) -> Iterator[Entry]:
    """Yield the entries of a sheet."""
    section, source, entry = "facts", "", None
    for number, written in enumerate(text.split("\n"), 1):
        place = f"{file}, line {number}"
        line = (REMARK.sub("", written) if "#" in written else written).rstrip()
        if not line:
            continue
        if "\t" in line or not line.isprintable():
            what = "the line has a tab or a sign that does not print"
            raise SheetError(place, what, "indent by spaces, and leave such signs out")
        if line.startswith(" "):
            if entry is None:
                raise SheetError(place, "an indented line without an entry before", "write its head first")
            if line.startswith("        "):  # goes on with the line before
                *before, last = [entry.head, *entry.lines]
                entry.head, *entry.lines = [*before, f"{last} {line.strip()}"]
            else:
                entry.lines.append(line.strip())
            continue
        if entry is not None:
            yield from entry.expanded()
            entry = None
        if line.startswith("##"):
            source = line.removeprefix("##").strip()
        elif found := SECTION.fullmatch(line):
            section = found[2] or found[1]
        elif line.startswith("["):
            raise SheetError(
                place,
                f"{line} is no section",
                "write [inputs], [tables], [facts], [variant NAME], [mechanism], [position], [branches], [closes] "
                "or [loops]",
            )
        else:
            entry = Entry(place, line, section, source)
    if entry is not None:
        yield from entry.expanded()


def read_sheets(beside: str, names: Sequence[str], *catalogues: Catalogue) -> None:
    """Declare the inputs and facts of the sheets of some names that stand beside a file."""
    for name in names:
        path = Path(beside).with_name(f"{name}.facts")
        read_sheet(path.read_text(encoding="utf-8"), path.name, *catalogues)


def read_sheet(text: str, file: str, *catalogues: Catalogue) -> None:
    """Declare the inputs and facts of a sheet in catalogues; errors name the file."""
    names: dict[str, Any] = dict(NAMESPACE)
    for entry in entries_of(text, file):
        if entry.section in OF_MECHANISM:
            continue
        found = entry.parts
        if found["kind"] == "also ":
            for catalogue in catalogues:
                catalogue.also_called(**{found["name"]: found["unknowns"]})
            continue
        if found["name"] in names or found["name"] in RESERVED:
            what = f"{found['name']} is a function or constant of formulas, or a word of Python"
            raise entry.refused(what, "call it otherwise, such as lambda_")
        if found["kind"] == "let ":
            names[found["name"]] = _number(entry, found["value"], names)
            continue
        matches = {line: SAYING.fullmatch(line) for line in entry.lines if ": " in line}
        said = {match[1]: match[2] for match in matches.values() if match}
        if len(said) < sum(map(bool, matches.values())):
            raise entry.refused(f"{found['name']} says one thing twice", "write it once")
        lines = [line for line in entry.lines if not matches.get(line)]
        lines += [f"= {found['value']}"] if found["value"] else []
        for catalogue in catalogues:
            try:
                _declare(catalogue, entry, said, lines, names)
            except SheetError as error:
                if error.place != catalogue.name:
                    raise
                raise entry.refused(error.what, error.remedy) from None


def _declare(
    catalogue: Catalogue,
    entry: Entry,
    said: Mapping[str, str],
    lines: Sequence[str],
    names: Mapping[str, Any],
) -> None:
    """Declare what an entry says."""
    head = entry.parts
    name, units, symbol, meaning = (head[key] for key in ("name", "units", "symbol", "meaning"))
    variant = None if entry.section in ("inputs", "tables", "facts", "loops") else entry.section
    codes = {int(code): text for code, text in said.items() if code.lstrip("-").isdigit()}
    if "also" in said:
        catalogue.also_called(**{name: said["also"]})
    if not lines and entry.section != "facts":
        catalogue.declare_input(
            _input(entry, Input(name, units, symbol, meaning, choices=codes), said), variant
        )
        return
    formula = _formula(entry, name, lines, names)
    if entry.section == "loops":
        if catalogue.loops is not None:
            raise entry.refused("there are two loops", "write all equations below one head")
        catalogue.loops = _loops(entry, tuple(re.split(r",\s*", head["unknowns"])), said, formula)
        return
    if head["unknowns"]:
        unknowns = tuple(re.split(r",\s*", head["unknowns"]))
        if variant is None:
            raise entry.refused(f"system {name} is in no variant", "write [variant NAME] before it")
        _check_words(entry, *unknowns)
        catalogue.declare_system(System(name, unknowns, formula, formula.parameters), variant)
        return
    if not meaning:
        catalogue.declare_derivative(name, formula, variant)
        return
    if said.keys() & {"rule", "default"}:
        what, remedy = f"{name} has a formula, and a rule or a default", "leave them out: they are of inputs"
        raise entry.refused(what, remedy)
    internal = head["kind"] == "step " or entry.section == "tables"
    fact = Fact(name, formula, formula.parameters, units, symbol, meaning, entry.source, internal, codes)
    if "low" in said:
        _check_words(entry, said["low"])
    if entry.section == "tables":
        catalogue.declare_table(fact, said.get("low"))
        return
    if "hides" in said:
        catalogue.hiding.add(name)
    catalogue.declare(replace(fact, low=said.get("low")), variant)


def _input(entry: Entry, declared: Input, said: Mapping[str, str]) -> Input:
    """Return an input with its rule and its default."""
    rule: Any = said.get("rule", "any")
    if rule not in RULES:
        raise entry.refused(f"{rule!r} is no rule", suggest(rule, RULES))
    default = _number(entry, said["default"], {}) if "default" in said else None
    if default is not None and not replace(declared, rule=rule, choices={}).allows(default):
        raise entry.refused(f"the default {default} of {declared.name} is not {rule}", "write another one")
    return replace(declared, rule=rule, default=default)


def _formula(entry: Entry, name: str, lines: Sequence[str], names: Mapping[str, Any]) -> Formula:
    """Return the formula of an entry, and find what it depends on."""
    parameters: dict[str, None] = {}
    local: set[str] = set()
    rows = [line.removeprefix("| ") for line in lines if line.startswith("| ")]
    written = [line for line in lines if not line.startswith("| ")]
    if rows:
        written.append(f"= ({''.join(f'({row}), ' for row in rows)})")
    texts = []
    for k, line in enumerate(written or [""]):
        targets, _, value = line.partition(" = ") if not line.startswith("= ") else ("", "", line[2:])
        if bool(targets) == (k == len(written) - 1) or not value:
            what = f"has {line!r}" if line else "has no line"
            raise entry.refused(f"the formula of {name} {what}", "end it in one line `= ...`")
        words = (word for word in WORD.findall(value) if word not in local and word not in names)
        parameters |= {word: None for word in words if word not in RESERVED}
        if targets:
            local.update(WORD.findall(targets))
        texts.append(line if targets else f"return {value}")
    return Formula(name, tuple(parameters), texts, names, entry.place)


def _check_words(entry: Entry, *names: str) -> None:
    """Refuse what cannot be a name in Python."""
    for name in names:
        if WORD.fullmatch(name) is None or name in RESERVED:
            raise entry.refused(f"{name!r} is no name", "write letters, digits and _, such as lambda_")


def _number(entry: Entry, text: str, names: Mapping[str, Any]) -> float:
    """Return a number: a literal, a power, a product of constants."""
    known = {name: value for name, value in names.items() if isinstance(value, float)}
    try:
        tree = ast.parse(text, mode="eval")
        if not all(isinstance(node, OF_NUMBERS) for node in ast.walk(tree)):
            raise ValueError
        found = eval(compile(tree, entry.place, "eval"), {"__builtins__": {}}, known)
        if type(found) not in (int, float) or not math.isfinite(found):
            raise ValueError
    except (ArithmeticError, NameError, SyntaxError, TypeError, ValueError):
        raise entry.refused(f"{text!r} is no number", "write such as 2.0**-500") from None
    return float(found)


# -- A whole mechanism


#: What the sheet of a mechanism gets with it, in terms of its input angle.
TURN = Path(__file__).with_name("turn.facts")
CLOSES = Path(__file__).with_name("closes.facts")
#: The codes of how a design assembles.
STATUS = """status [1] status: How the design assembles over a full turn of the input
    0: rotates_fully
    1: assembles_over_part_of_the_turn
    2: never_assembles
    3: invalid_input
    4: beyond_range
"""
#: What it gets unless it has a fact of that name.
UNLESS_DECLARED = (
    """
## the input angle turns
[facts]
step valid [1] valid: 1 where all inputs are as they have to be, else NaN
    = select({valid}, 1.0, NOT_A_NUMBER)
step Z0 [1] Z_0: Least Z of the range: negative, as the input angle is not limited there
    = -valid
step C0 [1] C_0: Least C of the range: negative, as the input angle is not limited there
    = -valid
"""
    + STATUS
    + """    part = select((Z0 > 0.0) | (C0 > 0.0), 1.0, 0.0)
    = select(valid == 1.0, select(range_width > 0.0, part, 2.0), 3.0)
"""
)
#: The status of a sheet with gaps, which kernels find by the pieces of its range; and what each gap gets.
STATUS_OF_GAPS = (
    STATUS
    + """    = select(valid == 1.0, select(closes == 1.0, 0.0, 2.0), 3.0)
POSITION_{low,high} [rad] x_{low,high}: Input angles where ranges {begin,end} through which it moves; NaN without limits
    = select(closes == 1.0, 0.0, NOT_A_NUMBER)
POSITION_{low,high}_by [1] by: What limits the ranges through which it moves where they {begin,end}
    0: nothing
{gaps}
    = select(closes == 1.0, 0.0, 0.0)
"""
)
STATUS_WITHOUT_GAPS = (
    STATUS
    + """    = select(valid == 1.0, 0.0, 3.0)
"""
)
CLOSES_WHERE = """
## where all loops close
step closes [1] closes: 1 where all loops close, else NaN
    = select({conditions}, 1.0, NOT_A_NUMBER)
"""
#: The part of the width of a piece within which a place is its limit.
AT_LIMIT = "7.9e-31"
OF_GAP = """
## docs/own_mechanisms.md#several-loops
step ROOT [1] r: Root of GAP
    = sqrt(GAP)
step SLOPE [1] s: Slope of GAP
    = d_GAP_d_POSITION
d_ROOT_d_POSITION = 0.5 * d_GAP_d_POSITION / ROOT
d_SLOPE_d_POSITION = GAP
[variant graded]
step ROOT [1] r: Root of GAP
    low, high = piece_width * from_low, piece_width * from_high
    next_low = (piece_by_low == NUMBER.0) & (low < piece_near_low)
    next_high = (piece_by_high == NUMBER.0) & (high < piece_near_high)
    at_low = low * (piece_slope_low + piece_bend_low * low)
    at_high = high * (piece_slope_high + piece_bend_high * high)
    = sqrt(select(next_low, at_low, select(next_high, at_high, GAP)))
d_ROOT_d_POSITION = 0.5 * d_GAP_d_POSITION / ROOT
d_SLOPE_d_POSITION = GAP
"""
#: The most ways in which the dyads of a mechanism can be assembled.
MOST_BRANCHES = 64
VALID = {"positive": "({0} > 0.0) & ({0} < INFINITY)", "non-negative": "({0} >= 0.0) & ({0} < INFINITY)"}
#: Functions whose values or slopes may jump: extremes of what calls them are those of samples.
JUMPS = frozenset(("select", "choice", "abs", "absolute", "sign", "largest", "zero_where"))


def mechanism_of(text: str, file: str) -> Catalogue:
    """Return the catalogue of a mechanism that a sheet declares from nothing, driven by an angle that turns.

    Raises
    ------
    SheetError
        The sheet cannot be read, or what it declares is incomplete.
    """
    text = text.removeprefix("\ufeff")
    entries = [*entries_of(text, file)]
    title, position = _only_head(entries, "mechanism", file), _only_head(entries, "position", file)
    if not title["unknowns"]:
        raise SheetError(file, "the mechanism has no title", "write NAME: title below [mechanism]")
    if position["units"] != "rad":
        remedy = "write NAME [rad] symbol: meaning below [position]; only an angle can drive"
        raise SheetError(file, "the position is no angle in rad", remedy)
    numbered = [entry.head.partition(": ") for entry in entries if entry.section == "branches"]
    gaps = None
    if re.search(r"^\[closes\]", text, re.M):
        gaps = tuple(entry.parts["name"] for entry in entries if entry.section == "closes")
    numbers = [number for number, _, _ in numbered]
    many = (
        gaps is not None
        and len(numbers) <= MOST_BRANCHES
        and numbers == [str(k + 1) for k in range(len(numbers))]
    )
    if not (numbers == ["1", "2"] or many) or not all(meaning for *_, meaning in numbered):
        remedy = "write both below [branches]: 1: meaning, and 2: meaning"
        raise SheetError(file, "the branches are not 1 and 2", remedy)
    name, symbol, meaning = (position[key] for key in ("name", "symbol", "meaning"))
    branches = {int(number): meaning for number, _, meaning in numbered}
    found = Catalogue(title["name"], title["unknowns"], branches, Input(name, "rad", symbol, meaning))
    _check_names(entries)
    turn = TURN if gaps is None else CLOSES
    read_sheet(turn.read_text(encoding="utf-8").replace("POSITION", name), "what every sheet gets", found)
    shared = {*found.facts, "Z0", "C0", *map(root_of_gap, gaps or ())}
    read_sheet(text, file, found)
    _check_facts(found)
    given = [*found.inputs.values()] if gaps is None else _given_to(found, gaps)
    if gaps == ():
        given = [one for one in found.inputs.values() if one.rule != "any"]
    conditions = (VALID.get(one.rule, "(abs({0}) < INFINITY)").format(one.name) for one in given)
    default = UNLESS_DECLARED.replace("{valid}", " & ".join(conditions) or "1.0 > 0.0")
    if gaps is not None:
        _declare_gaps(found, gaps, file)
        status = STATUS_OF_GAPS if gaps else STATUS_WITHOUT_GAPS
        default = default[: default.index("step Z0")] + status.replace("POSITION", name)
        default = default.replace("{gaps}", "\n".join(f"    {k}: {gap}" for k, gap in enumerate(gaps, 1)))
    head, *rest = re.split(r"\n(?=\w)", default)
    missing = [entry for entry in rest if entry.removeprefix("step ").split(" ")[0] not in found.facts]
    read_sheet("\n".join([head, *missing]), "what every sheet gets", found)
    found.closes = ("sigma", "p", "q") if gaps is None else ("closes",)
    found.graded = _graded_range(found, gaps)
    found.check()
    for name, problem in wrong_units(found).items():
        place = found.facts[name].formula.place if name in found.facts else file
        raise SheetError(place, f"{name} {problem}", "mend its units, or its formula")
    if found.loops is not None:
        _check_loops(found, found.loops)
    poles = _with_poles(found, shared)
    found.graded = replace(found.graded, poles=poles, divisors=_with_divisors(found, poles))
    return found.copied()  # without what was noted before the last step was declared


def _given_to(known: Catalogue, names: Sequence[str]) -> list[Input]:
    """Return the inputs that facts depend on."""
    found, new = dict.fromkeys(names), list(names)
    while new:
        fact = known.facts.get(new.pop().removesuffix("_root"))
        further = [name for name in (fact.depends_on if fact else ()) if name not in found]
        found |= dict.fromkeys(further)
        new += further
    return [known.inputs[name] for name in known.inputs if name in found]


def _declare_gaps(known: Catalogue, gaps: Sequence[str], file: str) -> None:
    """Declare the roots of gaps, by which facts vanish at limits of motion, and what their zeros are searched by."""
    position, place = known.position.name, "what every sheet gets"
    for k, gap in enumerate(gaps, 1):
        fact = known.facts.get(gap)
        if fact is None or fact.units != "1":
            what = f"{gap} of [closes] is no fact without units"
            raise SheetError(file, what, f"declare it in [facts]: step {gap} [1] symbol: meaning")
        text = OF_GAP.replace("POSITION", position).replace("NUMBER", str(k))
        for word, name in (("GAP", gap), ("ROOT", root_of_gap(gap)), ("SLOPE", slope_of_gap(gap))):
            text = text.replace(word, name)
        read_sheet(text, place, known)
    conditions = " & ".join(f"({gap} >= 0.0)" for gap in gaps) or f"cos_{position} < 2.0"
    read_sheet(CLOSES_WHERE.replace("{conditions}", conditions), place, known)
    read_sheet("\n".join(_moving_limits(known, gaps)), place, known)


def _moving_limits(known: Catalogue, gaps: Sequence[str]) -> Iterator[str]:
    """Yield the derivatives of the position and of roots of gaps by inputs, at limits that move as the inputs do.

    At a limit its gap stays zero, and the position changes by -(d gap/d input)/(d gap/d position).
    """
    position, slopes = known.position.name, [slope_of_gap(gap) for gap in gaps]
    given = {*known.inputs, *known.tables, *known.table_low_parts, position, "branch"}
    changes = [
        {need for step in known.dependencies([gap], given) for need in step.depends_on} for gap in gaps
    ]
    # a search takes the place 2^-120 of the width from a limit for that
    at = [
        f"((piece_by_low == {k}.0) & (from_low < {AT_LIMIT})) | ((piece_by_high == {k}.0) & (from_high < {AT_LIMIT}))"
        for k in range(1, len(gaps) + 1)
    ]
    yield "[variant graded]"
    for name in known.inputs:
        of = [
            derivative_name(gap, name) if name in needs else ""
            for gap, needs in zip(gaps, changes, strict=True)
        ]
        moves = "0.0"
        for here, change, slope in zip(at, of, slopes, strict=True):
            moves = f"select({here}, -{change} / {slope}, {moves})" if change else moves
        if any(of):
            yield f"{derivative_name(position, name)} = {moves}"
            for gap, here, change, slope in zip(gaps, at, of, slopes, strict=True):
                root, whole = root_of_gap(gap), f"{change or '0.0'} + {slope} * ({moves})"
                of_root = derivative_name(root, name)
                yield f"{of_root} = select({here}, 0.0, 0.5 * ({whole}) / {root})"


#: Functions of formulas that tables alone may call, and what facts have in their place.
OF_TABLES = {"sin": "sine", "cos": "cosine"} | dict.fromkeys(
    ("exp", "sinh", "cosh", "binary_exponent", "ldexp"), ""
)


def _check_names(entries: Iterable[Entry]) -> None:
    """Refuse names that no file or kernel could have, and units that are none."""
    for entry in entries:
        if entry.section == "branches" or entry.parts["kind"] == "also ":
            continue
        name, units = entry.parts["name"], entry.parts["units"]
        if entry.section == "facts" and name == "status":
            continue
        if not re.fullmatch("[A-Za-z](_?[A-Za-z0-9])*_?", name) or is_reserved(name):
            what = (
                f"{name} is a word of fastlink's own, or has other letters than a to z, digits and single _"
            )
            raise entry.refused(what, f"call it otherwise, such as my_{name}")
        if entry.parts["meaning"]:
            try:
                check_units(("units",), units)
            except InputError as error:
                raise entry.refused(f"{name} has the units {units!r}", str(error.remedy)) from None


def _check_facts(found: Catalogue) -> None:
    """Refuse facts that call functions of tables, and a status without codes."""
    for name, fact in found.facts.items():
        for called in sorted(fact.formula.uses & OF_TABLES.keys()):
            position = found.position.name
            other = f"{called}_{position} for that of {position}, or {OF_TABLES[called]}(...)"
            remedy = f"write {other}" if OF_TABLES[called] else "write what is made of + - * / and sqrt"
            raise SheetError(fact.formula.place, f"{name} calls {called}, which kernels do not have", remedy)
        if name == "status" and (fact.internal or "beyond_range" not in fact.flags.values()):
            remedy = "write a line CODE: meaning for each code, one of them beyond_range, or leave status out"
            raise SheetError(fact.formula.place, "status has no code beyond_range", remedy)


def _check_loops(known: Catalogue, loops: Loops) -> None:
    """Refuse equations with other names than unknowns, inputs and the position, and names that are no quantities."""
    place, inputs = loops.formula.place, {*known.inputs, known.position.name, "branch"}
    for name in (*loops.unknowns, *loops.rates):
        if name not in known.public:
            raise SheetError(place, f"{name} of the loops is no quantity", suggest(name, known.public))
    for name in (*loops.formula.parameters, *(speed for _, speed, _ in loops.rates.values())):
        if name not in inputs.union(loops.unknowns):
            what = f"{name} of the loops is none of their unknowns, and no input"
            raise SheetError(place, what, suggest(name, [*loops.unknowns, *inputs]))
    others = loops.formula.uses - {"cos", "sin", "cosine", "sine", "PI", "TWO_PI"}
    if others:
        raise SheetError(place, f"the loops call {', '.join(sorted(others))}", "write + - * /, cos and sin")


def wrong_units(known: Catalogue) -> dict[str, str]:
    """Return by name what is wrong with the units of facts: their formulas on numbers that have nothing but units."""
    given = {**known.all_inputs, known.position.name: known.position}
    declared: list[Mapping[str, Fact | System]] = [known.facts, known.tables, *known.variants.values()]
    units = {name: one.units for name, one in given.items()}
    for facts in declared:
        units = {name: one.units for name, one in facts.items() if isinstance(one, Fact)} | units
    units |= dict.fromkeys((*known.tables, *known.table_low_parts, "branch"), "1")
    if known.graded is not None:
        units |= dict.fromkeys(known.graded.given, "1")

    def number(name: str) -> Powers:
        plain = plain_and_above(known.parse(name))[0]
        made = known.resolve(plain) if plain not in units else None
        return Powers.of_units(made.units if isinstance(made, Fact) else units[plain])

    problems = {}
    for facts in declared:
        for name, step in facts.items():
            try:
                _check_units(step, [number(need) for need in step.depends_on], number)
            except UnlikePowers as error:
                problems[name] = str(error)
            except ArithmeticError as error:
                problems[name] = f"cannot be computed ({error})"
    return problems


def _check_units(step: Fact | System, given: Sequence[Powers], number: Callable[[str], Powers]) -> None:
    """Raise UnlikePowers if a formula adds unlike units, or gives others than are declared."""
    if isinstance(step, System):
        for *factors, value in step.formula(*given):
            terms = (x * number(unknown) for x, unknown in zip(factors, step.unknowns, strict=True))
            sum(terms, start=value)
    elif given and not any(any(one.powers) for one in given):  # what is made of pure numbers is one
        Powers.of_units(step.units).like(1.0, "declares")
    else:
        value = step.formula(*given)
        for part in (value,) if step.low is None else value:
            Powers.of_units(step.units).like(part, "declares")


def _only_head(entries: Sequence[Entry], section: str, file: str) -> Mapping[str, str]:
    """Return the parts of the head of a section that has one."""
    heads = [entry for entry in entries if entry.section == section]
    if len(heads) != 1:
        raise SheetError(file, f"[{section}] has {len(heads)} entries", "write it with one entry")
    return heads[0].parts


def _graded_range(known: Catalogue, gaps: tuple[str, ...] | None) -> GradedRange:
    """Return how extremes are searched, and of which quantities they are those of samples."""
    wraps: dict[str, str] = {}
    sampled = []
    open_ends, windings = _with_roots(known, gaps)
    for name, fact in known.public.items():
        value = value_of(fact.formula)
        sine = value.args[0] if value.value is atan2 else value
        sine = sine.args[0] if sine.kind in OPERATORS else sine
        if value.value is atan2 and sine.value in known.facts and name not in open_ends:
            wraps[name] = sine.value
        elif value.value is atan2 or name in open_ends or not fact.formula.uses.isdisjoint(JUMPS):
            sampled.append(name)
    jumping = {name: windings[name] for name in known.public if windings[name] and name not in wraps}
    sampled += [name for name, turns in jumping.items() if not turns.keys() <= wraps.keys()]
    found = GradedRange(
        bounded_factor="share_of_sigma",
        not_differentiable=tuple(dict.fromkeys(sampled)),
        wraps_at=wraps,
        windings={name: turns for name, turns in jumping.items() if name not in sampled},
    )
    if gaps is None:
        return found
    of_pieces: dict[str, Any] = {"ends": tuple(names[5:] for names in PIECE_ENDS), "cells_otherwise": 64}
    of_pieces |= {"antisymmetric": (), "vanish_at_one_end": ()}
    return replace(found, bounded_factor="toward_limits", gaps=gaps, **of_pieces)


def _steps_of(known: Catalogue) -> list[Fact | System]:
    """Return all that quantities are made of, each after what it is made of."""
    given = {*known.inputs, *known.tables, *known.table_low_parts, known.position.name, "branch"}
    return [*known.dependencies(sorted(known.public), given)]


def _with_roots(
    known: Catalogue, gaps: Collection[str] | None
) -> tuple[set[str], dict[str, dict[str, float]]]:
    """Return the facts that may be no number where the loop closes by Z0 and C0, roots; how facts wind with angles."""
    found: set[str] = set()
    windings: dict[str, dict[str, float]] = {known.position.name: {known.position.name: 1.0}}
    closes = {*known.tables, *(("p", "q", "sigma") if gaps is None else gaps)}
    for step in _steps_of(known):
        value = value_of(step.formula)
        nodes = beneath([value])
        turns = winding(nodes, lambda name: windings.get(name, {}))
        windings.update(dict.fromkeys(step.names, {step.name: 1.0} if value.value is atan2 else turns))
        roots = [node for node in nodes if node.value is sqrt]
        names = {node.value for node in beneath(roots) if node.kind == "name"}
        if any(map(known.varies, names - closes)):
            found.update(step.names)
        if not found.isdisjoint(root_of(known.parse(need)) for need in step.depends_on):
            found.update(step.names)
    return found, windings


def _with_poles(known: Catalogue, shared: Collection[str]) -> dict[str, tuple[str, ...]]:
    """Return the facts that a quantity, or what it is made of, is divided by; other values become steps.

    What every sheet shares is divided by nothing that vanishes within the range.
    """
    found: dict[str, dict[str, None]] = {}
    made: dict[tuple[str, ...], str] = {}
    for step in _steps_of(known):
        if not isinstance(step, Fact) or step.name in shared:
            continue
        poles = dict[str, None]()
        for k, zero in enumerate(divisors(beneath([value_of(step.formula)]))):
            names = [part.value for part in beneath([zero]) if part.kind == "name"]
            if zero.kind == "name" and _is_size(known, zero.value):
                continue  # of a vector, which vanishes at no position of most designs
            if not any(known.varies(name) for name in names if name not in shared):
                continue
            of = f"{root_of(known.parse(step.name))}_rate" if known.is_derivative(step.name) else step.name
            name = next(free for n in count(k) if not known.declares(free := f"{of}_pole{n}"))
            labels = {"units": "1", "symbol": name, "meaning": name, "source": step.source}
            text = generate_formula("", GraphAsWritten(()), zero, {}).lines
            if text not in made:  # a quotient and its derivative are divided by the same
                made[text] = zero.value if zero.kind == "name" else declared_step(known, name, zero, labels)
            poles[made[text]] = None
        for need in step.depends_on:
            # a derivative is divided by what it is made of, and where its quantity is infinite it is, too
            poles |= found.get(need, {}) | found.get(root_of(known.parse(need)), {})
        found.update(dict.fromkeys(step.names, poles))
    return {name: tuple(found[name]) for name in known.public if found.get(name)}


def _with_divisors(known: Catalogue, poles: Mapping[str, tuple[str, ...]]) -> dict[str, tuple[str, int]]:
    """Return by quantity of one pole what it is divided by, and the power of that by which its derivative is at most.

    Where that comes close to zero, but not there, the quantity has extremes that hide between two samples; those of the
    derivative times that power do not. The power is even, as what a quotient is divided by may be negative.
    """
    found = {}
    given = {*known.inputs, *known.tables, *known.table_low_parts, known.position.name, "branch"}
    for name, (first, *others) in poles.items():
        if others:
            continue
        assert known.graded is not None
        graded = replace(known.graded, gaps=None, vanishes_at_toggle=first)
        steps = known.dependencies([first, name], given)
        order = asymptotics(graded, steps, (known.position.name,))[name].order
        # a derivative has one order more; of a magnitude, that of half the square is searched
        order += order + 1.0 if value_of(known.facts[name].formula).value is magnitude else 1.0
        if order > 1.0:
            found[name] = first, 2 * math.ceil(order / 2.0)
    return found


def _is_size(known: Catalogue, name: str) -> bool:
    """Tell whether a fact is the magnitude of a vector, or its square."""
    fact = known.facts.get(name)
    value = value_of(fact.formula) if fact is not None else None
    if value is None or value.value is magnitude:
        return value is not None
    return value.kind == "+" and all(part.kind == "*" and part.args[0] is part.args[1] for part in value.args)


def _loops(entry: Entry, unknowns: tuple[str, ...], said: Mapping[str, str], formula: Formula) -> Loops:
    """Return the equations of the loops of an entry."""
    rates: dict[str, tuple[str, str, int]] = {}
    for key, names in said.items():
        unknown, _, speed = key.partition(" by ")
        if unknown not in unknowns:
            remedy = f"write such as {unknowns[0]} by SPEED: NAME"
            raise entry.refused(f"{unknown} is none of the unknowns", remedy)
        rates |= {name: (unknown, speed, k) for k, name in enumerate(re.split(r",\s*", names), 1)}
    rows = getattr(formula.result, "elts", [])
    if len(rows) != len(unknowns):
        what = f"the loops have {len(rows)} equations for {len(unknowns)} unknowns"
        raise entry.refused(what, "write a line `| ...` that vanishes for each unknown")
    return Loops(unknowns, formula, rates)
