"""Resolved requests: which are kept, what they need, and how they travel."""

import multiprocessing
import operator
import pickle
import tracemalloc
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from dataclasses import replace

import cloudpickle
import numpy as np
import pytest
from tests.support.configurations import PLANAR
from tests.support.refusals import assert_refusal, refused
from tests.support.registry import ENTRIES
from tests.support.sweeps import BARS, CRANK, sweep_4r
from tests.support.toys import add, toy

import fastlink as fl
from fastlink import machine
from fastlink.codegen.kernel import Kernel, kernel_of
from fastlink.engine.evaluate import evaluate
from fastlink.engine.resolve import cached_plan, resolve
from fastlink.engine.run import BLOCK_BYTES, aligned, run
from fastlink.engine.sinks import needs_of
from fastlink.mechanisms import NAMES, catalogue, inputs_of
from fastlink.mechanisms.planar_4r import planar_4r

# == Run functions in another process, to which they travel by value: the tests are not importable there =====


class _ByValue:
    """A function that is pickled as the bytes that cloudpickle makes of it."""

    def __init__(self, function):
        self.data = cloudpickle.dumps(function)

    def __reduce__(self):
        return cloudpickle.loads, (self.data,)


# == What is resolved, compiled or made by fastlink travels to other processes: pickle, cloudpickle, joblib, dask, ray

LENGTHS = {"a1": 0.4, "a2": [1.1, 1.2, 1.3], "a3": 0.8, "a4": 1.0, "omega1": [5.0, 25.0]}
FIXED = {"a1": 0.4, "a4": 1.0, "omega1": 25.0}
PICKLERS = pytest.mark.parametrize("pickler", [pickle, cloudpickle], ids=["pickle", "cloudpickle"])


@pytest.fixture(scope="module")
def elsewhere():
    """Give ``run(function, *args)``, which calls a function in one fresh process."""
    with ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("spawn")) as pool:
        yield lambda function, *args: pool.submit(operator.call, _ByValue(function), *args).result()


def results(resolved):
    job = resolved.job()
    arrays = [np.zeros((job.size, *shape), dtype) for shape, dtype in job.shapes]
    run(job, targets=arrays)
    return [array.tobytes() for array in arrays]


def of_pickled_job(data):
    import pickle

    import numpy as np

    from fastlink.engine.run import run

    job = pickle.loads(data)
    arrays = [np.zeros((job.size, *shape), dtype) for shape, dtype in job.shapes]
    run(job, targets=arrays)
    return [array.tobytes() for array in arrays]


@PICKLERS
@pytest.mark.parametrize(
    ("quantities", "options"),
    [
        (["omega4", "transmission_angle_max"], {}),
        (["shaking_force_max"], {"links": BARS, "branch": 2, "solver": "dense"}),
    ],
    ids=["values and extremes", "forces"],
)
def test_a_resolved_sweep_and_its_kernels_travel(elsewhere, pickler, quantities, options):
    resolved = resolve("planar_4r", fl.grid(**LENGTHS), quantities, angles=8, **{"branch": (1, 2)} | options)
    data, job = pickler.dumps(resolved), pickler.dumps(resolved.job())
    assert elsewhere(lambda data: __import__("pickle").loads(data).fingerprint, data) == resolved.fingerprint
    assert elsewhere(of_pickled_job, job) == results(resolved)
    assert b"\x7fELF" not in job  # no machine code


@pytest.mark.sample(4)
@pytest.mark.parametrize(("mechanism", "input"), [(name, by) for name in NAMES for by in inputs_of(name)])
def test_every_plan_is_made_again_from_its_names(mechanism, input):
    known = catalogue(mechanism, input)
    assert pickle.loads(pickle.dumps(known)) is known
    (entry, *_) = [one for one in ENTRIES if (one.mechanism, one.input) == (mechanism, input)]
    drawn = next(iter(entry.families.values()))(np.random.default_rng(1), 2)
    space = {key: values for key, values in drawn.items() if key in known.known_inputs(known.variant_inputs)}
    some = [name for name, fact in known.public.items() if name not in space and "status" not in name][:3]
    options = {"input": input, "angles": np.linspace(0.1, 0.5, 4)}
    resolved = resolve(mechanism, fl.table(space), some, allow_invalid=True, **{"branch": (1, 2)} | options)
    again = pickle.loads(pickle.dumps(resolved))
    assert again.fingerprint == resolved.fingerprint
    assert again.plan is pickle.loads(pickle.dumps(resolved.plan))  # made once for all blocks of a sweep


@PICKLERS
def test_designs_links_and_functions_travel(elsewhere, pickler):
    function = fl.function("planar_4r", ["a2", "a3"], ["shaking_force_max"], links=BARS, **FIXED)
    spaces = [
        fl.grid(**LENGTHS),
        fl.sobol(8, seed=3, a1=(0.5, 1.5), a2=2.0),
        fl.latin_hypercube(8, seed=3, a1=(0.5, 1.5)),
        fl.table({"a1": [0.5, 0.7], "part": ["one", "two"]}),
    ]
    data = pickler.dumps([function, BARS, *spaces])

    def look(data):
        import pickle

        import numpy as np

        function, bar, *spaces = pickle.loads(data)
        values = [space.values(name).tobytes() for space in spaces for name in space.names]
        return repr(bar), function(np.array([1.2, 0.8])).tobytes(), values

    expected = [space.values(name).tobytes() for space in spaces for name in space.names]
    assert elsewhere(look, data) == (repr(BARS), function(np.array([1.2, 0.8])).tobytes(), expected)


def test_public_names_and_jitted_functions_travel(elsewhere):
    for name in fl.__all__:
        value = getattr(fl, name)
        again = cloudpickle.loads(cloudpickle.dumps(lambda value=value: value))()
        assert again is value or (again == value and isinstance(value, str)), name
    function = fl.function("planar_4r", ["a2", "a3"], ["omega4_max"], **FIXED)
    x = np.array([1.2, 0.8])
    data = cloudpickle.dumps(function.jitted)
    assert elsewhere(lambda data, x: __import__("pickle").loads(data)(x), data, x) == function(x)


def test_a_quantity_that_is_declared_otherwise_there_is_refused(elsewhere):
    def declare(sign):
        planar_4r.facts.pop("some_length", None)
        add(planar_4r, f"## test\nsome_length [m] s_a: Some length\n    = a1 {sign} a2")

    def refusal(data):
        import pickle

        import fastlink as fl

        try:
            pickle.loads(data)
        except fl.InputError as error:
            return error

    try:
        declare("+")
        resolved = resolve("planar_4r", fl.grid(**LENGTHS), ["some_length"], branch=(1, 2))
        data, job, expected = pickle.dumps(resolved), pickle.dumps(resolved.job()), results(resolved)
        declare("-")
        with refused("planar_4r", "import the modules that declare"):
            pickle.loads(data)
    finally:
        planar_4r.facts.pop("some_length", None)
    assert_refusal(elsewhere(refusal, data), "'some_length'")
    assert elsewhere(of_pickled_job, job) == expected  # the text of its kernels is all that a job needs


# == Plans are found once, whatever the values are, and anew when what is declared is another thing ==========

NAMES_KEPT = ["omega4_max", "theta2"]


def plan_of(names=NAMES_KEPT, lengths=CRANK, **options):
    return resolve("planar_4r", fl.grid(**lengths, omega1=25.0), names, **{"branch": (1, 2)} | options).plan


@pytest.mark.parametrize(
    "other",
    [
        {"lengths": CRANK | {"a2": 1.3}},
        {"lengths": CRANK | {"a2": [1.1, 1.3]}},
        {"theta1": 90},
        {"names": tuple(NAMES_KEPT)},
        {"backend": "numba"},
    ],
    ids=str,
)
def test_values_have_no_part_in_a_plan(other):
    angles = other.pop("theta1", 360)
    assert plan_of(angles=angles, **other) is plan_of()


@pytest.mark.parametrize(
    "other",
    [
        {"names": NAMES_KEPT[::-1]},
        {"names": ["omega4_max"]},
        {"angles": 8},
        {"angles": np.linspace(0.0, 1.0, 360), "extrema": "sampled"},
        {"extrema": "sampled"},
        {"branch": (2, 1)},
        {"branch": 1},
        {"links": BARS},
        {"solver": "dense"},
        {"lengths": CRANK | {"gravity_y": -9.81}},
        {"input": "joint_angle_1", "lengths": CRANK, "names": ["status"]},
    ],
    ids=str,
)
def test_whatever_else_is_asked_has_a_part(other):
    try:
        found = plan_of(**other)
    except fl.InputError:  # omega1 is not an input of a joint
        found = None
    assert found is not plan_of()


SHEET = """\
[inputs]
a [m] a: a length
[facts]
## here
x [m] x: A fact
    = {} * theta
"""


def text_of(catalogue):
    options = {"given": ["a"], "branches": (1,), "variants": (), "angles": 40, "extrema": "sampled"}
    return kernel_of(cached_plan(catalogue, ["x"], False, **options).programs[0]).text


def test_what_is_declared_anew_is_planned_anew():
    first, second = toy(SHEET.format("a")), toy(SHEET.format("a"))
    assert text_of(first) == text_of(second)
    fact = first.facts["x"]
    first.facts["x"] = toy(SHEET.format("2.0 * a")).facts["x"]
    assert "2.0 * " in text_of(first)
    assert "2.0 * " not in text_of(second)
    first.facts["x"] = fact
    assert text_of(first) == text_of(second)
    before = second.version
    add(second, "[variant more]\nb [m] b: a length\n    default: 1.0")
    assert second.version != before
    assert second.version == second.version


def test_a_changed_plan_has_a_text_of_its_own_and_threads_may_ask_at_once():
    (program, *_) = plan_of(["omega4_mean"]).programs
    kernel, other = kernel_of(program), kernel_of(replace(program, branches=(1,)))
    assert kernel_of(program) is kernel
    assert other.text != kernel.text
    assert other.key != kernel.key

    def ask(k):
        lengths = CRANK | {"a2": 1.2 + 0.001 * (k % 7)}
        maps = sweep_4r(fl.grid(**lengths, omega1=25.0), ["omega4_max"], threads=1)
        return k % 7, maps.omega4_max.values.tolist()

    with ThreadPoolExecutor(8) as pool:
        found = list(pool.map(ask, range(56)))
    for k, values in found:
        assert values == dict(found[:7])[k]


def test_one_design_is_labelled_like_one_of_many():
    names = ["omega4_max", "omega4", "omega4_extrema", "status"]
    given = {"a1": 0.4, "a3": 0.8, "a4": 1.0, "omega1": 25.0}
    for k, a2 in enumerate((1.2, 1.25)):
        one = sweep_4r(fl.grid(a2=a2, **given), names, theta1=40, attrs={"run": k})
        many = sweep_4r(fl.grid(a2=[a2, 1.3], **given), names, theta1=40, attrs={"run": k})
        expected = many.isel(a2=0)
        assert one.identical(expected.assign_attrs(one.attrs))
        assert set(one.attrs) == set(many.attrs)
        assert one.run == k
        assert all(one[name].dtype == of.dtype for name, of in expected.variables.items())


def test_what_users_do_to_a_result_stays_there():
    space = fl.grid(**CRANK, omega1=25.0)
    first = sweep_4r(space, ["omega4_max"])
    expected = sweep_4r(space, ["omega4_max"])
    first.omega4_max.values[:] = 0.0
    first.omega4_max.attrs["units"] = "none"
    first.a2.attrs["units"] = "none"
    first.a2.values[...] = 9.0
    first.attrs["title"] = "mine"
    for array in (first.status.attrs["flag_values"], first.branch.values):
        with pytest.raises(ValueError, match="read-only"):
            array[:] = 7
    again = sweep_4r(space, ["omega4_max"])
    assert again.identical(expected.assign_attrs(again.attrs))
    assert again.title == expected.title


@pytest.mark.parametrize("backend", ["llvm", "numba"])
def test_a_map_says_what_compiled_it(backend, monkeypatch):
    space = fl.grid(**CRANK, omega1=25.0)
    maps = sweep_4r(space, ["status"], backend=backend)
    assert maps.backend == backend
    assert ("numba " in maps.source) == (backend == "numba")
    assert "llvmlite " in maps.source
    monkeypatch.setenv("FASTLINK_BACKEND", backend)
    assert sweep_4r(space, ["status"]).backend == backend


def test_a_closure_is_found_anew_when_facts_change():
    given = CRANK | {"theta1": 0.3, "omega1": 25.0}
    before = evaluate("planar_4r", ["omega4"], **given)
    fact = PLANAR.facts["omega4"]
    PLANAR.facts["omega4"] = replace(PLANAR.facts["omega2"], name="omega4")
    try:
        other = evaluate("planar_4r", ["omega2"], **given)["omega2"]
        assert evaluate("planar_4r", ["omega4"], **given) == {"omega4": other}
    finally:
        PLANAR.facts["omega4"] = fact
    assert evaluate("planar_4r", ["omega4"], **given) == before


def test_positions_is_another_name_of_the_option_for_them():
    linkage = fl.grid(a1=0.4, a2=1.2, a3=0.8, a4=1.0, omega1=2.0)
    names = ["omega4_rms", "omega4_max"]
    first, second = (sweep_4r(linkage, names, **{key: 24}, verify=0) for key in ("theta1", "positions"))
    assert first.omega4_rms.identical(second.omega4_rms)
    with refused("theta1 is given too", "write one of them"):
        sweep_4r(linkage, names, theta1=24, positions=24)


def test_extremes_of_given_positions_say_so():
    linkage = fl.grid(a1=0.4, a2=1.2, a3=0.8, a4=1.0, omega1=2.0)
    said = r"those of the 3 positions given, not of the turn; write extrema='sampled'"
    with pytest.warns(fl.InputWarning, match=said):
        some = sweep_4r(linkage, ["omega4_max"], theta1=[0.1, 0.2, 0.3])
    title = some.omega4_max.attrs["long_name"]
    assert title == "Angular velocity of the output link, greatest of 3 positions"
    every = sweep_4r(linkage, ["omega4_max"], theta1=3)
    assert every.omega4_max.attrs["long_name"].endswith("greatest over the cycle")


# == What does not fit memory is refused before anything is computed; the count of bytes is that of the run ==

LENGTHS_NEEDS = {"a1": 0.4, "a2": 1.1, "a3": 0.8, "a4": 1.0}


@pytest.fixture
def small_machine(monkeypatch):
    monkeypatch.setattr(machine, "available_memory", lambda: 100 << 20)


def wide(**axes):
    return fl.grid(**{**LENGTHS_NEEDS, **{name: np.linspace(0.7, 1.2, n) for name, n in axes.items()}})


def test_what_does_not_fit_is_refused_with_the_remedy_before_anything_is_compiled(
    small_machine, monkeypatch, tmp_path
):
    function = fl.function("planar_4r", ["a2"], ["swing"], a1=0.4, a3=0.8, a4=1.0)
    with refused("the result", "pass fewer designs at once"):
        function(np.broadcast_to(1.1, (1, 10**5, 10**4)))
    monkeypatch.setattr(Kernel, "compiled", lambda *_: pytest.fail("compiled"))
    # theta4 in two modes at 360 angles: 5.8 kB a design
    with refused("the result", "write it to a file with to='maps.h5'"):
        sweep_4r(wide(a2=200, a3=200), ["theta4"])
    with refused("the result", "to='maps.h5'"):  # far more than any address: nothing overflows
        sweep_4r(wide(a1=2**15, a2=2**15, a3=2**15, a4=2**10), ["theta4"])
    many = {"to": tmp_path / "maps.h5", "theta1": np.linspace(0.0, 6.0, 3_000_000)}
    with refused("a sweep of so many input positions", "ask for fewer"):
        sweep_4r(wide(), ["theta4"], **many)
    with refused("a sweep of so many input positions", "ask for fewer"):
        sweep_4r(wide(a2=2000, a3=2000), ["theta4"], to=tmp_path / "maps.h5", verify=10**5)
    assert list(tmp_path.iterdir()) == []
    for sample in (fl.sobol, fl.latin_hypercube):
        space = sample(2**30, a1=(0.1, 0.4), a2=1.2, a3=0.8, a4=1.0)
        with refused("an array of 1,073,741,824 values", "read a part of it"):
            np.asarray(space.columns["a1"])
        with refused("the result", "to='maps.h5'"):
            sweep_4r(space, ["swing"])


def test_what_fits_is_not_refused(small_machine, tmp_path):
    assert sweep_4r(wide(a2=20, a3=20), ["theta4"]).theta4.shape == (20, 20, 2, 360)
    space = wide(a2=400, a3=400)
    with sweep_4r(space, ["swing"], to=tmp_path / "maps.h5", verify=0) as maps:
        assert maps.swing.shape == (400, 400)


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
    space = fl.grid(**LENGTHS_NEEDS, omega1=np.linspace(1.0, 2.0, 300_000))
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
    one = sweep_4r(fl.grid(**LENGTHS_NEEDS, omega1=float(space.axes["omega1"][123_456])), ["alpha4_max"])
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
