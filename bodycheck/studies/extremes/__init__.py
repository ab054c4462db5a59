"""The study of extreme values: `bodycheck extremes`.

- `study` plans and makes the runs; `points` lists the points on the axes of a case. `rows` defines the tables.
- `diagnosis` gives each run a status, from the `symptoms` of its motion. `growth` describes how a drift grows.
- `stability` searches the largest stable time step.
- `page` and `outcome_map` make the report. `command` and `printing` serve the command line.
"""
