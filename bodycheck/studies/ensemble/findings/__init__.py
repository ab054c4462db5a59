"""Findings about the runs of an ensemble, read from its folder; nothing is run.

- `stored` reads columns, and `queries` answers questions in SQL.
- `intervals` has quantiles and shares with confidence intervals, and `aggregates` the data of tables and reports.
- `sensitivity` finds which drawn numbers a figure depends on, and `maps` has the figure over two of them.
- `ways` are the ways in which members fail. `analysis` joins all of these.
"""
