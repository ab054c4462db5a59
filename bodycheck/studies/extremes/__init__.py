"""Push cases and methods to extreme values, and report where and how the methods fail.

By default, all shipped cases with a table [extremes] are run. A case or a robot's file without this table is varied along axes
that fit its scene: time step, length, gravity, and the speeds that it has. The tables are extremes.csv and limits.csv. An
interrupted study resumes when it is run again with the same --out.

- `study` plans and makes the runs at the points on the axes of a case. `rows` defines the tables.
- `diagnosis` gives each run a status, from the `symptoms` of its motion, and describes how a drift grows.
- `stability` searches the largest stable time step.
- `page` and `outcome_map` make the report. `printing` serves the command line, and `interface` is the Python function.
"""
