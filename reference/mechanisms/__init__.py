"""Mechanisms: bodies on joints, and their motion.

`mechanism` has what a mechanism is, `joint_types` the table of the types of joints, `coordinates` how the coordinates of joints
are laid out in arrays, and `exact` the numbers of a mechanism in exact arithmetic.

The way of the truth without loops is `recursion`. `tree` splits a mechanism into trees of links on elementary joints, with
`frames` in exact arithmetic. `articulated` has the articulated-body recursion in any arithmetic, and `link_states` the system
of first order that follows from it. `tree_equations` and, with dry friction, `stick_slip` solve its equations by
heyoka in any type; where it is not installed, `recursion` does by DOP853. `poses` leads back to joints and bodies.

`forms` has the motions in closed form, `lagrangian` the witness, and `loops` those of mechanisms whose chains are closed.
"""
