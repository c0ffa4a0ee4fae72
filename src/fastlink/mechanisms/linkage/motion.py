"""Linkages that a user declares by their joints: a crank, then dyads, each of which a closed form places.

A declaration becomes a sheet of formulas (`fastlink.facts.sheet`), from which all else follows as for any mechanism.
With A and D the outer joints of a dyad of two bars, B the inner one, J the quarter turn to the left, s = 1 or -1 the
way to assemble it and T the area of the triangle ADB,

    AB = (AD (|AD|^2 + AB^2 - DB^2) + s J AD 4 T)/(2 |AD|^2),    16 T^2 = ((AB + DB)^2 - |AD|^2)(|AD|^2 - (AB - DB)^2).

Angular velocities over that of the crank follow from A' + n_AB J AB = D' + n_DB J DB, multiplied by DB and by AB, with
AB x DB = s 2 T. A pin on a line, a slot about a pin and two lines are placed and moved alike.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import cache
from string import Template
from typing import Any, Literal

from fastlink._text import short_repr
from fastlink.errors import InputError, KeyPath, Problems, check_choice, remark, suggest
from fastlink.facts.fact import Input, Rule
from fastlink.facts.names import derivative_name
from fastlink.facts.own import check_name
from fastlink.facts.sheet import entries_of
from fastlink.mechanisms._shared.picture import Bar, Force, Picture, Point, Torque
from fastlink.space.units import ends_in_unit, looks_like_degrees

#: What each kind of dyad is given besides the points that it joins; what may be left out stands in brackets.
KINDS = {
    "rrr": "lengths",
    "rrp": "length along",
    "rpr": "[offset]",
    "rpp": "along [angle]",
    "prp": "",
    "on": "[at] [lengths] [side]",
    "gear": "about ratio length [phase]",
}
SHAPES = {
    "rrr": '{"rrr": ("A", "D"), "lengths": ("a2", "a3")}',
    "rrp": '{"rrp": "A", "length": "l", "along": ("C", "E")}',
    "rpr": '{"rpr": ("A", "D"), "offset": "e"}',
    "rpp": '{"rpp": "A", "along": ("C", "E")}',
    "prp": '{"prp": (("C", "E"), ("G", "H"))}',
    "on": '{"on": ("A", "B"), "at": ("P_u", "P_v")}',
    "gear": '{"gear": ("O", "A"), "about": "D", "ratio": -2, "length": "b"}',
}
#: Dyads that can be assembled in two ways, at most.
MOST_WAYS = 6
#: The speeds of a gear over that of the bar that drives it.
MOST_RATIO = 8
#: How inputs of lengths are called that were given as numbers.
OF_NUMBER = "length_"
COORDINATES = "coordinates: names of inputs, or numbers in m"
NAME = re.compile("[A-Za-z][A-Za-z0-9]*")

Pair = tuple[str, str]
Kind = Literal["joint", "slider", "traced"]


@dataclass(frozen=True)
class Link:
    """A rigid link: its points, and the unit vector of its axis as facts and by the unknowns of the loops."""

    name: str
    points: list[str]
    origin: str
    axis: Pair
    in_loops: Pair
    #: The fact of its angular velocity over that of the crank; empty of the ground.
    rate: str
    #: Its angle as a quantity or as the input position; empty of the ground.
    angle: str = ""
    #: Its length, of one of two pins; empty of others.
    length: str = ""
    #: The vectors from its origin to its points.
    vectors: dict[str, Pair] = field(default_factory=dict)

    def vector(self, point: str) -> Pair:
        """Return the vector from its origin to a point of it."""
        return ("0.0", "0.0") if point == self.origin else self.vectors[point]


@dataclass(frozen=True)
class Line:
    """A line of a link, or of the ground: a point of it, and the unit vector along it as facts and in the loops."""

    start: str
    unit: Pair
    in_loops: Pair
    link: Link


@dataclass(frozen=True)
class Placed:
    """What was placed: the links that are new with it, the points that these hang on, the lines that it runs on."""

    kind: str
    name: str
    links: tuple[Link, ...] = ()
    points: tuple[str, ...] = ()
    lines: tuple[Line, ...] = ()
    #: The angle of a slot, the place along one, the ratio of a gear.
    by: str = ""


def slope_of(name: str) -> str:
    """Return the name of the derivative of a fact by the crank angle."""
    return derivative_name(name, "theta")


def minus(a: str, b: str) -> str:
    """Return a difference as text."""
    if b == "0.0":
        return a
    b = f"({b})" if " " in b else b
    return f"-{b}" if a == "0.0" else f"{a} - {b}"


def times(a: str, b: str) -> str:
    """Return a product as text."""
    return "0.0" if "0.0" in (a, b) else (a if b == "1.0" else f"{a} * {b}")


def _value(text: str) -> str | float:
    """Return what stands for a coordinate in a picture."""
    return 0.0 if text == "0.0" else text


def plus(a: str, b: str) -> str:
    """Return a sum as text."""
    return b if a == "0.0" else (a if b == "0.0" else f"{a} + {b}")


def _angle_of(unit: Pair) -> str:
    """Return the angle of a unit vector in the loops."""
    return unit[0].removeprefix("cos(").removesuffix(")")


def _along(point: Pair, distance: str, unit: Pair) -> Pair:
    """Return the place that is so far from a point along a unit vector, as text."""
    return plus(point[0], times(distance, unit[0])), plus(point[1], times(distance, unit[1]))


def difference(a: Pair, b: Pair) -> Pair:
    """Return the difference of two places or rates as text."""
    return minus(a[0], b[0]), minus(a[1], b[1])


# -- Parts of sheets, in which each ``$word`` stands for a name or a formula


class Part(Template):
    """An entry of a part of a sheet: words end before an underscore."""

    idpattern = "[a-z]+[0-9]?"


@cache
def entries_of_part(part: str) -> list[Part]:
    """Return the entries of a part of a sheet, each with its lines."""
    return [Part("\n".join((one.head, *one.lines))) for one in entries_of(part, "")]


#: What follows from the motion of a point.
PATH = """
$p_speed [m s-1] |v_$p|: Speed of $p; its magnitude
    = magnitude($p_vx, $p_vy)
$p_acceleration [m s-2] |a_$p|: Acceleration of $p; its magnitude
    = magnitude($p_ax, $p_ay)
$p_curvature [m-1] kappa_$p: Curvature of the path of $p; positive where it turns left
    = ($p_vx * $p_ay - $p_vy * $p_ax) / ($p_speed * $p_speed * $p_speed)
"""
#: The derivatives of a vector of a link.
TURNING = """
d_$vector_x_d_theta = -($rate * $vector_y)
d_$vector_y_d_theta = $rate * $vector_x
"""
#: Directions: of a fixed line at an angle, and from one point to another.
AT_ANGLE = """
step $unit_{x,y} [1] u_{x,y}: Direction of the line through $start
    = {cosine,sine}($angle)
"""
DIRECTION = """
step $unit_{x,y} [1] u_{x,y}: Direction from $start to $end, {x,y}
    = ({$x,$y}) / magnitude($x, $y)
"""
#: The vector between the outer joints of a dyad, and its square.
REACH = """
step reach_$b_{x,y} [m] $p$q_{x,y}: Vector from $p to $q, {x,y}
    = {$rx,$ry}
"""
REACH_SQUARED = """
step reach_$b_squared [m2] |$p$q|^2: Square of the distance of $p and $q
    = reach_$b_x * reach_$b_x + reach_$b_y * reach_$b_y
"""
# Divisions are most of what a configuration costs: per_sum is of the design, per_reach and per_cross are of it.
RRR = """
step sum_$b_squared [m2] ($first + $second)^2: Square of the length of both bars
    = select(($l1 > 0.0) & ($l2 > 0.0), ($l1 + $l2) * ($l1 + $l2), NOT_A_NUMBER)
step per_sum_$b [m-2] 1/($first + $second)^2: Reciprocal of that square
    = 1.0 / sum_$b_squared
step per_reach_$b [m-2] 1/(2 |$p$q|^2): Half the reciprocal of the square of that distance
    = 0.5 / reach_$b_squared
step fold_$b [1] d^2: Square of the difference of both bars over that of their sum
    ratio = ($l1 - $l2) / ($l1 + $l2)
    = ratio * ratio
step gap_$b [1] 16 T^2/($first + $second)^4: Square of the triangle $p$q$b
    part = reach_$b_squared * per_sum_$b
    = (1.0 - part) * (part - fold_$b)
step $first_{x,y} [m] $first_{x,y}: Vector from $p to $b, {x,y}
    share = reach_$b_squared + ($l1 - $l2) * ($l1 + $l2)
    across = sign_$b * (sum_$b_squared * gap_$b_root)
    = per_reach_$b * (reach_$b_{x,y} * share {-,+} reach_$b_{y,x} * across)
step $second_{x,y} [m] $second_{x,y}: Vector from $q to $b, {x,y}
    = $first_{x,y} - reach_$b_{x,y}
step per_cross_$b [m-2] 1/($first x $second): Reciprocal of the cross product of both bars
    = 2.0 / (sign_$b * (sum_$b_squared * gap_$b_root))
step dot_$b [m2] $first . $second: Product of both bars
    = $first_x * $second_x + $first_y * $second_y
step n_{$first,$second} [1] n_{$first,$second}: Angular velocity of {$first,$second} over that of the crank
    = (($wx) * {$second,$first}_x + ($wy) * {$second,$first}_y) * per_cross_$b
d_{$first,$second}_x_d_theta = -(n_{$first,$second} * {$first,$second}_y)
d_{$first,$second}_y_d_theta = n_{$first,$second} * {$first,$second}_x
d_per_cross_$b_d_theta = -(per_cross_$b * per_cross_$b * ((n_$second - n_$first) * dot_$b))
"""
# |x| by the size of a vector, whose kinks are known to the search of extremes
TRANSMISSION = """
step sine_$b [m2] |$b|: Sine of the transmission angle at $b, times lengths
    = $sine
transmission_angle_$b [rad] mu_$b: Transmission angle at $b; between $between
    = atan2(sine_$b + 0.0, $cosine)
d_transmission_angle_$b_d_theta = sign_$b * ($growth)
acute_transmission_angle_$b [rad] mu_$b: Acute transmission angle at $b; that or its supplement
    = atan2(sine_$b + 0.0, magnitude($cosine, $cosine - $cosine))
"""
RRP = """
step off_$b [m] h: Distance of $q from the line through $p, to its left
    = $ux * ($ry) - $uy * ($rx)
step gap_$b [1] 1 - h^2/$bar^2: Square of the sine of the transmission angle at $b
    part = off_$b / select($length > 0.0, $length, NOT_A_NUMBER)
    = (1.0 - part) * (1.0 + part)
step ahead_$b [m] c: Part of $bar along the line
    = sign_$b * ($length * gap_$b_root)
step $bar_{x,y} [m] $bar_{x,y}: Vector from $q to $b, {x,y}
    = ahead_$b * {$ux,$uy} {+,-} off_$b * {$uy,$ux}
slide_$b [m] s_$b: Place of the slider $b on its line, from $p
    = $ux * ($rx) + $uy * ($ry) + ahead_$b
step per_ahead_$b [m-1] 1/c: Reciprocal of the part of $bar along the line
    = 1.0 / (sign_$b * ($length * gap_$b_root))
step n_$bar [1] n_$bar: Angular velocity of $bar over that of the crank
    = (($wy) * $ux - ($wx) * $uy$turning) * per_ahead_$b
d_$bar_x_d_theta = -(n_$bar * $bar_y)
d_$bar_y_d_theta = n_$bar * $bar_x
d_per_ahead_$b_d_theta = -(per_ahead_$b * per_ahead_$b * ($more * off_$b))
d_ahead_$b_d_theta = $more * off_$b
d_slide_$b_d_theta = n_$bar * off_$b - (($wx) * $ux + ($wy) * $uy)
step across_$b [m2] h $bar: Cosine of the transmission angle at $b, times lengths
    = off_$b * $length
"""
#: A slot through the pivot of its link, and one beside it.
RPR = """
slide_$b [m] s_$b: Place of $q along the slot of $b, from $p
    = magnitude(reach_$b_x, reach_$b_y)
step axis_$b_{x,y} [1] u_{x,y}: Direction of $b, {x,y}
    = reach_$b_{x,y} / slide_$b
"""
RPR_BESIDE = """
step gap_$b [1] s^2: Square of the place of $q along the slot, over that of the crank
    = (reach_$b_squared - $offset * $offset) / ($scale * $scale)
slide_$b [m] s_$b: Place of $q along the slot of $b, from $p
    = sign_$b * ($scale * gap_$b_root)
step axis_$b_{x,y} [1] u_{x,y}: Direction of $b, {x,y}
    = (slide_$b * reach_$b_{x,y} {+,-} $offset * reach_$b_{y,x}) / reach_$b_squared
"""
RPR_RATES = """
step n_$b [1] n_$b: Angular velocity of $b over that of the crank
    = (($wy) * axis_$b_x - ($wx) * axis_$b_y) / $per
d_axis_$b_x_d_theta = -(n_$b * axis_$b_y)
d_axis_$b_y_d_theta = n_$b * axis_$b_x
d_slide_$b_d_theta = ($wx) * axis_$b_x + ($wy) * axis_$b_y$more
"""


class Writer:
    """The sheet of a declaration while it is written, and its picture."""

    def __init__(self, declared: Mapping[str, Any]) -> None:
        self.declared, self.problems = declared, Problems()
        self.inputs: dict[str, list[str]] = {}
        self.facts: list[str] = []
        #: The facts that change over the turn.
        self.moving = {"theta", "cos_theta", "sin_theta"}
        #: The lengths of bars by their ends.
        self.lengths: dict[frozenset[str], str] = {}
        #: Directions that have facts already: of fixed lines, and between points.
        self.directions: set[str | Pair] = set()
        self.gaps: dict[str, str] = {}
        self.ways: list[tuple[str, Pair, str]] = []
        #: The coordinates of points as facts or inputs, and by the unknowns of the loops.
        self.points: dict[str, Pair] = {}
        self.in_loops: dict[str, Pair] = {}
        self.unknowns: list[str] = []
        self.rows: list[str] = []
        self.links: list[Link] = []
        #: A length that is positive, of what drives.
        self.scale = ""
        #: The least transmission angle of the dyads so far.
        self.least = ""
        #: The dyad under way.
        self.current = ""
        self.placed: list[Placed] = []
        #: What pins are of: a link, or a slider by its own name, where they join links.
        self.owners: dict[str, Link | str] = {}
        self.drawn: list[Point] = []
        self.bars: list[Bar] = []

    @contextmanager
    def within(self, *place: str) -> Iterator[None]:
        """Note the problems of a part of the declaration, at its place in that."""
        try:
            yield
        except InputError as error:
            self.problems.noted += [
                replace(one, where=("linkage", *place, *one.where)) for one in error.problems
            ]

    # -- reading -------------------------------------------------------------------------------------------------------

    def value(
        self, where: KeyPath, given: Any, name: str, units: str, meaning: str, rule: Rule = "any"
    ) -> str:
        """Return the name of an input, or of one with a number as its default; 0 is no input."""
        if isinstance(given, str):
            name = given
            if NAME.match(name) is None or re.fullmatch("[A-Za-z](_?[A-Za-z0-9])*_?", name) is None:
                remedy = "write letters, digits and single _, or a number"
                if re.fullmatch(r"[-+.\d][-+.\deE]*", name):
                    remedy = "write a number without quotes"
                raise InputError(f"is {given!r}, which is no name", where, remedy)
            check_name(name)
            of, unit = ends_in_unit(name, units)
            if unit:
                what = f"is {name!r}, which ends in a unit"
                raise InputError(what, where, f"call it {of!r}, and give {name!r}")
        elif isinstance(given, bool) or not isinstance(given, (int, float)) or given - given != 0.0:
            raise InputError(f"is {short_repr(given)}", where, "write the name of an input, or a number")
        elif given == 0 and rule == "any":
            return "0.0"
        lines = self.inputs.setdefault(name, [f"{name} [{units}] {name}: {meaning}"])
        if f"[{units}]" not in lines[0]:
            what = f"{name} is an input in {lines[0].partition('[')[2].partition(']')[0]} already, here in {units}"
            raise InputError(what, where, "call one of both otherwise")
        if rule != "any" and f"rule: {rule}" not in lines:
            lines.append(f"rule: {rule}")
        default = self.declared["defaults"].get(name) if isinstance(given, str) else float(given)
        if default is not None and not Input(name, units, name, meaning, rule).allows(default):
            whose = f", the default of {name}" if isinstance(given, str) else ""
            raise InputError(f"is {float(default)!r}{whose}, not {rule}", where, "write another number")
        if default is not None and units == "rad" and looks_like_degrees(default):
            remedy = f"if these are degrees, write {math.radians(default):.6g}"
            remark(f"{name} is {default}, taken as radians", ("linkage", *where), remedy)
        if default is not None and not any(line.startswith("default") for line in lines):
            lines.append(f"default: {float(default)!r}")
        return name

    def length(self, where: KeyPath, given: Any, ends: str, meaning: str) -> str:
        """Return the name of an input that is the distance of two points of a link."""
        return self.value(where, given, f"{OF_NUMBER}{ends}", "m", f"{meaning} {ends}", "positive")

    def point(self, where: KeyPath, name: Any) -> str:
        """Return the name of a point that is placed already."""
        if isinstance(name, str) and name in self.points:
            return name
        dyads = self.declared["dyads"]
        if not isinstance(name, str) or not isinstance(dyads, Mapping) or name not in dyads:
            raise InputError(f"{short_repr(name)} is no point", where, suggest(str(name), list(self.points)))
        needed, found = {name}, [name]
        while found:
            further = set(re.findall(r"\w+", str(dyads[found.pop()]))).intersection(dyads) - needed
            needed |= further
            found += further
        group = sorted(needed - self.points.keys())
        if self.current not in group:
            raise InputError(f"{name} is placed later", where, f"declare {name} before it")
        what = (
            f"{name} stands on {self.current} itself: {', '.join(group)} are an Assur group of higher class"
        )
        raise InputError(what, where, "write dyads, each of which stands on points before it")

    def pair(self, where: KeyPath, given: Any, noun: str) -> tuple[Any, Any]:
        """Return two entries of a list."""
        if isinstance(given, str) or not isinstance(given, Sequence) or len(given) != 2:
            raise InputError(f"is {short_repr(given)}", where, f"write two {noun}")
        return given[0], given[1]

    def values(
        self, where: KeyPath, given: Any, noun: str, *of: Pair, units: str = "m", rule: Rule = "any"
    ) -> Pair:
        """Return the names of two inputs, each by its usual name and meaning."""
        pair = self.pair(where, given, noun)
        x, y = (
            self.value(where, one, name, units, meaning, rule)
            for one, (name, meaning) in zip(pair, of, strict=True)
        )
        return x, y

    def link_of(self, where: KeyPath, first: str, second: str) -> Link:
        """Return the link that two points are of."""
        if first == second:
            raise InputError(f"is {first} twice", where, "write two points of one link")
        for link in self.links:
            if first in link.points and second in link.points:
                return link
        raise InputError(
            f"{first} and {second} are of no link", where, "write two points of one bar, or of the ground"
        )

    # -- writing -------------------------------------------------------------------------------------------------------

    def fact(self, head: str, *lines: str) -> None:
        """Append a fact, and note whether it moves."""
        self.facts += [head, *(f"    {line}" for line in lines)]
        if not self.moving.isdisjoint(re.findall(r"\w+", " ".join(lines))):
            name = head.removeprefix("step ").partition(" ")[0]
            self.moving |= {name, slope_of(name)}

    def write(self, part: str, **words: str) -> None:
        """Append a part of a sheet, and note which of its facts move."""
        for entry in entries_of_part(part):
            self.fact(*entry.substitute(words).split("\n"))

    def rate(self, name: str) -> str:
        """Return the derivative of a fact by time as text, 0 times the speed where it does not move."""
        return f"omega * {slope_of(name)}" if name in self.moving else "0.0 * omega"

    def slope(self, name: str, slope: str) -> None:
        """Append the derivative of a fact by the crank angle."""
        self.facts.append(f"{slope_of(name)} = {slope}")

    def rate_of(self, point: str) -> Pair:
        """Return the derivative of a point by the crank angle."""
        moves = (f"{point}_{axis}" in self.moving for axis in "xy")
        x, y = (slope_of(f"{point}_{axis}") if own else "0.0" for axis, own in zip("xy", moves, strict=True))
        return x, y

    def reach(self, name: str, start: str, end: str) -> dict[str, str]:
        """Return the words of what joins two points by a dyad: of their vector and its rate."""
        rx, ry = difference(self.points[end], self.points[start])
        wx, wy = difference(self.rate_of(end), self.rate_of(start))
        return {"b": name, "p": start, "q": end, "rx": rx, "ry": ry, "wx": wx, "wy": wy}

    def add_point(self, name: str, at: Sequence[str], in_loops: Sequence[str], kind: Kind = "joint") -> None:
        """Append the place and the motion of a point, by what it is the sum of; in the loops also by what vanishes."""
        for k, axis in enumerate("xy"):
            x, v, a = f"{name}_{axis}", f"{name}_v{axis}", f"{name}_a{axis}"
            self.fact(f"{x} [m] {x}: Point {name}, {axis}", f"= {at[k]}")
            self.fact(f"{v} [m s-1] {v}: Velocity of {name}, {axis}", f"= {self.rate(x)}")
            self.fact(f"{a} [m s-2] {a}: Acceleration of {name}, {axis}", f"= {self.rate(v)}")
            vanishes = in_loops[k] if x in in_loops[k] else minus(x, in_loops[k])
            self.rows += [f"    | {vanishes}", f"    {x} by omega: {v}, {a}"]
            self.unknowns.append(x)
        self.write(PATH, p=name)
        self.points[name] = (f"{name}_x", f"{name}_y")
        self.in_loops[name] = self.points[name]
        self.drawn.append(Point(name, f"{name}_x", f"{name}_y", kind))

    def add_angle(self, name: str, vector: str, rate: str) -> str:
        """Append angle, angular velocity, acceleration and jerk of a link by a vector of it; return its angle."""
        angle = f"angle_{name}"
        self.fact(
            f"{angle} [rad] theta_{name}: Direction of {name}", f"= atan2({vector}_y + 0.0, {vector}_x)"
        )
        self.slope(angle, rate)
        of = f"of {name}"
        self.fact(f"omega_{name} [rad s-1] omega_{name}: Angular velocity {of}", f"= omega * {rate}")
        before = "omega"
        for word, unit, noun in (("alpha", "s-2", "acceleration"), ("jerk", "s-3", "jerk")):
            head = f"{word}_{name} [rad {unit}] {word}_{name}: Angular {noun} {of}"
            self.fact(head, f"= {self.rate(f'{before}_{name}')}")
            before = word
        self.unknowns.append(angle)
        self.rows.append(f"    {angle} by omega: omega_{name}, alpha_{name}, jerk_{name}")
        return angle

    def add_ways(self, name: str, meanings: Pair, gap: str, first: str = "1.0") -> None:
        """Note that a dyad can be assembled in two ways, the sign of the first, and what limits it."""
        self.ways.append((name, meanings, first))
        self.gaps[f"gap_{name}"] = gap
        self.moving.add(f"gap_{name}_root")

    def line(self, where: KeyPath, given: Any) -> Line:
        """Return a line of two points of a link, or a fixed one at an angle."""
        first, second = self.pair(where, given, "points of one link, or a ground pivot and an angle")
        start = self.point(where, first)
        if not isinstance(second, str) or second not in self.points:
            if start not in self.links[0].points:
                what = f"{short_repr(second)} is no point, and an angle is that of a fixed line"
                raise InputError(what, where, suggest(str(second), list(self.points)))
            name = f"{start}_angle"
            angle = self.value(where, second, name, "rad", f"direction of the line through {start}")
            if angle == "0.0":
                return Line(start, ("1.0", "0.0"), ("1.0", "0.0"), self.links[0])
            unit = "axis_" + "_".join((start, "at", angle))
            if unit not in self.directions:
                self.directions.add(unit)
                self.write(AT_ANGLE, unit=unit, start=start, angle=angle)
            return Line(start, (f"{unit}_x", f"{unit}_y"), (f"cos({angle})", f"sin({angle})"), self.links[0])
        link = self.link_of(where, start, second)
        return Line(start, *self.direction(link, start, second), link)

    def slid(self, line: Line, slide: str) -> tuple[Pair, Pair]:
        """Return the place so far along a line, as facts and in the loops."""
        start = line.start
        return _along(self.points[start], slide, line.unit), _along(
            self.in_loops[start], slide, line.in_loops
        )

    def direction(self, link: Link, start: str, end: str) -> tuple[Pair, Pair]:
        """Return the unit vector from a point of a link to another, as facts and in the loops."""
        if link.origin == start and link.points[:2] == [start, end] and link.rate:
            return link.axis, link.in_loops
        unit, (x, y) = f"axis_{start}{end}", difference(self.points[end], self.points[start])
        if (x, y) == ("0.0", "0.0"):
            raise InputError(f"{start} and {end} are in one place", (), "write two points that are apart")
        # of a zero without units nobody could tell that it is a length
        x, y = (f"{y} - ({y})" if x == "0.0" else x), (f"{x} - ({x})" if y == "0.0" else y)
        if (start, end) not in self.directions:
            self.directions.add((start, end))
            self.write(DIRECTION, unit=unit, start=start, end=end, x=x, y=y)
            if link.rate:
                self.write(TURNING, vector=unit, rate=link.rate)
        # by the angle of the link and that of its two points in it, which are numbers of the design
        name = f"angle_{start}{end}" if link.rate else f"slant_{start}{end}"
        if name not in self.unknowns:
            if link.rate:
                self.add_angle(f"{start}{end}", unit, link.rate)
            else:
                self.fact(f"{name} [rad] {name}: Direction from {start} to {end}", f"= atan2({y} + 0.0, {x})")
                self.unknowns.append(name)
            u, v = difference(self.in_loops[end], self.in_loops[start])
            self.rows.append(f"    | sin({name}) * ({u}) - cos({name}) * ({v})")
        return (f"{unit}_x", f"{unit}_y"), (f"cos({name})", f"sin({name})")

    # -- the ground and the crank --------------------------------------------------------------------------------------

    def write_ground(self) -> None:
        """Write the pivots of the ground."""
        ground = self.declared["ground"]
        if not isinstance(ground, Mapping) or not ground:
            raise InputError(
                f"is {short_repr(ground)}", ("ground",), 'write pivots, such as {"O": (0, 0), "D": ("a4", 0)}'
            )
        self.links.append(Link("ground", [], "", ("1.0", "0.0"), ("1.0", "0.0"), ""))
        for name, at in ground.items():
            with self.within("ground", str(name)):
                self.new_name((), name)
                labels = ((f"{name}_{axis}", f"{axis} of the pivot {name}") for axis in "xy")
                x, y = self.values((), at, COORDINATES, *labels)
                self.points[name] = self.in_loops[name] = x, y
                self.links[0].points.append(name)
                self.drawn.append(Point(name, _value(x), _value(y), "ground"))

    def new_name(self, where: KeyPath, name: Any) -> None:
        """Refuse a name that no point could have, or that is one already."""
        if not isinstance(name, str) or NAME.fullmatch(name) is None:
            raise InputError(f"{short_repr(name)} is no name of a point", where, "write letters and digits")
        if name in self.points or any(name == link.name for link in self.links):
            raise InputError(f"{name} is placed twice", where, "call one of both otherwise")

    def write_crank(self) -> None:
        """Write the crank, which turns at a constant speed."""
        crank = self.declared["crank"]
        shape = 'write {"A": ("O", "a1")}: its pin, its pivot and its length'
        if not isinstance(crank, Mapping) or len(crank) != 1:
            raise InputError(f"is {short_repr(crank)}", ("crank",), shape)
        ((pin, given),) = crank.items()
        self.new_name(("crank",), pin)
        first, second = self.pair(("crank", pin), given, "entries: the pivot and the length")
        pivot = self.point(("crank", pin), first)
        if pivot not in self.links[0].points:
            raise InputError(f"{pivot} is no pivot of the ground", ("crank", pin), shape)
        name = pivot + pin
        length = self.length(("crank", pin), second, name, "length of the crank")
        self.inputs["omega"] = ["omega [rad s-1] omega: angular velocity of the crank, constant"]
        axis = ("cos_theta", "sin_theta")
        radius, self.scale = f"{length}_or_none", length
        self.fact(
            f"step {radius} [m] {length}: Length of the crank {name}, which is positive",
            f"= select({length} > 0.0, {length}, NOT_A_NUMBER)",
        )
        in_loops = ("cos(theta)", "sin(theta)")
        self.links.append(Link(name, [pivot, pin], pivot, axis, in_loops, "crank_rate", "theta", length))
        self.placed.append(Placed("crank", pin, (self.links[-1],), (pivot,)))
        self.fact("step crank_rate [1] n: Angular velocity of the crank over itself", "= 1.0")
        self.add_bar(name, pivot, pin, length, (f"{radius} * cos_theta", f"{radius} * sin_theta"))

    def write_slider(self) -> None:
        """Write the slider that drives to and fro: at one end of its stroke at 0, at the other half a turn later."""
        slider = self.declared["slider"]
        shape = 'write {"A": {"along": ("O", "beta"), "stroke": ("s_1", "s_2")}}'
        if not isinstance(slider, Mapping) or len(slider) != 1:
            raise InputError(f"is {short_repr(slider)}", ("slider",), shape)
        ((pin, given),) = slider.items()
        where: KeyPath = ("slider", pin)
        self.new_name(("slider",), pin)
        if not isinstance(given, Mapping) or given.keys() != {"along", "stroke"}:
            raise InputError(f"is {short_repr(given)}", where, shape)
        line = self.line((*where, "along"), given["along"])
        labels = ((f"stroke_{pin}_{k}", f"end of the stroke of {pin}, number {k}") for k in (1, 2))
        one, other = self.values((*where, "stroke"), given["stroke"], "places on the line", *labels)
        self.inputs["omega"] = [
            "omega [rad s-1] omega: rate of theta, a turn of which is a stroke to and fro; constant"
        ]
        self.scale, slide = f"stroke_{pin}", f"slide_{pin}"
        length = minus(other, one)
        self.fact(
            f"step {self.scale} [m] h: Stroke of {pin}",
            f"= select(abs({length}) > 0.0, abs({length}), NOT_A_NUMBER)",
        )
        at = f"0.5 * ({plus(one, other)}"
        self.fact(
            f"{slide} [m] s_{pin}: Place of the slider {pin} on its line, from {line.start}",
            f"= {at} - ({length}) * cos_theta)",
        )
        self.add_slide(pin, slide)
        self.rows.append(f"    | {slide} - {at} - ({length}) * cos(theta))")
        self.placed.append(Placed("slider", pin, lines=(line,)))
        self.owners[pin] = pin
        self.add_point(pin, *self.slid(line, slide), "slider")

    def add_bar(self, name: str, start: str, end: str, length: str, at: Pair | None = None) -> None:
        """Write the end of a bar, whose link is the last."""
        link = self.links[-1]
        x, y = self.points[start]
        to = at or (f"{length} * {link.axis[0]}", f"{length} * {link.axis[1]}")
        link.vectors[end] = to
        self.owners[end] = link
        loops = _along(self.in_loops[start], length, link.in_loops)
        self.add_point(end, (plus(x, to[0]), plus(y, to[1])), loops)
        self.draw_bar(start, end, length)

    def draw_bar(self, start: str, end: str, length: str) -> None:
        """Note a bar of two points for the picture, and its length."""
        self.bars.append(Bar(f"{start} {end}", {f"{start} {end}": length}))
        self.lengths[frozenset((start, end))] = length

    def add_link(self, name: str, points: list[str], vector: str, rate: str, length: str = "") -> Link:
        """Append the angle and the rates of a link by a vector of it, of that length unless it is a unit vector."""
        angle, along = self.add_angle(name, vector, rate), (f"{vector}_x", f"{vector}_y")
        axis, in_loops = along, (f"cos({angle})", f"sin({angle})")
        if length:
            per = f"per_{name}"
            self.fact(f"step {per} [m-1] 1/{name}: Reciprocal of the length of {name}", f"= 1.0 / {length}")
            axis = f"{vector}_x * {per}", f"{vector}_y * {per}"
        link = Link(name, points, points[0], axis, in_loops, rate, angle, length)
        link.vectors.update(dict.fromkeys(points[1:], along))
        self.links.append(link)
        return link

    # -- dyads ---------------------------------------------------------------------------------------------------------

    def write_dyads(self) -> None:
        """Write all dyads in their order."""
        dyads = self.declared["dyads"]
        if not isinstance(dyads, Mapping) or not dyads:
            raise InputError(f"is {short_repr(dyads)}", ("dyads",), f'write such as {{"B": {SHAPES["rrr"]}}}')
        for name, given in dyads.items():
            self.current = name
            with self.within("dyads", str(name)):
                self.new_name((), name)
                words = list(given) if isinstance(given, Mapping) else []
                kind = next((word for word in words if word in KINDS), "")
                if not kind:
                    said = f"has no kind, but {', '.join(map(repr, words))}"
                    remedy = f"write one of {'; '.join(SHAPES.values())}"
                    raise InputError(said if words else f"is {short_repr(given)}", (), remedy)
                known = [kind, *KINDS[kind].replace("[", "").replace("]", "").split()]
                for word in words:
                    check_choice((word,), word, known)
                missing = [word for word in KINDS[kind].split() if word[0] != "[" and word not in words]
                if missing:
                    raise InputError(f"has no {missing[0]!r}", (), f"write {SHAPES[kind]}")
                getattr(self, f"write_{kind}")(name, given)
            if self.problems.noted:
                return  # what follows may stand on it

    def write_rrr(self, name: str, given: Mapping[str, Any]) -> None:
        """Write a dyad of two bars: both outer joints and the inner one are revolute."""
        outer = self.pair(("rrr",), given["rrr"], "points")
        a, d = (self.point(("rrr",), one) for one in outer)
        if a == d or any(a in link.points and d in link.points for link in self.links):
            what = f"{a} and {d} are of one link, on which {name} would be fixed"
            raise InputError(what, ("rrr",), f"write {SHAPES['on']}")
        first, second = a + name, d + name
        labels = ((f"{OF_NUMBER}{bar}", f"length of the bar {bar}") for bar in (first, second))
        l1, l2 = self.values(("lengths",), given["lengths"], "lengths", *labels, rule="positive")
        meanings = (f"{name} to the right of {a}{d}", f"{name} to its left")  # in the order of the planar 4R
        between = f"the bars {first} and {second}"
        self.add_ways(name, meanings, between, "-1.0")
        words = self.reach(name, a, d) | {"first": first, "second": second, "l1": l1, "l2": l2}
        self.write(REACH + REACH_SQUARED + RRR, **words)
        loops = []
        for bar, start, length in ((first, a, l1), (second, d, l2)):
            link = self.add_link(bar, [start, name], bar, f"n_{bar}", length)
            loops.append(_along(self.in_loops[start], length, link.in_loops))
            self.draw_bar(start, name, length)
        self.rows += [f"    | {one}" for one in difference(*loops)]
        self.placed.append(Placed("rrr", name, tuple(self.links[-2:]), (a, d)))
        self.owners[name] = self.links[-2]
        ax, ay = self.points[a]
        self.add_point(name, (plus(ax, f"{first}_x"), plus(ay, f"{first}_y")), loops[0])
        sine = f"0.5 * (sum_{name}_squared * gap_{name}_root)"
        self.add_transmission(name, sine, f"dot_{name}", f"n_{second}", f"n_{first}", between)

    def add_transmission(self, name: str, sine: str, cosine: str, fast: str, slow: str, between: str) -> None:
        """Write the transmission angle of a dyad, which grows at the difference of two rates."""
        growth = minus(fast, slow)
        self.write(TRANSMISSION, b=name, sine=sine, cosine=cosine, growth=growth, between=between)
        acute = f"acute_transmission_angle_{name}"
        least, self.least = self.least, acute
        if least:
            self.least = f"least_{name}"
            head = f"step {self.least} [rad] mu: Least acute transmission angle up to {name}"
            self.fact(head, f"d = {least} - {acute}", f"= 0.5 * ({least} + {acute} - magnitude(d, d - d))")

    def write_rrp(self, name: str, given: Mapping[str, Any]) -> None:
        """Write a bar whose end is a slider on a line, which is fixed or of a link."""
        a = self.point(("rrp",), given["rrp"])
        bar, slide = a + name, f"slide_{name}"
        length = self.length(("length",), given["length"], bar, "length of the bar")
        line = self.line(("along",), given["along"])
        rate, turn = f"n_{bar}", line.link.rate
        self.add_ways(name, (f"{name} ahead of {a} along the line", f"{name} behind it"), f"the bar {bar}")
        words = self.reach(name, line.start, a) | {"bar": bar, "length": length}
        words |= {"ux": line.unit[0], "uy": line.unit[1], "turning": f" + {slide} * {turn}" if turn else ""}
        # here the rate of the line's point less that of the pin
        words["wx"], words["wy"] = difference(self.rate_of(line.start), self.rate_of(a))
        words["more"] = f"({minus(rate, turn)})" if turn else rate
        self.write(RRP, **words)
        self.add_slide(name, slide)
        link = self.add_link(bar, [a, name], bar, rate, length)
        self.placed.append(Placed("rrp", name, (link,), (a,), (line,)))
        self.owners[name] = name
        ends = _along(self.in_loops[a], length, link.in_loops)
        _, slid = self.slid(line, slide)
        self.rows += [f"    | {one}" for one in difference(ends, slid)]
        ax, ay = self.points[a]
        self.add_point(name, (plus(ax, f"{bar}_x"), plus(ay, f"{bar}_y")), ends, "slider")
        self.draw_bar(a, name, length)
        between, sine = f"the bar {bar} and the normal of its line", f"{length} * {length} * gap_{name}_root"
        self.add_transmission(name, sine, f"across_{name}", rate, turn or "0.0", between)

    def add_slide(self, name: str, slide: str) -> None:
        """Write the velocity and acceleration of a slider along its line."""
        rate, second = f"{slide}_rate", f"{slide}_acceleration"
        self.fact(f"{rate} [m s-1] v: Velocity of {name} along its line", f"= {self.rate(slide)}")
        self.fact(f"{second} [m s-2] a: Acceleration of {name} along its line", f"= {self.rate(rate)}")
        self.unknowns.append(slide)
        self.rows.append(f"    {slide} by omega: {rate}, {second}")

    def write_rpr(self, name: str, given: Mapping[str, Any]) -> None:
        """Write a link about a pivot, along whose slot a pin slides."""
        pin, pivot = self.pair(
            ("rpr",), given["rpr"], "points: the pin, and the pivot of the link with the slot"
        )
        a, d = self.point(("rpr",), pin), self.point(("rpr",), pivot)
        if a == d:
            raise InputError(f"is {a} twice", ("rpr",), f"write {SHAPES['rpr']}")
        meaning = f"distance of the slot of {name} from {d}, to its left"
        offset = self.value(("offset",), given.get("offset", 0), f"offset_{name}", "m", meaning)
        slide, rate = f"slide_{name}", f"n_{name}"
        words = self.reach(name, d, a) | {"offset": offset, "scale": self.scale}
        through = offset == "0.0"
        per = slide if through else f"(sign_{name} * ({self.scale} * gap_{name}_root))"
        if not through:
            self.add_ways(name, (f"{a} ahead of {d} along {name}", f"{a} behind it"), f"the slot of {name}")
        more = "" if through else f" + {offset} * {rate}"
        parts = (REACH, RPR) if through else (REACH, REACH_SQUARED, RPR_BESIDE)
        self.write("".join((*parts, RPR_RATES)), per=per, more=more, **words)
        self.add_slide(a, slide)
        link = self.add_link(name, [d], f"axis_{name}", rate)
        link.vectors[a] = (f"reach_{name}_x", f"reach_{name}_y")
        self.placed.append(Placed("rpr", name, (link,), (a, d), by=per))
        lx, ly = link.in_loops
        (px, py), (qx, qy) = self.in_loops[a], self.in_loops[d]
        left = ("", "") if through else (f" - {offset} * {ly}", f" + {offset} * {lx}")
        self.rows += [
            f"    | {qx} + {slide} * {lx}{left[0]} - ({px})",
            f"    | {qy} + {slide} * {ly}{left[1]} - ({py})",
        ]
        self.bars.append(Bar(f"{d} {a}", {}))

    def write_rpp(self, name: str, given: Mapping[str, Any]) -> None:
        """Write a slider on a line, in whose slot a pin slides."""
        a = self.point(("rpp",), given["rpp"])
        line = self.line(("along",), given["along"])
        slide, (ux, uy), (lx, ly) = f"slide_{name}", line.unit, line.in_loops
        rx, ry = difference(self.points[a], self.points[line.start])
        angle, meaning = "", f"angle of the slot of {name} from its line"
        if "angle" in given:
            angle = self.value(("angle",), given["angle"], f"slot_{name}", "rad", meaning)
        off = f" - ({ux} * ({ry}) - {uy} * ({rx})) * (cosine({angle}) / sine({angle}))" if angle else ""
        self.fact(
            f"{slide} [m] s_{name}: Place of the slider {name} on its line, from {line.start}",
            f"= {ux} * ({rx}) + {uy} * ({ry}){off}",
        )
        self.add_slide(name, slide)
        of, (at, ends) = self.in_loops[a], self.slid(line, slide)
        x, y = (minus(of[k], f"({ends[k]})") for k in range(2))
        along = f"(({x}) * {lx} + ({y}) * {ly})"
        if angle:
            along = f"{along} * sin({angle}) - (({y}) * {lx} - ({x}) * {ly}) * cos({angle})"
        self.rows.append(f"    | {along}")
        self.links.append(Link(f"slider{name}", [name], name, (ux, uy), (lx, ly), line.link.rate))
        self.placed.append(Placed("rpp", name, (self.links[-1],), (a,), (line,), angle))
        self.owners[name] = self.links[-1]
        self.add_point(name, at, ends, "slider")
        self.bars.append(Bar(f"{name} {a}", {}))

    def write_prp(self, name: str, given: Mapping[str, Any]) -> None:
        """Write a pin of two sliders, each on a line of its own."""
        lines = self.pair(
            ("prp",), given["prp"], "lines, each of two points of one link, or of a ground pivot and an angle"
        )
        one, other = (self.line(("prp",), line) for line in lines)
        slide, (ux, uy), (wx, wy), (kx, ky) = f"slide_{name}", one.unit, other.unit, other.in_loops
        self.placed.append(Placed("prp", name, lines=(one, other)))
        self.owners[name] = name
        rx, ry = difference(self.points[other.start], self.points[one.start])
        self.fact(
            f"step cross_{name} [1] u x w: Sine of the angle between both lines of {name}",
            f"= {ux} * {wy} - {uy} * {wx}",
        )
        self.fact(
            f"{slide} [m] s_{name}: Place of {name} on its first line, from {one.start}",
            f"= (({rx}) * {wy} - ({ry}) * {wx}) / cross_{name}",
        )
        self.add_slide(name, slide)
        of, (at, ends) = self.in_loops[other.start], self.slid(one, slide)
        x, y = (minus(f"({ends[k]})", f"({of[k]})") for k in range(2))
        self.rows.append(f"    | ({x}) * {ky} - ({y}) * {kx}")
        self.add_point(name, at, ends, "slider")

    def write_on(self, name: str, given: Mapping[str, Any]) -> None:
        """Write a point of a link, by its place along the axis from one point of it to another, and left of that."""
        on = given["on"]
        named = next((link for link in self.links if isinstance(on, str) and link.name == on), None)
        if named is not None:
            link, start, (ux, uy), (lx, ly) = named, named.origin, named.axis, named.in_loops
            end = named.points[-1]
        else:
            first, second = self.pair(("on",), on, "points of one link")
            start, end = (self.point(("on",), one) for one in (first, second))
            link = self.link_of(("on",), start, end)
            (ux, uy), (lx, ly) = self.direction(link, start, end)
        if ("at" in given) == ("lengths" in given):
            raise InputError("has no place, or two", (), f"write {SHAPES['on']}, or lengths from both points")
        u, v = self.place_of(name, given, link) if "at" in given else self.third_of(name, given, start, end)
        (x, y), (px, py) = self.points[start], self.in_loops[start]

        def at(x: str, y: str, ux: str, uy: str) -> Pair:
            along, left = u == "0.0", v == "0.0"
            first = x + ("" if along else f" + {u} * ({ux})") + ("" if left else f" - {v} * ({uy})")
            return first, y + ("" if along else f" + {u} * ({uy})") + ("" if left else f" + {v} * ({ux})")

        loops: Sequence[str] = at(px, py, lx, ly)
        if "lengths" in given:  # in the loops by the triangle itself
            squares = (
                (f"({name}_{axis} - ({of[k]}))" for k, axis in enumerate("xy"))
                for of in (self.in_loops[start], self.in_loops[end])
            )
            sides = (self.lengths[frozenset((of, name))] for of in (start, end))
            loops = tuple(
                f"{p} * {p} + {q} * {q} - {d} * {d}" for (p, q), d in zip(squares, sides, strict=True)
            )
        link.points.append(name)
        if link.rate:
            link.vectors[name] = at(*link.vector(start), ux, uy)
            self.owners[name] = link
        self.add_point(name, at(x, y, ux, uy), loops, "traced")
        joined = " ".join(dict.fromkeys([*link.points[:2], name]))
        self.bars = [bar for bar in self.bars if bar.points != joined]
        self.bars.append(Bar(joined, {}))

    def place_of(self, name: str, given: Mapping[str, Any], link: Link) -> tuple[str, str]:
        """Return the place of a point along the axis of its link, and left of that."""
        ways = (("u", "along"), ("v", "left of"))
        labels = ((f"{name}_{axis}", f"place of {name} on {link.name}, {way} its axis") for axis, way in ways)
        return self.values(("at",), given["at"], COORDINATES, *labels)

    def third_of(self, name: str, given: Mapping[str, Any], start: str, end: str) -> tuple[str, str]:
        """Return the place of a point by its distances from both ends of a bar, to the left of that or to the right."""
        base = self.lengths.get(frozenset((start, end)))
        if base is None:
            what = f"{start}{end} is no bar whose length is given"
            raise InputError(what, ("lengths",), f"write {SHAPES['on']}")
        check_choice(("side",), side := given.get("side", "left"), ("left", "right"))
        labels = ((f"{OF_NUMBER}{end}{name}", f"distance of {end} and {name}") for end in (start, end))
        d, e = self.values(("lengths",), given["lengths"], "lengths", *labels, rule="positive")
        self.lengths |= {frozenset((start, name)): d, frozenset((end, name)): e}
        u, v = f"along_{start}{end}_{name}", f"left_{start}{end}_{name}"
        self.fact(
            f"step {u} [m] u: Place of {name} along {start}{end}",
            f"= 0.5 * ({base} + (({d} - {e}) * ({d} + {e})) / {base})",
        )
        sign = "" if side == "left" else "-"
        self.fact(
            f"step {v} [m] v: Place of {name} left of {start}{end}",
            f"= {sign}sqrt(({d} - {u}) * ({d} + {u}))",
        )
        return u, v

    def write_gear(self, name: str, given: Mapping[str, Any]) -> None:
        """Write a bar that a gear or a belt of a whole ratio turns with another, both about pivots of one link."""
        first, second = self.pair(("gear",), given["gear"], "points of the bar that drives it")
        start, end = (self.point(("gear",), one) for one in (first, second))
        driver = self.link_of(("gear",), start, end)
        pivot, ratio = self.point(("about",), given["about"]), given["ratio"]
        arm = self.link_of(("about",), start, pivot)
        if arm is driver:
            what = f"{start}, {end} and {pivot} are of one link, on which nothing turns"
            raise InputError(what, ("gear",), f"write {SHAPES['gear']}")
        if isinstance(ratio, float) and ratio.is_integer():
            ratio = int(ratio)
        if isinstance(ratio, bool) or not isinstance(ratio, int) or not 1 <= abs(ratio) <= MOST_RATIO:
            what = f"is {short_repr(ratio)}"
            remedy = f"write a whole number from -{MOST_RATIO} to {MOST_RATIO}, not 0"
            if isinstance(ratio, float):
                what += ": the motion goes on for several turns of the crank"
                remedy += ", or let a slow crank drive both bars by such"
            raise InputError(what, ("ratio",), remedy)
        bar = pivot + name
        length = self.length(("length",), given["length"], bar, "length of the bar")
        meaning = f"angle of {bar} beyond that of its drive"
        phase = self.value(("phase",), given.get("phase", 0), f"phase_{bar}", "rad", meaning)
        (ux, uy), in_loops = self.direction(driver, start, end)
        (ax, ay), of_arm = self.direction(arm, start, pivot) if arm.rate else (("1.0", "0.0"), ("", ""))
        seen = f"{ux} * {ax} + {uy} * {ay}, {uy} * {ax} - {ux} * {ay}" if arm.rate else f"{ux}, {uy}"
        lines = [f"x, y = {seen}", "u, v = x, y"] + ["u, v = u * x - v * y, u * y + v * x"] * (abs(ratio) - 1)
        if phase != "0.0":
            lines.append(f"c, s = cosine({phase}), sine({phase})")
        v = "v" if ratio > 0 else "-v"
        turned = ("u", v) if phase == "0.0" else (f"u * c - {v} * s", f"u * s + {v} * c")
        if arm.rate:
            lines.append(f"p, q = {turned[0]}, {turned[1]}")
            turned = (f"p * {ax} - q * {ay}", f"p * {ay} + q * {ax}")
        for axis, of in zip("xy", turned, strict=True):
            self.fact(f"step axis_{bar}_{axis} [1] u_{axis}: Direction of {bar}, {axis}", *lines, f"= {of}")
        rate = f"n_{bar}"
        self.fact(
            f"step {rate} [1] n_{bar}: Angular velocity of {bar} over that of the crank",
            f"= {plus(times(f'{float(ratio)}', driver.rate or '0.0'), times(f'{1.0 - ratio}', arm.rate or '0.0'))}",
        )
        self.write(TURNING, vector=f"axis_{bar}", rate=rate)
        link = self.add_link(bar, [pivot, name], f"axis_{bar}", rate)
        self.placed.append(Placed("gear", bar, (link, driver, arm), (pivot,), by=f"{ratio}.0"))
        turns = f"{ratio}.0 * {_angle_of(in_loops)}" + ("" if phase == "0.0" else f" + {phase}")
        turns += f" + {1.0 - ratio} * {_angle_of(of_arm)}" if arm.rate else ""
        self.rows.append(f"    | sin({link.angle} - ({turns}))")
        self.add_bar(bar, pivot, name, length)

    # -- the sheet -----------------------------------------------------------------------------------------------------

    def place(self) -> None:
        """Write the motion of all points and links, or raise all problems of the declaration."""
        drives = self.write_slider if "slider" in self.declared else self.write_crank
        for write in (self.write_ground, drives, self.write_dyads):
            with self.within():
                write()
            self.problems.stop()

    def sheet(self, variant: Sequence[str]) -> str:
        """Return the sheet, with the lines of a variant."""
        for name in self.declared["defaults"]:
            if name not in self.inputs:
                self.problems.add(
                    "is no input of it", ("linkage", "defaults", name), suggest(name, [*self.inputs])
                )
        self.problems.stop()
        if len(self.ways) > MOST_WAYS:
            what = f"{len(self.ways)} dyads have two ways each"
            raise InputError(what, ("linkage", "dyads"), f"write at most {MOST_WAYS}")
        if self.least:
            head = "least_transmission_angle [rad] mu: Least acute transmission angle of all dyads"
            self.fact(head, f"= {self.least}")
        for k, (name, _, first) in enumerate(self.ways):
            rest, lines = "branch - 1.0", []
            for higher in range(len(self.ways) - 1, k, -1):
                lines.append(f"r{higher} = {rest}")
                rest = f"r{higher} - select(r{higher} >= {2.0**higher}, {2.0**higher}, 0.0)"
            self.fact(
                f"step sign_{name} [1] s_{name}: 1 or -1, the way to assemble the dyad of {name}",
                *lines,
                f"= {first} * select({rest} >= {2.0**k}, -1.0, 1.0)",
            )
        name = str(self.declared["name"])
        title = str(self.declared["title"] or f"Linkage {name}")
        branches = []
        for number in range(2 ** len(self.ways)):
            words = [ways[number >> k & 1] for k, (_, ways, _) in enumerate(self.ways)]
            branches.append(f"{number + 1}: {'; '.join(words) or 'the only one'}")
        inputs = ["\n    ".join(lines) for lines in self.inputs.values()]
        drive = f"crank angle; direction of {self.links[1].name}"
        if "slider" in self.declared:
            drive = f"place of {self.placed[0].name} in its stroke; at the ends at 0 and pi"
        parts = ["[mechanism]", f"{name}: {title}", "[position]"]
        parts += [f"theta [rad] theta: {drive}", "[branches]", *branches]
        closes = ["[closes]", *(f"{gap}: {what}" for gap, what in self.gaps.items())]
        parts += [*closes, "[inputs]", *inputs]
        parts += ["## docs/linkages.md", "[facts]", *self.facts, *variant]
        parts += ["[loops]", f"loops {name}: {', '.join(self.unknowns)}", *self.rows]
        return "\n".join(parts) + "\n"

    def picture(self, drawn: Sequence[Force | Torque]) -> Picture:
        """Return what is drawn of it, with forces and torques."""
        moving = [point.name for point in self.drawn if point.kind != "ground"]
        shown = [point.name for point in self.drawn if point.kind == "traced"] or moving[-1:]
        traced = {"path": " ".join(shown)} | {name: name for name in moving}
        named = (
            replace(bar, lengths={k: v for k, v in bar.lengths.items() if not v.startswith(OF_NUMBER)})
            for bar in self.bars
        )
        return Picture(
            points=tuple(self.drawn),
            bars=tuple(named),
            traced=traced,
            forces=tuple(one for one in drawn if isinstance(one, Force)),
            torques=tuple(one for one in drawn if isinstance(one, Torque)),
            title=str(self.declared["name"]),
        )
