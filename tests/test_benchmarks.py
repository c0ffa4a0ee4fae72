"""The benchmarks run, agree and report; how fast they are is for ``python -m benchmarks`` to say."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest
from benchmarks import c_kernel, extrema, facts, output, report, table
from benchmarks.__main__ import quick
from benchmarks.agree import agree
from benchmarks.families import FAMILIES
from benchmarks.inputs import CASES

# A reaction next to a toggle goes as 1/sigma^3: some 40 roundings times a condition of up to 100, relative to
# the greatest value over the cycle; 7e-15 is the worst seen.
SAME_ARITHMETIC = 1e-12
# Table 2 has ten digits of angles and values, of the shaking force seven.
PAPER = 1e-9
PAPER_FORCE = 5e-7
# Roundings of a value and of its inputs, as in test_precision.py.
MULTIPLE = 4


@pytest.fixture(scope="module")
def results():
    return quick()


def test_every_case_is_timed(results):
    rows, _ = results
    assert [row["case"] for row in rows][: len(CASES)] == list(CASES)
    for row in rows:
        numbers = {name: value for name, value in row.items() if name != "case" and value is not None}
        assert {"ns", "NumPy", "error"} <= set(numbers)
        assert all(math.isfinite(value) and value > 0 for value in numbers.values())


def test_every_fact_is_a_positive_number(results):
    _, found = results
    assert all(math.isfinite(value) and (value > 0 or aim == "0") for _, value, _, aim in found)


def test_refined_extremes_are_right_and_none_is_missed(results):
    _, found = results
    values = {what: value for what, value, _, aim in found if aim in ("0", "<= 1e-14")}
    assert len(values) == 2
    assert all(value <= (1e-14 if "error" in what else 0) for what, value in values.items())


def test_what_a_coarser_search_misses_is_counted():
    """A sixteenth of the cells is four: too few for accelerations next to a change point."""
    ((_, differ, _, _),) = extrema.missed(500, ["near parallelogram"], ["alpha4"], finer=1 / 16)
    assert differ > 0


def test_scipy_finds_the_same_extremes():
    x = extrema.draw("crank", 20)
    greatest, least = extrema.by_scipy(x)
    (ours,) = extrema.bind(extrema.extremes(["omega4"]), x)
    for theirs, refined in zip((greatest, least), ours.arrays, strict=True):
        for branch in (0, 1):
            # The textbook form loses what |AD|^2 - (b - c)^2 cancels by, in these cranks some four digits at most.
            np.testing.assert_allclose(theirs, refined[:, branch], rtol=1e-11)


@pytest.mark.parametrize("family", FAMILIES)
def test_c_finds_the_same_extremes(family):
    if not c_kernel.available():
        pytest.skip("the C limit kernels need gcc, which is not here")
    x = extrema.draw(family, 1000)
    call, found = c_kernel.bind_extrema(x)
    call()
    (ours,) = extrema.bind(extrema.extremes(["omega4"]), x)
    assert [search.cells for search in ours.plan.searches] == [c_kernel.extrema_cells()]
    # The same arithmetic, strict IEEE in both: C follows the engine, or their times do not compare.
    for theirs, refined in zip(found, ours.arrays, strict=True):
        np.testing.assert_array_equal(theirs, refined)


def test_errors_are_a_few_roundings(results):
    rows, _ = results
    assert all(row["error"] <= MULTIPLE for row in rows if "dense" not in row["case"])


def test_c_is_timed(results):
    if not c_kernel.available():
        pytest.skip("the C limit kernels need gcc, which is not here")
    rows, _ = results
    assert all(row["to_C"] > 0 for row in rows[: len(CASES)])


def test_without_a_compiler_the_table_says_so(monkeypatch):
    monkeypatch.setenv("CC", "no-such-compiler")
    about = report.machine()
    row = dict.fromkeys(table.COLUMNS) | {"case": "positions", "ns": 0.3}
    assert about["versions"]["gcc"] is None
    assert "| positions |" in report.text_of([row], about)
    assert "No gcc" in report.text_of([row], about)


def test_all_agree():
    for (what, other), difference in agree(n=20, K=36).items():
        paper = PAPER_FORCE if "force" in what else PAPER
        assert difference <= (paper if other == "paper" else SAME_ARITHMETIC), (what, other)


def test_output_is_measured_and_leaves_nothing(tmp_path):
    found = [value for _, value, _, _ in output.disk(tmp_path, side=4, repeats=1)]
    found += output.map_overhead(tmp_path, side=3, theta1=36, repeats=1)
    assert all(math.isfinite(value) and value > 0 for value in found)
    assert not list(tmp_path.iterdir())


def test_processes_are_measured(tmp_path):
    found = facts.compilation(["positions"]) + facts.start(repeats=1)
    found += output.memory(tmp_path, curves_side=2, map_side=2)
    assert all(math.isfinite(value) and value > 0 for _, value, _, _ in found)


def test_compilation_of_refined_extremes_is_measured(monkeypatch):
    """In the folders of the tests, where the kernel is already: fresh ones take half a minute."""
    monkeypatch.setattr(extrema, "python", lambda code, **environment: facts.python(code))
    found = extrema.compilation([("omega4",)])
    assert len(found) == 3
    assert all(math.isfinite(value) and value > 0 for _, value, _, _ in found)


def test_too_little_room_is_said_and_nothing_measured(tmp_path, monkeypatch):
    said = []
    monkeypatch.setattr(output, "NEED", 1 << 62)
    assert output.measure(tmp_path, said.append) == []
    assert "are needed" in said[0]


def test_what_was_measured_is_what_is_shown():
    kept = json.loads((report.FOLDER / "benchmarks.json").read_text())
    found = [tuple(fact.values()) for fact in kept["facts"]]
    text = report.text_of(kept["cases"], kept["machine"])
    written = (report.FOLDER / "benchmarks.md").read_text()
    assert written == f"{text}\n\n{report.fact_table(found)}\n"
    shown = report.in_readme()
    if shown is None:
        pytest.skip(f"README.md has no {report.BEGIN}")
    assert shown == text


def test_the_readme_is_changed_between_its_markers_only(tmp_path, monkeypatch, results):
    readme = tmp_path / "README.md"
    readme.write_text(f"before\n{report.BEGIN}\n{report.END}\nafter\n")
    monkeypatch.setattr(report, "README", readme)
    monkeypatch.setattr(report, "FOLDER", tmp_path / "data")
    rows, found = results
    about = report.machine()
    for _ in range(2):
        report.write(rows, found, about)
        assert report.in_readme() == report.text_of(rows, about)
    assert readme.read_text().startswith("before\n")
    assert readme.read_text().endswith(f"{report.END}\nafter\n")
