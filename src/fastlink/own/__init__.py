"""Quantities and inputs that users declare: their texts as facts, their units, and a mechanism's catalogue with them.

What a user writes is read, never run: its text becomes a fact like those of the package.
"""
