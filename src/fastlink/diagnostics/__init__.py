"""Error against run time: every way to a study's quantities, measured."""

from fastlink.diagnostics.pareto import accuracy_table
from fastlink.diagnostics.work_precision import accuracy

__all__ = ["accuracy", "accuracy_table"]
