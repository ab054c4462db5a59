"""The execution of an ensemble's chunks.

- `carrying` runs and judges the members of a chunk, and writes its files. `calls` has the calls made in worker processes.
- `truths` stores the truths of members.
- `result_tables` joins the files of chunks to tables, also those of several jobs, and selects the runs that are kept whole.
"""
