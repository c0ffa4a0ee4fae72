"""Tables for the terminal and the documentation: quantities of a mechanism, summaries of maps."""
