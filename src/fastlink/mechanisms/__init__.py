"""The mechanisms: inputs and facts, nothing else."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fastlink.errors import InputError, suggest

if TYPE_CHECKING:
    from fastlink.catalogue import Catalogue

NAMES = ("planar_4r",)


def catalogue(mechanism: str) -> Catalogue:
    """Return the catalogue of a mechanism by its name.

    Raises
    ------
    InputError
        The name is unknown.
    """
    if mechanism not in NAMES:
        raise InputError(f"mechanism {mechanism!r} is unknown; {suggest(str(mechanism), NAMES)}")
    from importlib import import_module

    found: Catalogue = getattr(import_module(f"fastlink.mechanisms.{mechanism}"), mechanism)
    return found
