"""The derivatives of a function's outputs by its inputs, as a function of their own."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink.doors import door
from fastlink.errors import InputError, Problems
from fastlink.facts.names import Derivative, GradientStatus, Quantity, Reduced, derivative_name
from fastlink.numerics.gradient_status import MOVING, NOTHING
from fastlink.plan.query import parse_request
from fastlink.symbolic.changes import is_tolerance
from fastlink.symbolic.derivative import NoDependence

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from fastlink.engine.function import Function
    from fastlink.engine.resolve import ResolvedSweep
    from fastlink.plan.program import Output
    from fastlink.plan.query import Request

__all__ = ["WithGradient", "derivative_of"]

#: Codes of the status of derivatives where there is none of a mean, whatever the input.
NONE = (MOVING, NOTHING)


class WithGradient:
    """A function of arrays that has the derivatives of its outputs by its inputs."""

    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    shape: tuple[int, ...]
    _resolved: ResolvedSweep
    _recipe: Callable[[list[str]], Function]
    _rows: Callable[[ArrayLike], NDArray[np.float64]]

    @door(name="function", hint="x is one array, with a row for each input")
    def gradient(self, x: ArrayLike) -> NDArray[np.float64]:
        """Return the derivatives (outputs, inputs, ...) of the outputs of designs (inputs, ...).

        Those of extremes, means and places over the cycle are ``d_NAME_max_d_INPUT`` and its like, see
        docs/design_search.md: where two places tie or the motion has a limit, they are one-sided or NaN.

        Parameters
        ----------
        x : array (inputs, ...)
            The designs.

        Returns
        -------
        array (outputs, inputs, ...)
            The derivatives, followed by the axes of the function's result; 0 where an output does not depend on an
            input, and NaN where it has no value there, or is a mean over a range whose limits move.

        Raises
        ------
        InputError
            An output has no derivative.

        Examples
        --------
        >>> import fastlink as fl
        >>> speed = fl.function("planar_4r", ["a2", "a3"], ["omega4_max"], a1=0.4, a4=1.0, omega1=25.0)
        >>> speed.gradient([1.2, 0.8]).round(6)
        array([[  7.846495, -17.870504]])
        """
        rows = self._rows(x)
        function, wanted = self._derivatives
        result = np.zeros((len(self.outputs), len(self.inputs), *rows.shape[1:], *self.shape))
        found = dict(zip(function.outputs, function(rows), strict=True))
        for name, place in wanted.by_name.items():
            result[place] = found[name]
        for name, places in wanted.zero_unless.items():
            none = np.isin(found[name], NONE) if name in wanted.statuses else np.isnan(found[name])
            for place in places:
                result[place] = np.where(none, np.nan, 0.0)
        return result

    @property
    def without_gradient(self) -> tuple[str, ...]:
        """The outputs that have no derivatives: codes, lists, error bounds."""
        try:
            _wanted(self._resolved, self.inputs)
        except InputError as error:
            return tuple({self.outputs[int(one.where[1])]: None for one in error.problems})
        return ()

    @cached_property
    def _derivatives(self) -> tuple[Function, _Wanted]:
        """The function that gives what derivatives are made of, and what that is."""
        wanted = _wanted(self._resolved, self.inputs)
        return self._recipe(list(dict.fromkeys((*wanted.by_name, *wanted.zero_unless)))), wanted


@dataclass
class _Wanted:
    """Quantities of which derivatives are made, each with the numbers of the output and of the input.

    Attributes
    ----------
    by_name : dict
        The derivatives.
    zero_unless : dict
        Outputs that do not depend on inputs, NaN where that has no derivative: the outputs themselves, or `statuses`.
    statuses : set of str
        Those that are the status of derivatives.
    """

    by_name: dict[str, tuple[int, int]] = field(default_factory=dict)
    zero_unless: dict[str, list[tuple[int, int]]] = field(default_factory=dict)
    statuses: set[str] = field(default_factory=set)


def _wanted(resolved: ResolvedSweep, inputs: Sequence[str]) -> _Wanted:
    """Return what the derivatives of the outputs by the inputs are made of.

    Raises
    ------
    InputError
        An output has no derivative: a code, a list, an error bound.
    """
    catalogue, variants, given = resolved.catalogue, resolved.plan.variants, resolved.space.names
    wanted = _Wanted()
    problems = Problems()
    for j, by in enumerate(inputs):
        if is_tolerance(by):
            remedy = "make a function of the other inputs, with the tolerance as a number that stays"
            problems.add(f"{by!r} is a tolerance, by which there are no derivatives", ("inputs", j), remedy)
    problems.stop()
    for k, output in enumerate(resolved.plan.outputs):
        with problems.at("outputs", k):
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
                    moves = catalogue.moves_at_limits(of, by, variants, given)
                    if not (output.refined and moves):
                        test = _none_of(output, moves)
                        wanted.statuses.update({test} - {output.name})
                        wanted.zero_unless.setdefault(test, []).append((k, j))
                        continue
                wanted.by_name[name] = k, j
    problems.stop()
    return wanted


def _none_of(output: Output, moves: bool) -> str:
    """Return the quantity that tells where an output that does not depend on an input has no derivative by it."""
    how = output.request.reduction
    if how is None or not moves or how.has_position:
        return output.name  # NaN
    return str(GradientStatus(Reduced(Quantity(output.request.quantity), how.suffix)))


def derivative_of(request: Request, by: str, position: str) -> str:
    """Return the name of the derivative of a requested quantity or reduction."""
    of: Any = Quantity(request.quantity)
    if request.reduction is not None:
        of = Reduced(of, request.reduction.suffix, position if request.is_position else "")
    return str(Derivative(of, by))
