"""The Python interface: `bodycheck.run`, and what it shares with `.tradeoff`, `.recommend` and `.extremes`.

The functions have the arguments of the commands of these names, with their defaults, and raise `BadInput` with their texts.

- `runs` has `bodycheck.run` and its results. The other functions are in the folders of their studies, in `interface`.
- `results`: the properties of all results: a headline, tables as data frames, plots, and a part of a page for a notebook.
  `plots`: a chart of the report, which a notebook shows.
- `arguments`: cases, names and numbers as Python gives them.

>>> import bodycheck
>>> for timestep in (0.004, 0.002, 0.001):
...     results = bodycheck.run("free-brick", engine="mujoco", integrator="Euler", timestep=timestep)
...     print(timestep, results.to_frame()["attitude_error"].max())
"""
