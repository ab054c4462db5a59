"""The Python interface for studies: `bodycheck.run`, `.tradeoff`, `.recommend` and `.extremes`, and what they return.

The functions have the arguments of the commands of these names, with their defaults, and raise `BadInput` with their texts.

- `runs`, `tradeoffs`, `recommendations` and `extremes` have one function each, and the class of its results.
- `results`: what all results have: a headline, tables as data frames, and plots. `plots`: a chart of the report, which a
  notebook shows. `html`: results as a part of a page, for a notebook.
- `arguments`: cases, names and numbers as Python gives them. `folders`: where results are.

>>> import bodycheck
>>> for timestep in (0.004, 0.002, 0.001):
...     found = bodycheck.run("free-brick", engine="mujoco", integrator="Euler", timestep=timestep)
...     print(timestep, found.to_frame()["attitude_error"].max())
"""
