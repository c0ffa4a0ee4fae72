"""Study files: one clear line for each thing that is wrong with them."""

from pathlib import Path

import pytest

import fastlink as fl
from fastlink.study import run_study
from fastlink.study_schema import MOST_LINES
from study_files import BARE, GOOD, LENGTHS, written


def refused(text, **options):
    """Return the lines with which a study is refused, without the name of the file."""
    path = written(text)
    with pytest.raises(fl.InputError) as caught:
        run_study(path, **options)
    lines = str(caught.value).splitlines()
    assert all(line.startswith("study.toml: ") for line in lines)
    return [line.removeprefix("study.toml: ") for line in lines]


AXIS = "write a finite number, or {linspace = [lo, hi, n]}, {geomspace = [lo, hi, n]} or {values = [...]}"
THREE = "write [lo, hi, n] with finite lo and hi and a whole number n from 1 to 10000000"
SIGNED = THREE.replace("hi and", "hi of one sign, neither 0, and")


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        # misspelt keys, in each table
        ("mechanism", "mechanim", "mechanim is no key here; did you mean 'mechanism'?"),
        ("[design]", "[desing]", "desing is no key here; did you mean 'design'?"),
        ("linspace", "linspce", "design.a2.linspce is no key here; did you mean 'linspace'?"),
        ("theta1", "teta1", "cycle.teta1 is no option, and the input is theta1; did you mean 'theta1'?"),
        ("[cycle]", "[output]\nfiel = 'x'\n[cycle]", "output.fiel is no key here; did you mean 'file'?"),
        (
            "a4 = 1",
            "a4 = 1\nomega_1 = 2",
            "design.omega_1: input 'omega_1' is unknown to planar_4r; did you mean 'omega1'?",
        ),
        (
            "[cycle]",
            "[links]\nmodel = 'round_bar'\nradus = 1\n[cycle]",
            "links.radus: round_bar has no 'radus'; did you mean 'radius'?",
        ),
        (
            "a2 = {linspace = [1.0, 1.4, 3]}",
            "sobool = {n = 4, a2 = [1, 2]}",
            "design.sobool is no key here; did you mean 'sobol'?",
        ),
        (
            "theta1 = 8",
            "theta1 = {geomspace = [1, 2, 3]}",
            "cycle.theta1.geomspace is no key here; did you mean 'linspace'?",
        ),
        # unknown names
        (
            '"planar_4r"',
            '"planar_4"',
            "mechanism: mechanism 'planar_4' is unknown; did you mean 'planar_4r'?",
        ),
        (
            "omega4_max",
            "omga4_max",
            "quantities[0]: quantity 'omga4_max' is unknown to planar_4r; did you mean 'omega4_max'?",
        ),
        (
            "[cycle]",
            "[links]\nmodel = 'round_ba'\n[cycle]",
            "links.model: model 'round_ba' is unknown; did you mean 'round_bar'?",
        ),
        (
            "[cycle]",
            "[cycle]\nsolver = 'dens'",
            "cycle.solver: solver 'dens' is unknown; did you mean 'dense'?",
        ),
        (
            "[cycle]",
            "[cycle]\nbranch = 3",
            "cycle.branch: 3 is no assembly mode of planar_4r; write some of 1, 2",
        ),
        # wrong types
        ('"planar_4r"', "4", "mechanism is 4; write a text that is not empty"),
        (
            '["omega4_max", "theta4"]',
            '"theta4"',
            "quantities is 'theta4'; write a list of names, such as [\"omega4_max\"]",
        ),
        ('"theta4"]', "4]", "quantities[1] is 4; write the name of a quantity as text"),
        ("a1 = 0.4", 'a1 = "0.4"', f"design.a1 is '0.4'; {AXIS}"),
        ("a1 = 0.4", "a1 = [0.4, 0.5]", f"design.a1 is [0.4, 0.5]; {AXIS}"),
        ("a1 = 0.4", "a1 = true", f"design.a1 is True; {AXIS}"),
        ("a1 = 0.4", "a1 = nan", f"design.a1 is nan; {AXIS}"),
        ("a1 = 0.4", "a1 = 1e999", f"design.a1 is inf; {AXIS}"),
        ("1.4, 3]", "1.4, 3.0]", f"design.a2.linspace is [1.0, 1.4, 3.0]; {THREE}"),
        ("1.4, 3]", "1.4]", f"design.a2.linspace is [1.0, 1.4]; {THREE}"),
        ("[0.8, 0.7]", '[0.8, "x"]', "design.a3.values[1] is 'x'; write a finite number"),
        (
            "theta1 = 8",
            "theta1 = 8.5",
            "cycle.theta1 is 8.5; write a number of angles from 1 to 10000000, {linspace = [lo, hi, n]} or "
            "{values = [...]} in rad",
        ),
        (
            "[cycle]",
            "[cycle]\nbranch = 'left'",
            "cycle.branch is 'left'; write assembly modes, such as [1, 2]",
        ),
        ("[cycle]", "[output]\noverwrite = 1\n[cycle]", "output.overwrite is 1; write true or false"),
        (
            "[cycle]",
            "[links]\nmodel = 'round_bar'\ndensity = 1\nradius = {values = [1]}\n[cycle]",
            "links.radius is {'values': [1]}; write one finite number; to sweep it, make it an axis in [design]",
        ),
        # empty or impossible values
        ('["omega4_max", "theta4"]', "[]", 'quantities is []; write a list of names, such as ["omega4_max"]'),
        ("1.4, 3]", "1.4, 0]", f"design.a2.linspace is [1.0, 1.4, 0]; {THREE}"),
        ("1.4, 3]", "1.4, 10000001]", f"design.a2.linspace is [1.0, 1.4, 10000001]; {THREE}"),
        ("[0.8, 0.7]", "[]", "design.a3.values is []; write a list of one or more finite numbers"),
        (
            "{values = [0.8, 0.7]}",
            "{}",
            "design.a3 has no key; write exactly one of geomspace, linspace, values",
        ),
        (
            "{values = [0.8, 0.7]}",
            "{values = [1], linspace = [1, 2, 3]}",
            "design.a3 has linspace and values; write exactly one of geomspace, linspace, values",
        ),
        (
            "linspace = [1.0",
            "geomspace = [-1.0",
            "design.a2: geomspace runs from -1.0 to 1.4; write ends of one sign, neither 0",
        ),
        ("linspace = [1.0", "geomspace = [inf", f"design.a2.geomspace is [inf, 1.4, 3]; {SIGNED}"),
        ("[0.8, 0.7]", "[0.8, 0.8]", "design.a3: axis a3 holds 0.8 twice (at 0 and 1); give each value once"),
        (
            "a1 = 0.4",
            "a1 = -0.4",
            "design.a1 is -0.4; length of the input crank OA: write a finite number greater than 0",
        ),
        (
            "[0.8, 0.7]",
            "[0.8, 0.0]",
            "design.a3[1] is 0.0; length of the output link DB: write a finite number greater than 0",
        ),
        ("[cycle]", "[cycle]\nbranch = []", "cycle.branch: none is given; write some of 1, 2"),
        ("[cycle]", "[cycle]\nbranch = [1, 1]", "cycle.branch: 1 is given twice; write each once"),
        (
            "theta1 = 8",
            "theta1 = {values = [1, 1]}",
            "cycle.theta1: 1.0 stands twice (at 0 and 1); give each angle once",
        ),
        ('"theta4"]', '"omega4_max"]', "quantities[1]: 'omega4_max' is asked for twice; name it once"),
        # missing
        (
            'quantities = ["omega4_max", "theta4"]',
            "",
            'quantities is missing; write quantities = ["omega4_max"]',
        ),
        (
            "omega1 = 25.0",
            "",
            "design.omega1 is missing (angular velocity of the crank, constant [rad s-1]); omega4_max depends on "
            "it: add it",
        ),
        ("[cycle]", "[links]\ndensity = 1.0\n[cycle]", 'links.model is missing; write model = "round_bar"'),
    ],
)
def test_bad_input(folder, old, new, message):
    assert old in GOOD
    assert refused(GOOD.replace(old, new, 1)) == [message]


@pytest.mark.parametrize(
    ("design", "message"),
    [
        ("", "design is missing; write a table [design] with a number or an axis for each input"),
        ("[design]\n", "design is empty; write a number or an axis for each input"),
        ("[[design]]\na1 = 1\n", "design is [{'a1': 1}]; write a table of keys, such as [design]"),
        (
            "[design]\nsobol = {n = 4, a1 = [1, 2]}\na2 = {values = [1]}\n",
            "design has sobol and axes (a2); write one of them, beside constants",
        ),
        (
            "[design]\nsobol = {n = 4, a1 = [1, 2]}\nlatin_hypercube = {n = 4, a1 = [1, 2]}\n",
            "design has sobol and latin_hypercube; write one of them, beside constants",
        ),
        (
            "[design]\nsobol = {n = 0, a1 = [1, 2]}\n",
            "design.sobol: n is 0; write an integer from 1 to 1073741824",
        ),
        (
            "[design]\nsobol = {a1 = [1, 2]}\n",
            "design.sobol.n is missing; write n = 1024, the number of designs",
        ),
        (
            "[design]\nsobol = {n = 4}\n",
            "design.sobol: no input has a range; write at least one as NAME=[lo, hi], or use grid",
        ),
        (
            "[design]\nsobol = {n = 4, a1 = [2, 1]}\n",
            "design.sobol: a1 runs from 2.0 to 1.0; write [lo, hi] with lo < hi",
        ),
        (
            "[design]\nsobol = {n = 4, a1 = [1, 2, 3]}\n",
            "design.sobol.a1 is [1, 2, 3]; write [lo, hi] with finite lo < hi, or one finite number",
        ),
        (
            "[design]\nsobol = {n = 4, a1 = [1, 2]}\na1 = 3\n",
            "design.sobol: gives a1, which stands in [design] too; write it once",
        ),
        (
            f"[design]\n{LENGTHS}sobol = {{n = 4, omga1 = [1, 2]}}\n",
            "design.sobol.omga1: input 'omga1' is unknown to planar_4r; did you mean 'omega1'?",
        ),
        ("[design]\ntable = 3\n", 'design.table is 3; write the path of a CSV file, such as "designs.csv"'),
        (
            "[design]\ntable = 'absent.csv'\n",
            "design.table: cannot read absent.csv: No such file or directory; give the path of a CSV file",
        ),
        (
            "[design]\ntable = 'holes.csv'\n",
            "design.table: row 1 (line 3) of column a2 in holes.csv is empty; write a finite number",
        ),
        (
            f"[design]\n{LENGTHS}radius = 0.01\n",
            "design.radius: 'radius' belongs to links of model 'round_bar'; choose that model, or leave it out",
        ),
    ],
)
def test_bad_designs(folder, design, message):
    Path("holes.csv").write_text("a1,a2\n1,2\n1,\n")
    assert refused(BARE + design) == [message]


def test_links_that_lack_a_value(folder):
    text = BARE.replace("theta4", "T41") + f"[design]\nomega1 = 1\n{LENGTHS}[links]\nmodel = 'round_bar'\n"
    assert refused(text) == [
        "links.density is missing (density of the round bars [kg m-3]); T41 depends on it: add it",
        "links.radius is missing (radius of the round bars [m]); T41 depends on it: add it",
    ]


def test_every_missing_input_is_named_once(folder):
    lines = refused(BARE.replace('["theta4"]', '["omega4", "alpha4"]') + "[design]\na1 = 1.0\na4 = 2.0\n")
    assert [line.split(" ")[0] for line in lines] == ["design.a2", "design.a3", "design.omega1"]


def test_several_problems_are_a_line_each(folder):
    text = (
        GOOD.replace("a1 = 0.4", "a1 = -1")
        .replace("theta1 = 8", "theta1 = 8\nbranch = 7")
        .replace("ga4", "ga")
    )
    keys = [line.split(" ")[0].rstrip(":") for line in refused(text)]
    assert sorted(keys) == ["cycle.branch", "design.a1", "quantities[0]"]


def test_very_many_problems_are_counted(folder):
    names = ", ".join(f'"wrong{k}"' for k in range(MOST_LINES + 5))
    lines = refused(GOOD.replace('"omega4_max", "theta4"', names))
    assert len(lines) == MOST_LINES + 1
    assert lines[-1] == "and 5 more problems"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (GOOD.replace("a1 = 0.4", "a1 = "), "is no TOML: Invalid value (at line 5, column 6)"),
        (GOOD + "a1\n", "is no TOML: Expected '=' after a key in a key/value pair (at line 12, column 3)"),
    ],
)
def test_toml_faults_have_their_line(folder, text, message):
    with pytest.raises(fl.InputError) as caught:
        run_study(written(text))
    assert str(caught.value) == f"study.toml: {message}"


def test_files_that_cannot_be_read(folder):
    with pytest.raises(fl.InputError, match=r"^absent\.toml: cannot be read \(No such file"):
        run_study("absent.toml")
    with pytest.raises(fl.InputError, match=r"cannot be read .*; give the path of a study file"):
        run_study(folder)
    Path("latin.toml").write_bytes("# Länge".encode("latin-1"))
    with pytest.raises(fl.InputError, match=r"^latin\.toml: is no UTF-8 text .* at byte 3"):
        run_study("latin.toml")


def test_output_that_cannot_be_written(folder):
    assert refused(GOOD + '[output]\nfile = "no/map.h5"\n') == [
        f"output.file: {folder / 'no/map.h5'}: there is no folder {folder / 'no'}; create it or choose another"
    ]
    assert refused(GOOD, to="no/map.h5")[0].startswith(f"output: {folder / 'no/map.h5'}: there is no folder")
    assert refused(GOOD + '[output]\nfile = ""\n') == ["output.file is ''; write a text that is not empty"]


@pytest.mark.parametrize("name", ["study.toml", "designs.csv"])
def test_a_study_never_replaces_what_it_is_read_from(folder, name):
    Path("designs.csv").write_text("a1,a2\n0.4,1.2\n")
    text = f'{BARE}[design]\ntable = "designs.csv"\na3 = 0.8\na4 = 1.0\n'
    assert refused(text, to=name, overwrite=True) == [
        f"output: {name}: the study is read from that file; choose another name"
    ]
    assert Path("designs.csv").read_text() == "a1,a2\n0.4,1.2\n"


def test_what_only_the_sweep_can_refuse_names_the_study(folder):
    assert refused(GOOD, threads=0) == ["threads: 0; write a whole number of at least 1"]
    assert not Path("study.h5").exists()


def test_an_existing_file_is_replaced_when_the_study_or_the_caller_says_so(folder):
    path = written(GOOD)
    run_study(path).close()
    assert refused(GOOD) == [
        f"output.file: {folder / 'study.h5'}: the file exists; choose another name or set overwrite"
    ]
    run_study(path, overwrite=True).close()
    run_study(written(GOOD + "[output]\noverwrite = true\n")).close()
