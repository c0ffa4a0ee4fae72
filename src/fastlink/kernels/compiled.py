"""Kernel text to machine code, kept in the user's cache under a hash of all it depends on.

Numba's own cache does not notice an edited helper in another file. A kernel's file name therefore is the
hash of its text, of the helpers' sources, of numba's version and of the processor.
"""

from __future__ import annotations

import hashlib
import importlib.util
import os
import sys
import tempfile
import threading
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import llvmlite.binding
import numba
import platformdirs
from numba import types

from fastlink.jit import compile_kernel

if TYPE_CHECKING:
    from types import ModuleType

    from fastlink.closure import Closure

__all__ = ["cache_folder", "kernel_key", "load_kernel"]

HELPERS = (
    *("jit.py", "logarithm.py", "geometry.py", "kernels/dense.py", "kernels/whole.py"),
    *("kernels/items.py", "kernels/search.py", "kernels/bracket.py", "kernels/found.py"),
)
_lock = threading.Lock()


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


@lru_cache(maxsize=1)
def _environment() -> bytes:
    """Return what every kernel depends on besides its text."""
    here = Path(__file__).parents[1]
    digest = hashlib.sha256()
    for name in HELPERS:
        digest.update((here / name).read_bytes())
    cpu = llvmlite.binding.get_host_cpu_name() + llvmlite.binding.get_host_cpu_features().flatten()
    digest.update(f"{numba.__version__} {llvmlite.__version__} {sys.version} {cpu}".encode())
    return digest.digest()


def kernel_key(text: str) -> str:
    """Return what tells a kernel's machine code from all others."""
    return hashlib.sha256(_environment() + text.encode()).hexdigest()[:32]


def _load_module(text: str) -> ModuleType:
    name = f"fastlink_kernel_{kernel_key(text)}"
    if name in sys.modules:
        return sys.modules[name]
    path = cache_folder() / f"{name}.py"
    if not path.exists():
        # Another process may write the same file: each writes its own and renames it.
        handle, temporary = tempfile.mkstemp(dir=path.parent, suffix=".tmp")
        with os.fdopen(handle, "w") as file:
            file.write(text)
        os.replace(temporary, path)
    spec = importlib.util.spec_from_file_location(name, path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    spec.loader.exec_module(module)
    return module


def signature(plan: Closure) -> tuple[Any, ...]:
    """Return numba's types of the kernel's arguments."""
    vector, matrix = types.float64[::1], types.float64[:, ::1]
    outputs = []
    for output in plan.outputs:
        dtype = getattr(types, output.dtype)
        outputs.append(types.Array(dtype, 1 + len(output.axes), "C"))
    return (matrix, matrix, types.int64, types.int64, vector, vector, *outputs)


def load_kernel(plan: Closure, text: str, *, relaxed: bool = False) -> Any:
    """Return the kernel of a plan with this text, compiled now or taken from the cache."""
    with _lock:
        module = _load_module(f"# relaxed arithmetic\n{text}" if relaxed else text)
        if not hasattr(module, "compiled"):
            made = compile_kernel(module.kernel, signature(plan), relaxed=relaxed)
            module.compiled = made  # type: ignore[attr-defined]
        return module.compiled
