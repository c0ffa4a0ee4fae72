"""Quantities of one's own have all that built-in ones have: values, extremes, derivatives, error bounds, labels."""

import ast
import math
import pickle
import random
import re
from math import sin

import numpy as np
import pytest
from tests.support.refusals import refused
from tests.support.sweeps import BARS, TURNING, sweep_4r, sweep_both
from tests.support.toys import declare_all, function_of

import fastlink as fl
from fastlink.app.study import load_extension
from fastlink.codegen.kernel import kernel_of
from fastlink.engine.resolve import resolve
from fastlink.errors import InputError
from fastlink.facts.formula import NAMESPACE
from fastlink.facts.own import TAKEN, TOO_LONG, is_reserved
from fastlink.mechanisms import catalogue
from fastlink.pictures.content import script_of

mine = fl.extend("planar_4r")
mine.input("weight", units="1", default=0.5, rule="non-negative", description="weight of poor transmission")
mine.input("F_allowed", units="N", default=400.0, rule="positive")


@mine.quantity(units="1", symbol="C")
def cost(transmission_angle, omega4, omega1, weight):
    """Poor transmission, and speed of the output."""
    poor = 1.0 - sin(transmission_angle)
    speed = omega4 / omega1
    return weight * poor + speed**2


declare_all(
    mine,
    {
        "bearing_load(F21, F41)": ("N", "max(F21, F41)"),
        "smaller_load(F21, F41)": ("N", "np.minimum(F21, F41)"),
        "overload(bearing_load, F_allowed)": ("1", "max(bearing_load / F_allowed - 1, 0) ** 2"),
        "off_right_angle(transmission_angle)": ("rad", "abs(transmission_angle - math.pi / 2)"),
        "is_poor(transmission_angle)": (
            "1",
            "1.0 if transmission_angle < 0.7 or transmission_angle > 2.4 else 0.0",
        ),
    },
)

DESIGNS = fl.sobol(64, a1=(0.2, 0.5), a2=(0.9, 1.4), a3=(0.6, 1.1), a4=(0.9, 1.2), omega1=25.0, seed=3)
#: Numbers of angles of a grid that is compared with extremes.
ANGLES = 1000


def test_values_are_those_of_the_formula():
    names = ["cost", "bearing_load", "smaller_load", "overload", "off_right_angle", "is_poor"]
    maps = sweep_both(
        mine, DESIGNS, [*names, "transmission_angle", "omega4", "F21", "F41"], links=BARS, angles=60
    )
    mu, load = maps.transmission_angle, np.maximum(maps.F21, maps.F41)
    expected = {
        "cost": 0.5 * (1.0 - np.sin(mu)) + (maps.omega4 / 25.0) ** 2,
        "bearing_load": load,
        "smaller_load": np.minimum(maps.F21, maps.F41),
        "overload": np.maximum(load / 400.0 - 1.0, 0.0) ** 2,
        "off_right_angle": abs(mu - np.pi / 2),
        "is_poor": ((mu < 0.7) | (mu > 2.4)).where(mu.notnull()),
    }
    exact = ("bearing_load", "smaller_load", "off_right_angle")
    for name in names:
        # sine: two units in the last place of at most 1 where 1 - sin is taken; then four roundings
        atol = 0.0 if name in exact else 4 * 2.0**-52
        np.testing.assert_allclose(maps[name], expected[name], rtol=atol, atol=atol)


def test_it_goes_to_other_processes_as_text_and_every_door_agrees():
    maps = fl.sweep(mine, TURNING, ["cost", "cost_max"], theta1=np.array([1.0]), extrema="sampled", branch=1)
    at = fl.evaluate(mine, ["cost"], **TURNING, theta1=1.0, branch=1)
    assert at["cost"] == maps.cost.item()
    greatest = fl.function(
        mine, ["a1", "weight"], ["cost_max"], **{k: v for k, v in TURNING.items() if k != "a1"}
    )
    assert greatest([0.4, 0.5]).item() == fl.sweep(mine, TURNING, ["cost_max"], branch=1).cost_max.item()
    assert pickle.loads(pickle.dumps(greatest))([0.4, 0.5]) == greatest([0.4, 0.5])
    again = pickle.loads(pickle.dumps(mine))
    assert repr(again) == repr(mine)
    request = resolve(mine, TURNING, ["cost_max"], branch=(1, 2))
    travelled = pickle.loads(pickle.dumps(request))
    assert travelled.fingerprint == request.fingerprint
    assert travelled.catalogue is request.catalogue


@pytest.mark.sample(1)
@pytest.mark.parametrize("name", ["cost", "bearing_load", "off_right_angle", "smaller_load"])
def test_extremes_are_those_of_a_dense_grid(name):
    wanted = [f"{name}{ending}" for ending in ("_max", "_min", "_max_error", "_min_error")]
    maps = sweep_both(mine, DESIGNS, wanted, links=BARS)
    grid = sweep_both(
        mine, DESIGNS, [name], links=BARS, theta1=np.linspace(0.0, 2 * np.pi, ANGLES, endpoint=False)
    )
    rotates = (maps.status == 0).values
    curves = grid[name].values[rotates]
    for ending, sign in (("max", 1.0), ("min", -1.0)):
        found, bound = (maps[f"{name}_{ending}{more}"].values[rotates] for more in ("", "_error"))
        best = (sign * curves).max(axis=-1)
        # no sample is beyond an extreme by more than its bound and the rounding of the sample
        size = np.abs(curves).max(axis=-1)
        assert (best - sign * found <= bound + 1e-12 * size).all()
        # next to a kink a sample is off by at most half a step times the slope, here below 40 times the size
        assert (sign * found - best <= 40.0 * size * np.pi / ANGLES).all()


@pytest.mark.stress
def test_verification_with_50_digits_finds_roundings_alone():
    names = ["cost_max", "cost_extrema", "d_cost_d_a1"]
    names += ["bearing_load_max", "d_overload_d_F_allowed", "cost_error"]
    maps = sweep_both(mine, DESIGNS, [*names, "bearing_load_error"], links=BARS, angles=24, verify=3)
    assert maps.attrs["verify_mismatches"] == 0
    for name in ("cost_max", "d_cost_d_a1", "bearing_load_max"):
        # in units of the rounding of the inputs: the bound of `test_precision` for built-in ones
        assert maps[name].attrs["error_max_roundings"] < 64.0
    assert maps.cost_error.attrs["verify_mismatches"] == 0


def test_derivatives_are_those_of_differences_and_bounds_cover_choices_that_rounding_makes():
    given = {**TURNING, "theta1": 1.0, "branch": 1}
    step = 2.0**-18
    for by in ("a1", "weight"):
        moved = [fl.evaluate(mine, ["cost"], **{**given, "weight": 0.5, by: {**given, "weight": 0.5}[by] + d})["cost"]
                 for d in (-step, step)]  # fmt: skip
        slope = fl.evaluate(mine, [f"d_cost_d_{by}"], **given)[f"d_cost_d_{by}"]
        # the third derivative over six times step^2, about 1e-10 of the value; rounding over the step
        assert abs((moved[1] - moved[0]) / (2 * step) - slope) < 1e-8 * max(abs(slope), 1.0)
    # where both forces are within their errors of each other, the bound is at least the greater of both errors
    maps = sweep_both(mine, DESIGNS, ["bearing_load_error", "F21_error", "F41_error"], links=BARS, angles=60)
    least = np.minimum(maps.F21_error, maps.F41_error)
    assert (maps.bearing_load_error >= least).where(least.notnull(), True).all()


def test_extremes_at_kinks_have_no_derivative():
    names = ["d_off_right_angle_max_d_a2", "d_off_right_angle_min_d_a2"]
    names += [f"off_right_angle_{end}{more}" for end in ("max", "min") for more in ("", "_gradient_status")]
    maps = sweep_both(mine, DESIGNS, names).isel(design=slice(0, 16))
    rotates = (maps.status == 0).values
    kink = (maps.off_right_angle_min_gradient_status.values == 6)[rotates]
    # a least value of |x| is either 0, at a kink, or that of a place where the slope of x is 0
    assert ((maps.off_right_angle_min.values[rotates] < 1e-12) == kink).all()
    assert (np.isnan(maps.d_off_right_angle_min_d_a2.values[rotates]) == kink).all()
    assert kink.any()
    assert not (maps.off_right_angle_max_gradient_status == 6).any()


def test_labels_tell_what_it_is_and_inputs_that_nothing_depends_on_stay_out():
    maps = sweep_both(mine, TURNING, ["cost_max", "bearing_load_rms"], links=BARS)
    assert maps.cost_max.attrs["long_name"].startswith("Poor transmission, and speed of the output")
    assert maps.cost_max.attrs["symbol"] == "max C"
    assert maps.bearing_load_rms.attrs["units"] == "N"
    assert maps.weight.attrs["long_name"] == "weight of poor transmission"
    assert "declared in test_own_quantities.py" in maps.cost_max.attrs["references"]
    assert any(row.name == "cost" and row.units == "1" for row in fl.quantities(mine))
    assert "cost_max" in str(fl.explain(mine, TURNING, ["cost_max"], branch=(1, 2)))
    maps = sweep_both(mine, TURNING, ["omega4_max"])
    assert maps.identical(sweep_4r(TURNING, ["omega4_max"]).assign_attrs(maps.attrs))
    assert "weight" in sweep_both(mine, TURNING, ["cost_max"]).coords
    maps = sweep_both(mine, TURNING, ["is_poor_max", "is_poor_mean"])
    assert maps.is_poor_max.attrs["extrema"] == "sampled"


def test_a_map_holds_the_text_that_makes_it_again(tmp_path):
    maps = sweep_both(mine, TURNING, ["overload_max"], links=BARS)
    text = maps.attrs["own_quantities"]
    names = [node.name for node in ast.parse(text).body if isinstance(node, ast.FunctionDef)]
    assert names == ["bearing_load", "overload"]
    file = tmp_path / "again.py"
    file.write_text(text)
    scope = {}
    exec(compile(text, str(file), "exec"), scope)
    again = sweep_both(scope["mine"], TURNING, ["overload_max"], links=BARS)
    assert again.overload_max.identical(maps.overload_max.assign_attrs(references="declared in again.py"))
    assert "own_quantities" not in sweep_both(mine, TURNING, ["omega4_max"]).attrs


def test_the_best_design_is_refined_by_the_extension_of_its_map():
    space = fl.grid(a1=[0.2, 0.3], a2=[1.0, 1.2], a3=[0.7, 0.9], a4=1.0, omega1=25.0)
    maps = fl.sweep(mine, space, ["cost_max"], branch=1)
    wanted = {"minimise": "cost_max", "where": "rotates_fully", "top": 1, "refine": True}
    found = fl.best(maps, **wanted, mechanism=mine)
    assert found.cost_max[0] < maps.cost_max.where(maps.status == 0).min()
    with refused("cost_max", "mechanism="):
        fl.best(maps, **wanted)
    for other in (fl.extend("planar_4r"), fl.extend("hart"), "planar_4r"):
        with refused("mechanism", "extend" if other == "planar_4r" else "extension"):
            fl.best(maps, **wanted, mechanism=other)
    with refused("mechanism", "refine=True"):
        fl.best(maps, minimise="cost_max", mechanism=mine)


def test_built_in_kernels_stay_as_they_are():
    texts = [
        [
            kernel_of(program).text
            for program in resolve(of, TURNING, ["omega4_max", "theta4"], branch=(1, 2)).plan.programs
        ]
        for of in (mine, "planar_4r")
    ]
    assert texts[0] == texts[1]
    assert not catalogue("planar_4r").is_quantity("cost")
    with refused("cost"):
        sweep_4r(TURNING, ["cost"])


def test_a_run_of_another_definition_is_refused(tmp_path):
    other = fl.extend(mine)
    path = tmp_path / "maps.h5"
    sweep_both(mine, TURNING, ["cost_max"], to=path, verify=0).close()
    sweep_both(mine, TURNING, ["cost_max"], to=path, verify=0).close()  # the same: opened

    labels = {"symbol": "C", "description": "Poor transmission, and speed of the output."}
    head, text = "cost(transmission_angle, omega4, omega1, weight)", "weight * (1.0 - transmission_angle)"
    changed = function_of(head, f"return {text} + (omega4 / omega1) ** 2")
    other.quantity(units="1", **labels)(changed)
    with pytest.raises(InputError, match="own_quantities"):
        sweep_both(other, TURNING, ["cost_max"], to=path, verify=0)
    one, another = (resolve(of, TURNING, ["cost_max"], branch=(1, 2)).fingerprint for of in (mine, other))
    assert one != another
    further = fl.extend(mine)
    further.input("unrelated", units="1")
    assert resolve(further, TURNING, ["cost_max"], branch=(1, 2)).fingerprint == one


def test_other_inputs_have_what_is_defined_there():
    lengths = {name: value for name, value in TURNING.items() if name != "omega1"}
    maps = sweep_both(mine, lengths, ["off_right_angle_max"], input="joint_angle_4")
    assert np.isfinite(maps.off_right_angle_max).any()
    with refused("bearing_load_max", "leave input out"):
        sweep_both(mine, lengths, ["bearing_load_max"], input="joint_angle_4")


def test_names_of_kernels_are_taken():
    wanted = ["omega4_max", "omega4_extrema", "F21_max_error", "d_F21_max_d_a1"]
    wanted += ["F21", "F21_mean", "T41_fluctuation", "P_straightness", "P_roundness"]
    known, names = catalogue("planar_4r"), set()
    design = TURNING | {"P_u": 0.5, "P_v": 0.2}
    for program in resolve("planar_4r", design, wanted, links=BARS, branch=(1, 2)).plan.programs:
        tree = ast.parse(kernel_of(program).text)
        names |= {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)}
        names |= {node.arg for node in ast.walk(tree) if isinstance(node, ast.arg)}
        names |= {node.name for node in ast.walk(tree) if isinstance(node, ast.alias)}
        names |= {node.name for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)}
    numbered = {name for name in names if re.fullmatch(r"[a-z]+(_[a-z]+)*_\d+", name)}
    assert {name for name in numbered if not (is_reserved(name) or known.declares(name))} == set()
    # names with two underscores, and those that begin with one or end in a number after one, are made of others
    names = {name for name in names if not re.search(r"__|^_|_\d+$|^out_|_error$|^whole_", name)}
    facts = {name for name in names if known.declares(name) or known.is_derivative(name)}
    assert names - facts <= TAKEN | FUNCTIONS_OF_FACTS


#: What facts call: no name of a quantity, since `extend` lets no declaration have a name that NAMESPACE has.
FUNCTIONS_OF_FACTS = set(NAMESPACE)


# == Texts of any length: each long chain of operations is computed in pieces, or refused in a line ==========

HEAD = """from math import *
import fastlink as fl
mine = fl.extend("planar_4r")
@mine.quantity(units="1")
def long(theta4, a1, a2):
    x = theta4
"""
FACTORS = [round(random.Random(k).uniform(0.5, 1.5), 3) for k in range(1000)]
TEXTS = {
    "sum": " + ".join(f"{k} * x" for k in FACTORS),
    "difference": " - ".join(f"{k} / x" for k in FACTORS),
    "product": " * ".join(f"({k} + 0.001 * x)" for k in FACTORS),
    "quotient": " / ".join(f"({k} + 0.001 * x)" for k in FACTORS),
    "signs": f"{'-' * 1001}x",
    "choices": f"{''.join(f'{k} if x < {k / 1000} else ' for k in range(1000))}x",
    "conditions": f"1.0 if {' & '.join(f'(x < {k + 5})' for k in range(1000))} else 0.0",
    "all": f"1.0 if {' and '.join(f'x < {k + 5}' for k in range(1000))} else 0.0",
    "comparisons": f"1.0 if x < {' < '.join(f'{k} + x' for k in range(1000))} else 0.0",
    "greatest": f"max({', '.join(f'{k} * x' for k in FACTORS)})",
    "magnitudes": " + ".join(f"abs({k} - x)" for k in FACTORS),
}


@pytest.fixture
def declared(tmp_path):
    """Return a function that declares a text, and returns the extension and the text as a function of Python."""

    def declare(text):
        (tmp_path / "mine.py").write_text(HEAD + text + "\n")
        extension = load_extension(tmp_path / "study.toml", "mine.py", "planar_4r", True)
        names = {}
        exec(
            compile(f"from math import *\ndef long{HEAD.rpartition('def long')[2]}{text}\n", "", "exec"),
            names,
        )
        return extension, names["long"]

    return declare


@pytest.mark.sample(1)
@pytest.mark.parametrize("kind", TEXTS)
def test_a_long_chain_has_the_value_that_python_gives_it(declared, kind):
    mine, function = declared(f"    return {TEXTS[kind]}")
    found = fl.evaluate(mine, ["theta4", "long"], theta1=1.0, branch=1, **TURNING)
    assert found["long"] == function(found["theta4"], 0.4, 1.2)
    catalogue = mine.catalogue()
    assert script_of(catalogue, ["long"], list(TURNING), ())[1] == ("long",)
    assert catalogue.resolve("long_error").depends_on
    if kind not in (
        "conditions",
        "all",
        "comparisons",
    ):  # they choose between numbers, which depend on nothing
        assert catalogue.resolve("d_long_d_a2").depends_on


@pytest.mark.sample(1)
@pytest.mark.parametrize("kind", ["sum", "conditions"])
def test_a_long_chain_is_taken_by_every_reader(declared, kind):
    text = TEXTS[kind] if kind == "conditions" else " + ".join(f"{k} * x" for k in FACTORS[:100])
    mine, function = declared(f"    return {text} + a2 / a1 * x")
    space = fl.grid(**TURNING | {"a1": [0.3, 0.4]})
    smooth = ["d_long_d_a2", "long_max_error"] if kind == "sum" else []
    maps = fl.sweep(
        mine, space, ["theta4", "long", "long_error", "long_max", *smooth], branch=1, theta1=7, verify=1
    )
    expected = [
        [function(x, a1, 1.2) for x in row]
        for a1, row in zip((0.3, 0.4), maps.theta4.squeeze().values, strict=True)
    ]
    assert np.abs(maps.long.squeeze() - expected).max() <= 1e-13 * np.abs(expected).max()
    assert (maps.long_max.squeeze() >= maps.long.squeeze().max("theta1") * (1 - 1e-13)).all()
    assert float(maps.long_error.max()) < 1e-9


@pytest.mark.stress
def test_ten_thousand_terms(declared):
    lines = [f"    y = {'y + ' if k else ''}{TEXTS['sum']}" for k in range(10)]
    mine, function = declared("\n".join([*lines, "    return y"]))
    found = fl.evaluate(mine, ["theta4", "long"], theta1=1.0, branch=1, **TURNING)
    assert math.isclose(found["long"], function(found["theta4"], 0.4, 1.2), rel_tol=1e-11)


def test_what_python_has_no_room_for_is_refused_and_more_kinks_than_are_searched_sampled(declared):
    for text in (" + ".join(["x"] * 100_000), "-" * 100_000 + "x"):
        with refused("quantities_file", TOO_LONG[1]):
            declared(f"    return {text}")
    for text in ("x" + "**2" * 900, "x" + "[0]" * 900, f"1.0 if {'not ' * 900}x < 1.0 else 0.0"):
        with pytest.raises(InputError) as caught:
            declared(f"    return {text}")
        assert len(str(caught.value)) < 400
    for count, sampled in ((3, False), (100, True)):
        mine, _ = declared(f"    return {' + '.join(f'abs({k} - x)' for k in FACTORS[:count])}")
        catalogue = mine.catalogue()
        assert ("long" in catalogue.graded.not_differentiable) is sampled
        assert ("long" in catalogue.graded.kinks) is not sampled


# == A quantity of one's own of every mechanism: values, extremes, derivatives ===============================

#: The head of a quantity, its units and value, and a design.
CASES = {
    "slider_crank": (
        *("of_it(slider_velocity, omega, r)", "m s-1", "max(abs(slider_velocity), omega * r / 2)"),
        {"r": 0.1, "l": 0.3, "e": 0.02, "omega": 20.0},
    ),
    "hart": ("of_it(Q_x, Q_y)", "m2", "Q_x**2 + Q_y**2", {"m": 4.0, "n": 8.0, "d": 6.0, "kappa": 0.5}),
    "focal": (
        *("of_it(A_x, A_y, B_x, B_y)", "m", "((A_x - B_x) ** 2 + (A_y - B_y) ** 2) ** 0.5"),
        {"a": 5.0, "b": 5.0, "c": 2.0, "d": 4.0, "rho": 1.0, "completion": 1},
    ),
    "minkowski_4r": ("of_it(A_x, A_y)", "m2", "A_x * A_y", {"a": 1.0, "b": 7.0, "g": 4.0, "h": 1.0}),
}
LATER = ("focal", "hart")


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.stress if name in LATER else ()) for name in CASES]
)
def test_it_is_compiled_searched_and_differentiated(name):
    head, units, value, design = CASES[name]
    declare_all(mechanism := fl.extend(name), {head: (units, value)})
    slope = f"d_of_it_d_{next(iter(design))}"
    wanted = ["of_it", "of_it_max", "of_it_min", slope, "of_it_error"]
    angles = None if name == "minkowski_4r" else 90
    maps = fl.sweep(mechanism, design, wanted, angles=angles, branch=1, verify=1)
    curve = maps.of_it
    assert curve.notnull().any()
    size = float(abs(curve).max())
    # a sample is no better than the extreme; the extreme is off a sample by a step times the slope at most
    assert float(curve.max()) <= float(maps.of_it_max) + 1e-12 * size
    assert float(maps.of_it_min) <= float(curve.min()) + 1e-12 * size
    assert maps.attrs["verify_mismatches"] == 0
    for each in ("of_it", slope):
        assert maps[each].attrs["error_max_roundings"] < 64.0
    assert np.isfinite(maps.of_it_error.where(curve.notnull())).any()
