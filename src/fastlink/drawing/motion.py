"""Positions of the points of one design, by the facts of its mechanism, and the range in which it assembles."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from fastlink._text import in_words, short_number
from fastlink.engine.evaluate import evaluate
from fastlink.errors import InputError, InputWarning, KeyPath, Remedy, Setting
from fastlink.plan.validate import missing_inputs, selected_variants
from fastlink.space.degrees import RADIANS

if TYPE_CHECKING:
    from fastlink.catalogue.catalogue import Catalogue
    from fastlink.engine.extending import Extension
    from fastlink.mechanisms._shared.picture import Picture, Point, Value
    from fastlink.space.links import Links

__all__ = ["Motion", "as_draw"]

T = TypeVar("T")
#: Positions at which it is looked whether a linkage assembles; halvings of the step where that ends; along a path.
SAMPLES, HALVINGS, ALONG = 720, 44, 361
#: Where nothing is said about the ends of an input that does not turn.
SPAN = (1.0, 1.0)
#: The share of its range at which a linkage stands unless a position is given.
USUAL = 1.0 / 6.0


@dataclass(frozen=True, eq=False)
class Motion:
    """One design that moves.

    Attributes
    ----------
    mechanism : str
        Its name.
    catalogue : Catalogue
        The mechanism, as driven by the input.
    picture : Picture
        Its points.
    design : dict
        Its inputs.
    branches : tuple of int
        The assembly modes.
    links : Links or None
        Where mass data come from.
    reach : float
        Of an input without bounds, how far what is looked at reaches at least, to both sides.
    """

    mechanism: str | Extension
    catalogue: Catalogue
    picture: Picture
    design: dict[str, float]
    branches: tuple[int, ...]
    links: Links | None
    reach: float = 0.0

    @property
    def input(self) -> str:
        """The name of the input."""
        return self.catalogue.position.name

    @property
    def turns(self) -> bool:
        """Whether the input turns, so that its range is a circle."""
        return self.catalogue.position.units == RADIANS

    def values(self, names: Iterable[Value], positions: Any) -> dict[Value, Any]:
        """Return facts, inputs and constants, each over assembly modes and positions."""
        positions = np.atleast_1d(np.asarray(positions, dtype=float))
        shape = (len(self.branches), positions.size)
        known: dict[Any, Any] = {**self.design, self.input: positions}
        facts = [name for name in dict.fromkeys(names) if isinstance(name, str) and name not in known]
        if facts:
            known |= self._evaluated(facts, np.array(self.branches)[:, None], positions)
        return {
            name: np.broadcast_to(known[name] if isinstance(name, str) else float(name), shape)
            for name in names
        }

    def number(self, value: Value) -> float:
        """Return a value of the design: what does not depend on assembly mode and position."""
        return float(self.values([value], [0.0])[value].flat[0])

    def meaning(self, name: str) -> str:
        """Return the words for the code of the design, such as its status."""
        code = int(self.number(name))
        return in_words(self.catalogue.public_fact(name).flags[code])

    def _evaluated(self, names: list[str], branch: Any, positions: Any) -> dict[str, Any]:
        given = {**self.design, self.input: positions[None, :]}
        of = {"branch": branch, "links": self.links, "input": self.input}
        return as_draw(lambda: dict(evaluate(self.mechanism, names, **of, **given)))

    def has(self, name: Value) -> bool:
        """Tell whether the design gives all inputs that a fact depends on."""
        if not isinstance(name, str) or name in (*self.design, self.input):
            return True
        if name not in self.catalogue.facts:
            return False
        of_links = self.links.values if self.links is not None else {}
        given = (*self.design, *of_links)
        variants = selected_variants(self.catalogue, self.links, "eliminated", self.design)
        return not missing_inputs(self.catalogue, name, variants, (*given, *self._defaults))

    @cached_property
    def _defaults(self) -> tuple[str, ...]:
        declared = self.catalogue.known_inputs(self.catalogue.variant_inputs).values()
        return tuple(one.name for one in declared if one.default is not None or one.choices)

    @cached_property
    def points(self) -> tuple[Point, ...]:
        """The points that the design determines; joints are never left out, so that what they lack is said."""
        needed = ("ground", "joint", "slider")
        return tuple(
            one for one in self.picture.points if one.kind in needed or (self.has(one.x) and self.has(one.y))
        )

    def places(self, positions: Any, points: Sequence[Point] | None = None) -> dict[str, Any]:
        """Return each point over assembly modes, positions, and x and y."""
        points = self.points if points is None else points
        values = self.values([value for one in points for value in (one.x, one.y)], positions)
        return {one.name: np.stack([values[one.x], values[one.y]], axis=-1) for one in points}

    def assembles(self, positions: Any) -> Any:
        """Tell for each assembly mode and position whether all joints and sliders have a place."""
        joints = [one for one in self.points if one.kind in ("joint", "slider")]
        places = self.places(positions, joints)
        return np.logical_and.reduce([np.isfinite(place).all(axis=-1) for place in places.values()])

    @cached_property
    def span(self) -> tuple[float, float]:
        """The ends of what is looked at: a turn, or what the picture says of the input."""
        if self.turns:
            return -np.pi, np.pi
        low, high = (self.number(end) for end in self.picture.spans.get(self.input, SPAN))
        return (-max(low, self.reach), max(high, self.reach)) if self.is_window else (-low, high)

    @property
    def is_window(self) -> bool:
        """Whether the ends of what is looked at are no limits of the input, which has no bounds."""
        ends = self.picture.spans.get(self.input, SPAN)
        return not self.turns and not any(isinstance(end, str) for end in ends)

    def range_texts(self, degrees: bool) -> list[str]:
        """Return the ranges in which the linkage assembles as texts, such as ``24° to 145°``."""
        found = []
        for low, high in self.ranges:
            first = "" if self.is_window and low == self.span[0] else self.shown(low, degrees)
            last = "" if self.is_window and high == self.span[1] else self.shown(high, degrees)
            found.append(
                f"{first} to {last}" if first and last else f"{first} on" if first else f"up to {last}"
            )
        return found

    @cached_property
    def _samples(self) -> Any:
        low, high = self.span
        step = (high - low) / SAMPLES
        return low + step * (np.arange(SAMPLES) + 0.5)

    @cached_property
    def ranges(self) -> tuple[tuple[float, float], ...]:
        """The ranges of the input in which an assembly mode exists; of a full turn, one of 2 pi."""
        low, high = self.span
        inner = self._samples
        samples = np.concatenate(([low], inner, [high]))
        inside = self.assembles(samples).any(axis=0)
        if inside.all() or not inside.any():
            return ((low, high),) if inside.any() else ()
        edges = np.flatnonzero(inside[1:] != inside[:-1])
        ends = self._ends(samples[edges], samples[edges + 1], inside[edges])
        bounds = ([low] if inside[0] else []) + list(ends) + ([high] if inside[-1] else [])
        found = list(zip(bounds[::2], bounds[1::2], strict=True))
        if self.turns and inside[0] and inside[-1]:  # one range about half a turn
            first, last = found[0], found[-1]
            found = [(last[0], first[1] + 2.0 * np.pi), *found[1:-1]]
        return tuple((float(a), float(b)) for a, b in found)

    def _ends(self, one: Any, other: Any, begins_inside: Any) -> Any:
        """Return where the linkage just assembles between neighbours of which it does at one alone."""
        if not one.size:
            return one
        good, bad = np.where(begins_inside, one, other), np.where(begins_inside, other, one)
        for _ in range(HALVINGS):
            middle = 0.5 * (good + bad)
            inside = self.assembles(middle).any(axis=0)
            good, bad = np.where(inside, middle, good), np.where(inside, bad, middle)
        return good

    @property
    def turns_fully(self) -> bool:
        """Whether the input turns fully."""
        return self.turns and self.ranges == (self.span,)

    def around(self, positions: Any) -> tuple[tuple[float, float], ...]:
        """Return the ranges in which some positions are, all where none is in any."""
        whole = 2.0 * np.pi if self.turns else np.inf
        inside = [
            one
            for one in self.ranges
            if (np.mod(np.asarray(positions) - one[0], whole) <= one[1] - one[0]).any()
        ]
        return tuple(inside) or self.ranges

    def along(self, number: int, positions: Any = None) -> list[Any]:
        """Return positions along each range, denser towards its ends, where the motion is fast.

        Given positions, along the ranges in which these are.
        """
        if self.turns_fully:
            return [np.linspace(*self.span, 2 * number)]
        share = 0.5 - 0.5 * np.cos(np.pi * np.linspace(0.0, 1.0, number))
        ranges = self.ranges if positions is None else self.around(positions)
        return [low + (high - low) * share for low, high in ranges]

    def spread(self, count: int, ends: bool = True) -> Any:
        """Return so many positions over the widest range, of a full turn without its end."""
        low, high = max(self.ranges, key=lambda one: one[1] - one[0])
        if self.turns_fully:
            return np.arange(count) * ((high - low) / count)
        return (
            np.linspace(low, high, count) if ends else low + (high - low) * (np.arange(count) + 0.5) / count
        )

    @property
    def usual(self) -> float:
        """The position of a picture unless one is given."""
        low, high = max(self.ranges, key=lambda one: one[1] - one[0])
        return USUAL * 2.0 * np.pi if self.turns_fully else low + 2.0 * USUAL * (high - low)

    def check(self, positions: Any, degrees: bool, key: str) -> None:
        """Refuse a design that never assembles, and positions at all of which it does not."""
        words = self.meaning("status") if "status" in self.catalogue.facts else ""
        if not self.ranges:
            what = f"the linkage does not assemble at any {self.input}{f' ({words})' if words else ''}"
            raise InputError(what, where=("draw",), remedy="draw another design")
        if positions is None or self.assembles(positions).any():
            return
        at = " and ".join(self.shown(one, degrees) for one in np.atleast_1d(positions)[:3])
        ranges = " or ".join(self.range_texts(degrees))
        what = f"the linkage does not assemble at {at}{f' ({words})' if words else ''}"
        raise InputError(what, where=("draw", key), remedy=f"write a position from {ranges}")

    def shown(self, position: float, degrees: bool, brief: bool = False) -> str:
        """Return a position as text."""
        if self.turns and degrees:
            return f"{short_number(round(float(np.degrees(position)), 3))}°"
        units = "" if self.catalogue.position.units == "1" else f" {self.catalogue.position.units}"
        return f"{position:.4g}{units}" if brief else f"{short_number(float(position))}{units}"


def as_draw(function: Callable[[], T], curve: int = 0) -> T:
    """Call a function whose problems are those of `fastlink.draw`, its quantities those of a curve.

    What it remarks on was said when the request was read.
    """
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", InputWarning)
            return function()
    except InputError as error:
        heads: dict[KeyPath, KeyPath] = {("evaluate",): ("draw",), ("quantities",): ("curves", curve)}
        problems = [
            replace(
                one,
                where=(*heads.get(one.where[:1], one.where[:1]), *_rest(one.where)),
                remedy=_without(one.remedy, "allow_invalid"),
            )
            for one in error.problems
        ]
        raise InputError.of(problems) from None


def _without(remedy: Remedy, option: str) -> Remedy:
    """Return a remedy without the part that names an option of another function."""
    if isinstance(remedy, str):
        return remedy

    def names_it(part: Any) -> bool:
        return isinstance(part, tuple) and any(isinstance(p, Setting) and p.name == option for p in part)

    return tuple(part for part in remedy if not names_it(part))


def _rest(where: KeyPath) -> KeyPath:
    """Return a path without its head, and without the number of a quantity."""
    return where[2:] if where[:1] == ("quantities",) else where[1:]
