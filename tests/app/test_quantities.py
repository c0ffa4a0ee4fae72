"""The tables of quantities: what is in them, and that the documentation is what they say."""

import re
from importlib.resources import files

import pytest
from tests.support.refusals import refused
from tests.support.registry import ENTRIES
from tests.support.sweeps import sweep_4r
from typer.testing import CliRunner

import fastlink as fl
from fastlink.app.cli import app
from fastlink.app.report import GROUPS, Quantity, QuantityList, document
from fastlink.engine.labels import variables
from fastlink.engine.resolve import resolve
from fastlink.mechanisms import NAMES
from fastlink.mechanisms import catalogue as find_catalogue
from fastlink.plan.query import REDUCTIONS


def results(mechanism):
    """What a sweep says of every public quantity of a mechanism, over a table; nothing is compiled."""
    position = find_catalogue(mechanism).position.name
    entry = next(e for e in ENTRIES if (e.mechanism, e.input) == (mechanism, position) and e.moves)
    drawn = entry.drawn("random", 1, 4)
    angles = drawn.pop(position)
    drawn.pop("branch", None)
    names = [row.name for row in fl.quantities(mechanism)]
    resolved = resolve(mechanism, fl.table(drawn), names, angles=angles, branch=(1, 2))
    labelled = variables(resolved)
    return {variable.name: variable for variable in labelled}


@pytest.mark.filterwarnings("ignore:extremes are those of the 4 positions")
@pytest.mark.parametrize("mechanism", NAMES)
def test_every_public_quantity_is_listed_once_by_groups_and_as_the_result_says(mechanism):
    rows, found = fl.quantities(mechanism), results(mechanism)
    catalogue = find_catalogue(mechanism)
    most = catalogue.most_asked.split()
    assert [row.name for row in rows[: len(most)]] == most
    assert sorted(row.name for row in rows) == sorted({*catalogue.public, *most})
    order = [GROUPS.index(row.group) for row in rows]
    assert order == sorted(order)
    for row in rows:
        assert isinstance(row, Quantity)
        assert row.dims == found[row.name].dims
        labels = found[row.name].attrs
        title, _, remark = row.meaning.partition("; ")
        assert (row.units, title, remark, row.source) == (
            labels.get("units", "1"),
            labels["long_name"].replace("of 4 positions", "over the cycle"),
            labels.get("comment", ""),
            labels["references"],
        )


@pytest.mark.parametrize("entry", ENTRIES, ids=lambda entry: f"{entry.mechanism}-{entry.input}")
def test_a_title_fits_a_picture(entry):
    catalogue = find_catalogue(entry.mechanism, entry.input)
    labelled = (*catalogue.public.values(), *catalogue.known_inputs(catalogue.variant_inputs).values())
    assert {one.name: one.title for one in labelled if len(one.title) > 60} == {}


def test_the_table_shows_every_row():
    listed = fl.quantities("planar_4r")
    text = str(listed)
    assert isinstance(listed, QuantityList)
    assert repr(listed) == text
    lines = text.splitlines()
    assert [line[:-1] for line in lines if line[:-1] in GROUPS] == list(
        dict.fromkeys(r.group for r in listed)
    )
    assert lines[2].split() == ["name", "units", "dims", "meaning", "source"]
    for row in listed:
        (line,) = [line for line in lines if line.split("  ")[0] == row.name]
        assert f"({', '.join(row.dims)})" in line
    assert all(line == line.rstrip() for line in lines)


def test_the_inputs_are_a_table_of_their_own():
    listed = fl.quantities("planar_4r")
    rows = {given.name: given for given in listed.inputs}
    assert rows["a1"].allowed == "greater than 0"
    assert rows["omega1"].links == ""
    assert rows["m1"].links == "given by round_bar"
    assert rows["radius"].links == "of round_bar"
    assert rows["omega1"].units == "rad s-1"
    below = str(listed).split("Inputs;")[1]
    assert all(f"\n{name} " in below for name in rows)


def test_the_rules_of_names_stand_once_and_are_true():
    listed = fl.quantities("planar_4r")
    for text in (str(listed), listed.markdown()):
        for suffix in REDUCTIONS:
            noun = "POINT" if REDUCTIONS[suffix].of_path else "NAME"
            named = re.findall(rf"{noun}_{suffix}\b", text)  # that of an error has its own
            assert len(named) == (2 if REDUCTIONS[suffix].has_position else 1)
        assert len(re.findall(r"theta1_at_NAME_max\b", text)) == 1
    space = fl.grid(a1=[0.3, 0.4], a2=1.2, a3=0.8, a4=1.0, omega1=25.0)
    maps = sweep_4r(space, ["omega4_rms", "theta1_at_omega4_max"], theta1=4)
    assert maps["omega4_rms"].dims == maps["theta1_at_omega4_max"].dims == ("a1", "branch")
    assert maps["theta1_at_omega4_max"].attrs["units"] == "rad"


def test_internal_steps_come_after_the_public_quantities():
    public, every = fl.quantities("planar_4r"), fl.quantities("planar_4r", internal=True)
    assert list(every[: len(public)]) == list(public)
    further = {row.name: row.dims for row in every[len(public) :]}
    assert further["s1"] == ("design",)
    assert further["cos_theta1"] == ("theta1",)
    assert further["p"] == ("design", "theta1")
    assert further["AB_x"] == ("design", "branch", "theta1")


def test_markdown_tables_are_regular():
    for line in document().splitlines():
        if line.startswith("|"):
            assert line.replace("\\|", "").count("|") == 6


@pytest.mark.parametrize(
    "name", ["T41", "omega4_max", "theta1_at_omega4_max", "d_omega4_d_a1", "omega4_extrema"]
)
def test_a_row_by_name_says_what_a_sweep_gives_and_needs(name):
    row = fl.quantities("planar_4r")[name]
    inputs = {given: 1.0 for given in row.needs} | {"a1": 0.4, "a2": 1.1, "a3": 0.8}
    space = fl.table({k: [v] for k, v in inputs.items()})
    resolved = resolve("planar_4r", space, [name], branch=(1, 2))
    (variable, *_) = variables(resolved)
    assert (row.name, row.dims) == (name, variable.dims)
    assert row.units == variable.attrs["units"]
    assert row.meaning == variable.attrs["long_name"]
    for without in row.needs:
        space = fl.grid(**{k: v for k, v in inputs.items() if k != without})
        with pytest.raises(fl.InputError, match=rf"\b{without} is missing"):
            resolve("planar_4r", space, [name], branch=(1, 2))


def test_unknown_quantities_and_words_to_find_are_refused():
    with refused("'mu'", "transmission_angle"):
        fl.quantities("planar_4r")["mu"]
    with refused("'torque'", "find='torque'"):
        fl.quantities("torque")
    with refused("'planar4r'", "'planar_4r'"):
        fl.quantities("planar4r")


def test_quantities_are_found_by_what_they_mean_in_all_mechanisms():
    found = fl.quantities("planar_4r", find="torque")
    assert found[0].name == "T41"
    assert found.inputs[0].name == "T_load"
    assert "Driving torque" in str(found)
    assert fl.quantities("planar_4r", find="peak torque")[0].name == "T41_peak"
    found = fl.quantities(find="piston")
    assert {row.mechanism for row in found} == {"slider_crank"}
    assert found.mechanism == ""
    assert "slider_crank  slider_velocity" in str(found)
    assert "<td>slider_velocity</td>" in found._repr_html_()
    assert "Nothing" in str(fl.quantities(find="xyzzy"))


@pytest.mark.parametrize("options", [{}, {"find": ""}, {"find": 3}, {"mechanism": "planar_4r", "find": " "}])
def test_what_to_list_or_find_is_a_word(options):
    with refused("find" if options else "mechanism", "torque"):
        fl.quantities(**options)


def test_the_source_of_a_quantity_is_its_formula_and_where_it_stands():
    done = CliRunner().invoke(app, ["quantities", "planar_4r", "--find", "omega4", "--source"])
    place, head, formula, *_ = done.output.splitlines()
    sheet, line = re.fullmatch(r"(\w+\.facts), line (\d+):", place).groups()
    text = (
        files("fastlink").joinpath("mechanisms", "planar_4r", sheet).read_text(encoding="utf-8").splitlines()
    )
    assert text[int(line) - 1] == head
    assert formula in text[int(line) :][:4]
    assert fl.quantities("planar_4r", find="T41_peak").formulas().count("\nT41 [N m]") == 1
    assert fl.quantities("planar_4r", internal=True).formulas().count(".facts, line") > 300
