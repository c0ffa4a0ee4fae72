"""Planar linkages by the million."""
