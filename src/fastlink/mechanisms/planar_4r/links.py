"""Links made of a round bar: masses, inertias and mass centres from the lengths."""

from __future__ import annotations

from typing import Any

from fastlink.mechanisms.planar_4r.declare import HAYES, planar_4r

ROUND_BAR = "round_bar"
SOURCE = f"{HAYES}, Table 1"

planar_4r.input(
    "density",
    units="kg m-3",
    symbol="rho",
    meaning="density of the round bars",
    rule="non-negative",
    alternative=ROUND_BAR,
)
planar_4r.input(
    "radius",
    units="m",
    symbol="r",
    meaning="radius of the round bars",
    rule="non-negative",
    alternative=ROUND_BAR,
)


@planar_4r.quantity(units="kg m-1", symbol="rho pi r^2", source=SOURCE, internal=True, alternative=ROUND_BAR)
def bar_mass_per_length(density: Any, radius: Any) -> Any:
    """Mass of a round bar per length."""
    return density * 3.141592653589793 * (radius * radius)


@planar_4r.quantity(units="m2", symbol="r^2/4", source=SOURCE, internal=True, alternative=ROUND_BAR)
def bar_section(radius: Any) -> Any:
    """Squared radius of gyration of the round section about a diameter."""
    return 0.25 * (radius * radius)


@planar_4r.quantity(units="kg", symbol="m_1", source=SOURCE, alternative=ROUND_BAR)
def m1(a1: Any, bar_mass_per_length: Any) -> Any:
    """Mass of the crank, a solid cylinder."""
    return bar_mass_per_length * a1


@planar_4r.quantity(units="kg m2", symbol="I_1", source=SOURCE, alternative=ROUND_BAR)
def I1(m1: Any, a1: Any, bar_section: Any) -> Any:
    """Moment of inertia of the crank, a solid cylinder, about its mass centre."""
    return m1 * (a1 * a1 / 12.0 + bar_section)


@planar_4r.quantity(units="m", symbol="G_1u", source=SOURCE, alternative=ROUND_BAR)
def G1_u(a1: Any) -> Any:
    """Mass centre of the crank at mid-length."""
    return 0.5 * a1


@planar_4r.quantity(units="m", symbol="G_1v", source=SOURCE, alternative=ROUND_BAR)
def G1_v(a1: Any) -> Any:
    """Mass centre of the crank on its axis."""
    return 0.0 * a1


@planar_4r.quantity(units="kg", symbol="m_2", source=SOURCE, alternative=ROUND_BAR)
def m2(a2: Any, bar_mass_per_length: Any) -> Any:
    """Mass of the coupler, a solid cylinder."""
    return bar_mass_per_length * a2


@planar_4r.quantity(units="kg m2", symbol="I_2", source=SOURCE, alternative=ROUND_BAR)
def I2(m2: Any, a2: Any, bar_section: Any) -> Any:
    """Moment of inertia of the coupler, a solid cylinder, about its mass centre."""
    return m2 * (a2 * a2 / 12.0 + bar_section)


@planar_4r.quantity(units="m", symbol="G_2u", source=SOURCE, alternative=ROUND_BAR)
def G2_u(a2: Any) -> Any:
    """Mass centre of the coupler at mid-length."""
    return 0.5 * a2


@planar_4r.quantity(units="m", symbol="G_2v", source=SOURCE, alternative=ROUND_BAR)
def G2_v(a2: Any) -> Any:
    """Mass centre of the coupler on its axis."""
    return 0.0 * a2


@planar_4r.quantity(units="kg", symbol="m_3", source=SOURCE, alternative=ROUND_BAR)
def m3(a3: Any, bar_mass_per_length: Any) -> Any:
    """Mass of the output link, a solid cylinder."""
    return bar_mass_per_length * a3


@planar_4r.quantity(units="kg m2", symbol="I_3", source=SOURCE, alternative=ROUND_BAR)
def I3(m3: Any, a3: Any, bar_section: Any) -> Any:
    """Moment of inertia of the output link, a solid cylinder, about its mass centre."""
    return m3 * (a3 * a3 / 12.0 + bar_section)


@planar_4r.quantity(units="m", symbol="G_3u", source=SOURCE, alternative=ROUND_BAR)
def G3_u(a3: Any) -> Any:
    """Mass centre of the output link at mid-length."""
    return 0.5 * a3


@planar_4r.quantity(units="m", symbol="G_3v", source=SOURCE, alternative=ROUND_BAR)
def G3_v(a3: Any) -> Any:
    """Mass centre of the output link on its axis."""
    return 0.0 * a3
