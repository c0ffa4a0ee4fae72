"""Kernels to call: the text of a kernel, its machine code, and how it is called."""

from __future__ import annotations

import hashlib
import math
import os
import sys
import threading
from collections.abc import Callable, Sequence
from functools import cache, cached_property, lru_cache, partial
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink.codegen.cache import environment, is_kept, load_or_compile, locked, notice, remove_numba_files
from fastlink.codegen.extremes import write_extrema
from fastlink.codegen.known import write_known
from fastlink.codegen.machine import Loaded, compile_object, host, lanes_of_host, version
from fastlink.codegen.pointwise import write_kernel
from fastlink.codegen.source import Source
from fastlink.codegen.translate import Refused, translate
from fastlink.errors import check_choice
from fastlink.plan.programs import ExtremaProgram, KnownProgram, Program

if TYPE_CHECKING:
    from numpy.typing import NDArray

#: Compilers of kernels: the translator of this package, and numba.
BACKENDS = ("llvm", "numba")
KINDS = {"float64": "f", "int64": "i", "int8": "c"}
#: The first of them where there is little to do: in a third of the time, to code that takes up to twice as long to run.
SOON = "llvm soon"
#: Places up to which it does that. What it saves was lost again after 270,000 to 5,000,000 places of curves, and after
#: 4,000 to 500,000 designs of extremes, over 57 kernels; these count as so many places each.
FEW, SEARCHED = 1 << 16, 16
_lock = threading.Lock()
_loaded: dict[str, Callable[..., None]] = {}


def backend_of(chosen: str | None) -> str:
    """Return the compiler to use: the chosen one, else that of FASTLINK_BACKEND, else our own."""
    if chosen is not None:
        return check_choice(("backend",), chosen, BACKENDS)
    name = os.environ.get("FASTLINK_BACKEND") or BACKENDS[0]
    return check_choice(("environment variable FASTLINK_BACKEND",), name, BACKENDS)


@cache
def _environment() -> bytes:
    """Return a digest of everything that a kernel depends on besides its text."""
    return environment() + repr((version(), sys.platform, host(), lanes_of_host())).encode()


def kernel_key(source: Source, backend: str = "") -> str:
    """Return a hash that tells a kernel's machine code from all others."""
    text = repr((source.arguments, backend)) + source.text
    return hashlib.sha256(_environment() + text.encode()).hexdigest()[:32]


def llvm_text(source: Source, *, lanes: int | None = None, fast_math: Sequence[str] = ()) -> str:
    """Return the kernel as LLVM's assembly language, for vectors of so many lanes; see `translate`."""
    arguments = [(KINDS[dtype], lengths) for dtype, lengths in source.arguments]
    return translate(source.text, arguments, lanes or lanes_of_host(), fast_math)


class MachineCode(Loaded):
    """Machine code with the arguments of a `Source`.

    It is called with designs, angles, their numbers, scratch and results. The arrays must lie in rows and not overlap.
    """

    def __init__(self, source: Source, code: bytes) -> None:
        super().__init__(code)
        self._arguments = source.arguments

    def table(self, *arguments: Any) -> NDArray[np.int64]:
        """Return the addresses and lengths of the arguments, as the machine code reads them."""
        entries = []
        for (dtype, lengths), argument in zip(self._arguments, arguments, strict=True):
            if not lengths:
                entries.append(argument)
                continue
            if argument.dtype != dtype or argument.ndim != len(lengths) or not argument.flags.c_contiguous:
                raise TypeError(
                    f"{dtype} array in rows of {len(lengths)} axes expected, not {argument.dtype} "
                    f"{argument.shape}"
                )
            entries.append(argument.ctypes.data)
            for length, known in zip(argument.shape, lengths, strict=True):
                if known is None:
                    entries.append(length)
                elif known != length:
                    raise TypeError(f"{length} entries along an axis of {known}")
        return np.array(entries, dtype=np.int64)

    def __call__(self, *arguments: Any) -> None:
        """Evaluate."""
        table = self.table(*arguments)  # it lives as long as the call
        self.call(table.ctypes.data)


def load_kernel(source: Source, compiler: str = BACKENDS[0]) -> Callable[..., None]:
    """Return a kernel, compiled now or taken from the cache; numba compiles what the translator refuses."""
    with _lock:
        if compiler == SOON and _is_there(kernel_key(source, BACKENDS[0])):
            compiler = BACKENDS[0]
        key = kernel_key(source, compiler)
        if key not in _loaded:
            _loaded[key] = _load(source, key, compiler)
        return _loaded[key]


def _is_there(key: str) -> bool:
    return key in _loaded or is_kept(key)


def _load(source: Source, key: str, compiler: str) -> Callable[..., None]:
    if compiler != "numba":
        try:
            return load_or_compile(
                key,
                lambda: compile_object(llvm_text(source), soon=compiler == SOON),
                partial(MachineCode, source),
            )
        except Refused:
            key = kernel_key(source, BACKENDS[0])
    from fastlink.codegen.numba_backend import compile_by_numba

    with notice(), locked(key):
        try:
            return compile_by_numba(source, key)
        except Exception:  # of all kinds, where a file of numba's cache is damaged
            remove_numba_files(key)
            return compile_by_numba(source, key)


class Kernel:
    """The kernel of a program: its text, and its machine code, each made when it is first used."""

    def __init__(self, program: Program) -> None:
        self.program = program
        self._compiled: dict[str, Callable[..., None]] = {}
        self._places = 0.0

    @cached_property
    def source(self) -> Source:
        """The text of the kernel, and the arguments that it is called with."""
        if isinstance(self.program, KnownProgram):
            return write_known(self.program)
        if isinstance(self.program, ExtremaProgram):
            return write_extrema(self.program)
        return write_kernel(self.program)

    @property
    def text(self) -> str:
        """The text of the kernel."""
        return self.source.text

    @cached_property
    def key(self) -> str:
        """A hash of the kernel's text and arguments, of fastlink's code and of the machine."""
        return kernel_key(self.source)

    def places(self, designs: float, positions: int) -> float:
        """Return how many places it evaluates: each design at each input position."""
        return designs * (positions if self.program.tables else SEARCHED)

    def compiler(self, backend: str, places: float) -> str:
        """Return what compiles it if it is about to evaluate so many more places; see `load_kernel`."""
        return SOON if backend == BACKENDS[0] and self._places + places <= FEW else backend

    def is_compiled(self, compiler: str) -> bool:
        """Tell whether the kernel need not be compiled: it is loaded, or in the cache."""
        enough = {compiler, BACKENDS[0] if compiler == SOON else compiler}
        return compiler in self._compiled or any(_is_there(kernel_key(self.source, one)) for one in enough)

    def compiled(self, backend: str | None = None, places: float = math.inf) -> Any:
        """Return the kernel as a callable, compiled or loaded from the cache on first use."""
        backend = backend_of(backend)
        compiler = self.compiler(backend, places)
        self._places += places
        if compiler not in self._compiled:
            self._compiled[compiler] = load_kernel(self.source, compiler)
        return self._compiled[compiler]


@lru_cache(maxsize=1024)
def kernel_of(program: Program) -> Kernel:
    """Return the kernel of a program, made once."""
    return Kernel(program)
