"""Texts as people have them, each with what it means: tables, studies and command lines."""

import json
import random
import tomllib
from pathlib import Path

import numpy as np

from tests.hostile.values import EITHER, REFUSED, TAKEN, texts_of

# == Tables as people have them in CSV files, each with the numbers that it means ============================

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


def pick(rng, choices):
    """Return an entry, all as likely, and what may come of it."""
    return rng.choice([(verdict, one) for verdict, entries in choices.items() for one in entries])


def bytes_changed(rng, data):
    """Return a text with a few bytes flipped, cut off, put in or left out."""
    place = rng.randrange(len(data))
    before, after = data[:place], data[place:]
    flipped = before + bytes([after[0] ^ 1 << rng.randrange(8)]) + after[1:]
    return rng.choice(
        [flipped, before, before + rng.randbytes(2) + after, before + after[rng.randrange(1, 6) :]]
    )


def tables(seed, count):
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


# == Studies changed in their text, and what a study means, read without fastlink ============================

ROOT = Path(__file__).parents[2]
SHIPPED = sorted([*ROOT.glob("data/studies/*.toml"), *ROOT.glob("src/fastlink/mechanisms/*/study.toml")])
SMALL = """
mechanism = "planar_4r"
title = "small"
quantities = ["theta4", "omega4_max"]
[design]
a1 = 0.4
a2 = {linspace = [1.0, 1.4, 3]}
a3 = {values = [0.8, 0.7]}
a4 = 1.0
omega1 = 25.0
[cycle]
theta1 = 8
branch = [1, 2]
[output]
file = "small.h5"
overwrite = true
verify = 0
"""
#: Values in TOML that stand for anything. No count that would be accepted takes long.
VALUES = texts_of(
    r"""
    nan   -nan   inf   -inf   +inf   1e400   -0.0   0.0   0   -1   5e-324   1e-310   1.7e308   1_000   0x10   0o17
    0b11   9223372036854775808   -9223372036854775809   1.5   2.0   1e3   true   false   ""   " "   "nan"   "0.4"
    "\u0000"   "\u001b[31m"   "ä€𝄞"   "\uFFFF"   'a\b'   []   {}   [[]]   [{}]   [1, 2]   [1, 1]   [0.4, 0.4]
    ["a1"]   [true]   [1.0, "x"]   [1.0, nan]   [[1.0, 2.0]]   1979-05-27T07:32:00Z   1979-05-27   07:32:00
    {x = 1}   {values = 1}   {values = []}   {values = [1.0, 1.0]}   {values = ["1"]}   {values = [[1.0]]}
    {values = [1.0, true]}   {linspace = [0.0, 1.0]}   {linspace = [0.0, 1.0, 0]}   {linspace = [0.0, 1.0, -3]}
    {linspace = [0.0, 1.0, 2.0]}   {linspace = [1.0, 1.0, 2]}   {linspace = [nan, 1.0, 2]}
    {linspace = [-1.7e308, 1.7e308, 3]}   {linspace = [0, 1, 100000000000]}   {linspace = 3}   {linspace = {}}
    {geomspace = [0.0, 1.0, 3]}   {geomspace = [-1.0, 1.0, 3]}   {geomspace = [1e-320, 1e300, 3]}   {n = 4}
    {linspace = [0.8, 0.9, 2], values = [1.0]}   {n = 4, seed = 1, a2 = [1.0, 1.4]}   {linspace = [0.9, 0.8, 2]}
    {linspace = [true, 1, 2]}   {linspace = ["0", "1", "2"]}   {values = {}}   {Values = [1.0]}
    {linspace = [1.0, 1.4, 3], x = 1}   "joint_angle_2"   "theta1"   "dense"   "sampled"   "refined"   "round_bar"
    "planar_4r"   "hart"   "no.csv"   "."   1.0   0.9   2   3   [1]   [2, 1]   ["theta4"]   ["theta4", "theta4"]
    ["nosuch"]   {values = [0.9, 0.8]}
    """
)
VALUES += ["1" + "0" * 400, '"' + "x" * 5000 + '"', '"""\na\n"""']
KEYS = texts_of(
    """
    a1 a5 A1 a_1 ä 𝄞 __class__ sobol table latin_hypercube quantities mechanism design cycle output run links linspace
    values n seed angles input theta1 theta2 theta joint_angle_2 branch Branch solver extrema verify file title backend
    gravity density radius model m1 status phi theta1_deg a1.b self space to threads attrs
    """,
    r"\s+",
)
KEYS += ["a1 ", "", "a\nb", "\x00", "x" * 3000]


def _changed(rng, text):
    """Return a study with another value, key or line somewhere."""
    lines = text.splitlines()
    place = rng.randrange(len(lines))
    key, equals, value = lines[place].partition("=")
    kind = rng.choice(["value", "key", "misspelt", "less", "more", "twice", "wrapped", "text", "orders"])
    k = rng.randrange(len(key) + 1)
    misspelt = [key[:k] + key[k + 1 :], key[:k] + "_" + key[k:], key.upper(), key[::-1]]
    wrapped = f"{{{rng.choice(['values', 'linspace', 'x', 'n', 'sobol'])} = {value}}}"
    changed = {
        "value": [f"{key}{equals}{rng.choice(VALUES)}"],
        "key": [f"{json.dumps(rng.choice(KEYS), ensure_ascii=False)}{equals}{value}"],
        "misspelt": [f"{rng.choice(misspelt)}{equals}{value}"],
        "less": [],
        "more": [lines[place], f"{rng.choice(KEYS)} = {rng.choice(VALUES)}"],
        "twice": [lines[place], rng.choice(lines)],
        "wrapped": [f"{key}{equals}{wrapped}"],
        "text": [f"{key}{equals}{json.dumps(value)}"],
    }
    if kind == "orders":
        return "\n".join(rng.sample(lines, len(lines)))
    return "\n".join([*lines[:place], *changed[kind], *lines[place + 1 :]])


def _rewritten(rng, text):
    """Return the text of a study with another encoding, other bytes or another end."""
    encoding = rng.choice(["utf-16", "utf-16-le", "utf-32", "cp037", "utf-8-sig"])
    end = rng.choice(["\r\n", "\r", "\n\n", "\x0b", "\u2028"])
    deep = rng.choice(["[" * 5000, "{a=" * 2000, "[" * 400 + "]" * 400])
    long = rng.choice(["#" * 10**5, "\n" * 10**4, "x = '" + "é" * 10**5 + "'", "1" * 10**4 + " = 1"])
    place = rng.randrange(len(text))
    return rng.choice(
        [
            bytes_changed(rng, text.encode()),
            (text[:place] + rng.choice("[]{}\"'=#,.\\") + text[place:]).encode(),
            text.encode(encoding, "replace"),
            text.replace("\n", end).encode(),
            f"{text}\n[deep]\nx = {deep}".encode(),
            (text + long).encode(),
        ]
    )


def studies(seed, count):
    """Yield the calls with the studies of a seed."""
    rng = random.Random(seed)
    shipped = [path.read_text() for path in SHIPPED]
    for _ in range(count):
        small = rng.random() < 0.3
        text = SMALL if small else rng.choice(shipped)
        changed = rng.random() < 0.7
        data = _changed(rng, text).encode("utf-8", "surrogatepass") if changed else _rewritten(rng, text)
        doors = ["ran", "read", "commanded"] if small else ["read"] * 9 + ["explained"]
        yield f"{rng.choice(doors)}({data!r})"


def numbers_meant(given):
    """Return the numbers that a value of [design] stands for, by the rules of docs/studies.md; ValueError for none."""
    if type(given) in (int, float) and abs(given) < float("inf"):
        return float(given)
    if isinstance(given, dict) and len(given) == 1:
        ((kind, values),) = given.items()
        if isinstance(values, list) and values and all(type(value) in (int, float) for value in values):
            if kind == "values":
                return np.array(values, dtype=float)
            if kind in ("linspace", "geomspace") and len(values) == 3 and type(values[2]) is int:
                return getattr(np, kind)(*values)
    raise ValueError(f"{given!r} stands for no numbers")


def meant(data):
    """Return the numbers of each input of a study; of one with a sample or a table of designs its constants."""
    design = tomllib.loads(data.decode("utf-8-sig").replace("\r\n", "\n").replace("\r", "\n"))["design"]
    if {"sobol", "latin_hypercube", "table"} & set(design):
        design = {name: value for name, value in design.items() if type(value) in (int, float)}
    return {name: numbers_meant(value) for name, value in design.items()}


# == Command lines with words changed, dropped, doubled and exchanged ========================================

#: Lines that run, in a folder with study.toml and maps.h5.
COMMANDS = """
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


def command_lines(seed, count):
    """Yield the words of the command lines of a seed."""
    rng = random.Random(seed)
    for _ in range(count):
        words = rng.choice(COMMANDS).split()
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
