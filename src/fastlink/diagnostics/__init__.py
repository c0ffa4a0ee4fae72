"""Explain what a study computes; measure error against run time of its quantities by every method."""

from fastlink.diagnostics.pareto import accuracy_table
from fastlink.diagnostics.work_precision import accuracy

__all__ = ["accuracy", "accuracy_table"]
