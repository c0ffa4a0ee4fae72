"""Every public function refuses a wrong call, and a wrong option, with what to write instead."""

import inspect
import pickle
import re
import subprocess
import sys

import pytest
from typer.testing import CliRunner

import fastlink as fl
from fastlink.app.cli import app
from fastlink.errors import CallError, door
from tests.support.refusals import refused
from tests.support.study_files import GOOD, written
from tests.support.sweeps import sweep_4r

NAMESPACES = (fl, fl.planar, fl.focal, fl.minkowski, fl.hart)


def public_functions():
    """Return every public function and every public method of a design space, by its name."""
    found = {}
    for namespace in NAMESPACES:
        for name in namespace.__all__:
            thing = getattr(namespace, name)
            if inspect.isfunction(thing):
                found[f"{namespace.__name__}.{name}"] = thing
    for name, method in inspect.getmembers(fl.DesignSpace, inspect.isfunction):
        if not name.startswith("_") or name == "__init__":
            found[f"DesignSpace.{name}"] = method
    return found


PUBLIC = public_functions()


@pytest.mark.parametrize("name", PUBLIC)
def test_every_public_function_refuses_a_call_that_does_not_fit(name):
    function = PUBLIC[name]
    with pytest.raises(CallError) as caught:
        function(*range(50))
    assert isinstance(caught.value, fl.InputError)
    assert isinstance(caught.value, TypeError)
    assert " by position, " in caught.value.what
    assert str(caught.value.remedy).startswith("write ")
    if "**" not in str(inspect.signature(function)):
        with pytest.raises(CallError, match="nothing_like_it"):
            function(nothing_like_it=1)


DESIGN = {"a1": 0.4, "a2": 1.2, "a3": 0.8, "a4": 1.0, "omega1": 25.0}
SLIDER = {"r": 0.1, "l": 0.3, "e": 0.0}


def search_of(where):
    return fl.search("planar_4r", fl.grid(DESIGN), minimise="swing", where=where)


def swept(space, **options):
    names = options.pop("quantities", ["theta4"])
    return sweep_4r(space, names, **options)


#: Calls, what is wrong with each, and what to write instead.
WRONG_CALLS = {
    "fl.round_bar(raduis=0.01)": ("raduis", "'radius'"),
    "fl.sobol(N=64, a1=(1, 2))": ("n", "n in place of N"),
    "swept(fl.sobol(4, Seed=1, a1=(0.1, 0.2)))": ("Seed", "'seed'"),
    "swept(fl.grid(a1=1.0), n_jobs=2)": ("n_jobs", "'threads'"),
    "swept(fl.grid(a1=1.0), output='maps.h5')": ("output", "'to'"),
    "fl.sweep('planar_4r', designs=fl.grid(a1=1.0), outputs=['omega4'])": ("space", "of designs"),
    "fl.latin_hypercube(a1=(1, 2))": ("n", "latin_hypercube(n, ranges=..., seed=..., **more)"),
    "fl.grid([1.0, 2.0])": ("grid", "by name"),
    "fl.sobol(8, n=8)": ("n", "once"),
    "fl.sobol(8, n=(1.0, 2.0))": ("n", "in a mapping"),
    "fl.evaluate('planar_4r', ['theta4'], {'a1': 0.4})": ("evaluate", "as **design"),
    "fl.focal.cubic(a=1.0)": ("b, c, d and phi", "cubic(a, b, c, d, phi, branch=...)"),
    "fl.function('planar_4r', ['a2'], outputs=['omega4'])": ("quantities", "quantities in place of outputs"),
    "fl.explain(study='study.toml')": ("subject", "subject in place of study"),
    "fl.plot('maps.h5', maximise=[])": ("names", "or objectives by "),
    "fl.mechanisms(3)": ("mechanisms", "mechanisms()"),
    "fl.open()": ("path", "open(path"),
    "fl.sweep('planar_4r', fl.grid(a1=1.0), quantites=['omega4'])": ("quantities", "of quantites"),
    "fl.sweep('planar_4r', fl.grid(a1=1.0), ['omega4'], 360)": ("sweep", "links=..."),
    "fl.sweep('planar_4r', fl.grid(a1=1.0))": ("quantities", "sweep(mechanism, space, quantities"),
    "fl.accuracy('planar_4r', fl.grid(a1=1.0), ['omega4'])": ("accuracy", "fastlink new"),
    "fl.run('s.toml', thraeds=2)": ("thraeds", "'threads'"),
    "fl.grid(a1=1.0).values()": ("values", "values(name)"),
    "fl.DesignSpace('grid')": ("dims", "grid, table, sobol"),
    "fl.planar.cognates(1, 2, 3)": ("cognates", "cognates("),
    "fl.hart.integer_designs(8, moveable=True)": ("moveable", "'movable'"),
    "fl.run('s.toml', branch=2)": ("branch", "in the study, under [cycle]"),
    "fl.run('s.toml', theta1_deg=[1.0])": ("theta1_deg", "in the study, under [cycle]"),
    "fl.accuracy('s.toml', minimise='swing')": ("minimise", "in the study, under [search]"),
    "fl.accuracy('s.toml', a1_mm=400)": ("a1_mm", "in the study, under [design]"),
    "swept(DESIGN, branch='both')": ("'both'", "'branch', value=(1, 2)"),
    "swept(DESIGN, branch='open')": ("'open'", "write 2, which is open where theta1 is in (0, pi)"),
    "swept(DESIGN, branch='left')": ("'left'", "2 (B to the left"),
    "fl.evaluate('planar_4r', ['theta4'], **DESIGN, theta1=1.0, branch='crossed')": ("'crossed'", "write 2"),
    "fl.sweep('slider_crank', SLIDER, ['stroke'], theta1_deg=[10.0])": ("theta1_deg", "as theta_deg"),
    "fl.evaluate('slider_crank', ['theta2'], **SLIDER, theta1_deg=10.0)": ("theta1_deg", "write theta_deg"),
    "fl.evaluate('planar_4r', ['theta4'], **DESIGN, positions=20)": ("positions", "write theta1"),
    "swept(DESIGN, quantities=['swing_deg'])": ("swing_deg", "write 'swing'"),
    "swept(DESIGN, quantities=['d_swing_d_a1_mm'])": ("d_swing_d_a1_mm", "write 'd_swing_d_a1'"),
    "fl.draw('slider_crank', SLIDER, theta1_deg=10.0)": ("theta1_deg", "write theta_deg"),
    "swept(DESIGN, theta=[1.0])": ("theta", "write its positions as theta1"),
    "search_of({'status': 'wrong meaning'})": ("'status'", "rotates_fully"),
    "search_of('wrong meaning')": ("'wrong meaning'", "rotates_fully"),
    "search_of({'grashof_class': ['rocker_cranc']})": ("'grashof_class'", "'rocker_crank'"),
    "fl.sweep('planar_4r', DESIGN, ['omega4_maxx'])": ("omega4_maxx", "'omega4_max'"),
}


@pytest.mark.parametrize("call", WRONG_CALLS)
def test_a_wrong_call_names_the_parameter_and_what_to_write(call):
    key, remedy = WRONG_CALLS[call]
    with pytest.raises(fl.InputError) as caught:
        eval(call)
    problems = [(str(one.where) + one.what, str(one.remedy)) for one in caught.value.problems]
    assert any(key in where and remedy in mended for where, mended in problems), caught.value


def test_all_that_is_wrong_with_a_call_is_named_and_errors_inside_are_passed_on():
    with pytest.raises(CallError) as caught:
        fl.plot(nmae="omega4", branches=1, colour="red")
    wheres = {one.where for one in caught.value.problems}
    assert wheres == {("plot", key) for key in ("maps", "nmae", "branches", "colour")}

    @door
    def broken(value):
        return value + "text"

    with pytest.raises(TypeError, match="unsupported operand") as caught:
        broken(1)
    assert not isinstance(caught.value, CallError)


def test_a_guarded_function_keeps_its_signature_and_travels():
    assert list(inspect.signature(fl.sobol).parameters) == ["n", "ranges", "seed", "more"]
    assert pickle.loads(pickle.dumps(fl.sobol)) is fl.sobol
    with pytest.raises(CallError) as caught:
        fl.sobol()
    again = pickle.loads(pickle.dumps(caught.value))
    assert (again.problems, str(again)) == (caught.value.problems, str(caught.value))


def test_the_command_alone_prints_its_help_and_a_mechanism_is_no_study():
    for function in (fl.accuracy, fl.explain, fl.run):
        with refused("planar_4r", "`fastlink new planar_4r > study.toml` writes one"):
            function("planar_4r")
    assert "\n  run " in CliRunner().invoke(app, []).output


WORD = "w" * 5000
LINES = (
    f"{WORD}", f"--{WORD}", f"run --{WORD}", f"run study.toml {WORD}", f"run {WORD}", f"run study.toml --part {WORD}",
    f"info {WORD}", f"best maps.h5 --minimise {WORD}", f"best maps.h5 --minimise omega4_max --where {WORD}",
    f"best maps.h5 --minimise omega4_max --where {WORD}=1:2", f"plot maps.h5 {WORD}", f"convert maps.h5 --to {WORD}",
    f"convert maps.h5 --to x.nc --select {WORD}=1", f"tolerance maps.h5 {WORD}=1", f"draw planar_4r {WORD}=1",
    f"draw planar_4r a1={WORD}", f"new {WORD}", f"quantities {WORD}", f"mechanisms {WORD}",
)  # fmt: skip


@pytest.fixture(scope="module")
def swept_maps(tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(tmp_path_factory.mktemp("words"))
        with sweep_4r(DESIGN | {"a1": [0.3, 0.4]}, ["omega4_max"], to="maps.h5") as maps:
            yield maps


@pytest.mark.sample(5)
@pytest.mark.parametrize("line", LINES, ids=lambda line: line.replace(WORD, "WORD"))
def test_a_long_word_is_shortened_on_the_command_line(line, swept_maps):
    written(GOOD)
    found = CliRunner().invoke(app, line.split())
    assert found.exit_code == 2
    assert WORD[:8] in found.output
    assert len(found.output) < 600


def test_at_least_one_objective_is_named(swept_maps):
    for none in ([], ()):
        for call in (
            lambda none=none: fl.best(swept_maps, minimise=none),
            lambda none=none: fl.search("planar_4r", DESIGN | {"a1": [0.3, 0.4]}, minimise=none),
        ):
            with pytest.raises(fl.InputError, match="no objective; write minimise="):
                call()


IMPORTS = """
import sys

import fastlink.engine.sweep, fastlink.space.samplers, fastlink.app.report
import fastlink as fl

others = ("focal", "hart", "minkowski", "planar", "__version__")
assert all(callable(getattr(fl, name)) for name in fl.__all__ if name not in others)
assert fl.table({"a1": [1.0]}).size == 1

import fastlink.planar
from fastlink.hart import integer_designs
from fastlink.focal import T_deviation as deviation
from fastlink.minkowski import *
from fastlink import errors, planar

assert fl.planar is planar is fastlink.planar is sys.modules["fastlink.planar"]
assert fl.planar.cognates is sys.modules["fastlink.planar"].cognates
assert fl.focal.T_deviation is deviation
assert sextic is fl.minkowski.sextic
assert errors is sys.modules["fastlink.errors"]
assert not hasattr(fl, "nothing_like_it")
"""


def test_functions_of_a_mechanism_are_imported_by_their_public_names():
    done = subprocess.run([sys.executable, "-c", IMPORTS], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")


def test_misspelt_and_earlier_names_are_answered_with_what_is_there():
    with pytest.raises(AttributeError, match=r"no attribute 'swep'; did you mean 'sweep'\?"):
        fl.swep  # noqa: B018
    with pytest.raises(ImportError, match=r"cannot import 'swep' .*; did you mean 'sweep'\?"):
        from fastlink import swep  # noqa: F401
    function = fl.function("planar_4r", ["a2"], ["grashof_class"], a1=0.4, a3=0.8, a4=1.0)
    with pytest.raises(AttributeError, match=r"'outputs'; did you mean 'quantities'\?"):
        function.outputs  # noqa: B018


#: The names of 0.2 that are gone, and what stands in their place.
GONE = {
    "accuracy_table": "fl.accuracy(study).fastlink.summary()",
    "finite": "maps.fastlink.finite()",
    "plot_designs": "fl.plot(maps, names)",
    "plot_front": "fl.plot(maps, minimise=..., maximise=...)",
    "plot_map": "fl.plot(maps, name)",
    "run_study": "fl.run(study)",
    "summary": "maps.fastlink.summary()",
    # what others call it
    "optimise": "fl.search(...)",
    "load": "fl.open(path)",
    "read": "fl.open(path)",
    "simulate": "fl.sweep(...)",
    "solve": "fl.sweep(...)",
    "pareto": "fl.search(...)",
    "animate": "fl.draw(",
}


@pytest.mark.parametrize("name", GONE)
def test_a_name_of_an_earlier_version_is_answered_with_what_replaces_it(name):
    remedy = re.escape(f"; write {GONE[name]}")
    with pytest.raises(AttributeError, match=remedy):
        getattr(fl, name)
    with pytest.raises(ImportError, match=remedy):
        exec(f"from fastlink import {name}")
    assert name not in dir(fl)


def test_every_door_takes_branch_1_unless_it_is_told(tmp_path):
    space = fl.grid(DESIGN | {"a2": [1.1, 1.2]})
    study = tmp_path / "study.toml"
    text = 'mechanism = "planar_4r"\nquantities = ["omega4_max"]\n[design]\na2 = {values = [1.1, 1.2]}\n'
    study.write_text(text + "a1 = 0.4\na3 = 0.8\na4 = 1.0\nomega1 = 25.0\n")
    maps = fl.sweep("planar_4r", space, ["omega4_max"])
    with fl.run(study, to=tmp_path / "maps.h5") as run:
        assert (maps.branch, run.branch) == (1, 1)
        assert maps.omega4_max.dims == run.omega4_max.dims == ("a2",)
    assert fl.search("planar_4r", space, minimise="omega4_max").branch == 1
    for call in (fl.sweep, fl.search, fl.function, fl.evaluate, fl.focal.cubic, fl.planar.curve_length):
        assert inspect.signature(call).parameters["branch"].default == 1
    assert "2 designs, 1 branch" in fl.explain("planar_4r", space, ["omega4_max"]).title
    assert fl.planar.rate_extrema(space, pair="14").branch == 1


def test_a_branch_that_a_result_lacks_is_no_condition_to_be_missed():
    """A map of branch 1 gave its own designs as the nearest, and a search ended in a KeyError."""
    space = fl.grid(DESIGN | {"a2": [1.1, 1.2]})
    maps = fl.sweep("planar_4r", space, ["omega4_max"])
    both = sweep_4r(space, ["omega4_max"])
    with refused("where: branch: here is branch 1 alone", "compute both branches"):
        fl.best(maps, minimise="omega4_max", where={"branch": 2})
    with refused("where: branch: here is branch 1 alone", "compute both branches"):
        fl.search("planar_4r", space, minimise="omega4_max", where={"branch": (2, None)})
    for where in ({"branch": 1}, {"branch": (1, 2)}):
        found = fl.search("planar_4r", space, minimise="omega4_max", where=where, refine=False)
        assert (found.sizes["design"], found.branch) == (2, 1)
    assert fl.best(both, minimise="omega4_max", where={"branch": 2}).branch.values.tolist() == [2, 2]
    with refused("branch is 2", "the map is of branch 1 alone: leave it out"):
        fl.plot(maps, "omega4_max", branch=2)


MISLEADING = {
    "fl.search('planar_4r', DESIGN, minimise='omega4_max', samples=9)": ("samples", "fl.sobol(n, "),
    "fl.sweep('planar_4r', DESIGN, ['omega4'], position=9)": ("position", "did you mean 'positions'?"),
    "fl.sweep('planar_4r', DESIGN, ['omega4'], mode=2)": ("mode", "did you mean 'branch'?"),
    "fl.best(maps, minimise='omega4_max', where='a1 < 0.5')": ("where: 'a1 < 0.5'", "{'a1': ':0.5'}"),
    "fl.plot(maps.isel(branch=0), 'a2', kind='cumulative')": ("it is one value", "has several"),
    "fl.sweep('planar_4r', written(GOOD), ['swing'])": ("is a study", "fastlink.run('study.toml')"),
}


@pytest.mark.parametrize("call", MISLEADING)
def test_an_answer_names_what_is_meant(swept_maps, call):
    with refused(*MISLEADING[call]):
        eval(call, globals() | {"maps": swept_maps})


def test_the_accessors_answer_as_the_module_does(swept_maps):
    for lacking, remedy in (
        (lambda: swept_maps.fastlink.summry, "did you mean 'summary'"),
        (lambda: swept_maps.omega4_max.fastlink.summary, "known: convert, degrees, finite, status_is"),
        (lambda: swept_maps.fastlink.plot.designs, "write maps.fastlink.plot(names, ...)"),
    ):
        with pytest.raises(AttributeError, match=re.escape(remedy)):
            lacking()


# == Calls that a user who is in a hurry makes, of each class one: the answer says what to write, and that is right

ROW = "0.4,1.2,0.8,1.0"
CALLS = {
    'fl.sweep("planar_4r", DESIGN, "swing, omega4_max")': "write a list: ['swing', 'omega4_max']",
    'fl.sweep("planar_4r", DESIGN, ["swing"], units="mm")': "write units in names, such as theta1_deg",
    'fl.sweep("planar_4r", DESIGN, ["a1_max"])': "a1 is an input, which does not change over the cycle",
    'fl.sweep("hart", DESIGN, ["stroke"])': "known to planar_4r; known: m, n, d, kappa",
    'fl.sweep("planar_4r", {"a": 0.4, "b": 1.2}, ["swing"])': "known to minkowski_4r and focal; known: a1, a2, a3, a4",
    'fl.sweep("planar_4r", DESIGN, ["swing"], a1=0.5)': "give it with the design",
    'fl.sweep("planar_4r", DESIGN | {"swing": 1.0}, ["omega4_max"], where={"swing": 1})': "known: allow_invalid",
    'fl.sweep("planar_4r", DESIGN, ["P_straigthness"])': "did you mean 'P_straightness'?",
    'fl.evaluate("planar_4r", ["theta4"], **DESIGN, theta1=1.0, swing=2.0)': "is a quantity, not an input; leave it",
    'fl.evaluate("planar_4r", ["theta4"], **DESIGN, angle=1.0)': "whose input is theta1; write theta1",
    'fl.grid(a1=0.4, a2="1.0:1.4:11")': "write numpy.linspace(1.0, 1.4, 11)",
    'fl.sobol(64, a1="0.1:0.5")': "write (lo, hi)",
    'table("a1 a2 a3 a4\\n0.4 1.2 0.8 1.0")': "separate columns by commas, semicolons or tabs",
    'table(f"a1,a2,a3,a4\\n{ROW}\\n0.4,long,0.8,1.0")': "or, if it is no input, pass keep=['a2']",
    'fl.search("planar_4r", SPACE, objective="swing")': "did you mean 'minimise'?",
    'fl.search("planar_4r", SPACE, minimise="status")': "is a code; select by where={'status': 'MEANING'}",
    'fl.best(maps, minimise="a2_mm")': "write 'a2'",
    'fl.best(maps, minimise="a1")': "is the same for all designs; rank by one that differs: swing",
    'fl.best(maps, minimise="swing", to="best.csv")': "write fl.convert(found, to=...)",
    'fl.best(maps, minimise="swing", where={"swing": 1.0, "swing_deg": 60.0})': "swing is given too; write one of them",
    'fl.best(maps, minimise="swing", n=3)': "did you mean 'top'?",
    'fl.best(maps.isel(a2=[]), minimise="swing")': "there is no row",
    'fl.function("planar_4r", ["a1"], ["swing"], a2="1.2 m", a3=0.8, a4=1.0)': "write a2=1.2",
    'fl.function("planar_4r", ["a1"], ["swing"], a2=1.2, a3=0.8, a4=1.0)(["400 mm"])': "the function of a1_mm, and",
    'fl.tolerance(maps, {"a1": 1e-4})': "write tolerances by name, such as a1=1e-4",
    'fl.draw(maps, at={"a1": 0.4})': "known: a2",
    'fl.draw("planar_4r", DESIGN | {"a1": [0, 4]})': "write one number, with a point",
    'fl.plot(maps, "swing", panels="a1")': "known: a2",
    'fl.plot(maps, "swing", at={"a1": 0.4})': "known: a2",
    'maps.fastlink.counts("swing")': "name a code, such as status",
    'fl.quantities("planar_4r", "torque")': "or find='torque'",
    'fl.explain("planar_4r")': "is a mechanism, not a study",
    'fl.check("designs.csv")': "does not begin as such a file does",
    'fl.convert(maps, to="out")': "has no ending; write one of .h5",
}
LINES_CARELESS = {
    "draw planar_4r a1=0,4 a2=1.2 a3=0.8 a4=1.0": "write one number, with a point",
    "quantities planar_4r torque": "write words as --find WORD",
    "best maps.h5 swing": "write objectives as --minimise NAME",
}


@pytest.fixture(scope="module")
def names(tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(tmp_path_factory.mktemp("careless"))
        maps = fl.sweep("planar_4r", fl.grid(DESIGN | {"a2": [1.1, 1.2, 1.3]}), ["swing"])

        def table(text):
            with open("designs.csv", "w") as file:
                file.write(text)
            return fl.table("designs.csv")

        table(f"a1,a2,a3,a4\n{ROW}")
        space = fl.sobol(64, DESIGN | {"a1": (0.1, 0.4)})
        yield {"fl": fl, "maps": maps, "table": table, "DESIGN": DESIGN, "SPACE": space, "ROW": ROW}


@pytest.mark.parametrize("call", CALLS)
def test_a_careless_call_is_told_what_to_write(call, names):
    with pytest.raises(fl.InputError, match=re.escape(CALLS[call])):
        eval(call, names)


@pytest.mark.parametrize("line", LINES_CARELESS)
def test_a_careless_command_is_told_what_to_write(line):
    assert LINES_CARELESS[line] in " ".join(CliRunner().invoke(app, line.split()).output.split())


def test_what_can_hardly_be_meant_is_remarked_on(names):
    bars = fl.round_bar(0.01, 7750.0)  # the wrong way round
    with pytest.warns(fl.InputWarning, match=r"radius is 7750 m, of bars up to 1.2 m long"):
        fl.sweep("planar_4r", DESIGN, ["shaking_force_max"], links=bars)
    with pytest.warns(
        fl.InputWarning, match="a1 is 5 m, more than a1 itself; if it is in per cent, write a1='5 %'"
    ):
        fl.tolerance(names["maps"], a1=5)


def test_units_are_taken_wherever_inputs_are_named(names):
    assert names["table"]("a1 mm,a2 [mm],a3_mm,a4\n400,1200,800,1.0").size == 1
    ways = {"minimise": "swing", "top": 1}
    best = fl.best(names["maps"], refine=["a2_mm"], **ways)
    assert best.a2.item() == fl.best(names["maps"], refine=["a2"], **ways).a2.item()
    assert fl.search("planar_4r", names["SPACE"], refine=["a1_mm"], **ways).sizes["design"] == 1


def test_a_study_of_a_search_needs_no_table_of_designs(folder):
    text = 'mechanism = "slider_crank"\n[search]\nminimise = "stroke"\nsamples = 64\n'
    study = written(f"{text}bounds = {{r = [0.1, 0.2], l = [0.4, 0.6], e = [0.0, 0.1]}}")
    with fl.run(study) as found:
        assert found.attrs["searched_designs"] == 64
