"""Run functions in another process, to which they travel by value: the tests are not importable there."""

from __future__ import annotations

import multiprocessing
import operator
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from typing import Any

import cloudpickle

__all__ = ["other_process"]


class _ByValue:
    """A function that is pickled as the bytes that cloudpickle makes of it."""

    def __init__(self, function: Callable[..., Any]) -> None:
        self.data = cloudpickle.dumps(function)

    def __reduce__(self) -> tuple[Any, ...]:
        return cloudpickle.loads, (self.data,)


@contextmanager
def other_process() -> Iterator[Callable[..., Any]]:
    """Give ``run(function, *args)``, which calls a function in one fresh process."""
    with ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("spawn")) as pool:
        yield lambda function, *args: pool.submit(operator.call, _ByValue(function), *args).result()
