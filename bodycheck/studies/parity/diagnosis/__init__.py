"""The causes of differences, each of which is recomputed: put into the model of the file, it makes what the engine has.

- `explaining`: which causes explain which rows.
- `fault`: a suspected fault, and the model that the file would be with it.
- `bodies` and `inertias`, `joints`, `frames`: faults by the numbers and poses that an engine tells.
- `ordering`, `passive`, `hidden`: faults by what it computes: the order of its velocities, passive forces, and masses,
  inertias and armatures that it does not tell.
"""
