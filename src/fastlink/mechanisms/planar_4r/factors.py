"""The eight factors of the coefficients of the input-output equations, eq. (1), as sums without loss."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from fastlink.mechanisms.planar_4r import scaling  # noqa: F401 (on which it builds)
from fastlink.mechanisms.planar_4r.inputs import HAYES, planar_4r
from fastlink.numerics.compensated import sum_of_four


def _factor(law: Callable[..., Any]) -> Callable[..., Any]:
    """Declare a factor of eq. (1), a sum without loss: high and low part."""
    name = law.__name__
    return planar_4r.quantity(
        units="1",
        symbol=f"{name[-2]}_{name[-1]}",
        source=f"{HAYES}, eq. (1)",
        internal=True,
        low=f"{name}_low",
    )(law)


@_factor
def factor_A1(s1: Any, s2: Any, s3: Any, s4: Any) -> Any:
    """a1 - a2 + a3 - a4, scaled."""
    return sum_of_four(s1, -s2, s3, -s4)


@_factor
def factor_A2(s1: Any, s2: Any, s3: Any, s4: Any) -> Any:
    """a1 + a2 + a3 - a4, scaled."""
    return sum_of_four(s1, s2, s3, -s4)


@_factor
def factor_B1(s1: Any, s2: Any, s3: Any, s4: Any) -> Any:
    """a1 + a2 - a3 - a4, scaled."""
    return sum_of_four(s1, s2, -s3, -s4)


@_factor
def factor_B2(s1: Any, s2: Any, s3: Any, s4: Any) -> Any:
    """a1 - a2 - a3 - a4, scaled."""
    return sum_of_four(s1, -s2, -s3, -s4)


@_factor
def factor_C1(s1: Any, s2: Any, s3: Any, s4: Any) -> Any:
    """a1 - a2 - a3 + a4, scaled."""
    return sum_of_four(s1, -s2, -s3, s4)


@_factor
def factor_C2(s1: Any, s2: Any, s3: Any, s4: Any) -> Any:
    """a1 + a2 - a3 + a4, scaled."""
    return sum_of_four(s1, s2, -s3, s4)


@_factor
def factor_D1(s1: Any, s2: Any, s3: Any, s4: Any) -> Any:
    """a1 + a2 + a3 + a4, scaled."""
    return sum_of_four(s1, s2, s3, s4)


@_factor
def factor_D2(s1: Any, s2: Any, s3: Any, s4: Any) -> Any:
    """a1 - a2 + a3 + a4, scaled."""
    return sum_of_four(s1, -s2, s3, s4)
