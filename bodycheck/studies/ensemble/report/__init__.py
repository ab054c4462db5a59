"""The report of an ensemble.

- `page` joins `page_tables` and `charts`.
- `publishing` writes tables and report after runs, and `reporting` makes both again from the files.
"""
