"""Tell where the values of designs lie among those of a variable: design by design, or value by value."""

from __future__ import annotations

from dataclasses import dataclass

from fastlink.io.ranges import Range

__all__ = ["Placement"]


@dataclass(frozen=True)
class Placement:
    """Where the rows of a variable lie, one row of values for each design.

    Attributes
    ----------
    rows : int
        Number of designs.
    values : int
        Values of each design.
    itemsize : int
        Bytes of a value.
    by_value : bool
        Whether the first value of all designs comes first, then the second one; else the first design, then the second.
    shared : int
        Designs that share a value, written with the first of them: of an input that further axes are crossed with.

    Examples
    --------
    >>> Placement(10, 3, 8, by_value=False).pieces(2, 4)
    [(48, 48)]
    >>> Placement(10, 3, 8, by_value=True).pieces(2, 4)
    [(16, 16), (96, 16), (176, 16)]
    >>> crossed = Placement(12, 1, 8, by_value=False, shared=3)
    >>> crossed.pieces(2, 7), crossed.own(2, 7)
    ([(8, 16)], (1, 3))
    >>> Placement(10, 3, 8, by_value=True).rows_in(96, 104), Placement(10, 3, 8, by_value=False).rows_in(48, 56)
    ([(2, 3)], [(2, 3)])
    """

    rows: int
    values: int
    itemsize: int
    by_value: bool
    shared: int = 1

    def own(self, start: int, stop: int) -> Range:
        """Return the rows that follow from some designs; those of other designs are others."""
        return -(-start // self.shared), -(-stop // self.shared)

    def pieces(self, start: int, stop: int) -> list[Range]:
        """Return where the values of some designs lie: position and number of bytes of each piece."""
        start, stop = self.own(start, stop)
        count = (stop - start) * self.itemsize
        if not self.by_value or stop - start == self.rows:
            return [(start * self.values * self.itemsize, count * self.values)] if count else []
        first, step = start * self.itemsize, self.rows * self.itemsize
        return [(first + k * step, count) for k in range(self.values)] if count else []

    def rows_in(self, start: int, stop: int) -> list[Range]:
        """Return the designs that have values in a range of bytes."""
        if not self.by_value:
            of_row = self.values * self.itemsize
            first, last = start // of_row, -(-stop // of_row)
            return [(first * self.shared, min(self.rows, last * self.shared))]
        first, count = start // self.itemsize, -(-stop // self.itemsize) - start // self.itemsize
        begin = first % self.rows
        if count >= self.rows:
            return [(0, self.rows)]
        if begin + count <= self.rows:
            return [(begin, begin + count)]
        return [(0, begin + count - self.rows), (begin, self.rows)]
