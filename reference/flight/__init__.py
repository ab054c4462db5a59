"""Motion in free flight: rotation without torque in closed form, the parabola, and translation with drag.

- `closed_form`: open this first. It chooses the simplest exact form of a rotation, gives the motion and its error bound, and
  the period between flips.
- `torque_free`: rotation of a body with any moments, by Jacobi's elliptic functions.
- `symmetric_top`: rotation of a body with two equal moments, in elementary functions.
- `elliptic`: Jacobi's elliptic functions, for every modulus.
- `drag`: translation with quadratic drag, by quadratures, with its bounds and its witness; a folder of its own.

`closed_form` imports `symmetric_top`, which imports `torque_free`, which imports `elliptic`. `drag` uses only
the wide type of the others, and the drivers of heyoka and DOP853 of `integration`.
"""
