"""Worker processes. Nothing here knows mechanics, cases or results.

- `pool` calls functions in worker processes; `worker` is what such a process executes. They talk through a `channel`.
- `interpreter`: the Python that a process runs in. `limits` restricts its memory and lifetime, and `guard` ends what it starts.
- `process_state` shows whether a call has changed its process. `failures`: the outcomes of a call that fails.
"""
