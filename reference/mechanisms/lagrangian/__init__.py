"""The Lagrangian of a mechanism in joint coordinates, and the equations of motion that follow from it by differentiation.

- `solution`: the motion, which is the witness of the recursion.
- `border`: the mechanism as a chain of elements, with a hundred digits.
- `equations`: L, and the equations of Boltzmann and Hamel.
- `differentiation`: expressions and their derivatives.
- `taylor`, `scipy_solver`: the solution of the equations by Taylor's method (heyoka), and by DOP853.
- `laws`, `sampled`: controllers and stops, and controllers that compute at instants.
- `system`, `phases`, `changes`: motions whose equations switch, from change to change.
- `reaching`: which rigid stops a motion reaches.
- `friction`, `impacts`: what is held at rest, and what happens at rigid stops.
- `poses`: the motion of joints and bodies from the states.
"""
