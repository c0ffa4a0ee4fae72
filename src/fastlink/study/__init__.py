"""Studies: TOML files that name a mechanism, a design space and quantities.

A study is checked by the same checks as a sweep; only their wording differs.
"""
