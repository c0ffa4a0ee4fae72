"""Design spaces, whose inputs are filled in on demand, and link models.

Nothing here knows what is computed for a design.
"""
