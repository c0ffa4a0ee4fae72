"""The mechanisms: inputs and facts, nothing else."""
