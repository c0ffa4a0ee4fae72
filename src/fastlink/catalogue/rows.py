"""Declare facts in rows of plain data, where one law holds for several quantities."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from fastlink.catalogue.declare import Declarations

__all__ = ["DerivativeRows", "Rows"]


@dataclass(frozen=True)
class Rows:
    """Facts with common labels, each declared by a call.

    Attributes
    ----------
    catalogues : sequence of Declarations
        The mechanisms that the facts belong to: the same one by several inputs, for example.
    units, source : str
        The labels of all rows but those that have their own.
    internal : bool
        Whether users cannot request the facts.
    variant : str or None
        The variant to which they belong.
    flags : mapping of int to str or None
        For quantities that are codes: the meanings of their values.
    """

    catalogues: Sequence[Declarations]
    units: str
    source: str
    internal: bool
    variant: str | None = None
    flags: Mapping[int, str] | None = None

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
            As in `Declarations.quantity`, where they differ from those of the other rows.
        **given : str
            The names that replace parameters of the law.
        """
        for catalogue in self.catalogues:
            catalogue.quantity(
                units=units or self.units,
                symbol=symbol,
                source=source or self.source,
                internal=self.internal,
                flags=self.flags,
                variant=self.variant,
                name=name,
                meaning=meaning,
                given=given,
                low=low,
            )(law)

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


@dataclass(frozen=True)
class DerivativeRows:
    """Derivatives with respect to one variable, each declared by a call."""

    catalogue: Declarations
    by: str
    variant: str | None = None

    def __call__(self, law: Callable[..., Any], name: str, /, **given: str) -> None:
        """Declare the derivative of `name`; `given` names replace parameters of the law."""
        self.catalogue.derivative(name, self.by, given=given, variant=self.variant)(law)
