"""Requested names: quantities, their reductions over the input cycle, lists of their extrema."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from difflib import get_close_matches
from itertools import islice
from string import Formatter
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

from fastlink._text import short_repr
from fastlink.errors import InputError, Problems, listed
from fastlink.facts import find
from fastlink.facts.derivative import units_per
from fastlink.facts.find import parts
from fastlink.facts.formula import CatalogueError
from fastlink.facts.names import (
    Change,
    Derivative,
    ErrorBound,
    GradientStatus,
    ListOfExtrema,
    Name,
    Quantity,
    Reduced,
    bounded_of,
    derivative_name,
    ending,
    error_name,
    forget_reduction,
    innermost,
    register_reduction,
    signed,
    size_name,
)
from fastlink.mechanisms import NAMES
from fastlink.mechanisms import catalogue as find_catalogue
from fastlink.numerics import compiler
from fastlink.numerics.elementary import sqrt
from fastlink.space.units import is_unit

if TYPE_CHECKING:
    from fastlink.facts.catalogue import Catalogue


# -- Reductions over the input cycle: greatest, least, mean, root mean square, fluctuation

# Everything that is true of one reduction stands in its entry of `REDUCTIONS`: the kernel text, the
# reference that verification compares with, the sign of an extreme, how its value and its units follow from
# those of the quantity.


#: The accumulator ``{count}`` of the configurations that assemble: its first value and its update.
COUNT = ("0.0", "{count} + select({value} == {value}, {part}, 0.0)")
#: What stands for the part of a position in a sum, and for it as a factor: at the ends of an arc it is a half.
WHOLE_PART, OF_ARC = {"part": "1.0", "times": ""}, {"part": "part", "times": "part * "}
#: Samples on which a reference is tried when a reduction is defined, and a factor without rounding.
TRIED, FACTOR = (0.375, -1.25, 3.5, -0.0625, 2.0), 4.0
TOLERANCE = 1e-12
#: What kernel text calls the quantity, and whether it replaces an extreme.
RESERVED = {"value", "better", "slope", *WHOLE_PART}


@dataclass(frozen=True, eq=False, kw_only=True)
class Reduction:
    """One way to reduce the cycle of a quantity to a number.

    Kernel text is one expression of arithmetic, comparisons, ``select``, ``sqrt`` and ``abs`` in which ``{value}`` is
    the quantity at an input position and ``{NAME}`` an accumulator; ``{part}``, and ``{times}`` before a factor, weigh
    what is summed where the ends of an arc count half. Configurations that do not assemble are NaN and
    must not enter: a comparison with NaN is false. A cycle without any value must give NaN.

    Attributes
    ----------
    suffix : str
        The ending of its names.
    phrase : str
        Its meaning, to follow that of the quantity in a long name.
    keywords : tuple of str
        Other words for it, by which it is found.
    reference : callable
        ``reference(samples)`` returns the exact value over at least one sample, and the size of the terms that it is
        the sum of (its absolute value where it is not a sum): errors are counted in roundings of that. Samples are
        numbers of 50 digits without NaN, in the order of the input positions; it works with floats too. None of a path,
        which verification leaves out.
    accumulators : mapping of str to (str, str)
        For each accumulator its first value and the kernel text that updates it at each input position; all updates see
        the values from before. `COUNT` may be among them, under the name ``count``.
    finish : str
        Kernel text of the result, over accumulators.
    sign : int
        1 for the greatest value, -1 for the least: these are searched exactly, and have a position. 0 for all others.
    power : int or None
        A quantity times a positive factor gives the result times this power of it; units follow. None where there is no
        such power, so that no axis of a sweep only scales the result.
    units : str
        Those of the result, where `power` is None.
    toggle_order : int, optional
        A quantity that grows as this power of 1/sigma at a toggle, or a greater one, sigma as the root of the distance
        from it, has no such integral over the turn.
    at_toggle : str
        Kernel text of the result there, over accumulators.
    whole : str
        ``MODULE.FUNCTION`` of ``fastlink.codegen.runtime``: takes the whole curve at once, of equal steps over a turn,
        instead of `accumulators` and `finish`. A curve with a gap gives NaN.
    gradient, gradient_finish : mapping of str to (str, str), str
        Further accumulators, and kernel text over all of them, of the derivative of the result by an input. Their
        updates may read ``{slope}``, that of the quantity at the input position. Without them it has no derivative.
    has_kink : bool
        Whether it has no derivative where it is zero, as a root.
    of_size : bool
        Whether it is taken of the magnitude of the quantity.
    of_path : bool
        Whether it is of the path of a point NAME with the coordinates NAME_x and NAME_y: `whole` takes both curves, in
        any order of their positions.
    """

    suffix: str
    phrase: str
    reference: Callable[[Sequence[Any]], tuple[Any, Any]] | None
    accumulators: Mapping[str, tuple[str, str]] = field(default_factory=dict)
    finish: str = ""
    sign: int = 0
    power: int | None = 1
    units: str = ""
    toggle_order: int | None = None
    at_toggle: str = "nan"
    whole: str = ""
    keywords: tuple[str, ...] = ()
    gradient: Mapping[str, tuple[str, str]] = field(default_factory=dict)
    gradient_finish: str = ""
    has_kink: bool = False
    of_size: bool = False
    of_path: bool = False

    def __post_init__(self) -> None:
        if bad := RESERVED.intersection((*self.accumulators, *self.gradient)):
            raise CatalogueError(f"reduction {self.suffix}: call the accumulator {bad.pop()!r} otherwise")
        if bool(self.whole) == bool(self.accumulators and self.finish):
            raise CatalogueError(
                f"reduction {self.suffix}: give accumulators and finish, or the function of whole curves"
            )
        if bool(self.units) != (self.power is None):
            raise CatalogueError(f"reduction {self.suffix}: give the power of its units, or its units")
        if self.sign not in (-1, 0, 1):
            raise CatalogueError(f"reduction {self.suffix}: the sign is {self.sign!r}; write 1, -1 or 0")
        if (self.reference is None) != self.of_path:
            raise CatalogueError(f"reduction {self.suffix}: give a reference, or say that it is of a path")
        self._check_text()
        if self.reference is not None:
            self._check_reference(self.reference)

    def _check_text(self) -> None:
        names = set(self.accumulators)
        finals = ((text, names) for text in (self.finish, self.at_toggle))
        all_names, here = names | set(self.gradient), {"value", "better", *WHOLE_PART}
        updates = [(text, names | here) for pair in self.accumulators.values() for text in pair]
        slopes = [(text, all_names | here | {"slope"}) for pair in self.gradient.values() for text in pair]
        for text, known in (*updates, *finals, *slopes, (self.gradient_finish, all_names)):
            read = {name for _, name, _, _ in Formatter().parse(text) if name is not None}
            if unknown := read - known:
                raise CatalogueError(f"reduction {self.suffix}: {text!r} reads {', '.join(sorted(unknown))}")

    def _check_reference(self, reference: Callable[[Sequence[Any]], tuple[Any, Any]]) -> None:
        (one, _), (scaled, _) = reference(TRIED), reference([FACTOR * sample for sample in TRIED])
        if self.power is not None and not math.isclose(scaled, FACTOR**self.power * one, rel_tol=TOLERANCE):
            raise CatalogueError(
                f"reduction {self.suffix}: {FACTOR:g} times the quantity gives {scaled:g}, not {FACTOR:g}^{self.power} "
                f"times {one:g}"
            )
        if self.sign and one != {1: max, -1: min}[self.sign](TRIED):
            raise CatalogueError(
                f"reduction {self.suffix}: the sign {self.sign} is not that of its reference"
            )

    @property
    def has_position(self) -> bool:
        """Whether it is the value at one position of the cycle, an extremum."""
        return self.sign != 0

    @property
    def better(self) -> str:
        """Kernel text: whether the value at a position replaces the extremum so far."""
        return {0: "", 1: "{value} > {best}", -1: "{value} < {best}"}[self.sign]

    def units_of(self, units: str) -> str:
        """Return the units of the result for a quantity of some units."""
        if self.power is None:
            return self.units
        if self.power == 1:
            return units
        powers = [(unit, self.power * int(n or 1)) for unit, n in re.findall(r"([A-Za-z]+)(-?\d*)", units)]
        return " ".join(f"{unit}{n if n != 1 else ''}" for unit, n in powers if n) or "1"

    def degree_of(self, degree: float) -> float | None:
        """Return the power of an input by which the result grows where the quantity grows by `degree`."""
        if degree == 0.0:
            return 0.0
        return None if self.power is None else self.power * degree


def _greatest(samples: Sequence[Any]) -> tuple[Any, Any]:
    return max(samples), abs(max(samples))


def _least(samples: Sequence[Any]) -> tuple[Any, Any]:
    return min(samples), abs(min(samples))


def _root_mean_square(samples: Sequence[Any]) -> tuple[Any, Any]:
    root = sqrt(sum(sample * sample for sample in samples) / len(samples))
    return root, root


def _mean(samples: Sequence[Any]) -> tuple[Any, Any]:
    return sum(samples) / len(samples), sum(map(abs, samples)) / len(samples)


def _travel(samples: Sequence[Any]) -> tuple[Any, Any]:
    return max(samples) - min(samples), max(map(abs, samples))


def _fluctuation(samples: Sequence[Any]) -> tuple[Any, Any]:
    """Return what `fastlink.codegen.runtime.systems` takes, and the sum of the sizes of its terms."""
    count, (mean, size) = len(samples), _mean(samples)
    step = 2 * getattr(samples[0], "context", math).pi / count
    total = low = high = 0 * mean
    for j, here in enumerate(samples):
        before, after, later = (samples[(j + k) % count] for k in (-1, 1, 2))
        turn = total
        if (here - mean) * (after - mean) < 0:
            turn += (here - mean) ** 2 / (2 * (here - after))
        low, high = min(low, turn), max(high, turn)
        total += (13 * (here + after) - (before + later)) / 24 - mean
    # each sample enters four terms, with 28/24 in all, and every mean
    return step * (high - low), step * count * size * 13 / 6


def _extreme(
    sign: int, suffix: str, phrase: str, reference: Callable[..., Any], keywords: str, of_size: bool = False
) -> Reduction:
    initial = "-inf" if sign > 0 else "inf"
    has_value = "{best} > -inf" if sign > 0 else "{best} < inf"
    return Reduction(
        suffix=suffix,
        phrase=phrase,
        reference=reference,
        accumulators={"best": (initial, "select({better}, {value}, {best})")},
        finish=f"select({has_value}, {{best}}, nan)",
        sign=sign,
        keywords=tuple(keywords.split()),
        gradient={"slope_there": ("nan", "select({better}, {slope}, {slope_there})")},
        gradient_finish="{slope_there}",
        of_size=of_size,
    )


#: Every reduction by its suffix.
REDUCTIONS: dict[str, Reduction] = {}


def register(reduction: Reduction) -> None:
    """Offer a reduction for every quantity that changes over the cycle."""
    if reduction.suffix in REDUCTIONS:
        raise CatalogueError(f"reduction {reduction.suffix} is declared twice")
    register_reduction(reduction.suffix, reduction.has_position)
    REDUCTIONS[reduction.suffix] = reduction


def unregister(suffix: str) -> None:
    """Take back what `register` offers, in a test of a reduction of its own."""
    forget_reduction(suffix)
    del REDUCTIONS[suffix]


register(_extreme(1, "max", "greatest over the cycle", _greatest, "maximum maximal greatest largest highest"))
register(_extreme(-1, "min", "least over the cycle", _least, "minimum minimal least smallest lowest"))
register(
    _extreme(
        1,
        "peak",
        "greatest magnitude over the cycle",
        _greatest,
        "magnitude absolute amplitude",
        of_size=True,
    )
)
register(
    Reduction(
        suffix="rms",
        phrase="root mean square over the cycle",
        reference=_root_mean_square,
        accumulators={
            "total": ("0.0", "{total} + select({value} == {value}, {times}{value} * {value}, 0.0)"),
            "count": COUNT,
        },
        finish="sqrt({total} / {count})",
        toggle_order=1,
        at_toggle="select({total} == 0.0, sqrt({total} / {count}), inf)",
        keywords=("effective", "quadratic"),
        gradient={
            "product": ("0.0", "{product} + select({value} == {value}, {times}{value} * {slope}, 0.0)")
        },
        gradient_finish="{product} / ({count} * sqrt({total} / {count}))",
        has_kink=True,
    )
)
register(
    Reduction(
        suffix="mean",
        phrase="mean over the cycle",
        reference=_mean,
        accumulators={
            "total": ("0.0", "{total} + select({value} == {value}, {times}{value}, 0.0)"),
            "count": COUNT,
        },
        finish="{total} / {count}",
        toggle_order=2,
        at_toggle="select({total} == 0.0, {total} / {count}, nan)",
        keywords=("average", "avg", "averaged"),
        gradient={"slopes": ("0.0", "{slopes} + select({value} == {value}, {times}{slope}, 0.0)")},
        gradient_finish="{slopes} / {count}",
    )
)
register(
    Reduction(
        suffix="fluctuation",
        phrase="greatest minus least integral over the input angle of what exceeds the mean",
        reference=_fluctuation,
        whole="systems.fluctuation_lanes",
        toggle_order=0,  # the curve has a gap, be it between two samples
        keywords=("variation", "ripple"),
    )
)


register(
    Reduction(
        suffix="travel",
        phrase="greatest minus least of the positions",
        reference=_travel,
        accumulators={
            "high": ("-inf", "select({value} > {high}, {value}, {high})"),
            "low": ("inf", "select({value} < {low}, {value}, {low})"),
        },
        finish="select({high} >= {low}, {high} - {low}, nan)",
        keywords=("dwell", "rest", "span", "stroke"),
        gradient={
            "of_high": ("nan", "select({value} > {high}, {slope}, {of_high})"),
            "of_low": ("nan", "select({value} < {low}, {slope}, {of_low})"),
        },
        gradient_finish="{of_high} - {of_low}",
        has_kink=True,
    )
)


def _path(suffix: str, phrase: str, *keywords: str) -> Reduction:
    whole = f"paths.{suffix}_lanes"
    return Reduction(
        suffix=suffix, phrase=phrase, reference=None, whole=whole, keywords=keywords, of_path=True
    )


register(_path("straightness", "greatest distance from the best straight line", "straight", "line"))
register(
    _path("roundness", "greatest distance from the circle of least squares", "round", "circle", "circular")
)


# -- Derivatives of reductions over the cycle by the inputs: which there are, and what the codes of their
#    status mean

# An extreme inside the range changes by an input as the quantity does at its place, which need not be moved
# along: the slope is zero there. At a limit of motion the place moves with the limit, and the derivative
# that counts keeps the place at the end of the range.


#: The codes of ``NAME_max_gradient_status``.
STATUS_FLAGS = {
    compiler.SMOOTH: "derivative",
    compiler.AT_LIMIT: "at a limit of motion that moves",
    compiler.TIED: "one-sided as two places tie",
    compiler.INFINITE: "none as the value is infinite",
    compiler.AT_CHANGE_POINT: "none at the fold of a change point",
    compiler.NOTHING: "no value",
    compiler.KINK: "none at a kink or next to a pole",
    compiler.OF_SAMPLES: "of the sampled positions that assemble",
    compiler.CONSTANT: "one-sided as nothing changes over the cycle",
    compiler.JUMP: "zero where an angle jumps by a full turn or folds at pi or 0",
    compiler.MOVING: "none as limits of motion move",
}


def reduced_of(tree: Name) -> Reduced | ListOfExtrema | None:
    """Return the property of the cycle of which a name is the derivative, status or change, or a bound of one."""
    inner = tree.of if isinstance(tree, ErrorBound) else tree
    while isinstance(inner, Derivative) and isinstance(inner.of, Derivative):
        inner = inner.of
    if isinstance(inner, Derivative) and isinstance(inner.of, Change):
        inner = inner.of
    of = inner.of if isinstance(inner, (Derivative, GradientStatus, Change)) else None
    return of if isinstance(of, (Reduced, ListOfExtrema)) else None


def gradient_refusal(name: str, tree: Name, of: Reduced, catalogue: Catalogue) -> InputError | None:
    """Return the error that says why a property of the cycle has no such derivative, None where it has one."""
    what, quantity, position = f"quantity {name!r}: ", str(of.of), catalogue.position.name
    first = next(iter(catalogue.inputs))
    if isinstance(tree, ErrorBound) and isinstance(tree.of, Change):
        return InputError(f"{what}no error bound of {tree.of} is known", remedy="leave it out")
    if isinstance(tree, ErrorBound):
        what += (
            f"{tree.of} is taken at a place that is off itself, and no bound of what that does to it is known"
        )
        return InputError(what, remedy=f"ask for {ErrorBound(of)}, the error of the extreme itself")
    if isinstance(tree, Derivative) and isinstance(tree.of, (Derivative, Change)):
        return InputError(f"{what}second derivatives of {of} are not offered", remedy=f"ask for {tree.of}")
    if isinstance(tree, Derivative) and tree.by == position:
        by_input = Derivative(of, first)
        what += f"{of} is one number of the cycle, which does not change with {position}"
        return InputError(what, remedy=f"ask for its derivative by an input, such as {by_input}")
    if not REDUCTIONS[of.how].gradient_finish:
        return InputError(f"{what}{of} has no derivative by an input", remedy="leave it out")
    if isinstance(tree, Change) and isinstance(of.of, Change):
        return InputError(f"{what}{of.of} is a change itself", remedy=f"ask for {of}")
    fact = catalogue.public_fact(quantity)
    if fact.flags:
        return InputError(f"{what}{quantity} is a code, which has no derivative", remedy="leave it out")
    by = tree.by if isinstance(tree, Derivative) else first
    catalogue.public_fact(derivative_name(quantity, by))
    return None


def status_text(reduction: Reduction, value: str, over_all: bool) -> tuple[str, str]:
    """Return kernel text of the status of derivatives of a reduction of samples, and that at a limit of motion."""
    code = compiler.SMOOTH if over_all else compiler.OF_SAMPLES
    if reduction.has_kink:
        value, text = f"({value})", f"select({value} == 0.0, {compiler.KINK}.0, {code}.0)"
    else:
        text = f"{code}.0"
    found = f"select({value} == {value}, {{}}, {compiler.NOTHING}.0)"
    return found.format(text), found.format(f"{compiler.MOVING}.0")


def check_sampled(requests: Iterable[Request], catalogue: Catalogue) -> None:
    """Refuse derivatives of places where extremes are those of samples."""
    for request in requests:
        if (request.by or request.change) and request.is_position:
            what = f"quantity {request.name!r}: the extremes of {request.quantity} are those of samples here, whose"
            what += f" {catalogue.position.name} does not change with {request.by or 'the inputs'}"
            raise InputError(what, remedy="leave it out")


class Results:
    """The names of all that may be computed of a mechanism."""

    def __init__(self, catalogue: Catalogue) -> None:
        self.catalogue = catalogue

    def __contains__(self, name: object) -> bool:
        try:
            return bool(parse_request(str(name), self.catalogue))
        except InputError:
            return False


def units_of(request: Request, catalogue: Catalogue) -> str:
    """Return the units of a request, of that which has units."""
    if request.by and request.is_position:
        return units_per(catalogue.position.units, catalogue.variables[request.by].units)
    if request.change and request.is_position:
        return catalogue.position.units
    units = catalogue.public_fact(request.bounded if request.by else request.quantity).units
    return units if request.reduction is None else request.reduction.units_of(units)


# -- Suggest what an unknown name may mean: quantities, their reductions and derivatives, inputs


#: Words that ask for the position of an extreme: before an extreme, and in its place.
AT, PLACES = frozenset(("at", "where", "when")), {"argmax": "max", "argmin": "min"}
LISTS = frozenset(("extrema", "extreme", "extremes", "extremum", "maxima", "minima"))
COUNTS, KINDS = frozenset(("number", "count", "many")), frozenset(("kind", "kinds"))
ALL = frozenset(("all", "list"))
#: The share of letters from which a word is that of a reduction.
MISSPELT = 0.85
ERRORS = frozenset(("error", "err", "uncertainty", "rounding"))
#: The derivative of one thing with respect to another, in words.
IN_WORDS = re.compile(
    r"^(?:derivative|sensitivity|slope|gradient) (?:of )?(.+?) (?:with respect to|wrt|by|over|to) (.+)$"
)


class Form(NamedTuple):
    """The request that words make of a quantity: besides its name, a reduction or an error bound."""

    #: The words of the quantity itself.
    rest: tuple[str, ...]
    #: The reduction.
    how: str = ""
    #: Whether the input position of the extreme is asked for.
    position: bool = False
    #: The part of a list of extremes.
    listed: str = ""
    #: Whether the bound of the rounding error is asked for.
    error: bool = False
    #: Whether that bound is of the extreme, and not the extreme of the bounds.
    of_extreme: bool = False

    def of(self, name: Name, position: str) -> Name:
        """Return the name that the words ask for, of a quantity."""
        if self.of_extreme:
            return ErrorBound(Reduced(name, self.how)) if self.how else ListOfExtrema(name, "error")
        tree = ErrorBound(name) if self.error else name
        if self.listed:
            return ListOfExtrema(tree, self.listed, position if self.position else "")
        return Reduced(tree, self.how, position if self.position else "") if self.how else tree


def _forms(spelt: Sequence[str], position: str) -> Iterable[Form]:
    """Yield what words may ask for: first the quantity that they name as they are."""
    yield Form(tuple(spelt))
    said = _reductions()
    spelt = [part for word in spelt for part in _unglued(word, said)]
    at = _after_position(spelt, position)
    rest = tuple(at if at is not None else spelt)
    how = [said[word] for word in rest if word in said]
    rest = tuple(word for word in rest if word not in said)
    if how and rest:
        wanted = at is not None or any(word in PLACES for word in spelt)
        yield Form(rest, how[0], wanted and REDUCTIONS[how[0]].has_position)
    if (names := tuple(word for word in rest if word not in LISTS | ALL)) and LISTS.intersection(rest):
        kind = "count" if COUNTS.intersection(rest) else "kind" if KINDS.intersection(rest) else "value"
        names = tuple(word for word in names if word not in COUNTS | KINDS)
        yield Form(names, "", at is not None and kind == "value", kind)
    if ERRORS.intersection(rest) and (names := tuple(word for word in rest if word not in ERRORS)):
        if how and REDUCTIONS[how[0]].has_position:
            yield Form(names, how[0], error=True, of_extreme=True)
        yield Form(names, how[0] if how else "", error=True)
        if LISTS.intersection(names) and (names := tuple(word for word in names if word not in LISTS | ALL)):
            yield Form(names, error=True, of_extreme=True)


def _reductions() -> dict[str, str]:
    """Return the reduction that each word asks for."""
    of_quantities = {how: each for how, each in REDUCTIONS.items() if not each.of_path}
    return {word: how for how, each in of_quantities.items() for word in (how, *each.keywords)} | PLACES


def _unglued(word: str, said: Iterable[str]) -> tuple[str, ...]:
    """Return a word in two parts if it begins or ends with that of a reduction, as maxomega does; or spelt right."""
    if near := [how for how in get_close_matches(word, said, 1, MISSPELT) if len(how) > 3]:
        return (near[0],)
    for how in said:
        if len(word) > len(how) + 2 and word.startswith(how):
            return how, word.removeprefix(how)
        if len(word) > len(how) + 2 and word.endswith(how):
            return word.removesuffix(how), how
    return (word,)


def _after_position(spelt: Sequence[str], position: str) -> tuple[str, ...] | None:
    """Return the words after "theta1 at" or "crank angle of", else None."""
    own = parts(position)
    if list(spelt[: len(own) + 1]) in ([*own, "at"], [*own, "where"]):
        return tuple(spelt[len(own) + 1 :])
    for k, word in enumerate(spelt[1:4], 1):
        if word in (*AT, "of") and find.canonical((spelt[k - 1],))[0] in ("angle", "position"):
            return tuple(spelt[k + 1 :])
    return None


def rank_quantities(text: str, catalogue: Catalogue, over_cycle: bool = True) -> list[find.Ranked]:
    """Return the names of quantities, their reductions and derivatives that a phrase may mean, the best first."""
    found = {one.name: one for one in _ranked(tuple(parts(text)), catalogue, over_cycle)}
    for how, each in REDUCTIONS.items():
        if each.of_path and over_cycle and {how, *each.keywords}.intersection(parts(text)):
            said = [point for point in points_of(catalogue) if point.lower() in parts(text)]
            for point in said or points_of(catalogue):
                name = str(Reduced(Quantity(point), how))
                found[name] = find.Ranked.of(find.LEAST + 0.01, name)
    for of, by, tail in _derivatives(text, catalogue):
        for one in _ranked((*of, *tail), catalogue, over_cycle, by):
            found[one.name] = max(one, found.get(one.name, one), key=lambda each: each.score)
    return sorted(found.values())


def _ranked(
    spelt: tuple[str, ...], catalogue: Catalogue, over_cycle: bool, by: str = ""
) -> list[find.Ranked]:
    """Return the names that words may mean; of derivatives with respect to `by`, where that is given."""
    found: dict[str, find.Ranked] = {}
    position = catalogue.position.name
    for form in _forms(spelt, position):
        for one in find.index_of_quantities(catalogue).ranked_parts(form.rest):
            if one.score < find.LEAST:
                break
            tree = catalogue.parse(one.name)
            of_cycle = bool(form.how or form.listed or form.of_extreme)
            if of_cycle and not catalogue.has_reductions(one.name):
                continue
            if form.of_extreme and catalogue.graded is None:
                continue
            if not over_cycle and (of_cycle or not catalogue.is_quantity(one.name)):
                continue
            # no code has a derivative or an error bound, no number of the cycle
            is_number = catalogue.is_quantity(one.name) and not catalogue.public_fact(one.name).flags
            if (by or form.error) and not is_number:
                continue
            name = str(form.of(Derivative(tree, by) if by else tree, position))
            if name not in found or found[name].score < one.score:
                found[name] = find.Ranked.of(one.score, name)
    return list(found.values())


def _derivatives(text: str, catalogue: Catalogue) -> Iterable[tuple[tuple[str, ...], str, tuple[str, ...]]]:
    """Yield the readings of a text as a derivative: words of the quantity, the variable, words after it."""
    spelt = " ".join(parts(text))
    in_words = IN_WORDS.match(spelt)
    if in_words:
        for name in suggest_input(in_words[2], catalogue)[:1]:
            yield tuple(in_words[1].split()), name, ()
    if not spelt.startswith("d"):
        return
    for name in catalogue.variables:
        sought = find.squeezed(name)
        # d, the quantity, d and the variable, then nothing or the words of a reduction
        pattern = f"^d ?(.+?) ?(?<![a-z])d ?{' ?'.join(sought)}( .*)?$"
        if read := re.match(pattern, spelt):
            yield tuple(read[1].split()), name, tuple((read[2] or "").split())


def suggest_quantity(text: str, catalogue: Catalogue, over_cycle: bool = True) -> list[str]:
    """Return the names to suggest for an unknown quantity: three at most."""
    of, how = ending(text)
    if over_cycle and catalogue.is_quantity(of) and catalogue.has_reductions(of):
        known = [name for name, each in REDUCTIONS.items() if not each.of_path]
        if not catalogue.is_quantity(text) and (near := get_close_matches(how, known, 1, 0.66)):
            return [str(Reduced(Quantity(of), near[0]))]
    paths = [name for name, each in REDUCTIONS.items() if each.of_path]
    if over_cycle and of in points_of(catalogue) and (near := get_close_matches(how, paths, 1)):
        return [str(Reduced(Quantity(of), near[0]))]
    return find.best_names(rank_quantities(text, catalogue, over_cycle))


def suggest_input(text: str, catalogue: Catalogue) -> list[str]:
    """Return the names to suggest for an unknown input: three at most."""
    return find.best_names(find.index_of_inputs(catalogue).ranked(text))


#: What quantities were called before 0.3, of mechanisms that have those.
FORMER = {
    "transmission_angle_least": "transmission_angle_min",
    "transmission_angle_greatest": "transmission_angle_max",
}


def unknown_quantity(name: str, catalogue: Catalogue, over_cycle: bool = True) -> InputError:
    """Return the error for a name that is no quantity: why there is none, or what it may mean."""
    if absent := catalogue.absence(name):
        return absent
    if (new := FORMER.get(name)) and catalogue.has_reductions(innermost(new, catalogue)):
        what = f"quantity {name!r} is called {new!r} since 0.3"
        return InputError(
            what, remedy=f"write {new!r}, or 'least_transmission_angle' for the least acute angle"
        )
    of, unit = ending(name)
    if of and unit and is_unit(unit) and of in Results(catalogue):
        what = f"quantity {name!r}: results are in SI"
        return InputError(what, remedy=f"write {of!r}, and convert the result")
    same = find.squeezed(name)
    for known in catalogue.all_inputs.values():
        if find.squeezed(known.name) == same:
            of = "" if known.name == name else f" {known.name!r}"
            what = f"quantity {name!r} is the input{of}, a coordinate of the result ({known.meaning})"
            return InputError(what, remedy="leave it out")
    if of in catalogue.all_inputs and unit in REDUCTIONS:
        what = f"quantity {name!r}: {of} is an input, which does not change over the cycle"
        return InputError(what, remedy="leave it out")
    wrong, of_variable = catalogue.unknown_part(name)
    what = f"quantity {name!r}" if wrong == name else f"quantity {name!r}: {wrong!r}"
    elsewhere = [other for other in NAMES if find_catalogue(other).is_public(wrong)]
    what += f" is unknown to {catalogue.name}{', known to ' if elsewhere else ''}{' and '.join(elsewhere)}"
    if of_variable:
        near = suggest_input(wrong, catalogue)
        return InputError(what, remedy=find.did_you_mean(near) if near else listed(list(catalogue.variables)))
    near = suggest_quantity(name, catalogue, over_cycle) or suggest_quantity(wrong, catalogue, over_cycle)
    of_built_in = getattr(catalogue, "first", catalogue).name
    lists = "`fl.quantities(...)` of it lists all"
    if of_built_in in NAMES:
        lists = f"`fastlink quantities {of_built_in}` lists all"
    return InputError(what, remedy=find.did_you_mean(near) if near else lists)


def require_quantity(name: str, catalogue: Catalogue) -> None:
    """Refuse a name that has no value at an input position."""
    if catalogue.is_quantity(name):
        catalogue.public_fact(name)
        return
    named = catalogue.parse(name)
    tree = bounded_of(named)
    if isinstance(tree, (Reduced, ListOfExtrema)) and catalogue.has_reductions(str(tree.of)):
        what = f"quantity {name!r} is over the whole cycle, not at an input position"
        is_error = tree is not named or (isinstance(tree, ListOfExtrema) and tree.part == "error")
        here = str(ErrorBound(tree.of) if is_error else tree.of)
        raise InputError(what, remedy=f"request it of fl.sweep or fl.function, or write {here!r}")
    raise unknown_quantity(name, catalogue, over_cycle=False)


#: Most names in one list; more come from an iterator without end.
MOST_NAMES = 10_000

#: Whether extrema are exact over the cycle, or those of the values at the given positions.
Extrema = Literal["refined", "sampled"]


@dataclass(frozen=True)
class Request:
    """A requested name."""

    #: The name, and that of the quantity in it.
    name: str
    quantity: str
    #: The reduction over the cycle that it is.
    reduction: Reduction | None = None
    #: Whether it is the input position of an extremum instead of its value.
    is_position: bool = False
    #: The part of a list of extrema that it is, if it is one.
    listed: str = ""
    #: Whether it is the error bound of an extremum or of each of a list instead of the value.
    is_error: bool = False
    #: The input by which it is the derivative of the reduction or its position; empty if it is none.
    by: str = ""
    #: Whether it is the status of the derivatives of the reduction by the inputs instead of the value.
    is_status: bool = False
    change: str = ""
    #: Of a reduction of the path of a point, whose first coordinate is the quantity, the other one.
    other: str = ""

    @property
    def is_of_gradient(self) -> bool:
        """Whether it is a derivative of a reduction by an input, their status, or a change by tolerances."""
        return bool(self.by or self.change) or self.is_status

    @property
    def is_of_quantity(self) -> bool:
        """Whether a value has the meaning and the values of its quantity: no mean of a code is one, no position."""
        of_value = self.reduction is None or self.reduction.sign != 0
        return not self.is_position and not self.is_of_gradient and of_value

    @property
    def has_its_units(self) -> bool:
        """Whether it is in the units of its quantity, or those of its reduction: no position, number or kind."""
        return not (self.is_position or self.is_status) and self.listed in ("", "value", "error")

    @property
    def of(self) -> Quantity | Reduced:
        """The quantity, or its reduction; a reduction of the magnitude is one of the quantity."""
        quantity = Quantity(signed(self.quantity))
        return quantity if self.reduction is None else Reduced(quantity, self.reduction.suffix)

    @property
    def value(self) -> str:
        """The name of the value, of an extreme or a list, of which it is the error bound."""
        return str(ListOfExtrema(self.of) if self.reduction is None else self.of)

    @property
    def bounded(self) -> str:
        """The quantity, or its error bound or derivative, where the request is that of extremes."""
        if self.by and not self.is_position:
            return derivative_name(self.quantity, self.by)
        return error_name(self.quantity) if self.is_error else self.quantity

    @property
    def can_be_refined(self) -> bool:
        """Whether it is one number of the extrema, which samples only come near."""
        return self.reduction is not None and self.reduction.has_position


def parse_request(name: str, catalogue: Catalogue) -> Request:
    """Read a requested name such as ``omega4``, ``omega4_max`` or ``theta1_at_omega4_max``."""
    if catalogue.is_quantity(name):
        return Request(name, name)
    tree = catalogue.parse(name)
    if request := _of_gradient(name, tree, catalogue):
        return request
    of = bounded_of(tree)
    if isinstance(tree, Change) and isinstance(of, ListOfExtrema):
        what = f"quantity {name!r}: {of} is a list, of which no change is offered"
        raise InputError(what, remedy=f"ask for {Change(Reduced(of.of, 'max'), tree.how)}")
    if isinstance(of, Reduced) and REDUCTIONS[of.how].of_path:
        return _of_path(name, tree, of, catalogue)
    if isinstance(of, (Reduced, ListOfExtrema)) and catalogue.has_reductions(quantity := str(of.of)):
        listed = "" if isinstance(of, Reduced) else "position" if of.position else of.part
        if (is_error := of is not tree or listed == "error") and (refusal := _no_error(name, of, catalogue)):
            raise refusal
        if isinstance(of, Reduced):
            how = REDUCTIONS[of.how]
            quantity = _reduced_by(how, quantity, catalogue, name)
            return Request(name, quantity, how, bool(of.position), is_error=is_error)
        return Request(name, quantity, listed=listed, is_error=is_error)
    raise unknown_quantity(name, catalogue)


def _of_gradient(name: str, tree: Name, catalogue: Catalogue) -> Request | None:
    """Return the request for a derivative of a reduction by an input, or for the status of these."""
    of = reduced_of(tree)
    if isinstance(of, Reduced) and REDUCTIONS[of.how].of_path:
        return _of_path(name, tree, of, catalogue)
    if not isinstance(of, Reduced) or not catalogue.has_reductions(quantity := str(of.of)):
        return None
    if refusal := gradient_refusal(name, tree, of, catalogue):
        raise refusal
    own = {"by": tree.by} if isinstance(tree, Derivative) else {"change": getattr(tree, "how", "")}
    how = REDUCTIONS[of.how]
    quantity = _reduced_by(how, quantity, catalogue, name)
    return Request(name, quantity, how, bool(of.position), is_status=not any(own.values()), **own)


def points_of(catalogue: Catalogue) -> list[str]:
    """Return the points whose path has reductions: those with two coordinates, in m, that change over the cycle."""
    if catalogue.positions is not None:
        return []  # a path by rapidity is not in the Euclidean plane
    return [
        name[:-2]
        for name, fact in catalogue.public.items()
        if name.endswith("_x")
        and fact.units == "m"
        and catalogue.varies(name)
        and f"{name[:-2]}_y" in catalogue.public
    ]


def _of_path(name: str, tree: Name, of: Reduced, catalogue: Catalogue) -> Request:
    """Return the request for a reduction of the path of a point."""
    point, points = str(of.of), points_of(catalogue)
    if point not in points:
        what = f"quantity {name!r}: {point!r} is no point of {catalogue.name} that moves"
        raise InputError(what, remedy=listed([str(Reduced(Quantity(one), of.how)) for one in points]))
    if tree is not of:
        what = f"quantity {name!r}: of {of} no derivative, change or error bound is offered"
        raise InputError(what, remedy=f"ask for {of}")
    return Request(name, f"{point}_x", REDUCTIONS[of.how], other=f"{point}_y")


def _reduced_by(how: Reduction, quantity: str, catalogue: Catalogue, name: str) -> str:
    """Return the quantity of which a reduction is taken: the quantity itself, or its magnitude."""
    if not how.of_size:
        return quantity
    if catalogue.public_fact(quantity).flags:
        what = f"quantity {name!r}: {quantity} is a code, which has no magnitude"
        raise InputError(what, remedy="leave it out")
    return size_name(quantity)


def _no_error(name: str, of: Reduced | ListOfExtrema, catalogue: Catalogue) -> InputError | None:
    """Return the error that says why a property of the cycle has no error bound, None where it has one."""
    catalogue.public_fact(error_name(str(of.of)))  # codes have none, nor have error bounds
    what, remedy = f"quantity {name!r}: ", f"ask for {Reduced(ErrorBound(of.of), 'max')}"
    if isinstance(of, ListOfExtrema) and of.part in ("count", "kind"):
        return InputError(f"{what}{of} is a code, which has no error", remedy="leave it out")
    if of.position:
        of_value = (
            ErrorBound(Reduced(of.of, of.how)) if isinstance(of, Reduced) else ListOfExtrema(of.of, "error")
        )
        what += f"{of} is off by the error of the slope over the curvature there, of which no bound is known"
        return InputError(what, remedy=f"ask for {of_value}, the error of the extreme itself")
    if isinstance(of, Reduced) and REDUCTIONS[of.how].sign == 0:
        what += f"{of} is taken from samples of the cycle, and how far these are from all of it is not known"
        return InputError(what, remedy=f"{remedy}, the greatest error of the samples")
    return None


def check_names(parameter: str, given: Iterable[str]) -> tuple[str, ...]:
    """Return the names of a list, each of which must stand in it once."""
    where = (parameter,)
    if isinstance(given, str):
        meant = re.findall(r"[^\s,;]+", given) or [given]
        raise InputError(f"is one text, {short_repr(given)}", where, f"write a list: {short_repr(meant)}")
    names: list[str] = []
    try:
        if not isinstance(given, (bytes, bytearray, set, frozenset, Mapping)):
            names = list(islice(given, MOST_NAMES + 1))
        elif given:
            raise TypeError
    except Exception:  # no list, or whatever a class of somebody's does
        raise InputError(f"is {short_repr(given)}", where, "write a list of names") from None
    if not names:
        raise InputError("is empty", where, "write at least one name")
    if len(names) > MOST_NAMES:
        raise InputError(f"holds more than {MOST_NAMES} names", where, "write fewer")
    problems, known = Problems(), set()
    for k, name in enumerate(names):
        if not isinstance(name, str):
            problems.add(f"is {short_repr(name)}", (parameter, k), "write a name")
        elif name in known:
            problems.add(f"{name!r} is named twice", (parameter, k), "name it once")
        else:
            known.add(name)
    problems.stop()
    return tuple(map(str, names))


def list_names(catalogue: Catalogue, quantity: str) -> tuple[str, ...]:
    """Return the names that belong together: a list of extrema, their positions, their number, their kinds."""
    of = Quantity(quantity)
    parts = (ListOfExtrema(of, part) for part in ("count", "kind"))
    return tuple(map(str, (ListOfExtrema(of), ListOfExtrema(of, position=catalogue.position.name), *parts)))


def with_companions(catalogue: Catalogue, names: Iterable[str]) -> list[str]:
    """Return the names with those that belong to each and are not requested already.

    These are the parts of a list of extrema, and after a change by tolerances the status of its derivatives.
    """
    requested = list(names)
    result: list[str] = []
    for name in requested:
        request = parse_request(name, catalogue)
        together: tuple[str, ...] = (name,)
        if request.listed == "value":
            together = list_names(catalogue, request.quantity)
        elif request.change and request.reduction is not None:
            together = (name, str(GradientStatus(request.of)))
        result += [other for other in together if other == name or other not in (*requested, *result)]
    return result
