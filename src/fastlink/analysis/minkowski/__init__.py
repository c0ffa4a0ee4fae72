"""What belongs to linkages of the Minkowskian plane alone."""

from fastlink.analysis.minkowski.curves import sextic

__all__ = ["sextic"]
