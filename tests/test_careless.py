"""Calls that a user who is in a hurry makes, of each class one: the answer says what to write, and that is right."""

import re

import pytest
from typer.testing import CliRunner

import fastlink as fl
from fastlink.app.cli import app

DESIGN = dict(a1=0.4, a2=1.2, a3=0.8, a4=1.0, omega1=25.0)
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
LINES = {
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


@pytest.mark.parametrize("line", LINES)
def test_a_careless_command_is_told_what_to_write(line):
    assert LINES[line] in " ".join(CliRunner().invoke(app, line.split()).output.split())


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


def test_a_study_of_a_search_needs_no_table_of_designs(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    lines = (
        "[search]",
        'minimise = "stroke"',
        "samples = 64",
        "[search.bounds]",
        "r = [0.1, 0.2]",
        "l = [0.4, 0.6]",
    )
    (tmp_path / "s.toml").write_text("\n".join(('mechanism = "slider_crank"', *lines, "e = [0.0, 0.1]")))
    with fl.run("s.toml") as found:
        assert found.attrs["searched_designs"] == 64


def test_the_command_alone_prints_its_help_in_lines():
    assert "\n  run " in CliRunner().invoke(app, []).output
