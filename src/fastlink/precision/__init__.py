"""Measure the errors of a sweep's results, by 50 digits for some of its designs."""

from fastlink.precision.verification import DESIGNS, Verification, check_verify, with_remark

__all__ = ["DESIGNS", "Verification", "check_verify", "with_remark"]
