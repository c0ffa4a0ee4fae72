"""Input positions by the input's own name: every mechanism, every input, at every door."""

import re

import numpy as np
import pytest
import xarray as xr
from numpy.testing import assert_array_equal, assert_equal
from tests.support.configurations import draw
from tests.support.refusals import refused
from tests.support.registry import ENTRIES
from tests.support.study_files import written
from tests.support.sweeps import BARS, sweep_4r, sweep_both

import fastlink as fl
from fastlink.app.report import contents
from fastlink.facts.evaluate import evaluate_on_doubles
from fastlink.facts.tables import angle_tables
from fastlink.mechanisms import NAMES, catalogue, inputs_of

DRIVES = [(mechanism, input) for mechanism in NAMES for input in inputs_of(mechanism)]
EVERY = pytest.mark.parametrize(("mechanism", "input"), DRIVES)
VALUES = [-0.4, 0.1, 0.3]


def request_of(mechanism, input):
    """Return a design that assembles and a quantity that changes over the cycle: nothing of it is written by hand."""
    result = catalogue(mechanism, input)
    columns = draw(result.inputs, np.random.default_rng(7), 64)
    for name, known in result.inputs.items():
        if known.choices:
            columns[name][:] = min(known.choices)
    for name in reversed(list(columns)):
        if any(other in columns for other in result.mutually_exclusive_inputs(name)):
            del columns[name]
    quantity = next(name for name, fact in result.public.items() if result.varies(name) and not fact.flags)
    values = sweep_both(mechanism, fl.table(columns), [quantity], input=input, angles=VALUES)[quantity].values
    first = int(np.flatnonzero(np.isfinite(values.reshape(64, -1)).any(axis=1))[0])
    return {name: float(column[first]) for name, column in columns.items()}, quantity


def study_of(mechanism, input, design, quantity, positions):
    """Return the text of a study with positions by some name."""
    text = f'mechanism = "{mechanism}"\nquantities = ["{quantity}"]\n[design]\n'
    text += "".join(f"{name} = {value!r}\n" for name, value in design.items())
    return text + f'[cycle]\ninput = "{input}"\n{positions} = {{values = {VALUES}}}\n'


@pytest.mark.sample(3)
@EVERY
def test_every_door_takes_positions_by_the_name_of_the_input(folder, mechanism, input):
    design, quantity = request_of(mechanism, input)
    first, *others = design
    fixed = {name: design[name] for name in others}
    found = []
    for name in ("angles", input):
        at = {"input": input, name: VALUES}
        swept = fl.sweep(mechanism, fl.grid(**design), [quantity], **at)
        function = fl.function(mechanism, [first], [quantity], **fixed, **at)
        assert function.shape == (len(VALUES),)
        assert_array_equal(swept[input], VALUES)
        assert swept.mechanism == mechanism  # a name that `fl.sweep` takes, whatever drives
        study = written(study_of(mechanism, input, design, quantity, name))
        with fl.run(study, to=f"{name}.h5", verify=0) as result:
            found += [swept[quantity].values, function([design[first]])[0], result[quantity].values]
    for values in found[1:]:
        assert_array_equal(values, found[0])


@pytest.mark.sample(3)
@EVERY
def test_the_name_of_another_input_is_refused_with_the_right_one(folder, mechanism, input):
    design, quantity = request_of(mechanism, input)
    others = {other for _, other in DRIVES} - {input, *catalogue(mechanism, input).inputs}
    for wrong in [*sorted(others), f"{input}_"]:
        message = rf"{re.escape(wrong)}\b.*\b{re.escape(input)}\b"
        with pytest.raises(fl.InputError, match=message):
            sweep_both(mechanism, fl.grid(**design), [quantity], input=input, **{wrong: VALUES})
        with pytest.raises(fl.InputError, match=message):
            fl.function(mechanism, list(design), [quantity], input=input, **{wrong: VALUES})
        with pytest.raises(fl.InputError, match=rf"cycle\.{message}"):
            fl.run(written(study_of(mechanism, input, design, quantity, wrong)))
        with pytest.raises(fl.InputError, match=message):
            fl.evaluate(mechanism, [quantity], input=input, **design, **{wrong: 0.1})


@pytest.mark.parametrize("name", ["theta1", "theta1_deg", "angles"])
def test_a_range_of_more_positions_than_can_be_read_is_refused_at_once(name):
    design = {"a1": 0.4, "a2": 1.2, "a3": 0.8, "a4": 1.0}
    with refused(name, "at most"):
        sweep_4r(design, ["theta4"], **{name: range(10**12)})


# == `fl.evaluate` refuses what a sweep refuses: inputs, branches and positions that nothing would depend on =

DESIGN = {"a1": 0.4, "a2": 1.2, "a3": 0.8, "a4": 1.0, "omega1": 1.0}


@pytest.mark.parametrize(("name", "remedy"), [("gravty_y", "did you mean 'gravity_y'?"), ("foo", "known: ")])
def test_a_misspelt_input_is_refused(name, remedy):
    """It changed nothing: T41 was that without gravity."""
    with refused(name, remedy):
        fl.evaluate("planar_4r", ["T41"], theta1=1.0, links=BARS, **DESIGN, **{name: -9.8})


@pytest.mark.parametrize("branch", [3, 0, -1, 1.5, np.nan, [1, 2, 3]])
def test_a_branch_that_is_not_there_is_refused(branch):
    """It gave numbers of no assembly mode."""
    with refused("branch", "write some of 1, 2"):
        fl.evaluate("planar_4r", ["theta4"], theta1=1.0, branch=branch, **DESIGN)


@pytest.mark.sample(5)
@pytest.mark.parametrize("entry", [entry for entry in ENTRIES if entry.moves], ids=str)
def test_a_gap_among_branches_is_a_gap_in_what_depends_on_them(entry):
    """A branch of NaN comes with a configuration of NaN, such as that of a cognate where nothing assembles."""
    one = {name: float(values[0]) for name, values in entry.drawn(next(iter(entry.families)), 5, 1).items()}
    one.pop("branch", None)
    given = {"input": entry.input, "solver": entry.solver, **one}
    modes = [fl.evaluate(entry.mechanism, entry.names, branch=branch, **given) for branch in (1, 2)]
    for gap in ([1, np.nan], np.array([1.0, np.nan]), np.ma.array([1, 1], mask=[0, 1])):
        found = fl.evaluate(entry.mechanism, entry.names, branch=gap, allow_invalid=True, **given)
        for name, values in found.items():
            first, second = np.broadcast_to(values, 2)
            assert_equal(first, modes[0][name], err_msg=name)
            if modes[0][name] != modes[1][name]:
                assert np.isnan(second), name
    with pytest.raises(fl.InputError):
        fl.evaluate(entry.mechanism, entry.names, branch=gap, **given)


def test_what_is_of_the_design_needs_no_position():
    design = {"a1": 0.4, "a2": [1.2, 1.3], "a3": 0.8, "a4": 1.0}
    found = fl.evaluate("planar_4r", ["swing"], **design)["swing"]
    assert found.tolist() == fl.evaluate("planar_4r", ["swing"], theta1=1.0, **design)["swing"].tolist()
    assert found.shape == (2,)
    with refused("theta1 is missing", "give it in rad"):
        fl.evaluate("planar_4r", ["swing", "theta4"], **design)


@pytest.mark.parametrize("name", ["omega4", "d_omega4_d_a2", "omega4_error", "grashof_class", "status"])
def test_results_of_evaluate_are_labelled_as_in_a_map(name):
    angles = xr.DataArray([0.5, 1.0], dims="theta1")
    found = fl.evaluate("planar_4r", [name], **DESIGN, theta1=angles)[name]
    swept = sweep_4r(DESIGN, [name], theta1=angles)[name]
    for label in ("units", "long_name", "symbol", "references"):
        assert found.attrs.get(label) == swept.attrs.get(label), label
    twice = fl.evaluate("planar_4r", [name], **DESIGN, theta1=angles)[name]
    found.attrs["units"] = "spoiled"
    assert twice.attrs.get("units") == swept.attrs.get("units")


# == One configuration has the bits that it has in an array, however degenerate: no division of Python's own numbers

POSITIONS = [0.0, np.pi, np.pi / 2, 1.0, -1.0, 0.3, 2.0 * np.pi]
#: Small whole numbers meet in change points, kites and folded positions; zeros where the rule allows them.
NUMBERS = {"any": [0.0, 1.0, -1.0, 2.0, 0.5]}


def drawn(mechanism, known, rng):
    """Return a degenerate design, an input position and an assembly mode."""
    design = {
        name: rng.choice(list(given.choices) or NUMBERS.get(given.rule, [1.0, 1.0, 2.0, 0.5, 3.0]))
        for name, given in known.items()
    }
    return design | {
        mechanism.position.name: rng.choice(POSITIONS),
        "branch": rng.choice(list(mechanism.branches)),
    }


@pytest.mark.sample(3)
@EVERY
def test_every_quantity_alone_is_as_in_an_array(mechanism, input):
    mechanism, rng = catalogue(mechanism, input), np.random.default_rng(3)
    known, position = mechanism.known_inputs(()), mechanism.position.name
    tables = (position, *mechanism.tables, *mechanism.table_low_parts)
    names = [name for name in mechanism.public if not mechanism.public[name].flags]
    bounds = [f"{name}_error" for name in names]
    steps = list(mechanism.dependencies([*mechanism.public, *bounds], {*known, *tables, "branch"}))
    for _ in range(5):
        values = drawn(mechanism, known, rng)
        tabled = angle_tables(mechanism, tables, np.array([values[position]]))
        values |= zip(tables, tabled[:, 0], strict=True)
        alone = {name: np.float64(value) for name, value in values.items()}
        together = {name: np.array([value], dtype=float) for name, value in values.items()}
        evaluate_on_doubles(steps, alone)
        evaluate_on_doubles(steps, together)
        for step in steps:
            for name in step.names:
                assert_array_equal(np.ravel(alone[name]), np.ravel(together[name]), f"{name} {values}")


@pytest.mark.parametrize(
    ("mechanism", "name", "inputs"),
    [
        ("minkowski_4r", "phi_error", {"a": 3.0, "b": 0.5, "g": 0.5, "h": 2.0, "theta": 1.0}),
        ("hart", "closure_residual", {"m": 1.0, "n": 1.0, "d": 1.0, "kappa": 0.0, "phi": 1.0}),
    ],
)
def test_evaluate_returns_what_an_array_has(mechanism, name, inputs):
    alone = fl.evaluate(mechanism, [name], **inputs)[name]
    (together,) = fl.evaluate(
        mechanism, [name], **{**inputs, next(iter(inputs)): [next(iter(inputs.values()))]}
    )[name]
    assert_array_equal(alone, together)
    assert not np.isfinite(alone)


# == A single assembly mode is a scalar coordinate, as xarray's users expect; a list of one is a dimension ===

LENGTHS = {"a1": 0.4, "a3": 0.8, "a4": 1.0, "omega1": 25.0}
SPACE = fl.grid(a2=[1.1, 1.2, 5.0], **LENGTHS)
NAMES_BRANCH = ["omega4", "omega4_max", "omega4_extrema", "grashof_class"]


@pytest.fixture(scope="module")
def both():
    return sweep_4r(SPACE, NAMES_BRANCH, theta1=24)


@pytest.mark.parametrize(
    "branch", [2, np.int64(2), np.array(2), xr.DataArray(2)], ids=lambda b: type(b).__name__
)
def test_a_scalar_is_a_coordinate_and_a_list_a_dimension(both, branch):
    one = fl.sweep("planar_4r", SPACE, NAMES_BRANCH, theta1=24, branch=branch)
    listed = fl.sweep("planar_4r", SPACE, NAMES_BRANCH, theta1=24, branch=[2])
    xr.testing.assert_equal(one, both.sel(branch=2))
    xr.testing.assert_equal(listed, both.sel(branch=[2]))
    assert one.branch.dims == ()
    assert one.branch.attrs["comment"] == both.branch.attrs["comment"]


def test_the_file_has_the_same_labels(tmp_path, both):
    options = {"theta1": 24, "branch": 2, "to": tmp_path / "map.h5", "verify": 2}
    with sweep_4r(SPACE, NAMES_BRANCH, **options) as one:
        xr.testing.assert_equal(one, both.sel(branch=2))
        assert one.attrs["verify_mismatches"] == 0
        assert int(one.branch) == 2
        assert "assembly mode" in contents(one)


def test_functions_of_maps_take_one_assembly_mode_and_what_has_none_has_no_label():
    names = ["T41_fluctuation"]
    one = fl.sweep("planar_4r", SPACE, names, links=BARS, branch=1)
    several = sweep_4r(SPACE, names, links=BARS)
    xr.testing.assert_equal(
        fl.planar.flywheel_inertia(one, C_s=0.02), fl.planar.flywheel_inertia(several, C_s=0.02).sel(branch=1)
    )
    chebyshev = fl.grid(a=[5.0, 5.5], b=5.0, c=2.0, d=4.0, rho=1.0, completion=1)
    options = {"input": "sigma", "sigma": np.linspace(3.3, 6.0, 9)}
    one = fl.sweep("focal", chebyshev, ["T_x", "T_y"], branch=1, **options)
    several = sweep_both("focal", chebyshev, ["T_x", "T_y"], **options)
    xr.testing.assert_equal(fl.focal.T_deviation(one), fl.focal.T_deviation(several).sel(branch=1))
    found = fl.sweep("planar_4r", SPACE, ["grashof_class"], branch=2)
    assert "branch" not in found.coords
