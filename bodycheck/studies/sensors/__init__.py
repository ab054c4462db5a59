"""The study of sensors: what the sensors of an engine read after a step, after its own forward pass, and after a reset.

- `study`: which runs are made, and what of them is a measurement; the rows are those of `bodycheck.judging.sensors`.
- `rows`: the table, and the lines of the sheet, each of which joins the rows of all scenes.
- `recorded`: readings that somebody recorded, from a CSV file.
- `page`, `printing`, `command`, `interface`: the report, the terminal, the command `bodycheck sensors`, and its function.
"""
