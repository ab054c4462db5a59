"""Mechanisms: bodies on joints, and their motion.

`mechanism` has what a mechanism is, `coordinates` how the coordinates of joints are laid out in arrays, and `exact` the numbers
of a mechanism in exact arithmetic.

The way of the truth without loops is `recursion`. `tree` splits a mechanism into trees of links on elementary joints, with
`frames` in exact arithmetic. `articulated` has the articulated-body recursion in any arithmetic, and `link_states` the system
of first order that follows from it. `taylor_tree` and, with dry friction, `stick_slip` solve the equations of `tree_equations`
by heyoka, in types of `rounding`; `dop853_tree` solves them without it. `poses` leads back to joints and bodies.

`forms` has the motions in closed form, and `loops` those of mechanisms whose chains are closed.
"""
