"""Estimate the errors of an engine on a scene without a truth, by runs with smaller and smaller time steps.

The errors are distances from the engine's own limit as the time step goes to zero; what the model itself is worth is not asked.

- `study` runs a file or a case in engines; `method` refines the time step of one method, and searches the largest one that
  keeps an error. `levels` has the runs, `distances` the differences between them, and `refinement` the estimates that follow.
- `factors` has the measured safety factors of the classes of scenes, and `calibration` measures them.
- `rating` makes the rows of estimate.csv, which `rows` defines; `wording` says the results in sentences.
- `page`, `printing`, `command`, `interface`, `saved`: the report, the terminal, the command `bodycheck estimate`, the Python
  function, and reading back.
"""
