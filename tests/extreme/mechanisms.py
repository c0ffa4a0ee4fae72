"""All mechanisms with extreme cases."""

from __future__ import annotations

from tests.extreme.focal import FOCAL
from tests.extreme.hart import HART
from tests.extreme.minkowski import MINKOWSKI_4R
from tests.extreme.planar import PLANAR_4R

MECHANISMS = {mechanism.catalogue.name: mechanism for mechanism in (PLANAR_4R, MINKOWSKI_4R, FOCAL, HART)}
