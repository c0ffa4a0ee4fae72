"""Functions of Burmester's focal mechanism: its cubic, constructions on it, conics, the five-bar, straight lines."""

from fastlink.analysis.focal.best_drive import best_point
from fastlink.analysis.focal.conics import InscribedConic, Involution, inscribed_conics, involution
from fastlink.analysis.focal.construction import Construction, from_point
from fastlink.analysis.focal.cubic import cubic, cubic_points
from fastlink.analysis.focal.five_bar import five_bar, from_five_bar
from fastlink.analysis.focal.inversion import held_at_AB
from fastlink.analysis.focal.straight_line import StraightLine, T_deviation, straight_line

__all__ = [
    "Construction",
    "InscribedConic",
    "Involution",
    "StraightLine",
    "T_deviation",
    "best_point",
    "cubic",
    "cubic_points",
    "five_bar",
    "from_five_bar",
    "from_point",
    "held_at_AB",
    "inscribed_conics",
    "involution",
    "straight_line",
]


def __dir__() -> list[str]:
    return __all__
