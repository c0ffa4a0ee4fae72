"""Speed of the compiled plans against C, NumPy and JAX on the same arithmetic."""
