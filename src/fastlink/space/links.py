"""Models of the links, which give mass data from the lengths."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from numbers import Real

from fastlink.doors import door
from fastlink.errors import InputError, Problems, suggest

__all__ = ["Links", "links_from", "round_bar"]

MODELS: dict[str, tuple[str, ...]] = {"round_bar": ("density", "radius")}


@dataclass(frozen=True)
class Links:
    """A model of the links, with its inputs that are the same for all designs."""

    model: str
    values: Mapping[str, float]


@door
def round_bar(density: float | None = None, radius: float | None = None) -> Links:
    """Links made of solid round bars.

    Each link of length a has the mass ``density * pi * radius**2 * a``, the moment of inertia
    ``m (a**2/12 + radius**2/4)`` about its mass centre, and its mass centre at mid-length (Hayes et al.,
    Table 1). Mass data that the design itself gives replace the model's.

    Parameters
    ----------
    density : float, optional
        In kg m-3. Left out, the design gives it (to sweep it, make it an axis there).
    radius : float, optional
        In m. Left out, the design gives it.

    Raises
    ------
    InputError
        A value is not a finite number, or is negative.

    Examples
    --------
    >>> round_bar(density=7750.0, radius=0.01).values["radius"]
    0.01
    """
    given = {"density": density, "radius": radius}
    return links_from("round_bar", {name: value for name, value in given.items() if value is not None})


def links_from(model: str, values: Mapping[str, float]) -> Links:
    """Return a model of the links by name, after a check of its values."""
    if model not in MODELS:
        raise InputError(
            f"{model!r} is unknown", where=("links", "model"), remedy=suggest(str(model), MODELS)
        )
    problems = Problems()
    for name, value in values.items():
        where = ("links", name)
        if name not in MODELS[model]:
            problems.add(f"{model} has no {name!r}", where, suggest(name, MODELS[model]))
        elif isinstance(value, bool) or not isinstance(value, Real):
            remedy = f"write one number, or leave it out and give {name} in the design"
            problems.add(f"is {value!r}", where, remedy)
        elif not math.isfinite(value) or value < 0:
            problems.add(f"is {value!r}", where, "write a finite number of at least 0")
    problems.stop()
    return Links(model, {name: float(value) for name, value in values.items()})
