"""Runs: how they are planned, made and compared with their truths.

- `plan` decides which cases are run in which engines with which methods. `campaign` makes the runs and their truths in worker
  processes, whose work is in `tasks`.
- `simulation` makes one run, sampled at `instants`; `state_checks` checks its states. `truths` computes the truth of a case.
  `pairing` brings a run and its truth together while both are in memory.
- `engines` gets the records of engines from worker processes, and `fetch_environments` installs releases of them.
- `members` runs the members of ensembles. `robot_readings` lets engines read a robot model.
- `exporting` writes a run as a script. `smoke` checks an adapter with scenes that have an obvious solution.
"""
