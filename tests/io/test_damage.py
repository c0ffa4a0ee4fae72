"""Bits that change in a map are noticed; whatever changes in what a killed run left, the next one ends right."""

import itertools
import os
import shutil
import warnings
import zlib
from collections import Counter
from typing import NamedTuple

import h5py
import numpy as np
import pytest
import xarray as xr
from tests.io.test_faults import sweep
from tests.support.map_files import SPACES, Sample, failing_after, left_in
from tests.support.refusals import refused
from tests.support.sweeps import sweep_4r

import fastlink as fl
from fastlink.io import checksums, partial_file
from fastlink.io.checksums import SIGNATURE, Stored, seal_is_broken
from fastlink.io.reader import open_map

LAYOUTS = ("curves", "maps")
NOTICED, RIGHT, AGAIN, WRONG = "noticed", "right", "computed again", "wrong"


class Kind(NamedTuple):
    """A kind of damage: of which file, of which of its bytes, and how often it is tried in the long and short form."""

    file: str
    region: str
    long: int
    short: int


KINDS = {
    "values of a map": Kind("map", "values", 120, 12),
    "labels of a map": Kind("map", "labels", 150, 15),
    "a map cut off": Kind("map", "end", 64, 6),
    "a partial file cut off": Kind("part", "end", 64, 2),
    "labels of a partial file": Kind("part", "labels", 222, 2),
    "values of a partial file": Kind("part", "values", 100, 2),
    "a journal's head": Kind("journal", "head", 212, 2),
    "a journal's records": Kind("journal", "records", 100, 1),
    "a journal cut off": Kind("journal", "end", 64, 1),
}


class Files:
    """A whole map, and what an interrupted run of the same request left, in a layout."""

    def __init__(self, folder, layout, patch):
        self.layout = layout
        with sweep(None, layout=layout) as found:
            self.expected = found.load()
        sweep(folder / "whole.h5", layout=layout, verify=0).close()
        with patch.context() as interrupted:
            failing_after(interrupted, 5, KeyboardInterrupt())
            with pytest.raises(KeyboardInterrupt):
                sweep(folder / "m.h5", layout=layout, verify=0)
        names = {"map": "whole.h5", "part": "m.h5.part", "journal": "m.h5.part.journal"}
        self.contents = {which: (folder / name).read_bytes() for which, name in names.items()}
        self.regions = {
            which: _of_hdf5(folder / names[which], len(self.contents[which])) for which in ("map", "part")
        }
        head = self.contents["journal"].index(b"\n") + 1
        self.regions["journal"] = {
            "head": np.arange(head),
            "records": np.arange(head, len(self.contents["journal"])),
            "end": np.arange(len(self.contents["journal"])),
        }
        shutil.rmtree(folder)

    def damaged(self, kind, rng):
        """Return the bytes of all files, one of which has one bit changed, or has lost its end."""
        content, place = bytearray(self.contents[kind.file]), rng.choice(self.regions[kind.file][kind.region])
        if kind.region == "end":
            del content[place:]
        else:
            content[place] ^= 1 << int(rng.integers(8))
        return {**self.contents, kind.file: bytes(content)}


def _of_hdf5(path, nbytes):
    """Return the bytes of the values of a file, and those before their end that are of labels; all bytes to there."""
    of_values = np.zeros(nbytes, bool)
    with h5py.File(path) as file:
        for name in str(file["checksums"].attrs["variables"]).split():
            start = file[name].id.get_offset()
            of_values[start : start + file[name].nbytes] = True
    end = (
        np.flatnonzero(of_values)[-1] + 1 if path.suffix == ".part" else nbytes
    )  # room for labels to come follows
    return {
        "values": np.flatnonzero(of_values),
        "labels": np.flatnonzero(~of_values[:end]),
        "end": np.arange(end),
    }


def checked(folder, contents):
    """Return what a check says of a changed map."""
    (folder / "m.h5").write_bytes(contents["map"])
    try:
        return WRONG if fl.check(folder / "m.h5") else NOTICED
    except fl.InputError:
        return NOTICED


def resumed(folder, contents, files):
    """Return how the run ends that goes on with changed files."""
    path = folder / "m.h5"
    (folder / "m.h5.part").write_bytes(contents["part"])
    (folder / "m.h5.part.journal").write_bytes(contents["journal"])
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", fl.InputWarning)
            sweep(path, layout=files.layout, verify=0).close()
    except fl.InputError:
        return WRONG if path.exists() else NOTICED
    assert fl.check(path)
    with open_map(path) as found:
        xr.testing.assert_equal(found, files.expected)
        return RIGHT if found.attrs.get("designs_of_earlier_runs") == 40 else AGAIN


@pytest.mark.parametrize("form", ["short", pytest.param("long", marks=pytest.mark.stress)])
def test_damage_is_noticed_or_mended(form, tmp_path, monkeypatch, small_blocks, tell):
    """Of a map all of it is noticed; nothing wrong comes of it in what an interrupted run has left."""
    rng, table, wrong = np.random.default_rng(len(form)), Counter(), []
    monkeypatch.setattr(partial_file, "STEP_SECONDS", 0.0)
    both = []
    for layout in LAYOUTS:
        (tmp_path / layout).mkdir()
        both.append(Files(tmp_path / layout, layout, monkeypatch))
    for name, kind in KINDS.items():
        for trial in range(getattr(kind, form)):
            files, folder = both[trial % 2], tmp_path / "trial"
            folder.mkdir()
            contents = files.damaged(kind, rng)
            try:
                ended = checked(folder, contents) if kind.file == "map" else resumed(folder, contents, files)
            except Exception as error:
                ended = WRONG
                wrong.append((name, trial, f"{type(error).__name__}: {error}"[:300]))
            table[name, ended] += 1
            shutil.rmtree(folder)
    tell(str(table))
    assert not sum(count for (_, end), count in table.items() if end == WRONG), (table, wrong)
    for name, kind in KINDS.items():
        all_of_kind = sum(count for (which, _), count in table.items() if which == name)
        assert kind.file != "map" or table[name, NOTICED] == all_of_kind
    for name in ("values of a partial file", "a journal's head"):
        assert form == "short" or table[name, AGAIN], "nothing was damaged that counts"


@pytest.fixture(scope="module")
def sealed(tmp_path_factory):
    """Return the paths of a map as it is written, one compressed, one joined, and one that shows its parts."""
    folder = tmp_path_factory.mktemp("sealed")
    space = fl.grid(a1=0.4, a2=np.linspace(1.0, 1.4, 7), a3=[0.6, 0.8], a4=1.0, omega1=25.0)
    quantities = ["omega4_max", "omega4_extrema"]
    found = {name: folder / f"{name}.h5" for name in ("map", "joined", "shown", "compressed")}
    sweep_4r(space, quantities, to=found["map"]).close()
    parts = [folder / f"part-{k}.h5" for k in (1, 2)]
    for k, part in enumerate(parts, 1):
        sweep_4r(space, quantities, to=part, part=(k, 2)).close()
    fl.join(parts, to=found["joined"], copy=True).close()
    fl.join(parts, to=found["shown"]).close()
    fl.convert(found["map"], to=found["compressed"], compress="gzip")
    return found


def _label_bytes(path):
    """Return the numbers of the bytes of a file that are neither values nor the checksum of the rest."""
    with h5py.File(path) as file:
        stored = Stored.of(file)
        chunked = [one.id for one in file.values() if isinstance(one, h5py.Dataset) and one.chunks]
        chunks = [one.get_chunk_info(k) for one in chunked for k in range(one.get_num_chunks())]
    places = np.ones(path.stat().st_size, bool)
    places[: len(SIGNATURE)] = False  # without it the file is no HDF5, and is refused as such
    places[stored.rest_at : stored.rest_at + 4] = False
    for one in stored.values.values():
        places[one.offset : one.offset + one.nbytes] = False
    for chunk in chunks:
        places[chunk.byte_offset : chunk.byte_offset + chunk.size] = False
    return np.flatnonzero(places)


def _damaged(path, count):
    """Yield copies of a file with one wrong bit of its labels each, the one at which HDF5 loops, and zeroed bytes."""
    whole = path.read_bytes()
    places = _label_bytes(path)
    rng = np.random.default_rng(len(whole))
    at = rng.choice(places, min(count, len(places)), replace=False)
    bits = [(int(k), 1 << int(rng.integers(8))) for k in at]
    bits += [
        (whole.index(b"GCOL") + 73, 1 << 2),
        (len(SIGNATURE), 1 << 7),
    ]  # the last makes a version that is none
    for k, bit in bits:
        yield whole[:k] + bytes([whole[k] ^ bit]) + whole[k + 1 :]
    for k in (whole.index(b"GCOL"), len(whole) - 512, len(whole) - 1400):
        yield whole[:k] + bytes(512) + whole[k + 512 :]


@pytest.mark.sample(3)
@pytest.mark.parametrize("count", [100, pytest.param(20_000, marks=pytest.mark.stress)])
@pytest.mark.parametrize("kind", ["map", "joined", "shown", "compressed"])
def test_changed_labels_are_seen_without_hdf5(kind, count, sealed, tmp_path):
    """HDF5 never returns from some of these files."""
    assert not seal_is_broken(sealed[kind])
    path = tmp_path / "damaged.h5"
    for content in _damaged(sealed[kind], count):
        path.write_bytes(content)
        assert seal_is_broken(path)


#: Functions of a map and of a variable of it.
DOORS = [
    lambda path, name: fl.open(path),
    lambda path, name: fl.best(path, minimise=name),
    lambda path, name: fl.convert(path, to=path.with_name("new.csv")),
    lambda path, name: fl.join([path], to=path.with_name("new.h5")),
    lambda path, name: fl.plot(path, name, to=path.with_name("new.png")),
    lambda path, name: fl.plot(path, [name, "a2"], to=path.with_name("new.png")),
    lambda path, name: fl.draw(path, design=1, to=path.with_name("new.png")),
    lambda path, name: fl.tolerance(path, a1=1e-3),
    lambda path, name: fl.explore(path, to=path.with_name("new.html")),
]


def test_no_door_lets_hdf5_read_changed_labels(sealed, tmp_path):
    path = tmp_path / "damaged.h5"
    content = sealed["map"].read_bytes()
    k = content.index(b"GCOL") + 73
    path.write_bytes(content[:k] + bytes([content[k] ^ 4]) + content[k + 1 :])
    assert not fl.check(path)
    space = fl.grid(a1=0.4, a2=[1.0, 1.2], a3=0.8, a4=1.0, omega1=25.0)
    for door in DOORS:
        with pytest.raises(fl.InputError, match="labels or attributes have changed"):
            door(path, "omega4_max")
    # what stands where a sweep is to write is no map, and is not replaced
    with pytest.raises(fl.InputError, match="and is not a map"):
        sweep_4r(space, ["omega4_max"], to=path)


@pytest.mark.parametrize("engine", ["h5netcdf", "netcdf4"])
def test_other_readers_do_not_mind_the_seal(engine, sealed):
    for path in sealed.values():
        with xr.open_dataset(path, engine=engine) as found, fl.open(path) as maps:
            xr.testing.assert_identical(found.load(), maps.load())


def test_a_map_that_hdf5_has_changed_since_opens(sealed, tmp_path):
    path = tmp_path / "edited.h5"
    shutil.copy(sealed["map"], path)
    with h5py.File(path, "r+") as file:
        file.attrs["note"] = "for the workshop"
    with fl.open(path) as maps:
        assert maps.attrs["note"] == "for the workshop"
    assert not fl.check(path)


def of_a_stranger(path, secret, kind):
    """Make a map of HDF5 that takes values from another file, or tells of values that it does not hold."""
    with h5py.File(path, "w") as file:
        file.attrs["fastlink_map"] = np.int64(1)
        file["a2"] = [1.0, 1.2]
        file["a2"].make_scale("a2")
        group = file.create_group("checksums")
        group.attrs.update({"algorithm": "crc32", "block_bytes": 65536, "variables": "x"})
        group["values"], group["rest"] = np.zeros(1, "u4"), np.zeros(1, "u4")
        if kind == "a link":
            file["x"] = h5py.ExternalLink(secret, "x")
        elif kind == "a link in a group":
            file["whole/x"] = h5py.ExternalLink(secret, "x")
        elif kind == "storage":
            file.create_dataset("x", (2,), "f8", external=[(str(secret), 0, 16)])
        elif kind == "a virtual dataset":
            layout = h5py.VirtualLayout((2,), "f8")
            layout[:] = h5py.VirtualSource(secret, "x", (2,))
            file.create_virtual_dataset("x", layout)
        elif kind == "many values":
            file.create_dataset("x", (10**12,), "f8")
        elif kind == "many chunks":
            file.create_dataset("x", (10**12,), "f8", chunks=(1000,))
        elif kind == "blocks of no bytes":
            file["x"] = [1.0, 2.0]
            group.attrs["block_bytes"] = 0
        if (
            "x" in file
            and "many" not in kind
            and not isinstance(file.get("x", getlink=True), h5py.ExternalLink)
        ):
            file["x"].dims[0].attach_scale(file["a2"])


@pytest.mark.parametrize(
    "kind",
    [
        "a link",
        "a link in a group",
        "storage",
        "a virtual dataset",
        "many values",
        "many chunks",
        "blocks of no bytes",
    ],
)
def test_what_maps_of_strangers_do_not_hold_themselves_is_not_read(tmp_path, kind):
    secret, path = tmp_path / "secret.h5", tmp_path / "m.h5"
    with h5py.File(secret, "w") as file:
        file["x"] = [3.0, 4.0]
    of_a_stranger(path, secret, kind)
    with refused(path.name):
        fl.check(path)
    for door in [] if kind == "blocks of no bytes" else DOORS:
        with refused(path.name):
            door(path, "x")
    assert left_in(tmp_path) == ["m.h5", "secret.h5"]


# == A byte that changes in a map is found ===================================================================


def test_a_sum_of_pieces_in_any_order_is_the_crc_of_the_block():
    rng = np.random.default_rng(0)
    size = checksums.BLOCK_BYTES
    nbytes = 2 * size + 12_345
    data = memoryview(rng.bytes(nbytes))
    cuts = [0, *sorted(map(int, rng.integers(0, nbytes, 30))), nbytes]
    pieces = [(start, data[start:stop]) for start, stop in itertools.pairwise(cuts)]
    assert len(pieces) > checksums.FEW
    rng.shuffle(pieces)
    expected = {k: zlib.crc32(data[k * size : (k + 1) * size]) for k in range(3)}
    for groups in ([pieces], [[piece] for piece in pieces]):
        sums = {}
        for some in groups:
            checksums.add(sums, checksums.of_pieces(some, nbytes))
        assert sums == expected


@pytest.mark.parametrize("space", SPACES.values(), ids=SPACES)
def test_checksums_are_read_without_fastlink(tmp_path, space, small_blocks):
    """As the attribute `algorithm` says."""
    path = Sample(space).save(tmp_path / "m.h5")
    assert fl.check(path)
    whole = bytearray(path.read_bytes())
    with h5py.File(path) as file:
        group = file["checksums"]
        size, names = int(group.attrs["block_bytes"]), group.attrs["variables"].split()
        values = [file[name][()].tobytes() for name in names]
        places = [(file[name].id.get_offset(), file[name].nbytes) for name in names]
        said, rest, at = group["values"][:], group["rest"][0], group["rest"].id.get_offset()
    assert said.tolist() == [zlib.crc32(v[k : k + size]) for v in values for k in range(0, len(v), size)]
    whole[at : at + 4] = bytes(4)
    for offset, nbytes in sorted(places, reverse=True):
        del whole[offset : offset + nbytes]
    assert rest == zlib.crc32(whole)


def test_what_has_changed_is_told(tmp_path, small_blocks):
    path = tmp_path / "m.h5"
    sweep(path).close()
    assert str(fl.check(path)).endswith("is as it was written")
    with h5py.File(path, "r+") as file:
        start = file["theta4"].id.get_offset()
        file["theta4"].attrs["units"] = "deg"
    with open(path, "r+b") as file:
        file.seek(start + 300)
        file.write(b"changed!")
    found = fl.check(path)
    assert not found
    assert (found.damaged, found.rest_is_intact) == ({"theta4": [(32, 63)]}, False)
    assert "values of theta4 have changed, between number 32 and 63" in str(found)


@pytest.mark.skipif(not os.path.exists("/proc/self/mem"), reason="of Linux")
def test_files_without_checksums_and_files_that_cannot_be_read_are_refused(tmp_path):
    """HDF5 adds the time and an address, which differ from call to call."""
    with refused("cannot be read (Input/output error)", "give a map that a sweep has written"):
        fl.check("/proc/self/mem")
    path = Sample().save(tmp_path / "m.h5")
    with h5py.File(path, "r+") as file:
        del file["checksums"]
    with refused("m.h5", "write it again"):
        fl.check(path)
