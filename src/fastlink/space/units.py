"""Units of a designer's own, by names such as ``a1_mm`` and ``omega1_rpm``, and what texts of units mean."""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Container, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fastlink._text import short_repr
from fastlink.errors import InputError, KeyPath, Problems, remark
from fastlink.numerics.compensated import two_product, two_sum

PI = Fraction("3.14159265358979323846264338327950288419716939937510582097494459230781640628620899862803")
#: Units: how each is written, first as in names such as ``a1_mm``; of what it is a multiple, and of how much of it.
TABLE: tuple[tuple[str, str, Fraction], ...] = (
    ("m meter metre meters metres", "m", Fraction(1)),
    ("mm millimeter millimetre millimeters millimetres", "m", Fraction(1, 1000)),
    ("cm centimeter centimetre centimeters centimetres", "m", Fraction(1, 100)),
    ("um µm μm micrometer micrometre micron", "m", Fraction(1, 10**6)),
    ("in inch inches", "m", Fraction("0.0254")),
    ("ft foot feet", "m", Fraction("0.3048")),
    ("rad radian radians", "rad", Fraction(1)),
    ("deg degree degrees °", "rad", PI / 180),
    ("turn turns rev", "rad", 2 * PI),
    ("s second seconds", "s", Fraction(1)),
    ("rpm", "rad s-1", PI / 30),
    ("kg kilogram kilograms", "kg", Fraction(1)),
    ("g gram grams", "kg", Fraction(1, 1000)),
    ("lb lbs pound pounds", "kg", Fraction("0.45359237")),
    ("N newton newtons", "N", Fraction(1)),
    ("mN", "N", Fraction(1, 1000)),
    ("kN", "N", Fraction(1000)),
    ("lbf", "N", Fraction("4.4482216152605")),
    ("Nm", "N m", Fraction(1)),
    ("Nmm", "N m", Fraction(1, 1000)),
    ("W watt watts", "W", Fraction(1)),
    ("mW", "W", Fraction(1, 1000)),
    ("kW", "W", Fraction(1000)),
)
#: What is measured in a unit of SI, as messages and studies say it; and in what most often, besides, as in names.
KINDS = {
    "m": ("length", "mm"),
    "rad": ("angle", "deg"),
    "rad s-1": ("speed", "rpm"),
    "kg": ("mass", "g"),
    "kg m-3": ("density", "g_cm3"),
    "kg m2": ("inertia", "kg_mm2"),
    "N": ("force", "kN"),
    "N m": ("torque", "Nmm"),
    "W": ("power", "kW"),
}
RADIANS, DEGREES = "rad", frozenset({"deg", "degree", "degrees", "°"})
#: A unit with its power, and what stands before it.
TOKEN = re.compile(r"([/*·._ ]*)([^\W\d_]+|°)(?:\^|\*\*)?(-?\d?)")
#: The powers of the units of SI of which each unit is a multiple, and of how much of them; how names write it.
UNITS = {
    text: ({base: int(power or 1) for _, base, power in TOKEN.findall(of)}, factor, texts.split()[0])
    for texts, of, factor in TABLE
    for text in texts.split()
}


@dataclass(frozen=True, eq=False)
class InUnit:
    """Input positions in a unit of its own, in place of an array in that of SI."""

    values: Any
    unit: str


# -- What texts of units mean, and names that end in one


@lru_cache(maxsize=1024)
def _parts(text: str) -> tuple[tuple[str, int], ...] | None:
    """Return the units of a text with their powers: of ``g/cm3``, of ``g cm-3`` as CF writes it; None of others."""
    found, rest = [], text.strip()
    rest = "" if rest in ("1", "dimensionless") else rest.removeprefix("1") if rest[:2] == "1/" else rest
    while rest:
        token = TOKEN.match(rest)
        if token is None or token[2] not in UNITS or token[3] == "-":
            return None
        found.append((token[2], int(token[3] or 1) * (-1 if "/" in token[1] else 1)))
        rest = rest[token.end() :]
    return tuple(found)


def is_unit(text: object) -> bool:
    """Tell whether a text is a unit, or a product of some."""
    return isinstance(text, str) and _parts(text) is not None


@lru_cache(maxsize=1024)
def factor_of(text: str, units: str) -> Fraction | None:
    """Return by what numbers in one unit are multiplied to be in another of its kind, 1/1000 of mm in m; else None.

    A unit as in names has no signs: those of ``g_cm3`` are those of its kind.
    """
    parts, others = _parts(text), _parts(units)
    if parts is None or others is None:
        return None
    wanted, divisor = _in_si(others, [1] * len(others))
    for signs in product((1, -1), repeat=len(parts) if "_" in text else 0):
        powers, factor = _in_si(parts, signs or [1] * len(parts))
        if powers == wanted:
            return factor / divisor
    return None


def _in_si(parts: Sequence[tuple[str, int]], signs: Sequence[int]) -> tuple[dict[str, int], Fraction]:
    """Return the powers of units of SI of which a product of units is a multiple, and of how much."""
    powers, factor = Counter[str](), Fraction(1)
    for (unit, power), sign in zip(parts, signs, strict=True):
        of, one, _ = UNITS[unit]
        factor *= one ** (sign * power)
        for base, times in of.items():
            powers[base] += sign * power * times
    return {base: power for base, power in powers.items() if power}, factor


def split(name: str, known: Container[Any]) -> tuple[str, str]:
    """Return the known name and the unit that make another name, a1 and mm of a1_mm; others as they are, and ""."""
    if isinstance(name, str) and name not in known:
        pieces = name.split("_")
        for at in range(len(pieces) - 1, 0, -1):
            of, unit = "_".join(pieces[:at]), "_".join(pieces[at:])
            if _parts(unit) and of in known:
                return of, unit
    return name, ""


def ends_in_unit(name: str, units: str) -> tuple[str, str]:
    """Return the name and the unit that a name is made of, F and kN of F_kN, if that is of a kind and not of SI."""
    pieces = name.split("_")
    of, unit = split(name, {"_".join(pieces[:at]) for at in range(1, len(pieces))})
    return (of, unit) if unit and factor_of(unit, units) not in (None, 1) else (name, "")


def with_unit(name: str, unit: str) -> str:
    """Return the name by which something is given in a unit: density_g_cm3 in g/cm3."""
    powers = [(UNITS[one][2], abs(power)) for one, power in _parts(unit) or ()]
    return "_".join([name, *(one if power == 1 else f"{one}{power}" for one, power in powers)])


#: A number and what may be its unit.
QUANTITY = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*([^\d\s].*?)\s*")


def named_with_unit(name: str, value: object, *, shown: bool = True) -> str:
    """Return the remedy for a number that is given as a text with its unit, such as 40 mm; empty for others."""
    found = QUANTITY.fullmatch(value) if isinstance(value, str) else None
    if found is None or not is_unit(found[2]):
        return ""
    named = name.removesuffix(with_unit("", found[2]))
    if any(UNITS[part][1] != 1 for part, _ in _parts(found[2]) or ()):  # of SI none need stand in the name
        named = with_unit(named, found[2])
    return f"write {named}{f'={found[1]}' if shown else ', and numbers alone'}"


def usual_name(name: str, units: str) -> str:
    """Return the name of an input or a result in the unit that is most usual besides, a1_mm of a1; else its own."""
    return f"{name}_{KINDS[units][1]}" if units in KINDS else name


def in_words(unit: str) -> str:
    """Return a unit as messages say it."""
    return "degrees" if unit in DEGREES else unit


def comment(unit: str) -> str:
    """Return the comment of a coordinate whose values were converted."""
    return f"given in {in_words(unit)}"


def check_unit(of: str, unit: str, units: str, others: dict[str, str] | None = None) -> Fraction:
    """Return what a unit is in that of an input, 1 without one, or refuse another kind, or a second value.

    The others are known by the inputs that they are, and this one is added.
    """
    if not unit:
        return Fraction(1)
    factor = factor_of(unit, units)
    if factor is None:
        nouns = (noun for one, (noun, _) in KINDS.items() if factor_of(unit, one) is not None)
        no = f"no {noun}" if (noun := next(nouns, "")) else f"not in {unit}"
        own, usual = "a plain number" if units == "1" else f"in {units}", usual_name(of, units)
        remedy = f"write {of}" if usual == of else f"write {of}, or such as {usual}"
        raise InputError(f"{of} is {no} but {own}", remedy=remedy)
    if others is not None and of in others:
        raise InputError(f"{others[of]} is given too", remedy="write one of them")
    if others is not None:
        others[of] = with_unit(of, unit)
    return factor


def in_si(where: str, given: Mapping[str, Any], units: Mapping[str, str]) -> dict[str, Any]:
    """Return numbers, or pairs of them, by plain names and in the units of these; what is no number as it is."""
    found, problems, others = dict[str, Any](), Problems(), {name: name for name in given}
    for name, value in given.items():
        of, unit = split(name, units)
        with problems.at(where, name):
            factor = check_unit(of, unit, units.get(of, "1"), others)
            try:
                found[of] = value if factor == 1 else scaled(value, factor).tolist()
            except (TypeError, ValueError):
                found[of] = value
    problems.stop()
    return found


def conversion(
    of: str, unit: str, stated: str, expected: str, others: dict[str, str] | None = None, where: KeyPath = ()
) -> tuple[Fraction, str]:
    """Return what the unit of values is in that of their input, and that unit: of their name, or that they state.

    Values in another unit than their name says are refused.
    """
    factor = check_unit(of, unit, expected, others)
    if stated and not has_unit(stated, unit or expected):
        if unit or (found := factor_of(stated, expected)) is None:
            wanted = in_words(unit or expected)
            remedy = f"convert it to {wanted}, or leave the unit (the attribute 'units') out"
            raise InputError(f"has the unit {stated!r}", where, remedy)
        return found, stated
    return factor, unit


def has_unit(unit: str, expected: str) -> bool:
    """Tell whether labelled values state the unit that is expected, by whatever spelling."""
    plain = unit.translate(str.maketrans("", "", "^* ."))
    return plain == expected.replace(" ", "") or factor_of(unit, expected) == 1


# -- Values in another unit, each rounded once


#: Numbers beyond are shifted by a power of two, for Veltkamp's splitting would leave the range of doubles.
GREAT, SMALL, SHIFT = 1e290, 1e-200, 256


def scaled(values: Any, factor: Fraction) -> Any:
    """Return a multiple of doubles, rounded once, if not below 1e-307: 180 degrees are pi, 400 mm are 0.4 m."""
    # from 100 bits of the factor, which decide: a product with one of the table is nearer to no middle of two doubles
    numbers = np.asarray(values, dtype=np.float64)
    if factor == 1:
        return numbers[()]
    high = float(factor)
    low = float(factor - Fraction(high))
    with np.errstate(all="ignore"):
        size = abs(numbers)
        scale = np.where(size > GREAT, 2.0**-SHIFT, np.where(size < SMALL, 2.0**SHIFT, 1.0))
        whole, rest = two_product(numbers * scale, high)
        total, _ = two_sum(whole, rest + numbers * scale * low)
        # -0.0 and what is not finite as they are
        return np.where((size > 0.0) & (size < np.inf), total / scale, numbers)[()]


# -- Warn of numbers that can hardly be meant in units of SI


#: Whole numbers of at least so much are no usual angles in radians, and multiples of 30 are usual ones in degrees.
BEYOND, STEP_OF_DEGREES, MOST_DEGREES = 10.0, 30.0, 36000.0
#: Links longer than so much beside a bar thinner than so much, in m, are in mm.
LONG, THIN = 50.0, 0.1


def looks_like_degrees(values: Any) -> bool:
    """Tell whether numbers can hardly be radians by their size: whole ones, or up to a multiple of 30."""
    if isinstance(values, (bytes, bytearray, memoryview)):
        return False  # refused as such
    try:
        numbers: NDArray[Any] = np.asarray(values, dtype=np.float64)
    except Exception:  # whatever a class of somebody's does when it is converted
        return False
    if not numbers.size:
        return False
    most = float(abs(numbers).max())
    if not BEYOND <= most <= MOST_DEGREES:
        return False
    return most % STEP_OF_DEGREES == 0.0 or bool((numbers % 1.0 == 0.0).all())


def remark_on_angles(name: str, values: Any, *where: str) -> None:
    """Warn of angles that can hardly be meant as radians."""
    if looks_like_degrees(values):
        what = f"{short_repr(np.asarray(values).tolist())} is taken as radians"
        remark(what, (*where, name), f"if these are degrees, write {usual_name(name, RADIANS)}")


def remark_on_lengths(values: Mapping[str, Any], *where: str) -> None:
    """Warn of lengths, among which is the radius of bars, that can hardly be meant in m."""
    thinnest = values.get("radius", THIN)
    longest = max((one for name, one in values.items() if name != "radius"), default=math.inf)
    if thinnest > longest > 0.0:
        remedy = f"if it is in mm, write {usual_name('radius', 'm')}; round_bar takes density, then radius"
        remark(f"is {thinnest:g} m, of bars up to {longest:g} m long", (*where, "radius"), remedy)
    for name, longest in values.items() if thinnest < THIN else ():
        if longest > LONG:
            what = f"is up to {longest:g} m, of bars with a radius of {thinnest:g} m"
            remark(what, (*where, name), f"if these are mm, write {usual_name(name, 'm')}")
            return
