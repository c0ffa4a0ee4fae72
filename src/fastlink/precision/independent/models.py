"""The models by mechanism and input, and which quantities they compute."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

from fastlink.precision.independent import focal, hart, minkowski_4r, planar_4r, slider_crank
from fastlink.precision.independent.series import Open, Singular, rotation

if TYPE_CHECKING:
    from fastlink.catalogue.catalogue import Catalogue

__all__ = ["Model", "model_of"]

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
        """Return independent values: NaN where the loop does not close, none where nothing is determined.

        Parameters
        ----------
        ctx : context
            Of the numbers.
        at : mapping of str to number
            Inputs, branch and input position.
        names : iterable of str
            Quantities that the model covers.
        """
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
