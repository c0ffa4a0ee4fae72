"""Compare the facts with 50 digits and independent values, with as many digits as that takes."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any

from fastlink.facts.names import Derivative, Quantity
from fastlink.precision.independent import focal, hart, minkowski_4r, planar_4r, slider_crank
from fastlink.precision.independent.loops import Open, Singular, context, rotation
from fastlink.precision.reference import CONTEXT, DIGITS

if TYPE_CHECKING:
    from fastlink.facts.catalogue import Catalogue

__all__ = ["TOLERANCE", "IndependentValues", "Model", "model_of"]


# -- The models by mechanism and input, and which quantities they compute


#: Angles are the same where they differ by whole turns.
TURNING: tuple[str, ...] = ("theta2", "theta4", "psi", "phi", "sigma", "omega_angle", "alpha", "beta", "chi")
TURNING += tuple(f"joint_angle_{i}" for i in (1, 2, 3, 4))

#: Modes, which are no numbers.
CODES = ("branch", "completion")


@dataclass(frozen=True)
class Model:
    """Values of one mechanism by one input, without its facts.

    Attributes
    ----------
    orders : mapping of str to int
        The quantities of a configuration, by the order of the derivatives that they need.
    of_design : tuple of str
        The quantities of the design as a whole.
    configuration : callable
        Adds quantities, of a context, values, an order, whether forces are needed, and those found.
    design : callable
        Adds quantities of the design, of a context, values, and those found.
    forces : tuple of str
        Quantities that need a linear system of all links.
    lost : callable
        Returns how many digits the equations lose at values, None where these are too many.
    """

    orders: Mapping[str, int]
    of_design: tuple[str, ...]
    configuration: Callable[[Any, Mapping[str, Any], int, bool, dict[str, Any]], None]
    design: Callable[[Any, Mapping[str, Any], dict[str, Any]], None]
    forces: tuple[str, ...] = ()
    turning: frozenset[str] = frozenset(TURNING)
    lost: Callable[[Mapping[str, Any]], int | None] = lambda _: 0

    def covers(self, name: str) -> bool:
        """Tell whether a quantity has an independent value."""
        return name in self.orders or name in self.of_design

    def values(self, ctx: Any, at: Mapping[str, Any], names: Iterable[str]) -> dict[str, Any]:
        """Return independent values: NaN where the loop does not close, none where nothing is determined."""
        given = {name: int(value) if name in CODES else ctx.mpf(value) for name, value in at.items()}
        moving = [name for name in names if name in self.orders]
        fixed = [name for name in names if name in self.of_design]
        found: dict[str, Any] = {}
        if fixed:
            found |= self._found(ctx, fixed, partial(self.design, ctx, given))
        if moving:
            order = max(self.orders[name] for name in moving)
            forces = any(name in self.forces for name in moving)
            found |= self._found(ctx, moving, partial(self.configuration, ctx, given, order, forces))
        return found

    def _found(
        self, ctx: Any, names: Iterable[str], compute: Callable[[dict[str, Any]], None]
    ) -> dict[str, Any]:
        found: dict[str, Any] = {}
        try:
            compute(found)
        except Singular:
            pass
        except Open:
            found = dict.fromkeys(names, ctx.nan) | found
        return {name: found[name] for name in names if name in found}


def _joints(joint: int, ctx: Any, at: Mapping[str, Any], order: int, _: bool, found: dict[str, Any]) -> None:
    planar_4r.add_driven_end(ctx, at, joint, found)
    directions = planar_4r.joints(ctx, at, joint, order, found)
    planar_4r.add_places(ctx, at, (rotation(ctx, directions[0]), rotation(ctx, directions[1])), found)


def _planar_4r(joint: int) -> Model:
    if joint == 0:
        return Model(
            planar_4r.JOINTS | planar_4r.FIXED_FRAME,
            planar_4r.DESIGN,
            planar_4r.fixed_frame,
            planar_4r.design,
            planar_4r.FORCES,
        )
    known = planar_4r.JOINTS | planar_4r.PLACES
    orders = {name: order for name, order in known.items() if name != f"joint_angle_{joint}"}
    return Model(
        orders,
        ("grashof_excess",),
        partial(_joints, joint),
        planar_4r.design,
    )


def _focal(by_crank: bool) -> Model:
    return Model(
        focal.BY_CRANK if by_crank else focal.BY_ROCKER,
        focal.DESIGN,
        lambda ctx, at, order, _, found: focal.configuration(ctx, at, by_crank, order, found),
        focal.design,
    )


def _hart(by_line: bool) -> Model:
    return Model(
        hart.BY_LINE if by_line else hart.BY_ROCKER,
        hart.DESIGN,
        lambda ctx, at, order, _, found: hart.configuration(ctx, at, by_line, order, found),
        hart.design,
    )


def _minkowski_4r() -> Model:
    return Model(
        minkowski_4r.QUANTITIES,
        minkowski_4r.DESIGN,
        lambda ctx, at, order, _, found: minkowski_4r.configuration(ctx, at, order, found),
        minkowski_4r.design,
        lost=minkowski_4r.digits,
    )


def _slider_crank() -> Model:
    return Model(
        slider_crank.QUANTITIES,
        slider_crank.DESIGN,
        slider_crank.configuration,
        slider_crank.design,
        slider_crank.FORCES,
    )


#: The models by mechanism and input.
MODELS: dict[tuple[str, str], Callable[[], Model]] = {
    ("planar_4r", "theta1"): partial(_planar_4r, 0),
    **{("planar_4r", f"joint_angle_{k}"): partial(_planar_4r, k) for k in (1, 2, 3, 4)},
    ("minkowski_4r", "theta"): _minkowski_4r,
    ("focal", "phi"): partial(_focal, by_crank=False),
    ("focal", "sigma"): partial(_focal, by_crank=True),
    ("hart", "phi"): partial(_hart, by_line=False),
    ("hart", "F_y"): partial(_hart, by_line=True),
    ("slider_crank", "theta"): _slider_crank,
}


def model_of(catalogue: Catalogue) -> Model | None:
    """Return the model of a mechanism by its input, if there is one."""
    mechanism, _, _ = catalogue.name.partition(" driven by ")
    make = MODELS.get((mechanism, catalogue.position.name))
    return make() if make else None


#: Where both references differ by more, in units of |f| + sum |x df/dx|, one of them is wrong: facts of some hundred
#: steps lose some digits of their 50.
TOLERANCE = CONTEXT.mpf(10) ** (8 - DIGITS)
#: Digits of the equations, which are not written so that nothing cancels; the second for what then differs.
FEW, MANY = DIGITS + 10, 6 * DIGITS


class IndependentValues:
    """Values of a mechanism's quantities that share no formula with its facts.

    Examples
    --------
    >>> from fastlink.mechanisms import catalogue
    >>> checks = IndependentValues(catalogue("planar_4r"), ["omega4", "d_omega4_d_a1", "status"])
    >>> checks.names
    ('omega4', 'd_omega4_d_a1')
    """

    def __init__(self, catalogue: Catalogue, names: Iterable[str]) -> None:

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
        """Return by quantity the difference from exact values in units of their own, infinite if one is no number."""
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
