"""The study of the time step that an accuracy needs: `bodycheck recommend`.

- `study` searches the largest time step of every method that keeps an error, and measures what it costs. `search` chooses the
  next step to be measured; `measuring` makes the runs and times the answers. `rows` defines the result.
- `wording` says it in sentences. `page` makes the report. `command` and `printing` serve the command line, and `interface` is
  the Python function.

>>> bodycheck.recommend("osrf-boxes-complex", error=1e-3).best
"""
