"""Worker processes. Nothing here knows mechanics, cases or results.

- `pool` calls functions in worker processes; `worker` is the program of such a process. They communicate through a `channel`.
- `interpreter` starts processes in a Python interpreter. `limits` restricts their memory and lifetime, and `guard` ends the
  processes that they start.
- `process_state` shows whether a call has changed its process. `failures` defines the outcomes of calls that fail.
"""
