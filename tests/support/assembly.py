"""Assembly language of x86-64 (AT&T) and aarch64, read: loops, and which arithmetic is in them."""

from __future__ import annotations

import re
from dataclasses import dataclass, field

LABEL = re.compile(r"^([\w.$]+):")
JUMP = re.compile(r"^\s+(?:j\w+|b|b\.\w+|cbn?z\s+\w+,|tbn?z\s+\w+,\s*#\w+,)\s+(\.?L\w+)\b")
CALL = re.compile(r"^\s+(?:callq?|bl|jmpq?|b)\s+(?!\.?L)(\*?[A-Za-z_][\w.$]*)")
#: Arithmetic of doubles; on x86 a plain .2d is an xmm register.
PACKED = re.compile(r"^\s+(?:v?(?:add|sub|mul|div|sqrt)pd\b|f(?:add|sub|mul|div|sqrt)\s+v\d+\.2d)")
SINGLE = re.compile(r"^\s+(?:v?(?:add|sub|mul|div|sqrt)sd\b|f(?:add|sub|mul|div|sqrt)\s+d\d+)")
#: Products fused with sums, which round once.
FUSED = re.compile(r"^\s+(?:vfn?m(?:add|sub)\w*|fn?m(?:add|sub|la|ls))\b")


@dataclass
class Loop:
    """Lines from the label of a loop to the last jump back to it."""

    lines: list[str] = field(repr=False)

    @property
    def packed(self) -> int:
        return sum(bool(PACKED.match(line)) for line in self.lines)

    @property
    def single(self) -> int:
        return sum(bool(SINGLE.match(line)) for line in self.lines)


def inner_loops(text: str) -> list[Loop]:
    """Return the loops that hold no other one."""
    lines = text.splitlines()
    labels = {found[1]: k for k, line in enumerate(lines) if (found := LABEL.match(line))}
    ends: dict[int, int] = {}
    for k, line in enumerate(lines):
        if (found := JUMP.match(line)) and labels.get(found[1], k) < k:
            ends[labels[found[1]]] = k
    inner = [
        (a, b)
        for a, b in ends.items()
        if not any(a <= c and d <= b and (a, b) != (c, d) for c, d in ends.items())
    ]
    return [Loop(lines[a : b + 1]) for a, b in sorted(inner)]


def called(text: str) -> set[str]:
    """Return the functions that are called, or gone on to, and are no part of the text."""
    lines = text.splitlines()
    own = {found[1] for line in lines if (found := LABEL.match(line))}
    return {found[1] for line in lines if (found := CALL.match(line))} - own


def fused(text: str) -> list[str]:
    """Return the lines that fuse a product with a sum."""
    return [line for line in text.splitlines() if FUSED.match(line)]
