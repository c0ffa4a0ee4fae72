"""The benchmarks run, agree and report; how fast they are is for ``python -m benchmarks`` to say."""

import math
import re
from pathlib import Path

import numpy as np
import pytest
from benchmarks.__main__ import measure
from benchmarks.cases import CASES, angle_tables, bind_case, designs, fact, space_of
from numpy.testing import assert_allclose, assert_array_equal

from benchmarks import accuracy, answers, minkowski, numba_baseline, peers, report
from fastlink.app.accuracy import curves_by_numpy
from fastlink.engine.resolve import resolve

# A reaction next to a toggle goes as 1/sigma^3: some 40 roundings times a condition of up to 100, relative to
# the greatest value over the cycle; 7e-15 is the worst seen.
SAME_ARITHMETIC = 1e-12


@pytest.mark.stress
def test_a_quick_run_measures_everything_and_changes_the_page_between_its_markers(tmp_path, monkeypatch):
    rows, answered, found = measure(quick=True)
    assert [row["case"] for row in rows][: len(CASES)] == list(CASES)
    for row in (*rows, *answered):
        numbers = [value for value in row.values() if isinstance(value, float)]
        assert all(math.isfinite(value) and value > 0 for value in numbers)
    assert all(math.isfinite(fact["value"]) and fact["value"] > 0 for fact in found)
    page, about = tmp_path / "performance.md", report.machine()
    page.write_text(f"before\n{report.BEGIN}\n\n{report.END}\nafter\n")
    monkeypatch.setattr(report, "PAGE", page)
    monkeypatch.setattr(report, "FOLDER", tmp_path / "data")
    for _ in range(2):
        report.write(rows, answered, found, about)
        assert report.parts_of_page()[1] == report.text_of(rows, answered, about)
    assert report.record()["answers"] == answered
    assert page.read_text().startswith("before\n")
    assert page.read_text().endswith(f"{report.END}\nafter\n")


@pytest.mark.sample(1)
@pytest.mark.parametrize("case", CASES)
def test_c_has_the_bits_of_the_engine(case):
    if not peers.compiler():
        pytest.skip("the C limit kernels need gcc, which is not here")
    x, K = designs(64), 72
    call, theirs = peers.bind_c(case, x, angle_tables(K))
    call()
    ours = bind_case(case, x, K)[1]
    # The same arithmetic, strict IEEE in both.
    for name, one, other in zip(CASES[case], ours, theirs, strict=True):
        assert_array_equal(one, other, err_msg=name)


def test_the_page_shows_what_was_measured_and_notes_a_lacking_compiler(monkeypatch):
    monkeypatch.setenv("CC", "no-such-compiler")
    about = report.machine()
    text = report.text_of([{"case": "positions", "ns": 0.3}], [{"request": "rates", "cold": 0.1}], about)
    assert about["versions"]["gcc"] is None
    assert "| positions |" in text
    assert "No gcc" in text
    kept = report.record()
    assert report.parts_of_page()[1] == report.text_of(kept["cases"], kept["answers"], kept["machine"])


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
    pairs = peers.jax_kernel(case)(x, tables)
    return (lambda: None), tuple(np.stack(pair, axis=1) for pair in pairs)


@pytest.mark.sample(1)
@pytest.mark.parametrize("case", CASES)
def test_all_agree(case):
    x, K = designs(20), 36
    ours, tables = bind_case(case, x, K)[1], angle_tables(K)
    others = {"NumPy": peers.bind_numpy, "numba by hand": numba_baseline.bind}
    if peers.available("jax"):
        others["JAX"] = by_jax
    if peers.heyoka_has(case):
        others["heyoka.py"] = peers.bind_heyoka
    for name, binding in others.items():
        assert difference(ours, found_by(binding, case, x, tables)) <= SAME_ARITHMETIC, name
    if case == "reactions":
        assert difference(ours, peers.solve(*peers.system(x, K))) <= SAME_ARITHMETIC


@pytest.mark.parametrize("label", answers.LABELS)
def test_every_request_is_one(label):
    request = answers.request(label)
    asked = resolve(**request)
    assert {output.name for output in asked.plan.outputs} > set(request["quantities"])
    refined = any(output.refined for output in asked.plan.outputs)
    assert refined == ("extremes of" in label or label in (answers.COMMAND, "greatest shaking force"))


ANSWERS = {"request": "rates", "to_heyoka": 3.0, "to_fixed": 2.0, "known_to_fixed": 1.0}
RECORD = {
    "facts": [fact("a / C", 1.0), fact("b / C", 1.0), fact("a", 3.0, "ns"), fact("NumPy / a", 9.0, "times")],
    "cases": [{"case": "rates", "to_C": 1.0}, {"case": "dense", "to_C": None}],
    "answers": [ANSWERS],
}


def measuring(*times):
    """Return a measurement of a / C that finds another value each time, and of b / C as it was."""
    values = iter(times)
    return {"group": lambda: {"a / C": next(values), "b / C": 1.05}}


def test_what_got_worse_is_named_and_what_other_load_disturbed_measured_again(capsys):
    assert report.check(RECORD, measuring(*[1.2] * report.ROUNDS)) == 1
    said = capsys.readouterr().out
    assert "a / C: 1.2, recorded 1, 20 % worse" in said
    assert "b / C" not in said
    assert report.check(RECORD, measuring(2.0, 1.3, 1.0)) == 0
    assert "nothing is more than 10 % worse" in capsys.readouterr().out
    assert set(report.ratios(*RECORD.values())) == {
        *("a / C", "b / C", "rates, time / C", "rates, set-up / heyoka.py"),
        *("rates, set-up / fixed work", "rates, set-up from the cache / fixed work"),
    }


@pytest.mark.stress
def test_the_page_has_the_measured_errors_of_textbook_formulas():
    """Next to a toggle or a fold they subtract squares of lengths that agree to the distance; fastlink does not."""
    page = (Path(__file__).parents[2] / "docs" / "accuracy.md").read_text()
    errors = {family: accuracy.errors(family, 200) for family in accuracy.CLOSE}
    for quantity in accuracy.QUANTITIES:
        (row,) = re.findall(rf"^\| {quantity} \| (.*) \|$", page, flags=re.MULTILINE)
        for family, text in zip(accuracy.CLOSE, row.split(" | "), strict=True):
            printed = [float(number) for number in re.findall(r"([\d.e+-]+) \(", text)]
            # The sines and arctangents of another machine's library: a rounding of each, whose median it is.
            medians = np.median(errors[family][quantity], axis=1)
            assert_allclose(medians, printed, rtol=0.5, atol=0.3)
            if family in ("gap 1e-8", "gap 1e-15", "toggle 1e-5", "toggle 1e-8"):
                # theta4 itself has a square-root's sensitivity there: half of the digits
                assert medians[0] > (100.0 if quantity == "theta4" else 5e4), (quantity, family)
            # some twelve operations on factors right to a rounding each, half of their errors cancelling
            assert medians[1] < 5.0, (quantity, family)


def test_single_precision_has_digits_of_single_precision():
    resolved = resolve("planar_4r", space_of(designs(8)), ["omega4"], angles=36, branch=(1, 2))
    single, double = accuracy.by_numpy_single(resolved, 8), curves_by_numpy(resolved, 8)
    assert single.dtype == np.float32
    # Some 40 roundings of 2^-24, times a condition of up to 100; one rounding at least is seen.
    assert 2.0**-25 < difference([double], [single]) <= 40 * 100 * 2.0**-24


def test_eq3_has_the_same_roots():
    x, theta = minkowski.designs(40), np.linspace(-4.0, 4.0, 57)
    psi, orientation = minkowski.bind_psi(x, theta)[1]
    by_eq3, sign = minkowski.eq3(x, theta)
    assert_array_equal(np.isnan(by_eq3), np.isnan(psi))
    assert_array_equal(np.nan_to_num(sign), orientation)
    # Of 16 digits eq. (3) loses those of e^(psi + theta): four at most here.
    assert_allclose(by_eq3, psi, rtol=0, atol=1e-10)


def test_the_table_of_the_docs_is_the_one_that_is_measured():
    page = Path(__file__).parents[2].joinpath("docs", "minkowski.md").read_text()
    _, _, *rows = minkowski.error_table(2, rounds=1).splitlines()
    shown = page[page.index("| inputs | fastlink: error") :].split("\n\n")[0].splitlines()[2:]
    assert len(shown) == len(rows)
    for row, measured in zip(shown, rows, strict=True):
        (name, own, by_eq3, *times), (of, _, now, *others) = (
            [cell.strip() for cell in line.strip("|").split("|")] for line in (row, measured)
        )
        assert name == of
        assert float(own) <= 4.0
        # What has no value in two configurations has none in a hundred.
        assert by_eq3 == "no value" if now == "no value" else by_eq3 == "no value" or float(by_eq3) > 1.0
        assert len(times) == len(others) == 3
        assert all(float(time) > 0.0 for time in times + others)
