"""Studies changed in their text, and what a study means, read without fastlink."""

from __future__ import annotations

import json
import random
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from tests.hostile.tables import bytes_changed
from tests.hostile.values import texts_of

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


def _changed(rng: random.Random, text: str) -> str:
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


def _rewritten(rng: random.Random, text: str) -> bytes:
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


def studies(seed: int, count: int) -> Iterator[str]:
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


def numbers_meant(given: Any) -> Any:
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


def meant(data: bytes) -> dict[str, Any]:
    """Return the numbers of each input of a study; of one with a sample or a table of designs its constants."""
    design = tomllib.loads(data.decode("utf-8-sig").replace("\r\n", "\n").replace("\r", "\n"))["design"]
    if {"sobol", "latin_hypercube", "table"} & set(design):
        design = {name: value for name, value in design.items() if type(value) in (int, float)}
    return {name: numbers_meant(value) for name, value in design.items()}
