"""Positions of the points of one design, the planes in which they stand, and places for names."""

from __future__ import annotations

import itertools
import re
import warnings
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from importlib import import_module
from inspect import Parameter, signature
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from fastlink._text import in_words, short_number
from fastlink.engine.evaluate import evaluate
from fastlink.errors import InputError, InputWarning, KeyPath, Setting
from fastlink.pictures.labels import mathematical
from fastlink.plan.request import missing_inputs, selected_variants
from fastlink.space.units import RADIANS

if TYPE_CHECKING:
    from fastlink.engine.extend import Extension
    from fastlink.facts.catalogue import Catalogue
    from fastlink.facts.fact import Input
    from fastlink.mechanisms._shared.picture import Locus, Picture, Point, Value
    from fastlink.space.design_space import Links


# -- Positions of the points of one design, by the facts of its mechanism, and the range in which it
#    assembles


T = TypeVar("T")
#: Positions at which it is looked whether a linkage assembles; halvings of the step where that ends; along a path.
SAMPLES, HALVINGS, ALONG = 720, 44, 361
#: Where nothing is said about the ends of an input that does not turn.
SPAN = (1.0, 1.0)
#: The share of its range at which a linkage stands unless a position is given.
USUAL = 1.0 / 6.0


@dataclass(frozen=True, eq=False)
class Motion:
    """One design that moves."""

    #: Its name.
    mechanism: str | Extension
    #: The mechanism, as driven by the input.
    catalogue: Catalogue
    #: Its points.
    picture: Picture
    #: Its inputs.
    design: dict[str, float]
    #: The branches.
    branches: tuple[int, ...]
    #: Where mass data come from.
    links: Links | None
    #: Of an input without bounds, how far what is looked at reaches at least, to both sides.
    reach: float = 0.0

    @property
    def input(self) -> str:
        """The name of the input."""
        return self.catalogue.position.name

    @property
    def symbol(self) -> str:
        """The symbol of the input."""
        return mathematical(self.catalogue.position.symbol)

    @property
    def turns(self) -> bool:
        """Whether the input turns, so that its range is a circle."""
        return self.catalogue.position.units == RADIANS

    def values(self, names: Iterable[Value], positions: Any) -> dict[Value, Any]:
        """Return facts, inputs and constants, each over branches and positions."""
        positions = np.atleast_1d(np.asarray(positions, dtype=float))
        shape = (len(self.branches), positions.size)
        every = self.catalogue.inputs.values()
        by_default = {one.name: one.default for one in every if one.default is not None and not one.choices}
        known: dict[Any, Any] = {**by_default, **self.design, self.input: positions}
        facts = [name for name in dict.fromkeys(names) if isinstance(name, str) and name not in known]
        if facts:
            known |= self._evaluated(facts, np.array(self.branches)[:, None], positions)
        return {
            name: np.broadcast_to(known[name] if isinstance(name, str) else float(name), shape)
            for name in names
        }

    def number(self, value: Value) -> float:
        """Return a value of the design: what does not depend on branch and position."""
        return float(self.values([value], [0.0])[value].flat[0])

    @property
    def title(self) -> str:
        """What tells this design from others: its class, and how far its output goes."""
        parts = []
        for part in self.picture.title.split(", "):
            told = {name: self._told(name) for name in re.findall(r"\{(\w+)\}", part)}
            parts += [part.format(**told)] if part and all(told.values()) else []
        text = ", ".join(parts) or self.catalogue.title
        return text[0].upper() + text[1:]

    def _told(self, name: str) -> str:
        """Return a number of the design, or the words of a code, as a title has it; nothing of what it lacks."""
        if not self.has(name):
            return ""
        fact = self.catalogue.public_fact(name)
        if fact.flags:
            return self.meaning(name).replace("crank rocker", "crank-rocker")
        value = self.number(name)
        is_whole_turn = fact.units == RADIANS and value > 2.0 * np.pi - 1e-9
        if not np.isfinite(value) or is_whole_turn:
            return ""
        return f"{np.degrees(value):.3g}°" if fact.units == RADIANS else f"{value:.3g} {fact.units}"

    @property
    def looks(self) -> tuple[int, ...]:
        """The branches in whose colours and dashes curves are drawn: of one alone those of the first."""
        return self.branches if len(self.branches) > 1 else (1,)

    def meaning(self, name: str) -> str:
        """Return the words for the code of the design, such as its status."""
        code = int(self.number(name))
        graded = self.catalogue.graded
        if graded is not None and graded.gaps is not None and not code:  # of one position; the turn tells
            turn = np.linspace(0.0, 2.0 * np.pi, 721)
            codes = self._evaluated([name], np.array(self.branches)[:1, None], turn)[name]
            code = int(bool(np.any(codes)))
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
        inputs = self.known_inputs.values()
        defaults = [one.name for one in inputs if one.default is not None or one.choices]
        return not missing_inputs(self.catalogue, name, self.variants, (*self.design, *of_links, *defaults))

    def lacks(self, locus: Locus) -> list[str]:
        """Return what the function of a locus takes and the design does not give."""
        given = {*self.design, self.input, *locus.given, "branch"}
        taken = parameters_of(locus).values()
        return [one.name for one in taken if one.default is one.empty and one.name not in given]

    @cached_property
    def variants(self) -> tuple[str, ...]:
        """The variants of facts that the design selects."""
        return selected_variants(self.catalogue, self.links, "eliminated", self.design)

    @cached_property
    def known_inputs(self) -> dict[str, Input]:
        """The inputs that a design may give."""
        return self.catalogue.known_inputs(self.catalogue.variant_inputs)

    @cached_property
    def points(self) -> tuple[Point, ...]:
        """The points that the design determines; joints are never left out, so that what they lack is said."""
        needed = ("ground", "joint", "slider")
        return tuple(
            one for one in self.picture.points if one.kind in needed or (self.has(one.x) and self.has(one.y))
        )

    def traced(self, words: Iterable[str]) -> list[Point]:
        """Return the points whose paths some words show."""
        names = {name for word in words for name in self.picture.traced.get(word, "").split()}
        return [one for one in self.points if one.name in names]

    def vectors(self, components: Mapping[str, Sequence[Value]], positions: Any) -> dict[str, Any]:
        """Return vectors by their names, each over branches, positions, and its components."""
        values = self.values([value for one in components.values() for value in one], positions)
        return {name: np.stack([values[key] for key in one], axis=-1) for name, one in components.items()}

    def places(self, positions: Any, points: Sequence[Point] | None = None) -> dict[str, Any]:
        """Return each point over branches, positions, and x and y."""
        points = self.points if points is None else points
        return self.vectors({one.name: (one.x, one.y) for one in points}, positions)

    def place(self, name: str, positions: Any) -> Any:
        """Return one point by its name, over branches, positions, and x and y."""
        return self.places(positions, [self.picture.point(name)])[name]

    def places_at(self, position: float, points: Sequence[Point]) -> dict[str, Any]:
        """Return each point at one position, over branches, and x and y."""
        return {name: place[:, 0] for name, place in self.places([position], points).items()}

    def assembles(self, positions: Any) -> Any:
        """Tell for each branch and position whether all joints and sliders have a place."""
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
    def ranges(self) -> tuple[tuple[float, float], ...]:
        """The ranges of the input in which a branch exists; of a full turn, one of 2 pi."""
        low, high = self.span
        inner = low + (high - low) / SAMPLES * (np.arange(SAMPLES) + 0.5)
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

    @property
    def widest(self) -> tuple[float, float]:
        """The widest of these ranges."""
        return max(self.ranges, key=lambda one: one[1] - one[0])

    def _ends(self, one: Any, other: Any, begins_inside: Any) -> Any:
        """Return where the linkage just assembles between neighbours of which it does at one alone."""
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
        low, high = self.widest
        if self.turns_fully:
            return np.arange(count) * ((high - low) / count)
        if ends:
            return np.linspace(low, high, count)
        return low + (high - low) * (np.arange(count) + 0.5) / count

    @property
    def usual(self) -> float:
        """The position of a picture unless one is given."""
        low, high = self.widest
        return USUAL * 2.0 * np.pi if self.turns_fully else low + 2.0 * USUAL * (high - low)

    def check(self, positions: Any, degrees: bool, key: str) -> None:
        """Refuse a design that never assembles, and positions at all of which it does not."""
        why = f" ({self.meaning('status')})" if "status" in self.catalogue.facts else ""
        if not self.ranges:
            what = f"the linkage does not assemble at any {self.input}{why}"
            raise InputError(what, where=("draw",), remedy="draw another design")
        if positions is None or self.assembles(positions).any():
            return
        at = " and ".join(self.shown(one, degrees) for one in np.atleast_1d(positions)[:3])
        ranges = " or ".join(self.range_texts(degrees))
        what = f"the linkage does not assemble at {at}{why}"
        raise InputError(what, where=("draw", key), remedy=f"write a position from {ranges}")

    def shown(self, position: float, degrees: bool, brief: bool = False) -> str:
        """Return a position as text."""
        if self.turns and degrees:
            angle = float(np.degrees(position))
            return f"{angle:.4g}°" if brief else f"{short_number(round(angle, 3))}°"
        units = "" if self.catalogue.position.units == "1" else f" {self.catalogue.position.units}"
        return f"{position:.4g}{units}" if brief else f"{short_number(float(position))}{units}"

    def stated(self, position: float, degrees: bool, brief: bool = False) -> str:
        """Return the input and a position as text."""
        return f"{self.symbol} = {self.shown(position, degrees, brief)}"


def function_of(locus: Locus) -> Callable[..., Any]:
    """Return the function of fastlink that gives a curve."""
    package, name = locus.function.split(".")
    found: Callable[..., Any] = getattr(import_module(f"fastlink.{package}"), name)
    return found


def parameters_of(locus: Locus) -> Mapping[str, Parameter]:
    """Return what the function of a curve takes."""
    return signature(function_of(locus)).parameters


#: An option of the evaluation that drawing lacks.
ALLOW = Setting("allow_invalid", True)


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
        problems = []
        for one in error.problems:
            head, rest = one.where[:1], one.where[2 if one.where[:1] == ("quantities",) else 1 :]
            where = (*heads.get(head, head), *rest)
            remedy = one.remedy
            if not isinstance(remedy, str):
                remedy = tuple(part for part in remedy if not isinstance(part, tuple) or ALLOW not in part)
            problems.append(replace(one, where=where, remedy=remedy))
        raise InputError.of(problems) from None


# -- The planes in which mechanisms stand: their circles, and the light cones of the Minkowskian one


#: Points along a circle, or an arm of one.
CIRCLE_POINTS = 181
#: The greatest rapidity that a picture shows of a circle.
REACH = 4.0


class Euclidean:
    """The plane of the usual metric."""

    def circle(self, centre: Any, radius: float, view: Any) -> list[tuple[Any, bool]]:
        """Return the arms of a circle, as far as a view shows them, and whether each is the usual one."""
        size = float(np.hypot(view[1] - view[0], view[3] - view[2]))
        turn = np.linspace(0.0, 2.0 * np.pi, CIRCLE_POINTS)
        if radius > size:  # of a great circle, only what is near the view
            middle = np.array([view[0] + view[1], view[2] + view[3]]) / 2.0 - centre
            turn = (
                np.arctan2(middle[1], middle[0]) + np.linspace(-1.0, 1.0, CIRCLE_POINTS) * 2.0 * size / radius
            )
        return [(centre + radius * np.stack([np.cos(turn), np.sin(turn)], axis=-1), True)]

    def curvature(self, slope: Any, bend: Any) -> Any:
        """Return the vector of curvature of a curve by its first two derivatives: along the normal."""
        across = np.stack([-slope[..., 1], slope[..., 0]], axis=-1)
        size = np.hypot(slope[..., 0], slope[..., 1])
        return ((across * bend).sum(axis=-1) / size**4)[..., None] * across


class Minkowskian:
    """The plane of the metric x^2 - y^2."""

    def circle(self, centre: Any, radius: float, view: Any) -> list[tuple[Any, bool]]:
        """Return the two arms of a hyperbola, of future-pointing vectors and of past-pointing ones."""
        t = np.linspace(-REACH, REACH, CIRCLE_POINTS)
        arm = radius * np.stack([np.cosh(t), np.sinh(t)], axis=-1)
        return [(centre + arm, True), (centre - arm, False)]

    def curvature(self, slope: Any, bend: Any) -> Any:
        """Return the vector of curvature: along the line that is normal in the sense of the metric."""
        x, y = slope[..., 0], slope[..., 1]
        turn, norm = x * bend[..., 1] - y * bend[..., 0], (x - y) * (x + y)
        return (turn / (norm * np.abs(norm)))[..., None] * slope[..., ::-1]


PLANES: dict[str, Euclidean | Minkowskian] = {"euclidean": Euclidean(), "minkowskian": Minkowskian()}


# -- Find places for names where they cover nothing: among a few round each point, the freest


#: In points: the size of a letter, the distance of a name from its point, the step along what must not be covered.
LETTER, HEIGHT, AWAY, STEP = 5.6, 12.0, 12.0, 3.0
ROUND = np.pi / 8.0 * np.arange(16)
#: Where a name stands best if all places are free: above to the right.
BEST, PREFERENCE, STAY = np.pi / 4.0, 0.15, 0.6
#: The last in a film, where names that jump cannot be read.
STAY_IN_FILM = 6.0
#: How much farther away a name may stand where that is free, and what it costs.
FURTHER, FARTHER = 6.0, 3.0
NEAR, OUTSIDE = 1.7, 6.0


def finite_of(places: Iterable[Any]) -> Any:
    """Return those places of some arrays that are finite, one below the other."""
    every = np.concatenate([np.asarray(one, dtype=float).reshape(-1, 2) for one in places])
    return every[np.isfinite(every).all(axis=1)]


def samples_of(line: Any, scale: float) -> Any:
    """Return points along a broken line, close to each other in the picture; `scale` is points per unit."""
    line = finite_of([line])
    pieces = [line]
    for start, end in itertools.pairwise(line):
        count = min(400, int(np.hypot(*(end - start)) * scale / STEP))
        if count > 1:
            share = np.linspace(0.0, 1.0, count)[:, None]
            pieces.append(start + share * (end - start))
    return np.concatenate(pieces)


class Names:
    """The names of one picture, placed one after the other."""

    def __init__(self, scale: float, view: Any, in_film: bool) -> None:
        self.scale, self.view = scale, np.asarray(view, dtype=float)
        self.last: dict[str, int] = {}
        #: What it costs to stand elsewhere than in the picture before.
        self.stay = STAY_IN_FILM if in_film else STAY
        self.cloud, self.weights = np.empty((0, 2)), np.empty(0)
        self.still = 0

    def rest(self) -> None:
        """Keep what must not be covered so far for good."""
        self.still = len(self.cloud)

    def clear(self) -> None:
        """Forget what moves and must not be covered, but not where names stood, so that they move little."""
        self.cloud, self.weights = self.cloud[: self.still], self.weights[: self.still]

    def keep_free(self, points: Any, weight: float = 1.0) -> None:
        """Add points that names should not cover."""
        points = finite_of([points])
        self.cloud = np.concatenate([self.cloud, points])
        self.weights = np.concatenate([self.weights, np.full(len(points), weight)])

    def place(self, key: str, text: str, anchor: Any, away: float = AWAY) -> Any:
        """Return where the middle of a name stands that belongs to a point."""
        wide = 0.5 * LETTER * len(text)
        rounds = [
            np.stack([(one + wide - LETTER) * np.cos(ROUND), one * np.sin(ROUND)], axis=-1)
            for one in (away, away + FURTHER)
        ]
        farther = np.repeat([0.0, FARTHER], len(ROUND))
        middles = np.asarray(anchor) + np.concatenate(rounds) / self.scale
        return self._best(key, wide, middles, np.tile(ROUND, 2), farther)

    def beside(self, key: str, text: str, start: Any, end: Any) -> Any:
        """Return where the middle of a name stands that belongs to a bar."""
        start, end = np.asarray(start), np.asarray(end)
        along = end - start
        length = float(np.hypot(*along)) or 1.0
        normal = np.array([-along[1], along[0]]) / length
        wide = 0.5 * LETTER * len(text)
        off = AWAY + max(0.0, wide - LETTER) * abs(normal[0])
        shares = np.array([0.5, 0.5, 0.38, 0.38, 0.62, 0.62])
        sides = np.array([1.0, -1.0] * 3)
        middles = start + shares[:, None] * along + (sides * off / self.scale)[:, None] * normal
        return self._best(key, wide, middles, BEST + 0.3 * np.arange(6))

    def _best(self, key: str, wide: float, middles: Any, angles: Any, farther: Any = 0.0) -> Any:
        """Return the freest of some places, and keep it free from now on."""
        half = np.array([wide + 2.0, 0.5 * HEIGHT + 1.0]) / self.scale
        cost = PREFERENCE * (1.0 - np.cos(angles - BEST)) + farther
        if key in self.last:
            cost += self.stay * (np.arange(len(middles)) != self.last[key])
        if len(self.cloud):
            gaps = np.abs(self.cloud[None] - middles[:, None]) / half
            cost = cost + np.maximum(0.0, NEAR - gaps.max(axis=-1)) ** 2 @ self.weights
        low, high = self.view[::2], self.view[1::2]
        beyond = (middles - half < low) | (middles + half > high)
        cost = cost + OUTSIDE * beyond.any(axis=1)
        chosen = int(np.argmin(cost))
        self.last[key] = chosen
        box = np.stack(np.meshgrid(np.linspace(-1, 1, 7), np.linspace(-1, 1, 3)), axis=-1).reshape(-1, 2)
        self.keep_free(middles[chosen] + box * half, 2.0)
        return middles[chosen]
