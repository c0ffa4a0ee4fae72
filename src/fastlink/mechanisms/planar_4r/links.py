"""Links made of a round bar: masses, inertias and mass centres from the lengths."""

from __future__ import annotations

from typing import Any

from fastlink.mechanisms.planar_4r.inputs import HAYES, LINKS, planar_4r
from fastlink.numerics.elementary import PI

ROUND_BAR = "round_bar"
SOURCE = f"{HAYES}, Table 1"

planar_4r.input(
    "density",
    units="kg m-3",
    symbol="rho",
    meaning="density of the round bars",
    rule="non-negative",
    variant=ROUND_BAR,
)
planar_4r.input(
    "radius",
    units="m",
    symbol="r",
    meaning="radius of the round bars",
    rule="non-negative",
    variant=ROUND_BAR,
)


@planar_4r.quantity(units="kg m-1", symbol="rho pi r^2", source=SOURCE, internal=True, variant=ROUND_BAR)
def bar_mass_per_length(density: Any, radius: Any) -> Any:
    """Mass of a round bar per length."""
    return density * PI * (radius * radius)


@planar_4r.quantity(units="m2", symbol="r^2/4", source=SOURCE, internal=True, variant=ROUND_BAR)
def bar_section(radius: Any) -> Any:
    """Squared radius of gyration of the round section about a diameter."""
    return 0.25 * (radius * radius)


def bar_mass(length: Any, bar_mass_per_length: Any) -> Any:
    """Mass of a solid cylinder."""
    return bar_mass_per_length * length


def bar_inertia(mass: Any, length: Any, bar_section: Any) -> Any:
    """Moment of inertia of a solid cylinder about a transverse axis through its centre."""
    return mass * (length * length / 12.0 + bar_section)


def mid_length(length: Any) -> Any:
    """Half the length."""
    return 0.5 * length


def on_axis(length: Any) -> Any:
    """Zero, in the length's unit and reading."""
    return 0.0 * length


bar = planar_4r.quantities(units="m", source=SOURCE, variant=ROUND_BAR)
for _i, _link in LINKS.items():
    _a, _m = f"a{_i}", f"m{_i}"
    bar(bar_mass, _m, f"m_{_i}", f"mass of the {_link}", length=_a, units="kg")
    bar(
        bar_inertia,
        f"I{_i}",
        f"I_{_i}",
        f"moment of inertia of the {_link} about its centre",
        mass=_m,
        length=_a,
        units="kg m2",
    )
    bar(mid_length, f"G{_i}_u", f"G_{_i}u", f"mass centre of the {_link} at mid-length", length=_a)
    bar(on_axis, f"G{_i}_v", f"G_{_i}v", f"mass centre of the {_link} on its axis", length=_a)
