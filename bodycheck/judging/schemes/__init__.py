"""Integration schemes of methods: their observed orders, the textbook schemes they agree with, and equal algorithms.

- `convergence` observes the order of a method.
- `identification` finds the textbook scheme that a method agrees with, from `scheme_runs` and within `scheme_rounding`;
  `jointed_identification` does so for mechanisms, and `identified` defines the results.
- `classes` finds the methods, of any engines, that are the same algorithm: their motions agree to rounding. `run_classes` does
  so among stored runs.
"""
