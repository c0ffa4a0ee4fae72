"""Explain what a study computes, and measure error against run time."""

from fastlink.diagnostics.pareto import accuracy_table
from fastlink.diagnostics.work_precision import accuracy

__all__ = ["accuracy", "accuracy_table"]
