"""Measure how high the body is at the end of each case.

Cases with a mechanism are left out.

- `rows` defines the table, and `study` makes the runs.
"""
