"""The study of the repository on offset slider-cranks runs, and its map says what quick return costs."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from fastlink.app.study import run_study
from fastlink.numerics.compensated import UNIT_ROUNDING

STUDY = Path(__file__).parents[3] / "data" / "studies" / "slider_crank_press.toml"


def test_the_study_of_quick_return(folder):
    path = Path(STUDY.name)
    path.write_text(STUDY.read_text(encoding="utf-8").replace(", 31]", ", 7]"), encoding="utf-8")
    with run_study(path) as maps:
        maps = maps.load()
    assert maps.sizes["l"] == maps.sizes["e"] == 7
    turns = maps.l > 0.1 + maps.e + 1e-12  # tenths are not doubles
    np.testing.assert_array_equal(np.isfinite(maps.time_ratio), turns)
    np.testing.assert_array_equal(maps.time_ratio.sel(e=0.0), 1.0)
    # The farther the line is off, the quicker the return and the worse the transmission.
    for name, sign in (("time_ratio", 1), ("transmission_angle_greatest", 1)):
        steps = np.diff(maps[name].where(turns).values, axis=maps[name].dims.index("e"))
        assert np.nanmin(sign * steps) > 0.0, name
    # of a whole turn: both ends of the stroke are extremes of the position
    way = 4.0 * 0.1 * maps.l / (maps.outer_dead_centre + maps.inner_dead_centre)
    np.testing.assert_allclose(maps.stroke.where(turns), way.where(turns), rtol=16 * UNIT_ROUNDING)
    assert np.all(maps.T41_fluctuation.where(turns).fillna(1.0) > 0.0)
