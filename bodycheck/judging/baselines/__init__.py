"""Comparison of results with earlier ones.

- `baseline` saves results and finds changes, within `tolerances`; `baseline_checks` checks a baseline that is read.
- `rounding` estimates the differences that rounding can cause, from `nudged_runs`, whose initial states are changed a little.
"""
