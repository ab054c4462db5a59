"""The report of an ensemble.

- `page` joins `page_tables` and `charts`. `kept` is what was run for the report, stored so that it can be made again.
- `publishing` writes tables and report after runs, and `reporting` makes both again from the files.
"""
