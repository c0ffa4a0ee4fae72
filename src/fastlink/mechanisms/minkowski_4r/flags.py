"""Flags of the Minkowskian 4R: why the coupler point or the rates are not finite numbers."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from fastlink._text import in_words
from fastlink.mechanisms.minkowski_4r import coupler, rates, sextic  # noqa: F401 (which they describe)
from fastlink.mechanisms.minkowski_4r.inputs import NUMERICS, minkowski_4r
from fastlink.numerics.elementary import INFINITY, select

CONFIGURATIONS = f"{NUMERICS}#configurations"
THERE = {0: "there", 1: "see_configuration_status", 2: "beyond_the_range_of_numbers"}


def with_reason(code: Any, configuration_status: Any) -> Any:
    """Return a code, 1 instead where the status of the configuration gives the reason."""
    lacking = (configuration_status > 0.0) & (configuration_status < 7.0)
    return select((code > 0.0) & lacking, 1.0, code)


def code_of_point(X_x: Any, X_y: Any, sextic_residual: Any) -> Any:
    """0 where the coupler point and its residual are finite, 2 where it is not, 3 where the residual alone is not."""
    missed = select(abs(sextic_residual) < INFINITY, 0.0, 3.0)
    return select((abs(X_x) < INFINITY) & (abs(X_y) < INFINITY), missed, 2.0)


def code_of_rates(dpsi_dtheta: Any, d2psi_dtheta2: Any) -> Any:
    """0 where both rates are finite, 2 where the first is not, 3 where the second alone is not."""
    return select(abs(dpsi_dtheta) < INFINITY, select(abs(d2psi_dtheta2) < INFINITY, 0.0, 3.0), 2.0)


def declare_flags(name: str, law: Callable[..., Any], what: str, third: str) -> None:
    """Declare the code of missing values, alone and after the reason that the configuration gives."""
    step = minkowski_4r.steps(units="1", source=CONFIGURATIONS)
    step(law, f"{name}_code", name)
    status = minkowski_4r.quantities(units="1", source=CONFIGURATIONS, flags=THERE | {3: third})
    meaning = f"Why {what} is not a finite number"
    status(with_reason, f"{name}_status", in_words(name), meaning, code=f"{name}_code")


declare_flags(
    "coupler_point", code_of_point, "the coupler point", "sextic_residual_beyond_the_range_of_numbers"
)
declare_flags("rates", code_of_rates, "a rate of psi", "second_rate_beyond_the_range_of_numbers")
