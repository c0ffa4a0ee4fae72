"""The codes of what the derivatives of an extreme by the inputs are worth; their meanings stand in `plan.gradients`."""

__all__ = [
    *("AT_CHANGE_POINT", "AT_LIMIT", "CONSTANT", "INFINITE", "JUMP", "KINK", "MOVING", "NOTHING"),
    *("OF_SAMPLES", "SMOOTH", "TIED"),
]

SMOOTH, AT_LIMIT, TIED, INFINITE, AT_CHANGE_POINT, NOTHING, KINK, OF_SAMPLES, CONSTANT, JUMP, MOVING = range(
    11
)
