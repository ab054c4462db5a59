"""Figures of a run: what each is called, what it means, how it is computed, and where it is shown.

`definition` says what a figure and a column are. `motion`, `conservation` and `contact` hold the figures. `columns` is the
table of all columns, and `scales` gives the sizes by which rounding is estimated.
"""
