"""Let several threads take work until there is none, or until one of them fails."""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Callable
from concurrent.futures import FIRST_EXCEPTION, Future, ThreadPoolExecutor, wait

__all__ = ["work_in_threads"]


def work_in_threads(work: Callable[[], None], threads: int, name: str, stop: threading.Event) -> None:
    """Call a function in several threads, and wait for all; at an exception, or Ctrl-C, all are to end.

    Parameters
    ----------
    work : callable
        Takes pieces of work, which the threads share, one by one, until `stop` is set.
    threads : int
        Number of threads. Where the system starts fewer, these do all the work.
    name : str
        What the names of the threads begin with.
    stop : threading.Event
        Set when one has failed: the others finish their piece and no more.
    """

    def until_one_fails() -> None:
        # The thread of a failed call may begin the next one, and a writer keeps by thread what belongs to a piece.
        try:
            work()
        except BaseException:
            stop.set()
            raise

    with ThreadPoolExecutor(threads, thread_name_prefix=name) as pool:
        futures: list[Future[None]] = []
        try:
            with contextlib.suppress(RuntimeError):  # the system starts no more
                while len(futures) < threads:
                    futures.append(pool.submit(until_one_fails))
            if not futures:
                work()
            for future in wait(futures, return_when=FIRST_EXCEPTION).done:
                future.result()
        finally:
            stop.set()
