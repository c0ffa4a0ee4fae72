"""Arithmetic that compiles, runs on NumPy arrays and on mpmath numbers, with the same text.

Nothing here knows a mechanism, and nothing here imports a compiler.
"""
