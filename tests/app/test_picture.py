"""The picture of error against run time: names and ticks can be read."""

import itertools

import numpy as np
import pytest
import xarray as xr
from matplotlib.text import Text

from fastlink.app.accuracy import draw

# as of omega4_max in docs/accuracy.md: methods whose times and errors are nearly the same
CROWDED = {
    "32 angles": (60, 3e-3), "64 angles": (84, 9e-4), "128 angles": (150, 2e-4), "256 angles": (290, 5e-5),
    "360 angles": (350, 2.8e-5), "360 angles, relaxed": (270, 2.8e-5), "512 angles": (540, 1.3e-5),
    "1024 angles": (950, 3.5e-6), "2048 angles": (1800, 7e-7), "4096 angles": (2500, 2e-7),
    "refined": (335, 4e-16), "refined, relaxed": (210, 4e-16), "NumPy, 360 angles": (1.1e6, 1.5e-5),
    "scipy, brentq": (4.7e6, 3e-16), "scipy, minimize_scalar": (5.4e6, 4e-16),
}  # fmt: skip
ALIKE = {"eliminated": (870.0, 1.1e-12), "dense": (910.0, 1.3e-12), "NumPy": (1200.0, 1.2e-12)}


@pytest.mark.parametrize("methods", [CROWDED, ALIKE], ids=["crowded", "alike"])
def test_no_label_covers_another(methods, tmp_path):
    times, errors = np.array(list(methods.values())).T
    measured = xr.Dataset(
        {
            name: (("way", "quantity"), values[:, None])
            for name, values in {"ns_per_design": times, "error_max": errors, "pareto": times < 300}.items()
        },
        {"way": list(methods), "quantity": ["omega4_max"]},
    )
    figure = draw(measured)
    figure.savefig(tmp_path / "accuracy.png")
    (axes,) = figure.axes
    boxes = [Text.get_window_extent(text) for text in axes.texts]  # without its line
    assert sorted(text.get_text() for text in axes.texts) == sorted(methods)
    assert not [(a, b) for a, b in itertools.combinations(boxes, 2) if a.overlaps(b)]
    for axis in (axes.xaxis, axes.yaxis):
        low, high = sorted(axis.get_view_interval())
        ticks = [tick for tick in axis.get_major_ticks() if low <= tick.get_loc() <= high]
        assert len(ticks) >= 1
        shown = [tick.label1.get_window_extent() for tick in ticks]
        assert not [(a, b) for a, b in itertools.combinations(shown, 2) if a.overlaps(b)]
