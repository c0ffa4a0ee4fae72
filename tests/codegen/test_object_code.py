"""Machine code of every target: whole vectors in the loops over lanes, no call of a library, nothing fused."""

import ast
import re

import llvmlite.binding as llvm
import pytest
from tests.support.assembly import called, fused, inner_loops
from tests.support.plan_families import FAMILIES, few, kernels

from fastlink.codegen.kernel import llvm_text
from fastlink.codegen.machine import assembly

#: Processor, platform, and how many doubles a register holds.
TARGETS = {
    "v2": ("x86-64-v2", "x86_64-unknown-linux-gnu", 2),
    "v3": ("x86-64-v3", "x86_64-unknown-linux-gnu", 4),
    "v4": ("x86-64-v4", "x86_64-unknown-linux-gnu", 8),
    "aarch64": ("generic", "aarch64-unknown-linux-gnu", 2),
}
#: What LLVM makes of loops that copy; libc has them, and they know no arithmetic.
COPIES = {"memset", "memcpy", "memmove"}


@pytest.fixture(scope="module", autouse=True)
def all_targets():
    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()


def assembly_for(kernel, target, **options):
    cpu, triple, lanes = TARGETS[target]
    text = llvm_text(kernel.source, **{"lanes": lanes} | options)
    return assembly(text, cpu=cpu, triple=triple)


def loops_over_lanes(kernel):
    """Return how many loops of the text over lanes have products in them."""
    loops = [node for node in ast.walk(ast.parse(kernel.text)) if isinstance(node, ast.For)]
    abreast = [loop for loop in loops if ast.unparse(loop.iter).startswith(("lanes(", "entries("))]
    return sum(any(isinstance(node, ast.Mult) for node in ast.walk(loop)) for loop in abreast)


@pytest.mark.sample(3)
@pytest.mark.parametrize("target", TARGETS)
@pytest.mark.parametrize("name", few("curves of rapidity", "reductions", "systems", "extremes of forces"))
def test_lanes_are_whole_vectors_and_nothing_is_called_or_fused(name, target):
    for kernel, _ in kernels(FAMILIES[name].request()):
        text = assembly_for(kernel, target)
        loops = inner_loops(text)
        vector = [loop for loop in loops if loop.packed]
        assert len(vector) >= loops_over_lanes(kernel) > 0
        assert max(loop.packed for loop in vector) > 40
        assert [loop for loop in vector if loop.single] == []
        # Loops over cells, of bounds and ends, are of one lane: that of bounds of extremes has 16 operations.
        assert max((loop.single for loop in loops if not loop.packed), default=0) <= 16
        assert called(text) <= COPIES
        assert fused(text) == []
        assert "vmaskmov" not in text  # AVX2 stores lane by lane under a mask


#: The most instructions for each operation in the loop over angles.
@pytest.mark.parametrize(("name", "most"), [("curves", 2.2), ("curves of forces", 1.55)])
def test_with_16_registers_little_stands_in_memory(name, most):
    """Half as many instructions again for loads, stores and what registers cannot hold; addresses are known before."""
    kernel, _ = kernels(FAMILIES[name].request())[0]
    hot = [loop for loop in inner_loops(assembly_for(kernel, "v3")) if loop.packed > 40][-1]
    assert len(hot.lines) < most * hot.packed


@pytest.mark.parametrize("target", ["v3", "v4"])
def test_vectors_on_the_stack_lie_in_one_cache_line(target):
    *_, (kernel, _) = kernels(FAMILIES["extremes of forces"].request())
    long = [loop for loop in inner_loops(assembly_for(kernel, target)) if loop.packed > 40]
    stack = [line for loop in long for line in loop.lines if re.search(r"mm\d+, \d*\(%rsp\)", line)]
    assert stack
    assert [line for line in stack if "movup" in line] == []


def test_entries_for_lanes_are_loaded_without_vectors_of_addresses():
    """AVX2 has instructions for neither conversion, and LLVM takes the addresses apart again."""
    *_, (kernel, _) = kernels(FAMILIES["extremes"].request())
    assert "vpextrq" not in assembly_for(kernel, "v3")


@pytest.mark.parametrize("target", TARGETS)
def test_single_lanes_and_fused_products_would_be_noticed(target):
    kernel, _ = kernels(FAMILIES["curves of forces"].request())[0]
    loops = inner_loops(assembly_for(kernel, target, lanes=1))
    assert sum(loop.packed for loop in loops) == 0
    assert max(loop.single for loop in loops) > 40
    # The second level has no instructions that fuse.
    assert bool(fused(assembly_for(kernel, target, fast_math=("contract",)))) == (target != "v2")


@pytest.mark.parametrize("target", TARGETS)
def test_a_call_would_be_noticed(target):
    text = """
    declare double @llvm.sin.f64(double)
    define void @kernel(ptr %x) {
      %v = load double, ptr %x
      %y = call double @llvm.sin.f64(double %v)
      store double %y, ptr %x
      ret void
    }"""
    cpu, triple, _ = TARGETS[target]
    assert called(assembly(text, cpu=cpu, triple=triple)) == {"sin"}
