"""A map that is there already: used where it is that of the request, else refused with what differs."""

import os
import shutil
import time
from pathlib import Path

import h5py
import numpy as np
import pytest
from tests.support.refusals import refused

import fastlink as fl
from fastlink.codegen.kernel import Kernel
from fastlink.io.finished import WRITTEN
from fastlink.io.layout import FINGERPRINT

DESIGNS = {"a1": 0.4, "a2": np.array([1.1, 1.2]), "a3": 0.8, "a4": 1.0, "omega1": 2.0}
REQUEST = {"mechanism": "planar_4r", "space": DESIGNS, "quantities": ["omega4"], "theta1": 12, "verify": 2}


def swept(path, **changes):
    request = {name: value for name, value in {**REQUEST, **changes}.items() if value is not None}
    names = [request.pop(name) for name in ("mechanism", "space", "quantities")]
    names[1] = names[1] if isinstance(names[1], fl.DesignSpace) else fl.grid(**names[1])
    return fl.sweep(*names, to=path, **{"branch": (1, 2)} | request)


@pytest.fixture(scope="module")
def original(tmp_path_factory):
    """Return the path of a finished map."""
    path = tmp_path_factory.mktemp("finished") / "maps.h5"
    swept(path).close()
    return path


@pytest.fixture
def path(original, tmp_path):
    """Return the path of a finished map of the test alone."""
    return Path(shutil.copy2(original, tmp_path / "maps.h5"))


@pytest.fixture
def nothing_is_compiled(monkeypatch):
    monkeypatch.setattr(Kernel, "compiled", lambda *_: pytest.fail("compiled"))


@pytest.mark.parametrize("same", [{}, {"verify": 1, "threads": 1, "block": 1}])
def test_the_same_request_opens_the_map(path, same, nothing_is_compiled):
    before = path.stat()
    with swept(path, **same) as maps:
        assert maps.omega4.shape == (2, 2, 12)
        assert maps.attrs[WRITTEN] == before.st_mtime_ns
        assert len(maps.attrs[FINGERPRINT]) == 64
    assert (path.stat().st_mtime_ns, path.stat().st_ino) == (before.st_mtime_ns, before.st_ino)


@pytest.mark.parametrize(
    ("change", "differs"),
    [
        ({"quantities": ["omega4", "theta4"]}, "quantities"),
        ({"space": {**DESIGNS, "a3": np.nextafter(0.8, 1.0)}}, "a3"),
        ({"theta1": 13}, "theta1"),
        ({"branch": [2, 1]}, "branch"),
        ({"attrs": {"project": "press"}}, "project"),
        (
            {
                "mechanism": "focal",
                "space": {"a": 2.0, "b": 3.0, "c": 4.0, "d": 5.0, "s": 1.0},
                "quantities": ["m"],
                "theta1": None,
            },
            "",
        ),
        ({"verify": 3, "space": {**DESIGNS, "a2": [1.1, 1.2, 1.3]}}, "a2"),
    ],
)
def test_another_request_is_refused_with_what_differs(path, change, differs, nothing_is_compiled):
    before = path.read_bytes()
    with refused(
        f"the file exists, a map {'with other ' + differs if differs else 'of planar_4r'}", "overwrite=True"
    ):
        swept(path, **change)
    assert path.read_bytes() == before


def test_long_attributes_are_compared_to_their_last_value(tmp_path):
    values = np.arange(5000.0)
    swept(tmp_path / "maps.h5", attrs={"weights": values}).close()
    swept(tmp_path / "maps.h5", attrs={"weights": values}).close()
    with refused("other weights"):
        swept(tmp_path / "maps.h5", attrs={"weights": np.where(values == 2500.0, -1.0, values)})


def test_a_table_that_changed_since_is_another_request(tmp_path):
    path, table = tmp_path / "maps.h5", tmp_path / "designs.csv"
    table.write_text("a1,a2\n0.4,1.1\n0.5,1.2\n")
    constants = {"a3": 0.8, "a4": 1.0, "omega1": 2.0}
    swept(path, space=fl.table(table).with_constants(constants)).close()
    swept(path, space=fl.table(table).with_constants(constants)).close()
    table.write_text("a1,a2\n0.4,1.1\n0.5,1.3\n")
    with refused("other a2"):
        swept(path, space=fl.table(table).with_constants(constants))


def test_a_map_that_was_changed_since_is_not_up_to_date(path, tmp_path):
    time.sleep(0.02)  # two ticks of a kernel's clock of 100 Hz
    with h5py.File(path, "r+") as file:
        file["omega4"][0, 0, 0] = 7.0
    with refused("changed or copied since it was written", "overwrite=True"):
        swept(path)
    with swept(path, overwrite=True) as maps:
        assert float(maps.omega4[0, 0, 0]) != 7.0
    shutil.copy2(path, tmp_path / "copy.h5")
    swept(tmp_path / "copy.h5").close()  # a copy with its times
    os.utime(path, ns=(0, path.stat().st_mtime_ns // 10**9 * 10**9))
    swept(path).close()  # moved to a file system that knows whole seconds


def test_more_verified_designs_than_there_are_is_another_request(tmp_path):
    swept(tmp_path / "maps.h5", verify=0).close()
    with refused("with 0 verified designs, not 2"):
        swept(tmp_path / "maps.h5", verify=64)


def test_a_map_by_another_version_is_not_up_to_date(path, monkeypatch):
    from fastlink.engine import labels, resolve

    monkeypatch.setattr(labels, "__version__", "9.9")
    with refused("other versions"):
        swept(path)
    monkeypatch.undo()
    monkeypatch.setattr(resolve, "environment", lambda: b"other code")
    with refused("a map by another version"):
        swept(path)
