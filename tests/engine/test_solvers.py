"""The solver: every door refuses one that a mechanism lacks, and a result names it only where it matters."""

from importlib import import_module

import pytest
from tests.support.study_files import written
from tests.support.sweeps import BARS, sweep_4r, sweep_both

import fastlink as fl
from fastlink.engine.resolve import resolve
from fastlink.facts.fact import System
from fastlink.mechanisms import NAMES
from fastlink.mechanisms import catalogue as find_catalogue

pytestmark = pytest.mark.usefixtures("folder")

LENGTHS = {"a1": 0.4, "a2": 1.1, "a3": 0.8, "a4": 1.0, "omega1": 25.0}
DRIVEN = [
    (name, drives)
    for name in NAMES
    for drives in (None, *import_module(f"fastlink.mechanisms.{name}").DRIVEN)
]
WITHOUT = [
    (name, drives) for name, drives in DRIVEN if find_catalogue(name, drives).solvers == ("eliminated",)
]
STUDY = """
mechanism = "{mechanism}"
quantities = ["status"]
[design]
[cycle]
input = "{input}"
solver = "dense"
"""


def doors(mechanism, drives):
    """Return each way to name a solver."""
    drives = find_catalogue(mechanism, drives).position.name
    options = {"input": drives, "solver": "dense"}
    study = written(STUDY.format(mechanism=mechanism, input=drives))
    return {
        "sweep": lambda: sweep_both(mechanism, fl.grid(), ["status"], **options),
        "evaluate": lambda: fl.evaluate(mechanism, ["status"], **options),
        "function": lambda: fl.function(mechanism, ["x"], ["status"], **options),
        "study": lambda: fl.run(study),
        "explain": lambda: fl.explain(study),
        "accuracy": lambda: fl.accuracy(study),
    }


@pytest.mark.parametrize(("mechanism", "drives"), DRIVEN)
def test_solvers_are_the_sets_with_a_linear_system(mechanism, drives):
    catalogue = find_catalogue(mechanism, drives)
    systems = {
        key
        for key, facts in catalogue.variants.items()
        if any(isinstance(fact, System) for fact in facts.values())
    }
    assert set(catalogue.solvers) == {"eliminated", *systems}


@pytest.mark.sample(2)
@pytest.mark.parametrize(("mechanism", "drives"), WITHOUT)
def test_a_solver_that_a_mechanism_lacks_is_refused(mechanism, drives):
    for call in doors(mechanism, drives).values():
        with pytest.raises(fl.InputError) as caught:
            call()
        message = str(caught.value)
        assert "solver: 'dense' is " in message
        assert mechanism in message
        assert "leave solver out" in message


@pytest.mark.parametrize("solver", ["eliminated", "dense"])
@pytest.mark.parametrize(
    ("quantities", "depends"),
    [(["omega4_max", "grashof_class"], False), (["F41_max", "theta4"], True), (["shaking_moment_rms"], True)],
)
def test_the_solver_is_recorded_where_a_result_depends_on_it(quantities, depends, solver):
    options = {"links": BARS, "angles": 8, "extrema": "sampled", "solver": solver}
    maps = sweep_4r(fl.grid(**LENGTHS), quantities, **options)
    assert maps.attrs.get("solver") == (solver if depends else None)


@pytest.mark.parametrize("name", ["d_T41_d_a1", "T41_error", "T41_max"])
def test_what_follows_from_a_reaction_depends_on_the_solver(name):
    assert resolve("planar_4r", fl.grid(**LENGTHS), [name], links=BARS, branch=(1, 2)).solver == "eliminated"


@pytest.mark.parametrize(("mechanism", "drives"), WITHOUT)
def test_no_solver_is_recorded_where_there_is_one_way(mechanism, drives):
    catalogue = find_catalogue(mechanism, drives)
    tables = (catalogue.position.name, *catalogue.tables, *catalogue.table_low_parts)
    leaves = (*catalogue.inputs, *tables, "branch")
    for name in catalogue.public:
        assert not catalogue.depends_on_solver(catalogue.dependencies([name], leaves)), name
