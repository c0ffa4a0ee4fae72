"""Quantities of one's own have all that built-in ones have: values, extremes, derivatives, error bounds, labels."""

import ast
import pickle
import re

import numpy as np
import pytest
from tests.facts.own.declared import LENGTHS, LINKS, mine
from tests.support.four_bar import sweep_4r
from tests.support.refusals import refused

import fastlink as fl
from fastlink.codegen.kernel import kernel_of
from fastlink.engine.resolve import resolve
from fastlink.errors import InputError
from fastlink.facts.formula import NAMESPACE
from fastlink.facts.own import TAKEN, is_reserved
from fastlink.mechanisms import catalogue

DESIGNS = fl.sobol(64, a1=(0.2, 0.5), a2=(0.9, 1.4), a3=(0.6, 1.1), a4=(0.9, 1.2), omega1=25.0, seed=3)
#: Numbers of angles of a grid that is compared with extremes.
ANGLES = 1000


def test_values_are_those_of_the_formula():
    names = ["cost", "bearing_load", "smaller_load", "overload", "off_right_angle", "is_poor"]
    maps = fl.sweep(
        mine,
        DESIGNS,
        [*names, "transmission_angle", "omega4", "F21", "F41"],
        links=LINKS,
        angles=60,
        branch=(1, 2),
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


def test_evaluate_and_function_and_sweep_agree():
    maps = fl.sweep(mine, LENGTHS, ["cost", "cost_max"], theta1=np.array([1.0]), extrema="sampled", branch=1)
    at = fl.evaluate(mine, ["cost"], **LENGTHS, theta1=1.0, branch=1)
    assert at["cost"] == maps.cost.item()
    greatest = fl.function(
        mine, ["a1", "weight"], ["cost_max"], **{k: v for k, v in LENGTHS.items() if k != "a1"}
    )
    assert greatest([0.4, 0.5]).item() == fl.sweep(mine, LENGTHS, ["cost_max"], branch=1).cost_max.item()
    assert pickle.loads(pickle.dumps(greatest))([0.4, 0.5]) == greatest([0.4, 0.5])


@pytest.mark.sample(1)
@pytest.mark.parametrize("name", ["cost", "bearing_load", "off_right_angle", "smaller_load"])
def test_extremes_are_those_of_a_dense_grid(name):
    wanted = [f"{name}{ending}" for ending in ("_max", "_min", "_max_error", "_min_error")]
    maps = fl.sweep(mine, DESIGNS, wanted, links=LINKS, branch=(1, 2))
    grid = fl.sweep(
        mine,
        DESIGNS,
        [name],
        links=LINKS,
        theta1=np.linspace(0.0, 2 * np.pi, ANGLES, endpoint=False),
        branch=(1, 2),
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
    names = [
        "cost_max",
        "cost_extrema",
        "d_cost_d_a1",
        "bearing_load_max",
        "d_overload_d_F_allowed",
        "cost_error",
    ]
    maps = fl.sweep(
        mine, DESIGNS, [*names, "bearing_load_error"], links=LINKS, angles=24, verify=3, branch=(1, 2)
    )
    assert maps.attrs["verify_mismatches"] == 0
    for name in ("cost_max", "d_cost_d_a1", "bearing_load_max"):
        # in units of the rounding of the inputs: the bound of `test_precision` for built-in ones
        assert maps[name].attrs["error_max_roundings"] < 64.0
    assert maps.cost_error.attrs["verify_mismatches"] == 0


def test_derivatives_are_those_of_differences():
    given = {**LENGTHS, "theta1": 1.0, "branch": 1}
    step = 2.0**-18
    for by in ("a1", "weight"):
        moved = [fl.evaluate(mine, ["cost"], **{**given, "weight": 0.5, by: {**given, "weight": 0.5}[by] + d})["cost"]
                 for d in (-step, step)]  # fmt: skip
        slope = fl.evaluate(mine, [f"d_cost_d_{by}"], **given)[f"d_cost_d_{by}"]
        # the third derivative over six times step^2, about 1e-10 of the value; rounding over the step
        assert abs((moved[1] - moved[0]) / (2 * step) - slope) < 1e-8 * max(abs(slope), 1.0)


def test_error_bounds_cover_a_choice_that_rounding_makes():
    # where both forces are within their errors of each other, the bound is at least the greater of both errors
    maps = fl.sweep(
        mine, DESIGNS, ["bearing_load_error", "F21_error", "F41_error"], links=LINKS, angles=60, branch=(1, 2)
    )
    least = np.minimum(maps.F21_error, maps.F41_error)
    assert (maps.bearing_load_error >= least).where(least.notnull(), True).all()


def test_extremes_at_kinks_have_no_derivative():
    names = ["d_off_right_angle_max_d_a2", "d_off_right_angle_min_d_a2"]
    names += [f"off_right_angle_{end}{more}" for end in ("max", "min") for more in ("", "_gradient_status")]
    maps = fl.sweep(mine, DESIGNS, names, branch=(1, 2)).isel(design=slice(0, 16))
    rotates = (maps.status == 0).values
    kink = (maps.off_right_angle_min_gradient_status.values == 6)[rotates]
    # a least value of |x| is either 0, at a kink, or that of a place where the slope of x is 0
    assert ((maps.off_right_angle_min.values[rotates] < 1e-12) == kink).all()
    assert (np.isnan(maps.d_off_right_angle_min_d_a2.values[rotates]) == kink).all()
    assert kink.any()
    assert not (maps.off_right_angle_max_gradient_status == 6).any()


def test_labels_tell_what_it_is():
    maps = fl.sweep(mine, LENGTHS, ["cost_max", "bearing_load_rms"], links=LINKS, branch=(1, 2))
    assert maps.cost_max.attrs["long_name"].startswith("Poor transmission, and speed of the output")
    assert maps.cost_max.attrs["symbol"] == "max C"
    assert maps.bearing_load_rms.attrs["units"] == "N"
    assert maps.weight.attrs["long_name"] == "weight of poor transmission"
    assert "declared in declared.py" in maps.cost_max.attrs["references"]
    assert any(row.name == "cost" and row.units == "1" for row in fl.quantities(mine))
    assert "cost_max" in str(fl.explain(mine, LENGTHS, ["cost_max"], branch=(1, 2)))


def test_a_map_holds_the_text_that_makes_it_again(tmp_path):
    maps = fl.sweep(mine, LENGTHS, ["overload_max"], links=LINKS, branch=(1, 2))
    text = maps.attrs["own_quantities"]
    names = [node.name for node in ast.parse(text).body if isinstance(node, ast.FunctionDef)]
    assert names == ["bearing_load", "overload"]
    file = tmp_path / "again.py"
    file.write_text(text)
    scope = {}
    exec(compile(text, str(file), "exec"), scope)
    again = fl.sweep(scope["mine"], LENGTHS, ["overload_max"], links=LINKS, branch=(1, 2))
    assert again.overload_max.identical(maps.overload_max.assign_attrs(references="declared in again.py"))
    assert "own_quantities" not in fl.sweep(mine, LENGTHS, ["omega4_max"], branch=(1, 2)).attrs


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


def test_inputs_that_nothing_depends_on_stay_out():
    maps = fl.sweep(mine, LENGTHS, ["omega4_max"], branch=(1, 2))
    assert maps.identical(sweep_4r(LENGTHS, ["omega4_max"]).assign_attrs(maps.attrs))
    assert "weight" in fl.sweep(mine, LENGTHS, ["cost_max"], branch=(1, 2)).coords


def test_built_in_kernels_stay_as_they_are():
    texts = [
        [
            kernel_of(program).text
            for program in resolve(of, LENGTHS, ["omega4_max", "theta4"], branch=(1, 2)).plan.programs
        ]
        for of in (mine, "planar_4r")
    ]
    assert texts[0] == texts[1]
    assert not catalogue("planar_4r").is_quantity("cost")
    with refused("cost"):
        sweep_4r(LENGTHS, ["cost"])


def test_a_run_of_another_definition_is_refused(tmp_path):
    other = fl.extend(mine)
    path = tmp_path / "maps.h5"
    fl.sweep(mine, LENGTHS, ["cost_max"], to=path, verify=0, branch=(1, 2)).close()
    fl.sweep(mine, LENGTHS, ["cost_max"], to=path, verify=0, branch=(1, 2)).close()  # the same: opened

    @other.quantity(units="1", symbol="C")
    def cost(transmission_angle, omega4, omega1, weight):
        """Poor transmission, and speed of the output."""
        return weight * (1.0 - transmission_angle) + (omega4 / omega1) ** 2

    with pytest.raises(InputError, match="own_quantities"):
        fl.sweep(other, LENGTHS, ["cost_max"], to=path, verify=0, branch=(1, 2))
    one, another = (resolve(of, LENGTHS, ["cost_max"], branch=(1, 2)).fingerprint for of in (mine, other))
    assert one != another
    further = fl.extend(mine)
    further.input("unrelated", units="1")
    assert resolve(further, LENGTHS, ["cost_max"], branch=(1, 2)).fingerprint == one


def test_it_goes_to_other_processes_as_text():
    again = pickle.loads(pickle.dumps(mine))
    assert repr(again) == repr(mine)
    request = resolve(mine, LENGTHS, ["cost_max"], branch=(1, 2))
    travelled = pickle.loads(pickle.dumps(request))
    assert travelled.fingerprint == request.fingerprint
    assert travelled.catalogue is request.catalogue


def test_other_inputs_have_what_is_defined_there():
    lengths = {name: value for name, value in LENGTHS.items() if name != "omega1"}
    maps = fl.sweep(mine, lengths, ["off_right_angle_max"], input="joint_angle_4", branch=(1, 2))
    assert np.isfinite(maps.off_right_angle_max).any()
    with refused("bearing_load_max", "leave input out"):
        fl.sweep(mine, lengths, ["bearing_load_max"], input="joint_angle_4", branch=(1, 2))


def test_extremes_of_what_may_jump_are_those_of_samples():
    maps = fl.sweep(mine, LENGTHS, ["is_poor_max", "is_poor_mean"], branch=(1, 2))
    assert maps.is_poor_max.attrs["extrema"] == "sampled"


def test_names_of_kernels_are_taken():
    wanted = [
        "omega4_max",
        "omega4_extrema",
        "F21_max_error",
        "d_F21_max_d_a1",
        "F21",
        "F21_mean",
        "T41_fluctuation",
        "P_straightness",
        "P_roundness",
    ]
    known, names = catalogue("planar_4r"), set()
    design = LENGTHS | {"P_u": 0.5, "P_v": 0.2}
    for program in resolve("planar_4r", design, wanted, links=LINKS, branch=(1, 2)).plan.programs:
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
