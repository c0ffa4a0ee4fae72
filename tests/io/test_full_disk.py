"""Disks that fill up as a map is converted: file systems of a few megabytes, filled up by another program."""

import contextlib
import os
import subprocess
import sys
import warnings

import numpy as np
import pytest
from numpy.testing import assert_array_equal
from tests.support.map_files import left_in
from tests.support.refusals import refused
from tests.support.sweeps import sweep_4r

import fastlink as fl
from fastlink.io.convert import Source

pytestmark = pytest.mark.filterwarnings("default:NOT TESTED")
COUPLERS = np.linspace(1.0, 1.4, 120)


def sweep(to, **options):
    """Make a map of some 500 kB."""
    space = fl.grid(a1=0.4, a2=COUPLERS, a3=[0.7, 0.8], a4=1.0, omega1=2.0)
    given = {"theta1": 90, "block": 16, "threads": 1, "verify": 0, "to": to, **options}
    return sweep_4r(space, ["omega4_max", "theta4"], **given)


class Disk:
    """A file system of 4 MiB."""

    def __init__(self, folder):
        self.folder = folder
        folder.mkdir()
        command = ["mount", "-t", "tmpfs", "-o", "size=4m", "none", str(folder)]
        done = subprocess.run(command, check=False, capture_output=True, text=True)
        if done.returncode:
            raise PermissionError(done.stderr.strip())

    def fill(self, left=0):
        """Let another program take all of it but so many bytes."""
        status = os.statvfs(self.folder)
        with open(self.folder / "other", "ab", buffering=0) as file, contextlib.suppress(OSError):
            file.write(bytes(max(0, status.f_bavail * status.f_frsize - left)))

    def make_room(self):
        """Take away what the other program wrote."""
        (self.folder / "other").unlink(missing_ok=True)


@pytest.fixture
def disk(tmp_path):
    """A small disk, or a loud skip."""
    try:
        made = Disk(tmp_path / "disk")
    except OSError as error:
        warnings.warn(f"NOT TESTED: full disks, none can be mounted here ({error})", stacklevel=1)
        pytest.skip(f"no disk can be mounted: {error}")
    yield made
    subprocess.run(["umount", "--lazy", str(made.folder)], check=True)


@pytest.fixture(scope="module")
def source(tmp_path_factory):
    """A folder on a good disk with the map."""
    folder = tmp_path_factory.mktemp("source")
    sweep(folder / "m.h5").close()
    return folder


CONVERSIONS = {
    "o.h5": {},
    "z.h5": {"compress": "gzip:1"},
    "o.zarr": {},
    "o.csv": {"select": {"theta1": "#0:20"}},
    "o.parquet": {},
}


@pytest.mark.sample(2)
@pytest.mark.parametrize(("name", "options"), CONVERSIONS.items(), ids=CONVERSIONS)
def test_a_disk_that_fills_up_during_a_conversion(disk, monkeypatch, source, name, options):
    path, read = disk.folder / name, Source.read
    fl.convert(source / "m.h5", path, quantities=["omega4_max"])
    before = sorted((str(file), file.read_bytes()) for file in disk.folder.rglob("*") if file.is_file())

    def filled(self, variable, index):
        disk.fill()
        return read(self, variable, index)

    with monkeypatch.context() as patch:
        patch.setattr(Source, "read", filled)
        patch.delattr(os, "posix_fallocate")
        with refused("to", "make room"):
            fl.convert(source / "m.h5", path, overwrite=True, **options)
    disk.make_room()
    after = sorted((str(file), file.read_bytes()) for file in disk.folder.rglob("*") if file.is_file())
    assert after == before
    fl.convert(source / "m.h5", path, overwrite=True, **options)
    if name.endswith((".h5", ".zarr")):
        with fl.open(path) as found, fl.open(source / "m.h5") as whole:
            assert_array_equal(found.theta4, whole.theta4)
    assert left_in(disk.folder) == [name]


COMPRESSED = """
import os, sys
import fastlink as fl
from fastlink.io.convert import Source
from tests.io.test_full_disk import Disk
read, disk = Source.read, Disk.__new__(Disk)
disk.folder = __import__("pathlib").Path(sys.argv[1]).parent
def filled(self, variable, index):
    disk.fill()
    return read(self, variable, index)
Source.read = filled
try:
    fl.convert(sys.argv[2], sys.argv[1], compress="gzip:1")
except fl.InputError:
    print("refused")
"""


def test_a_process_whose_compressed_file_had_no_room_ends_well(disk, source):
    """HDF5 tries to write again as the process ends, and once ended it by a violation of memory."""
    done = subprocess.run(
        [sys.executable, "-c", COMPRESSED, str(disk.folder / "z.h5"), str(source / "m.h5")],
        check=False,
        capture_output=True,
        text=True,
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "refused\n", "")
