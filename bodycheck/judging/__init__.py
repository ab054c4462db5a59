"""Judging stored runs: errors against the truth, expectations, and comparison with earlier results.

- `judgement` gives every run a verdict and makes the rows of results; `result_set` bundles results with their verdicts.
- `discrepancy` computes the errors of a run; `comparison` also computes a truth at the instants of the run.
- `attribution` finds the causes of errors in contact. `expectation_writer` writes measured limits into case files.
- `baselines` compares results with earlier results. `schemes` finds orders, textbook schemes and equal algorithms.
"""
