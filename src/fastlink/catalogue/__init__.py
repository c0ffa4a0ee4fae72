"""The catalogue of a mechanism: its declared facts, their dependencies, their evaluation without a kernel.

Nothing here depends on a mechanism; mechanisms are declared in `fastlink.mechanisms`.
"""
