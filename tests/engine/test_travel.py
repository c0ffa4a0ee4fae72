"""What is resolved, compiled or made by fastlink travels to other processes: pickle, cloudpickle, joblib, dask, ray."""

import pickle

import cloudpickle
import numpy as np
import pytest
from tests.support.elsewhere import other_process
from tests.support.refusals import assert_refusal, refused
from tests.support.registry import ENTRIES
from tests.support.toys import add

import fastlink as fl
from fastlink.engine.resolve import resolve
from fastlink.engine.run import run
from fastlink.mechanisms import NAMES, catalogue, inputs_of
from fastlink.mechanisms.planar_4r import planar_4r

LENGTHS = {"a1": 0.4, "a2": [1.1, 1.2, 1.3], "a3": 0.8, "a4": 1.0, "omega1": [5.0, 25.0]}
FIXED = {"a1": 0.4, "a4": 1.0, "omega1": 25.0}
BAR = fl.round_bar(density=7750.0, radius=0.01)
PICKLERS = pytest.mark.parametrize("pickler", [pickle, cloudpickle], ids=["pickle", "cloudpickle"])


@pytest.fixture(scope="module")
def elsewhere():
    with other_process() as run_there:
        yield run_there


def bits(arrays):
    return [array.tobytes() for array in arrays]


def results(resolved):
    job = resolved.job()
    arrays = [np.zeros((job.size, *shape), dtype) for shape, dtype in job.shapes]
    run(job, targets=arrays)
    return bits(arrays)


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
        (["shaking_force_max"], {"links": BAR, "branch": 2, "solver": "dense"}),
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
    function = fl.function("planar_4r", ["a2", "a3"], ["shaking_force_max"], links=BAR, **FIXED)
    spaces = [
        fl.grid(**LENGTHS),
        fl.sobol(8, seed=3, a1=(0.5, 1.5), a2=2.0),
        fl.latin_hypercube(8, seed=3, a1=(0.5, 1.5)),
        fl.table({"a1": [0.5, 0.7], "part": ["one", "two"]}),
    ]
    data = pickler.dumps([function, BAR, *spaces])

    def look(data):
        import pickle

        import numpy as np

        function, bar, *spaces = pickle.loads(data)
        values = [space.values(name).tobytes() for space in spaces for name in space.names]
        return repr(bar), function(np.array([1.2, 0.8])).tobytes(), values

    expected = [space.values(name).tobytes() for space in spaces for name in space.names]
    assert elsewhere(look, data) == (repr(BAR), function(np.array([1.2, 0.8])).tobytes(), expected)


def test_a_jitted_function_travels_without_its_addresses(elsewhere):
    function = fl.function("planar_4r", ["a2", "a3"], ["omega4_max"], **FIXED)
    x = np.array([1.2, 0.8])
    data = cloudpickle.dumps(function.jitted)
    assert elsewhere(lambda data, x: __import__("pickle").loads(data)(x), data, x) == function(x)


def test_every_public_name_travels():
    for name in fl.__all__:
        value = getattr(fl, name)
        again = cloudpickle.loads(cloudpickle.dumps(lambda value=value: value))()
        assert again is value or (again == value and isinstance(value, str)), name


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
