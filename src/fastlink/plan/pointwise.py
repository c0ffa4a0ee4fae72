"""Asked names to one compiled kernel: the closure of facts, each value where it is cheapest.

A fact that depends on the design alone is computed once per design; what depends on the input angle
alone, once per angle; what does not depend on the branch, once for both branches. The kernel's text is a
straight-line loop over lanes (see `fastlink.codegen`), to be read with ``plan.source``.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any

from fastlink.catalogue.catalogue import Catalogue, System
from fastlink.catalogue.tables import angle_tables
from fastlink.codegen.kernel import backend_of, kernel_key, load_kernel
from fastlink.codegen.pointwise import write_kernel
from fastlink.errors import InputError
from fastlink.plan.program import EXTREMUM, Lanes, Output, Program
from fastlink.plan.query import Request, parse_request

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from fastlink.codegen.source import Source

__all__ = ["Kernel", "Plan", "make_plan", "output_of", "parse_requests"]

# Fewer angles than this leave vector lanes idle when lanes are angles.
ANGLES_FOR_LANES = 32


class Kernel:
    """What every plan has: the text of its kernel, and the machine code."""

    written: Source

    @property
    def source(self) -> str:
        """The text of the kernel."""
        return self.written.text

    @cached_property
    def key(self) -> str:
        """What tells the kernel's text and arguments from all others."""
        return kernel_key(self.written)

    def compiled(self, backend: str | None = None, *, relaxed: bool = False) -> Any:
        """Return the kernel, compiled or loaded from the cache on first use.

        Parameters
        ----------
        backend : {"llvm", "numba"}, optional
            The compiler; see `fastlink.codegen.kernel.backend_of`.
        relaxed : bool
            Compile for other roundings, to compare: see `fastlink.accuracy`.
        """
        which = backend_of(backend), relaxed
        if which not in self._kernels:
            self._kernels[which] = self._load(*which)
        return self._kernels[which]

    def _load(self, backend: str, relaxed: bool) -> Any:
        return load_kernel(self.written, backend, relaxed=relaxed)

    @property
    def kernel(self) -> Any:
        """The kernel by the compiler that is used unless another one is named."""
        return self.compiled()

    @cached_property
    def _kernels(self) -> dict[tuple[str, bool], Any]:
        return {}


class Plan(Program, Kernel):
    """A closure over given input positions, with its kernel."""

    @cached_property
    def written(self) -> Source:  # type: ignore[override]
        """The text of the kernel, and what it is called with."""
        return write_kernel(self)

    def angle_tables(self, theta: NDArray[Any]) -> NDArray[Any]:
        """Return the rows of the kernel's angle array for these input positions."""
        return angle_tables(self.catalogue, self.tables, theta)


def make_plan(
    catalogue: Catalogue,
    names: Iterable[str],
    *,
    given: Iterable[str],
    branches: Sequence[int] = (1, 2),
    variants: Sequence[str] = (),
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
    variants : sequence of str
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
    requests = parse_requests(names, catalogue)
    position = catalogue.position.name
    tables = (position, *catalogue.tables, *catalogue.table_low_parts)
    leaves = (*given, *tables, "branch")
    steps = tuple(catalogue.dependencies([request.quantity for request in requests], leaves, variants))
    read = {need for step in steps for need in step.depends_on}
    read_tables = tuple(name for name in tables if name in read)
    if any(request.place for request in requests) and position not in read_tables:
        read_tables = (position, *read_tables)
    outputs = tuple(output_of(request, catalogue) for request in requests)
    has_cycle = any(request.reduction for request in requests)
    has_system = any(isinstance(step, System) for step in steps)
    if lanes is None:
        lanes = (
            "designs" if has_cycle or has_system or angles < ANGLES_FOR_LANES or not read_tables else "angles"
        )
    # In the catalogue's order, so that one set of names has one kernel however the design is written.
    inputs = tuple(name for name in catalogue.known_inputs(variants) if name in read and name in leaves)
    return Plan(catalogue, outputs, steps, inputs, read_tables, tuple(branches), lanes, tuple(variants))


def parse_requests(names: Iterable[str], catalogue: Catalogue) -> list[Request]:
    """Read requested names, each of which is there once."""
    requests = [parse_request(name, catalogue) for name in names]
    for i, request in enumerate(requests):
        if any(other.name == request.name for other in requests[:i]):
            raise InputError(f"quantity {request.name!r} is asked for twice", remedy="name it once")
    return requests


def output_of(request: Request, catalogue: Catalogue, *, refined: bool = False) -> Output:
    """Return what a request results in."""
    fact = catalogue.public_fact(request.quantity)
    axes: tuple[str, ...]
    if not catalogue.varies(fact.name):
        axes = ()
    elif request.listed:
        axes = ("branch",) if request.listed == "count" else ("branch", EXTREMUM)
    elif request.reduction is None:
        axes = ("branch", catalogue.position.name)
    else:
        axes = ("branch",)
    is_code = (bool(fact.flags) and request.is_of_quantity) or request.listed in ("count", "kind")
    return Output(request, axes, "int8" if is_code else "float64", refined)
