"""A mechanism driven by another of its inputs than the first: fewer quantities, and why others are missing."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping

from fastlink.catalogue.catalogue import Catalogue, Input
from fastlink.errors import InputError, Setting
from fastlink.facts.names import innermost

__all__ = ["ByOtherInput"]


class ByOtherInput(Catalogue):
    """The catalogue of a mechanism by another input.

    Parameters
    ----------
    first : Catalogue
        The mechanism by its first input.
    title, branches, position, positions
        As in `Catalogue`.
    instead : sequence of str
        Some quantities that are offered here, named in the message about one that is not.
    """

    def __init__(
        self,
        first: Catalogue,
        title: str,
        branches: Mapping[int, str],
        position: Input,
        positions: tuple[float, float, int] | None = None,
        *,
        instead: Iterable[str],
    ) -> None:
        super().__init__(f"{first.name} driven by {position.name}", title, branches, position, positions)
        self.first, self.instead = first, tuple(instead)
        self.keywords = first.keywords

    def absence(self, name: str) -> InputError | None:
        """Return why a name is not offered by this input."""
        if name in self.inputs:
            what = f"quantity {name!r} is given, and a coordinate of the result"
            return InputError(what, remedy="leave it out")
        if not self.is_of_position(name) and innermost(name, self.first) in self.first.public:
            what = f"quantity {name!r} is defined for input {self.first.position.name!r} alone"
            here = ("with ", Setting("input", self.position.name), " ")
            instead = ", ".join(map(repr, self.instead))
            return InputError(what, remedy=(here, f"ask for such as {instead}, or leave input out"))
        return super().absence(name)

    def adopt_design_facts(self, further: Collection[str] = ()) -> None:
        """Adopt the facts of the design as a whole, and further ones that hold for every input."""
        for name, fact in self.first.facts.items():
            of_design = not (self.first.is_derivative(name) or self.first.varies(name))
            if of_design or name in further:
                self.facts.setdefault(name, fact)
