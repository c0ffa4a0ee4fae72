"""A compiled kernel as a plain function of arrays, for optimisers and other libraries."""

from __future__ import annotations

import math
import threading
from collections.abc import Callable, Mapping, Sequence
from functools import cached_property, partial
from inspect import signature
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink.engine.binding import BLOCK, Bound, bind
from fastlink.engine.checks import check_names
from fastlink.engine.resolve import ResolvedSweep, resolve
from fastlink.errors import InputError
from fastlink.mechanisms import catalogue as find_catalogue
from fastlink.plan.validate import allowed, check_inputs, check_keywords, variants_of
from fastlink.space.design_space import DESIGN, DesignSpace
from fastlink.space.samplers import grid

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from fastlink.plan.program import Output
    from fastlink.space.links import Links

__all__ = ["Function", "function"]

#: Bytes of results that are computed at once: they fit the cache of one core.
BLOCK_BYTES = 1 << 20


def function(
    mechanism: str,
    inputs: Sequence[str],
    outputs: Sequence[str],
    *,
    links: Links | None = None,
    input: str | None = None,
    angles: int | ArrayLike | None = None,
    branch: int | Sequence[int] = 1,
    solver: str = "eliminated",
    extrema: str | None = None,
    backend: str | None = None,
    **fixed: Any,
) -> Function:
    """Return compiled quantities as a function of arrays, for optimisers and other libraries.

    Parameters
    ----------
    mechanism : str
        Name of the mechanism.
    inputs : sequence of str
        The inputs that vary: the rows of the function's argument.
    outputs : sequence of str
        Quantities, or what is taken of them over the cycle, as in `fastlink.sweep`: the rows of its result. Ask for
        ``"status"`` to have it.
    branch : int or sequence of int, default 1
        An assembly mode; or several, which are a further axis of the result.
    links, input, angles, solver, extrema, backend
        As in `fastlink.sweep`.
    **fixed : float
        The inputs that stay; and, as in `fastlink.sweep`, the input positions by the name of the input.

    Returns
    -------
    Function
        Takes an array (inputs, ...) and returns one (outputs, ...), followed by the axes of the results: one of several
        assembly modes, and of quantities at each input position one of these. An output that has no such axis, such as
        a class of the design, is repeated along it. Bits are those of `fastlink.sweep`. What does not assemble is NaN,
        and so is all of a design with a value that the sweep would refuse, but for codes such as ``status``.
        It may be called from several threads at once, and pickled.

    Raises
    ------
    InputError
        Bad input; the message says what, where, and what to write instead.

    Examples
    --------
    >>> import fastlink as fl
    >>> speed = fl.function("planar_4r", ["a2", "a3"], ["omega4_max"], a1=0.4, a4=1.0, omega1=25.0)
    >>> speed([1.2, 0.8]).round(6)
    array([13.513437])
    >>> speed([[1.2, 1.3, 9.0], [0.8, 0.8, 0.8]]).round(6)
    array([[13.513437, 14.583591,       nan]])
    """
    options: dict[str, Any] = {
        "links": links,
        "input": input,
        "angles": angles,
        "branch": branch,
        "solver": solver,
        "extrema": extrema,
        "backend": backend,
    }
    names = list(check_names("inputs", inputs))
    for name in names:
        if name in fixed:
            raise InputError(
                f"function: {name} is among the inputs and given as {fixed[name]!r}; leave one out"
            )
    positions, constants = _fixed(mechanism, input, fixed)
    varying = DesignSpace(
        "table", (DESIGN,), (1,), constants, columns={name: np.full(1, np.nan) for name in names}
    )
    asked = resolve(
        mechanism,
        varying,
        outputs,
        positions=positions,
        allow_invalid=True,  # the fixed values are checked below, the others at each call
        companions=False,
        called="outputs",
        **options,
    )
    variants = variants_of(asked.catalogue, links, solver, varying.names)
    check_inputs(asked.catalogue, DesignSpace("grid", (), (), constants), variants, False)
    _refuse_choices(asked, varying)
    again: Any = function
    recipe = partial(again, mechanism, names, list(outputs), **options, **fixed)
    return Function(asked, names, isinstance(branch, (int, np.integer)), recipe)


class Function:
    """Compiled quantities of a mechanism as a function of arrays; made by `fastlink.function`.

    Attributes
    ----------
    inputs, outputs : tuple of str
        The rows of its argument and of its result.
    shape : tuple of int
        The last axes of its result: assembly modes where there are several, input positions.
    """

    def __init__(
        self, asked: ResolvedSweep, inputs: Sequence[str], one_branch: bool, recipe: Callable[[], Function]
    ) -> None:
        self.inputs = tuple(inputs)
        self.outputs = tuple(output.name for output in asked.plan.outputs)
        self._asked, self._recipe = asked, recipe
        axes = _axes(asked.plan.outputs)
        lengths = {"branch": len(asked.branches), asked.catalogue.position.name: asked.positions.size}
        lengths["extremum"] = asked.plan.extrema_kept
        self.shape = tuple(lengths[axis] for axis in axes if not (one_branch and axis == "branch"))
        #: What each design has of each output: its own lengths, and 1 along axes that it lacks.
        self._shapes = [
            tuple(
                lengths[axis] if axis in output.axes else 1
                for axis in axes
                if not (one_branch and axis == "branch")
            )
            for output in asked.plan.outputs
        ]
        self._buffers = [(tuple(lengths[axis] for axis in o.axes), o.dtype) for o in asked.plan.outputs]
        known = asked.catalogue.known_inputs(asked.plan.variants)
        self._declared = [known[name] for name in self.inputs]
        self._numbers = [k for k, output in enumerate(asked.plan.outputs) if output.dtype == "float64"]
        row = sum(8 * math.prod(shape) for shape in self._shapes)
        self._block = max(1, min(BLOCK, BLOCK_BYTES // row // 64 * 64))
        self._own = threading.local()
        self._parts = asked.parts()

    def __call__(self, x: ArrayLike) -> NDArray[np.float64]:
        """Return the outputs (outputs, ...) of designs (inputs, ...)."""
        given = np.asarray(x, dtype=np.float64)
        if given.shape[:1] != (len(self.inputs),):
            raise InputError(
                f"function: x has the shape {given.shape}; its first axis has {len(self.inputs)} rows: "
                f"{', '.join(self.inputs)}"
            )
        try:
            bound = self._own.bound
        except AttributeError:
            bound = self._own.bound = self._bind()
        if given.ndim == 1:
            return self._one(given, bound)
        flat = given.reshape(len(self.inputs), -1)
        found = np.empty((len(self.outputs), flat.shape[1], *self.shape))
        for start in range(0, flat.shape[1], self._block):
            part = flat[:, start : start + self._block]
            self._some(part, found[:, start : start + self._block], bound)
        bad = np.zeros(flat.shape[1], dtype=bool)
        for declared, row in zip(self._declared, flat, strict=True):
            bad |= ~allowed(declared, row)
        if bad.any():
            for k in self._numbers:
                found[k, bad] = np.nan
        return found.reshape(len(self.outputs), *given.shape[1:], *self.shape)

    def __reduce__(self) -> tuple[Callable[[], Function], tuple[()]]:
        return self._recipe, ()

    def __repr__(self) -> str:
        return f"<function of {self._asked.mechanism}: {', '.join(self.inputs)} to {', '.join(self.outputs)}>"

    @cached_property
    def jitted(self) -> Any:
        """The same for numba: a function of an array (inputs,) or (inputs, n) that ``@njit`` functions may call.

        It calls the kernels by address; nothing of them is compiled again. See docs/performance.md.
        """
        from fastlink.engine.jitted import JITTED_BLOCK, jitted_of

        return jitted_of(self._bind(JITTED_BLOCK), self._declared, self._shapes, self.shape)

    def _bind(self, block: int | None = None) -> list[Bound]:
        space = self._asked.space
        constants = space.constants
        places = {name: k for k, name in enumerate(self.inputs)}
        programs = self._asked.plan.programs
        return [
            bind(part, program.inputs, places, constants, self._buffers, block or self._block)
            for part, program in zip(self._parts, programs, strict=True)
        ]

    def _one(self, given: NDArray[np.float64], bound: list[Bound]) -> NDArray[np.float64]:
        """Return the outputs of one design: no more than a dozen steps of Python."""
        found = np.empty((len(self.outputs), *self.shape))
        values = given.tolist()
        for part in bound:
            for row, place in part.rows:
                row[:8] = values[place]
            part.run(1)
            for k, result in part.results:
                found[k] = result[0].reshape(self._shapes[k])
        if not all(map(allowed, self._declared, values)):
            found[self._numbers] = np.nan
        return found

    def _some(self, given: NDArray[np.float64], found: NDArray[np.float64], bound: list[Bound]) -> None:
        """Evaluate designs of one block."""
        count = given.shape[1]
        # lanes beyond the last design repeat it; their results are not read
        padded = -(-count // 8) * 8
        for part in bound:
            for row, place in part.rows:
                row[:count] = given[place]
                row[count:padded] = given[place, -1]
            part.run(count)
            for k, result in part.results:
                found[k] = result[:count].reshape(count, *self._shapes[k])


def _fixed(
    mechanism: str, input: str | None, fixed: Mapping[str, Any]
) -> tuple[dict[str, Any], dict[str, float]]:
    """Return the input positions by the name of the input, and the inputs that stay."""
    catalogue = find_catalogue(mechanism, input)
    known = {catalogue.position.name, *catalogue.known_inputs(catalogue.variant_inputs)}
    options = [name for name in signature(function).parameters if name != "fixed"]
    check_keywords(mechanism, catalogue, [name for name in fixed if name not in known], [*options, *known])
    positions = {name: values for name, values in fixed.items() if name == catalogue.position.name}
    return positions, _constants({name: value for name, value in fixed.items() if name not in positions})


def _constants(fixed: Mapping[str, Any]) -> dict[str, float]:
    space = grid(**fixed)
    if space.dims:
        name = space.dims[0]
        raise InputError(
            f"function: {name} is given {space.shape[0]} values; write one number, or name it among the inputs"
        )
    return space.constants


def _refuse_choices(asked: ResolvedSweep, varying: DesignSpace) -> None:
    """Refuse an input that is a code and is not given; a sweep would have a dimension of all of them."""
    known = asked.catalogue.known_inputs(asked.plan.variants)
    for name in asked.space.axes:
        if name not in varying.names:
            codes = ", ".join(f"{code} ({meaning})" for code, meaning in known[name].choices.items())
            raise InputError(f"function: {name} is missing; give it, one of {codes}")


def _axes(outputs: Sequence[Output]) -> tuple[str, ...]:
    """Return the axes of the results besides the design; what stands along one has no other."""
    first, *others = (output for output in sorted(outputs, key=lambda output: -len(output.axes)))
    for other in others:
        if set(other.axes) - set(first.axes):
            raise InputError(
                f"function: {first.name} is along {first.axes[-1]}, {other.name} along {other.axes[-1]}; "
                "make a function of each"
            )
    return first.axes
