"""The wording of problems for the author of a study."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fastlink.errors import KeyPath, Model, Pair, Piece, Problem, Samples, Setting, Wording, path_text
from fastlink.study.schema import KEEP, KEYS, SAMPLES

if TYPE_CHECKING:
    from fastlink.space.design_space import DesignSpace

__all__ = ["StudyWording"]

#: Parameters of `fastlink.sweep` with another name in a study.
PARAMETERS = {"to": "file"}


class StudyWording(Wording):
    """The wording of problems for the author of a study: in its own keys and grammar.

    Parameters
    ----------
    file : Path
        The study.
    tables : mapping, optional
        Its tables, as far as they were read.
    space : DesignSpace, optional
        Its designs.
    """

    def __init__(
        self, file: Path, tables: Mapping[str, Any] | None = None, space: DesignSpace | None = None
    ) -> None:
        self.file, self.tables, self.space = file, tables or {}, space
        self.door = Wording()

    def within(self, door: Wording) -> Wording:
        """Return this wording with the options of the door that the study was given at."""
        worded = StudyWording(self.file, self.tables, self.space)
        worded.door = door
        return worded

    def line(self, problem: Problem) -> str:
        """Return a problem as one line, after the file."""
        return f"{self.file}: {super().line(problem)}"

    def path(self, where: KeyPath) -> str:
        """Return a path as the key of the study."""
        return "" if where[:1] == ("study",) else path_text(self._key(where))

    def _key(self, where: KeyPath) -> KeyPath:
        where = where[1:] if where[:1] == ("attrs",) else where  # the title, and the names of files
        head, *rest = where or ("",)
        if head in SAMPLES:
            return ("design", *where)
        if head in ("grid", "design"):
            return ("design", *self._sample(rest), *rest)
        key = PARAMETERS.get(str(head), head)
        for name, keys in KEYS.items():
            if key in keys or key in self._table(name):
                return (name, key, *rest)
        return where

    def _table(self, name: str) -> Mapping[str, Any]:
        table = self.tables.get(name)
        return table if isinstance(table, Mapping) else {}

    def _sample(self, rest: Sequence[str | int]) -> KeyPath:
        """Return the key of the sample or the table that gives an input, if one does."""
        design = self._table("design")
        if self.space is None or not rest or rest[0] not in self.space.names or rest[0] in design:
            return ()
        return tuple(kind for kind in SAMPLES if kind in design)

    def piece(self, piece: Piece) -> str | None:
        """Return a piece of a remedy in the grammar of studies, or None where they have no such key."""
        if isinstance(piece, Samples):
            return f"{{linspace = [{piece.first:g}, {piece.last:g}, {piece.count}]}}"
        if isinstance(piece, Pair):
            return "[lo, hi], inf or -inf for no limit" if piece.unlimited else "[lo, hi]"
        if isinstance(piece, Model):
            keys = "".join(f" {name} = ..." for name in piece.inputs)
            return f'[links] model = "{piece.name}"{keys}'
        if isinstance(piece, Setting):
            if piece.name in ("overwrite", "part", "restart", "trust_code"):
                return self.door.piece(piece)  # for once, by who runs the study
            known = piece.name == KEEP or any(piece.name in keys for keys in KEYS.values())
            return f"{piece.name} = {json.dumps(piece.value)}" if known else None
        return piece
