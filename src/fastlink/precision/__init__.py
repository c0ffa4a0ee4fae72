"""Measure the errors of a sweep's results, by 50 digits for some of its designs."""

from fastlink.precision.verification import Verification, check_verify

__all__ = ["Verification", "check_verify"]
