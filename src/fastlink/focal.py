"""Functions of Burmester's focal mechanism; see `fastlink.focal`."""

from fastlink.analysis.focal import (
    Construction,
    InscribedConic,
    Involution,
    StraightLine,
    T_deviation,
    best_point,
    cubic,
    cubic_points,
    five_bar,
    from_five_bar,
    from_point,
    held_at_AB,
    inscribed_conics,
    involution,
    straight_line,
)

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
