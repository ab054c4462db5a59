"""Making runs and storing them.

- `plan` decides which cases are run in which engines with which methods. `campaign` makes the runs and their truths, for which
  worker processes are asked what is in `tasks`; `preparing` imports an engine there.
- `simulation` makes one run; `outcome` defines how it may end. `truths` computes the truth of a case.
- `engines` asks engines in a worker process whether they can be used.
- `pool` calls functions in worker processes, whose memory and lifetime `limits` restricts and whose `guard` ends what they
  start; they talk through a `channel`, and `process_state` tells whether a call has changed its process.
- `store` writes and reads a folder of results, with `journal` and `records` for its records, `header` for its header,
  `truth_records` for what they say of truths, `trajectory_files` for its states and `csv_tables` for tables. `key` identifies a
  run.
- `machine` describes the machine. `smoke` checks an adapter with scenes whose solution is obvious.
"""
