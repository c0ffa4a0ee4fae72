"""Kernels: from a plan's facts to text, to machine code."""

from fastlink.kernels.compiled import kernel_key, load_kernel
from fastlink.kernels.items import LANES
from fastlink.kernels.refined import write_refined
from fastlink.kernels.text import write_kernel

__all__ = ["LANES", "kernel_key", "load_kernel", "write_kernel", "write_refined"]
