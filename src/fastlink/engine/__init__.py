"""Doors to compiled kernels besides the sweep: a kernel as a function of arrays, and as one that numba calls.

What enters here takes a resolved request and runs its kernels; it knows no labels and no files.
"""
