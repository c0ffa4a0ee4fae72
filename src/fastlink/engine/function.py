"""Give compiled quantities as a plain function of arrays."""

from __future__ import annotations

import itertools
import math
import re
import threading
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import cached_property, partial
from inspect import signature
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink._text import counted, joined
from fastlink.engine.resolve import ResolvedSweep, check, of_request, resolve
from fastlink.engine.run import VECTOR, Runner
from fastlink.errors import InputError, Problem, Problems, Suggesting, door
from fastlink.facts.catalogue import ELIMINATED, Catalogue
from fastlink.facts.derivative import NoDependence, is_tolerance
from fastlink.facts.fact import Input
from fastlink.facts.names import Derivative, GradientStatus, Reduced, derivative_name
from fastlink.facts.powers import any_beyond_range, beyond_range
from fastlink.machine import check_memory
from fastlink.mechanisms import catalogue as find_catalogue
from fastlink.numerics.compiler import MOVING, NOTHING
from fastlink.plan.query import Request, check_names, parse_request
from fastlink.plan.request import (
    POSITIONS,
    check_inputs,
    drivers,
    flag_beyond_range,
    keywords_in_si,
    selected_variants,
    unknown_input,
)
from fastlink.space.design_space import DESIGN, MOST_DIMS, DesignSpace, in_unit, numbers_of
from fastlink.space.samplers import grid
from fastlink.space.units import check_unit, scaled, split

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from fastlink.engine.extend import Extension
    from fastlink.plan.programs import Output
    from fastlink.space.design_space import Links


# -- Check the request of `fastlink.function`: inputs that vary, numbers that stay, quantities that go together


def wrong_inputs(catalogue: Catalogue, names: Sequence[str]) -> list[Problem]:
    """Return the problems of names that are listed as inputs and are none."""
    position, known = catalogue.position.name, catalogue.all_inputs
    problems = []
    for k, name in enumerate(names):
        if split(name, (position,))[0] in (position, "branch"):
            remedy = f"leave it out of the list, and write {name} as an option of the function"
            problems.append(Problem(f"{name!r} is not an input of a design", ("inputs", k), remedy))
        elif split(name, known)[0] not in known:
            problems.append(unknown_input(catalogue, name, known, "inputs"))
    return problems


def constants(fixed: Mapping[str, Any], known: Mapping[str, Input]) -> dict[str, float]:
    """Return fixed inputs as numbers in their own units, or refuse what is not one number."""
    numbers, problems = {}, Problems()
    for name, value in fixed.items():
        with problems.at():
            plain = numbers_of("function", name, value)
            numbers[name] = in_unit(("function", name), value, plain, known[name].units)
    problems.stop()
    space = grid(numbers)
    if space.dims:
        name = space.dims[0]
        what = f"is given {counted(space.shape[0], 'value')}"
        raise InputError(what, ("function", name), "write one number, or name it among the inputs")
    return space.constants


def axes_of(outputs: Sequence[Output]) -> tuple[str, ...]:
    """Return the axes of the output that has most; no other may have further ones."""
    first, *others = (output for output in sorted(outputs, key=lambda output: -len(output.axes)))
    for other in others:
        if set(other.axes) - set(first.axes):
            what = f"{first.name} is along {first.axes[-1]}, {other.name} along {other.axes[-1]}"
            raise InputError(what, ("function",), "make a function of each")
    return first.axes


# -- The derivatives of a function's quantities by its inputs, as a function of their own


#: Codes of the status of derivatives where there is none of a mean, whatever the input.
NONE = (MOVING, NOTHING)


def _wanted(
    resolved: ResolvedSweep, inputs: Sequence[str]
) -> tuple[dict[str, tuple[int, int]], dict[str, list[tuple[int, int]]]]:
    """Return what the derivatives are made of, each with the numbers of outputs and inputs.

    First the derivatives; then, of outputs that do not depend on inputs, what tells where there is none: they
    themselves, by NaN, or the status of their derivatives.
    """
    catalogue, variants, given = resolved.catalogue, resolved.plan.variants, resolved.space.names
    by_name, zero_unless = dict[str, tuple[int, int]](), dict[str, list[tuple[int, int]]]()
    problems = Problems()
    for j, by in enumerate(inputs):
        if is_tolerance(by):
            remedy = "make a function of the other inputs, with the tolerance as a number that stays"
            problems.add(f"{by!r} is a tolerance, by which there are no derivatives", ("inputs", j), remedy)
    problems.stop()
    for k, output in enumerate(resolved.plan.outputs):
        with problems.at("quantities", k):
            if output.request.listed or output.request.is_error or output.request.is_of_gradient:
                what = f"quantity {output.name!r} has no derivatives by the inputs"
                raise InputError(what, remedy="leave it out, or take a function of the others")
            for j, by in enumerate(inputs):
                name = derivative_of(output.request, by, catalogue.position.name)
                parse_request(name, catalogue)
                at_one = derivative_name(of := output.request.quantity, by)
                catalogue.public_fact(at_one)  # codes have none
                try:
                    catalogue.resolve(at_one, variants, given)
                except NoDependence:
                    moves = catalogue.selection(variants, given).moves(of, by)
                    if not (output.refined and moves):
                        zero_unless.setdefault(_none_of(output, moves), []).append((k, j))
                        continue
                by_name[name] = k, j
    problems.stop()
    return by_name, zero_unless


def _none_of(output: Output, moves: bool) -> str:
    """Return the quantity that tells where an output that does not depend on an input has no derivative by it."""
    how = output.request.reduction
    if how is None or not moves or how.has_position:
        return output.name  # NaN
    return str(GradientStatus(output.request.of))


def derivative_of(request: Request, by: str, position: str) -> str:
    """Return the name of the derivative of a requested quantity or reduction."""
    of = request.of
    if isinstance(of, Reduced) and request.is_position:
        of = replace(of, position=position)
    return str(Derivative(of, by))


#: The rows of the kernels' designs that are inputs of a function, and which.
Rows = list[tuple["NDArray[Any]", int]]
#: Most designs in one call of a kernel, and bytes of their results: they fit the cache of one core.
BLOCK, BLOCK_BYTES = 1024, 1 << 20


@door
def function(
    mechanism: str | Extension,
    inputs: Sequence[str],
    quantities: Sequence[str],
    *,
    links: Links | None = None,
    input: str | None = None,
    angles: int | ArrayLike | None = None,
    branch: int | Sequence[int] = 1,
    solver: str = ELIMINATED,
    extrema: str | None = None,
    backend: str | None = None,
    **fixed: Any,
) -> Function:
    """Return compiled quantities as a function of arrays, such as for an optimiser.

    Parameters
    ----------
    mechanism : str or Extension
        Name of the mechanism.
    inputs : sequence of str
        The inputs that vary: the rows of the function's argument, in SI or, by names such as ``a1_mm``, in other units.
    quantities : sequence of str
        Quantities, or their extremes and means over the cycle, as in `fastlink.sweep`: the rows of the function's
        result. ``"status"`` is among them only if it is named.
    branch : int or sequence of int, default 1
        A branch; or several, which are a further axis of the result.
    links, input, angles, solver, extrema, backend
        As in `fastlink.sweep`.
    **fixed : float
        The inputs that stay; and, as in `fastlink.sweep`, the input positions, as ``positions=72`` or by the name of
        the input.

    Returns
    -------
    Function
        Takes an array (inputs, ...) and returns one (quantities, ...), followed by the axes of the results: one of
        several branches, and of quantities at each input position one of these. A quantity that has no such axis, such
        as a class of the design, is repeated along it. Bits are those of `fastlink.sweep`. What does not assemble is
        NaN, and so is all of a design with a value that the sweep would refuse, but for codes such as ``status``.
        It may be called from several threads at once, and pickled.

    Examples
    --------
    >>> speed = fl.function("planar_4r", ["a2", "a3"], ["omega4_max"], a1=0.4, a4=1.0, omega1=25.0)
    >>> speed([1.2, 0.8]).round(6)
    array([13.513437])
    >>> speed([[1.2, 1.3, 9.0], [0.8, 0.8, 0.8]]).round(6)
    array([[13.513437, 14.583591,       nan]])
    """
    options = of_request(locals())
    names, wanted = list(check_names("inputs", inputs)), check_names("quantities", quantities)
    catalogue, problems = find_catalogue(mechanism, input), Problems()
    known = catalogue.all_inputs
    fixed = keywords_in_si(catalogue, "function", fixed, problems, position=False)
    own, factors, others = [split(name, known) for name in names], [], dict(zip(fixed, fixed, strict=True))
    for name, (of, unit) in zip(names, own, strict=True):
        with problems.at("function", name):
            factors.append(check_unit(of, unit, known[of].units if unit else "1"))
            if others.setdefault(of, name) != name or of in fixed:
                raise InputError(f"{others[of]} is given too", remedy="write one of them")
    drives = drivers() - known.keys()
    strange = [name for name in fixed if split(name, drives)[0] not in {*known, *drives, POSITIONS}]
    keywords = (*_OPTIONS, catalogue.position.name, POSITIONS)
    problems.noted += [unknown_input(catalogue, name, known, "function", keywords) for name in strange]
    problems.noted += wrong_inputs(catalogue, names)
    with problems.at():
        fixed_numbers = constants({name: value for name, value in fixed.items() if name in known}, known)
        variants = selected_variants(catalogue, links, solver, [*(of for of, _ in own), *fixed_numbers])
        check_inputs(catalogue, DesignSpace("grid", (), (), fixed_numbers), variants, False)
    positions = {name: values for name, values in fixed.items() if name not in (*known, *strange)}
    named: dict[str, Any] = {"positions": positions, "options": [*_OPTIONS, *known], "allow_invalid": True}
    # fixed values are checked above, others at each call
    named |= {"companions": False}
    if problems.noted:
        problems.attempt(check, mechanism, None, wanted, **named, **options)
    problems.stop()
    columns = {of: np.full(1, np.nan) for of, _ in own}
    varying = DesignSpace("table", (DESIGN,), (1,), fixed_numbers, columns=columns)
    resolved = resolve(mechanism, varying, wanted, **named, **options)
    for name in resolved.space.axes:  # a sweep evaluates every choice
        if name not in varying.names:
            choices = resolved.catalogue.known_inputs(resolved.plan.variants)[name].choices
            codes = ", ".join(f"{code} ({meaning})" for code, meaning in choices.items())
            raise InputError("is missing", ("function", name), f"give it, one of {codes}")
    function_again: Any = function
    recipe = partial(function_again, mechanism, names, **options, **fixed)
    return Function(resolved, names, factors, recipe)


#: The keywords of a function besides its fixed inputs and the name of the input.
_OPTIONS = tuple(name for name in signature(function).parameters if name != "fixed")


class Function(Suggesting):
    """Compiled quantities of a mechanism as a function of arrays.

    Attributes
    ----------
    inputs, quantities : tuple of str
        The rows of its argument and of its result.
    shape : tuple of int
        The last axes of its result: branches where there are several, input positions.
    """

    def __init__(
        self, resolved: ResolvedSweep, inputs: Sequence[str], factors: Sequence[Fraction], recipe: Any
    ) -> None:
        plan, lengths = resolved.plan, resolved.lengths
        self.inputs = tuple(inputs)
        self.quantities = tuple(output.name for output in plan.outputs)
        self._resolved, self._recipe = resolved, recipe
        self._job = resolved.job(math.inf)
        axes = [axis for axis in axes_of(plan.outputs) if not (resolved.one_branch and axis == "branch")]
        self.shape = tuple(lengths[axis] for axis in axes)
        #: The shape of each output of one design: its own lengths, and 1 along axes that it lacks.
        self._shapes = [
            tuple(lengths[axis] if axis in output.axes else 1 for axis in axes) for output in plan.outputs
        ]
        known = self._known = resolved.catalogue.known_inputs(plan.variants)
        #: The inputs by their own names; by what rows in other units are multiplied, none where all are in SI.
        self._names = [split(name, known)[0] for name in self.inputs]
        self._factors = [factor for factor in factors if set(factors) - {1}]
        self._declared = [known[name] for name in self._names]
        self._numbers = [k for k, output in enumerate(plan.outputs) if output.dtype == "float64"]
        row = sum(8 * math.prod(shape) for shape in self._shapes)
        self._block = max(1, min(BLOCK, BLOCK_BYTES // row // 64 * 64))
        self._of_thread = threading.local()
        #: The row of the status, and its code for designs with numbers beyond the range.
        self._flag = flag_beyond_range(resolved.catalogue, self.quantities)

    @door(name="function", hint="x is one array, with a row for each input")
    def __call__(self, x: ArrayLike) -> NDArray[np.float64]:
        """Return the quantities (quantities, ...) of designs (inputs, ...)."""
        given = self._rows(x)
        try:
            bound = self._of_thread.bound
        except AttributeError:
            bound = self._of_thread.bound = self._bind(self._block)
        if given.ndim == 1:
            return self._evaluate_one(given, *bound)
        doubles = given.size + math.prod((given.size // len(self.inputs), len(self.quantities), *self.shape))
        check_memory(8 * doubles, "the result", where=("function", "x"), remedy="pass fewer designs at once")
        flat = given.reshape(len(self.inputs), -1)
        far = any_beyond_range(self._known, dict(zip(self._names, flat, strict=True)))
        if far.any():
            flat = np.where(far, np.nan, flat)
        result = np.empty((len(self.quantities), flat.shape[1], *self.shape))
        for start in range(0, flat.shape[1], self._block):
            block = slice(start, start + self._block)
            self._evaluate_block(flat[:, block], result[:, block], *bound)
        good = np.all(list(map(Input.allows, self._declared, flat)), axis=0)
        for k in self._numbers if not good.all() else ():
            result[k, ~good] = np.nan
        if far.any() and self._flag is not None:
            result[self._flag[0], far] = self._flag[1]
        return result.reshape(len(self.quantities), *given.shape[1:], *self.shape)

    def __reduce__(self) -> tuple[Callable[..., Function], tuple[list[str]]]:
        return self._recipe, (list(self.quantities),)

    def __repr__(self) -> str:
        mechanism = self._resolved.mechanism
        return f"<function of {mechanism}: {', '.join(self.inputs)} to {', '.join(self.quantities)}>"

    @cached_property
    def jitted(self) -> Any:
        """The same function of (inputs,) or (inputs, n) for callers in ``@njit`` code, see docs/performance.md."""
        from fastlink.engine.jitted import JITTED_BLOCK, jitted_of

        if self._factors:
            raise InputError("takes inputs in SI", ("jitted",), f"make a function of {joined(self._names)}")
        bound = self._bind(JITTED_BLOCK)
        jitted = jitted_of(*bound, self._declared, self._shapes, self.shape, self._flag)
        jitted.__reduce_ex__ = lambda _: (getattr, (self, "jitted"))  # its addresses are of this process
        return jitted

    @door(name="function", hint="x is one array, with a row for each input")
    def gradient(self, x: ArrayLike) -> NDArray[np.float64]:
        """Return the derivatives (quantities, inputs, ...) of the quantities of designs (inputs, ...).

        Each is per unit of its input as the function takes it: of ``a1_mm`` per mm, of ``a1`` per m.

        Those of extremes, means and places over the cycle are ``d_NAME_max_d_INPUT`` and its like, see
        docs/tolerances.md: where two places tie or the motion has a limit, they are one-sided or NaN.

        Examples
        --------
        >>> speed = fl.function("planar_4r", ["a2", "a3"], ["omega4_max"], a1=0.4, a4=1.0, omega1=25.0)
        >>> speed.gradient([1.2, 0.8]).round(6)
        array([[  7.846495, -17.870504]])
        """
        rows = self._rows(x)
        function, by_name, zero_unless = self._derivatives
        result = np.zeros((len(self.quantities), len(self.inputs), *rows.shape[1:], *self.shape))
        found = dict(zip(function.quantities, function(x), strict=True))
        for name, place in by_name.items():
            result[place] = scaled(found[name], self._factors[place[1]]) if self._factors else found[name]
        for name, places in zero_unless.items():
            none = np.isnan(found[name]) if name in self.quantities else np.isin(found[name], NONE)
            for place in places:
                result[place] = np.where(none, np.nan, 0.0)
        return result

    @property
    def without_gradient(self) -> tuple[str, ...]:
        """The quantities that have no derivatives: codes, lists, error bounds."""
        try:
            _wanted(self._resolved, self._names)
        except InputError as error:
            return tuple({self.quantities[int(one.where[1])]: None for one in error.problems})
        return ()

    @cached_property
    def _derivatives(self) -> tuple[Function, Any, Any]:
        """The function that gives what derivatives are made of, and what that is."""
        wanted = _wanted(self._resolved, self._names)
        return self._recipe(list(dict.fromkeys(itertools.chain(*wanted)))), *wanted

    def _rows(self, x: ArrayLike) -> NDArray[np.float64]:
        """Return the argument as an array with a row for each input."""
        plain = type(x) is np.ndarray and x.dtype == np.float64
        try:
            numbers: Any = x if plain else numbers_of("function", "x", x, MOST_DIMS)
        except InputError as error:
            name = self._names[int((*error.where, 0)[2])]  # of a text with its unit, which belongs there
            remedy = re.sub("^write x(.*, and)", rf"make the function of {name}\1 write", str(error.remedy))
            raise InputError(error.what, error.where, remedy) from None
        given: NDArray[np.float64] = numbers
        if given.shape[:1] != (len(self.inputs),):
            remedy = f"its first axis has {len(self.inputs)} rows: {', '.join(self.inputs)}"
            raise InputError(f"has the shape {given.shape}", ("function", "x"), remedy)
        if self._factors:
            return np.array([scaled(row, factor) for row, factor in zip(given, self._factors, strict=True)])
        return given

    def _bind(self, block: int) -> tuple[Runner, Rows]:
        """Return kernels for blocks of designs, whose constants are set, and the rows that are inputs."""
        constants, rows = self._resolved.space.constants, []
        runner = Runner(self._job, block)
        for kernel in runner.kernels:
            for name, row in zip(kernel.task.inputs, kernel.designs, strict=True):
                row[...] = constants.get(name, np.nan)
                if name in self._names:
                    rows.append((row, self._names.index(name)))
        return runner, rows

    def _evaluate_one(self, given: NDArray[np.float64], runner: Runner, rows: Rows) -> NDArray[np.float64]:
        """Return the outputs of one design, in no more than a dozen steps of Python."""
        outputs = np.empty((len(self.quantities), *self.shape))
        values = given.tolist()
        far = any(map(beyond_range, self._declared, values))
        if far:
            values = [math.nan] * len(values)
        for row, index in rows:
            row[:VECTOR] = values[index]
        runner.run(1)
        for k, result in enumerate(runner.results):
            outputs[k] = result[0].reshape(self._shapes[k])
        if not all(map(Input.allows, self._declared, values)):
            outputs[self._numbers] = np.nan
        if far and self._flag is not None:
            outputs[self._flag[0]] = self._flag[1]
        return outputs

    def _evaluate_block(
        self, given: NDArray[np.float64], outputs: NDArray[np.float64], runner: Runner, rows: Rows
    ) -> None:
        """Evaluate designs of one block into the outputs."""
        count = given.shape[1]
        # lanes beyond the last design repeat it; their results are not read
        padded = -(-count // VECTOR) * VECTOR
        for row, index in rows:
            row[:count] = given[index]
            row[count:padded] = given[index, -1]
        runner.run(count)
        for k, result in enumerate(runner.results):
            outputs[k] = result[:count].reshape(count, *self._shapes[k])
