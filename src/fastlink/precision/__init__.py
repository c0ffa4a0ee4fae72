"""What error a sweep's results have: some of its designs computed again with 50 digits."""

from fastlink.precision.verification import Verification, check_verify

__all__ = ["Verification", "check_verify"]
