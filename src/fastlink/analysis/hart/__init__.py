"""What belongs to Hart's straight-line linkage alone."""

from fastlink.analysis.hart.integers import integer_designs

__all__ = ["integer_designs"]
