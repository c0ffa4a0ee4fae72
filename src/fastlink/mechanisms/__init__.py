"""The mechanisms: inputs and facts, nothing else."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING

from fastlink.errors import InputError, suggest

if TYPE_CHECKING:
    from collections.abc import Callable

    from fastlink.catalogue import Catalogue

_lock = threading.Lock()
NAMES = ("planar_4r", "minkowski_4r", "focal", "hart")


def catalogue(mechanism: str, input: str | None = None) -> Catalogue:
    """Return the catalogue of a mechanism by its name, driven by the named input or else by its first.

    Raises
    ------
    InputError
        The mechanism or the input is unknown.
    """
    if mechanism not in NAMES:
        raise InputError(f"mechanism {mechanism!r} is unknown; {suggest(str(mechanism), NAMES)}")
    from importlib import import_module

    package = import_module(f"fastlink.mechanisms.{mechanism}")
    found: Catalogue = getattr(package, mechanism)
    if input in (None, found.position.name):
        return found
    driven: dict[str, Callable[[], Catalogue]] = package.DRIVEN
    if input not in driven:
        inputs = (found.position.name, *driven)
        raise InputError(f"input {input!r} is unknown to {mechanism}; {suggest(str(input), inputs)}")
    with _lock:
        return driven[input]()
