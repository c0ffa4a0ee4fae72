"""Facts: what a mechanism declares, as expressions that can be read, differentiated and bounded.

Nothing here knows an array or a kernel. `fact` and `names` are grammars, `expression` is the graph, `derivative` and
`bounds` read it, `catalogue` collects the facts of a mechanism, `own` adds those of a user.
"""
