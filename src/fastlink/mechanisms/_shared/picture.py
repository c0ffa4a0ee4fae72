"""The words in which a mechanism declares its picture: joints, bars and curves, by the names of its facts.

A picture holds no formula: every number in it is a fact, an input or the input position, by its name, or a constant.
Points are named as in the papers; a text such as ``"A B P"`` names several.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal, TypeAlias

#: The name of a fact, an input or the input position, or a constant.
Value: TypeAlias = str | float


@dataclass(frozen=True)
class Point:
    """A point of a mechanism."""

    #: Its letter, as in the papers.
    name: str
    #: Where it is.
    x: Value
    y: Value
    #: A moving ``"joint"``, a ``"ground"`` pivot, a ``"slider"``, a ``"traced"`` point of a link, a mere ``"mark"``.
    kind: Literal["joint", "ground", "slider", "traced", "mark"] = "joint"
    #: The word of `fastlink.draw` that shows it; always shown without one.
    group: str = ""
    #: Whether its name is written.
    is_named: bool = True


def joint(name: str, kind: Literal["joint", "traced", "mark"] = "joint", **labels: Any) -> Point:
    """Return a point whose coordinates are the facts of its name."""
    return Point(name, f"{name}_x", f"{name}_y", kind, **labels)


@dataclass(frozen=True)
class Bar:
    """A link through some of the points."""

    #: Their names; a link of three that are not in line is a plate.
    points: str
    #: The facts that are distances of two of its points, but for a sign.
    lengths: Mapping[str, str]
    #: Whether it is the frame.
    is_ground: bool = False
    #: The fact that tells a future-pointing bar, 1, from a past-pointing one, -1.
    orientation: str = ""


@dataclass(frozen=True)
class Circle:
    """A circle of the plane, about a point."""

    centre: str
    radius: Value
    group: str = "circles"


@dataclass(frozen=True)
class Guide:
    """A straight line along one of the axes; a slider runs on it, or a point only happens to."""

    x: Value | None = None
    y: Value | None = None
    slider: str = ""
    group: str = ""


@dataclass(frozen=True)
class Force:
    """A force at a point, by its two components."""

    name: str
    at: str

    @property
    def components(self) -> tuple[str, ...]:
        """The facts that are its components."""
        return f"{self.name}_x", f"{self.name}_y"


@dataclass(frozen=True)
class Torque:
    """A torque of the ground on a link, at a point; counterclockwise where it is positive."""

    name: str
    at: str

    @property
    def components(self) -> tuple[str, ...]:
        """The fact that it is."""
        return (self.name,)


@dataclass(frozen=True)
class Locus:
    """A curve that a function of fastlink gives for a position of the mechanism."""

    #: The word of `fastlink.draw` that shows it.
    group: str
    #: Its public name, such as ``"focal.cubic_points"``; it takes inputs and the input position by their names.
    function: str
    #: ``"points"`` (x, y), the ``"equation"`` by the coefficients of x^i y^j, or a ``"conic"`` with its axes and
    # foci.
    gives: Literal["points", "equation", "conic"]
    #: Words for the legend.
    meaning: str
    #: The input that has to drive, where the function takes its position; an empty text where it takes none.
    by: str = ""
    #: The facts that are further arguments.
    given: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Picture:
    """All that is drawn of a mechanism."""

    points: tuple[Point, ...]
    bars: tuple[Bar, ...]
    circles: tuple[Circle, ...] = ()
    guides: tuple[Guide, ...] = ()
    forces: tuple[Force, ...] = ()
    torques: tuple[Torque, ...] = ()
    loci: tuple[Locus, ...] = ()
    #: The points whose paths are drawn, by the word that shows them.
    traced: Mapping[str, str] = field(default_factory=dict)
    #: What makes a circle of the plane, ``"euclidean"`` or ``"minkowskian"``.
    metric: Literal["euclidean", "minkowskian"] = "euclidean"
    #: The words of `fastlink.draw` that hold unless others are given.
    usual: str = "path limits"
    #: What it says above of a design, by facts in braces; a part between commas that lacks a value is left out.
    title: str = ""
    #: Of an input that has no turn, the ends of what is drawn: facts or numbers, the first with its sign changed.
    spans: Mapping[str, tuple[Value, Value]] = field(default_factory=dict)

    def point(self, name: str) -> Point:
        """Return a point by its name."""
        return next(one for one in self.points if one.name == name)

    @property
    def loads(self) -> dict[str, tuple[Force | Torque, ...]]:
        """The loads that are drawn as arrows, by the words that show them."""
        return {"forces": self.forces, "torques": self.torques}

    @property
    def words(self) -> tuple[str, ...]:
        """The words of what can be shown besides the linkage."""
        parts: tuple[Point | Circle | Guide | Locus, ...]
        parts = (*self.points, *self.circles, *self.guides, *self.loci)
        groups = [one.group for one in parts]
        own = {*filter(None, groups), "limits"}
        own |= {*self.traced, "circuits", "comb"} if self.traced else set()
        own |= {kind for kind, loads in self.loads.items() if loads}
        own |= {"cone"} if self.metric == "minkowskian" else set()
        return tuple(sorted(own))
