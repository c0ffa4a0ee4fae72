"""Forces of declared linkages: mass and loads of links, joint forces dyad by dyad, and all equations at once.

What a link needs is its rate of momentum less the loads on it, and the moment of both about its first joint. Its joints
give that. No dyad stands on a later one, so the last is solved first, and the links that carry it take the negatives of
what it gets. With R and M what the bars AB and DB need, the force of DB on AB at B is

    F = (M_DB AB + M_AB DB)/(AB x DB),    at A acts R_AB - F, at D R_DB + F.

The torque of the crank follows from the power of what the links need, the shaking force and moment from its sums:
neither needs a reaction. The variant ``dense`` solves the equations of all links by LU, in the words of the loops.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

from fastlink._text import short_repr
from fastlink.errors import InputError, check_choice, suggest
from fastlink.mechanisms._shared.picture import Force, Torque
from fastlink.mechanisms.linkage.motion import (
    COORDINATES,
    Line,
    Link,
    Pair,
    Placed,
    Writer,
    difference,
    minus,
    plus,
    times,
)

MASS = '{"mass": "m2", "inertia": "I2", "centre": ("G2_u", "G2_v")}'
BAR = "round_bar"
NONE: Pair = ("0.0", "0.0")
#: What a link needs: parts of a force and a moment, with their units.
PARTS = (("x", "N"), ("y", "N"), ("moment", "N m"))
ROUND_BARS = (
    "[variant round_bar]",
    "density [kg m-3] rho: density of the round bars",
    "    rule: non-negative",
    "radius [m] r_b: radius of the round bars",
    "    rule: non-negative",
)
POWER = "input_power [W] P_in: Power of what drives"
#: What vanishes, in whatever units.
NOTHING = "0.0 * omega"


def negative(term: str) -> str:
    """Return the negative of a product as text."""
    return "0.0" if term == "0.0" else term[1:] if term[0] == "-" else f"-{term}"


def total(terms: Iterable[str]) -> str:
    """Return a sum of products as text."""
    found = ""
    for term in terms:
        if term != "0.0":
            sign, rest = (" - ", term[1:]) if term[0] == "-" else (" + ", term)
            found += sign + rest if found else term
    return found or NOTHING


def moment(arm: Pair, force: Pair) -> str:
    """Return the moment of a force as text."""
    return "0.0" if NONE in (arm, force) else f"cross({', '.join((*arm, *force))})"


def left(unit: Pair) -> Pair:
    """Return the unit vector to the left of one."""
    return negative(unit[1]), unit[0]


def scaled(factor: str, vector: Pair) -> Pair:
    """Return a multiple of a vector, whose parts are products or sums in brackets, as text."""
    x, y = (negative(times(factor, one[1:])) if one[0] == "-" else times(factor, one) for one in vector)
    return x, y


def across(line: Line) -> tuple[Pair, Pair]:
    """Return the unit vector to the left of a line, as facts and in the loops."""
    return left(line.unit), left(line.in_loops)


def of_facts(pair: Pair) -> Pair:
    """Return a direction in the loops by the functions that kernels have."""
    x, y = (one.replace("cos(", "cosine(").replace("sin(", "sine(") for one in pair)
    return x, y


@dataclass
class Body:
    """A link, or a slider without extent: what it needs, and what it carries."""

    name: str
    #: Its first joint.
    at: str
    link: Link | None = None
    #: Along x, along y and about the first joint: what it needs of itself, and that in the words of the loops.
    own: tuple[list[str], ...] = field(default_factory=lambda: ([], [], []))
    dense: tuple[list[str], ...] = field(default_factory=lambda: ([], [], []))
    #: Forces on links that it carries with the vectors to where they act, and moments.
    carried: list[tuple[Pair, Pair]] = field(default_factory=list)
    turned: list[str] = field(default_factory=list)

    def arm(self, point: str) -> Pair:
        """Return the vector from its first joint to a point of it."""
        return NONE if self.link is None else self.link.vector(point)


class Forces:
    """The facts of force of a declaration."""

    def __init__(self, writer: Writer) -> None:
        self.writer = writer
        self.ground = writer.links[0].name
        self.bodies = {link.name: Body(link.name, link.origin, link) for link in writer.links[1:]}
        self.bodies |= {name: Body(name, name) for name in writer.owners.values() if isinstance(name, str)}
        #: A slider turns as the link of its line does.
        self.turns_as = {one.links[0].name: one.lines[0].link for one in writer.placed if one.kind == "rpp"}
        self.gravity = NONE
        #: By unknown the links on which it acts: the parts along x and y of a force of 1, and its moment.
        self.columns: dict[str, list[tuple[str, str, str, str]]] = {}
        self.drawn: list[Force | Torque] = []
        self.round_bars: list[str] = []
        #: Further facts in the words of the loops.
        self.dense: list[str] = []

    def write(self) -> list[str]:
        """Write all facts of force; return the lines of the variants."""
        self.read()
        self.write_sums()
        for placed in reversed(self.writer.placed):
            getattr(self, f"solve_{placed.kind}")(placed)
        return self.variants()

    # -- what is declared ----------------------------------------------------------------------------------------------

    def read(self) -> None:
        """Read gravity, masses and loads."""
        declared, within = self.writer.declared, self.writer.within
        if declared.get("gravity") is not None:
            if not declared.get("masses"):
                self.writer.problems.add("pulls at nothing", ("linkage", "gravity"), "declare masses=")
            with within("gravity"):
                self.gravity = self.vector(declared["gravity"], "gravity", "m s-2", "acceleration of gravity")
        bars = {link.name: BAR for link in self.writer.links if link.length}
        masses = bars if declared.get("masses") == BAR else declared.get("masses")
        for part, given, read in (
            ("masses", masses, self.read_mass),
            ("loads", declared.get("loads"), self.read_load),
        ):
            with within(part):
                if given is not None and not isinstance(given, Mapping):
                    raise InputError(f"is {short_repr(given)}", (), "write a mapping of links and points")
                for name, one in (given or {}).items():
                    with within(part, str(name)):
                        read(name, one)
        self.writer.problems.stop()

    def vector(self, given: Any, name: str, units: str, meaning: str) -> Pair:
        """Return the names of two inputs."""
        of = ((f"{name}_{axis}", f"{meaning}, {axis}") for axis in "xy")
        return self.writer.values((), given, "components: names of inputs, or numbers", *of, units=units)

    def body_of(self, name: str) -> tuple[Body, str]:
        """Return a link and no point, or the link of a point and that."""
        if (body := self.owner(name)) is not None:
            return body, name
        if name not in self.bodies:
            known = [*self.bodies, *self.writer.owners]
            for link in self.writer.links:
                if name == "".join(reversed(link.points[:2])):
                    raise InputError("is no link", (), f"write {link.name!r}: its axis is from {link.origin}")
            raise InputError("is no link and no point that moves", (), suggest(name, known))
        return self.bodies[name], ""

    def read_mass(self, name: str, given: Any) -> None:
        """Read the mass of a link, or one in a point."""
        value, (body, point) = self.writer.value, self.body_of(name)
        if point and given == BAR:
            raise InputError(f"is {BAR!r}, and {name} is a point", (), "write its mass")
        if point:
            mass = value((), given, f"mass_{name}", "kg", f"mass in {name}", "non-negative")
            self.need(body, point, scaled(mass, self.less_gravity(self.acceleration(point))))
            return
        assert body.link is not None
        if given == BAR and body.link.length:
            mass, inertia = self.round_bar(body.link)
            self.add_mass(body, mass, inertia, (f"0.5 * {body.link.length}", "0.0"))
            return
        if not isinstance(given, Mapping):
            raise InputError(f"is {short_repr(given)}", (), f"write {MASS}; {BAR!r} for a bar of two pins")
        for word in given:
            check_choice((word,), word, ("mass", "inertia", "centre"))
        for word in ("mass", "centre"):
            if word not in given:
                raise InputError(f"has no {word!r}", (), f"write {MASS}")
        mass = value(("mass",), given["mass"], f"mass_{name}", "kg", f"mass of {name}", "non-negative")
        inertia, about = "0.0", f"moment of inertia of {name}; about its mass centre"
        if "inertia" in given:
            inertia = value(("inertia",), given["inertia"], f"inertia_{name}", "kg m2", about, "non-negative")
        ways = (("u", "along"), ("v", "left of"))
        of = ((f"G_{name}_{axis}", f"mass centre of {name}, {way} its axis") for axis, way in ways)
        centre = self.writer.values(("centre",), given["centre"], COORDINATES, *of)
        self.add_mass(body, mass, inertia, centre)

    def round_bar(self, link: Link) -> Pair:
        """Return mass and moment of inertia of a round bar: inputs, in whose place the variant has formulas."""
        value, length, name = self.writer.value, link.length, link.name
        mass = value((), f"mass_{name}", "", "kg", f"mass of the bar {name}", "non-negative")
        about = f"moment of inertia of the bar {name}; about its middle"
        inertia = value((), f"inertia_{name}", "", "kg m2", about, "non-negative")
        self.round_bars += [
            f"{mass} [kg] m_{name}: mass of the bar {name}",
            f"    = density * PI * (radius * radius) * {length}",
            f"{inertia} [kg m2] I_{name}: {about}",
            f"    = {mass} * ({length} * {length} / 12.0 + 0.25 * (radius * radius))",
        ]
        return mass, inertia

    def read_load(self, name: str, given: Any) -> None:
        """Read a force on a point, or a torque on a link."""
        body, point = self.body_of(name)
        if point:
            x, y = self.vector(given, f"load_{name}", "N", f"load on {name}")
            self.need(body, point, (negative(x), negative(y)))
            return
        torque = self.writer.value((), given, f"load_{name}", "N m", f"load torque on {name}")
        for needs in (body.own, body.dense):
            needs[2].append(negative(torque))

    # -- what links need -----------------------------------------------------------------------------------------------

    def owner(self, point: str) -> Body | None:
        """Return the link that carries a point, None if it is the ground."""
        owner = self.writer.owners.get(point)
        return None if owner is None else self.bodies[owner if isinstance(owner, str) else owner.name]

    def acceleration(self, point: str) -> Pair:
        """Return the acceleration of a point as text."""
        return (f"{point}_ax", f"{point}_ay") if f"{point}_x" in self.writer.moving else NONE

    def less_gravity(self, acceleration: Pair) -> Pair:
        """Return an acceleration less that of gravity."""
        x, y = difference(acceleration, self.gravity)
        return (f"({x})" if " " in x else x), (f"({y})" if " " in y else y)

    def between(self, start: str, end: str) -> Pair:
        """Return a vector by the coordinates of points."""
        return NONE if start == end else difference(self.writer.points[end], self.writer.points[start])

    def lever(self, body: Body, point: str) -> Pair:
        """Return the vector from the first joint of a link to a point, by coordinates."""
        return NONE if body.link is None else self.between(body.at, point)

    def need(self, body: Body, point: str, force: Pair) -> None:
        """Let a link need a force in a point of it."""
        for needs, arm in ((body.own, body.arm(point)), (body.dense, self.between(body.at, point))):
            for part, text in zip(needs, (*force, moment(arm, force)), strict=True):
                part.append(text)

    def add_mass(self, body: Body, mass: str, inertia: str, place: Pair) -> None:
        """Let a link need what the acceleration of its mass does."""
        link = body.link
        assert link is not None
        turning = self.turns_as.get(link.name, link)
        spin, speed = f"alpha_{turning.name}", f"omega_{turning.name}"
        if not turning.angle or turning.angle == "theta":
            spin, speed = "0.0", "omega" if turning.angle else "0.0"
        first = self.less_gravity(self.acceleration(link.origin))

        def centre(axis: Pair) -> Pair:
            along, across = scaled(place[0], axis), scaled(place[1], left(axis))
            return plus(along[0], across[0]), plus(along[1], across[1])

        def force(arm: Pair) -> Pair:
            x = total((first[0], negative(times(spin, arm[1])), negative(times(times(speed, speed), arm[0]))))
            y = total((first[1], times(spin, arm[0]), negative(times(times(speed, speed), arm[1]))))
            return f"{mass} * ({x})", f"{mass} * ({y})"

        arm = (f"arm_{link.name}_x", f"arm_{link.name}_y")
        for name, text, axis in zip(arm, centre(link.axis), "xy", strict=True):
            head = f"step {name} [m] G_{axis}: Mass centre of {link.name} from {link.origin}, {axis}"
            self.writer.fact(head, f"= {total((text,))}")
        # the moment without the products of parallel vectors in that of the force
        squares = [
            f"{one} * {one}" if one.isidentifier() else f"({one}) * ({one})" for one in place if one != "0.0"
        ]
        inertia_about = f"({total((inertia, *(f'{mass} * ({one})' for one in squares)))})"
        own = (*force(arm), plus(times(inertia_about, spin), times(mass, moment(arm, first))))
        ends = self.between(link.origin, link.points[1]) if link.length else NONE
        of_ends = (f"({ends[0]}) / {link.length}", f"({ends[1]}) / {link.length}")
        x, y = centre(of_ends if link.length else of_facts(link.in_loops))
        whole = force((f"({x})", f"({y})"))
        dense = (*whole, plus(times(inertia, spin), moment((x, y), whole)))
        for needs, texts in ((body.own, own), (body.dense, dense)):
            for part, text in zip(needs, texts, strict=True):
                part.append(text)

    def write_sums(self) -> None:
        """Write what links need of themselves, and the sums of that: the torque, and what shakes the ground."""
        power, x, y, about = list[str](), list[str](), list[str](), list[str]()
        for body in self.bodies.values():
            if not body.own[0] and not body.own[2]:
                continue
            x_name, y_name, turning = self.parts("own", body, body.own, "of itself")
            force = x_name, y_name
            for name, terms in zip((*force, turning), body.own, strict=True):
                terms[:] = [name]
            rate = body.link.rate if body.link else ""
            power += [times(*pair) for pair in zip(force, self.writer.rate_of(body.at), strict=True)]
            power += [times(turning, rate)] if rate else []
            x.append(force[0])
            y.append(force[1])
            about += [turning, moment(self.writer.points[body.at], force)]
        if self.writer.placed[0].kind == "crank":
            crank = self.writer.links[1]
            head = f"torque [N m] T: Driving torque of the ground on the crank {crank.name}"
            self.writer.fact(head, f"= {total(power)}")
            self.drawn.append(Torque("torque", crank.origin))
            power = ["torque"]
        self.writer.fact(POWER, f"= omega * ({total(power)})")
        for line in self.shaking(*(list(map(negative, terms)) for terms in (x, y, about))):
            self.writer.facts.append(line)
        self.size("shaking_force", "F", "Shaking force of all links on the ground")

    @staticmethod
    def shaking(x: list[str], y: list[str], about: list[str]) -> list[str]:
        """Return the facts of what shakes the ground, as sums."""
        force = "[N] F: Shaking force of all links on the ground"
        found = []
        for head, terms in (
            (f"shaking_force_x {force}, x", x),
            (f"shaking_force_y {force}, y", y),
            ("shaking_moment [N m] M_0: Shaking moment on the ground about its origin", about),
        ):
            found += [head, f"    = {total(terms)}"]
        return found

    def parts(self, word: str, body: Body, sums: Iterable[list[str]], of: str) -> tuple[str, str, str]:
        """Write what a link needs, and return the names of that."""
        names = [f"{word}_{body.name}_{part}" for part, _ in PARTS]
        for name, terms, (part, units) in zip(names, sums, PARTS, strict=True):
            head = f"step {name} [{units}] {name}: What {body.name} needs {of}, {part}"
            self.writer.fact(head, f"= {total(terms)}")
        return names[0], names[1], names[2]

    def size(self, name: str, symbol: str, meaning: str) -> None:
        """Write the magnitude of a force."""
        self.writer.fact(
            f"{name} [N] |{symbol}|: {meaning}; its magnitude", f"= magnitude({name}_x, {name}_y)"
        )

    # -- joints --------------------------------------------------------------------------------------------------------

    def needs(self, body: Body) -> tuple[Pair, str]:
        """Return the force that the joints of a link have to give, and its moment about the first joint."""
        terms: tuple[list[str], ...] = tuple([*own] for own in body.own)
        for arm, force in body.carried:
            for part, text in zip(terms, (*force, moment(arm, force)), strict=True):
                part.append(text)
        terms[2].extend(body.turned)
        x, y, about = self.parts("need", body, terms, "of its joints")
        return (x, y), about

    def pin(self, on: Body, point: str, by: Body | None, force: Pair, giver: str = "") -> Pair:
        """Write the force on a link in a pin; the link that carries it takes the negative."""
        name, symbol = f"force_{on.name}_{point}", f"F_{on.name}{point}"
        meaning = f"Force on {on.name} at {point}{f', of {giver}' if giver else ''}"
        found = f"{name}_x", f"{name}_y"
        for axis, text, unknown, unit in zip(
            "xy", force, found, (("1.0", "0.0"), ("0.0", "1.0")), strict=True
        ):
            self.writer.fact(f"{unknown} [N] {symbol}{axis}: {meaning}, {axis}", f"= {text}")
            self.column(unknown, unit, point, on, by)
        self.size(name, symbol, meaning)
        self.drawn.append(Force(name, point))
        if by is not None and not giver:
            by.carried.append((by.arm(point), found))
        return found

    def guide(
        self, name: str, meaning: str, text: str, units: tuple[Pair, Pair], at: str, on: Body, by: Body | None
    ) -> Pair:
        """Write the force of a guide along a unit vector, as facts and in the loops; return it as a vector."""
        symbol = f"{'N' if name.startswith('normal') else 'F'}_{at}"
        self.writer.fact(f"{name} [N] {symbol}: {meaning}", f"= {text}")
        self.column(name, of_facts(units[1]), at, on, by)
        vectors = scaled(name, units[0]), scaled(name, of_facts(units[1]))
        for axis, part, dense in zip("xy", *vectors, strict=True):
            head = f"{name}_{axis} [N] {symbol}{axis}: {meaning}, {axis}"
            self.writer.fact(head, f"= {total((part,))}")
            self.dense += [head, f"    = {total((dense,))}"]
        self.drawn.append(Force(name, at))
        return f"{name}_x", f"{name}_y"

    def column(self, unknown: str, unit: Pair, point: str, on: Body, by: Body | None) -> None:
        """Note on what an unknown force along a unit vector acts, and from where."""
        found = self.columns.setdefault(unknown, [])
        found.append((on.name, *unit, moment(self.lever(on, point), unit)))
        arm = self.writer.points[point] if by is None else self.lever(by, point)
        name = self.ground if by is None else by.name
        found.append((name, negative(unit[0]), negative(unit[1]), negative(moment(arm, unit))))

    def of_line(self, line: Line) -> Body | None:
        """Return the link that a line is of, None if it is the ground."""
        return None if line.link is self.writer.links[0] else self.bodies[line.link.name]

    def carry_on(self, line: Line, point: str, force: Pair) -> None:
        """Let the link of a line take the negative of a force on a point of that line."""
        if (by := self.of_line(line)) is not None:
            start, along = line.link.vector(line.start), self.between(line.start, point)
            by.carried.append(((plus(start[0], along[0]), plus(start[1], along[1])), force))

    def solve_rrr(self, placed: Placed) -> None:
        """Write the joint forces of two bars."""
        one, other = (self.bodies[link.name] for link in placed.links)
        (a, d), b = placed.points, placed.name
        (x1, y1), about_a = self.needs(one)
        (x2, y2), about_d = self.needs(other)
        per = f"per_cross_{b}"
        (ux, uy), (wx, wy) = one.arm(b), other.arm(b)
        force = tuple(f"{about_d} * {per} * {u} + {about_a} * {per} * {w}" for u, w in ((ux, wx), (uy, wy)))
        x, y = self.pin(one, b, other, (force[0], force[1]), other.name)
        self.pin(one, a, self.owner(a), (f"{x1} - {x}", f"{y1} - {y}"))
        self.pin(other, d, self.owner(d), (f"{x2} + {x}", f"{y2} + {y}"))

    def solve_rrp(self, placed: Placed) -> None:
        """Write the joint forces of a bar and its slider on a line."""
        bar, (a,), (line,), b = self.bodies[placed.links[0].name], placed.points, placed.lines, placed.name
        slider = self.bodies[b]
        own, _ = self.needs(slider)
        (x1, y1), about_a = self.needs(bar)
        text = f"({about_a} + {moment(bar.arm(b), own)}) * per_ahead_{b}"
        meaning = f"Force of the guide on {b}, to the left of its line"
        force = self.guide(f"normal_force_{b}", meaning, text, across(line), b, slider, self.of_line(line))
        x, y = self.pin(bar, b, slider, difference(force, own), f"the slider {b}")
        self.pin(bar, a, self.owner(a), (f"{x1} - {x}", f"{y1} - {y}"))
        self.carry_on(line, b, force)

    def solve_rpr(self, placed: Placed) -> None:
        """Write the joint forces of a link along whose slot a pin slides."""
        link, (a, d) = placed.links[0], placed.points
        lever, carrier, name = self.bodies[link.name], self.owner(a), f"normal_force_{placed.name}"
        need, about_d = self.needs(lever)
        meaning = f"Force of {a} on {placed.name}, to the left of its slot"
        units = left(link.axis), left(link.in_loops)
        force = self.guide(name, meaning, f"{about_d} / {placed.by}", units, a, lever, carrier)
        if carrier is not None:
            carrier.carried.append((carrier.arm(a), force))
        self.pin(lever, d, self.owner(d), difference(need, force))

    def solve_rpp(self, placed: Placed) -> None:
        """Write the forces of a slider on a line, in whose slot a pin slides."""
        (a,), (line,), y, angle = placed.points, placed.lines, placed.name, placed.by
        slider, carrier, rail = self.bodies[placed.links[0].name], self.owner(a), self.of_line(line)
        force, about = self.needs(slider)
        slot, normal, turning = f"slot_force_{y}", f"normal_force_{y}", f"guide_moment_{y}"

        def slotted(unit: Pair) -> Pair:
            """Return the unit vector to the left of the slot."""
            if not angle:
                return negative(unit[0]), negative(unit[1])
            c, s = scaled(f"cosine({angle})", left(unit)), scaled(f"sine({angle})", unit)
            return f"({minus(c[0], s[0])})", f"({minus(c[1], s[1])})"

        along, off = (
            total(times(one, by) for one, by in zip(force, scaled("1.0", unit), strict=True))
            for unit in (line.unit, left(line.unit))
        )
        per, rest = (f" / sine({angle})", f" - {slot} * cosine({angle})") if angle else ("", "")
        units = slotted(line.unit), slotted(line.in_loops)
        meaning = f"Force of {a} on {y}, to the left of the slot"
        pushed = self.guide(slot, meaning, f"-({along}){per}", units, a, slider, carrier)
        meaning = f"Force of the guide on {y}, to the left of its line"
        held = self.guide(normal, meaning, off + rest, across(line), y, slider, rail)
        head = f"{turning} [N m] M_{y}: Moment of the guide on {y}, about {y}"
        self.writer.fact(head, f"= {minus(about, moment(self.between(y, a), pushed))}")
        self.turn(turning, (slider, "1.0"), (rail, "-1.0"))
        if carrier is not None:
            carrier.carried.append((carrier.arm(a), pushed))
        if rail is not None:
            self.carry_on(line, y, held)
            rail.turned.append(turning)

    def solve_prp(self, placed: Placed) -> None:
        """Write the forces of two lines on a pin."""
        pin = self.bodies[placed.name]
        force, _ = self.needs(pin)
        first, second = placed.lines
        for word, line, other in (("first", first, second), ("second", second, first)):
            name = f"{word}_force_{pin.name}"
            along = total(times(*pair) for pair in zip(force, other.unit, strict=True))
            text = f"{'' if line is first else '-'}({along}) / cross_{pin.name}"
            meaning = f"Force of the {word} line on {pin.name}, to its left"
            found = self.guide(name, meaning, text, across(line), pin.name, pin, self.of_line(line))
            self.carry_on(line, pin.name, found)

    def solve_gear(self, placed: Placed) -> None:
        """Write the force and the torque on a bar that a gear or a belt turns."""
        (bar, driver, arm), (pivot,), ratio = placed.links, placed.points, float(placed.by)
        body = self.bodies[bar.name]
        force, about = self.needs(body)
        self.pin(body, pivot, self.owner(pivot), force)
        name = f"torque_{bar.name}"
        self.writer.fact(f"{name} [N m] T_{bar.name}: Torque of the gear or belt on {bar.name}", f"= {about}")
        given: list[tuple[Body | None, str]] = [(body, "1.0")]
        for link, factor in ((driver, ratio), (arm, 1.0 - ratio)):
            if (by := self.bodies.get(link.name)) is not None:
                by.turned.append(f"{factor} * {name}")
            given.append((by, f"{-factor}"))
        self.turn(name, *given)

    def solve_crank(self, placed: Placed) -> None:
        """Write the force on the crank; its torque is that of the power."""
        crank = self.bodies[placed.links[0].name]
        force, _ = self.needs(crank)
        self.pin(crank, placed.points[0], None, force)
        self.turn("torque", (crank, "1.0"), (None, "-1.0"))

    def solve_slider(self, placed: Placed) -> None:
        """Write the forces on the slider that drives."""
        slider, (line,), name = self.bodies[placed.name], placed.lines, placed.name
        force, _ = self.needs(slider)
        for unknown, of, units in (
            (f"driving_force_{name}", "what drives, along its line", (line.unit, line.in_loops)),
            (f"normal_force_{name}", "the guide, to the left of its line", across(line)),
        ):
            along = total(times(*pair) for pair in zip(force, scaled("1.0", units[0]), strict=True))
            self.guide(unknown, f"Force on {name} of {of}", along, units, name, slider, None)

    def turn(self, unknown: str, *on: tuple[Body | None, str]) -> None:
        """Note on what an unknown moment acts."""
        self.columns[unknown] = [
            (body.name if body else self.ground, "0.0", "0.0", sign) for body, sign in on
        ]

    # -- all links at once ---------------------------------------------------------------------------------------------

    def variants(self) -> list[str]:
        """Return the lines of the variants: round bars, and the one that solves the equations of all links."""
        rows = []
        for body in self.bodies.values():
            for k, value in enumerate(body.dense[: 3 if body.link else 2], 1):
                factors = (total(one[k] for one in on if one[0] == body.name) for on in self.columns.values())
                texts = ("0.0" if one == NOTHING else one for one in factors)
                rows.append(f"    | {', '.join((*texts, total(value)))}")
        shaking = ([], [], [])  # type: tuple[list[str], ...]
        for unknown, on in self.columns.items():
            for name, *parts in on:
                if name == self.ground:
                    for terms, factor in zip(shaking, parts, strict=True):
                        sign, factor = ("-", factor[1:]) if factor[0] == "-" else ("", factor)
                        terms.append("0.0" if factor == "0.0" else f"{sign}{times(unknown, factor)}")
        head = f"system reactions: {', '.join(self.columns)}"
        lines = [*ROUND_BARS, *self.round_bars] if self.round_bars else []
        lines += ["[variant dense]", head, *rows, *self.dense, *self.shaking(*shaking)]
        if (drive := self.writer.placed[0]).kind == "slider":
            lines += [POWER, f"    = driving_force_{drive.name} * slide_{drive.name}_rate"]
        return lines
