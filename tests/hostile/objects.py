"""Objects that fail where a caller looks at them."""

from __future__ import annotations

import enum
from typing import Any


class Sulky:
    """Refuses to be shown."""

    def __repr__(self) -> str:
        raise RuntimeError("no repr")

    __str__ = __repr__


class BadArray:
    """Refuses to become an array."""

    def __array__(self, dtype: Any = None, copy: Any = None) -> Any:
        raise RuntimeError("no array")


class BadFloat:
    """Refuses to become a number."""

    def __float__(self) -> float:
        raise RuntimeError("no float")

    def __index__(self) -> int:
        raise RuntimeError("no index")


class BadLength:
    """A sequence that refuses to tell its length."""

    def __len__(self) -> int:
        raise RuntimeError("no length")

    def __getitem__(self, index: Any) -> Any:
        raise RuntimeError("no item")


class BadIteration:
    """Refuses to be iterated."""

    def __iter__(self) -> Any:
        raise RuntimeError("no iteration")


class BadTruth:
    """Refuses to be compared and to be true or false."""

    __hash__ = None  # type: ignore[assignment]

    def __eq__(self, other: object) -> bool:
        raise RuntimeError("no equality")

    def __bool__(self) -> bool:
        raise RuntimeError("no truth")


class BadAttributes:
    """Refuses every attribute that it is asked for."""

    def __getattr__(self, name: str) -> Any:
        raise RuntimeError("no attribute")


class BadPath:
    """Refuses to become a path."""

    def __fspath__(self) -> str:
        raise RuntimeError("no path")


class Everything:
    """Has every attribute, and each is itself."""

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        return self

    def __call__(self, *args: Any, **options: Any) -> Any:
        return self


class Real(float):
    """A float of another class."""


class Whole(int):
    """An int of another class."""


class Name(str):
    """A text of another class."""


class Code(enum.IntEnum):
    """Assembly modes as somebody may enumerate them."""

    RIGHT = 1
    LEFT = 2


def circle() -> list[Any]:
    """Return a list that holds itself."""
    inside: list[Any] = []
    inside.append(inside)
    return inside


def deep() -> Any:
    """Return a list in a list, a thousand times."""
    inside: Any = []
    for _ in range(1000):
        inside = [inside]
    return inside
