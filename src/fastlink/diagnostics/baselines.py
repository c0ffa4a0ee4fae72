"""Ways to a quantity without any kernel: NumPy and scipy read the facts as they stand."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink.catalogue.evaluate import read_facts
from fastlink.catalogue.tables import angle_tables
from fastlink.symbolic.derivative import derivative_name

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from fastlink.engine.resolve import ResolvedSweep
    from fastlink.plan.query import Request

__all__ = ["by_brentq", "by_minimize", "by_numpy", "by_numpy_single"]


def by_numpy(asked: ResolvedSweep, designs: int) -> NDArray[Any]:
    """Return curves, or the greatest or least of their samples, in doubles."""
    return _taken(asked.plan.outputs[0].request, _curves(asked, designs, "float64"))


def by_numpy_single(asked: ResolvedSweep, designs: int) -> NDArray[Any]:
    """Return the same in single precision (but for arctangents)."""
    return _taken(asked.plan.outputs[0].request, _curves(asked, designs, "float32"))


def by_minimize(asked: ResolvedSweep, designs: int) -> NDArray[Any]:
    """Return extremes by scipy's minimize_scalar, from the best of the samples."""
    from scipy.optimize import minimize_scalar

    def found(
        at: Callable[[str, float], float], quantity: str, sign: float, low: float, high: float
    ) -> float:
        best = minimize_scalar(
            lambda t: -sign * at(quantity, t), bounds=(low, high), method="bounded", options={"xatol": 1e-12}
        )
        return float(-sign * best.fun)

    return _extremes(asked, designs, found)


def by_brentq(asked: ResolvedSweep, designs: int) -> NDArray[Any]:
    """Return extremes by scipy's brentq on the derivative, from the best of the samples."""
    from scipy.optimize import brentq

    position = asked.catalogue.position.name

    def found(
        at: Callable[[str, float], float], quantity: str, sign: float, low: float, high: float
    ) -> float:
        slope = derivative_name(quantity, position)
        if not at(slope, low) * at(slope, high) < 0.0:
            return np.nan
        return at(quantity, brentq(lambda t: at(slope, t), low, high, xtol=1e-15))

    return _extremes(asked, designs, found)


def _curves(asked: ResolvedSweep, designs: int, dtype: str) -> NDArray[Any]:
    """Return the quantity (designs, branches, positions)."""
    catalogue, plan = asked.catalogue, asked.plan
    tables = (catalogue.position.name, *catalogue.tables, *catalogue.table_low_parts)
    values = {name: column[:, None, None] for name, column in asked.space.at(np.arange(designs)).items()}
    values |= dict(zip(tables, angle_tables(catalogue, tables, asked.positions)[:, None, None], strict=True))
    values["branch"] = np.array(asked.branches, dtype=float)[None, :, None]
    values = {name: value.astype(dtype) for name, value in values.items()}
    quantity = plan.outputs[0].request.quantity
    with np.errstate(all="ignore"):
        found = read_facts(catalogue, [quantity], values, plan.variants)[quantity]
    shape = (designs, len(asked.branches), asked.positions.size)
    curves: NDArray[Any] = np.broadcast_to(found, shape).astype(float)
    return curves if catalogue.varies(quantity) else curves[:, 0, 0]


def _taken(request: Request, curves: NDArray[Any]) -> NDArray[Any]:
    if request.reduction is None:
        return curves
    sign = sign_of(request)
    found: NDArray[Any] = sign * np.fmax.reduce(sign * curves, axis=-1)
    return found


def sign_of(request: Request) -> float:
    """Return 1 for a greatest value, -1 for a least one."""
    assert request.reduction is not None
    assert request.reduction.has_place
    return float(request.reduction.sign)


def _extremes(asked: ResolvedSweep, designs: int, found: Callable[..., float]) -> NDArray[Any]:
    """Return for each design and branch what ``found`` makes of the steps beside the best sample."""
    request, catalogue = asked.plan.outputs[0].request, asked.catalogue
    curves, inputs = sign_of(request) * _curves(asked, designs, "float64"), asked.space.at(np.arange(designs))
    step = asked.positions[1] - asked.positions[0]
    result = np.full(curves.shape[:2], np.nan)
    for design, k in np.argwhere(np.isfinite(curves).any(axis=-1)).tolist():
        one = {name: float(column[design]) for name, column in inputs.items()}
        one["branch"] = float(asked.branches[k])

        def at(name: str, t: float, one: dict[str, float] = one) -> float:
            with np.errstate(all="ignore"):
                known = {**one, catalogue.position.name: np.float64(t)}
                return float(read_facts(catalogue, [name], known, asked.plan.variants)[name])

        middle = asked.positions[int(np.nanargmax(curves[design, k]))]
        result[design, k] = found(at, request.quantity, sign_of(request), middle - step, middle + step)
    return result
