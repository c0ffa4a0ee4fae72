"""Measure the errors of a sweep's results: some of its designs are computed again with 50 digits."""

from fastlink.precision.verification import Verification, check_verify

__all__ = ["Verification", "check_verify"]
