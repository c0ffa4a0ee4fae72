"""Models of the links, which give mass data from the lengths."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from fastlink._text import short_repr
from fastlink.doors import door
from fastlink.errors import InputError, Problems, suggest
from fastlink.space.values import as_real, is_number

__all__ = ["MODELS", "Links", "round_bar", "taken_links"]

MODELS: dict[str, tuple[str, ...]] = {"round_bar": ("density", "radius")}


@dataclass(frozen=True)
class Links:
    """A model of the links, with its inputs that are the same for all designs.

    Raises
    ------
    InputError
        The model is unknown, or a value is not a finite number, or is negative.
    """

    model: str
    values: Mapping[str, float]

    def __post_init__(self) -> None:
        if not isinstance(self.model, str) or self.model not in MODELS:
            what = f"{short_repr(self.model)} is unknown"
            raise InputError(what, where=("links", "model"), remedy=suggest(self.model, MODELS))
        problems, known = Problems(), MODELS[self.model]
        numbers: dict[str, float] = {}
        for name, value in self.values.items():
            where = ("links", name)
            value = value[()] if isinstance(value, np.ndarray) and value.ndim == 0 else value
            if name not in known:
                problems.add(f"{self.model} has no {short_repr(name)}", where, suggest(name, known))
            elif not is_number(value):
                remedy = f"write one number, or leave it out and give {name} in the design"
                problems.add(f"is {short_repr(value)}", where, remedy)
            else:
                number = as_real(value)
                if number is None or not 0 <= number < math.inf:
                    problems.add(f"is {short_repr(value)}", where, "write a finite number of at least 0")
                else:
                    numbers[name] = number
        problems.stop()
        object.__setattr__(self, "values", numbers)


def taken_links(given: dict[str, Any]) -> Links | None:
    """Take the numbers of a model of the links out of what is given, and return it; None without any.

    Examples
    --------
    >>> given = {"a1": 0.4, "density": 7750.0, "radius": 0.01}
    >>> taken_links(given).values, given
    ({'density': 7750.0, 'radius': 0.01}, {'a1': 0.4})
    """
    for model, names in MODELS.items():
        values = {name: given.pop(name) for name in names if name in given}
        if values:
            return Links(model, values)
    return None


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
    return Links("round_bar", {name: value for name, value in given.items() if value is not None})
