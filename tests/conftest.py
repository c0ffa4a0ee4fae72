"""What the tests share: a kernel cache of their own, random designs, the 50-digit reference."""

import gc
import os
import shutil
import tempfile

import pytest

# Before fastlink is imported anywhere: the tests neither use nor fill the user's cache. Workers share the first one's.
MADE_HERE = "FASTLINK_CACHE_DIR" not in os.environ
if MADE_HERE:
    os.environ["FASTLINK_CACHE_DIR"] = tempfile.mkdtemp(prefix="fastlink-tests-")


gc.disable()  # a quarter of the time of collecting tests, which leaves no garbage; see pytest_runtestloop
#: Objects made since the last look for garbage: with the usual 700, which compiling passes at every statement, looking
#: takes a tenth of the time of the tests.
OBJECTS = 100_000


@pytest.hookimpl(tryfirst=True)
def pytest_runtestloop():
    """Look for garbage from here on, but seldom, and not through all that was collected."""
    gc.collect()
    gc.freeze()
    gc.set_threshold(OBJECTS, 20, 20)
    gc.enable()


def pytest_unconfigure():
    if MADE_HERE:
        shutil.rmtree(os.environ["FASTLINK_CACHE_DIR"], ignore_errors=True)


@pytest.hookimpl(tryfirst=True)  # before pytest leaves out what has the mark `stress`
def pytest_collection_modifyitems(items):
    """Run some cases of a test with the mark `sample` by default, at even distances, the others by `stress`."""
    cases = {}
    for item in items:
        if item.get_closest_marker("sample"):
            cases.setdefault(item.nodeid.partition("[")[0], []).append(item)
    for found in cases.values():
        count = min(found[0].get_closest_marker("sample").args[0], len(found))  # type: ignore[union-attr]
        kept = {round((k + 0.5) * len(found) / count - 0.5) for k in range(count)}
        for k, item in enumerate(found):
            if k not in kept:
                item.add_marker("stress")


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """Return an empty folder that is the current one."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def tell(request):
    """Return a function that shows a table at the end of the session, in whatever process the test runs."""
    return lambda text: request.node.user_properties.append(("table", text))


def pytest_terminal_summary(terminalreporter):
    reports = [report for found in terminalreporter.stats.values() for report in found]
    for report in reports:
        if getattr(report, "when", None) == "call":
            for name, text in report.user_properties:
                if name == "table":
                    terminalreporter.section(report.nodeid)
                    terminalreporter.write_line(text)
