"""What does not fit memory is refused before anything is computed; the count of bytes is that of the run."""

import tracemalloc

import numpy as np
import pytest
from tests.support.four_bar import sweep_4r
from tests.support.refusals import refused

import fastlink as fl
from fastlink import machine
from fastlink.codegen.kernel import Kernel
from fastlink.engine.resolve import resolve
from fastlink.engine.run import BLOCK_BYTES, aligned
from fastlink.engine.sinks import needs_of

LENGTHS = {"a1": 0.4, "a2": 1.1, "a3": 0.8, "a4": 1.0}


@pytest.fixture
def small_machine(monkeypatch):
    monkeypatch.setattr(machine, "available_memory", lambda: 100 << 20)


def wide(**axes):
    return fl.grid(**{**LENGTHS, **{name: np.linspace(0.7, 1.2, n) for name, n in axes.items()}})


def test_a_result_that_does_not_fit_names_the_file_before_anything_is_compiled(small_machine, monkeypatch):
    monkeypatch.setattr(Kernel, "compiled", lambda *_: pytest.fail("compiled"))
    # theta4 in two modes at 360 angles: 5.8 kB a design
    with refused("the result", "write it to a file with to='maps.h5'"):
        sweep_4r(wide(a2=200, a3=200), ["theta4"])
    with refused("the result", "to='maps.h5'"):  # far more than any address: nothing overflows
        sweep_4r(wide(a1=2**15, a2=2**15, a3=2**15, a4=2**10), ["theta4"])


def test_what_fits_is_not_refused(small_machine, tmp_path):
    assert sweep_4r(wide(a2=20, a3=20), ["theta4"]).theta4.shape == (20, 20, 2, 360)
    space = wide(a2=400, a3=400)
    with sweep_4r(space, ["swing"], to=tmp_path / "maps.h5", verify=0) as maps:
        assert maps.swing.shape == (400, 400)


def test_positions_and_verified_designs_beyond_memory_are_refused_with_a_file_too(small_machine, tmp_path):
    many = {"to": tmp_path / "maps.h5", "theta1": np.linspace(0.0, 6.0, 3_000_000)}
    with refused("a sweep of so many input positions", "ask for fewer"):
        sweep_4r(wide(), ["theta4"], **many)
    with refused("a sweep of so many input positions", "ask for fewer"):
        sweep_4r(wide(a2=2000, a3=2000), ["theta4"], to=tmp_path / "maps.h5", verify=10**5)
    assert list(tmp_path.iterdir()) == []


def test_samples_need_no_memory_until_they_are_looked_at(small_machine):
    for sample in (fl.sobol, fl.latin_hypercube):
        space = sample(2**30, a1=(0.1, 0.4), a2=1.2, a3=0.8, a4=1.0)
        with refused("an array of 1,073,741,824 values", "read a part of it"):
            np.asarray(space.columns["a1"])
        with refused("the result", "to='maps.h5'"):
            sweep_4r(space, ["swing"])


def test_a_function_of_too_many_designs_is_refused(small_machine):
    function = fl.function("planar_4r", ["a2"], ["swing"], a1=0.4, a3=0.8, a4=1.0)
    with refused("the result", "pass fewer designs at once"):
        function(np.broadcast_to(1.1, (1, 10**5, 10**4)))


@pytest.mark.parametrize(
    ("names", "axes", "options"),
    [
        (["theta4", "A_x"], {"a2": 40, "a3": 40}, {}),
        (["omega4_max", "swing"], {"a2": 100, "a3": 100}, {}),
        (["theta4"], {}, {"theta1": np.linspace(0.0, 6.0, 20_000)}),
    ],
)
def test_no_sweep_takes_more_than_it_needs(names, axes, options):
    """A count of bytes at their peak: arrays are allocated once, so it is not above the count by more than labels."""
    space = wide(**axes).with_constants({"omega1": 2.0})
    resolved = resolve("planar_4r", space, names, angles=options.get("theta1"), branch=(1, 2))
    sweep_4r(wide(), ["swing"])  # what the first sweep of a process loads
    sweep_4r(space, names, threads=2, **options)
    tracemalloc.start()
    sweep_4r(space, names, threads=2, **options)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    needs = needs_of(resolved, threads=2)
    # the values are there at the end, whatever else is; Python's own objects take less than a megabyte
    assert needs.values < peak < needs.in_memory + 2**20


def test_a_long_axis_that_scales_takes_no_second_copy_of_the_result():
    space = fl.grid(**LENGTHS, omega1=np.linspace(1.0, 2.0, 300_000))
    resolved = resolve("planar_4r", space, ["omega4_max", "alpha4_max"], branch=(1, 2))
    assert resolved.scaling_axis is not None
    sweep_4r(space, ["omega4_max", "alpha4_max"], threads=1)
    tracemalloc.start()
    maps = sweep_4r(space, ["omega4_max", "alpha4_max"], threads=1)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    needs = needs_of(resolved, threads=1)
    assert needs.values > 2 * BLOCK_BYTES
    assert peak < needs.in_memory + 2**20
    one = sweep_4r(fl.grid(**LENGTHS, omega1=float(space.axes["omega1"][123_456])), ["alpha4_max"])
    # one product more than the design alone, of a power of the speed that numpy rounds to 1 ulp
    np.testing.assert_allclose(maps.alpha4_max[123_456], one.alpha4_max, rtol=8 * 2.0**-53)


def test_memory_of_a_container_is_that_of_its_narrowest_group(tmp_path):
    own = tmp_path / "cgroup"
    own.write_text("0::/job/step\n")
    for folder, most, used in (("", "max", 5), ("job", "1000", 400), ("job/step", "2000", 300)):
        place = tmp_path / folder
        place.mkdir(exist_ok=True)
        (place / "memory.max").write_text(f"{most}\n")
        (place / "memory.current").write_text(f"{used}\n")
        (place / "memory.stat").write_text("anon 7\ninactive_file 50\nactive_file 40\n")
    assert sorted(machine._of_groups(own, tmp_path)) == [1000 - 400 + 90, 2000 - 300 + 90]
    old = tmp_path / "memory"
    old.mkdir()
    own.write_text("4:cpu,memory:/host/path/that/is/not/here\n1:cpu:/x\n")
    (old / "memory.limit_in_bytes").write_text("700")
    (old / "memory.usage_in_bytes").write_text("600")
    assert list(machine._of_groups(own, tmp_path)) == [100]
    assert list(machine._of_groups(tmp_path / "absent", tmp_path)) == []


def test_results_lie_apart_in_the_first_cache():
    """On cache lines, and no two of twenty at one place of their pages, for which it has 8 or 12 lines."""
    places = {array.ctypes.data % 4096 for array in [aligned((64, 2, 360), number=k) for k in range(20)]}
    assert len(places) == 20
    assert not any(place % 64 for place in places)
