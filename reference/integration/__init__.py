"""Numerical integration of the equations of motion of a free rigid body: the witnesses of the closed forms.

- `lagrangian`: the Euler-Lagrange equations in Euler angles, with DOP853.
- `quasi_coordinates`: Euler's equations with a quaternion, with DOP853.
- `taylor`: both forms by Taylor's method in 80-bit and 128-bit arithmetic, with heyoka (Linux only).
- `sensitivity`: growth of an error along a motion, from the variational equations, with heyoka.
- `dop853`: SciPy's DOP853 near machine precision, used by `lagrangian` and `quasi_coordinates`, by `flight.drag` and by
  `sliding.coupled_motion`.

`sensitivity` imports `taylor`, and `taylor` imports the charts of `lagrangian`. Only `taylor` and `sensitivity` import heyoka;
where it is not installed, importing them raises `ImportError`.
"""
