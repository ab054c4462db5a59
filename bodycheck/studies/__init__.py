"""Studies: each makes many runs to answer one question, and has a folder with its rows, its report and its command.

- `tradeoff`: what does an accuracy cost with each method, and at which order do errors vanish with the time step?
- `recommend`: which method reaches an accuracy at the lowest cost, and with which time step?
- `extremes`: at which extreme values do methods fail, and how?
- `ablation`: what do the model parts cost that a case does not require?
- `releases`: what changed from one release of an engine to the next?
- `audit`: what does an engine compute that is not mechanics, and which methods are the same?
- `ensemble`: how often does a method fail over many members of a case, and which are the worst?
- `parity`: does an engine build from a robot file the robot that the file describes?

Several studies use `cost`, which measures the time per step, `timesteps`, which has the time steps that suit a case, and
`orders`, the rows of the orders of convergence.
"""
