"""The contents of a folder of results, and how they are read and written.

- `store` writes and reads a folder. `journal` and `records` have its records, `header` its header, `truth_records` the records
  of truths, `trajectory_files` the states, and `csv_tables` the tables.
- `key` identifies a run, and `outcome` defines how a run may end. `unchecked` reads records without checking all of them.
- `verdicts` is the vocabulary of verdicts: their words, marks and meanings.
- `origin` and `versions` describe where and with what results were made.
"""
