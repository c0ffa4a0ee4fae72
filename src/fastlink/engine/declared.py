"""Check the declarations of a user against the text of them that a map has, which nothing runs."""

from __future__ import annotations

import re
from typing import Any

from fastlink._text import short_repr
from fastlink.engine.extending import Extension
from fastlink.errors import InputError, KeyPath, Setting
from fastlink.own.catalogue import used
from fastlink.own.definition import declared_names, definition_text

__all__ = ["check_declared", "is_own", "own_refused"]


class _Mine:
    """The extension that a remedy names: a variable in Python, its file at the command line."""

    def __repr__(self) -> str:
        return "mine"

    def __str__(self) -> str:
        return "mine.py"


def is_own(name: str, text: str) -> bool:
    """Tell whether a name of a map is of quantities or inputs of a user, of which the map has the text.

    Examples
    --------
    >>> is_own("cost_max", "def cost(F21):"), is_own("omega4_max", "def cost(F21):")
    (True, False)
    """
    return any(re.search(rf"(^|_){re.escape(own)}(_|$)", name) for own in declared_names(text))


def own_refused(where: KeyPath, name: str) -> InputError:
    """Return the error of a result of a map that a user has declared, where the declarations are not given."""
    what = f"{name!r} is of quantities of a user's own, of which a map has the text and runs none"
    remedy = ("write ", Setting("mechanism", _Mine()), ", with which the map was made")
    return InputError(what, where=where, remedy=remedy)


def check_declared(where: KeyPath, given: Any, mechanism: str, text: str) -> Extension:
    """Return the extension by which a map was made, or refuse another one.

    Parameters
    ----------
    where : tuple
        The option.
    given : Extension
        The extension.
    mechanism, text : str
        What the map tells of its mechanism, and of quantities of a user.
    """
    if not isinstance(given, Extension):
        remedy = "give what fastlink.extend returned"
        raise InputError(f"is {short_repr(given)}, not an extended mechanism", where=where, remedy=remedy)
    catalogue = given.catalogue()
    names = declared_names(text)
    if given.mechanism != mechanism or (
        text and definition_text(mechanism, used(catalogue, (), names)) != text
    ):
        what = f"is {short_repr(given)}, and the map is of {mechanism} with other declarations"
        raise InputError(what, where=where, remedy="give the extension by which it was made")
    return given
