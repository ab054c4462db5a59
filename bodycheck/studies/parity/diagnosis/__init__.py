"""The causes of differences. Each cause is recomputed: the model of the file, with the cause put in, has the engine's numbers.

- `explaining`: the assignment of causes to rows. The order of an engine's velocities is examined first.
- `fault`: a suspected fault, and the model of the file with faults put into it.
- `bodies` and `inertias`, `joints`, `frames`: faults found from the numbers and poses that an engine reports.
- `passive`, `hidden`: faults found from the terms that an engine computes: passive forces, and masses, inertias and armatures
  that it does not report.
"""
