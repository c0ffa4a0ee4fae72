"""Say before a request runs what memory and disk it takes, and how long it takes."""

from __future__ import annotations

import os
import shutil
from collections.abc import Mapping
from dataclasses import dataclass, replace
from inspect import signature
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fastlink._text import aligned, counted, duration, size
from fastlink.codegen.kernel import SOON, llvm_text
from fastlink.codegen.translate import Refused
from fastlink.diagnostics.timing import Timing, timing_of
from fastlink.engine.executor import default_threads
from fastlink.engine.needs import needs_of
from fastlink.engine.options import check_options
from fastlink.engine.resolve import resolve
from fastlink.engine.sweep import sweep
from fastlink.errors import InputError, Problems
from fastlink.io.writing.target import check_target
from fastlink.memory import available_memory
from fastlink.precision import DESIGNS

if TYPE_CHECKING:
    from fastlink.codegen.kernel import Kernel
    from fastlink.engine.resolve import ResolvedSweep

__all__ = ["Forecast", "forecast", "request_of"]

#: The options of a sweep that change how it runs, not what it computes.
OF_RUN = ("verify", "to", "overwrite", "restart", "layout", "threads", "progress", "attrs", "block")

#: Seconds to compile a character of a kernel's LLVM text, by backend: measured over 32 kernels of 22 to 335 thousand
#: characters (0.9 to 2.1 us by our own translation) and over 5 by numba (20 to 72 us), on a core
#: with AVX-512 at 2.1 GHz.
SECONDS_PER_CHARACTER = {"llvm": 1.7e-6, SOON: 0.6e-6, "numba": 4e-5}
#: Bytes of the labels of a file, for each variable (2,500 to 4,200 in maps of 10 to 53 variables).
LABEL_BYTES = 3000


@dataclass(frozen=True)
class Forecast:
    """The expected needs of a request.

    Attributes
    ----------
    memory : int
        Bytes of a sweep whose result stays in memory: its arrays and buffers.
    memory_to_file : int
        Bytes of memory of a sweep to a file.
    available : int or None
        Bytes of memory that this process may take, if the system says so.
    file : int
        Bytes of the file.
    folder : Path
        The folder of the file.
    free : int or None
        Free bytes of its disk.
    kernels, compiled : int
        The number of kernels, and of those that are compiled already.
    compile_time : float
        Seconds to compile the others, estimated from the length of their texts.
    threads : int
        The number of threads.
    size : int
        The number of designs.
    timing : Timing or None
        The expected run time, measured on a sample of the designs; None where it was not measured.
    """

    memory: int
    memory_to_file: int
    available: int | None
    file: int
    folder: Path
    free: int | None
    kernels: int
    compiled: int
    compile_time: float
    threads: int
    size: int
    timing: Timing | None

    def __str__(self) -> str:
        left = "" if self.available is None else f"; {size(self.available)} are available"
        beyond = self.available is not None and self.memory > self.available
        memory = f"{size(self.memory)} to keep the result there{', which is refused' if beyond else ''}"
        free = "" if self.free is None else f"; {size(self.free)} are free in {self.folder}"
        rows = [
            ("memory", f"{memory}, {size(self.memory_to_file)} to write it to a file{left}"),
            ("file", f"{size(self.file)}{free}"),
            ("kernels", self._compilation()),
            ("run time", self._run_time()),
        ]
        return aligned([(f"{name}:", text) for name, text in rows], indent="  ")

    def _compilation(self) -> str:
        if self.compiled == self.kernels:
            return f"{self.kernels}, compiled already"
        fresh = self.kernels - self.compiled
        which = f"of which {self.compiled} are compiled already" if self.compiled else "not compiled yet"
        return f"{self.kernels}, {which}: about {duration(self.compile_time)} for {fresh}, by the length of the text"

    def _run_time(self) -> str:
        if self.timing is None:
            return "not measured, for not every kernel is compiled; --measure (measure=True) compiles them and measures"
        timing = self.timing
        parts = [f"{duration(timing.evaluation)} of evaluation by {counted(self.threads, 'thread')}"]
        if timing.verification:
            parts.append(f"{duration(timing.verification)} of verification")
        positions = f" at {counted(timing.positions, 'position')}" if timing.positions else ""
        measured = f"{timing.designs:,} of {counted(self.size, 'design')}{positions}"
        return f"about {duration(timing.total)} ({', '.join(parts)}), estimated from {measured}"


def request_of(
    mechanism: Any, space: Any, quantities: Any, options: Mapping[str, Any]
) -> tuple[ResolvedSweep, dict[str, Any]]:
    """Return the request of a call of `fastlink.sweep`, and what a forecast takes of its other options."""
    known = signature(sweep).parameters
    missing = [name for name, value in (("space", space), ("quantities", quantities)) if value is None]
    if missing:
        raise InputError(
            "is missing", where=(missing[0],), remedy="write explain(mechanism, space, quantities)"
        )
    positions = {name: value for name, value in options.items() if name not in known or name == "positions"}
    of_request = {name: value for name, value in options.items() if name not in (*positions, *OF_RUN)}
    problems, checked = Problems(), dict[str, Any]()
    with problems.at():
        checked = check_options({name: options[name] for name in OF_RUN if name in options})
    with problems.at():
        names = tuple(known)[:-1]
        resolved = resolve(mechanism, space, quantities, positions=positions, options=names, **of_request)
    problems.stop()
    to, verify = checked.get("to"), checked.get("verify")
    folder = None if to is None else check_target(to, 0, True).parent
    verify = (0 if to is None else DESIGNS) if verify is None else verify
    of_run = {name: checked.get(name) for name in ("threads", "block")}
    resolved = replace(resolved, layout=checked.get("layout", resolved.layout))
    return resolved, {**of_run, "folder": folder, "verify": verify}


def forecast(
    request: ResolvedSweep,
    *,
    folder: Path | None = None,
    threads: int | None = None,
    block: int | None = None,
    verify: int = 0,
    measure: bool | None = None,
) -> Forecast:
    """Return the expected needs of a request.

    Parameters
    ----------
    request : ResolvedSweep
        The request.
    folder : Path, optional
        Where its file is to be; None for a result that stays in memory.
    threads, block, verify
        As in `fastlink.sweep`.
    measure : bool, optional
        Whether to run a sample of the designs, with their kernels compiled if need be; by default where every kernel
        is compiled already.
    """
    backend, kernels = request.backend, request.kernels
    compilers = [kernel.compiler(backend, request.places(kernel)) for kernel in kernels]
    fresh = [way for way in zip(kernels, compilers, strict=True) if not way[0].is_compiled(way[1])]
    compile_time = sum(_compile_seconds(*way) for way in fresh)
    threads = threads or default_threads()
    needs = needs_of(request, threads, block, verify)
    timing = None
    # What is compiled soon runs slower, and so as not to be measured.
    if measure or (measure is None and all(kernel.is_compiled(backend) for kernel in kernels)):
        timing = timing_of(request, threads=threads, block=block, verify=verify, folder=folder)
    place = (Path.cwd() if folder is None else folder).resolve()
    labels = LABEL_BYTES * (len(request.plan.outputs) + len(request.space.names))
    axes = 8 * (sum(request.space.shape) + request.positions.size)
    return Forecast(
        needs.in_memory,
        needs.to_file,
        available_memory(),
        needs.values + labels + axes + 8 * sum(map(len, request.space.columns.values())),
        place,
        shutil.disk_usage(place).free if os.path.isdir(place) else None,
        len(kernels),
        len(kernels) - len(fresh),
        compile_time,
        threads,
        request.space.size,
        timing,
    )


def _compile_seconds(kernel: Kernel, compiler: str) -> float:
    """Return the expected time to compile a kernel, from the length of its text for LLVM."""
    try:
        length = len(llvm_text(kernel.source))
    except Refused:
        compiler, length = "numba", 8 * len(kernel.text)  # texts for LLVM are some eight times as long
    return SECONDS_PER_CHARACTER[compiler] * length
