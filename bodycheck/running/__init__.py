"""Runs: how they are planned, made and met with their truths.

- `plan` decides which cases are run in which engines with which methods. `campaign` makes the runs and their truths, for which
  worker processes do the work in `tasks`.
- `simulation` makes one run, sampled at `instants`; `state_checks` checks its states. `truths` computes the truth of a
  case. `pairing` hands on a run with its truth while both are in memory.
- `engines` asks engines in a worker process whether they can be used, and `fetch_environments` installs releases of them.
- `members` runs the members of ensembles. `robot_readings` asks engines what they read of a robot model.
- `exporting` writes a run as a script. `smoke` checks an adapter with scenes whose solution is obvious.
"""
