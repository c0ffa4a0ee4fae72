"""The doors `sweep`, `evaluate` and `function`, and the parts that they share.

A module enters here if it resolves requests, runs their kernels or labels their results.
"""
