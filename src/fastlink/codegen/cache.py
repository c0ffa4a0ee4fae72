"""Machine code, kept in the user's cache under a hash of all it depends on."""

from __future__ import annotations

import contextlib
import hashlib
import os
import tempfile
from collections.abc import Callable
from functools import cache, lru_cache
from pathlib import Path

import platformdirs

import fastlink.codegen
import fastlink.numerics

__all__ = ["cache_folder", "environment", "kept", "written_file"]

#: Packages whose every file a kernel may depend on.
PACKAGES = (fastlink.codegen, fastlink.numerics)


def cache_folder() -> Path:
    """Return the folder of compiled kernels: FASTLINK_CACHE_DIR, else the user's cache folder.

    Where neither can be written, a folder for this process alone.
    """
    chosen = os.environ.get("FASTLINK_CACHE_DIR") or platformdirs.user_cache_dir("fastlink")
    folder = Path(chosen) / "kernels"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        if os.access(folder, os.W_OK | os.X_OK):
            return folder
    except OSError:
        pass
    return _private_folder()


@lru_cache(maxsize=1)
def _private_folder() -> Path:
    return Path(tempfile.mkdtemp(prefix="fastlink-kernels-"))


@cache
def environment() -> bytes:
    """Return a digest of the packages that write, compile and run kernels."""
    digest = hashlib.sha256()
    for package in PACKAGES:
        for folder in package.__path__:
            for file in sorted(Path(folder).rglob("*.py")):
                digest.update(file.read_bytes())
    return digest.digest()


def written_file(name: str, text: str) -> Path:
    """Return a file of the cache that holds a text."""
    path = cache_folder() / name
    if not path.exists():
        _write(path, text.encode())
    return path


def _write(path: Path, data: bytes) -> None:
    # Another process may write the same file: each writes its own and renames it.
    handle, temporary = tempfile.mkstemp(dir=path.parent, suffix=".tmp")
    with os.fdopen(handle, "wb") as file:
        file.write(data)
    os.replace(temporary, path)


def kept(key: str, compile: Callable[[], bytes]) -> bytes:
    """Return the object code under a key: from the cache, else compiled now and kept there."""
    path = cache_folder() / f"{key}.o"
    try:
        data = path.read_bytes()
    except OSError:
        data = b""
    digest, code = data[:32], data[32:]
    if hashlib.sha256(code).digest() == digest:
        return code
    code = compile()
    with contextlib.suppress(OSError):
        _write(path, hashlib.sha256(code).digest() + code)
    return code
