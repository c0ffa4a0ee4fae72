"""The user's cache of machine code, under a hash of everything that the code depends on.

The cache only saves time: a damaged file is compiled again, and a folder that cannot be read, written or locked
costs a compilation. What it holds is run, so a folder or a file that another user owns, or may write, is not read.
Processes that want the same kernel wait for the one that compiles it.
"""

from __future__ import annotations

import atexit
import contextlib
import hashlib
import os
import re
import shutil
import stat
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TypeVar

import platformdirs

import fastlink.codegen
import fastlink.numerics
from fastlink.errors import InputError, remark

# -- A line on the terminal while kernels compile


#: Seconds after which the line appears that something compiles.
NOTICE_AFTER = 0.5
#: Seconds between two kernels that count as one wait.
PAUSE = 0.1
TEXT = "fastlink: compiling kernels, which are kept for next time ..."

#: When the wait at hand began, and when the last kernel was ready.
_began = _ended = float("-inf")


@contextmanager
def notice() -> Iterator[None]:
    """Show a line while something compiles for long, and wipe it out when that is done; on a terminal only."""
    global _began, _ended
    stream = sys.stderr
    if stream is None or not stream.isatty():
        yield
        return
    now = time.monotonic()
    if now - _ended > PAUSE:
        _began = now
    shown = threading.Event()

    def show() -> None:
        with suppress(OSError, ValueError):  # the stream may be closed
            stream.write(f"\r{TEXT}")
            stream.flush()
            shown.set()

    timer = threading.Timer(max(_began + NOTICE_AFTER - now, 0.0), show)
    timer.daemon = True
    timer.start()
    try:
        yield
    finally:
        timer.cancel()
        timer.join()
        if shown.is_set():
            stream.write(f"\r{' ' * len(TEXT)}\r")
            stream.flush()
        _ended = time.monotonic()


T = TypeVar("T")

#: Packages whose every file a kernel may depend on. The facts of mechanisms are pasted into its text, which is hashed.
PACKAGES = (fastlink.codegen, fastlink.numerics)
#: Bytes that the cache may take, unless FASTLINK_CACHE_BYTES says otherwise: some thousand kernels.
MOST_BYTES = 256 << 20
#: Seconds after which an unused kernel goes, even where there is room: most likely an older version made it.
UNUSED = 90 * 86400.0
#: Seconds to wait for another process that compiles the same kernel; none takes as long on an idle machine.
PATIENCE = 30.0
#: The folder is looked through for what must go when a process has written this part of what it may hold.
PART = 16
DIGEST = 32
#: What tells a kernel from others, in the names of all its files.
KEY = re.compile("[0-9a-f]{32,}")


def cache_folder() -> Path:
    """Return the folder of compiled kernels: of FASTLINK_CACHE_DIR, else in the user's cache; it may not exist."""
    chosen = os.environ.get("FASTLINK_CACHE_DIR") or platformdirs.user_cache_dir("fastlink")
    return Path(chosen) / "kernels"


def is_own(folder: Path) -> bool:
    """Tell whether nobody but this user can have put something into a folder, or a folder can be made there.

    Of one that others may have written it is said once, and how to mend it.
    """
    try:
        found = os.lstat(folder)
    except OSError:  # nothing is there to be run, or it cannot be read
        return True
    why = _not_own(found)
    if why:
        _remark(folder, why)
    return not why


def _not_own(found: os.stat_result) -> str:
    """Return why a file or folder may hold what another user has put there; empty where none can have."""
    if not hasattr(
        os, "geteuid"
    ):  # Windows has the folders of a user in his profile, which others cannot write
        return ""
    if found.st_uid != os.geteuid():
        return "belongs to another user"
    if stat.S_ISLNK(found.st_mode):
        return "is a link"
    return "can be written by other users" if found.st_mode & 0o022 else ""


@cache
def _remark(folder: Path, why: str) -> None:
    mend = (
        f"`chmod go-w {folder}`"
        if why.startswith("can")
        else "set FASTLINK_CACHE_DIR to a folder of your own"
    )
    remark(f"the cache of kernels {folder} {why}; they are compiled without it", remedy=mend)


@cache
def environment() -> bytes:
    """Return a digest of the packages that write, compile and run kernels."""
    digest = hashlib.sha256()
    for package in PACKAGES:
        for folder in package.__path__:
            for file in sorted(Path(folder).rglob("*.py")):
                digest.update(f"{file.relative_to(folder)} {file.stat().st_size} ".encode())
                digest.update(file.read_bytes())
    return digest.digest()


# -- one kernel ------------------------------------------------------------------------------------


def load_or_compile(key: str, compile: Callable[[], bytes], load: Callable[[bytes], T]) -> T:
    """Return loaded object code: from the cache, else compiled now and added to it."""
    path = cache_folder() / f"{key}.o"
    if not is_own(path.parent):
        with notice():
            return load(compile())
    if (loaded := _read(path, load)) is not None:
        return loaded
    with notice(), locked(key):
        loaded = _read(path, load)  # another process may have written it meanwhile
        if loaded is None:
            code = compile()
            loaded = load(code)
            with contextlib.suppress(OSError):
                _write(path, hashlib.sha256(code).digest() + code)
    return loaded


def _read(path: Path, load: Callable[[bytes], T]) -> T | None:
    """Return the loaded contents of a file of the cache; None where it is missing or damaged."""
    try:
        with open(path, "rb") as file:
            if _not_own(os.fstat(file.fileno())):
                return None
            data = file.read()
        code = data[DIGEST:]
        # LLVM crashes on some object code that is cut short, so nothing is tried whose digest is wrong.
        if not code or hashlib.sha256(code).digest() != data[:DIGEST]:
            return None
        loaded = load(code)
    except (OSError, RuntimeError, ValueError):
        return None
    _use(path)
    return loaded


def _use(path: Path) -> None:
    """Note that a file was used. The time of its change stays: numba's cache compares it."""
    with contextlib.suppress(OSError):
        os.utime(path, ns=(time.time_ns(), path.stat().st_mtime_ns))


@contextlib.contextmanager
def locked(key: str) -> Iterator[None]:
    """Let other processes that want the same kernel wait; without a lock where none can be had."""
    import filelock  # 15 ms, for nothing where the cache has all

    folder = cache_folder() / "locks"
    lock = filelock.FileLock(folder / f"{key[:2]}.lock")
    with contextlib.ExitStack() as stack:
        with contextlib.suppress(OSError, NotImplementedError):  # its Timeout is an OSError
            if not is_own(folder.parent):
                raise PermissionError(f"{folder.parent} is not this user's own")
            _make(folder)
            stack.enter_context(lock.acquire(timeout=PATIENCE, poll_interval=0.02))
        yield


def text_file(name: str, text: str) -> Path:
    """Return a file that holds a text: of the cache, or of this process alone where that cannot be written."""
    for folder in (cache_folder, _private_folder):
        path = folder() / name
        if not (is_own(path.parent) and _numba_files_are_own(path)):
            continue
        try:
            if path.read_bytes() == text.encode():
                _use(path)
                return path
        except OSError:
            pass
        with contextlib.suppress(OSError):
            _write(path, text.encode())
            return path
    raise OSError(f"neither {cache_folder()} nor {_private_folder()} can be written")


@cache
def _private_folder() -> Path:
    folder = tempfile.mkdtemp(prefix="fastlink-kernels-")
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return Path(folder)


def _numba_files_are_own(path: Path) -> bool:
    """Tell whether nobody else can have put something beside a file of the cache that numba would run."""
    beside = path.parent / "__pycache__"
    files = [path, beside, *beside.glob(f"*{path.stem}*")]
    return not any(_not_own(file.lstat()) for file in files if os.path.lexists(file))


def is_kept(key: str) -> bool:
    """Tell whether the cache has a kernel, of whichever compiler."""
    folder = cache_folder()
    if not is_own(folder):
        return False
    return (folder / f"{key}.o").is_file() or any((folder / "__pycache__").glob(f"*{key}*.nbc"))


def remove_numba_files(key: str) -> None:
    """Remove the files that numba writes beside that of a kernel."""
    for folder in (cache_folder(), _private_folder()):
        for path in (folder / "__pycache__").glob(f"*{key}*"):
            with contextlib.suppress(OSError):
                path.unlink()


def _write(path: Path, data: bytes) -> None:
    """Write a file at once: what is half written has another name."""
    _make(path.parent)
    temporary = path.with_name(f"{path.name}.{os.getpid()}-{threading.get_ident()}.tmp")
    try:
        temporary.write_bytes(data)
        temporary.chmod(0o600)
        os.replace(temporary, path)
    except BaseException:
        with contextlib.suppress(OSError):
            temporary.unlink()
        raise
    _bound(len(data))


def _make(folder: Path) -> None:
    """Make a folder of the cache, and those above it that are missing, which others cannot write whatever the umask."""
    for missing in reversed([one for one in (folder, *folder.parents) if not one.exists()]):
        missing.mkdir(mode=0o700, exist_ok=True)


# -- all of them -----------------------------------------------------------------------------------


@dataclass(frozen=True)
class Contents:
    """The contents of the cache."""

    folder: Path
    kernels: int
    size: int
    limit: int


@dataclass
class _Entry:
    """All files of one kernel."""

    files: list[Path]
    size: int = 0
    used: float = 0.0


def limit() -> int:
    """Return how many bytes the cache may take: FASTLINK_CACHE_BYTES, else 256 MiB."""
    chosen = os.environ.get("FASTLINK_CACHE_BYTES", "")
    if not chosen:
        return MOST_BYTES
    if not chosen.isdecimal():
        raise InputError(
            f"environment variable FASTLINK_CACHE_BYTES: {chosen!r} is not a number of bytes; "
            f"write such as {MOST_BYTES}, or 0 to keep nothing"
        )
    return int(chosen)


def _entries() -> dict[str, _Entry]:
    """Return the files of the cache by kernel; numba has several files for one."""
    entries: dict[str, _Entry] = {}
    for folder, inner, names in os.walk(cache_folder()):
        inner[:] = [name for name in inner if name != "locks"]
        for name in names:
            path = Path(folder, name)
            with contextlib.suppress(OSError):  # another process removes files too
                known = path.lstat()
                key = KEY.search(name)
                entry = entries.setdefault(key[0] if key else name, _Entry([]))
                entry.files.append(path)
                entry.size += known.st_size
                entry.used = max(entry.used, known.st_atime, known.st_mtime)
    return entries


def contents() -> Contents:
    """Return how much the cache holds."""
    entries = _entries()
    return Contents(cache_folder(), len(entries), sum(entry.size for entry in entries.values()), limit())


def clear() -> Contents:
    """Remove every kernel, and return what there was. Processes that have them loaded go on."""
    before = contents()
    for entry in _entries().values():
        _remove(entry)
    shutil.rmtree(before.folder / "locks", ignore_errors=True)
    return before


def _remove(entry: _Entry) -> None:
    for file in entry.files:
        with contextlib.suppress(OSError):
            file.unlink()


#: Bytes that this process has written since it last removed what must go.
_written: float = float("inf")


def _bound(size: int) -> None:
    """Remove the kernels that were not used for longest until the rest is in bounds; not at every call."""
    global _written
    _written += size
    if _written * PART < limit():
        return
    _written = 0.0
    entries = sorted(_entries().values(), key=lambda entry: entry.used)
    too_many = sum(entry.size for entry in entries) - limit()
    for entry in entries:
        if too_many <= 0 and entry.used > time.time() - UNUSED:
            break
        _remove(entry)
        too_many -= entry.size
