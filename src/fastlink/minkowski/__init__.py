"""What belongs to linkages of the Minkowskian plane alone."""

from fastlink.minkowski.curves import sextic

__all__ = ["sextic"]
