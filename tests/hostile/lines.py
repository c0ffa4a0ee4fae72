"""Command lines with words changed, dropped, doubled and exchanged."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

#: Lines that run, in a folder with study.toml and maps.h5.
LINES = [
    ["new", "planar_4r"],
    ["quantities", "hart"],
    ["quantities", "planar_4r", "--input", "joint_angle_2"],
    ["explain", "study.toml"],
    ["run", "study.toml", "--to", "changed.h5", "--overwrite", "--threads", "1", "--verify", "0"],
    ["run", "study.toml", "--to", "changed.h5", "--overwrite", "--quiet"],
    ["run", "study.toml", "--part", "1/1", "--to", "changed.h5", "--overwrite", "--quiet"],
    ["run", "study.toml", "--to", "changed.h5", "--overwrite", "--restart", "--layout", "maps", "--quiet"],
    ["join", "part.h5", "--to", "changed.h5", "--overwrite", "--quiet"],
    ["join", "part.h5", "--to", "changed.h5", "--copy", "--overwrite", "--quiet"],
    ["info", "maps.h5"],
    ["check", "maps.h5"],
    ["plot", "maps.h5", "omega4_max", "--branch", "1", "--to", "changed.png"],
    ["plot", "maps.h5", "omega4_max", "--at", "a2=1.2", "--to", "changed.png"],
    [
        "draw",
        "slider_crank",
        "r=0.1",
        "l=0.3",
        "e=0.02",
        "theta_deg=50",
        "--branch",
        "1",
        "--to",
        "changed.png",
    ],
    ["draw", "study.toml", "theta1=1", "--design", "2", "--show", "circles", "--to", "changed.png"],
    ["accuracy", "no.toml", "--designs", "2", "--to", "changed.h5"],
    ["--version"],
    ["--help"],
    ["plot", "--help"],
]
#: Words that stand for anything.
WORDS = [
    *(
        "",
        " ",
        "-",
        "--",
        "---",
        "-1",
        "0",
        "3",
        "2.5",
        "nan",
        "inf",
        "1e3",
        "1e400",
        "1" * 400,
        "١",
        "1_0",
        "None",
        "True",
        "x",
    ),
    *(
        "no.toml",
        "study.toml",
        "maps.h5",
        ".",
        "..",
        "/",
        "folder",
        "loop",
        "a" * 5000,
        "a" * 300 + ".h5",
        "no/such/a.h5",
        "table.csv",
    ),
    *(
        "\x1b[31m",
        "a\nb",
        "ä€𝄞",
        "\udcff",
        "\ufffe",
        "a\tb",
        "~nosuchuser/a",
        "file:///a",
        "C:\\a.h5",
        "*",
        "$HOME",
        "a;b",
        "a.h5/",
    ),
    *(
        "planar_4r",
        "planar4r",
        "PLANAR_4R",
        "omega4",
        "omega4_max",
        "theta1",
        "joint_angle_9",
        "status",
        "__class__",
        "a2",
    ),
    *(
        "a2=",
        "=1",
        "a2=x",
        "a2=nan",
        "a2=1=2",
        "a9=1",
        "branch=1",
        "a2=1e400",
        "a2=99",
        "a2=0x1",
        "a2=1_0",
        "=",
        "a2",
        "A2=1.2",
    ),
    *(
        "--to",
        "--nosuch",
        "--branch",
        "--overwrite",
        "--overwrite=yes",
        "--threads=0",
        "--threads=99999999999999999999",
        "--help",
        "-h",
    ),
    *(
        "--verify=-1",
        "--part=2/1",
        "--dask=",
        "--dask=no/such.json",
        "--dask=tcp://nosuch",
        "--input=",
        "--all",
        "--designs=0",
        "--to=",
        "--quiet",
        "--verify=1.5",
        "--branch=3",
        "--at=",
        "--version",
    ),
    *(
        "/dev/null",
        "/dev/null/a.h5",
        "/proc/self/mem",
        "changed.h5.part",
        "study.toml/a",
        "changed.gif",
        "changed",
        ".png",
        "changed.PNG",
    ),
]


def command_lines(seed: int, count: int) -> Iterator[tuple[str, list[str]]]:
    """Yield the kind and the words of the command lines of a seed."""
    rng = np.random.default_rng(seed)
    for _ in range(count):
        words = list(LINES[rng.integers(len(LINES))])
        kind = str(
            rng.choice(
                ["another word", "a word more", "a word less", "words exchanged", "two words", "a sign"]
            )
        )
        place = int(rng.integers(len(words)))
        if kind in ("another word", "two words"):
            words[place] = WORDS[rng.integers(len(WORDS))]
        if kind in ("a word more", "two words"):
            words.insert(int(rng.integers(len(words) + 1)), WORDS[rng.integers(len(WORDS))])
        elif kind == "a word less":
            del words[place]
        elif kind == "words exchanged":
            other = int(rng.integers(len(words)))
            words[place], words[other] = words[other], words[place]
        elif kind == "a sign":
            word = words[place]
            k = int(rng.integers(len(word) + 1))
            words[place] = word[:k] + str(rng.choice(list("-_=.x0é\x7f "))) + word[k + int(rng.integers(2)) :]
        if not {"cache", "--clear"} & set(words):
            yield kind, words
