"""The Python interface: `bodycheck.run` and `.export`, and the code that they share with the functions of studies.

The functions have the arguments, defaults and `BadInput` messages of the commands with the same names.

- `runs` has `bodycheck.run` and its results, and `exporting` has `bodycheck.export`. The other functions are in the module
  `interface` of their studies.
- `results` defines the properties of all results: a headline, tables as data frames, plots, and HTML for a notebook. `plots`
  defines a chart of the report, which a notebook shows.
- `arguments` reads cases, names and numbers that Python code gives.

>>> import bodycheck
>>> for timestep in (0.004, 0.002, 0.001):
...     results = bodycheck.run("free-brick", engine="mujoco", integrator="Euler", timestep=timestep)
...     print(timestep, results.to_frame()["attitude_error"].max())
"""
