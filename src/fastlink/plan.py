"""Asked names to one compiled kernel: the closure of facts, each value where it is cheapest.

A fact that depends on the design alone is computed once per design; what depends on the input angle
alone, once per angle; what does not depend on the branch, once for both branches. The kernel's text is a
straight-line loop over lanes (see `fastlink.kernels`), to be read with ``plan.source``.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any

from fastlink.catalogue import Catalogue, System
from fastlink.closure import Closure, Lanes, Output
from fastlink.cycle import Request, parse_request
from fastlink.errors import InputError
from fastlink.kernels import load_kernel, write_kernel
from fastlink.tables import angle_tables

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["Output", "Plan", "make_plan", "split"]

# Fewer angles than this leave vector lanes idle when lanes are angles.
ANGLES_FOR_LANES = 32


class Plan(Closure):
    """A closure with its kernel: the text, and the machine code."""

    @cached_property
    def _written(self) -> tuple[str, tuple[int, int]]:
        return write_kernel(self)

    @property
    def source(self) -> str:
        """The text of the kernel."""
        return self._written[0]

    @property
    def scratch(self) -> tuple[int, int]:
        """Lengths of the kernel's two scratch arrays."""
        return self._written[1]

    @cached_property
    def kernel(self) -> Any:
        """The compiled kernel (compiled, or loaded from the cache, on first use)."""
        return load_kernel(self, self.source)

    def angle_tables(self, theta: NDArray[Any]) -> NDArray[Any]:
        """Return the rows of the kernel's angle array for these input positions."""
        return angle_tables(self.catalogue, self.tables, theta)


def make_plan(
    catalogue: Catalogue,
    names: Iterable[str],
    *,
    given: Iterable[str],
    branches: Sequence[int] = (1, 2),
    alternatives: Sequence[str] = (),
    angles: int = 360,
    lanes: Lanes | None = None,
) -> Plan:
    """Resolve the asked names into a plan.

    Parameters
    ----------
    catalogue : Catalogue
        The mechanism.
    names : iterable of str
        Quantities or what is taken of them over the cycle.
    given : iterable of str
        The inputs that the design space gives.
    branches : sequence of int
        Assembly modes.
    alternatives : sequence of str
        Chosen sets of facts, such as ``"round_bar"`` or ``"dense"``.
    angles : int
        Number of input positions: decides, with what is asked, what the lanes are.
    lanes : {"designs", "angles"}, optional
        Force one; both give the same bits.

    Raises
    ------
    InputError
        A name is unknown or asked twice, or an input that the closure needs is not given.
    """
    requests = [parse_request(name, catalogue) for name in names]
    for i, request in enumerate(requests):
        if any(other.name == request.name for other in requests[:i]):
            raise InputError(f"quantity {request.name!r} is asked for twice; name it once")
    position = catalogue.position.name
    tables = (position, *catalogue.tables, *catalogue.table_low_parts)
    leaves = (*given, *tables, "branch")
    steps = tuple(catalogue.closure([request.quantity for request in requests], leaves, alternatives))
    read = {need for step in steps for need in step.needs}
    read_tables = tuple(name for name in tables if name in read)
    if any(request.place for request in requests) and position not in read_tables:
        read_tables = (position, *read_tables)
    outputs = tuple(_output(request, catalogue) for request in requests)
    has_cycle = any(request.reduction for request in requests)
    has_system = any(isinstance(step, System) for step in steps)
    if lanes is None:
        lanes = (
            "designs" if has_cycle or has_system or angles < ANGLES_FOR_LANES or not read_tables else "angles"
        )
    # In the catalogue's order, so that one set of names has one kernel however the design is written.
    inputs = tuple(name for name in catalogue.known_inputs(alternatives) if name in read and name in leaves)
    return Plan(catalogue, outputs, steps, inputs, read_tables, tuple(branches), lanes, tuple(alternatives))


def split(plan: Plan, angles: int) -> list[Plan]:
    """Return the plans that together give a plan's results fastest: curves apart from the rest.

    With lanes that are designs a curve is stored across the lines of its array, 1 ns a value; with lanes that are
    angles it costs less to compute what both need again.
    """
    position = plan.catalogue.position.name
    curves = [output.name for output in plan.outputs if position in output.axes]
    rest = [output.name for output in plan.outputs if position not in output.axes]
    whole = (
        plan.lanes == "angles" or angles < ANGLES_FOR_LANES or any(isinstance(s, System) for s in plan.steps)
    )
    if whole or not curves or not rest:
        return [plan]
    options: dict[str, Any] = {"branches": plan.branches, "alternatives": plan.alternatives, "angles": angles}
    return [make_plan(plan.catalogue, names, given=plan.inputs, **options) for names in (curves, rest)]


def _output(request: Request, catalogue: Catalogue) -> Output:
    fact = catalogue.require(request.quantity)
    position = catalogue.position.name
    if not catalogue.varies(fact.name):
        axes: tuple[str, ...] = ()
    elif request.reduction is None:
        axes = ("branch", position)
    else:
        axes = ("branch",)
    return Output(request, axes, "int8" if fact.flags else "float64")
