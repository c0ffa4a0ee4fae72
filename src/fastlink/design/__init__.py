"""Find designs: the best of a map or of a search without one, refined off the grid.

`refine` improves designs by exact derivatives, `search` streams a sweep and keeps its best rows, `best` ranks a map.
"""
