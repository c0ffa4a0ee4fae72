"""Design spaces and link models: numbered designs whose inputs are filled in on demand.

Nothing here knows what is computed for a design.
"""
