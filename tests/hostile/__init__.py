"""Hostile input at every door: each case is one line of Python, made from a seed and judged by one oracle."""
