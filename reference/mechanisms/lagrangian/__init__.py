"""The Lagrangian of a mechanism in joint coordinates, and the equations of motion that follow from it by differentiation.

- `solution`: the motion, which is the witness of the recursion.
- `border`: the mechanism as a chain of elements, with a hundred digits.
- `equations`: L, and the equations of Boltzmann and Hamel.
- `differentiation`: expressions and their derivatives.
- `taylor`, `scipy_solver`: the solution of the equations by Taylor's method (heyoka), and by DOP853.
- `poses`: the motion of joints and bodies from the states.
"""
