"""Sinks that travel: they work in other processes, and what they have gathered there is merged here.

A sink is made of functions and of objects that keep something: a file, counts, chosen designs. Functions travel by
value; of each object a twin is made in the other process, which keeps the same for some designs and reports it.
"""

from __future__ import annotations

import collections
import io
import pickle
from collections.abc import Sequence
from types import MethodType
from typing import Any, ClassVar, Protocol

__all__ = ["Traveller", "Twin", "packed", "unpacked"]


class Twin(Protocol):
    """A stand-in for an object in another process, for the designs of one task; picklable before it has any."""

    def report(self) -> Any:
        """Return what was gathered, which travels back."""


class Traveller(Protocol):
    """An object that has twins in other processes."""

    def twin(self) -> Twin:
        """Return a twin, which has gathered nothing."""

    def merge(self, report: Any) -> None:
        """Add what a twin has gathered."""


def packed(value: Any) -> tuple[bytes, list[Traveller]]:
    """Return a value as bytes, and the travellers in it, which `unpacked` gives twins."""
    import cloudpickle

    travellers: list[Traveller] = []
    twins: list[Twin] = []

    class Packer(cloudpickle.Pickler):  # type: ignore[misc]
        # methods by their name: of a twin they are those of its own class
        dispatch_table: ClassVar[Any] = collections.ChainMap(
            {MethodType: _by_name}, cloudpickle.Pickler.dispatch_table
        )

        def persistent_id(self, known: Any) -> Any:
            if not (hasattr(type(known), "twin") and hasattr(type(known), "merge")):
                return None
            if known not in travellers:
                travellers.append(known)
                twins.append(known.twin())  # one, wherever it is referred to
            return travellers.index(known), twins[travellers.index(known)]

    file = io.BytesIO()
    Packer(file, protocol=pickle.HIGHEST_PROTOCOL).dump(value)
    return file.getvalue(), travellers


def _by_name(method: MethodType) -> tuple[Any, ...]:
    return getattr, (method.__self__, method.__name__)


def unpacked(data: bytes) -> tuple[Any, Sequence[Twin]]:
    """Return a packed value, and its new twins in the order of the travellers."""
    twins: dict[int, Twin] = {}

    class Unpacker(pickle.Unpickler):
        def persistent_load(self, known: Any) -> Any:
            index, twin = known
            return twins.setdefault(index, twin)

    value = Unpacker(io.BytesIO(data)).load()
    return value, [twins[k] for k in sorted(twins)]
