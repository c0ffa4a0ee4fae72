"""What is computed for a set of names: data only, which kernel text and plans are made of."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Literal

from fastlink.catalogue import Catalogue, Fact, System
from fastlink.cycle import Request

__all__ = ["Closure", "Lanes", "Output"]

Lanes = Literal["designs", "angles"]


@dataclass(frozen=True)
class Output:
    """One result of a kernel: the request and the axes it has besides the design."""

    request: Request
    axes: tuple[str, ...]
    dtype: str

    @property
    def name(self) -> str:
        """Name of the result."""
        return self.request.name


@dataclass(frozen=True)
class Closure:
    """What is computed for a set of names.

    Attributes
    ----------
    catalogue : Catalogue
        The mechanism.
    outputs : tuple of Output
        The results, in the order asked.
    steps : tuple of Fact or System
        The closure: everything computed, in order.
    inputs : tuple of str
        The inputs that the closure reads, the rows of the kernel's design array.
    tables : tuple of str
        The functions of the input position that it reads, the rows of the kernel's angle array.
    branches : tuple of int
        The assembly modes.
    lanes : {"designs", "angles"}
        What stands side by side in the vector lanes.
    alternatives : tuple of str
        The chosen sets of facts.
    """

    catalogue: Catalogue
    outputs: tuple[Output, ...]
    steps: tuple[Fact | System, ...]
    inputs: tuple[str, ...]
    tables: tuple[str, ...]
    branches: tuple[int, ...]
    lanes: Lanes
    alternatives: tuple[str, ...]

    @cached_property
    def axes(self) -> dict[str, frozenset[str]]:
        """The axes on which each value of the closure depends."""
        position = self.catalogue.position.name
        axes = {name: frozenset({"design"}) for name in self.inputs}
        axes |= {name: frozenset({position}) for name in self.tables}
        axes["branch"] = frozenset({"branch"})
        for step in self.steps:
            joint = frozenset[str]().union(*(axes[need] for need in step.needs))
            for name in step.unknowns if isinstance(step, System) else (step.name,):
                axes[name] = joint
        return axes

    @property
    def uses_position(self) -> bool:
        """Whether anything depends on the input position; a map of design facts touches none."""
        return bool(self.tables)
