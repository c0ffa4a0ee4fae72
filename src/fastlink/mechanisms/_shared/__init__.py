"""Parts that two mechanisms use: laws, lengths, and facts of one under their names in another."""
