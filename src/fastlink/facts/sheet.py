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

An entry is a head and indented lines. The head has a name, units, a symbol and a meaning; ``step`` makes a fact
internal; a derivative has the labels of its quantity. A formula is Python's: assignments to local names, then what is
returned after ``=``. What it depends on are the names that are neither local nor functions. A line that is indented
further goes on with the one before. Braces stand for several entries, part by part. ``##`` is the source of what
follows, ``#`` a remark; ``[inputs]``, ``[tables]``, ``[facts]`` and ``[variant NAME]`` begin a section, and
``let NAME = number`` is a constant of the sheet. Further lines of an entry:

- ``also: names`` by which it is found, with commas between;
- ``0: meaning`` of a code; ``rule: positive`` and ``default: 0.0`` of an input;
- ``low: name`` of the low part, where a formula returns an unevaluated sum of two doubles;
- ``hides: its reduction`` where a quantity has the name of an extreme of another;
- ``| a, b`` a row of a linear system, whose head is ``system NAME: unknowns``, in the section of a variant.

``also NAME: names`` at the margin is of a name that is declared elsewhere. Expressions are parsed when they are used,
and by `Catalogue.check`, which refuses what is no formula; all else is refused when a sheet is read.
"""

from __future__ import annotations

import ast
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from keyword import kwlist
from pathlib import Path
from typing import TYPE_CHECKING, Any, get_args

from fastlink.errors import suggest
from fastlink.facts.fact import Fact, Input, Rule, System
from fastlink.facts.formula import NAMESPACE, WORD, CatalogueError, Formula, SheetError

if TYPE_CHECKING:
    from fastlink.facts.catalogue import Catalogue

__all__ = ["Entry", "SheetError", "entries_of", "read_sheet", "read_sheets"]

HEAD = re.compile(
    r"(?P<kind>step |system |also |let )?(?P<name>[A-Za-z_]\w*)"
    r"(?: \[(?P<units>[^\]]*)\] (?P<symbol>.*?): (?P<meaning>.+)|: (?P<unknowns>.+)| = (?P<value>.+))?"
)
SECTION = re.compile(r"\[(inputs|tables|facts|variant (\w+))\]")
RULES = get_args(Rule)
#: Words that are no names of values.
RESERVED = frozenset((*kwlist, "abs"))
#: What a line of an entry says that is no formula.
SAYING = re.compile(r"(also|rule|default|low|hides|-?\d+): (.+)")
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

    def expanded(self) -> Iterator[Entry]:
        """Yield the entries that braces stand for."""
        text = "\n".join([self.head, *self.lines])
        if "{" not in text:
            yield self
            return
        counts = {group.count(",") + 1 for group in BRACES.findall(text)}
        if len(counts) > 1:
            what = "braces of one entry have different numbers of parts"
            raise SheetError(self.place, what, "write as many parts in each")
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
                place, f"{line} is no section", "write [inputs], [tables], [facts] or [variant NAME]"
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
        found = HEAD.fullmatch(entry.head)
        if found is None:
            remedy = "write NAME [units] symbol: meaning, or step NAME [units] symbol: meaning"
            raise SheetError(entry.place, f"{entry.head!r} is no head of an entry", remedy)
        if found["kind"] == "also ":
            for catalogue in catalogues:
                catalogue.also_called(**{found["name"]: found["unknowns"] or ""})
            continue
        if found["name"] in names or found["name"] in RESERVED:
            what = f"{found['name']} is a function or constant of formulas, or a word of Python"
            raise SheetError(entry.place, what, "call it otherwise, such as lambda_")
        if found["kind"] == "let ":
            names[found["name"]] = _number(entry, found["value"] or "", names)
            continue
        matches = {line: SAYING.fullmatch(line) for line in entry.lines if ": " in line}
        said = {match[1]: match[2] for match in matches.values() if match}
        if len(said) < sum(map(bool, matches.values())):
            raise SheetError(entry.place, f"{found['name']} says one thing twice", "write it once")
        lines = [line for line in entry.lines if not matches.get(line)]
        lines += [f"= {found['value']}"] if found["value"] else []
        for catalogue in catalogues:
            try:
                _declare(catalogue, entry, found.groupdict(), said, lines, names)
            except SheetError:
                raise
            except CatalogueError as error:
                what, _, remedy = str(error).removeprefix(f"{catalogue.name}: ").partition("; ")
                raise SheetError(entry.place, what, remedy) from None


def _declare(
    catalogue: Catalogue,
    entry: Entry,
    head: Mapping[str, str | None],
    said: Mapping[str, str],
    lines: Sequence[str],
    names: Mapping[str, Any],
) -> None:
    """Declare what an entry says."""
    name, units, symbol, meaning = (str(head[key] or "") for key in ("name", "units", "symbol", "meaning"))
    variant = None if entry.section in ("inputs", "tables", "facts") else entry.section
    codes = {int(code): text for code, text in said.items() if code.lstrip("-").isdigit()}
    if "also" in said:
        catalogue.also_called(**{name: said["also"]})
    if not lines and entry.section != "facts":
        catalogue.declare_input(
            _input(entry, Input(name, units, symbol, meaning, choices=codes), said), variant
        )
        return
    formula = _formula(entry, name, lines, names)
    if head["unknowns"]:
        unknowns = tuple(re.split(r",\s*", head["unknowns"]))
        if variant is None:
            raise SheetError(entry.place, f"system {name} is in no variant", "write [variant NAME] before it")
        _check_words(entry, *unknowns)
        catalogue.declare_system(System(name, unknowns, formula, formula.parameters), variant)
        return
    if head["units"] is None:
        catalogue.declare_derivative(name, formula, formula.parameters, variant)
        return
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
        raise SheetError(entry.place, f"{rule!r} is no rule", suggest(rule, RULES))
    default = _number(entry, said["default"], {}) if "default" in said else None
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
            raise SheetError(entry.place, f"the formula of {name} {what}", "end it in one line `= ...`")
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
            raise SheetError(
                entry.place, f"{name!r} is no name", "write letters, digits and _, such as lambda_"
            )


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
        raise SheetError(entry.place, f"{text!r} is no number", "write such as 2.0**-500") from None
    return float(found)
