"""Colours of lines and codes are told apart, also by people who do not see red, green or blue as others do."""

import itertools

import numpy as np
import pytest
from matplotlib.colors import to_rgb

from fastlink.pictures.style import FLAGS, LINES

# Machado, Oliveira, Fernandes (2009): what is seen with full deuteranopia, protanopia, tritanopia, in linear RGB
SIGHT = {
    "common": np.eye(3).ravel(),
    "no green": (0.367322, 0.860646, -0.227968, 0.280085, 0.672501, 0.047413, -0.011820, 0.042940, 0.968881),
    "no red": (0.152286, 1.052583, -0.204868, 0.114503, 0.786281, 0.099216, -0.003882, -0.048116, 1.051998),
    "no blue": (1.255528, -0.076749, -0.178779, -0.078411, 0.930809, 0.147602, 0.004733, 0.691367, 0.303900),
}
TO_XYZ = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])
# of CIELAB: 2.3 is just noticeable side by side; a legend is some way off, so about ten times that
APART = 20.0


def lab(colour, sight):
    """Return lightness and two hues of a colour, as someone sees it."""
    rgb = np.array(to_rgb(colour))
    linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
    ratio = TO_XYZ @ np.clip(np.reshape(sight, (3, 3)) @ linear, 0.0, 1.0) / TO_XYZ.sum(axis=1)
    f = np.where(ratio > 0.008856, np.cbrt(ratio), 7.787 * ratio + 16.0 / 116.0)
    return np.array([116.0 * f[1] - 16.0, 500.0 * (f[0] - f[1]), 200.0 * (f[1] - f[2])])


@pytest.mark.parametrize("sight", SIGHT.values(), ids=SIGHT)
@pytest.mark.parametrize("colours", [LINES, FLAGS], ids=["lines", "codes"])
def test_colours_can_be_told_apart(colours, sight):
    for one, other in itertools.combinations(colours, 2):
        assert np.hypot.reduce(lab(one, sight) - lab(other, sight)) > APART, (one, other)
