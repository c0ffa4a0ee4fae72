"""Declarations: facts, inputs, and the grammars of their text and of their names.

Nothing here knows a mechanism, an array or a kernel; it imports `fastlink.numerics` alone.
"""
