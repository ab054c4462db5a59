"""Figures of a run: their names, their meanings, how they are computed, and where they are shown.

`definition` defines figures, and `column` defines columns. `motion`, `conservation`, `contact`, `touching` and `mechanisms`
contain the figures, and `bounds` the bounds of the truth's own errors. `columns` is the table of all columns, and `scales`
gives the sizes by which rounding is estimated.
"""
