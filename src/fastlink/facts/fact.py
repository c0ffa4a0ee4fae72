"""Inputs, facts and linear systems.

A *fact* states one physical statement for one design at one input position: a formula, and what it depends on.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import reduce
from typing import Any, Literal

from fastlink.facts.formula import Formula

Rule = Literal["positive", "non-negative", "any"]


class Labelled:
    """What has a meaning: a title, and perhaps a remark behind a semicolon."""

    meaning: str

    @property
    def title(self) -> str:
        """The title of a picture of it."""
        return self.meaning.partition("; ")[0]

    @property
    def remark(self) -> str:
        """How it is meant, and where it has no value; empty where the title says all."""
        return self.meaning.partition("; ")[2]


@dataclass(frozen=True)
class Input(Labelled):
    """A number that the user gives for each design; optional if it has a default.

    An input with `choices` is a code; where it is left out, every choice of each design is evaluated.
    """

    name: str
    units: str
    symbol: str
    meaning: str
    rule: Rule = "any"
    default: float | None = None
    choices: Mapping[int, str] = field(default_factory=dict, hash=False)

    def allows(self, value: Any) -> Any:
        """Tell whether it may have a value; for an array, each of its values."""
        finite = abs(value) < math.inf
        if self.choices:
            return finite & reduce(operator.or_, (value == code for code in self.choices))
        if self.rule == "positive":
            return finite & (value > 0)
        return finite & (value >= 0) if self.rule == "non-negative" else finite


@dataclass(frozen=True)
class Fact(Labelled):
    """One physical statement, with its labels in files and documentation.

    The formula of a fact with a `low` part returns an unevaluated sum of two doubles, which are two values: that of
    the fact's own name, and its low part. One that is `own` was declared by a user, see `fastlink.own`.
    """

    name: str
    formula: Formula
    depends_on: tuple[str, ...]
    units: str
    symbol: str
    meaning: str
    source: str
    internal: bool = False
    flags: Mapping[int, str] = field(default_factory=dict)
    low: str | None = None
    own: bool = False

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the values that it determines: its own, and that of its low part."""
        return (self.name,) if self.low is None else (self.name, self.low)

    def values(self, known: Mapping[str, Any]) -> dict[str, Any]:
        """Evaluate the fact on known values."""
        value = self.formula(*(known[name] for name in self.depends_on))
        return {self.name: value} if self.low is None else dict(zip(self.names, value, strict=True))

    def renamed(self, rename: Callable[[str], str]) -> Fact:
        """Return the fact under other names."""
        low = None if self.low is None else rename(self.low)
        return replace(self, name=rename(self.name), low=low, depends_on=tuple(map(rename, self.depends_on)))


@dataclass(frozen=True)
class System:
    """A linear system; `formula` returns its rows with the right-hand sides last."""

    name: str
    unknowns: tuple[str, ...]
    formula: Formula
    depends_on: tuple[str, ...]

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the values that it determines."""
        return self.unknowns


@dataclass(frozen=True)
class Loops:
    """Equations between quantities that hold wherever a mechanism closes, by which its values are verified.

    Attributes
    ----------
    unknowns : tuple of str
        The quantities that they determine.
    formula : Formula
        What vanishes, as many as unknowns.
    rates : mapping of str to (str, str, int)
        For a quantity the unknown whose derivative by time it is, the speed of the drive, and the order.
    """

    unknowns: tuple[str, ...]
    formula: Formula
    rates: Mapping[str, tuple[str, str, int]]


@dataclass(frozen=True)
class KnownExtremes:
    """Where the extremes of a quantity are in every design, besides the limits of motion.

    Each place is a fact of the design: the root of the ratio of its distances from the lower and the upper end of the
    graded range, on the side where the input position grows with the first of them; NaN where there is none.

    Attributes
    ----------
    places : mapping of int to tuple of str
        By branch, the places where the quantity is greatest or least. Without any, it goes one way all the way from
        one end to the other, and both ends count.
    jumps : mapping of int to tuple of str
        By branch, the places where an angle passes pi.
    exchanged : bool
        Whether the other side has them in the other branch, as the mirror exchanges both; else in the same one.
    """

    places: Mapping[int, tuple[str, ...]] = field(default_factory=dict)
    jumps: Mapping[int, tuple[str, ...]] = field(default_factory=dict)
    exchanged: bool = True

    @property
    def facts(self) -> tuple[str, ...]:
        """All facts of places."""
        return tuple(name for of in (self.places, self.jumps) for names in of.values() for name in names)

    def renamed(self, rename: Callable[[str], str]) -> KnownExtremes:
        """Return the same with facts under other names."""
        places, jumps = (
            {branch: tuple(map(rename, names)) for branch, names in of.items()}
            for of in (self.places, self.jumps)
        )
        return replace(self, places=places, jumps=jumps)


#: What may be at a breakpoint: an angle passes from pi to -pi (wrap), or the quantity has another value on both sides
#: (jump), infinity between them (pole); an arc ends; one smooth quantity turns into another (kink), or such a one is
#: extreme (piece); another search has one of these, where its cells are split.
Breaking = Literal["wrap", "jump", "pole", "end", "kink", "piece", "split"]


@dataclass(frozen=True)
class Breakpoint:
    """Places where a quantity or its slope is not smooth, which may be greatest or least there without a slope of 0."""

    kind: Breaking
    #: The value that vanishes there: of a piece the slope of it, else the fact itself.
    zero: str
    of: str


#: What is given of a piece of the range: where it begins, how long it is, how far off its limits may be; of both ends
#: which gap limits it (from 1 on, 0 for none), two terms of the power series of that in the distance, the error of the
#: first, within what distance they stand for it; and how samples are graded, see `GradedRange.ends`.
PIECE_ENDS = tuple(
    tuple(
        f"piece_{name}_{end}" for name in ("by", "slope", "bend", "off", "near", "scale", "start", "toggle")
    )
    for end in ("low", "high")
)
PIECE = ("piece_low", "piece_width", "piece_off", *PIECE_ENDS[0], *PIECE_ENDS[1])
#: The errors of what is given of a piece.
PIECE_ERRORS = {"piece_low": "piece_off", "piece_width": "piece_off"} | {
    names[1]: names[3] for names in PIECE_ENDS
}


def ranges_of(position: str) -> dict[str, int]:
    """Return the facts of the ranges between limits through which a mechanism with gaps moves, each with its row."""
    return {f"{position}_{name}": row for row, name in enumerate(("low", "high", "low_by", "high_by"))}


def root_of_gap(gap: str) -> str:
    """Return the name of the root of a gap."""
    return f"{gap}_root"


def slope_of_gap(gap: str) -> str:
    """Return the name of the fact whose extremes are searched at the zeros of a gap, whose slope it is there."""
    return f"{gap}_slope"


@dataclass(frozen=True, kw_only=True)
class GradedRange:
    """The range in which extremes are searched, dense where curves are steep.

    Attributes
    ----------
    name : str
        The variant that gives the input position from coordinates in the range.
    ends : tuple of (scale, start, toggle)
        For the lower and the upper end the facts of the design that grade the samples: with rho the ratio of the
        distances to both ends, samples stand at ``sqrt(rho) = scale sinh(j h)``, the first one at ``start``;
        ``toggle`` is 1 where the branches meet there.
    coordinates : tuple of str
        The coordinates of a place: its distances from both ends over the width, and the side of the ground line: 1
        where the input position grows with the distance from the lower end, -1 where it falls.
    antisymmetric : tuple of str
        The values that change sign in the mirror that exchanges the sides and the branches.
    vanishes_at_toggle, reciprocal, bounded_factor : str
        A fact that vanishes at toggles like the root of the distance, its reciprocal, and a fact in proportion to it
        that is 1 at most.
    vanish_at_one_end : tuple of str
        The values whose product is in proportion to its square, each of which vanishes at one of both toggles.
    cells, max_extrema : mapping of str to int
        For some quantities half the number of cells that find every extreme, a power of two, and how many
        extremes there are at most; `cells_otherwise` and `max_extrema_otherwise` for all others.
    not_differentiable : tuple of str
        The quantities that are not described by a derivative: residuals, and quantities with poles.
    wraps_at : mapping of str to str
        For an angle the fact that vanishes where the angle passes pi, and where it passes 0.
    windings : mapping of str to mapping of str to float
        For a quantity made of angles as numbers, by how many turns it changes where each of these goes through one: it
        jumps where they do. NaN where it jumps by something else.
    divisors : mapping of str to (str, int)
        For a quantity the fact that it is divided by and that may come close to zero anywhere in the range, never
        negative, and the power of it by which its derivative is divided.
    poles : mapping of str to tuple of str
        For a quantity the facts that it is divided by, which vanish where it may pass infinity.
    kinks : mapping of str to (tuple of str, tuple of str)
        For a quantity that chooses between smooth ones the facts that vanish where it does, and the smooth ones.
    turns : mapping of str to str
        For a fact whose derivative has kinks the fact that vanishes there.
    axis : float
        The input position that the mirror leaves: it exchanges `axis` + x and `axis` - x.
    known : mapping of str to KnownExtremes
        The quantities whose extremes are known in closed form, and are not searched.
    gaps : tuple of str, optional
        Of a mechanism whose loops close one after the other the facts that are not negative where they do, each
        defined where those before are not negative. They cut the turn into pieces, each of which is a range.
    """

    name: str = "graded"
    ends: tuple[tuple[str, str, str], tuple[str, str, str]] = (
        ("scale_low", "start_low", "toggle_low"),
        ("scale_high", "start_high", "toggle_high"),
    )
    coordinates: tuple[str, str, str] = ("from_low", "from_high", "side")
    antisymmetric: tuple[str, ...] = ("side", "branch_sign")
    vanishes_at_toggle: str = "sigma"
    reciprocal: str = "per_sigma"
    bounded_factor: str
    vanish_at_one_end: tuple[str, ...] = ("p", "q")
    cells: Mapping[str, int] = field(default_factory=dict)
    max_extrema: Mapping[str, int] = field(default_factory=dict)
    not_differentiable: tuple[str, ...] = ()
    wraps_at: Mapping[str, str] = field(default_factory=dict)
    divisors: Mapping[str, tuple[str, int]] = field(default_factory=dict)
    cells_otherwise: int = 32
    max_extrema_otherwise: int = 16
    axis: float = 0.0
    known: Mapping[str, KnownExtremes] = field(default_factory=dict)
    kinks: Mapping[str, tuple[tuple[str, ...], tuple[str, ...]]] = field(default_factory=dict)
    turns: Mapping[str, str] = field(default_factory=dict)
    windings: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    poles: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    gaps: tuple[str, ...] | None = None

    @property
    def given(self) -> tuple[str, ...]:
        """The values of a place that are given: its coordinates, and where there are gaps those of its piece."""
        return self.coordinates if self.gaps is None else (*self.coordinates, *PIECE)

    @property
    def vanishing(self) -> tuple[str, ...]:
        """The facts that vanish at limits of motion like the root of the distance."""
        return (self.vanishes_at_toggle,) if self.gaps is None else tuple(map(root_of_gap, self.gaps))

    def breakpoints(self, quantity: str, *kinds: Breaking) -> list[Breakpoint]:
        """Return the places where a quantity is not smooth, those of some kinds."""
        zeros: dict[Breaking, Iterable[str]] = {
            "kink": self.kinks.get(quantity, ((), ()))[0],
            "wrap": [self.wraps_at[quantity]] if quantity in self.wraps_at else (),
            "jump": (self.wraps_at[angle] for angle in self.windings.get(quantity, ())),
            "pole": self.poles.get(quantity, ()),
        }
        return [Breakpoint(kind, zero, zero) for kind in kinds for zero in zeros[kind]]
