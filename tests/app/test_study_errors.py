"""Study files: one clear line for each thing that is wrong with them."""

from pathlib import Path

import h5py
import pytest
from tests.support.four_bar import sweep_4r
from tests.support.study_files import BARE, GOOD, LENGTHS, written
from typer.testing import CliRunner

import fastlink as fl
from fastlink.app.cli import app
from fastlink.errors import MOST_LINES


def refused(text, **options):
    """Return the lines with which a study is refused, without the name of the file."""
    path = written(text)
    with pytest.raises(fl.InputError) as caught:
        fl.run(path, **options)
    lines = str(caught.value).splitlines()
    assert all(line.startswith("study.toml: ") for line in lines)
    return [line.removeprefix("study.toml: ") for line in lines]


def assert_problem(text, key, remedy):
    """Assert that one problem of a study is told: at its key, with its remedy."""
    (line,) = refused(text)
    assert line.split(" ")[0].rstrip(":") == key
    assert remedy in line.partition("; ")[2]
    assert not any(word in line for word in ("numpy", "allow_invalid=True", "(lo, hi)"))


NUMBER = "write a finite number, or {linspace = [lo, hi, n]},"
LINSPACE = "write [lo, hi, n] with finite lo and hi and a whole number"
ONE_SIGN = "write [lo, hi, n] with finite lo and hi of one sign,"
LIST = 'write a list of names, such as ["omega4_max"]'
BARS = "[links]\nmodel = 'round_bar'\n"


@pytest.mark.parametrize(
    ("old", "new", "key", "remedy"),
    [
        ("mechanism", "mechanim", "mechanim", "did you mean 'mechanism'?"),
        ("[design]", "[desing]", "desing", "did you mean 'design'?"),
        ("linspace", "linspce", "design.a2.linspce", "did you mean 'linspace'?"),
        ("theta1", "teta1", "cycle.teta1", "did you mean 'theta1'?"),
        ("[cycle]", "[output]\nfiel = 'x'\n[cycle]", "output.fiel", "did you mean 'file'?"),
        ("a4 = 1", "a4 = 1\nomega_1 = 2", "design.omega_1", "did you mean 'omega1'?"),
        ("[cycle]", f"{BARS}radus = 1\n[cycle]", "links.radus", "did you mean 'radius'?"),
        ("a2 = {linspace = [1.0, 1.4, 3]}", "sobool = {n = 4}", "design.sobool", "did you mean 'sobol'?"),
        ("theta1 = 8", "theta1 = {geomspace = [1]}", "cycle.theta1.geomspace", "did you mean 'linspace'?"),
        ('"planar_4r"', '"planar_4"', "mechanism", "did you mean 'planar_4r'?"),
        ("omega4_max", "omga4_max", "quantities[0]", "did you mean 'omega4_max'"),
        ("[cycle]", "[links]\nmodel = 'round_ba'\n[cycle]", "links.model", "did you mean 'round_bar'?"),
        ("[cycle]", "[links]\nmodel = 3\n[cycle]", "links.model", "write a text that is not empty"),
        ("[cycle]", "[cycle]\nsolver = 'dens'", "cycle.solver", "did you mean 'dense'?"),
        ("[cycle]", "[cycle]\nbranch = 3", "cycle.branch", "write some of 1, 2"),
        ('"planar_4r"', "4", "mechanism", "write a text that is not empty"),
        ('["omega4_max", "theta4"]', '"theta4"', "quantities", LIST),
        ('"theta4"]', "4]", "quantities[1]", "write the name of a quantity as text"),
        ("a1 = 0.4", 'a1 = "0.4"', "design.a1", NUMBER),
        ("a1 = 0.4", "a1 = 1e999", "design.a1", NUMBER),
        ("1.4, 3]", "1.4, 3.0]", "design.a2.linspace", LINSPACE),
        ("1.4, 3]", "1.4, 10000001]", "design.a2.linspace", LINSPACE),
        ("linspace = [1.0", "geomspace = [-1.0", "design.a2.geomspace", ONE_SIGN),
        ("[0.8, 0.7]", '[0.8, "x"]', "design.a3.values[1]", "write a finite number"),
        (
            "theta1 = 8",
            "theta1 = 8.5",
            "cycle.theta1",
            "write a number of angles from 1 to 10000000, {linspace =",
        ),
        ("[cycle]", "[cycle]\nbranch = 'left'", "cycle.branch", "2 (B to the left"),
        ("[cycle]", "[cycle]\nbranch = 'both'", "cycle.branch", "write branch = [1, 2]"),
        ("[cycle]", "[cycle]\nbranch = true", "cycle.branch", "write branches, such as [1, 2]"),
        ("[cycle]", "[unit]\nlength = 'mm'\n[cycle]", "unit", "did you mean 'units'?"),
        ("[cycle]", "[link]\nmodel = 'round_bar'\n[cycle]", "link", "did you mean 'links'?"),
        ("omega4_max", "omega4_maxx", "quantities[0]", "did you mean 'omega4_max'?"),
        ("a1 = 0.4", "a1 = '400 mm'", "design.a1", "write a1_mm=400"),
        ("[cycle]", "[output]\noverwrite = 1\n[cycle]", "output.overwrite", "write true or false"),
        ("[cycle]", f"{BARS}radius = {{values = [1]}}\n[cycle]", "links.radius", "make it an axis in"),
        ("[0.8, 0.7]", "[]", "design.a3.values", "write a list of one or more finite numbers"),
        ("{values = [0.8, 0.7]}", "{}", "design.a3", "write exactly one of geomspace, linspace, values"),
        ("values = [0.8", "linspace = [1, 2, 3], values = [0.8", "design.a3", "write exactly one of"),
        ("[0.8, 0.7]", "[0.8, 0.8]", "design.a3", "give each value once"),
        ("[0.8, 0.7]", "[0.8, 0.0]", "design.a3[1]", "write a finite number greater than 0"),
        ("[cycle]", "[cycle]\nbranch = [1, 1]", "cycle.branch", "write each once"),
        ("theta1 = 8", "theta1 = {values = [1, 1]}", "cycle.theta1", "give each position once"),
        ('"theta4"]', '"omega4_max"]', "quantities[1]", "name it once"),
        ('quantities = ["omega4_max", "theta4"]', "", "quantities", 'write quantities = ["omega4_max"]'),
        ("omega1 = 25.0", "", "design.omega1", "omega4_max depends on it: add it"),
        ("[cycle]", "[links]\ndensity = 1.0\n[cycle]", "links.model", 'write model = "round_bar"'),
    ],
)
def test_bad_input(folder, old, new, key, remedy):
    assert old in GOOD
    assert_problem(GOOD.replace(old, new, 1), key, remedy)


SOBOL = "sobol = {n = 4, a1 = [1, 2]}\n"


@pytest.mark.parametrize(
    ("design", "key", "remedy"),
    [
        ("", "design", "write a table [design] with a number or an axis for each"),
        ("[design]\n", "design", "write a number or an axis for each input"),
        ("[[design]]\na1 = 1\n", "design", "write a table of keys, such as [design]"),
        (
            "[design]\nsobol = {n = 4, a1 = [1, 2]}\na2 = {values = [1]}\n",
            "design",
            "write one of them, beside",
        ),
        (
            f"[design]\n{SOBOL}latin_hypercube = {{n = 4, a1 = [1, 2]}}\n",
            "design",
            "write one of them, beside",
        ),
        (
            "[design]\nsobol = {n = 0, a1 = [1, 2]}\n",
            "design.sobol.n",
            "an integer from 1 to 1125899906842624",
        ),
        ("[design]\nsobol = {a1 = [1, 2]}\n", "design.sobol.n", "write n = 1024, the number of designs"),
        ("[design]\nsobol = {n = 4}\n", "design.sobol", "write [lo, hi] for at least one, or use a grid"),
        ("[design]\nsobol = {n = 4, a1 = [2, 1]}\n", "design.sobol.a1", "write [lo, hi] with lo < hi"),
        (
            "[design]\nsobol = {n = 4, a1 = [1, 2, 3]}\n",
            "design.sobol.a1",
            "with finite lo < hi, or one finite",
        ),
        (f"[design]\n{SOBOL}a1 = 3\n", "design.sobol", "write it once"),
        (f"[design]\n{LENGTHS}sobol = {{n = 4, omga1 = [1, 2]}}\n", "design.sobol.omga1", "'omega1'?"),
        ("[design]\ntable = 3\n", "design.table", 'a CSV or Parquet file, such as "designs.csv"'),
        ("[design]\ntable = 'absent.csv'\n", "design.table", "give the path of a CSV file"),
        ("[design]\ntable = 'holes.csv'\n", "design.table", "write a finite number"),
        (f"[design]\n{LENGTHS}radius = 0.01\n", "design.radius", '[links] model = "round_bar"'),
    ],
)
def test_bad_designs(folder, design, key, remedy):
    Path("holes.csv").write_text("a1,a2\n1,2\n1,\n")
    assert_problem(BARE + design, key, remedy)


def test_links_that_lack_a_value(folder):
    text = BARE.replace("theta4", "T41") + f"[design]\nomega1 = 1\n{LENGTHS}[links]\nmodel = 'round_bar'\n"
    assert refused(text) == [
        "links.density is missing (density of the round bars [kg m-3]); T41 depends on it: add it",
        "links.radius is missing (radius of the round bars [m]); T41 depends on it: add it",
    ]


def test_very_many_problems_are_counted(folder):
    names = ", ".join(f'"wrong{k}"' for k in range(MOST_LINES + 5))
    lines = refused(GOOD.replace('"omega4_max", "theta4"', names))
    assert len(lines) == MOST_LINES + 1
    assert lines[-1] == "and 5 more problems"


def test_what_is_no_study_is_told_so(folder):
    sweep_4r(fl.grid(a1=0.4, a2=1.2, a3=0.8, a4=1.0), ["grashof_class"], to="map.h5").close()
    written(GOOD.replace("a1 = 0.4", "a1 = "), "value.toml")
    written(GOOD + "a1\n", "key.toml")
    for path, message in (
        ("value.toml", "value.toml: is not TOML: Invalid value (at line 5, column 6); "),
        (
            "key.toml",
            "key.toml: is not TOML: Expected '=' after a key in a key/value pair (at line 12, column 3); ",
        ),
        ("absent.toml", "absent.toml: cannot be read (No such file"),
        (folder, f"{folder}: is a folder, not a study; give the path of a study,"),
        ("map.h5", "map.h5: is a map, not a study; `fastlink info map.h5` shows it"),
    ):
        with pytest.raises(fl.InputError) as caught:
            fl.run(path)
        assert str(caught.value).startswith(message)


def of_the_caller(text, **options):
    """Return the error of what the study does not say, but its caller."""
    with pytest.raises(fl.InputError) as caught:
        fl.run(written(text), **options)
    return caught.value


def test_output_that_cannot_be_written(folder):
    (line,) = refused(GOOD + '[output]\nfile = "no/map.h5"\n')
    assert line.startswith("output.file: ")
    assert line.endswith("there is no folder " + f"{folder / 'no'}; create it or choose another")
    assert of_the_caller(GOOD, to="no/map.h5").where == ("to",)
    assert_problem(GOOD + '[output]\nfile = ""\n', "output.file", "write a text that is not empty")


@pytest.mark.parametrize("name", ["study.toml", "designs.csv"])
def test_a_study_never_replaces_what_it_is_read_from(folder, name):
    Path("designs.csv").write_text("a1,a2\n0.4,1.2\n")
    text = f'{BARE}[design]\ntable = "designs.csv"\na3 = 0.8\na4 = 1.0\n'
    error = of_the_caller(text, to=name, overwrite=True)
    assert (error.where, error.what) == (("to",), f"{name!r} is not the name of an HDF5 file")
    Path("link.h5").symlink_to(name)
    error = of_the_caller(text, to="link.h5", overwrite=True)
    assert (error.where, error.what) == (("to",), "link.h5 is a file that is read for it")
    assert Path("designs.csv").read_text() == "a1,a2\n0.4,1.2\n"


def test_what_the_caller_says_is_told_in_the_words_of_the_caller(folder):
    assert of_the_caller(GOOD, threads=0).where == ("threads",)
    assert of_the_caller(GOOD, verify=-1).where == ("verify",)
    assert not Path("study.h5").exists()


def test_an_existing_file_is_replaced_when_the_study_or_the_caller_says_so(folder):
    path = written(GOOD)
    fl.run(path).close()
    fl.run(path).close()  # the same again is up to date
    (line,) = refused(GOOD + "# and more\n")
    assert line.startswith("output.file: ")
    assert line.endswith("overwrite=True")
    fl.run(path, overwrite=True).close()
    fl.run(written(GOOD + "[output]\noverwrite = true\n")).close()


@pytest.mark.parametrize("search", ["", '[search]\nminimise = ["omega4_max"]\ntop = 1\n'])
def test_a_study_of_its_own_replaces_maps_alone(folder, search):
    text = GOOD + search + "[output]\noverwrite = true\n"
    with h5py.File("theirs.h5", "w") as file:
        file["measured"] = [1.0, 2.0]
    for other in (Path("theirs.h5").read_bytes(), b"", b"years of work"):
        Path("study.h5").write_bytes(other)
        (line,) = refused(text)
        assert line.startswith("output.file: ")
        assert "is no map" in line
        assert line.endswith("overwrite=True")
        assert Path("study.h5").read_bytes() == other
    done = CliRunner().invoke(app, ["run", "study.toml", "--quiet"])
    assert done.exit_code == 2
    assert done.output.endswith("or write --overwrite\n")
    fl.run(written(text), overwrite=True).close()
    fl.run(written(text + "# and more\n")).close()


def test_columns_of_a_table_are_kept(folder):
    Path("designs.csv").write_text("a2,part_no\n1.1,7\n1.2,8\n")
    rest = "a1 = 0.4\na3 = 0.8\na4 = 1.0\n"
    text = BARE + "[design]\n{}table = 'designs.csv'\n" + rest
    assert_problem(text.format(""), "design.table.part_no", 'keep = ["part_no"]')
    with fl.run(written(text.format("keep = ['part_no']\n"))) as maps:
        assert maps.part_no.values.tolist() == [7, 8]
    assert_problem(BARE + "[design]\nkeep = ['part_no']\na2 = 1.2\n" + rest, "design.keep", "table = ...")
    assert refused(text.format("keep = 7\n"))[0].startswith("design.keep is 7; write names of columns")
    assert (
        refused(text.format("keep = [7]\n"))[0] == "design.keep[0] is 7; write the name of a column as text"
    )


def test_an_input_called_as_a_parameter_of_a_sample(folder):
    text = """mechanism = "hart"
quantities = ["stroke"]
[design]
sobol = {n = 8, ranges = {n = [1.0, 2.0]}, m = [1.5, 2.5], d = 1.0, kappa = 0.5}
"""
    with fl.run(written(text)) as maps:
        assert (maps.n.dims, maps.attrs["design_n"]) == (("design",), 8)
        assert 1.0 <= maps.n.values.min() < maps.n.values.max() <= 2.0
