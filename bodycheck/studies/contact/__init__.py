"""The study of contact: how bodies roll, bounce, rest and tip in an engine, at its defaults and at the best settings found.

- `sheet`: which scenes and figures are on the sheet, and what mechanics says of each figure.
- `study`: which runs are made, and the rows that follow from them; `rows` has the table.
- `page`, `printing`, `command`: the report, the terminal, and the command `bodycheck contact`.
"""
