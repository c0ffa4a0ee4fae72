"""Suggest what an unknown name may mean: quantities, their reductions and derivatives, inputs."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from difflib import get_close_matches
from typing import TYPE_CHECKING, NamedTuple

from fastlink.catalogue.search import (
    LEAST,
    Ranked,
    best_names,
    did_you_mean,
    index_of_inputs,
    index_of_quantities,
)
from fastlink.catalogue.words import canonical, parts, squeezed
from fastlink.errors import InputError, Remedy, listed
from fastlink.facts.names import Derivative, ErrorBound, ListOfExtrema, Name, Reduced, bounded_of
from fastlink.mechanisms import NAMES
from fastlink.mechanisms import catalogue as find_catalogue
from fastlink.plan.reductions import REDUCTIONS

if TYPE_CHECKING:
    from fastlink.catalogue.catalogue import Catalogue

__all__ = [
    "input_remedy",
    "rank_quantities",
    "require_quantity",
    "suggest_input",
    "suggest_quantity",
    "unknown_quantity",
]

#: Words that ask for the position of an extreme: before an extreme, and in its place.
AT, PLACES = frozenset(("at", "where", "when")), {"argmax": "max", "argmin": "min"}
LISTS = frozenset(("extrema", "extreme", "extremes", "extremum", "maxima", "minima"))
COUNTS, KINDS, ALL = (
    frozenset(("number", "count", "many")),
    frozenset(("kind", "kinds")),
    frozenset(("all", "list")),
)
#: The share of letters from which a word is that of a reduction.
MISSPELT = 0.85
ERRORS = frozenset(("error", "err", "uncertainty", "rounding"))
#: The derivative of one thing with respect to another, in words.
IN_WORDS = re.compile(
    r"^(?:derivative|sensitivity|slope|gradient) (?:of )?(.+?) (?:with respect to|wrt|by|over|to) (.+)$"
)


class Form(NamedTuple):
    """The request that words make of a quantity: besides its name, a reduction or an error bound.

    Attributes
    ----------
    rest : tuple of str
        The words of the quantity itself.
    how : str
        The reduction.
    position : bool
        Whether the input position of the extreme is asked for.
    listed : str
        The part of a list of extremes.
    error : bool
        Whether the bound of the rounding error is asked for.
    of_extreme : bool
        Whether that bound is of the extreme, and not the extreme of the bounds.
    """

    rest: tuple[str, ...]
    how: str = ""
    position: bool = False
    listed: str = ""
    error: bool = False
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
    return {word: how for how, each in REDUCTIONS.items() for word in (how, *each.keywords)} | PLACES


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


def _has_derivative(name: str, catalogue: Catalogue) -> bool:
    """Tell whether a quantity has derivatives and an error bound: no code has, no number of the cycle."""
    return catalogue.is_quantity(name) and not catalogue.public_fact(name).flags


def _after_position(spelt: Sequence[str], position: str) -> tuple[str, ...] | None:
    """Return the words after "theta1 at" or "crank angle of", else None."""
    own = parts(position)
    if list(spelt[: len(own) + 1]) in ([*own, "at"], [*own, "where"]):
        return tuple(spelt[len(own) + 1 :])
    for k, word in enumerate(spelt[1:4], 1):
        if word in (*AT, "of") and canonical((spelt[k - 1],))[0] in ("angle", "position"):
            return tuple(spelt[k + 1 :])
    return None


def rank_quantities(text: str, catalogue: Catalogue, over_cycle: bool = True) -> list[Ranked]:
    """Return the names of quantities, their reductions and derivatives that a phrase may mean, the best first.

    Parameters
    ----------
    text : str
        A name or a phrase.
    catalogue : Catalogue
        The mechanism.
    over_cycle : bool
        Whether reductions over the cycle are offered.
    """
    found = {one.name: one for one in _ranked(tuple(parts(text)), catalogue, over_cycle)}
    for of, by, tail in _derivatives(text, catalogue):
        for one in _ranked((*of, *tail), catalogue, over_cycle, by):
            found[one.name] = max(one, found.get(one.name, one), key=lambda each: each.score)
    return sorted(found.values())


def _ranked(spelt: tuple[str, ...], catalogue: Catalogue, over_cycle: bool, by: str = "") -> list[Ranked]:
    """Return the names that words may mean; of derivatives with respect to `by`, where that is given."""
    found: dict[str, Ranked] = {}
    position = catalogue.position.name
    for form in _forms(spelt, position):
        for one in index_of_quantities(catalogue).ranked_parts(form.rest):
            if one.score < LEAST:
                break
            tree = catalogue.parse(one.name)
            of_cycle = bool(form.how or form.listed or form.of_extreme)
            if of_cycle and not catalogue.has_reductions(one.name):
                continue
            if form.of_extreme and catalogue.graded is None:
                continue
            if not over_cycle and (of_cycle or not catalogue.is_quantity(one.name)):
                continue
            if (by or form.error) and not _has_derivative(one.name, catalogue):
                continue
            name = str(form.of(Derivative(tree, by) if by else tree, position))
            if name not in found or found[name].score < one.score:
                found[name] = Ranked.of(one.score, name)
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
        sought = squeezed(name)
        # d, the quantity, d and the variable, then nothing or the words of a reduction
        pattern = f"^d ?(.+?) ?(?<![a-z])d ?{' ?'.join(sought)}( .*)?$"
        if read := re.match(pattern, spelt):
            yield tuple(read[1].split()), name, tuple((read[2] or "").split())


def suggest_quantity(text: str, catalogue: Catalogue, over_cycle: bool = True) -> list[str]:
    """Return the names to suggest for an unknown quantity: three at most.

    Examples
    --------
    >>> from fastlink.mechanisms import catalogue
    >>> suggest_quantity("mu_min", catalogue("planar_4r"))
    ['transmission_angle_min']
    """
    return best_names(rank_quantities(text, catalogue, over_cycle))


def suggest_input(text: str, catalogue: Catalogue) -> list[str]:
    """Return the names to suggest for an unknown input: three at most.

    Examples
    --------
    >>> from fastlink.mechanisms import catalogue
    >>> suggest_input("crank_length", catalogue("planar_4r"))
    ['a1']
    """
    return best_names(index_of_inputs(catalogue).ranked(text))


def unknown_quantity(name: str, catalogue: Catalogue, over_cycle: bool = True) -> InputError:
    """Return the error for a name that is no quantity: why there is none, or what it may mean.

    Parameters
    ----------
    name : str
        The name.
    catalogue : Catalogue
        The mechanism.
    over_cycle : bool
        Whether reductions over the cycle are offered.
    """
    if absent := catalogue.absence(name):
        return absent
    same = squeezed(name)
    for known in catalogue.all_inputs.values():
        if squeezed(known.name) == same:
            of = "" if known.name == name else f" {known.name!r}"
            what = f"quantity {name!r} is the input{of}, a coordinate of the result ({known.meaning})"
            return InputError(what, remedy="leave it out")
    wrong, of_variable = catalogue.unknown_part(name)
    what = f"quantity {name!r}" if wrong == name else f"quantity {name!r}: {wrong!r}"
    elsewhere = [other for other in NAMES if find_catalogue(other).is_public(wrong)]
    what += f" is unknown to {catalogue.name}{', known to ' if elsewhere else ''}{' and '.join(elsewhere)}"
    if of_variable:
        return InputError(what, remedy=input_remedy(wrong, catalogue))
    near = suggest_quantity(name, catalogue, over_cycle) or suggest_quantity(wrong, catalogue, over_cycle)
    lists = f"`fastlink quantities {getattr(catalogue, 'first', catalogue).name}` lists all"
    return InputError(what, remedy=did_you_mean(near) if near else lists)


def require_quantity(name: str, catalogue: Catalogue) -> None:
    """Refuse a name that has no value at an input position.

    Raises
    ------
    InputError
        It is unknown, or a property of the whole cycle.
    """
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


def input_remedy(name: str, catalogue: Catalogue, known: Iterable[str] = ()) -> Remedy:
    """Return the remedy for an unknown input: what it may mean, or the known ones."""
    near = suggest_input(name, catalogue)
    return did_you_mean(near) if near else listed(list(known or catalogue.variables))
