"""Compare the facts with 50 digits and independent values, with as many digits as that takes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Any

from fastlink.facts.names import Derivative, Quantity
from fastlink.precision.independent.series import context
from fastlink.precision.reference import CONTEXT, DIGITS

if TYPE_CHECKING:
    from fastlink.catalogue.catalogue import Catalogue
    from fastlink.precision.independent.models import Model

__all__ = ["TOLERANCE", "IndependentValues"]

#: Where both references differ by more, in units of |f| + sum |x df/dx|, one of them is wrong: facts of some hundred
#: steps lose some digits of their 50.
TOLERANCE = CONTEXT.mpf(10) ** (8 - DIGITS)
#: Digits of the equations, which are not written so that nothing cancels; the second for what then differs.
FEW, MANY = DIGITS + 10, 6 * DIGITS


class IndependentValues:
    """Values of a mechanism's quantities that share no formula with its facts.

    Parameters
    ----------
    catalogue : Catalogue
        The mechanism.
    names : iterable of str
        Quantities and derivatives; those that no model covers are left out.

    Examples
    --------
    >>> from fastlink.mechanisms import catalogue
    >>> checks = IndependentValues(catalogue("planar_4r"), ["omega4", "d_omega4_d_a1", "status"])
    >>> checks.names
    ('omega4', 'd_omega4_d_a1')
    """

    def __init__(self, catalogue: Catalogue, names: Iterable[str]) -> None:
        from fastlink.precision.independent.models import model_of

        self.catalogue, self.model = catalogue, model_of(catalogue)
        self.names = tuple(name for name in names if self._covers(name))

    def _covers(self, name: str) -> bool:
        return self.model is not None and self.model.covers(str(self._of(name)))

    def _of(self, name: str) -> Any:
        """Return the quantity of a name or of its derivative."""
        tree = self.catalogue.parse(name)
        return tree.of if isinstance(tree, Derivative) and isinstance(tree.of, Quantity) else tree

    @cached_property
    def _by(self) -> dict[str, list[str]]:
        """The quantities to evaluate with respect to an input; those of "" themselves."""
        names: dict[str, list[str]] = {}
        for name in self.names:
            tree = self.catalogue.parse(name)
            names.setdefault(tree.by if isinstance(tree, Derivative) else "", []).append(name)
        return names

    def difference(self, at: Mapping[str, Any], name: str, exact: Any, unit: Any) -> float | None:
        """Return the difference of one quantity, None if it has no independent value."""
        return self.differences(at, {name: exact}, {name: unit}).get(name) if name in self.names else None

    def values(self, at: Mapping[str, Any], digits: int = FEW) -> dict[str, Any]:
        """Return independent values at a configuration: NaN where the loop is open, none where undetermined."""
        lost = self.model.lost(at) if self.model is not None else None
        if self.model is None or lost is None:
            return {}
        found: dict[str, Any] = {}
        for by, names in self._by.items():
            if not by:
                found |= self.model.values(context(digits + lost), at, names)
            else:
                found |= self._differences(self.model, at, by, names, digits + lost)
        return found

    def _differences(
        self, model: Model, at: Mapping[str, Any], by: str, names: Iterable[str], digits: int
    ) -> dict[str, Any]:
        """Return derivatives as central differences, which have the square of their step as error."""
        ctx = context(2 * digits)
        here = ctx.mpf(at[by])
        step = ctx.mpf(10) ** (-digits // 2) * (abs(here) if here != 0 else 1)
        quantities = {name: str(self._of(name)) for name in names}
        below, above = (
            model.values(ctx, {**at, by: here + sign * step}, quantities.values()) for sign in (-1, 1)
        )
        found = {}
        for name, quantity in quantities.items():
            if quantity in below and quantity in above:
                change = above[quantity] - below[quantity]
                if quantity in model.turning and abs(change) > 3:
                    change -= 2 * ctx.pi * ctx.nint(change / (2 * ctx.pi))
                found[name] = change / (2 * step)
        return found

    def differences(
        self, at: Mapping[str, Any], exact: Mapping[str, Any], units: Mapping[str, Any]
    ) -> dict[str, float]:
        """Return by quantity the difference from exact values in units of their own, infinite if one is no number.

        Parameters
        ----------
        at : mapping of str to number
            Inputs, branch and input position.
        exact : mapping of str to number
            The facts with 50 digits.
        units : mapping of str to number
            The size that a difference is measured against.
        """
        found = self._differences_from(exact, units, self.values(at))
        # few digits neither tell lines of links from links nearly in line, nor hold what these cancel
        if len(found) < len(self.names) or any(difference > TOLERANCE for difference in found.values()):
            found = self._differences_from(exact, units, self.values(at, MANY))
        return {name: float(difference) for name, difference in found.items()}

    def _differences_from(
        self, exact: Mapping[str, Any], units: Mapping[str, Any], values: Mapping[str, Any]
    ) -> dict[str, Any]:
        turning = self.model.turning if self.model is not None else frozenset()
        found = {}
        for name, value in values.items():
            one, other = CONTEXT.mpf(value), exact[name]
            if not (CONTEXT.isfinite(one) and CONTEXT.isfinite(other)):
                both = CONTEXT.isnan(one) == CONTEXT.isnan(other)
                found[name] = CONTEXT.zero if both else CONTEXT.inf
                continue
            difference = abs(one - other)
            if name in turning and difference > 3:
                difference = abs(difference - 2 * CONTEXT.pi)
            unit = units[name]
            found[name] = difference / unit if unit != 0 else CONTEXT.inf if difference else CONTEXT.zero
        return found
