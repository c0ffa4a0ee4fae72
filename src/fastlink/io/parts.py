"""Parts of a map: consecutive designs in files of their own, which `fastlink.join` puts together."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Mapping
from dataclasses import dataclass
from numbers import Integral
from pathlib import Path
from typing import Any

from fastlink._text import counted, short_repr
from fastlink.errors import InputError, KeyPath, Setting
from fastlink.io.ranges import Range

__all__ = ["OF_PARTS", "WHOLE", "Part", "PartOfMap", "check_part", "check_size"]

#: The global attributes of a part, see `PartOfMap`; they are not those of the whole map.
OF_PARTS = ("part_number", "part_count", "part_start", "part_stop", "whole_designs", "whole_fingerprint")
#: The group of a part that holds coordinates of the whole map.
WHOLE = "whole"
#: More parts than any cluster has jobs.
MOST_PARTS = 10**6


@dataclass(frozen=True)
class Part:
    """The `number`-th of `count` nearly equal parts, from 1 on.

    Examples
    --------
    >>> print(Part(3, 16), Part(3, 16).range(1000), Part(3, 16).path(Path("maps.h5")))
    3/16 (125, 187) maps.part-03-of-16.h5
    """

    number: int
    count: int

    def __str__(self) -> str:
        return f"{self.number}/{self.count}"

    def range(self, designs: int) -> Range:
        """Return the first of its designs, and the first after them."""
        return designs * (self.number - 1) // self.count, designs * self.number // self.count

    @property
    def mark(self) -> str:
        """Its mark in the name of its file."""
        return f".part-{self.number:0{len(str(self.count))}}-of-{self.count}"

    def path(self, whole: Path) -> Path:
        """Return the file of the part beside that of the whole map."""
        return whole.with_name(f"{whole.stem}{self.mark}{whole.suffix}")


def check_part(where: KeyPath, value: Any) -> Part:
    """Return the part of a pair (k, n), or of a text ``"k/n"``, or refuse the value.

    Examples
    --------
    >>> check_part(("part",), (17, 16))
    Traceback (most recent call last):
    fastlink.errors.InputError: part is (17, 16); write k of n parts with k from 1 to n, such as part='3/16'
    """
    pair = value
    if isinstance(value, str) and (found := re.fullmatch(r"(\d{1,9})/(\d{1,9})", value, re.ASCII)):
        pair = [int(number) for number in found.groups()]
    if isinstance(pair, (list, tuple)) and len(pair) == 2 and all(map(_is_whole, pair)):
        number, count = map(int, pair)
        if 1 <= number <= count <= MOST_PARTS:
            return Part(number, count)
    remedy = ("write k of n parts with k from 1 to n", (", such as ", Setting("part", "3/16")))
    raise InputError(f"is {short_repr(value)}", where=where, remedy=remedy)


def check_size(where: KeyPath, part: Part, designs: int) -> None:
    """Refuse parts some of which would have no design."""
    if part.count > designs:
        what = f"is {part}, but there {'is' if designs == 1 else 'are'} {counted(designs, 'design')}"
        remedy = f"write at most {counted(designs, 'part')}, of one design at least"
        raise InputError(what, where=where, remedy=remedy)


@dataclass(frozen=True)
class PartOfMap:
    """A part of a certain map.

    Attributes
    ----------
    part : Part
        Which part.
    whole : str
        The hash of the whole request, which its parts and their joined map share.
    designs : int
        The number of designs of the whole map.
    """

    part: Part
    whole: str
    designs: int

    @property
    def range(self) -> Range:
        """Return the first of its designs, and the first after them."""
        return self.part.range(self.designs)

    @property
    def fingerprint(self) -> str:
        """The hash of the part, which no other part has."""
        return hashlib.sha256(f"{self.whole} {self.part}".encode()).hexdigest()

    def attrs(self) -> dict[str, Any]:
        """Return the global attributes that tell which part it is."""
        return dict(
            zip(
                OF_PARTS,
                (self.part.number, self.part.count, *self.range, self.designs, self.whole),
                strict=True,
            )
        )

    @classmethod
    def of(cls, attrs: Mapping[str, Any]) -> PartOfMap | None:
        """Return what the global attributes of a map tell, None of what is no part."""
        try:
            number, count, start, stop, designs = (int(attrs[name]) for name in OF_PARTS[:-1])
            found = cls(Part(number, count), str(attrs[OF_PARTS[-1]]), designs)
        except (KeyError, TypeError, ValueError):
            return None
        return found if 1 <= number <= count <= designs and (start, stop) == found.range else None


def _is_whole(value: Any) -> bool:
    return (
        isinstance(value, Integral) and not isinstance(value, bool) and type(value).__name__ != "timedelta64"
    )
