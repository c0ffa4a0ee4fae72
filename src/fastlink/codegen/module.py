"""One LLVM module under construction: functions, constants, declarations."""

from __future__ import annotations

from collections.abc import Hashable, Sequence

from fastlink.codegen.ir import LLVM, Array, Value, constant

__all__ = ["Module"]

#: Of functions, of those that are merged into others, and of those whose vectors go to the stack: else LLVM leaves
#: them across cache lines there in every other process, in which reactions took up to 1.25 times as long.
ATTRIBUTES = """attributes #0 = { nounwind "denormal-fp-math"="ieee,ieee" }
attributes #1 = { nounwind alwaysinline "denormal-fp-math"="ieee,ieee" }
attributes #2 = { nounwind "stackrealign" "denormal-fp-math"="ieee,ieee" }"""


class Module:
    """The functions of one kernel under construction.

    Parameters
    ----------
    lanes : int
        How many doubles a vector has.
    flags : str
        Freedoms of arithmetic that functions have, but not the texts pasted into them.
    """

    def __init__(self, lanes: int, flags: str = "") -> None:
        self.flags = flags
        self.lanes = lanes
        self.text: list[str] = []
        self.constants: list[str] = []
        self.declarations: dict[str, None] = {}
        #: Of each function that was translated, by text and kinds of arguments, its name and the kind of its result.
        self.functions: dict[Hashable, tuple[str, str | None]] = {}

    def __str__(self) -> str:
        return "\n".join([*self.constants, *self.declarations, *self.text, ATTRIBUTES])

    def declare(self, text: str) -> None:
        """Declare a function of LLVM, once."""
        self.declarations[text] = None

    def constant_array(self, values: Sequence[Value]) -> Array:
        """Return a read-only array of known numbers."""
        kind = "f" if any(value.kind == "f" for value in values) else "i"
        at = f"@c{len(self.constants)}"
        numbers = [constant(value.known or 0, kind).at for value in values]
        entries = ", ".join(f"{LLVM[kind]} {number}" for number in numbers)
        self.constants.append(
            f"{at} = private unnamed_addr constant [{len(values)} x {LLVM[kind]}] [{entries}], align 64"
        )
        return Array(at, kind, (constant(len(values)),))
