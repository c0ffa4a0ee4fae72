"""Studies changed in their structure or in their text, and what a study means, read without fastlink."""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

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
VALUES = [
    *(
        "nan",
        "-nan",
        "inf",
        "-inf",
        "+inf",
        "1e400",
        "-0.0",
        "0.0",
        "0",
        "-1",
        "5e-324",
        "1e-310",
        "1.7e308",
        "1" + "0" * 400,
    ),
    *(
        "1_000",
        "0x10",
        "0o17",
        "0b11",
        "9223372036854775808",
        "-9223372036854775809",
        "1.5",
        "2.0",
        "1e3",
        "true",
        "false",
    ),
    *(
        '""',
        '" "',
        '"nan"',
        '"0.4"',
        '"\\u0000"',
        '"\\u001b[31m"',
        '"' + "x" * 5000 + '"',
        '"ä€𝄞"',
        '"\\uFFFF"',
        "'a\\b'",
    ),
    *(
        "[]",
        "{}",
        "[[]]",
        "[{}]",
        "[1, 2]",
        "[1, 1]",
        "[0.4, 0.4]",
        '["a1"]',
        "[true]",
        '[1.0, "x"]',
        "[1.0, nan]",
        "[[1.0, 2.0]]",
    ),
    *(
        "1979-05-27T07:32:00Z",
        "1979-05-27",
        "07:32:00",
        '"""\na\n"""',
        "{x = 1}",
        "{values = 1}",
        "{values = []}",
    ),
    *(
        "{values = [1.0, 1.0]}",
        '{values = ["1"]}',
        "{values = [[1.0]]}",
        "{values = [1.0, true]}",
        "{linspace = [0.0, 1.0]}",
    ),
    *(
        "{linspace = [0.0, 1.0, 0]}",
        "{linspace = [0.0, 1.0, -3]}",
        "{linspace = [0.0, 1.0, 2.0]}",
        "{linspace = [1.0, 1.0, 2]}",
    ),
    *(
        "{linspace = [nan, 1.0, 2]}",
        "{linspace = [-1.7e308, 1.7e308, 3]}",
        "{linspace = [0, 1, 100000000000]}",
        "{linspace = 3}",
    ),
    *(
        "{geomspace = [0.0, 1.0, 3]}",
        "{geomspace = [-1.0, 1.0, 3]}",
        "{geomspace = [1e-320, 1e300, 3]}",
        "{linspace = {}}",
    ),
    *(
        "{linspace = [0.8, 0.9, 2], values = [1.0]}",
        "{n = 4}",
        "{n = 4, seed = 1, a2 = [1.0, 1.4]}",
        "{linspace = [0.9, 0.8, 2]}",
    ),
    *(
        "{linspace = [true, 1, 2]}",
        '{linspace = ["0", "1", "2"]}',
        "{values = {}}",
        "{Values = [1.0]}",
        "{linspace = [1.0, 1.4, 3], x = 1}",
    ),
    *(
        '"joint_angle_2"',
        '"theta1"',
        '"dense"',
        '"sampled"',
        '"refined"',
        '"round_bar"',
        '"planar_4r"',
        '"hart"',
        '"no.csv"',
        '"."',
    ),
    *(
        "1.0",
        "0.9",
        "2",
        "3",
        "[1]",
        "[2, 1]",
        "[2]",
        '["theta4"]',
        '["theta4", "theta4"]',
        '["nosuch"]',
        "{values = [0.9, 0.8]}",
    ),
]
KEYS = [
    *(
        "a1",
        "a5",
        "A1",
        "a_1",
        "a1 ",
        "",
        "a\nb",
        "\x00",
        "ä",
        "𝄞",
        "x" * 3000,
        "__class__",
        "sobol",
        "table",
        "latin_hypercube",
    ),
    *(
        "quantities",
        "mechanism",
        "design",
        "cycle",
        "output",
        "run",
        "links",
        "linspace",
        "values",
        "n",
        "seed",
        "angles",
        "input",
    ),
    *(
        "theta1",
        "theta2",
        "theta",
        "joint_angle_2",
        "branch",
        "Branch",
        "solver",
        "extrema",
        "verify",
        "file",
        "title",
        "backend",
    ),
    *(
        "gravity",
        "density",
        "radius",
        "model",
        "m1",
        "status",
        "phi",
        "theta1_deg",
        "a1.b",
        "self",
        "space",
        "to",
        "threads",
        "attrs",
    ),
]


class Raw(str):
    """A value as it stands in the text."""


def text_of(value: Any) -> str:
    """Return a value in TOML."""
    if isinstance(value, Raw):
        return str(value)
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key_of(key)} = {text_of(entry)}" for key, entry in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(text_of, value)) + "]"
    if isinstance(value, str):
        return quoted(value)
    return {"inf": "inf", "-inf": "-inf"}.get(
        str(value), str(value).lower() if isinstance(value, bool) else repr(value)
    )


def quoted(text: str) -> str:
    """Return a text in quotes, with no sign that TOML forbids."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def key_of(key: str) -> str:
    """Return a key, in quotes if it needs them."""
    return key if re.fullmatch(r"[A-Za-z0-9_-]+", key) else quoted(key)


def study_text(tables: dict[str, Any]) -> str:
    """Return a study in TOML: values first, then tables."""
    lines = [
        f"{key_of(key)} = {text_of(value)}" for key, value in tables.items() if not isinstance(value, dict)
    ]
    for name, table in tables.items():
        if isinstance(table, dict):
            lines.append(f"[{key_of(name)}]")
            lines += [f"{key_of(key)} = {text_of(value)}" for key, value in table.items()]
    return "\n".join(lines) + "\n"


def _places(tables: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """Yield the path of every key and entry."""
    entries: Any = tables.items() if isinstance(tables, dict) else enumerate(tables)
    for key, value in entries:
        yield (*path, key)
        if isinstance(value, (dict, list)):
            yield from _places(value, (*path, key))


def _changed(rng: np.random.Generator, tables: dict[str, Any]) -> str:
    """Change one thing in the structure of a study, and return the kind of change."""
    places = list(_places(tables))
    *outer, key = places[rng.integers(len(places))] if places else ("design",)
    inside: Any = tables
    for part in outer:
        inside = inside[part]
    kind = str(
        rng.choice(
            [
                "another value",
                "another key",
                "a key less",
                "a key more",
                "value in a table",
                "moved",
                "number as text",
            ]
        )
    )
    value = inside[key] if isinstance(inside, list) else inside.get(key)
    if kind == "another value":
        inside[key] = Raw(VALUES[rng.integers(len(VALUES))])
    elif kind == "another key" and isinstance(inside, dict):
        entries = list(inside.items())
        new = KEYS[rng.integers(len(KEYS))] if rng.random() < 0.5 else _misspelt(rng, str(key))
        inside.clear()
        inside.update((new if name == key else name, entry) for name, entry in entries)
    elif kind == "a key less":
        del inside[key]
    elif kind == "a key more" and isinstance(inside, dict):
        inside[KEYS[rng.integers(len(KEYS))]] = Raw(VALUES[rng.integers(len(VALUES))])
    elif kind == "value in a table":
        wrap = str(rng.choice(["values", "linspace", "x", "n", "sobol"]))
        inside[key] = value[wrap] if isinstance(value, dict) and wrap in value else {wrap: value}
    elif kind == "moved" and outer:
        tables[str(key)] = value
    else:
        inside[key] = Raw(quoted(str(value)))
    return kind


def _misspelt(rng: np.random.Generator, key: str) -> str:
    k = int(rng.integers(len(key) + 1))
    return str(
        rng.choice([key[:k] + key[k + 1 :], key[:k] + "_" + key[k:], key.upper(), key + "s", key[::-1]])
    )


def _rewritten(rng: np.random.Generator, text: str) -> tuple[bytes, str]:
    """Change the text of a study, and return its bytes and the kind of change."""
    data, lines = bytearray(text.encode()), text.splitlines()
    place = int(rng.integers(max(1, len(data))))
    kinds: dict[str, Callable[[], bytes]] = {
        "bytes flipped": lambda: (
            bytes(data[:place]) + bytes([data[place] ^ 1 << int(rng.integers(8))]) + bytes(data[place + 1 :])
        ),
        "truncated": lambda: bytes(data[:place]),
        "bytes dropped": lambda: bytes(data[:place] + data[place + int(rng.integers(1, 6)) :]),
        "bytes inserted": lambda: (
            bytes(data[:place]) + rng.integers(0, 256, 2, dtype=np.uint8).tobytes() + bytes(data[place:])
        ),
        "marks inserted": lambda: (
            bytes(data[:place]) + str(rng.choice(list("[]{}\"'=#,.\\"))).encode() + bytes(data[place:])
        ),
        "encodings": lambda: text.encode(
            str(rng.choice(["utf-16", "utf-16-le", "utf-32", "cp037", "utf-8-sig"])), "replace"
        ),
        "ends of lines": lambda: text.replace(
            "\n", str(rng.choice(["\r\n", "\r", "\n\n", "\x0b", "\u2028"]))
        ).encode(),
        "lines twice": lambda: "\n".join([*lines, lines[rng.integers(len(lines))]]).encode(),
        "lines swapped": lambda: "\n".join(lines[k] for k in rng.permutation(len(lines))).encode(),
        "deep": lambda: (
            text + "\n[deep]\nx = " + str(rng.choice(["[" * 5000, "{a=" * 2000, "[" * 400 + "]" * 400]))
        ).encode(),
        "long": lambda: (
            text
            + str(rng.choice(["#" * 10**5, "\n" * 10**4, "x = '" + "é" * 10**5 + "'", "1" * 10**4 + " = 1"]))
        ).encode(),
    }
    kind = list(kinds)[rng.integers(len(kinds))]
    return kinds[kind](), kind


def studies(seed: int, count: int) -> Iterator[tuple[str, str, str]]:
    """Yield the call, its kind and the source text of the studies of a seed."""
    rng = np.random.default_rng(seed)
    shipped = [path.read_text() for path in SHIPPED]
    for _ in range(count):
        small = rng.random() < 0.3
        text = SMALL if small else shipped[rng.integers(len(shipped))]
        if rng.random() < 0.7:
            tables = tomllib.loads(text)
            kind = _changed(rng, tables)
            if rng.random() < 0.3:
                _changed(rng, tables)
                kind = "two at once"
            data = study_text(tables).encode("utf-8", "surrogatepass")
        else:
            data, kind = _rewritten(rng, text)
        door = (
            str(rng.choice(["ran", "read", "commanded"]))
            if small
            else str(rng.choice(["read"] * 9 + ["explained"]))
        )
        yield f"{door}(SOURCE)", kind, repr(data)


def numbers_meant(given: Any) -> Any:
    """Return the numbers that a value of [design] stands for, by the rules of docs/studies.md.

    Raises
    ------
    ValueError
        It stands for none.
    """
    number = isinstance(given, (int, float)) and not isinstance(given, bool)
    if number and abs(given) < float("inf"):
        return float(given)
    if isinstance(given, dict) and len(given) == 1:
        ((kind, values),) = given.items()
        if isinstance(values, list) and values and all(type(value) in (int, float) for value in values):
            if kind == "values":
                return np.array(values, dtype=float)
            if kind in ("linspace", "geomspace") and len(values) == 3 and type(values[2]) is int:
                return getattr(np, kind)(*values)
    raise ValueError(f"{given!r} stands for no numbers")


def meant(data: bytes) -> dict[str, Any]:
    """Return the numbers of each input of a study that has no sample and no table of designs."""
    tables = tomllib.loads(data.decode("utf-8-sig").replace("\r\n", "\n").replace("\r", "\n"))
    if {"sobol", "latin_hypercube", "table"} & set(tables["design"]):
        return {
            name: numbers_meant(value)
            for name, value in tables["design"].items()
            if type(value) in (int, float)
        }
    return {name: numbers_meant(value) for name, value in tables["design"].items()}
