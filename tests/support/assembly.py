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
#: A number is copied to all lanes.
SPREAD = re.compile(r"^\s+(?:v?(?:broadcastsd|movddup|unpcklpd|movlhps)\b|dup\s|.*\.d\[0\])")
REGISTER = re.compile(r"%[xyz]mm(\d+)|\b[dvq](\d+)\b")
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
        """Operations of one lane, but for those of numbers from outside, whose result goes to all lanes at once.

        LLVM makes one such operation of a packed one between numbers that stand in all lanes.
        """
        spread: dict[int, bool] = {}
        for k in reversed(range(len(self.lines))):
            if SINGLE.match(self.lines[k]):
                spread[k] = self._is_spread(k, spread)
        return sum(not done for done in spread.values())

    def _is_spread(self, k: int, spread: dict[int, bool]) -> bool:
        """Tell whether the next line that reads what line k makes copies it to all lanes, or is of that kind itself."""
        made = _registers(self.lines[k])
        made = made[0] if re.match(r"\s+f", self.lines[k]) else made[-1]
        for later in range(k + 1, len(self.lines)):
            if made in _registers(self.lines[later]):
                return spread.get(later, bool(SPREAD.match(self.lines[later])))
        return False


def _registers(line: str) -> list[str]:
    return [x86 or arm for x86, arm in REGISTER.findall(line)]


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
    """Return the functions that are called, or gone on to, and are not part of the text."""
    lines = text.splitlines()
    own = {found[1] for line in lines if (found := LABEL.match(line))}
    return {found[1] for line in lines if (found := CALL.match(line))} - own


def fused(text: str) -> list[str]:
    """Return the lines that fuse a product with a sum."""
    return [line for line in text.splitlines() if FUSED.match(line)]
