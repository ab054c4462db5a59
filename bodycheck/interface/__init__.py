"""The Python interface: `bodycheck.run`, and what it shares with `.tradeoff`, `.recommend` and `.extremes`.

The functions have the arguments of the commands of these names, with their defaults, and raise `BadInput` with their texts.

- `runs` has `bodycheck.run` and its results. The other functions are in the folders of their studies, in `interface`.
- `results`: what all results have: a headline, tables as data frames, and plots. `plots`: a chart of the report, which a
  notebook shows. `html`: results as a part of a page, for a notebook.
- `arguments`: cases, names and numbers as Python gives them. `folders`: where results are.

>>> import bodycheck
>>> for timestep in (0.004, 0.002, 0.001):
...     found = bodycheck.run("free-brick", engine="mujoco", integrator="Euler", timestep=timestep)
...     print(timestep, found.to_frame()["attitude_error"].max())
"""
