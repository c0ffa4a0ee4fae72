"""Tables of text: quantities of a mechanism, summaries of maps."""
