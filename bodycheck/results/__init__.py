"""The contents of a results folder, and how they are read and written.

- `store` writes and reads a folder. `journal` and `records` handle its records, `header` its header, `truth_records` the
  records of truths, `trajectory_files` the states, and `csv_tables` the tables.
- `key` identifies a run, and `outcome` defines how a run may end. `unchecked` defines expectations that no run could check.
- `verdicts` is the vocabulary of verdicts: their words, marks and meanings.
- `origin` and `versions` describe the machine and the versions with which results were made.
"""
