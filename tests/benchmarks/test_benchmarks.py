"""The benchmarks run, agree and report; how fast they are is for ``python -m benchmarks`` to say."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest
from benchmarks.__main__ import quick
from benchmarks.cases import CASES, angle_tables, angles, bind, designs, round_bars

from benchmarks import answers, numba_baseline, peers, report, table

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


@pytest.mark.parametrize("case", CASES)
def test_c_has_the_bits_of_the_engine(case):
    if not peers.compiler():
        pytest.skip("the C limit kernels need gcc, which is not here")
    x, K = designs(64), 72
    call, theirs = peers.bind_c(case, x, angle_tables(K))
    call()
    ours = bind(case, x, K).arrays
    # The same arithmetic, strict IEEE in both.
    for name, one, other in zip(CASES[case], ours, theirs, strict=True):
        np.testing.assert_array_equal(one, other, err_msg=name)


@pytest.mark.stress
def test_errors_are_a_few_roundings(results):
    rows, _, _ = results
    assert all(row["error"] <= MULTIPLE for row in rows if "dense" not in row["case"])


@pytest.mark.stress
def test_c_is_timed(results):
    if not peers.compiler():
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


def difference(ours, theirs):
    """Return the largest difference relative to the design's greatest value; infinite where only one is NaN."""
    worst = 0.0
    for a, b in zip(theirs, ours, strict=True):
        if not np.array_equal(np.isnan(a), np.isnan(b)):
            return np.inf
        scale = np.fmax.reduce(np.abs(b), axis=tuple(range(1, b.ndim)), keepdims=True)
        worst = np.fmax(worst, np.fmax.reduce(np.abs(a - b) / scale, axis=None))
    return worst


def found_by(binding, case, x, tables):
    """Return the arrays of a peer, called once."""
    call, arrays = binding(case, x, tables)
    call()
    return arrays


def by_jax(case, x, tables):
    pairs = peers.jax_kernels()[case](x, tables)
    return (lambda: None), tuple(np.stack(pair, axis=1) for pair in pairs)


@pytest.mark.parametrize("case", CASES)
def test_all_agree(case):
    x, K = designs(20), 36
    ours, tables = bind(case, x, K).arrays, angle_tables(K)
    others = {"NumPy": peers.bind_numpy, "numba by hand": numba_baseline.bind}
    if peers.available("jax"):
        others["JAX"] = by_jax
    if case in peers.FORMS and peers.available("heyoka"):
        others["heyoka.py"] = peers.bind_heyoka
    for name, binding in others.items():
        assert difference(ours, found_by(binding, case, x, tables)) <= SAME_ARITHMETIC, name
    if case == "reactions":
        assert difference(ours, peers.solve(*peers.system(x, angles(K)))) <= SAME_ARITHMETIC


def test_the_paper_agrees():
    """Hayes, Hninn, Irani, Tables 1 and 2 (one misprint corrected), branch 2, to the digits given."""
    x, curves = round_bars(([0.4], [1.2], [0.8], [1.0])), {}
    places = [1.667165012, 5.913849943, 0.1482557001, 0.1096]
    for case in ("rates", "reactions"):
        curves |= zip(CASES[case], (array[0, 1] for array in bind(case, x, places).arrays), strict=True)
    np.testing.assert_allclose(curves["omega4"][:2], [13.51343678, -23.95938172], rtol=PAPER)
    np.testing.assert_allclose(curves["alpha4"][2], 1062.775829, rtol=PAPER)
    force = np.hypot(*(curves[f"F41_{axis}"] + curves[f"F43_{axis}"] for axis in "xy"))
    np.testing.assert_allclose(force[3], 2512.318, rtol=PAPER_FORCE)


@pytest.mark.stress
def test_layouts_are_measured_and_leave_nothing(tmp_path):
    found = answers.layouts(tmp_path, side=2, repeats=1)
    assert len(found) == 10
    assert all(math.isfinite(value) and value > 0 for _, value, _, _ in found)
    assert not list(tmp_path.iterdir())


@pytest.mark.stress
def test_times_to_an_answer_are_measured(results):
    _, answered, _ = results
    (row,) = answered
    assert set(answers.COLUMNS) < set(row)
    if not peers.available("heyoka"):
        assert row.pop("to_heyoka") is row.pop("compile_heyoka") is None
    numbers = [value for name, value in row.items() if name != "request" and value is not None]
    assert len(numbers) >= len(row) - 2  # but the request, and the peak of memory where no system tells it
    assert all(math.isfinite(value) and value > 0 for value in numbers)


@pytest.mark.parametrize("label", answers.LABELS)
def test_every_request_is_one(label):
    asked = answers.resolved(label)
    assert {output.name for output in asked.plan.outputs} > set(answers.requested(label)[2])
    refined = any(output.refined for output in asked.plan.outputs)
    assert refined == ("extremes of" in label or label in (answers.COMMAND, "greatest shaking force"))


def test_peers_are_left_out_where_they_are_not_installed(monkeypatch):
    monkeypatch.setattr(peers, "available", lambda module: False)
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
    assert set(report.recorded(RECORD)) == {
        *("a / C", "b / C", "rates, time / C", "set-up of rates, / heyoka.py"),
        *("set-up of rates, / fixed work", "set-up of rates, from the cache / fixed work"),
    }


def test_what_got_worse_is_named(capsys):
    assert report.report_worse(RECORD, measured=measuring(*[1.2] * report.ROUNDS)) == 1
    said = capsys.readouterr().out
    assert "a / C: 1.2, recorded 1, 20 % worse" in said
    assert "b / C" not in said


def test_compile_times_count_too(capsys):
    slow = {"answers": lambda: report.answer_ratios([ANSWERS | {"to_fixed": 2.5}])}
    assert report.report_worse(RECORD, measured=slow) == 1
    assert "set-up of rates, / fixed work: 2.5, recorded 2" in capsys.readouterr().out


def test_what_other_load_disturbed_is_measured_again(capsys):
    assert report.report_worse(RECORD, measured=measuring(2.0, 1.3, 1.0)) == 0
    assert "nothing is more than 10 % worse" in capsys.readouterr().out


def test_new_facts_are_listed_and_are_not_failures():
    said = []
    assert report.check(RECORD, {"group": lambda: {"c / C": 5.0}}, said.append) == {}
    assert "not in the record: c / C" in said


def test_without_a_record_nothing_is_checked(capsys):
    assert report.report_worse(None) == 1
    assert "no record" in capsys.readouterr().out


@pytest.mark.stress
def test_groups_measure_what_is_recorded(results):
    """At tiny sizes: the names of a record are those that `--check` measures."""
    rows, answered, found = results
    record = {
        "facts": [dict(zip(("fact", "value", "unit", "aim"), fact, strict=True)) for fact in found],
        "cases": rows,
        "answers": answered,
    }
    groups = report.groups()
    now = report.ratios(table.ratios_to_c(rounds=1)) | report.ratios(table.one_mode(64, 1, ("omega4",)))
    assert set(now) <= set(report.recorded(record))
    assert set(report.answer_ratios(answered)) <= set(report.recorded(record))
    assert set(groups) >= {f"set-up of {label}" for label in answers.LABELS}


def test_what_was_measured_is_what_is_shown():
    kept = json.loads((report.FOLDER / "benchmarks.json").read_text())
    text = report.text_of(kept["cases"], kept.get("answers", []), kept["machine"])
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
