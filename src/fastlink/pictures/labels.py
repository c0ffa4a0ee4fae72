"""Compose the text of pictures: titles, labels with symbols and units, fixed values."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Mapping
from typing import TYPE_CHECKING

from fastlink._text import short_number
from fastlink.maps.units import DEGREE

if TYPE_CHECKING:
    import xarray as xr


GREEK = "alpha|beta|gamma|delta|epsilon|zeta|eta|theta|kappa|lambda|mu|nu|xi|rho|sigma|tau|phi|chi|psi|omega|Delta"
#: A symbol with its index; one after the d of a derivative, with the orders; what may stand between symbols.
SYMBOL = re.compile(rf"({GREEK}|[A-Za-z]+)(?:_\{{?([A-Za-z0-9]+)\}}?)?")
SLOPE = re.compile(rf"d(\d?)(?:({GREEK}|[A-Za-z])(?:_([A-Za-z0-9]+))?(\d?))?")
BETWEEN = re.compile(r"([/()|])")
CONSTANTS_PER_LINE = 8
TITLE_WIDTH = 64  # letters
WORDS = frozenset({"max", "min", "peak", "rms", "at", "status"})


def plain(text: object) -> str:
    """Return a text as matplotlib shows it as it is: a dollar sign does not begin a formula."""
    return str(text).replace("$", r"\$")


def mathematical(symbol: str) -> str:
    r"""Return a catalogue symbol as matplotlib sets it.

    Examples
    --------
    >>> mathematical("max omega_4"), mathematical("F_32x"), mathematical("theta_{max}")
    ('max $\\omega_{4}$', '$F_{32x}$', '$\\theta_{max}$')
    >>> mathematical("1/rho_P"), mathematical("d2v_1/dt2"), mathematical("ch(psi_{max})")
    ('$1/\\rho_{P}$', '$d^2v_{1}/dt^2$', '$\\mathrm{ch}(\\psi_{max})$')
    """
    return " ".join(plain(word) if word in WORDS else _formula(word) for word in symbol.split())


def _formula(word: str) -> str:
    """Return a word of a symbol as a formula; as it is if it is not made of symbols and whole numbers."""
    pieces = [_piece(piece) for piece in BETWEEN.split(word)]
    whole = "".join(piece or "" for piece in pieces)
    return plain(word) if None in pieces or not any(map(str.isalpha, whole)) else f"${whole}$"


def _piece(piece: str) -> str | None:
    """Return a symbol, a slope or a number as part of a formula, None of anything else."""
    if piece.isdecimal() or not piece or BETWEEN.fullmatch(piece):
        return piece
    if (slope := SLOPE.fullmatch(piece)) and piece not in WORDS:
        order, base, index, by = slope.groups()
        return f"d{_raised(order)}{_letter(base, index)}{_raised(by)}" if base else f"d{_raised(order)}"
    if symbol := SYMBOL.fullmatch(piece):
        return _letter(*symbol.groups())
    return None


def _letter(base: str, index: str | None) -> str:
    is_greek = re.fullmatch(GREEK, base)
    letter = f"\\{base}" if is_greek else base if len(base) == 1 else f"\\mathrm{{{base}}}"
    return letter + (f"_{{{index}}}" if index else "")


def _raised(order: str) -> str:
    return f"^{order}" if order else ""


def units_text(units: str) -> str:
    """Return units as matplotlib sets them, with raised exponents and the sign of degrees."""
    if units == DEGREE:
        return "°"
    return re.sub(r"([A-Za-z]+)(-?\d+)", r"\1$^{\2}$", plain(units))


def label_of(array: xr.DataArray, name: bool = True) -> str:
    """Return the label of an axis: name, symbol and units."""
    attrs = array.attrs
    parts = [plain(attrs.get("long_name", array.name))] if name else []
    if "symbol" in attrs:
        parts.append(mathematical(str(attrs["symbol"])))
    units = str(attrs.get("units", "1"))
    if units != "1":
        parts.append(f"[{units_text(units)}]")
    return " ".join(parts) or plain(array.name)


def valued(array: xr.DataArray, value: object) -> str:
    """Return a variable and its value, with symbol and units."""
    symbol = mathematical(str(array.attrs.get("symbol", array.name)))
    units = str(array.attrs.get("units", "1"))
    space = "" if units in ("1", DEGREE) else " "
    return f"{symbol} = {plain(short_number(value))}{space}{'' if units == '1' else units_text(units)}"


def title_of(dataset: xr.Dataset, variable: xr.DataArray, fixed: Mapping[str, object], branches: str) -> str:
    """Return the name of a variable, the values at which dimensions are fixed, and the branches."""
    title = textwrap.fill(plain(variable.attrs.get("long_name", variable.name)), TITLE_WIDTH)
    values = ", ".join(filter(None, [*(valued(dataset[dim], one) for dim, one in fixed.items()), branches]))
    return f"{title}\n{values}" if values else title


def constants_of(dataset: xr.Dataset) -> str:
    """Return the inputs that are the same for every design, a few to a line."""
    scalars = [coord for coord in dataset.coords.values() if coord.ndim == 0 and "symbol" in coord.attrs]
    parts = [valued(coord, coord.item()) for coord in scalars]
    lines = [", ".join(parts[k : k + CONSTANTS_PER_LINE]) for k in range(0, len(parts), CONSTANTS_PER_LINE)]
    return ",\n".join(lines)
