"""Pictures, films, pages and measurements: an older file of the name stays until the new one is whole."""

import errno
import os

import numpy as np
import pytest
from tests.support.refusals import refused
from tests.support.sweeps import sweep_4r

import fastlink as fl

DESIGN = {"a1": 0.4, "a2": 1.1, "a3": 0.8, "a4": 1.0}
STUDY = """
mechanism = "planar_4r"
quantities = ["grashof_excess"]
design = {a1 = 0.4, a2 = {linspace = [1.0, 1.3, 9]}, a3 = 0.8, a4 = 1.0}
"""


@pytest.fixture(scope="module")
def maps():
    space = fl.grid(**(DESIGN | {"a2": np.linspace(1.0, 1.3, 9), "a3": [0.7, 0.8], "omega1": 1.0}))
    return sweep_4r(space, ["omega4_max"])


def plot(path, maps, folder):
    fl.plot(maps, "omega4_max", to=path)


def draw(path, maps, folder):
    fl.draw("planar_4r", **DESIGN, to=path)


def animate(path, maps, folder):
    fl.draw("planar_4r", **DESIGN, animate=path, frames=3)


def explore(path, maps, folder):
    fl.explore(maps, to=path)


def accuracy(path, maps, folder, **options):
    study = folder / "study.toml"
    study.write_text(STUDY)
    kind = {"picture": path} if path.suffix == ".png" else {"to": path}
    fl.accuracy(study, designs=2, overwrite=True, **kind, **options)


DOORS = [
    (plot, "to", "map.png"),
    (draw, "to", "linkage.svg"),
    (animate, "animate", "linkage.gif"),
    (animate, "animate", "linkage.html"),
    (explore, "to", "page.html"),
    (accuracy, "to", "measured.h5"),
    (accuracy, "picture", "measured.png"),
]


@pytest.mark.sample(2)
@pytest.mark.parametrize(("write", "key", "name"), DOORS, ids=[f"{d.__name__} {n}" for d, _, n in DOORS])
def test_an_older_file_stays_until_the_new_one_is_whole(write, key, name, maps, tmp_path, monkeypatch):
    folder = tmp_path / "made"
    folder.mkdir()
    path = folder / name
    path.write_bytes(b"older")

    def full(fd):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    with monkeypatch.context() as patched, refused(key, "make room"):
        patched.setattr(os, "fsync", full)
        write(path, maps, tmp_path)
    assert path.read_bytes() == b"older"
    assert os.listdir(folder) == [name]
    link = tmp_path / f"link{path.suffix}"
    link.symlink_to(path)
    write(link, maps, tmp_path)
    assert link.is_symlink()
    assert len(path.read_bytes()) > 1000
    assert os.listdir(folder) == [name]


def test_what_a_killed_run_left_is_not_replaced_by_a_measurement(tmp_path):
    path = tmp_path / "maps.h5"
    space = fl.grid(**(DESIGN | {"a2": np.linspace(1.0, 1.3, 9), "omega1": 1.0}))
    sweep_4r(space, ["omega4_max"], verify=0, to=path).close()
    os.rename(path, f"{path}.part")
    with refused("to", "rename or remove it"):
        accuracy(path, None, tmp_path)
    assert fl.check(f"{path}.part")
