"""The causes of differences, each of which is recomputed: put into the model of the file, it makes what the engine has.

- `explaining`: which causes explain which rows. The order of an engine's velocities comes first.
- `fault`: a suspected fault, and the model that the file would be with it.
- `bodies` and `inertias`, `joints`, `frames`: faults by the numbers and poses that an engine tells.
- `passive`, `hidden`: faults by what it computes: passive forces, and masses, inertias and armatures that it does not tell.
"""
