"""Numerical integration of the equations of motion of a free rigid body: the witnesses of the closed forms.

- `lagrangian`: the Euler-Lagrange equations in Euler angles, with DOP853.
- `quasi_coordinates`: Euler's equations with a quaternion, with DOP853.
- `taylor`: the Euler-Lagrange equations by Taylor's method in 80-bit and 128-bit arithmetic, with heyoka (Linux only).
- `heyoka_solver`: Taylor's method itself, in any arithmetic.
- `collocation`: Gauss-Legendre collocation in the wide type, which steps over singular positions.
- `periods`: any number of turns of a body without torque, continued from one period.
- `rotation`: the result of an integration in a wide type.
- `sensitivity`: growth of an error along a motion, from the variational equations, with heyoka.
- `dop853`: SciPy's DOP853 near machine precision, used by `lagrangian` and `quasi_coordinates`, by `flight.drag` and by
  `sliding.coupled_motion`.

Only `taylor`, `heyoka_solver` and `sensitivity` import heyoka; where it is not installed, importing them raises `ImportError`.
"""
