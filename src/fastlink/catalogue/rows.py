"""Declare facts in rows of plain data, where one law holds for several quantities."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from fastlink.catalogue.declare import Declarations

__all__ = ["Rows"]


@dataclass(frozen=True)
class Rows:
    """Facts with common labels, each declared by a call.

    Attributes
    ----------
    catalogues : sequence of Declarations
        The mechanisms that the facts belong to: the same one by several inputs, for example.
    labels : mapping
        Arguments of `Declarations.quantity` that the facts have in common.
    """

    catalogues: Sequence[Declarations]
    labels: Mapping[str, Any]

    def __call__(
        self,
        law: Callable[..., Any],
        name: str,
        symbol: str,
        meaning: str | None = None,
        /,
        *,
        units: str | None = None,
        source: str | None = None,
        low: str | None = None,
        **given: str,
    ) -> None:
        """Declare a fact.

        Parameters
        ----------
        law : callable
            The function.
        name, symbol, meaning : str
            The name, the symbol in the paper, and the meaning (by default the first line of the law's docstring).
        units, source, low
            As in `Declarations.quantity`, where they differ from the common ones.
        **given : str
            The names that replace parameters of the law.
        """
        own = {"units": units, "source": source, "low": low}
        labels = {**self.labels, **{label: value for label, value in own.items() if value is not None}}
        for catalogue in self.catalogues:
            catalogue.quantity(**labels, symbol=symbol, name=name, meaning=meaning, given=given)(law)

    def vector(
        self,
        law: Callable[..., Any] | tuple[Callable[..., Any], Callable[..., Any]],
        name: str,
        symbol: str,
        meaning: str,
        /,
        *,
        units: str | None = None,
        source: str | None = None,
        **given: str,
    ) -> None:
        """Declare both components of a vector; x and y stand for each * in the row.

        Parameters
        ----------
        law : callable or pair of callables
            The text of both components, or that of each.
        name, symbol, meaning, units, source, **given
            As where a fact is declared; the meaning is that of the vector.

        Examples
        --------
        ``force.vector(difference, "F21_*", "F_21*", "Force on the crank at A", x="F32_*", y="p2_*")`` declares
        ``F21_x = F32_x - p2_x`` and ``F21_y = F32_y - p2_y``.
        """
        laws = law if isinstance(law, tuple) else (law, law)
        for component, own in zip("xy", laws, strict=True):
            names = {parameter: other.replace("*", component) for parameter, other in given.items()}
            labels = (name.replace("*", component), symbol.replace("*", component), f"{meaning}, {component}")
            self(own, *labels, units=units, source=source, **names)
