"""Studies: each makes many runs to answer one question, and has a folder with its rows, its report and its command.

- `tradeoff`: which methods reach an accuracy at the lowest cost?
- `extremes`: at which extreme values do methods fail, and how?
- `ablation`: what do model parts cost that a case does not require?
- `releases`: what changed from one release of an engine to the next?

Several studies use `cost`, which measures the time per step, and `orders`, the rows on orders of convergence.
"""
