"""The study of contact: how bodies roll, bounce, rest and tip in an engine, at its defaults, as recommended, and at its best.

- `sheet`: which scenes and figures are on the sheet, and what mechanics says of each figure.
- `study`: which runs are made, and the rows that follow from them; `rows` has the tables.
- `search`: the search for the best settings, as pure functions of measured errors.
- `probes`, `property`, `wording`: short motions that show which contacts a method has, and their words.
- `measuring`, `calls`: runs and probes in worker processes, recorded in a journal.
- `page`, `printing`, `command`: the report, the terminal, and the command `bodycheck contact`.
"""
