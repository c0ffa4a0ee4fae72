"""Kernels with little to do are compiled in less time; `test_differential` compares their bits."""

import numpy as np
import pytest
from tests.support.four_bar import sweep_4r

import fastlink as fl
from fastlink.codegen import kernel
from fastlink.codegen.kernel import FEW, SEARCHED, SOON, kernel_of, load_kernel
from fastlink.engine.resolve import resolve

LENGTHS = {"a1": 0.4, "a3": 0.8, "a4": 1.0}
NAMES = ("swing",), ("B_x",)


@pytest.fixture
def compiled(monkeypatch, tmp_path):
    """An empty cache, and a list of how each kernel was compiled: in the shortest time or not."""
    monkeypatch.setenv("FASTLINK_CACHE_DIR", str(tmp_path))
    monkeypatch.setattr(kernel, "_loaded", {})
    kernel_of.cache_clear()
    compile, found = kernel.compile_object, []
    monkeypatch.setattr(
        kernel, "compile_object", lambda text, soon: found.append(soon) or compile(text, soon=soon)
    )
    yield found
    kernel_of.cache_clear()


def space(size):
    return fl.grid(a2=np.linspace(1.0, 1.2, size), **LENGTHS)


@pytest.mark.parametrize("names", NAMES)
def test_few_designs_come_soon_and_many_fast(compiled, names):
    most = FEW // (SEARCHED if names == ("swing",) else 36)
    assert most > 1000
    first = sweep_4r(space(9), names, angles=36)
    assert compiled == [True]
    kernel_of.cache_clear()  # as another process, which finds it in the cache
    kernel._loaded.clear()
    second = sweep_4r(space(9), names, angles=36)
    sweep_4r(space(most - 9), names, angles=36)
    assert compiled == [True]
    third = sweep_4r(space(9), names, angles=36)  # too many, all told
    assert compiled == [True, False]
    sweep_4r(space(most + 1), names, angles=36)
    assert compiled == [True, False]
    for found in (second, third):
        np.testing.assert_array_equal(found[names[0]], first[names[0]], strict=True)


def test_code_that_runs_fast_is_taken_wherever_it_is(compiled):
    sweep_4r(space(FEW), ["swing"])
    kernel_of.cache_clear()
    sweep_4r(space(9), ["swing"])
    kernel._loaded.clear()
    kernel_of.cache_clear()
    sweep_4r(space(9), ["swing"])
    assert compiled == [False]


def test_what_is_called_again_and_again_is_compiled_well(compiled):
    fl.function("planar_4r", ["a2"], ["swing"], **LENGTHS)
    assert compiled == [False]


def test_a_forecast_tells_them_apart(compiled):
    small, large = (("planar_4r", space(size), ["swing"]) for size in (9, FEW))
    times = [fl.explain(*request).forecast.compile_time for request in (small, large)]
    assert 0.0 < times[0] < times[1]
    fl.sweep(*small, branch=(1, 2))
    assert [fl.explain(*request).forecast.compiled for request in (small, large)] == [1, 0]
    assert fl.explain(*large, measure=True).forecast.timing is not None  # of the code that will run
    assert compiled == [True, False]


def test_what_numba_compiles_is_compiled_once(compiled, monkeypatch):
    def refuse(*_):
        raise kernel.Refused("no")

    monkeypatch.setattr(kernel, "llvm_text", refuse)
    keys = []
    monkeypatch.setattr(
        "fastlink.codegen.numba_backend.compile_by_numba", lambda source, key: keys.append(key)
    )
    (of,) = resolve("planar_4r", space(9), ["swing"], branch=(1, 2)).kernels
    for compiler in (SOON, "llvm"):
        load_kernel(of.source, compiler)
    assert len(keys) == 2
    assert len(set(keys)) == 1
