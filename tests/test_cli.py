"""The command line: what it prints, where, and how it ends."""

import io
import os
import re
import signal
import subprocess
import sys
import time
from importlib.metadata import version
from inspect import signature
from pathlib import Path

import pytest
from typer.core import TyperOption
from typer.main import get_command
from typer.testing import CliRunner

import fastlink as fl
from fastlink.app import study
from fastlink.app.cli import OTHER_NAMES, app
from fastlink.io.output_path import progress_bar
from fastlink.mechanisms import NAMES
from tests.support.refusals import assert_refusal
from tests.support.sweeps import sweep_4r

HEAVY = ["numba", "xarray", "h5py", "h5netcdf", "scipy"]
HEAVY += ["numpy", "pydantic", "matplotlib", "pandas", "mpmath"]
MAIN = [sys.executable, "-c", "from fastlink.app.cli import main; main()"]
STUDY = """
mechanism = "planar_4r"
quantities = ["omega4_max"]
[design]
a1 = 0.4
a2 = {linspace = [1.0, 1.4, 5]}
a3 = {linspace = [0.6, 1.0, 4]}
a4 = 1.0
omega1 = 25.0
[cycle]
branch = [1, 2]
theta1 = 36
"""


@pytest.fixture
def folder(folder):
    Path("study.toml").write_text(STUDY)
    return folder


@pytest.fixture(scope="module")
def map_of_study(tmp_path_factory):
    """Return the bytes of the map of the study."""
    folder = tmp_path_factory.mktemp("map")
    (folder / "study.toml").write_text(STUDY)
    fl.run(folder / "study.toml", to=folder / "study.h5").close()
    return (folder / "study.h5").read_bytes()


@pytest.fixture
def mapped(folder, map_of_study):
    """Return the current folder, with the study and its map."""
    Path("study.h5").write_bytes(map_of_study)
    return folder


def called(*arguments):
    return CliRunner().invoke(app, [str(argument) for argument in arguments], prog_name="fastlink")


def refused(*arguments):
    """Return the lines that a command ends with when its input is bad."""
    done = called(*arguments)
    assert done.exit_code == 2
    assert done.stdout == ""
    lines = done.stderr.splitlines()
    assert all(line.startswith("fastlink: ") for line in lines)
    return [line.removeprefix("fastlink: ") for line in lines]


def test_run_writes_the_map_and_ends_with_the_summary_unless_quiet(folder):
    done = called("run", "study.toml", "--to", "other.h5", "--threads", "1", "--quiet")
    assert (done.exit_code, done.output) == (0, "")
    with fl.open("other.h5") as maps:
        assert maps.attrs["threads"] == 1
    assert not Path("study.h5").exists()
    done = called("run", "study.toml")
    assert (done.exit_code, done.stderr) == (0, "")
    with fl.open("study.h5") as maps:
        assert dict(maps.sizes) == {"a2": 5, "a3": 4, "branch": 2}
        turning = maps.attrs["designs_rotates_fully"]
    rows = done.stdout.splitlines()
    assert rows[0].split() == ["designs", "20"]
    assert rows[1].split() == [str(turning), "rotates", "fully", f"{5 * turning:.1f}", "%"]
    assert [row.split("  ")[0] for row in rows[-4:]] == ["run time", "speed", "largest error", "file"]
    assert all(row.startswith(" ") for row in rows[1:-4])  # the counts of the statuses
    assert rows[-3].endswith("designs/s")
    assert rows[-2].endswith("roundings, of 20")
    assert rows[-1].split()[1] == str(folder / "study.h5")


def test_an_unchanged_study_is_up_to_date(folder):
    assert called("run", "study.toml").exit_code == 0
    before = Path("study.h5").stat()
    again, quiet = called("run", "study.toml"), called("run", "study.toml", "--quiet")
    assert (again.exit_code, quiet.exit_code) == (0, 0)
    assert quiet.output == f"{folder / 'study.h5'} is up to date\n"
    assert again.output.startswith(quiet.output)
    assert again.output.splitlines()[-1].split()[1] == str(folder / "study.h5")
    after = Path("study.h5").stat()
    assert (after.st_mtime_ns, after.st_ino) == (before.st_mtime_ns, before.st_ino)
    assert called("run", "study.toml", "--overwrite", "--quiet").output == ""
    assert Path("study.h5").stat().st_ino != before.st_ino


def test_run_replaces_a_file_only_with_overwrite(folder):
    assert called("run", "study.toml").exit_code == 0
    before = Path("study.h5").read_bytes()
    Path("study.toml").write_text(STUDY.replace("1.0, 4]", "1.0, 5]"))
    (line,) = refused("run", "study.toml")
    assert line.startswith("study.toml: output.file: ")
    assert line.endswith(
        "the file exists, a map with other a3, study; choose another name, or write --overwrite"
    )
    assert Path("study.h5").read_bytes() == before
    assert called("run", "study.toml", "--overwrite").exit_code == 0


def test_problems_of_a_study_are_a_line_each_with_what_to_write(folder):
    Path("study.toml").write_text(STUDY.replace("\na1", "\na9").replace("omega4_max", "omega9_max"))
    keys = [line.split(": ")[1].split(" ")[0] for line in refused("run", "study.toml")]
    assert keys == ["quantities[0]", "design.a9"]
    done = called("run", "study.toml", "--branch", 2)
    assert done.exit_code == 2
    assert "write branch in the study, under [cycle]" in " ".join(done.stderr.split())
    (line,) = refused("run", "no.toml")
    assert line.startswith("no.toml: cannot be read (No such file or directory); give the path of a study")
    assert line.endswith("`fastlink new planar_4r > study.toml` writes one")


def test_a_remark_is_one_line(folder):
    Path("designs.csv").write_text("a1,a2,a3,a4,omega1,omega4_max\n0.4,1.2,0.8,1.0,25.0,20.0\n")
    Path("study.toml").write_text(
        'mechanism = "planar_4r"\nquantities = ["theta4"]\n[design]\ntable = "designs.csv"\n'
        "[cycle]\ntheta1 = {values = [40, 80, 120]}\n"
    )
    done = called("run", "study.toml", "--quiet")
    lines = done.stderr.splitlines()
    assert done.exit_code == 0
    assert len(lines) == 2
    assert all(line.startswith("fastlink: ") for line in lines)
    assert "ignored: omega4_max;" in lines[0]
    assert lines[1].endswith("write theta1_deg")


@pytest.mark.sample(1)
@pytest.mark.skipif(os.name != "posix", reason="needs signals")
@pytest.mark.parametrize(
    ("number", "word", "code"), [(signal.SIGINT, "interrupted", 130), (signal.SIGTERM, "terminated", 143)]
)
def test_an_interrupted_run_is_kept_to_go_on(folder, number, word, code):
    # 2 10^7 designs: some seconds at the least
    long = STUDY.replace("1.4, 5]", "1.4, 2000]").replace("1.0, 4]", "1.0, 10000]")
    Path("study.toml").write_text(long.replace("theta1 = 36", "theta1 = 1000"))
    # A shell's background job ignores the signal, and so would the child.
    heed = "import os, signal, sys; signal.signal(signal.SIGINT, signal.SIG_DFL); os.execv(sys.argv[1], sys.argv[1:])"
    command = [sys.executable, "-c", heed, *MAIN, "run", "study.toml"]
    process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
    try:
        limit, journal = time.monotonic() + 60, Path("study.h5.part.journal")
        while not journal.exists() and process.poll() is None and time.monotonic() < limit:
            time.sleep(0.02)
        assert journal.exists()  # the first designs are on the disk
        process.send_signal(number)
        _, errors = process.communicate(timeout=120)
    finally:
        process.kill()
        process.wait()
        left = sorted(path.name for path in folder.iterdir())
        Path("study.h5.part").unlink(missing_ok=True)  # of some hundred megabytes
    assert process.returncode == code
    interrupted, kept = errors.splitlines()
    assert interrupted == f"fastlink: {word}"
    assert kept.endswith("study.h5.part; run the same again to go on")
    assert left == ["study.h5.part", "study.h5.part.journal", "study.toml"]


@pytest.mark.parametrize(
    ("name", "remedy"),
    [
        ("summary", "did you mean 'info'?"),
        ("finite", "did you mean 'info'?"),
        ("sweep", "did you mean 'run'?"),
        ("exlpain", "did you mean 'explain'?"),
        ("help", "`fastlink --help` lists the commands"),
        ("spatial", "known: accuracy, "),
    ],
)
def test_an_unknown_command_is_answered_with_the_one_that_is_meant(name, remedy):
    done = called(name, "maps.h5")
    assert (done.exit_code, done.stdout) == (2, "")
    assert done.stderr.startswith(f"fastlink: {name!r} is not a command; {remedy}")


def test_the_words_of_others_are_for_commands_that_are_there():
    names = {command.name or command.callback.__name__ for command in app.registered_commands}
    assert not OTHER_NAMES.keys() - names
    assert not names & {word for words in OTHER_NAMES.values() for word in words}


def test_quantities_prints_the_table_and_unknown_mechanisms_are_refused():
    done = called("quantities", "planar_4r")
    assert done.exit_code == 0
    assert done.stdout == f"{fl.quantities('planar_4r')}\n"
    every = called("quantities", "planar_4r", "--all")
    assert every.stdout == f"{fl.quantities('planar_4r', internal=True)}\n"
    assert refused("quantities", "planar4r") == [
        "MECHANISM|STUDY.toml: 'planar4r' is unknown; did you mean 'planar_4r'?"
    ]
    assert refused("new", "planar4r") == ["MECHANISM: 'planar4r' is unknown; did you mean 'planar_4r'?"]
    assert called("--version").stdout == f"fastlink {version('fastlink-linkages')}\n"


def test_info_prints_what_a_map_holds(mapped):
    done = called("info", "study.h5")
    assert done.exit_code == 0
    for line in (
        "mechanism   planar_4r",
        "study file  study.toml",
        "  a2      5: 1 to 1.4 m  length of the coupler AB",
        "  omega1  25 rad s-1  angular velocity of the crank, constant",
        "  omega4_max  (a2, a3, branch)  [rad s-1]  Angular velocity of the output link, greatest over the cycle",
        "designs        20",
    ):
        assert line in done.stdout.splitlines()


def test_info_prints_the_ranges_of_a_sample_and_refuses_something_else(folder):
    space = fl.sobol(16, seed=1, a1=(0.2, 0.4), a2=1.2, a3=0.8, a4=1.0)
    sweep_4r(space, ["status"], to="sample.h5").close()
    lines = called("info", "sample.h5").stdout.splitlines()
    (line,) = [line for line in lines if line.startswith("  a1")]
    assert re.fullmatch(r"  a1  0\.2\d* to 0\.3\d* m  length of the input crank OA", line)
    assert refused("info", "no.h5") == ["no.h5: there is no such file; give the path of a written map"]
    remedy = "`fastlink run study.toml` makes its map"
    assert refused("info", "study.toml") == [f"study.toml: is a study, not a map; {remedy}"]
    Path("map.txt").write_text("no map")
    (line,) = refused("info", "map.txt")
    assert line.startswith("map.txt: cannot be read as HDF5")


@pytest.mark.sample(1)
@pytest.mark.parametrize("mechanism", NAMES)
def test_a_new_study_runs_as_it_is(folder, mechanism):
    done = called("new", mechanism)
    assert done.exit_code == 0
    assert sum(line.startswith("#") for line in done.stdout.splitlines()) > 5
    Path("mine.toml").write_text(done.stdout)
    assert called("run", "mine.toml", "--quiet").exit_code == 0
    with fl.open("mine.h5") as maps:
        assert maps.attrs["mechanism"] == mechanism
        assert maps.attrs["study"] == done.stdout


def test_plots_of_maps_rows_and_fronts_are_written(mapped):
    done = called("plot", "study.h5", "omega4_max", "--branch", 2)
    assert (done.exit_code, done.stdout) == (0, "omega4_max.png\n")
    assert Path("omega4_max.png").read_bytes().startswith(b"\x89PNG")
    line = ("--at", "a3=0.7", "--degrees", "--to", "line.svg")
    assert called("plot", "study.h5", "omega4_max", *line).exit_code == 0
    assert Path("line.svg").read_text().startswith("<?xml")
    for arguments, picture in (
        (["omega4_max", "a3", "--branch", "1"], "omega4_max-a3.png"),
        (["omega4_max", "--kind", "cumulative", "--to", "c.pdf"], "c.pdf"),
        (["--minimise", "omega4_max", "--maximise", "a3"], "front.png"),
        (["omega4_max", "--lines", "a3", "--to", "l.png"], "l.png"),
    ):
        assert called("plot", "study.h5", *arguments).stdout == f"{picture}\n"
        assert (mapped / picture).exists()


def test_best_lists_designs_in_degrees_where_asked(mapped, folder):
    done = called(
        "best", "study.h5", "--minimise", "omega4_max", "--where", "a3=0.7:", "--top", 2, "--degrees"
    )
    assert (done.exit_code, done.stderr) == (0, "")
    about, names, units, *rows, same = done.stdout.splitlines()
    with fl.open("study.h5") as maps:
        expected = fl.best(maps, minimise="omega4_max", where={"a3": (0.7, None)}, top=2).load()
    assert about == expected.attrs["selection"]
    assert names.split()[:4] == ["a2", "a3", "branch", "omega4_max"]
    assert units.split() == ["m", "m", "rad", "s-1"]
    shown = [[float(cell) for cell in row.split()] for row in rows]
    assert shown == [[float(f"{expected[n][k]:g}") for n in names.split()] for k in range(2)]
    assert "a1 = 0.4 m" in same
    Path("study.toml").write_text(
        Path("study.toml").read_text().replace('"omega4_max"', '"omega4_max", "swing"')
    )
    called("run", "study.toml", "--overwrite", "--quiet")
    done = called("best", "study.h5", "--minimise", "omega4_max", "--where", "swing_deg=1:")
    assert "degree" in done.stdout.splitlines()[2]


def test_best_designs_are_written_to_be_swept_again_and_places_refused_beforehand(mapped, monkeypatch):
    line = ("best", "study.h5", "--minimise", "omega4_max", "--top", 3, "--to", "best.csv")
    assert called(*line).exit_code == 0
    with fl.open("study.h5") as maps:
        expected = fl.best(maps, minimise="omega4_max", top=3).load()
    assert fl.table("best.csv").columns["a2"].tolist() == expected.a2.values.tolist()
    assert_refusal(fl.InputError(*refused(*line)), "--to", "--overwrite")
    assert called(*line, "--overwrite").exit_code == 0
    monkeypatch.setattr(
        "fastlink.design.best.chosen", lambda *given, **options: pytest.fail("it was computed")
    )
    Path("best.csv").write_text("mine")
    line = ("best", "study.h5", "--minimise", "omega4_max", "--to")
    assert_refusal(fl.InputError(*refused(*line, "best.csv")), "--to", "--overwrite")
    assert_refusal(fl.InputError(*refused(*line, "best.xls")), "--to", ".csv")
    assert Path("best.csv").read_text() == "mine"


def test_best_refuses(mapped):
    for arguments, key, remedy in (
        (["--where", "a3"], "--where", "--where a2=1.1:1.3"),
        (["--where", "a3=x:1", "--minimise", "a2"], "--where", "write LO:HI, LO: or :HI, or a number"),
        (["--where", "a3=1:", "--where", "a3=:2"], "--where", "once"),
        (["--where", "a3=fast", "--minimise", "a2"], "a3", "LO:HI, LO: or :HI, or a number"),
        (["--minimise", "omega_max"], "--minimise", "omega4_max"),
        ([], "objective", "minimise"),
    ):
        (line,) = refused("best", "study.h5", *arguments)
        assert_refusal(fl.InputError(line), key, remedy)


def options_of(command, function):
    """Return how each option of a command may be written as a word, and how it is to be; "" for those of Python."""
    found = dict.fromkeys(signature(function).parameters, "")
    for one in command.params:
        if isinstance(one, TyperOption):
            found |= dict.fromkeys((one.name, one.opts[0].strip("-")), one.opts[0])
    return found.items()


def test_an_option_that_is_written_as_an_input_is_refused_with_how_it_is_written(mapped):
    commands = get_command(app).commands
    doors = {
        "draw": (fl.draw, ["planar_4r", "a1=0.4", "a2=1.1", "a3=0.8", "a4=1.0"]),
        "tolerance": (fl.tolerance, ["study.h5", "a1=1e-4"]),
        "plot": (fl.plot, ["study.h5", "omega4_max"]),
    }
    for name, (function, words) in doors.items():
        for key, option in options_of(commands[name], function):
            (line,) = refused(name, *words, f"{key}=3")
            assert f"'{key}=3' names an option, not an input; " in line
            if option:
                assert re.search(rf"; write {option}( 3)?$", line), line
    for words, remedy in {
        "draw slider_crank r=0.1 l=0.3 e=0.02 branch=1": "; write --branch 1",
        "draw planar_4r degrees=1": "; write --degrees",
        "draw planar_4r a1=0.4 title=press": "title is 'press', not a number; write such as a1=0.4",
        "tolerance study.h5 quantities_file=own.py": "; write --quantities-file own.py",
        "plot study.h5 omega4_max a3=0.6": "a3=0.6 is no variable; write --at a3=0.6",
    }.items():
        (line,) = refused(*words.split())
        assert line.endswith(remedy)


def test_plot_refuses(mapped):
    for arguments, message in (
        (["--at", "a3"], "--at: 'a3' is not DIM=VALUE; write such as --at a4=1.0"),
        (["--at", "a3=x"], "--at: a3 is 'x', not a number; write such as --at a4=1.0"),
        (["--at", "=1"], "--at: '=1' is not DIM=VALUE; write such as --at a4=1.0"),
        (["--at", "a3=1", "--at", "a3=1"], "--at: a3 is given twice; write it once"),
        (["--branch", "3"], "--branch is 3; write one of 1, 2"),
        (["--at", "a1=0.4"], "--at: 'a1' is not a dimension of omega4_max that can be fixed; known: a2, a3"),
    ):
        assert refused("plot", "study.h5", "omega4_max", *arguments) == [message]
    for arguments, key, remedy in (
        ([], "NAME...", "write a variable"),
        (["omega4_max", "--minimise", "omega4_max"], "NAME...", "leave it out"),
        (["omega4_max", "a3", "--at", "a3=1"], "--at", "--where"),
        (["omega4_max", "a3", "--kind", "pie"], "--kind", "scatter"),
    ):
        (line,) = refused("plot", "study.h5", *arguments)
        assert line.startswith(key)
        assert remedy in line.partition("; ")[2]


def test_an_interrupt_and_usage_errors_have_their_codes(folder, monkeypatch):
    for arguments in (["run"], ["run", "study.toml", "--wrong"], ["run", "study.toml", "--threads", "x"]):
        done = called(*arguments)
        assert done.exit_code == 2
        assert "Usage: fastlink" in done.stderr
        assert "Traceback" not in done.output

    def interrupted(*args, **options):
        raise KeyboardInterrupt

    monkeypatch.setattr(study, "sweep", interrupted)
    done = called("run", "study.toml")
    assert (done.exit_code, done.stdout, done.stderr) == (130, "", "fastlink: interrupted\n")


def test_help_imports_nothing_heavy():
    script = (
        "import sys\n"
        "from fastlink.app.cli import app\n"
        "for words in (['--help'], *([name, '--help'] for name in ('run', 'info', 'new', 'cache', 'plot', 'best'))):\n"
        "    try:\n"
        "        app(words, prog_name='fastlink')\n"
        "    except SystemExit as done:\n"
        "        assert done.code == 0\n"
        "    heavy = {name for name in sys.argv[1:] if name in sys.modules}\n"
        # typer itself takes pydantic for the arguments of a command
        "    assert heavy <= ({'pydantic'} if words[1:] else set()), heavy\n"
    )
    heavy = [*HEAVY, "fastlink.app.study", "fastlink.mechanisms"]
    done = subprocess.run([sys.executable, "-c", script, *heavy], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.count("Usage: fastlink") == 7


def test_a_real_process_refuses():
    done = subprocess.run([*MAIN, "new", "planar4r"], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1)
    assert done.stderr.startswith("fastlink: MECHANISM: ")


@pytest.mark.stress
def test_a_name_that_is_no_text_is_printed_to_a_strict_terminal_too(folder):
    environment = os.environ | {"PYTHONIOENCODING": "utf-8:strict"}
    command = [*MAIN, "draw", "planar_4r", "a1=0.4", "a2=1.1", "a3=0.8", "a4=1.0", "--to", b"\xff.png"]
    done = subprocess.run(command, capture_output=True, env=environment, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (0, b"\\udcff.png\n", b"")
    assert Path(os.fsdecode(b"\xff.png")).is_file()


def test_best_refines(mapped):
    line = ("best", "study.h5", "--minimise", "omega4_max", "--where", "a2=1.13:", "--top", 1)
    about, names, *_ = called(*line, "--refine", "--to", "finer.h5").stdout.splitlines()
    assert "refined: 1 converged" in about
    assert names.split()[-4:] == ["omega4_max_gain", "refinement", "starts", "active"]
    with fl.open("study.h5") as maps, fl.open("finer.h5") as finer:
        expected = fl.best(maps, minimise="omega4_max", where={"a2": (1.13, None)}, top=1, refine=True)
        assert str(finer.active[0].item()) == str(expected.active[0].item())
        assert float(finer.omega4_max[0]) == float(expected.omega4_max[0])
    assert_refusal(fl.InputError(*refused(*line, "--changing", "a2")), "--changing", "--refine")
    assert_refusal(fl.InputError(*refused(*line, "--refine", "--changing", "a1")), "--refine", "a2, a3")


def test_a_bar_is_shown_where_the_terminal_has_no_size(monkeypatch):
    """As of `docker exec -t`: tqdm alone prints nothing there."""
    text = io.StringIO()
    monkeypatch.setattr(text, "isatty", lambda: True, raising=False)
    monkeypatch.setattr(text, "fileno", lambda: 2, raising=False)
    monkeypatch.setattr(sys, "stderr", text)
    monkeypatch.setattr(os, "get_terminal_size", lambda *of: os.terminal_size((0, 0)))
    with progress_bar(10, " designs", None) as bar:
        bar.update(10)
    assert "10.0" in text.getvalue()


def test_a_study_is_drawn_without_a_choice(folder):
    """Of the designs near the middle one whose crank turns."""
    (folder / "study.toml").write_text(called("new", "planar_4r").stdout)
    done = called("draw", "study.toml", "--to", "drawn.png")
    assert done.exit_code == 0
    assert "design 15301 of 30,603 is drawn" in done.output
