"""Studies, the command line, and what they report: quantities, summaries, explanations, accuracy, tolerances."""
