"""The derivatives of a function's outputs by its inputs, as a function of their own."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink.doors import door
from fastlink.errors import InputError, Problems
from fastlink.facts.names import Derivative, Quantity, Reduced, derivative_name
from fastlink.plan.query import parse_request
from fastlink.symbolic.changes import is_tolerance
from fastlink.symbolic.derivative import NoDependence

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from fastlink.engine.function import Function
    from fastlink.engine.resolve import ResolvedSweep
    from fastlink.plan.query import Request

__all__ = ["WithGradient", "derivative_of"]


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
            input.

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
        function, places = self._derivatives
        result = np.zeros((len(self.outputs), len(self.inputs), *rows.shape[1:], *self.shape))
        if function is not None:
            for (k, j), found in zip(places, function(rows), strict=True):
                result[k, j] = found
        return result

    @property
    def without_gradient(self) -> tuple[str, ...]:
        """The outputs that have no derivatives: codes, lists, error bounds."""
        try:
            _names_of(self._resolved, self.inputs)
        except InputError as error:
            return tuple({self.outputs[int(one.where[1])]: None for one in error.problems})
        return ()

    @cached_property
    def _derivatives(self) -> tuple[Function | None, list[tuple[int, int]]]:
        """The function that gives the derivatives that are not zero everywhere, and output and input of each."""
        places = _names_of(self._resolved, self.inputs)
        return self._recipe(list(places)) if places else None, list(places.values())


def _names_of(resolved: ResolvedSweep, inputs: Sequence[str]) -> dict[str, tuple[int, int]]:
    """Return the names of the derivatives of the outputs by the inputs, with the numbers of both.

    Raises
    ------
    InputError
        An output has no derivative: a code, a list, an error bound.
    """
    catalogue, variants, given = resolved.catalogue, resolved.plan.variants, resolved.space.names
    names: dict[str, tuple[int, int]] = {}
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
                    if not output.refined or not catalogue.moves_at_limits(of, by, variants, given):
                        continue
                names[name] = k, j
    problems.stop()
    return names


def derivative_of(request: Request, by: str, position: str) -> str:
    """Return the name of the derivative of a requested quantity or reduction."""
    of: Any = Quantity(request.quantity)
    if request.reduction is not None:
        of = Reduced(of, request.reduction.suffix, position if request.is_position else "")
    return str(Derivative(of, by))
