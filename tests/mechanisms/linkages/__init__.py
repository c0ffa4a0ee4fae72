"""Linkages that are declared by their joints."""
