"""The study of model parts that a case does not require: `bodycheck ablate`.

- `study` plans the runs, and compares cost and motion of every model with those of the smallest. `rows` defines the table.
- `page` makes the report. `command` and `printing` serve the command line.
"""
