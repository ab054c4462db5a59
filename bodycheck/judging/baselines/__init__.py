"""Comparison of results with earlier results.

- `baseline` saves results and reads them back, and `difference` finds the changes between two baselines.
- `rounding` estimates the differences that rounding can cause, from runs whose initial states are changed a little.
"""
