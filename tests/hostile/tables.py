"""Tables as people have them: CSV texts, mappings, data frames and datasets, each with the numbers that it means."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from tests.hostile.values import EITHER, REFUSED, TAKEN

NAMES = ("a1", "a2", "a3", "a4", "omega1")
BASE = {"a1": 0.4, "a2": 1.2, "a3": 0.8, "a4": 1.0, "omega1": 25.0}

#: One cell of a CSV file: kind, text, verdict. ``{x}`` is a number, ``{comma}`` the same with a decimal comma.
CELLS = [
    *(
        ("cells", text, TAKEN)
        for text in ("{x}", " {x} ", '"{x}"', "+{x}", "{x}e0", "{x}E+00", "{x}" + "0" * 5000)
    ),
    *(
        ("cells", text, EITHER)
        for text in ('"{comma}"', "'{x}'", "{x}f", "{x}d0", "{x}\u00a0", "\u2009{x}", "{x}\t")
    ),
    *(
        ("not finite", text, REFUSED)
        for text in ("nan", "NaN", "inf", "-Infinity", "1e400", "-1e999", "1" * 400, "")
    ),
    *(
        ("no numbers", text, REFUSED)
        for text in ("x", "={x}", "=A1*2", "{x} m", "{x}cm", "0x1p3", "TRUE", "None", "#N/A")
    ),
    *(
        ("no numbers", text, REFUSED)
        for text in ("1_0", "1'000", "--1", "1.2.3", "{x}%", "1e", "1/2", "é" * 100_000, "$1")
    ),
    *(
        ("no numbers", text, REFUSED)
        for text in ("\x00", "{x}\x00", "\x1b[31m", "2020-01-01", "12:30", "{x}j", "'", "-")
    ),
    *(("thousands", text, REFUSED) for text in ('"1,200.5"', "1 200", '"1.200,5"', '"1,234"')),
    *(("quotes", text, REFUSED) for text in ('"{x}', '{x}"', '""', '"{x}"1', "\"{x}'")),
]
#: Names in line 1 that are none, and what they stand for.
HEADERS = [
    *(("names", text, TAKEN) for text in ("{n}", " {n} ", '"{n}"', "{n}\t")),
    *(("names", text, REFUSED) for text in ("", " ", "a2", "1.5", "nan", "#{n}", "{n};{n}", "{n}\x00")),
    *(("names", text, EITHER) for text in ("{n} [m]", "{n}.1", "Ä", "\x1b", "__class__", "x" * 2000)),
]
#: How the lines are joined to bytes: kind, separator, end of line, encoding, verdict.
FORMATS = [
    ("as it should be", ",", "\n", "utf-8", TAKEN),
    ("as it should be", ",", "\r\n", "utf-8", TAKEN),
    ("as it should be", ",", "\n", "utf-8-sig", TAKEN),
    ("as it should be", ",", "\r", "utf-8", EITHER),
    ("as it should be", ", ", "\n", "utf-8", TAKEN),
    ("as it should be", ",", "\n\n", "utf-8", TAKEN),
    ("separators", ";", "\n", "utf-8", EITHER),
    ("separators", "\t", "\n", "utf-8", EITHER),
    ("separators", " ", "\n", "utf-8", REFUSED),
    ("separators", "|", "\n", "utf-8", REFUSED),
    ("separators", ",", "", "utf-8", REFUSED),
    ("separators", "", "\n", "utf-8", REFUSED),
    ("separators", ",,", "\n", "utf-8", REFUSED),
    ("encodings", ",", "\n", "utf-16", REFUSED),
    ("encodings", ",", "\n", "utf-16-le", REFUSED),
    ("encodings", ",", "\n", "utf-32", REFUSED),
    ("encodings", ",", "\n", "cp037", REFUSED),
]
#: Further lines of a file, put anywhere.
LINES = [
    "1",
    "1,2,3,4,5,6,7",
    "{header}",
    "# a comment",
    "a1",
    '"',
    "\x00",
    "\x1a",
    "nan,nan,nan,nan,nan",
    "é",
    "\ufeff1",
]

#: A column in memory: kind, text, verdict, plain text. ``{v}`` is a list of numbers.
COLUMNS = [
    ("columns", "{v}", TAKEN, "{v}"),
    ("columns", "tuple({v})", TAKEN, "{v}"),
    ("columns", "np.array({v}, dtype='>f8')", TAKEN, "{v}"),
    ("columns", "np.array({v}, dtype=np.float32)", TAKEN, "np.array({v}, dtype=np.float32).astype(float)"),
    ("columns", "np.array({v}, dtype=np.longdouble)", EITHER, "{v}"),
    ("columns", "np.array({v}, dtype=object)", EITHER, "{v}"),
    ("columns", "np.array([1, 2, 3], dtype=np.uint8)", TAKEN, "[1.0, 2.0, 3.0]"),
    ("columns", "np.array([1, 2, 3])", TAKEN, "[1.0, 2.0, 3.0]"),
    ("columns", "[1, 2, 3]", TAKEN, "[1.0, 2.0, 3.0]"),
    ("columns", "pd.array({v}, dtype='Float64')", EITHER, "{v}"),
    ("columns", "pd.array([1, 2, 3], dtype='Int64')", EITHER, "[1.0, 2.0, 3.0]"),
    ("columns", "pd.arrays.SparseArray({v})", EITHER, "{v}"),
    ("columns", "pd.Categorical({v})", EITHER, "{v}"),
    ("columns", "[Decimal(str(v)) for v in {v}]", EITHER, "{v}"),
    ("columns", "np.ma.array({v})", EITHER, "{v}"),
    ("not finite", "[{v}[0], float('nan'), {v}[2]]", REFUSED, "[{v}[0], float('nan'), {v}[2]]"),
    ("not finite", "[{v}[0], np.inf, {v}[2]]", REFUSED, "[{v}[0], np.inf, {v}[2]]"),
    ("not finite", "np.ma.array({v}, mask=[0, 1, 0])", REFUSED, "[{v}[0], float('nan'), {v}[2]]"),
    (
        "not finite",
        "pd.array([{v}[0], None, {v}[2]], dtype='Float64')",
        REFUSED,
        "[{v}[0], float('nan'), {v}[2]]",
    ),
    ("not finite", "pd.array([1, None, 3], dtype='Int64')", REFUSED, "[1.0, float('nan'), 3.0]"),
    *(
        ("other types", text, REFUSED, "")
        for text in (
            "['0.4', '0.5', '0.6']",
            "[0.4, '0.5', 0.6]",
            "[0.4, None, 0.6]",
            "[0.4, True, 0.6]",
            "[True, False, True]",
            "np.array([True, False, True])",
            "pd.array([True, None, False], dtype='boolean')",
            "pd.array(['a', 'b', None], dtype='string')",
            "pd.Categorical(['x', 'y', 'x'])",
            "pd.to_datetime(['2020-01-01', '2020-01-02', None])",
            "pd.to_timedelta([1, 2, 3])",
            "pd.period_range('2020', periods=3)",
            "pd.interval_range(0, 3)",
            "np.array([1, 2, 3], dtype='M8[D]')",
            "np.array({v}) * 1j",
            "np.array({v}) + 0j",
            "np.array([0.4, 10**400, 0.6], dtype=object)",
            "[0.4, Sulky(), 0.6]",
            "[0.4, [0.5], 0.6]",
            "[0.4, pd.NA, 0.6]",
            "[0.4, 1j, 0.6]",
            "np.zeros((3, 2))",
            "np.zeros(3, dtype=[('x', float)])",
            "np.array([b'0.4', b'0.5', b'0.6'])",
            "[0.4, np.datetime64('2020'), 0.6]",
            "{0.4, 0.5, 0.6}",
            "(v for v in {v})",
            "memoryview(b'abc')",
            "b'abc'",
            "'abc'",
            "BadArray()",
            "BadIteration()",
            "Everything()",
            "[]",
            "{v}[:2]",
            "{v} + [1.0]",
            "None",
            "True",
            "deep()",
            "circle()",
        )
    ),
]
FRAMES = [
    *(
        ("frames", text, REFUSED)
        for text in (
            "pd.DataFrame()",
            "pd.DataFrame({F}).iloc[:0]",
            "pd.DataFrame({F})[[]]",
            "pd.DataFrame({F}).rename(columns={'a2': 'a1'})",
            "pd.DataFrame({F}).rename(columns={'a2': 3})",
            "pd.DataFrame({F}).rename(columns={'a2': None})",
            "pd.DataFrame({F}).rename(columns={'a2': ('a', 'b')})",
            "pd.DataFrame({F}).rename(columns={'a2': float('nan')})",
            "pd.concat({'x': pd.DataFrame({F}), 'y': pd.DataFrame({F})}, axis=1)",
            "pd.DataFrame({F}).T",
            "pd.DataFrame({F}).shift(1)",
            "pd.DataFrame({F}).astype(str)",
            "pd.DataFrame({F})['a1']",
            "pd.DataFrame({F}).describe",
            "xr.Dataset()",
            "xr.Dataset({'a1': ('x', [0.4, 0.5]), 'a2': ('y', [1.2, 1.3, 1.4])})",
            "xr.Dataset({'a1': (('x', 'y'), np.ones((2, 2)))})",
            "xr.DataArray([1.0, 2.0], dims='a1')",
            "xr.Dataset({'a1': ('design', ['x', 'y'])})",
            "xr.Dataset({'a1': ('design', [True, False])})",
            "xr.Dataset({1: ('design', [0.4, 0.5])})",
            "{}",
            "{'a1': 0.4}",
            "{1: [0.4, 0.5]}",
            "{'': [0.4, 0.5]}",
            "{'design': [0.4, 0.5]}",
            "{None: [0.4]}",
            "[('a1', [0.4])]",
            "np.ones((3, 2))",
            "0.4",
            "None",
            "'no.csv'",
            "'folder'",
            "'a\\x00b.csv'",
            "'\\ud800.csv'",
            "'x' * 5000",
            "'/proc/self/mem'",
            "'~nosuchuser/a.csv'",
            "b'table.csv'",
            "BadPath()",
            "BadAttributes()",
            "Everything()",
            "Sulky()",
            "iter([1.0])",
            "deep()",
        )
    ),
    *(
        ("frames", text, EITHER)
        for text in (
            "pd.DataFrame({F})",
            "pd.DataFrame({F}, index=['x', 'y', 'z'])",
            "pd.DataFrame({F}, index=[0, 0, 0])",
            "pd.DataFrame({F}).set_index(pd.MultiIndex.from_tuples([(1, 'a'), (1, 'b'), (2, 'a')]))",
            "pd.DataFrame({F}).rename_axis(index='name', columns='input')",
            "pd.DataFrame({F}).rename_axis(index='a1')",
            "pd.DataFrame({F}).convert_dtypes().astype(float)",
            "pd.DataFrame({F})[::-1][::-1]",
            "pd.DataFrame({F}).to_xarray()",
            "pd.DataFrame({F}).rename_axis(index='design').to_xarray()",
            "pd.DataFrame({F}).to_dict('list')",
            "pd.DataFrame({F}).to_dict('series')",
            "xr.Dataset({name: ('run', column) for name, column in {F}.items()})",
            "[dict(zip({F}, row)) for row in zip(*{F}.values())]",
            "xr.Dataset({name: ('run', column) for name, column in {F}.items()}, coords={'run': ['x', 'y', 'z']})",
            "xr.Dataset({n: ('run', c) for n, c in {F}.items()}, coords={'label': ('run', ['x', 'y', 'z'])})",
        )
    ),
]


def _numbers(rng: np.random.Generator, name: str, count: int = 3) -> list[float]:
    """Return lengths near those of a crank-rocker, of few digits."""
    return [round(BASE[name] * (1.0 + 0.01 * int(k)), 6) for k in rng.integers(0, 10, count)]


def _pick(rng: np.random.Generator, items: Any) -> Any:
    return items[rng.integers(len(items))]


def _csv(rng: np.random.Generator) -> tuple[str, str, str, str]:
    """Return kind, verdict, source text and plain text of a table in a file."""
    columns = {name: _numbers(rng, name) for name in NAMES}
    rows = [[f"{columns[name][k]}" for name in NAMES] for k in range(3)]
    header, kinds, verdicts = list(NAMES), [], []
    plain = dict(columns)
    what = rng.integers(4)
    if what == 0:
        kind, text, verdict = _pick(rng, CELLS)
        row, column = rng.integers(3), rng.integers(5)
        x = rows[row][column]
        rows[row][column] = text.replace("{x}", x).replace("{comma}", x.replace(".", ","))
        kinds.append(kind)
        verdicts.append(verdict)
    elif what == 1:
        kind, text, verdict = _pick(rng, HEADERS)
        header[4] = text.replace("{n}", "omega1")
        if verdict == EITHER:
            plain[header[4]] = plain.pop("omega1")
        kinds.append(kind)
        verdicts.append(verdict)
    kind, separator, end, encoding, verdict = (
        FORMATS[0] if what < 2 and rng.random() < 0.7 else _pick(rng, FORMATS)
    )
    kinds.append(kind)
    verdicts.append(verdict)
    lines = [separator.join(line) for line in (header, *rows)]
    if what == 2:
        line = _pick(rng, LINES).replace("{header}", ",".join(NAMES))
        lines.insert(int(rng.integers(1, 5)), line)
        kinds, verdicts = ["further lines"], [REFUSED]
    data = end.join(lines).encode(encoding, "replace")
    if what == 3:
        data, kind = _bytes_changed(rng, data)
        kinds, verdicts = [kind], ["any"]
    verdict = (
        "any"
        if "any" in verdicts
        else REFUSED
        if REFUSED in verdicts
        else EITHER
        if EITHER in verdicts
        else TAKEN
    )
    return kinds[0], verdict, f"written({data!r})", repr(plain)


def _bytes_changed(rng: np.random.Generator, data: bytes) -> tuple[bytes, str]:
    """Return a text with a few bytes changed, and the kind of change."""
    place, changed = int(rng.integers(len(data))), bytearray(data)
    kind = _pick(rng, ["bytes flipped", "truncated", "bytes inserted", "bytes dropped"])
    if kind == "bytes flipped":
        changed[place] ^= 1 << int(rng.integers(8))
    elif kind == "truncated":
        del changed[place:]
    elif kind == "bytes inserted":
        changed[place:place] = rng.integers(0, 256, rng.integers(1, 4), dtype=np.uint8).tobytes()
    else:
        del changed[place : place + int(rng.integers(1, 6))]
    return bytes(changed), kind


def _in_memory(rng: np.random.Generator) -> tuple[str, str, str, str, bool]:
    """Return kind, verdict, source and plain text of a table in memory, and whether non-finite cells are allowed."""
    columns = {name: repr(_numbers(rng, name)) for name in NAMES}
    plain = dict(columns)
    name = _pick(rng, NAMES)
    kind, text, verdict, meant = _pick(rng, COLUMNS)
    v, keep = columns[name], bool(rng.random() < 0.3)
    columns[name], plain[name] = text.replace("{v}", v), meant.replace("{v}", v)
    if kind == "not finite" and keep:
        verdict = TAKEN
    if kind == "other types":  # refused, or labels of the designs
        verdict = EITHER
        if text == "[0.4, None, 0.6]":  # a gap to pandas
            plain[name] = "[0.4, float('nan'), 0.6]"
        else:
            del plain[name]
    source = "{" + ", ".join(f"{key!r}: {value}" for key, value in columns.items()) + "}"
    meaning = "{" + ", ".join(f"{key!r}: {value}" for key, value in plain.items()) + "}"
    # what numpy and pandas turn into numbers before fastlink sees it
    converted = text.startswith(("memoryview", "(v for", "[0.4, True"))
    wrapped = (
        "{s}"
        if converted
        else _pick(rng, ["{s}", "pd.DataFrame({s})", "xr.Dataset({k: ('run', v) for k, v in {s}.items()})"])
    )
    if wrapped != "{s}" and verdict == TAKEN:
        verdict = EITHER
    return kind, verdict, wrapped.replace("{s}", source), meaning, keep


def tables(seed: int, count: int) -> Iterator[tuple[str, str, str, str, str]]:
    """Yield the call, kind, verdict, source text and plain text of the tables of a seed."""
    rng = np.random.default_rng(seed)
    for _ in range(count):
        keep, draw = False, rng.random()
        if draw < 0.5:
            kind, verdict, source, plain = _csv(rng)
        elif draw < 0.85:
            kind, verdict, source, plain, keep = _in_memory(rng)
        else:
            kind, text, verdict = _pick(rng, FRAMES)
            plain = repr({name: _numbers(rng, name) for name in NAMES})
            source = text.replace("{F}", plain)
        options = ", allow_invalid=True" if keep else ""
        door = "fl.table(SOURCE{o})" if rng.random() < 0.7 else "swept(fl.table(SOURCE{o}){o})"
        if verdict == "any":
            plain = source
        door = door.replace("{o}", options)
        yield door, kind, verdict, source, plain
