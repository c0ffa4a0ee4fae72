"""Colours of maps and of codes, and figures that a notebook shows."""

from __future__ import annotations

import contextlib
import io
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import matplotlib
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import CenteredNorm, ListedColormap, LogNorm, Normalize, to_hex
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from fastlink._text import in_words
from fastlink.maps.units import flags_of, half_turn

if TYPE_CHECKING:
    import xarray as xr


# -- Choose the colours of maps: ranges without far outliers, and those of codes


CYCLIC = "twilight_shifted"
# Colours of branches, and of the codes that most mechanisms have, then of long lists of types. All can be told
# apart by people who do not see red, green or blue as others do: tests/pictures/test_colours.py.
LINES = ("#0b5fa5", "#d1495b", "#e69f00", "#56b4e9")
FLAGS = (
    *("#009e73", "#f0e442", "#c3c9d3", "#d55e00", "#333333", "#b10de0"),
    *("#9af79a", "#6b3c0d", "#f782f7", "#0d5382", "#0d0df7", "#e0b153", "#b182b1", "#530d9a", "#e00d3c"),
)
ABSENT, INFINITE, VEIL = "0.78", "0.45", (1.0, 1.0, 1.0, 0.55)
WITHOUT_BOUND = "grows without bound"
MOST_COUNTS = 8
# Matplotlib subtracts, multiplies and takes logarithms of values without a care for overflow.
LARGEST, SMALLEST = 1e300, 1e-290
FAR = 1e9  # spans outside a range of colours, where all values look the same


def colours_of(values: Any, regular: Any, half_turn: float | None) -> tuple[Any, Any, str]:
    """Return norm, colour map and open ends, from the regular cells if there are any.

    An angle that passes from half a turn to minus half a turn has a cyclic map, values of both signs have zero in the
    middle.
    """
    inside = values[regular]
    low, high, extend = limits_of(values, inside, 2.0)
    if half_turn is not None and low < -0.9 * half_turn and high > 0.9 * half_turn:
        return Normalize(-half_turn, half_turn), matplotlib.colormaps[CYCLIC], "neither"
    if low < 0 < high and min(-low, high) > 0.05 * max(-low, high):
        return CenteredNorm(0.0, max(-low, high)), matplotlib.colormaps["RdBu_r"], extend
    positive = inside[np.isfinite(inside)] if low > 0 else np.empty(0)
    low_inner, high_inner = np.percentile(positive, (2, 98)) if positive.size else (1.0, 1.0)
    if high_inner > 30 * low_inner:
        return LogNorm(low, high), matplotlib.colormaps["viridis"], extend
    return Normalize(low, high), matplotlib.colormaps["viridis"], extend


def drawable(values: Any) -> Any:
    """Return values with the finite ones beyond what matplotlib can draw at its limits."""
    clipped = np.where(np.abs(values) < SMALLEST, 0.0, np.clip(values, -LARGEST, LARGEST))
    return np.where(np.isinf(values), values, clipped)


def near(values: Any, norm: Any) -> Any:
    """Return values with far outliers moved towards the range of a norm, where their colour is the same."""
    span = norm.vmax - norm.vmin
    return np.clip(values, norm.vmin - FAR * span, norm.vmax + FAR * span)


def are_counts(values: Any) -> bool:
    """Tell whether values are a few neighbouring whole numbers."""
    counts = np.unique(values[np.isfinite(values)])
    few = 1 < counts.size <= MOST_COUNTS and counts[-1] - counts[0] < MOST_COUNTS
    return bool(few and (counts % 1.0 == 0.0).all())


def count_colours(values: Any) -> tuple[Any, Any, str]:
    """Return norm and colour map of counts, one colour for each."""
    low, high = np.nanmin(values), np.nanmax(values)
    colours = matplotlib.colormaps["viridis"].resampled(int(high - low) + 1)
    return Normalize(low - 0.5, high + 0.5), colours, "neither"


def limits_of(values: Any, regular: Any, most: float) -> tuple[float, float, str]:
    """Return a range, and at which ends values lie outside.

    The range is that of the regular values, or of their inner 96 % if that is `most` times shorter: a few far outliers
    must not use up a scale.
    """
    every = values[np.isfinite(values)]
    finite = regular[np.isfinite(regular)]
    finite = finite if finite.size else every
    if not finite.size:
        return 0.0, 1.0, "neither"
    low, high = float(finite.min()), float(finite.max())
    inner_low, inner_high = (float(value) for value in np.percentile(finite, (2, 98)))
    if high - low > most * (inner_high - inner_low) > 0:
        margin = 0.1 * (inner_high - inner_low)
        low, high = max(low, inner_low - margin), min(high, inner_high + margin)
    ends = (bool(every.min() < low), bool(every.max() > high))
    if low == high:
        low, high = low - 0.5 * (abs(low) or 1.0), high + 0.5 * (abs(high) or 1.0)
    return low, high, {(True, True): "both", (True, False): "min", (False, True): "max"}.get(ends, "neither")


def flag_looks(variable: xr.DataArray) -> list[tuple[int, str, str]]:
    """Return each code of a variable with its meaning in words and its colour."""
    flags = enumerate(flags_of(variable).items())
    return [(code, in_words(meaning), FLAGS[k % len(FLAGS)]) for k, (meaning, code) in flags]


def flag_colours(variable: xr.DataArray) -> tuple[Any, Any, str]:
    """Return norm and colour map of the indices of a code, one colour for each."""
    colours = [colour for *_, colour in flag_looks(variable)]
    return Normalize(-0.5, len(colours) - 0.5), ListedColormap(colours), "neither"


def flag_indices(variable: xr.DataArray, values: Any) -> Any:
    """Return the index of each code in the list of codes, NaN for other values."""
    indices = np.full(values.shape, np.nan)
    for index, code in enumerate(flags_of(variable).values()):
        indices[values == code] = index
    return indices


def flag_handles(variable: xr.DataArray, values: Any) -> list[Any]:
    """Return the legend of a code, for the values that occur."""
    return [
        Patch(facecolor=colour, label=meaning)
        for code, meaning, colour in flag_looks(variable)
        if (values == code).any()
    ]


# -- Choose the colours of a variable for the page, as a picture of it has them


#: The colour maps that scales name: even in lightness, and told apart by the colour-blind.
COLOURS = ("viridis", "RdBu_r", CYCLIC)
STEPS = 256


def colour_tables() -> dict[str, list[str]]:
    """Return each colour map as a list of colours."""
    places = np.linspace(0.0, 1.0, STEPS)
    return {name: [to_hex(one) for one in matplotlib.colormaps[name](places)] for name in COLOURS}


def scale_of(variable: xr.DataArray, sample: Any, regular: Any = None) -> dict[str, Any]:
    """Return how values become colours, from a sample of them."""
    if looks := flag_looks(variable):
        return {"kind": "codes", "colours": {str(code): colour for code, _, colour in looks}, "pools": False}
    values = np.ravel(np.asarray(sample, dtype=float))
    if are_counts(values):
        low, high = float(np.nanmin(values)), float(np.nanmax(values))
        return {"kind": "counts", "low": low - 0.5, "high": high + 0.5, "map": "viridis", "pools": False}
    values = np.where(np.isfinite(values), drawable(values), np.nan)
    inside = np.ones(values.shape, bool) if regular is None or not np.any(regular) else np.ravel(regular)
    norm, colours, extend = colours_of(values, inside, half_turn(variable.attrs.get("units")))
    low, high = float(norm.vmin), float(norm.vmax)
    kind = "log" if isinstance(norm, LogNorm) else "linear"
    scale = {"kind": kind, "low": low, "high": high, "map": colours.name, "extend": extend}
    # an angle and that half a turn further on have no mean
    return {**scale, "pools": colours.name != CYCLIC}


# -- Figures that a notebook shows, outside matplotlib's global state


STYLE = {
    "font.size": 10,
    "axes.titlesize": 10.5,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "hatch.color": "0.35",
    "hatch.linewidth": 0.5,
    "savefig.dpi": 160,
    "svg.hashsalt": "fastlink",  # equal pictures are equal files
}
DPI = 100  # in a notebook


class NotebookFigure(Figure):
    """A figure that a notebook shows as a picture, without pyplot; it need not be closed."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**{"layout": "constrained"} | options)
        FigureCanvasAgg(self)

    def _repr_png_(self) -> bytes:
        """Return the picture as a notebook shows it."""
        written = io.BytesIO()
        with style():
            self.savefig(written, format="png", dpi=DPI)
        return written.getvalue()


@contextlib.contextmanager
def style() -> Iterator[None]:
    """Draw with settings of our own, and restore the user's."""
    with matplotlib.rc_context():
        matplotlib.rcParams.update({**matplotlib.rcParamsDefault, **STYLE, "backend": "agg"})
        yield
