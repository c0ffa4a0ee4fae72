"""Hostile input at every door: each case is one line of Python, made from a seed and judged by one oracle.

`values` says what may stand for an argument, `doors` where it is given, `judge` what may come of it; `tables`,
`studies` and `lines` make texts; `campaign` draws the cases of a seed and counts what became of them.
"""
