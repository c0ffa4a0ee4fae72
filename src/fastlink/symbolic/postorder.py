"""Visit values after those that they are made of, in chains of any length: no recursion."""

from __future__ import annotations

from collections.abc import Callable, Container, Hashable, Iterable, Iterator
from typing import TypeVar

__all__ = ["CircularError", "postorder"]

T = TypeVar("T", bound=Hashable)


class CircularError(Exception):
    """A value is made of itself; the arguments are the values on the way round."""


def postorder(
    roots: Iterable[T], parts: Callable[[T], Iterable[T]], done: Container[T] = frozenset()
) -> Iterator[T]:
    """Yield values that are not done, each after its parts.

    Parameters
    ----------
    roots : iterable
        The values to reach.
    parts : callable
        Returns the values that one is made of.
    done : container
        Values that count as visited. The caller adds each value to them before the next one is taken.

    Raises
    ------
    CircularError
        A value is made of itself.
    """
    for root in roots:
        path = {} if root in done else {root: iter(parts(root))}
        pending = [*path]
        while pending:
            value = pending[-1]
            for part in path[value]:
                if part not in done:
                    if part in path:
                        raise CircularError(*path, part)
                    path[part] = iter(parts(part))
                    pending.append(part)
                    break
            else:
                del path[pending.pop()]
                yield value
