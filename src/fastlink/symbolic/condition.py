"""Conditions on values of which less is known than a number: what is computed with them takes either way."""

from __future__ import annotations

from typing import Any, Self

__all__ = ["Condition"]


class Condition:
    """The result of a comparison, which counts as met; a subclass says what `choose` returns."""

    def __and__(self, other: Any) -> Self:
        return self

    __rand__ = __or__ = __ror__ = __and__

    def __bool__(self) -> bool:
        """Satisfy `sqrt` of `fastlink.numerics.elementary`, which tests the sign of its argument."""
        return True

    def choose(self, if_true: Any, if_false: Any) -> Any:
        """Return what is known of both values of `fastlink.numerics.elementary.select`."""
        raise NotImplementedError
