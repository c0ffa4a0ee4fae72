"""Say what a request computes, what it takes of memory, disk and time, and what it leaves out."""

from __future__ import annotations

import ast
import contextlib
import html
import os
import shutil
import statistics
import tempfile
import textwrap
import threading
import time
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from inspect import signature
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from fastlink._text import aligned, counted, duration, size
from fastlink.app.study import A_STUDY, Study, read_study, request_of_search
from fastlink.codegen.kernel import SOON, Kernel, llvm_text
from fastlink.codegen.machine import assembly
from fastlink.codegen.runtime import cells
from fastlink.codegen.translate import Refused
from fastlink.engine.options import check_options, checked_call
from fastlink.engine.resolve import ResolvedSweep, of_request, resolve
from fastlink.engine.run import Job, Sink, default_threads, row_bytes, run
from fastlink.engine.sinks import designs_per_block, needs_of
from fastlink.engine.sweep import sweep
from fastlink.errors import InputError, door
from fastlink.facts.fact import Input
from fastlink.facts.own import OwnQuantity
from fastlink.io.checksums import count_of
from fastlink.io.partial_file import check_target, write_all
from fastlink.machine import available_memory
from fastlink.numerics import compensated, vectors
from fastlink.numerics.compiler import COMPILED_AS, INLINED, parsed, syntax
from fastlink.plan.programs import ExtremaProgram, KnownProgram
from fastlink.precision import DESIGNS, Verification
from fastlink.space.design_space import DesignSpace, sampled

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from fastlink.codegen.source import Source


# -- Time a request on a sample of its designs, to say beforehand how long all of them take


#: Seconds after which no more designs are evaluated, and bytes of results after which no more are.
PATIENCE, MOST_BYTES = 0.03, 64 << 20
#: The middle one of so many times counts: a time slice of another process, of some 10 ms, is in few of them.
REPEATS = 5
#: So many input positions are evaluated; the time of more grows in proportion.
MOST_POSITIONS = 4096
#: Pieces of the design space that are looked at, for designs that do not assemble take less time.
PIECES = 16
#: Designs that are computed again with 50 digits.
VERIFIED, SEED = 2, 0
#: Seconds that a file takes besides its values, and for each of its variables: loading what writes it, laying it out,
#: reading its labels again; measured 0.25 to 0.85 s for 7 to 29 variables, a tenth of it where it is not the first.
FILE_SECONDS, VARIABLE_SECONDS = 0.3, 0.01


@dataclass(frozen=True)
class Timing:
    """The expected time of a request in seconds, measured on a sample of its designs."""

    #: Evaluating all designs, and writing them where there is a file.
    evaluation: float
    #: Computing some of them again with 50 digits.
    verification: float
    #: Making the file.
    file: float
    #: How many designs were timed, and at how many input positions.
    designs: int
    positions: int

    @property
    def total(self) -> float:
        """What a map calls its run time: all of it, besides compiling and verification."""
        return self.evaluation + self.file


def timing_of(
    request: ResolvedSweep,
    *,
    threads: int,
    block: int | None = None,
    verify: int = 0,
    folder: Path | None = None,
) -> Timing:
    """Time a sample of the designs of a request; kernels that are not compiled yet are compiled first."""
    for kernel in request.kernels:
        kernel.compiled(request.backend)
    total = request.positions.size
    sample = replace(request, positions=request.positions[:MOST_POSITIONS])
    started = time.perf_counter()
    job = sample.job()
    tables = time.perf_counter() - started
    length = designs_per_block(sample, threads, block)
    with _scratch(folder if request.space.size > 1 else None) as write:
        axis = request.scaling_axis
        sink = write if axis is None else axis.over(write)
        seconds, designs = _evaluated(sample, job, sink, threads, length)
    positions = sample.positions.size if request.plan.uses_position else 0
    evaluation = (total / positions if positions else 1.0) * (tables + seconds / designs * job.size)
    variables = len(request.plan.outputs) + len(request.space.names)
    file = 0.0 if folder is None else FILE_SECONDS + VARIABLE_SECONDS * variables
    return Timing(evaluation, _verification(request, verify), file, designs, positions)


def _evaluated(sample: ResolvedSweep, job: Job, sink: Sink, threads: int, length: int) -> tuple[float, int]:
    """Evaluate more and more designs from all over the space; return the time of the last, and their number."""
    row = row_bytes(job.shapes) * (1 if sample.scaling_axis is None else sample.scaling_axis.length)
    most = max(1, min(job.size, MOST_BYTES // row))
    count = min(most, 2 * length)
    run(job, sink=sink, threads=threads, block=length, pending=_spread(job.size, 1))

    def timed(pending: list[tuple[int, int]]) -> float:
        started = time.perf_counter()
        run(job, sink=sink, threads=threads, block=length, pending=pending)
        return time.perf_counter() - started

    pending = _spread(job.size, count)
    while timed(pending) < PATIENCE and count < most:
        count = min(most, 4 * count)
        pending = _spread(job.size, count)
    seconds = statistics.median(timed(pending) for _ in range(REPEATS))
    return seconds, count_of(pending)


def _spread(size: int, count: int) -> list[tuple[int, int]]:
    """Return ranges of about so many designs, evenly spread over all."""
    pieces = min(PIECES, count)
    each = -(-count // pieces)
    starts = np.linspace(0, size - each, pieces).astype(np.int64).tolist()
    ranges = zip(starts, [0, *(start + each for start in starts)], strict=False)
    return [(max(start, end), start + each) for start, end in ranges if end < start + each]


@contextlib.contextmanager
def _scratch(folder: Path | None) -> Iterator[Sink]:
    """Yield a sink that takes results for a moment, over and over: a file without a name, else memory."""
    lock, position, fd = threading.Lock(), 0, -1

    def write(start: int, stop: int, arrays: Sequence[NDArray[Any]]) -> None:
        nonlocal position
        for array in arrays:
            if fd < 0:
                array.copy()
                continue
            with lock:
                start_at, position = position, (position + array.nbytes) % MOST_BYTES
            with contextlib.suppress(OSError):  # a full disk is refused elsewhere
                write_all(fd, array.reshape(-1).view(np.uint8).data, start_at)

    with contextlib.ExitStack() as stack:
        if folder is not None:
            with contextlib.suppress(OSError):
                fd = stack.enter_context(tempfile.TemporaryFile(dir=folder)).fileno()
        yield write


def _verification(request: ResolvedSweep, verify: int) -> float:
    """Return the expected time of the verification, from that of a few designs."""
    space, count = request.space, min(verify, request.space.size)
    if not count:
        return 0.0
    columns = space.at(space.some(VERIFIED, np.random.default_rng(SEED)))
    few = replace(request, space=sampled("table", {}, columns, {}), scaling_axis=None)
    job = few.job()
    arrays = [np.empty((job.size, *shape), dtype) for shape, dtype in job.shapes]
    run(job, targets=arrays)
    verification = Verification(few.plan, few.space, few.positions, job.size)
    verification.collect(0, job.size, arrays)
    return verification.expected_time(count)


# -- Say before a request runs what memory and disk it takes, and how long it takes


#: Seconds to compile a character of a kernel's LLVM text, by backend: measured over 32 kernels of 22 to 335 thousand
#: characters (0.9 to 2.1 us by our own translation) and over 5 by numba (20 to 72 us), on a core
#: with AVX-512 at 2.1 GHz.
SECONDS_PER_CHARACTER = {"llvm": 1.7e-6, SOON: 0.6e-6, "numba": 4e-5}
#: Bytes of the labels of a file, for each variable (2,500 to 4,200 in maps of 10 to 53 variables).
LABEL_BYTES = 3000


@dataclass(frozen=True)
class Forecast:
    """The expected needs of a request."""

    #: Bytes of a sweep whose result stays in memory: its arrays and buffers.
    memory: int
    #: Bytes of memory of a sweep to a file.
    memory_to_file: int
    #: Bytes of memory that this process may take, if the system says so.
    available: int | None
    #: Bytes of the file.
    file: int
    #: The folder of the file.
    folder: Path
    #: Free bytes of its disk.
    free: int | None
    #: The number of kernels, and of those that are compiled already.
    kernels: int
    compiled: int
    #: Seconds to compile the others, estimated from the length of their texts.
    compile_time: float
    #: The number of threads.
    threads: int
    #: The number of designs.
    size: int
    #: The expected run time, measured on a sample of the designs; None where it was not measured.
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
            # short runs have their kernels in a hurry: these may be there, and not be those that would be measured
            return "not measured; --measure (measure=True) compiles the kernels as long runs have them, and measures"
        timing = self.timing
        after = f", then {duration(timing.verification)} of verification" if timing.verification else ""
        positions = f" at {counted(timing.positions, 'position')}" if timing.positions else ""
        measured = f"{timing.designs:,} of {counted(self.size, 'design')}{positions}"
        time = f"{duration(timing.total)} by {counted(self.threads, 'thread')}"
        return f"about {time}{after}, estimated from {measured}"


def request_of(
    mechanism: Any, space: Any, quantities: Any, options: Mapping[str, Any]
) -> tuple[ResolvedSweep, dict[str, Any]]:
    """Return the request of a call of `fastlink.sweep`, and what a forecast takes of its other options."""
    for name, value in (("space", space), ("quantities", quantities)):
        if value is None:
            raise InputError("is missing", (name,), "write explain(mechanism, space, quantities)")
    known = tuple(signature(sweep).parameters)[:-1]
    positions = {name: value for name, value in options.items() if name not in known}
    call = {**options, "positions": positions}
    checked, resolved = checked_call(
        call, lambda given: resolve(mechanism, space, quantities, options=known, **of_request(given))
    )
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
    """Return the expected needs of a request."""
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


# -- The work of the loops of a kernel, counted in the statements that the writer of its text recorded


OPERATIONS = {
    ast.Add: "+ -",
    ast.Sub: "+ -",
    ast.USub: "+ -",
    ast.Mult: "*",
    ast.Div: "/",
    ast.Compare: "choices",
    ast.IfExp: "choices",
}
CALLS = {"select": "choices", "sqrt": "sqrt", "abs": "+ -"}
ELEMENTARY = ("atan2", "cosine", "sine", "log_quotient", "arsinh")
#: Functions that are counted by what they do.
HELPERS = {
    name: COMPILED_AS.get(function, function)
    for module in (compensated, vectors, cells)
    for name, function in vars(module).items()
    if getattr(function, "__module__", "") == module.__name__
    and COMPILED_AS.get(function, function) in INLINED
}
KINDS = ("+ -", "*", "/", "sqrt", "choices", "atan2, log, cos", "loads", "stores")


class LoopWork(NamedTuple):
    """The work of one loop of a kernel in each of its passes."""

    #: For what a pass is: a design, an input position, both, a sample, a step of a refinement.
    per: str
    #: How often.
    times: str
    #: Number of operations of each kind, of numbers read from arrays and written to arrays; functions of the house
    #: are counted by what they do, elementary functions as one; functions with loops are not counted.
    work: dict[str, int]


def loop_work(source: Source) -> list[LoopWork]:
    """Return the work of every loop of a kernel that computes something."""
    rows = []
    for loop in source.loops:
        work: Counter[str] = Counter()
        for statement in parsed("\n".join(loop.statements)).body:
            _count(statement, work)
        if any(work.values()):
            rows.append(LoopWork(loop.per, loop.times, {kind: work[kind] for kind in KINDS}))
    return rows


def _count(statement: ast.stmt, work: Counter[str]) -> None:
    """Add the operations of an assignment, or of the result of a function."""
    if not isinstance(statement, (ast.Assign, ast.Return)) or statement.value is None:
        return
    pending: list[ast.AST] = [statement.value]
    if isinstance(statement, ast.Assign):
        work["stores"] += sum(isinstance(target, ast.Subscript) for target in statement.targets)
    while pending:
        node = pending.pop()
        if isinstance(node, ast.Subscript):
            work["loads"] += 1
            continue
        if isinstance(node, ast.Call):
            name = node.func.id if isinstance(node.func, ast.Name) else ""
            if name in ELEMENTARY:
                work["atan2, log, cos"] += 1
            elif name in CALLS:
                work[CALLS[name]] += 1
            elif name in HELPERS:
                work.update(_helper(name))
        operation = getattr(node, "op", node)
        if isinstance(node, (ast.operator, ast.unaryop)) or _is_constant(node):
            continue
        if kind := OPERATIONS.get(type(operation)):
            work[kind] += 1
        pending += ast.iter_child_nodes(node)


def _is_constant(node: ast.AST) -> bool:
    """Tell whether the compiler knows a value: a number, a constant of the module, an expression of these."""
    if isinstance(node, ast.Name):
        return any(isinstance(getattr(module, node.id, None), float) for module in (compensated, vectors))
    if isinstance(node, (ast.BinOp, ast.UnaryOp)):
        operands = (node.left, node.right) if isinstance(node, ast.BinOp) else (node.operand,)
        return all(_is_constant(operand) for operand in operands)
    return isinstance(node, ast.Constant)


@cache
def _helper(name: str) -> Counter[str]:
    """Return the operations of a function that is pasted at each call."""
    work: Counter[str] = Counter()
    for statement in syntax(HELPERS[name]).body:
        _count(statement, work)
    return work


# -- The work of a study, and what it leaves out: counted in the loops of its kernels


class KernelWork(NamedTuple):
    """The work of one kernel."""

    #: What it gives.
    results: str
    #: The facts that it computes.
    facts: tuple[str, ...]
    #: The work of its loops.
    loops: list[LoopWork]
    #: Its text, and what it is called with.
    source: Source


@dataclass(frozen=True, eq=False)
class Explanation:
    """The work of a request; prints as text."""

    #: The mechanism, and how many designs, branches and positions.
    title: str
    #: The requested results.
    results: tuple[str, ...]
    #: The axis that is multiplied instead of evaluated, or an empty text.
    scaling_axis: str
    #: The work of each kernel.
    kernels: tuple[KernelWork, ...]
    #: Public quantities of the mechanism that no requested result needs.
    left_out: tuple[str, ...]
    #: How many facts of the mechanism are not computed, and how many there are.
    facts_left_out: int
    facts_known: int
    #: Tabled functions of the input position; none for a map of designs.
    tables: tuple[str, ...]
    #: The names of quantities and inputs of a user that are read, and where the quantities are declared.
    declared: tuple[str, ...] = ()
    #: The memory, file and time that it needs, where these were looked at.
    forecast: Forecast | None = None
    #: What a search looks for, an empty text for a map.
    search: str = ""

    @door
    def text(self, *, kernels: bool = False, code: bool = False, ir: bool = False, asm: bool = False) -> str:
        """Return the explanation, if wanted with what each kernel computes, its text, LLVM's, its assembly language."""
        lines = [self.title, _folded("asked for", self.results)]
        lines += [_folded("declared by yourself", self.declared)] if self.declared else []
        if self.search:
            lines.append(_folded("searched for, and nothing else kept", [self.search]))
        if self.scaling_axis:
            lines += [f"{self.scaling_axis}: only scales what is asked for; evaluated once, then multiplied"]
        if self.forecast is not None:
            lines += ["before it runs", str(self.forecast)]
        if not (kernels or code or ir or asm):
            return "\n".join([*lines, "what each kernel computes: --kernels, or .text(kernels=True)"])
        lines.append(
            _folded("tables of the input", self.tables or ["none: nothing depends on the input position"])
        )
        for number, kernel in enumerate(self.kernels, 1):
            rows = [(loop.per, loop.times, *map(str, loop.work.values())) for loop in kernel.loops]
            lines += [
                "",
                f"kernel {number} of {len(self.kernels)}: {kernel.results}",
                _folded("computes", kernel.facts),
                aligned([("for each", "how often", *KINDS), *rows], right=2, indent="  "),
            ]
            if helpers := [name for name in kernel.source.calls if name not in HELPERS]:
                lines.append(_folded("  not counted", helpers))
            lines += ["", kernel.source.text] if code else []
            if ir or asm:
                lines += _machine_texts(kernel.source, ir, asm)
        share = f"{self.facts_left_out} of {self.facts_known} facts"
        return "\n".join([*lines, "", _folded(f"left out: {share}, among them", self.left_out)])

    def __str__(self) -> str:
        return self.text()

    __repr__ = __str__

    def _repr_html_(self) -> str:
        """Return what it needs as a notebook shows it; the kernels are folded up."""
        title, forecast = html.escape(self.title), html.escape(str(self.forecast or ""))
        kernels = html.escape(self.text(kernels=True))
        whole = f"<details><summary>what is computed</summary><pre>{kernels}</pre></details>"
        return f"<div><b>{title}</b><pre>{forecast}</pre>{whole}</div>"


@door(hint=A_STUDY)
def explain(
    subject: Any,
    space: DesignSpace | None = None,
    quantities: Sequence[str] | None = None,
    *,
    measure: bool | None = None,
    trust_code: bool = False,
    **options: Any,
) -> Explanation:
    """Return the work of a study or a sweep, what it leaves out, and what it needs.

    No kernel is compiled unless `measure` says so. Where every kernel is compiled already, a sample of the designs is
    run, some tenths of a second, to say how long all of them take.

    Parameters
    ----------
    subject : path, str or Extension
        A study file; or, with `space` and `quantities`, a mechanism, as in `fastlink.sweep`.
    space, quantities, **options
        As in `fastlink.sweep`.
    measure : bool, optional
        Whether to run a sample of the designs: by default where nothing has to be compiled for it.
    trust_code : bool, default False
        Run the Python file of quantities that the study names (see `fastlink.run`).

    Returns
    -------
    Explanation
        Prints as text. Its `forecast` has the expected memory, file, compile time and run time.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> text = '''
    ... mechanism = "planar_4r"
    ... quantities = ["grashof_class"]
    ... design = {a1 = 0.4, a2 = 1.1, a3 = 0.8, a4 = 1.0}
    ... '''
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder, "study.toml")
    ...     _ = path.write_text(text)
    ...     found = explain(path)
    >>> found.tables, [loop.per for loop in found.kernels[0].loops]
    ((), ['design'])

    The same of a sweep:

    >>> designs = fl.grid(a1=np.linspace(0.1, 0.5, 40_000), a2=np.linspace(1.0, 1.4, 40_000), a3=0.8, a4=1.0)
    >>> needs = fl.explain("planar_4r", designs, ["theta4"], measure=False).forecast
    >>> needs.memory > 8 * 360 * 40_000**2  # 5 TB: write it to a file, if there is a disk for it
    True
    """
    measure = check_options({"measure": measure})["measure"]
    if space is None and quantities is None:
        for name in options:
            what = "is an option of a sweep, not of a study"
            raise InputError(what, (name,), "write it in the study, or give space and quantities")
        read = read_study(subject, trust_code)
        if read.search is not None:
            return _of_search(read, measure)
        request = resolve(read.mechanism, read.space, read.quantities, **read.options)
        verify = read.output.get("verify", DESIGNS)
        needs = forecast(request, folder=read.target().parent, verify=verify, measure=measure)
    else:
        request, given = request_of(subject, space, quantities, options)
        needs = forecast(request, measure=measure, **given)
    return replace(explain_request(request), forecast=needs)


def _of_search(read: Study, measure: bool | None) -> Explanation:
    """Return the work of the search of a study: it holds no more than the designs that are found."""
    of_sweep = {"positions": {}, **read.options}
    table = read.tables["search"]
    search = request_of_search(read.mechanism, read.space, read.quantities, table, **of_sweep)
    needs = forecast(search.resolved, measure=measure)
    file = LABEL_BYTES * (len(search.quantities) + len(read.space.names))
    needs = replace(needs, memory=needs.memory_to_file, file=file)
    about = str(search.about()["search"])
    return replace(explain_request(search.resolved), forecast=needs, search=about)


def explain_request(request: ResolvedSweep) -> Explanation:
    """Return the work of a request, and what it leaves out."""
    plan, catalogue, axis = request.plan, request.catalogue, request.scaling_axis
    computed = {name for program in plan.programs for step in program.steps for name in step.names}
    requested = {output.request.quantity for output in plan.outputs}
    sizes = [counted(request.space.size, "design"), counted(len(request.branches), "branch")]
    if plan.uses_position:
        sizes.append(f"{counted(request.positions.size, 'value')} of {catalogue.position.name}")
    return Explanation(
        f"{request.mechanism}: {', '.join(sizes)}",
        tuple(output.name for output in plan.outputs),
        "" if axis is None else f"{axis.name} ({counted(axis.length, 'value')})",
        tuple(map(_kernel_work, request.kernels)),
        tuple(name for name in catalogue.public if name not in computed | requested),
        sum(name not in computed for name in catalogue.facts),
        len(catalogue.facts),
        tuple(dict.fromkeys(table for program in plan.programs for table in program.tables)),
        tuple(map(_place, request.declared)),
    )


def _place(one: Input | OwnQuantity) -> str:
    """Return the name of what a user has declared, and of a quantity where."""
    return f"{one.name} ({one.file}, line {one.line})" if isinstance(one, OwnQuantity) else one.name


def _kernel_work(kernel: Kernel) -> KernelWork:
    program = kernel.program
    names = ", ".join(output.name for output in program.outputs)
    if isinstance(program, ExtremaProgram):
        is_known = isinstance(program, KnownProgram)
        how = "known extremes, which are not searched," if is_known else "every extreme"
        found = dict.fromkeys(search.quantity for search in program.searches if not search.splits)
        names += f"; {how} of {', '.join(found)}"
        if splits := [search.quantity for search in program.searches if search.splits]:
            names += f"; cells split at the zeros of {', '.join(splits)}"
    facts = tuple(name for step in program.steps for name in step.names)
    return KernelWork(names, facts, loop_work(kernel.source), kernel.source)


def _machine_texts(source: Source, ir: bool, asm: bool) -> list[str]:
    """Return a kernel in LLVM's language, in assembly language, or both."""
    try:
        text = llvm_text(source)
    except Refused as why:
        return ["", f"compiled by numba, for the translator refuses it: {why}"]
    return [*(["", text] if ir else []), *(["", assembly(text)] if asm else [])]


def _folded(head: str, names: Iterable[str]) -> str:
    return textwrap.fill(f"{head}: {', '.join(names)}", 110, subsequent_indent="  ")
