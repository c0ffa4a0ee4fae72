"""Error against run time: every way to a study's quantities, measured."""

from fastlink.accuracy.measure import accuracy
from fastlink.accuracy.report import accuracy_table

__all__ = ["accuracy", "accuracy_table"]
