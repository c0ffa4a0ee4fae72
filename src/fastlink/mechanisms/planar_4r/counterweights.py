"""Counterweights on the crank and on the output link, as point masses.

Each belongs to its link: it changes the link's mass, mass centre and moment of inertia, nothing else. Its
direction is that of the link's frame: pi (the default) is opposite to the link.
"""

from __future__ import annotations

from typing import Any

from fastlink.mechanisms.planar_4r import loads  # noqa: F401 (declares what is replaced)
from fastlink.mechanisms.planar_4r.declare import HAYES, LINKS, build_on, planar_4r, plus
from fastlink.numerics.elementary import PI, cosine, select, sine

COUNTERWEIGHTS = f"{HAYES}, Fig. 2, with counterweights"


def along(mass: Any, radius: Any, direction: Any) -> Any:
    """Mass times radius of a counterweight, along the link."""
    return (mass * radius) * cosine(direction)


def across(mass: Any, radius: Any, direction: Any) -> Any:
    """Mass times radius of a counterweight, to the left of the link."""
    return (mass * radius) * sine(direction)


def spin(mass: Any, radius: Any) -> Any:
    """Moment of inertia of a counterweight about the link's fixed pivot."""
    return mass * (radius * radius)


def fact(number: int, name: str, units: str, symbol: str, law: Any, **given: str) -> None:
    """Declare a fact that holds with the counterweight of one link."""
    planar_4r.quantity(
        units=units,
        symbol=symbol,
        source=COUNTERWEIGHTS,
        internal=True,
        alternative=f"counterweight{number}",
        name=name,
        given=given,
    )(law)


for _i in (1, 3):
    for _name, _units, _symbol, _meaning, _rule, _default in (
        ("mass", "kg", "m", "mass", "non-negative", None),
        ("radius", "m", "r", "distance from the link's fixed pivot", "non-negative", None),
        ("direction", "rad", "psi", "direction in the link's frame", "any", PI),
    ):
        planar_4r.input(
            f"counterweight{_i}_{_name}",
            units=_units,
            symbol=f"{_symbol}_W{_i}",
            meaning=f"counterweight on the {LINKS[_i]}: {_meaning}",
            rule=_rule,  # type: ignore[arg-type]
            alternative=f"counterweight{_i}",
            default=_default,
        )
    _inputs = {name: f"counterweight{_i}_{name}" for name in ("mass", "radius", "direction")}
    _massive = {name: _inputs[name] for name in ("mass", "radius")}
    fact(_i, f"counterweight{_i}_along", "kg m", f"m_W{_i} r cos psi", along, **_inputs)
    fact(_i, f"counterweight{_i}_across", "kg m", f"m_W{_i} r sin psi", across, **_inputs)
    fact(_i, f"counterweight{_i}_spin", "kg m2", f"m_W{_i} r^2", spin, **_massive)
    build_on(f"counterweight{_i}", f"mass{_i}", plus, further=f"counterweight{_i}_mass")


# -- on the crank ---------------------------------------------------------------------------------


def inward(replaced: Any, omega1_squared: Any, further: Any) -> Any:
    """Rate of momentum of the crank with its counterweight, in the crank's frame."""
    return replaced - omega1_squared * further


for _axis, _where in (("u", "along"), ("v", "across")):
    build_on("counterweight1", f"m1_G1_{_axis}", plus, further=f"counterweight1_{_where}")
    build_on("counterweight1", f"crank_force_{_where}", inward, further=f"counterweight1_{_where}")
build_on("counterweight1", "I1_O", plus, further="counterweight1_spin")


# -- on the output link ---------------------------------------------------------------------------


def plus_quotient(replaced: Any, further: Any, length: Any) -> Any:
    """Add a term over a length."""
    return replaced + further / length


for _where in ("along", "across"):
    build_on(
        "counterweight3", f"m3_G3_{_where}", plus_quotient, further=f"counterweight3_{_where}", length="a3"
    )
build_on("counterweight3", "I3_D", plus, further="counterweight3_spin")


# -- mass centres, which eq. (9) is about -----------------------------------------------------------


def reciprocal(whole: Any) -> Any:
    """Reciprocal of a link's whole mass; zero for a link without mass, whose mass centre is its fixed pivot."""
    return select(whole > 0.0, 1.0 / select(whole > 0.0, whole, 1.0), 0.0)


def centre(part: Any, per_mass: Any) -> Any:
    """Mass centre of a link with its counterweight, from its fixed pivot."""
    return part * per_mass


def leaning(part: Any, per_mass: Any, length: Any) -> Any:
    """Cross product of the mass centre of the output link with its counterweight and B, both from D."""
    return -((part * per_mass) * (length * length))


def about_centre(
    replaced: Any, own: Any, mass: Any, per_mass: Any, radius: Any, direction: Any, G_u: Any, G_v: Any
) -> Any:
    """Moment of inertia of a link with its counterweight about their mass centre."""
    u = G_u - radius * cosine(direction)
    v = G_v - radius * sine(direction)
    return replaced + ((own * per_mass) * mass) * (u * u + v * v)


for _i, _pivot in ((1, "O"), (3, "D")):
    fact(_i, f"per_mass{_i}", "kg-1", f"1/m_{_i}", reciprocal, whole=f"mass{_i}")
    for _axis in "xy":
        _given = {"part": f"m{_i}_{_pivot}G_{_axis}", "per_mass": f"per_mass{_i}"}
        fact(_i, f"{_pivot}G_{_axis}", "m", f"{_pivot}G_{_i}{_axis}", centre, **_given)
    _given = {name: f"counterweight{_i}_{name}" for name in ("mass", "radius", "direction")}
    _given |= {"own": f"m{_i}", "per_mass": f"per_mass{_i}", "G_u": f"G{_i}_u", "G_v": f"G{_i}_v"}
    build_on(f"counterweight{_i}", f"I{_i}_G", about_centre, **_given)
fact(3, "DG_cross_DB", "m2", "DG_3 x DB", leaning, part="m3_G3_across", per_mass="per_mass3", length="a3")
