"""Motion in free flight: rotation without torque in closed form, the parabola, and translation with drag.

- `closed_form`: open this first. It chooses the simplest exact form of a rotation, gives the motion and its error bound, and
  the period between flips.
- `torque_free`: rotation of a body with any moments, by Jacobi's elliptic functions.
- `symmetric_top`: rotation of a body with two equal moments, in elementary functions.
- `constants`: the constants of a rotation, computed with a hundred digits, or for many bodies at once with pairs of numbers.
- `elliptic`: Jacobi's elliptic functions, for every modulus.
- `flights`: the motions of many bodies at once, as an ensemble needs them.
- `drag`: translation with quadratic drag, by quadratures, with its bounds and its witness; a folder.

`flights` imports `closed_form`, which imports `symmetric_top`, which imports `torque_free`, which imports `constants` and
`elliptic`. `drag` uses only the wide type of the others, and the drivers of heyoka and DOP853 of `integration`.
"""
