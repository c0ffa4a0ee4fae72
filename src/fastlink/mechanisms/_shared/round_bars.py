"""Links made of a round bar: masses, inertias and mass centres from the lengths."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from fastlink.catalogue.catalogue import Catalogue
from fastlink.numerics.elementary import PI

__all__ = ["ROUND_BAR", "bar_volume", "declare"]

ROUND_BAR = "round_bar"
SOURCE = "Hayes, Hninn, Irani, Table 1"


def bar_mass_per_length(density: Any, radius: Any) -> Any:
    """Mass of a round bar per length."""
    return density * PI * (radius * radius)


def bar_section(radius: Any) -> Any:
    """Squared radius of gyration of the round section about a diameter."""
    return 0.25 * (radius * radius)


def bar_volume(length: Any, radius: Any) -> Any:
    """Volume of a solid cylinder."""
    return PI * (radius * radius) * length


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


def declare(catalogue: Catalogue, bars: Mapping[int, tuple[str, str]]) -> None:
    """Declare masses, inertias and mass centres of links that are round bars, as the variant `ROUND_BAR`.

    Parameters
    ----------
    catalogue : Catalogue
        The mechanism, with the inputs m1, I1, G1_u, G1_v of its link 1 and so on.
    bars : mapping of int to (str, str)
        By the number of the link what it is, and the name of its length.
    """
    step = catalogue.steps(units="m2", source=SOURCE, variant=ROUND_BAR)
    bar = catalogue.quantities(units="m", source=SOURCE, variant=ROUND_BAR)
    for name, units, symbol, meaning in (
        ("density", "kg m-3", "rho", "density of the round bars"),
        ("radius", "m", "r_b", "radius of the round bars"),
    ):
        catalogue.input(
            name, units=units, symbol=symbol, meaning=meaning, rule="non-negative", variant=ROUND_BAR
        )
    step(bar_mass_per_length, "bar_mass_per_length", "rho pi r_b^2", units="kg m-1")
    step(bar_section, "bar_section", "r_b^2/4")
    for i, (link, a) in bars.items():
        about = f"moment of inertia of the {link} about its centre"
        bar(bar_mass, f"m{i}", f"m_{i}", f"mass of the {link}", length=a, units="kg")
        bar(bar_inertia, f"I{i}", f"I_{i}", about, mass=f"m{i}", length=a, units="kg m2")
        bar(mid_length, f"G{i}_u", f"G_{i}u", f"mass centre of the {link} at mid-length", length=a)
        bar(on_axis, f"G{i}_v", f"G_{i}v", f"mass centre of the {link} on its axis", length=a)
