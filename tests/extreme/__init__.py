"""Stiff and extreme cases of every mechanism: tables of named cases, and one judge of what comes out."""
