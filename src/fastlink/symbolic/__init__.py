"""Properties derived from the text of facts: derivatives, error bounds, homogeneity, asymptotics.

Everything here takes facts and returns facts or properties of them; no mechanism, no array, no kernel.
"""
