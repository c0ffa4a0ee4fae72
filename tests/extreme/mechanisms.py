"""All mechanisms with extreme cases."""

from __future__ import annotations

from extreme.focal import FOCAL
from extreme.hart import HART
from extreme.minkowski import MINKOWSKI_4R
from extreme.planar import PLANAR_4R

MECHANISMS = {mechanism.catalogue.name: mechanism for mechanism in (PLANAR_4R, MINKOWSKI_4R, FOCAL, HART)}
