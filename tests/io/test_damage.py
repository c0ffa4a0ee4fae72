"""Bits that change in a map are noticed; whatever changes in what a killed run left, the next one ends right."""

from __future__ import annotations

import shutil
import warnings
from collections import Counter
from pathlib import Path
from typing import Any, NamedTuple

import h5py
import numpy as np
import pytest
import xarray as xr
from tests.io.test_faults import failing_after, sweep

import fastlink as fl
from fastlink.io.reader import open_map
from fastlink.io.writing import journal

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
    """A whole map, and what an interrupted run of the same request left, in a layout.

    Attributes
    ----------
    contents : dict
        The bytes of each file.
    regions : dict
        The numbers of the bytes of each region of each file.
    """

    def __init__(self, folder: Path, layout: str, patch: pytest.MonkeyPatch) -> None:
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

    def damaged(self, kind: Kind, rng: Any) -> dict[str, bytes]:
        """Return the bytes of all files, one of which has one bit changed, or has lost its end."""
        content, place = bytearray(self.contents[kind.file]), rng.choice(self.regions[kind.file][kind.region])
        if kind.region == "end":
            del content[place:]
        else:
            content[place] ^= 1 << int(rng.integers(8))
        return {**self.contents, kind.file: bytes(content)}


def _of_hdf5(path: Path, nbytes: int) -> dict[str, Any]:
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


def checked(folder: Path, contents: dict[str, bytes]) -> str:
    """Return what a check says of a changed map."""
    (folder / "m.h5").write_bytes(contents["map"])
    try:
        return WRONG if fl.check(folder / "m.h5") else NOTICED
    except fl.InputError:
        return NOTICED


def resumed(folder: Path, contents: dict[str, bytes], files: Files) -> str:
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


def outcomes(tmp_path, patch, form, seed):
    """Return how often each kind of damage ended how, and what was wrong."""
    rng, table, wrong = np.random.default_rng(seed), Counter(), []
    patch.setattr(journal, "STEP_SECONDS", 0.0)
    both = []
    for layout in LAYOUTS:
        (tmp_path / layout).mkdir()
        both.append(Files(tmp_path / layout, layout, patch))
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
    return table, wrong


def report(table, wrong):
    """Return the table of outcomes as text."""
    ends = (NOTICED, RIGHT, AGAIN, WRONG)
    lines = [f"{'damage':<26}{'tried':>6}{''.join(f'{end:>16}' for end in ends)}"]
    for name in KINDS:
        counts = [table[name, end] for end in ends]
        lines.append(f"{name:<26}{sum(counts):>6}{''.join(f'{count:>16}' for count in counts)}")
    return "\n".join([*lines, *map(repr, wrong)])


def assert_none_is_wrong(table, wrong):
    assert not sum(count for (_, end), count in table.items() if end == WRONG), report(table, wrong)
    assert all(
        table[name, NOTICED] == sum(n for (which, _), n in table.items() if which == name)
        for name, kind in KINDS.items()
        if kind.file == "map"
    )


def test_damage_is_noticed_or_mended(tmp_path, monkeypatch, small_blocks):
    assert_none_is_wrong(*outcomes(tmp_path, monkeypatch, "short", seed=1))


@pytest.mark.stress
def test_damage_is_noticed_or_mended_a_thousand_times(tmp_path, monkeypatch, small_blocks, tell):
    table, wrong = outcomes(tmp_path, monkeypatch, "long", seed=2)
    tell(report(table, wrong))
    assert_none_is_wrong(table, wrong)
    for name in ("values of a partial file", "a journal's head"):
        assert table[name, AGAIN], "nothing was damaged that counts"
