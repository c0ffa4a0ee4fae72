"""Threads that take work until one of them fails, and the memory that is left."""

from __future__ import annotations

import contextlib
import os
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import FIRST_EXCEPTION, Future, ThreadPoolExecutor, wait
from pathlib import Path

from fastlink._text import size
from fastlink.errors import InputError, KeyPath, Remedy

# -- Let several threads take work until there is none, or until one of them fails


def work_in_threads(work: Callable[[], None], threads: int, name: str, stop: threading.Event) -> None:
    """Call a function in several threads, and wait for all; at an exception, or Ctrl-C, all are to end."""

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


# -- The memory that a process may still take, and the refusal of what does not fit


try:
    import resource
except ImportError:  # not POSIX
    resource = None  # type: ignore[assignment]


#: Less is never refused, so that small requests do not pay for the look-up (0.2 to 0.7 ms).
ALWAYS_FITS = 64 << 20
FILES, TOTALS = ("inactive_file", "active_file"), ("total_inactive_file", "total_active_file")
#: Of a control group, by version: the files of its limit and its use, and the kinds of memory that it gives back.
GROUPS = (
    ("", "memory.max", "memory.current", FILES),
    ("memory", "memory.limit_in_bytes", "memory.usage_in_bytes", TOTALS),
)


def check_memory(nbytes: int, what: str, *, where: KeyPath = (), remedy: Remedy = "") -> None:
    """Refuse what needs more memory than there is; to be called before anything is allocated."""
    if nbytes <= ALWAYS_FITS:
        return
    available = available_memory()
    if available is not None and nbytes > available:
        needs = f"{what} needs {size(nbytes)} of memory, but {size(available)} are available"
        raise InputError(needs, where, remedy)


def available_memory() -> int | None:
    """Return how many bytes this process may still take without swapping, None where the system does not say."""
    # The least of what the machine has left, what the control groups of a container or a job allow, and the
    # limit of the address space (``ulimit -v``).
    known = [*_of_machine(), *_of_groups(Path("/proc/self/cgroup"), Path("/sys/fs/cgroup")), *_of_limit()]
    return max(0, min(known)) if known else None


def _of_machine() -> Iterator[int]:
    """Yield what the machine has left; of a machine that does not say, all that it has."""
    if available := _entry(Path("/proc/meminfo"), "MemAvailable:"):
        yield available * 1024
        return
    try:
        yield os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, OSError, ValueError):  # not POSIX, or a name that it does not know
        return


def _of_groups(own: Path, root: Path) -> Iterator[int]:
    """Yield what each control group of this process allows it to take."""
    for line in _text(own).splitlines():
        _, controllers, path = line.split(":", 2)
        for folder, limit, use, given_back in GROUPS:
            if folder not in controllers.split(","):
                continue
            top = root / folder
            # a container may see its own group at the top, whatever its path on the host
            group = top / path.lstrip("/")
            for place in (group, *group.parents):
                most, used = _text(place / limit).strip(), _text(place / use).strip()
                if most.isdecimal() and used.isdecimal():
                    free = sum(_entry(place / "memory.stat", kind) for kind in given_back)
                    yield int(most) - int(used) + free
                if place == top:
                    break


def _of_limit() -> Iterator[int]:
    """Yield what the limit of the address space leaves."""
    if resource is None:
        return
    most, _ = resource.getrlimit(resource.RLIMIT_AS)
    pages = _text(Path("/proc/self/statm")).split()
    if most != resource.RLIM_INFINITY and pages:
        yield most - int(pages[0]) * resource.getpagesize()


def _entry(path: Path, name: str) -> int:
    """Return a number from a file of lines of names and numbers; 0 where there is none."""
    rows = (line.split() for line in _text(path).splitlines())
    return next((int(row[1]) for row in rows if row and row[0] == name), 0)


def _text(path: Path) -> str:
    try:
        return path.read_text()
    except OSError:
        return ""
