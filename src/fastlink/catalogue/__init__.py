"""The catalogue of a mechanism: its declared facts, their dependencies, their evaluation without a kernel.

No mechanism is known here by name; those are declared in `fastlink.mechanisms`.
"""
