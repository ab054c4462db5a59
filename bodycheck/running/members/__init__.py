"""The execution of ensembles: many members are run in blocks, and blocks form chunks of work.

- `blocks` runs the members of a chunk with one method of an engine. `member_runs` makes the runs of members.
- `chunks` divides an ensemble, `chunk_files` stores the rows of a chunk, and `compaction` joins such files.
- `chunk_workers` manages the worker processes of a thread, and finds the members that end a process.
- `executors` carry out chunks on this machine, on a Dask cluster, or as a share of several jobs.
"""
