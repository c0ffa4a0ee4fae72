"""Every kind of kernel: the text run as Python, our machine code and numba's give the same bits."""

import importlib
import pkgutil
import re

import llvmlite.binding as llvm
import numpy as np
import pytest
from tests.support.compiled import assert_same_bits
from tests.support.plan_families import FAMILIES, few, kernels, run_as_python, run_code, run_compiled

import fastlink.codegen.runtime
from fastlink.codegen.kernel import BACKENDS, llvm_text
from fastlink.codegen.machine import compile_object, host, lanes_of_host
from fastlink.numerics.compiler import OUTLINED


@pytest.mark.sample(4)
@pytest.mark.parametrize("name", FAMILIES)
def test_machine_code_has_the_bits_of_the_text(name):
    for kernel, arguments in kernels(FAMILIES[name].request()):
        text = llvm_text(kernel.source)
        llvm.parse_assembly(text).verify()
        expected = run_as_python(kernel, arguments)  # first: Python looks whether indices are within arrays
        found = run_compiled(kernel, arguments)
        assert_same_bits(found, expected)
        assert_same_bits(run_code(kernel, arguments, compile_object(text, soon=True)), found)
        assert_written(kernel, arguments, found)


@pytest.mark.parametrize("name", few("few angles"))
def test_both_compilers_give_the_same_bits(name):
    for kernel, arguments in kernels(FAMILIES[name].request()):
        first, *others = (run_compiled(kernel, arguments, backend) for backend in BACKENDS)
        for other in others:
            assert_same_bits(first, other)


LEVELS = {
    "x86-64-v2": {"sse4.2"},
    "x86-64-v3": {"avx2", "bmi2", "fma"},
    "x86-64-v4": {"avx512f", "avx512bw", "avx512cd", "avx512dq", "avx512vl"},
}


def levels():
    """Return the instruction sets that this processor has, from the first on."""
    has = {feature[1:] for feature in host()[1].split(",") if feature.startswith("+")}
    return [level for level, needed in LEVELS.items() if needed <= has]


@pytest.mark.parametrize("name", few("systems", "extremes of one branch"))
def test_any_width_and_instruction_set_gives_the_same_bits(name):
    """Wider vectors than a register holds are several registers."""
    for kernel, arguments in kernels(FAMILIES[name].request()):
        expected = run_compiled(kernel, arguments)
        # Other widths by the processor's own instructions, and each by those that have registers of it.
        others = [(None, lanes) for lanes in (2, 4, 8) if lanes != lanes_of_host()]
        for cpu, lanes in [*others, *zip(levels(), (2, 4, 8), strict=False)]:
            code = compile_object(llvm_text(kernel.source, lanes=lanes), cpu=cpu, check=True)
            assert_same_bits(run_code(kernel, arguments, code), expected)


def assert_written(kernel, arguments, found):
    """Every result was stored, and there is more in it than what does not assemble."""
    for output, before, after in zip(kernel.program.outputs, arguments[-len(found) :], found, strict=True):
        assert not (after == before).any(), output.name
        assert np.isfinite(after).any() or kernel.program.catalogue.name == "focal", output.name


def test_the_families_call_every_function_that_kernels_call():
    modules = [
        importlib.import_module(f"fastlink.codegen.runtime.{module.name}")
        for module in pkgutil.iter_modules(fastlink.codegen.runtime.__path__)
    ]
    functions = {function for function in OUTLINED if function.__module__ in {m.__name__ for m in modules}}
    written = {function.__name__ for function in functions if not function.__name__.startswith("_")}
    texts = [kernel.text for family in FAMILIES.values() for kernel, _ in kernels(family.request())]
    imports = [line for text in texts for line in re.findall(r"^from fastlink.codegen.runtime.*", text, re.M)]
    called = {name for line in imports for name in re.findall(r"\w+", line.partition(" import ")[2])}
    helpers = {
        *("append_item", "append_of_lane", "append_unresolved", "is_unresolved", "next_split"),
        *("insert", "position_of", "set_bracket"),
    }  # other functions call them
    assert written - called <= helpers
    for word in ("entries(min(", "w2[", "turn in range(2)", "silenced(", "store_list(", "for step in range("):
        assert any(word in text for text in texts), word
