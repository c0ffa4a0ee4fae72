"""Tables as people have them in CSV files, each with the numbers that it means."""

from __future__ import annotations

import random
from collections.abc import Iterator
from typing import Any

from tests.hostile.values import EITHER, REFUSED, TAKEN, texts_of

BASE = {"a1": 0.4, "a2": 1.2, "a3": 0.8, "a4": 1.0, "omega1": 25.0}
#: Texts of one cell by what may come of them; ``{x}`` is a number, ``{comma}`` the same with a decimal comma.
CELLS = {
    TAKEN: ["{x}", " {x} ", '"{x}"', "+{x}", "{x}e0", "{x}E+00", "{x}" + "0" * 5000],
    EITHER: ['"{comma}"', "'{x}'", "{x}f", "{x}d0", "{x}\u00a0", "\u2009{x}", "{x}\t"],
    REFUSED: [
        *texts_of(
            """
            nan   NaN   inf   -Infinity   1e400   -1e999   x   ={x}   =A1*2   {x} m   {x}cm   0x1p3   TRUE   None   #N/A
            1_0   1'000   --1   1.2.3   {x}%   1e   1/2   $1   2020-01-01   12:30   {x}j   '   -
            "1,200.5"   1 200   "1.200,5"   "1,234"   "{x}   {x}"   ""   "{x}"1   "{x}'
            """
        ),
        *("", "1" * 400, "é" * 100_000, "\x00", "{x}\x00", "\x1b[31m"),
    ],
}
#: Names in line 1 that are none, and what they stand for.
HEADERS = {
    TAKEN: ["{n}", " {n} ", '"{n}"', "{n}\t"],
    REFUSED: ["", " ", "a2", "1.5", "nan", "#{n}", "{n};{n}", "{n}\x00"],
    EITHER: ["{n} [m]", "{n}.1", "Ä", "\x1b", "__class__", "x" * 2000],
}
#: How lines are joined to bytes: separator, end of line, encoding.
FORMATS = {
    TAKEN: [(",", "\n", "utf-8"), (",", "\r\n", "utf-8"), (",", "\n", "utf-8-sig"), (", ", "\n", "utf-8")],
    EITHER: [(",", "\r", "utf-8"), (";", "\n", "utf-8"), ("\t", "\n", "utf-8")],
    REFUSED: [
        *((separator, "\n", "utf-8") for separator in (" ", "|", "", ",,")),
        *((",", "\n", encoding) for encoding in ("utf-16", "utf-16-le", "utf-32", "cp037")),
        (",", "", "utf-8"),
    ],
}
#: Further lines of a file, put anywhere.
LINES = ["1", "1,2,3,4,5,6,7", ",".join(BASE), "# a comment", "a1", '"', "\x00", "\x1a", "é", "\ufeff1"]


def pick(rng: random.Random, choices: dict[str, list[Any]]) -> tuple[str, Any]:
    """Return an entry, all as likely, and what may come of it."""
    return rng.choice([(verdict, one) for verdict, entries in choices.items() for one in entries])


def bytes_changed(rng: random.Random, data: bytes) -> bytes:
    """Return a text with a few bytes flipped, cut off, put in or left out."""
    place = rng.randrange(len(data))
    before, after = data[:place], data[place:]
    flipped = before + bytes([after[0] ^ 1 << rng.randrange(8)]) + after[1:]
    return rng.choice(
        [flipped, before, before + rng.randbytes(2) + after, before + after[rng.randrange(1, 6) :]]
    )


def tables(seed: int, count: int) -> Iterator[tuple[str, str, str, str]]:
    """Yield the call, what may come of it, source text and plain text of the tables of a seed."""
    rng = random.Random(seed)
    for _ in range(count):
        columns = {
            name: [round(x * (1.0 + 0.01 * rng.randrange(10)), 6) for _ in range(3)]
            for name, x in BASE.items()
        }
        header, rows = list(columns), [list(map(str, row)) for row in zip(*columns.values(), strict=True)]
        verdicts, what = [], rng.choice(["cell", "name", "format", "line", "bytes"])
        if what == "cell":
            verdict, text = pick(rng, CELLS)
            row, k = rng.choice(rows), rng.randrange(5)
            row[k] = text.replace("{x}", row[k]).replace("{comma}", row[k].replace(".", ","))
            verdicts.append(verdict)
        elif what == "name":
            verdict, text = pick(rng, HEADERS)
            header[4] = text.replace("{n}", "omega1")
            columns = {header[4] if verdict == EITHER and k == "omega1" else k: x for k, x in columns.items()}
            verdicts.append(verdict)
        how = pick(rng, FORMATS) if what == "format" else (TAKEN, FORMATS[TAKEN][0])
        separator, end, encoding = how[1]
        lines = [separator.join(line) for line in (header, *rows)]
        if what == "line":
            lines.insert(rng.randrange(1, 5), rng.choice(LINES))
            verdicts.append(REFUSED)
        data = end.join(lines).encode(encoding, "replace")
        data = bytes_changed(rng, data) if what == "bytes" else data
        verdict = next((one for one in (REFUSED, EITHER) if one in (*verdicts, how[0])), TAKEN)
        door = "fl.table(SOURCE)" if rng.random() < 0.7 else "swept(fl.table(SOURCE))"
        source = f"written({data!r})"
        yield (door, EITHER, source, source) if what == "bytes" else (door, verdict, source, repr(columns))
