"""From requested names to programs: what a kernel has to compute, as data only.

No kernel text, no machine code, no array of results.
"""
