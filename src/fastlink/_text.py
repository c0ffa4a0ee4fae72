"""Text for people: aligned columns, sizes of files, run times, counts."""

from __future__ import annotations

import builtins
import html
import itertools
import numbers
import re
import reprlib
import textwrap
from collections.abc import Iterable, Mapping, Sequence
from functools import cache
from importlib import metadata
from typing import Any

BYTES = (" B", " kB", " MB", " GB", " TB")


def aligned(
    rows: Sequence[Sequence[str]], *, right: int | None = None, ruled: bool = False, indent: str = ""
) -> str:
    """Return rows of cells as lines of text, with columns below each other.

    Examples
    --------
    >>> print(aligned([("", "way", "ns"), ("*", "refined", "335")], right=2, ruled=True))
       way       ns
    -  -------  ---
    *  refined  335
    """
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    right = len(widths) if right is None else right
    lines = [list(row) for row in rows]
    if ruled:
        lines.insert(1, ["-" * width for width in widths])
    for line in lines:
        line[:right] = map(str.ljust, line[:right], widths[:right])
        line[right:] = map(str.rjust, line[right:], widths[right:])
    return "\n".join(f"{indent}{'  '.join(line)}".rstrip() for line in lines)


def html_table(header: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table as a notebook shows it."""
    head = "".join(f"<th>{html.escape(name)}</th>" for name in header)
    lines = ["".join(f"<td>{html.escape(cell)}</td>" for cell in row) for row in rows]
    return f"<table><tr>{head}</tr>{''.join(f'<tr>{line}</tr>' for line in lines)}</table>"


def folded(header: Sequence[str], rows: Iterable[Sequence[str]], widths: Sequence[int | None]) -> str:
    """Return a ruled table whose cells are folded at the widths of their columns, None for no limit.

    Examples
    --------
    >>> print(folded(("name", "meaning"), [("a", "two words")], (None, 4)))
    name  meaning
    ----  -------
    a     two
          words
    """
    lines: list[Sequence[str]] = [header]
    for row in rows:
        cells = [
            [cell] if width is None else textwrap.wrap(cell, width, break_long_words=False)
            for cell, width in zip(row, widths, strict=True)
        ]
        lines += itertools.zip_longest(*cells, fillvalue="")
    return aligned(lines, ruled=True)


def counted(number: int, noun: str) -> str:
    """Return a number with its noun, in the plural where there is not one."""
    return f"{number:,} {noun}{'' if number == 1 else 'es' if noun.endswith('ch') else 's'}"


def joined(parts: Sequence[str]) -> str:
    """Return texts as an enumeration."""
    return " and ".join((", ".join(parts[:-1]), parts[-1])) if len(parts) > 1 else "".join(parts)


def duration(seconds: float) -> str:
    """Return a time in words.

    Examples
    --------
    >>> duration(0.0123), duration(4.56), duration(125.0), duration(7300.0)
    ('0.012 s', '4.6 s', '2 min 5 s', '2 h 1 min')
    """
    if seconds < 60:
        return f"{seconds:.2g} s"
    minutes, rest = divmod(round(seconds), 60)
    if minutes < 60:
        return f"{minutes} min {rest} s"
    return f"{minutes // 60} h {minutes % 60} min"


def scaled(value: float, units: Sequence[str]) -> str:
    """Return a number with three digits, in one of the units for 1, 10^3, 10^6 ...

    Examples
    --------
    >>> scaled(1.23456e6, ("/s", " thousand/s", " million/s"))
    '1.23 million/s'
    """
    for unit in units[:-1]:
        if value < 1000:
            return f"{value:.3g}{unit}"
        value /= 1000
    return f"{value:.3g}{units[-1]}"


def in_words(name: str) -> str:
    """Return a meaning of a code, or another name, as words."""
    return name.replace("_", " ")


def short_number(value: object) -> str:
    """Return a number with at most six digits, and anything else, such as the name of a design, as it is."""
    return f"{value:g}" if isinstance(value, numbers.Real) else str(value)


def size(nbytes: int) -> str:
    """Return a number of bytes in words."""
    return scaled(nbytes, BYTES)


def unwritable(text: str) -> str:
    r"""Return the first sign of a text that no file can hold, NUL or half a letter; an empty text without any.

    Examples
    --------
    >>> unwritable("crank"), unwritable("crank" + chr(0))
    ('', '\x00')
    """
    if text.isprintable():
        return ""
    return next((sign for sign in text if sign == "\0" or "\ud800" <= sign <= "\udfff"), "")


def writable(name: str) -> str:
    r"""Return the name of a file as any file can hold it: bytes of it that are no letters are escaped.

    Examples
    --------
    >>> import os
    >>> print(writable("maps.h5"), writable(os.fsdecode(bytes([255])) + ".h5"))
    maps.h5 \udcff.h5
    """
    return name.encode("utf-8", "backslashreplace").decode()


def filled(template: str, values: Mapping[str, str]) -> str:
    """Return a template with its marks replaced at once: a value may hold what looks like another mark.

    Examples
    --------
    >>> filled("TITLE of YEAR", {"TITLE": "YEAR", "YEAR": "1963"})
    'YEAR of 1963'
    """
    return re.sub("|".join(map(re.escape, values)), lambda mark: values[mark[0]], template)


class _Short(reprlib.Repr):
    """Short texts of any values: the same each time, without addresses, whatever their classes do."""

    def repr_instance(self, x: Any, level: int) -> str:
        try:
            text = re.sub(r" at 0x[0-9a-fA-F]+", "", builtins.repr(x))
        except Exception:  # whatever a class of somebody's does when it is shown
            return f"<{type(x).__name__}>"
        if len(text) > self.maxother:
            half = (self.maxother - 3) // 2
            text = f"{text[:half]}...{text[-half:]}"
        return text


def short_repr(value: object) -> str:
    """Return the repr of a value for a message: short and on one line.

    Examples
    --------
    >>> short_repr(object()), short_repr("x" * 100)
    ('<object object>', "'xxxxxxxxxxxx...xxxxxxxxxxxxx'")
    """
    try:
        return " ".join(_Short().repr(value).split())
    except Exception:  # such as a whole number of more digits than Python writes
        return f"a value of type {type(value).__name__}"


# -- The version of fastlink, and of what it is built on


UNKNOWN = "unknown"  # run from a source tree that is not installed


@cache
def version(distribution: str) -> str:
    """Return the version of an installed distribution."""
    try:
        return metadata.version(distribution)
    except metadata.PackageNotFoundError:
        return UNKNOWN


__version__ = version("fastlink-linkages")
