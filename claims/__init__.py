"""Claims: every statement about an engine is a record that anyone can check.

A claim is a file `claims/ENGINE/NAME.toml`, the record, beside `claims/ENGINE/NAME.py`, a short script that shows the same with
the engine alone. `records` reads and checks records and writes their sentences with numbers, and `docs/tables.py` inserts these
sentences into pages. `measuring` runs the command and the script of a claim in each of its releases and compares their numbers
with the record. CONTRIBUTING.md describes how to add a claim. The room is no part of the package that users install.
"""
