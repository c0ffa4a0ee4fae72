"""The work of a study, and what it leaves out: counted in the loops of its kernels."""

from __future__ import annotations

import html
import textwrap
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from fastlink._text import aligned, counted
from fastlink.codegen.kernel import llvm_text
from fastlink.codegen.machine import assembly
from fastlink.codegen.translate import Refused
from fastlink.diagnostics.forecast import LABEL_BYTES, Forecast, forecast, request_of
from fastlink.diagnostics.work import HELPERS, KINDS, LoopWork, loop_work
from fastlink.doors import door
from fastlink.engine.resolve import ResolvedSweep, resolve
from fastlink.errors import InputError
from fastlink.options import check_switch
from fastlink.own.definition import OwnInput, OwnQuantity
from fastlink.plan.program import ExtremaProgram, KnownProgram
from fastlink.precision import DESIGNS
from fastlink.study.schema import A_STUDY
from fastlink.study.search import request_of_search
from fastlink.study.study import read_study

if TYPE_CHECKING:
    from fastlink.codegen.kernel import Kernel
    from fastlink.codegen.source import Source
    from fastlink.space.design_space import DesignSpace
    from fastlink.study.study import Study

__all__ = ["Explanation", "KernelWork", "LoopWork", "explain"]


class KernelWork(NamedTuple):
    """The work of one kernel.

    Attributes
    ----------
    results : str
        What it gives.
    facts : tuple of str
        The facts that it computes.
    loops : list of LoopWork
        The work of its loops.
    source : Source
        Its text, and what it is called with.
    """

    results: str
    facts: tuple[str, ...]
    loops: list[LoopWork]
    source: Source


@dataclass(frozen=True, eq=False)
class Explanation:
    """The work of a request; prints as text.

    Attributes
    ----------
    title : str
        The mechanism, and how many designs, branches and positions.
    results : tuple of str
        The requested results.
    scaling_axis : str
        The axis that is multiplied instead of evaluated, or an empty text.
    kernels : tuple of KernelWork
        The work of each kernel.
    left_out : tuple of str
        Public quantities of the mechanism that no requested result needs.
    facts_left_out, facts_known : int
        How many facts of the mechanism are not computed, and how many there are.
    tables : tuple of str
        Tabled functions of the input position; none for a map of designs.
    declared : tuple of str
        The names of quantities and inputs of a user that are read, and where the quantities are declared.
    forecast : Forecast or None
        The memory, file and time that it needs, where these were looked at.
    search : str
        What a search looks for, an empty text for a map.
    """

    title: str
    results: tuple[str, ...]
    scaling_axis: str
    kernels: tuple[KernelWork, ...]
    left_out: tuple[str, ...]
    facts_left_out: int
    facts_known: int
    tables: tuple[str, ...]
    declared: tuple[str, ...] = ()
    forecast: Forecast | None = None
    search: str = ""

    @door
    def text(self, *, kernels: bool = False, ir: bool = False, asm: bool = False) -> str:
        """Return the explanation, with the kernels' text, its translation for LLVM, its assembly language if wanted."""
        lines = [self.title, _folded("asked for", self.results)]
        lines += [_folded("declared by yourself", self.declared)] if self.declared else []
        if self.search:
            lines.append(_folded("searched for, and nothing else kept", [self.search]))
        if self.scaling_axis:
            lines.append(
                f"{self.scaling_axis}: only scales what is asked for; evaluated once, then multiplied"
            )
        if self.forecast is not None:
            lines += ["before it runs", str(self.forecast)]
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
            lines += ["", kernel.source.text] if kernels else []
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
        whole = f"<details><summary>what is computed</summary><pre>{html.escape(self.text())}</pre></details>"
        return f"<div><b>{title}</b><pre>{forecast}</pre>{whole}</div>"


@door(hint=A_STUDY)
def explain(
    study: str | Path,
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
    study : path or str
        A study file; or, with `space` and `quantities`, the name of a mechanism, or one that `fastlink.extend` returns.
    space, quantities, **options
        As in `fastlink.sweep`.
    measure : bool, optional
        Whether to run a sample of the designs: by default where nothing has to be compiled for it.
    trust_code : bool, default False
        Run the Python file of quantities that the study names (see `fastlink.run_study`).

    Returns
    -------
    Explanation
        Prints as text. Its `forecast` has the expected memory, file, compile time and run time.

    Raises
    ------
    InputError
        One line for each problem of the study.

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

    >>> import numpy as np
    >>> import fastlink as fl
    >>> designs = fl.grid(a1=np.linspace(0.1, 0.5, 40_000), a2=np.linspace(1.0, 1.4, 40_000), a3=0.8, a4=1.0)
    >>> needs = fl.explain("planar_4r", designs, ["theta4"], measure=False).forecast
    >>> needs.memory > 8 * 2 * 360 * 40_000**2  # 9 TB: write it to a file, if there is a disk for it
    True
    """
    measure = None if measure is None else check_switch(("measure",), measure)
    if space is None and quantities is None:
        for name in options:
            what = "is an option of a sweep, not of a study"
            raise InputError(
                what, where=(name,), remedy="write it in the study, or give space and quantities"
            )
        read = read_study(study, trust_code)
        if read.search is not None:
            return _of_search(read, measure)
        request = resolve(read.mechanism, read.space, read.quantities, **read.options)
        verify = read.output.get("verify", DESIGNS)
        needs = forecast(request, folder=read.target().parent, verify=verify, measure=measure)
    else:
        request, given = request_of(study, space, quantities, options)
        needs = forecast(request, measure=measure, **given)
    return replace(explain_request(request), forecast=needs)


def _of_search(read: Study, measure: bool | None) -> Explanation:
    """Return the work of the search of a study: it holds no more than the designs that are found."""
    search = request_of_search(
        read.mechanism,
        read.space,
        read.quantities,
        read.tables["search"],
        **{"positions": {}, **read.options},
    )
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
    sizes = [counted(request.space.size, "design"), counted(len(request.branches), "assembly mode")]
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


def _place(one: OwnInput | OwnQuantity) -> str:
    """Return the name of what a user has declared, and of a quantity where."""
    return f"{one.name} ({one.file}, line {one.line})" if isinstance(one, OwnQuantity) else one.name


def _kernel_work(kernel: Kernel) -> KernelWork:
    program = kernel.program
    names = ", ".join(output.name for output in program.outputs)
    if isinstance(program, ExtremaProgram):
        how = (
            "known extremes, which are not searched,"
            if isinstance(program, KnownProgram)
            else "every extreme"
        )
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
