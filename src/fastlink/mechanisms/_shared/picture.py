"""The words in which a mechanism declares its picture: joints, bars and curves, by the names of its facts.

A picture holds no formula: every number in it is a fact, an input or the input position, by its name, or a constant.
Points are named as in the papers; a text such as ``"A B P"`` names several.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal, TypeAlias

__all__ = ["Bar", "Circle", "Force", "Guide", "Locus", "Picture", "Point", "Torque", "joint"]

#: The name of a fact, an input or the input position, or a constant.
Value: TypeAlias = str | float


@dataclass(frozen=True)
class Point:
    """A point of a mechanism.

    Attributes
    ----------
    name : str
        Its letter, as in the papers.
    x, y : str or float
        Where it is.
    kind : str
        A moving ``"joint"``, a ``"ground"`` pivot, a ``"slider"``, a ``"traced"`` point of a link, a mere ``"mark"``.
    group : str
        The word of `fastlink.draw` that shows it; always shown without one.
    is_named : bool
        Whether its name is written.
    """

    name: str
    x: Value
    y: Value
    kind: Literal["joint", "ground", "slider", "traced", "mark"] = "joint"
    group: str = ""
    is_named: bool = True


def joint(name: str, kind: Literal["joint", "traced", "mark"] = "joint", **labels: Any) -> Point:
    """Return a point whose coordinates are the facts of its name."""
    return Point(name, f"{name}_x", f"{name}_y", kind, **labels)


@dataclass(frozen=True)
class Bar:
    """A link through some of the points.

    Attributes
    ----------
    points : str
        Their names; a link of three that are not in line is a plate.
    lengths : mapping of str to str
        The facts that are distances of two of its points, but for a sign.
    is_ground : bool
        Whether it is the frame.
    orientation : str
        The fact that tells a future-pointing bar, 1, from a past-pointing one, -1.
    """

    points: str
    lengths: Mapping[str, str]
    is_ground: bool = False
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
    """A curve that a function of fastlink gives for a position of the mechanism.

    Attributes
    ----------
    group : str
        The word of `fastlink.draw` that shows it.
    function : str
        Its public name, such as ``"focal.cubic_points"``; it takes inputs and the input position by their names.
    gives : str
        ``"points"`` (x, y), the ``"equation"`` by the coefficients of x^i y^j, or a ``"conic"`` with its axes and foci.
    meaning : str
        Words for the legend.
    by : str
        The input that has to drive, where the function takes its position; an empty text where it takes none.
    given : mapping of str to str
        The facts that are further arguments.
    """

    group: str
    function: str
    gives: Literal["points", "equation", "conic"]
    meaning: str
    by: str = ""
    given: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Picture:
    """All that is drawn of a mechanism.

    Attributes
    ----------
    points, bars, circles, guides, forces, torques, loci : tuple
        See there.
    traced : mapping of str to str
        The points whose paths are drawn, by the word that shows them.
    metric : str
        What makes a circle of the plane, ``"euclidean"`` or ``"minkowskian"``.
    usual : str
        The words of `fastlink.draw` that hold unless others are given.
    spans : mapping of str to tuple
        Of an input that has no turn, the ends of what is drawn: facts or numbers, the first with its sign changed.
    """

    points: tuple[Point, ...]
    bars: tuple[Bar, ...]
    circles: tuple[Circle, ...] = ()
    guides: tuple[Guide, ...] = ()
    forces: tuple[Force, ...] = ()
    torques: tuple[Torque, ...] = ()
    loci: tuple[Locus, ...] = ()
    traced: Mapping[str, str] = field(default_factory=dict)
    metric: Literal["euclidean", "minkowskian"] = "euclidean"
    usual: str = "path limits"
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
