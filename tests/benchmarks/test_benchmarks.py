"""The benchmarks run, agree and report; how fast they are is for ``python -m benchmarks`` to say."""

from __future__ import annotations

import itertools
import json
import math
from functools import partial

import numpy as np
import pytest
from benchmarks.__main__ import quick
from benchmarks.agree import agree
from benchmarks.families import FAMILIES
from benchmarks.inputs import CASES, angle_tables, round_bars

from benchmarks import (
    answers,
    c_kernel,
    check,
    engine,
    extrema,
    facts,
    files,
    heyoka_baseline,
    jax_baseline,
    numba_baseline,
    output,
    peers,
    pylinkage_baseline,
    report,
    table,
)
from fastlink.numerics.compensated import UNIT_ROUNDING

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


@pytest.mark.stress
def test_every_case_is_timed(results):
    rows, _, _ = results
    assert [row["case"] for row in rows][: len(CASES)] == list(CASES)
    for row in rows:
        numbers = {name: value for name, value in row.items() if name != "case" and value is not None}
        assert {"ns", "NumPy", "error"} <= set(numbers)
        assert all(math.isfinite(value) and value > 0 for value in numbers.values())


@pytest.mark.stress
def test_every_fact_is_a_positive_number(results):
    _, _, found = results
    assert all(math.isfinite(value) and (value > 0 or isinstance(value, int)) for _, value, _, _ in found)


@pytest.mark.stress
def test_refined_extremes_are_right_and_none_is_missed(results):
    _, _, found = results
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


@pytest.mark.parametrize("case", CASES)
def test_c_has_the_bits_of_the_engine(case):
    if not c_kernel.available():
        pytest.skip("the C limit kernels need gcc, which is not here")
    x, K = engine.designs(64), 72
    theirs = c_kernel.evaluate(case, x, angle_tables(K))
    ours = engine.bind(case, x, K).arrays
    # The same arithmetic, strict IEEE in both, as in test_c_finds_the_same_extremes.
    for name, one, other in zip(CASES[case], ours, theirs, strict=True):
        np.testing.assert_array_equal(one, other, err_msg=name)


def whole_lengths():
    """Return all designs of lengths 1 to 6: parallelograms, kites, change points, extremes at ends of the range."""
    return round_bars(np.array(list(itertools.product(range(1, 7), repeat=4)), dtype=float).T)


@pytest.mark.parametrize("family", [*FAMILIES, "whole lengths"])
def test_c_finds_the_same_extremes(family):
    if not c_kernel.available():
        pytest.skip("the C limit kernels need gcc, which is not here")
    x = whole_lengths() if family == "whole lengths" else extrema.draw(family, 1000)
    call, found = c_kernel.bind_extrema(x)
    call()
    (ours,) = extrema.bind(extrema.extremes(["omega4"]), x)
    assert [search.cells for search in ours.program.searches] == [c_kernel.extrema_cells()]
    # The same arithmetic, strict IEEE in both: C follows the engine, or their times do not compare.
    for theirs, refined in zip(found, ours.arrays, strict=True):
        np.testing.assert_array_equal(theirs, refined)


@pytest.mark.stress
def test_errors_are_a_few_roundings(results):
    rows, _, _ = results
    assert all(row["error"] <= MULTIPLE for row in rows if "dense" not in row["case"])


@pytest.mark.stress
def test_c_is_timed(results):
    if not c_kernel.available():
        pytest.skip("the C limit kernels need gcc, which is not here")
    rows, _, _ = results
    assert all(row["to_C"] > 0 for row in rows[: len(CASES)])


def test_without_a_compiler_the_table_has_a_note(monkeypatch):
    monkeypatch.setenv("CC", "no-such-compiler")
    about = report.machine()
    row = dict.fromkeys(table.COLUMNS) | {"case": "positions", "ns": 0.3}
    assert about["versions"]["gcc"] is None
    assert "| positions |" in report.text_of([row], [], about)
    assert "No gcc" in report.text_of([row], [], about)


def test_all_agree():
    for (what, other), difference in agree(n=20, K=36).items():
        paper = PAPER_FORCE if "force" in what else PAPER
        assert difference <= (paper if other == "paper" else SAME_ARITHMETIC), (what, other)


def test_output_is_measured_and_leaves_nothing(tmp_path):
    found = [value for _, value, _, _ in output.disk(tmp_path, side=4, repeats=1)]
    found += output.map_overhead(tmp_path, side=3, theta1=36, repeats=1)
    assert all(math.isfinite(value) and value > 0 for value in found)
    assert not list(tmp_path.iterdir())


@pytest.mark.stress
def test_files_are_measured_and_none_is_left(tmp_path):
    found = files.checksums(tmp_path, rows=400, repeats=1) + files.layouts(tmp_path, side=2, repeats=1)
    assert all(math.isfinite(value) and value > 0 for _, value, _, _ in found)
    assert not list(tmp_path.iterdir())


@pytest.mark.stress
def test_processes_are_measured(tmp_path):
    found = facts.start(repeats=1)
    found += output.memory(tmp_path, curves_side=2, map_side=2)
    assert all(math.isfinite(value) and value > 0 for _, value, _, _ in found)


@pytest.mark.stress
def test_times_to_an_answer_are_measured(results):
    _, answered, _ = results
    (row,) = answered
    assert set(answers.COLUMNS) < set(row)
    if not heyoka_baseline.available():
        assert row.pop("to_heyoka") is row.pop("compile_heyoka") is None
    numbers = [value for name, value in row.items() if name != "request" and value is not None]
    assert len(numbers) >= len(row) - 2  # but the request, and the peak of memory where no system tells it
    assert all(math.isfinite(value) and value > 0 for value in numbers)
    assert all(math.isfinite(value) and value > 0 for _, value, _, _ in answers.small_calls())


@pytest.mark.parametrize("label", answers.LABELS)
def test_every_request_is_one(label):
    asked = answers.resolved(label)
    assert {output.name for output in asked.plan.outputs} > set(answers.requested(label)[2])
    refined = any(output.refined for output in asked.plan.outputs)
    assert refined == ("extremes of" in label or label in (answers.COMMAND, "greatest shaking force"))


def test_pylinkage_finds_the_same_positions():
    if not pylinkage_baseline.available():
        pytest.skip("pylinkage is not here")
    x, K = round_bars([[0.4], [1.2], [0.8], [1.0]]), 90
    call, found = pylinkage_baseline.bind(x, K)
    call()
    for theirs, ours in zip(found, engine.bind("positions", x, K).arrays, strict=True):
        # It adds up K steps of the angle, each rounded: K / 2 roundings of 2 pi at most, and some of its own.
        np.testing.assert_allclose(theirs, ours[:, 1], rtol=0, atol=K * 2 * math.pi * UNIT_ROUNDING + 1e-14)


def test_the_scan_in_numba_finds_extremes_of_cranks():
    x = extrema.draw("crank", 50)
    call, found = numba_baseline.bind_scan(x, angle_tables(numba_baseline.SCAN))
    call()
    (ours,) = extrema.bind(extrema.extremes(["omega4"]), x)
    for theirs, refined in zip(found, ours.arrays, strict=True):
        # Of textbook formulas, as in test_scipy_finds_the_same_extremes.
        np.testing.assert_allclose(theirs, refined, rtol=1e-11)


def test_peers_are_left_out_where_they_are_not_installed(monkeypatch):
    for module in (heyoka_baseline, pylinkage_baseline, jax_baseline):
        monkeypatch.setattr(module, "available", lambda: False)
    assert peers.against_pylinkage() == []
    row = table.case_row("positions", 2, 64, 1, 0.001, 1)
    assert row["heyoka"] is None
    assert row["numba"] > 0
    kept = [{"case": "positions", "JAX": None}]
    table.add_jax(kept, 2, 64)
    assert kept[0]["JAX"] is None


# ---- --check ----

FACTS = (
    *(
        ("a / C", 1.0, "", "<= 1.1"),
        ("b / C", 1.0, "", ""),
        ("a", 3.0, "ns", ""),
        ("NumPy / a", 9.0, "times", ""),
    ),
    ("missed", 0, "", "0"),
)
ANSWERS = {"request": "rates", "to_heyoka": 3.0, "to_fixed": 2.0, "known_to_fixed": 1.0}
RECORD = {
    "facts": [dict(zip(("fact", "value", "unit", "aim"), fact, strict=True)) for fact in FACTS],
    "cases": [{"case": "rates", "to_C": 1.0}, {"case": "dense", "to_C": None}],
    "answers": [ANSWERS],
}


def measuring(*times):
    """Return a measurement of a / C that finds another value each time, and of b / C as it was."""
    values = iter(times)
    return {"group": lambda: {"a / C": next(values), "b / C": 1.05}}


def test_ratios_of_the_record_are_those_of_times():
    assert set(check.recorded(RECORD)) == {
        *("a / C", "b / C", "rates, time / C", "set-up of rates, / heyoka.py"),
        *("set-up of rates, / fixed work", "set-up of rates, from the cache / fixed work"),
    }


def test_what_got_worse_is_named(capsys):
    assert check.report_worse(RECORD, measured=measuring(*[1.2] * check.ROUNDS)) == 1
    said = capsys.readouterr().out
    assert "a / C: 1.2, recorded 1, 20 % worse" in said
    assert "b / C" not in said


def test_compile_times_count_too(capsys):
    slow = {"answers": lambda: check.answer_ratios([ANSWERS | {"to_fixed": 2.5}])}
    assert check.report_worse(RECORD, measured=slow) == 1
    assert "set-up of rates, / fixed work: 2.5, recorded 2" in capsys.readouterr().out


def test_what_other_load_disturbed_is_measured_again(capsys):
    assert check.report_worse(RECORD, measured=measuring(2.0, 1.3, 1.0)) == 0
    assert "nothing is more than 10 % worse" in capsys.readouterr().out


def test_new_facts_are_listed_and_are_not_failures():
    said = []
    assert check.check(RECORD, {"group": lambda: {"c / C": 5.0}}, said.append) == {}
    assert "not in the record: c / C" in said


def test_without_a_record_nothing_is_checked(capsys):
    assert check.report_worse(None) == 1
    assert "no record" in capsys.readouterr().out


@pytest.mark.stress
def test_groups_measure_what_is_recorded(monkeypatch, results):
    """At tiny sizes: the names of a record are those that `--check` measures."""
    rows, answered, found = results
    record = {
        "facts": [dict(zip(("fact", "value", "unit", "aim"), fact, strict=True)) for fact in found],
        "cases": rows,
        "answers": answered,
    }
    monkeypatch.setattr(table, "ratios_to_c", partial(table.ratios_to_c, rounds=1))
    groups = check.groups()
    now = groups["curves and sampled extremes"]() | check.ratios(extrema.against_c(64, 1))
    now |= check.ratios(peers.against_scan(64, 1))
    assert set(now) <= set(check.recorded(record))
    assert set(check.answer_ratios(answered)) <= set(check.recorded(record))
    assert set(groups) >= {f"set-up of {label}" for label in answers.LABELS}


def test_with_too_little_room_nothing_is_measured(tmp_path, monkeypatch):
    said = []
    monkeypatch.setattr(output, "NEED", 1 << 62)
    assert output.measure(tmp_path, said.append) == []
    assert "are needed" in said[0]


def test_what_was_measured_is_what_is_shown():
    kept = json.loads((report.FOLDER / "benchmarks.json").read_text())
    found = [tuple(fact.values()) for fact in kept["facts"]]
    text = report.text_of(kept["cases"], kept.get("answers", []), kept["machine"])
    written = (report.FOLDER / "benchmarks.md").read_text()
    assert written == f"{text}\n\n{report.fact_table(found)}\n"
    short_repr = report.in_page()
    if short_repr is None:
        pytest.skip(f"docs/performance.md has no {report.BEGIN}")
    assert short_repr == text


@pytest.mark.stress
def test_the_page_is_changed_between_its_markers_only(tmp_path, monkeypatch, results):
    page = tmp_path / "performance.md"
    page.write_text(f"before\n{report.BEGIN}\n{report.END}\nafter\n")
    monkeypatch.setattr(report, "PAGE", page)
    monkeypatch.setattr(report, "FOLDER", tmp_path / "data")
    rows, answered, found = results
    about = report.machine()
    for _ in range(2):
        report.write(rows, answered, found, about)
        assert report.in_page() == report.text_of(rows, answered, about)
    assert report.record()["answers"] == answered
    assert page.read_text().startswith("before\n")
    assert page.read_text().endswith(f"{report.END}\nafter\n")
