"""Findings about the runs of an ensemble, read from its folder; nothing is run.

- `stored` reads columns, and `queries` answers questions in SQL.
- `intervals` has quantiles and shares with their confidence, and `aggregates` what tables and reports are made of.
- `sensitivity` finds which drawn numbers a figure depends on, and `maps` shows it over two of them.
- `ways` are the ways in which members fail. `analysis` joins all of it.
"""
