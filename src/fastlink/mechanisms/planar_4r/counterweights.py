"""Counterweights on the crank and on the output link, as point masses.

Each belongs to its link: it changes the link's mass, mass centre and moment of inertia, nothing else. Its
direction is that of the link's frame: pi (the default) is opposite to the link.
"""

from __future__ import annotations

from functools import partial
from typing import Any

from fastlink.mechanisms._shared.laws import product
from fastlink.mechanisms.planar_4r import loads  # noqa: F401 (declares what is replaced)
from fastlink.mechanisms.planar_4r.inputs import HAYES, LINKS, build_on, planar_4r, plus
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


def declare_counterweight(link: int) -> None:
    """Declare the counterweight of one link, and the terms that it adds to either link."""
    name = f"counterweight{link}"
    mass, radius, direction = f"{name}_mass", f"{name}_radius", f"{name}_direction"
    given = partial(planar_4r.input, variant=name)
    on = f"counterweight on the {LINKS[link]}"
    given(mass, units="kg", symbol=f"m_W{link}", meaning=f"{on}: mass", rule="non-negative")
    distance, angle = f"{on}: distance from the link's fixed pivot", f"{on}: direction in the link's frame"
    given(radius, units="m", symbol=f"r_W{link}", meaning=distance, rule="non-negative")
    given(direction, units="rad", symbol=f"psi_W{link}", meaning=angle, default=PI)
    step = planar_4r.steps(units="kg m", source=COUNTERWEIGHTS, variant=name)
    step(along, f"{name}_along", f"m_W{link} r cos psi", mass=mass, radius=radius, direction=direction)
    step(across, f"{name}_across", f"m_W{link} r sin psi", mass=mass, radius=radius, direction=direction)
    step(spin, f"{name}_spin", f"m_W{link} r^2", mass=mass, radius=radius, units="kg m2")
    build_on(name, f"mass{link}", plus, further=mass)


declare_counterweight(1)
declare_counterweight(3)


# -- on the crank ---------------------------------------------------------------------------------


def inward(replaced: Any, omega1_squared: Any, further: Any) -> Any:
    """Rate of momentum of the crank with its counterweight, in the crank's frame."""
    return replaced - omega1_squared * further


build_on("counterweight1", "m1_G1_u", plus, further="counterweight1_along")
build_on("counterweight1", "m1_G1_v", plus, further="counterweight1_across")
build_on("counterweight1", "crank_force_along", inward, further="counterweight1_along")
build_on("counterweight1", "crank_force_across", inward, further="counterweight1_across")
build_on("counterweight1", "I1_O", plus, further="counterweight1_spin")


# -- on the output link ---------------------------------------------------------------------------


def plus_quotient(replaced: Any, further: Any, length: Any) -> Any:
    """Add a term over a length."""
    return replaced + further / length


build_on("counterweight3", "m3_G3_along", plus_quotient, further="counterweight3_along", length="a3")
build_on("counterweight3", "m3_G3_across", plus_quotient, further="counterweight3_across", length="a3")
build_on("counterweight3", "I3_D", plus, further="counterweight3_spin")


# -- mass centres, which eq. (9) is about -----------------------------------------------------------


def reciprocal(whole: Any) -> Any:
    """Reciprocal of a link's whole mass; zero for a link without mass, whose mass centre is its fixed pivot."""
    return select(whole > 0.0, 1.0 / select(whole > 0.0, whole, 1.0), 0.0)


def about_centre(
    replaced: Any, own: Any, mass: Any, per_mass: Any, radius: Any, direction: Any, G_u: Any, G_v: Any
) -> Any:
    """Moment of inertia of a link with its counterweight about their mass centre."""
    u = G_u - radius * cosine(direction)
    v = G_v - radius * sine(direction)
    return replaced + ((own * per_mass) * mass) * (u * u + v * v)


def declare_centre(link: int, centre: str, moment: str, symbol: str, units: str) -> None:
    """Declare both components of a link's mass centre with its counterweight, and the moment of inertia about it."""
    name, per_mass = f"counterweight{link}", f"per_mass{link}"
    step = planar_4r.steps(units=units, source=COUNTERWEIGHTS, variant=name)
    step(reciprocal, per_mass, f"1/m_{link}", whole=f"mass{link}", units="kg-1")
    meaning = "Mass centre of a link with its counterweight, from its fixed pivot"
    for part in ("x", "y") if units == "m" else ("along", "across"):
        step(product, centre + part, symbol + part, meaning, x=moment + part, y=per_mass)
    own = {"own": f"m{link}", "per_mass": per_mass, "G_u": f"G{link}_u", "G_v": f"G{link}_v"}
    given = {part: f"{name}_{part}" for part in ("mass", "radius", "direction")}
    build_on(name, f"I{link}_G", about_centre, **own, **given)


declare_centre(1, "OG_", "m1_OG_", "OG_1", "m")
declare_centre(3, "DG_", "m3_G3_", "DG_3/a_3 ", "1")
