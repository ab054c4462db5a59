"""Judging stored runs: errors against the truth, expectations, and comparison with earlier results.

- `judgement` gives every run a verdict and makes the rows of results; `result_set` bundles results with their verdicts.
- `discrepancy` computes the errors of a run; `comparison` also computes a truth at the instants of the run.
- `identification` finds the textbook scheme that a method agrees with, from `scheme_runs` and within `scheme_rounding`.
- `classes` finds the methods, of whatever engines, that are the same algorithm: their motions agree to rounding.
  `run_classes` does so among stored runs.
- `convergence` observes the order of a method. `attribution` finds the causes of errors in contact.
- `baseline` saves results and finds changes; `rounding` estimates the differences that rounding can cause.
- `expectation_writer` writes measured limits into case files.
"""
