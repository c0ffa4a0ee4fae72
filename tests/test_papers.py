"""Each line of the three papers is computed, by a name that is there and held by a test that is there."""

import pytest

from tests.support import papers

PAPERS = {paper["authors"]: paper for paper in papers.papers()}
every_paper = pytest.mark.parametrize("paper", PAPERS.values(), ids=PAPERS)


@every_paper
def test_what_a_row_names_is_there(paper):
    problems = [papers.problem(name) for row in paper["row"] for name in row["names"]]
    problems += [papers.test_problem(test) for row in paper["row"] for test in row["tests"]]
    assert not [problem for problem in problems if problem]


@every_paper
def test_a_row_has_a_name_and_a_test_or_says_why_not(paper):
    unfounded = [row for row in paper["row"] if not (row["names"] and row["tests"]) and not row.get("note")]
    assert not unfounded


@every_paper
def test_every_numbered_item_has_a_row(paper):
    named = {place for row in paper["row"] for place in row["place"]}
    assert not [item for item in papers.numbered(paper) if item not in named]


@pytest.mark.parametrize(
    "name", ["planar_4r: omega5", "fl.planar.curve_ares", "data/studies/none.toml", "spatial_4r: omega4"]
)
def test_a_name_that_is_not_there_is_noticed(name):
    assert papers.problem(name)


@pytest.mark.parametrize("test", ["tests/test_papers.py::test_nothing", "tests/test_none.py::test_nothing"])
def test_a_test_that_is_not_there_is_noticed(test):
    assert papers.test_problem(test)
