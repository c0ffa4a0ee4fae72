"""Command lines with words changed, dropped, doubled and exchanged."""

from __future__ import annotations

import random
from collections.abc import Iterator

from tests.hostile.values import texts_of

#: Lines that run, in a folder with study.toml and maps.h5.
LINES = """
new planar_4r
quantities hart
quantities planar_4r --input joint_angle_2
explain study.toml
run study.toml --to changed.h5 --overwrite --threads 1 --verify 0
run study.toml --part 1/1 --to changed.h5 --overwrite --quiet
run study.toml --to changed.h5 --overwrite --restart --layout maps --quiet
join part.h5 --to changed.h5 --overwrite --quiet
join part.h5 --to changed.h5 --copy --overwrite --quiet
info maps.h5
check maps.h5
plot maps.h5 omega4_max --branch 1 --to changed.png
plot maps.h5 omega4_max --at a2=1.2 --to changed.png
draw slider_crank r=0.1 l=0.3 e=0.02 theta_deg=50 --branch 1 --to changed.png
draw study.toml theta1=1 --design 2 --show circles --to changed.png
accuracy no.toml --designs 2 --to changed.h5
--version
plot --help
""".strip().splitlines()
#: Words that stand for anything.
WORDS = texts_of(
    r"""
    - -- --- -1 0 3 2.5 nan inf 1e3 1e400 ١ 1_0 None True x no.toml study.toml maps.h5 . .. / folder loop
    no/such/a.h5 table.csv ä€𝄞 ~nosuchuser/a file:///a C:\a.h5 * $HOME a;b a.h5/ planar_4r planar4r PLANAR_4R
    omega4 omega4_max theta1 joint_angle_9 status __class__ a2 a2= =1 a2=x a2=nan a2=1=2 a9=1 branch=1 a2=1e400
    a2=99 a2=0x1 a2=1_0 = A2=1.2 --to --nosuch --branch --overwrite --overwrite=yes --threads=0
    --threads=99999999999999999999 --help -h --verify=-1 --part=2/1 --dask= --dask=no/such.json
    --dask=tcp://nosuch --input= --all --designs=0 --to= --quiet --verify=1.5 --branch=3 --at= --version
    /dev/null /dev/null/a.h5 /proc/self/mem changed.h5.part study.toml/a changed.gif changed .png changed.PNG
    """,
    r"\s+",
)
WORDS += ["", " ", "1" * 400, "a" * 5000, "a" * 300 + ".h5", "\x1b[31m", "a\nb", "a\tb", "\udcff", "\ufffe"]


def command_lines(seed: int, count: int) -> Iterator[list[str]]:
    """Yield the words of the command lines of a seed."""
    rng = random.Random(seed)
    for _ in range(count):
        words = rng.choice(LINES).split()
        place = rng.randrange(len(words))
        kind = rng.choice(["another", "more", "less", "exchanged", "two", "sign"])
        if kind in ("another", "two"):
            words[place] = rng.choice(WORDS)
        if kind in ("more", "two"):
            words.insert(rng.randrange(len(words) + 1), rng.choice(WORDS))
        elif kind == "less":
            del words[place]
        elif kind == "exchanged":
            other = rng.randrange(len(words))
            words[place], words[other] = words[other], words[place]
        elif kind == "sign":
            k = rng.randrange(len(words[place]) + 1)
            words[place] = (
                words[place][:k] + rng.choice("-_=.x0é\x7f ") + words[place][k + rng.randrange(2) :]
            )
        if not {"cache", "--clear"} & set(words):
            yield words
