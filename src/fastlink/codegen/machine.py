"""LLVM text to machine code, and machine code to something to call. This is the only module that knows LLVM's options.

Arithmetic is strict IEEE: no fastmath flag is ever written, so nothing is regrouped or fused. No vectoriser runs: loops
over lanes are vectors already, and other loops are short.
"""

from __future__ import annotations

import ctypes
import threading
from functools import cache
from typing import Any

import llvmlite
import llvmlite.binding as llvm

#: What the text leaves to do: short functions are merged into their callers, what stands in memory goes to registers,
#: what is computed twice is computed once. LLVM's O2 takes five times as long and its code as much time to run (within
#: 3 % over nine kernels).
PASSES = ("always_inliner", "sroa", "instruction_combine", "simplify_cfg", "new_gvn", "aggressive_dce")
#: Those of them without which code generation takes longer. With these alone, and the code generator's level 0, LLVM
#: takes a fourth of the time; the code takes up to twice as long to run, and gives the same bits (NaN signs aside).
SOON = ("always_inliner", "sroa")
#: Of the calls into LLVM: llvmlite has one lock for all of them anyway.
_lock = threading.RLock()


@cache
def _start() -> None:
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()


@cache
def host() -> tuple[str, str]:
    """Return the name of the processor, and its features as LLVM writes them."""
    return llvm.get_host_cpu_name(), llvm.get_host_cpu_features().flatten()


def version() -> str:
    """Return the version of LLVM and of its binding."""
    return f"llvmlite {llvmlite.__version__}, LLVM {'.'.join(map(str, llvm.llvm_version_info))}"


@cache
def lanes_of_host() -> int:
    """Return how many doubles a register of this processor holds: 8 with AVX-512, 4 with AVX, else 2."""
    features = host()[1].split(",")
    return 8 if "+avx512f" in features else 4 if "+avx" in features else 2


def _target_machine(cpu: str | None, triple: str | None = None, level: int = 2) -> Any:
    _start()
    name, features = (cpu, "") if cpu else host()
    target = llvm.Target.from_triple(triple) if triple else llvm.Target.from_default_triple()
    return target.create_target_machine(
        cpu=name, features=features, opt=level, reloc="pic", codemodel="default"
    )


def optimised(
    text: str,
    *,
    cpu: str | None = None,
    triple: str | None = None,
    check: bool = False,
    soon: bool = False,
) -> tuple[Any, Any]:
    """Return a module after LLVM's passes, and the target machine that they were for."""
    machine = _target_machine(cpu, triple, 0 if soon else 2)
    module = llvm.parse_assembly(text)
    if check:
        module.verify()
    module.triple = machine.triple
    module.data_layout = str(machine.target_data)
    builder = llvm.create_pass_builder(machine, llvm.create_pipeline_tuning_options(2))
    passes = llvm.create_new_module_pass_manager()
    for name in SOON if soon else PASSES:
        getattr(passes, f"add_{name}_pass")()
    passes.run(module, builder)
    return module, machine


def compile_object(text: str, **options: Any) -> bytes:
    """Return the object code of LLVM text; options as of `optimised`."""
    with _lock:
        module, machine = optimised(text, **options)
        return bytes(machine.emit_object(module))


def assembly(text: str, *, cpu: str | None = None, triple: str | None = None) -> str:
    """Return the assembly language of LLVM text."""
    with _lock:
        module, machine = optimised(text, cpu=cpu, triple=triple)
        return str(machine.emit_assembly(module))


class Loaded:
    """Object code in memory."""

    def __init__(self, code: bytes) -> None:
        with _lock:
            # Each engine owns a target machine: one that is shared crashed.
            # And llvmlite keeps the parts of one together: LLVM ends the process where great arrays stand between them.
            self._engine = llvm.create_mcjit_compiler(
                llvm.parse_assembly(""), _target_machine(None), use_lmm=True
            )
            self._engine.add_object_file(llvm.ObjectFileRef.from_data(code))
            self._engine.finalize_object()
            self.address: int = self._engine.get_function_address("kernel")
        if not self.address:
            raise ValueError("object code without a kernel")
        self.call = ctypes.CFUNCTYPE(None, ctypes.c_void_p)(self.address)
